//! From the document's heat, moisture and composition to the core's climate.

mod control;

use eclss_core::climate::volume::MOST_K;
use eclss_core::climate::{Contents, Volume};
use eclss_core::component::{FileKind, LineFacts, Passage, Placed, Table};
use eclss_core::fluid::medium::{self, Medium};
use eclss_core::parameter::{Carries, KeyType, Place};
use eclss_core::{AnyComponent, Element as _, InputSpec, moist};

use super::Tables;
use crate::document::air::{ContentsEntry, Starts};
use crate::document::{ElementEntry, NetworkFile, NodeEntry, NodeEntryKind};
use crate::element::Keys;
use crate::input::{self, Named, Slot};
use crate::limits;
use crate::loaded::ClimateTables;
use crate::notes::Notes;
use crate::reason;

/// Where water freezes [K].
const ICE_K: f64 = 273.15;

/// Share of oxygen in dry air by volume.
const OXYGEN_SHARE: f64 = 0.2095;

/// Converts everything beside the flows. Adds the inputs of all parts to `tables`.
pub(super) fn climate(file: &NetworkFile, tables: &mut Tables, notes: &mut Notes) -> ClimateTables {
    let mut climate = ClimateTables::default();
    let Some(air) = &file.air else {
        refuse_without_air(file, notes);
        return climate;
    };
    climate.reference_k = air.reference_temperature_k.unwrap_or(limits::REFERENCE_K) as f32;
    climate.air = Medium::air(climate.reference_k);
    let heat = air.coolant_heat_j_kg_k.map_or(moist::LIQUID_HEAT_J_KG_K, |heat| heat as f32);
    let expansion_1_k = air.coolant_expansion_1_k.unwrap_or(0.0) as f32;
    climate.coolant = Medium { expansion_1_k, ..Medium::coolant(heat) };
    for (index, node) in file.nodes.iter().enumerate() {
        let liquid = matches!(node.kind, NodeEntryKind::Liquid { .. } | NodeEntryKind::Accumulator { .. });
        if liquid && air.coolant_heat_j_kg_k.is_none() && node.temperature_k < ICE_K {
            let span = notes.place(&format!("node[{index}]"), &["temperature_k"]);
            let help = "a coolant that is not water has its `coolant_heat_j_kg_k` in [air]";
            notes.refuse_with(span, "the coolant is water, which freezes below 273.15 K", help);
        }
        climate.volumes.push(volume(node, &format!("node[{index}]"), notes));
    }
    let mut lowering = Lowering { file, tables, notes, climate: &mut climate };
    lowering.components();
    lowering.controls();
    climate
}

/// Names what needs `[air]` in a file without it.
fn refuse_without_air(file: &NetworkFile, notes: &mut Notes) {
    let mut refuse = |path: String, keys: &[&str]| {
        let span = notes.place(&path, keys);
        notes.refuse_with(span, "this needs heat and moisture", "add a table `[air]`");
    };
    for (index, node) in file.nodes.iter().enumerate() {
        let liquid = matches!(node.kind, NodeEntryKind::Liquid { .. } | NodeEntryKind::Accumulator { .. });
        if liquid || node.contents != ContentsEntry::default() {
            refuse(format!("node[{index}]"), &["oxygen_pa", "carbon_dioxide_pa", "dew_point_k", "kind"]);
        }
    }
    for kind in file.parts.keys() {
        refuse(format!("{kind}[0]"), &["id"]);
    }
    if !file.controls.is_empty() {
        refuse("control[0]".into(), &["id"]);
    }
}

