//! How cost grows with size, against the bars for networks of any topology.
//!
//! Each figure is the best of a few runs in which floor and methods take turns, because noise can only make a
//! figure worse. [`HELD`] lists the ratios to the floor that are asserted; the others are printed beside the figure
//! until the core keeps them, and then belong into the list. How time grows with size is printed only: two sizes are
//! not measured at the same moment, and a busy machine decides the third digit. What is asserted of growth is
//! counted in instructions (`tests/instructions.rs`).

use eclss_bench::{ScaleRow, exponent, mesh_cost, scale_costs};

/// Largest exponent of cost growth from 1 000 to 10 000 nodes [1].
const EXPONENT: f64 = 1.05;
/// Largest cost at 1000 nodes over the floor of 2000 equations [1].
const FLOORS: [(&str, f64); 2] = [("adaptive", 2.5), ("tr-bdf2", 12.0)];
/// Bars that hold and must go on holding.
const HELD: [(&str, Bar); 2] = [("adaptive", Bar::Floors), ("tr-bdf2", Bar::Floors)];
/// Runs of which the best counts.
const RUNS: usize = 8;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Bar {
    Floors,
    Exponent,
}

fn ratio(rows: &[ScaleRow], method: &str, nodes: usize) -> f64 {
    let row = rows.iter().find(|row| row.method == method && row.nodes == nodes);
    row.expect("every method is measured at every size").ratio_to_floor
}

fn judge(method: &str, bar: Bar, figure: f64, limit: f64) -> Option<String> {
    let within = figure <= limit;
    let asserted = HELD.contains(&(method, bar));
    let verdict = if within { "holds" } else { "NOT HELD" };
    println!("{method} {bar:?}: {figure:.3} (bar {limit}) {verdict}");
    (asserted && !within).then(|| format!("{method} {bar:?}: {figure:.3} > {limit}"))
}

#[test]
fn cost_grows_with_the_nodes_and_stays_near_the_floor() {
    if cfg!(debug_assertions) {
        return;
    }
    let runs: Vec<Vec<ScaleRow>> =
        (0..RUNS).map(|_| scale_costs(&[1_000, 10_000], &mut |_| {}).expect("chains run")).collect();
    let least = |figure: &dyn Fn(&[ScaleRow]) -> f64| {
        runs.iter().map(|rows| figure(rows)).fold(f64::INFINITY, f64::min)
    };
    let mut broken = Vec::new();
    for (method, floors) in FLOORS {
        let best = least(&|rows| ratio(rows, method, 1_000));
        broken.extend(judge(method, Bar::Floors, best, floors));
        let best = least(&|rows| exponent(rows, method).expect("two sizes ten times apart"));
        broken.extend(judge(method, Bar::Exponent, best, EXPONENT));
    }
    assert!(broken.is_empty(), "{broken:?}");
}

#[test]
fn a_mesh_runs_with_both_methods() {
    let rows = mesh_cost(12).expect("a mesh runs");
    assert_eq!(rows.len(), 3);
    assert!(rows.iter().all(|row| row.median_ns > 0.0 && row.ratio_to_floor > 0.0), "{rows:?}");
}
