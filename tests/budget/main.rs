//! What a step costs on the emulated boards: measures, prints, and keeps `docs/budgets.md`.
//!
//! Run by `cargo xtask budget`, which builds the programs first. With `--check` the document is compared instead of
//! written: a figure that grew by more than 2 % (15 % where another compiler built the programs), a bar that is no
//! longer met or a row that is not there is an error.

#[path = "../tests/emulator/mod.rs"]
mod emulator;
mod figures;
mod report;
mod table;
mod thumb;
mod trace;

use std::path::Path;
use std::process::ExitCode;

use table::{OTHER_COMPILER, TOLERANCE, read, worse};

fn main() -> ExitCode {
    let check = match std::env::args().skip(1).collect::<Vec<_>>().as_slice() {
        [] => false,
        [word] if word == "--check" => true,
        _ => {
            eprintln!("usage: budget [--check]");
            return ExitCode::from(2);
        }
    };
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/budgets.md");
    let folder = std::env::temp_dir().join(format!("eclss-budget-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder for traces");
    let report = report::make(&folder);
    std::fs::remove_dir_all(&folder).expect("the folder was ours");
    let text = report.text();
    println!("{text}");
    if !check {
        std::fs::write(&path, text).expect("docs/budgets.md can be written");
        return ExitCode::SUCCESS;
    }
    let recorded = std::fs::read_to_string(&path).unwrap_or_default();
    let compiler = format!("Compiler: {}\n", report.compiler);
    let tolerance = if recorded.contains(&compiler) { TOLERANCE } else { OTHER_COMPILER };
    println!("{}figures may grow by {:.0} %", compiler, 100.0 * tolerance);
    let mut problems = worse(&read(&recorded), &report.tables, tolerance);
    problems.extend(report.disagreements);
    if problems.is_empty() {
        println!("docs/budgets.md holds.");
        return ExitCode::SUCCESS;
    }
    eprintln!("docs/budgets.md does not hold; if that is meant, `cargo xtask budget` writes it anew:");
    for problem in problems {
        eprintln!("  {problem}");
    }
    ExitCode::FAILURE
}
