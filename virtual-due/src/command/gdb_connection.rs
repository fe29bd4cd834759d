//! The connection of a debugger, which Ctrl-C ends.

use std::io::{self, ErrorKind, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use gdbstub::conn::{Connection, ConnectionExt};

/// Period at which the flag of Ctrl-C is polled.
const WAIT: Duration = Duration::from_millis(50);

/// A connection by TCP.
pub struct GdbConnection {
    stream: TcpStream,
    stop: Arc<AtomicBool>,
    /// A byte that was received and not read yet.
    peeked: Option<u8>,
}

impl GdbConnection {
    /// Waits for a debugger; `None` if Ctrl-C comes first.
    ///
    /// # Errors
    /// Those of the network.
    pub fn accept(listener: &TcpListener, stop: Arc<AtomicBool>) -> io::Result<Option<Self>> {
        listener.set_nonblocking(true)?;
        while !stop.load(Ordering::Relaxed) {
            match listener.accept() {
                Ok((stream, _)) => {
                    stream.set_nonblocking(false)?;
                    stream.set_nodelay(true)?;
                    stream.set_read_timeout(Some(WAIT))?;
                    return Ok(Some(Self { stream, stop, peeked: None }));
                }
                Err(error) if error.kind() == ErrorKind::WouldBlock => std::thread::sleep(WAIT),
                Err(error) => return Err(error),
            }
        }
        Ok(None)
    }

    /// The next byte; `None` if it does not arrive within the time-out, or at once on a connection that does not block.
    fn receive(&mut self) -> io::Result<Option<u8>> {
        let mut byte = [0];
        match Read::read(&mut self.stream, &mut byte) {
            Ok(0) => Err(ErrorKind::UnexpectedEof.into()),
            Ok(_) => Ok(Some(byte[0])),
            Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => Ok(None),
            Err(error) => Err(error),
        }
    }
}

impl Connection for GdbConnection {
    type Error = io::Error;

    fn write(&mut self, byte: u8) -> io::Result<()> {
        Write::write_all(&mut self.stream, &[byte])
    }

    fn write_all(&mut self, bytes: &[u8]) -> io::Result<()> {
        Write::write_all(&mut self.stream, bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        Write::flush(&mut self.stream)
    }
}

impl ConnectionExt for GdbConnection {
    fn read(&mut self) -> io::Result<u8> {
        loop {
            if let Some(byte) = self.peeked.take() {
                return Ok(byte);
            }
            if self.stop.load(Ordering::Relaxed) {
                return Err(ErrorKind::Interrupted.into());
            }
            self.peeked = self.receive()?;
        }
    }

    fn peek(&mut self) -> io::Result<Option<u8>> {
        if self.peeked.is_none() {
            self.stream.set_nonblocking(true)?;
            let received = self.receive();
            self.stream.set_nonblocking(false)?;
            self.peeked = received?;
        }
        Ok(self.peeked)
    }
}
