//! Writes `host-sim/data/paper_reference.csv`, the stored reference of the paper's experiment.
//!
//! `cargo run --release -p eclss-tests --example paper_reference`

use eclss_tests::reference;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let rows = reference::compute()?;
    std::fs::write(reference::path(), reference::to_csv(&rows))?;
    println!("{} rows from {} s to {} s", rows.len(), rows[0].0, rows[rows.len() - 1].0);
    Ok(())
}
