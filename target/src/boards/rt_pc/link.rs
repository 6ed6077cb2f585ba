//! The computer's link: a Unix socket that one peer at a time connects to, or datagrams from one peer on the same
//! computer. Nothing here ever waits.

use std::io::{self, ErrorKind, Read as _, Write as _};
use std::net::{SocketAddr, UdpSocket};
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::Path;

/// Largest datagram that is taken whole \[bytes\]; a frame has 512 at most.
const DATAGRAM: usize = 2_048;
/// Most datagrams that one call looks at, so that no flood of empty ones makes it long.
const DATAGRAMS: usize = 16;

/// Where the other end is.
#[derive(Debug, Default)]
pub(super) enum PcLink {
    /// There is none.
    #[default]
    None,
    /// Whoever connects to a Unix socket.
    Unix(UnixListener, Option<UnixStream>),
    /// One peer, by datagrams.
    Udp(UdpSocket, Datagram),
}

/// A datagram of which not all has been asked for yet: the kernel gives it whole or cuts it off.
#[derive(Debug)]
pub(super) struct Datagram {
    bytes: Box<[u8; DATAGRAM]>,
    from: usize,
    to: usize,
}

impl PcLink {
    /// Opens `unix:PATH`, whose file must not exist, or `udp:OWN,PEER`, two addresses of this computer.
    pub(super) fn open(address: &str) -> io::Result<Self> {
        let bad = |what: &str| io::Error::new(ErrorKind::InvalidInput, format!("{what} in `{address}`"));
        match address.split_once(':') {
            Some(("unix", path)) => {
                let listener = UnixListener::bind(Path::new(path))?;
                listener.set_nonblocking(true)?;
                Ok(Self::Unix(listener, None))
            }
            Some(("udp", pair)) => {
                let (own, peer) = pair.split_once(',').ok_or_else(|| bad("no peer"))?;
                let parsed = |text: &str| text.parse::<SocketAddr>().map_err(|_| bad("no address"));
                let (own, peer) = (parsed(own)?, parsed(peer)?);
                if !own.ip().is_loopback() || !peer.ip().is_loopback() {
                    return Err(bad("an address of another computer"));
                }
                let socket = UdpSocket::bind(own)?;
                // Datagrams of anybody else never get here.
                socket.connect(peer)?;
                socket.set_nonblocking(true)?;
                Ok(Self::Udp(socket, Datagram { bytes: Box::new([0; DATAGRAM]), from: 0, to: 0 }))
            }
            _ => Err(bad("neither `unix:` nor `udp:`")),
        }
    }

    /// Takes what has come, as much as `bytes` holds.
    pub(super) fn read(&mut self, bytes: &mut [u8]) -> usize {
        match self {
            Self::None => 0,
            Self::Udp(socket, datagram) => {
                let mut length = 0;
                for _ in 0..DATAGRAMS {
                    length += datagram.take(bytes.get_mut(length..).unwrap_or(&mut []));
                    if length == bytes.len() {
                        break;
                    }
                    let Ok(came) = socket.recv(&mut datagram.bytes[..]) else { break };
                    (datagram.from, datagram.to) = (0, came);
                }
                length
            }
            Self::Unix(listener, stream) => {
                if stream.is_none() {
                    *stream = listener.accept().ok().map(|(stream, _)| stream);
                    *stream = stream.take().filter(|stream| stream.set_nonblocking(true).is_ok());
                }
                let Some(open) = stream else { return 0 };
                match open.read(bytes) {
                    Ok(length @ 1..) => length,
                    Err(error) if error.kind() == ErrorKind::WouldBlock => 0,
                    _ => {
                        // The peer is gone; another may come.
                        *stream = None;
                        0
                    }
                }
            }
        }
    }

