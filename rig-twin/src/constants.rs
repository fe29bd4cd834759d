//! Every number of the reference arm, its rig and its programs of motion, with unit and source. Sizes of the flaws of
//! all other arms are in `flaws`.
//!
//! "paper" is arXiv 2511.01165. "assumed" marks what no source gives; those were chosen so that the residual of the
//! V–Orient maps and the drift come out near the paper's.

use core::f64::consts::PI;

use crate::pose::EndPose;

/// One degree in radians.
pub(crate) const DEGREE_RAD: f64 = PI / 180.0;

/// Segments of the longest arm (assumed: what one board has pins for).
pub const MAX_SEGMENTS: usize = 8;
/// Segments of a module, which share a regulator to the right and one to the left (the reference rig's wiring).
pub(crate) const SEGMENTS_PER_MODULE: usize = 2;
/// Places of bend sensors on a segment, a and b (paper).
pub(crate) const SENSORS_PER_SEGMENT: usize = 2;
/// Modules of the longest arm.
pub(crate) const MAX_MODULES: usize = MAX_SEGMENTS / SEGMENTS_PER_MODULE;
/// Pressure regulators of the longest arm, two a module.
pub const MAX_REGULATORS: usize = 2 * MAX_MODULES;

/// Segments of the reference arm: three modules of two (paper).
pub const SEGMENTS: usize = 6;
/// Bend sensors of the reference arm, two a segment (paper).
pub const BEND_SENSORS: usize = SENSORS_PER_SEGMENT * SEGMENTS;
/// Pressure regulators of the reference arm, two a module (the reference rig's wiring).
pub const REGULATORS: usize = SEGMENTS;

// Random numbers.

/// ChaCha seed of the reference arm's tolerances (assumed).
pub(crate) const REFERENCE_ARM_SEED: u64 = 3;

/// Limit of a tolerance, in sigma: a maker rejects parts beyond it (assumed).
pub(crate) const TOLERANCE_LIMIT_SIGMA: f64 = 3.0;

// Time.

/// Grid of the physics (assumed: a fiftieth of the fastest lag).
pub(crate) const GRID_S: f64 = 0.002;
/// Margin at which a sum of steps has reached a grid point, so that rounding never costs a step (assumed).
pub(crate) const GRID_SLACK_S: f64 = 1e-9;
/// Longest single step; longer ones are cut to it (assumed: bounds the time a call can take).
pub(crate) const LONGEST_STEP_S: f64 = 3600.0;
/// Grid points between two outputs of an IMU's fusion: 10 ms, its fastest rate (BNO055 datasheet).
pub(crate) const GRID_POINTS_PER_FUSION: i64 = 5;
/// Time between two outputs of an IMU's fusion.
pub(crate) const FUSION_S: f64 = GRID_S * GRID_POINTS_PER_FUSION as f64;

// Geometry.

/// Arc length of a segment's curved part (paper).
pub(crate) const CURVE_LENGTH_M: f64 = 0.080;
/// Length of a segment's rigid connector (paper).
pub(crate) const CONNECTOR_LENGTH_M: f64 = 0.017;
/// Simpson intervals along a curved part; even (assumed: the tip within 2 µm free, 45 µm under contact).
pub(crate) const SIMPSON_INTERVALS: usize = 8;
/// Elongation at full mean pressure of a module, a share of the curve's length (assumed).
pub(crate) const STRETCH_AT_FULL_PRESSURE: f64 = 0.012;
/// Mean excess of curvature at the far end of a free segment, negative: the near end bends more (assumed).
pub(crate) const SLOPE_MEAN: f64 = -0.12;
/// Spread of that excess over the segments, one sigma (assumed).
pub(crate) const SLOPE_SIGMA: f64 = 0.06;
/// Mean loss of curvature next to the stiff connectors (assumed).
pub(crate) const BULGE_MEAN: f64 = -0.12;
/// Spread of that loss over the segments, one sigma (assumed).
pub(crate) const BULGE_SIGMA: f64 = 0.04;

// Pneumatics and actuators.

