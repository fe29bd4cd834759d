//! Verdict on the wiring of a whole session.

use calibration_tables::MAX_SEGMENTS;

use super::fit::{EXPLAINED, Fit, MISFIT};
use super::wiring::{Fault, Wiring};
use crate::finding::{Finding, Kind, Rows, Source, is_bend_blamed};

/// Gains of an IMU outside which its scale is wrong.
const GAINS: [f64; 2] = [0.6, 1.6];
/// Largest heading in radians.
const WHOLE_TURN_RAD: f64 = 6.284;
/// Correlation from which on two sensors agree, and size from which on they follow one another.
const AGREES: f64 = 0.4;
const FOLLOWS: f64 = 0.75;

/// Readings of a session that the judge needs and the fit does not keep.
#[derive(Debug, Clone)]
pub(super) struct Facts {
    pub segments: usize,
    pub rows: Rows,
    /// Largest heading of each IMU as it was read, deg.
    pub largest: [f64; MAX_SEGMENTS],
    /// By segment: squares of the steps of a and of b, their products with those by the IMUs, and the square of these.
    pub places: [[f64; 5]; MAX_SEGMENTS],
}

/// The judge.
pub(super) struct Judge<'f> {
    pub fit: Fit,
    pub facts: &'f Facts,
}

impl Judge<'_> {
    fn faults(&self, wiring: &Wiring) -> Vec<Fault> {
        let mut faults = vec![Fault::Gain(None, self.fit.common_gain(wiring))];
        let last = self.fit.segments.last().map_or(0, |last| last + 1);
        faults.extend((0..last).map(|i| Fault::Gain(Some(i), self.fit.gain(i) / wiring.gain[i])));
        faults.extend(self.fit.segments.iter().map(|i| Fault::BendSign(*i)));
        for i in 0..last {
            faults.extend((0..i).flat_map(|j| [Fault::Imus(j, i), Fault::Bends(j, i)]));
        }
        faults
    }

    pub fn run(&self, findings: &mut Vec<Finding>) {
        self.radians(findings);
        if findings.iter().any(|found| found.kind == Kind::Radians) {
            return;
        }
        self.lone_sensors(findings);
        let judged: Vec<usize> =
            self.fit.segments.iter().copied().filter(|i| !is_bend_blamed(findings, i + 1)).collect();
        let wiring = self.explain(&judged, findings);
        self.report_unexplained(&wiring, &self.bad(&judged, &wiring), findings);
    }

    /// Finds IMUs in radians: no heading is above a whole turn in them, and the segments on either side of the IMU disagree.
    fn radians(&self, findings: &mut Vec<Finding>) {
        let in_order = Wiring::in_order();
        let disagrees = |i: usize| self.fit.segments.contains(&i) && self.fit.misfit(&in_order, i) > MISFIT;
        let is_small = |i: usize| (f64::MIN_POSITIVE..=WHOLE_TURN_RAD).contains(&self.facts.largest[i]);
        let imus: Vec<usize> =
            (0..self.facts.segments).filter(|i| is_small(*i) && (disagrees(*i) || disagrees(i + 1))).collect();
        let figure = |imus: &[usize]| imus.iter().map(|i| self.facts.largest[*i]).fold(0.0, f64::max);
        let (rows, kind) = (self.facts.rows, Kind::Radians);
        if imus.len() > 1 && (0..self.facts.segments).all(is_small) {
            findings.push(Finding { sensor: Source::AllImus, rows, kind, figure: figure(&imus) });
        } else {
            let found =
                |i: &usize| Finding { sensor: Source::Imu { segment: i + 1 }, rows, kind, figure: figure(&[*i]) };
            findings.extend(imus.iter().map(found));
        }
    }

    /// The segments of these whose sensors disagree.
    fn bad(&self, judged: &[usize], wiring: &Wiring) -> Vec<usize> {
        judged.iter().copied().filter(|i| self.fit.misfit(wiring, *i) > MISFIT).collect()
    }

    /// Supposes the fault that explains most, as long as one explains a segment; returns the wiring with all of them.
    fn explain(&self, judged: &[usize], findings: &mut Vec<Finding>) -> Wiring {
        let mut wiring = Wiring::in_order();
        loop {
            let now = self.bad(judged, &wiring);
            if now.is_empty() {
                return wiring;
            }
            let is_allowed = |fault: &Fault| match fault {
                Fault::Gain(_, gain) => gain.is_finite() && !(GAINS[0]..=GAINS[1]).contains(gain),
                _ => true,
            };
            let cost = |fault: &Fault| self.fit.misfits(&wiring.with(*fault));
            let best = self.faults(&wiring).into_iter().filter(is_allowed).min_by(|a, b| cost(a).total_cmp(&cost(b)));
            let Some(fault) = best else { return wiring };
            let then = wiring.with(fault);
            let explains =
                now.iter().any(|i| self.fit.misfit(&then, *i) < EXPLAINED) && self.bad(judged, &then).len() < now.len();
            if !explains {
                return wiring;
            }
            let explained = 100.0 * (1.0 - self.fit.misfits(&then) / self.fit.misfits(&wiring));
            self.report(fault, explained, findings);
            wiring = then;
        }
    }

    /// Reports the segments that no fault of the wiring explains: all of them by one cause, or each.
    fn report_unexplained(&self, wiring: &Wiring, bad: &[usize], findings: &mut Vec<Finding>) {
        if bad.len() == self.fit.segments.len() && bad.len() > 1 {
            let [square, product] = self.fit.sum_by_imus(wiring, bad);
            let bend: f64 = bad.iter().map(|i| self.fit.bend(*i)).sum();
            let correlation = 100.0 * product / (square * bend).sqrt().max(f64::MIN_POSITIVE);
            let (rows, kind) = (self.facts.rows, Kind::Unrelated);
            findings.push(Finding { sensor: Source::AllImus, rows, kind, figure: correlation });
            return;
        }
        for i in bad {
            let source = Source::Imu { segment: *i };
            let is_before_unrelated =
                findings.iter().any(|found| found.sensor == source && found.kind == Kind::Unrelated);
            if !is_before_unrelated {
                self.blame(*i, bad.contains(&(i + 1)) || *i + 1 == self.facts.segments, findings);
            }
        }
    }

    fn report(&self, fault: Fault, explained: f64, findings: &mut Vec<Finding>) {
        let (sensor, kind, figure) = match fault {
            Fault::Gain(imu, gain) => {
                let sensor = imu.map_or(Source::AllImus, |i| Source::Imu { segment: i + 1 });
                (sensor, if gain < 0.0 { Kind::Inverted } else { Kind::Scale }, gain.recip())
            }
            Fault::Imus(i, j) => (Source::TwoImus { segment: i + 1, other: j + 1 }, Kind::Exchanged, explained),
            Fault::Bends(i, j) => (Source::TwoBends { segment: i + 1, other: j + 1 }, Kind::Exchanged, explained),
            Fault::BendSign(i) => return self.blame(i, false, findings),
        };
        findings.push(Finding { sensor, rows: self.facts.rows, kind, figure });
    }

    /// Finds bend sensors that do not follow the IMUs while their twins do.
    fn lone_sensors(&self, findings: &mut Vec<Finding>) {
        for i in &self.fit.segments {
            let correlations = correlations(&self.facts.places[*i]);
            for place in 0..2 {
                if correlations[place] < AGREES && correlations[1 - place] > FOLLOWS {
                    let sensor = Source::Bend { segment: i + 1, place };
                    let figure = 100.0 * correlations[place];
                    findings.push(Finding { sensor, rows: self.facts.rows, kind: Kind::Unrelated, figure });
                }
            }
        }
    }

    /// Finds the sensor of a segment in which no supposed fault of the wiring explains the misfit. An IMU is in the next segment,
    /// too.
    fn blame(&self, i: usize, next_is_bad: bool, findings: &mut Vec<Finding>) {
        let correlations = correlations(&self.facts.places[i]);
        let rows = self.facts.rows;
        if (next_is_bad || self.fit.fits_without(i))
            && correlations.iter().all(|correlation| correlation.abs() < FOLLOWS)
        {
            let figure = 100.0 * correlations[0];
            findings.push(Finding { sensor: Source::Imu { segment: i + 1 }, rows, kind: Kind::Unrelated, figure });
            return;
        }
        for (place, correlation) in correlations.into_iter().enumerate() {
            if correlation < AGREES {
                let kind = if correlation < -FOLLOWS { Kind::Inverted } else { Kind::Unrelated };
                let figure = if kind == Kind::Inverted { correlation } else { 100.0 * correlation };
                findings.push(Finding { sensor: Source::Bend { segment: i + 1, place }, rows, kind, figure });
            }
        }
    }
}

/// Correlations of the steps of a segment's bend sensors with those of its IMUs.
fn correlations([a, b, a_imu, b_imu, imu]: &[f64; 5]) -> [f64; 2] {
    [a_imu / (a * imu).sqrt(), b_imu / (b * imu).sqrt()]
}
