//! `cargo xtask budget`: what a step costs, measured on the emulated boards.

use crate::firmware::ensure_set_up;
use crate::process::run;
use crate::test::{ALL, TESTS};
use crate::toolchain::Toolchain;
use crate::{Outcome, project, qemu};
use std::process::Command;

/// `cargo xtask budget [--check]`: writes `docs/budgets.md`, or fails when something became dearer than it says.
pub(crate) fn command(arguments: &[String]) -> Outcome {
    if let Some(unknown) = arguments.iter().find(|argument| *argument != "--check") {
        return Err(format!("unknown argument `{unknown}`"));
    }
    ensure_set_up()?;
    let toolchain = Toolchain::ready().ok_or("no firmware toolchain; run `cargo xtask setup`")?;
    let mut build = Command::new("cargo");
    // With a test, so that the libraries are those that the tests use.
    build.arg("build").args(&TESTS[1..]).args(ALL).args(["--bin", "budget", "--test", "qemu"]);
    run(build.current_dir(project::root()))?;
    let program = format!("budget{}", std::env::consts::EXE_SUFFIX);
    let mut budget = Command::new(project::output_folder()?.join("checked").join(program));
    budget.args(arguments).current_dir(project::root());
    budget.env("ECLSS_COMPILER", toolchain.version().ok_or("the compiler does not answer")?);
    qemu::hand_over(&mut budget)?;
    run(&mut budget)
}
