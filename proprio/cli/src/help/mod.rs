//! Remedies of the libraries' errors.

mod calibration;
mod check;
mod flash;
mod link;
mod program;
mod session;
mod table;

/// An error or a finding with a remedy.
pub trait Help {
    /// The remedy, as a request to the user.
    fn help(&self) -> String;
}
