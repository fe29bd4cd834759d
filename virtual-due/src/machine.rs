//! The whole board: CPU, chip and world, and time.

use crate::chip::Chip;
use crate::cpu::{Bus, Cpu, Stop};
use crate::elf::Elf;
use crate::engine::Engine;
use crate::pins::PinChange;
use crate::report::Report;
use firmware_image::ImageError;
use std::collections::BTreeSet;

use sam3x_models::flash::{BANK, FLASH};
use sam3x_models::model::{Cause, Cycles, Memory, Pin, World};

/// Size of the flash, bytes: both banks.
pub const FLASH_BYTES: usize = 2 * BANK as usize;

/// A reset that happened.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Reset {
    /// Its cause.
    pub cause: Cause,
    /// Time of the reset.
    pub at: Cycles,
}

/// An Arduino Due that runs a firmware, in a world.
///
/// Two machines of the same firmware and world behave the same, in however many pieces they are run.
///
/// ```no_run
/// use rig_twin::Scenario;
/// use virtual_due::{CYCLES_PER_SECOND, Machine, WiredRig};
///
/// let elf = std::fs::read("firmware.elf")?;
/// let mut machine = Machine::new(&elf, WiredRig::new(Scenario::FreeSwing, 1))?;
/// machine.run_for(2 * CYCLES_PER_SECOND);
/// println!("{} instructions, pc {:#x}", machine.instructions(), machine.pc());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Machine<W> {
    pub(crate) cpu: Engine,
    pub(crate) chip: Chip<W>,
    elf: Elf,
    resets: Vec<Reset>,
    locked_up: bool,
    // The world may have been changed since the last instruction.
    touched: bool,
    pub(crate) breakpoints: BTreeSet<u32>,
    // Address at which a debugger has seen the CPU stop: its breakpoint there does not stop it again.
    pub(crate) stopped_at: Option<u32>,
}

impl<W: World> Machine<W> {
    /// A board with `elf` in its flash, at power-on.
    ///
    /// # Errors
    ///
    /// [`ImageError`] if `elf` is not a firmware for the Due.
    pub fn new(elf: &[u8], world: W) -> Result<Self, ImageError> {
        let elf = Elf::parse(elf)?;
        let mut chip = Chip::new(world);
        for (address, bytes) in &elf.pieces {
            chip.memories.load(*address, bytes);
        }
        let mut cpu = Engine::new();
        chip.memories.map(&mut cpu);
        let mut machine = Self {
            cpu,
            chip,
            elf,
            resets: Vec::new(),
            locked_up: false,
            touched: true,
            breakpoints: BTreeSet::new(),
            stopped_at: None,
        };
        machine.reset(Cause::General);
        machine.resets.clear();
        Ok(machine)
    }

    /// Replaces the content of the flash, from its first byte, but for what the firmware occupies.
    pub fn load_flash(&mut self, content: &[u8]) {
        for (address, bank) in [FLASH, FLASH + BANK].into_iter().zip(content.chunks(BANK as usize)) {
            self.chip.memories.load(address, bank);
        }
        for (address, bytes) in &self.elf.pieces {
            self.chip.memories.load(*address, bytes);
        }
    }

    /// Content of the flash, both banks.
    pub fn flash(&self) -> Vec<u8> {
        [FLASH, FLASH + BANK].into_iter().filter_map(|bank| self.peek(bank, BANK as usize)).flatten().collect()
    }

    /// Runs until board time `end`; the last instruction may end after it.
    pub fn run_until(&mut self, end: Cycles) {
        self.run(end);
    }

    /// Runs for a number of cycles.
    pub fn run_for(&mut self, cycles: Cycles) {
        self.run(self.now() + cycles);
    }

    /// Runs until the instruction at `address` is next, or until board time `limit`; true if the instruction was reached. A
    /// CPU that is at `address` already runs until it returns there.
    pub fn run_to(&mut self, address: u32, limit: Cycles) -> bool {
        let address = address & !1;
        if !self.cpu.add_breakpoint(address) {
            return false;
        }
        if self.cpu.pc() == address {
            self.cpu.pass_breakpoint(address);
        }
        let stopped = self.run(limit);
        self.cpu.remove_breakpoint(address);
        stopped
    }

    /// Runs until `end`, or a breakpoint; true if a breakpoint was reached.
    pub(crate) fn run(&mut self, end: Cycles) -> bool {
        self.chip.limit = end;
        loop {
            self.process_pending();
            if self.now() >= end {
                self.chip.advance_all(self.cpu.instructions());
                return false;
            }
            let instructions = self.cpu.instructions();
            let budget = self.chip.clock.instructions_until(instructions, self.next_event(end)).max(1);
            match self.cpu.run(u32::try_from(budget).unwrap_or(u32::MAX), &mut self.chip) {
                Stop::Returned => {}
                Stop::Breakpoint => {
                    self.process_pending();
                    self.chip.advance_all(self.cpu.instructions());
                    return true;
                }
                Stop::Waiting => self.sleep(end),
                Stop::Lockup => {
                    self.report_lockup();
                    self.sleep(end);
                }
            }
        }
    }

    /// Sleeps until the next event.
    pub(crate) fn sleep(&mut self, end: Cycles) {
        if self.chip.reset.is_none() {
            let next = self.next_event(end);
            self.chip.clock.sleep_until(self.cpu.instructions(), next);
        }
    }

