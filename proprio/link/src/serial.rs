//! A serial port as a line to a board.

use std::io::{self, Read, Write};
use std::str::FromStr;
use std::time::Duration;

use serialport::{DataBits, FlowControl, Parity, SerialPort, StopBits};

use super::ports::{Port, find_due, list};
use super::{LinkError, Source, Transport};

/// Longest wait of a read: requests are sent between two reads.
const WAIT: Duration = Duration::from_millis(10);

/// Speed at which opening the Due's programming port erases its flash, Bd.
const ERASES: u32 = 1200;

/// Speed of a line: never the one that erases the board.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Baud(u32);

impl Baud {
    /// A speed in Bd; `None` for 1200 Bd, which would erase the board, and 0.
    #[must_use]
    pub const fn new(baud: u32) -> Option<Self> {
        if baud == ERASES || baud == 0 { None } else { Some(Self(baud)) }
    }
}

impl Default for Baud {
    /// Speed of the protocol.
    fn default() -> Self {
        Self(250_000)
    }
}

impl FromStr for Baud {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let baud = text.parse().map_err(|_| "a speed in Bd is wanted".to_owned())?;
        Self::new(baud)
            .ok_or_else(|| format!("{baud} Bd: at 1200 Bd the Due erases its flash; 250000 is the firmware's"))
    }
}

impl std::fmt::Display for Baud {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.0.fmt(f)
    }
}

/// The port of a Due, found again by its USB serial number when it comes back.
#[derive(Debug)]
pub struct PortSource {
    name: Option<String>,
    baud: Baud,
    found: Option<Port>,
}

impl PortSource {
    /// The port of this name, or of the only Due that is plugged in.
    #[must_use]
    pub const fn new(name: Option<String>, baud: Baud) -> Self {
        Self { name, baud, found: None }
    }

    /// The current name of the port, and the port where the system lists it: a pseudo-terminal is not listed.
    fn find(&self) -> Result<(String, Option<Port>), LinkError> {
        let ports = match (list(), &self.name) {
            (Err(_), Some(_)) => Vec::new(),
            (ports, _) => ports?,
        };
        let same = |port: &&Port| self.found.as_ref().is_some_and(|found| port.is_same(found));
        if let Some(port) = ports.iter().find(same) {
            return Ok((port.name.clone(), Some(port.clone())));
        }
        if let Some(name) = &self.name {
            return Ok((name.clone(), ports.into_iter().find(|port| port.name == *name)));
        }
        if self.found.is_some() {
            return Err(LinkError::Gone);
        }
        let port = find_due(&ports)?;
        Ok((port.name.clone(), Some(port.clone())))
    }
}

impl Port {
    /// True for a port of the same device, under any name.
    fn is_same(&self, other: &Self) -> bool {
        match (&self.serial_number, &other.serial_number) {
            (Some(mine), Some(others)) => mine == others && self.usb == other.usb,
            _ => self.name == other.name,
        }
    }
}

impl Source for PortSource {
    fn open(&mut self) -> Result<(String, Box<dyn Transport>), LinkError> {
        let (name, port) = self.find()?;
        let serial = Serial::open(&name, self.baud).map_err(|source| LinkError::Open { port: name.clone(), source })?;
        self.found = port;
        Ok((name, Box::new(serial)))
    }

    fn can_reconnect(&self) -> bool {
        true
    }
}

struct Serial(Box<dyn SerialPort>);

impl Serial {
    fn open(name: &str, baud: Baud) -> serialport::Result<Self> {
        // macOS sets no speed on a pseudo-terminal.
        let is_pty = cfg!(target_os = "macos") && name.starts_with("/dev/ttys");
        let port = serialport::new(name, if is_pty { 0 } else { baud.0 })
            .data_bits(DataBits::Eight)
            .parity(Parity::None)
            .stop_bits(StopBits::One)
            .flow_control(FlowControl::None)
            .dtr_on_open(true)
            .timeout(WAIT)
            .open()?;
        Ok(Self(port))
    }
}

impl Transport for Serial {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        match self.0.read(buffer) {
            Err(error) if matches!(error.kind(), io::ErrorKind::TimedOut | io::ErrorKind::Interrupted) => Ok(0),
            // Readable without data: the port was unplugged.
            Ok(0) => Err(io::ErrorKind::UnexpectedEof.into()),
            read => read,
        }
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.0.write_all(bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::{Baud, Port};
    use crate::PortKind;

    #[test]
    fn the_speed_that_erases_the_board_is_refused() {
        assert_eq!(Baud::new(1200), None);
        let refusal = "1200".parse::<Baud>().expect_err("it would erase the board");
        assert!(refusal.contains("erases"), "{refusal}");
        assert_eq!("250000".parse(), Ok(Baud::default()));
    }

    fn port(name: &str, serial_number: Option<&str>) -> Port {
        Port {
            name: name.to_owned(),
            kind: PortKind::DueProgramming,
            usb: Some("2341:003d".to_owned()),
            serial_number: serial_number.map(str::to_owned),
            product: None,
        }
    }

    #[test]
    fn a_board_is_the_same_by_its_serial_number_under_any_name() {
        let board = port("/dev/ttyACM0", Some("1"));
        assert!(board.is_same(&port("/dev/ttyACM1", Some("1"))));
        assert!(!board.is_same(&port("/dev/ttyACM0", Some("2"))));
        assert!(port("/dev/ttyACM0", None).is_same(&port("/dev/ttyACM0", None)));
    }
}
