//! `cargo xtask test`: everything that must hold before a change goes in.

use crate::process::{command, run};
use crate::report::Stages;
use crate::{Outcome, project};

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
    stages.stage("host tests", || cargo(&["test", "--release", "--workspace", "--all-features"]))?;
    stages.stage("documentation", documentation)
}

fn lints() -> Outcome {
    cargo(&["clippy", "--workspace", "--all-targets", "--all-features", "--", "-D", "warnings"])
}

fn documentation() -> Outcome {
    let mut doc = command("cargo", &["doc", "--workspace", "--all-features", "--no-deps"]);
    run(doc.current_dir(project::root()).env("RUSTDOCFLAGS", "-D warnings"))
}

fn cargo(arguments: &[&str]) -> Outcome {
    run(command("cargo", arguments).current_dir(project::root()))
}
