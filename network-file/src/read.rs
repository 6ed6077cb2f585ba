//! From TOML text to the document: keys, types, ranges.

mod air;

use std::ops::Range as Span;

use eclss_core::climate::parts;
use toml::de::{DeTable, DeValue};

use crate::channel;
use crate::document::{
    Blockage, Curve, ElementEntry, ElementKind, LineEntry, Loss, Machine, NetworkFile, NodeEntry,
    NodeEntryKind, Passage, Regulator, Run, SCHEMA, ScheduleEntry, Seat,
};
use crate::limits;
use crate::notes::Notes;
use crate::number::number;
use crate::table::Table;

/// Kinds of node and of element, as written.
const NODE_KINDS: [&str; 5] = ["cabin", "liquid", "accumulator", "junction", "boundary"];
const ELEMENT_KINDS: [&str; 18] = [
    "pipe",
    "reference_pipe",
    "valve",
    "fan",
    "pump",
    "heat_exchanger",
    "bed",
    "condenser",
    "coolant_side",
    "interface_exchanger",
    "heater",
    "measured",
    "orifice",
    "leak",
    "check_valve",
    "relief_valve",
    "pressure_regulator",
    "hatch",
];

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
        sources: Vec::new(),
        crews: Vec::new(),
        removers: Vec::new(),
        walls: Vec::new(),
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
    let kind = element.need_kind("kind", &ELEMENT_KINDS)?;
    let kind = read_passage(element, &kind).unwrap_or_else(|| read_opening(element, &kind));
    Some(ElementEntry {
        id,
        kind,
        length_m: element.number("length_m", &limits::LENGTH),
        diameter_m: element.number("diameter_m", &limits::DIAMETER),
        area_m2: element.number("area_m2", &limits::AREA),
        inertance_per_m: element.number("inertance_per_m", &limits::INERTANCE),
        outlet_volume_m3: element.number("outlet_volume_m3", &limits::OUTLET_VOLUME),
    })
}

/// Ducts and machines; `None` for the kinds of [`read_opening`].
fn read_passage(element: &mut Table<'_, '_>, kind: &str) -> Option<ElementKind> {
    Some(match kind {
        "pipe" => ElementKind::Pipe { loss: read_loss(element), blockage: read_blockage(element) },
        "reference_pipe" => ElementKind::ReferencePipe {
            pressure_drop_pa: element.need_number("pressure_drop_pa", &limits::REFERENCE_DROP),
            mass_flow_kg_s: element.need_number("mass_flow_kg_s", &limits::REFERENCE_FLOW),
            exponent: element.need_number("exponent", &limits::FLOW_EXPONENT),
            density_kg_m3: element.number("density_kg_m3", &limits::DENSITY),
        },
        "valve" => ElementKind::Valve {
            open_resistance_pa_s2_kg2: element
                .need_number("open_resistance_pa_s2_kg2", &limits::SOME_RESISTANCE),
            exponent: element.need_number("exponent", &limits::VALVE_EXPONENT),
            seat: read_seat(element),
            opening: element.number("opening", &limits::FRACTION),
        },
        "fan" => ElementKind::Fan(read_machine(element)),
        "pump" => ElementKind::Pump(read_machine(element)),
        "heat_exchanger" => ElementKind::HeatExchanger {
            loss: read_loss(element),
            liquid_fraction: element.need_number("liquid_fraction", &limits::FRACTION),
            separator_efficiency: element.need_number("separator_efficiency", &limits::FRACTION),
        },
        "measured" => ElementKind::Measured {
            largest_flow_kg_s: element.need_number("largest_flow_kg_s", &limits::MEASURED_FLOW),
            slope_kg_s_pa: element.need_number("slope_kg_s_pa", &limits::MEASURED_SLOPE),
        },
        "condenser" => ElementKind::Condenser {
            loss: read_loss(element),
            blockage: read_blockage(element),
            coil: air::read_coil(element),
        },
        "coolant_side" => ElementKind::CoolantSide {
            loss: read_loss(element),
            blockage: read_blockage(element),
            condenser: element.need_text("condenser"),
        },
        "interface_exchanger" => ElementKind::InterfaceExchanger {
            loss: read_loss(element),
            blockage: read_blockage(element),
            plates: air::read_plates(element),
        },
        "heater" => {
            let (loss, blockage) = (read_loss(element), read_blockage(element));
            ElementKind::Heater { loss, blockage, starts: air::starts(element, &[parts::HEATER_INPUT]) }
        }
        "bed" => ElementKind::Bed {
            loss: read_loss(element),
            mass_fraction: element.need_number("mass_fraction", &limits::FRACTION),
            capture_efficiency: element.need_number("capture_efficiency", &limits::FRACTION),
        },
        _ => return None,
    })
}

