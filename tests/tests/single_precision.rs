//! Single precision: which way of writing the paper's system keeps its steady flow, beside the product.

use eclss_core::{Method, Network, example};
use eclss_tests::{paper, product};

type Outcome = Result<(), Box<dyn std::error::Error>>;

/// How states are written and updated in `f32`.
#[derive(Debug, Clone, Copy)]
struct Form {
    name: &'static str,
    /// From which pressure the states count [Pa]: 0 gauge, the cabin's own for absolute.
    reference_pa: f32,
    /// Whether sums are compensated.
    compensated: bool,
}

const FORMS: [Form; 4] = [
    Form { name: "absolute", reference_pa: 101_325.0, compensated: false },
    Form { name: "absolute, compensated sum", reference_pa: 101_325.0, compensated: true },
    Form { name: "gauge", reference_pa: 0.0, compensated: false },
    Form { name: "gauge, compensated sum", reference_pa: 0.0, compensated: true },
];

/// Adds to a state, with its carry where the form has one.
fn add(form: Form, (state, carry): (&mut f32, &mut f32), increment: f32) {
    if form.compensated {
        let y = increment - *carry;
        let t = *state + y;
        *carry = (t - *state) - y;
        *state = t;
    } else {
        *state += increment;
    }
}

/// Relative error of the flow against the exact steady flow after `until_s` [s] of the paper's system in
/// `f32` with the valve held at `opening`.
fn error(form: Form, opening: f64, h: f32, until_s: f32) -> f64 {
    let felt = paper::felt_resistances().map(|r| r as f32);
    let valve = paper::valve_resistance(opening) as f32;
    let heads = [0.0, paper::FAN_HEAD_PA as f32, 0.0, 0.0, 0.0];
    let (mut p, mut w) = ([form.reference_pa; 5], paper::START_FLOW_KG_S as f32);
    let (mut carry, mut flow_carry) = ([0.0; 5], 0.0);
    for _ in 0..(until_s / h).round() as u32 {
        let square = w * w.abs();
        let mut before = form.reference_pa;
        for (((p, carry), resistance), head) in p.iter_mut().zip(&mut carry).zip(felt).zip(heads) {
            let rate = before - *p + head - resistance * square;
            before = *p;
            add(form, (p, carry), h * rate);
        }
        let phi = (1.0 / (h * 2.0 * valve * w.abs())).min(1.0);
        let rate = phi * (before - form.reference_pa - valve * square);
        add(form, (&mut w, &mut flow_carry), h * rate);
    }
    f64::from(w) / paper::steady_flow_kg_s(opening) - 1.0
}

/// Relative error of the product's flow after `until_us` [µs].
fn product_error(opening: f64, step_us: u32, until_us: u64) -> Result<f64, Box<dyn std::error::Error>> {
    let inputs = product::held_at(opening as f32);
    let network = Network { inputs: &inputs, ..example::paper_loop() };
    let flow = product::with_simulator(&network, Method::Relaxation, step_us, |simulator| {
        product::step_until(simulator, until_us);
        f64::from(simulator.line_flow_kg_s(0))
    })?;
    Ok(flow / paper::steady_flow_kg_s(opening) - 1.0)
}

#[test]
fn only_gauge_states_with_compensated_sums_keep_the_steady_flow() -> Outcome {
    // Orders of magnitude of each form's error, 100 % and 2 % open, 1 ms.
    let bands = [[1e-3, 1e-2], [1e-4, 1e-6], [1e-6, 1e-5], [0.0, 0.0]];
    let ceilings = [[1e-2, 1e-1], [1e-3, 1e-4], [1e-4, 1e-3], [1e-6, 1e-6]];
    for ((form, floor), ceiling) in FORMS.into_iter().zip(bands).zip(ceilings) {
        let errors = [1.0, 0.02].map(|opening| error(form, opening, 1e-3, 100.0));
        println!("1 ms, {}: {:+.1e} / {:+.1e}", form.name, errors[0], errors[1]);
        for ((error, floor), ceiling) in errors.into_iter().zip(floor).zip(ceiling) {
            assert!((floor..=ceiling).contains(&error.abs()), "{}: {error:e}", form.name);
        }
    }
    let ours = [product_error(1.0, 1_000, 100_000_000)?, product_error(0.02, 1_000, 100_000_000)?];
    println!("1 ms, the product: {:+.1e} / {:+.1e}", ours[0], ours[1]);
    assert!(ours.iter().all(|error| error.abs() < 1e-6), "{ours:?}");
    Ok(())
}

#[test]
fn with_absolute_pressures_a_smaller_step_is_worse_and_in_the_product_it_is_not() -> Outcome {
    let [absolute, ..] = FORMS;
    let (mut last, mut ours_last) = (0.0, f64::INFINITY);
    for (step_us, floor) in [(10_000, 0.0), (1_000, 0.02), (100, 0.3)] {
        let wrong = error(absolute, 0.02, step_us as f32 * 1e-6, 100.0);
        let ours = product_error(0.02, step_us, 100_000_000)?;
        println!("2 % open, {step_us} µs: absolute {:+.2} %, the product {ours:+.1e}", 100.0 * wrong);
        assert!(wrong.abs() > last && wrong.abs() >= floor, "{step_us}: {wrong}");
        // One rounding of the flow apart.
        assert!(ours.abs() <= ours_last + 1.2e-7 && ours.abs() < 1e-6, "{step_us}: {ours:e}");
        (last, ours_last) = (wrong.abs(), ours.abs());
    }
    Ok(())
}
