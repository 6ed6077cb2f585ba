//! Networks whose steady state is known in closed form, and networks that have none.

use eclss_core::element::{Fan, HeadCurve, HeatExchanger, Law, Operating, ParameterError, Pipe, Valve};
use eclss_core::{
    Active, Element, Fingerprint, InputSpec, Line, Network, NetworkError, Node, NodeKind, Plan, Segment,
    StdElement, example,
};

use super::*;

#[derive(Default)]
struct Tables {
    nodes: Vec<Node>,
    lines: Vec<Line>,
    segments: Vec<Segment>,
    active: Vec<Active>,
    inputs: Vec<f32>,
}

impl Tables {
    fn node(&mut self, kind: NodeKind, start_gauge_pa: f32) -> u32 {
        self.nodes.push(Node { kind, start_gauge_pa, temperature_k: 295.15 });
        self.nodes.len() as u32 - 1
    }

    fn line(&mut self, from: u32, to: u32, elements: &[StdElement]) {
        let line = self.lines.len() as u32;
        let first_segment = self.segments.len() as u32;
        for element in elements {
            let segment = self.segments.len() as u32;
            if element.is_active() {
                self.active.push(Active { segment, line });
            }
            let first_input = self.inputs.len() as u32;
            self.inputs.extend((0..).map_while(|index| element.input_spec(index)).map(|spec| spec.default));
            self.segments.push(Segment {
                element: *element,
                inertance_per_m: 0.0,
                outlet_volume_m3: 0.0,
                first_input,
            });
        }
        self.lines.push(Line {
            from,
            to,
            first_segment,
            segments: elements.len() as u32,
            flow_segment: 0,
            laminar_below_pa: 0.0,
            start_flow_kg_s: 0.0,
        });
    }

    fn network(&self) -> Network<'_> {
        Network {
            nodes: &self.nodes,
            lines: &self.lines,
            segments: &self.segments,
            active: &self.active,
            inputs: &self.inputs,
            plan: Plan::EMPTY,
            ..example::paper_loop()
        }
    }

    fn steady(&self) -> Result<Steady, SteadyError> {
        steady(&self.network(), &self.inputs)
    }
}

const CABIN: NodeKind = NodeKind::Cabin { volume_m3: 10.0 };

fn pipe(resistance_pa_s2_kg2: f32) -> StdElement {
    StdElement::Pipe(Pipe { resistance_pa_s2_kg2 })
}

fn fan(shutoff_pa: f32) -> StdElement {
    let curve = HeadCurve { shutoff_pa, linear_pa_s_kg: 0.0, quadratic_pa_s2_kg2: 1e3 };
    StdElement::Fan(Fan { curve })
}

fn near(found: f64, exact: f64) {
    assert!((found - exact).abs() <= 1e-9 * exact.abs().max(1e-3), "{found} against {exact}");
}

#[test]
fn the_papers_loop_flows_steadily_while_its_cabin_loses_condensate() {
    let network = example::paper_loop();
    let found = steady_flows(&network, network.inputs).unwrap();
    assert!((found.flow_kg_s[0] - 0.086_477_6).abs() < 1e-7, "{found:?}");
    let capacity = 60.0 / (f64::from(eclss_core::air::GAS_CONSTANT_J_KG_K) * f64::from(295.15f32));
    let drained = f64::from(0.0045f32) * found.flow_kg_s[0];
    near(found.rate_pa_s[0], -drained / capacity);
    let refused = steady(&network, network.inputs).unwrap_err();
    let names = crate::Names {
        nodes: vec!["cabin".to_owned()],
        lines: vec!["loop".to_owned()],
        ..crate::Names::default()
    };
    let text = refused.text(&names);
    assert!(
        text.contains("`cabin`") && text.contains("`loop`") && text.contains("no steady state"),
        "{text}"
    );
}