/// What a node holds at the start.
fn volume(node: &NodeEntry, path: &str, notes: &mut Notes) -> Volume {
    let entry = &node.contents;
    let coolant = match node.kind {
        NodeEntryKind::Liquid { .. } | NodeEntryKind::Accumulator { .. } => true,
        NodeEntryKind::Boundary => entry.contents.as_deref() == Some("coolant"),
        NodeEntryKind::Cabin { .. } | NodeEntryKind::Junction => false,
    };
    if let NodeEntryKind::Cabin { .. } | NodeEntryKind::Junction = node.kind
        && entry.contents.as_deref() == Some("coolant")
    {
        notes.refuse_at(path, &["contents"], "a volume of coolant is of kind `liquid` or `accumulator`");
    }
    let mut masses = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    if !coolant {
        // A fixed f64 form of the same formula as the core's, so that a file gives the same bits everywhere.
        let vapour = entry.dew_point_k.map_or(0.0, saturation_pa);
        let [carbon_dioxide, trace] =
            [entry.carbon_dioxide_pa, entry.trace_pa].map(|part| part.unwrap_or(0.0));
        if entry.dew_point_k.is_some_and(|dew_point| dew_point > node.temperature_k) {
            notes.refuse_at(path, &["dew_point_k"], "the dew point lies above `temperature_k`");
        }
        let dry = node.pressure_pa - vapour - carbon_dioxide - trace;
        let oxygen = entry.oxygen_pa.unwrap_or(OXYGEN_SHARE * dry);
        let nitrogen = dry - oxygen;
        if nitrogen < 0.0 || oxygen < 0.0 {
            let keys = ["oxygen_pa", "carbon_dioxide_pa", "dew_point_k", "trace_pa", "pressure_pa"];
            notes.refuse_at(path, &keys, "partial pressures sum to more than `pressure_pa`");
        }
        let pressures = [nitrogen, oxygen, carbon_dioxide, vapour, trace];
        for ((mass, pressure), gas) in masses.iter_mut().zip(pressures).zip(medium::GAS_CONSTANTS_J_KG_K) {
            *mass = pressure.max(0.0) / f64::from(gas);
        }
    }
    let sum: f64 = masses.iter().sum();
    // A vacuum has no composition of its own; nothing flows out of it.
    let fractions =
        if sum > 0.0 { masses.map(|mass| (mass / sum) as f32) } else { [1.0, 0.0, 0.0, 0.0, 0.0, 0.0] };
    let start_kg = match node.kind {
        NodeEntryKind::Cabin { volume_m3 } => {
            if node.pressure_pa <= 0.0 {
                notes.refuse_at(path, &["pressure_pa"], "a volume of air must hold some at the start");
            }
            (sum * volume_m3 / node.temperature_k).max(f64::MIN_POSITIVE)
        }
        NodeEntryKind::Liquid { volume_m3, density_kg_m3, .. }
        | NodeEntryKind::Accumulator { volume_m3, density_kg_m3, .. } => volume_m3 * density_kg_m3,
        NodeEntryKind::Junction | NodeEntryKind::Boundary => 1.0,
    };
    if node.kind == NodeEntryKind::Junction {
        notes.refuse_at(path, &["kind"], "with `[air]` a node needs a volume: there is none in a junction");
    }
    if !(200.0..=MOST_K).contains(&(node.temperature_k as f32)) {
        notes.refuse_at(path, &["temperature_k"], "with `[air]` temperatures start in 200 … 395.15 K");
    }
    Volume {
        contents: if coolant { Contents::Coolant } else { Contents::Air },
        start_kg: start_kg as f32,
        fractions,
        mixing_limit_s: entry.mixing_limit_s.unwrap_or(limits::MIXING_LIMIT_S) as f32,
        surface_kg_s_pa: entry.surface_kg_s_pa.unwrap_or(limits::SURFACE_KG_S_PA) as f32,
    }
}

/// Saturation pressure by the formula of [`moist::saturation_pressure_pa`] in double precision.
fn saturation_pa(temperature_k: f64) -> f64 {
    let t = temperature_k - 273.15;
    611.21 * libm::exp((18.678 - t / 234.5) * (t / (257.14 + t)))
}

/// Everything that the conversion of one file shares.
struct Lowering<'l, 'f> {
    file: &'f NetworkFile,
    tables: &'l mut Tables,
    notes: &'l mut Notes,
    climate: &'l mut ClimateTables,
}

impl Lowering<'_, '_> {
    /// Adds the inputs of one part and returns the first slot.
    fn inputs(&mut self, id: &str, specs: &[InputSpec], starts: &Starts, path: &str) -> u32 {
        let first = self.tables.slots.len() as u32;
        for spec in specs {
            let start = starts.get(spec.name).copied();
            self.tables.slots.push(Slot::new(id, *spec, start, path));
        }
        first
    }

