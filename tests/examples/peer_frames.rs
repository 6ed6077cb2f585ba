//! What a solver of variable step and order spends in each frame of the valve scenario: executed instructions, the
//! worst frame over the mean. Ours stand in `cargo test -p eclss-bench --release --test all instructions::`.
//!
//! `cargo run --release -p eclss-tests --example peer_frames`, with valgrind installed.
//!
//! diffsol integrates the same equations through the same 26 s and must deliver the state every 10 ms, at tolerances
//! of engineering size and with interpolation within its own longer steps. The program runs itself under callgrind.

use std::error::Error;
use std::hint::black_box;
use std::process::Command;

use diffsol::{NalgebraLU, NalgebraMat, OdeBuilder, OdeSolverMethod};
use eclss_tests::paper::{Relaxation, relaxation_start};
use eclss_tests::physical::{Drain, Ringing};
use eclss_tests::tight::Equations;

type Matrix = NalgebraMat<f64>;
type Lu = NalgebraLU<f64>;

/// Frames, and the time of each [s].
const FRAMES: usize = 2_600;
const FRAME_S: f64 = 0.01;
/// Relative tolerance [1]; the absolute ones are that part of what matters of each state.
const TOLERANCE: f64 = 1e-4;
const SYSTEMS: [&str; 2] = ["relaxation", "P"];
const FAMILIES: [&str; 2] = ["bdf", "esdirk34"];

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if let [system, family] = arguments.as_slice() {
        return match system.as_str() {
            "relaxation" => run(&Relaxation, &relaxation_start(), family),
            _ => run(&Ringing(Drain::Signed), &Ringing::start(), family),
        };
    }
    println!("{:<12}{:<10}{:>12}{:>12}{:>14}", "equations", "method", "mean", "worst", "worst/mean");
    for system in SYSTEMS {
        for family in FAMILIES {
            let frames = count(system, family)?;
            let mean = frames.iter().sum::<u64>() as f64 / frames.len() as f64;
            let worst = frames.iter().copied().max().unwrap_or(0);
            println!("{system:<12}{family:<10}{mean:>12.0}{worst:>12}{:>14.1}", worst as f64 / mean);
        }
    }
    Ok(())
}

/// Integrates frame by frame.
fn run(equations: &impl Equations, start: &[f64], family: &str) -> Result<(), Box<dyn Error>> {
    let order = equations.order();
    let problem = OdeBuilder::<Matrix>::new()
        .rtol(TOLERANCE)
        .atol((0..order).map(|index| TOLERANCE * equations.scale(index)))
        .h0(1e-4)
        .rhs_implicit(
            |x, _, t, rates| equations.rates(t, x, rates),
            |x, _, t, v, out| equations.slope_along(t, x, v, out),
        )
        .init(|_, _, x| x.copy_from_slice(start), order)
        .build()?;
    if family == "bdf" { frames(problem.bdf::<Lu>()?) } else { frames(problem.esdirk34::<Lu>()?) }
}

fn frames<'a, E, S>(mut solver: S) -> Result<(), Box<dyn Error>>
where
    E: diffsol::OdeEquations<T = f64> + 'a,
    S: OdeSolverMethod<'a, E>,
{
    for index in 1..=FRAMES {
        let until_s = index as f64 * FRAME_S;
        let mut outcome = Ok(());
        eclss_frame(&mut || {
            outcome = (|| {
                while solver.state().t < until_s {
                    solver.step()?;
                }
                black_box(solver.interpolate(until_s)?);
                Ok::<_, diffsol::error::DiffsolError>(())
            })();
        });
        outcome?;
    }
    Ok(())
}

/// One frame; its name is what the counter looks for.
#[inline(never)]
fn eclss_frame(work: &mut dyn FnMut()) {
    work();
    black_box(());
}

/// Instructions of every frame but the first, which holds the start of the program.
fn count(system: &str, family: &str) -> Result<Vec<u64>, Box<dyn Error>> {
    let out = std::env::temp_dir().join(format!("peer-frames-{}-{system}-{family}", std::process::id()));
    let run = Command::new("valgrind")
        .args(["--tool=callgrind", "--quiet", "--combine-dumps=yes"])
        .arg("--dump-after=peer_frames::eclss_frame")
        .arg(format!("--callgrind-out-file={}", out.display()))
        .arg(std::env::current_exe()?)
        .args([system, family])
        .output()?;
    if !run.status.success() {
        return Err(String::from_utf8_lossy(&run.stderr).into());
    }
    let text = std::fs::read_to_string(&out)?;
    std::fs::remove_file(&out)?;
    let sums: Result<Vec<u64>, _> =
        text.lines().filter_map(|line| line.strip_prefix("totals: ")).map(|sum| sum.trim().parse()).collect();
    let sums = sums?;
    if sums.len() != FRAMES + 1 {
        return Err(format!("{} parts of {FRAMES} frames", sums.len()).into());
    }
    Ok(sums[1..FRAMES].to_vec())
}