/// Pressure of a regulator at full duty (the supply of the reference rig's Enfield TR regulators).
pub(crate) const FULL_SCALE_PA: f64 = 280e3;
/// Time constant of a regulator (assumed).
pub(crate) const REGULATOR_LAG_S: f64 = 0.10;
/// Bend of a segment of average gain at full pressure on one side (assumed).
pub(crate) const FULL_BEND_RAD: f64 = 63.0 * DEGREE_RAD;
/// Share of the bend that stiffening takes away at full pressure, cubic in the pressure (assumed).
pub(crate) const STIFFENING: f64 = 0.15;
/// Spread of the segments' gains, one sigma (assumed).
pub(crate) const GAIN_SIGMA: f64 = 0.03;
/// Radius of the actuator's play (assumed).
pub(crate) const ACTUATOR_PLAY_RAD: f64 = 1.5 * DEGREE_RAD;
/// Time constant of the silicone's prompt response (assumed).
pub(crate) const ACTUATOR_LAG_S: f64 = 0.20;
/// Time constant of the silicone's creep (assumed).
pub(crate) const ACTUATOR_CREEP_S: f64 = 30.0;
/// Share of the bend that comes by creep (assumed).
pub(crate) const ACTUATOR_CREEP_SHARE: f64 = 0.08;

// Programs of motion.

/// Rest at the start of every session (assumed: longer than the tare's 1 s).
pub const REST_S: f64 = 5.0;
/// Time in which the swings grow to full size after the rest (assumed).
pub(crate) const FADE_IN_S: f64 = 4.0;
/// Period range of the sweep's swings, slow, so that a camera follows (assumed).
pub(crate) const SWEEP_PERIODS_S: (f64, f64) = (22.0, 40.0);
/// Peak drive of the sweep, a share of full pressure: the whole range.
pub(crate) const SWEEP_DRIVE: f64 = 1.0;
/// Period range of the free swings of scenario I (assumed).
pub(crate) const FREE_PERIODS_S: (f64, f64) = (6.0, 16.0);
/// Peak drive of scenario I, a share of full pressure (assumed).
pub(crate) const FREE_DRIVE: f64 = 0.75;
/// Period range of the swings of scenarios II and III (assumed).
pub(crate) const CONTACT_PERIODS_S: (f64, f64) = (8.0, 18.0);
/// Peak drive of scenarios II and III, a share of full pressure (assumed).
pub(crate) const CONTACT_DRIVE: f64 = 0.60;
/// Lean of the two lower modules towards the obstacle of scenario III, a share of full pressure (assumed).
pub(crate) const OBSTACLE_LEAN_DRIVE: f64 = 0.20;
/// Period of a swing's envelope, a multiple of the swing's own (assumed).
pub(crate) const ENVELOPE_PERIODS: (f64, f64) = (2.3, 4.1);
/// Mean and swing of the envelope, shares of the peak drive that add up to 1 (assumed).
pub(crate) const ENVELOPE: (f64, f64) = (0.625, 0.375);
/// Period of a swing's change of pace, a multiple of the swing's own (assumed).
pub(crate) const PACE_PERIODS: (f64, f64) = (1.7, 2.9);
/// Size of a swing's change of pace (assumed).
pub(crate) const PACE_RAD: f64 = 0.8;
/// Periods of the slow swings, a multiple of the scenario's (assumed: under a degree a second).
pub(crate) const SLOW_PERIODS: f64 = 12.0;
/// Periods of the fast swings, a multiple of the scenario's (assumed: near the regulators' lag).
pub(crate) const FAST_PERIODS: f64 = 0.25;
/// Pauses in a round, after which they repeat.
pub(crate) const PAUSES: usize = 32;
/// Time of the transition to a pause, and of that back (assumed).
pub(crate) const PAUSE_BLEND_S: f64 = 4.0;
/// Range of the swings between two rests (assumed).
pub(crate) const REST_SPELL_S: (f64, f64) = (20.0, 120.0);
/// Range of the logarithm (base e) of a rest's duration in s: 2 min to 2 h (assumed).
pub(crate) const REST_PAUSE_LOG_S: (f64, f64) = (4.787, 8.882);
/// Share of the rests at which the arm is vented; in the others it holds a pose (assumed).
pub(crate) const REST_VENTED_SHARE: f64 = 0.5;
/// Range of a module's drive in a rest that holds a pose, a share of full pressure (assumed).
pub(crate) const REST_DRIVE: (f64, f64) = (0.0, 0.5);
/// Range of the swings between two leans (assumed).
pub(crate) const LEAN_SPELL_S: (f64, f64) = (60.0, 180.0);
/// Range of the logarithm (base e) of a lean's duration in s: 2 to 10 min (assumed).
pub(crate) const LEAN_PAUSE_LOG_S: (f64, f64) = (4.787, 6.397);
/// Range of a module's drive in a lean, a share of full pressure (assumed).
pub(crate) const LEAN_DRIVE: (f64, f64) = (0.30, 0.60);
/// Share of the swings that is left in a lean (assumed).
pub(crate) const LEAN_SWING_SHARE: f64 = 0.1;
/// Range of a module's drive at the start of a session that begins bent, a share of full pressure (assumed).
pub(crate) const START_DRIVE: (f64, f64) = (0.25, 0.50);
/// Motion before a session that does not begin at rest (assumed: many times the slowest lag but creep).
pub(crate) const LEAD_IN_S: f64 = 30.0;
/// Heading of the tip that the swings of scenarios I to III do not pass (assumed: the arm does not coil up).
pub(crate) const TOTAL_HEADING_RAD: f64 = 190.0 * DEGREE_RAD;

