//! From the document to the core's tables: references, densities, slots, and the core's own checks.

mod climate;

use std::collections::{HashMap, HashSet};

use eclss_core::component::LineFacts;
use eclss_core::signal::OutputSpec;
use eclss_core::{
    Active, Climate, Element, Fault, InputSpec, Line, Method, Network, Node, NodeKind, Operating, Plan,
    Responsive, Segment, air,
};

use crate::document::{LineEntry, NetworkFile, NodeEntryKind};
use crate::duration::duration_us;
use crate::element::Conversion;
use crate::flow_row::{self, Driven};
use crate::input::{self, Named, Slot};
use crate::limits;
use crate::loaded::{Loaded, Names, RunDefaults};
use crate::notes::Notes;
use crate::number::single;
use crate::plan::PlanTables;
use crate::process;
use crate::reason;
use crate::signal::{self, NamedSignal};
use crate::steady;
use crate::unrest::Places;

/// Converts a document; `None` with findings in the notes.
pub(crate) fn lower(file: NetworkFile, notes: &mut Notes) -> Option<Loaded> {
    let ids = Ids::collect(&file, notes);
    let nodes = nodes(&file, notes);
    let run = run_defaults(&file, notes);
    let mut tables = Tables::default();
    for (index, line) in file.lines.iter().enumerate() {
        tables.add_line(&file, line, &format!("line[{index}]"), &ids, notes);
    }
    let elements = tables.segments.len();
    if elements > limits::ELEMENTS {
        let most = limits::ELEMENTS;
        notes.refuse_at("line", &[], format!("{elements} elements in all lines, at most {most} are allowed"));
    }
    let climate = climate::climate(&file, &mut tables, notes);
    let driven = input::drive(&file, &tables.slots, notes);
    let names = Names {
        nodes: file.nodes.iter().map(|node| node.id.clone()).collect(),
        lines: file.lines.iter().map(|line| line.id.clone()).collect(),
        segments: tables.names,
        inputs: tables.slots.iter().map(|slot| slot.name.clone()).collect(),
        components: climate.names.clone(),
        controls: file.controls.iter().map(|control| control.id.clone()).collect(),
    };
    let ranges = tables.slots.iter().map(|slot| (slot.spec.min, slot.spec.max)).collect();
    let specs: Vec<_> = tables.slots.iter().map(|slot| slot.spec).collect();
    let input_specs = input_specs(&specs, &climate.climate());
    let network = Network {
        reference_pa: file.reference_pressure_pa as f32,
        nodes: &nodes,
        lines: &tables.lines,
        segments: &tables.segments,
        active: &tables.active,
        responsive: &tables.responsive,
        inputs: &driven.inputs,
        schedules: &driven.schedules,
        points: &driven.points,
        plan: Plan::EMPTY,
        climate: climate.climate(),
    };
    let all = signal::all(&network, &names, &input_specs);
    let process = process::lower(&file, &all, &specs, notes);
    let records = records(&file, all, notes);
    if !notes.findings.is_empty() {
        return None;
    }
    let mut loaded = Loaded {
        names,
        places: Places::default(),
        input_specs,
        ranges,
        climate,
        run,
        records,
        reference_pa: file.reference_pressure_pa as f32,
        plan: PlanTables::new(&nodes, &tables.lines, &tables.segments),
        nodes,
        lines: tables.lines,
        segments: tables.segments,
        active: tables.active,
        responsive: tables.responsive,
        inputs: driven.inputs,
        schedules: driven.schedules,
        points: driven.points,
        process,
        file,
    };
    core_checks(&loaded, notes);
    if notes.findings.is_empty() {
        process::check(&loaded, notes);
    }
    if notes.findings.is_empty() && loaded.file.run.start.as_deref() == Some("steady") {
        rest(&mut loaded, notes);
        if notes.findings.is_empty() {
            core_checks(&loaded, notes);
        }
    }
    notes.findings.is_empty().then_some(loaded)
}

/// Every id of the file; one name space, so that `fan.mass_flow` can mean one thing only.
struct Ids<'f> {
    nodes: HashMap<&'f str, usize>,
}

