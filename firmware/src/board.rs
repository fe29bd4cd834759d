//! Initialisation of the board: clocks, pins and drivers, in the order of their dependencies.

use atsam3x8e_hal::adc::{self, Adc};
use atsam3x8e_hal::backup::Backup;
use atsam3x8e_hal::gpio::Split;
use atsam3x8e_hal::pac::Peripherals;
use atsam3x8e_hal::pwm::{self, Output, Period, Polarity, Prescaler, Pwm};
use atsam3x8e_hal::tc::{self, Mono, Trigger};
use atsam3x8e_hal::twi::Twi;
use atsam3x8e_hal::uart::{self, Rx, Tx};
use atsam3x8e_hal::watchdog::{self, Watchdog};
use atsam3x8e_hal::{clock, crash, eefc, gpio, reset};
use board_core::tca9548a::{self, Tca9548a};
use board_core::{BootCounter, Scan, TableServer};
use board_table::{ANALOG_PINS, MAX_REGULATORS};
use embedded_hal::digital::PinState;
use telemetry::Hello;

use crate::imu_bus::ImuBus;
use crate::panic::outputs_safe;
use crate::parameters::{
    ANALOG_CHANNELS, BAUD, PWM_COUNTS, RECEIVE_BYTES, SCAN_US, STORAGE, TICK_HZ, TRANSMIT_BYTES, WATCHDOG_MS,
};
use crate::{device_info, retained};

/// The multiplexer's RESET, on D22.
pub type MuxReset = gpio::Pin<'B', 26, gpio::Output>;

/// DMA buffers of the peripherals.
pub struct Buffers {
    /// One scan of the ADC.
    pub scan: Scan,
    /// Frames to send.
    pub transmit: [u8; TRANSMIT_BYTES],
    /// Received bytes.
    pub receive: [u8; RECEIVE_BYTES],
}

impl Buffers {
    /// Empty buffers.
    pub const fn new() -> Self {
        Self { scan: [0; ANALOG_PINS as usize], transmit: [0; TRANSMIT_BYTES], receive: [0; RECEIVE_BYTES] }
    }
}

/// Drivers and data for the tasks.
pub struct Board {
    pub watchdog: Watchdog,
    /// For the trigger of the ticks.
    pub tick_channel: tc::Channel0,
    pub adc: Adc<{ ANALOG_PINS as usize }>,
    /// One output for each of [`REGULATOR_PINS`](board_table::REGULATOR_PINS).
    pub regulators: Pwm<MAX_REGULATORS>,
    pub imu_bus: ImuBus,
    /// Multiplexer of the IMUs.
    pub mux: Tca9548a<MuxReset>,
    pub tx: Tx,
    pub rx: Rx,
    pub backup: Backup,
    pub boots: BootCounter,
    /// The `Hello`, but for the table.
    pub hello: Hello,
    pub tables: TableServer<eefc::Flash>,
}

/// Errors of the initialisation. Each is a fault of the hardware or of [`parameters`](crate::parameters).
#[derive(Debug, thiserror::Error)]
pub enum Error {
    #[error("clock: {0}")]
    Clock(#[from] clock::Error),
    #[error("watchdog: {0}")]
    Watchdog(#[from] watchdog::Error),
    #[error("timer: {0}")]
    Timer(#[from] tc::Error),
    #[error("ADC: {0}")]
    Adc(#[from] adc::Error),
    #[error("PWM: {0}")]
    Pwm(#[from] pwm::Error),
    #[error("UART: {0}")]
    Uart(#[from] uart::Error),
    #[error("flash: {0}")]
    Flash(#[from] eefc::Error),
}

/// Starts the trigger of the ticks, last: a first tick that waits for the rest of the start would cut off its IMUs. Returns it
/// and the time of its first edge, µs.
pub fn start_ticks(channel: tc::Channel0) -> Result<(Trigger, u64), Error> {
    let start_us = Mono::now_us();
    Ok((Trigger::start(channel, TICK_HZ, SCAN_US)?, start_us))
}

/// Initialises the chip; returns the board, vented. No tick comes before [`start_ticks`].
pub fn set_up(device: Peripherals, buffers: &'static mut Buffers) -> Result<Board, Error> {
    crash::on_fault(outputs_safe);
    // First, so that it resets the board if anything below hangs.
    let watchdog = Watchdog::start(device.WDT, WATCHDOG_MS)?;
    let cause = device_info::reset_cause(reset::cause(&device.RSTC));
    let clocks = clock::configure(device.PMC, &device.EFC0, &device.EFC1)?;
    let (a, b, c) = (device.PIOA.split(clocks), device.PIOB.split(clocks), device.PIOC.split(clocks));

    // In the order of REGULATOR_PINS: D6 to D9, D34, D36, D38, D40.
    let regulators = [
        Output::from(c.pc24),
        Output::from(c.pc23),
        Output::from(c.pc22),
        Output::from(c.pc21),
        Output::from(c.pc2),
        Output::from(c.pc4),
        Output::from(c.pc6),
        Output::from(c.pc8),
    ];
    let period = Period { prescaler: Prescaler::Div1, counts: PWM_COUNTS };
    let regulators = Pwm::new(device.PWM, regulators, period, Polarity::ActiveHigh, clocks)?;

    let mut flash = eefc::Flash::new(device.EFC0, device.EFC1, STORAGE)?;
    let chip = flash.unique_id()?;
    let mut backup = Backup::new(device.GPBR);
    let last_panic = crash::take();
    let boots = BootCounter::start(retained::read(&backup), cause, last_panic.is_some());
    retained::write(&mut backup, &boots);
    let tables = TableServer::new(flash);
    let hello = device_info::hello(chip, cause, boots.number(), last_panic.as_ref());

    let (rx, tx) = (a.pa8.into_peripheral_a(), a.pa9.into_peripheral_a());
    let uart = uart::new(device.UART, rx, tx, BAUD, &mut buffers.transmit, &mut buffers.receive, clocks);
    let (tx, rx) = uart?;

    let imu_bus = ImuBus(Twi::new(device.TWI1, b.pb12.into_peripheral_a(), b.pb13.into_peripheral_a(), Mono, clocks));
    let mux = Tca9548a::new(tca9548a::ADDRESS, Some(b.pb26.into_output(PinState::High)));

    let channels = tc::split(device.TC0, clocks);
    Mono::start(channels.channel1);
    let adc = Adc::new(device.ADC, ANALOG_CHANNELS, adc::Trigger::Tc0Channel0, &mut buffers.scan, clocks);
    let adc = adc?;
    let tick_channel = channels.channel0;
    Ok(Board { watchdog, tick_channel, adc, regulators, imu_bus, mux, tx, rx, backup, boots, hello, tables })
}
