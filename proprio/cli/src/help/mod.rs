//! Remedies of the libraries' errors.

mod calibration;
mod flash;
mod link;
mod program;
mod session;
mod table;

/// An error with a remedy.
pub trait Help {
    /// The remedy, as a request to the user.
    fn help(&self) -> String;
}
