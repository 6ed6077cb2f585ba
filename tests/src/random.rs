//! Random networks, drawn once as the product's tables and once as the independent [`Model`].

use crate::dice::Dice;
use crate::laws;
use crate::model::{Branch, Model};
use crate::product::Tables;
use eclss_core::components::{Bed, Fan, HeadCurve, HeatExchanger, Pipe, Pump, ReferencePipe, Valve};
use eclss_core::{AnyComponent, Element, NodeKind};

/// Rg·T of the nodes [J/kg].
const GAS_J_KG: f64 = 287.05 * 295.15;

/// A network twice.
#[derive(Debug, Clone)]
pub struct Drawn {
    /// As the product sees it.
    pub tables: Tables,
    /// As the equations say.
    pub model: Model,
}

/// What may be drawn.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    /// Step that every node is large enough for [s].
    pub step_s: f64,
    /// Resistance of the flow element per resistance of all others, as powers of ten.
    pub dominance: (f64, f64),
    /// Only quadratic losses, and a laminar limit for some lines.
    pub quadratic: bool,
    /// Powers of ten of the elements' resistances.
    pub resistance: (f64, f64),
    /// Powers of ten of the lines' start flows [kg/s].
    pub start_flow: (f64, f64),
    /// Largest volume per smallest that the step allows, as a power of ten.
    pub volume_range: f64,
    /// Whether node 0 is held in every network, or only in half of them.
    pub held: bool,
}

impl Limits {
    /// Lines of cabin ventilation whose flow state sits on the stiffest element.
    pub const fn ventilation(step_s: f64) -> Self {
        Self {
            step_s,
            dominance: (0.0, 2.0),
            quadratic: false,
            resistance: (2.0, 4.5),
            start_flow: (-3.0, -1.0),
            volume_range: 3.0,
            held: false,
        }
    }
}

impl Drawn {
    /// Draws a network of two to six nodes in one piece.
    pub fn new(dice: &mut Dice, limits: &Limits) -> Self {
        let nodes = dice.whole(2, 6);
        let mut ends: Vec<(u32, u32)> = (1..nodes as u32)
            .map(|node| if dice.chance(0.5) { (node - 1, node) } else { (node, node - 1) })
            .collect();
        for _ in 0..dice.whole(0, nodes) {
            // Now and then the same node: a loop through a cabin.
            ends.push((dice.whole(0, nodes - 1) as u32, dice.whole(0, nodes - 1) as u32));
        }
        let mut drawn = Self { tables: Tables::default(), model: Model::default() };
        for node in 0..nodes as u32 {
            let volume = draw_volume(dice, &ends, node, limits);
            let gauge = dice.between(-200.0, 200.0) as f32;
            drawn.tables.node((node > 0 || (!limits.held && dice.chance(0.5))).then_some(volume), gauge);
        }
        for ends in ends {
            drawn.draw_line(dice, ends, limits);
        }
        for slot in 0..drawn.tables.inputs.len() {
            drawn.tables.inputs[slot] = dice.between(0.3, 1.0) as f32;
        }
        drawn.model.pressure_per_mass = drawn
            .tables
            .nodes
            .iter()
            .map(|node| match node.kind {
                NodeKind::Cabin { volume_m3 } => GAS_J_KG / f64::from(volume_m3),
                NodeKind::Liquid { capacity_kg_pa } => 1.0 / f64::from(capacity_kg_pa),
                NodeKind::Boundary | NodeKind::Junction => 0.0,
            })
            .collect();
        drawn.refresh();
        drawn
    }

