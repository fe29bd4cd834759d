//! Tip errors of constant-curvature kinematics.

use crate::recording::{Sample, bends_rad, differences, record, rms, tared_headings_rad};
use rig_twin::{SEGMENTS, Scenario};

/// Tip of a chain of constant curvatures, m.
fn pcc_tip_m(bends_rad: [f64; SEGMENTS]) -> (f64, f64) {
    let (mut x, mut y, mut heading) = (0.0, 0.0, 0.0_f64);
    for (segment, bend) in bends_rad.into_iter().enumerate() {
        let (sin, cos) = bend.sin_cos();
        let (curve_x, curve_y) =
            if bend.abs() < 1e-6 { (0.0, 0.08) } else { (0.08 / bend * (1.0 - cos), 0.08 / bend * sin) };
        let (offset_x, offset_y) = if segment % 2 == 0 { (0.017 * sin, 0.017 * cos) } else { (0.0, 0.017) };
        let (local_x, local_y) = (curve_x + offset_x, curve_y + offset_y);
        x += local_x * heading.cos() + local_y * heading.sin();
        y += local_y * heading.cos() - local_x * heading.sin();
        heading += bend;
    }
    (x, y)
}

fn tip_rmse_mm(samples: &[Sample], bends: impl Iterator<Item = [f64; SEGMENTS]>) -> f64 {
    let misses = samples.iter().zip(bends).map(|(sample, bends)| {
        let (x, y) = pcc_tip_m(bends);
        let tip = sample.truth[SEGMENTS - 1];
        1e3 * (x - tip.x_m).hypot(y - tip.y_m)
    });
    rms(misses)
}

#[test]
fn exact_angles_miss_the_tip_by_millimetres() {
    for (scenario, range) in
        [(Scenario::FreeSwing, 1.5..4.0), (Scenario::Push, 1.8..6.0), (Scenario::Obstacle, 3.0..6.5)]
    {
        let samples = record(scenario, 2, 300);
        let floor = tip_rmse_mm(&samples, samples.iter().map(|sample| bends_rad(&sample.truth)));
        assert!(range.contains(&floor), "{scenario:?}: {floor} mm");
    }
}

#[test]
fn raw_headings_miss_the_tip_by_the_papers_centimetres() {
    let samples = record(Scenario::FreeSwing, 2, 900);
    let miss = tip_rmse_mm(&samples, tared_headings_rad(&samples).into_iter().map(differences));
    assert!((22.0..40.0).contains(&miss), "{miss} mm; the paper has 33 mm");
}
