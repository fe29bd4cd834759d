//! Sizes of the flaws from which every arm but the reference arm is drawn, with unit and source.
//!
//! A pair named `…_RANGE` holds the bounds of a uniform draw; `…_SIGMA` is the standard deviation of
//! a normal draw, whose tails are cut at 3 sigma. "Batch" marks what all devices of an arm have in
//! common, drawn once for each arm; the devices then differ by a sigma. "assumed" marks what no
//! source gives. No size was fitted to a recording. The slow error, its shared part and the offset
//! were first larger; they were reduced on arms 1 to 12, until the tip errors of version 0.1 there were
//! about as large as on arms of other simulators.
//!
//! Sources: "BNO055", "BMI055" are Bosch's datasheets (BST-BNO055-DS000, BST-BMI055-DS000; the
//! gyroscope is the same); "Spectra Symbol" is the datasheet of the flex sensor FS; "paper" is
//! arXiv 2511.01165.

use crate::constants::DEGREE_RAD;

// Geometry.

/// Share by which a curve's true length departs from the nominal one (assumed: cast by hand, 0.3 mm).
pub(crate) const LENGTH_SIGMA: f64 = 0.004;
/// Share by which a connector's length departs from the nominal one (assumed: printed, 0.1 mm).
pub(crate) const CONNECTOR_SIGMA: f64 = 0.006;
/// Elongation at full mean pressure of a module, a share (assumed; batch).
pub(crate) const STRETCH_RANGE: (f64, f64) = (0.004, 0.020);
/// Excess of curvature at a segment's far end (assumed; batch).
pub(crate) const SLOPE_RANGE: (f64, f64) = (-0.25, 0.10);
/// Spread of that excess over the segments (assumed).
pub(crate) const SLOPE_SIGMA: f64 = 0.08;
/// Loss of curvature next to the connectors, negative (assumed; batch).
pub(crate) const BULGE_RANGE: (f64, f64) = (-0.25, 0.05);
/// Spread of that loss over the segments (assumed).
pub(crate) const BULGE_SIGMA: f64 = 0.06;
/// Bend of a vented segment (assumed: a cast arm is not quite straight).
pub(crate) const REST_BEND_SIGMA_RAD: f64 = 0.2 * DEGREE_RAD;

// Regulators and actuators.

/// Time constant of a regulator (assumed).
pub(crate) const REGULATOR_LAG_RANGE_S: (f64, f64) = (0.05, 0.25);
/// Share by which a regulator's full scale is off (assumed: 2 % of full scale).
pub(crate) const REGULATOR_GAIN_SIGMA: f64 = 0.02;
/// Offset of a regulator, a share of full scale (assumed).
pub(crate) const REGULATOR_OFFSET_SIGMA: f64 = 0.005;
/// Spread of a segment's gain, which makes the two segments of a module bend unlike (assumed).
pub(crate) const ACTUATOR_GAIN_SIGMA: f64 = 0.10;
/// Share by which a segment bends more to its right and less to its left (assumed).
pub(crate) const ACTUATOR_ASYMMETRY_SIGMA: f64 = 0.05;
/// Share of the bend that stiffening takes away at full pressure (assumed).
pub(crate) const STIFFENING_RANGE: (f64, f64) = (0.05, 0.30);
/// Half width of the actuator's play (assumed).
pub(crate) const ACTUATOR_PLAY_RANGE_RAD: (f64, f64) = (0.8 * DEGREE_RAD, 3.0 * DEGREE_RAD);
/// Time constant of the silicone's prompt response (assumed).
pub(crate) const ACTUATOR_LAG_RANGE_S: (f64, f64) = (0.12, 0.35);
/// Time constant of the silicone's creep (assumed).
pub(crate) const ACTUATOR_CREEP_RANGE_S: (f64, f64) = (15.0, 120.0);
/// Share of the bend that comes by creep (assumed).
pub(crate) const ACTUATOR_CREEP_SHARE_RANGE: (f64, f64) = (0.03, 0.12);

// Bend sensors: the strip.