#[test]
fn parallel_branches_share_the_flow_by_their_roots() {
    let mut tables = Tables::default();
    let (high, low) = (tables.node(NodeKind::Boundary, 100.0), tables.node(NodeKind::Boundary, 0.0));
    let (left, right) = (tables.node(NodeKind::Junction, 0.0), tables.node(CABIN, 7.0));
    tables.line(high, left, &[pipe(300.0)]);
    tables.line(left, right, &[pipe(400.0)]);
    tables.line(right, left, &[pipe(1600.0)]);
    tables.line(right, low, &[pipe(500.0)]);
    let found = tables.steady().unwrap();
    let parallel = (1.0f64 / 20.0 + 1.0 / 40.0).powi(-2);
    let flow = (100.0 / (300.0 + parallel + 500.0)).sqrt();
    for (found, exact) in found.flow_kg_s.iter().zip([flow, flow / 1.5, -flow / 3.0, flow]) {
        near(*found, exact);
    }
    near(found.gauge_pa[2], 100.0 - 300.0 * flow * flow);
    near(found.gauge_pa[3], 500.0 * flow * flow);
}

#[test]
fn a_balanced_bridge_carries_nothing() {
    let mut tables = Tables::default();
    let (high, low) = (tables.node(NodeKind::Boundary, 50.0), tables.node(NodeKind::Boundary, -50.0));
    let (left, right) = (tables.node(CABIN, 3.0), tables.node(CABIN, -30.0));
    tables.line(high, left, &[pipe(100.0)]);
    tables.line(high, right, &[pipe(300.0)]);
    tables.line(left, low, &[pipe(200.0)]);
    tables.line(right, low, &[pipe(600.0)]);
    tables.line(left, right, &[pipe(1.0)]);
    let found = tables.steady().unwrap();
    assert!(found.flow_kg_s[4].abs() < 1e-7, "{found:?}");
    near(found.flow_kg_s[0], (100.0f64 / 300.0).sqrt());
}

#[test]
fn without_boundary_the_level_follows_from_the_mass() {
    let mut tables = Tables::default();
    let small = tables.node(NodeKind::Cabin { volume_m3: 2.0 }, 90.0);
    let large = tables.node(NodeKind::Cabin { volume_m3: 6.0 }, -10.0);
    tables.line(small, large, &[fan(40.0), pipe(3e3)]);
    tables.line(large, small, &[pipe(4e3)]);
    let found = tables.steady().unwrap();
    near(found.flow_kg_s[0], (40.0f64 / 8e3).sqrt());
    near(found.flow_kg_s[1], (40.0f64 / 8e3).sqrt());
    // 2·90 − 6·10 = 120 Pa·m³ are shared by 8 m³; the return duct loses 20 Pa from large to small.
    near(found.gauge_pa[1] - found.gauge_pa[0], 20.0);
    near(2.0 * found.gauge_pa[0] + 6.0 * found.gauge_pa[1], 120.0);
}

#[test]
fn a_dead_end_and_a_closed_valve_come_to_rest() {
    let mut tables = Tables::default();
    let (supply, sink) = (tables.node(NodeKind::Boundary, 200.0), tables.node(NodeKind::Boundary, 0.0));
    let (end, closed) = (tables.node(CABIN, -100.0), tables.node(CABIN, 0.0));
    tables.line(supply, end, &[fan(30.0), pipe(100.0)]);
    tables.line(supply, closed, &[pipe(100.0)]);
    let valve = Valve { open_resistance_pa_s2_kg2: 90.0, exponent: 3.0, leakage_opening: 1e-3 };
    tables.line(closed, sink, &[StdElement::Valve(valve)]);
    tables.inputs[1] = 0.0;
    let found = tables.steady().unwrap();
    assert!(found.flow_kg_s[0].abs() < 1e-9, "{found:?}");
    near(found.gauge_pa[2], 230.0);
    // C^−3 at the leakage opening is known to single precision.
    assert!((found.flow_kg_s[2] / (200.0 / 90e9f64).sqrt() - 1.0).abs() < 1e-6, "{found:?}");
}

