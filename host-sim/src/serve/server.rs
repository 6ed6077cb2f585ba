//! The server: a thread that accepts, one for each connection, and a fixed set of answers. No file is ever opened on
//! a request's word.

use std::io::{self, Write};
use std::net::{Shutdown, SocketAddr, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

use super::feed::{Command, Feed};
use super::hub::Hub;
use super::request::{self, Refusal, Request};

/// Connections at once; further ones are turned away.
const CONNECTIONS: usize = 64;
/// Time for a write to a page that does not read.
const WRITE: Duration = Duration::from_secs(5);

/// Files of the page: path, type, content. All of it is part of the program.
const FILES: [(&str, &str, &str); 13] = [
    ("/", "text/html; charset=utf-8", include_str!("../../page/index.html")),
    ("/page.css", "text/css; charset=utf-8", include_str!("../../page/page.css")),
    ("/schematic.css", "text/css; charset=utf-8", include_str!("../../page/schematic.css")),
    ("/main.js", SCRIPT, include_str!("../../page/main.js")),
    ("/stream.js", SCRIPT, include_str!("../../page/stream.js")),
    ("/units.js", SCRIPT, include_str!("../../page/units.js")),
    ("/drawing.js", SCRIPT, include_str!("../../page/drawing.js")),
    ("/trends.js", SCRIPT, include_str!("../../page/trends.js")),
    ("/air.js", SCRIPT, include_str!("../../page/air.js")),
    ("/charts.js", SCRIPT, include_str!("../../page/charts.js")),
    ("/controls.js", SCRIPT, include_str!("../../page/controls.js")),
    ("/recorder.js", SCRIPT, include_str!("../../page/recorder.js")),
    ("/hardware.js", SCRIPT, include_str!("../../page/hardware.js")),
];
const SCRIPT: &str = "text/javascript; charset=utf-8";
const JSON: &str = "application/json";

/// Nothing is loaded from elsewhere, nothing inline runs, nobody may frame the page.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; img-src 'self' data:; \
                      base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

/// A running server; it stops when dropped.
#[derive(Debug)]
pub struct Server {
    address: SocketAddr,
    stop: Arc<AtomicBool>,
    threads: Vec<JoinHandle<()>>,
}

/// What every connection needs.
struct Shared {
    own: SocketAddr,
    feed: Feed,
    hub: Hub,
    catalogue: String,
    drawing: Option<String>,
    stop: Arc<AtomicBool>,
    open: AtomicUsize,
}

impl Server {
    /// Serves `feed` at `address`, with the schematic if there is one.
    pub fn start(address: SocketAddr, feed: Feed, drawing: Option<String>) -> io::Result<Self> {
        let listener = TcpListener::bind(address)?;
        let own = listener.local_addr()?;
        let stop = Arc::new(AtomicBool::new(false));
        let catalogue = serde_json::to_string(&*feed.catalogue)?;
        let shared = Arc::new(Shared {
            own,
            feed,
            hub: Hub::default(),
            catalogue,
            drawing,
            stop: Arc::clone(&stop),
            open: AtomicUsize::new(0),
        });
        let hub = Arc::clone(&shared);
        let threads = vec![
            std::thread::Builder::new()
                .name("frames".into())
                .spawn(move || hub.hub.run(&hub.feed, &hub.stop))?,
            std::thread::Builder::new().name("accept".into()).spawn(move || accept(&listener, &shared))?,
        ];
        Ok(Self { address: own, stop, threads })
    }

    /// Where it listens.
    pub fn address(&self) -> SocketAddr {
        self.address
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

fn refuse(stream: &mut TcpStream, Refusal(status, reason): Refusal) -> io::Result<()> {
    answer(stream, status, "text/plain; charset=utf-8", format!("{reason}\n").as_bytes(), true)?;
    // What is still being sent is read for a moment, so that the answer is not lost to a reset; not for longer.
    stream.shutdown(Shutdown::Write)?;
    stream.set_read_timeout(Some(Duration::from_millis(100)))?;
    let mut rest = [0; 4096];
    for _ in 0..16 {
        if io::Read::read(stream, &mut rest)? == 0 {
            break;
        }
    }
    Ok(())
}

fn reply(stream: &mut TcpStream, shared: &Shared, request: &Request) -> io::Result<()> {
    let whole = request.method != "HEAD";
    if request.method == "POST" {
        let refusal = match request.path.as_str() {
            "/command" if !shared.feed.catalogue.control => {
                Refusal(403, "this server takes no commands; start it with --control")
            }
            "/command" => match serde_json::from_slice::<Command>(&request.body) {
                Ok(command) if shared.feed.command(command) => {
                    return answer(stream, 204, JSON, b"", true);
                }
                Ok(_) => Refusal(503, "too many commands wait"),
                Err(_) => Refusal(400, "not a command"),
            },
            _ => Refusal(404, "there is nothing here"),
        };
        return refuse(stream, refusal);
    }
    match request.path.as_str() {
        "/network" => answer(stream, 200, JSON, shared.catalogue.as_bytes(), whole),
        "/schematic.svg" => match &shared.drawing {
            Some(drawing) => answer(stream, 200, "image/svg+xml", drawing.as_bytes(), whole),
            None => refuse(stream, Refusal(404, "this network is not drawn")),
        },
        // One frame, for programs that ask now and then.
        "/frame" => match shared.hub.latest() {
            Some(event) => answer(stream, 200, JSON, event.trim_start_matches("data: ").as_bytes(), whole),
            None => refuse(stream, Refusal(503, "nothing was published yet")),
        },
        "/events" if whole => events(stream, shared),
        path => match FILES.iter().find(|(name, ..)| *name == path) {
            Some((_, kind, text)) => answer(stream, 200, kind, text.as_bytes(), whole),
            None => refuse(stream, Refusal(404, "there is nothing here")),
        },
    }
}

fn answer(stream: &mut TcpStream, status: u16, kind: &str, body: &[u8], whole: bool) -> io::Result<()> {
    let mut bytes = head(status, kind, Some(body.len())).into_bytes();
    if whole {
        bytes.extend_from_slice(body);
    }
    stream.write_all(&bytes)
}

fn head(status: u16, kind: &str, length: Option<usize>) -> String {
    let reason = match status {
        200 => "OK",
        204 => "No Content",
        400..=499 => "Refused",
        _ => "Unavailable",
    };
    let length = length.map(|length| format!("Content-Length: {length}\r\n")).unwrap_or_default();
    format!(
        "HTTP/1.1 {status} {reason}\r\nContent-Type: {kind}\r\n{length}Connection: close\r\nCache-Control: no-store\r\n\
         X-Content-Type-Options: nosniff\r\nReferrer-Policy: no-referrer\r\n\
         Cross-Origin-Resource-Policy: same-origin\r\nContent-Security-Policy: {POLICY}\r\n\r\n"
    )
}

/// Frames until the page goes away or the server stops.
fn events(stream: &mut TcpStream, shared: &Shared) -> io::Result<()> {
    let Some(frames) = shared.hub.join() else {
        return refuse(stream, Refusal(503, "too many pages are open"));
    };
    stream.write_all(head(200, "text/event-stream", None).as_bytes())?;
    // A browser that lost us comes back within half a second.
    stream.write_all(b"retry: 500\n\n")?;
    while !shared.stop.load(Ordering::Relaxed) {
        match frames.recv_timeout(Duration::from_secs(1)) {
            Ok(frame) => stream.write_all(frame.as_bytes())?,
            Err(std::sync::mpsc::RecvTimeoutError::Timeout) => stream.write_all(b": still here\n\n")?,
            Err(std::sync::mpsc::RecvTimeoutError::Disconnected) => break,
        }
    }
    Ok(())
}
