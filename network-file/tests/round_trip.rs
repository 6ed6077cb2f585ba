//! A saved document is the document that was read.

use eclss_network_file::parse;

const PAPER: &str = include_str!("../../networks/paper.toml");
const ZOO: &str = include_str!("files/zoo.toml");
const JUNCTION: &str = include_str!("files/junction.toml");
const THCS: &str = include_str!("../../networks/thcs.toml");
const MALFUNCTIONS: &str = include_str!("files/malfunctions.toml");

#[test]
fn what_is_saved_is_what_was_read() {
    for text in [PAPER, ZOO, JUNCTION, THCS, MALFUNCTIONS] {
        let first = parse(text, "first").expect("the file is right");
        let saved = first.file.to_toml();
        let second = parse(&saved, "second").expect("what is saved is right");
        assert_eq!(first.file, second.file);
        assert_eq!(first.network().id(), second.network().id());
        assert_eq!(first.records, second.records);
        // From the second time on the text itself stays the same.
        assert_eq!(saved, second.file.to_toml());
    }
}

#[test]
fn comments_spacing_and_the_order_of_keys_do_not_count() {
    let bare: String = PAPER
        .lines()
        .map(|line| line.split(" #").next().unwrap_or_default().trim())
        .filter(|line| !line.starts_with('#'))
        .fold(String::new(), |text, line| text + line + "\r\n");
    let with_comments = parse(PAPER, "paper").expect("the file is right");
    let without = parse(&bare, "bare").expect("comments are not needed");
    assert_eq!(with_comments.file, without.file);
    assert_eq!(with_comments.network().id(), without.network().id());
}

#[test]
fn every_value_counts_for_the_id() {
    let id = |text: &str| parse(text, "zoo").expect("the file is right").network().id();
    let original = id(ZOO);
    for (old, new) in [
        ("reference_pressure_pa = 100000.0", "reference_pressure_pa = 100001.0"),
        ("volume_m3 = 97.71", "volume_m3 = 97.72"),
        ("temperature_k = 296.0", "temperature_k = 296.1"),
        ("loss_coefficient = 1.7", "loss_coefficient = 1.8"),
        ("h1_s_m2 = 3.0", "h1_s_m2 = 3.1"),
        ("density_kg_m3 = 1.2\n\n[[line]]", "density_kg_m3 = 1.3\n\n[[line]]"),
        ("leakage_opening = 0.01", "leakage_opening = 0.02"),
        ("opening = 0.25", "opening = 0.26"),
        ("[10.1, 0.6]", "[10.1, 0.61]"),
        ("laminar_below_pa = 0.01", "laminar_below_pa = 0.02"),
    ] {
        assert_eq!(ZOO.matches(old).count(), 1, "{old}");
        assert_ne!(id(&ZOO.replace(old, new)), original, "{old}");
    }
    // Names, places in drawings and what a run records are not part of the physics.
    assert_eq!(
        id(&ZOO.replace("temperature_k = 296.0", "temperature_k = 296.0\nposition = [3, 4]")),
        original
    );
    assert_eq!(id(&ZOO.replace("One of each", "Each of one")), original);
}
