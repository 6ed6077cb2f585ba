//! Hardware on the plant's volumes with delay: what `check --hil` says is what happens.

use std::fmt::Write as _;

use eclss_core::components::Measured;
use eclss_core::mode::Mode;
use eclss_core::process::{InputState, OutputState, Process};
use eclss_core::{Health, Method, Settings, Simulator};
use eclss_host_sim::{HostBuffers, coupling};
use eclss_network_file::{Loaded, parse};

const STEP_US: u32 = 1_000;

/// Two cabins and a boundary; hardware between the cabins and from the second to the boundary. `slopes` are how
/// strongly the two lines answer to pressure [kg/(s·Pa)].
fn network(slopes: &[f64], channel: &str) -> Loaded {
    let mut text = String::from(
        "schema = 1\nname = \"rig\"\nreference_pressure_pa = 101325.0\n\n[run]\nmethod = \"adaptive\"\n",
    );
    for (id, volume) in [("a", 0.012), ("b", 0.05)] {
        let _ = write!(
            text,
            "\n[[node]]\nid = \"{id}\"\nkind = \"cabin\"\nvolume_m3 = {volume}\npressure_pa = 101335.0\n\
             temperature_k = 295.15\n"
        );
    }
    text +=
        "\n[[node]]\nid = \"hold\"\nkind = \"boundary\"\npressure_pa = 101325.0\ntemperature_k = 295.15\n";
    let ends = [("a", "hold"), ("b", "a")];
    for ((from, to), slope) in ends.iter().zip(slopes) {
        let _ = write!(
            text,
            "\n[[line]]\nid = \"{from}_line\"\nfrom = \"{from}\"\nto = \"{to}\"\n\n[[line.element]]\nid = \
             \"rig_{from}\"\nkind = \"measured\"\nlargest_flow_kg_s = 10.0\nslope_kg_s_pa = {slope:e}\n"
        );
        let _ = write!(
            text,
            "\n[[channel]]\nbind = \"rig_{from}.measured_flow\"\ndirection = \"in\"\nsafe_value = 0.0\n\
             event_step = 100.0\nsafe_rate_per_s = 1e12\n{channel}\n"
        );
    }
    if slopes.len() == 1 {
        // The second cabin must hang on something; nothing drives it.
        text += "\n[[line]]\nid = \"idle\"\nfrom = \"b\"\nto = \"hold\"\n\n[[line.element]]\nid = \"duct\"\nkind \
                 = \"pipe\"\nresistance_pa_s2_kg2 = 4e4\n";
    }
    for node in ["a", "b"] {
        let _ = write!(
            text,
            "\n[[channel]]\nbind = \"{node}.pressure\"\ndirection = \"out\"\nmin = -1e4\nmax = 1e4\nsafe_value = \
             0.0\n"
        );
    }
    parse(&text, "rig.toml").unwrap_or_else(|error| panic!("{error}\n{text}"))
}

/// Jumps of every size: exactly those that are warned of lose the input.
#[test]
fn a_jump_is_lost_where_the_check_says_so() {
    let settings = Settings { method: Method::Adaptive, step_us: STEP_US };
    let mut lost = 0;
    for (max_rate_per_s, stale_ticks) in [(100.0, 10), (100.0, 30), (1_000.0, 10), (900.0, 9), (50.0, 300)] {
        let channel = format!(
            "max_rate_per_s = {max_rate_per_s:?}\nstale_ticks = {stale_ticks}\nmin = -5.0\nmax = 5.0"
        );
        let loaded = network(&[1e-9], &channel);
        let warnings = coupling::examine(&loaded, settings, 0).warnings;
        let warned = warnings.iter().any(|warning| warning.contains("a sudden change by more than"));
        let is_lost = loaded.process.with_image(|image| {
            let mut states = ([InputState::new(0.0)], [OutputState::new(0.0); 2]);
            let mut process = Process::new(image, 1e-3, &mut states.0, &mut states.1).unwrap();
            process.ingest(&[Some(-5.0)], Mode::Run.conduct());
            (0..1_000).any(|_| {
                process.ingest(&[Some(5.0)], Mode::Run.conduct());
                process.lost_input().is_some()
            })
        });
        assert_eq!(warned, is_lost, "{max_rate_per_s} per s, {stale_ticks} ticks: {warnings:?}");
        lost += u32::from(is_lost);
    }
    assert_eq!(lost, 3, "both kinds are among them");
}

/// Pressures of all nodes.
fn pressures(simulator: &Simulator<'_>) -> Vec<f32> {
    (0..simulator.network().nodes.len()).map(|node| simulator.node_gauge_pa(node)).collect()
}

