//! `cargo xtask test`: everything that must hold before a change goes in.

use crate::process::{command, run};
use crate::report::Stages;
use crate::{Outcome, firmware, project, qemu, setup};

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
    stages.stage("lints", || on_host("clippy", &["--all-targets"], &["--", "-D", "warnings"]))?;
    stages.stage("host tests", || on_host("test", &["--release"], &[]))?;
    stages.stage("documentation", || on_host("doc", &["--no-deps"], &[]))?;
    stages.stage("setup", || setup::setup(&[]))?;
    stages.stage("firmware", firmware::check)?;
    stages.stage("boards in QEMU", qemu::test)
}

/// Runs a cargo command on all packages with all features. `eclss-target` comes apart from the others, because of
/// its features only the one for computers can be built here.
fn on_host(verb: &str, options: &[&str], rest: &[&str]) -> Outcome {
    let most = ["--workspace", "--exclude", "eclss-target", "--all-features"];
    let target = ["--package", "eclss-target", "--features", "rt-pc"];
    for packages in [most.as_slice(), target.as_slice()] {
        cargo(&[&[verb], options, packages, rest].concat())?;
    }
    Ok(())
}

fn cargo(arguments: &[&str]) -> Outcome {
    let mut cargo = command("cargo", arguments);
    run(cargo.current_dir(project::root()).env("RUSTDOCFLAGS", "-D warnings"))
}
