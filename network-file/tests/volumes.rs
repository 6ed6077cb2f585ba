//! Volumes of air that are small against what passes, or stiff against what drives it.

use eclss_core::{Buffers, Health, Method, Settings, Simulator};
use eclss_network_file::parse;

/// A file of volumes and lines that starts like this.
const HEAD: &str = "schema = 1\nname = \"volumes\"\nreference_pressure_pa = 101325.0\n[run]\n\
                    method = \"implicit-euler\"\n[air]\n";

fn node(id: &str, volume_m3: f64, pressure_pa: f64, temperature_k: f64) -> String {
    format!(
        "[[node]]\nid = \"{id}\"\nkind = \"cabin\"\nvolume_m3 = {volume_m3:e}\n\
         pressure_pa = {pressure_pa:e}\ntemperature_k = {temperature_k:e}\n"
    )
}

fn line(from: &str, to: &str, element: &str) -> String {
    let id = format!("{from}{to}");
    format!(
        "[[line]]\nid = \"l_{id}\"\nfrom = \"{from}\"\nto = \"{to}\"\n[[line.element]]\nid = \"e_{id}\"\n{element}\n"
    )
}

/// Runs a file to its end and calls `each` after every step.
fn run(text: &str, method: Method, step_us: u32, steps: u32, each: impl FnMut(u32, &Simulator<'_>)) {
    assert_eq!(trusted_steps(text, method, step_us, steps, each), steps, "{method:?}, {step_us} µs");
}

/// Runs a file for at most so many steps, calls `each` after every one that is trusted, and returns their number.
fn trusted_steps(
    text: &str,
    method: Method,
    step_us: u32,
    steps: u32,
    mut each: impl FnMut(u32, &Simulator<'_>),
) -> u32 {
    let loaded = parse(text, "volumes.toml").unwrap_or_else(|error| panic!("{error}"));
    let network = loaded.network();
    let sizes = method.sizes(&network);
    let (mut state, mut work) = (vec![0.0; sizes.state], vec![0.0; sizes.work]);
    let (mut inputs, mut cursors) = (vec![0.0; sizes.inputs], vec![0; sizes.cursors]);
    let buffers = Buffers { state: &mut state, work: &mut work, inputs: &mut inputs, cursors: &mut cursors };
    let mut simulator = Simulator::new(&network, Settings { method, step_us }, buffers).unwrap();
    for step in 0..steps {
        if simulator.step() != Health::Trusted {
            return step;
        }
        each(step, &simulator);
    }
    for ledger in simulator.ledgers() {
        assert!(ledger.gap().abs() < 1e-3, "{method:?}: {ledger:?}");
    }
    steps
}

/// Cabins of 60 m³ with open hatches between them: at rest a hatch is so stiff that φ of `adaptive` is far below 1.
#[test]
fn open_hatches_between_cabins_come_to_rest() {
    let hatch = "kind = \"hatch\"\nresistance_pa_s2_kg2 = 0.5";
    let fan = "kind = \"fan\"\nshutoff_pa = 100.0\nquadratic_pa_s2_kg2 = 6000.0";
    let text = [
        HEAD.to_owned(),
        node("a", 60.0, 101_326.0, 295.15),
        node("b", 60.0, 101_325.0, 295.15),
        node("c", 60.0, 101_325.0, 295.15),
        line("a", "b", hatch),
        line("b", "c", hatch),
        line("c", "a", fan),
    ]
    .concat();
    for method in [Method::Adaptive, Method::ImplicitEuler] {
        let mut flow = 0.0;
        run(&text, method, 10_000, 60_000, |_, simulator| {
            flow = simulator.line_flow_kg_s(0);
            assert!(flow.abs() < 2.0, "{method:?}: {flow}");
        });
        // What the fan drives, √(100/6001): the loss of the hatches is small beside its own.
        let exact = (100.0f32 / 6_001.0).sqrt();
        assert!((flow / exact - 1.0).abs() < 1e-3, "{method:?}: {flow} against {exact}");
    }
}

/// A litre between two large volumes, through which more passes in a step than it holds: its temperature and pressure
/// stay between those around it but for the steps in which it warms.
#[test]
fn a_litre_in_a_strong_stream_neither_rings_nor_overshoots() {
    let pipe = "kind = \"pipe\"\nresistance_pa_s2_kg2 = 100.0";
    for start_k in [295.15f32, 215.0] {
        let text = [
            HEAD.to_owned(),
            node("a", 100.0, 101_425.0, 310.0),
            node("b", 1e-3, 101_325.0, f64::from(start_k)),
            node("c", 100.0, 101_325.0, 295.15),
            line("a", "b", pipe),
            line("b", "c", pipe),
        ]
        .concat();
        for (method, step_us) in [
            (Method::ImplicitEuler, 10_000),
            (Method::ImplicitEuler, 1_000_000),
            (Method::TrBdf2, 100_000),
            (Method::Adaptive, 100_000),
        ] {
            let mut apart = f32::INFINITY;
            run(&text, method, step_us, 600, |step, simulator| {
                let air = simulator.air(1).unwrap();
                let label = format!("{method:?}, {step_us} µs, {start_k} K, step {step}: {air:?}");
                assert!((start_k - 0.1..310.1f32).contains(&air.temperature_k), "{label}");
                apart = simulator.node_gauge_pa(1) - simulator.node_gauge_pa(0);
                // In the step in which it warms, or the stream turns, it cannot yet have given off what no longer fits.
                let coldest = if step == 0 { start_k } else { 293.0 };
                let bound = 1.1 * 101_325.0 * (310.0 / coldest - 1.0);
                assert!(apart.abs() < bound, "{label}");
            });
            assert!(apart.abs() < 60.0, "{method:?}, {step_us} µs, {start_k} K: {apart}");
        }
    }
}

/// A boundary of coolant has the density of the liquid that it feeds, not that of air at its pressure.
#[test]
fn coolant_from_a_boundary_flows_as_a_liquid() {
    let pipe = "kind = \"pipe\"\nloss_coefficient = 10.0\ndiameter_m = 0.01";
    let boundary = |id: &str, pressure_pa: f64| {
        format!(
            "[[node]]\nid = \"{id}\"\nkind = \"boundary\"\ncontents = \"coolant\"\n\
             pressure_pa = {pressure_pa:e}\ntemperature_k = 280.0\n"
        )
    };
    let liquid = "[[node]]\nid = \"l\"\nkind = \"liquid\"\nvolume_m3 = 0.01\ndensity_kg_m3 = 1000.0\n\
                  bulk_modulus_pa = 1e8\npressure_pa = 2e5\ntemperature_k = 280.0\n";
    let ends = [HEAD.to_owned(), boundary("in", 3e5), boundary("out", 1e5)].concat();
    let text = [ends.clone(), liquid.to_owned(), line("in", "l", pipe), line("l", "out", pipe)].concat();
    let mut flow = 0.0;
    run(&text, Method::ImplicitEuler, 10_000, 2_000, |_, simulator| flow = simulator.line_flow_kg_s(0));
    // Δp = ξ/(2·ρ·A²)·w², 100 000 Pa a pipe.
    let area = core::f64::consts::FRAC_PI_4 * 1e-4;
    let exact = (1e5 * 2.0 * 1_000.0 * area * area / 10.0).sqrt();
    assert!((f64::from(flow) / exact - 1.0).abs() < 1e-5, "{flow} against {exact}");
    // Between two boundaries nothing says what the liquid is.
    let error = parse(&[ends, line("in", "out", pipe)].concat(), "volumes.toml").unwrap_err();
    assert!(error.problems().iter().any(|problem| problem.reason.contains("boundary of coolant")), "{error}");
}

/// Oxygen that is taken out of a volume without supply ends the run when there is none left.
#[test]
fn what_is_not_there_cannot_be_taken_out() {
    let source = "[[source]]\nid = \"sink\"\nnode = \"a\"\noxygen = -1e-3\n";
    let pipe = line("a", "a", "kind = \"pipe\"\nresistance_pa_s2_kg2 = 100.0");
    let text = [HEAD.to_owned(), node("a", 0.5, 101_325.0, 295.15), pipe, source.to_owned()].concat();
    let oxygen_kg = 0.2095 * 101_325.0 * 0.5 / (8_314.463 / 31.998 * 295.15);
    let steps = trusted_steps(&text, Method::ImplicitEuler, 10_000, 20_000, |_, _| ());
    assert!((f64::from(steps) * 1e-5 / oxygen_kg - 1.0).abs() < 2e-3, "{steps} steps, {oxygen_kg} kg");
}

/// However fast a surface is, its water evaporates to saturation and not beyond.
#[test]
fn a_wet_volume_is_saturated_and_no_more() {
    let wet = format!("{}surface_kg_s_pa = 1e-2\n", node("a", 0.01, 101_325.0, 295.15));
    let source = "[[source]]\nid = \"tap\"\nnode = \"a\"\nliquid = 1e-6\n";
    let pipe = line("a", "a", "kind = \"pipe\"\nresistance_pa_s2_kg2 = 100.0");
    let text = [HEAD.to_owned(), wet, pipe, source.to_owned()].concat();
    let mut end = (0.0, 0.0);
    run(&text, Method::ImplicitEuler, 100_000, 6_000, |_, simulator| {
        let air = simulator.air(0).unwrap();
        assert!((-1e-6..1.0001).contains(&air.relative_humidity), "{air:?}");
        end = (air.relative_humidity, air.liquid_kg);
    });
    assert!(end.0 > 0.9999 && end.1 > 1e-4, "{end:?}");
}

/// Air that expands in a volume of which some leaves does work: p ∝ m^γ, T ∝ m^(γ−1).
#[test]
fn a_volume_that_blows_down_cools_isentropically() {
    let space = "[[node]]\nid = \"space\"\nkind = \"boundary\"\npressure_pa = 0.0\ntemperature_k = 290.0\n";
    let hole = line("a", "space", "kind = \"orifice\"\narea_m2 = 1e-4\ndischarge_coefficient = 0.6");
    let text = [HEAD.to_owned(), node("a", 1.0, 101_325.0, 295.15), space.to_owned(), hole].concat();
    let start_kg = 101_325.0 * 0.79 / 296.8 / 295.15 + 101_325.0 * 0.21 / 259.8 / 295.15;
    let gamma = 1.0 + 288.2 / 720.2;
    for method in [Method::Adaptive, Method::ImplicitEuler, Method::TrBdf2] {
        run(&text, method, 10_000, 3_000, |step, simulator| {
            let air = simulator.air(0).unwrap();
            let left = 1.0 + simulator.node_mass_kg(0) / start_kg;
            let exact = [101_325.0 * left.powf(gamma), 295.15 * left.powf(gamma - 1.0)];
            for (found, exact) in [air.pressure_pa, air.temperature_k].into_iter().zip(exact) {
                assert!(
                    (f64::from(found) / exact - 1.0).abs() < 2e-3,
                    "{method:?}, {step}: {found} {exact}, {left} left"
                );
            }
        });
    }
}