impl<'f> Ids<'f> {
    fn collect(file: &'f NetworkFile, notes: &mut Notes) -> Self {
        let mut seen: HashMap<&str, String> = HashMap::new();
        let mut see = |id: &'f str, path: String| {
            if let Some(first) = seen.get(id) {
                let at = notes.place(&path, &["id"]);
                let help = "ids are unique among nodes, lines, elements and everything else together";
                notes.refuse_with(at, format!("id `{id}` is taken already by {first}"), help);
            } else {
                seen.insert(id, path);
            }
        };
        for (index, node) in file.nodes.iter().enumerate() {
            see(&node.id, format!("node[{index}]"));
        }
        for (index, line) in file.lines.iter().enumerate() {
            see(&line.id, format!("line[{index}]"));
            for (place, element) in line.elements.iter().enumerate() {
                see(&element.id, format!("line[{index}].element[{place}]"));
            }
        }
        for (kind, parts) in &file.parts {
            for (index, part) in parts.iter().enumerate() {
                see(&part.id, format!("{kind}[{index}]"));
            }
        }
        for (index, control) in file.controls.iter().enumerate() {
            see(&control.id, format!("control[{index}]"));
        }
        Self { nodes: file.nodes.iter().enumerate().map(|(index, node)| (node.id.as_str(), index)).collect() }
    }
}

fn nodes(file: &NetworkFile, notes: &mut Notes) -> Vec<Node> {
    let reached: HashSet<&str> = file.lines.iter().flat_map(|line| [&*line.from, &*line.to]).collect();
    let mut nodes = Vec::with_capacity(file.nodes.len());
    let mut places = HashMap::new();
    for (index, entry) in file.nodes.iter().enumerate() {
        let path = format!("node[{index}]");
        if let Some(first) = entry.position.and_then(|place| places.insert(place, &entry.id)) {
            notes.refuse_at(&path, &["position"], format!("node `{first}` stands there already"));
        }
        // The difference is taken before rounding: in single precision 101 325 Pa is known to 8 mPa only.
        let gauge = single(entry.pressure_pa - file.reference_pressure_pa);
        if gauge.is_none() {
            notes.refuse_at(&path, &["pressure_pa"], "too close to `reference_pressure_pa` to tell apart");
        }
        let node = Node {
            kind: match entry.kind {
                NodeEntryKind::Cabin { volume_m3 } => NodeKind::Cabin { volume_m3: volume_m3 as f32 },
                NodeEntryKind::Liquid { volume_m3, density_kg_m3, bulk_modulus_pa } => {
                    NodeKind::Liquid { capacity_kg_pa: (volume_m3 * density_kg_m3 / bulk_modulus_pa) as f32 }
                }
                NodeEntryKind::Accumulator { density_kg_m3, stiffness_pa_m3, .. } => {
                    NodeKind::Liquid { capacity_kg_pa: (density_kg_m3 / stiffness_pa_m3) as f32 }
                }
                NodeEntryKind::Junction => NodeKind::Junction,
                NodeEntryKind::Boundary => NodeKind::Boundary,
            },
            start_gauge_pa: gauge.unwrap_or(0.0),
            temperature_k: entry.temperature_k as f32,
        };
        if let Err(error) = node.check() {
            notes.refuse_at(&path, reason::keys_of(error.parameter), reason::text(error));
        }
        if !reached.contains(entry.id.as_str()) {
            notes.refuse_at(&path, &["id"], format!("no line reaches node `{}`", entry.id));
        }
        nodes.push(node);
    }
    nodes
}

/// The core's tables while lines are added.
#[derive(Default)]
struct Tables {
    lines: Vec<Line>,
    segments: Vec<Segment>,
    active: Vec<Active>,
    responsive: Vec<Responsive>,
    memory_slots: usize,
    slots: Vec<Slot>,
    names: Vec<String>,
}

