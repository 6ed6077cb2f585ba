//! The first steps of the implicit methods from any start: pressures stay between those that drive them, and a volume that
//! empties through a valve does not pass what it empties into.

use std::fmt::Write;

use crate::support::with_network;
use eclss_core::Health;

/// A file of nodes and lines that starts like this.
fn head(method: &str, step: &str) -> String {
    format!(
        "schema = 1\nname = \"first\"\nreference_pressure_pa = 101325.0\n[run]\nmethod = \"{method}\"\nstep = \"{step}\"\n"
    )
}

const PLENUM: &str = r#"
[[node]]
id = "plenum"
kind = "cabin"
volume_m3 = VOLUME
pressure_pa = PRESSURE
temperature_k = 295.0
[[node]]
id = "cabin"
kind = "boundary"
pressure_pa = OUTSIDE
temperature_k = 295.0
[[line]]
id = "out"
from = "plenum"
to = "cabin"
[[line.element]]
id = "flap"
kind = "check_valve"
resistance_pa_s2_kg2 = RESISTANCE
reverse_leak_kg_s = 1e-7
reverse_pressure_pa = 1000.0
"#;

#[test]
fn what_empties_through_a_check_valve_stops_at_the_pressure_outside() {
    // Emptying is monotonic, dm/dt ≤ 0 as long as the volume is above the outside, and nothing comes back through the
    // valve: the pressure can never pass the outside.
    for method in ["tr-bdf2", "implicit-euler"] {
        for step in ["100us", "1ms", "10ms", "50ms"] {
            for [volume, pressure, outside, resistance] in [
                [0.1, 101_825.0, 101_325.0, 500.0],
                [0.000_35, 142_000.0, 55_200.0, 89.5],
                [0.1, 200_000.0, 101_325.0, 5.0],
                [2.0, 103_000.0, 101_325.0, 20.0],
                [60.0, 101_900.0, 101_325.0, 0.5],
            ] {
                let text = PLENUM
                    .replace("VOLUME", &format!("{volume:e}"))
                    .replace("PRESSURE", &format!("{pressure:e}"))
                    .replace("OUTSIDE", &format!("{outside:e}"))
                    .replace("RESISTANCE", &format!("{resistance:e}"));
                let text = format!("{}{text}", head(method, step));
                let case = format!("{method}, {step}, {volume} m³ at {pressure} Pa");
                let drop = pressure - outside;
                with_network(&text, |_, simulator| {
                    let mut least = f64::INFINITY;
                    for tick in 1..=200 {
                        assert_eq!(simulator.step(), Health::Trusted, "{case}, tick {tick}");
                        let over = f64::from(simulator.node_gauge_pa(0)) + 101_325.0 - outside;
                        least = least.min(over);
                    }
                    assert!(least > -1e-3 * drop, "{case}: {least} Pa below the outside");
                });
            }
        }
    }
}

/// `SplitMix64`, Steele et al. 2014.
struct Dice(u64);

