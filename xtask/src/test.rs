//! `cargo xtask test`: everything that must hold before a change goes in.

use crate::beside::Beside;
use crate::process::{command, run};
use crate::report::Stages;
use crate::{Outcome, beside, budget, firmware, fit, project, qemu, setup};

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
    let mut firmware = None;
    let outcome = chosen.try_for_each(|(word, header, work)| {
        stages.stage(header, || {
            // Linking firmware keeps one core busy, the page mostly waits for its browser.
            if *word == "page" && wanted("firmware") {
                firmware = Beside::start("firmware")?;
            }
            firmware.take_if(|_| *word == "firmware").map_or_else(work, Beside::finish)
        })
    });
    stages.summary();
    outcome
}

/// `cargo xtask beside STAGE`: one stage for another run of this program, which started it ahead of its turn.
pub(crate) fn beside(arguments: &[String]) -> Outcome {
    beside::end_with_parent();
    let stage = STAGES.iter().find(|(word, ..)| arguments.iter().any(|name| name == word));
    stage.map_or_else(|| Err("there is no such stage".into()), |(.., work)| work())
}

/// Whether this is a machine that decides about changes: there, what could not be checked counts as wrong.
pub(crate) fn in_ci() -> bool {
    std::env::var_os("CI").is_some_and(|value| value == "true")
}

/// What is built and how, the same for all stages: what one has built another need not build again. Part of it is the
/// solvers' and the tests' libraries, so every stage names a kind of target that may use them.
pub(crate) const ALL: [&str; 5] = ["--workspace", "--profile", "checked", "--features", OPTIONS];
/// What the core offers to boards and files, the real-time loop on a computer, and the tests that run firmware.
const OPTIONS: &str = "eclss-host-sim/hil,eclss-core/keyed,eclss-core/defmt,\
    eclss-target/wire,eclss-tests/qemu";
/// All tests but those of costs.
pub(crate) const TESTS: [&str; 3] = ["test", "--exclude", "eclss-bench"];
/// The solver to compare with is too long a build for more than seeing that it still fits.
const PEERS: [&str; 2] = ["--features", "eclss-bench/peers"];

fn lints() -> Outcome {
    let strict = ["--", "-D", "warnings"];
    cargo(&[&["clippy", "--all-targets"], &ALL[..], &PEERS, &strict].concat())?;
    // The tests that need a browser or an emulator are no targets of `cargo test`, and so none of the above.
    cargo(&[&["clippy", "--test", "page", "--test", "qemu"], &ALL[..], &PEERS, &strict].concat())
}

fn host_tests() -> Outcome {
    cargo(&[&TESTS[..], &ALL].concat())?;
    // What costs are measured with is the profile that users run.
    cargo(&["test", "--release", "--package", "eclss-bench"])
}

/// The tests that drive a browser. They are run by name only, because a plain `cargo test` may have none.
fn page() -> Outcome {
    if !setup::browser_present() {
        let missing = "no Chromium with its driver; `cargo xtask setup` installs them where it can";
        if in_ci() {
            return Err(missing.into());
        }
        println!("The page is not tested: {missing}.");
        return Ok(());
    }
    cargo(&[&TESTS[..], &ALL, &["--test", "page"]].concat())
}

/// The client's own tests, against the bytes of the protocol's document. It needs nothing but the interpreter.
fn python() -> Outcome {
    let mut python = command("python3", &["-m", "unittest", "discover", "clients/python"]);
    run(python.current_dir(project::root()))
}

fn documentation() -> Outcome {
    // With the examples, so that the libraries are those that the lints have looked at.
    cargo(&[&["doc", "--no-deps", "--lib", "--bins", "--examples"], &ALL[..], &PEERS].concat())
}

fn cargo(arguments: &[&str]) -> Outcome {
    let mut cargo = command("cargo", arguments);
    // A network that is named for a board or a run is not what the tests are about.
    cargo.env_remove("ECLSS_NETWORK");
    run(cargo.current_dir(project::root()).env("RUSTDOCFLAGS", "-D warnings"))
}
