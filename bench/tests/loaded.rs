//! Instructions of a step of loaded networks against their bars: closed loops of small cabins with and without gas, a
//! module, and a station of twelve.
//!
//! Counted by callgrind as the difference of two lengths of one run, so that loading does not count. Where valgrind is
//! not installed nothing is counted, and the test says so.

use std::path::{Path, PathBuf};
use std::process::Command;

use eclss_network_file::generate::{Gas, modules, ring};

/// Step [µs].
const STEP_US: &str = "10000";
/// Lengths of the two runs [steps].
const STEPS: [u64; 2] = [20, 60];

/// A network, a method, the most instructions that a step may take, and the bar that is aimed at.
struct Bar {
    name: &'static str,
    text: String,
    method: &'static str,
    most: f64,
    aim: f64,
}

fn bars() -> Vec<Bar> {
    let thcs = include_str!("../../networks/thcs.toml");
    let bar =
        |name, text: &str, method, [most, aim]: [f64; 2]| Bar { name, text: text.into(), method, most, aim };
    let loops = |nodes, gas| ring(nodes, gas).expect("a loop of this size").to_toml();
    let twelve = modules(thcs, 12, "cabin").expect("a station");
    let mut bars = vec![
        bar("twelve modules", &twelve, "implicit-euler", [206_000.0, 110_000.0]),
        bar("thcs", thcs, "implicit-euler", [18_400.0, 11_500.0]),
    ];
    for (name, nodes, gas, tr_bdf2, euler) in [
        ("flows, N = 6", 6, Gas::Plain, [11_500.0, 5_000.0], [4_900.0, 2_000.0]),
        ("flows, N = 100", 100, Gas::Plain, [123_000.0, 70_000.0], [46_000.0, 25_000.0]),
        ("air, N = 6", 6, Gas::Air, [17_500.0, 7_000.0], [11_000.0, 4_000.0]),
        ("air, N = 100", 100, Gas::Air, [211_000.0, 120_000.0], [129_000.0, 60_000.0]),
        ("density follows, N = 6", 6, Gas::Following, [23_500.0, 9_000.0], [15_800.0, 5_000.0]),
        ("density follows, N = 100", 100, Gas::Following, [308_000.0, 150_000.0], [205_000.0, 80_000.0]),
    ] {
        bars.push(bar(name, &loops(nodes, gas), "tr-bdf2", tr_bdf2));
        bars.push(bar(name, &loops(nodes, gas), "implicit-euler", euler));
    }
    bars
}

/// Instructions of a whole run of so many steps.
fn instructions(file: &Path, method: &str, steps: u64) -> u64 {
    let run = Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .args([env!("CARGO_BIN_EXE_eclss-frames"), method, STEP_US, &(10 * steps).to_string()])
        .arg(file)
        .output()
        .expect("valgrind starts");
    let text = String::from_utf8_lossy(&run.stderr).into_owned();
    assert!(run.status.success(), "{text}");
    let count = text.lines().find_map(|line| line.split("Collected : ").nth(1));
    count.and_then(|count| count.trim().parse().ok()).expect("callgrind says how many it collected")
}

#[test]
fn a_step_of_a_loaded_network_takes_at_most_its_instructions() {
    let _turn = crate::alone();
    if Command::new("valgrind").arg("--version").output().is_err() {
        println!("valgrind is not installed: nothing counted");
        return;
    }
    let folder: PathBuf = std::env::temp_dir().join(format!("eclss-loaded-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let mut above = Vec::new();
    for (index, Bar { name, text, method, most, aim }) in bars().into_iter().enumerate() {
        let file = folder.join(format!("{index}.toml"));
        std::fs::write(&file, text).expect("a file");
        let [short, long] = STEPS.map(|steps| instructions(&file, method, steps));
        let step = (long - short) as f64 / (STEPS[1] - STEPS[0]) as f64;
        println!("{name:<25} {method:<15} {step:>10.0}  at most {most:>8.0}  aim {aim:>7.0}");
        if step > most {
            above.push(format!("{name}, {method}: {step:.0} > {most:.0}"));
        }
    }
    std::fs::remove_dir_all(&folder).expect("the folder can be removed");
    assert!(above.is_empty(), "{}", above.join("\n"));
}
