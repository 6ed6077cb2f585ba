//! The table of signals: one name, one reading, one unit for everything that a network publishes.

use std::collections::HashSet;
use std::fmt::Write as _;

use eclss_core::signal::{Display, Owner};
use eclss_core::{Method, Output, Settings, Signal, Simulator};
use eclss_network_file::{Loaded, parse};

const THCS: &str = include_str!("../../networks/thcs.toml");
const PAPER: &str = include_str!("../../networks/paper.toml");

/// Runs a network for `steps` and hands it over.
fn run<T>(
    loaded: &Loaded,
    method: Method,
    step_us: u32,
    steps: usize,
    take: impl FnOnce(&mut Simulator<'_>) -> T,
) -> T {
    let network = loaded.network();
    let sizes = method.sizes(&network);
    let (mut state, mut work) = (vec![0.0; sizes.state], vec![0.0; sizes.work]);
    let (mut inputs, mut cursors) = (vec![0.0; sizes.inputs], vec![0; sizes.cursors]);
    let buffers = eclss_core::Buffers {
        state: &mut state,
        work: &mut work,
        inputs: &mut inputs,
        cursors: &mut cursors,
    };
    let mut simulator = Simulator::new(&network, Settings { method, step_us }, buffers).unwrap();
    for _ in 0..steps {
        simulator.step();
    }
    take(&mut simulator)
}

#[test]
fn every_name_is_unique_and_every_listed_signal_exists() {
    for text in [THCS, PAPER, include_str!("files/zoo.toml")] {
        let loaded = parse(text, "file").unwrap();
        let network = loaded.network();
        let all = loaded.signals();
        let names: HashSet<_> = all.iter().map(|named| &named.name).collect();
        let signals: HashSet<_> = all.iter().map(|named| named.signal).collect();
        assert_eq!((names.len(), signals.len()), (all.len(), all.len()));
        for named in &all {
            assert!(network.publishes(named.signal), "{}", named.name);
            let Signal { output, owner, item } = named.signal;
            assert!(!network.publishes(Signal { owner: owner + 100_000, ..named.signal }), "{}", named.name);
            let items = if output == Output::Figure {
                network.climate.component_signals(owner as usize).count()
            } else {
                output.items()
            };
            let beyond = Signal { item: items as u16, ..named.signal };
            assert!(usize::from(item) < items && !network.publishes(beyond), "{}", named.name);
        }
    }
}

/// Read together, one by one, and in an order that tears the elements of lines apart: the same bits.
#[test]
fn signals_read_alike_together_and_alone() {
    let cases =
        [(PAPER, Method::ALL.to_vec(), 1_000), (THCS, vec![Method::ImplicitEuler, Method::TrBdf2], 10_000)];
    for (text, methods, step_us) in cases {
        let loaded = parse(text, "file").unwrap();
        for method in methods {
            run(&loaded, method, step_us, 300, |simulator| {
                let mut signals: Vec<Signal> = loaded.signals().iter().map(|named| named.signal).collect();
                for turn in 0..3 {
                    let mut values = vec![0.5; signals.len()];
                    simulator.read_signals(&signals, &mut values);
                    for (signal, value) in signals.iter().zip(values) {
                        let alone = simulator.signal(*signal);
                        assert_eq!(value.to_bits(), alone.to_bits(), "{method:?} {signal:?}");
                    }
                    // Backwards, then with a stride that is prime to the length.
                    signals.reverse();
                    if turn == 1 {
                        let length = signals.len();
                        let stride =
                            [7, 11, 13].into_iter().find(|stride| !length.is_multiple_of(*stride)).unwrap();
                        signals = (0..length).map(|k| signals[k * stride % length]).collect();
                    }
                }
                for nowhere in [Output::Pressure.of(999), Output::SegmentFlow.of(999), Output::Figure.of(999)]
                {
                    assert!(simulator.signal(nowhere).is_nan(), "{nowhere:?}");
                }
            });
        }
    }
}

/// Gauge, absolute and partial pressures of air agree with each other, and the dew point with the vapour.
#[test]
fn pressures_of_air_add_up() {
    let loaded = parse(THCS, "thcs.toml").unwrap();
    run(&loaded, Method::ImplicitEuler, 10_000, 2_000, |simulator| {
        let network = loaded.network();
        let mut rooms = 0;
        for node in 0..network.nodes.len() {
            let total = simulator.signal(Output::TotalPressure.of(node));
            if !network.publishes(Output::TotalPressure.of(node)) {
                assert!(network.publishes(Output::Temperature.of(node)), "coolant has a temperature");
                continue;
            }
            rooms += 1;
            let gauge = simulator.signal(Output::Pressure.of(node));
            assert!((total - loaded.reference_pa - gauge).abs() < 0.05, "{total} {gauge}");
            let parts = (0..Output::PartialPressure.items()).map(|k| Output::PartialPressure.item(node, k));
            let sum: f32 = parts.map(|part| simulator.signal(part)).sum();
            assert!((sum - total).abs() <= 1e-6 * total, "{sum} {total}");
            let vapour = simulator.signal(Output::PartialPressure.item(node, 3));
            let dew_point = simulator.signal(Output::DewPoint.of(node));
            let saturated = eclss_core::moist::saturation_pressure_pa(dew_point);
            // Space is dry.
            assert!(total < 1.0 || (saturated / vapour - 1.0).abs() < 1e-3, "{saturated} {vapour}");
        }
        assert!(rooms > 3, "{rooms}");
    });
}

/// Volume flow times the density that partial pressures and temperature give is the mass flow; coolant has none.
#[test]
fn volume_flow_is_mass_flow_over_the_density_where_it_comes_from() {
    let loaded = parse(THCS, "thcs.toml").unwrap();
    let network = loaded.network();
    run(&loaded, Method::ImplicitEuler, 10_000, 2_000, |simulator| {
        let mut gas = 0;
        for (index, line) in network.lines.iter().enumerate() {
            let coolant = !network.publishes(Output::TotalPressure.of(line.from as usize));
            assert_eq!(
                network.publishes(Output::VolumeFlow.of(index)),
                !coolant,
                "{}",
                loaded.names.lines[index]
            );
            let flow = simulator.signal(Output::MassFlow.of(index));
            if coolant || flow.abs() < 1e-9 {
                continue;
            }
            gas += 1;
            let node = if flow > 0.0 { line.from } else { line.to } as usize;
            let kelvin = f64::from(simulator.signal(Output::Temperature.of(node)));
            let molar = [28.013_4, 31.998, 44.009, 18.015, 28.965];
            let parts = molar.iter().enumerate().map(|(part, molar)| {
                let partial = simulator.signal(Output::PartialPressure.item(node, part));
                f64::from(partial) * molar / (8_314.463 * kelvin)
            });
            let volume = f64::from(simulator.signal(Output::VolumeFlow.of(index)));
            assert!((volume * parts.sum::<f64>() / f64::from(flow) - 1.0).abs() < 1e-5, "{volume} {flow}");
        }
        assert!(gas > 3, "{gas}");
    });
    // The paper's loop at rest: 86.4776 g/s of dry air of 295.15 K and 101 325 Pa are 72.31 l/s.
    let loaded = parse(PAPER, "paper.toml").unwrap();
    run(&loaded, Method::Relaxation, 1_000, 9_000, |simulator| {
        let volume = simulator.signal(Output::VolumeFlow.of(0));
        let density = 101_325.0 / (287.05 * loaded.nodes[0].temperature_k);
        assert!((volume * density - 0.086_477_6).abs() < 2e-6, "{volume}");
    });
}

/// A gap is what the ledger of its name lacks, in its unit.
#[test]
fn gaps_are_those_of_the_ledgers() {
    let loaded = parse(THCS, "thcs.toml").unwrap();
    let all = loaded.signals();
    run(&loaded, Method::ImplicitEuler, 10_000, 1_000, |simulator| {
        for ledger in simulator.ledgers() {
            let name = format!("{}_gap", ledger.name);
            let named = all.iter().find(|named| named.name == name).unwrap();
            let gap = (ledger.held - ledger.supplied) as f32;
            assert_eq!(
                (simulator.signal(named.signal).to_bits(), named.spec.unit()),
                (gap.to_bits(), ledger.unit)
            );
        }
    });
}

/// A sensor without lag, noise and fault reads the signal that it is bound to, in the unit of that signal.
#[test]
fn a_control_reads_the_signal_that_it_measures() {
    let loaded = parse(THCS, "thcs.toml").unwrap();
    let network = loaded.network();
    let all = loaded.signals();
    run(&loaded, Method::ImplicitEuler, 10_000, 500, |simulator| {
        let mut exact = 0;
        for (index, control) in network.climate.loops.iter().enumerate() {
            let named = all.iter().find(|named| named.signal == Output::Reading.of(index)).unwrap();
            assert_eq!(named.spec.display, control.measures.spec().display);
            assert_eq!(named.owner(), loaded.file.controls[index].id);
            if control.sensor.lag_s == 0.0 && control.sensor.noise == 0.0 {
                let seen = simulator.signal(control.measures);
                simulator.step();
                let read = simulator.signal(Output::Reading.of(index));
                assert_eq!(read.to_bits(), seen.to_bits(), "{}", named.name);
                exact += 1;
            }
        }
        assert!(exact > 0);
    });
    // Its set point and its bias are in that unit too.
    let of = |name: &str| all.iter().find(|named| named.name == name).unwrap().spec.display;
    assert_eq!(of("cabin_temperature.setpoint"), Display::Temperature);
    assert_eq!(of("cabin_temperature.sensor_bias"), Display::TemperatureDifference);
}

/// A sensor may look at everything that volumes and exchangers publish.
#[test]
fn sensors_and_channels_take_what_the_table_has() {
    let loaded = parse(THCS, "thcs.toml").unwrap();
    let measured = loaded.signals().into_iter().filter(|named| named.signal.is_measurable());
    for named in measured {
        let text = THCS.replace("\"cabin.total_pressure\"", &format!("{:?}", named.name));
        assert!(text.contains(&format!("measures = {:?}", named.name)));
        let loaded = parse(&text, "thcs.toml").unwrap();
        assert!(
            loaded.climate.loops.iter().any(|control| control.measures == named.signal),
            "{}",
            named.name
        );
    }
    let channels: Vec<_> =
        loaded.signals().into_iter().filter(|named| named.signal.output.owner() != Owner::Input).collect();
    for part in channels.chunks(64) {
        let mut text = THCS.to_owned();
        for named in part {
            let _ = write!(
                text,
                "\n[[channel]]\nbind = {:?}\ndirection = \"out\"\nmin = 0.0\nmax = 1.0\nsafe_value = 0.0\n",
                named.name
            );
        }
        let outputs = parse(&text, "thcs.toml").unwrap().process.outputs;
        assert!(
            outputs.iter().map(|output| output.channel().signal).eq(part.iter().map(|named| named.signal))
        );
    }
}
