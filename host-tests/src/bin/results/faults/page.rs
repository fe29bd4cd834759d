//! The page of faults.

use std::fmt::{self, Write};

use super::{ARMS, AT_ONCE_S, FaultFigures, Faults, Verdict};

impl Verdict {
    const ALL: [Self; 5] =
        [Self::Recovered, Self::FlaggedAndInside, Self::InsideAlone, Self::FlaggedAlone, Self::Broken];

    fn name(self) -> &'static str {
        match self {
            Self::Recovered => "recovered",
            Self::FlaggedAndInside => "flagged, inside",
            Self::InsideAlone => "**inside, not flagged**",
            Self::FlaggedAlone => "**flagged, not inside**",
            Self::Broken => "**neither**",
        }
    }
}

impl Faults {
    /// The page.
    pub fn to_markdown(&self) -> Result<String, fmt::Error> {
        let mut page = String::new();
        self.write(&mut page)?;
        Ok(page)
    }

    fn write(&self, page: &mut String) -> fmt::Result {
        writeln!(page, "{INTRODUCTION}")?;
        writeln!(page, "Arms {ARMS:?} of the test arms ([results](results.md)), nothing tuned.\n")?;
        self.write_counts(page)?;
        for scenario in ["I", "II"] {
            writeln!(page, "## Scenario {scenario}\n")?;
            writeln!(page, "| fault | arm | before | clean | first 10 s | after 1 min | flagged | inside | |")?;
            writeln!(page, "|---|---|---|---|---|---|---|---|---|")?;
            self.write_rows(page, scenario)?;
            writeln!(page)?;
        }
        writeln!(page, "{WHAT_IT_IS_NOT}")
    }

    fn write_counts(&self, page: &mut String) -> fmt::Result {
        writeln!(page, "| one minute after | sessions |\n|---|---|")?;
        for verdict in Verdict::ALL {
            let count = self.sessions.iter().filter(|session| session.verdict() == verdict).count();
            writeln!(page, "| {} | {count} of {} |", verdict.name(), self.sessions.len())?;
        }
        write!(page, "\nShare of time with a condition in the sessions without a fault:")?;
        for (k, (scenario, arm, percent)) in self.clean.iter().enumerate() {
            let comma = if k == 0 { "" } else { "," };
            write!(page, "{comma} {scenario} arm {arm} {percent:.1} %")?;
        }
        writeln!(page, ".\n")
    }

    /// Rows in the order of the catalogue, the arms of a fault together.
    fn write_rows(&self, page: &mut String, scenario: &str) -> fmt::Result {
        let sessions: Vec<&FaultFigures> = self.sessions.iter().filter(|row| row.scenario == scenario).collect();
        let of_first = sessions.iter().filter(|row| row.arm == ARMS[0]);
        for name in of_first.map(|row| row.name) {
            sessions.iter().filter(|row| row.name == name).try_for_each(|row| row.write(page))?;
        }
        Ok(())
    }
}

impl FaultFigures {
    fn write(&self, page: &mut String) -> fmt::Result {
        let before = self.before_mm.map_or_else(|| "–".to_owned(), |before_mm| format!("{before_mm:.1}"));
        let flagged = match self.flagged_s {
            Some(seconds) if seconds <= AT_ONCE_S => "within 1 s".to_owned(),
            Some(seconds) => format!("after {seconds:.0} s"),
            None => "no".to_owned(),
        };
        writeln!(
            page,
            "| {} | {} | {before} | {:.1} | {:.1} | {:.1} | {flagged} | {:.0} % | {} |",
            self.name,
            self.arm,
            self.clean_mm,
            self.first_mm,
            self.after_mm,
            self.inside_percent,
            self.verdict().name()
        )
    }
}

const INTRODUCTION: &str = "\
# Faults of sessions

`cargo xtask results` makes this page: it puts faults of sensors, recordings and motion into simulated sessions and replays them in the
board's fixed point. Tip RMSE of fusion in mm: *before* the fault; *clean*, in the same session without the fault, from one minute after
the fault's time to the end; in the *first 10 s* of the fault, or after one that ends at once; and *after 1 min*, from one minute later
to the end, with the share of true tips *inside* the 95 % ellipse in the same time. *Flagged*: `Estimator::conditions` reports a condition
of some segment, within a minute at most. 15 min at 10 Hz, the fault at 300 s; at 100 Hz 5 min, the fault at 120 s.

The promise: one minute after a fault the error is within 1.5 times the clean one, or the estimator has flagged it and at least 88 % of the
true tips are inside the ellipse. Sessions that break it are bold.
";

const WHAT_IT_IS_NOT: &str = "\
## Reading it

A fault comes once in a session, at one moment: a row is one draw, not a statistic. The clean error of a session is one draw as well,
and small by chance in some.

What `proprio check` finds of such faults in a session, and what looks the same as a good one, is in [checking a
session](../how-to/checking-a-session.md#what-it-cannot-tell).";
