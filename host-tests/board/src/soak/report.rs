//! Result of a soak: violations, and a table by fault.

use std::collections::BTreeMap;
use std::fmt;

use super::checks::TipFigures;
use super::finding::Finding;
use super::known::Known;

/// An invariant that did not hold in an episode, with its first time and its largest figure.
pub struct Violation {
    /// The finding.
    pub finding: Finding,
    /// How often in the episode.
    pub count: u64,
    /// Faults of the episode, and of the one before.
    pub faults: String,
    /// The weakness that explains it.
    pub known: Option<&'static Known>,
}

/// Figures of one kind of fault.
#[derive(Debug, Clone, Copy, Default)]
pub struct Row {
    episodes: u32,
    tip: TipFigures,
    longest_recovery_s: f64,
    not_recovered: u32,
}

/// Result of a soak.
pub struct Report {
    /// Seed.
    pub seed: u64,
    /// Virtual time, s.
    pub seconds: f64,
    /// Everything that broke an invariant.
    pub violations: Vec<Violation>,
    /// Restarts of the board.
    pub restarts: u32,
    /// Estimates that were compared with the host's, bit for bit.
    pub replays: u64,
    /// Largest error of the tip after which the arm has not recovered, mm.
    pub limit_mm: f64,
    rows: BTreeMap<String, Row>,
}

impl Report {
    /// Before the first fault.
    pub const fn new(seed: u64) -> Self {
        Self {
            seed,
            seconds: 0.0,
            violations: Vec::new(),
            restarts: 0,
            replays: 0,
            limit_mm: f64::INFINITY,
            rows: BTreeMap::new(),
        }
    }

    /// Adds an episode of a kind of fault; `recovery_s` is `None` if it did not recover.
    pub fn add(&mut self, kind: String, tip: TipFigures, recovery_s: Option<f64>) {
        let row = self.rows.entry(kind).or_default();
        row.episodes += 1;
        row.tip.add(tip);
        match recovery_s {
            Some(seconds) => row.longest_recovery_s = row.longest_recovery_s.max(seconds),
            None => row.not_recovered += 1,
        }
    }

    /// Violations that no known weakness explains.
    pub fn unexplained(&self) -> impl Iterator<Item = &Violation> {
        self.violations.iter().filter(|violation| violation.known.is_none())
    }
}

impl TipFigures {
    /// Adds figures of another time.
    fn add(&mut self, other: Self) {
        self.worst_mm = self.worst_mm.max(other.worst_mm);
        self.worst_deviations = self.worst_deviations.max(other.worst_deviations);
        self.compared += other.compared;
        self.flagged += other.flagged;
    }
}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Finding { invariant, time_s, figure, .. } = &self.finding;
        write!(f, "{time_s:9.2} s  {invariant}: {figure} ({} times; {})", self.count, self.faults)?;
        self.known.map_or(Ok(()), |known| write!(f, "\n             known: {}", known.reason))
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for violation in &self.violations {
            writeln!(f, "{violation}")?;
        }
        writeln!(
            f,
            "\nfault                                         episodes  tip, mm  in deviations  flagged, %  recovery, s  not recovered"
        )?;
        for (kind, row) in &self.rows {
            let Row { episodes, tip, longest_recovery_s, not_recovered } = row;
            let flagged_percent = 100.0 * tip.flagged as f64 / tip.compared.max(1) as f64;
            writeln!(
                f,
                "{kind:45} {episodes:8}  {:7.1}  {:13.1}  {flagged_percent:10.0}  {longest_recovery_s:11.1}  {not_recovered:13}",
                tip.worst_mm, tip.worst_deviations
            )?;
        }
        writeln!(
            f,
            "\nseed {}, {:.0} s of the board: {} restarts, {} estimates compared with the host's, \
             recovered below {:.1} mm, {} violations, {} of them known",
            self.seed,
            self.seconds,
            self.restarts,
            self.replays,
            self.limit_mm,
            self.violations.len(),
            self.violations.len() - self.unexplained().count()
        )
    }
}
