//! What a run with hardware was like, in figures.

use eclss_core::protocol::{Counters, Drift};
use serde::Serialize;

use super::loopback::LoopbackFigures;
use super::timing::{Bucket, Summary};

mod text;

use eclss_target::wire::LinkCounts;
pub use text::write_report;
pub(super) use text::{write_link, write_record};

/// Version of the report's format.
pub const FORMAT: u32 = 1;

/// The whole report.
#[derive(Debug, Clone, Serialize)]
pub struct Report {
    /// [`FORMAT`].
    pub format: u32,
    /// Where the network came from.
    pub network: String,
    /// Its id, hexadecimal.
    pub network_id: String,
    /// Id of the process image, hexadecimal.
    pub process_id: String,
    /// Method.
    pub method: &'static str,
    /// Step [s].
    pub step_s: f64,
    /// When outputs go out: `latched` or `immediate`.
    pub order: &'static str,
    /// The computer, as far as it tells.
    pub machine: Machine,
    /// What the loop had to do without.
    pub missing: Vec<String>,
    /// Rate asked for [Hz].
    pub target_hz: f64,
    /// Rate reached [Hz].
    pub actual_hz: f64,
    /// Ticks that ran.
    pub ticks: u64,
    /// From a tick's begin to its end, handing over included (TET).
    pub tick: Summary,
    /// Part of the period that the longest tick left [1]; negative where it ran over.
    pub headroom: f64,
    /// From a tick's release to its begin.
    pub wake_up: Summary,
    /// The same as a histogram.
    pub wake_up_histogram: Vec<Bucket>,
    /// Ticks that ended after the next release.
    pub overruns: Overruns,
    /// Releases at which no tick ran.
    pub missed_ticks: u64,
    /// Time that the loop ticked through [s].
    pub loop_s: f64,
    /// Steps of the plant times step [s].
    pub plant_s: f64,
    /// Time on the wall [s].
    pub wall_s: f64,
    /// How far the loop's ticks are behind the wall [s].
    pub lag_s: f64,
    /// From reading inputs to giving out what follows from them, measured in the loop; largest minus smallest is its
    /// jitter.
    pub in_out: Summary,
    /// The link, where there is one.
    pub link: Option<LinkFigures>,
    /// Channels of the process image, inputs first.
    pub channels: Vec<ChannelFigures>,
    /// In→out delay by loopback, where it was measured.
    pub loopback: Option<LoopbackFigures>,
    /// Mode at the end.
    pub mode: &'static str,
    /// Why it is SAFE, if it is.
    pub cause: Option<String>,
    /// Hash over the plant's state at the end, hexadecimal.
    pub state_hash: String,
    /// The record, where there is one.
    pub record: Option<RecordFigures>,
    /// Events that found no room.
    pub events_lost: u64,
}

/// The computer.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Machine {
    /// Processor, as the kernel calls it.
    pub processor: String,
    /// Cores that this process may use.
    pub cores: usize,
    /// Kernel.
    pub kernel: String,
    /// Whether the processor says that it is a virtual one: then latencies are those of a guest.
    pub virtual_machine: bool,
}

/// Ticks that were too long.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Overruns {
    /// All of them.
    pub total: u32,
    /// The most in a row.
    pub consecutive: u32,
    /// Those in the first second.
    pub start_up: u32,
}

/// Figures of the link.
#[derive(Debug, Clone, Serialize)]
pub struct LinkFigures {
    /// Where it leads.
    pub address: String,
    /// Bytes.
    #[serde(flatten)]
    pub bytes: LinkCounts,
    /// Whether there was a session at the end.
    pub connected: bool,
    /// Sessions that began.
    pub sessions: u32,
    /// Frames that were taken.
    pub accepted: u32,
    /// Those of them whose values were too old to be used.
    pub stale: u32,
    /// Commands that were refused because nothing proved that their sender has the key.
    pub unproven: u32,
    /// Frames that never came.
    pub lost: u32,
    /// Frames that came late or out of order.
    pub late: u32,
    /// Frames that had come before.
    pub duplicate: u32,
    /// Frames with a wrong check sum.
    pub bad_crc: u32,
    /// Frames that were damaged otherwise.
    pub damaged: u32,
    /// Frames of another version, network, process image or session.
    pub foreign: u32,
    /// Frames of our own that found no room.
    pub unsent: u32,
    /// Time that a frame takes to the peer and back [µs], of the fastest exchange.
    pub round_trip_us: Option<u64>,
    /// The peer's clock minus ours [µs].
    pub peer_offset_us: Option<i64>,
    /// By how much the peer's clock runs faster [ppm].
    pub peer_drift_ppm: Option<f64>,
    /// Bound of the error of that [ppm].
    pub peer_drift_error_ppm: Option<f64>,
}

impl LinkFigures {
    /// Takes the counters over.
    pub fn new(address: String, bytes: LinkCounts, connected: bool, counters: &Counters) -> Self {
        Self {
            address,
            bytes,
            connected,
            sessions: counters.sessions,
            accepted: counters.accepted,
            stale: counters.stale,
            unproven: counters.unproven,
            lost: counters.lost,
            late: counters.late.saturating_add(counters.ancient),
            duplicate: counters.duplicate,
            bad_crc: counters.bad_crc,
            damaged: counters.damaged() - counters.bad_crc,
            foreign: counters.foreign(),
            unsent: counters.unsent,
            round_trip_us: None,
            peer_offset_us: None,
            peer_drift_ppm: None,
            peer_drift_error_ppm: None,
        }
    }

    /// The same with what is known of the peer's clock.
    #[must_use]
    pub fn with_drift(self, drift: Option<Drift>) -> Self {
        Self {
            peer_drift_ppm: drift.map(|drift| drift.ppb as f64 / 1e3),
            peer_drift_error_ppm: drift.map(|drift| drift.error_ppb as f64 / 1e3),
            ..self
        }
    }
}

/// What a channel was worth.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct ChannelFigures {
    /// Its slot or point.
    pub name: String,
    /// `in` to the plant or `out` of it.
    pub direction: &'static str,
    /// What its value was worth at the end.
    pub quality: &'static str,
    /// Values that were NaN or infinite.
    pub not_finite: u32,
    /// Values rejected because they were out of range.
    pub out_of_range: u32,
    /// Values rejected because they had changed faster than the channel can.
    pub too_fast: u32,
    /// Values rejected because no sound wire carries them.
    pub open_wire: u32,
    /// Values limited to the range.
    pub limited: u32,
}

/// Figures of the record.
#[derive(Debug, Clone, Default, Serialize)]
pub struct RecordFigures {
    /// Files.
    pub files: Vec<String>,
    /// Ticks that were handed over.
    pub rows: u64,
    /// Ticks that were not: the recorder did not keep up.
    pub dropped: u32,
    /// Captures.
    pub captures: u32,
}

impl Machine {
    /// Asks the kernel.
    pub fn this() -> Self {
        let cpu = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
        let field = |name: &str| {
            let line = cpu.lines().find(|line| line.starts_with(name));
            line.and_then(|line| line.split_once(':')).map(|(_, value)| value.trim().to_owned())
        };
        let kernel = std::fs::read_to_string("/proc/sys/kernel/osrelease").unwrap_or_default();
        Self {
            processor: field("model name").unwrap_or_else(|| "unknown".to_owned()),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            kernel: kernel.trim().to_owned(),
            virtual_machine: field("flags")
                .is_some_and(|flags| flags.split(' ').any(|flag| flag == "hypervisor")),
        }
    }
}
