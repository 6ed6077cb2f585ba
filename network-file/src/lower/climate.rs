//! From the document's heat, moisture and composition to the core's climate.

mod control;

use std::collections::HashMap;

use eclss_core::climate::condenser::Condenser;
use eclss_core::climate::medium::{self, Medium, PARTS};
use eclss_core::climate::parts::HEATER_INPUT;
use eclss_core::climate::volume::MOST_K;
use eclss_core::climate::{Contents, Crew, Exchanger, Passage, Remover, Source, Station, Volume, Wall};
use eclss_core::element::{Fan, Pump};
use eclss_core::{InputSpec, Line, StdElement, moist};

use super::Tables;
use crate::document::air::{CoilEntry, ContentsEntry, PartEntry, PlatesEntry, Starts};
use crate::document::{ElementKind, LineEntry, Machine, NetworkFile, NodeEntry, NodeEntryKind};
use crate::input::Slot;
use crate::limits;
use crate::loaded::ClimateTables;
use crate::notes::Notes;

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
    lowering.stations();
    lowering.parts();
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
    for (index, line) in file.lines.iter().enumerate() {
        for (place, element) in line.elements.iter().enumerate() {
            let path = format!("line[{index}].element[{place}]");
            match &element.kind {
                ElementKind::Condenser { .. }
                | ElementKind::CoolantSide { .. }
                | ElementKind::InterfaceExchanger { .. }
                | ElementKind::Heater { .. } => {
                    refuse(path, &["kind"]);
                }
                ElementKind::Fan(machine) | ElementKind::Pump(machine)
                    if machine.power_w.is_some() || machine.efficiency.is_some() =>
                {
                    refuse(path, &["power_w", "efficiency"]);
                }
                _ => {}
            }
        }
    }
    for (key, count) in [
        ("source", file.sources.len()),
        ("crew", file.crews.len()),
        ("remover", file.removers.len()),
        ("wall", file.walls.len()),
        ("control", file.controls.len()),
    ] {
        if count > 0 {
            refuse(format!("{key}[0]"), &["id"]);
        }
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

    /// Heat and water on the way of lines. Condensers first, so that coolant sides find them.
    fn stations(&mut self) {
        let mut condensers: HashMap<&str, u32> = HashMap::new();
        let coolant: Vec<&str> = self
            .file
            .lines
            .iter()
            .flat_map(|line| &line.elements)
            .filter_map(|element| match &element.kind {
                ElementKind::CoolantSide { condenser, .. } => Some(condenser.as_str()),
                _ => None,
            })
            .collect();
        for (index, line) in self.file.lines.iter().enumerate() {
            for (place, element) in line.elements.iter().enumerate() {
                let plates;
                let coil = match &element.kind {
                    ElementKind::Condenser { coil, .. } => coil,
                    ElementKind::InterfaceExchanger { plates: entry, .. } => {
                        plates = coil_of(entry);
                        &plates
                    }
                    _ => continue,
                };
                let path = format!("line[{index}].element[{place}]");
                condensers.insert(&element.id, self.climate.exchangers.len() as u32);
                let own_coolant = !coolant.contains(&element.id.as_str());
                self.exchanger(&element.id, index, coil, own_coolant, &path);
            }
        }
        for (index, line) in self.file.lines.iter().enumerate() {
            let first = self.tables.lines[index].first_segment;
            for (place, element) in line.elements.iter().enumerate() {
                let path = format!("line[{index}].element[{place}]");
                let segment = first + place as u32;
                let passage = match &element.kind {
                    ElementKind::Condenser { .. } => Passage::Condenser(condensers[element.id.as_str()]),
                    ElementKind::InterfaceExchanger { .. } => {
                        Passage::LiquidSide(condensers[element.id.as_str()])
                    }
                    ElementKind::CoolantSide { condenser, .. } => {
                        let Some(&of) = condensers.get(condenser.as_str()) else {
                            let reason =
                                format!("there is no condenser or interface exchanger `{condenser}`");
                            self.notes.refuse_at(&path, &["condenser"], reason);
                            continue;
                        };
                        Passage::CoolantSide(of)
                    }
                    ElementKind::Heater { starts, .. } => Passage::Heater {
                        power_input: self.inputs(&element.id, &[HEATER_INPUT], starts, &path),
                    },
                    ElementKind::Fan(machine) | ElementKind::Pump(machine) => Passage::Machine {
                        power_w: self.power_w(line, segment, machine, &path),
                        speed_input: self.tables.segments[segment as usize].first_input,
                    },
                    _ => continue,
                };
                self.climate.stations.push(Station { segment, line: index as u32, passage });
            }
        }
    }

    /// Electric power of a machine at rated speed [W].
    fn power_w(&mut self, line: &LineEntry, segment: u32, machine: &Machine, path: &str) -> f32 {
        let node = |id: &str| self.file.nodes.iter().position(|node| node.id == id);
        let density = super::density(self.file, line, node(&line.from), node(&line.to));
        let curve = match &self.tables.segments[segment as usize].element {
            StdElement::Fan(Fan { curve }) | StdElement::Pump(Pump { curve }) => *curve,
            _ => return 0.0,
        };
        let power = super::power::electric_w(machine, &curve, density);
        power.unwrap_or_else(|(key, reason)| {
            self.notes.refuse_at(path, &[key], reason);
            0.0
        }) as f32
    }

    fn exchanger(&mut self, id: &str, line: usize, coil: &CoilEntry, own_coolant: bool, path: &str) {
        let of = |value: Option<f64>, default: f32| value.map_or(default, |value| value as f32);
        let standard = Condenser::CCAA;
        let condenser = Condenser {
            air_w_k: of(coil.air_w_k, standard.air_w_k),
            air_reference_kg_s: of(coil.air_reference_kg_s, standard.air_reference_kg_s),
            air_exponent: of(coil.air_exponent, standard.air_exponent),
            coolant_w_k: of(coil.coolant_w_k, standard.coolant_w_k),
            coolant_reference_kg_s: of(coil.coolant_reference_kg_s, standard.coolant_reference_kg_s),
            capacity_j_k: of(coil.capacity_j_k, standard.capacity_j_k),
            film_kg: of(coil.film_kg, standard.film_kg),
        };
        let Line { from, to, .. } = self.tables.lines[line];
        let start = self.file.nodes.get(from as usize).map_or(limits::REFERENCE_K, |node| node.temperature_k);
        if !own_coolant {
            for name in ["coolant_flow", "coolant_temperature"] {
                let input = format!("{id}.{name}");
                let reason = format!("`{id}` has a coolant side, so `{input}` does nothing");
                for (index, _) in
                    self.file.schedules.iter().enumerate().filter(|(_, other)| other.input == input)
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
                if coil.starts.contains_key(name) {
                    let reason = format!("`{id}` has a coolant side, so its `{name}` is not an input");
                    self.notes.refuse_at(path, &[name], reason);
                }
            }
        }
        let first_input = self.inputs(id, &Exchanger::INPUTS, &coil.starts, path);
        self.climate.exchangers.push(Exchanger {
            condenser,
            start_k: of(coil.temperature_k, start as f32),
            outlet_node: to,
            own_coolant,
            separator_kg: of(coil.separator_kg, limits::SEPARATOR_KG as f32),
            discharge_s: of(coil.discharge_s, limits::DISCHARGE_S as f32),
            slug_kg: of(coil.slug_kg, limits::SLUG_KG as f32),
            first_input,
        });
        self.climate.exchanger_names.push(id.to_owned());
    }

    fn parts(&mut self) {
        let file = self.file;
        let path = |kind: &str, index: usize| format!("{kind}[{index}]");
        for (index, PartEntry { id, node, starts, .. }) in file.sources.iter().enumerate() {
            let path = path("source", index);
            let (node, first_input) =
                (self.node(node, &path), self.inputs(id, &Source::INPUTS, starts, &path));
            self.climate.sources.push(Source { node, first_input });
        }
        for (index, PartEntry { id, node, starts, .. }) in file.crews.iter().enumerate() {
            let path = path("crew", index);
            let (node, first_input) = (self.node(node, &path), self.inputs(id, &Crew::INPUTS, starts, &path));
            self.climate.crews.push(Crew { node, first_input });
        }
        for (index, PartEntry { id, node, part, starts, .. }) in file.removers.iter().enumerate() {
            let path = path("remover", index);
            let (node, first_input) =
                (self.node(node, &path), self.inputs(id, &Remover::INPUTS, starts, &path));
            let part = part_of(part.as_deref().unwrap_or_default()).unwrap_or(0);
            self.climate.removers.push(Remover { node, part, first_input });
        }
        for (index, PartEntry { id, node, wall, starts, .. }) in file.walls.iter().enumerate() {
            let path = path("wall", index);
            let (node, first_input) = (self.node(node, &path), self.inputs(id, &Wall::INPUTS, starts, &path));
            let Some(wall) = wall else { continue };
            self.climate.walls.push(Wall {
                node,
                capacity_j_k: wall.capacity_j_k as f32,
                inner_w_k: wall.inner_w_k as f32,
                outer_w_k: wall.outer_w_k as f32,
                start_k: wall.temperature_k as f32,
                first_input,
            });
        }
        for (kind, part, node, contents) in self.nodes_of_parts() {
            let held =
                file.nodes.iter().any(|entry| entry.id == node && entry.kind == NodeEntryKind::Boundary);
            if held && kind != "wall" {
                let reason = format!("`{node}` is a boundary, which is held whatever a {kind} does there");
                self.notes.refuse_at(&format!("{kind}[{part}]"), &["node"], reason);
            }
            if contents != Contents::Air && kind != "wall" {
                let reason = format!("`{node}` holds coolant, a {kind} needs air");
                self.notes.refuse_at(&format!("{kind}[{part}]"), &["node"], reason);
            }
        }
    }

    /// Kind, index, node and its contents of every part.
    fn nodes_of_parts(&self) -> Vec<(&'static str, usize, String, Contents)> {
        let file = self.file;
        let lists = [
            ("source", &file.sources),
            ("crew", &file.crews),
            ("remover", &file.removers),
            ("wall", &file.walls),
        ];
        let contents = |id: &str| {
            let node = file.nodes.iter().position(|node| node.id == id)?;
            self.climate.volumes.get(node).map(|volume| volume.contents)
        };
        let part = |kind, (index, entry): (usize, &PartEntry)| {
            contents(&entry.node).map(|contents| (kind, index, entry.node.clone(), contents))
        };
        lists
            .into_iter()
            .flat_map(|(kind, list)| list.iter().enumerate().filter_map(move |entry| part(kind, entry)))
            .collect()
    }
}

/// Plates between two liquids as the coil that they are computed as: liquid in the place of the air.
fn coil_of(plates: &PlatesEntry) -> CoilEntry {
    CoilEntry {
        air_w_k: Some(plates.liquid_w_k),
        air_reference_kg_s: Some(plates.liquid_reference_kg_s),
        air_exponent: Some(limits::LIQUID_EXPONENT),
        coolant_w_k: Some(plates.coolant_w_k),
        coolant_reference_kg_s: Some(plates.coolant_reference_kg_s),
        capacity_j_k: plates.capacity_j_k,
        temperature_k: plates.temperature_k,
        starts: plates.starts.clone(),
        ..CoilEntry::default()
    }
}

/// Index of a part of air by its name.
fn part_of(name: &str) -> Option<u32> {
    medium::NAMES.iter().take(PARTS - 1).position(|part| *part == name).map(|part| part as u32)
}
