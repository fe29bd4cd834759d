//! The serial line on a pseudo-terminal, which other programs open as a serial port.

use std::time::{Duration, Instant};

use super::run::{Line, Received};
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::fd::OwnedFd;
use rustix::fs::{Mode, OFlags, open};
use rustix::io::{Errno, ioctl_fionbio};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{LocalModes, OptionalActions, tcgetattr, tcsetattr};

/// Time after an opening at which the modes are checked here. The program that opens a port sets its modes at once, and checks
/// that they are set.
const SETTLING: Duration = Duration::from_millis(20);

/// Our end of a pseudo-terminal.
pub struct Pty {
    ours: OwnedFd,
    /// Path of the other end.
    path: String,
    open: bool,
    /// Time of its opening, until its modes are checked.
    opened: Option<Instant>,
}

impl Pty {
    /// Opens a pseudo-terminal.
    pub fn new() -> std::io::Result<Self> {
        let ours = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY)?;
        ioctl_fionbio(&ours, true)?;
        grantpt(&ours)?;
        unlockpt(&ours)?;
        let path = ptsname(&ours, Vec::new())?;
        let path = path.to_string_lossy().into_owned();
        // Opened and closed once: from then on a hang-up means that no program has it open.
        drop(open(path.as_str(), OFlags::RDWR | OFlags::NOCTTY, Mode::empty())?);
        let pty = Self { ours, path, open: false, opened: None };
        pty.make_raw()?;
        Ok(pty)
    }

    /// Path of its other end, for other programs.
    pub fn path(&self) -> &str {
        &self.path
    }

    /// Sets raw modes: each closing loses them, and not every program sets them.
    fn make_raw(&self) -> std::io::Result<()> {
        let mut modes = tcgetattr(&self.ours)?;
        if modes.local_modes.intersects(LocalModes::ICANON | LocalModes::ECHO) {
            modes.make_raw();
            tcsetattr(&self.ours, OptionalActions::Now, &modes)?;
        }
        Ok(())
    }

    /// True if a program has the other end open.
    fn is_open(&self) -> std::io::Result<bool> {
        let mut polled = [PollFd::new(&self.ours, PollFlags::IN)];
        poll(&mut polled, Some(&Timespec { tv_sec: 0, tv_nsec: 0 }))?;
        Ok(!polled[0].revents().contains(PollFlags::HUP))
    }
}

impl Line for Pty {
    fn receive(&mut self) -> std::io::Result<Received> {
        let open = self.is_open()?;
        let was_open = std::mem::replace(&mut self.open, open);
        let opened = open && !was_open;
        if opened {
            self.opened = Some(Instant::now());
        }
        if self.opened.take_if(|opened| opened.elapsed() >= SETTLING).is_some() {
            self.make_raw()?;
        }
        let mut bytes = vec![0; 4096];
        let count = match rustix::io::read(&self.ours, &mut bytes) {
            // No bytes, or no program at the other end.
            Err(Errno::AGAIN | Errno::IO) => 0,
            count => count?,
        };
        bytes.truncate(count);
        Ok(Received { opened, bytes })
    }

    fn send(&mut self, mut bytes: &[u8]) -> std::io::Result<bool> {
        // Bytes that no program reads are lost, as in the USB bridge.
        while self.open && !bytes.is_empty() {
            match rustix::io::write(&self.ours, bytes) {
                Err(Errno::AGAIN | Errno::IO) => break,
                count => bytes = &bytes[count?..],
            }
        }
        Ok(true)
    }
}

#[cfg(test)]
mod tests {
    use super::{Line, Mode, OFlags, Pty, SETTLING, open};

    #[test]
    fn each_opening_is_reported_once_and_bytes_without_a_reader_are_lost() {
        let mut pty = Pty::new().expect("a pseudo-terminal");
        let path = pty.path().to_owned();
        let open_it = || open(path.as_str(), OFlags::RDWR | OFlags::NOCTTY, Mode::empty()).expect("its other end");
        for _ in 0..2 {
            assert!(!pty.receive().expect("no reader").opened);
            pty.send(b"lost").expect("no reader");
            let theirs = open_it();
            assert!(pty.receive().expect("a reader").opened);
            std::thread::sleep(SETTLING);
            assert!(!pty.receive().expect("a reader").opened);
            pty.send(b"seen").expect("a reader");
            let mut bytes = [0; 16];
            let count = rustix::io::read(&theirs, &mut bytes).expect("four bytes");
            assert_eq!(bytes[..count], *b"seen");
        }
    }
}