impl Tables {
    fn add_line(
        &mut self,
        file: &NetworkFile,
        line: &LineEntry,
        path: &str,
        ids: &Ids<'_>,
        notes: &mut Notes,
    ) {
        let from = node_of(ids, &line.from, path, "from", notes);
        let to = node_of(ids, &line.to, path, "to", notes);
        let density_kg_m3 = density(file, line, from, to);
        let high_side = high_side(file, from, to);
        let facts = LineFacts {
            density_kg_m3,
            area_m2: None,
            high_pa: high_side.0,
            high_k: high_side.1,
            from_k: from
                .and_then(|node| file.nodes.get(node))
                .map_or(limits::REFERENCE_K, |node| node.temperature_k),
            has_air: file.air.is_some(),
        };
        let first_segment = self.segments.len();
        for (place, entry) in line.elements.iter().enumerate() {
            let path = format!("{path}.element[{place}]");
            let last = place + 1 == line.elements.len();
            let (element, inertance_per_m, outlet_volume_m3) =
                Conversion { notes, entry, path: &path, line: facts, last }.convert();
            if let Err(error) = element.check() {
                notes.refuse_at(&path, reason::keys_of(error.parameter), reason::text(error));
            }
            let first_input = self.slots.len() as u32;
            let named = Named { id: &entry.id, entry: &entry.entry, path: &path };
            input::slots_of(&element, named, &mut self.slots, notes);
            self.segments.push(Segment { element, inertance_per_m, outlet_volume_m3, first_input });
            self.names.push(entry.id.clone());
        }
        let follows = line.density.as_deref() == Some("follows");
        if follows && density_kg_m3 <= 0.0 {
            let reason =
                "`density` follows none: give the line a `reference_density_kg_m3`, it starts in a vacuum";
            notes.refuse_at(path, &["density"], reason);
        }
        self.list(first_segment, if follows { density_kg_m3 as f32 } else { 0.0 });
        let segments = &self.segments[first_segment..];
        let start_flow_kg_s = line.initial_flow_kg_s.unwrap_or(0.0);
        let drop_pa = pressure(file, from) - pressure(file, to);
        if let Some(flow) = excessive_flow(segments, drop_pa, high_side) {
            let limit = Fault::FLOW_LIMIT_KG_S;
            let reason = format!("line `{}` would carry up to {flow:.0} kg/s, more than {limit}", line.id);
            notes.refuse_at(path, &["id"], reason);
        }
        self.lines.push(Line {
            from: from.unwrap_or(0) as u32,
            to: to.unwrap_or(0) as u32,
            first_segment: first_segment as u32,
            segments: segments.len() as u32,
            flow_segment: flow_row::choose(Driven { segments, drop_pa, start_flow_kg_s }) as u32,
            laminar_below_pa: line.laminar_below_pa.unwrap_or(limits::LAMINAR_BELOW_PA) as f32,
            start_flow_kg_s: start_flow_kg_s as f32,
        });
    }
}

impl Tables {
    /// Puts the line whose segments begin at `first_segment` into the list of responsive lines, or its segments into
    /// that of active ones.
    fn list(&mut self, first_segment: usize, reference_density_kg_m3: f32) {
        let line = self.lines.len() as u32;
        let segments = &self.segments[first_segment..];
        let responds = segments.iter().any(|segment| segment.element.responds());
        if responds || reference_density_kg_m3 > 0.0 {
            let first_memory = self.memory_slots as u32;
            self.responsive.push(Responsive { line, first_memory, reference_density_kg_m3 });
            self.memory_slots += segments.iter().map(|segment| segment.element.memory()).sum::<usize>();
            return;
        }
        let active =
            (first_segment as u32..).zip(segments).filter(|(_, segment)| segment.element.is_active());
        self.active.extend(active.map(|(segment, _)| Active { segment, line }));
    }
}

fn node_of(ids: &Ids<'_>, id: &str, path: &str, key: &str, notes: &mut Notes) -> Option<usize> {
    let node = ids.nodes.get(id).copied();
    if node.is_none() {
        notes.refuse_at(path, &[key], format!("there is no node `{id}`"));
    }
    node
}

/// Absolute pressure of a node at the start [Pa].
fn pressure(file: &NetworkFile, node: Option<usize>) -> f64 {
    node.and_then(|node| file.nodes.get(node)).map_or(0.0, |node| node.pressure_pa)
}

