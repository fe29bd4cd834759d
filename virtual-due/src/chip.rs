//! The chip around the CPU: bus, time and interrupt lines of the peripherals.

use crate::clock::Clock;
use crate::cpu::{Access, Bus};
use crate::dwt::Dwt;
use crate::engine::DWT;
use crate::memory_map::Memories;
use crate::peripheral_map::{Directory, Slot};
use crate::pins::{Pins, WiredWorld};
use sam3x_models::WarningLog;
use sam3x_models::flash::{BANK, FLASH};
use sam3x_models::model::{Cause, Context, Cycles, Peripheral, Signal, World};

pub const NEVER: Cycles = Cycles::MAX;
/// Offset of PIO_PDSR, the levels of the pins.
const PDSR: u32 = 0x3C;

/// All of the chip but its CPU, and the world on its pins.
pub struct Chip<W> {
    pub clock: Clock,
    pub memories: Memories,
    pub world: W,
    pub warnings: WarningLog,
    /// Cause of a requested reset.
    pub reset: Option<Cause>,
    /// True if the next reset boots from flash.
    pub boots_from_flash: bool,
    /// Time by which the CPU returns.
    pub limit: Cycles,
    /// Wires between pins, and a record of their changes.
    pub pins: Pins,
    /// The next change of a watched output.
    pub next_edge: Cycles,
    pub(crate) directory: Directory,
    pub(crate) slots: Vec<Slot>,
    // For each slot, the time of its next event, and its interrupt lines.
    due: Vec<Cycles>,
    lines: Vec<u32>,
    earliest: Cycles,
    // The latest time at which a model was called.
    pub(crate) now: Cycles,
    changed_lines: Vec<(u16, bool)>,
    signals: Vec<Signal>,
    master_clock_hz: u32,
    pub(crate) clocks: u64,
    /// Lines of each PIO controller that belong to peripherals A and B.
    pub(crate) given: [(u32, u32); 4],
    dwt: Dwt,
}

impl<W: World> Chip<W> {
    /// The chip with this world, before its first reset.
    pub fn new(world: W) -> Self {
        let memories = Memories::new();
        let slots = crate::peripheral_map::all(&memories);
        let master_clock_hz = 4_000_000;
        Self {
            clock: Clock::new(master_clock_hz),
            memories,
            world,
            warnings: WarningLog::default(),
            reset: None,
            boots_from_flash: true,
            limit: 0,
            pins: Pins::default(),
            next_edge: NEVER,
            directory: Directory::new(&slots),
            due: vec![NEVER; slots.len()],
            lines: vec![0; slots.len()],
            slots,
            earliest: NEVER,
            now: 0,
            changed_lines: Vec::new(),
            signals: Vec::new(),
            master_clock_hz,
            clocks: 0,
            given: [(0, 0); 4],
            dwt: Dwt::default(),
        }
    }

    /// Brings all models into the state after a reset, with `instructions` retired.
    pub fn apply_reset(&mut self, cause: Cause, instructions: u64) {
        self.now = self.now.max(self.clock.now(instructions));
        self.reset = None;
        self.dwt = Dwt::default();
        for index in 0..self.slots.len() {
            self.slots[index].model.reset();
            self.call(index, |model, context| model.signal(Signal::Reset(cause), context));
        }
        self.dispatch_signals(instructions);
        // The CPU's lines are low after its reset.
        self.changed_lines.clear();
        for index in 0..self.slots.len() {
            self.lines[index] = 0;
            self.refresh(index);
        }
        self.follow_outputs(instructions);
    }

    /// Time of the next event of any model.
    pub fn next_event(&self) -> Cycles {
        self.earliest.min(self.next_edge)
    }

    /// Advances the models to `now`, each event at its own time.
    pub fn catch_up(&mut self, now: Cycles, instructions: u64) {
        while self.next_event() <= now {
            if self.next_edge <= self.earliest {
                self.now = self.now.max(self.next_edge);
                self.follow_outputs(instructions);
                continue;
            }
            let (index, due) =
                self.due.iter().copied().enumerate().min_by_key(|(_, due)| *due).expect("there are peripherals");
            self.now = self.now.max(due);
            self.show_outputs(index);
            self.call(index, |model, context| model.advance(context));
            self.dispatch_signals(instructions);
            self.refresh(index);
            if self.due[index] <= due {
                let name = self.slots[index].name;
                self.warnings
                    .warn_once(format!("the model of {name} is late for its own event: a defect of this emulator"));
                self.due[index] = self.now + 1;
                self.find_earliest();
            }
            self.follow_outputs(instructions);
        }
        self.now = self.now.max(now);
    }

