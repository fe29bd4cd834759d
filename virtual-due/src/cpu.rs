//! The interface between the board and a CPU engine.

/// A Cortex-M3 that runs the firmware's instructions.
///
/// Instants are cycles of the core's own clock, as its SysTick counts them.
pub trait Cpu {
    /// Runs at most `budget` instructions, and as many more as [`Bus::carry_on`] grants.
    fn run(&mut self, budget: u32, bus: &mut dyn Bus) -> Stop;

    /// Instructions retired since the CPU was made, resets or not.
    fn instructions(&self) -> u64;

    /// Address of the next instruction.
    fn pc(&self) -> u32;

    /// True if it sleeps until an interrupt or event.
    fn waiting(&self) -> bool;

    /// Drives an interrupt line.
    fn set_line(&mut self, line: u16, high: bool);

    /// Time at which its own timer next needs [`on_event`](Self::on_event).
    fn next_event(&self) -> Option<u64>;

    /// Handles the event of its own timer that is due.
    fn on_event(&mut self, core_cycles: u64);

    /// Puts it into the state after reset and loads stack pointer and entry from the vector table at address 0.
    fn reset(&mut self, stack_pointer: u32, entry: u32);

    /// True if the firmware wrote AIRCR.SYSRESETREQ since the last call.
    fn take_reset_request(&mut self) -> bool;

    /// Drops translations of `length` bytes from `start`, which have changed.
    fn changed(&mut self, start: u32, length: u32);

    /// Sets a breakpoint, which stops with [`Stop::Breakpoint`] before the instruction at `address`; false if that is not
    /// possible.
    fn add_breakpoint(&mut self, address: u32) -> bool;

    /// Removes a breakpoint.
    fn remove_breakpoint(&mut self, address: u32);

    /// Lets the next run pass the breakpoint at `address`.
    fn pass_breakpoint(&mut self, address: u32);

    /// The register that GDB numbers `number`: r0 to r15, xPSR, and the system registers of [`debugger_description`].
    ///
    /// [`debugger_description`]: Self::debugger_description
    fn register(&self, number: usize) -> Option<u32>;

    /// Writes the register that GDB numbers `number`; false for an unknown number.
    fn set_register(&mut self, number: usize, value: u32) -> bool;

    /// GDB's description of the registers.
    fn debugger_description(&self) -> &'static str;

    /// Reads a word of its own registers, 0xE000_0000…, as a debugger does.
    fn peek(&mut self, address: u32, core_cycles: u64) -> Option<u32>;

    /// Writes a word of its own registers as a debugger does; false if there is no register.
    fn poke(&mut self, address: u32, value: u32, core_cycles: u64) -> bool;
}

/// Reason why a CPU stopped.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stop {
    /// The budget is spent, or the bus requested the return.
    Returned,
    /// It sleeps.
    Waiting,
    /// A breakpoint is next.
    Breakpoint,
    /// It locked up: a fault in the handler of a fault.
    Lockup,
}

/// A load or store outside mapped memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Access {
    /// Address of the first byte.
    pub address: u32,
    /// Width: 1, 2 or 4 bytes, aligned.
    pub bytes: u8,
    /// The value of a store.
    pub store: Option<u32>,
    /// Address of the instruction.
    pub pc: u32,
    /// Instructions retired, this one included.
    pub instructions: u64,
}

/// The board as the CPU sees it while it runs.
pub trait Bus {
    /// Answers an access; `None` is a bus fault.
    fn access(&mut self, access: Access) -> Option<u32>;

    /// Core cycles with `instructions` retired.
    fn core_cycles(&self, instructions: u64) -> u64;

    /// Takes a change of an interrupt line: number and level.
    fn take_line(&mut self) -> Option<(u16, bool)>;

    /// Takes a piece of memory that was changed by others than the CPU: start and length.
    fn take_changed(&mut self) -> Option<(u32, u32)>;

    /// Number of instructions that may run after an access before the board has to be called, with the CPU's own next event
    /// at `event`; `None`: it must return now.
    fn carry_on(&mut self, instructions: u64, event: Option<u64>) -> Option<u32>;
}
