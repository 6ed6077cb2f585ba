//! One open wire of any kind, in non-blocking mode, and what opens it.

use std::fs::{File, OpenOptions};
use std::io::{self, ErrorKind, Read as _, Write as _};
use std::net::UdpSocket;
use std::os::unix::fs::{FileTypeExt as _, OpenOptionsExt as _};
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::PathBuf;

use rustix::fs::OFlags;
use rustix::termios::{OptionalActions, SpecialCodeIndex, tcgetattr, tcsetattr};

use super::Address;

/// An open wire.
#[derive(Debug)]
pub(super) enum Wire {
    Serial(File),
    Udp(UdpSocket),
    Unix(UnixStream),
}

/// The other side is gone.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Gone;

impl Wire {
    /// Reads what is there; 0 for nothing.
    pub(super) fn read(&mut self, buffer: &mut [u8]) -> Result<usize, Gone> {
        let (result, is_stream) = match self {
            Self::Serial(port) => (port.read(buffer), true),
            Self::Udp(socket) => (socket.recv(buffer), false),
            Self::Unix(stream) => (stream.read(buffer), true),
        };
        match result {
            // The end of a stream, and a port that was unplugged: one that is only quiet would block.
            Ok(0) if is_stream => Err(Gone),
            Ok(length) => Ok(length),
            Err(error) => self.judge(&error),
        }
    }

    /// Sends as much as is taken; 0 for nothing.
    pub(super) fn write(&mut self, bytes: &[u8]) -> Result<usize, Gone> {
        let result = match self {
            Self::Serial(port) => port.write(bytes),
            Self::Udp(socket) => socket.send(bytes),
            Self::Unix(stream) => stream.write(bytes),
        };
        result.or_else(|error| self.judge(&error))
    }

    fn judge(&self, error: &io::Error) -> Result<usize, Gone> {
        match (self, error.kind()) {
            // Over UDP, without a listener, there is an error for every datagram, which says nothing about the next.
            (_, ErrorKind::WouldBlock | ErrorKind::Interrupted) | (Self::Udp(_), _) => Ok(0),
            _ => Err(Gone),
        }
    }
}

/// Opens a wire as often as it is asked.
#[derive(Debug)]
pub(super) enum Opener {
    Serial { path: PathBuf, baud: u32 },
    Udp(UdpSocket),
    Connects(PathBuf),
    Listens { listener: UnixListener, path: PathBuf },
}

impl Opener {
    /// Finds out what can be found out before the other side is there.
    pub(super) fn new(address: &Address) -> io::Result<Self> {
        let refused = |error: io::Error| io::Error::new(error.kind(), format!("{address}: {error}"));
        match address {
            Address::Serial { path, baud } => {
                let opener = Self::Serial { path: path.clone(), baud: *baud };
                open_serial(path, *baud).map_err(refused)?;
                Ok(opener)
            }
            Address::Udp { local, peer } => {
                let socket = UdpSocket::bind(local).map_err(refused)?;
                // The kernel drops what comes from anybody else, before it could cost us time.
                socket.connect(peer).map_err(refused)?;
                socket.set_nonblocking(true).map_err(refused)?;
                Ok(Self::Udp(socket))
            }
            Address::Unix { path, listens: false } => Ok(Self::Connects(path.clone())),
            Address::Unix { path, listens: true } => {
                let listener = listen(path).map_err(refused)?;
                listener.set_nonblocking(true).map_err(refused)?;
                Ok(Self::Listens { listener, path: path.clone() })
            }
        }
    }

    /// Opens the wire if the other side is there.
    pub(super) fn try_open(&mut self) -> Option<Wire> {
        match self {
            Self::Serial { path, baud } => open_serial(path, *baud).ok().map(Wire::Serial),
            Self::Udp(socket) => socket.try_clone().ok().map(Wire::Udp),
            Self::Connects(path) => UnixStream::connect(path).ok().and_then(non_blocking),
            Self::Listens { listener, .. } => {
                listener.accept().ok().and_then(|(stream, _)| non_blocking(stream))
            }
        }
    }
}

impl Drop for Opener {
    fn drop(&mut self) {
        if let Self::Listens { path, .. } = self {
            // A socket that nobody listens at would be in the way the next time.
            let _ = std::fs::remove_file(path);
        }
    }
}

/// Listens at `path`, also where a program that was killed has left its socket behind; one that listens is left alone.
fn listen(path: &std::path::Path) -> io::Result<UnixListener> {
    let first = UnixListener::bind(path);
    let in_use = first.as_ref().is_err_and(|error| error.kind() == ErrorKind::AddrInUse);
    let is_socket = || std::fs::symlink_metadata(path).is_ok_and(|file| file.file_type().is_socket());
    let is_dead =
        || UnixStream::connect(path).is_err_and(|error| error.kind() == ErrorKind::ConnectionRefused);
    if in_use && is_socket() && is_dead() {
        std::fs::remove_file(path)?;
        return UnixListener::bind(path);
    }
    first
}

fn non_blocking(stream: UnixStream) -> Option<Wire> {
    stream.set_nonblocking(true).ok().map(|()| Wire::Unix(stream))
}

/// Opens a port without waiting for a modem, raw, 8N1, at `baud`.
fn open_serial(path: &std::path::Path, baud: u32) -> io::Result<File> {
    let flags = (OFlags::NONBLOCK | OFlags::NOCTTY).bits().cast_signed();
    let port = OpenOptions::new().read(true).write(true).custom_flags(flags).open(path)?;
    let mut settings = tcgetattr(&port)?;
    settings.make_raw();
    // A read of nothing is then an error that says so, and not an end.
    settings.special_codes[SpecialCodeIndex::VMIN] = 1;
    settings.special_codes[SpecialCodeIndex::VTIME] = 0;
    settings.set_speed(baud)?;
    tcsetattr(&port, OptionalActions::Now, &settings)?;
    Ok(port)
}
