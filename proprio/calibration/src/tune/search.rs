//! The bias filter's own parameters: a pattern search, one coordinate at a time, with shorter and shorter steps.
//!
//! Around the minimum the errors hardly change with these parameters, and its place differs between scenarios. So each stays
//! within a decade of its start, and the loss is regularised by the distance from there.

use std::f64::consts::LN_10;
use std::ops::RangeInclusive;

use calibration_tables::DriftToml;

use super::objective::Evaluation;

/// Rate, rate random walk, angle random walk, offset and its time constant.
const PARAMETERS: usize = 5;
/// Point of the search: decades from the table's own parameters, in units of 1/[`DECADE`].
pub(super) type GridPoint = [i32; PARAMETERS];

/// Largest change of a parameter, a factor of 10.
const DECADE: i32 = 8;
/// Factors of 10, 3.2, 1.8 and 1.3.
const STEPS: [i32; 4] = [8, 4, 2, 1];
/// Largest number of runs of the estimator.
pub(super) const MAX_RUNS: usize = 100;
/// Regularisation of a factor of e, as a share of the error; it grows with the square of the factor's logarithm.
const REGULARISATION: f64 = 0.01;

/// A point that was better than all before it.
#[derive(Debug, Clone)]
pub(super) struct Candidate {
    pub place: GridPoint,
    pub found: Evaluation,
}

impl Candidate {
    fn regularised_loss(&self) -> f64 {
        let decades = self.place.iter().map(|steps| f64::from(*steps) / f64::from(DECADE));
        self.found.loss + REGULARISATION * decades.map(|decades| (decades * LN_10).powi(2)).sum::<f64>()
    }
}

/// Goes from `start` to the best neighbour as long as there is a better one, with shorter and shorter steps, and returns all
/// candidates, the best one last. `at` evaluates a point; `None` ends the search.
pub(super) fn search(start: Evaluation, mut at: impl FnMut(&GridPoint) -> Option<Evaluation>) -> Vec<Candidate> {
    let mut best = Candidate { place: GridPoint::default(), found: start };
    let (mut candidates, mut seen) = (Vec::new(), vec![best.place]);
    for step in STEPS {
        loop {
            let mut next: Option<Candidate> = None;
            for place in neighbours(best.place, step) {
                if seen.contains(&place) {
                    continue;
                }
                if seen.len() > MAX_RUNS {
                    return candidates;
                }
                seen.push(place);
                let Some(found) = at(&place) else { return candidates };
                let candidate = Candidate { place, found };
                if candidate.regularised_loss() < next.as_ref().unwrap_or(&best).regularised_loss() {
                    next = Some(candidate);
                }
            }
            let Some(next) = next else { break };
            best = next;
            candidates.push(best.clone());
        }
    }
    candidates
}

/// Points one step away.
fn neighbours(place: GridPoint, step: i32) -> impl Iterator<Item = GridPoint> {
    let ways = (0..PARAMETERS).flat_map(move |k| [(k, step), (k, -step)]);
    let places = ways.map(move |(k, step)| {
        let mut place = place;
        place[k] += step;
        place
    });
    places.filter(|place| place.iter().all(|steps| steps.abs() <= DECADE))
}

/// The bias filter at a point relative to `start`.
pub(super) fn filter_at(start: &DriftToml, place: &GridPoint) -> DriftToml {
    let [rate, rate_walk, angle_walk, offset, time] =
        place.map(|steps| libm::pow(10.0, f64::from(steps) / f64::from(DECADE)));
    DriftToml {
        rate_deg_per_s: within(start.rate_deg_per_s * rate, &(1e-4..=0.2)),
        rate_random_walk_deg_per_s_sqrt_s: within(start.rate_random_walk_deg_per_s_sqrt_s * rate_walk, &(1e-5..=0.01)),
        angle_random_walk_deg_per_sqrt_s: within(start.angle_random_walk_deg_per_sqrt_s * angle_walk, &(0.0..=1.0)),
        offset_deg: within(start.offset_deg * offset, &(0.0..=20.0)),
        offset_s: within(start.offset_s * time, &(64.0..=1e6)),
        ..start.clone()
    }
}

fn within(value: f64, range: &RangeInclusive<f64>) -> f64 {
    value.clamp(*range.start(), *range.end())
}
