//! Leaks, openings, check and relief valves, regulators and hatches in networks, against closed solutions.

use eclss_core::{Health, Method, Settings, Simulator};
use eclss_network_file::{Loaded, parse};

/// Methods that take lines whose laws respond.
const METHODS: [Method; 3] = [Method::Adaptive, Method::ImplicitEuler, Method::TrBdf2];

const GAS: f64 = 287.05 * 295.15;

fn node(id: &str, volume_m3: Option<f64>, pressure_pa: f64) -> String {
    let kind = volume_m3.map_or("kind = \"boundary\"".to_owned(), |volume_m3| {
        format!("kind = \"cabin\"\nvolume_m3 = {volume_m3:?}")
    });
    format!("[[node]]\nid = \"{id}\"\n{kind}\npressure_pa = {pressure_pa:?}\ntemperature_k = 295.15\n")
}

fn line(id: &str, from: &str, to: &str, more: &str) -> String {
    format!("[[line]]\nid = \"{id}\"\nfrom = \"{from}\"\nto = \"{to}\"\n{more}\n")
}

fn element(id: &str, kind: &str, more: &str) -> String {
    format!("[[line.element]]\nid = \"{id}\"\nkind = \"{kind}\"\n{more}\n")
}

fn loaded(parts: &[String]) -> Loaded {
    let head =
        "schema = 1\nname = \"openings\"\nreference_pressure_pa = 101325.0\n[run]\nmethod = \"adaptive\"\n";
    let text = format!("{head}{}", parts.concat());
    parse(&text, "openings.toml").unwrap_or_else(|error| panic!("{error}\n{text}"))
}

