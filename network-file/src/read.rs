//! From TOML text to the document: keys, types, ranges.

mod air;

use std::collections::BTreeMap;
use std::ops::Range as Span;

use eclss_core::component::FileKind;
use eclss_core::parameter::{KeyType, Place, Presence};
use toml::de::{DeTable, DeValue};

use crate::channel;
use crate::document::{
    ElementEntry, Entry, LineEntry, NetworkFile, NodeEntry, NodeEntryKind, Run, SCHEMA, ScheduleEntry, Value,
};
use crate::limits::{self, Range};
use crate::notes::Notes;
use crate::number::number;
use crate::table::Table;

/// Kinds of node, as written.
const NODE_KINDS: [&str; 5] = ["cabin", "liquid", "accumulator", "junction", "boundary"];
/// Reads the whole text; the document counts only if there are no findings.
pub(crate) fn read(text: &str, notes: &mut Notes) -> Option<NetworkFile> {
    if text.len() > limits::FILE_BYTES {
        notes.refuse(
            0..0,
            format!("the file has {} bytes, at most {} are allowed", text.len(), limits::FILE_BYTES),
        );
        return None;
    }
    let (document, errors) = DeTable::parse_recoverable(text);
    for error in &errors {
        notes.refuse(error.span().unwrap_or(0..0), format!("not TOML: {}", error.message()));
    }
    if !errors.is_empty() {
        return None;
    }
    // The root table has no header to point at: its first character stands for it.
    let root = Table::new(notes, document.get_ref(), 0..text.len().min(1), String::new());
    let file = root.read(read_file);
    notes.findings.is_empty().then_some(file).flatten()
}

fn read_file(root: &mut Table<'_, '_>) -> Option<NetworkFile> {
    let schema = root.need_number("schema", &limits::ANY);
    if (schema - SCHEMA as f64).abs() > 0.0 && root.has("schema") {
        root.refuse("schema", format!("schema {schema} is not known, this version reads schema {SCHEMA}"));
        return None;
    }
    let name = root.need_id("name");
    let title = root.text("title");
    let reference_pressure_pa = root.need_number("reference_pressure_pa", &limits::PRESSURE);
    let run = root.table("run", read_run).unwrap_or_else(default_run);
    let nodes = root.tables("node", 1..=limits::NODES, read_node);
    let lines = root.tables("line", 1..=limits::LINES, |line| Some(read_line(line)));
    let schedules = root.tables("schedule", 0..=limits::SCHEDULES, |table| Some(read_schedule(table)));
    let process = root.table("process", channel::read_process);
    let channels = root.tables("channel", 0..=2 * limits::CHANNELS, channel::read_channel);
    let mut file = NetworkFile {
        schema: SCHEMA,
        name,
        title,
        reference_pressure_pa,
        run,
        air: None,
        nodes,
        lines,
        parts: BTreeMap::new(),
        controls: Vec::new(),
        schedules,
        process,
        channels,
    };
    air::read_parts(root, &mut file);
    Some(file)
}

fn default_run() -> Run {
    let text = |text: &str| text.to_owned();
    let (method, step, until) = (text(limits::METHOD), text(limits::STEP), text(limits::UNTIL));
    Run { method, step, until, start: None, record: None }
}

fn read_run(run: &mut Table<'_, '_>) -> Run {
    let default = default_run();
    Run {
        method: run.text("method").unwrap_or(default.method),
        step: run.text("step").unwrap_or(default.step),
        until: run.text("until").unwrap_or(default.until),
        start: run.word("start", &["file", "steady"]),
        record: read_record(run),
    }
}

fn read_record(run: &mut Table<'_, '_>) -> Option<Vec<String>> {
    let mut points = Vec::new();
    for value in run.array("record")? {
        match value.get_ref() {
            DeValue::String(point) => points.push(point.to_string()),
            _ => run.notes.refuse(value.span(), "a recorded point is text, as in \"valve.mass_flow\""),
        }
    }
    Some(points)
}

fn read_node(node: &mut Table<'_, '_>) -> Option<NodeEntry> {
    let id = node.need_id("id");
    let kind = match node.need_kind("kind", &NODE_KINDS)?.as_str() {
        "cabin" => NodeEntryKind::Cabin { volume_m3: node.need_number("volume_m3", &limits::NODE_VOLUME) },
        "liquid" => NodeEntryKind::Liquid {
            volume_m3: node.need_number("volume_m3", &limits::NODE_VOLUME),
            density_kg_m3: node.need_number("density_kg_m3", &limits::DENSITY),
            bulk_modulus_pa: node.need_number("bulk_modulus_pa", &limits::BULK_MODULUS),
        },
        "accumulator" => NodeEntryKind::Accumulator {
            volume_m3: node.need_number("volume_m3", &limits::NODE_VOLUME),
            density_kg_m3: node.need_number("density_kg_m3", &limits::DENSITY),
            stiffness_pa_m3: node.need_number("stiffness_pa_m3", &limits::STIFFNESS),
        },
        "junction" => NodeEntryKind::Junction,
        _ => NodeEntryKind::Boundary,
    };
    let pressure_pa = node.need_number("pressure_pa", &limits::PRESSURE);
    let temperature_k = node.need_number("temperature_k", &limits::TEMPERATURE);
    let position = read_position(node);
    let contents = air::read_contents(node);
    Some(NodeEntry { id, kind, pressure_pa, temperature_k, position, contents })
}

