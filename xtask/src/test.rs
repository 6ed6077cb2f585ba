//! `cargo xtask test`: everything that must hold before a change goes in.

use crate::process::{command, run};
use crate::report::Stages;
use crate::{Outcome, budget, firmware, fit, project, qemu, setup};

/// A word for the command line, a header, what is done.
type Stage = (&'static str, &'static str, fn() -> Outcome);

/// All stages in order of how soon they answer.
const STAGES: [Stage; 11] = [
    ("format", "format", || cargo(&["fmt", "--all", "--check"])),
    ("lints", "lints", lints),
    ("host", "host tests", host_tests),
    ("python", "the client in Python", python),
    ("docs", "documentation", documentation),
    ("setup", "setup", || setup::setup(&[])),
    ("page", "the live page in a browser", page),
    ("firmware", "firmware", firmware::check),
    ("qemu", "boards in QEMU", qemu::test),
    ("budget", "budget", || budget::command(&["--check".into()])),
    ("fit", "a network that is too large", fit::refuses),
];

/// `cargo xtask test [STAGE …]`: all stages, or those that are named; stops at the first failure.
pub(crate) fn test(arguments: &[String]) -> Outcome {
    if let Some(unknown) = arguments.iter().find(|name| STAGES.iter().all(|(word, ..)| word != name)) {
        let words: Vec<&str> = STAGES.iter().map(|(word, ..)| *word).collect();
        return Err(format!("there is no stage `{unknown}`; there are {}", words.join(", ")));
    }
    let wanted = |word: &str| arguments.is_empty() || arguments.iter().any(|name| name == word);
    let mut stages = Stages::default();
    let mut chosen = STAGES.iter().filter(|(word, ..)| wanted(word));
    let outcome = chosen.try_for_each(|(_, header, work)| stages.stage(header, work));
    stages.summary();
    outcome
}

/// Whether this is a machine that decides about changes: there, what could not be checked counts as wrong.
pub(crate) fn in_ci() -> bool {
    std::env::var_os("CI").is_some_and(|value| value == "true")
}

/// Everything but the firmware application, of which only the board for computers can be built here.
pub(crate) const MOST: [&str; 5] = ["--workspace", "--exclude", "eclss-target", "--features", OPTIONS];
/// What the core offers to boards and files, and the real-time loop on a computer.
const OPTIONS: &str = "eclss-host-sim/hil,eclss-host-sim/compiled,eclss-core/protocol,eclss-core/defmt";
/// How tests are run but for those of costs. Stages that name the same packages share what was built for another.
pub(crate) const TESTS: [&str; 5] = ["test", "--profile", "checked", "--exclude", "eclss-bench"];
/// The same for the application.
const APPLICATION_TESTS: [&str; 3] = ["test", "--profile", "checked"];
const APPLICATION: [&str; 4] = ["--package", "eclss-target", "--features", "rt-pc"];

fn lints() -> Outcome {
    let strict = ["--", "-D", "warnings"];
    // With the tests that need an emulator or a browser, which are compiled but not run by the host's stages.
    let boards = ["--all-targets", "--features", "eclss-tests/qemu,eclss-host-sim/browser"];
    cargo(&[&["clippy"], &MOST[..], &boards, &strict].concat())?;
    // The solver to compare with is too long a build for more than seeing that it still fits.
    cargo(&["check", "--package", "eclss-bench", "--all-targets", "--features", "peers"])?;
    cargo(&[&["clippy", "--all-targets"], &APPLICATION[..], &strict].concat())
}

fn host_tests() -> Outcome {
    cargo(&[&TESTS[..], &MOST[..]].concat())?;
    cargo(&[&APPLICATION_TESTS[..], &APPLICATION[..]].concat())?;
    // What costs are measured with is the profile that users run.
    cargo(&["test", "--release", "--package", "eclss-bench"])
}

/// The tests that drive a browser. They stand behind a feature because a plain `cargo test` may have none.
fn page() -> Outcome {
    if !setup::browser_present() {
        let missing = "no Chromium with its driver; `cargo xtask setup` installs them where it can";
        if in_ci() {
            return Err(missing.into());
        }
        println!("The page is not tested: {missing}.");
        return Ok(());
    }
    cargo(&[&TESTS[..], &MOST[..], &["--features", "eclss-host-sim/browser", "--test", "page"]].concat())
}

/// The client's own tests, against the bytes of the protocol's document. It needs nothing but the interpreter.
fn python() -> Outcome {
    let mut python = command("python3", &["-m", "unittest", "discover", "clients/python"]);
    run(python.current_dir(project::root()))
}

fn documentation() -> Outcome {
    cargo(&[&["doc", "--no-deps"], &MOST[..]].concat())?;
    cargo(&[&["doc", "--no-deps"], &APPLICATION[..]].concat())
}

fn cargo(arguments: &[&str]) -> Outcome {
    let mut cargo = command("cargo", arguments);
    // A network that is named for a board or a run is not what the tests are about.
    cargo.env_remove("ECLSS_NETWORK");
    run(cargo.current_dir(project::root()).env("RUSTDOCFLAGS", "-D warnings"))
}
