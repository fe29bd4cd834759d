//! The arm's firmware for the Arduino Due.
//!
//! A timer triggers the ADC 100 times a second, by hardware and without jitter. 200 µs later, when the scan of the
//! twelve analog pins is in memory, its interrupt is the tick, which starts everything else.
//!
//! | task | priority | period | bound, µs | longest measured, µs | work |
//! |---|---|---|---|---|---|
//! | `twi1` | 5 | a byte on the I²C bus | 5 | 1.2 | the IMUs' bus |
//! | `time` | 5 | a timer's alarm | 5 | 2.3 | delays and deadlines |
//! | `tick` | 4 | 10 ms | 100 | 37 | scan, pressures, watchdog |
//! | `commands` | 3 | 10 ms | 1100 | 1044 | requests of the host |
//! | `estimation` | 2 | 10 ms | 6000 | 5639 | IMUs (6 ms at most), estimator, messages |
//! | `table` | 1 | a request about the table | | | pages of the flash |
//! | `idle` | 0 | | | | sleep |
//!
//! Times are those of the reference arm, from a task's interrupt to its end, preemption included, and for `estimation` from
//! the tick. `cargo xtask bench` measures them on the emulated board, in a run with faults and floods of requests, and checks
//! them against the bounds.
//!
//! The watchdog is fed in `tick`, and only while all tasks meet their deadlines. Every panic and fault vents the arm first.
#![no_std]
#![no_main]

mod board;
mod command_task;
mod cpu_load;
mod device_info;
mod downlink;
mod estimation;
mod imu_bus;
mod panic;
mod parameters;
mod retained;
mod supervision;
mod table_task;
mod tick;

use defmt_rtt as _;

defmt::timestamp!("{=u64:us}", atsam3x8e_hal::tc::Mono::now_us());

/// The tasks and their shared state; the work of each is in the module of its name.
#[rtic::app(device = atsam3x8e_hal::pac, dispatchers = [SSC, HSMCI, SPI0])]
mod app {
    use core::mem::MaybeUninit;

    use atsam3x8e_hal::pac::TWI1;
    use atsam3x8e_hal::tc::{Mono, prelude::*};
    use atsam3x8e_hal::{reset, twi};
    use board_core::imus::Imus;
    use board_core::{Actuator, BendSensorMonitor, RestMonitor, Schedule};
    use board_estimator::BoardEstimator;
    use board_table::{BoardTable, MAX_SEGMENTS, Wiring};
    use estimator_core::{ArmConfig, Q};
    use rtic_sync::channel::Receiver;
    use rtic_sync::make_channel;
    use rtic_sync::signal::{Signal, SignalReader};
    use telemetry::{Counts, Request, TableStatus};

    use crate::board::{self, Buffers};
    use crate::command_task::{CommandTask, Control, Pose, TABLE_REQUESTS};
    use crate::downlink::TelemetrySender;
    use crate::estimation::{EstimationTask, Sensors, place_estimator};
    use crate::parameters::SEGMENTS_WITHOUT_TABLE;
    use crate::table_task::TableTask;
    use crate::tick::{Tick, Ticker, regulator_outputs};
    use crate::{cpu_load, device_info};

    #[shared]
    struct Shared {
        actuator: Actuator,
        control: Control,
        sender: TelemetrySender,
    }

    #[local]
    struct Local {
        ticker: Ticker,
        command_task: CommandTask,
        command_ticks: SignalReader<'static, Tick>,
        estimation_task: EstimationTask,
        estimation_ticks: SignalReader<'static, Tick>,
        table_task: TableTask,
        table_requests: Receiver<'static, Request, TABLE_REQUESTS>,
    }

