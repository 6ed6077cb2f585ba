//! `eclss-rt serve`: a plant at the clock's pace, with a page.

use std::io::Write;
use std::net::SocketAddr;
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use eclss_core::Settings;

use crate::args::ServeArgs;
use crate::run::{Plan, Wishes};
use crate::schematic::{Drawing, Dress, Graph};
use crate::serve::{Plant, Server, feed};
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
    let source = Source::open(args.network.as_deref())?;
    let wishes = Wishes { method: args.stepping.method, step: args.stepping.step, ..Wishes::default() };
    let step_us = Plan::step_us(&source, &wishes)?;
    let method = args.stepping.method.unwrap_or(source.loaded.run.method);
    let graph = Graph::of(&source.loaded.file);
    // A network that is too large for a drawing has a page without one.
    let drawing = Drawing::new(&graph).map(|drawing| drawing.svg(&graph, Dress::Page)).ok();
    let plant = Plant::new(source, Settings { method, step_us })?;
    let (publisher, feed) = feed(plant.catalogue(args.control));
    let server = Server::start(address, feed, drawing)
        .map_err(|error| Failure::Failed(format!("cannot listen at {address}: {error}")))?;
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
    plant.run(publisher, &Arc::new(AtomicBool::new(false)))
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