// Sticks of scenario II.

/// Range of the pause between two pushes (assumed).
pub(crate) const PUSH_PAUSE_S: (f64, f64) = (3.0, 10.0);
/// Range of a push's duration (assumed).
pub(crate) const PUSH_DURATION_S: (f64, f64) = (1.5, 6.0);
/// Rise time of a push, and its fall time (assumed).
pub(crate) const PUSH_RISE_S: f64 = 0.5;
/// Range of the bend that a push adds to its segment (assumed).
pub(crate) const PUSH_BEND_RAD: (f64, f64) = (8.0 * DEGREE_RAD, 25.0 * DEGREE_RAD);
/// Range of the place of a push along the curve, a share of its length (assumed).
pub(crate) const PUSH_PLACE: (f64, f64) = (0.25, 0.75);
/// Counter-bend of the two neighbours, a share of the push (assumed).
pub(crate) const PUSH_NEIGHBOUR_SHARE: f64 = 0.35;

// Obstacle of scenario III.

/// Range of the obstacle's distance from the base's axis, across (assumed).
pub(crate) const OBSTACLE_X_M: (f64, f64) = (0.03, 0.07);
/// Length of the reference arm below the obstacle, three segments. Distance and lever scale with the length that an arm
/// has there.
pub(crate) const OBSTACLE_BELOW_M: f64 = 3.0 * (CURVE_LENGTH_M + CONNECTOR_LENGTH_M);
/// Lever from the bending base to the contact (assumed: half the arm below it).
pub(crate) const OBSTACLE_LEVER_M: f64 = 0.16;
/// Most that the obstacle turns the arm back (assumed: then it slides).
pub(crate) const OBSTACLE_YIELD_RAD: f64 = 22.0 * DEGREE_RAD;
/// Wrapping around the contact, a share of the turning back below it (assumed).
pub(crate) const OBSTACLE_WRAP_SHARE: f64 = 0.70;
/// Wrapping of the next segment, a share of the turning back (assumed).
pub(crate) const OBSTACLE_NEXT_SHARE: f64 = 0.25;
/// Place of the contact along its segment's curve, a share of its length (assumed).
pub(crate) const OBSTACLE_PLACE: f64 = 0.30;

/// Half width of the curvature's peak at a contact, a share of the curve's length (assumed).
pub(crate) const CONTACT_HALF_WIDTH: f64 = 0.28;
/// Half width of the bend that a contact causes elsewhere, a share of the curve's length (assumed: nearly the whole
/// curve).
pub(crate) const REACTION_HALF_WIDTH: f64 = 0.48;

// Bend sensors.

