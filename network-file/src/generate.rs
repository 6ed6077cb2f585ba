//! Networks of any size, made up: chains, stars, trees and meshes; closed loops of small cabins; stations of equal modules.
//!
//! [`ring`] and [`modules`] have fixed figures, for measurements. In the other shapes:
//!
//! Every node is a module of 20–200 m³ but two: the first end of the shape is a supply held 200 Pa above the rest and
//! the last an exhaust held 200 Pa below it, so that there is a steady state with flow. Every edge is a line of duct
//! and valve; about one in four has a second line with a fan beside it, which makes the air go round. The valve in the
//! middle closes within one second. Figures are drawn from a seed: same shape, size and seed, same file, on every
//! machine. None of them stands for a real station.
//!
//! ```
//! use eclss_network_file::generate::{Shape, generate};
//!
//! let text = generate(Shape::Mesh, 100, 1)?.to_toml();
//! let loaded = eclss_network_file::parse(&text, "mesh.toml").expect("what is generated is accepted");
//! assert_eq!(loaded.nodes.len(), 100);
//! # Ok::<(), eclss_network_file::generate::SizeError>(())
//! ```

mod modules;
mod ring;

use std::collections::BTreeMap;
use std::fmt;

use eclss_core::Component;
use eclss_core::component::FileKind;
use eclss_core::components::{Fan, Pipe, Valve};

pub use self::modules::{StationError, modules};
pub use self::ring::{Gas, ring};

use crate::document::air::ContentsEntry;
use crate::document::{
    ElementEntry, Entry, LineEntry, NetworkFile, NodeEntry, NodeEntryKind, Run, SCHEMA, ScheduleEntry,
};
use crate::limits;

/// Pressure of all modules at the start [Pa].
const MODULE_PA: f64 = 101_325.0;
/// What supply and exhaust are held above and below it [Pa].
const DRIVE_PA: f64 = 200.0;
/// Temperature of everything [K].
const TEMPERATURE_K: f64 = 295.15;
/// Part of the edges that have a fan beside them.
const FANS: f64 = 0.25;
/// Smallest network: supply, module, exhaust.
const FEWEST: usize = 3;

/// How nodes hang together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// Each with the next.
    Chain,
    /// All with one hub.
    Star,
    /// Each with its parent, two children each.
    Tree,
    /// A rectangle, as square as can be, each with its neighbours in row and column.
    Mesh,
}

/// A number of nodes that no network file can hold in this shape.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SizeError {
    /// Name of the shape.
    pub shape: &'static str,
    /// Number of nodes that was refused.
    pub nodes: usize,
    /// Fewest nodes of the shape.
    pub fewest: usize,
}

impl Shape {
    /// All shapes.
    pub const ALL: [Self; 4] = [Self::Chain, Self::Star, Self::Tree, Self::Mesh];

    /// Returns the shape's name in commands and files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Chain => "chain",
            Self::Star => "star",
            Self::Tree => "tree",
            Self::Mesh => "mesh",
        }
    }

    /// Returns the shape of this name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|shape| shape.name() == name)
    }

    /// Pairs of nodes that are joined, the lower index first.
    fn edges(self, nodes: usize) -> Vec<(usize, usize)> {
        let width = (1..=nodes).find(|width| width * width >= nodes).unwrap_or(1);
        match self {
            Self::Chain => (1..nodes).map(|node| (node - 1, node)).collect(),
            // The hub is a module, so it is neither the first node nor the last.
            Self::Star => {
                (0..nodes).filter(|&node| node != 1).map(|node| (node.min(1), node.max(1))).collect()
            }
            Self::Tree => (1..nodes).map(|node| ((node - 1) / 2, node)).collect(),
            Self::Mesh => (0..nodes)
                .flat_map(|node| {
                    let right = ((node + 1) % width != 0).then_some((node, node + 1));
                    right.into_iter().chain([(node, node + width)])
                })
                .filter(|&(_, to)| to < nodes)
                .collect(),
        }
    }
}

impl fmt::Display for SizeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { shape, nodes, fewest } = self;
        write!(
            f,
            "no {shape} of {nodes} nodes: at least {fewest} nodes, at most {} nodes and {} lines",
            limits::NODES,
            limits::LINES
        )
    }
}

impl std::error::Error for SizeError {}

