//! The truth of a session or a camera's file before anything is fitted to it: wrong poses are left out, or it is refused.

use std::path::{Path, PathBuf};

use calibration_tables::ArmFile;
use proprio_check::truth::{Fault, LeftOut, TruthCheck, TruthReport, TruthRow};
use proprio_check::{Finding, Kind};
use proprio_session::{Progress, RequiredColumns, SessionReader};

use crate::error::Error;
use crate::truth_error::{TruthError, TruthLengths};

/// Share of wrong poses above which truth is refused. The poses that are found to be wrong differ from those of the arm by a
/// tenth of a segment or more; where every fifth pose is, smaller errors of the same cause must be expected in the others.
const MOST_WRONG: f64 = 0.2;
/// Difference of the truth's lengths from the arm's above which no table can be made, as a share.
const MOST_STRETCH: f64 = 0.1;

/// Findings about the truth of one file.
#[derive(Debug, Clone)]
pub struct JudgedTruth {
    /// The file.
    pub path: PathBuf,
    /// The findings.
    pub findings: Vec<Finding>,
    /// Lengths that the markers fit; `None` where no pose has its neighbour.
    pub lengths: Option<TruthLengths>,
    /// Time by which the truth is later than the IMUs, s; `None` where the motion does not determine it.
    pub lag_s: Option<f64>,
}

impl JudgedTruth {
    /// Refuses lengths of another arm.
    pub(crate) fn check_lengths(&self) -> Result<(), Error> {
        match self.lengths.filter(|lengths| (lengths.scale - 1.0).abs() > MOST_STRETCH) {
            Some(lengths) => {
                Err(Error::Truth { path: self.path.clone(), source: Box::new(TruthError::Lengths(lengths)) })
            }
            None => Ok(()),
        }
    }

    /// Text of a finding, with the lengths in mm.
    #[must_use]
    pub fn text(&self, finding: &Finding) -> String {
        match self.lengths.filter(|_| finding.kind == Kind::TruthLengths) {
            Some(lengths) => lengths.to_string(),
            None => finding.to_string(),
        }
    }
}

/// A judge of one file's truth.
pub(crate) struct TruthJudge {
    path: PathBuf,
    given_mm: f64,
    check: TruthCheck,
    left_out: LeftOut,
}

impl TruthJudge {
    pub fn new(path: &Path, arm: &ArmFile) -> Self {
        let given_mm = arm.segments.first().map_or(0.0, |segment| segment.length_mm);
        Self { path: path.to_owned(), given_mm, check: TruthCheck::new(arm), left_out: LeftOut::default() }
    }

    /// Judges the next row.
    pub fn update(&mut self, row: &TruthRow) {
        for fault in self.check.update(row) {
            self.left_out.add(fault);
        }
    }

    /// The result, and the wrong poses.
    pub fn finish(self) -> Result<(JudgedTruth, LeftOut), Error> {
        let Self { path, given_mm, check, mut left_out } = self;
        let (report, faults): (TruthReport, Vec<Fault>) = check.finish();
        for fault in &faults {
            left_out.add(fault);
        }
        let TruthReport { findings, scale, lag_s, wrong_share } = report;
        let lengths = scale.map(|scale| TruthLengths { scale, given_mm });
        let refuse = |source| Error::Truth { path: path.clone(), source: Box::new(source) };
        if let Some(finding) = findings.iter().find(|of| matches!(of.kind, Kind::TruthUnit | Kind::TruthRadians)) {
            return Err(refuse(TruthError::Unit(*finding)));
        }
        // No pose is wrong by itself; the misfit of all is an error of the table that is made of them.
        if let Some(axes) = findings.iter().find(|finding| finding.kind == Kind::TruthAxes) {
            return Ok((JudgedTruth { path, findings: vec![*axes], lengths, lag_s }, LeftOut::default()));
        }
        let worst = findings.iter().filter(|finding| finding.kind.is_wrong_pose()).max_by_key(|of| of.rows.count);
        if let Some(worst) = worst.filter(|_| wrong_share > MOST_WRONG) {
            let (percent, most) = (wrong_share * 100.0, MOST_WRONG * 100.0);
            return Err(refuse(TruthError::Wrong { percent, most, worst: *worst }));
        }
        Ok((JudgedTruth { path, findings, lengths, lag_s }, left_out))
    }
}

/// Judges the truth of a session.
pub(crate) fn judge(
    session: &Path,
    arm: &ArmFile,
    needs: &RequiredColumns,
    progress: &mut dyn Progress,
) -> Result<(JudgedTruth, LeftOut), Error> {
    let mut reader = SessionReader::open(session, needs)?;
    let mut judge = TruthJudge::new(session, arm);
    let work = format!("checking the truth of {}", session.display());
    let mut number = 0;
    while let Some(row) = reader.next_row()? {
        number += 1;
        judge.update(&TruthRow::of(&row, number));
        progress.advance(&work, reader.progress());
    }
    judge.finish()
}
