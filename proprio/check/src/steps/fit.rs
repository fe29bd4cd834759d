//! Misfits of the segments by the mean products of their steps, with the sensors wired in any way.

use super::moments::{Matrix, Moments};
use super::wiring::Wiring;

/// Least number of steps in which the arm moves.
const STEPS: f64 = 10.0;
/// Least root mean square of a segment's steps, deg; its square is added to the denominator of the misfit.
const MOTION: f64 = 2.0;
/// Misfit above which a segment's sensors disagree.
pub(super) const MISFIT: f64 = 0.6;
/// Misfit below which a supposed fault explains a segment.
pub(super) const EXPLAINED: f64 = 0.35;

/// Mean products of the steps, and the segments that can be judged, from 0.
pub(super) struct Fit {
    imu_imu: Matrix,
    imu_bend: Matrix,
    bend_bend: Matrix,
    pub segments: Vec<usize>,
}

impl Fit {
    /// The fit of `count` segments of which those are judged that have steps with motion, and of which `is_allowed` is true.
    pub fn new(moments: &Moments, count: usize, is_allowed: impl Fn(usize) -> bool) -> Self {
        let (imu_imu, imu_bend, bend_bend) = (moments.imu_imu(), moments.imu_bend(), moments.bend_bend());
        let can_be_judged =
            |i: &usize| moments.count(*i) >= STEPS && bend_bend[*i][*i] >= MOTION * MOTION && is_allowed(*i);
        let segments = (0..count).filter(can_be_judged).collect();
        Self { imu_imu, imu_bend, bend_bend, segments }
    }

    /// Mean square of the steps of a segment by the bend sensors.
    pub fn bend(&self, i: usize) -> f64 {
        self.bend_bend[i][i]
    }

    /// Mean square of a segment's step by its IMUs, and its product with the step by the bend sensors.
    fn by_imus(&self, wiring: &Wiring, i: usize) -> [f64; 2] {
        let (own, bend) = (wiring.imu[i], wiring.bend[i]);
        let gain = wiring.gain[own];
        let [mut square, mut product] = [gain * gain * self.imu_imu[own][own], gain * self.imu_bend[own][bend]];
        if let Some(before) = i.checked_sub(1).map(|before| wiring.imu[before]) {
            let gain_before = wiring.gain[before];
            square +=
                gain_before * (gain_before * self.imu_imu[before][before] - 2.0 * gain * self.imu_imu[own][before]);
            product -= gain_before * self.imu_bend[before][bend];
        }
        [square, wiring.bend_sign[i] * product]
    }

    /// The misfit of a segment.
    pub fn misfit(&self, wiring: &Wiring, i: usize) -> f64 {
        let [square, product] = self.by_imus(wiring, i);
        let bend = self.bend_bend[wiring.bend[i]][wiring.bend[i]];
        (square - 2.0 * product + bend) / (square + bend + MOTION * MOTION)
    }

    /// Sum of the misfits.
    pub fn misfits(&self, wiring: &Wiring) -> f64 {
        self.segments.iter().map(|i| self.misfit(wiring, *i)).sum()
    }

    /// True where this segment and the next one together fit the IMUs before and behind them, without the IMU between them.
    pub fn fits_without(&self, i: usize) -> bool {
        let next = i + 1;
        if !self.segments.contains(&next) {
            return false;
        }
        let product = |imu: usize| self.imu_bend[imu][i] + self.imu_bend[imu][next];
        let (mut square, mut both) = (self.imu_imu[next][next], product(next));
        if let Some(before) = i.checked_sub(1) {
            square += self.imu_imu[before][before] - 2.0 * self.imu_imu[next][before];
            both -= product(before);
        }
        let bend = self.bend_bend[i][i] + self.bend_bend[next][next] + 2.0 * self.bend_bend[next][i];
        (square - 2.0 * both + bend) / (square + bend + MOTION * MOTION) < EXPLAINED
    }

    /// The gain of all IMUs by which they fit best.
    pub fn common_gain(&self, wiring: &Wiring) -> f64 {
        let [square, product] = self.sum_by_imus(wiring, &self.segments);
        product / square
    }

    /// Sums of [`Self::by_imus`] over these segments.
    pub fn sum_by_imus(&self, wiring: &Wiring, segments: &[usize]) -> [f64; 2] {
        let each = segments.iter().map(|i| self.by_imus(wiring, *i));
        each.fold([0.0; 2], |sum, [square, product]| [sum[0] + square, sum[1] + product])
    }

    /// The gain of one IMU by which its heading fits the bend angles up to it best.
    pub fn gain(&self, i: usize) -> f64 {
        let product: f64 = (0..=i).map(|j| self.imu_bend[i][j]).sum();
        product / self.imu_imu[i][i]
    }
}
