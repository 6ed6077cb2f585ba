//! Prints all cost tables: `cargo run --release -p eclss-bench --features peers --example costs`.
//! With `chains` or `scale` behind it, only that one; sizes may follow.

use std::error::Error;

use eclss_bench::{PAPER_SIZES, SCALE_SIZES, chain_costs, exponent, mesh_cost, scale_costs};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let which = arguments.first().map_or("all", String::as_str);
    let sizes = arguments.iter().skip(1).map(|size| size.parse()).collect::<Result<Vec<usize>, _>>()?;
    let or = |usual: &[usize]| if sizes.is_empty() { usual.to_vec() } else { sizes.clone() };
    if matches!(which, "all" | "chains") {
        println!(
            "{:>6}  {:<15}{:>14}{:>14}{:>14}{:>14}{:>12}",
            "n", "method", "median ns", "mean ns", "repeated ns", "worst ns", "x floor"
        );
        for row in chain_costs(&or(&PAPER_SIZES), &mut |_| {})? {
            println!(
                "{:>6}  {:<15}{:>14.0}{:>14.0}{:>14.0}{:>14.0}{:>12.2}",
                row.n,
                row.method,
                row.median_ns,
                row.mean_ns,
                row.repeated_ns,
                row.worst_ns,
                row.ratio_to_floor
            );
        }
    }
    if matches!(which, "all" | "scale") {
        println!("{:>6}  {:<15}{:>14}{:>12}", "nodes", "method", "median ns", "x floor");
        let mut rows = scale_costs(&or(&SCALE_SIZES), &mut |_| {})?;
        for method in ["adaptive", "tr-bdf2"] {
            println!("exponent of {method}: {:.3}", exponent(&rows, method).unwrap_or(f64::NAN));
        }
        rows.extend(mesh_cost(100)?);
        for row in rows {
            println!(
                "{:>6}  {:<15}{:>14.0}{:>12.2}",
                row.nodes, row.method, row.median_ns, row.ratio_to_floor
            );
        }
    }
    Ok(())
}