/// Active length, a share of the curve's: 40 to 60 mm of 80 mm (Spectra Symbol sells 55.9 mm; batch).
pub(crate) const STRIP_LENGTH_RANGE: (f64, f64) = (0.50, 0.75);
/// Distance of the strip's middle from the curve's, a share of its length (assumed: 2.4 mm).
pub(crate) const STRIP_PLACE_SIGMA: f64 = 0.03;
/// Share of the sensitivity in the strip's near half, around a half (assumed).
pub(crate) const STRIP_BALANCE_SIGMA: f64 = 0.05;
/// Bend of a strip on the straight arm (assumed: mounted pre-bent; batch).
pub(crate) const PRE_BEND_RANGE_RAD: (f64, f64) = (90.0 * DEGREE_RAD, 125.0 * DEGREE_RAD);
/// Spread of the pre-bend over the strips (assumed).
pub(crate) const PRE_BEND_SIGMA_RAD: f64 = 5.0 * DEGREE_RAD;
/// Growth of the resistance with bend, a share of the flat one a radian (Spectra Symbol: at least
/// twice at 180°, 0.32; strips on sale reach four times, 0.95; batch).
pub(crate) const GAUGE_RANGE_PER_RAD: (f64, f64) = (0.50, 0.90);
/// Share by which the strips' growth departs from their batch's (assumed).
pub(crate) const GAUGE_SIGMA: f64 = 0.10;
/// Cubic term of the response to bend from the straight arm, 1/rad² (assumed: 4° at 50°, of which a
/// quadratic map leaves 0.6° RMS).
pub(crate) const CUBIC_RANGE_PER_RAD2: (f64, f64) = (-0.10, 0.10);
/// Size of the ripple over the response (assumed; batch).
pub(crate) const RIPPLE_RANGE_RAD: (f64, f64) = (0.5 * DEGREE_RAD, 2.5 * DEGREE_RAD);
/// Period of the ripple over the bend (assumed).
pub(crate) const RIPPLE_PERIOD_RANGE_RAD: (f64, f64) = (45.0 * DEGREE_RAD, 90.0 * DEGREE_RAD);
/// Share by which the strips' ripple and hysteresis depart from their batch's (assumed).
pub(crate) const STRIP_SIGMA: f64 = 0.20;
/// Shares of the plays in the response, a multiple of the reference arm's (assumed; batch).
pub(crate) const MEMORY_SCALE_RANGE: (f64, f64) = (0.2, 1.0);
/// Half widths of the plays, a multiple of the reference arm's (assumed; batch).
pub(crate) const PLAY_SCALE_RANGE: (f64, f64) = (0.6, 1.4);
/// Time constant of the overshoot's relaxation (assumed).
pub(crate) const RELAXATION_RANGE_S: (f64, f64) = (2.0, 12.0);
/// Share of the overshoot in the response (assumed).
pub(crate) const RELAXATION_SHARE_RANGE: (f64, f64) = (0.0, 0.12);
/// Time constants of the fast and the slow creep (assumed: seconds to ten minutes).
pub(crate) const CREEP_RANGES_S: [(f64, f64); 2] = [(8.0, 60.0), (120.0, 600.0)];
/// Shares of the fast and the slow creep in the response (assumed).
pub(crate) const CREEP_SHARE_RANGES: [(f64, f64); 2] = [(0.01, 0.06), (0.01, 0.08)];
/// Bend from storage that the fast and the slow creep start from (assumed; by session).
pub(crate) const STORED_BEND_SIGMAS_RAD: [f64; 2] = [6.0 * DEGREE_RAD, 12.0 * DEGREE_RAD];
/// Change of the resistance with temperature, a share for each K (assumed: ±1000 ppm/K, carbon ink;
/// batch).
pub(crate) const STRIP_RANGE_PER_K: (f64, f64) = (-1.0e-3, 1.0e-3);
/// Spread of that change over the strips; what differs does not cancel in a pair (assumed).
pub(crate) const STRIP_SIGMA_PER_K: f64 = 0.25e-3;
/// Noise of a conversion, counts (measured on Spectra Symbol strips at 3.3 V: 1.7 to 2.4; batch).
pub(crate) const ADC_NOISE_RANGE_COUNTS: (f64, f64) = (1.5, 4.0);

// Bend sensors: slow errors of a pair.

