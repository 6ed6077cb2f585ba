//! Heat, moisture and control in a file: what is refused and where, and how the shipped module behaves.

use crate::support::signal;
use std::fmt::Write as _;

use eclss_core::climate::monitor::{Limit, Monitor};
use eclss_core::{Buffers, Health, InputError, Settings, Simulator};
use eclss_network_file::{Loaded, parse};

const THCS: &str = include_str!("../../networks/thcs.toml");

/// The lines and reasons for which a file is refused in which `from` is replaced by `to`.
fn refusal(from: &str, to: &str) -> Vec<(usize, String)> {
    assert!(THCS.contains(from), "{from}");
    match parse(&THCS.replacen(from, to, 1), "thcs.toml") {
        Ok(_) => panic!("accepted with {to}"),
        Err(error) => error.problems().iter().map(|problem| (problem.line, problem.reason.clone())).collect(),
    }
}

#[test]
fn mistakes_are_named_at_their_place() {
    for (from, to, wanted) in [
        (
            "[air]\nreference_temperature_k = 295.15\ncoolant_expansion_1_k = 1.1e-4",
            "#",
            "this needs heat and moisture",
        ),
        ("oxygen_pa = 21200.0", "oxygen_pa = 121200.0", "partial pressures sum to more"),
        ("dew_point_k = 282.0", "dew_point_k = 282.0\nhumidity = 0.5", "unknown key `humidity`"),
        (
            "condenser = \"che\"",
            "condenser = \"cher\"",
            "there is no condenser or interface exchanger `cher`",
        ),
        (
            "measures = \"cabin.temperature\"",
            "measures = \"cabin.colour\"",
            "there is nothing `cabin.colour` to measure",
        ),
        (
            "drives = \"che_valve.opening\"",
            "drives = \"fan.speed\"",
            "follows a schedule, it cannot be driven",
        ),
        (
            "drives = \"gases.oxygen\"",
            "drives = \"gases.nitrogen\"",
            "drives what does not exist, or what something else",
        ),
        ("gain = -0.2", "gain = 0.0", "`gain` must not be 0"),
        ("part = \"carbon_dioxide\"", "part = \"carbon_monoxide\"", "is not a part that exists"),
        ("capacity_j_k = 1e6", "capacity_j_k = 1e-3", "`capacity_j_k` must be at least"),
        ("method = \"implicit-euler\"", "method = \"relaxation\"", "pseudo-time"),
        ("method = \"implicit-euler\"", "method = \"adaptive\"", "moves gas only"),
        ("from = \"warm\"", "from = \"cabin\"", "joins air and coolant"),
        ("node = \"cabin\"\ncount = 3.0", "node = \"warm\"\ncount = 3.0", "needs air"),
        (
            "activity\"\ninterpolation = \"hold\"\npoints = [[0.0, 0.0], [25200.0, 1.0]",
            "activity\"\ninterpolation = \"hold\"\npoints = [[0.0, 0.0], [25200.0, 9.0]",
            "`activity` must lie in 0 … 7",
        ),
        ("id = \"equipment\"", "id = \"cabin\"", "id `cabin` is taken already"),
        ("setpoint = 277.5 ", "", "`setpoint` is missing"),
        (
            "\"cold.temperature\"\nkind",
            "\"cold.total_pressure\"\nkind",
            "nothing `cold.total_pressure` to measure",
        ),
        ("dew_point_k = 282.0", "dew_point_k = 300.0", "dew point lies above"),
        ("from = \"warm\"", "density = \"follows\"\nfrom = \"warm\"", "laws of gases"),
        (
            "id = \"cold_plate\"\nkind = \"heater\"\nresistance_pa_s2_kg2 = 2000000.0\ninertance_per_m = 5000.0\npower = 500.0",
            "id = \"cold_plate\"\nkind = \"orifice\"\narea_m2 = 1e-5\ndischarge_coefficient = 0.6",
            "laws of gases",
        ),
        ("inner_w_k = 60.0", "inner_w_k = 9e7", "`inner_w_k` must be at most"),
    ] {
        let problems = refusal(from, to);
        let found = problems.iter().any(|(line, reason)| *line > 1 && reason.contains(wanted));
        assert!(found, "{to}: {problems:?}");
    }
}

