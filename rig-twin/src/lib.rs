//! Soft arms and their sensors, simulated: the reference arm, and a family of others.
//!
//! An arm of 1 to 8 segments bends in a plane: two segments are a module, under a pressure regulator to the right and
//! one to the left. Up to two bend sensors and a BNO055 unit on each segment measure it with the flaws of real sensors.
//! The reference arm has six segments, twelve bend sensors and six units. The same seed results in the same bits on every platform: all
//! random numbers come from `ChaCha` streams, all transcendental functions from `libm`, and time is a fixed grid.
//!
//! Angles are rad, clockwise positive (towards +x); lengths are m; y is along the base's tangent.
//!
//! # The family
//!
//! [`Setup::arm_seed`] selects the arm. 0 is the reference arm; any other seed draws an arm of its own: lengths and
//! curvature, regulators and actuators, strips, IMUs. `flaws.rs` has the size of every flaw with its source.
//! [`Setup::layout`] selects the segments, their nominal lengths and their sensors.
//! [`Setup::seed`] draws the properties of a session (turn-on biases, temperature, stored creep, offsets of the strips,
//! noise). [`Motion`] selects the motion: swings as in the paper, or rests, leans, one module alone, slow, fast, starts
//! that are bent or moving. [`HeadingDrift`] adds the drift of a real IMU.
//!
//! # Flaws of the reference arm
//!
//! - Segments do not bend with constant curvature, least of all in contact, and they stretch a little: with exact bend
//!   angles, constant-curvature kinematics have a tip error of 2 to 5 mm.
//! - Bend sensors have tolerances, hysteresis, an overshoot that relaxes, creep, a ripple that a quadratic cannot fit,
//!   a common-mode error of both sensors of a segment, and 2 counts of noise: the best quadratic has a mean error of
//!   4.7°. Sensor b is mounted the other way round, so that its counts fall where those of a rise, and the common-mode
//!   error cancels.
//! - IMU headings start at random and drift: units 1 to 6 by 0.010, −0.008, 0.014, 0.011, −0.011 and 0.050 °/s, of
//!   which the last is 45° in 900 s. The rates vary by some percent between sessions and have a random walk;
//!   acceleration adds a degree or two, and the gyroscopes' sensitivities differ by 1 %.
//!
//! Tolerances belong to the arm and are the same in every session, so a calibration on [`Scenario::Sweep`] holds for
//! all sessions. The flaws' sizes were chosen so that the errors of maps and drift are near the paper's: agreement of
//! results on the twin with the paper's is no evidence for either.
//!
//! # Faults
//!
//! [`Rig::inject`] lets sensors fail: a [`Fault`] has a name, such as `imu3:reset` or `bend2a:factor=1.3`, and a
//! [`TimedFault`] a begin and an end. A rig without faults is the same to the bit as one that knows none.
//!
//! Contacts are modelled by their effect on the curvature; there are no forces.
//!
//! # Example
//!
//! ```
//! use rig_twin::{MotionProgram, Rig, Scenario};
//!
//! let (scenario, seed) = (Scenario::FreeSwing, 7);
//! let program = MotionProgram::new(scenario, seed);
//! let mut rig = Rig::new(scenario, seed);
//! for _ in 0..2000 {
//!     rig.step(0.01, &program.duties(rig.time_s()));
//! }
//! let tip = rig.truth()[rig_twin::SEGMENTS - 1];
//! assert!(tip.x_m.hypot(tip.y_m) < 0.6, "the arm is 0.582 m long");
//! assert!(rig.adc_counts().into_iter().flatten().all(|counts| counts > 0 && counts < 4095));
//! ```

mod actuator;
mod arm;
mod arm_file;
mod bno055;
mod camera;
mod constants;
mod contact;
mod faults;
mod flaws;
mod flex;
mod gauss_markov;
mod heading_drift;
mod layout;
mod motion;
mod noise;
mod pose;
mod program;
mod rig;
mod scenario;
mod setup;
mod shape;
mod smooth_step;
mod temperature;

pub use camera::{Camera, Frame};
pub use constants::{BEND_SENSORS, MAX_REGULATORS, MAX_SEGMENTS, REGULATORS, REST_S, SEGMENTS};
pub use contact::Push;
pub use faults::{BendPlace, Fault, FaultError, Hold, SegmentNumber, TimedFault, parse_schedule, reference_table};
pub use heading_drift::HeadingDrift;
pub use layout::{Layout, LayoutError, PerBendSensor, PerRegulator, PerSegment, SegmentLayout};
pub use motion::Motion;
pub use pose::EndPose;
pub use program::MotionProgram;
pub use rig::Rig;
pub use scenario::Scenario;
pub use setup::Setup;
