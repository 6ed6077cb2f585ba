//! The experiment's table, CSV and plots.

use std::path::Path;

use crate::common::Folder;

fn texts(path: &Path) -> Vec<String> {
    let svg = std::fs::read_to_string(path).unwrap();
    let document = roxmltree::Document::parse(&svg).unwrap_or_else(|error| panic!("{error}"));
    let texts = document.descendants().filter(|node| node.has_tag_name("text"));
    texts.filter_map(|node| node.text()).map(|text| text.trim().to_owned()).collect()
}

fn assert_says(path: &Path, wanted: &[&str]) {
    let texts = texts(path);
    for part in wanted {
        assert!(texts.iter().any(|text| text.contains(part)), "{}: no `{part}` in {texts:?}", path.display());
    }
}

#[test]
fn the_experiment_prints_its_table_and_leaves_csv_and_plots() {
    let folder = Folder::new("experiment");
    let (code, out, err) = folder.say(&[]);
    assert!(code == 0 && err.is_empty(), "{err}");
    for part in [
        "copy of networks/paper.toml inside this program",
        "86.4776",
        "4.0456",
        "pseudo-time, not physics",
        "(p) printed in the paper",
        "+0.0009 %",
        "−0.3412 %",
        "would give +0.0008 % and −0.3400 %",
        "state hash at 26 s, 10 ms",
    ] {
        assert!(out.contains(part), "`{part}` not in {out}");
    }
    let hash = out.lines().find(|line| line.contains("state hash at 26 s, 1 ms")).unwrap();
    let hash = hash.rsplit(' ').next().unwrap();
    let (_, json, _) = folder.say(&["run", "--json"]);
    assert!(hash.len() == 16 && json.contains(hash), "{hash} is not in {json}");
    let results = folder.path("results/paper");
    assert_says(
        &results.join("eigenvalues_1ms.svg"),
        &["Eigenvalues", "real part [1]", "opening [%]", "with φ"],
    );
    assert_says(&results.join("eigenvalues_10ms.svg"), &["10 ms", "imaginary part [1]", "unit circle"]);
    assert_says(&results.join("spectral_radius.svg"), &["spectral radius [1]", "without φ, 1 ms", "43.2 %"]);
    assert_says(&results.join("flow_operator.svg"), &["time [s]", "mass flow at the valve [g/s]", "AMESim"]);
    for step in ["1ms", "10ms"] {
        let file = format!("flow_reference_{step}.svg");
        assert_says(&results.join(file), &["ours − reference [g/s]", "tight solution", "pseudo-time"]);
    }
    let csv = std::fs::read_to_string(results.join("relaxation_1ms.csv")).unwrap();
    assert_eq!(csv.lines().count(), 26_002);
    let names = csv.lines().next().unwrap();
    assert!(names.starts_with("t_s,") && names.contains("valve.mass_flow_kg_s"), "{names}");
    assert!(csv.lines().nth(10_001).unwrap().starts_with("10.000000,"));
}

#[test]
fn the_experiment_reads_the_file_in_the_folder_first() {
    let folder = Folder::new("experiment_file");
    std::fs::create_dir(folder.path("networks")).unwrap();
    std::fs::write(folder.path("networks/paper.toml"), "schema = 99").unwrap();
    let (code, _, err) = folder.say(&[]);
    assert!(code == 2 && err.contains("networks/paper.toml:1:"), "{err}");
}

#[test]
fn a_run_and_a_sweep_leave_csv_and_plots() {
    let folder = Folder::new("run_files");
    let (code, _, err) = folder.say(&["run", "--until", "12s", "--out", "out"]);
    assert_eq!(code, 0, "{err}");
    assert_says(&folder.path("out/run_relaxation.svg"), &["mass flow [g/s]", "gauge pressure [Pa]", "φ [1]"]);
    let csv = std::fs::read_to_string(folder.path("out/run_relaxation.csv")).unwrap();
    assert_eq!(csv.lines().count(), 12_002);
    let (code, _, err) = folder.say(&["stability", "--out", "out"]);
    assert_eq!(code, 0, "{err}");
    assert_says(&folder.path("out/stability_loop_discs.svg"), &["Gershgorin disc", "real part [1]"]);
    assert_says(&folder.path("out/stability_loop_radius.svg"), &["valve.opening [1]", "margin"]);
}