/// Length of a sensor's active part, a share of the curve's: 2.2 inch of 80 mm (Spectra Symbol datasheet).
pub(crate) const STRIP_LENGTH: f64 = 0.05588 / CURVE_LENGTH_M;
/// Place of the strip's start on the curve, a share of its length, mean and sigma (assumed: centred, glued by hand).
pub(crate) const STRIP_START: (f64, f64) = ((1.0 - STRIP_LENGTH) / 2.0, 0.02);
/// Share of a strip's sensitivity that lies in its near half, mean and sigma (assumed).
pub(crate) const STRIP_BALANCE: (f64, f64) = (0.5, 0.03);
/// Radii of the strip's plays, its hysteresis (assumed).
pub(crate) const MEMORY_PLAY_RAD: [f64; 3] = [5.0 * DEGREE_RAD, 13.0 * DEGREE_RAD, 28.0 * DEGREE_RAD];
/// Shares of the plays in the strip's response (assumed: strips repeat to 2.5°).
pub(crate) const MEMORY_SHARE: [f64; 3] = [0.12, 0.10, 0.08];
/// Spread of the hysteresis over the sensors, one sigma (assumed).
pub(crate) const MEMORY_SIGMA: f64 = 0.25;
/// Time constant of the strip's relaxation: its resistance overshoots, then settles (assumed).
pub(crate) const STRIP_RELAXATION_S: f64 = 6.0;
/// Share of the overshoot in the strip's response, mean and sigma (assumed).
pub(crate) const STRIP_RELAXATION_SHARE: (f64, f64) = (0.16, 0.06);
/// Time constant of the strip's creep (assumed).
pub(crate) const STRIP_CREEP_S: f64 = 40.0;
/// Share of the creep in the strip's response, mean and sigma (assumed).
pub(crate) const STRIP_CREEP_SHARE: (f64, f64) = (0.04, 0.015);
/// Spread of the creep that a session starts with, one sigma (assumed: how the arm was stored).
pub(crate) const STORED_BEND_SIGMA_RAD: f64 = 6.0 * DEGREE_RAD;
/// Bend of a strip on the straight arm, mean and sigma: mounted pre-bent, it works both ways (assumed).
pub(crate) const PRE_BEND_RAD: (f64, f64) = (110.0 * DEGREE_RAD, 4.0 * DEGREE_RAD);
/// Size of the ripple that the strip's cracked ink lays over its response (assumed: its RMS of 2.5° is below the 3.3°
/// that a quadratic left of one strip's static calibration).
pub(crate) const RIPPLE_RAD: f64 = 3.5 * DEGREE_RAD;
/// Range of the ripple's period over the bend; every strip cracks in its own way (assumed).
pub(crate) const RIPPLE_PERIOD_RAD: (f64, f64) = (56.0 * DEGREE_RAD, 74.0 * DEGREE_RAD);
/// Common-mode error of the strips on both sides of a segment, by warmth, squeeze or stretch, as bend; RMS. It is in
/// each map's residual and cancels in their mean (assumed: errors of 4.72° that did not cancel would result in twice
/// the paper's tip error of the bend sensors, 24.6 mm).
pub(crate) const COMMON_MODE_RAD: f64 = 4.0 * DEGREE_RAD;
/// Time constant of that error (assumed).
pub(crate) const COMMON_MODE_S: f64 = 40.0;
/// Resistance of a flat strip (Spectra Symbol datasheet: 25 kΩ), of which a sensor keeps a factor.
pub(crate) const FLAT_OHM: f64 = 25e3;
/// Spread of the flat resistance, one sigma, a share (Spectra Symbol datasheet: ±30 % at three sigma).
pub(crate) const FLAT_SIGMA: f64 = 0.10;
/// Growth of the resistance with bend, a share of the flat one a radian, mean and sigma (datasheet: at least 2 × at
/// 180°).
pub(crate) const GAUGE_PER_RAD: (f64, f64) = (0.70, 0.06);
/// Fixed resistor of the divider, to the supply (assumed: near the strip's mid resistance).
pub(crate) const DIVIDER_OHM: f64 = 47e3;
/// Largest count of the ADC; its reference is the divider's supply, 3.3 V (SAM3X datasheet, 12 bits).
pub(crate) const ADC_FULL_SCALE_COUNTS: f64 = 4095.0;
/// Noise of a conversion, one sigma (measured on Spectra Symbol strips at 3.3 V: 1.7 to 2.4).
pub(crate) const ADC_NOISE_COUNTS: f64 = 2.0;

