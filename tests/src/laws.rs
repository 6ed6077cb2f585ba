//! The components' laws in `f64`, written from their formulas and not from the elements' code.

use crate::model::{Branch, Part, Power};
use eclss_core::element::HeadCurve;
use eclss_core::{Segment, StdElement};

/// Returns an element's part at `input` [1]: speed of a machine, opening of a valve, unused elsewhere.
pub fn part(element: &StdElement, input: f64) -> Part {
    match element {
        StdElement::Pipe(pipe) => {
            Part { resistance: f64::from(pipe.resistance_pa_s2_kg2), ..Part::default() }
        }
        StdElement::ReferencePipe(pipe) => Part {
            power: Power {
                drop_pa: f64::from(pipe.pressure_drop_pa),
                flow_kg_s: f64::from(pipe.mass_flow_kg_s),
                exponent: f64::from(pipe.exponent),
            },
            ..Part::default()
        },
        StdElement::Valve(valve) => {
            let opening = input.max(f64::from(valve.leakage_opening));
            let open = f64::from(valve.open_resistance_pa_s2_kg2);
            Part { resistance: open * opening.powf(-f64::from(valve.exponent)), ..Part::default() }
        }
        StdElement::Fan(fan) => machine(&fan.curve, input),
        StdElement::Pump(pump) => machine(&pump.curve, input),
        StdElement::HeatExchanger(exchanger) => Part {
            resistance: f64::from(exchanger.resistance_pa_s2_kg2),
            removal: f64::from(exchanger.separator_efficiency) * f64::from(exchanger.liquid_fraction),
            ..Part::default()
        },
        StdElement::Bed(bed) => {
            // w_d = y·η·w_in, so w_in/w_out = 1/(1 − y·η).
            let caught = f64::from(bed.mass_fraction) * f64::from(bed.capture_efficiency);
            let resistance = f64::from(bed.resistance_pa_s2_kg2);
            Part { resistance, removal: 1.0 / (1.0 - caught) - 1.0, ..Part::default() }
        }
        // Its flow is given, so that no loop is made of it.
        StdElement::Hatch(hatch) => {
            let opening = input.max(f64::from(hatch.leakage_opening));
            let resistance = f64::from(hatch.open_resistance_pa_s2_kg2) / (opening * opening);
            Part { resistance, ..Part::default() }
        }
        // What responds to pressure, or is measured, has no place in the relaxation system.
        StdElement::Orifice(_)
        | StdElement::CheckValve(_)
        | StdElement::ReliefValve(_)
        | StdElement::PressureRegulator(_)
        | StdElement::Measured(_) => Part { resistance: f64::INFINITY, ..Part::default() },
    }
}

/// Returns a loop of `segments` with the flow state on `flow_part`, its valves at `opening` [1], its machines at
/// rated speed.
pub fn branch(segments: &[Segment], flow_part: usize, opening: f64) -> Branch {
    let input = |element: &StdElement| if matches!(element, StdElement::Valve(_)) { opening } else { 1.0 };
    let parts = segments.iter().map(|segment| part(&segment.element, input(&segment.element))).collect();
    Branch { from: 0, to: 0, parts, flow_part, laminar_below_pa: 0.0 }
}

/// Affinity laws: flow grows with the speed N, head with its square; h(w; N) = N²·h(w/N).
fn machine(curve: &HeadCurve, speed: f64) -> Part {
    Part {
        resistance: f64::from(curve.quadratic_pa_s2_kg2),
        linear: speed * f64::from(curve.linear_pa_s_kg),
        head: speed * speed * f64::from(curve.shutoff_pa),
        ..Part::default()
    }
}