/// Openings and valves that respond to pressure, and the hatch.
fn read_opening(element: &mut Table<'_, '_>, kind: &str) -> ElementKind {
    match kind {
        "orifice" => ElementKind::Orifice {
            discharge_coefficient: element.need_number("discharge_coefficient", &limits::DISCHARGE),
            opening: element.number("opening", &limits::FRACTION),
        },
        "leak" => ElementKind::Leak {
            leak_kg_d: element.need_number("leak_kg_d", &limits::LEAK),
            pressure_drop_pa: element.need_number("pressure_drop_pa", &limits::SOME_PRESSURE),
            inlet_pressure_pa: element.number("inlet_pressure_pa", &limits::SOME_PRESSURE),
            opening: element.number("opening", &limits::FRACTION),
        },
        "check_valve" => ElementKind::CheckValve {
            loss: read_loss(element),
            reverse_leak_kg_s: element.need_number("reverse_leak_kg_s", &limits::SEAT_LEAK),
            reverse_pressure_pa: element.need_number("reverse_pressure_pa", &limits::SOME_PRESSURE),
        },
        "relief_valve" => ElementKind::ReliefValve {
            crack_pa: element.need_number("crack_pa", &limits::SOME_PRESSURE),
            reseat_pa: element.need_number("reseat_pa", &limits::PRESSURE),
            passage: if element.has("discharge_coefficient") {
                let discharge_coefficient = element.need_number("discharge_coefficient", &limits::DISCHARGE);
                Passage::Discharge { discharge_coefficient }
            } else {
                Passage::Loss(read_loss(element))
            },
            seat: read_seat(element),
        },
        "pressure_regulator" => ElementKind::PressureRegulator(Regulator {
            discharge_coefficient: element.need_number("discharge_coefficient", &limits::DISCHARGE),
            set_point_pa: element.need_number("set_point_pa", &limits::SOME_PRESSURE),
            band_pa: element.need_number("band_pa", &limits::SOME_PRESSURE),
            lag_s: element.need_number("lag_s", &limits::LAG),
            seat: read_seat(element),
        }),
        _ => ElementKind::Hatch {
            loss: read_loss(element),
            seat: read_seat(element),
            opening: element.number("opening", &limits::FRACTION),
        },
    }
}

/// What the element lets through when closed.
fn read_seat(element: &mut Table<'_, '_>) -> Seat {
    let seat = Seat {
        leakage_opening: element.number("leakage_opening", &limits::LEAKAGE),
        seat_leak_kg_d: element.number("seat_leak_kg_d", &limits::SEAT_LEAK_A_DAY),
        seat_leak_pressure_pa: element.number("seat_leak_pressure_pa", &limits::SOME_PRESSURE),
    };
    if element.has("leakage_opening") && element.has("seat_leak_kg_d") {
        element.refuse(
            "seat_leak_kg_d",
            "give the leak of the seat once: as `seat_leak_kg_d`, or as `leakage_opening`",
        );
    }
    for (key, other) in
        [("seat_leak_kg_d", "seat_leak_pressure_pa"), ("seat_leak_pressure_pa", "seat_leak_kg_d")]
    {
        if element.has(key) && !element.has(other) {
            element.refuse(key, format!("`{key}` needs `{other}`: a leak at a pressure"));
        }
    }
    seat
}

/// Whether the element can be blocked, and how far it is.
fn read_blockage(element: &mut Table<'_, '_>) -> Blockage {
    let blockable = element.flag("blockable");
    let opening = element.number("opening", &limits::FRACTION);
    if opening.is_some() && blockable != Some(true) {
        element.refuse("opening", "an `opening` is for an element with `blockable = true`");
    }
    Blockage { blockable, opening }
}

fn read_loss(element: &mut Table<'_, '_>) -> Loss {
    let resistance = element.number("resistance_pa_s2_kg2", &limits::RESISTANCE);
    let coefficient = element.number("loss_coefficient", &limits::LOSS_COEFFICIENT);
    let given = (element.has("resistance_pa_s2_kg2"), element.has("loss_coefficient"));
    if given.0 == given.1 {
        element.refuse(
            "loss_coefficient",
            "give the loss once: as `resistance_pa_s2_kg2`, or as `loss_coefficient` with a diameter or area",
        );
    }
    match coefficient {
        Some(loss_coefficient) => Loss::Coefficient { loss_coefficient },
        None => Loss::Resistance { resistance_pa_s2_kg2: resistance.unwrap_or(1.0) },
    }
}

fn read_machine(element: &mut Table<'_, '_>) -> Machine {
    let curve = if element.has("h0_m") {
        Curve::Head {
            h0_m: element.need_number("h0_m", &limits::HEAD),
            h1_s_m2: element.number("h1_s_m2", &limits::HEAD_LINEAR),
            h2_s2_m5: element.need_number("h2_s2_m5", &limits::HEAD_QUADRATIC),
        }
    } else {
        Curve::Pressure {
            shutoff_pa: element.need_number("shutoff_pa", &limits::PRESSURE),
            linear_pa_s_kg: element.number("linear_pa_s_kg", &limits::LINEAR_FALL),
            quadratic_pa_s2_kg2: element.need_number("quadratic_pa_s2_kg2", &limits::SOME_RESISTANCE),
        }
    };
    Machine {
        curve,
        speed: element.number("speed", &limits::SPEED),
        power_w: element.number("power_w", &limits::POWER),
        efficiency: element.number("efficiency", &limits::EFFICIENCY),
    }
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
