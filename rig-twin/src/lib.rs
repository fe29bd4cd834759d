//! Soft arms and their sensors, simulated: the reference arm, and a family of others.
//!
//! Three modules of two segments bend in a plane under six pressure regulators; twelve bend sensors and six BNO055 units watch
//! them with the flaws that real ones have. The same seed gives the same bits on every platform: all random numbers come from
//! `ChaCha` streams, all transcendental functions from `libm`, and time is a fixed grid.
//!
//! Angles are rad, clockwise positive (towards +x); lengths are m; y is along the base's tangent.
//!
//! # The family
//!
//! [`Setup::arm_seed`] selects the arm. 0 is the reference arm; any other seed draws an arm of its own: lengths and curvature,
//! regulators and actuators, strips, IMUs. `flaws.rs` has the size of every flaw with its source. What differs between sessions
//! (turn-on biases, temperature, stored creep, offsets of the strips, noise) comes from [`Setup::seed`]. [`Motion`] selects how
//! the arm moves: swings as in the paper, or rests, leans, one module alone, slow, fast, starts that are bent or moving.
//! [`HeadingDrift`] adds the drift of a real IMU.
//!
//! # What is wrong with the reference arm
//!
//! - Segments do not bend with constant curvature, least of all where something touches them, and they stretch a little: exact
//!   bend angles put through constant-curvature kinematics miss the true tip by 2 to 5 mm.
//! - Bend sensors have a tolerance each, a memory of direction, an overshoot that relaxes, creep, a ripple that no quadratic
//!   follows, something that both of a segment feel alike, and 2 counts of noise: the best quadratic misses by 4.7° on average.
//!   Sensor b is mounted the other way round, so its counts fall where those of a rise, and what both feel alike cancels.
//! - IMU headings start anywhere and drift: units 1 to 6 by 0.010, −0.008, 0.014, 0.011, −0.011 and 0.050 °/s, of which the last
//!   is 45° in 900 s. Each session varies these by some percent and lets them wander; acceleration adds a degree or two, and the
//!   gyroscopes' sensitivities differ by 1 %.
//!
//! Tolerances belong to the arm and are the same in every session, so a calibration on [`Scenario::Sweep`] holds for all sessions.
//! The flaws' sizes were chosen to come near the paper's figures for maps and drift: that results on the twin resemble the
//! paper's is no evidence for either.
//!
//! Contacts are told by what they do to the curvature; there are no forces.
//!
//! # Example
//!
//! ```
//! use rig_twin::{Program, Rig, Scenario};
//!
//! let (scenario, seed) = (Scenario::One, 7);
//! let program = Program::new(scenario, seed);
//! let mut rig = Rig::new(scenario, seed);
//! for _ in 0..2000 {
//!     rig.step(0.01, program.duties(rig.time_s()));
//! }
//! let tip = rig.truth()[rig_twin::SEGMENTS - 1];
//! assert!(tip.x_m.hypot(tip.y_m) < 0.6, "the arm is 0.582 m long");
//! assert!(rig.adc_counts().iter().all(|&counts| counts > 0 && counts < 4095));
//! ```

mod actuator;
mod arm;
mod bno055;
mod camera;
mod constants;
mod contact;
mod flaws;
mod flex;
mod gauss_markov;
mod heading_drift;
mod motion;
mod noise;
mod program;
mod rig;
mod setup;
mod shape;
mod temperature;

pub use camera::{Camera, Frame};
pub use constants::{BEND_SENSORS, REGULATORS, SEGMENTS};
pub use contact::Push;
pub use heading_drift::HeadingDrift;
pub use motion::Motion;
pub use program::{Program, Scenario};
pub use rig::Rig;
pub use setup::Setup;
pub use shape::EndPose;