    fn draw_line(&mut self, dice: &mut Dice, ends: (u32, u32), limits: &Limits) {
        let count = dice.whole(1, 6);
        let stiff = dice.whole(0, count - 1);
        let mut others = 0.0;
        let mut elements: Vec<AnyComponent> = (0..count)
            .map(|_| {
                let resistance = dice.power_of_ten(limits.resistance.0, limits.resistance.1);
                others += resistance;
                draw_element(dice, resistance as f32, limits.quadratic)
            })
            .collect();
        // Closed as far as an input may close it, the valve is the stiffest by far; open it still is.
        let resistance = others * dice.power_of_ten(limits.dominance.0, limits.dominance.1);
        elements[stiff] = if dice.chance(0.7) {
            Valve {
                open_resistance_pa_s2_kg2: resistance as f32,
                exponent: dice.between(0.5, 3.0) as f32,
                leakage_opening: 1e-3,
            }
            .into_any()
        } else {
            Pipe::new(resistance as f32).into_any()
        };
        // Where mass is taken out ahead of it, the resistance that a laminar limit follows from depends on the
        // direction of flow.
        let drained = elements[..stiff].iter().any(|element| element.removal() > 0.0);
        let laminar = limits.quadratic && !drained && dice.chance(0.5);
        let laminar = if laminar { dice.power_of_ten(-3.0, 1.0) } else { 0.0 };
        let sign = if dice.chance(0.5) { 1.0 } else { -1.0 };
        let flow = sign * dice.power_of_ten(limits.start_flow.0, limits.start_flow.1);
        self.tables.line(ends, &elements, stiff, laminar as f32, flow as f32);
        self.model.branches.push(Branch {
            from: ends.0 as usize,
            to: ends.1 as usize,
            parts: vec![],
            flow_part: stiff,
            laminar_below_pa: f64::from(laminar as f32),
        });
    }

    /// Takes the parts of the model anew from the elements and the present inputs.
    pub fn refresh(&mut self) {
        for (line, branch) in self.tables.lines.iter().zip(&mut self.model.branches) {
            let first = line.first_segment as usize;
            let segments = &self.tables.segments[first..first + line.segments as usize];
            let input = |slot: u32| self.tables.inputs.get(slot as usize).map_or(1.0, |&v| f64::from(v));
            branch.parts = segments
                .iter()
                .map(|segment| laws::part(&segment.element, input(segment.first_input)))
                .collect();
        }
    }

    /// Node pressures [Pa] and line flows [kg/s] at the start.
    pub fn start(&self) -> (Vec<f64>, Vec<f64>) {
        (
            self.tables.nodes.iter().map(|node| f64::from(node.start_gauge_pa)).collect(),
            self.tables.lines.iter().map(|line| f64::from(line.start_flow_kg_s)).collect(),
        )
    }
}

/// A volume that the method takes with this step [m³]: `h²·Σc ≤ 0.9`, and up to a given factor more.
fn draw_volume(dice: &mut Dice, ends: &[(u32, u32)], node: u32, limits: &Limits) -> f32 {
    let lines = ends.iter().filter(|(from, to)| *from == node || *to == node).count();
    let smallest = limits.step_s * limits.step_s * GAS_J_KG * lines as f64 / 0.9;
    (smallest * dice.power_of_ten(0.0, limits.volume_range)) as f32
}

/// An element that loses about as much as a pipe of `resistance` [Pa·s²/kg²] at 0.05 kg/s.
fn draw_element(dice: &mut Dice, resistance: f32, quadratic: bool) -> AnyComponent {
    let linear = if quadratic { 0.0 } else { 0.02 * resistance };
    let curve = HeadCurve {
        shutoff_pa: dice.between(20.0, 400.0) as f32,
        linear_pa_s_kg: linear,
        quadratic_pa_s2_kg2: 0.5 * resistance,
    };
    match dice.whole(0, if quadratic { 4 } else { 5 }) {
        0 => Fan::new(curve).into_any(),
        1 => Pump::new(curve).into_any(),
        2 => HeatExchanger {
            resistance_pa_s2_kg2: resistance,
            liquid_fraction: dice.between(0.0, 0.1) as f32,
            separator_efficiency: dice.between(0.5, 1.0) as f32,
        }
        .into_any(),
        3 => Bed {
            resistance_pa_s2_kg2: resistance,
            mass_fraction: dice.between(0.0, 0.2) as f32,
            capture_efficiency: dice.between(0.1, 0.9) as f32,
        }
        .into_any(),
        4 => Pipe::new(resistance).into_any(),
        _ => ReferencePipe {
            pressure_drop_pa: resistance * 0.0025,
            mass_flow_kg_s: 0.05,
            exponent: dice.between(1.0, 2.0) as f32,
        }
        .into_any(),
    }
}
