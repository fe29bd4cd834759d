//! The bias filter's own parameters: a pattern search, one coordinate at a time, with shorter and shorter steps.
//!
//! Around the best place the errors hardly change with these parameters, and where it lies differs from scenario to
//! scenario. So none goes further than a decade from where it was, and what it wins must pay for the way.

use std::f64::consts::LN_10;
use std::ops::RangeInclusive;

use calibration_tables::DriftToml;

use super::objective::Evaluation;

/// Rate, rate random walk, angle random walk, offset and its time constant.
const PARAMETERS: usize = 5;
/// Where the search is: shares of a decade, in units of 1/[`DECADE`], from the table's own parameters.
pub(super) type Place = [i32; PARAMETERS];

/// No parameter goes further, a factor of 10.
const DECADE: i32 = 8;
/// Factors of 10, 3.2, 1.8 and 1.3.
const STEPS: [i32; 4] = [8, 4, 2, 1];
/// The search is over after so many runs of the estimator.
pub(super) const MAX_RUNS: usize = 100;
/// What a factor of e costs, as a share of the error; more cost by the square of their logarithm.
const PRICE: f64 = 0.01;

/// A place that was better than all before it.
#[derive(Debug, Clone)]
pub(super) struct Find {
    pub place: Place,
    pub found: Evaluation,
}

impl Find {
    fn costs(&self) -> f64 {
        let decades = self.place.iter().map(|steps| f64::from(*steps) / f64::from(DECADE));
        self.found.loss + PRICE * decades.map(|decades| (decades * LN_10).powi(2)).sum::<f64>()
    }
}

/// Goes from `start` to the best neighbour as long as there is a better one, with shorter and shorter steps, and gives all
/// finds, the best one last. `at` says what a place is worth; `None` ends the search.
pub(super) fn search(start: Evaluation, mut at: impl FnMut(&Place) -> Option<Evaluation>) -> Vec<Find> {
    let mut best = Find { place: Place::default(), found: start };
    let (mut finds, mut seen) = (Vec::new(), vec![best.place]);
    for step in STEPS {
        loop {
            let mut next: Option<Find> = None;
            for place in neighbours(best.place, step) {
                if seen.contains(&place) {
                    continue;
                }
                if seen.len() > MAX_RUNS {
                    return finds;
                }
                seen.push(place);
                let Some(found) = at(&place) else { return finds };
                let find = Find { place, found };
                if find.costs() < next.as_ref().unwrap_or(&best).costs() {
                    next = Some(find);
                }
            }
            let Some(next) = next else { break };
            best = next;
            finds.push(best.clone());
        }
    }
    finds
}

/// Places one step away.
fn neighbours(place: Place, step: i32) -> impl Iterator<Item = Place> {
    let ways = (0..PARAMETERS).flat_map(move |k| [(k, step), (k, -step)]);
    let places = ways.map(move |(k, step)| {
        let mut place = place;
        place[k] += step;
        place
    });
    places.filter(|place| place.iter().all(|steps| steps.abs() <= DECADE))
}

/// The bias filter at a place as seen from `start`.
pub(super) fn filter_at(start: &DriftToml, place: &Place) -> DriftToml {
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
