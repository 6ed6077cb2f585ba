//! Addresses of links on the command line.

use std::fmt;
use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::path::PathBuf;

/// Speed of a serial port when none is given [baud].
const BAUD: u32 = 115_200;

/// Where the other side is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Address {
    /// A serial port with its speed [baud], 8N1.
    Serial {
        /// The device.
        path: PathBuf,
        /// Its speed.
        baud: u32,
    },
    /// Datagrams.
    Udp {
        /// Where we are.
        local: SocketAddr,
        /// The one peer that is heard.
        peer: SocketAddr,
    },
    /// A Unix socket.
    Unix {
        /// Its path.
        path: PathBuf,
        /// Whether we listen there for one connection at a time, or connect.
        listens: bool,
    },
}

/// Why an address was refused.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum AddressError {
    /// None of the known kinds.
    Kind,
    /// Nothing behind the kind.
    Empty,
    /// Not a speed.
    Baud(String),
    /// Neither a port nor an address with port.
    Socket(String),
    /// UDP needs to know whom to hear.
    NoPeer,
    /// Only UDP has a peer.
    NeedlessPeer,
}

impl fmt::Display for AddressError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Kind => f.write_str(
                "no such kind of link; there are serial:PORT[@BAUD], udp:[ADDRESS:]PORT, unix:PATH (connects) and \
                 unix-listen:PATH",
            ),
            Self::Empty => f.write_str("says nothing about where"),
            Self::Baud(text) => write!(f, "`{text}` is no speed in baud"),
            Self::Socket(text) => write!(f, "`{text}` is neither a port nor an address with a port"),
            Self::NoPeer => f.write_str("needs --peer ADDRESS:PORT: over UDP only one listed peer is heard"),
            Self::NeedlessPeer => f.write_str("has no use for --peer, which is for udp"),
        }
    }
}

impl std::error::Error for AddressError {}

impl Address {
    /// Reads `text`, such as `serial:/dev/ttyACM0@921600`, `udp:7400` or `unix:/run/plant`. A UDP address without
    /// a host is the loopback's; `peer` is whom it hears.
    pub fn read(text: &str, peer: Option<&str>) -> Result<Self, AddressError> {
        let (kind, place) = text.split_once(':').ok_or(AddressError::Kind)?;
        if place.is_empty() {
            return Err(AddressError::Empty);
        }
        if kind != "udp" && peer.is_some() {
            return Err(AddressError::NeedlessPeer);
        }
        match kind {
            "serial" => {
                let (path, baud) = match place.rsplit_once('@') {
                    Some((path, baud)) => {
                        let speed = baud.parse().ok().filter(|baud| *baud > 0);
                        (path, speed.ok_or_else(|| AddressError::Baud(baud.into()))?)
                    }
                    None => (place, BAUD),
                };
                Ok(Self::Serial { path: path.into(), baud })
            }
            "udp" => {
                let peer = peer.ok_or(AddressError::NoPeer)?;
                Ok(Self::Udp { local: socket(place)?, peer: socket(peer)? })
            }
            "unix" => Ok(Self::Unix { path: place.into(), listens: false }),
            "unix-listen" => Ok(Self::Unix { path: place.into(), listens: true }),
            _ => Err(AddressError::Kind),
        }
    }
}

impl fmt::Display for Address {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Serial { path, baud } => write!(f, "serial {} at {baud} baud", path.display()),
            Self::Udp { local, peer } => write!(f, "UDP at {local}, hears {peer} alone"),
            Self::Unix { path, listens: true } => write!(f, "Unix socket {}, listens", path.display()),
            Self::Unix { path, listens: false } => write!(f, "Unix socket {}", path.display()),
        }
    }
}

/// A port on the loopback, or an address with a port.
fn socket(text: &str) -> Result<SocketAddr, AddressError> {
    let on_loopback = || text.parse().ok().map(|port| SocketAddr::new(IpAddr::V4(Ipv4Addr::LOCALHOST), port));
    text.parse().ok().or_else(on_loopback).ok_or_else(|| AddressError::Socket(text.into()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_are_read_or_refused_with_a_reason() {
        let serial = |path: &str, baud| Ok(Address::Serial { path: path.into(), baud });
        assert_eq!(Address::read("serial:/dev/ttyACM0", None), serial("/dev/ttyACM0", BAUD));
        assert_eq!(Address::read("serial:/dev/ttyACM0@921600", None), serial("/dev/ttyACM0", 921_600));
        assert_eq!(Address::read("serial:x@fast", None), Err(AddressError::Baud("fast".into())));
        let unix = |listens| Ok(Address::Unix { path: "/run/a:b".into(), listens });
        assert_eq!(Address::read("unix:/run/a:b", None), unix(false));
        assert_eq!(Address::read("unix-listen:/run/a:b", None), unix(true));
        assert_eq!(Address::read("unix:", None), Err(AddressError::Empty));
        assert_eq!(Address::read("unix:/a", Some("1")), Err(AddressError::NeedlessPeer));
        assert_eq!(Address::read("tcp:1", None), Err(AddressError::Kind));
        assert_eq!(Address::read("nonsense", None), Err(AddressError::Kind));
    }

    /// Nothing but this computer reaches a socket unless an address was given, and nobody is heard unlisted.
    #[test]
    fn udp_is_the_loopbacks_unless_told_otherwise() {
        let Ok(Address::Udp { local, peer }) = Address::read("udp:7400", Some("7401")) else { panic!() };
        assert!(local.ip().is_loopback() && peer.ip().is_loopback());
        let Ok(Address::Udp { local, .. }) = Address::read("udp:0.0.0.0:7400", Some("192.0.2.1:9")) else {
            panic!()
        };
        assert!(local.ip().is_unspecified());
        assert_eq!(Address::read("udp:7400", None), Err(AddressError::NoPeer));
        let refused = AddressError::Socket("seven".into());
        assert_eq!(Address::read("udp:seven", Some("1")), Err(refused));
    }
}