/// Column and row of a node in drawings.
fn read_position(node: &mut Table<'_, '_>) -> Option<(u32, u32)> {
    let before = node.notes.count;
    let [column, row] = node.array("position")? else {
        node.refuse("position", "`position` is a pair of column and row, as in [2, 0]");
        return None;
    };
    let mut place = |value| number(node.notes, "position", value, &limits::POSITION).unwrap_or(0.0);
    let (column, row) = (place(column), place(row));
    if node.notes.count == before && (column.fract().abs() > 0.0 || row.fract().abs() > 0.0) {
        node.refuse("position", "`position` counts whole columns and rows");
    }
    Some((column as u32, row as u32))
}

fn read_line(line: &mut Table<'_, '_>) -> LineEntry {
    LineEntry {
        id: line.need_id("id"),
        from: line.need_text("from"),
        to: line.need_text("to"),
        laminar_below_pa: line.number("laminar_below_pa", &limits::PRESSURE),
        initial_flow_kg_s: line.number("initial_flow_kg_s", &limits::MASS_FLOW),
        reference_density_kg_m3: line.number("reference_density_kg_m3", &limits::DENSITY),
        density: line.word("density", &["fixed", "follows"]),
        elements: line.tables("element", 1..=limits::ELEMENTS, read_element),
    }
}

fn read_element(element: &mut Table<'_, '_>) -> Option<ElementEntry> {
    let id = element.need_id("id");
    let kinds: Vec<_> = element.notes.kinds.iter().filter(|kind| kind.place() == Place::Line).collect();
    let names: Vec<_> = kinds.iter().map(|kind| kind.name()).collect();
    let name = element.need_kind("kind", &names)?;
    let kind = **kinds.iter().find(|kind| kind.name() == name)?;
    Some(ElementEntry {
        id,
        kind: kind.name(),
        entry: read_entry(element, kind),
        length_m: element.number("length_m", &limits::LENGTH),
        diameter_m: element.number("diameter_m", &limits::DIAMETER),
        area_m2: element.number("area_m2", &limits::AREA),
        inertance_per_m: element.number("inertance_per_m", &limits::INERTANCE),
        outlet_volume_m3: element.number("outlet_volume_m3", &limits::OUTLET_VOLUME),
    })
}

/// The keys and start values that a component of this kind may have.
pub(crate) fn read_entry(table: &mut Table<'_, '_>, kind: &'static dyn FileKind) -> Entry {
    let mut keys = BTreeMap::new();
    for key in kind.keys().iter().copied().flatten() {
        let required = key.presence == Presence::Required;
        let value = match key.holds {
            KeyType::Number { unit, min, max } => {
                let range = Range { values: min..=max, unit };
                if required {
                    Some(Value::Number(table.need_number(key.name, &range)))
                } else {
                    table.number(key.name, &range).map(Value::Number)
                }
            }
            KeyType::Flag => table.flag(key.name).map(Value::Flag),
            KeyType::Choice(words) => {
                let word = table.word(key.name, words);
                if word.is_none() && !table.has(key.name) {
                    table.refuse(key.name, format!("`{}` is missing: one of {}", key.name, words.join(", ")));
                }
                word.map(Value::Text)
            }
            KeyType::Component => Some(Value::Text(table.need_text(key.name))),
        };
        keys.extend(value.map(|value| (key.name, value)));
    }
    Entry { kind, keys, starts: air::starts(table, kind.inputs()) }
}

fn read_schedule(schedule: &mut Table<'_, '_>) -> ScheduleEntry {
    let before = schedule.notes.count;
    let entry = ScheduleEntry {
        input: schedule.need_text("input"),
        interpolation: schedule.word("interpolation", &["linear", "hold"]),
        points: read_points(schedule),
    };
    if entry.points.is_empty() && schedule.notes.count == before {
        schedule.refuse("points", "a schedule needs `points`, as in [[0.0, 1.0], [10.0, 0.5]]");
    }
    entry
}

fn read_points(schedule: &mut Table<'_, '_>) -> Vec<(f64, f64)> {
    let Some(array) = schedule.array("points") else { return Vec::new() };
    if array.len() > limits::SCHEDULE_POINTS {
        schedule.refuse("points", format!("more than {} points", limits::SCHEDULE_POINTS));
        return Vec::new();
    }
    let mut points = Vec::with_capacity(array.len());
    for value in array {
        let pair = value.get_ref().as_array().map(AsRef::as_ref);
        if let Some([time, level]) = pair {
            // A time is kept in whole microseconds, so it need not fit single precision.
            let time = number(schedule.notes, "time", time, &limits::TIME);
            let level = number(schedule.notes, "value", level, &limits::ANY);
            points.push((time.unwrap_or(0.0), level.unwrap_or(0.0)));
        } else {
            let span: Span<usize> = value.span();
            schedule.notes.refuse(span, "a point is a pair of time [s] and value, as in [10.0, 0.5]");
        }
    }
    points
}
