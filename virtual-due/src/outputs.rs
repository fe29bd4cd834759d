//! The chip's outputs: the level at which a peripheral drives a pin, for the PIO controllers, for wires and for a record.

use crate::chip::{Chip, NEVER};
use crate::peripheral_map::Slot;
use crate::pins::PinChange;
use sam3x_models::model::{Pin, Side, Signal, World};

/// Passes of levels along wires, where an output follows an input; more would be an oscillator.
const PASSES: usize = 4;

impl<W: World> Chip<W> {
    /// Connects two pins.
    pub fn connect(&mut self, first: Pin, second: Pin, instructions: u64) {
        self.pins.wires.push([first, second]);
        self.follow_outputs(instructions);
    }

    /// Begins to record changes of pins.
    pub fn record_pins(&mut self, instructions: u64) {
        self.pins.changes = Some(Vec::new());
        self.follow_outputs(instructions);
    }

    /// Takes the changes of pins since the last call, in the order of time.
    pub fn take_pin_changes(&mut self) -> Vec<PinChange> {
        let mut changes = self.pins.changes.as_mut().map(std::mem::take).unwrap_or_default();
        changes.sort_by_key(|change| change.at);
        changes
    }

    /// The side of a pin's multiplexer, where the pin belongs to a peripheral.
    fn side(&self, pin: Pin) -> Option<Side> {
        let (a, b) = self.given[usize::from(pin.port)];
        if a >> pin.line & 1 != 0 { Some(Side::A) } else { (b >> pin.line & 1 != 0).then_some(Side::B) }
    }

    /// The peripheral that drives a pin of its own.
    fn driver(&self, pin: Pin, side: Side) -> Option<usize> {
        // A PIO controller drives pins that are no peripheral's.
        let drives = |slot: &Slot| slot.model.output(pin, side, self.now).is_some();
        self.slots.iter().position(drives).filter(|index| !self.directory.pio.contains(index))
    }

    /// The level at which a peripheral drives a pin that belongs to it.
    fn peripheral_output(&mut self, pin: Pin) -> Option<bool> {
        let side = self.side(pin)?;
        let index = self.driver(pin, side)?;
        if self.slots[index].clock_runs(self.clocks) {
            self.call(index, |model, context| model.advance(context));
            self.refresh(index);
        }
        self.slots[index].model.output(pin, side, self.now)
    }

    /// The level at which the chip drives a pin: a peripheral, or the PIO controller.
    fn level(&mut self, pin: Pin) -> Option<bool> {
        if self.side(pin).is_some() {
            return self.peripheral_output(pin);
        }
        let pio = self.directory.pio[usize::from(pin.port)];
        self.slots[pio].model.output(pin, Side::A, self.now)
    }

    /// Shows a PIO controller the levels at which peripherals drive its lines now.
    pub fn show_outputs(&mut self, index: usize) {
        let Some(port) = self.directory.pio.iter().position(|pio| *pio == index) else { return };
        let (a, b) = self.given[port];
        let (mut driven, mut levels) = (0, 0);
        for line in (0..32_u8).filter(|line| (a | b) >> line & 1 != 0) {
            if let Some(level) = self.peripheral_output(Pin { port: port as u8, line }) {
                driven |= 1 << line;
                levels |= u32::from(level) << line;
            }
        }
        self.call(index, |model, context| model.signal(Signal::Outputs { driven, levels }, context));
    }

    /// Follows the outputs, where they are watched: records their changes, passes them along wires, and finds the next edge.
    pub fn follow_outputs(&mut self, instructions: u64) {
        if !self.pins.are_watched() {
            return;
        }
        self.record_outputs();
        self.dispatch_signals(instructions);
        for _ in 0..PASSES {
            if !self.move_wires() {
                break;
            }
            for index in self.directory.samplers {
                self.send_signal(index, Signal::WiresMoved);
            }
            self.dispatch_signals(instructions);
        }
        self.next_edge = self.find_next_edge();
    }

    fn given_pins(&self) -> Vec<Pin> {
        let lines = |port: u8| {
            let (a, b) = self.given[usize::from(port)];
            (0..32).filter(move |line| (a | b) >> line & 1 != 0).map(move |line| Pin { port, line })
        };
        (0..4).flat_map(lines).collect()
    }

    fn record_outputs(&mut self) {
        for pin in self.given_pins() {
            let level = self.peripheral_output(pin);
            let before = match level {
                Some(level) => self.pins.outputs.insert(pin, level),
                None => self.pins.outputs.remove(&pin),
            };
            if before != level {
                self.pins.record(pin, level, self.now);
            }
        }
        let given = self.given;
        self.pins.outputs.retain(|pin, _| {
            let (a, b) = given[usize::from(pin.port)];
            (a | b) >> pin.line & 1 != 0
        });
    }

    /// Passes levels along the wires; true if one has changed.
    fn move_wires(&mut self) -> bool {
        let mut moved = false;
        for [first, second] in self.pins.wires.clone() {
            for (from, to) in [(first, second), (second, first)] {
                let level = self.level(from);
                let before = match level {
                    Some(level) => self.pins.wired.insert(to, level),
                    None => self.pins.wired.remove(&to),
                };
                if before != level {
                    moved = true;
                    self.pins.record(to, level, self.now);
                }
            }
        }
        moved
    }

    fn find_next_edge(&self) -> u64 {
        let edge = |pin: Pin| {
            let side = self.side(pin)?;
            let index = self.driver(pin, side)?;
            self.slots[index].model.next_output_edge(pin, side, self.now)
        };
        let edges = self.given_pins().into_iter().filter_map(edge);
        edges.min().map_or(NEVER, |edge| edge.max(self.now + 1))
    }
}
