//! The register map, pages 0 and 1 (data sheet 4.2).

use super::fusion::Output;
use std::f64::consts::PI;

pub const PAGE_ID: u8 = 0x07;
const ACC_DATA: u8 = 0x08;
const EUL_HEADING: u8 = 0x1A;
const QUA_DATA: u8 = 0x20;
const GRV_DATA: u8 = 0x2E;
const TEMP: u8 = 0x34;
const CALIB_STAT: u8 = 0x35;
const ST_RESULT: u8 = 0x36;
const SYS_STATUS: u8 = 0x39;
const UNIT_SEL: u8 = 0x3B;
pub const OPR_MODE: u8 = 0x3D;
const PWR_MODE: u8 = 0x3E;
pub const SYS_TRIGGER: u8 = 0x3F;
const TEMP_SOURCE: u8 = 0x40;
const AXIS_MAP_CONFIG: u8 = 0x41;
const RADIUS_END: u8 = 0x6A;

/// SYS_TRIGGER bit 5.
pub const RST_SYS: u8 = 1 << 5;

/// SYS_STATUS (data sheet 4.3.58).
const INITIALISING: u8 = 2;
const FUSION_RUNS: u8 = 5;
const RUNS_WITHOUT_FUSION: u8 = 6;

/// The modes that are not fusion and read the accelerometer: ACCONLY, ACCMAG, ACCGYRO, AMG (data sheet table 3-3).
const RAW_ACCELERATION: [u8; 4] = [0x01, 0x04, 0x05, 0x07];

/// Both pages.
#[derive(Debug, Clone)]
pub struct Registers {
    page: u8,
    pages: [[u8; 128]; 2],
}

impl Registers {
    /// State after power-on.
    pub fn new() -> Self {
        let mut registers = Self { page: 0, pages: [[0; 128]; 2] };
        // Chip, accelerometer, magnetometer, gyroscope; software 3.17, boot loader 21.
        registers.set(0, 0x00, &[0xA0, 0xFB, 0x32, 0x0F, 0x11, 0x03, 0x15]);
        registers.set(0, ST_RESULT, &[0x0F]);
        registers.set(0, UNIT_SEL, &[0x80]);
        registers.set(0, AXIS_MAP_CONFIG, &[0x24]);
        // The soft-iron matrix is the identity; accelerometer and magnetometer radius.
        for diagonal in [0x43, 0x4B, 0x53] {
            registers.set(0, diagonal, &[0x00, 0x40]);
        }
        registers.set(0, 0x67, &[0xE8, 0x03, 0xE0, 0x01]);
        // Sensor configurations.
        registers.set(1, 0x08, &[0x0D, 0x6D, 0x38]);
        registers
    }

    fn set(&mut self, page: usize, first: u8, values: &[u8]) {
        let first = usize::from(first);
        self.pages[page][first..first + values.len()].copy_from_slice(values);
    }

    fn set_words(&mut self, first: u8, words: &[i16]) {
        for (address, word) in (first..).step_by(2).zip(words) {
            self.set(0, address, &word.to_le_bytes());
        }
    }

    /// The page that is selected.
    pub fn page(&self) -> u8 {
        self.page
    }

    /// A register of the selected page.
    pub fn read(&self, address: u8) -> u8 {
        match address {
            PAGE_ID => self.page,
            _ => self.pages[usize::from(self.page)].get(usize::from(address)).copied().unwrap_or(0),
        }
    }

    /// Settings are writable in CONFIG mode only (data sheet 3.3); the page, and interrupts' settings, always.
    pub fn write(&mut self, address: u8, value: u8, in_config: bool) {
        let writable = match (self.page, address) {
            (_, PAGE_ID) => {
                self.page = value & 1;
                return;
            }
            (0, UNIT_SEL | PWR_MODE | TEMP_SOURCE | AXIS_MAP_CONFIG..=RADIUS_END) | (1, 0x08..=0x0D) => in_config,
            (0, SYS_TRIGGER) | (1, 0x0F..=0x1F) => true,
            _ => false,
        };
        if writable {
            self.set(self.page.into(), address, &[value]);
        }
    }

    /// Fills the data registers for a read, all from one output. Without an output they are zero, except for the acceleration
    /// of the modes without fusion.
    pub fn sample(&mut self, mode: u8, output: Option<Output>, acceleration: [i16; 3], runs: bool) {
        self.pages[0][usize::from(ACC_DATA)..=usize::from(CALIB_STAT)].fill(0);
        self.set(0, OPR_MODE, &[mode]);
        let status = match (output, runs) {
            (Some(_), _) => FUSION_RUNS,
            (None, true) if mode < 0x08 => RUNS_WITHOUT_FUSION,
            (None, true) => INITIALISING,
            (None, false) => 0,
        };
        self.set(0, SYS_STATUS, &[status]);
        if runs {
            self.set(0, TEMP, &[25]);
        }
        if RAW_ACCELERATION.contains(&mode) {
            self.set_words(ACC_DATA, &acceleration);
        }
        if let Some(output) = output {
            self.set_output(mode, output);
        }
    }

    /// Sets the registers of the fusion's output. The arm moves slowly: acceleration is gravity. UNIT_SEL selects the unit of
    /// angles.
    fn set_output(&mut self, mode: u8, output: Output) {
        let in_radians = self.pages[0][usize::from(UNIT_SEL)] & (1 << 2) != 0;
        let steps_per_rad = if in_radians { 900.0 } else { 16.0 * 180.0 / PI };
        self.set_words(ACC_DATA, &output.gravity);
        self.set_words(EUL_HEADING, &output.euler_rad.map(|angle| (angle * steps_per_rad).floor() as i16));
        self.set_words(QUA_DATA, &output.quaternion);
        self.set_words(GRV_DATA, &output.gravity);
        // Gyroscope and accelerometer are calibrated; in NDOF modes magnetometer and system as well.
        self.set(0, CALIB_STAT, &[if mode >= 0x0B { 0xFF } else { 0x3C }]);
    }
}