    /// Calls a model with its context.
    pub(crate) fn call<R>(&mut self, index: usize, run: impl FnOnce(&mut dyn Peripheral, &mut Context) -> R) -> R {
        self.warnings.now = self.now;
        let mut wired = WiredWorld { world: &mut self.world, pins: &mut self.pins };
        let mut context = Context {
            now: self.now,
            master_clock_hz: self.master_clock_hz,
            memory: &mut self.memories,
            world: &mut wired,
            warnings: &mut self.warnings,
            signals: &mut self.signals,
        };
        run(&mut *self.slots[index].model, &mut context)
    }

    /// Updates a model's lines and next event after it was called.
    pub(crate) fn refresh(&mut self, index: usize) {
        let slot = &self.slots[index];
        let lines = slot.model.interrupts();
        let mut changes = lines ^ self.lines[index];
        while changes != 0 {
            let bit = changes.trailing_zeros();
            self.changed_lines.push((slot.line + bit as u16, lines >> bit & 1 != 0));
            changes &= changes - 1;
        }
        self.lines[index] = lines;
        let due = if slot.clock_runs(self.clocks) { slot.model.next_event().unwrap_or(NEVER) } else { NEVER };
        let before = std::mem::replace(&mut self.due[index], due);
        if due <= self.earliest {
            self.earliest = due;
        } else if before == self.earliest {
            self.find_earliest();
        }
    }

    fn find_earliest(&mut self) {
        self.earliest = self.due.iter().copied().min().unwrap_or(NEVER);
    }

    /// Dispatches the signals of the models.
    pub(crate) fn dispatch_signals(&mut self, instructions: u64) {
        while !self.signals.is_empty() {
            for signal in std::mem::take(&mut self.signals) {
                self.dispatch(signal, instructions);
            }
        }
    }

    fn dispatch(&mut self, signal: Signal, instructions: u64) {
        match signal {
            Signal::Tioa(_) | Signal::PwmEvent(_) => {
                for index in self.directory.triggered {
                    self.send_signal(index, signal);
                }
            }
            Signal::Flash(address, length) => self.memories.changed.push((address, length)),
            Signal::BootFlash(flash) => self.boots_from_flash = flash,
            Signal::Reset(cause) => self.reset = Some(cause),
            Signal::Pins { port, a, b } => {
                self.given[usize::from(port)] = (a, b);
                self.send_to_all(signal);
            }
            Signal::SlowCrystal(_) => self.send_to_all(signal),
            // The chip itself sends these.
            Signal::Outputs { .. } | Signal::WiresMoved => {}
            Signal::PeripheralClocks(clocks) => {
                let switched = |slot: &Slot| slot.clock_runs(self.clocks) != slot.clock_runs(clocks);
                let switched: Vec<usize> =
                    (0..self.slots.len()).filter(|index| switched(&self.slots[*index])).collect();
                for &index in &switched {
                    if self.slots[index].clock_runs(self.clocks) {
                        self.call(index, |model, context| model.advance(context));
                    }
                }
                let before = std::mem::replace(&mut self.clocks, clocks);
                for index in switched {
                    self.refresh(index);
                }
                for index in 0..self.slots.len() {
                    if self.slots[index].sees_clock_change(before, clocks) {
                        self.show_outputs(index);
                        self.send_signal(index, signal);
                    }
                }
            }
            Signal::MasterClock(hz) => {
                for index in 0..self.slots.len() {
                    if self.slots[index].clock_runs(self.clocks) {
                        self.call(index, |model, context| model.advance(context));
                    }
                }
                self.master_clock_hz = hz;
                self.clock.set_hz(instructions, hz);
                self.send_to_all(signal);
            }
        }
    }

    fn send_to_all(&mut self, signal: Signal) {
        (0..self.slots.len()).for_each(|index| self.send_signal(index, signal));
    }

    /// Sends a signal to a model.
    pub(crate) fn send_signal(&mut self, index: usize, signal: Signal) {
        let runs = self.slots[index].clock_runs(self.clocks);
        self.call(index, |model, context| {
            if runs {
                model.advance(context);
            }
            model.signal(signal, context);
        });
        self.refresh(index);
    }

    /// Advances all models to now, so that the world may be read or changed from outside.
    pub fn advance_all(&mut self, instructions: u64) {
        for index in 0..self.slots.len() {
            if self.slots[index].clock_runs(self.clocks) {
                self.call(index, |model, context| model.advance(context));
                self.dispatch_signals(instructions);
                self.refresh(index);
            }
        }
    }

