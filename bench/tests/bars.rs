//! What a step of the paper's method may cost: at 1100 equations no more than the scalar floor of the same run,
//! and growth in proportion to the equations.
//!
//! Floor and methods take turns, so that another program on the machine slows all of them. Each figure is the best
//! of a few runs, because noise can only make a figure worse. Without optimisation a bar means nothing; then only
//! the shape of the answer is checked.

use eclss_bench::{Row, chain_costs};

/// Largest cost of `relaxation` at 1100 equations [floors].
const RELAXATION_FLOORS: f64 = 1.0;
/// Largest cost at 1100 equations over 11 times the cost at 100 [1].
const GROWTH: f64 = 1.4;
/// Runs of which the best counts.
const RUNS: usize = 4;

fn of<'r>(rows: &'r [Row], method: &str, n: usize) -> &'r Row {
    rows.iter()
        .find(|row| row.method == method && row.n == n)
        .expect("every method is measured at every size")
}

/// Smallest value of `figure` over a few runs, stopping early once it is within `bar`.
fn best(sizes: &[usize], bar: f64, figure: impl Fn(&[Row]) -> f64) -> f64 {
    let mut best = f64::INFINITY;
    for _ in 0..RUNS {
        let rows = chain_costs(sizes, &mut |_| {}).expect("chains run");
        best = best.min(figure(&rows));
        if best <= bar {
            break;
        }
    }
    best
}

#[test]
fn relaxation_costs_no_more_than_the_floor_and_grows_linearly() {
    let _turn = crate::alone();
    if cfg!(debug_assertions) {
        return;
    }
    let sizes = [100, 1100];
    let floors = best(&sizes, RELAXATION_FLOORS, |rows| of(rows, "relaxation", 1100).ratio_to_floor);
    let growth = best(&sizes, GROWTH, |rows| {
        of(rows, "relaxation", 1100).median_ns / (11.0 * of(rows, "relaxation", 100).median_ns)
    });
    println!(
        "relaxation at 1100: {floors:.2} floors (bar {RELAXATION_FLOORS}), growth {growth:.2} (bar {GROWTH})"
    );
    assert!(floors <= RELAXATION_FLOORS, "{floors:.3} floors");
    assert!(growth <= GROWTH, "growth {growth:.3}");
}

#[test]
fn every_method_is_measured_and_the_dense_baseline_is_the_slowest_of_ours() {
    let _turn = crate::alone();
    let mut seen = Vec::new();
    let rows = chain_costs(&[40], &mut |progress| seen.push(progress.equations)).expect("a short chain runs");
    assert_eq!(seen, [40, 0]);
    for method in ["floor", "euler", "relaxation", "implicit-euler", "tr-bdf2", "dense-newton"] {
        let row = of(&rows, method, 40);
        assert!(row.median_ns > 0.0 && row.repeated_ns >= row.mean_ns, "{row:?}");
        assert!(row.worst_ns >= row.repeated_ns, "{row:?}");
    }
    assert!(of(&rows, "dense-newton", 40).median_ns > of(&rows, "relaxation", 40).median_ns);
}

/// What a solver with variable steps cannot do: its worst frame is many times its mean.
#[cfg(feature = "peers")]
#[test]
fn the_peers_worst_frame_is_far_above_its_mean() {
    let _turn = crate::alone();
    let rows = chain_costs(&[100], &mut |_| {}).expect("the peer solves the chain");
    let bdf = of(&rows, "bdf", 100);
    println!("bdf at 100: mean {:.0} ns, worst {:.0} ns", bdf.mean_ns, bdf.repeated_ns);
    assert!(bdf.repeated_ns > 3.0 * bdf.mean_ns, "{bdf:?}");
}
