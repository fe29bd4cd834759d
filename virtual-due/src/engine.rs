//! The CPU engine: rigless' Cortex-M3, behind [`Cpu`].

use crate::cpu::{self, Bus, Cpu, Stop};
use crate::memory::{Mapped, Region};
use rigless::cpu::armv7m::{Window, processor};
use rigless::device::Level;
use rigless::emulator::{Access, AccessKind, CoreBus, Exit, InterruptLine, Queued};
use rigless::machine::armv7m::{Config, Core, Fpu, MpuRegions, Variant};
use rigless::soc::{Endian, Width};
use rigless::time::VirtualNanos;
use std::num::{NonZeroU32, NonZeroU64};
use std::rc::Rc;

/// Interrupt lines of the SAM3X8E (datasheet 9.1, "Peripheral identifiers").
const LINES: NonZeroU32 = NonZeroU32::new(45).expect("not zero");
const CORE_HZ: NonZeroU64 = NonZeroU64::new(84_000_000).expect("not zero");
/// SysTick's reference clock is MCK/8 (datasheet 10.22).
const REFERENCE_DIVIDER: NonZeroU32 = NonZeroU32::new(8).expect("not zero");
/// CPUID of the Cortex-M3 r2p0 in the SAM3X8E.
const CPUID: u32 = 0x412F_C230;

/// The watchpoint unit's registers that the board answers: DWT_CTRL and DWT_CYCCNT.
pub const DWT: std::ops::Range<u32> = 0xE000_1000..0xE000_1008;

/// Engine time of a core cycle. The engine measures time in ns, and its timer counts at a fixed 84 MHz of it. A core cycle of
/// any length is therefore 250/21 ns to the engine; rounded up, so that the engine's own rounding down yields the cycle again.
fn nanos(core_cycles: u64) -> VirtualNanos {
    VirtualNanos(core_cycles / 21 * 250 + (core_cycles % 21 * 250).div_ceil(21))
}

/// The first core cycle whose engine time is `at` or later.
fn core_cycles(at: VirtualNanos) -> u64 {
    let floor = at.0 / 250 * 21 + at.0 % 250 * 21 / 250;
    if nanos(floor) >= at { floor } else { floor + 1 }
}

/// The Cortex-M3 of the board.
#[derive(Debug)]
pub struct Engine {
    mapped: Mapped,
    // The state after the first reset: loading it keeps translated code, which the engine's own reset drops, at a third of a
    // second each time.
    fresh: Option<Vec<u8>>,
    // Instructions before the last reset; loading a state sets the engine's own count back.
    before: u64,
    // Instructions at which translations from RAM were last dropped.
    swept: u64,
}

/// Instructions after which translations from RAM are dropped. While a page of RAM has translated code, the engine takes the
/// slow path for each store to it, and variables often share a page with a routine that ran once. Code that still runs is
/// translated again.
const SWEEP: u64 = 5_000_000;
const RAM: std::ops::Range<u32> = 0x2000_0000..0x2010_1000;

impl Engine {
    /// A core with nothing mapped.
    pub fn new() -> Self {
        let core = Core {
            variant: Variant::M3,
            clock_hz: CORE_HZ,
            interrupt_lines: LINES,
            priority_bits: 4,
            refclk_divider: REFERENCE_DIVIDER,
            instructions_per_second: NonZeroU64::new(60_000_000).expect("not zero"),
            boot: "flash",
        };
        let window = Window { base: DWT.start.into(), size: DWT.len() as u64 };
        let mut config = Config::new(core, &[window]);
        config.fpu = Fpu::None;
        config.mpu_regions = MpuRegions::Eight;
        config.cpuid = CPUID;
        let processor = processor(&config, Endian::Little).expect("the SAM3X8E's core is one that the engine makes");
        Self { mapped: Mapped::new(processor), fresh: None, before: 0, swept: 0 }
    }

    /// Maps memory at an address.
    pub fn map(&mut self, address: u32, region: &Rc<Region>, writable: bool) {
        self.mapped.map(address, region, writable);
    }
}

impl Cpu for Engine {
    fn run(&mut self, budget: u32, bus: &mut dyn Bus) -> Stop {
        if self.instructions() - self.swept > SWEEP {
            self.swept = self.instructions();
            self.changed(RAM.start, RAM.len() as u32);
        }
        let (exit, _) = self.mapped.processor_mut().run(budget, &mut BusAdapter { bus, before: self.before });
        match exit {
            Exit::Waiting => Stop::Waiting,
            Exit::Breakpoint => Stop::Breakpoint,
            Exit::Lockup => Stop::Lockup,
            Exit::HostCall => {
                // There is no host: the BKPT is a fault as without a debugger.
                self.mapped.processor_mut().answer_host_call(None);
                Stop::Returned
            }
            _ => Stop::Returned,
        }
    }

    fn instructions(&self) -> u64 {
        self.before + self.mapped.processor().retired()
    }

