//! Writes the process image as constant tables.

use std::fmt::{Debug, Write as _};

use eclss_core::process::{Curve, InputChannel, OutputChannel, Port, Scaling};

use super::{constant, table};
use crate::loaded::Loaded;

/// Appends `INPUT_CHANNELS`, `OUTPUT_CHANNELS`, their names, `PROCESS` and `PROCESS_ID`.
pub(super) fn write(loaded: &Loaded, text: &mut String) {
    let process = &loaded.process;
    let (inputs, outputs) = (process.input_channels(), process.output_channels());
    table(text, "Channels from hardware to the plant.", "INPUT_CHANNELS", "InputChannel", &inputs, input);
    table(text, "Channels from the plant to hardware.", "OUTPUT_CHANNELS", "OutputChannel", &outputs, output);
    let names = |list: Vec<&str>| list.into_iter().map(|name| format!("{name:?}")).collect::<Vec<_>>();
    let input_names = names(process.inputs.iter().map(|entry| entry.name.as_str()).collect());
    let output_names = names(process.outputs.iter().map(|entry| entry.name.as_str()).collect());
    table(text, "Names of the input channels.", "INPUT_CHANNEL_NAMES", "&str", &input_names, String::clone);
    table(
        text,
        "Names of the output channels.",
        "OUTPUT_CHANNEL_NAMES",
        "&str",
        &output_names,
        String::clone,
    );
    constant(text, "Id of the process image.", "PROCESS_ID", "u64", format!("0x{:016x}", process.id()));
    let _ = write!(
        text,
        "\n/// The process image.\n\
         pub static PROCESS: Image<'static> = Image {{\n    \
             inputs: &INPUT_CHANNELS,\n    outputs: &OUTPUT_CHANNELS,\n    order: Order::{:?},\n    \
             safe_after_ticks: {},\n    \
             rest: eclss_core::process::Rest {{ part: {:?}, time_s: {:?} }},\n}};\n",
        process.order, process.safe_after_ticks, process.rest.part, process.rest.time_s
    );
}

fn input(channel: &InputChannel<'_>) -> String {
    let c = channel;
    format!(
        "InputChannel {{ slot: {}, port: {}, scaling: {}, min: {:?}, max: {:?}, saturates: {}, \
         max_rate_per_s: {}, filter_s: {:?}, hold: Hold::{:?}, extrapolate_ticks: {}, event_step: {:?}, \
         stale_ticks: {}, safe_value: {:?}, safe_rate_per_s: {:?}, essential: {} }}",
        c.slot,
        port(c.port),
        scaling(&c.scaling),
        c.min,
        c.max,
        c.saturates,
        number(c.max_rate_per_s),
        c.filter_s,
        c.hold,
        c.extrapolate_ticks,
        c.event_step,
        c.stale_ticks,
        c.safe_value,
        c.safe_rate_per_s,
        c.essential
    )
}

fn output(channel: &OutputChannel<'_>) -> String {
    let c = channel;
    format!(
        "OutputChannel {{ signal: {}, port: {}, scaling: {}, min: {:?}, max: {:?}, max_rate_per_s: {}, \
         safe_value: {:?}, safe_rate_per_s: {:?} }}",
        debug(&c.signal).replace("{ output: ", "{ output: Output::"),
        port(c.port),
        scaling(&c.scaling),
        c.min,
        c.max,
        number(c.max_rate_per_s),
        c.safe_value,
        c.safe_rate_per_s
    )
}

fn port(port: Port) -> String {
    format!("Port::{port:?}")
}

/// A number that may be infinite.
fn number(number: f32) -> String {
    if number.is_finite() { format!("{number:?}") } else { "f32::INFINITY".into() }
}

fn scaling(scaling: &Scaling<'_>) -> String {
    if *scaling == Scaling::NONE {
        return "Scaling::NONE".into();
    }
    format!(
        "Scaling {{ electrical: {}, engineering: {}, wire: {}, calibration: Calibration {} }}",
        curve(scaling.electrical),
        curve(scaling.engineering),
        debug(&scaling.wire),
        format_args!("{{ id: {:?}, date: {} }}", scaling.calibration.id, scaling.calibration.date)
    )
}

fn curve(curve: Curve<'_>) -> String {
    format!("Curve {{ points: &{:?} }}", curve.points)
}

fn debug(item: &impl Debug) -> String {
    format!("{item:?}")
}
