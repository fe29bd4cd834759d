//! The chip's peripherals, with their addresses and interrupt lines (datasheet 9.1 and 7).

use crate::memory_map::Memories;
use sam3x_models::flash::{BANK, FLASH};
use sam3x_models::model::Peripheral;
use sam3x_models::{
    Adc, ChipId, Dacc, Dmac, Eefc, Gpbr, Matrix, Pio, Pmc, Pwm, Rstc, Rtc, Rtt, Spi, Supc, Tc, Trng, Twi, Uart,
    Unmodelled, Uotghs, Usart, Wdt,
};

/// A peripheral at its address.
pub struct Slot {
    pub name: &'static str,
    /// Address of its first register.
    pub base: u32,
    bytes: u32,
    /// Its interrupt line, which is its identifier too; the first of several.
    pub line: u16,
    /// Identifiers, a bit each, of which at least one has to be enabled in the PMC for it to run; 0: it always runs.
    gate: u64,
    pub model: Box<dyn Peripheral>,
}

impl Slot {
    /// True if it runs with these clocks enabled.
    pub fn clock_runs(&self, clocks: u64) -> bool {
        self.gate == 0 || self.gate & clocks != 0
    }

    /// True if a clock of the system controller's part changes that it needs for a part of its work: a PIO controller.
    pub fn sees_clock_change(&self, before: u64, clocks: u64) -> bool {
        self.gate == 0 && (before ^ clocks) >> self.line & 1 != 0
    }
}

/// A peripheral of the APB bridge, which runs only with its clock on.
fn clocked(name: &'static str, base: u32, line: u16, model: impl Peripheral + 'static) -> Slot {
    Slot { name, base, bytes: 0x4000, line, gate: 1 << line, model: Box::new(model) }
}

/// A peripheral of the system controller, which always runs.
fn system(name: &'static str, base: u32, bytes: u32, line: u16, model: impl Peripheral + 'static) -> Slot {
    Slot { name, base, bytes, line, gate: 0, model: Box::new(model) }
}

/// A block of three timer channels, each with an identifier of its own; it runs if one of them is on.
fn timer(name: &'static str, base: u32, line: u16, block: usize) -> Slot {
    Slot { gate: 0b111 << line, ..clocked(name, base, line, Tc::new(block)) }
}

/// All of them.
pub fn all(memories: &Memories) -> Vec<Slot> {
    let mut slots = system_controller(memories);
    slots.extend([
        clocked("HSMCI", 0x4000_0000, 21, Unmodelled::new("HSMCI")),
        // SSC_SR: TXRDY and TXEMPTY.
        clocked("SSC", 0x4000_4000, 26, Unmodelled::ready("SSC", 0x40, 0b11)),
        clocked("SPI0", 0x4000_8000, 24, Spi::new("SPI0")),
        clocked("SPI1", 0x4000_C000, 25, Spi::new("SPI1")),
        timer("TC0", 0x4008_0000, 27, 0),
        timer("TC1", 0x4008_4000, 30, 1),
        timer("TC2", 0x4008_8000, 33, 2),
        clocked("TWI0", 0x4008_C000, 22, Twi::new(0)),
        clocked("TWI1", 0x4009_0000, 23, Twi::new(1)),
        clocked("PWM", 0x4009_4000, 36, Pwm::new()),
        clocked("USART0", 0x4009_8000, 17, Usart::new(1)),
        clocked("USART1", 0x4009_C000, 18, Usart::new(2)),
        clocked("USART2", 0x400A_0000, 19, Usart::new(3)),
        clocked("USART3", 0x400A_4000, 20, Usart::new(4)),
        clocked("UOTGHS", 0x400A_C000, 40, Uotghs::new()),
        clocked("EMAC", 0x400B_0000, 42, Unmodelled::new("EMAC")),
        clocked("CAN0", 0x400B_4000, 43, Unmodelled::new("CAN0")),
        clocked("CAN1", 0x400B_8000, 44, Unmodelled::new("CAN1")),
        clocked("TRNG", 0x400B_C000, 41, Trng::new()),
        clocked("ADC", 0x400C_0000, 37, Adc::new()),
        clocked("DMAC", 0x400C_4000, 39, Dmac::new()),
        clocked("DACC", 0x400C_8000, 38, Dacc::new()),
    ]);
    slots
}

