//! What a step costs against the number of equations.

use super::html::{Html, fixed};
use crate::Failure;
use crate::command::bench;

const COMMAND: &str = "eclss-rt bench";

/// Measures and writes the section.
pub(super) fn write(page: &mut Html, sizes: &[usize]) -> Result<(), Failure> {
    page.section("Cost against the number of equations");
    page.paragraph(bench::PRINTED);
    let rows =
        eclss_bench::chain_costs(sizes, &mut |_| {}).map_err(|error| Failure::Failed(error.to_string()))?;
    page.figure(
        &bench::picture(&rows).svg(),
        "Time of a step on chains of n equations, measured when this report was made, on the machine that made it.",
        COMMAND,
    );
    let table: Vec<_> = rows
        .iter()
        .map(|row| {
            [
                row.n.to_string(),
                row.method.to_owned(),
                fixed(row.median_ns * 1e-3, 3),
                fixed(row.worst_ns * 1e-3, 3),
                fixed(row.ratio_to_floor, 2),
            ]
        })
        .collect();
    page.table(
        ["n", "method", "median [µs]", "worst frame [µs]", "over the floor"],
        &table,
        "The floor is one scalar square root and one division per equation over arrays of the same length.",
        COMMAND,
    );
    Ok(())
}
