//! The components' laws in `f64`, written from their formulas and not from the elements' code.

use crate::model::{Branch, Part, Power};
use eclss_core::components::{Bed, Fan, Hatch, HeadCurve, HeatExchanger, Pipe, Pump, ReferencePipe, Valve};
use eclss_core::{AnyComponent, Segment};

/// Returns an element's part at `input` [1]: speed of a machine, opening of a valve, unused elsewhere.
pub fn part(element: &AnyComponent, input: f64) -> Part {
    let resists = |resistance: f32| Part { resistance: f64::from(resistance), ..Part::default() };
    if let Some(pipe) = element.get::<Pipe>() {
        return resists(pipe.resistance_pa_s2_kg2);
    }
    if let Some(pipe) = element.get::<ReferencePipe>() {
        return Part {
            power: Power {
                drop_pa: f64::from(pipe.pressure_drop_pa),
                flow_kg_s: f64::from(pipe.mass_flow_kg_s),
                exponent: f64::from(pipe.exponent),
            },
            ..Part::default()
        };
    }
    if let Some(valve) = element.get::<Valve>() {
        let opening = input.max(f64::from(valve.leakage_opening));
        let open = f64::from(valve.open_resistance_pa_s2_kg2);
        return Part { resistance: open * opening.powf(-f64::from(valve.exponent)), ..Part::default() };
    }
    if let Some(fan) = element.get::<Fan>() {
        return machine(&fan.curve(), input);
    }
    if let Some(pump) = element.get::<Pump>() {
        return machine(&pump.curve(), input);
    }
    if let Some(exchanger) = element.get::<HeatExchanger>() {
        let removal = f64::from(exchanger.separator_efficiency) * f64::from(exchanger.liquid_fraction);
        return Part { removal, ..resists(exchanger.resistance_pa_s2_kg2) };
    }
    if let Some(bed) = element.get::<Bed>() {
        // w_d = y·η·w_in, so w_in/w_out = 1/(1 − y·η).
        let caught = f64::from(bed.mass_fraction) * f64::from(bed.capture_efficiency);
        return Part { removal: 1.0 / (1.0 - caught) - 1.0, ..resists(bed.resistance_pa_s2_kg2) };
    }
    if let Some(hatch) = element.get::<Hatch>() {
        let opening = input.max(f64::from(hatch.leakage_opening));
        let resistance = f64::from(hatch.open_resistance_pa_s2_kg2) / (opening * opening);
        return Part { resistance, ..Part::default() };
    }
    // Components that respond to pressure, or whose flow is given, have no place in the relaxation system.
    Part { resistance: f64::INFINITY, ..Part::default() }
}

/// Returns a loop of `segments` with the flow state on `flow_part`, its valves at `opening` [1], its machines at
/// rated speed.
pub fn branch(segments: &[Segment], flow_part: usize, opening: f64) -> Branch {
    let input = |element: &AnyComponent| if element.is::<Valve>() { opening } else { 1.0 };
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
