//! RTT: the real-time timer (datasheet 14).

use crate::model::{Context, Cycles, Peripheral};
use crate::ticks::Ticks;

const MR: u32 = 0x00;
const AR: u32 = 0x04;
const VR: u32 = 0x08;
const SR: u32 = 0x0C;
const ALMIEN: u32 = 1 << 16;
const RTTINCIEN: u32 = 1 << 17;
const RTTRST: u32 = 1 << 18;
const ALMS: u32 = 1;
const RTTINC: u32 = 2;
const SLOW_CLOCK_HZ: u32 = 32_768;

/// The timer; it is in the backup area, so that only power-on resets it.
pub struct Rtt {
    mode: u32,
    alarm: u32,
    status: u32,
    ticks: Ticks,
    seen: u64,
}

impl Rtt {
    /// State after power-on: counting 32768 slow clocks each.
    pub fn new() -> Self {
        let ticks = Ticks { origin: 0, hz: SLOW_CLOCK_HZ, divisor: 0x8000 };
        Self { mode: 0x8000, alarm: u32::MAX, status: 0, ticks, seen: 0 }
    }

    /// Ticks until the counter is one past the alarm, which sets ALMS.
    fn to_alarm(&self) -> u64 {
        u64::from(self.alarm.wrapping_sub(self.seen as u32)) + 1
    }
}

impl Peripheral for Rtt {
    fn read(&mut self, offset: u32, context: &mut Context) -> u32 {
        match offset {
            MR => self.mode,
            AR => self.alarm,
            VR => self.seen as u32,
            SR => std::mem::take(&mut self.status),
            _ => {
                context.report.unmodelled("RTT", offset);
                0
            }
        }
    }

    fn write(&mut self, offset: u32, value: u32, context: &mut Context) {
        match offset {
            MR => {
                self.mode = value & 0x0003_FFFF;
                if value & RTTRST != 0 {
                    // RTPRES 0 stands for 2¹⁶.
                    let divisor = if (value & 0xFFFF) as u16 == 0 { 0x1_0000 } else { value & 0xFFFF };
                    self.ticks = Ticks { origin: context.now, hz: SLOW_CLOCK_HZ, divisor };
                    self.seen = 0;
                }
            }
            AR => self.alarm = value,
            _ => context.report.unmodelled("RTT", offset),
        }
    }

    fn advance(&mut self, context: &mut Context) {
        let now = self.ticks.at(context.now);
        if now > self.seen {
            self.status |= RTTINC;
            if now - self.seen >= self.to_alarm() {
                self.status |= ALMS;
            }
            self.seen = now;
        }
    }

    fn next_event(&self) -> Option<Cycles> {
        let tick = match (self.mode & RTTINCIEN != 0, self.mode & ALMIEN != 0) {
            (true, _) => self.seen + 1,
            (false, true) => self.seen + self.to_alarm(),
            (false, false) => return None,
        };
        self.ticks.time(tick)
    }

    fn interrupt(&self) -> bool {
        self.mode & ALMIEN != 0 && self.status & ALMS != 0 || self.mode & RTTINCIEN != 0 && self.status & RTTINC != 0
    }

    fn reset(&mut self) {}
}

#[cfg(test)]
mod tests {
    use super::{AR, MR, Rtt, SR, VR};
    use crate::model::{CYCLES_PER_SECOND, Peripheral};
    use crate::test_support::Bench;

    #[test]
    fn it_counts_and_alarms() {
        let mut bench = Bench::new(Rtt::new());
        bench.write(AR, 3);
        bench.write(MR, 0x0005_0020);
        bench.run(CYCLES_PER_SECOND * 3 / 1024 + 1);
        assert_eq!((bench.read(VR), bench.model.interrupt()), (3, false));
        bench.run(CYCLES_PER_SECOND / 1024);
        assert_eq!((bench.read(VR), bench.model.interrupt()), (4, true));
        assert_eq!(bench.read(SR), 3);
        assert!(!bench.model.interrupt());
    }
}
