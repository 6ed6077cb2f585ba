//! Every frame costs the same: the worst frame of the valve scenario takes at most 1.05 times the instructions of
//! the mean frame, for every method; and a frame of a network of any topology grows no faster than the network.
//! Counted by callgrind, so that nothing else on the machine matters.
//!
//! The scenario is the paper's, 26 s at 10 ms; plain Euler, which diverges in it, runs up to 10.8 s. Where valgrind
//! is not installed nothing is counted, and the test says so.

use std::process::Command;

use eclss_core::Method;

/// Largest worst frame over the mean frame [1].
const WORST_OVER_MEAN: f64 = 1.05;
const STEP_US: &str = "10000";
/// Largest exponent of growth from 100 to 1 000 and to 10 000 nodes [1].
const EXPONENT: f64 = 1.05;

/// Instructions of every frame.
fn scenario(method: Method) -> Vec<u64> {
    let until_ms = if method == Method::Euler { "10800" } else { "26000" };
    frames(method.name(), &[STEP_US, until_ms])
}

/// Instructions of every frame but the first and what follows the last, with `rest` behind the method's name.
fn frames(method: &str, rest: &[&str]) -> Vec<u64> {
    let name = format!("eclss-frames-{}-{}-{}", std::process::id(), method, rest.join("-"));
    let out = std::env::temp_dir().join(name);
    let run = Command::new("valgrind")
        .args(["--tool=callgrind", "--quiet", "--combine-dumps=yes"])
        .arg("--dump-after=eclss_frames::eclss_frame*")
        .arg(format!("--callgrind-out-file={}", out.display()))
        .args([env!("CARGO_BIN_EXE_eclss-frames"), method])
        .args(rest)
        .output()
        .expect("valgrind starts");
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let text = std::fs::read_to_string(&out).expect("callgrind leaves its counts");
    std::fs::remove_file(&out).expect("the counts can be removed");
    let counted: u32 = String::from_utf8_lossy(&run.stdout)
        .split_whitespace()
        .next()
        .and_then(|word| word.parse().ok())
        .expect("the program says how many frames it ran");
    // One part per frame, from the end of the frame before to its own end, with its sum of instructions; the
    // first holds the start of the program too, and one more what runs behind the last frame.
    let sums: Vec<u64> = text
        .lines()
        .filter_map(|line| line.strip_prefix("totals: "))
        .map(|sum| sum.trim().parse().expect("a count"))
        .collect();
    assert_eq!(sums.len(), counted as usize + 1, "a part for every frame");
    sums[1..counted as usize].to_vec()
}

fn counter_missing() -> bool {
    let missing = Command::new("valgrind").arg("--version").output().is_err();
    if missing {
        println!("valgrind is not installed: nothing counted");
    }
    missing
}

#[test]
fn the_worst_frame_takes_hardly_more_instructions_than_the_mean() {
    let _turn = crate::alone();
    if counter_missing() {
        return;
    }
    let mut late = Vec::new();
    for method in Method::ALL {
        let frames = scenario(method);
        let mean = frames.iter().sum::<u64>() as f64 / frames.len() as f64;
        let worst = frames.iter().copied().max().unwrap_or(0);
        let ratio = worst as f64 / mean;
        println!("{:<15} mean {mean:>8.1}  worst {worst:>6}  ratio {ratio:.3}", method.name());
        if ratio > WORST_OVER_MEAN {
            late.push((method.name(), ratio));
        }
    }
    assert!(late.is_empty(), "{late:?}");
}

#[test]
fn a_frame_grows_no_faster_than_the_network() {
    let _turn = crate::alone();
    if counter_missing() {
        return;
    }
    let mut fast = Vec::new();
    for method in [Method::Adaptive, Method::ImplicitEuler, Method::TrBdf2] {
        let last =
            |nodes: &str| frames(method.name(), &["1000", "4", nodes]).pop().expect("frames were counted");
        let counts = [last("100"), last("1000"), last("10000")];
        for pair in counts.windows(2) {
            let exponent = (pair[1] as f64 / pair[0] as f64).log10();
            println!("{:<15} {:>9} to {:>10}  exponent {exponent:.3}", method.name(), pair[0], pair[1]);
            if exponent > EXPONENT {
                fast.push((method.name(), exponent));
            }
        }
    }
    assert!(fast.is_empty(), "{fast:?}");
}
