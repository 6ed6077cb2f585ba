//! Networks whose steady state is known in closed form, and networks that have none.

use eclss_core::component::Draft;
use eclss_core::components::{
    CheckValve, Fan, HeadCurve, HeatExchanger, Orifice, Pipe, PressureRegulator, ReliefValve, Valve,
};
use eclss_core::parameter::{Key, Keys};
use eclss_core::{
    Active, AnyComponent, Component, Element, Law, Line, Network, NetworkError, Node, NodeKind, Operating,
    ParameterError, Plan, Responsive, Segment, example,
};

use super::*;

#[derive(Default)]
struct Tables {
    nodes: Vec<Node>,
    lines: Vec<Line>,
    segments: Vec<Segment>,
    active: Vec<Active>,
    responsive: Vec<Responsive>,
    memory_slots: u32,
    inputs: Vec<f32>,
}

impl Tables {
    fn node(&mut self, kind: NodeKind, start_gauge_pa: f32) -> u32 {
        self.nodes.push(Node { kind, start_gauge_pa, temperature_k: 295.15 });
        self.nodes.len() as u32 - 1
    }

    fn line(&mut self, from: u32, to: u32, elements: &[AnyComponent]) {
        self.line_of_density(from, to, elements, 0.0);
    }

    fn line_of_density(
        &mut self,
        from: u32,
        to: u32,
        elements: &[AnyComponent],
        reference_density_kg_m3: f32,
    ) {
        let responds = elements.iter().any(Element::responds) || reference_density_kg_m3 > 0.0;
        let line = self.lines.len() as u32;
        let first_segment = self.segments.len() as u32;
        for element in elements {
            let segment = self.segments.len() as u32;
            if element.is_active() && !responds {
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
        if responds {
            let first_memory = self.memory_slots;
            self.responsive.push(Responsive { line, first_memory, reference_density_kg_m3 });
            self.memory_slots += elements.iter().map(|element| element.memory() as u32).sum::<u32>();
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
            responsive: &self.responsive,
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

fn pipe(resistance_pa_s2_kg2: f32) -> AnyComponent {
    Pipe::new(resistance_pa_s2_kg2).into_any()
}

fn fan(shutoff_pa: f32) -> AnyComponent {
    let curve = HeadCurve { shutoff_pa, linear_pa_s_kg: 0.0, quadratic_pa_s2_kg2: 1e3 };
    Fan::new(curve).into_any()
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
    tables.line(closed, sink, &[valve.into_any()]);
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
    tables.line(high, middle, &[fan(100.0), dryer.into_any()]);
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

eclss_core::parameters! {
    /// A fan that loses nothing at any flow, as only a foreign kind could.
    pub struct Ideal {
        /// Head [Pa].
        pub head_pa: f32,
    }
}

impl Component for Ideal {
    const KIND: &'static str = "ideal";
    const ABOUT: &'static str = "A fan without a loss.";
    const KEYS: Keys = &[&[Key::required("head_pa", "Pa", (0.0, 1e3), "Head.")]];

    fn from_file(draft: &mut Draft<'_>) -> Self {
        Self { head_pa: draft.single("head_pa") }
    }

    fn check(&self) -> Result<(), ParameterError> {
        Ok(())
    }

    fn is_active(&self) -> bool {
        true
    }

    fn law(&self, _at: &Operating<'_>) -> Law {
        Law { resistance: 0.0, linear: 0.0, head: self.head_pa }
    }
}

#[test]
fn fans_without_a_loss_are_refused() {
    let held = Node { kind: NodeKind::Boundary, start_gauge_pa: 0.0, temperature_k: 295.15 };
    let nodes = [held, held, Node { kind: NodeKind::Junction, ..held }];
    let segment = |_| Segment {
        element: Ideal { head_pa: 300.0 }.into_any(),
        inertance_per_m: 0.0,
        outlet_volume_m3: 0.0,
        first_input: 0,
    };
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
        responsive: &[],
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

/// Gas of the tests' nodes, Rg·T [J/kg].
fn gas() -> f64 {
    f64::from(eclss_core::air::GAS_CONSTANT_J_KG_K) * f64::from(295.15f32)
}

/// Flow of an opening, as in the textbook.
fn isentropic(area: f64, high: f64, low: f64) -> f64 {
    let gamma = 1.4f64;
    let r = (low / high).max((2.0 / (gamma + 1.0)).powf(gamma / (gamma - 1.0)));
    let fall = r.powf(2.0 / gamma) - r.powf((gamma + 1.0) / gamma);
    area * high / gas().sqrt() * (2.0 * gamma / (gamma - 1.0) * fall).sqrt()
}

/// Zero of a falling function.
fn zero(mut low: f64, mut high: f64, falling: impl Fn(f64) -> f64) -> f64 {
    for _ in 0..200 {
        let middle = f64::midpoint(low, high);
        if falling(middle) > 0.0 { low = middle } else { high = middle }
    }
    f64::midpoint(low, high)
}

fn orifice(effective_area_m2: f32) -> AnyComponent {
    Orifice { effective_area_m2 }.into_any()
}

const REFERENCE: f64 = 101_325.0;

#[test]
fn a_cabin_between_two_openings_stands_where_their_flows_agree() {
    // Both choked, only the outlet, and neither.
    for (supply, areas, sink) in [
        (1e6, [1e-6, 1e-5], 0.0f64),
        (1.2e5, [4e-6, 1e-6], 0.0),
        (1.05e5, [1e-6, 1e-6], 1.0e5),
        (4e6, [1e-7, 3e-6], 0.9e5),
    ] {
        let mut tables = Tables::default();
        let high = tables.node(NodeKind::Boundary, (supply - REFERENCE) as f32);
        let cabin = tables.node(CABIN, 0.0);
        let low = tables.node(NodeKind::Boundary, (sink - REFERENCE) as f32);
        tables.line(high, cabin, &[orifice(areas[0] as f32)]);
        tables.line(cabin, low, &[orifice(areas[1] as f32)]);
        let found = tables.steady().unwrap();
        let exact = zero(sink, supply, |p| isentropic(areas[0], supply, p) - isentropic(areas[1], p, sink));
        let pressure = found.gauge_pa[1] + REFERENCE;
        assert!((pressure / exact - 1.0).abs() < 3e-6, "{pressure} against {exact}: {found:?}");
        let flow = isentropic(areas[1], exact, sink);
        for w in &found.flow_kg_s {
            assert!((w / flow - 1.0).abs() < 3e-6, "{w} against {flow}");
        }
    }
}

#[test]
fn an_opening_behind_a_duct_takes_what_the_duct_leaves() {
    for (sink, ahead) in [(0.0, true), (0.0, false), (9e4, true), (9e4, false)] {
        let mut tables = Tables::default();
        let high = tables.node(NodeKind::Boundary, 0.0);
        let low = tables.node(NodeKind::Boundary, (sink - REFERENCE) as f32);
        let duct = pipe(1e9);
        let elements = if ahead { [duct, orifice(2e-5)] } else { [orifice(2e-5), duct] };
        tables.line(high, low, &elements);
        let found = tables.steady().unwrap().flow_kg_s[0];
        let area = f64::from(2e-5f32);
        let exact = zero(0.0, 0.1, |w| {
            let lost = f64::from(1e9f32) * w * w;
            let (high, low) = if ahead { (REFERENCE - lost, sink) } else { (REFERENCE, sink + lost) };
            if high > low { isentropic(area, high, low) - w } else { -w }
        });
        assert!((found / exact - 1.0).abs() < 1e-5, "{sink}, {ahead}: {found} against {exact}");
    }
}

/// Closed air is held, and the answer says so; what a drain of the same size takes is what its leak carries.
#[test]
fn a_leaking_cabin_keeps_its_air() {
    let mut tables = Tables::default();
    let cabin = tables.node(CABIN, 0.0);
    let space = tables.node(NodeKind::Boundary, -101_325.0);
    tables.line(cabin, space, &[orifice(1e-8)]);
    let found = tables.steady().unwrap();
    let exact = isentropic(f64::from(1e-8f32), REFERENCE, 0.0);
    assert!(found.gauge_pa[0].abs() < 1e-6 && (found.flow_kg_s[0] / exact - 1.0).abs() < 1e-6, "{found:?}");
    let NodeKind::Cabin { volume_m3 } = CABIN else { unreachable!() };
    let rate_pa_s = -exact * 287.05 * f64::from(295.15f32) / f64::from(volume_m3);
    let [held] = &found.held[..] else { panic!("{found:?}") };
    assert_eq!((&held.nodes[..], &held.lines[..]), (&[0][..], &[0][..]));
    assert!((held.rate_pa_s / rate_pa_s - 1.0).abs() < 1e-5, "{held:?}, {rate_pa_s}");
}

#[test]
fn a_check_valve_at_rest_passes_or_leaks() {
    let check = CheckValve { resistance_pa_s2_kg2: 4e3, reverse_pa_s_kg: 1e9 }.into_any();
    for (rise, exact) in [(250.0f32, (250.0f64 / 5e3).sqrt()), (-250.0, -250.0 / 1e9)] {
        let mut tables = Tables::default();
        let (one, other) = (tables.node(NodeKind::Boundary, rise), tables.node(NodeKind::Boundary, 0.0));
        tables.line(one, other, &[pipe(1e3), check]);
        let found = tables.steady().unwrap().flow_kg_s[0];
        assert!((found / exact - 1.0).abs() < 1e-6, "{found} against {exact}");
    }
}

#[test]
fn a_check_valve_beside_a_closed_valve_does_not_end_the_search_at_its_kink() {
    let check = |resistance_pa_s2_kg2: f32, reverse_pa_s_kg: f32| {
        CheckValve { resistance_pa_s2_kg2, reverse_pa_s_kg }.into_any()
    };
    let mut tables = Tables::default();
    let (high, cabin) = (tables.node(NodeKind::Boundary, 240.298_52), tables.node(CABIN, -48.0));
    let low = tables.node(NodeKind::Boundary, -152.410_31);
    tables.line(cabin, high, &[check(551_185.2, 3.516_095e7), pipe(551_185.2)]);
    tables.line(cabin, low, &[pipe(573_800.0)]);
    tables.line(low, cabin, &[check(943.66, 1.833_646e7), pipe(1_887.32)]);
    for (line, limit) in tables.lines.iter_mut().zip([0.024f32, 1.5e-3, 0.02]) {
        line.laminar_below_pa = limit;
    }
    let found = tables.steady().unwrap();
    let [leak, open, shut] = found.flow_kg_s[..] else { panic!("three lines") };
    // The cabin stands just above the low side: what leaks in goes out through the open line.
    let above = found.gauge_pa[1] + 152.410_31f64;
    assert!((1e-4..1e-3).contains(&above) && shut < 0.0 && shut.abs() < 1e-10, "{above} {found:?}");
    assert!((leak + open - shut).abs() < 1e-9 * open, "{found:?}");
}

#[test]
fn a_regulator_rests_in_its_band() {
    let regulator = PressureRegulator {
        effective_area_m2: 1e-6,
        set_point_pa: 101_000.0,
        band_pa: 400.0,
        lag_s: 1.0,
        leakage_opening: 1e-3,
    };
    for supply in [3e5, 1e6, 2e7] {
        let mut tables = Tables::default();
        let bottle = tables.node(NodeKind::Boundary, supply as f32 - 101_325.0);
        let cabin = tables.node(CABIN, 0.0);
        let space = tables.node(NodeKind::Boundary, -101_325.0);
        tables.line(bottle, cabin, &[regulator.into_any()]);
        tables.line(cabin, space, &[orifice(1e-6)]);
        let found = tables.steady().unwrap();
        let area = |p: f64| f64::from(1e-6f32) * ((101_000.0 - p) / 400.0).clamp(1e-3, 1.0);
        let exact = zero(9e4, 101_100.0, |p| isentropic(area(p), supply, p) - isentropic(1e-6, p, 0.0));
        let pressure = found.gauge_pa[1] + REFERENCE;
        assert!((pressure - exact).abs() < 0.5, "{supply}: {pressure} against {exact}");
    }
}

#[test]
fn a_relief_valve_rests_open_or_never() {
    let relief = |reseat_pa| {
        let leakage_opening = 1e-3;
        ReliefValve {
            crack_pa: 3_000.0,
            reseat_pa,
            resistance_pa_s2_kg2: 1e7,
            effective_area_m2: 0.0,
            leakage_opening,
        }
    };
    let rest = |reseat_pa| {
        let mut tables = Tables::default();
        let bottle = tables.node(NodeKind::Boundary, 1e6);
        let cabin = tables.node(CABIN, 0.0);
        let outside = tables.node(NodeKind::Boundary, 0.0);
        tables.line(bottle, cabin, &[orifice(5e-6)]);
        tables.line(cabin, outside, &[relief(reseat_pa).into_any()]);
        tables.steady()
    };
    // Open it loses 1e7·(12.9 g/s)² = 1.7 kPa.
    let flow = isentropic(f64::from(5e-6f32), 1e6 + REFERENCE, 1.05e5);
    let found = rest(1_000.0).unwrap();
    assert!((found.gauge_pa[1] / (1e7 * flow * flow) - 1.0).abs() < 1e-5, "{found:?}");
    let refused = rest(2_500.0).unwrap_err();
    assert_eq!(refused, SteadyError::Switching { segments: vec![1] });
    let names =
        crate::Names { segments: vec!["hole".to_owned(), "relief".to_owned()], ..crate::Names::default() };
    let text = refused.text(&names);
    assert!(text.contains("no steady state") && text.contains("`relief`"), "{text}");
}

#[test]
fn a_fan_moves_volume_where_density_follows() {
    let mut tables = Tables::default();
    let cabin = tables.node(CABIN, -50_000.0);
    let density = REFERENCE / gas();
    tables.line_of_density(cabin, cabin, &[fan(100.0), pipe(3e3)], density as f32);
    let found = tables.steady().unwrap().flow_kg_s[0];
    let exact = (REFERENCE - 50_000.0) / REFERENCE * (100.0f64 / 4e3).sqrt();
    assert!((found / exact - 1.0).abs() < 1e-6, "{found} against {exact}");
}