    fn pc(&self) -> u32 {
        self.mapped.processor().pc() as u32
    }

    fn waiting(&self) -> bool {
        self.mapped.processor().waiting()
    }

    fn set_line(&mut self, line: u16, high: bool) {
        self.mapped.processor_mut().ask(queued_line(line, high));
    }

    fn next_event(&self) -> Option<u64> {
        self.mapped.processor().next_event().map(core_cycles)
    }

    fn on_event(&mut self, core_cycles: u64) {
        self.mapped.processor_mut().on_event(nanos(core_cycles));
    }

    fn reset(&mut self, stack_pointer: u32, entry: u32) {
        let processor = self.mapped.processor_mut();
        let retired = processor.retired();
        if let Some(fresh) = &self.fresh {
            processor.load(fresh).expect("a state of this very processor");
        } else {
            processor.reset();
            self.fresh = Some(processor.save());
        }
        self.before += retired - processor.retired();
        processor.boot(0, &|address, _| Some(u64::from(if address == 0 { stack_pointer } else { entry })));
    }

    fn take_reset_request(&mut self) -> bool {
        self.mapped.processor_mut().take_reset_request()
    }

    fn changed(&mut self, start: u32, length: u32) {
        self.mapped.processor_mut().ask(queued_change(start, length));
    }

    fn add_breakpoint(&mut self, address: u32) -> bool {
        self.mapped.processor_mut().add_breakpoint(address.into())
    }

    fn remove_breakpoint(&mut self, address: u32) {
        self.mapped.processor_mut().remove_breakpoint(address.into());
    }

    fn pass_breakpoint(&mut self, address: u32) {
        self.mapped.processor_mut().pass_breakpoint(address.into());
    }

    fn register(&self, number: usize) -> Option<u32> {
        let bytes = self.mapped.processor().gdb_register(number)?;
        Some(u32::from_le_bytes(bytes.try_into().ok()?))
    }

    fn set_register(&mut self, number: usize, value: u32) -> bool {
        self.mapped.processor_mut().set_gdb_register(number, &value.to_le_bytes())
    }

    fn debugger_description(&self) -> &'static str {
        self.mapped.processor().target_xml()
    }

    fn peek(&mut self, address: u32, core_cycles: u64) -> Option<u32> {
        let value = self.mapped.processor_mut().debugger_access(None, address.into(), Width::W32, nanos(core_cycles));
        value.map(|value| value as u32)
    }

    fn poke(&mut self, address: u32, value: u32, core_cycles: u64) -> bool {
        let processor = self.mapped.processor_mut();
        processor.debugger_access(Some(value.into()), address.into(), Width::W32, nanos(core_cycles)).is_some()
    }
}

fn queued_line(line: u16, high: bool) -> Queued {
    let line = InterruptLine::new(line).expect("the engine has all lines of the board");
    Queued::Line(line, if high { Level::High } else { Level::Low })
}

fn queued_change(start: u32, length: u32) -> Queued {
    Queued::Invalidate(start.into(), u64::from(start) + u64::from(length))
}

/// The board's [`Bus`] as the engine's [`CoreBus`].
struct BusAdapter<'a> {
    bus: &'a mut dyn Bus,
    before: u64,
}

impl CoreBus for BusAdapter<'_> {
    fn access(&mut self, access: Access, _from_code: bool) -> Option<u64> {
        let bytes = match access.width {
            Width::W8 => 1,
            Width::W16 => 2,
            _ => 4,
        };
        let access = cpu::Access {
            address: access.address as u32,
            bytes,
            store: (access.kind == AccessKind::Write).then_some(access.value as u32),
            pc: access.program_counter.unwrap_or(0) as u32,
            instructions: self.before + access.instruction_count,
        };
        self.bus.access(access).map(u64::from)
    }

    fn time(&self, instructions: u64) -> VirtualNanos {
        nanos(self.bus.core_cycles(self.before + instructions))
    }

    fn queued(&mut self) -> Vec<Queued> {
        let mut queued = Vec::new();
        while let Some((start, length)) = self.bus.take_changed() {
            queued.push(queued_change(start, length));
        }
        while let Some((line, high)) = self.bus.take_line() {
            queued.push(queued_line(line, high));
        }
        queued
    }

    fn carry_on(&mut self, instructions: u64, event: Option<VirtualNanos>) -> Option<u32> {
        self.bus.carry_on(self.before + instructions, event.map(core_cycles))
    }
}

#[cfg(test)]
mod tests {
    use super::{core_cycles, nanos};

    #[test]
    fn a_core_cycle_survives_the_engines_nanoseconds() {
        for cycle in (0..100_000).chain(1_000_000_000_000..1_000_000_000_100) {
            assert_eq!(core_cycles(nanos(cycle)), cycle);
            assert_eq!(u128::from(nanos(cycle).0) * 84_000_000 / 1_000_000_000, u128::from(cycle));
        }
    }
}
