//! `cargo xtask test`: everything that must hold before a change goes in.

use crate::process::{command, run};
use crate::report::Stages;
use crate::{Outcome, budget, firmware, fit, project, qemu, setup};

/// Runs the stages in order of how soon they answer and stops at the first failure.
pub(crate) fn test(arguments: &[String]) -> Outcome {
    if let Some(unknown) = arguments.first() {
        return Err(format!("unknown argument `{unknown}`"));
    }
    let mut stages = Stages::default();
    let outcome = all(&mut stages);
    stages.summary();
    outcome
}

fn all(stages: &mut Stages) -> Outcome {
    stages.stage("format", || cargo(&["fmt", "--all", "--check"]))?;
    stages.stage("lints", lints)?;
    stages.stage("host tests", host_tests)?;
    stages.stage("documentation", documentation)?;
    stages.stage("setup", || setup::setup(&[]))?;
    stages.stage("firmware", firmware::check)?;
    stages.stage("boards in QEMU", qemu::test)?;
    stages.stage("budget", || budget::command(&["--check".into()]))?;
    stages.stage("a network that is too large", fit::refuses)
}

/// Whether this is a machine that decides about changes: there, what could not be checked counts as wrong.
pub(crate) fn in_ci() -> bool {
    std::env::var_os("CI").is_some_and(|value| value == "true")
}

/// Everything but the firmware application, of which only the board for computers can be built here.
const MOST: [&str; 5] = ["--workspace", "--exclude", "eclss-target", "--features", OPTIONS];
/// What the core offers to boards and files.
const OPTIONS: &str = "eclss-core/serde,eclss-core/defmt";
const APPLICATION: [&str; 4] = ["--package", "eclss-target", "--features", "rt-pc"];

fn lints() -> Outcome {
    let strict = ["--", "-D", "warnings"];
    // With the tests that need an emulator, which are compiled but not run by the host's stages.
    let boards = ["--all-targets", "--features", "eclss-tests/qemu"];
    cargo(&[&["clippy"], &MOST[..], &boards, &strict].concat())?;
    cargo(&[&["clippy", "--all-targets"], &APPLICATION[..], &strict].concat())
}

fn host_tests() -> Outcome {
    cargo(&[&["test", "--release"], &MOST[..]].concat())?;
    cargo(&[&["test", "--release"], &APPLICATION[..]].concat())
}

fn documentation() -> Outcome {
    cargo(&[&["doc", "--no-deps"], &MOST[..]].concat())?;
    cargo(&[&["doc", "--no-deps"], &APPLICATION[..]].concat())
}

fn cargo(arguments: &[&str]) -> Outcome {
    let mut cargo = command("cargo", arguments);
    run(cargo.current_dir(project::root()).env("RUSTDOCFLAGS", "-D warnings"))
}
