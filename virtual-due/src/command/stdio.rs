//! The serial line on standard input and output.

use super::run::{Line, Received};
use std::io::{ErrorKind, Read, Write, stdin, stdout};
use std::sync::mpsc::{Receiver, channel};

/// Standard input and output.
pub struct Stdio {
    input: Receiver<Vec<u8>>,
    /// A line of output has begun.
    mid_line: bool,
}

impl Stdio {
    /// Starts to read. A file is read whole before the run begins, so that two runs receive the same input at the same virtual
    /// times; bytes from a terminal or pipe arrive in real time.
    pub fn new() -> std::io::Result<Self> {
        let (sender, input) = channel();
        if is_file()? {
            let mut bytes = Vec::new();
            stdin().read_to_end(&mut bytes)?;
            // The receiver is here.
            let _ = sender.send(bytes);
            return Ok(Self { input, mid_line: false });
        }
        std::thread::spawn(move || {
            let mut buffer = [0; 4096];
            while let Ok(count @ 1..) = stdin().read(&mut buffer) {
                if sender.send(buffer[..count].to_vec()).is_err() {
                    break;
                }
            }
        });
        Ok(Self { input, mid_line: false })
    }
}

/// True if standard input is an ordinary file.
fn is_file() -> std::io::Result<bool> {
    #[cfg(unix)]
    let input = std::os::fd::AsFd::as_fd(&stdin()).try_clone_to_owned()?;
    #[cfg(windows)]
    let input = std::os::windows::io::AsHandle::as_handle(&stdin()).try_clone_to_owned()?;
    Ok(std::fs::File::from(input).metadata()?.is_file())
}

impl Line for Stdio {
    fn receive(&mut self) -> std::io::Result<Received> {
        Ok(Received { opened: false, bytes: self.input.try_iter().flatten().collect() })
    }

    fn send(&mut self, bytes: &[u8]) -> std::io::Result<bool> {
        let Some(last) = bytes.last() else { return Ok(true) };
        self.mid_line = *last != b'\n';
        let mut output = stdout().lock();
        match output.write_all(bytes).and_then(|()| output.flush()) {
            Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(false),
            done => done.map(|()| true),
        }
    }

    /// Output and reports often meet in one terminal or file.
    fn end_line(&mut self) {
        if std::mem::take(&mut self.mid_line) {
            eprintln!();
        }
    }
}
