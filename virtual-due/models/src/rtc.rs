//! RTC: the calendar (datasheet 15). Time of day and date run from the values set, and alarms occur; the events that CR selects
//! are not modelled.

use crate::model::{CYCLES_PER_SECOND, Context, Cycles, Peripheral};

const CR: u32 = 0x00;
const MR: u32 = 0x04;
const TIMR: u32 = 0x08;
const CALR: u32 = 0x0C;
const TIMALR: u32 = 0x10;
const CALALR: u32 = 0x14;
const SR: u32 = 0x18;
const SCCR: u32 = 0x1C;
const IER: u32 = 0x20;
const IDR: u32 = 0x24;
const IMR: u32 = 0x28;
const VER: u32 = 0x2C;
const UPDTIM: u32 = 1;
const UPDCAL: u32 = 2;
const ACKUPD: u32 = 1;
const ALARM: u32 = 1 << 1;
const SEC: u32 = 1 << 2;

/// Fields of TIMALR and of CALALR, each with the bit that enables it: seconds, minutes, hours; month, date.
const TIME_FIELDS: [(u32, u32); 3] = [(0x7F, 1 << 7), (0x7F00, 1 << 15), (0x7F_0000, 1 << 23)];
const CALENDAR_FIELDS: [(u32, u32); 2] = [(0x1F_0000, 1 << 23), (0x3F00_0000, 1 << 31)];

const MINUTE: u64 = 60;
const HOUR: u64 = 60 * MINUTE;
const DAY: u64 = 24 * HOUR;

/// A date of the Gregorian calendar.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Date {
    year: u32,
    month: u32,
    day: u32,
    /// 1…7, as the program set it.
    weekday: u32,
}

impl Date {
    fn next(self) -> Self {
        let leap = self.year.is_multiple_of(4) && (!self.year.is_multiple_of(100) || self.year.is_multiple_of(400));
        let last = match self.month {
            2 if leap => 29,
            2 => 28,
            4 | 6 | 9 | 11 => 30,
            _ => 31,
        };
        let weekday = self.weekday % 7 + 1;
        match (self.day < last, self.month < 12) {
            (true, _) => Self { day: self.day + 1, weekday, ..self },
            (false, true) => Self { day: 1, month: self.month + 1, weekday, ..self },
            (false, false) => Self { day: 1, month: 1, year: self.year + 1, weekday },
        }
    }
}

/// The calendar; only power-on resets it.
pub struct Rtc {
    control: u32,
    mode: u32,
    status: u32,
    mask: u32,
    time_alarm: u32,
    calendar_alarm: u32,
    /// Seconds of the day and date at a board time.
    seconds: u64,
    date: Date,
    since: Cycles,
}

impl Rtc {
    /// Midnight of 1 January 2007, a Monday, the state after power-on (datasheet 15.6).
    pub fn new() -> Self {
        let date = Date { year: 2007, month: 1, day: 1, weekday: 1 };
        Self {
            control: 0,
            mode: 0,
            status: 0,
            mask: 0,
            time_alarm: 0,
            calendar_alarm: 0x0101_0000,
            seconds: 0,
            date,
            since: 0,
        }
    }

    fn stopped(&self) -> bool {
        self.control & (UPDTIM | UPDCAL) != 0
    }

    fn time(&self) -> u32 {
        let hour = (self.seconds / HOUR) as u32;
        let (hour, afternoon) = match (self.mode & 1 != 0, hour) {
            (false, hour) => (hour, 0),
            (true, 0) => (12, 0),
            (true, 1..12) => (hour, 0),
            (true, 12) => (12, 1),
            (true, _) => (hour - 12, 1),
        };
        let [minute, second] = [self.seconds / MINUTE % 60, self.seconds % 60].map(|value| bcd(value as u32));
        afternoon << 22 | bcd(hour) << 16 | minute << 8 | second
    }

    fn set_time(&mut self, value: u32) {
        let [second, minute, hour] = [value & 0x7F, value >> 8 & 0x7F, value >> 16 & 0x3F].map(from_bcd);
        let hour = match (self.mode & 1 != 0, value >> 22 & 1 != 0) {
            (false, _) => hour,
            (true, false) => hour % 12,
            (true, true) => hour % 12 + 12,
        };
        self.seconds = (u64::from(hour) * HOUR + u64::from(minute) * MINUTE + u64::from(second)) % DAY;
    }

    fn calendar(&self) -> u32 {
        let Date { year, month, day, weekday } = self.date;
        bcd(day) << 24 | weekday << 21 | bcd(month) << 16 | bcd(year % 100) << 8 | bcd(year / 100)
    }

    fn set_calendar(&mut self, value: u32) {
        self.date = Date {
            year: from_bcd(value & 0x7F) * 100 + from_bcd(value >> 8 & 0xFF),
            month: from_bcd(value >> 16 & 0x1F).clamp(1, 12),
            day: from_bcd(value >> 24 & 0x3F).clamp(1, 31),
            weekday: (value >> 21 & 7).clamp(1, 7),
        };
    }

    /// Advances by a second.
    fn step(&mut self) {
        self.seconds += 1;
        if self.seconds == DAY {
            self.seconds = 0;
            self.date = self.date.next();
        }
        self.status |= SEC;
        if self.alarm_is_now() {
            self.status |= ALARM;
        }
    }

