//! The host's end of the serial line of an emulated board.

use std::io::{ErrorKind, Read as _, Write as _};
use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use eclss_core::protocol::{Config, Link, Outgoing, Role};
use eclss_network_file::Loaded;
use eclss_target::coupling::link_counts;

/// Packets that may be under way: what is sent faster than the emulated line takes it only grows old.
const UNDER_WAY: u32 = 4;

/// The network that is compiled into the emulated board with hardware on its link.
pub(crate) fn network() -> Loaded {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("files/hil_emulated.toml");
    eclss_network_file::load(&path).expect("it ships")
}

/// A path for a socket of this test.
pub(crate) fn socket(name: &str) -> PathBuf {
    let path = std::env::temp_dir().join(format!("eclss-{}-{name}.sock", std::process::id()));
    let _ = std::fs::remove_file(&path);
    path
}

/// One end of the link, over a Unix socket.
pub(crate) struct Wire {
    pub(crate) link: Link,
    stream: UnixStream,
    begun: Instant,
    backlog: Vec<u8>,
    tick: u64,
}

impl Wire {
    /// Connects as soon as the emulator listens.
    pub(crate) fn connect(socket: &Path, role: Role, loaded: &Loaded) -> Self {
        let begun = Instant::now();
        let stream = loop {
            match UnixStream::connect(socket) {
                Ok(stream) => break stream,
                Err(error) => assert!(begun.elapsed() < Duration::from_mins(1), "{error}"),
            }
            std::thread::sleep(Duration::from_millis(20));
        };
        stream.set_nonblocking(true).expect("a socket can be asked without waiting");
        let (inputs, outputs) = loaded.process.with_image(|image| link_counts(&image));
        let config = Config {
            role,
            network_id: loaded.network().id(),
            process_id: loaded.process.id(),
            step_us: loaded.run.step_us,
            inputs,
            outputs,
            silent_ticks: 20_000,
            ..Config::default()
        };
        Self { link: Link::new(config, std::process::id()), stream, begun, backlog: Vec::new(), tick: 0 }
    }

    /// Microseconds since this end began.
    pub(crate) fn now_us(&self) -> u64 {
        self.begun.elapsed().as_micros() as u64
    }

    /// Reads what has come, waiting a little for it; false when the other end is gone.
    pub(crate) fn read(&mut self) -> bool {
        let mut bytes = [0; 4_096];
        for _ in 0..20 {
            match self.stream.read(&mut bytes) {
                Ok(0) => return false,
                Ok(length) => {
                    self.link.feed(&bytes[..length], self.begun.elapsed().as_micros() as u64);
                    return true;
                }
                Err(error) if error.kind() == ErrorKind::WouldBlock => {
                    std::thread::sleep(Duration::from_millis(1));
                }
                Err(_) => return false,
            }
        }
        true
    }

    /// Sends `values`, if what was sent before has been taken; false when the other end is gone.
    pub(crate) fn send(&mut self, outgoing: &Outgoing<'_>) -> bool {
        self.tick += 1;
        let now_us = self.now_us();
        if self.link.under_way() > UNDER_WAY || !self.backlog.is_empty() {
            self.link.send_quiet_tick(self.tick, now_us);
        } else {
            self.link.send_tick(self.tick, now_us, outgoing);
        }
        self.backlog.extend_from_slice(self.link.outgoing());
        self.link.sent(self.link.outgoing().len());
        while !self.backlog.is_empty() {
            match self.stream.write(&self.backlog) {
                Ok(length) => drop(self.backlog.drain(..length)),
                Err(error) => return error.kind() == ErrorKind::WouldBlock,
            }
        }
        true
    }
}