/// Pressure [Pa] and temperature [K] of the node of higher pressure at the start.
fn high_side(file: &NetworkFile, from: Option<usize>, to: Option<usize>) -> (f64, f64) {
    let side = |node: Option<usize>| {
        let node = node.and_then(|node| file.nodes.get(node));
        node.map_or((0.0, 1.0), |node| (node.pressure_pa, node.temperature_k))
    };
    let (from, to) = (side(from), side(to));
    if to.0 > from.0 { to } else { from }
}

/// Density for which the line's parameters hold [kg/m³].
///
/// A boundary of coolant has none of its own: there it is that of the liquid at the line's other end, or 0 for unknown.
fn density(file: &NetworkFile, line: &LineEntry, from: Option<usize>, to: Option<usize>) -> f64 {
    let liquid = |node: Option<usize>| match file.nodes.get(node?)?.kind {
        NodeEntryKind::Liquid { density_kg_m3, .. } | NodeEntryKind::Accumulator { density_kg_m3, .. } => {
            Some(density_kg_m3)
        }
        NodeEntryKind::Cabin { .. } | NodeEntryKind::Junction | NodeEntryKind::Boundary => None,
    };
    let gas = || {
        let node = file.nodes.get(from?)?;
        let coolant = node.contents.contents.as_deref() == Some("coolant");
        let density = node.pressure_pa / (f64::from(air::GAS_CONSTANT_J_KG_K) * node.temperature_k);
        Some(if coolant { 0.0 } else { density })
    };
    line.reference_density_kg_m3.or_else(|| liquid(from)).or_else(|| liquid(to)).or_else(gas).unwrap_or(1.0)
}

/// The steady flow with everything open and every machine at its highest speed [kg/s], if no run with it could
/// be trusted.
fn excessive_flow(segments: &[Segment], drop_pa: f64, (high_pa, temperature_k): (f64, f64)) -> Option<f64> {
    let (mut loss, mut drive) = (0.0, drop_pa.abs());
    for segment in segments {
        // Of a valve that acts by itself the input is its fault; sound it may be fully open.
        let widest = |spec: InputSpec| if spec.name == "fault" { spec.default } else { spec.max };
        let most = segment.element.input_spec(0).map_or(1.0, widest);
        let inlet_pa = high_pa as f32;
        let outlet_pa = (high_pa - drop_pa.abs()) as f32;
        let temperature_k = temperature_k as f32;
        let inputs = &[most];
        // A relief valve open, a regulator open.
        let at =
            Operating { inlet_pa, outlet_pa, temperature_k, memory: &[1.0], ..Operating::plain(inputs, 1.0) };
        let law = segment.element.law(&at);
        loss += f64::from(law.resistance) + f64::from(law.linear);
        drive += f64::from(law.head);
    }
    let flow = libm::sqrt(drive / loss);
    (loss > 0.0 && flow > f64::from(Fault::FLOW_LIMIT_KG_S)).then_some(flow)
}

fn run_defaults(file: &NetworkFile, notes: &mut Notes) -> RunDefaults {
    let run = &file.run;
    let method = Method::from_name(&run.method);
    if method.is_none() {
        let names: Vec<_> = Method::ALL.iter().map(|method| method.name()).collect();
        let span = notes.place("run", &["method"]);
        let help = format!("methods: {}", names.join(", "));
        notes.refuse_with(span, format!("there is no method `{}`", run.method), help);
    }
    let mut duration = |key: &str, text: &str| match duration_us(text) {
        Ok(0) => {
            notes.refuse_at("run", &[key], format!("`{key}` must be longer than nothing"));
            1
        }
        Ok(us) => us,
        Err(error) => {
            notes.refuse_at("run", &[key], format!("`{text}`: {error}"));
            1
        }
    };
    let step_us = duration("step", &run.step);
    let until_us = duration("until", &run.until);
    let step_us = u32::try_from(step_us).unwrap_or_else(|_| {
        notes.refuse_at("run", &["step"], "`step` is longer than an hour");
        1
    });
    RunDefaults { method: method.unwrap_or(Method::Relaxation), step_us, until_us }
}

