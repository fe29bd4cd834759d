//! The tick: reads the scan, sets the pressures, feeds the watchdog, and starts the other tasks.

use atsam3x8e_hal::adc::Adc;
use atsam3x8e_hal::backup::Backup;
use atsam3x8e_hal::pwm::Pwm;
use atsam3x8e_hal::tc::{Mono, Trigger};
use atsam3x8e_hal::watchdog::Watchdog;
use board_core::{Actuator, BootCounter, DeadlineMissed, Scan, Task};
use board_table::{ANALOG_PINS, MAX_REGULATORS, REGULATOR_PINS, RegulatorWiring, Wiring};
use heapless::Vec;
use rtic::Mutex;
use rtic_sync::signal::SignalWriter;
use telemetry::{TICK_US, vector};

use crate::retained;
use crate::supervision::SUPERVISOR;

/// Input of the other tasks in one tick.
#[derive(Clone, Copy)]
pub struct Tick {
    /// Number of the tick since boot.
    pub number: u32,
    /// Time of the ADC's trigger, µs.
    pub time_us: u64,
    /// Counts of A0 to A11; `None`: the scan is incomplete.
    pub scan: Option<Scan>,
}

/// State of the tick.
pub struct Ticker {
    pub trigger: Trigger,
    /// Time of the trigger's first edge, µs.
    pub start_us: u64,
    pub adc: Adc<{ ANALOG_PINS as usize }>,
    pub regulators: Pwm<MAX_REGULATORS>,
    /// Output of each of the arm's regulators.
    pub outputs: Vec<usize, MAX_REGULATORS>,
    pub watchdog: Watchdog,
    pub backup: Backup,
    pub boots: BootCounter,
    /// The tasks that run after each tick.
    pub subscribers: [SignalWriter<'static, Tick>; 2],
    /// A task missed its deadline: the watchdog is not fed again.
    pub missed_deadline: Option<DeadlineMissed>,
}

impl Ticker {
    /// Runs one tick.
    pub fn run(&mut self, mut actuator: impl Mutex<T = Actuator>) {
        if !self.trigger.on_interrupt() {
            return;
        }
        let now_us = Mono::now_us();
        // By the clock and not by counting: a tick that was missed leaves a gap and shifts nothing.
        let number = (now_us.saturating_sub(self.start_us) / TICK_US) as u32;
        let time_us = self.start_us + u64::from(number) * TICK_US;
        let scan = self.adc.take_scan().ok().map(in_order);

        let period = self.regulators.period();
        let duties = actuator.lock(|actuator| {
            actuator.advance(now_us);
            actuator.duties(period)
        });
        // The only error is a duty over the period, which `duties` does not give.
        let _ = self.regulators.set_duties(self.by_output(&duties));

        for subscriber in &mut self.subscribers {
            subscriber.write(Tick { number, time_us, scan });
        }
        retained::write_uptime(&mut self.backup, self.boots.uptime(number));
        SUPERVISOR.report(Task::Tick, number);
        self.supervise(number);
    }

    /// The regulators' duties in the order of the outputs, of which the others stay at zero.
    fn by_output(&self, duties: &[u16]) -> [u16; MAX_REGULATORS] {
        let mut by_output = [0; MAX_REGULATORS];
        for (duty, output) in duties.iter().zip(&self.outputs) {
            if let Some(of_output) = by_output.get_mut(*output) {
                *of_output = *duty;
            }
        }
        by_output
    }

    fn supervise(&mut self, tick: u32) {
        if self.missed_deadline.is_some() {
            return;
        }
        match SUPERVISOR.check(tick) {
            Ok(()) => self.watchdog.feed(),
            Err(missed) => {
                let DeadlineMissed(task) = missed;
                defmt::error!("task {} is late", defmt::Debug2Format(&task));
                atsam3x8e_hal::crash::record(format_args!("{missed}"));
                self.missed_deadline = Some(missed);
            }
        }
    }
}

/// Sorts a scan, which is in the order of the channels, in the order of the pins: A0 to A7 are channels 7 to 0, A8 to A11 are 10
/// to 13.
fn in_order([a7, a6, a5, a4, a3, a2, a1, a0, a8, a9, a10, a11]: Scan) -> Scan {
    [a0, a1, a2, a3, a4, a5, a6, a7, a8, a9, a10, a11]
}

/// Places of the arm's regulators among the outputs, which are in the order of [`REGULATOR_PINS`].
pub fn regulator_outputs(wiring: &Wiring) -> Vec<usize, MAX_REGULATORS> {
    let place = |regulator: &RegulatorWiring| REGULATOR_PINS.iter().position(|pin| *pin == regulator.pin);
    // The wiring was checked when it was read: each pin is there.
    vector(wiring.regulators.iter().filter_map(place))
}