// IMUs.

/// Drift of each unit's heading; the reference arm has the first six. The worst turns 45° in 900 s (paper); the others
/// are assumed.
pub(crate) const DRIFT_RAD_PER_S: [f64; MAX_SEGMENTS] = [
    0.010 * DEGREE_RAD,
    -0.008 * DEGREE_RAD,
    0.014 * DEGREE_RAD,
    0.011 * DEGREE_RAD,
    -0.011 * DEGREE_RAD,
    0.050 * DEGREE_RAD,
    0.009 * DEGREE_RAD,
    -0.013 * DEGREE_RAD,
];
/// Spread of a unit's drift between sessions, one sigma, a share (assumed).
pub(crate) const DRIFT_SESSION_SIGMA: f64 = 0.02;
/// Random walk of the drift rate, one sigma after one second (assumed: 1° of heading in 900 s).
pub(crate) const DRIFT_WALK_RAD_PER_S: f64 = 6.4e-5 * DEGREE_RAD;
/// Spread of the gyroscopes' sensitivity over the units, one sigma, a share (assumed: what MEMS gyroscopes are sold
/// with).
pub(crate) const GYRO_SENSITIVITY_SIGMA: f64 = 0.01;
/// White noise of a heading, one sigma (assumed).
pub(crate) const HEADING_NOISE_RAD: f64 = 0.1 * DEGREE_RAD;
/// Heading error by acceleration across the arm, radians for each m/s² (assumed).
pub(crate) const ERROR_PER_ACCELERATION_RAD_S2_PER_M: f64 = 1.5 * DEGREE_RAD;
/// Heading error by angular acceleration, radians for each rad/s² (assumed).
pub(crate) const ERROR_PER_SPIN_S2: f64 = 0.2 * DEGREE_RAD;
/// Time constant of those errors (assumed: the fusion's own filter).
pub(crate) const ACCELERATION_LAG_S: f64 = 0.3;
/// Tilt of a unit in its mount, pitch and roll, one sigma (assumed).
pub(crate) const TILT_SIGMA_RAD: f64 = 1.5 * DEGREE_RAD;
/// Steps of a quaternion's unit (BNO055 datasheet).
pub(crate) const QUATERNION_UNIT_STEPS: f64 = 16384.0;

// Camera.

/// Frames a second (assumed: what most cameras give).
pub(crate) const CAMERA_FRAMES_PER_S: f64 = 30.0;
/// Share of the frames that get lost (assumed).
pub(crate) const CAMERA_DROPPED_SHARE: f64 = 0.03;
/// Share of the frames in which a marker is not found (assumed).
pub(crate) const CAMERA_HIDDEN_SHARE: f64 = 0.005;
/// Noise of a frame's time stamp, one sigma (assumed).
pub(crate) const CAMERA_STAMP_NOISE_S: f64 = 0.002;
/// Time of the camera's clock at time 0 of the rig's (assumed: seconds since 1970, as most computers count).
pub(crate) const CAMERA_CLOCK_AHEAD_S: f64 = 1_760_000_000.0;
/// Rate error of the camera's clock, a share (assumed: two quartzes).
pub(crate) const CAMERA_CLOCK_FAST: f64 = 80e-6;
/// Pose of the arm's base in the camera's frame (assumed: placed by hand).
pub(crate) const CAMERA_BASE: EndPose = EndPose { x_m: 0.310, y_m: -0.240, heading_rad: 4.0 * DEGREE_RAD };
/// Noise of a marker's place, each axis, one sigma (assumed).
pub(crate) const CAMERA_PLACE_NOISE_M: f64 = 0.001;
/// Noise of a marker's heading, one sigma (assumed).
pub(crate) const CAMERA_HEADING_NOISE_RAD: f64 = 0.5 * DEGREE_RAD;