fn system_controller(memories: &Memories) -> Vec<Slot> {
    let eefc = |bank: usize| Eefc::new(bank, memories.flash[bank].clone(), FLASH + bank as u32 * BANK);
    let mut slots = vec![
        system("SMC", 0x400E_0000, 0x200, 9, Unmodelled::new("SMC")),
        system("SDRAMC", 0x400E_0200, 0x200, 10, Unmodelled::new("SDRAMC")),
        system("MATRIX", 0x400E_0400, 0x200, 0, Matrix::new()),
        system("PMC", 0x400E_0600, 0x200, 5, Pmc::new()),
        Slot { gate: 1 << 8, ..system("UART", 0x400E_0800, 0x140, 8, Uart::new(0)) },
        system("CHIPID", 0x400E_0940, 0xC0, 0, ChipId),
        system("EEFC0", 0x400E_0A00, 0x200, 6, eefc(0)),
        system("EEFC1", 0x400E_0C00, 0x200, 7, eefc(1)),
        system("RSTC", 0x400E_1A00, 0x10, 1, Rstc::new()),
        system("SUPC", 0x400E_1A10, 0x20, 0, Supc::new()),
        system("RTT", 0x400E_1A30, 0x20, 3, Rtt::new()),
        system("WDT", 0x400E_1A50, 0x10, 4, Wdt::new()),
        system("RTC", 0x400E_1A60, 0x30, 2, Rtc::new()),
        system("GPBR", 0x400E_1A90, 0x20, 0, Gpbr::new()),
    ];
    for (port, name) in ["PIOA", "PIOB", "PIOC", "PIOD"].into_iter().enumerate() {
        let port = port as u16;
        slots.push(system(name, 0x400E_0E00 + 0x200 * u32::from(port), 0x200, 11 + port, Pio::new(port as u8)));
    }
    slots
}

const NONE: u8 = u8::MAX;
const BRIDGE: u32 = 0x4000_0000;
const BRIDGE_STEP: u32 = 0x4000;
const SYSTEM: u32 = 0x400E_0000;
const SYSTEM_STEP: u32 = 0x10;

/// Lookup of the peripheral at an address.
pub struct Directory {
    bridge: [u8; 0x33],
    system: [u8; 0x200],
    /// ADC and DACC, which timers and the PWM trigger.
    pub triggered: [usize; 2],
    /// The two flash controllers.
    pub eefc: [usize; 2],
    /// PIOA to PIOD.
    pub pio: [usize; 4],
    /// The peripherals that sample pins: these, and the timers.
    pub samplers: [usize; 7],
}

impl Directory {
    /// The directory of these peripherals.
    pub fn new(slots: &[Slot]) -> Self {
        let named = |name: &str| slots.iter().position(|slot| slot.name == name).expect("every chip has one");
        let mut directory = Self {
            bridge: [NONE; 0x33],
            system: [NONE; 0x200],
            triggered: ["ADC", "DACC"].map(named),
            eefc: [named("EEFC0"), named("EEFC1")],
            pio: ["PIOA", "PIOB", "PIOC", "PIOD"].map(named),
            samplers: ["PIOA", "PIOB", "PIOC", "PIOD", "TC0", "TC1", "TC2"].map(named),
        };
        for (index, slot) in slots.iter().enumerate() {
            let (table, start, step): (&mut [u8], u32, u32) = if slot.base < SYSTEM {
                (&mut directory.bridge, BRIDGE, BRIDGE_STEP)
            } else {
                (&mut directory.system, SYSTEM, SYSTEM_STEP)
            };
            let first = ((slot.base - start) / step) as usize;
            table[first..first + (slot.bytes / step) as usize].fill(index as u8);
        }
        directory
    }

    /// The peripheral at `address`.
    pub fn find(&self, address: u32) -> Option<usize> {
        let entry = if address < SYSTEM {
            self.bridge.get((address.checked_sub(BRIDGE)? / BRIDGE_STEP) as usize)
        } else {
            self.system.get(((address - SYSTEM) / SYSTEM_STEP) as usize)
        };
        entry.filter(|index| **index != NONE).map(|index| usize::from(*index))
    }
}
