//! What one evaluation of every component's law costs.

use super::{Figure, calling, counted};
use core::hint::black_box;
use eclss_core::element::{Bed, Fan, HeadCurve, HeatExchanger, Pipe, Pump, ReferencePipe, Valve};
use eclss_core::{Element as _, Law, Operating, StdElement};

const CURVE: HeadCurve =
    HeadCurve { shutoff_pa: 300.0, linear_pa_s_kg: 120.0, quadratic_pa_s2_kg2: 12_984.201 };

/// Every component with parameters from the paper's loop.
const ELEMENTS: [(&str, StdElement); 7] = [
    ("pipe", StdElement::Pipe(Pipe { resistance_pa_s2_kg2: 805.874 })),
    (
        "reference_pipe",
        StdElement::ReferencePipe(ReferencePipe {
            pressure_drop_pa: 50.0,
            mass_flow_kg_s: 0.08,
            exponent: 1.75,
        }),
    ),
    (
        "valve",
        StdElement::Valve(Valve {
            open_resistance_pa_s2_kg2: 85.978_46,
            exponent: 3.134_165,
            leakage_opening: 1e-3,
        }),
    ),
    ("fan", StdElement::Fan(Fan { curve: CURVE })),
    ("pump", StdElement::Pump(Pump { curve: CURVE })),
    (
        "heat_exchanger",
        StdElement::HeatExchanger(HeatExchanger {
            resistance_pa_s2_kg2: 16_007.337,
            liquid_fraction: 0.0045,
            separator_efficiency: 1.0,
        }),
    ),
    (
        "bed",
        StdElement::Bed(Bed { resistance_pa_s2_kg2: 20_000.0, mass_fraction: 0.01, capture_efficiency: 0.9 }),
    ),
];

/// Inputs (opening or speed), from shut to more than nominal.
const INPUTS: [f32; 8] = [0.0, 0.001, 0.02, 0.118, 0.5, 0.755, 1.0, 1.5];
/// Mass flows \[kg/s\], both ways.
const FLOWS: [f32; 5] = [-0.05, -1e-4, 0.0, 1e-6, 0.0865];

/// Measures every law over all inputs and flows. Which component it is, the compiler cannot see: the figure holds
/// the choice among all of them, as in a network that is loaded at run time.
pub(super) fn measure() {
    let calling = calling();
    for (name, element) in ELEMENTS {
        let mut figure = Figure::EMPTY;
        for input in INPUTS {
            let inputs = [input];
            for mass_flow_kg_s in FLOWS {
                let operating = Operating::plain(&inputs, mass_flow_kg_s);
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
fn evaluate(element: &StdElement, operating: &Operating<'_>) -> Law {
    element.law(operating)
}