/// Runs `loaded` with its inputs at `inputs`, calling `each` after every step with the simulator and the time [s], for
/// as long as it says so.
fn run(loaded: &Loaded, method: Method, step_us: u32, mut each: impl FnMut(&mut Simulator<'_>, f64) -> bool) {
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
    let mut simulator = Simulator::new(&network, Settings { method, step_us }, buffers).expect("accepted");
    loop {
        assert_eq!(simulator.step(), Health::Trusted, "{} at {step_us} µs", method.name());
        let time_s = simulator.time_us() as f64 * 1e-6;
        if !each(&mut simulator, time_s) {
            return;
        }
    }
}

fn gauge(simulator: &Simulator<'_>, node: usize) -> f64 {
    f64::from(simulator.node_gauge_pa(node))
}

/// Flow [kg/s] of the isentropic formula, as in the textbook.
fn isentropic(area: f64, high: f64, low: f64) -> f64 {
    let gamma = 1.4f64;
    let r = (low / high).max((2.0 / (gamma + 1.0)).powf(gamma / (gamma - 1.0)));
    let fall = r.powf(2.0 / gamma) - r.powf((gamma + 1.0) / gamma);
    area * high / GAS.sqrt() * (2.0 * gamma / (gamma - 1.0) * fall).sqrt()
}

#[test]
fn a_cabin_blows_down_to_a_vacuum_along_the_exponential() {
    let hole = element("hole", "orifice", "discharge_coefficient = 0.8\narea_m2 = 0.001");
    let loaded = loaded(&[
        node("cabin", Some(2.0), 101_325.0),
        node("space", None, 0.0),
        line(
            "leak",
            "cabin",
            "space",
            &format!("initial_flow_kg_s = {:?}", isentropic(8e-4, 101_325.0, 0.0)),
        ),
        hole,
    ]);
    // Choked all the way: w = K·p, dp/dt = −(Rg·T/V)·K·p.
    let rate = isentropic(8e-4, 1.0, 0.0) * GAS / 2.0;
    for method in METHODS {
        // h·rate·e^−1/2 is what first order leaves: 1.5e-5 at 1 ms; second order is left with single precision.
        let second = method == Method::TrBdf2;
        for (step_us, most) in [(1_000, 2e-5), (10_000, 2e-4), (100_000, 2e-3)] {
            let most = if second { 2e-6 } else { most };
            let mut worst = 0.0f64;
            run(&loaded, method, step_us, |simulator, time_s| {
                let exact = 101_325.0 * (-rate * time_s).exp();
                let found = 101_325.0 + gauge(simulator, 0);
                worst = worst.max((found - exact).abs() / 101_325.0);
                // What left the cabin is what the vacuum received, to the last transfer.
                let received = simulator.node_mass_kg(1);
                assert!((simulator.node_mass_kg(0) + simulator.fictitious_kg(0) + received).abs() < 1e-7);
                assert!(found >= 0.0, "{found} Pa");
                time_s < 60.0
            });
            println!("blow-down, {}, {step_us} µs: {worst:.1e}", method.name());
            assert!(worst < most, "{}, {step_us} µs: {worst:e}", method.name());
        }
    }
}

#[test]
fn two_cabins_share_through_a_subsonic_orifice_and_stand_still() {
    let loaded = loaded(&[
        node("full", Some(3.0), 140_000.0),
        node("empty", Some(1.0), 20_000.0),
        line("between", "full", "empty", ""),
        element("hole", "orifice", "discharge_coefficient = 0.6\narea_m2 = 0.002"),
    ]);
    for method in METHODS {
        let mut last = 0.0;
        run(&loaded, method, 10_000, |simulator, time_s| {
            let (full, empty) = (gauge(simulator, 0), gauge(simulator, 1));
            // Between steps the flow is that of the formula at the pressures of the step's start or end.
            assert!(full - empty >= -0.1, "{}: {full}, {empty}", method.name());
            last = full;
            time_s < 60.0
        });
        // (3·140 + 1·20)/4 kPa.
        assert!((last + 101_325.0 - 110_000.0).abs() < 1.0, "{}: {last}", method.name());
    }
}

#[test]
fn flow_through_an_orifice_between_held_pressures_is_the_formula() {
    for (high, low) in
        [(101_325.0, 0.0), (101_325.0, 50_000.0), (101_325.0, 90_000.0), (2e6, 101_325.0), (5e3, 4e3)]
    {
        let loaded = loaded(&[
            node("one", None, high),
            node("other", None, low),
            line("out", "one", "other", ""),
            element("hole", "orifice", "discharge_coefficient = 1.0\narea_m2 = 1e-4\ninertance_per_m = 0.0"),
            line("back", "other", "one", "reference_density_kg_m3 = 1.0"),
            element("hole_2", "orifice", "discharge_coefficient = 0.5\narea_m2 = 2e-4"),
        ]);
        let exact = isentropic(1e-4, high, low);
        for method in METHODS {
            run(&loaded, method, 10_000, |simulator, time_s| {
                time_s < 1.0 || {
                    for (line, exact) in [(0, exact), (1, -exact)] {
                        let found = f64::from(simulator.line_flow_kg_s(line));
                        assert!((found / exact - 1.0).abs() < 2e-6, "{}: {found}, {exact}", method.name());
                    }
                    false
                }
            });
        }
    }
}

#[test]
fn a_measured_leak_leaks_as_measured() {
    // The station in 2011: 0.227 kg/d.
    let loaded = loaded(&[
        node("station", Some(400.0), 101_325.0),
        node("space", None, 0.0),
        line("hull", "station", "space", ""),
        element("leak", "leak", "leak_kg_d = 0.227\npressure_drop_pa = 101325.0"),
    ]);
    for method in METHODS {
        run(&loaded, method, 100_000, |simulator, time_s| {
            time_s < 3_600.0 || {
                let lost = -simulator.node_mass_kg(0) * 24.0;
                assert!((lost / 0.227 - 1.0).abs() < 1e-4, "{}: {lost} kg/d", method.name());
                false
            }
        });
    }
}

/// A day of a cabin of 60 m³ behind `element` to a vacuum; mass that it lost [kg].
fn lost_in_a_day(method: Method, kind: &str, more: &str) -> f64 {
    let loaded = loaded(&[
        node("cabin", Some(60.0), 101_325.0),
        node("space", None, 0.0),
        line("out", "cabin", "space", "reference_density_kg_m3 = 1.2"),
        element("closed", kind, more),
    ]);
    let mut lost = f64::NAN;
    run(&loaded, method, 60_000_000, |simulator, time_s| {
        lost = -simulator.node_mass_kg(0) - simulator.fictitious_kg(0);
        time_s < 86_400.0
    });
    lost
}

#[test]
fn closed_valves_are_tight_unless_their_seat_leaks() {
    let area = "discharge_coefficient = 0.8\ndiameter_m = 0.05";
    let relief = "crack_pa = 104000.0\nreseat_pa = 103000.0";
    let shut = "set_point_pa = 1.0\nband_pa = 0.5\nlag_s = 1.0";
    let (valve, hatch) = (
        "open_resistance_pa_s2_kg2 = 100.0\nexponent = 3.0\nopening = 0.0",
        "loss_coefficient = 2.7\narea_m2 = 0.8\nopening = 0.0",
    );
    let shutting = "discharge_coefficient = 0.8\narea_m2 = 0.01\nopening = 0.0";
    let seat = "seat_leak_kg_d = 0.1\nseat_leak_pressure_pa = 101325.0";
    for (kind, more) in [
        ("relief_valve", format!("{relief}\n{area}")),
        ("relief_valve", format!("{relief}\nresistance_pa_s2_kg2 = 1e5")),
        ("valve", valve.to_owned()),
        ("hatch", hatch.to_owned()),
        ("orifice", shutting.to_owned()),
        ("measured", "largest_flow_kg_s = 0.2\nslope_kg_s_pa = 1e-3".to_owned()),
    ] {
        for method in METHODS {
            let lost = lost_in_a_day(method, kind, &more);
            assert!((0.0..1e-6).contains(&lost), "{kind}, {}: {lost:e} kg in a day", method.name());
            if !["orifice", "measured"].contains(&kind) {
                // The pressure hardly falls: 0.1 kg of 72.
                let lost = lost_in_a_day(method, kind, &format!("{more}\n{seat}"));
                assert!((lost / 0.1 - 1.0).abs() < 2e-3, "{kind}, {}: {lost} kg in a day", method.name());
            }
        }
    }
    // A regulator whose outlet is above its set point, between a bottle and a cabin.
    for (seat, leak) in [("", 0.0), ("seat_leak_kg_d = 0.1\nseat_leak_pressure_pa = 500000.0", 0.1)] {
        let loaded = loaded(&[
            node("bottle", None, 1e6),
            node("cabin", Some(60.0), 101_325.0),
            line("feed", "bottle", "cabin", ""),
            element(
                "closed",
                "pressure_regulator",
                &format!("{area}\n{shut}\n{seat}").replace("= 1.0\nband", "= 90000.0\nband"),
            ),
        ]);
        run(&loaded, Method::ImplicitEuler, 60_000_000, |simulator, time_s| {
            let gained = simulator.node_mass_kg(1);
            time_s < 86_400.0 || {
                // Choked in the measurement as in the cabin.
                assert!((gained - leak).abs() < 2e-3 * leak + 1e-6, "{gained} kg in a day");
                false
            }
        });
    }
}

/// A fan that starts and stops against 200 Pa, with a check valve; `column` is the inertance of the duct.
fn fan_and_check_valve(column: &str) -> Loaded {
    let fan = "shutoff_pa = 500.0\nquadratic_pa_s2_kg2 = 2e3";
    loaded(&[
        node("low", Some(50.0), 101_325.0),
        node("high", None, 101_525.0),
        line("duct", "low", "high", ""),
        element("fan", "fan", &format!("{fan}\n{column}")),
        element(
            "check",
            "check_valve",
            &format!(
                "resistance_pa_s2_kg2 = 1e3\nreverse_leak_kg_s = 1e-6\nreverse_pressure_pa = 1e3\n{column}"
            ),
        ),
        element("pipe", "pipe", &format!("resistance_pa_s2_kg2 = 4e3\n{column}")),
        line("fill", "high", "low", ""),
        element("grille", "pipe", "resistance_pa_s2_kg2 = 5e4"),
        "[[schedule]]\ninput = \"fan.speed\"\ninterpolation = \"hold\"\n\
         points = [[0.0, 0.0], [1.0, 1.0], [2.0, 0.0], [3.03, 1.0], [4.0, 0.2], [5.0, 1.0]]\n"
            .to_owned(),
    ])
}

#[test]
fn a_check_valve_passes_no_reverse_flow_but_its_leak() {
    for column in
        ["", "length_m = 3.0\ndiameter_m = 0.1\noutlet_volume_m3 = 0.0", "length_m = 1.0\ndiameter_m = 0.1"]
    {
        let loaded = fan_and_check_valve(column);
        for method in METHODS {
            for step_us in [100, 1_000, 10_000, 100_000] {
                let (mut most, mut worst, mut given) = (0.0f64, 0.0f64, 0.0f64);
                let mut difference = 500.0f64;
                run(&loaded, method, step_us, |simulator, time_s| {
                    // Its own flow: beyond a volume the duct may well ring backward.
                    let w = f64::from(simulator.segment_flow_kg_s(0, 1));
                    // Where the duct rings the valve sees more than its line's ends do: all that the fan can make.
                    let before = difference;
                    difference = gauge(simulator, 1) - gauge(simulator, 0);
                    let seen = before.max(difference) + if column.is_empty() { 0.0 } else { 1_000.0 };
                    // A flow of 0.2 kg/s that stops within one step leaves its rounding.
                    worst = worst.max((-w - 1e-8) / (seen / 1e9));
                    most = most.max(w);
                    given = simulator.line_sums_kg(0)[1];
                    time_s < 6.0
                });
                println!("check valve, {} {step_us} µs: {worst:.3} of its leak", method.name());
                assert!(worst < 1.001, "{} {step_us} µs, {column}: {worst} times its leak", method.name());
                // 7e3 Pa·s²/kg² under 300 Pa and more.
                assert!(most > 0.18, "{} {step_us} µs: {most}", method.name());
                assert!(given > 0.3, "{} {step_us} µs: {given}", method.name());
            }
        }
    }
}

#[test]
fn a_relief_valve_cycles_between_its_two_pressures_and_never_chatters() {
    // 2 g/s come in, choked; open, the valve lets far more out.
    let inflow = isentropic(1e-6, 1e6, 1.01e5);
    let loaded = loaded(&[
        node("bottle", None, 1e6),
        node("cabin", Some(20.0), 104_000.0),
        node("outside", None, 101_325.0),
        line("feed", "bottle", "cabin", ""),
        element("hole", "orifice", "discharge_coefficient = 1.0\narea_m2 = 1e-6"),
        line("vent", "cabin", "outside", ""),
        element(
            "relief",
            "relief_valve",
            "crack_pa = 3000.0\nreseat_pa = 2500.0\nresistance_pa_s2_kg2 = 4e6\nleakage_opening = 1e-3",
        ),
    ]);
    let c = GAS / 20.0;
    // From 2500 to 3000 Pa with the valve closed.
    let filling = 500.0 / (c * inflow);
    for method in METHODS {
        for step_us in [1_000, 10_000, 100_000] {
            let mut opened: Vec<f64> = Vec::new();
            let mut closed: Vec<f64> = Vec::new();
            let mut was_open = false;
            run(&loaded, method, step_us, |simulator, time_s| {
                let pressure = gauge(simulator, 1);
                let open = simulator.line_flow_kg_s(1) > 1e-3;
                if open != was_open {
                    if open { opened.push(time_s) } else { closed.push(time_s) }
                }
                was_open = open;
                // A step's worth of in- and outflow beyond the two pressures.
                let h = f64::from(step_us) * 1e-6;
                let step_pa = h * c * 0.03 + 0.1;
                assert!(pressure <= 3_000.0 + step_pa, "{}: {pressure}", method.name());
                assert!(opened.is_empty() || pressure >= 2_500.0 - step_pa, "{}: {pressure}", method.name());
                time_s < 400.0
            });
            assert!(opened.len() >= 5, "{}: {opened:?}", method.name());
            for (closed, opened) in closed.iter().zip(&opened[1..]) {
                let took = opened - closed;
                assert!((took / filling - 1.0).abs() < 0.05, "{}: {took} s, not {filling}", method.name());
            }
        }
    }
}

#[test]
fn a_regulator_holds_its_band_while_its_bottle_empties() {
    let loaded = loaded(&[
        node("bottle", Some(0.05), 3e6),
        node("cabin", Some(5.0), 100_000.0),
        node("space", None, 0.0),
        line("feed", "bottle", "cabin", ""),
        element(
            "regulator",
            "pressure_regulator",
            "discharge_coefficient = 0.8\narea_m2 = 2e-6\nset_point_pa = 101000.0\nband_pa = 400.0\nlag_s = 0.2",
        ),
        line("leak", "cabin", "space", ""),
        element("hole", "orifice", "discharge_coefficient = 1.0\narea_m2 = 4e-6"),
    ]);
    for method in METHODS {
        for (step_us, until_s) in [(100, 150.0), (1_000, 400.0), (10_000, 400.0), (100_000, 400.0)] {
            let (mut low, mut high, mut turns) = (f64::MAX, f64::MIN, 0);
            let (mut last, mut falling) = (0.0f64, false);
            let mut bottle = 0.0;
            run(&loaded, method, step_us, |simulator, time_s| {
                let pressure = 101_325.0 + gauge(simulator, 1);
                bottle = 101_325.0 + gauge(simulator, 0);
                if time_s > 60.0 {
                    (low, high) = (low.min(pressure), high.max(pressure));
                    // Turns of the pressure that are more than rounding: a chattering valve makes one a step.
                    let moved = pressure - last;
                    if moved.abs() > 0.05 && (moved < 0.0) != falling {
                        turns += 1;
                        falling = moved < 0.0;
                    }
                    if moved.abs() > 0.05 {
                        last = pressure;
                    }
                }
                time_s < until_s
            });
            println!(
                "regulator, {}, {step_us} µs: {low:.0} … {high:.0} Pa, bottle {bottle:.0} Pa",
                method.name()
            );
            assert!(low >= 100_600.0 && high <= 101_000.0, "{} {step_us} µs: {low} … {high}", method.name());
            assert!(turns <= 4, "{} {step_us} µs: {turns} turns", method.name());
        }
    }
}

#[test]
fn a_hatch_that_opens_equalises_two_cabins() {
    let loaded = loaded(&[
        node("lab", Some(60.0), 102_325.0),
        node("node_1", Some(40.0), 101_325.0),
        line("passage", "lab", "node_1", ""),
        element("hatch", "hatch", "loss_coefficient = 2.7\narea_m2 = 0.8\nleakage_opening = 1e-5"),
        "[[schedule]]\ninput = \"hatch.opening\"\ninterpolation = \"hold\"\npoints = [[0.0, 0.0], [10.0, 1.0]]\n"
            .to_owned(),
    ]);
    for method in METHODS {
        let mut closed = 0.0;
        let (mut ends, mut lost) = ([0.0; 2], 0.0f64);
        run(&loaded, method, 10_000, |simulator, time_s| {
            if time_s < 0.205 {
                closed = f64::from(simulator.line_flow_kg_s(0));
            }
            ends = [gauge(simulator, 0), gauge(simulator, 1)];
            let stored: f64 =
                (0..2).map(|node| simulator.node_mass_kg(node) + simulator.fictitious_kg(node)).sum();
            lost = lost.max(stored.abs());
            time_s < 60.0
        });
        // 1e-5 of the area, 1000 Pa: √(2·ρ·Δp/ξ)·A.
        let open = 0.8 * (2.0 * 102_325.0 / GAS * 1_000.0 / 2.7).sqrt();
        assert!((closed / (1e-5 * open) - 1.0).abs() < 1e-3, "{}: {closed}", method.name());
        assert!(lost < 1e-6, "{}: {lost} kg", method.name());
        // (60·1000 + 40·0)/100 Pa; slowed nodes of `adaptive` share otherwise.
        let exact = if method == Method::Adaptive { f64::NAN } else { 600.0 };
        assert!((ends[0] - ends[1]).abs() < 0.05, "{}: {ends:?}", method.name());
        assert!(exact.is_nan() || (ends[0] - exact).abs() < 0.05, "{}: {ends:?}", method.name());
    }
}

#[test]
fn where_density_follows_a_fan_moves_volume() {
    let fan = "h0_m = 25.0\nh2_s2_m5 = 900.0";
    let parts = |density: &str| {
        loaded(&[
            node("cabin", Some(10.0), 101_325.0),
            node("space", None, 0.0),
            line("loop", "cabin", "cabin", density),
            element("fan", "fan", fan),
            element("filter", "pipe", "loss_coefficient = 3.0\ndiameter_m = 0.1"),
            line("leak", "cabin", "space", ""),
            element("hole", "orifice", "discharge_coefficient = 1.0\narea_m2 = 1e-3"),
        ])
    };
    let area = std::f64::consts::FRAC_PI_4 * 0.01;
    // ρ·g·(h0 − h2·Q²) = ξ·ρ/2·(Q/A)²: the volume flow does not depend on density.
    let volume_flow = (9.806 * 25.0 / (9.806 * 900.0 + 1.5 / (area * area))).sqrt();
    for method in METHODS {
        let mut worst = 0.0f64;
        run(&parts("density = \"follows\""), method, 10_000, |simulator, time_s| {
            let density = (101_325.0 + gauge(simulator, 0)) / GAS;
            let exact = density * volume_flow;
            // A step's flow is that of the density of its start: 10 ms against the 41 s of the blow-down.
            if time_s > 1.0 {
                worst = worst.max((f64::from(simulator.line_flow_kg_s(0)) / exact - 1.0).abs());
            }
            time_s < 60.0
        });
        println!("density, {}: {worst:.1e}", method.name());
        assert!(worst < 5e-4, "{}: {worst:e}", method.name());
        let mut flow = 0.0;
        run(&parts("density = \"fixed\""), method, 10_000, |simulator, time_s| {
            flow = f64::from(simulator.line_flow_kg_s(0));
            time_s < 60.0
        });
        assert!((flow / (101_325.0 / GAS * volume_flow) - 1.0).abs() < 1e-5, "fixed: {flow}");
    }
}

#[test]
fn the_papers_methods_refuse_what_responds() {
    let loaded = fan_and_check_valve("");
    for method in [Method::Euler, Method::Relaxation] {
        let refused = method.check(&loaded.network(), 1_000);
        assert_eq!(refused, Err(eclss_core::MethodError::Responsive(0)), "{}", method.name());
    }
    let two = self::loaded(&[
        node("one", Some(1.0), 101_325.0),
        node("other", None, 0.0),
        line("leak", "one", "other", ""),
        element("hole", "orifice", "discharge_coefficient = 1.0\narea_m2 = 1e-6"),
        line("seal", "one", "other", "density = \"follows\""),
        element("pipe", "pipe", "resistance_pa_s2_kg2 = 1e9"),
    ]);
    assert_eq!(two.responsive.len(), 2);
    assert_eq!(Method::Relaxation.check(&two.network(), 1_000), Err(eclss_core::MethodError::Responsive(0)));
}
