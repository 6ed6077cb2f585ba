//! `eclss-rt serve`: a plant at the clock's pace, with a page.

use std::io::Write;
use std::net::SocketAddr;
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use eclss_core::Settings;

use crate::args::{ServeArgs, Stepping};
use crate::run::{Plan, Wishes};
use crate::schematic::{Drawing, Dress, Graph};
use crate::serve::{Plant, Server, feed};
use crate::source::NETWORKS;
use crate::{Failure, Source};

/// Serves until it is interrupted.
pub(super) fn run(args: &ServeArgs, out: &mut dyn Write) -> Result<(), Failure> {
    let address = SocketAddr::new(args.listen, args.port);
    if args.control && !args.listen.is_loopback() {
        let text = "--control would let anyone on the network move the plant's inputs; listen on loopback and come in";
        return Err(Failure::BadInput(format!(
            "--listen {}: {text} through a tunnel such as ssh -L",
            args.listen
        )));
    }
    if args.recordings.is_some() && !args.listen.is_loopback() {
        return Err(Failure::BadInput(format!(
            "--listen {}: --recordings would let anyone on the network write files; listen on loopback",
            args.listen
        )));
    }
    if let Some(folder) = args.recordings.as_ref().filter(|folder| !folder.is_dir()) {
        return Err(Failure::BadInput(format!("--recordings {}: there is no such folder", folder.display())));
    }
    let source = Source::open(args.network.as_deref())?;
    // The network that was asked for, then those that ship.
    let mut names = vec![source.name.clone()];
    names.extend(NETWORKS.iter().map(|(path, _)| (*path).to_owned()));
    let (plant, drawing) = plant(source, &args.stepping)?;
    let (mut publisher, first) = feed(plant.catalogue(args.control));
    let server = Server::start(address, first, drawing)
        .map_err(|error| Failure::Failed(format!("cannot listen at {address}: {error}")))?;
    if let Some(folder) = &args.recordings {
        server.allow_recording(folder.clone());
    }
    // Whoever chooses a network ends the present one.
    let (stop, number) = (Arc::new(AtomicBool::new(false)), Arc::new(AtomicUsize::new(0)));
    let (chosen, ends, choice) = (server.offer(names), Arc::clone(&stop), Arc::clone(&number));
    std::thread::Builder::new().name("choices".into()).spawn(move || {
        for one in chosen {
            choice.store(one, Ordering::Release);
            ends.store(true, Ordering::Release);
        }
    })?;
    let link = format!("http://{}/", server.address());
    writeln!(out, "{link}")?;
    let hint = if args.control { "" } else { " Sliders and buttons are off; --control switches them on." };
    writeln!(out, "Ctrl-C ends it.{hint}")?;
    out.flush()?;
    if args.open {
        open(&link);
    }
    #[cfg(feature = "hil")]
    if args.real_time {
        // This thread becomes the plant's; the server's were begun before and stay as they are.
        for missing in crate::hil::realtime::become_real_time(crate::hil::realtime::Wishes::default()) {
            writeln!(out, "{missing}")?;
        }
        out.flush()?;
    }
    let own = plant.clone();
    let mut plant = plant;
    loop {
        plant.run(publisher, &stop)?;
        stop.store(false, Ordering::Release);
        let number = number.load(Ordering::Acquire);
        let (next, drawing) = match number.checked_sub(1).and_then(|place| NETWORKS.get(place)) {
            // As its file says: the method of the command line need not suit it.
            Some((path, text)) => self::plant(Source::built_in(text, path)?, &Stepping::default())?,
            None => (own.clone(), drawn(own.source())),
        };
        plant = next;
        let (ours, theirs) = feed(plant.catalogue(args.control));
        publisher = ours;
        server.show(theirs, drawing)?;
    }
}

/// A plant with its drawing.
fn plant(source: Source, stepping: &Stepping) -> Result<(Plant, Option<String>), Failure> {
    let wishes = Wishes { method: stepping.method, step: stepping.step, ..Wishes::default() };
    let step_us = Plan::step_us(&source, &wishes)?;
    let method = stepping.method.unwrap_or(source.loaded.run.method);
    let drawing = drawn(&source);
    Ok((Plant::new(source, Settings { method, step_us })?, drawing))
}

/// The drawing of a network; one that is too large for a drawing has a page without one.
fn drawn(source: &Source) -> Option<String> {
    let graph = Graph::of(&source.loaded.file);
    Drawing::new(&graph).map(|drawing| drawing.svg(&graph, Dress::Page)).ok()
}

/// Opens the page in the user's browser; where that fails, the printed link is left.
fn open(link: &str) {
    let program = if cfg!(target_os = "macos") {
        "open"
    } else if cfg!(windows) {
        "explorer"
    } else {
        "xdg-open"
    };
    let _ = Command::new(program)
        .arg(link)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn();
}