    #[init(local = [
        buffers: Buffers = Buffers::new(),
        for_commands: Signal<Tick> = Signal::new(),
        for_estimation: Signal<Tick> = Signal::new(),
        table: MaybeUninit<BoardTable<MAX_SEGMENTS>> = MaybeUninit::uninit(),
        config: MaybeUninit<ArmConfig<'static, Q>> = MaybeUninit::uninit(),
        estimator: MaybeUninit<BoardEstimator> = MaybeUninit::uninit(),
    ])]
    fn init(cx: init::Context) -> (Shared, Local) {
        let mut board = match board::set_up(cx.device, cx.local.buffers) {
            Ok(board) => board,
            Err(error) => panic!("the board does not come up: {error}"),
        };
        let (safe_mode, boot) = (board.boots.safe_mode(), board.boots.number());
        let table = cx.local.table.write(BoardTable::new());
        // A table that keeps the board from starting would keep it from reporting that.
        let table_state = if board.boots.fails_to_start() { board.tables.skip() } else { board.tables.load(table) };
        let reference = Wiring::reference(SEGMENTS_WITHOUT_TABLE);
        let wiring = table.wiring().unwrap_or(&reference);
        device_info::enter_arm(&mut board.hello, table, wiring);
        log_boot(&board.hello, &table_state, safe_mode);
        let (to_commands, command_ticks) = cx.local.for_commands.split();
        let (to_estimation, estimation_ticks) = cx.local.for_estimation.split();
        let (to_table, table_requests) = make_channel!(Request, TABLE_REQUESTS);
        let has_table = table_state.status == TableStatus::InUse;
        let config = cx.local.config.write(table.config().unwrap_or(ArmConfig::uncalibrated(&[])));
        let estimator = place_estimator(cx.local.estimator, config);
        let sensors = Sensors {
            imus: Imus::new(board.imu_bus, board.mux, wiring),
            bend: BendSensorMonitor::new(wiring),
            rest: RestMonitor::new(),
        };
        let estimation_task = EstimationTask::new(sensors, estimator, config, board.hello, table_state, safe_mode);
        // Each is spawned once and never ends, so that there is room for it.
        let _ = commands::spawn();
        let _ = estimation::spawn();
        let _ = table::spawn();
        let control = Control {
            schedule: Schedule::of_arm(wiring.segments.len(), wiring.regulators.len()),
            tare_requested: false,
            pose: Pose::default(),
            tare_report: None,
            hello_requested: false,
            received: Counts::default(),
            has_table,
            safe_mode,
            completed: None,
        };
        let (trigger, start_us) = match board::start_ticks(board.tick_channel) {
            Ok(started) => started,
            Err(error) => panic!("the ticks do not start: {error}"),
        };
        let ticker = Ticker {
            trigger,
            start_us,
            adc: board.adc,
            regulators: board.regulators,
            outputs: regulator_outputs(wiring),
            watchdog: board.watchdog,
            backup: board.backup,
            boots: board.boots,
            subscribers: [to_commands, to_estimation],
            missed_deadline: None,
        };
        (
            Shared { actuator: Actuator::new(wiring), control, sender: TelemetrySender::new(board.tx) },
            Local {
                ticker,
                command_task: CommandTask::new(board.rx, to_table, boot),
                command_ticks,
                estimation_task,
                estimation_ticks,
                table_task: TableTask::new(board.tables),
                table_requests,
            },
        )
    }

    /// Logs the boot, its cause, and the crash before it.
    fn log_boot(hello: &telemetry::Hello, table: &telemetry::TableState, safe_mode: bool) {
        let (firmware, revision) = (hello.firmware.as_str(), hello.revision.as_str());
        defmt::info!("boot {} of firmware {} ({}), reset by {}", hello.boot, firmware, revision, hello.reset);
        match table.status {
            TableStatus::InUse => defmt::info!("table {} of {}", table.generation, hello.arm.as_str()),
            status => defmt::warn!("no estimates, as the table is {}", status),
        }
        if let Some(last_panic) = &hello.last_panic {
            defmt::warn!("crash before this boot: {}", last_panic.as_str());
        }
        if safe_mode {
            defmt::warn!("safe mode after repeated crashes: the pressures stay at zero");
        }
    }

    /// Sleeps while no task runs.
    #[idle]
    fn idle(_: idle::Context) -> ! {
        loop {
            cpu_load::sleep();
        }
    }

    /// The tick, 200 µs after the ADC's trigger.
    #[task(binds = TC0, priority = 4, shared = [actuator], local = [ticker])]
    fn tick(cx: tick::Context) {
        cx.local.ticker.run(cx.shared.actuator);
    }

    /// A byte on the IMUs' bus.
    #[task(binds = TWI1, priority = 5)]
    fn twi1(_: twi1::Context) {
        twi::on_interrupt::<TWI1>();
    }

    /// The timer of all delays.
    #[task(binds = TC1, priority = 5)]
    fn time(_: time::Context) {
        Mono::on_interrupt();
    }

    /// Requests of the host.
    #[task(priority = 3, shared = [actuator, control, sender], local = [command_task, command_ticks])]
    async fn commands(cx: commands::Context) {
        let mut shared = cx.shared;
        loop {
            let tick = cx.local.command_ticks.wait().await;
            let (actuator, control, sender) = (&mut shared.actuator, &mut shared.control, &mut shared.sender);
            if cx.local.command_task.run(tick.number, actuator, control, sender) {
                // Time to send the reply and to vent the arm.
                Mono::delay(50u64.millis()).await;
                reset::reset();
            }
        }
    }

    /// IMUs, estimator, messages.
    #[task(priority = 2, shared = [actuator, control, sender], local = [estimation_task, estimation_ticks])]
    async fn estimation(cx: estimation::Context) {
        let mut shared = cx.shared;
        loop {
            let tick = cx.local.estimation_ticks.wait().await;
            let (actuator, control, sender) = (&mut shared.actuator, &mut shared.control, &mut shared.sender);
            cx.local.estimation_task.run(tick, actuator, control, sender).await;
        }
    }

    /// Requests about the table in the flash.
    #[task(priority = 1, shared = [control, sender], local = [table_task, table_requests])]
    async fn table(cx: table::Context) {
        let mut shared = cx.shared;
        // The sender is never dropped.
        while let Ok(request) = cx.local.table_requests.recv().await {
            if cx.local.table_task.run(&request, &mut shared.control, &mut shared.sender) {
                // Time to send the reply.
                Mono::delay(50u64.millis()).await;
                reset::reset();
            }
        }
    }
}