/// Published descriptions of the input slots: as declared, except inputs of a control, which have the unit of its measurement.
fn input_specs(specs: &[InputSpec], climate: &Climate<'_>) -> Vec<OutputSpec> {
    let mut list: Vec<_> = specs.iter().map(OutputSpec::of_input).collect();
    for control in climate.loops {
        let display = climate.spec_of_signal(control.measures).display;
        for (spec, display) in
            list.iter_mut().skip(control.first_input as usize).zip([display, display.difference()])
        {
            spec.display = display;
        }
    }
    list
}

fn records(file: &NetworkFile, all: Vec<NamedSignal>, notes: &mut Notes) -> Vec<NamedSignal> {
    let Some(wanted) = &file.run.record else {
        return all.into_iter().filter(NamedSignal::is_standard).collect();
    };
    let known: HashMap<&str, &NamedSignal> =
        all.iter().map(|signal| (signal.name.as_str(), signal)).collect();
    let mut seen = HashSet::new();
    let mut list: Vec<NamedSignal> = Vec::with_capacity(wanted.len());
    for (index, name) in wanted.iter().enumerate() {
        let place = format!("run.record[{index}]");
        match known.get(name.as_str()) {
            Some(_) if !seen.insert(name) => {
                notes.refuse_at(&place, &[], format!("`{name}` is recorded twice"));
            }
            Some(&signal) => list.push(signal.clone()),
            None => {
                let span = notes.place(&place, &[]);
                let help = "signals are like `cabin.pressure`, `loop.mass_flow`, `fan.outlet_pressure`, `valve.opening`";
                notes.refuse_with(span, format!("there is no signal `{name}` to record"), help);
            }
        }
    }
    list
}

/// Starts the network in its steady state with the inputs of the start, so that nothing moves at first.
fn rest(loaded: &mut Loaded, notes: &mut Notes) {
    match steady::steady(&loaded.network(), &loaded.inputs) {
        Ok(rest) => {
            for (index, gauge_pa) in rest.gauge_pa.iter().enumerate() {
                move_start(loaded, index, *gauge_pa as f32);
            }
            for (line, flow_kg_s) in loaded.lines.iter_mut().zip(&rest.flow_kg_s) {
                line.start_flow_kg_s = *flow_kg_s as f32;
            }
        }
        Err(error) => notes.refuse_at("run", &["start"], error.text(&loaded.names)),
    }
}

/// Moves the start of a node to another pressure, at its temperature and with its composition: gas laws, or the springs
/// of coolant, give the mass that it then holds.
fn move_start(loaded: &mut Loaded, index: usize, gauge_pa: f32) {
    let Some(node) = loaded.nodes.get_mut(index) else { return };
    let file_gauge_pa = std::mem::replace(&mut node.start_gauge_pa, gauge_pa);
    let Some(volume) = loaded.climate.volumes.get_mut(index) else { return };
    let start_kg = f64::from(volume.start_kg);
    let moved_kg = match node.kind {
        NodeKind::Cabin { .. } => {
            let absolute = |gauge: f32| f64::from(loaded.reference_pa) + f64::from(gauge);
            start_kg * (absolute(gauge_pa) / absolute(file_gauge_pa))
        }
        NodeKind::Liquid { capacity_kg_pa } => {
            start_kg + f64::from(capacity_kg_pa) * (f64::from(gauge_pa) - f64::from(file_gauge_pa))
        }
        NodeKind::Junction | NodeKind::Boundary => start_kg,
    };
    volume.start_kg = moved_kg as f32;
}

/// The core has the last word: on the tables, and on method and step.
fn core_checks(loaded: &Loaded, notes: &mut Notes) {
    let network = loaded.network();
    if let Err(error) = network.check() {
        reason::network(loaded, error, notes);
    } else if let Err(error) = loaded.run.method.check(&network, loaded.run.step_us) {
        reason::method(loaded, error, notes);
    } else if let Err(error) = network.climate.check(&network, loaded.run.step_us) {
        reason::climate(loaded, error, notes);
    } else if let Some(nodes) = crate::steady::floating(&network) {
        reason::floating(loaded, &nodes, notes);
    }
}
