//! One run of any network: what was asked, what came out.

mod picture;
mod plan;
mod report;
mod slowed;
mod table;
mod watch;

pub use picture::picture;
pub use plan::{Plan, Wishes};
pub use report::{ById, Diverged, End, RunReport, Snapshot, Worst};
pub(crate) use report::{GUARD, proof};
pub use slowed::{Slowed, TOLD_BELOW};
pub use table::write_table;
pub(crate) use table::{bound, part};
pub use watch::Breach;

use eclss_core::{Health, Proof, Simulator};

use crate::refusal::refused;
use crate::trace::{Trace, columns};
use crate::{Failure, HostBuffers, Progress, Source};

/// Rows that a record holds at most, unless an interval was asked for.
const ROWS: u64 = 20_000;
/// Values that a record holds at most, whatever was asked for.
const VALUES: u64 = 40_000_000;

/// Runs `plan` on `source`. A run that leaves its range ends there and says so in the report.
pub fn execute(source: &Source, plan: &Plan, progress: &Progress) -> Result<(RunReport, Trace), Failure> {
    let loaded = &source.loaded;
    let network = loaded.network();
    let mut buffers = HostBuffers::default();
    let simulator = buffers.simulator(&network, plan.settings);
    let mut simulator = simulator.map_err(|error| refused(source, plan.settings, &error))?;
    let columns = columns(loaded);
    let every = interval(plan, columns.len() as u64)?;
    let mut trace = Trace::new(columns, every);
    let mut snapshots = Vec::new();
    let mut guarded_ticks = 0;
    let mut watch = watch::Watch::of(loaded);
    let mut slowed = slowed::Watch::default();
    let mut due = plan.at_ticks.iter().copied().peekable();
    progress.say(&format!("{} at {}", plan.settings.method.name(), plan.step()));
    loop {
        let (tick, trusted) = (simulator.tick(), simulator.health() == Health::Trusted);
        if trace.is_due(&simulator) {
            trace.note(&simulator);
        }
        if !trusted {
            break;
        }
        if due.next_if_eq(&tick).is_some() {
            snapshots.push(Snapshot::take(loaded, &simulator));
        }
        if tick >= plan.ticks {
            break;
        }
        simulator.step();
        guarded_ticks += u64::from(simulator.margin().proof == Proof::ShortStep);
        slowed.look(&simulator, plan.settings.method);
        if watch.is_due(&simulator) {
            watch.look(&simulator);
        }
        tell(&simulator, progress);
    }
    progress.finish();
    let mut report = RunReport::new(source, plan, snapshots, &simulator, guarded_ticks);
    report.breaches = watch.breaches();
    report.slowed = slowed.found(source);
    Ok((report, trace))
}

/// Ticks between two rows of a record with `columns`.
fn interval(plan: &Plan, columns: u64) -> Result<u64, Failure> {
    let most = VALUES / columns.max(1);
    match plan.every_ticks {
        None => Ok(plan.ticks.div_ceil(most.clamp(1, ROWS)).max(1)),
        Some(every) if plan.ticks / every <= most => Ok(every),
        Some(every) => Err(Failure::BadInput(format!(
            "--every gives {} rows of {columns} values, more than the {VALUES} values that a record holds",
            plan.ticks / every
        ))),
    }
}

/// Moves the bar once in a while.
fn tell(simulator: &Simulator<'_>, progress: &Progress) {
    const OFTEN: u64 = 4_096;
    if simulator.tick() % OFTEN == 0 {
        progress.add(OFTEN);
    }
}
