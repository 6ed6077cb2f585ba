//! A fixed set of answers. No file is ever read on a request's word; what a request may write is
//! [`super::recorder`]'s matter.

use std::io::{self, Write};
use std::net::{Shutdown, TcpStream};
use std::sync::atomic::Ordering;
use std::sync::mpsc::SyncSender;
use std::time::Duration;

use super::feed::Command;
use super::recorder::Wish;
use super::request::{Refusal, Request};
use super::server::Shared;

/// Files of the page: path, type, content. All of it is part of the program.
const FILES: [(&str, &str, &str); 14] = [
    ("/", "text/html; charset=utf-8", include_str!("../../page/index.html")),
    ("/page.css", "text/css; charset=utf-8", include_str!("../../page/page.css")),
    ("/schematic.css", "text/css; charset=utf-8", include_str!("../../page/schematic.css")),
    ("/main.js", SCRIPT, include_str!("../../page/main.js")),
    ("/stream.js", SCRIPT, include_str!("../../page/stream.js")),
    ("/figures.js", SCRIPT, include_str!("../../page/figures.js")),
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

/// Networks that a page may choose among.
pub(super) struct Choices {
    /// Their names.
    pub(super) networks: Vec<String>,
    /// Where the number of the chosen one goes.
    pub(super) asked: SyncSender<usize>,
}

/// What a page asks for: the number of a network.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct Choice {
    network: usize,
}

/// Says why not.
pub(super) fn refuse(stream: &mut TcpStream, Refusal(status, reason): Refusal) -> io::Result<()> {
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

/// Answers a request that may be answered.
pub(super) fn reply(stream: &mut TcpStream, shared: &Shared, request: &Request) -> io::Result<()> {
    if request.method == "POST" {
        return match act(shared, request) {
            Ok(()) => answer(stream, 204, JSON, b"", true),
            Err(refusal) => refuse(stream, refusal),
        };
    }
    let whole = request.method != "HEAD";
    let shown = shared.shown();
    match request.path.as_str() {
        "/network" => answer(stream, 200, JSON, shown.catalogue.as_bytes(), whole),
        "/schematic.svg" => match &shown.drawing {
            Some(drawing) => answer(stream, 200, "image/svg+xml", drawing.as_bytes(), whole),
            None => refuse(stream, Refusal(404, "this network is not drawn")),
        },
        // One frame, for programs that ask now and then.
        "/frame" => match shared.hub.latest() {
            Some(event) => answer(stream, 200, JSON, event.trim_start_matches("data: ").as_bytes(), whole),
            None => refuse(stream, Refusal(503, "nothing was published yet")),
        },
        "/networks" => {
            let control = shown.feed.catalogue.control;
            let list = shared.choices.get().filter(|_| control).map_or(&[][..], |choices| &choices.networks);
            answer(stream, 200, JSON, &serde_json::to_vec(list)?, whole)
        }
        "/recording" if shared.recorder.allowed() => {
            answer(stream, 200, JSON, shared.recorder.state().as_bytes(), whole)
        }
        // An empty answer, so that a page that asks finds no error in its console.
        "/recording" => answer(stream, 204, JSON, b"", whole),
        "/events" if whole => {
            drop(shown);
            events(stream, shared)
        }
        path => match FILES.iter().find(|(name, ..)| *name == path) {
            Some((_, kind, text)) => answer(stream, 200, kind, text.as_bytes(), whole),
            None => refuse(stream, Refusal(404, "there is nothing here")),
        },
    }
}

/// Does what a page asks for.
fn act(shared: &Shared, request: &Request) -> Result<(), Refusal> {
    let shown = shared.shown();
    let control = shown.feed.catalogue.control;
    match request.path.as_str() {
        "/command" | "/networks" if !control => {
            Err(Refusal(403, "this server takes no commands; start it with --control"))
        }
        "/command" => match serde_json::from_slice::<Command>(&request.body) {
            Ok(command) if shown.feed.command(command) => Ok(()),
            Ok(_) => Err(Refusal(503, "too many commands wait")),
            Err(_) => Err(Refusal(400, "not a command")),
        },
        "/networks" => {
            let choice = serde_json::from_slice::<Choice>(&request.body);
            let Choice { network } = choice.map_err(|_| Refusal(400, "not a choice"))?;
            let choices = shared.choices.get().filter(|choices| network < choices.networks.len());
            let choices = choices.ok_or(Refusal(400, "there is no such network"))?;
            choices.asked.try_send(network).map_err(|_| Refusal(503, "another choice waits"))
        }
        "/recording" if !shared.recorder.allowed() => {
            Err(Refusal(403, "this server writes no files; start it with --recordings DIR"))
        }
        "/recording" => {
            let wish = serde_json::from_slice::<Wish>(&request.body);
            let wish = wish.map_err(|_| Refusal(400, "not a wish for a recording"))?;
            shared.recorder.ask(&wish, &shown.feed.catalogue).map_err(|reason| Refusal(409, reason))
        }
        _ => Err(Refusal(404, "there is nothing here")),
    }
}

/// Writes a whole answer; its body only where it is asked for.
pub(super) fn answer(
    stream: &mut TcpStream,
    status: u16,
    kind: &str,
    body: &[u8],
    whole: bool,
) -> io::Result<()> {
    // An answer without content has no length either.
    let mut bytes = head(status, kind, (status != 204).then_some(body.len())).into_bytes();
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
