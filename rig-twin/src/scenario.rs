//! Scenarios: the contacts and swings of a session.

/// Scenario of a session: the contacts of the arm and the amplitude of its swings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scenario {
    /// Calibration: every module swings slowly through its whole range, free.
    Sweep,
    /// I: free swings.
    FreeSwing,
    /// II: swings, with pushes by a stick at random times.
    Push,
    /// III: swings against an obstacle that the arm wraps around.
    Obstacle,
}
