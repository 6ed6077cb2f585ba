//! The server: a thread that accepts, one for each connection, and one that passes frames on.

use std::io;
use std::net::{Shutdown, SocketAddr, TcpListener, TcpStream};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, sync_channel};
use std::sync::{Arc, OnceLock, PoisonError, RwLock};
use std::thread::JoinHandle;
use std::time::Duration;

use super::answer::{Choices, answer, refuse, reply};
use super::feed::Feed;
use super::hub::Hub;
use super::recorder::Recorder;
use super::request;

/// Connections at once; further ones are turned away.
const CONNECTIONS: usize = 64;
/// Time for a write to a page that does not read.
const WRITE: Duration = Duration::from_secs(5);

/// A running server; it stops when dropped.
#[derive(Debug)]
pub struct Server {
    address: SocketAddr,
    shared: Arc<Shared>,
    stop: Arc<AtomicBool>,
    threads: Vec<JoinHandle<()>>,
}

/// The plant that is shown.
pub(super) struct Shown {
    pub(super) feed: Feed,
    pub(super) catalogue: String,
    pub(super) drawing: Option<String>,
}

impl Shown {
    fn new(feed: Feed, drawing: Option<String>) -> io::Result<Arc<Self>> {
        let catalogue = serde_json::to_string(&*feed.catalogue)?;
        Ok(Arc::new(Self { feed, catalogue, drawing }))
    }
}

/// What every connection needs.
pub(super) struct Shared {
    own: SocketAddr,
    shown: RwLock<Arc<Shown>>,
    pub(super) hub: Hub,
    pub(super) recorder: Recorder,
    pub(super) choices: OnceLock<Choices>,
    pub(super) stop: Arc<AtomicBool>,
    open: AtomicUsize,
}

impl Server {
    /// Serves `feed` at `address`, with the schematic if there is one.
    pub fn start(address: SocketAddr, feed: Feed, drawing: Option<String>) -> io::Result<Self> {
        let listener = TcpListener::bind(address)?;
        let own = listener.local_addr()?;
        let stop = Arc::new(AtomicBool::new(false));
        let shared = Arc::new(Shared {
            own,
            shown: RwLock::new(Shown::new(feed, drawing)?),
            hub: Hub::default(),
            recorder: Recorder::default(),
            choices: OnceLock::new(),
            stop: Arc::clone(&stop),
            open: AtomicUsize::new(0),
        });
        let (hub, doors) = (Arc::clone(&shared), Arc::clone(&shared));
        let frames = move || {
            hub.hub.run(|| hub.shown().feed.clone(), |frame| hub.recorder.note(frame), &hub.stop);
            hub.recorder.end(None);
        };
        let threads = vec![
            std::thread::Builder::new().name("frames".into()).spawn(frames)?,
            std::thread::Builder::new().name("accept".into()).spawn(move || accept(&listener, &doors))?,
        ];
        Ok(Self { address: own, shared, stop, threads })
    }

    /// Shows another plant; pages come back and find it. A recording ends.
    pub fn show(&self, feed: Feed, drawing: Option<String>) -> io::Result<()> {
        let shown = Shown::new(feed, drawing)?;
        self.shared.recorder.end(Some("another plant is shown"));
        *self.shared.shown.write().unwrap_or_else(PoisonError::into_inner) = shown;
        self.shared.hub.turn_over();
        Ok(())
    }

    /// Lets pages write what they show into files in `folder`.
    pub fn allow_recording(&self, folder: PathBuf) {
        self.shared.recorder.allow(folder);
    }

    /// Lets pages choose among `networks`; the numbers of those asked for arrive at the receiver. Only where commands
    /// are taken.
    pub fn offer(&self, networks: Vec<String>) -> Receiver<usize> {
        let (asked, receiver) = sync_channel(1);
        let _ = self.shared.choices.set(Choices { networks, asked });
        receiver
    }

    /// Where it listens.
    pub fn address(&self) -> SocketAddr {
        self.address
    }
}

impl Shared {
    /// The plant that is shown now.
    pub(super) fn shown(&self) -> Arc<Shown> {
        Arc::clone(&self.shown.read().unwrap_or_else(PoisonError::into_inner))
    }
}

impl std::fmt::Debug for Shared {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Shared").field("own", &self.own).finish_non_exhaustive()
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        // Wakes the thread that accepts.
        let _ = TcpStream::connect_timeout(&self.address, Duration::from_millis(200));
        for thread in self.threads.drain(..) {
            let _ = thread.join();
        }
    }
}

fn accept(listener: &TcpListener, shared: &Arc<Shared>) {
    for stream in listener.incoming() {
        if shared.stop.load(Ordering::Relaxed) {
            return;
        }
        let Ok(mut stream) = stream else {
            // Out of descriptors, most likely: give others time to close theirs.
            std::thread::sleep(Duration::from_millis(20));
            continue;
        };
        if shared.open.fetch_add(1, Ordering::AcqRel) >= CONNECTIONS {
            let _ = stream.set_write_timeout(Some(Duration::from_millis(50)));
            let _ = answer(&mut stream, 503, "text/plain; charset=utf-8", b"too many connections\n", true);
            shared.open.fetch_sub(1, Ordering::AcqRel);
            continue;
        }
        let own = Arc::clone(shared);
        let spawned =
            std::thread::Builder::new().name("page".into()).stack_size(256 << 10).spawn(move || {
                // An error here is a page that went away.
                let _ = serve(&mut stream, &own);
                let _ = stream.shutdown(Shutdown::Both);
                own.open.fetch_sub(1, Ordering::AcqRel);
            });
        if spawned.is_err() {
            shared.open.fetch_sub(1, Ordering::AcqRel);
        }
    }
}

fn serve(stream: &mut TcpStream, shared: &Shared) -> io::Result<()> {
    stream.set_write_timeout(Some(WRITE))?;
    stream.set_nodelay(true)?;
    match request::read(stream, shared.own) {
        Ok(None) => Ok(()),
        Ok(Some(request)) => reply(stream, shared, &request),
        Err(refusal) => refuse(stream, refusal),
    }
}
