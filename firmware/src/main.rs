//! The arm's firmware for the Arduino Due.
//!
//! A timer triggers the ADC 100 times a second, by hardware and without jitter. 200 µs later, when the scan of the twelve
//! bend sensors is in memory, its interrupt is the tick: everything else follows from there.
//!
//! | task | priority | period | bound, µs | longest measured, µs | what |
//! |---|---|---|---|---|---|
//! | `twi1` | 4 | a byte on the I²C bus | 5 | 1.5 | wakes the bus |
//! | `time` | 4 | a timer's alarm | 5 | 2.4 | wakes who waited |
//! | `tick` | 3 | 10 ms | 100 | 53 | scan, pressures, watchdog |
//! | `requests` | 2 | 10 ms | 1000 | 385 | what the host asks |
//! | `shape` | 1 | 10 ms | 6000 | 4471 | IMUs (4 ms at most), estimator, messages |
//! | `idle` | 0 | | | | sleeps |
//!
//! From a task's interrupt to its end, with what preempts it, and for `shape` from the tick. `cargo xtask bench` measures it
//! on the emulated board, in a run with faults and floods of requests, and holds it against the bounds.
//!
//! The watchdog is fed in `tick`, and only while all tasks report in time. Every panic and fault vents the arm first.
#![no_std]
#![no_main]

mod board;
mod identity;
mod imu_bus;
mod kept;
mod load;
mod panic;
mod parameters;
mod requests;
mod shape;
mod table;
mod tick;
mod voice;

use board_core::Supervisor;
use defmt_rtt as _;

/// Whether every task still reports in time.
static SUPERVISOR: Supervisor = Supervisor::new();

defmt::timestamp!("{=u64:us}", atsam3x8e_hal::tc::Mono::now_us());

/// The tasks and what they share; what they do is in the module of the same name.
#[rtic::app(device = atsam3x8e_hal::pac, dispatchers = [SSC, HSMCI])]
mod app {
    use core::mem::MaybeUninit;

    use atsam3x8e_hal::pac::TWI1;
    use atsam3x8e_hal::tc::{Mono, prelude::*};
    use atsam3x8e_hal::{reset, twi};
    use board_core::{Actuator, Arm, Schedule};
    use rtic_sync::signal::{Signal, SignalReader};

    use crate::board::{self, Buffers};
    use crate::load;
    use crate::parameters::LIMITS_PA;
    use crate::requests::{Control, Requests};
    use crate::shape::Shape;
    use crate::table::TABLE;
    use crate::tick::{Tick, Ticker};
    use crate::voice::Voice;

    #[shared]
    struct Shared {
        actuator: Actuator,
        control: Control,
        voice: Voice,
    }

    #[local]
    struct Local {
        ticker: Ticker,
        requests: Requests,
        requests_ticks: SignalReader<'static, Tick>,
        shape: Shape,
        shape_ticks: SignalReader<'static, Tick>,
    }

    #[init(local = [
        buffers: Buffers = Buffers::new(),
        for_requests: Signal<Tick> = Signal::new(),
        for_shape: Signal<Tick> = Signal::new(),
        arm: MaybeUninit<Arm> = MaybeUninit::uninit(),
    ])]
    fn init(cx: init::Context) -> (Shared, Local) {
        let board = match board::set_up(cx.device, cx.local.buffers) {
            Ok(board) => board,
            Err(error) => panic!("the board does not come up: {error}"),
        };
        defmt::info!("boot {} of {}", board.boots.number(), board.hello.firmware.as_str());
        let (to_requests, requests_ticks) = cx.local.for_requests.split();
        let (to_shape, shape_ticks) = cx.local.for_shape.split();
        let safe_mode = board.boots.safe_mode();
        let ticker = Ticker {
            trigger: board.trigger,
            start_us: board.start_us,
            adc: board.adc,
            regulators: board.regulators,
            watchdog: board.watchdog,
            backup: board.backup,
            boots: board.boots,
            followers: [to_requests, to_shape],
            late: None,
        };
        let shape = Shape::new(board.imus, cx.local.arm.write(Arm::new(&TABLE)), board.hello, safe_mode);
        // They wait for their first tick, and then for ever; there is room for each once.
        let _ = requests::spawn();
        let _ = shape::spawn();
        let control = Control { schedule: Schedule::default(), tare: false, hello: false, damaged_frames: 0 };
        (
            Shared { actuator: Actuator::new(LIMITS_PA), control, voice: Voice::new(board.tx) },
            Local { ticker, requests: Requests::new(board.rx), requests_ticks, shape, shape_ticks },
        )
    }

    /// Sleeps while there is nothing to do.
    #[idle]
    fn idle(_: idle::Context) -> ! {
        loop {
            load::sleep();
        }
    }

    /// The tick, 200 µs after the ADC's trigger.
    #[task(binds = TC0, priority = 3, shared = [actuator], local = [ticker])]
    fn tick(cx: tick::Context) {
        cx.local.ticker.run(cx.shared.actuator);
    }

    /// A byte on the IMUs' bus.
    #[task(binds = TWI1, priority = 4)]
    fn twi1(_: twi1::Context) {
        twi::on_interrupt::<TWI1>();
    }

    /// The timer of all waiting tasks.
    #[task(binds = TC1, priority = 4)]
    fn time(_: time::Context) {
        Mono::on_interrupt();
    }

    /// What the host asks.
    #[task(priority = 2, shared = [actuator, control, voice], local = [requests, requests_ticks])]
    async fn requests(cx: requests::Context) {
        let mut shared = cx.shared;
        loop {
            let tick = cx.local.requests_ticks.wait().await;
            let (actuator, control, voice) = (&mut shared.actuator, &mut shared.control, &mut shared.voice);
            if cx.local.requests.run(tick.number, actuator, control, voice) {
                // The answer goes out, and the arm vents meanwhile.
                Mono::delay(50u64.millis()).await;
                reset::reset();
            }
        }
    }

    /// IMUs, estimator, messages.
    #[task(priority = 1, shared = [actuator, control, voice], local = [shape, shape_ticks])]
    async fn shape(cx: shape::Context) {
        let mut shared = cx.shared;
        loop {
            let tick = cx.local.shape_ticks.wait().await;
            let (actuator, control, voice) = (&mut shared.actuator, &mut shared.control, &mut shared.voice);
            cx.local.shape.run(tick, actuator, control, voice).await;
        }
    }
}
