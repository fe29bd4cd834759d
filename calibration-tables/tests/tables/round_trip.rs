//! A file is written and read without loss: every number to its last bit, every name to its last character.

use calibration_tables::{
    AnchorToml, ArmFile, BendToml, CalibrationToml, ChangeToml, ContactToml, CoupledToml, DriftKind, DriftToml,
    DriftTuningToml, NoiseToml, PlayToml, RmseToml, SegmentToml, Side, StopReason, TareToml, TuningToml,
    UncertaintyToml,
};
use proptest::option;
use proptest::prelude::*;
use serde::de::IgnoredAny;

/// Numbers of every magnitude between the two powers of ten.
fn magnitude(powers: std::ops::Range<f64>) -> impl Strategy<Value = f64> {
    powers.prop_map(|power| 10.0_f64.powf(power))
}

/// A map that only rises or only falls: its angles at both ends, and a curvature that leaves a slope at both.
fn monotonic_map() -> impl Strategy<Value = BendToml> {
    map_over((0.0..3.0_f64, 0.2..3.3_f64).prop_map(|(lo, width)| [lo, (lo + width).min(3.3)]))
}

fn map_over(volts: impl Strategy<Value = [f64; 2]>) -> impl Strategy<Value = BendToml> {
    let angles = (-3.0..3.0_f64, prop_oneof![-3.0..-0.05_f64, 0.05..3.0_f64]);
    let curve = -0.9..0.9_f64;
    (volts, angles, curve, option::of(0.0..360.0_f64)).prop_map(|([lo, hi], (at_lo, rise), curve, rmse_deg)| {
        let width = hi - lo;
        let c2 = curve * rise / (width * width);
        let c1 = rise / width - c2 * (lo + hi);
        BendToml { c0: at_lo - (c2 * lo + c1) * lo, c1, c2, rmse_deg, volts: Some([lo, hi]), curve: None, memory: None }
    })
}

/// A map without `volts`, which is therefore valid over the whole range.
fn bare_map() -> impl Strategy<Value = BendToml> {
    map_over(Just([0.0, 3.3])).prop_map(|map| BendToml { volts: None, ..map })
}

fn noise() -> impl Strategy<Value = NoiseToml> {
    let q = prop_oneof![Just(0.0), magnitude(-300.0..6.0)];
    let h = || 0.5..1.25_f64;
    (q, magnitude(-7.0..1.0), magnitude(-4.9..4.9), h(), h()).prop_map(|(q, r_bend, ratio, h_imu, h_bend)| NoiseToml {
        q,
        r_imu: r_bend * ratio,
        r_bend,
        h_imu,
        h_bend,
    })
}

fn segment() -> impl Strategy<Value = SegmentToml> {
    let lengths = (0.1..500.0_f64, prop_oneof![Just(0.0), Just(-0.0), 0.0..500.0_f64]);
    let bend = option::of(prop::collection::vec(prop_oneof![monotonic_map(), bare_map()], 0..=2));
    let play = (0.0..180.0_f64, -1.0..1.0_f64);
    let play = play.prop_map(|(radius_deg, weight)| PlayToml { radius_deg, weight });
    let hysteresis = prop::collection::vec(play, 0..=3);
    let side = prop_oneof![Just(Side::Start), Just(Side::End)];
    (lengths, side, bend, hysteresis, option::of(noise()), option::of(noise())).prop_map(
        |((length_mm, offset_mm), offset_at, bend, hysteresis, orient, coord)| SegmentToml {
            length_mm,
            offset_mm,
            offset_at,
            bend,
            hysteresis,
            bend_error: None,
            imu_scale: None,
            coupled_to: None,
            contact: None,
            orient,
            coord,
        },
    )
}