impl Dice {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((mixed ^ (mixed >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    fn between(&mut self, from: f64, to: f64) -> f64 {
        from + (to - from) * self.unit()
    }

    fn power_of_ten(&mut self, from: f64, to: f64) -> f64 {
        10f64.powf(self.between(from, to))
    }

    fn below(&mut self, count: usize) -> usize {
        (self.unit() * count as f64) as usize
    }
}

/// A random network of junctions (or small liquid volumes) between held pressures, at rest at random pressures; with the
/// lowest and highest pressure that anything in it can drive [Pa gauge].
fn made(seed: u64, liquid: bool) -> (String, [f64; 2]) {
    let dice = &mut Dice(seed);
    let (held, inner) = (2 + dice.below(2), 1 + dice.below(5));
    let spread = if liquid { 1e5 } else { 1e4 };
    let mut text = String::new();
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for node in 0..held + inner {
        let gauge = dice.between(-0.5 * spread, spread) + if liquid { 2e6 } else { 0.0 };
        (low, high) = (low.min(gauge), high.max(gauge));
        let pressure = 101_325.0 + gauge;
        let kind = if node < held {
            if liquid { "boundary\"\ncontents = \"coolant" } else { "boundary" }.to_owned() + "\""
        } else if liquid {
            format!(
                "liquid\"\nvolume_m3 = {:e}\ndensity_kg_m3 = 1e3\nbulk_modulus_pa = 2e9",
                dice.power_of_ten(-4.0, -2.0)
            )
        } else {
            "junction\"".into()
        };
        write!(
            text,
            "[[node]]\nid = \"n{node}\"\nkind = \"{kind}\npressure_pa = {pressure:e}\ntemperature_k = 295.0\n"
        )
        .unwrap();
    }
    let mut lines = 0;
    let mut line = |from: usize, to: usize, dice: &mut Dice| {
        let resistance = if liquid { dice.power_of_ten(3.0, 9.0) } else { dice.power_of_ten(0.0, 6.0) };
        let machine = dice.unit() < 0.2;
        let kind = if machine {
            let shutoff = 0.3 * spread * dice.unit();
            (low, high) = (low - shutoff, high + shutoff);
            let kind = if liquid { "pump" } else { "fan" };
            format!("\"{kind}\"\nshutoff_pa = {shutoff:e}\nquadratic_pa_s2_kg2 = {resistance:e}")
        } else {
            format!("\"pipe\"\nresistance_pa_s2_kg2 = {resistance:e}")
        };
        let inertance = if dice.unit() < 0.5 { 0.0 } else { dice.power_of_ten(0.0, 4.0) };
        write!(
            text,
            "[[line]]\nid = \"l{lines}\"\nfrom = \"n{from}\"\nto = \"n{to}\"\n[[line.element]]\nid = \"e{lines}\"\n\
             kind = {kind}\ninertance_per_m = {inertance:e}\n"
        )
        .unwrap();
        lines += 1;
    };
    for node in held..held + inner {
        // A tree towards the first held node, so that everything is connected; the other held ones somewhere.
        let other = if node == held { 0 } else { [0, held + dice.below(node - held)][dice.below(2)] };
        line(node, other, dice);
    }
    for node in 1..held {
        let other = held + dice.below(inner);
        line(node, other, dice);
    }
    for _ in 0..dice.below(4) {
        let (from, to) = (dice.below(held + inner), held + dice.below(inner));
        if from != to {
            line(from, to, dice);
        }
    }
    (text, [low, high])
}

#[test]
fn pressures_of_junctions_and_of_small_liquid_volumes_stay_between_those_that_drive_them() {
    for (liquid, method) in
        [(false, "implicit-euler"), (false, "tr-bdf2"), (true, "implicit-euler"), (true, "tr-bdf2")]
    {
        // The first step of the first-order method damps everything. Later, and at second order, what flows against a small
        // volume of liquid swings back, by the spread at most that was there at the start.
        let most = |tick: u32| if tick == 1 && method == "implicit-euler" { 0.01 } else { 1.0 };
        let mut worst = [0.0f64; 2];
        for seed in 0..1500 {
            let (text, [low, high]) = made(seed, liquid);
            let air = if liquid { "[air]\n" } else { "" };
            let text = format!("{}{air}{text}", head(method, "10ms"));
            with_network(&text, |loaded, simulator| {
                for tick in 1..=12 {
                    let case = format!("{method}, liquid {liquid}, seed {seed}, step {tick}");
                    assert_eq!(simulator.step(), Health::Trusted, "{case}");
                    for node in 0..loaded.nodes.len() {
                        let gauge = f64::from(simulator.node_gauge_pa(node));
                        let beyond = (low - gauge).max(gauge - high) / (high - low);
                        assert!(beyond <= most(tick), "{case}, n{node}: {gauge} Pa not in {low} … {high}");
                        let place = usize::from(tick > 1);
                        worst[place] = worst[place].max(beyond);
                    }
                }
            });
        }
        println!("{method}, liquid {liquid}: beyond by {worst:?} in the first step and later");
    }
}
