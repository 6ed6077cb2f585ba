//! What one evaluation of every component's law costs.

use super::{Figure, calling, counted};
use core::hint::black_box;
use eclss_core::components::{
    Bed, CheckValve, Fan, Hatch, HeadCurve, HeatExchanger, Measured, Orifice, Pipe, PressureRegulator, Pump,
    ReferencePipe, ReliefValve, Valve,
};
use eclss_core::{AnyComponent, Element as _, Law, Operating};

const CURVE: HeadCurve =
    HeadCurve { shutoff_pa: 300.0, linear_pa_s_kg: 120.0, quadratic_pa_s2_kg2: 12_984.201 };

/// Every component: those of the paper with parameters from its loop, the others with usual ones.
const ELEMENTS: [(&str, AnyComponent); 13] = [
    ("pipe", Pipe::new(805.874).into_any()),
    (
        "reference_pipe",
        ReferencePipe { pressure_drop_pa: 50.0, mass_flow_kg_s: 0.08, exponent: 1.75 }.into_any(),
    ),
    (
        "valve",
        Valve { open_resistance_pa_s2_kg2: 85.978_46, exponent: 3.134_165, leakage_opening: 1e-3 }.into_any(),
    ),
    ("fan", Fan::new(CURVE).into_any()),
    ("pump", Pump::new(CURVE).into_any()),
    (
        "heat_exchanger",
        HeatExchanger {
            resistance_pa_s2_kg2: 16_007.337,
            liquid_fraction: 0.0045,
            separator_efficiency: 1.0,
        }
        .into_any(),
    ),
    ("bed", Bed { resistance_pa_s2_kg2: 20_000.0, mass_fraction: 0.01, capture_efficiency: 0.9 }.into_any()),
    ("orifice", Orifice { effective_area_m2: 1e-4 }.into_any()),
    ("check_valve", CheckValve { resistance_pa_s2_kg2: 5_000.0, reverse_pa_s_kg: 1e8 }.into_any()),
    (
        "relief_valve",
        ReliefValve {
            crack_pa: 3_000.0,
            reseat_pa: 2_500.0,
            resistance_pa_s2_kg2: 1e6,
            effective_area_m2: 0.0,
            leakage_opening: 1e-3,
        }
        .into_any(),
    ),
    (
        "pressure_regulator",
        PressureRegulator {
            effective_area_m2: 1e-5,
            set_point_pa: 101_000.0,
            band_pa: 400.0,
            lag_s: 0.5,
            leakage_opening: 1e-3,
        }
        .into_any(),
    ),
    ("hatch", Hatch { open_resistance_pa_s2_kg2: 0.5, leakage_opening: 1e-3 }.into_any()),
    ("measured", Measured { largest_flow_kg_s: 0.2, slope_kg_s_pa: 1e-4 }.into_any()),
];

/// Inputs (opening or speed), from shut to more than nominal.
const INPUTS: [f32; 8] = [0.0, 0.001, 0.02, 0.118, 0.5, 0.755, 1.0, 1.5];
/// Mass flows \[kg/s\], both ways.
const FLOWS: [f32; 5] = [-0.05, -1e-4, 0.0, 1e-6, 0.0865];
/// Pressures at the outlet \[Pa\] against a cabin's at the inlet: vacuum, beyond and within the critical ratio, none
/// between both, reverse.
const OUTLETS: [f32; 5] = [0.0, 40e3, 90e3, 101_325.0, 150e3];
/// A valve of which the last step left half open.
const MEMORY: [f32; 1] = [0.5];

/// Measures every law over all inputs, flows and pressures. Which component it is, the compiler cannot see: the figure holds
/// the choice among all of them, as in a network that is loaded at run time.
pub(super) fn measure() {
    let calling = calling();
    for (name, element) in ELEMENTS {
        let mut figure = Figure::EMPTY;
        for input in INPUTS {
            let inputs = [input];
            for (mass_flow_kg_s, outlet_pa) in FLOWS.into_iter().flat_map(|flow| OUTLETS.map(|at| (flow, at)))
            {
                let plain = Operating::plain(&inputs, mass_flow_kg_s);
                let operating = Operating { outlet_pa, memory: &MEMORY, ..plain };
                let (element, operating) = (black_box(&element), black_box(&operating));
                let mut law = None;
                let count = counted(&mut || law = Some(evaluate(element, operating)));
                black_box(law);
                figure.add(count - calling);
            }
        }
        figure.report("law", name);
    }
}

#[inline(never)]
fn evaluate(element: &AnyComponent, operating: &Operating<'_>) -> Law {
    element.law(operating)
}
