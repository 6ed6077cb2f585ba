//! The ventilation loop of Qiu et al. 2017 as constant tables, valve fully open: for doctests, examples and a
//! board's self test. The shipped `networks/paper.toml` describes the same loop with the valve's schedule.

use crate::component::AnyComponent;
use crate::components::{Fan, HeadCurve, HeatExchanger, Pipe, Valve};
use crate::{Active, Line, Network, Node, NodeKind, Plan, Segment};

const fn pipe(resistance_pa_s2_kg2: f32) -> AnyComponent {
    Pipe::new(resistance_pa_s2_kg2).into_any()
}

const fn segment(element: AnyComponent, first_input: u32) -> Segment {
    Segment { element, inertance_per_m: 254.648, outlet_volume_m3: 0.015_708, first_input }
}

static NODES: [Node; 1] =
    [Node { kind: NodeKind::Cabin { volume_m3: 60.0 }, start_gauge_pa: 0.0, temperature_k: 295.15 }];
static LINES: [Line; 1] = [Line {
    from: 0,
    to: 0,
    first_segment: 0,
    segments: 6,
    flow_segment: 5,
    laminar_below_pa: 0.0,
    start_flow_kg_s: 1e-3,
}];
static SEGMENTS: [Segment; 6] = [
    segment(pipe(805.874), 0),
    segment(
        Fan::new(HeadCurve { shutoff_pa: 300.0, linear_pa_s_kg: 0.0, quadratic_pa_s2_kg2: 12_984.201 })
            .into_any(),
        0,
    ),
    segment(pipe(5_337.527), 1),
    segment(
        HeatExchanger {
            resistance_pa_s2_kg2: 16_007.337,
            liquid_fraction: 0.0045,
            separator_efficiency: 1.0,
        }
        .into_any(),
        1,
    ),
    segment(pipe(4_577.822), 1),
    segment(
        Valve { open_resistance_pa_s2_kg2: 85.978_46, exponent: 3.134_165, leakage_opening: 1e-3 }.into_any(),
        1,
    ),
];
static ACTIVE: [Active; 2] = [Active { segment: 1, line: 0 }, Active { segment: 5, line: 0 }];
static INPUTS: [f32; 2] = [1.0, 1.0];

/// Returns the paper's loop: cabin of 60 m³, pipe, fan, pipe, CHE, pipe, valve. Input 0 is the fan's speed,
/// input 1 the valve's opening.
pub fn paper_loop() -> Network<'static> {
    Network {
        reference_pa: 101_325.0,
        nodes: &NODES,
        lines: &LINES,
        segments: &SEGMENTS,
        active: &ACTIVE,
        responsive: &[],
        inputs: &INPUTS,
        schedules: &[],
        points: &[],
        plan: Plan {
            end_start: &[0, 2],
            ends: &[0, 1],
            order: &[0],
            row_start: &[0, 1],
            columns: &[0],
            diagonal: &[0],
            stamps: &[[0, Plan::NOWHERE, Plan::NOWHERE, 0]],
            row_of: &[0],
            leaves: &[[Plan::NOWHERE; 2]],
            terms: &[[12, 1, Plan::NOWHERE], [15, 1, Plan::NOWHERE]],
            series: &[],
            composite: &[0],
            between: &[[0, 1], [1, 2], [2, 3], [3, 4], [4, 5], [5, 0]],
        },
        climate: crate::Climate::NONE,
    }
}
