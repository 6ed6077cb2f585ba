//! `cargo xtask …`: set a machine up, test everything, build, run and flash the firmware.
//!
//! Only the standard library is used, so that the first thing a newcomer runs compiles in a second.

mod beside;
mod budget;
mod elf;
mod firmware;
mod fit;
mod process;
mod project;
mod qemu;
mod report;
mod setup;
mod test;
mod toolchain;

use std::process::ExitCode;

/// What every command returns: nothing, or a sentence for the user.
type Outcome<T = ()> = Result<T, String>;

const HELP: &str = "\
cargo xtask <command>

  test [STAGE …]            format, lints, host tests, docs, firmware builds and QEMU tests; sets up what is missing
  setup                     install what building and running the firmware needs; safe to repeat
  build [BOARD …]           build the firmware of the given boards (default: all) and print flash and RAM
  qemu [--board BOARD] [--seconds N]
                            run the firmware on an emulated board and print its log
  budget [--check]          count what a step costs on the emulated boards and write docs/budgets.md, or
                            fail when something costs more than it says
  flash                     build the firmware for a NUCLEO-H743ZI2 and flash it with probe-rs

BOARD is one of qemu-mps2-an500, qemu-mps2-an386 and nucleo-h743zi2. ECLSS_NETWORK names the network file that
is compiled in, networks/paper.toml unless it is set.";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (command, rest) = match arguments.split_first() {
        Some((command, rest)) => (command.as_str(), rest),
        None => ("help", &[][..]),
    };
    let outcome = match command {
        "setup" => setup::setup(rest),
        "test" => test::test(rest),
        beside::COMMAND => test::beside(rest),
        "build" => firmware::command(rest),
        "qemu" => qemu::command(rest),
        "budget" => budget::command(rest),
        "flash" => firmware::flash(rest),
        "help" | "--help" | "-h" => {
            println!("{HELP}");
            Ok(())
        }
        other => Err(format!("there is no command `{other}`\n\n{HELP}")),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("\nxtask {command}: {message}");
            ExitCode::FAILURE
        }
    }
}
