//! What the link and the process image cost in a tick, for few and for many channels.

use super::{Figure, calling, counted};
use core::hint::black_box;
use eclss_core::Output;
use eclss_core::mode::Mode;
use eclss_core::process::{
    CHANNELS, Hold, Image, InputChannel, InputState, OutputChannel, OutputState, Port, Process, Scaling,
};
use eclss_core::protocol::{Config, FRAME_BYTES, Link, Outgoing, Role};

/// Ticks of each measurement.
const TICKS: u64 = 200;

const INPUT: InputChannel<'static> = InputChannel {
    slot: 0,
    port: Port::Link,
    scaling: Scaling::NONE,
    min: 0.0,
    max: 1.0,
    saturates: false,
    max_rate_per_s: 4.0,
    filter_s: 0.01,
    hold: Hold::Linear,
    extrapolate_ticks: 1,
    event_step: 0.1,
    stale_ticks: 10,
    safe_value: 0.5,
    safe_rate_per_s: 1.0,
    essential: true,
};

const OUTPUT: OutputChannel<'static> = OutputChannel {
    signal: Output::MassFlow.of(0),
    port: Port::Link,
    scaling: Scaling::NONE,
    min: -1.0,
    max: 1.0,
    max_rate_per_s: 100.0,
    safe_value: 0.0,
    safe_rate_per_s: 1.0,
};

/// Names of the figures, by number of channels each way.
const SIZES: [(usize, [&str; 4]); 3] = [
    (2, ["receive-2", "send-2", "ingest-2", "emit-2"]),
    (16, ["receive-16", "send-16", "ingest-16", "emit-16"]),
    (CHANNELS, ["receive-64", "send-64", "ingest-64", "emit-64"]),
];

/// Measures a frame each way and the process image of as many channels.
pub(super) fn measure() -> bool {
    SIZES
        .into_iter()
        .all(|(channels, names)| link(channels, names).is_some() && image(channels, names).is_some())
}

/// Both ends in one program; what one sends, the other receives.
fn link(channels: usize, [receive, send, ..]: [&str; 4]) -> Option<()> {
    let calling = calling();
    let config = |role| Config { role, ..Config::default() };
    let mut plant = Link::new(config(Role::Plant), 1);
    let mut controller = Link::new(config(Role::Controller), 2);
    let values: [f32; CHANNELS] = core::array::from_fn(|index| 0.01 * index as f32);
    let quality = [0; CHANNELS];
    let (values, quality) = (values.get(..channels)?, quality.get(..channels)?);
    let (mut receiving, mut sending) = (Figure::EMPTY, Figure::EMPTY);
    let mut bytes = [0; 2 * FRAME_BYTES];
    for tick in 0..TICKS {
        let outgoing = Outgoing { mode: Mode::Run, values, quality, ..Outgoing::default() };
        controller.send_tick(tick, 1_000 * tick, &outgoing);
        let length = controller.outgoing().len();
        bytes.get_mut(..length)?.copy_from_slice(controller.outgoing());
        controller.sent(length);
        let came = bytes.get(..length)?;
        let received = counted(&mut || {
            plant.feed(black_box(came), 1_000 * tick);
            black_box(plant.take_data());
        });
        let outgoing = Outgoing { seen: quality, ..outgoing };
        let sent = counted(&mut || plant.send_tick(tick, 1_000 * tick, black_box(&outgoing)));
        let length = plant.outgoing().len();
        controller.feed(plant.outgoing(), 1_000 * tick);
        plant.sent(length);
        // The first ticks are the handshake's.
        if tick >= 10 {
            receiving.add(received - calling);
            sending.add(sent - calling);
        }
    }
    receiving.report("link", receive);
    sending.report("link", send);
    plant.is_connected().then_some(())
}

fn image(channels: usize, [.., ingest, emit]: [&str; 4]) -> Option<()> {
    static INPUTS: [InputChannel<'static>; CHANNELS] = [INPUT; CHANNELS];
    static OUTPUTS: [OutputChannel<'static>; CHANNELS] = [OUTPUT; CHANNELS];
    let calling = calling();
    let mut inputs = [const { InputState::new(0.5) }; CHANNELS];
    let mut outputs = [const { OutputState::new(0.0) }; CHANNELS];
    let image = Image { inputs: INPUTS.get(..channels)?, outputs: OUTPUTS.get(..channels)?, ..Image::EMPTY };
    let mut process = Process::new(image, 1e-3, &mut inputs, &mut outputs).ok()?;
    let (mut ingesting, mut emitting) = (Figure::EMPTY, Figure::EMPTY);
    let conduct = Mode::Run.conduct();
    for tick in 0..TICKS {
        let raw = [Some(0.5 + 1e-4 * tick as f32); CHANNELS];
        let ingested = counted(&mut || process.ingest(black_box(&raw), conduct));
        let emitted = counted(&mut || process.emit(|_| black_box(0.08), conduct));
        ingesting.add(ingested - calling);
        emitting.add(emitted - calling);
    }
    ingesting.report("link", ingest);
    emitting.report("link", emit);
    Some(())
}
