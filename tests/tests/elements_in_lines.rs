//! Steady states of single lines whose elements are not purely quadratic, against the law solved by bisection.

use eclss_core::components::{Fan, HeadCurve, HeatExchanger, Pipe, ReferencePipe};
use eclss_core::{AnyComponent, BuildError, Method};
use eclss_tests::product::{self, Tables};

const HEAT_EXCHANGER: AnyComponent =
    HeatExchanger { resistance_pa_s2_kg2: 100.0, liquid_fraction: 0.05, separator_efficiency: 1.0 }
        .into_any();
/// Flow upstream of the heat exchanger per flow behind it.
const UPSTREAM: f64 = 1.05;

fn pipe(resistance_pa_s2_kg2: f32) -> AnyComponent {
    Pipe::new(resistance_pa_s2_kg2).into_any()
}

/// Settled flow [kg/s] of one line of three elements between boundaries, flow state on the last.
fn settled(elements: &[AnyComponent; 3], driving_pa: f32) -> Result<f64, BuildError> {
    let mut tables = Tables::default();
    let ends = (tables.node(None, driving_pa), tables.node(None, 0.0));
    tables.line(ends, elements, 2, 0.0, 1e-3);
    product::with_simulator(&tables.network(), Method::Relaxation, 1_000, |simulator| {
        product::step_until(simulator, 100_000_000);
        f64::from(simulator.line_flow_kg_s(0))
    })
}

/// Zero of a falling function on 0…1.
fn zero(balance: impl Fn(f64) -> f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        if balance(middle) > 0.0 { low = middle } else { high = middle }
    }
    low
}

#[test]
fn a_linear_loss_ahead_of_a_drain_feels_its_own_flow() -> Result<(), BuildError> {
    let curve = HeadCurve { shutoff_pa: 300.0, linear_pa_s_kg: 2_000.0, quadratic_pa_s2_kg2: 100.0 };
    let flow = settled(&[Fan::new(curve).into_any(), HEAT_EXCHANGER, pipe(5e3)], 0.0)?;
    let exact = zero(|w| {
        let ahead = UPSTREAM * w;
        300.0 - 2_000.0 * ahead - 200.0 * ahead * ahead - 5e3 * w * w
    });
    assert!((flow / exact - 1.0).abs() < 1e-5, "{flow} against {exact}");
    Ok(())
}

#[test]
fn a_power_law_ahead_of_a_drain_feels_its_own_flow() -> Result<(), BuildError> {
    let element = ReferencePipe { pressure_drop_pa: 200.0, mass_flow_kg_s: 0.1, exponent: 1.75 };
    let flow = settled(&[element.into_any(), HEAT_EXCHANGER, pipe(5e3)], 300.0)?;
    let exact = zero(|w| {
        let ahead = UPSTREAM * w;
        300.0 - 200.0 * (ahead / 0.1).powf(1.75) - 100.0 * ahead * ahead - 5e3 * w * w
    });
    assert!((flow / exact - 1.0).abs() < 1e-5, "{flow} against {exact}");
    Ok(())
}
