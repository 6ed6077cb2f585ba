//! Networks of the paper's largest size, as files: what a step costs there is in `docs/budgets.md`.

use std::fmt::Write as _;

const HEAD: &str = "schema = 1\nreference_pressure_pa = 101325.0\n\n[run]\nstep = \"1ms\"\nuntil = \"1s\"\n";

/// One line of `equations` equations: pipes and a valve that closes, between two held pressures.
pub(crate) fn chain(equations: usize) -> String {
    let mut text = format!("name = \"chain\"\n{HEAD}method = \"relaxation\"\n");
    node(&mut text, "supply", "boundary", 101_625.0);
    node(&mut text, "outlet", "boundary", 101_325.0);
    text.push_str("[[line]]\nid = \"chain\"\nfrom = \"supply\"\nto = \"outlet\"\ninitial_flow_kg_s = 0.08\n");
    for index in 1..equations {
        pipe(&mut text, &format!("p{index}"), 39_713.0 / (equations - 1) as f64);
    }
    valve(&mut text);
    text
}

/// `size` cabins with `size` lines: a tree of random shape with one more line that closes a loop through a fan.
pub(crate) fn general(size: usize) -> String {
    let mut text = format!("name = \"general\"\n{HEAD}method = \"adaptive\"\n");
    for index in 0..size {
        node(&mut text, &format!("n{index}"), "cabin", 101_325.0 + (index % 7) as f64 * 10.0);
    }
    // Knuth's MMIX generator: the same network on every machine.
    let mut dice = 1_u64;
    for index in 1..size {
        dice = dice.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let parent = index - 1 - (dice >> 33) as usize % index.min(12);
        line(&mut text, &format!("l{index}"), parent, index);
        pipe(&mut text, &format!("p{index}"), 50.0 + (index % 11) as f64 * 30.0);
    }
    line(&mut text, "return", size - 1, 0);
    text.push_str(
        "[[line.element]]\nid = \"fan\"\nkind = \"fan\"\nshutoff_pa = 300.0\nquadratic_pa_s2_kg2 = 12984.2\n",
    );
    valve(&mut text);
    text
}

fn node(text: &mut String, id: &str, kind: &str, pressure_pa: f64) {
    let _ = write!(text, "\n[[node]]\nid = \"{id}\"\nkind = \"{kind}\"\npressure_pa = {pressure_pa:.1}\n");
    text.push_str("temperature_k = 295.15\n");
    if kind == "cabin" {
        text.push_str("volume_m3 = 60.0\n");
    }
}

fn line(text: &mut String, id: &str, from: usize, to: usize) {
    let _ = write!(text, "\n[[line]]\nid = \"{id}\"\nfrom = \"n{from}\"\nto = \"n{to}\"\n");
}

fn pipe(text: &mut String, id: &str, resistance_pa_s2_kg2: f64) {
    let _ = write!(
        text,
        "[[line.element]]\nid = \"{id}\"\nkind = \"pipe\"\nresistance_pa_s2_kg2 = {resistance_pa_s2_kg2:.6}\n"
    );
}

/// The paper's valve, closing between 0.1 s and 0.2 s.
fn valve(text: &mut String) {
    text.push_str(
        "[[line.element]]\nid = \"valve\"\nkind = \"valve\"\nopen_resistance_pa_s2_kg2 = 85.978462\n\
         exponent = 3.134165\n\n[[schedule]]\ninput = \"valve.opening\"\ninterpolation = \"linear\"\n\
         points = [[0.0, 1.0], [0.1, 1.0], [0.2, 0.02]]\n",
    );
}
