//! The sweep for a calibration, for the page's guide: what a recording has covered so far.

use proprio_calibration::coverage::{SweepCoverage, SweepReport};
use proprio_link::Tared;
use proprio_session::Row;
use serde::Serialize;
use telemetry::{Conditions, Health, Message, RequestOutcome};

/// Phase of a sweep.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
enum Phase {
    /// Nothing was recorded yet: the rows since the board's last start or tare.
    Before,
    /// The rows since the begin of the recording.
    Recording,
    /// Those of the recording that has ended.
    Recorded,
}

/// A sweep, and the recording of it.
#[derive(Debug)]
pub(super) struct Sweep {
    coverage: SweepCoverage,
    segments: usize,
    phase: Phase,
    /// The file of the recording.
    file: Option<String>,
    /// Pose of the arm at the last tare that was requested.
    tare: Option<String>,
    /// Number of the last request that the board has refused.
    refused: Option<u32>,
}

/// State of a sweep.
#[derive(Debug, Serialize)]
pub(super) struct SweepStatus {
    phase: Phase,
    file: Option<String>,
    tare: Option<String>,
    /// Segments, from 1, whose estimate has a tare in which the arm was bent or moved.
    bad_tare: Vec<usize>,
    #[serde(flatten)]
    report: SweepReport,
    /// Sensors that do not follow, each with its remedy.
    faults: Vec<String>,
}

impl Default for Sweep {
    fn default() -> Self {
        let (file, tare, refused) = Default::default();
        Self { coverage: SweepCoverage::new(0), segments: 0, phase: Phase::Before, file, tare, refused }
    }
}

impl Sweep {
    /// Adds a row of an arm with this number of segments.
    pub fn update(&mut self, row: &Row, segments: usize) {
        if self.segments != segments {
            (self.segments, self.phase) = (segments, Phase::Before);
            self.restart();
        }
        match self.phase {
            Phase::Recorded => return,
            Phase::Before if row.starts => self.restart(),
            Phase::Before | Phase::Recording => {}
        }
        self.coverage.update(row);
    }

    /// Takes the file that is recorded now; with its begin the sweep begins.
    pub fn record(&mut self, file: Option<&str>) {
        match file {
            Some(_) if self.file.as_deref() == file => {}
            Some(file) => {
                (self.file, self.phase) = (Some(file.to_owned()), Phase::Recording);
                self.restart();
            }
            None if self.phase == Phase::Recording => self.phase = Phase::Recorded,
            None => {}
        }
    }

    /// Takes the report of a tare.
    pub fn take(&mut self, message: &Message) {
        match message {
            Message::Reply(reply) if matches!(reply.outcome, RequestOutcome::Nack(_)) => self.refused = Some(reply.id),
            Message::Tare(report) if self.refused != Some(report.id) => {
                self.tare = Some(Tared(Some(*report)).to_string());
            }
            _ => {}
        }
    }

    /// Forgets the tare of a board that has restarted or gone.
    pub fn board_lost(&mut self) {
        self.tare = None;
    }

    fn restart(&mut self) {
        self.coverage = SweepCoverage::new(self.segments);
    }

    /// Its state, with the last health of the board; `None` before the first row.
    pub fn status(&self, health: Option<&Health>) -> Option<SweepStatus> {
        let conditions = (1..).zip(health.iter().flat_map(|health| &health.conditions));
        let bad_tare = conditions
            .filter(|(_, conditions)| conditions.contains(Conditions::TARE_BAD))
            .map(|(segment, _)| segment)
            .collect();
        let report = self.coverage.report();
        let faults = report.faults.iter().map(ToString::to_string).collect();
        let (file, tare) = (self.file.clone(), self.tare.clone());
        (self.segments > 0).then_some(SweepStatus { phase: self.phase, file, tare, bad_tare, report, faults })
    }
}

#[cfg(test)]
mod tests {
    use calibration_tables::MAX_SEGMENTS;
    use estimator_core::{ImuReading, Phase as Turn, Sample};
    use proprio_session::Row;
    use telemetry::{Message, Refusal, Reply, RequestOutcome, TareReport};

    use super::Sweep;

    /// Adds seconds of an arm of one segment that turns by 10° per second.
    fn turn(sweep: &mut Sweep, seconds: std::ops::Range<u32>) {
        for tick in seconds.start * 100..seconds.end * 100 {
            let mut sample = Sample::<MAX_SEGMENTS>::missing(u64::from(tick) * 10_000);
            sample.imu[0] = Some(ImuReading::Heading(Turn::from_rad((f64::from(tick) * 0.1).to_radians())));
            sweep.update(&Row { sample, truth: [None; MAX_SEGMENTS], starts: tick == 0, board: None }, 1);
        }
    }

    fn status(sweep: &Sweep) -> serde_json::Value {
        serde_json::to_value(sweep.status(None).expect("there were rows")).expect("it has a form in JSON")
    }

    #[test]
    fn the_sweep_is_that_of_the_recording_and_stays_after_its_end() {
        let mut sweep = Sweep::default();
        turn(&mut sweep, 0..2);
        assert_eq!(status(&sweep)["phase"], "before");
        sweep.record(Some("a.mcap"));
        turn(&mut sweep, 2..5);
        sweep.record(Some("a.mcap"));
        turn(&mut sweep, 5..6);
        sweep.record(None);
        turn(&mut sweep, 6..9);
        let status = status(&sweep);
        assert_eq!((&status["phase"], &status["file"]), (&"recorded".into(), &"a.mcap".into()));
        let degrees = status["segments"][0]["ends_deg"][1].as_f64().expect("the IMU was read");
        assert!((degrees - 39.9).abs() < 1e-6, "{status}");
        assert!((status["seconds"].as_f64().expect("a number") - 3.99).abs() < 1e-6, "{status}");
    }

    #[test]
    fn the_pose_of_a_tare_is_shown_where_the_board_has_not_refused_it() {
        let mut sweep = Sweep::default();
        turn(&mut sweep, 0..1);
        let report = |id| Message::Tare(TareReport { id, turned: None, bent: None });
        sweep.take(&report(1));
        assert_eq!(status(&sweep)["tare"], "tared: no IMU was read, no bend sensor was read");
        sweep.board_lost();
        let outcome = RequestOutcome::Nack(Refusal::Moving);
        sweep.take(&Message::Reply(Reply { id: 2, session: 0, outcome }));
        sweep.take(&report(2));
        assert_eq!(status(&sweep)["tare"], serde_json::Value::Null);
    }
}
