//! Environment variables of ROS 2, with the meaning that its own nodes give them.

use std::env;
use std::fmt;

use crate::error::Error;

const DOMAIN: &str = "ROS_DOMAIN_ID";
const LOCALHOST_ONLY: &str = "ROS_LOCALHOST_ONLY";
const RANGE: &str = "ROS_AUTOMATIC_DISCOVERY_RANGE";
const DISTRIBUTION: &str = "ROS_DISTRO";

/// The highest domain whose ports exist.
const MAX_DOMAIN: u16 = 232;

/// Distributions in which an identifier of the graph has 24 bytes.
const LONG_IDENTIFIERS: [&str; 6] = ["crystal", "dashing", "eloquent", "foxy", "galactic", "humble"];

/// Settings of the node.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Environment {
    /// Number of the domain.
    pub domain: u16,
    /// Only nodes on this machine find the node.
    pub is_local: bool,
    /// Bytes of an identifier of the graph: 24 up to Humble, 16 from Iron on.
    pub identifier_bytes: usize,
}

impl Environment {
    /// Reads the environment of this process.
    pub fn read() -> Result<Self, Error> {
        Self::of(|name| env::var(name).ok())
    }

    fn of(variable: impl Fn(&str) -> Option<String>) -> Result<Self, Error> {
        // An empty variable is as one that is not set.
        let variable = |name| variable(name).filter(|value| !value.is_empty());
        let domain = match variable(DOMAIN) {
            None => 0,
            Some(value) => match value.parse() {
                Ok(domain @ 0..=MAX_DOMAIN) => domain,
                _ => return Err(Error::Environment { name: DOMAIN, value, expected: "0 to 232" }),
            },
        };
        // The older variable counts where it is 1, as in ROS 2.
        let is_local = variable(LOCALHOST_ONLY).as_deref() == Some("1") || is_range_local(variable(RANGE).as_deref())?;
        let has_long = variable(DISTRIBUTION).is_some_and(|name| LONG_IDENTIFIERS.contains(&name.as_str()));
        Ok(Self { domain, is_local, identifier_bytes: if has_long { 24 } else { 16 } })
    }
}

fn is_range_local(range: Option<&str>) -> Result<bool, Error> {
    match range {
        None | Some("SUBNET" | "SYSTEM_DEFAULT") => Ok(false),
        Some("LOCALHOST") => Ok(true),
        Some(value) => {
            let expected = "SUBNET, LOCALHOST or SYSTEM_DEFAULT";
            Err(Error::Environment { name: RANGE, value: value.to_owned(), expected })
        }
    }
}

impl fmt::Display for Environment {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let range = if self.is_local { "this machine" } else { "this network" };
        write!(f, "domain {}, for nodes on {range}", self.domain)
    }
}

#[cfg(test)]
mod tests {
    use super::{Environment, Error};

    fn read(variables: &[(&str, &str)]) -> Result<Environment, Error> {
        Environment::of(|wanted| {
            variables.iter().find(|(name, _)| *name == wanted).map(|(_, value)| (*value).to_owned())
        })
    }

    #[test]
    fn without_variables_the_node_is_in_domain_0_of_its_network() {
        let expected = Environment { domain: 0, is_local: false, identifier_bytes: 16 };
        assert_eq!(read(&[]).expect("it is valid"), expected);
        let empty = [("ROS_DOMAIN_ID", ""), ("ROS_AUTOMATIC_DISCOVERY_RANGE", ""), ("ROS_LOCALHOST_ONLY", "")];
        assert_eq!(read(&empty).expect("it is valid"), expected);
    }

    #[test]
    fn a_domain_without_ports_is_refused() {
        assert_eq!(read(&[("ROS_DOMAIN_ID", "232")]).expect("it is valid").domain, 232);
        for domain in ["233", "-1", "x", "1.0"] {
            assert!(read(&[("ROS_DOMAIN_ID", domain)]).is_err(), "{domain}");
        }
    }

    #[test]
    fn both_variables_keep_the_node_on_its_machine() {
        let is_local = |variables| read(variables).expect("it is valid").is_local;
        assert!(is_local(&[("ROS_LOCALHOST_ONLY", "1")]));
        assert!(is_local(&[("ROS_LOCALHOST_ONLY", "1"), ("ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET")]));
        assert!(is_local(&[("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")]));
        assert!(!is_local(&[("ROS_LOCALHOST_ONLY", "0"), ("ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET")]));
        for range in ["OFF", "localhost", "ALL"] {
            assert!(read(&[("ROS_AUTOMATIC_DISCOVERY_RANGE", range)]).is_err(), "{range}");
        }
    }

    #[test]
    fn identifiers_are_as_long_as_the_distribution_has_them() {
        for (distribution, bytes) in [("humble", 24), ("iron", 16), ("jazzy", 16), ("kilted", 16), ("rolling", 16)] {
            let environment = read(&[("ROS_DISTRO", distribution)]).expect("it is valid");
            assert_eq!(environment.identifier_bytes, bytes, "{distribution}");
        }
    }
}