#[test]
fn a_drain_takes_its_share_on_the_way_to_a_boundary() {
    let mut tables = Tables::default();
    let (high, low) = (tables.node(NodeKind::Boundary, 0.0), tables.node(NodeKind::Boundary, 0.0));
    let middle = tables.node(NodeKind::Junction, 0.0);
    let dryer =
        HeatExchanger { resistance_pa_s2_kg2: 500.0, liquid_fraction: 0.25, separator_efficiency: 1.0 };
    tables.line(high, middle, &[fan(100.0), StdElement::HeatExchanger(dryer)]);
    tables.line(middle, low, &[pipe(200.0)]);
    let found = tables.steady().unwrap();
    let behind = (100.0 / (1500.0 * 1.25f64.powi(2) + 200.0)).sqrt();
    near(found.flow_kg_s[0], 1.25 * behind);
    near(found.flow_kg_s[1], behind);
}

#[test]
fn fans_head_to_head_balance_only_through_a_loss() {
    let mut tables = Tables::default();
    let (left, right) = (tables.node(NodeKind::Boundary, 0.0), tables.node(NodeKind::Boundary, 0.0));
    let between = tables.node(NodeKind::Junction, 0.0);
    tables.line(left, between, &[fan(300.0)]);
    tables.line(right, between, &[fan(100.0)]);
    let found = tables.steady().unwrap();
    near(found.flow_kg_s[0], (200.0f64 / 2e3).sqrt());
    near(found.gauge_pa[2], 200.0);
}

/// A fan that loses nothing at any flow, as only a foreign element set could have it.
struct Ideal;

impl Element for Ideal {
    fn input_spec(&self, _index: usize) -> Option<InputSpec> {
        None
    }

    fn is_active(&self) -> bool {
        true
    }

    fn law(&self, _at: &Operating<'_>) -> Law {
        Law { resistance: 0.0, linear: 0.0, head: 300.0 }
    }

    fn check(&self) -> Result<(), ParameterError> {
        Ok(())
    }

    fn feed(&self, _hash: &mut Fingerprint) {}
}

#[test]
fn fans_without_a_loss_are_refused() {
    let held = Node { kind: NodeKind::Boundary, start_gauge_pa: 0.0, temperature_k: 295.15 };
    let nodes = [held, held, Node { kind: NodeKind::Junction, ..held }];
    let segment = |_| Segment { element: Ideal, inertance_per_m: 0.0, outlet_volume_m3: 0.0, first_input: 0 };
    let segments = [0, 1].map(segment);
    let line = |index| Line {
        from: index,
        to: 2,
        first_segment: index,
        segments: 1,
        ..example::paper_loop().lines[0]
    };
    let lines = [0, 1].map(|index| Line { flow_segment: 0, ..line(index) });
    let active = [0, 1].map(|index| Active { segment: index, line: index });
    let network = Network {
        reference_pa: 101_325.0,
        nodes: &nodes,
        lines: &lines,
        segments: &segments,
        active: &active,
        inputs: &[],
        schedules: &[],
        points: &[],
        plan: Plan::EMPTY,
        climate: eclss_core::Climate::NONE,
    };
    assert_eq!(steady(&network, &[]), Err(SteadyError::Network(NetworkError::LineWithoutLoss(0))));
}

#[test]
fn an_island_without_volume_or_boundary_is_named() {
    let mut tables = Tables::default();
    let cabin = tables.node(CABIN, 0.0);
    tables.line(cabin, cabin, &[fan(10.0)]);
    let (left, right) = (tables.node(NodeKind::Junction, 0.0), tables.node(NodeKind::Junction, 0.0));
    tables.line(left, right, &[pipe(1.0)]);
    assert_eq!(tables.steady(), Err(SteadyError::Floating { nodes: vec![left, right] }));
}

#[test]
fn a_balance_below_vacuum_is_refused() {
    let mut tables = Tables::default();
    let (cabin, outside) = (tables.node(CABIN, 0.0), tables.node(NodeKind::Boundary, 0.0));
    tables.line(cabin, outside, &[fan(2e5)]);
    let refused = tables.steady().unwrap_err();
    assert!(matches!(refused, SteadyError::BelowVacuum { node: 0, .. }), "{refused:?}");
}

#[test]
fn too_few_inputs_are_refused() {
    let network = example::paper_loop();
    assert_eq!(steady(&network, &[1.0]), Err(SteadyError::Inputs { needed: 2, given: 1 }));
}