    /// Sends `bytes` as far as they are taken now. With nobody there, or for datagrams that find no room, they are lost.
    pub(super) fn write(&mut self, bytes: &[u8]) -> usize {
        if bytes.is_empty() {
            return 0;
        }
        match self {
            Self::None => bytes.len(),
            Self::Udp(socket, _) => {
                let _ = socket.send(bytes);
                bytes.len()
            }
            Self::Unix(_, stream) => {
                let Some(open) = stream else { return bytes.len() };
                match open.write(bytes) {
                    Ok(length) => length,
                    Err(error) if error.kind() == ErrorKind::WouldBlock => 0,
                    Err(_) => {
                        *stream = None;
                        bytes.len()
                    }
                }
            }
        }
    }
}

impl Datagram {
    /// Gives away as much as `place` holds.
    fn take(&mut self, place: &mut [u8]) -> usize {
        let rest = self.bytes.get(self.from..self.to).unwrap_or(&[]);
        let length = rest.len().min(place.len());
        place[..length].copy_from_slice(&rest[..length]);
        self.from += length;
        length
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn free_port() -> u16 {
        UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port()
    }

    #[test]
    fn one_peer_at_a_time_may_come_and_go() {
        let path = std::env::temp_dir().join(format!("eclss-rt-pc-{}.sock", std::process::id()));
        let _ = std::fs::remove_file(&path);
        let mut link = PcLink::open(&format!("unix:{}", path.display())).unwrap();
        let mut bytes = [0; 8];
        assert_eq!((link.read(&mut bytes), link.write(b"lost")), (0, 4), "nobody is there");
        for _ in 0..2 {
            let mut peer = UnixStream::connect(&path).unwrap();
            peer.write_all(b"hello").unwrap();
            assert_eq!((link.read(&mut bytes), &bytes[..5]), (5, &b"hello"[..]));
            assert_eq!(link.write(b"well"), 4);
            peer.read_exact(&mut bytes[..4]).unwrap();
            assert_eq!(&bytes[..4], b"well");
            drop(peer);
            assert_eq!(link.read(&mut bytes), 0, "gone, which is no reason to wait");
        }
        std::fs::remove_file(&path).unwrap();
    }

    /// A datagram that is longer than what is asked for at once is not cut off, and several are taken in one call.
    #[test]
    fn a_long_datagram_comes_whole() {
        let (own, known) = (free_port(), UdpSocket::bind("127.0.0.1:0").unwrap());
        let peer = known.local_addr().unwrap();
        let mut link = PcLink::open(&format!("udp:127.0.0.1:{own},{peer}")).unwrap();
        let sent: Vec<u8> = (0..1_000_u32).map(|n| (n % 251) as u8).collect();
        for part in [&sent[..512], &sent[512..600], &sent[600..]] {
            known.send_to(part, ("127.0.0.1", own)).unwrap();
        }
        std::thread::sleep(std::time::Duration::from_millis(50));
        let (mut got, mut bytes) = (Vec::new(), [0; 256]);
        for _ in 0..4 {
            let length = link.read(&mut bytes);
            got.extend_from_slice(&bytes[..length]);
        }
        assert_eq!(got, sent);
        assert_eq!(link.read(&mut bytes), 0);
    }

    #[test]
    fn datagrams_of_strangers_are_not_seen() {
        let (own, known) = (free_port(), UdpSocket::bind("127.0.0.1:0").unwrap());
        let peer = known.local_addr().unwrap();
        let mut link = PcLink::open(&format!("udp:127.0.0.1:{own},{peer}")).unwrap();
        let stranger = UdpSocket::bind("127.0.0.1:0").unwrap();
        stranger.send_to(b"stranger", ("127.0.0.1", own)).unwrap();
        known.send_to(b"known", ("127.0.0.1", own)).unwrap();
        std::thread::sleep(std::time::Duration::from_millis(50));
        let mut bytes = [0; 16];
        assert_eq!((link.read(&mut bytes), &bytes[..5]), (5, &b"known"[..]));
        assert_eq!(link.read(&mut bytes), 0);
    }

    #[test]
    fn addresses_that_lead_nowhere_or_elsewhere_are_refused() {
        for address in
            ["", "serial:x", "udp:127.0.0.1:1", "udp:x,y", "udp:127.0.0.1:0,192.0.2.1:9", "unix:/no/such/x"]
        {
            assert!(PcLink::open(address).is_err(), "{address}");
        }
    }
}
