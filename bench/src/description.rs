//! The networks that are measured, as tables.

use eclss_core::components::{Fan, HeadCurve, HeatExchanger, Pipe, Valve};
use eclss_core::{
    Active, AnyComponent, Element, Interpolation, Line, Network, Node, NodeKind, Schedule, SchedulePoint,
    Segment, example,
};
use eclss_network_file::PlanTables;

/// Pressure between the ends of every chain and mesh [Pa].
const DRIVE_PA: f32 = 300.0;
/// Resistance of all pipes of the paper's loop together [Pa·s²/kg²], shared by the pipes of a chain.
const PIPES: f32 = 39_713.0;
/// The paper's valve.
const VALVE: Valve =
    Valve { open_resistance_pa_s2_kg2: 85.978_46, exponent: 3.134_165, leakage_opening: 1e-3 };
/// Driving pressure below which a line is linear [Pa].
const LAMINAR_BELOW_PA: f32 = 1e-3;

/// When the valve of [`Description::paper_chain`] begins and ends to close [µs].
pub(crate) const CLOSING_US: [u64; 2] = [100_000, 1_100_000];
/// What remains open of it [1]: as far as plain Euler stays stable at 1 ms.
pub(crate) const REMAINS_OPEN: f32 = 0.3;

/// A network that owns its tables.
#[derive(Debug, Clone, Default)]
pub struct Description {
    nodes: Vec<Node>,
    lines: Vec<Line>,
    segments: Vec<Segment>,
    active: Vec<Active>,
    inputs: Vec<f32>,
    schedules: Vec<Schedule>,
    points: Vec<SchedulePoint>,
    plan: PlanTables,
}

impl Description {
    /// Returns one line of `equations` equations as the relaxation system counts them, n − 1 pressures and one
    /// flow: n − 1 pipes and a valve that closes to 30 %, between two held pressures. The physical methods find one flow
    /// and one volume behind every element in it, 2·n − 1 equations. `equations` ≥ 2.
    pub fn paper_chain(equations: usize) -> Self {
        let mut made = Self::default();
        let (from, to) = (made.node(None, DRIVE_PA), made.node(None, 0.0));
        let pipes = equations - 1;
        let mut elements = vec![pipe(PIPES / pipes as f32); pipes];
        elements.push(VALVE.into_any());
        made.line((from, to), &elements, (DRIVE_PA / (PIPES + VALVE.open_resistance_pa_s2_kg2)).sqrt());
        made.close_valve(CLOSING_US, REMAINS_OPEN);
        made.planned()
    }

    /// Returns `nodes` cabins of 60 m³ in a row, a pipe between every two, a supply before the first and an outlet
    /// with a valve behind the last: `nodes` + `nodes` + 1 equations.
    pub fn node_chain(nodes: usize) -> Self {
        let mut made = Self::default();
        let step = DRIVE_PA / (nodes + 1) as f32;
        let mut before = made.node(None, DRIVE_PA);
        for index in 1..=nodes {
            let node = made.node(Some(60.0), DRIVE_PA - step * index as f32);
            made.line((before, node), &[pipe(50.0)], (step / 50.0).sqrt());
            before = node;
        }
        let out = made.node(None, 0.0);
        made.line((before, out), &[VALVE.into_any()], 0.1);
        made.planned()
    }

    /// Returns `side` × `side` cabins of 60 m³ with a pipe between all neighbours, fed at one corner and open at
    /// the other: 3·side² − 2·side + 2 equations.
    pub fn mesh(side: usize) -> Self {
        let mut made = Self::default();
        let (supply, outlet) = (made.node(None, DRIVE_PA), made.node(None, 0.0));
        let first = made.nodes.len() as u32;
        let fall = DRIVE_PA / (2 * side) as f32;
        for (row, column) in (0..side).flat_map(|row| (0..side).map(move |column| (row, column))) {
            made.node(Some(60.0), DRIVE_PA - fall * (row + column + 1) as f32);
        }
        let at = |row: usize, column: usize| first + (row * side + column) as u32;
        made.line((supply, at(0, 0)), &[pipe(50.0)], 0.1);
        for (row, column) in (0..side).flat_map(|row| (0..side).map(move |column| (row, column))) {
            if column + 1 < side {
                made.line((at(row, column), at(row, column + 1)), &[pipe(50.0)], 0.1);
            }
            if row + 1 < side {
                made.line((at(row, column), at(row + 1, column)), &[pipe(80.0)], 0.1);
            }
        }
        made.line((at(side - 1, side - 1), outlet), &[VALVE.into_any()], 0.1);
        made.planned()
    }

