//! Objective of search and descent, and its exact gradient by the parameters of the Kalman filters.
//!
//! For a session it is the RMSE of all segments' positions plus that of their headings, at the lever of the arm's length: the
//! displacement of the far end by the heading. For several sessions it is the geometric mean, so that a percent counts the same
//! in each.
//!
//! The filters carry the derivatives of their states by their own parameters. From there to the errors, each segment moves
//! all that lies beyond it as a rigid body: with θ_i it turns about that segment's end, with P_i it shifts.

use std::panic::resume_unwind;
use std::thread;

use calibration_tables::ArmFile;
use estimator_core::{Angle, Pcc, SegmentConfig, SegmentPose, UnitArc, forward_kinematics};
use nalgebra::Vector2;

use super::Dual;
use super::errors::{End, Errors, SessionErrors, ends};
use super::filters::{Filters, SegmentGradient, SegmentNoises};
use super::parameters::{FilterCoordinates, PARAMETERS, Ranges};
use super::sample::TrainingSample;
use super::training::Training;

/// The sessions and their arm.
#[derive(Debug)]
pub(super) struct Objective {
    sessions: Vec<Training>,
    ranges: Ranges,
    pccs: Vec<Pcc<f64>>,
    lever_m: f64,
}

/// Evaluation of a table, or of the filters at one place.
#[derive(Debug, Clone, Default)]
pub(super) struct Evaluation {
    /// Logarithm of the objective on the training part.
    pub loss: f64,
    /// Logarithm of the objective on the validation part.
    pub validation_loss: f64,
    /// Gradient of `loss` by the coordinates of the place; empty with the bias filter.
    pub gradient: Vec<f64>,
    /// Errors of each session.
    pub sessions: Vec<SessionErrors>,
}

impl Objective {
    /// For sessions of an arm of these segments.
    pub fn new(sessions: Vec<Training>, segments: &[SegmentConfig<f64>]) -> Self {
        let ranges = Ranges::new(sessions.iter().map(|session| session.rate_hz).fold(0.0, f64::max));
        let lever_m = segments.iter().map(|segment| segment.length + segment.offset).sum();
        Self { sessions, ranges, pccs: segments.iter().map(Pcc::new).collect(), lever_m }
    }

    /// The sessions.
    pub fn sessions(&self) -> &[Training] {
        &self.sessions
    }

    /// Measures all sessions again, with a table's drift correction.
    pub fn measure(&mut self, table: &ArmFile) {
        thread::scope(|scope| {
            self.sessions.iter_mut().for_each(|session| drop(scope.spawn(|| session.measure(table))));
        });
    }

    /// Evaluates a table that differs from the one of the last [`measure`](Self::measure) only in its Kalman filters. The
    /// gradient is not valid.
    pub fn of_table(&self, table: &ArmFile) -> Evaluation {
        if let Some(fused) = self.sessions.iter().map(Training::fused).collect() {
            return self.pool(fused);
        }
        self.evaluate(|rate_hz| {
            let compiled = table.compile::<Dual>(rate_hz).expect("it is a table");
            let segments = compiled.config().segments.iter();
            segments.map(|segment| [[segment.orient; PARAMETERS], [segment.coord; PARAMETERS]]).collect()
        })
    }

    /// Evaluates the filters at a place.
    pub fn at(&self, place: &[f64]) -> Evaluation {
        self.evaluate(|rate_hz| {
            segments(place).iter().map(|places| places.each_ref().map(|p| self.ranges.noises(p, rate_hz))).collect()
        })
    }

    /// Start of the descent: the table's filters or, where those are worse, the defaults of the format. From filters that are
    /// far off, descent ends in a poor local minimum.
    pub fn start(&self, table: &ArmFile) -> Vec<f64> {
        let mut plain = table.clone();
        plain.segments.iter_mut().for_each(|segment| (segment.orient, segment.coord) = (None, None));
        let [own, plain] = [table, &plain].map(|table| self.place(table));
        if self.at(&plain).loss < self.at(&own).loss { plain } else { own }
    }

    /// Place of a table's filters.
    pub fn place(&self, table: &ArmFile) -> Vec<f64> {
        let filters =
            table.segments.iter().flat_map(|segment| [segment.orient_or_default(), segment.coord_or_default()]);
        filters.flat_map(|keys| self.ranges.place(&keys)).collect()
    }

    /// The table with the filters at a place.
    pub fn table(&self, place: &[f64], mut table: ArmFile) -> ArmFile {
        for (segment, [orient, coord]) in table.segments.iter_mut().zip(segments(place)) {
            let r_bend = [segment.orient_or_default().r_bend, segment.coord_or_default().r_bend];
            segment.orient = Some(self.ranges.keys(orient, r_bend[0]));
            segment.coord = Some(self.ranges.keys(coord, r_bend[1]));
        }
        table
    }

