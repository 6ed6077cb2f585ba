//! How cost grows with size, against the bars for networks of any topology.
//!
//! Each figure is the best of a few runs in which floor and methods take turns, because noise can only make a
//! figure worse. The verdict on each bar is printed; while a bar is not kept (docs/validation.md, "What does not hold"),
//! what is asserted is a ceiling above what was measured, so that nothing gets worse unnoticed. How time grows with size
//! is printed only: two sizes are not measured at the same moment, and a busy machine decides the third digit. What is
//! asserted of growth is counted in instructions (`tests/instructions.rs`).

use eclss_bench::{ScaleRow, exponent, mesh_cost, scale_costs};

/// Largest exponent of cost growth from 1 000 to 10 000 nodes [1].
const EXPONENT: f64 = 1.05;
/// Largest cost at 1000 nodes over the floor of 2000 equations [1]: the bar, and what must not be exceeded meanwhile.
const FLOORS: [(&str, f64, f64); 2] = [("adaptive", 2.5, 3.5), ("tr-bdf2", 12.0, 24.0)];
/// Runs of which the best counts.
const RUNS: usize = 8;

fn ratio(rows: &[ScaleRow], method: &str, nodes: usize) -> f64 {
    let row = rows.iter().find(|row| row.method == method && row.nodes == nodes);
    row.expect("every method is measured at every size").ratio_to_floor
}

fn tell(method: &str, what: &str, figure: f64, bar: f64) {
    let verdict = if figure <= bar { "holds" } else { "NOT HELD" };
    println!("{method}, {what}: {figure:.3} (bar {bar}) {verdict}");
}

#[test]
fn cost_grows_with_the_nodes_and_stays_near_the_floor() {
    let _turn = crate::alone();
    if cfg!(debug_assertions) {
        return;
    }
    let runs: Vec<Vec<ScaleRow>> =
        (0..RUNS).map(|_| scale_costs(&[1_000, 10_000], &mut |_| {}).expect("chains run")).collect();
    let least = |figure: &dyn Fn(&[ScaleRow]) -> f64| {
        runs.iter().map(|rows| figure(rows)).fold(f64::INFINITY, f64::min)
    };
    let mut broken = Vec::new();
    for (method, bar, ceiling) in FLOORS {
        let best = least(&|rows| ratio(rows, method, 1_000));
        tell(method, "cost over the floor", best, bar);
        if best > ceiling {
            broken.push(format!("{method}: {best:.3} > {ceiling}"));
        }
        let best = least(&|rows| exponent(rows, method).expect("two sizes ten times apart"));
        tell(method, "exponent of growth", best, EXPONENT);
    }
    assert!(broken.is_empty(), "{broken:?}");
}

#[test]
fn a_mesh_runs_with_both_methods() {
    let _turn = crate::alone();
    let rows = mesh_cost(12).expect("a mesh runs");
    assert_eq!(rows.len(), 3);
    assert!(rows.iter().all(|row| row.median_ns > 0.0 && row.ratio_to_floor > 0.0), "{rows:?}");
}
