//! The bus clock's dividers.

use crate::clock::MCK_HZ;

/// Clock of the bus, Hz.
pub const BUS_HZ: u32 = 400_000;

/// CWGR for [`BUS_HZ`].
pub(super) const CLOCK_WAVEFORM: u32 = clock_waveform(MCK_HZ, BUS_HZ).expect("84 MHz has dividers for 400 kHz");

/// CWGR for a bus clock (datasheet chapter 33, TWI_CWGR): t_low = (CLDIV · 2^CKDIV + 4) / MCK, t_high likewise.
///
/// The low phase gets half of the period and at least 1.3 µs, the high phase the rest and at least 0.6 µs (I2C specification,
/// fast mode): 110 and 100 cycles of 84 MHz at 400 kHz.
const fn clock_waveform(mck: u32, bus_hz: u32) -> Option<u32> {
    let period = mck.div_ceil(bus_hz);
    let minimum_low = (mck / 10_000 * 13).div_ceil(1_000);
    let half = period.div_ceil(2);
    let low = if half > minimum_low { half } else { minimum_low };
    let high = period.saturating_sub(low);
    if high < (mck / 10_000 * 6).div_ceil(1_000) {
        return None;
    }
    let mut ckdiv = 0;
    while ckdiv < 8 {
        let cldiv = low.saturating_sub(4).div_ceil(1 << ckdiv);
        let chdiv = high.saturating_sub(4).div_ceil(1 << ckdiv);
        if cldiv <= 0xFF && chdiv <= 0xFF {
            return Some(ckdiv << 16 | chdiv << 8 | cldiv);
        }
        ckdiv += 1;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Low and high time of a CWGR value in cycles of MCK.
    fn low_and_high(cwgr: u32) -> (u32, u32) {
        let cycles = |divider: u32| (divider << (cwgr >> 16 & 0b111)) + 4;
        (cycles(cwgr & 0xFF), cycles(cwgr >> 8 & 0xFF))
    }

    #[test]
    fn the_bus_clock_is_exactly_400_khz_and_low_for_at_least_1300_ns() {
        let (low, high) = low_and_high(CLOCK_WAVEFORM);
        assert_eq!(MCK_HZ / (low + high), 400_000);
        assert!(low * 1_000 >= 1_300 * 84, "{low} cycles");
        assert_eq!(low_and_high(CLOCK_WAVEFORM), (110, 100));
    }

    #[test]
    fn a_slow_bus_uses_the_prescaler_and_is_never_too_fast() {
        let (low, high) = low_and_high(clock_waveform(84_000_000, 100_000).expect("100 kHz is possible"));
        assert!(low + high >= 840 && low + high < 850, "{low} + {high} cycles");
        assert_eq!(clock_waveform(84_000_000, 1_000_000), None);
    }
}
