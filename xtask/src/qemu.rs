//! Runs firmware on an emulated board, with its log decoded.

use crate::firmware::{BOARDS, Board, TEST_PROGRAMS, board, build, ensure_set_up};
use crate::process::shown;
use crate::test::{ALL, TESTS};
use crate::{Outcome, project};
use std::path::Path;
use std::process::{Command, Stdio};

/// Guest time of a run unless the user says otherwise \[s\].
const DEFAULT_SECONDS: u32 = 10;

/// `cargo xtask qemu [--board BOARD] [--seconds N] [WORD …]`; further words go to the firmware.
pub(crate) fn command(arguments: &[String]) -> Outcome {
    let mut chosen = &BOARDS[0];
    let mut seconds = DEFAULT_SECONDS;
    let mut words = Vec::new();
    let mut rest = arguments.iter();
    while let Some(argument) = rest.next() {
        let mut value = || rest.next().ok_or_else(|| format!("{argument} needs a value"));
        match argument.as_str() {
            "--board" => chosen = board(value()?)?,
            "--seconds" => {
                let text = value()?;
                seconds = text
                    .parse()
                    .ok()
                    .filter(|s| *s > 0)
                    .ok_or_else(|| format!("`{text}` is no number of seconds"))?;
            }
            word if !word.starts_with('-') => words.push(word.to_owned()),
            unknown => return Err(format!("unknown argument `{unknown}`")),
        }
    }
    ensure_set_up()?;
    words.push(format!("seconds={seconds}"));
    let elf = build(chosen)?;
    let mut emulator = emulator(chosen, &elf, &words)?;
    let mut decoder = Command::new("defmt-print");
    decoder.arg("-e").arg(&elf).arg("stdin");
    println!("$ {} | {}", shown(&emulator), shown(&decoder));
    let mut guest = emulator.stdout(Stdio::piped()).spawn().map_err(|e| format!("cannot start QEMU: {e}"))?;
    let log = guest.stdout.take().ok_or("QEMU has no output")?;
    let decoded = decoder.stdin(log).status().map_err(|e| format!("cannot start defmt-print: {e}"))?;
    let ended = guest.wait().map_err(|e| format!("lost QEMU: {e}"))?;
    match (ended.success(), decoded.success()) {
        (true, true) => Ok(()),
        (false, _) => Err(format!("the firmware on {} ended with {ended}", chosen.name)),
        (true, false) => Err(format!("defmt-print failed ({decoded})")),
    }
}

/// The emulator's command line. `-icount` ties guest time to executed instructions, 32 ns each, which
/// makes every run of one ELF identical, whatever else the host does.
fn emulator(board: &Board, elf: &Path, words: &[String]) -> Outcome<Command> {
    let machine = board.machine.ok_or_else(|| format!("QEMU does not emulate {}", board.name))?;
    let mut semihosting = "enable=on,target=native".to_owned();
    for word in words {
        semihosting.push_str(",arg=");
        semihosting.push_str(word);
    }
    let mut qemu = Command::new("qemu-system-arm");
    qemu.args(["-M", machine, "-nodefaults", "-display", "none", "-monitor", "none"]);
    qemu.args(["-icount", "shift=5,sleep=off", "-semihosting-config", &semihosting, "-kernel"]).arg(elf);
    Ok(qemu)
}

/// The tests that run firmware. They are run by name only, because a plain `cargo test` has no firmware.
pub(crate) fn test() -> Outcome {
    let mut tests = Command::new("cargo");
    tests.args(TESTS).args(ALL).args(["--test", "qemu"]);
    hand_over(&mut tests)?;
    crate::process::run(tests.current_dir(project::root()))
}

/// Builds every microcontroller program and names its ELF file in the command's environment.
pub(crate) fn hand_over(command: &mut Command) -> Outcome {
    for program in BOARDS.iter().chain(&TEST_PROGRAMS) {
        let variable = format!("ECLSS_ELF_{}", program.name.replace('-', "_").to_uppercase());
        command.env(variable, build(program)?);
    }
    Ok(())
}