    /// Each session in a thread of its own; the sums are those of the sessions in their order.
    fn evaluate(&self, noises: impl Fn(f64) -> Vec<SegmentNoises> + Sync) -> Evaluation {
        let parts: Vec<(SessionErrors, Gradient)> = thread::scope(|scope| {
            let run = |session: &Training| self.session(session, &noises(session.rate_hz));
            let threads: Vec<_> = self.sessions.iter().map(|session| scope.spawn(move || run(session))).collect();
            threads.into_iter().map(|thread| thread.join().unwrap_or_else(|panic| resume_unwind(panic))).collect()
        });
        let mut sums = vec![0.0; 2 * PARAMETERS * self.pccs.len()];
        let seen = || parts.iter().filter(|(errors, _)| errors.training.tips.count() > 0);
        let share = 1.0 / seen().count() as f64;
        for (errors, gradient) in seen() {
            for (sum, derivative) in sums.iter_mut().zip(gradient.of_log(&errors.training, self.lever_m)) {
                *sum += share * derivative;
            }
        }
        let all = self.pool(parts.into_iter().map(|(errors, _)| errors).collect());
        Evaluation { gradient: sums, ..all }
    }

    /// The errors of all sessions together, without a gradient.
    fn pool(&self, sessions: Vec<SessionErrors>) -> Evaluation {
        let mut all = Evaluation::default();
        let mean = |part: fn(&SessionErrors) -> &Errors| {
            let parts = || sessions.iter().map(part).filter(|errors| errors.tips.count() > 0);
            parts().map(|errors| libm::log(errors.joint_m(self.lever_m))).sum::<f64>() / parts().count() as f64
        };
        (all.loss, all.validation_loss) = (mean(|session| &session.training), mean(|session| &session.validation));
        Evaluation { sessions, ..all }
    }

    fn session(&self, session: &Training, noises: &[SegmentNoises]) -> (SessionErrors, Gradient) {
        let start = || -> Vec<Filters> {
            let segments = self.pccs.iter().zip(noises);
            segments.map(|(pcc, of)| Filters::new(pcc, of)).collect()
        };
        let mut filters = start();
        let (mut errors, mut gradient) = (SessionErrors::default(), Gradient::new(filters.len()));
        let mut links: Vec<Option<SegmentPose<f64>>> = Vec::new();
        for TrainingSample { is_validation, starts, measured } in session.rows() {
            if starts {
                filters = start();
            }
            links.clear();
            links.extend(filters.iter_mut().zip(measured).map(|(filters, measured)| filters.step(measured)));
            let ends = ends(forward_kinematics(links.iter().copied()), measured);
            if is_validation {
                errors.validation.add(&ends, filters.len());
            } else {
                errors.training.add(&ends, filters.len());
                gradient.add(&ends, &filters);
            }
        }
        (errors, gradient)
    }
}

/// KF_orient's and KF_coord's place of each segment.
fn segments(place: &[f64]) -> &[[FilterCoordinates; 2]] {
    place.as_chunks::<PARAMETERS>().0.as_chunks::<2>().0
}

/// Half the derivatives of the sums of squares, by each segment's parameters.
struct Gradient {
    positions: Vec<SegmentGradient>,
    headings: Vec<SegmentGradient>,
}

impl Gradient {
    fn new(segments: usize) -> Self {
        let zeros = vec![SegmentGradient::default(); segments];
        Self { positions: zeros.clone(), headings: zeros }
    }

    /// Adds one sample, from the tip to the base.
    fn add(&mut self, ends: &[End], filters: &[Filters]) {
        // Of all errors from here to the tip: their sum, their moment about the base, clockwise positive, and their turn.
        let (mut pull, mut moment, mut turn) = (Vector2::zeros(), 0.0, 0.0);
        let clockwise = |point: Vector2<f64>, pull: Vector2<f64>| point.y * pull.x - point.x * pull.y;
        for (i, end) in ends.iter().enumerate().rev() {
            if let Some(error) = end.error {
                pull += error.point;
                moment += clockwise(end.point, error.point);
                turn += error.heading;
            }
            let start = UnitArc::new(Angle::from(if i == 0 { 0.0 } else { ends[i - 1].heading }));
            let in_segment =
                Vector2::new(pull.x * start.cos - pull.y * start.sin, pull.x * start.sin + pull.y * start.cos);
            let moment_here = moment - clockwise(end.point, pull);
            filters[i].add_derivatives(moment_here, in_segment, &mut self.positions[i]);
            filters[i].add_derivatives(turn, Vector2::zeros(), &mut self.headings[i]);
        }
    }

    /// Derivatives of the logarithm of [`Errors::joint_m`].
    fn of_log(&self, errors: &Errors, lever_m: f64) -> impl Iterator<Item = f64> {
        let joint_m = errors.joint_m(lever_m);
        let by_position = errors.positions.slope() / joint_m;
        let by_heading = lever_m * errors.headings.slope() / joint_m;
        let [positions, headings] = [&self.positions, &self.headings].map(|of| of.as_flattened().as_flattened());
        positions.iter().zip(headings).map(move |(position, heading)| by_position * position + by_heading * heading)
    }
}