    /// Returns the paper's loop whose valve stays open until 10 s and closes linearly to 2 % at 11 s.
    pub fn paper_loop() -> Self {
        let mut made = Self::default();
        let cabin = made.node(Some(60.0), 0.0);
        let curve = HeadCurve { shutoff_pa: 300.0, linear_pa_s_kg: 0.0, quadratic_pa_s2_kg2: 12_984.201 };
        let exchanger = HeatExchanger {
            resistance_pa_s2_kg2: 16_007.337,
            liquid_fraction: 0.0045,
            separator_efficiency: 1.0,
        };
        let elements = [
            pipe(805.874),
            Fan::new(curve).into_any(),
            pipe(5_337.527),
            exchanger.into_any(),
            pipe(4_577.822),
            VALVE.into_any(),
        ];
        made.line((cabin, cabin), &elements, 1e-3);
        made.close_valve([10_000_000, 11_000_000], 0.02);
        made.planned()
    }

    /// Lends the tables.
    pub fn network(&self) -> Network<'_> {
        Network {
            nodes: &self.nodes,
            lines: &self.lines,
            segments: &self.segments,
            active: &self.active,
            inputs: &self.inputs,
            schedules: &self.schedules,
            points: &self.points,
            plan: self.plan.plan(),
            ..example::paper_loop()
        }
    }

    fn node(&mut self, volume_m3: Option<f32>, start_gauge_pa: f32) -> u32 {
        let kind = volume_m3.map_or(NodeKind::Boundary, |volume_m3| NodeKind::Cabin { volume_m3 });
        self.nodes.push(Node { kind, start_gauge_pa, temperature_k: 295.15 });
        self.nodes.len() as u32 - 1
    }

    /// Adds a line with its flow state on the last element.
    fn line(&mut self, (from, to): (u32, u32), elements: &[AnyComponent], start_flow_kg_s: f32) {
        let line = self.lines.len() as u32;
        let segments = elements.len() as u32;
        self.lines.push(Line {
            from,
            to,
            first_segment: self.segments.len() as u32,
            segments,
            flow_segment: segments - 1,
            laminar_below_pa: LAMINAR_BELOW_PA,
            start_flow_kg_s,
        });
        for element in elements {
            if element.is_active() {
                self.active.push(Active { segment: self.segments.len() as u32, line });
            }
            let first_input = self.inputs.len() as u32;
            self.inputs.extend((0..).map_while(|index| element.input_spec(index)).map(|spec| spec.default));
            self.segments.push(Segment {
                element: *element,
                inertance_per_m: 254.648,
                outlet_volume_m3: 0.015_708,
                first_input,
            });
        }
    }

    /// Lets the last input fall from 1 to `remains` between two times [µs].
    fn close_valve(&mut self, [begins_us, ends_us]: [u64; 2], remains: f32) {
        let input = self.inputs.len() as u32 - 1;
        let points = [(0, 1.0), (begins_us, 1.0), (ends_us, remains)];
        self.points = points.map(|(time_us, value)| SchedulePoint { time_us, value }).to_vec();
        self.schedules =
            vec![Schedule { input, first_point: 0, points: 3, interpolation: Interpolation::Linear }];
    }

    fn planned(mut self) -> Self {
        self.plan = PlanTables::new(&self.nodes, &self.lines, &self.segments);
        self
    }
}

fn pipe(resistance_pa_s2_kg2: f32) -> AnyComponent {
    Pipe::new(resistance_pa_s2_kg2).into_any()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn networks_have_the_equations_that_they_claim() {
        let count = |made: &Description| {
            let held = made.nodes.iter().filter(|node| node.kind == NodeKind::Boundary).count();
            made.nodes.len() - held + made.lines.len()
        };
        assert_eq!(Description::paper_chain(100).segments.len(), 100);
        assert_eq!(count(&Description::node_chain(10)), 21);
        assert_eq!(count(&Description::mesh(7)), 3 * 49 - 14 + 2);
        for made in [Description::node_chain(4), Description::mesh(3), Description::paper_loop()] {
            assert_eq!(made.network().check(), Ok(()));
        }
    }

    #[test]
    fn the_loop_is_the_one_of_the_example() {
        let (ours, theirs) = (Description::paper_loop(), example::paper_loop());
        let elements = |network: &Network<'_>| {
            network.segments.iter().map(|segment| segment.element).collect::<Vec<_>>()
        };
        assert_eq!(elements(&ours.network()), elements(&theirs));
        assert_eq!(ours.network().plan, theirs.plan);
    }
}
