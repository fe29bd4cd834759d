//! An emulated Arduino Due: it runs the unmodified ELF of a firmware, with the simulated arm on its pins.
//!
//! ```text
//!  Machine ──► Cpu (engine.rs: a JIT for Cortex-M3)
//!     │            │ loads and stores outside memory
//!     ▼            ▼
//!   Chip: bus, time, interrupt lines ──► the crate `sam3x-models`, each model behind `model::Peripheral`
//!                                           │ pins, ADC, I²C, serial
//!                                           ▼
//!                                     World: rig/…, the arm with its sensors and regulators
//! ```
//!
//! Time is virtual: cycles of 84 MHz since power-on. An instruction takes 1.4 cycles of the core clock, so that a busy wait
//! of two instructions a turn, three cycles on silicon, ends 7 % early; sleep costs nothing. The models follow the datasheet
//! of the SAM3X/A (Atmel 11057C), not a particular firmware; use of parts that they leave out is reported once, with the time
//! and the place in the program. Two runs of the same firmware, world and input are identical.
//!
//! Not modelled: HSMCI, EMAC, CAN and the memory controllers read as zero; SSC is always ready, and its data are lost, as are
//! those of the DACC; nothing is on the wires of SPI; the DMAC serves no peripheral; the native USB port never has a host; flash wait states and the bus matrix cost no time; the RTC's
//! time and calendar events.

pub mod arduino_pins;
mod chip;
mod clock;
mod cpu;
mod debugger;
mod dwt;
mod elf;
mod engine;
mod faults;
mod machine;
mod memory;
mod memory_map;
mod outputs;
mod peripheral_map;
mod pins;
mod report;
pub mod rig;

pub use faults::FaultSchedule;
pub use firmware_image::ImageError;
pub use machine::{FLASH_BYTES, Machine, Reset};
pub use pins::PinChange;
pub use report::Report;
pub use rig::WiredRig;
pub use sam3x_models::model::{self, CYCLES_PER_SECOND, Cause, Cycles};
