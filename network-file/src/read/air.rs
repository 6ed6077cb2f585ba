//! Reads heat, moisture, composition and control.

use eclss_core::InputSpec;
use eclss_core::climate::ControlLoop;
use eclss_core::parameter::Place;

use crate::document::NetworkFile;
use crate::document::air::{AirEntry, ContentsEntry, ControlEntry, ControlKind, PartEntry, Starts};
use crate::limits;
use crate::table::Table;

/// Reads what stands beside nodes and lines.
pub(super) fn read_parts(root: &mut Table<'_, '_>, file: &mut NetworkFile) {
    file.air = root.table("air", |air| AirEntry {
        reference_temperature_k: air.number("reference_temperature_k", &limits::MOIST_TEMPERATURE),
        coolant_heat_j_kg_k: air.number("coolant_heat_j_kg_k", &limits::SPECIFIC_HEAT),
        coolant_expansion_1_k: air.number("coolant_expansion_1_k", &limits::EXPANSION),
    });
    for kind in root.notes.kinds.iter().copied().filter(|kind| kind.place() != Place::Line) {
        let parts = root.tables(kind.name(), 0..=limits::PARTS, |table| {
            let (id, node) = (table.need_id("id"), table.need_text("node"));
            Some(PartEntry { id, node, entry: super::read_entry(table, kind) })
        });
        if !parts.is_empty() {
            file.parts.insert(kind.name(), parts);
        }
    }
    file.controls = root.tables("control", 0..=limits::PARTS, read_control);
}

/// Start values of inputs.
pub(super) fn starts(table: &mut Table<'_, '_>, specs: &[InputSpec]) -> Starts {
    let mut starts = Starts::new();
    for spec in specs {
        if let Some(value) = table.number(spec.name, &limits::of(spec)) {
            starts.insert(spec.name, value);
        }
    }
    starts
}

pub(super) fn read_contents(node: &mut Table<'_, '_>) -> ContentsEntry {
    ContentsEntry {
        contents: node.word("contents", &["air", "coolant"]),
        oxygen_pa: node.number("oxygen_pa", &limits::PRESSURE),
        carbon_dioxide_pa: node.number("carbon_dioxide_pa", &limits::PRESSURE),
        trace_pa: node.number("trace_pa", &limits::PRESSURE),
        dew_point_k: node.number("dew_point_k", &limits::MOIST_TEMPERATURE),
        mixing_limit_s: node.number("mixing_limit_s", &limits::SOME_TIME),
        surface_kg_s_pa: node.number("surface_kg_s_pa", &limits::FRACTION),
    }
}

fn read_control(table: &mut Table<'_, '_>) -> Option<ControlEntry> {
    let id = table.need_id("id");
    let kind = if table.need_kind("kind", &["pid", "thermostat"])? == "pid" {
        ControlKind::Pid {
            gain: table.need_number("gain", &limits::ANY),
            integral_s: table.number("integral_s", &limits::SOME_TIME),
            derivative_s: table.number("derivative_s", &limits::TIME),
            dead_band: table.number("dead_band", &limits::PRESSURE),
            bias: table.number("bias", &limits::FRACTION),
            rate_per_s: table.number("rate_per_s", &limits::OUTPUT_RATE),
        }
    } else {
        let on_when = table.word("on_when", &["high", "low"]);
        if on_when.is_none() && !table.has("on_when") {
            table.refuse("on_when", "`on_when` is missing: \"high\" or \"low\"");
        }
        ControlKind::Thermostat {
            half_band: table.need_number("half_band", &limits::PRESSURE),
            on_when: on_when.unwrap_or_default(),
        }
    };
    Some(ControlEntry {
        id,
        measures: table.need_text("measures"),
        drives: table.need_text("drives"),
        opposite: table.text("opposite"),
        kind,
        closed: table.need_number("closed", &limits::ANY),
        open: table.need_number("open", &limits::ANY),
        travel_s: table.number("travel_s", &limits::SOME_TIME),
        stiction: table.number("stiction", &limits::FRACTION),
        sensor_min: table.need_number("sensor_min", &limits::ANY),
        sensor_max: table.need_number("sensor_max", &limits::ANY),
        sensor_lag_s: table.number("sensor_lag_s", &limits::TIME),
        sensor_noise: table.number("sensor_noise", &limits::PRESSURE),
        seed: table.number("seed", &limits::SEED),
        starts: starts(table, &ControlLoop::INPUTS),
    })
}