fn drift() -> impl Strategy<Value = DriftToml> {
    let kind = prop_oneof![Just(DriftKind::Anchor), Just(DriftKind::Kalman), Just(DriftKind::Observer)];
    let headings = (0.0..30.0_f64, 0.0..10.0_f64, 1e-4..0.2_f64, 1e-3..1.0_f64, 1e-5..0.01_f64);
    (kind, headings, 0.0..20.0_f64, 64.0..1e6_f64).prop_map(|(kind, headings, offset_deg, offset_s)| {
        let (start_deg, straightness_deg, rate_deg_per_s, angle_random_walk, rate_random_walk) = headings;
        DriftToml {
            kind,
            start_deg,
            straightness_deg,
            rate_deg_per_s,
            angle_random_walk_deg_per_sqrt_s: angle_random_walk,
            rate_random_walk_deg_per_s_sqrt_s: rate_random_walk,
            offset_deg,
            offset_s,
        }
    })
}

fn change() -> impl Strategy<Value = ChangeToml> {
    (0.1..90.0_f64, 0.0..90.0_f64).prop_map(|(change_deg, motion_deg)| ChangeToml { change_deg, motion_deg })
}

fn contact() -> impl Strategy<Value = ContactToml> {
    (0.1..90.0_f64, 0.1..90.0_f64).prop_map(|(bend_deg, coupling_deg)| ContactToml { bend_deg, coupling_deg })
}

fn uncertainty() -> impl Strategy<Value = UncertaintyToml> {
    (0.0..9.0_f64, 0.0..10.0_f64, 0.0..9.0_f64, 0.0..9.0_f64, 0.0..9.0_f64, 0.0..100.0_f64).prop_map(
        |(theta_deg, bias_share, bend_deg, contact_deg, heading_deg, end_mm)| UncertaintyToml {
            theta_deg,
            bias_share,
            retired: IgnoredAny,
            bend_deg,
            contact_deg,
            heading_deg,
            end_mm,
        },
    )
}

/// Segments, each of which may be coupled to the first.
fn segments() -> impl Strategy<Value = Vec<SegmentToml>> {
    let coupled = (-7.9..7.9_f64, option::of(-7.9..7.9_f64), -10.0..10.0_f64, -30.0..30.0_f64, option::of(change()));
    let coupled = coupled.prop_map(|(ratio, ratio_left, lag_s, play_deg, limit)| CoupledToml {
        segment: 1,
        ratio,
        ratio_left,
        lag_s,
        play_deg,
        limit,
    });
    let later = (segment(), option::of(coupled), option::of(change()));
    let later = later.prop_map(|(segment, coupled_to, contact)| SegmentToml { coupled_to, contact, ..segment });
    (segment(), prop::collection::vec(later, 0..16))
        .prop_map(|(first, later)| std::iter::once(first).chain(later).collect())
}

fn rmse() -> impl Strategy<Value = RmseToml> {
    (magnitude(-300.0..9.0), magnitude(-3.0..9.0), prop_oneof![Just(0.0), 0.0..180.0_f64]).prop_map(
        |(position_rmse_mm, tip_rmse_mm, heading_rmse_deg)| RmseToml {
            position_rmse_mm,
            tip_rmse_mm,
            heading_rmse_deg,
        },
    )
}

fn drift_tuning() -> impl Strategy<Value = DriftTuningToml> {
    let pair = || [magnitude(-5.0..1.0), magnitude(-5.0..1.0)];
    (any::<u32>(), pair(), pair(), pair(), pair(), pair()).prop_map(
        |(runs, rate_deg_per_s, rate_random_walk, angle_random_walk, offset_deg, offset_s)| DriftTuningToml {
            runs: runs.into(),
            rate_deg_per_s,
            rate_random_walk_deg_per_s_sqrt_s: rate_random_walk,
            angle_random_walk_deg_per_sqrt_s: angle_random_walk,
            offset_deg,
            offset_s,
        },
    )
}

fn date() -> impl Strategy<Value = Option<String>> {
    option::of("[0-9]{4}-[0-9]{2}-[0-9]{2}")
}

fn calibration() -> impl Strategy<Value = CalibrationToml> {
    let sessions = prop::collection::vec(any::<String>(), 1..4);
    (sessions, date()).prop_map(|(sessions, date)| CalibrationToml { sessions, date })
}