    /// True if an alarm is enabled, and all enabled fields match (datasheet 15.5.4).
    fn alarm_is_now(&self) -> bool {
        let differs = |alarm: u32, now: u32, fields: &[(u32, u32)]| {
            fields.iter().any(|(field, enable)| alarm & enable != 0 && (alarm ^ now) & field != 0)
        };
        let enabled = |alarm: u32, fields: &[(u32, u32)]| fields.iter().any(|(_, enable)| alarm & enable != 0);
        (enabled(self.time_alarm, &TIME_FIELDS) || enabled(self.calendar_alarm, &CALENDAR_FIELDS))
            && !differs(self.time_alarm, self.time(), &TIME_FIELDS)
            && !differs(self.calendar_alarm, self.calendar(), &CALENDAR_FIELDS)
    }
}

fn bcd(value: u32) -> u32 {
    ((value / 10) << 4) | (value % 10)
}

fn from_bcd(value: u32) -> u32 {
    (value >> 4) * 10 + (value & 0xF)
}

impl Peripheral for Rtc {
    fn read(&mut self, offset: u32, context: &mut Context) -> u32 {
        match offset {
            CR => self.control,
            MR => self.mode,
            TIMR => self.time(),
            CALR => self.calendar(),
            TIMALR => self.time_alarm,
            CALALR => self.calendar_alarm,
            SR => self.status,
            IMR => self.mask,
            SCCR | IER | IDR | VER => 0,
            _ => {
                context.report.unmodelled("RTC", offset);
                0
            }
        }
    }

    fn write(&mut self, offset: u32, value: u32, context: &mut Context) {
        match offset {
            CR => {
                self.control = value & 0x0003_0303;
                if self.stopped() {
                    self.status |= ACKUPD;
                } else {
                    self.since = context.now;
                }
            }
            MR => self.mode = value & 1,
            TIMR if self.stopped() => self.set_time(value),
            CALR if self.stopped() => self.set_calendar(value),
            TIMR | CALR => {}
            TIMALR => self.time_alarm = value & 0x00FF_FFFF,
            CALALR => self.calendar_alarm = value & 0xBF9F_0000,
            SCCR => self.status &= !value,
            IER => self.mask |= value & 0x1F,
            IDR => self.mask &= !value,
            _ => context.report.unmodelled("RTC", offset),
        }
    }

    fn advance(&mut self, context: &mut Context) {
        if self.stopped() {
            return;
        }
        while context.now - self.since >= CYCLES_PER_SECOND {
            self.since += CYCLES_PER_SECOND;
            self.step();
        }
    }

    fn next_event(&self) -> Option<Cycles> {
        (self.mask & (SEC | ALARM) != 0 && !self.stopped()).then_some(self.since + CYCLES_PER_SECOND)
    }

    fn interrupt(&self) -> bool {
        self.status & self.mask != 0
    }

    fn reset(&mut self) {}
}

#[cfg(test)]
mod tests {
    use super::{ALARM, CALALR, CALR, CR, IER, Rtc, SCCR, SR, TIMALR, TIMR};
    use crate::model::{CYCLES_PER_SECOND, Peripheral};
    use crate::test_support::Bench;

    #[test]
    fn it_runs_from_the_time_that_was_set() {
        let mut bench = Bench::new(Rtc::new());
        assert_eq!(bench.read(CALR), 0x0121_0720);
        bench.write(CR, 3);
        bench.write(TIMR, 0x0023_5958);
        bench.write(CALR, 0x2981_2420 & !0x001F_0000 | 0x0002_0000);
        bench.write(CR, 0);
        bench.run(2 * CYCLES_PER_SECOND);
        assert_eq!(bench.read(TIMR), 0);
        assert_eq!(bench.read(CALR) & 0x3F1F_FFFF, 0x0103_2420, "1 March 2024 follows 29 February");
    }

    #[test]
    fn an_alarm_comes_when_all_its_enabled_fields_match() {
        let mut bench = Bench::new(Rtc::new());
        // On the 2nd of any month, 5 s after any full minute of the hour 0.
        bench.write(TIMALR, 0x0080_0085);
        bench.write(CALALR, 0x8201_0000);
        bench.write(IER, ALARM);
        bench.run(24 * 3600 * CYCLES_PER_SECOND);
        assert!(!bench.model.interrupt(), "the 1st is not the day");
        bench.run(4 * CYCLES_PER_SECOND);
        assert_eq!(bench.read(SR) & ALARM, 0);
        bench.run(CYCLES_PER_SECOND);
        assert!(bench.model.interrupt());
        assert_eq!(bench.read(TIMR), 5);
        bench.write(SCCR, ALARM);
        bench.run(59 * CYCLES_PER_SECOND);
        assert!(!bench.model.interrupt());
        bench.run(CYCLES_PER_SECOND);
        assert!(bench.model.interrupt(), "and again a minute later");
    }

    #[test]
    fn no_alarm_comes_while_none_is_enabled() {
        let mut bench = Bench::new(Rtc::new());
        bench.run(3 * CYCLES_PER_SECOND);
        assert_eq!(bench.read(SR) & ALARM, 0);
    }
}
