//! Panic handler: make outputs safe, record the message, reset.
//!
//! With the feature `panic-probe` it also logs the message by defmt, for `probe-rs run`. The package `panic-probe` is not
//! used: its handler logs before anything else can run and then stops in the debugger, with the pressures still on.

use core::panic::PanicInfo;

use atsam3x8e_hal::{crash, pwm};

/// Vents the arm, in any state of the tasks.
pub fn outputs_safe() {
    pwm::disable_all_outputs();
}

#[panic_handler]
fn panic(info: &PanicInfo) -> ! {
    #[cfg(feature = "panic-probe")]
    {
        cortex_m::interrupt::disable();
        outputs_safe();
        defmt::error!("{}", defmt::Display2Format(info));
        defmt::flush();
    }
    crash::die(info, outputs_safe)
}
