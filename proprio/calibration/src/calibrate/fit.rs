//! Least-squares quadratic of bend angle over voltage.

use calibration_tables::BendToml;
use estimator_core::VOLTS_PER_COUNT;
use nalgebra::{Matrix3, Vector3};

use super::sweep::range;

/// A fitted map and its residuals.
#[derive(Debug, Clone)]
pub(super) struct QuadraticFit {
    pub map: BendToml,
    pub samples: usize,
    /// Root mean square residual, rad.
    pub rmse: f64,
    /// Share of the variance that the map does not explain.
    pub unexplained: f64,
}

/// Fits θ = c2 V² + c1 V + c0 to pairs of counts and true angles (rad); `None` where they do not determine it.
pub(super) fn quadratic(pairs: &[(u16, f64)]) -> Option<QuadraticFit> {
    let [lo, hi] = range(pairs.iter().map(|(counts, _)| volts(*counts)));
    // Within ±1 the normal equations are well conditioned.
    let (middle, half) = (f64::midpoint(lo, hi), (hi - lo) / 2.0);
    let basis = |counts: u16| {
        let u = (volts(counts) - middle) / half;
        Vector3::new(1.0, u, u * u)
    };
    let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for (counts, theta) in pairs {
        let row = basis(*counts);
        normal += row * row.transpose();
        right += row * *theta;
    }
    let b = normal.cholesky()?.solve(&right);

    let n = pairs.len() as f64;
    let mean = pairs.iter().map(|(_, theta)| theta).sum::<f64>() / n;
    let residual = pairs.iter().map(|(counts, theta)| (theta - basis(*counts).dot(&b)).powi(2)).sum::<f64>() / n;
    let variance = pairs.iter().map(|(_, theta)| (theta - mean).powi(2)).sum::<f64>() / n;
    let (slope, curve) = (b.y / half, b.z / (half * half));
    let map = BendToml {
        c0: b.x - slope * middle + curve * middle * middle,
        c1: slope - 2.0 * curve * middle,
        c2: curve,
        rmse_deg: Some(residual.sqrt().to_degrees()),
        volts: Some([lo, hi]),
        curve: None,
        memory: None,
    };
    Some(QuadraticFit { map, samples: pairs.len(), rmse: residual.sqrt(), unexplained: residual / variance })
}

pub(super) fn volts(counts: u16) -> f64 {
    f64::from(counts) * VOLTS_PER_COUNT
}

#[cfg(test)]
mod tests {
    use super::{quadratic, volts};

    #[test]
    fn finds_the_quadratic_that_made_the_data() {
        let pairs: Vec<_> = (500..3500).map(|n| (n, 0.12 * volts(n).powi(2) + 0.7 * volts(n) - 1.4)).collect();
        let map = quadratic(&pairs).expect("3000 distinct voltages").map;
        assert!((map.c2 - 0.12).abs() < 1e-10 && (map.c1 - 0.7).abs() < 1e-10 && (map.c0 + 1.4).abs() < 1e-10);
    }

    #[test]
    fn one_voltage_makes_no_quadratic() {
        assert!(quadratic(&[(1000, 0.0), (1000, 0.1), (1000, 0.2)]).is_none());
    }
}