/// Runs `body` on the module of `text`.
fn with_module<T>(text: &str, body: impl FnOnce(&Loaded, &mut Simulator<'_>) -> T) -> T {
    let loaded = parse(text, "thcs.toml").expect("the file is accepted");
    let network = loaded.network();
    let settings = Settings { method: loaded.run.method, step_us: loaded.run.step_us };
    let sizes = settings.method.sizes(&network);
    let (mut state, mut work) = (vec![0.0; sizes.state], vec![0.0; sizes.work]);
    let (mut inputs, mut cursors) = (vec![0.0; sizes.inputs], vec![0; sizes.cursors]);
    let buffers = Buffers { state: &mut state, work: &mut work, inputs: &mut inputs, cursors: &mut cursors };
    let mut simulator = Simulator::new(&network, settings, buffers).expect("the network is accepted");
    body(&loaded, &mut simulator)
}

fn slot(loaded: &Loaded, name: &str) -> usize {
    loaded.names.inputs.iter().position(|input| input == name).expect("the input exists")
}

const CABIN: usize = 0;

#[test]
fn half_an_hour_under_control_closes_its_ledgers() {
    with_module(THCS, |loaded, simulator| {
        let mut monitor = Monitor::default();
        for second in 0..1_800 {
            simulator.step_times(100);
            let broken = monitor.watch(&simulator.air(CABIN).unwrap(), 1.0);
            assert!(second < 60 || broken.is_none(), "{second} s: {broken:?}");
        }
        assert_eq!(simulator.health(), Health::Trusted);
        let air = simulator.air(CABIN).unwrap();
        assert!((air.temperature_k - 295.35).abs() < 1.0, "{air:?}");
        for ledger in simulator.ledgers() {
            let bar = if ledger.name == "energy" { 1e-5 } else { 1e-6 };
            assert!(ledger.gap().abs() <= bar * ledger.turned_over.max(1e-3), "{ledger:?}");
        }
        assert!((0..7).all(|node| simulator.storage_phi(node).unwrap() >= 1.0));
        // What the coolant brings from the coil it carries to the tank.
        let taken = signal(loaded, simulator, "che.coolant_heat");
        let rise = simulator.node_temperature_k(6) - simulator.node_temperature_k(5);
        let carried = simulator.line_flow_kg_s(6) * 4_186.0 * rise;
        assert!((carried / taken - 1.0).abs() < 0.05, "{carried} {taken}");
    });
}

/// Figures of the climate go out, set points and malfunctions come in.
#[test]
fn a_climate_is_bound_to_channels() {
    let mut text = THCS.to_owned();
    for (bind, min, max) in [
        ("cabin.temperature", 273.0, 323.0),
        ("cabin.dew_point", 253.0, 323.0),
        ("cabin.carbon_dioxide", 0.0, 5000.0),
        ("cabin.mixed", 0.0, 1.0),
        ("che.condensate", 0.0, 0.01),
        ("che.air_outlet", 273.0, 323.0),
    ] {
        let _ = write!(
            text,
            "\n[[channel]]\nbind = \"{bind}\"\ndirection = \"out\"\nmin = {min:?}\nmax = {max:?}\nsafe_value = {min:?}\n"
        );
    }
    for (bind, max, safe) in [
        ("cabin_temperature.setpoint", 300.0, 295.0),
        ("cabin_temperature.sensor_fault", 2.0, 0.0),
        ("che.separator_efficiency", 1.0, 1.0),
    ] {
        let _ = write!(
            text,
            "\n[[channel]]\nbind = \"{bind}\"\ndirection = \"in\"\nmin = 0.0\nmax = {max:?}\nsafe_value = {safe:?}\n"
        );
    }
    with_module(&text, |loaded, simulator| {
        simulator.step_times(3_000);
        let air = simulator.air(CABIN).unwrap();
        let condensate = signal(loaded, simulator, "che.condensate");
        let wanted = [
            air.temperature_k,
            air.dew_point_k,
            air.partial_pa[2],
            1.0,
            condensate,
            signal(loaded, simulator, "che.air_outlet"),
        ];
        let channels = loaded.process.output_channels();
        assert_eq!(channels.len(), wanted.len());
        for (channel, wanted) in channels.iter().zip(wanted) {
            assert_eq!(simulator.signal(channel.signal).to_bits(), wanted.to_bits(), "{:?}", channel.signal);
        }
        assert!(condensate > 0.0);
        for channel in loaded.process.input_channels() {
            assert!(simulator.live_input(channel.slot as usize).is_ok(), "{}", channel.slot);
        }
    });
}

/// The loop holds what it held: what its pressures have moved is what its temperatures have expanded.
#[test]
fn coolant_expands_into_its_accumulator() {
    let expanded = |text: &str| {
        with_module(text, |_, simulator| {
            simulator.step_times(30_000);
            let node = |index: usize, start_k: f32, start_kg: f32, capacity_kg_pa: f64| {
                let rise = f64::from(simulator.node_temperature_k(index) - start_k);
                let moved = (f64::from(simulator.node_gauge_pa(index)) - 1e5) * capacity_kg_pa;
                [moved, 1.1e-4 * (f64::from(start_kg) + simulator.node_mass_kg(index)) * rise]
            };
            let nodes =
                [node(4, 283.0, 10.0, 1e-4), node(5, 277.5, 5.0, 2.5e-8), node(6, 283.0, 5.0, 2.5e-8)];
            [0, 1].map(|column| nodes.iter().map(|node| node[column]).sum::<f64>())
        })
    };
    let [moved, expanded_kg] = expanded(THCS);
    assert!(expanded_kg.abs() > 1e-4, "{expanded_kg}");
    assert!((moved / expanded_kg - 1.0).abs() < 1e-2, "{moved} {expanded_kg}");
    let rigid = THCS.replace("coolant_expansion_1_k = 1.1e-4", "coolant_expansion_1_k = 0.0");
    let [moved, expanded_kg] = expanded(&rigid);
    assert!(moved.abs() < 1e-2 * expanded_kg.abs(), "{moved} {expanded_kg}");
}

#[test]
fn malfunctions_are_commanded_live_and_show() {
    let temperature_after = |commands: &[(&str, f32)]| {
        // The fan is free for commands where it has no schedule.
        let cut = THCS.rfind("[[schedule]]").unwrap();
        // Films that are soon full, so that water reaches the separator.
        let text = THCS[..cut]
            .replace("separator_efficiency = 0.99", "separator_efficiency = 0.99\nfilm_kg = 0.002");
        with_module(&text, |loaded, simulator| {
            simulator.step_times(6_000);
            for (name, value) in commands {
                simulator.set_input(slot(loaded, name), *value).unwrap();
            }
            simulator.step_times(60_000);
            assert_eq!(simulator.health(), Health::Trusted);
            let water = ["che.separator", "che.slug"].map(|name| signal(loaded, simulator, name));
            (simulator.air(CABIN).unwrap(), water)
        })
    };
    let (sound, _) = temperature_after(&[]);
    let (closed, _) = temperature_after(&[("cabin_temperature.actuator_fault", 3.0)]);
    let (open, _) = temperature_after(&[("cabin_temperature.actuator_fault", 2.0)]);
    assert!(
        closed.temperature_k > sound.temperature_k + 0.2 && open.temperature_k < sound.temperature_k - 0.5
    );
    // A sensor that has dropped out reads the bottom of its range: too cold, so the bypass opens.
    let (dropped, _) = temperature_after(&[("cabin_temperature.sensor_fault", 2.0)]);
    assert!(dropped.temperature_k > sound.temperature_k + 0.2);
    let (stopped, _) = temperature_after(&[("fan.speed", 0.0)]);
    assert!(!stopped.mixed && stopped.temperature_k > sound.temperature_k + 2.0);
    let (leaking, _) = temperature_after(&[("hole.opening", 0.5)]);
    assert!(leaking.pressure_pa < sound.pressure_pa - 500.0, "{leaking:?}");
    let (_, [lossy, lossy_slug]) = temperature_after(&[("che.separator_efficiency", 0.0)]);
    let (_, [good, good_slug]) = temperature_after(&[("che.separator_efficiency", 1.0)]);
    assert!(good > 0.005 && lossy < 0.5 * good, "{lossy} {good}");
    assert!(lossy_slug > good_slug);
}

#[test]
fn what_a_loop_drives_takes_no_commands() {
    with_module(THCS, |loaded, simulator| {
        let valve = slot(loaded, "che_valve.opening");
        assert_eq!(simulator.set_input(valve, 0.5), Err(InputError::Controlled));
        let count = slot(loaded, "crew.count");
        assert_eq!(simulator.set_input(count, -1.0), Err(InputError::OutOfRange { min: 0.0, max: 100.0 }));
        assert_eq!(simulator.set_input(count, 6.0), Ok(()));
    });
}

#[test]
fn a_checkpoint_of_a_climate_goes_on_to_the_same_bits() {
    with_module(THCS, |_, simulator| {
        simulator.step_times(500);
        let mut bytes = vec![0; simulator.checkpoint_bytes()];
        simulator.save(&mut bytes).unwrap();
        simulator.step_times(500);
        let hash = simulator.state_hash();
        simulator.restore(&bytes).unwrap();
        simulator.step_times(500);
        assert_eq!(simulator.state_hash(), hash);
    });
}

#[test]
fn limits_name_a_stopped_fan() {
    with_module(THCS, |_, simulator| {
        // Before the first step nothing has flowed yet.
        let broken = Monitor::default().watch(&simulator.air(CABIN).unwrap(), 1.0);
        assert!(broken.has(Limit::NotMixed));
    });
}

#[test]
fn sensors_have_noises_of_their_own_and_an_explicit_seed_wins() {
    let seeds = |text: &str| {
        let loaded = parse(text, "thcs.toml").expect("the file is accepted");
        loaded.climate.loops.iter().map(|control| control.sensor.seed).collect::<Vec<_>>()
    };
    let own = seeds(THCS);
    let mut sorted = own.clone();
    sorted.sort_unstable();
    sorted.dedup();
    assert!(own.len() > 2 && sorted.len() == own.len(), "{own:?}");
    assert_eq!(own, seeds(THCS), "the same in every reading");
    let given = seeds(&THCS.replacen("sensor_noise = 0.02", "sensor_noise = 0.02\nseed = 7", 1));
    assert_eq!((given[0], &given[1..]), (7, &own[1..]));
}
