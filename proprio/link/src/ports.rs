//! The serial ports of this machine; the one of a Due among them.

use serde::Serialize;
use serialport::{SerialPortInfo, SerialPortType};

use super::LinkError;

/// Arduino's two vendor numbers.
const ARDUINO: [u16; 2] = [0x2341, 0x2a03];
const PROGRAMMING: u16 = 0x003d;
const NATIVE: u16 = 0x003e;

/// A serial port.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Port {
    /// Name to open it by.
    pub name: String,
    /// Kind of the device on it.
    pub kind: PortKind,
    /// USB numbers of the vendor and the product, in hexadecimal.
    pub usb: Option<String>,
    /// USB serial number, which stays when the name changes.
    pub serial_number: Option<String>,
    /// The device's own name.
    pub product: Option<String>,
}

/// Kind of the device on a port.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum PortKind {
    /// The Due's programming port, which the firmware uses.
    DueProgramming,
    /// The Due's native port.
    DueNative,
    /// Something else.
    Other,
}

impl PortKind {
    /// Its name for people.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::DueProgramming => "Due, programming port",
            Self::DueNative => "Due, native port",
            Self::Other => "other",
        }
    }
}

/// All serial ports, by name.
///
/// # Errors
/// [`LinkError::List`].
pub fn list() -> Result<Vec<Port>, LinkError> {
    // Where Linux has none, as in some containers, serialport panics.
    if cfg!(target_os = "linux") && !std::path::Path::new("/sys/class/tty").is_dir() {
        return Ok(Vec::new());
    }
    let found = serialport::available_ports().map_err(LinkError::List)?;
    // macOS lists each port twice; tty.* waits for a carrier that a Due does not give.
    let mut ports: Vec<Port> =
        found.into_iter().filter(|port| !port.port_name.starts_with("/dev/tty.")).map(Port::from).collect();
    ports.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(ports)
}

impl From<SerialPortInfo> for Port {
    fn from(found: SerialPortInfo) -> Self {
        let SerialPortType::UsbPort(usb) = found.port_type else {
            return Self {
                name: found.port_name,
                kind: PortKind::Other,
                usb: None,
                serial_number: None,
                product: None,
            };
        };
        let kind = match (ARDUINO.contains(&usb.vid), usb.pid) {
            (true, PROGRAMMING) => PortKind::DueProgramming,
            (true, NATIVE) => PortKind::DueNative,
            _ => PortKind::Other,
        };
        Self {
            name: found.port_name,
            kind,
            usb: Some(format!("{:04x}:{:04x}", usb.vid, usb.pid)),
            serial_number: usb.serial_number,
            product: usb.product,
        }
    }
}

/// The one Due among the ports: its programming port, or its native port where that alone is plugged in.
///
/// # Errors
/// [`LinkError::NoDue`] and [`LinkError::SeveralDues`].
pub fn find_due(ports: &[Port]) -> Result<&Port, LinkError> {
    for kind in [PortKind::DueProgramming, PortKind::DueNative] {
        let found: Vec<&Port> = ports.iter().filter(|port| port.kind == kind).collect();
        match found[..] {
            [] => {}
            [one] => return Ok(one),
            _ => return Err(LinkError::SeveralDues(found.into_iter().map(|port| port.name.clone()).collect())),
        }
    }
    Err(LinkError::NoDue)
}

/// A udev rule file for the programming port of the Due: access for the user at the computer (`uaccess`) and the group plugdev,
/// and no ModemManager, whose probing resets the board. ModemManager reads its mark on the USB device, above the tty.
#[must_use]
pub fn udev_rules() -> String {
    let rules = ARDUINO.map(|vendor| {
        let due = format!(r#"ATTRS{{idVendor}}=="{vendor:04x}", ATTRS{{idProduct}}=="{PROGRAMMING:04x}""#);
        format!(
            r#"{due}, ENV{{ID_MM_DEVICE_IGNORE}}="1"
SUBSYSTEM=="tty", {due}, MODE="0660", GROUP="plugdev", TAG+="uaccess"
"#
        )
    });
    let title = "# Arduino Due, programming port: access, and no ModemManager, which would reset the board.\n";
    title.to_owned() + &rules.concat()
}

#[cfg(test)]
mod tests {
    use serialport::UsbPortInfo;

    use super::{LinkError, Port, PortKind, SerialPortInfo, SerialPortType, find_due};

    fn usb(name: &str, vid: u16, pid: u16) -> Port {
        let usb = UsbPortInfo { vid, pid, serial_number: None, manufacturer: None, product: None };
        SerialPortInfo { port_name: name.to_owned(), port_type: SerialPortType::UsbPort(usb) }.into()
    }

    #[test]
    fn a_due_is_known_by_its_usb_numbers_and_found_by_its_programming_port() {
        let ports =
            [usb("a", 0x2341, 0x003e), usb("b", 0x2a03, 0x003d), usb("c", 0x2341, 0x0043), usb("d", 0x0403, 0x003d)];
        let kinds = ports.each_ref().map(|port| port.kind);
        assert_eq!(kinds, [PortKind::DueNative, PortKind::DueProgramming, PortKind::Other, PortKind::Other]);
        assert_eq!(find_due(&ports).expect("there is one").name, "b");
        assert_eq!(find_due(&ports[..1]).expect("its native port").name, "a");
    }

    #[test]
    fn without_a_due_or_with_several_none_is_chosen() {
        assert!(matches!(find_due(&[usb("c", 0x2341, 0x0043)]), Err(LinkError::NoDue)));
        let two = [usb("a", 0x2341, 0x003d), usb("b", 0x2a03, 0x003d)];
        assert!(matches!(find_due(&two), Err(LinkError::SeveralDues(names)) if names == ["a", "b"]));
    }
}