/// Returns a network of `nodes` nodes with figures drawn from `seed`.
pub fn generate(shape: Shape, nodes: usize, seed: u64) -> Result<NetworkFile, SizeError> {
    let refused = SizeError { shape: shape.name(), nodes, fewest: FEWEST };
    if !(FEWEST..=limits::NODES).contains(&nodes) {
        return Err(refused);
    }
    let edges = shape.edges(nodes);
    if edges.len() > limits::LINES {
        return Err(refused);
    }
    let mut figures = Figures(seed);
    let mut lines = Vec::new();
    let mut room = limits::LINES - edges.len();
    for (index, &edge) in edges.iter().enumerate() {
        lines.push(passive(index, edge, &mut figures));
        let between_modules = edge.0 != 0 && edge.1 != nodes - 1;
        if figures.unit() < FANS && room > 0 && between_modules {
            lines.push(driven(index, edge, &mut figures));
            room -= 1;
        }
    }
    let closing = format!("valve{}.opening", edges.len() / 2);
    Ok(NetworkFile {
        schema: SCHEMA,
        name: format!("{}_{nodes}", shape.name()),
        title: Some(format!("Generated {} of {nodes} nodes, seed {seed}", shape.name())),
        reference_pressure_pa: MODULE_PA,
        run: Run {
            method: "tr-bdf2".into(),
            step: "1ms".into(),
            until: "30s".into(),
            start: None,
            record: None,
        },
        air: None,
        parts: BTreeMap::new(),
        controls: Vec::new(),
        nodes: (0..nodes).map(|node| module(node, nodes, &mut figures)).collect(),
        lines,
        schedules: vec![ScheduleEntry {
            input: closing,
            interpolation: None,
            points: vec![(0.0, 1.0), (10.0, 1.0), (11.0, 0.02)],
        }],
        process: None,
        channels: Vec::new(),
    })
}

fn id_of(node: usize) -> String {
    format!("n{node}")
}

fn module(node: usize, nodes: usize, figures: &mut Figures) -> NodeEntry {
    let (kind, pressure_pa) = if node == 0 {
        (NodeEntryKind::Boundary, MODULE_PA + DRIVE_PA)
    } else if node == nodes - 1 {
        (NodeEntryKind::Boundary, MODULE_PA - DRIVE_PA)
    } else {
        (NodeEntryKind::Cabin { volume_m3: figures.between(20.0, 200.0) }, MODULE_PA)
    };
    let contents = ContentsEntry::default();
    NodeEntry { id: id_of(node), kind, pressure_pa, temperature_k: TEMPERATURE_K, position: None, contents }
}

/// Duct and valve.
fn passive(index: usize, (from, to): (usize, usize), figures: &mut Figures) -> LineEntry {
    let open = figures.between(50.0, 200.0);
    let valve = Entry::new(kind::<Valve>(), &[("open_resistance_pa_s2_kg2", open), ("exponent", 3.0)]);
    line(
        format!("line{index}"),
        (from, to),
        vec![duct(format!("duct{index}"), figures), element(format!("valve{index}"), valve, 0.3, 0.15)],
    )
}

/// Duct and fan, against the direction of the passive line so that the air goes round.
fn driven(index: usize, (from, to): (usize, usize), figures: &mut Figures) -> LineEntry {
    let (shutoff, fall) = (figures.between(100.0, 400.0), figures.between(5e3, 2e4));
    let fan = Entry::new(kind::<Fan>(), &[("shutoff_pa", shutoff), ("quadratic_pa_s2_kg2", fall)]);
    line(
        format!("fan_line{index}"),
        (to, from),
        vec![element(format!("fan{index}"), fan, 0.3, 0.15), duct(format!("fan_duct{index}"), figures)],
    )
}

fn line(id: String, (from, to): (usize, usize), elements: Vec<ElementEntry>) -> LineEntry {
    LineEntry {
        id,
        from: id_of(from),
        to: id_of(to),
        laminar_below_pa: Some(0.1),
        initial_flow_kg_s: None,
        reference_density_kg_m3: None,
        density: None,
        elements,
    }
}

fn duct(id: String, figures: &mut Figures) -> ElementEntry {
    let resistance = short(10f64.powi(3) * (1.0 + 30.0 * figures.unit() * figures.unit()));
    let pipe = Entry::new(kind::<Pipe>(), &[("resistance_pa_s2_kg2", resistance)]);
    element(id, pipe, figures.between(2.0, 8.0), 0.15)
}

fn kind<C: Component>() -> &'static dyn FileKind {
    <dyn FileKind>::of::<C>()
}

fn element(id: String, entry: Entry, length_m: f64, diameter_m: f64) -> ElementEntry {
    ElementEntry {
        id,
        kind: entry.kind.name(),
        entry,
        length_m: Some(length_m),
        diameter_m: Some(diameter_m),
        area_m2: None,
        inertance_per_m: None,
        outlet_volume_m3: None,
    }
}

/// Rounds to whole tenths, so that a file reads well.
fn short(number: f64) -> f64 {
    (10.0 * number).round() / 10.0
}

/// Draws figures (`SplitMix64`, Steele et al. 2014).
struct Figures(u64);