/// Runs plant and hardware tick by tick; hardware answers to what it was given `extra` ticks before. Returns the
/// largest pressure of the cabins' first in the first and in the last tenth.
fn couple(loaded: &Loaded, method: Method, extra: u32) -> (f32, f32) {
    const TICKS: usize = 20_000;
    let network = loaded.network();
    let mut buffers = HostBuffers::default();
    let mut simulator = buffers.simulator(&network, Settings { method, step_us: STEP_US }).unwrap();
    loaded.process.with_image(|image| {
        let mut states = vec![InputState::new(0.0); image.inputs.len()];
        let mut outs = vec![eclss_core::process::OutputState::new(0.0); image.outputs.len()];
        let mut process = Process::new(image, 1e-3, &mut states, &mut outs).unwrap();
        let slots: Vec<_> =
            image.inputs.iter().map(|channel| simulator.live_input(channel.slot as usize).unwrap()).collect();
        // What hardware was given: the exchange itself takes a tick.
        let mut given = vec![pressures(&simulator); 2 + extra as usize];
        let (mut first, mut last) = (0.0f32, 0.0f32);
        for tick in 0..TICKS {
            let seen = given.remove(0);
            let flows: Vec<_> = loaded
                .lines
                .iter()
                .zip(&loaded.segments)
                .filter_map(|(line, segment)| {
                    segment.element.get::<Measured>().map(|rig| {
                        Some(rig.slope_kg_s_pa * (seen[line.from as usize] - seen[line.to as usize]))
                    })
                })
                .collect();
            process.ingest(&flows, Mode::Run.conduct());
            let applied: Vec<_> = process.applied().collect();
            for (input, (_, applied)) in slots.iter().zip(applied) {
                if simulator.set_live(input, applied.value, applied.slope_per_s).is_err() {
                    return (first, f32::INFINITY);
                }
            }
            if simulator.step() != Health::Trusted {
                return (first, f32::INFINITY);
            }
            given.push(pressures(&simulator));
            let size = simulator.node_gauge_pa(0).abs();
            if tick < TICKS / 10 {
                first = first.max(size);
            } else if tick >= TICKS - TICKS / 10 {
                last = last.max(size);
            }
        }
        (first, last)
    })
}

/// Just inside its margin a coupling comes to rest, just outside it diverges, with every method, delay, hold and
/// filter.
#[test]
fn the_margin_is_where_it_diverges() {
    let channels = ["", "hold = \"linear\"", "filter_s = 0.003"];
    for method in [Method::Adaptive, Method::ImplicitEuler, Method::TrBdf2] {
        for channel in channels {
            for extra in 0..3 {
                let settings = Settings { method, step_us: STEP_US };
                let gain_of_one =
                    coupling::examine(&network(&[1e-6], channel), settings, extra).pairs.remove(0);
                let edge = 1e-6 * gain_of_one.margin.unwrap();
                let mut ends = Vec::new();
                for part in [0.98, 1.02] {
                    let loaded = network(&[part * edge], channel);
                    let said = coupling::examine(&loaded, settings, extra);
                    let margin = said.pairs[0].margin.unwrap();
                    assert!((margin * part - 1.0).abs() < 1e-4, "{margin}");
                    assert_eq!(said.refusals.is_empty(), part < 1.0, "{:?}", said.refusals);
                    ends.push(couple(&loaded, method, extra));
                }
                let what = format!("{method:?} `{channel}` +{extra}: {ends:?}");
                assert!(ends[0].1 < 0.5 * ends[0].0, "inside: {what}");
                assert!(ends[1].1 > 10.0 * ends[1].0.min(1e3), "outside: {what}");
            }
        }
    }
}

/// Two lines, each well inside its own margin, can be outside of it together.
#[test]
fn lines_on_one_volume_are_judged_together() {
    let settings = Settings { method: Method::Adaptive, step_us: STEP_US };
    let unit = coupling::examine(&network(&[1e-6, 1e-6], ""), settings, 0);
    let edge = 1e-6 * unit.margin_together.unwrap();
    for (part, stable) in [(0.98, true), (1.02, false)] {
        let loaded = network(&[part * edge, part * edge], "");
        let said = coupling::examine(&loaded, settings, 0);
        assert!(said.pairs.iter().all(|pair| pair.margin.unwrap() > 1.0), "each by itself is stable");
        assert_eq!(said.refusals.is_empty(), stable);
        let (first, last) = couple(&loaded, Method::Adaptive, 0);
        assert_eq!(last < 0.5 * first, stable, "{part}: {first} {last}");
    }
}

/// The whole loop of the paper as hardware: the volumes that MODEL gives for delays of 1, 2 and 3 ticks.
#[test]
fn the_published_volumes_come_out() {
    // dw/dp = 1/(2·R·w) of ΣR = 4.0e4 at 86.5 g/s.
    let slope = 1.0 / (2.0 * 4.0e4 * 0.0865);
    let settings = Settings { method: Method::Adaptive, step_us: STEP_US };
    for (extra, volume_m3) in [(0, 0.012), (1, 0.020), (2, 0.027)] {
        // The first cabin of the rig has 0.012 m³.
        let margin = coupling::examine(&network(&[slope], ""), settings, extra).pairs[0].margin.unwrap();
        let smallest = 0.012 / margin;
        assert!((smallest - volume_m3).abs() < 6e-4, "{smallest}");
    }
}

#[test]
fn what_cannot_be_coupled_is_refused_by_name() {
    let loaded = network(&[1e-6], "");
    let settings = Settings { method: Method::Relaxation, step_us: STEP_US };
    let said = coupling::examine(&loaded, settings, 0);
    assert!(said.refusals.iter().any(|text| text.contains("relaxation")), "{:?}", said.refusals);
    assert_eq!(said.pairs[0].outputs, ["a.pressure"]);
}
