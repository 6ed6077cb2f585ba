//! The same bits everywhere: after the paper's 26 s every method ends in the state that the host ends in, on every
//! emulated board, with the step specialised for the network or the general one.

use std::path::Path;

use crate::emulator::{MACHINES, measure, measure_day, run};
use eclss_core::components::Pipe;
use eclss_core::{Fingerprint, Health, Method, Network};
use eclss_network_file::Loaded;
use eclss_tests::product::with_simulator;

/// Steps of 1 ms that the scenario takes.
const STEPS: u64 = 26_000;

/// How a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct End {
    tick: u64,
    id: u64,
    state: u64,
    values: u64,
}

fn paper() -> Loaded {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../networks/paper.toml");
    let loaded = eclss_network_file::load(&path).expect("it ships");
    assert_eq!((loaded.run.step_us, loaded.run.until_us), (1_000, 1_000 * STEPS));
    loaded
}

/// Runs a network on this machine, to the end or to where it can no longer be trusted.
fn on_the_host(network: &Network<'_>, method: Method) -> End {
    with_simulator(network, method, 1_000, |simulator| {
        while simulator.tick() < STEPS && simulator.step() == Health::Trusted {}
        let mut values = Fingerprint::default();
        values.values(simulator.state());
        End {
            tick: simulator.tick(),
            id: simulator.network_id(),
            state: simulator.state_hash(),
            values: values.finish(),
        }
    })
    .expect("every method takes the paper's loop")
}

/// State and values as the firmware's log shows them.
fn shown(end: End) -> String {
    format!("state {:016x}, values {:016x}", end.state, end.values)
}

#[test]
fn every_method_ends_in_the_same_state_on_every_machine() {
    let paper = paper();
    let host = Method::ALL.map(|method| on_the_host(&paper.network(), method));
    for machine in MACHINES {
        let run = measure(machine, &["figures=all"]);
        assert!(run.status.success(), "{}", run.log.join("\n"));
        for (method, end) in Method::ALL.into_iter().zip(host) {
            for form in ["paper", "paper-loaded"] {
                let ended = run.after(&format!("run {form} {} ", method.name()));
                let expected =
                    [end.tick.to_string(), format!("{:016x}", end.id), format!("{:016x}", end.state)];
                assert_eq!(ended, expected, "{machine}: {form} {}", method.name());
            }
        }
    }
}

/// The day of temperature and humidity control, a thousand times as fast: crew, exercise, condensation, control and a
/// failed fan. `ECLSS_DAY_STEPS=360000` follows it for an hour of 10 ms steps.
#[test]
fn a_day_of_heat_moisture_and_control_ends_in_the_same_state_on_every_machine() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../networks/thcs.toml");
    let mut day = eclss_network_file::load(&path).expect("it ships");
    day.points.iter_mut().for_each(|point| point.time_us /= 1_000);
    let (method, step_us) = (day.run.method, day.run.step_us);
    let wanted = std::env::var("ECLSS_DAY_STEPS").ok().map(|steps| steps.parse().expect("a number of steps"));
    let steps = wanted.unwrap_or(day.run.until_us / 1_000 / u64::from(step_us));
    let (id, state, water) = with_simulator(&day.network(), method, step_us, |simulator| {
        while simulator.tick() < steps && simulator.step() == Health::Trusted {}
        let held = |name: &str| {
            let found = day.signals().into_iter().find(|signal| signal.name == name);
            simulator.signal(found.expect("it has a condenser").signal)
        };
        (simulator.network_id(), simulator.state_hash(), held("che.film") + held("che.separator"))
    })
    .expect("the method takes it");
    assert!(water > 1e-3, "nothing condensed: {water} kg");
    for machine in MACHINES {
        let run = measure_day(machine, &[&format!("steps={steps}")]);
        for form in ["thcs", "thcs-loaded"] {
            let ended = run.after(&format!("run {form} {} ", method.name()));
            assert_eq!(
                ended,
                [steps.to_string(), format!("{id:016x}"), format!("{state:016x}")],
                "{machine}: {form}"
            );
        }
    }
}

/// All but plain Euler reach the end: the comparison above is not one of runs that broke off at once.
#[test]
fn the_methods_reach_the_end_of_the_scenario() {
    let paper = paper();
    for method in Method::ALL {
        let end = on_the_host(&paper.network(), method);
        if method == Method::Euler {
            assert!((10_000..11_000).contains(&end.tick), "it diverges while the valve closes: {}", end.tick);
        } else {
            assert_eq!(end.tick, STEPS, "{}", method.name());
        }
    }
}

#[test]
fn the_firmware_of_a_board_ends_in_the_state_of_the_host() {
    let paper = paper();
    let end = on_the_host(&paper.network(), paper.run.method);
    for machine in MACHINES {
        let run = run(machine, &["seconds=26"]);
        run.line(&format!("network paper {:016x}", end.id));
        run.line(&shown(end));
        assert!(run.status.success());
    }
}

/// The smallest change of a parameter is seen in the values themselves, not only in the id.
#[test]
fn one_flipped_bit_of_a_parameter_changes_the_values() {
    let mut flipped = paper();
    let before = on_the_host(&flipped.network(), Method::Relaxation);
    let mut pipe = flipped.segments[0].element.get::<Pipe>().expect("the first is the intake");
    pipe.resistance_pa_s2_kg2 = f32::from_bits(pipe.resistance_pa_s2_kg2.to_bits() ^ 1);
    flipped.segments[0].element = pipe.into_any();
    let after = on_the_host(&flipped.network(), Method::Relaxation);
    assert!(before.id != after.id && before.values != after.values, "{before:?} {after:?}");
}
