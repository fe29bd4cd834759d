//! Jitter of the instant at which the bend sensors are sampled.

use board_tests::{UART, machine};
use rig_twin::Scenario;
use virtual_due::model::{I2c, Pin, Reception, World};
use virtual_due::{CYCLES_PER_SECOND, Cycles, WiredRig};

/// The ADC channel under observation: that of A7, the first of a scan.
const CHANNEL: u8 = 0;

/// A rig that records the times at which the channel is converted.
struct Watched {
    rig: WiredRig,
    conversions: Vec<Cycles>,
}

/// Largest minus smallest time between two scans in 20 s, cycles. The first scan is left out: before it the ADC starts up,
/// once (datasheet 43.7.2, ADC_MR.STARTUP).
///
/// # Panics
/// If the firmware does not sample.
pub fn cycles() -> f64 {
    let world = Watched { rig: WiredRig::new(Scenario::FreeSwing, 1), conversions: Vec::new() };
    let mut machine = machine(world);
    for second in 0..20 {
        // Noise on the line, so that the processor's work is not the same every time.
        let now = machine.now();
        machine.world_mut().rig.send(UART, &[second; 400], now);
        machine.run_for(CYCLES_PER_SECOND);
    }
    let conversions = &machine.world().conversions;
    assert!(conversions.len() > 1_900, "the firmware samples at 100 Hz");
    let periods = || conversions.windows(2).skip(1).map(|pair| pair[1] - pair[0]);
    let range = periods().max().unwrap_or_default() - periods().min().unwrap_or_default();
    range as f64
}

impl World for Watched {
    fn adc_counts(&mut self, channel: u8, now: Cycles) -> u16 {
        if channel == CHANNEL {
            self.conversions.push(now);
        }
        self.rig.adc_counts(channel, now)
    }

    fn i2c(&mut self, twi: usize) -> &mut dyn I2c {
        self.rig.i2c(twi)
    }

    fn pwm(&mut self, channel: u8, duty: Option<(u32, u32)>, now: Cycles) {
        self.rig.pwm(channel, duty, now);
    }

    fn drive(&mut self, pin: Pin, level: Option<bool>, now: Cycles) {
        self.rig.drive(pin, level, now);
    }

    fn level(&mut self, pin: Pin, now: Cycles) -> Option<bool> {
        self.rig.level(pin, now)
    }

    fn transmitted(&mut self, port: usize, byte: u8, now: Cycles) {
        self.rig.transmitted(port, byte, now);
    }

    fn receive(&mut self, port: usize, byte_time: Cycles, now: Cycles) -> Reception {
        self.rig.receive(port, byte_time, now)
    }
}
