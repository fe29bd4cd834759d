//! What happens when the firmware is at its end: outputs safe first, then last words, then a reset.

use core::panic::PanicInfo;

use atsam3x8e_hal::{crash, pwm};

/// Vents the arm without asking anybody.
pub fn outputs_safe() {
    pwm::disable_all_outputs();
}

#[panic_handler]
fn panic(info: &PanicInfo) -> ! {
    crash::die(info, outputs_safe)
}