    fn node(&mut self, id: &str, path: &str) -> u32 {
        let node = self.file.nodes.iter().position(|node| node.id == id);
        if node.is_none() {
            self.notes.refuse_at(path, &["node"], format!("there is no node `{id}`"));
        }
        node.unwrap_or(0) as u32
    }

    /// Places every component that acts on a volume or meets streams, kind by kind, and the passages of streams.
    fn components(&mut self) {
        let mut found = Vec::new();
        self.line_components(&mut found);
        self.node_components(&mut found);
        let kinds = self.notes.kinds;
        let place = |kind: &str| kinds.iter().position(|known| known.name() == kind);
        found.sort_by_key(|found| place(found.component.kind()));
        for own in found.chunk_by(|a, b| a.component.kind() == b.component.kind()) {
            let table = Table::behind(self.climate.tables.last(), &own[0].component, own.len() as u32);
            self.climate.tables.push(table);
        }
        for Found { component, placed, id, path, .. } in &found {
            self.climate.components.push(Placed { row: component.row(), ..*placed });
            self.climate.names.push(id.clone());
            self.climate.paths.push(path.clone());
        }
        self.passages(&found);
    }

    /// Components of lines that meet streams.
    fn line_components(&mut self, found: &mut Vec<Found>) {
        let file = self.file;
        let mut segment = 0;
        for (index, line) in file.lines.iter().enumerate() {
            for (place, element) in line.elements.iter().enumerate() {
                let (id, path) = (element.id.clone(), format!("line[{index}].element[{place}]"));
                let own = &self.tables.segments[segment];
                if !element.entry.kind.sides().is_empty() {
                    let linked = linking(file, &id).count() > 0;
                    let node = self.tables.lines[index].to;
                    let placed =
                        Placed { row: own.element.row(), node, first_input: own.first_input, linked };
                    found.push(Found { component: own.element, placed, id, path, segment: Some(segment) });
                    if linked {
                        self.refuse_idle(element, &found[found.len() - 1].path.clone());
                    }
                }
                segment += 1;
            }
        }
    }

    /// Refuses what drives an input that does nothing, because the line of a coolant passes the component.
    fn refuse_idle(&mut self, element: &ElementEntry, path: &str) {
        let id = &element.id;
        for name in element.entry.kind.idle_when_linked() {
            let input = format!("{id}.{name}");
            let reason = format!("`{id}` has a coolant side, so `{input}` does nothing");
            for (index, _) in self.file.schedules.iter().enumerate().filter(|(_, other)| other.input == input)
            {
                self.notes.refuse_at(&format!("schedule[{index}]"), &["input"], reason.clone());
            }
            for (index, control) in self.file.controls.iter().enumerate() {
                for (key, driven) in
                    [("drives", Some(&control.drives)), ("opposite", control.opposite.as_ref())]
                {
                    if driven == Some(&input) {
                        self.notes.refuse_at(&format!("control[{index}]"), &[key], reason.clone());
                    }
                }
            }
            if element.entry.starts.contains_key(name) {
                let reason = format!("`{id}` has a coolant side, so its `{name}` is not an input");
                self.notes.refuse_at(path, &[name], reason);
            }
        }
    }

    /// Components at nodes.
    fn node_components(&mut self, found: &mut Vec<Found>) {
        let file = self.file;
        let line = LineFacts {
            density_kg_m3: 0.0,
            area_m2: None,
            high_pa: 0.0,
            high_k: limits::REFERENCE_K,
            from_k: limits::REFERENCE_K,
            has_air: true,
        };
        let kinds = self.notes.kinds;
        for kind in kinds {
            for (index, part) in file.parts.get(kind.name()).into_iter().flatten().enumerate() {
                let path = format!("{}[{index}]", kind.name());
                let node = self.node(&part.node, &path);
                self.check_place(*kind, node, &part.node, &path);
                let mut keys = Keys { notes: self.notes, entry: &part.entry, path: &path };
                let component = kind.read(&mut keys, line);
                if let Err(error) = component.check() {
                    self.notes.refuse_at(&path, reason::keys_of(error.parameter), reason::text(error));
                }
                let first_input = self.tables.slots.len() as u32;
                let named = Named { id: &part.id, entry: &part.entry, path: &path };
                input::slots_of(&component, named, &mut self.tables.slots, self.notes);
                let placed = Placed { row: component.row(), node, first_input, linked: false };
                found.push(Found { component, placed, id: part.id.clone(), path, segment: None });
            }
        }
    }