fn tuning() -> impl Strategy<Value = TuningToml> {
    let sessions = prop::collection::vec(any::<String>(), 1..4);
    let stop_reason = prop_oneof![Just(StopReason::Converged), Just(StopReason::Interrupted)];
    let iterations = (0..=300_u64, 0..=300_u64);
    let extended = (option::of(1.0..1e9_f64), option::of(drift_tuning()), date());
    (sessions, iterations, stop_reason, extended, [rmse(), rmse(), rmse(), rmse()]).prop_map(
        |(
            sessions,
            (iterations, best_iteration),
            stop_reason,
            extended,
            [before, after, validation_before, validation_after],
        )| {
            TuningToml {
                sessions,
                date: extended.2,
                iterations: iterations.max(best_iteration),
                best_iteration,
                stop_reason,
                covariance_inflation: extended.0,
                drift: extended.1,
                observer: IgnoredAny,
                before,
                after,
                validation_before,
                validation_after,
            }
        },
    )
}

fn file() -> impl Strategy<Value = ArmFile> {
    let tare = (0.0..3600.0_f64, prop_oneof![Just(None), Just(Some(-0.0)), (-3600.0..3600.0_f64).prop_map(Some)]);
    let anchor = (1..=1000_u16, 0.0..360.0_f64, magnitude(-2.0..4.0));
    let records = (
        option::of(drift()),
        option::of(contact()),
        option::of(uncertainty()),
        option::of(tuning()),
        option::of(calibration()),
    );
    (any::<String>(), magnitude(-2.0..4.0), tare, anchor, records, segments()).prop_map(
        |(arm, rate_hz, (seconds, heading), (window, threshold_deg, anchor_hz), records, segments)| ArmFile {
            format: 1,
            arm,
            rate_hz,
            tare: TareToml { seconds, heading_deg: heading.map_or_else(Vec::new, |deg| vec![deg; segments.len()]) },
            anchor: AnchorToml { window, threshold_deg, rate_hz: anchor_hz },
            drift: records.0,
            contact: records.1,
            uncertainty: records.2,
            calibration: records.4,
            tuning: records.3,
            // In board.rs.
            board: None,
            segments,
        },
    )
}

proptest! {
    #[test]
    fn what_is_written_is_read_to_the_last_bit(file in file()) {
        let text = file.to_toml();
        let read = ArmFile::parse(&text).map_err(|error| TestCaseError::fail(format!("{error}\n{text}")))?;
        prop_assert_eq!(&read, &file);
        // The Debug form of a float is exact, and distinguishes −0 from 0, which == does not.
        prop_assert_eq!(format!("{read:?}"), format!("{file:?}"));
    }

    #[test]
    fn writing_is_stable(file in file()) {
        let text = file.to_toml();
        let again = ArmFile::parse(&text).map_err(|error| TestCaseError::fail(error.to_string()))?.to_toml();
        prop_assert_eq!(again, text);
    }
}

#[test]
fn names_with_every_kind_of_character_come_back() {
    for name in
        ["", "planar \"6\"", "a\\b", "line\nbreak\r\n", "'''", "\"\"\"", "arm № 6 🦾", "\u{7f}\u{1}\t", "\u{feff}"]
    {
        let text = super::common::DESCRIPTION;
        let file = ArmFile { arm: name.to_owned(), ..super::common::parse(text) };
        assert_eq!(ArmFile::parse(&file.to_toml()).expect("it was written by us").arm, name);
    }
}

#[test]
fn a_written_table_has_a_line_a_sensor_list_and_a_filter() {
    let text = super::common::parse(super::common::TABLE).to_toml();
    for start in ["bend = [{ c0 = ", "orient = { q = ", "coord = { q = ", "[[segment]]", "[tare]", "[anchor]"] {
        assert!(text.lines().any(|line| line.starts_with(start)), "no line begins with {start}: {text}");
    }
}
