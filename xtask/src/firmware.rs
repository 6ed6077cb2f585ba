//! Builds the boards' firmware and flashes the one that is real hardware.

use crate::elf::Elf;
use crate::process::{output, present, run};
use crate::toolchain::{TARGET, Toolchain};
use crate::{Outcome, project, setup, test};
use std::path::PathBuf;
use std::process::Command;
use std::thread;

/// A board the firmware is built for.
pub(crate) struct Board {
    /// Name of the board, of its binary and of its cargo feature.
    pub(crate) name: &'static str,
    /// QEMU's name of the machine, if it emulates it.
    pub(crate) machine: Option<&'static str>,
    /// Where it is built, under cargo's output folder. Two builds in one folder wait for each other.
    folder: &'static str,
}

/// Firmware is built by another toolchain than the host crates, so it gets folders of its own: two, with programs that
/// take about as long in each.
const BARE: &str = "firmware";
const OTHER: &str = "firmware-other";

/// Every board, in the order of the documentation.
pub(crate) const BOARDS: [Board; 3] = [
    Board { name: "qemu-mps2-an500", machine: Some("mps2-an500"), folder: BARE },
    Board { name: "qemu-mps2-an386", machine: Some("mps2-an386"), folder: BARE },
    Board { name: "nucleo-h743zi2", machine: None, folder: BARE },
];

/// Programs of the tests, built like a board's firmware: two count instructions, one is nothing but a step, one has
/// hardware on its link.
pub(crate) const TEST_PROGRAMS: [Board; 4] = [
    Board { name: "qemu-hil-an386", machine: None, folder: OTHER },
    Board { name: "measure", machine: None, folder: OTHER },
    Board { name: "measure-day", machine: None, folder: BARE },
    Board { name: "bare", machine: None, folder: OTHER },
];

/// Name of the real board that `flash` writes to, as probe-rs knows its chip.
const FLASHED: (&str, &str) = ("nucleo-h743zi2", "STM32H743ZITx");

/// Finds a board by its full name or by the emulator's name for it.
pub(crate) fn board(name: &str) -> Outcome<&'static Board> {
    BOARDS.iter().find(|board| board.name == name || board.machine == Some(name)).ok_or_else(|| {
        let names: Vec<&str> = BOARDS.iter().map(|board| board.name).collect();
        format!("there is no board `{name}`; there are {}", names.join(", "))
    })
}

/// `cargo xtask build [BOARD …]`.
pub(crate) fn command(arguments: &[String]) -> Outcome {
    let wanted = arguments.iter().map(|name| board(name)).collect::<Outcome<Vec<_>>>()?;
    ensure_set_up()?;
    let wanted = if wanted.is_empty() { BOARDS.iter().collect() } else { wanted };
    for board in wanted {
        build(board)?;
    }
    Ok(())
}

/// Builds and lints every board and the programs of the tests.
pub(crate) fn check() -> Outcome {
    let toolchain = Toolchain::ready().ok_or("no firmware toolchain")?;
    let check_all = |folder: &str| {
        BOARDS.iter().chain(&TEST_PROGRAMS).filter(|board| board.folder == folder).try_for_each(|board| {
            build(board)?;
            if !toolchain.has_clippy() {
                return Ok(());
            }
            // The crates that it stands on are linted on the host.
            let mut clippy = toolchain.clippy();
            select(&mut clippy, board)?;
            run(clippy.args(["--no-deps", "--", "-D", "warnings"]))
        })
    };
    // Linking one keeps one core busy, so the folders are filled side by side.
    thread::scope(|scope| {
        let folders = [BARE, OTHER].map(|folder| scope.spawn(move || check_all(folder)));
        folders.into_iter().try_for_each(|folder| folder.join().map_err(|_| "a build was lost")?)
    })?;
    if toolchain.has_clippy() {
        return Ok(());
    }
    let unlinted = format!("{}, without clippy: the bare-metal files were not linted", toolchain.describe());
    if test::in_ci() {
        return Err(unlinted);
    }
    println!("note: {unlinted}");
    Ok(())
}

/// Builds one board's firmware, prints its memory use and returns the ELF file.
pub(crate) fn build(board: &Board) -> Outcome<PathBuf> {
    let toolchain = Toolchain::ready().ok_or("no firmware toolchain; run `cargo xtask setup`")?;
    let mut cargo = toolchain.cargo();
    select(cargo.arg("build"), board)?;
    run(&mut cargo)?;
    let elf = project::output_folder()?.join(board.folder).join(TARGET).join("firmware").join(board.name);
    let (flash, ram) = Elf::read(&elf)?.memory_use();
    println!("{}: flash {flash} bytes, statics in RAM {ram} bytes", board.name);
    Ok(elf)
}

/// Installs what is missing, silently when nothing is.
pub(crate) fn ensure_set_up() -> Outcome {
    if setup::complete() { Ok(()) } else { setup::setup(&[]) }
}

/// Adds what selects a board's firmware to a cargo command.
pub(crate) fn select(cargo: &mut Command, board: &Board) -> Outcome {
    cargo.args(["--package", "eclss-target", "--profile", "firmware"]);
    cargo.args(["--bin", board.name, "--features", board.name]);
    cargo.args(["--target", TARGET, "--target-dir"]).arg(project::output_folder()?.join(board.folder));
    cargo.current_dir(project::root());
    Ok(())
}

/// `cargo xtask flash`: builds the real board's firmware, flashes it and shows its log.
pub(crate) fn flash(arguments: &[String]) -> Outcome {
    if let Some(unknown) = arguments.first() {
        return Err(format!("unknown argument `{unknown}`"));
    }
    if !present("probe-rs") {
        return Err("probe-rs is not installed; it talks to the board's debug probe. \
             Install it with `cargo install --locked probe-rs-tools`, then repeat"
            .into());
    }
    let probes = output(Command::new("probe-rs").arg("list")).ok_or("`probe-rs list` failed")?;
    if probes.to_lowercase().contains("no debug probes") {
        return Err("no debug probe was found. Connect the board by its ST-LINK USB socket; \
             on Linux probe-rs also needs its udev rules"
            .into());
    }
    ensure_set_up()?;
    let (name, chip) = FLASHED;
    let elf = build(board(name)?)?;
    run(Command::new("probe-rs").args(["run", "--chip", chip]).arg(elf))
}
