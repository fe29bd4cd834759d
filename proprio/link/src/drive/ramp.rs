//! Limit of the pressures' rate of change.

/// Set-points on their way to the wanted pressures.
#[derive(Debug, Clone, PartialEq)]
pub struct Ramp {
    max_pa_per_s: f64,
    now_pa: Vec<f64>,
}

impl Ramp {
    /// So many regulators, vented, changing by `max_pa_per_s` at most.
    #[must_use]
    pub fn new(regulators: usize, max_pa_per_s: f64) -> Self {
        Self { max_pa_per_s, now_pa: vec![0.0; regulators] }
    }

    /// The set-points `step_s` after the last ones, Pa: as near to the wanted ones as the limit allows.
    pub fn step(&mut self, wanted_pa: &[f64], step_s: f64) -> Vec<u32> {
        let max_pa = self.max_pa_per_s * step_s;
        for (now_pa, wanted_pa) in self.now_pa.iter_mut().zip(wanted_pa) {
            *now_pa += (wanted_pa - *now_pa).clamp(-max_pa, max_pa);
        }
        self.now_pa.iter().map(|now_pa| now_pa.round() as u32).collect()
    }

    /// True where no pressure is left.
    #[must_use]
    pub fn is_vented(&self) -> bool {
        self.now_pa.iter().all(|now_pa| *now_pa <= 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::Ramp;

    #[test]
    fn pressures_rise_and_fall_at_the_ramp_and_arrive() {
        let mut ramp = Ramp::new(3, 100e3);
        let up = [1, 2, 3].map(|_| ramp.step(&[12e3, 0.0, 4e3], 0.05));
        assert_eq!(up.map(|pa| [pa[0], pa[2]]), [[5_000, 4_000], [10_000, 4_000], [12_000, 4_000]]);
        let down = [1, 2, 3].map(|_| ramp.step(&[0.0; 3], 0.05)[0]);
        assert_eq!((down, ramp.is_vented()), ([7_000, 2_000, 0], true));
    }
}
