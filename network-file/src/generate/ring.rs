//! A closed loop of cabins: one fan, one valve, pipes between.

use std::collections::BTreeMap;

use eclss_core::components::{Fan, Pipe, Valve};

use super::{MODULE_PA, SizeError, TEMPERATURE_K, element, id_of, kind, line};
use crate::document::air::{AirEntry, ContentsEntry};
use crate::document::{Entry, NetworkFile, NodeEntry, NodeEntryKind, Run, SCHEMA, ScheduleEntry};
use crate::limits;

/// Volume of every cabin [m³]: small, so that flows and pressures are stiff at any usual step.
const VOLUME_M3: f64 = 0.02;
/// Resistance of all pipes together [Pa·s²/kg²], whatever their number.
const PIPES: f64 = 4_000.0;
/// Fewest cabins: one ahead of the fan, one behind it.
pub(super) const FEWEST: usize = 2;

/// Gas in a generated loop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Gas {
    /// Flows and pressures only.
    Plain,
    /// Heat, moisture and composition, at a fixed density.
    Air,
    /// The same, with losses and heads that follow the density.
    Following,
}

/// Returns `nodes` cabins of 20 litres in a loop: the first line holds the fan, the middle one the valve, which closes to a
/// tenth within a second, the others a pipe each.
pub fn ring(nodes: usize, gas: Gas) -> Result<NetworkFile, SizeError> {
    if !(FEWEST..=limits::NODES.min(limits::LINES)).contains(&nodes) {
        return Err(SizeError { shape: "ring", nodes, fewest: FEWEST });
    }
    let valve = nodes / 2;
    let lines = (0..nodes).map(|index| {
        let entry = if index == 0 {
            Entry::new(kind::<Fan>(), &[("shutoff_pa", 500.0), ("quadratic_pa_s2_kg2", 2_000.0)])
        } else if index == valve {
            Entry::new(kind::<Valve>(), &[("open_resistance_pa_s2_kg2", 300.0), ("exponent", 3.0)])
        } else {
            Entry::new(kind::<Pipe>(), &[("resistance_pa_s2_kg2", PIPES / nodes as f64)])
        };
        let mut made = line(
            format!("line{index}"),
            (index, (index + 1) % nodes),
            vec![element(format!("element{index}"), entry, 1.0, 0.1)],
        );
        made.density = (gas == Gas::Following).then(|| "follows".into());
        made
    });
    let cabin = |node| NodeEntry {
        id: id_of(node),
        kind: NodeEntryKind::Cabin { volume_m3: VOLUME_M3 },
        pressure_pa: MODULE_PA,
        temperature_k: TEMPERATURE_K,
        position: None,
        contents: ContentsEntry::default(),
    };
    Ok(NetworkFile {
        schema: SCHEMA,
        name: format!("ring_{nodes}"),
        title: Some(format!("Closed loop of {nodes} cabins of 20 litres")),
        reference_pressure_pa: MODULE_PA,
        run: Run {
            method: "tr-bdf2".into(),
            step: "10ms".into(),
            until: "30s".into(),
            start: None,
            record: None,
        },
        air: (gas != Gas::Plain).then(AirEntry::default),
        parts: BTreeMap::new(),
        controls: Vec::new(),
        nodes: (0..nodes).map(cabin).collect(),
        lines: lines.collect(),
        schedules: vec![ScheduleEntry {
            input: format!("element{valve}.opening"),
            interpolation: None,
            points: vec![(0.0, 1.0), (10.0, 1.0), (11.0, 0.1)],
        }],
        process: None,
        channels: Vec::new(),
    })
}