    /// Refuses a node that does not suit components of this kind.
    fn check_place(&mut self, kind: &dyn FileKind, node: u32, id: &str, path: &str) {
        let Place::Node { holds, boundary } = kind.place() else { return };
        let (Some(entry), Some(volume)) =
            (self.file.nodes.get(node as usize), self.climate.volumes.get(node as usize))
        else {
            return;
        };
        let name = kind.name();
        if entry.kind == NodeEntryKind::Boundary && !boundary {
            let reason = format!("`{id}` is a boundary, which is held whatever a {name} does there");
            self.notes.refuse_at(path, &["node"], reason);
        }
        let (holds_air, needed) = (volume.contents == Contents::Air, holds);
        let reason = match needed {
            Carries::Air if !holds_air => format!("`{id}` holds coolant, a {name} needs air"),
            Carries::Coolant if holds_air => format!("`{id}` holds air, a {name} needs coolant"),
            Carries::Any | Carries::Air | Carries::Coolant => return,
        };
        self.notes.refuse_at(path, &["node"], reason);
    }

    /// Passages of streams: through components with sides, and of components that name another through its second side.
    fn passages(&mut self, found: &[Found]) {
        let file = self.file;
        let elements = file.lines.iter().enumerate().flat_map(|(line, entry)| {
            entry.elements.iter().enumerate().map(move |(place, element)| (line, place, element))
        });
        for (segment, (line, place, element)) in elements.enumerate() {
            let own = found.iter().position(|found| found.segment == Some(segment));
            let other = links(element).next();
            let (component, side) = match (own, other) {
                (Some(own), _) => (own, 0),
                (None, Some((key, id))) => {
                    let both = |found: &Found| found.id == id && found.component.erased().sides().len() > 1;
                    let Some(component) = found.iter().position(both) else {
                        let path = format!("line[{line}].element[{place}]");
                        let two_sided = self.notes.kinds.iter().filter(|kind| kind.sides().len() > 1);
                        let names: Vec<_> = two_sided.map(|kind| kind.name().replace('_', " ")).collect();
                        let reason = format!("there is no {} `{id}`", names.join(" or "));
                        self.notes.refuse_at(&path, &[key], reason);
                        continue;
                    };
                    (component, 1)
                }
                (None, None) => continue,
            };
            let component = component as u32;
            let table = self.climate.tables.iter().position(|table| {
                (table.range.first..table.range.first + table.range.count).contains(&component)
            });
            let (segment, line, table) = (segment as u32, line as u32, table.unwrap_or(0) as u32);
            self.climate.passages.push(Passage { segment, line, table, component, side });
        }
    }
}

/// A placed component before its place among all is known.
struct Found {
    component: AnyComponent,
    placed: Placed,
    id: String,
    /// Path of its table.
    path: String,
    /// Its segment, of a component of a line.
    segment: Option<usize>,
}

/// Keys of an element that name another component, with the ids.
fn links(element: &ElementEntry) -> impl Iterator<Item = (&'static str, &str)> {
    let keys = element.entry.kind.keys().iter().copied().flatten();
    let names = keys.filter(|key| key.holds == KeyType::Component);
    names.filter_map(|key| Some((key.name, element.entry.text(key.name)?)))
}

/// Elements whose streams pass the second side of component `id`.
fn linking<'f>(file: &'f NetworkFile, id: &'f str) -> impl Iterator<Item = &'f ElementEntry> {
    let elements = file.lines.iter().flat_map(|line| &line.elements);
    elements.filter(move |element| links(element).any(|(_, named)| named == id))
}