    /// Accesses a register. APB registers are 32 bits wide: a byte or halfword is a lane of one (datasheet 9.3).
    fn register(&mut self, index: usize, access: Access) -> u32 {
        let slot = &self.slots[index];
        let runs = slot.clock_runs(self.clocks);
        let offset = (access.address - slot.base) & !3;
        let shift = 8 * (access.address & 3);
        let answer = match access.store {
            Some(_) if !runs => {
                self.warnings.warn_once(format!("{} written while its clock is off", slot.name));
                return 0;
            }
            Some(value) => {
                self.check_programming(index, offset, access);
                self.call(index, |model, context| {
                    model.advance(context);
                    model.write(offset, value << shift, context);
                });
                value
            }
            None => {
                if offset == PDSR {
                    self.show_outputs(index);
                }
                self.call(index, |model, context| {
                    if runs {
                        model.advance(context);
                    }
                    model.read(offset, context) >> shift
                })
            }
        };
        self.dispatch_signals(access.instructions);
        self.refresh(index);
        if access.store.is_some() {
            self.follow_outputs(access.instructions);
        }
        answer
    }

    /// Warns if the program runs from the bank that it programs, which cannot be read meanwhile (datasheet 18.4.1).
    fn check_programming(&mut self, index: usize, offset: u32, access: Access) {
        const FCR: u32 = 4;
        const PROGRAMS: u32 = 0b0101_1011_0011_1110;
        let Some(bank) = self.directory.eefc.iter().position(|eefc| *eefc == index) else { return };
        let programs = access.store.is_some_and(|value| PROGRAMS.checked_shr(value & 0xFF).unwrap_or(0) & 1 != 0);
        let start = FLASH + bank as u32 * BANK;
        if offset == FCR && programs && (start..start + BANK).contains(&access.pc) {
            let name = self.slots[index].name;
            self.warnings
                .warn_once(format!("{name}: the program erases or writes the bank it runs from: a real chip hangs"));
        }
    }

    /// Passes a store to flash to the latch buffer of its bank.
    fn latch(&mut self, access: Access) -> Option<u32> {
        let value = access.store?;
        let address = if access.address < FLASH { access.address + FLASH } else { access.address };
        let bank = usize::from(address >= FLASH + BANK);
        self.call(self.directory.eefc[bank], |model, context| model.write(address, value, context));
        Some(value)
    }

    /// Accesses a word of a peripheral's registers between instructions; `None` at an address without one.
    pub fn debugger_access(&mut self, address: u32, store: Option<u32>, pc: u32, instructions: u64) -> Option<u32> {
        let index = self.directory.find(address).filter(|_| address.is_multiple_of(4))?;
        self.catch_up(self.clock.now(instructions), instructions);
        Some(self.register(index, Access { address, bytes: 4, store, pc, instructions }))
    }

    fn answer(&mut self, access: Access) -> Option<u32> {
        let address = access.address;
        if DWT.contains(&address) {
            let core_cycles = self.clock.core_cycles(access.instructions);
            return Some(self.dwt.access(address - DWT.start, access.store, core_cycles));
        }
        if let Some(index) = self.directory.find(address) {
            return Some(self.register(index, access));
        }
        if address < FLASH + 2 * BANK { self.latch(access) } else { None }
    }
}

impl<W: World> Bus for Chip<W> {
    fn access(&mut self, access: Access) -> Option<u32> {
        self.catch_up(self.clock.now(access.instructions), access.instructions);
        self.warnings.now = self.now;
        self.warnings.pc = Some(access.pc);
        let answer = self.answer(access);
        if answer.is_none() {
            let address = access.address;
            let kind = if access.store.is_some() { "store to" } else { "load from" };
            self.warnings.warn_once(format!("bus fault: {kind} {address:#010x}, where nothing is mapped"));
        }
        self.warnings.pc = None;
        answer
    }

    fn core_cycles(&self, instructions: u64) -> u64 {
        self.clock.core_cycles(instructions)
    }

    fn take_line(&mut self) -> Option<(u16, bool)> {
        (!self.changed_lines.is_empty()).then(|| self.changed_lines.remove(0))
    }

    fn take_changed(&mut self) -> Option<(u32, u32)> {
        self.memories.changed.pop()
    }

    fn carry_on(&mut self, instructions: u64, event: Option<u64>) -> Option<u32> {
        if self.reset.is_some() {
            return None;
        }
        let event = event.map_or(NEVER, |event| self.clock.at_core_cycles(event));
        let next = self.next_event().min(self.limit).min(event);
        let left = self.clock.instructions_until(instructions, next);
        (left > 0).then(|| u32::try_from(left).unwrap_or(u32::MAX))
    }
}
