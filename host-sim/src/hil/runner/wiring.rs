//! What is opened before the loop begins: record, tester, page, and the process image that runs.

use std::collections::BTreeMap;
use std::io::{self, Write};

use eclss_core::process::Image;
use eclss_core::protocol::{Config, Role};
use eclss_target::coupling::link_counts;
use eclss_target::wire::{Keeper, Link, open, pair};

use super::{Job, Loopback, RecordWishes};
use crate::hil::loopback::Probe;
use crate::hil::page::{Page, catalogue};
use crate::hil::recorder::{Order, Recorder};
use crate::hil::shot::{Album, Camera};
use crate::{Failure, Source};

/// Opens the record, where one is wished.
pub(in crate::hil) fn open_recorder(
    wishes: Option<&RecordWishes>,
    names: &[String],
    epoch_ns: u64,
    network: &str,
    start: &[u8],
    begin: &BTreeMap<String, String>,
) -> Result<Option<Recorder>, Failure> {
    let open = |wishes: &RecordWishes| {
        Recorder::new(&Order {
            folder: &wishes.folder,
            names,
            every: wishes.every,
            triggers: &wishes.triggers,
            before: wishes.around.0,
            after: wishes.around.1,
            epoch_ns,
            network,
            start,
            begin,
        })
    };
    wishes.map(open).transpose()
}

/// The tester's end, and what keeps its wire.
type Tester = (Link, Option<Keeper>);

/// The loop's end of the link, and the tester's where there is one.
pub(super) fn open_tester(
    loopback: Option<&Loopback>,
    link: Option<Link>,
) -> io::Result<(Option<Link>, Option<Tester>)> {
    Ok(match loopback {
        None => (link, None),
        Some(Loopback::Inside) => {
            let (ours, testers) = pair()?;
            (Some(ours), Some((testers, None)))
        }
        Some(Loopback::Over(address)) => {
            let (testers, keeper) = open(address)?;
            (link, Some((testers, Some(keeper))))
        }
    })
}

/// A page with what it is shown, and the loop's camera for it.
type Shown = (Option<(Page, Album)>, Option<Camera>);

/// Opens the page, where one is wished.
pub(super) fn open_page(source: &Source, job: &Job, out: &mut dyn Write) -> Result<Shown, Failure> {
    let Some(address) = job.page else { return Ok((None, None)) };
    let catalogue = catalogue(source, job.settings, "this computer, with hardware")?;
    let page = Page::new(source, catalogue, job.settings, address)?;
    if job.shows {
        // Who does not read our output does not stop hardware.
        let _ = writeln!(out, "page http://{}/", page.address());
    }
    let (camera, album) = page.camera(source, job.settings);
    Ok((Some((page, album)), Some(camera)))
}

/// Names of the channels of the image that runs, inputs first.
pub(super) fn channel_names(source: &Source, probe: Option<&Probe>) -> Vec<String> {
    let process = &source.loaded.process;
    let inputs = process.inputs.iter().map(|entry| entry.name.clone());
    let outputs = process.outputs.iter().map(|entry| entry.name.clone());
    let added = probe.map(|probe| format!("{} (loopback)", probe.name));
    inputs.chain(outputs).chain(added).collect()
}

/// Lends the process image that runs.
pub(super) fn with_image<T>(source: &Source, probe: Option<&Probe>, take: impl FnOnce(Image<'_>) -> T) -> T {
    let process = &source.loaded.process;
    match probe {
        None => process.with_image(take),
        Some(probe) => probe.with_image(process, take),
    }
}

/// What both ends of the link agree on.
pub(super) fn config(image: &Image<'_>, network_id: u64, step_us: u32, role: Role) -> Config {
    let (inputs, outputs) = link_counts(image);
    let config =
        Config { role, network_id, process_id: image.id(), step_us, inputs, outputs, ..Config::default() };
    match role {
        Role::Plant => Config {
            silent_ticks: image.safe_after_ticks.saturating_mul(10),
            stale_us: u64::from(image.safe_after_ticks) * u64::from(step_us),
            ..config
        },
        Role::Controller => config,
    }
}
