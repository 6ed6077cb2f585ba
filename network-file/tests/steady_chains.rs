//! Steady states of chains that a measured flow feeds, and of leaking modules, against closed forms.

use eclss_network_file::{Loaded, parse, steady};

const GAS: f64 = 287.05 * 295.15;

fn node(id: &str, kind: &str, pressure_pa: f64) -> String {
    format!("[[node]]\nid = \"{id}\"\n{kind}\npressure_pa = {pressure_pa:?}\ntemperature_k = 295.15\n")
}

fn line(id: &str, from: &str, to: &str, keys: &str, element: &str) -> String {
    let element = format!("[[line.element]]\nid = \"{id}_element\"\n{element}\n");
    format!("[[line]]\nid = \"{id}\"\nfrom = \"{from}\"\nto = \"{to}\"\n{keys}\n{element}")
}

fn load(parts: &[String]) -> Loaded {
    let head = "schema = 1\nname = \"chain\"\nreference_pressure_pa = 101325.0\n[run]\nmethod = \"implicit-euler\"\n";
    let text = format!("{head}{}", parts.concat());
    parse(&text, "chain.toml").unwrap_or_else(|error| panic!("{error}\n{text}"))
}

/// A measured flow through a chain of cabins, some of whose lines are drawn against it, with densities that follow.
#[test]
fn a_measured_flow_goes_through_a_chain_however_its_lines_are_drawn() {
    let mut seed = 1u64;
    let mut random = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 33) as f64 / 2f64.powi(31)
    };
    for chain in 0..100 {
        let cabins = 1 + (random() * 8.0) as usize;
        let flow = 0.01 + 0.2 * random();
        let name = |index: usize| if index == cabins { "out".to_owned() } else { format!("c{index}") };
        let mut parts = vec![
            node("hall", "kind = \"boundary\"", 101_325.0),
            node("out", "kind = \"boundary\"", 101_325.0),
        ];
        let rig = "kind = \"measured\"\nlargest_flow_kg_s = 1.0\nslope_kg_s_pa = 1e-3";
        parts.push(line("rig", "hall", "c0", "", rig));
        let mut drawn = Vec::new();
        for index in 0..cabins {
            parts.push(node(&name(index), "kind = \"cabin\"\nvolume_m3 = 5.0", 101_325.0));
            let (resistance, against) = (1e3 + 5e4 * random(), random() < 0.5);
            let ends = if against { [index + 1, index] } else { [index, index + 1] };
            let keys = "density = \"follows\"\nreference_density_kg_m3 = 1.2";
            let pipe = format!("kind = \"pipe\"\nresistance_pa_s2_kg2 = {resistance:?}");
            parts.push(line(&format!("l{index}"), &name(ends[0]), &name(ends[1]), keys, &pipe));
            drawn.push((resistance, against));
        }
        parts.push(format!(
            "[[schedule]]\ninput = \"rig_element.measured_flow\"\npoints = [[0.0, {flow:?}]]\n"
        ));
        let loaded = load(&parts);
        let found = steady::steady(&loaded.network(), &loaded.inputs)
            .unwrap_or_else(|error| panic!("chain {chain}: {}", error.text(&loaded.names)));
        // From the outlet: p − p_out = R·w²·ρ_ref·Rg·T/p.
        let mut behind = 101_325.0f64;
        let flow = f64::from(flow as f32);
        for (index, (resistance, against)) in drawn.into_iter().enumerate().rev() {
            let loss = resistance * flow * flow * 1.2 * GAS;
            let exact = 0.5 * (behind + (behind * behind + 4.0 * loss).sqrt());
            let pressure = 101_325.0 + found.gauge_pa[2 + index];
            assert!(
                (pressure - exact).abs() < 1e-3 + 1e-6 * (exact - 101_325.0),
                "chain {chain}: {pressure} {exact}"
            );
            let own = if against { -found.flow_kg_s[1 + index] } else { found.flow_kg_s[1 + index] };
            assert!((own / flow - 1.0).abs() < 1e-6, "chain {chain}: {own} kg/s");
            behind = exact;
        }
    }
}

/// Two modules that a fan ventilates and that leak: rest is that without the leak, not a vacuum.
#[test]
fn a_leaking_station_rests_at_its_masses() {
    let cabin = "kind = \"cabin\"\nvolume_m3 = 60.0";
    let station = |leak: &[String]| {
        let mut parts = vec![
            node("hab", cabin, 101_425.0),
            node("lab", cabin, 101_225.0),
            line(
                "fan",
                "hab",
                "lab",
                "",
                "kind = \"fan\"\nshutoff_pa = 300.0\nquadratic_pa_s2_kg2 = 13000.0",
            ),
            line("back", "lab", "hab", "", "kind = \"pipe\"\nresistance_pa_s2_kg2 = 1000.0"),
        ];
        parts.extend_from_slice(leak);
        let loaded = load(&parts);
        steady::steady(&loaded.network(), &loaded.inputs)
            .unwrap_or_else(|error| panic!("{}", error.text(&loaded.names)))
    };
    let tight = station(&[]);
    assert!(tight.held.is_empty());
    let leak = "kind = \"leak\"\nleak_kg_d = 0.5\npressure_drop_pa = 101325.0";
    let relief = "kind = \"relief_valve\"\ncrack_pa = 104000.0\nreseat_pa = 103000.0\ndischarge_coefficient = 0.8\ndiameter_m = 0.05";
    let rig = "kind = \"measured\"\nlargest_flow_kg_s = 1.0\nslope_kg_s_pa = 1e-3";
    for outside in [
        vec![node("space", "kind = \"boundary\"", 0.0), line("hull", "hab", "space", "", leak)],
        vec![node("space", "kind = \"boundary\"", 0.0), line("prv", "hab", "space", "", relief)],
        vec![node("rig", "kind = \"boundary\"", 101_325.0), line("hardware", "rig", "lab", "", rig)],
    ] {
        let found = station(&outside);
        for (own, exact) in found.gauge_pa.iter().zip(&tight.gauge_pa) {
            assert!((own - exact).abs() < 0.01, "{found:?} {tight:?}");
        }
        for (own, exact) in found.flow_kg_s.iter().zip(&tight.flow_kg_s) {
            assert!((own - exact).abs() < 1e-5, "{found:?} {tight:?}");
        }
    }
}
