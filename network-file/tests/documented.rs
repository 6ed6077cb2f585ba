//! The format's reference says what the code does.

use eclss_network_file::limits::{self, Range};
use eclss_network_file::parse;

const REFERENCE: &str = include_str!("../../docs/network-file.md");

#[test]
fn its_example_is_accepted() {
    let start = REFERENCE.find("```toml\n").expect("an example") + "```toml\n".len();
    let example = &REFERENCE[start..];
    let example = &example[..example.find("```").expect("its end")];
    let loaded = parse(example, "network-file.md").unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(loaded.records.len(), 3);
}

#[test]
fn its_ranges_are_the_ones_that_are_checked() {
    let ranges: [(&str, &Range); 49] = [
        ("reference_pressure_pa", &limits::PRESSURE),
        ("volume_m3", &limits::NODE_VOLUME),
        ("pressure_pa", &limits::PRESSURE),
        ("temperature_k", &limits::TEMPERATURE),
        ("laminar_below_pa", &limits::PRESSURE),
        ("initial_flow_kg_s", &limits::MASS_FLOW),
        ("reference_density_kg_m3", &limits::DENSITY),
        ("length_m", &limits::LENGTH),
        ("diameter_m", &limits::DIAMETER),
        ("diameter_m", &limits::AREA),
        ("inertance_per_m", &limits::INERTANCE),
        ("outlet_volume_m3", &limits::OUTLET_VOLUME),
        ("resistance_pa_s2_kg2", &limits::RESISTANCE),
        ("loss_coefficient", &limits::LOSS_COEFFICIENT),
        ("liquid_fraction", &limits::FRACTION),
        ("separator_efficiency", &limits::FRACTION),
        ("mass_fraction", &limits::FRACTION),
        ("capture_efficiency", &limits::FRACTION),
        ("pressure_drop_pa", &limits::REFERENCE_DROP),
        ("mass_flow_kg_s", &limits::REFERENCE_FLOW),
        ("exponent", &limits::FLOW_EXPONENT),
        ("density_kg_m3", &limits::DENSITY),
        ("open_resistance_pa_s2_kg2", &limits::SOME_RESISTANCE),
        ("exponent", &limits::VALVE_EXPONENT),
        ("leakage_opening", &limits::LEAKAGE),
        ("opening", &limits::FRACTION),
        ("shutoff_pa", &limits::PRESSURE),
        ("linear_pa_s_kg", &limits::LINEAR_FALL),
        ("quadratic_pa_s2_kg2", &limits::SOME_RESISTANCE),
        ("h0_m", &limits::HEAD),
        ("h1_s_m2", &limits::HEAD_LINEAR),
        ("h2_s2_m5", &limits::HEAD_QUADRATIC),
        ("speed", &limits::SPEED),
        ("discharge_coefficient", &limits::DISCHARGE),
        ("leak_kg_d", &limits::LEAK),
        ("pressure_drop_pa", &limits::SOME_PRESSURE),
        ("inlet_pressure_pa", &limits::SOME_PRESSURE),
        ("reverse_leak_kg_s", &limits::SEAT_LEAK),
        ("reverse_pressure_pa", &limits::SOME_PRESSURE),
        ("crack_pa", &limits::SOME_PRESSURE),
        ("reseat_pa", &limits::PRESSURE),
        ("leakage_opening", &limits::LEAKAGE),
        ("set_point_pa", &limits::SOME_PRESSURE),
        ("band_pa", &limits::SOME_PRESSURE),
        ("lag_s", &limits::LAG),
        ("leakage_opening", &limits::LEAKAGE),
        ("seat_leak_kg_d", &limits::SEAT_LEAK_A_DAY),
        ("seat_leak_pressure_pa", &limits::SOME_PRESSURE),
        ("opening", &limits::FRACTION),
    ];
    for (key, range) in ranges {
        let row = |line: &&str| line.starts_with(&format!("| `{key}`"));
        let written = range.to_string();
        let found = REFERENCE.lines().filter(row).any(|line| line.contains(&written));
        assert!(found, "`{key}` with {written}");
    }
    let limits = format!(
        "{} MiB, {} nodes, {} lines, {} elements, {} schedules, {} schedule points",
        limits::FILE_BYTES >> 20,
        limits::NODES,
        limits::LINES,
        limits::ELEMENTS,
        limits::SCHEDULES,
        limits::SCHEDULE_POINTS
    );
    assert!(REFERENCE.contains(&limits), "{limits}");
}

#[test]
fn it_knows_every_key_that_the_files_use() {
    for file in [include_str!("../../networks/paper.toml"), include_str!("files/zoo.toml")] {
        for key in file.lines().filter_map(|line| line.split_once(" = ")).map(|(key, _)| key) {
            assert!(REFERENCE.contains(&format!("`{key}`")), "{key}");
        }
    }
}