/// RMS of the slow error of a strip (assumed; batch).
pub(crate) const SLOW_ERROR_RANGE_RAD: (f64, f64) = (0.5 * DEGREE_RAD, 2.0 * DEGREE_RAD);
/// Share of its power that both strips of a segment take for the same bend, so that it does not
/// cancel in their mean; the rest cancels (assumed; batch).
pub(crate) const SLOW_ERROR_SHARED_RANGE: (f64, f64) = (0.0, 0.5);
/// Logarithm (base e) of its time constant in s: 20 to 600 s (assumed; batch).
pub(crate) const SLOW_ERROR_LOG_RANGE: (f64, f64) = (2.996, 6.397);
/// Share of the arms whose pairs of strips have a constant offset in each session (assumed).
pub(crate) const OFFSET_SHARE_OF_ARMS: f64 = 0.3;
/// Largest offset of such an arm, three sigma over its segments and sessions (assumed: stored bent,
/// connectors plugged again; batch).
pub(crate) const OFFSET_RANGE_RAD: (f64, f64) = (1.0 * DEGREE_RAD, 4.0 * DEGREE_RAD);
/// Bend that warmth makes both strips of a segment mistake alike, for each K (assumed).
pub(crate) const THERMAL_BEND_SIGMA_RAD_PER_K: f64 = 0.08 * DEGREE_RAD;

// IMUs.

/// Share by which a unit's angles are too large or too small (BNO055: ±3 % at most).
pub(crate) const SENSITIVITY_RANGE: (f64, f64) = (-0.03, 0.03);
/// Pitch and roll of a unit in its mount (assumed).
pub(crate) const MOUNT_TILT_SIGMA_RAD: f64 = 3.0 * DEGREE_RAD;
/// Angle between a unit's axis of rotation and the vertical (assumed: the plane is not level).
pub(crate) const PLANE_TILT_RANGE_RAD: (f64, f64) = (0.0, 6.0 * DEGREE_RAD);
/// Bias of the rate that a unit has in all sessions (assumed: left by the fusion's calibration).
pub(crate) const BIAS_SIGMA_RAD_PER_S: f64 = 0.008 * DEGREE_RAD;
/// Turn-on bias of the rate, one sigma over sessions (assumed: three sigma are 0.024 to 0.09 °/s
/// around the paper's worst unit, 45° in 900 s; batch).
pub(crate) const TURN_ON_RANGE_RAD_PER_S: (f64, f64) = (0.008 * DEGREE_RAD, 0.030 * DEGREE_RAD);
/// Bias instability of the rate, RMS (assumed: 4 to 14 °/h, consumer MEMS gyroscopes; batch).
pub(crate) const INSTABILITY_RANGE_RAD_PER_S: (f64, f64) = (0.001 * DEGREE_RAD, 0.004 * DEGREE_RAD);
/// Time over which that instability is correlated (assumed).
pub(crate) const INSTABILITY_RANGE_S: (f64, f64) = (60.0, 600.0);
/// Random walk of the rate, one sigma after one second (assumed: 0.5 to 3° of heading in 900 s).
pub(crate) const RATE_WALK_RANGE_RAD_PER_S: (f64, f64) = (3e-5 * DEGREE_RAD, 2e-4 * DEGREE_RAD);
/// Random walk of the heading, one sigma after one second (BNO055, BMI055: 0.014 °/s/√Hz; a
/// fusion without magnetometer integrates it).
pub(crate) const HEADING_WALK_RAD: f64 = 0.014 * DEGREE_RAD;
/// Change of the rate with temperature, for each K (BMI055: 0.015 °/s before the fusion's
/// calibration; assumed: a tenth is left).
pub(crate) const RATE_SIGMA_RAD_PER_S_PER_K: f64 = 0.0015 * DEGREE_RAD;
/// White noise of a heading (assumed).
pub(crate) const HEADING_NOISE_RANGE_RAD: (f64, f64) = (0.05 * DEGREE_RAD, 0.20 * DEGREE_RAD);
/// Errors by acceleration, a multiple of the reference arm's (assumed; batch).
pub(crate) const ACCELERATION_SCALE_RANGE: (f64, f64) = (0.3, 1.5);

// Temperature, drawn by session.

/// Room temperature of a session against that of the arm's nominal parameters (assumed).
pub(crate) const AMBIENT_SIGMA_K: f64 = 2.0;
/// Warming-up of the electronics on the arm (assumed).
pub(crate) const WARM_UP_K: (f64, f64) = (1.0, 8.0);
/// Time constant of the warming-up (assumed).
pub(crate) const WARM_UP_S: (f64, f64) = (180.0, 1200.0);
/// Amplitude of the room's heating cycle (assumed).
pub(crate) const CYCLE_K: (f64, f64) = (0.0, 1.0);
/// Period of that cycle (assumed).
pub(crate) const CYCLE_S: (f64, f64) = (600.0, 2400.0);