impl Figures {
    /// A number in [0, 1).
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((mixed ^ (mixed >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// A number in [`from`, `to`], rounded.
    fn between(&mut self, from: f64, to: f64) -> f64 {
        short(from + (to - from) * self.unit())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::steady::steady;

    #[test]
    fn every_shape_and_size_is_accepted_and_has_a_steady_state() {
        for shape in Shape::ALL {
            for nodes in [3, 4, 7, 100, 321] {
                for seed in [0, 1, 99] {
                    let text = generate(shape, nodes, seed).unwrap().to_toml();
                    let loaded = crate::parse(&text, "generated.toml").unwrap_or_else(|error| {
                        panic!("{} of {nodes}, seed {seed}: {error}", shape.name());
                    });
                    assert_eq!(loaded.nodes.len(), nodes);
                    let found = steady(&loaded.network(), &loaded.inputs);
                    let found = found.unwrap_or_else(|error| panic!("{}", error.text(&loaded.names)));
                    let most = found.flow_kg_s.iter().fold(0.0, |most: f64, flow| most.max(flow.abs()));
                    assert!(most > 1e-3, "{} of {nodes}, seed {seed}: {most} kg/s", shape.name());
                }
            }
        }
    }

    #[test]
    fn rings_are_accepted_and_their_air_goes_round() {
        for gas in [Gas::Plain, Gas::Air, Gas::Following] {
            for nodes in [2, 3, 6, 100] {
                let text = ring(nodes, gas).unwrap().to_toml();
                let loaded = crate::parse(&text, "ring.toml").unwrap_or_else(|error| panic!("{error}"));
                assert_eq!((loaded.nodes.len(), loaded.lines.len()), (nodes, nodes));
                let found = steady(&loaded.network(), &loaded.inputs);
                let found = found.unwrap_or_else(|error| panic!("{}", error.text(&loaded.names)));
                // 500 Pa against 2000 + 300 + (n − 2)/n·4000 Pa·s²/kg² at one density; where densities follow, they differ
                // by the loop's 500 Pa of 101 325.
                let within = if gas == Gas::Following { 1e-2 } else { 1e-5 };
                let resistance = 2_300.0 + 4_000.0 * (nodes as f64 - 2.0) / nodes as f64;
                let expected = (500.0 / resistance).sqrt();
                for flow in found.flow_kg_s {
                    assert!((flow / expected - 1.0).abs() < within, "{gas:?} {nodes}: {flow} for {expected}");
                }
            }
        }
        assert!(ring(1, Gas::Plain).is_err());
    }

    #[test]
    fn a_station_of_modules_is_accepted_and_each_module_has_all_of_the_file() {
        let text = include_str!("../../networks/thcs.toml");
        let module = crate::parse(text, "thcs.toml").unwrap();
        let station = crate::parse(&modules(text, 3, "cabin").unwrap(), "station.toml");
        let station = station.unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(station.nodes.len(), 3 * module.nodes.len());
        assert_eq!(station.lines.len(), 3 * module.lines.len() + 4);
        assert_eq!(station.segments.len(), 3 * module.segments.len() + 4);
        assert_eq!(modules(text, 3, "attic"), Err(StationError::NoSuchNode("attic".into())));
        assert_eq!(modules(text, 0, "cabin"), Err(StationError::Count(0)));
        assert!(matches!(modules("node = [", 1, "cabin"), Err(StationError::Text(_))));
    }

    #[test]
    fn a_seed_decides_every_figure() {
        for shape in Shape::ALL {
            assert_eq!(generate(shape, 30, 5), generate(shape, 30, 5));
            assert_ne!(generate(shape, 30, 5), generate(shape, 30, 6));
        }
    }

    #[test]
    fn shapes_have_their_edges() {
        assert_eq!(Shape::Chain.edges(4), [(0, 1), (1, 2), (2, 3)]);
        assert_eq!(Shape::Star.edges(4), [(0, 1), (1, 2), (1, 3)]);
        assert_eq!(Shape::Tree.edges(6), [(0, 1), (0, 2), (1, 3), (1, 4), (2, 5)]);
        assert_eq!(Shape::Mesh.edges(5), [(0, 1), (0, 3), (1, 2), (1, 4), (3, 4)]);
        assert_eq!(Shape::Mesh.edges(100).len(), 180);
    }

    #[test]
    fn what_no_file_can_hold_is_refused() {
        assert!(generate(Shape::Chain, 2, 0).is_err());
        assert!(generate(Shape::Chain, limits::NODES, 0).is_ok());
        assert!(generate(Shape::Star, limits::NODES + 1, 0).is_err());
        assert!(generate(Shape::Mesh, limits::NODES, 0).is_ok());
        let error = generate(Shape::Mesh, limits::NODES + 1, 0).unwrap_err();
        assert!(error.to_string().starts_with("no mesh of 16385 nodes"), "{error}");
    }
}
