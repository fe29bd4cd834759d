//! The file of the pins' changes, a VCD, which PulseView and GTKWave open.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufWriter};
use std::path::Path;

use vcd::{IdCode, TimescaleUnit, Value, Writer};
use virtual_due::model::Pin;
use virtual_due::{CYCLES_PER_SECOND, Cycles, PinChange, arduino_pins};

const NANOSECONDS: u128 = 1_000_000_000;

/// A VCD file with a wire for each pin that has a name.
pub struct PinsFile {
    writer: Writer<BufWriter<File>>,
    wires: BTreeMap<Pin, IdCode>,
    /// Time of the last time stamp, ns.
    stamped: u64,
}

impl PinsFile {
    /// Creates the file; nothing drives a pin at first.
    ///
    /// # Errors
    /// Those of the file.
    pub fn create(path: &Path) -> io::Result<Self> {
        let mut writer = Writer::new(BufWriter::new(File::create(path)?));
        writer.version(concat!("virtual-due ", env!("CARGO_PKG_VERSION")))?;
        writer.timescale(1, TimescaleUnit::NS)?;
        writer.add_module("due")?;
        let mut wires = BTreeMap::new();
        for (name, pin) in arduino_pins::all() {
            wires.insert(pin, writer.add_wire(1, &name)?);
        }
        writer.upscope()?;
        writer.enddefinitions()?;
        writer.timestamp(0)?;
        for wire in wires.values() {
            writer.change_scalar(*wire, Value::Z)?;
        }
        Ok(Self { writer, wires, stamped: 0 })
    }

    /// Writes changes, which are in the order of time. Those of pins without a name are left out.
    ///
    /// # Errors
    /// Those of the file.
    pub fn write(&mut self, changes: &[PinChange]) -> io::Result<()> {
        for PinChange { at, pin, level } in changes {
            let Some(wire) = self.wires.get(pin).copied() else { continue };
            self.stamp(nanoseconds(*at))?;
            let value = match level {
                Some(true) => Value::V1,
                Some(false) => Value::V0,
                None => Value::Z,
            };
            self.writer.change_scalar(wire, value)?;
        }
        Ok(())
    }

    /// Writes the time of the end, and what is buffered.
    ///
    /// # Errors
    /// Those of the file.
    pub fn finish(&mut self, end: Cycles) -> io::Result<()> {
        self.stamp(nanoseconds(end))?;
        self.writer.flush()
    }

    fn stamp(&mut self, time: u64) -> io::Result<()> {
        if time > self.stamped {
            self.writer.timestamp(time)?;
            self.stamped = time;
        }
        Ok(())
    }
}

fn nanoseconds(at: Cycles) -> u64 {
    (u128::from(at) * NANOSECONDS / u128::from(CYCLES_PER_SECOND)) as u64
}