    /// Processes everything that is due before the next instruction: events, resets, changed memory, interrupt lines.
    pub(crate) fn process_pending(&mut self) {
        let instructions = self.cpu.instructions();
        self.chip.catch_up(self.chip.clock.now(instructions), instructions);
        if std::mem::take(&mut self.touched) {
            self.chip.advance_all(instructions);
        }
        if self.cpu.take_reset_request() {
            self.chip.reset.get_or_insert(Cause::Software);
        }
        if let Some(cause) = self.chip.reset {
            self.reset(cause);
        }
        while let Some((start, length)) = self.chip.take_changed() {
            self.cpu.changed(start, length);
        }
        while let Some((line, high)) = self.chip.take_line() {
            self.cpu.set_line(line, high);
        }
        let core_cycles = self.chip.clock.core_cycles(instructions);
        while self.cpu.next_event().is_some_and(|event| event <= core_cycles) {
            self.cpu.on_event(core_cycles);
        }
    }

    fn next_event(&self, end: Cycles) -> Cycles {
        let cpu = self.cpu.next_event().map_or(Cycles::MAX, |event| self.chip.clock.at_core_cycles(event));
        self.chip.next_event().min(cpu).min(end)
    }

    fn reset(&mut self, cause: Cause) {
        self.resets.push(Reset { cause, at: self.now() });
        self.locked_up = false;
        let (stack_pointer, entry) = self.chip.memories.boot(&mut self.cpu, self.chip.boots_from_flash);
        self.chip.warnings.now = self.now();
        if !self.chip.boots_from_flash {
            let text = "GPNVM bit 1 is clear: the boot loader in ROM runs and waits for a flash tool".to_owned();
            self.chip.warnings.warn_once(text);
        }
        self.cpu.reset(stack_pointer, entry);
        self.chip.apply_reset(cause, self.cpu.instructions());
    }

    pub(crate) fn report_lockup(&mut self) {
        if !self.locked_up {
            self.chip.warnings.now = self.now();
            self.chip.warnings.pc = Some(self.cpu.pc());
            self.chip.warnings.warn_once("the core locked up: a fault in a fault's handler".to_owned());
            self.chip.warnings.pc = None;
        }
        self.locked_up = true;
    }

    /// Presses and releases the reset button, as the USB bridge does when a host opens the programming port.
    pub fn press_reset(&mut self) {
        self.reset(Cause::User);
    }

    /// Power comes up again after it was lost: RAM and backup registers hold nothing of before.
    pub fn power_on(&mut self) {
        self.chip.memories.lose_ram();
        self.reset(Cause::General);
    }

    /// Board time: cycles of 84 MHz since power-on.
    pub fn now(&self) -> Cycles {
        self.chip.clock.now(self.cpu.instructions())
    }

    /// Board time in seconds.
    pub fn seconds(&self) -> f64 {
        self.now() as f64 / sam3x_models::model::CYCLES_PER_SECOND as f64
    }

    /// Instructions retired since power-on, sleep not counted.
    pub fn instructions(&self) -> u64 {
        self.cpu.instructions()
    }

    /// Address of the next instruction.
    pub fn pc(&self) -> u32 {
        self.cpu.pc()
    }

    /// True if the CPU sleeps until an interrupt.
    pub fn sleeps(&self) -> bool {
        self.cpu.waiting()
    }

    /// True if the CPU has locked up and was not reset since.
    pub fn locked_up(&self) -> bool {
        self.locked_up
    }

    /// A symbol's value; a function's is the address of its first instruction.
    pub fn symbol(&self, name: &str) -> Option<u32> {
        self.elf.symbol(name)
    }

    /// Reads memory as a debugger does; `None` outside memory.
    pub fn peek(&self, address: u32, length: usize) -> Option<Vec<u8>> {
        let mut bytes = vec![0; length];
        self.chip.memories.read(address, &mut bytes).then_some(bytes)
    }

    /// Writes memory, flash too, as a debugger does; false outside memory.
    pub fn poke(&mut self, address: u32, bytes: &[u8]) -> bool {
        self.cpu.changed(address, bytes.len() as u32);
        self.chip.memories.load(address, bytes)
    }

    /// Reads a word of the core's own registers, 0xE000_E000…: NVIC, SCB, SysTick.
    pub fn peek_core(&mut self, address: u32) -> Option<u32> {
        let core_cycles = self.chip.clock.core_cycles(self.cpu.instructions());
        self.cpu.peek(address, core_cycles)
    }

    /// Writes a word of the core's own registers as a debugger does; false if there is no register.
    pub fn poke_core(&mut self, address: u32, value: u32) -> bool {
        let core_cycles = self.chip.clock.core_cycles(self.cpu.instructions());
        self.cpu.poke(address, value, core_cycles)
    }

    /// Resets since power-on, the power-on not counted.
    pub fn resets(&self) -> &[Reset] {
        &self.resets
    }

    /// Takes the reports since the last call, about actions of the firmware that the models do not cover.
    pub fn reports(&mut self) -> Vec<Report> {
        let warnings = self.chip.warnings.take();
        warnings.into_iter().map(|warning| Report::new(warning, &self.elf)).collect()
    }

    /// Connects two pins by a wire: each shows the level at which the chip drives the other. Bytes of serial ports, I²C and SPI
    /// do not pass.
    pub fn connect(&mut self, first: Pin, second: Pin) {
        self.chip.connect(first, second, self.cpu.instructions());
    }

    /// Records the changes of all pins from now on, for [`take_pin_changes`](Self::take_pin_changes).
    pub fn record_pins(&mut self) {
        self.chip.record_pins(self.cpu.instructions());
    }

    /// Takes the changes of pins since the last call, in the order of time.
    pub fn take_pin_changes(&mut self) -> Vec<PinChange> {
        self.chip.take_pin_changes()
    }

    /// The devices on the pins.
    pub fn world(&self) -> &W {
        &self.chip.world
    }

    /// The devices on the pins.
    pub fn world_mut(&mut self) -> &mut W {
        self.touched = true;
        &mut self.chip.world
    }
}
