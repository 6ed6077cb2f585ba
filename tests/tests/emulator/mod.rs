//! Runs programs in QEMU and returns their decoded logs. Shared by the tests and by the budget.
#![allow(dead_code, unused_imports, reason = "every test takes what it needs of it")]

mod program;

pub(crate) use program::memory;

use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus, Stdio};

/// QEMU's machines, which are named like the boards' firmware behind `qemu-`.
pub(crate) const MACHINES: [&str; 2] = ["mps2-an500", "mps2-an386"];

/// Guest time of an instruction as a power of two [ns]: 32 ns, as in `cargo xtask qemu`.
const REAL_TIME: u32 = 5;
/// At 128 ns the boards' timers tell neighbouring instruction counts apart.
const COUNTING: u32 = 7;

/// How a run ended.
pub(crate) struct Run {
    /// The log's lines.
    pub(crate) log: Vec<String>,
    /// The emulator's, hence the guest's.
    pub(crate) status: ExitStatus,
}

/// The ELF file of a program, which `cargo xtask` builds and hands over.
pub(crate) fn elf(program: &str) -> PathBuf {
    let variable = format!("ECLSS_ELF_{}", program.replace('-', "_").to_uppercase());
    std::env::var_os(&variable)
        .unwrap_or_else(|| {
            panic!("{variable} is not set: run this by `cargo xtask test` or `cargo xtask budget`")
        })
        .into()
}

/// Runs a board's firmware with the given words as its command line.
pub(crate) fn run(machine: &str, words: &[&str]) -> Run {
    logged(machine, &elf(&format!("qemu-{machine}")), REAL_TIME, words)
}

/// Runs the program that counts instructions.
pub(crate) fn measure(machine: &str, words: &[&str]) -> Run {
    logged(machine, &elf("measure"), COUNTING, words)
}

/// Runs the program that counts the instructions of a day of temperature and humidity control.
pub(crate) fn measure_day(machine: &str, words: &[&str]) -> Run {
    logged(machine, &elf("measure-day"), COUNTING, words)
}

/// Runs the program that counts instructions and writes down the address of each.
pub(crate) fn trace(machine: &str, words: &[&str], file: &Path) -> Run {
    let elf = elf("measure");
    let mut qemu = emulator(machine, &elf, COUNTING, words);
    // One instruction per translated block; the option changed its name in 8.1.
    let text = Command::new("qemu-system-arm").arg("--version").output().expect("QEMU is set up").stdout;
    let version = String::from_utf8_lossy(&text);
    let mut numbers =
        version.split_whitespace().nth(3).unwrap_or("0").split('.').map(|n| n.parse().unwrap_or(0));
    let version: (u32, u32) = (numbers.next().unwrap_or(0), numbers.next().unwrap_or(0));
    qemu.args(if version < (8, 1) {
        ["-singlestep"].as_slice()
    } else {
        &["-accel", "tcg,one-insn-per-tb=on"]
    });
    qemu.args(["-d", "exec,nochain", "-D"]).arg(file);
    decoded(qemu, &elf)
}

fn logged(machine: &str, elf: &Path, shift: u32, words: &[&str]) -> Run {
    decoded(emulator(machine, elf, shift, words), elf)
}

/// Guest time of an instruction, 4 ns, at which an emulated millisecond takes a few of the host's: whoever is at the
/// other end of the serial line then has time to answer.
const SLOW: u32 = 2;

/// Runs the board with hardware on its link, whose other end is the Unix socket at `socket`; it starts when somebody
/// connects. The log is there when the run is over.
pub(crate) fn linked(socket: &Path, words: &[&str]) -> std::thread::JoinHandle<Run> {
    let elf = elf("qemu-hil-an386");
    let mut qemu = emulator("mps2-an386", &elf, SLOW, words);
    qemu.arg("-serial").arg(format!("unix:{},server=on,wait=on", socket.display()));
    std::thread::spawn(move || decoded(qemu, &elf))
}

/// The emulator's command line. Guest time is tied to executed instructions, so that every run is the same.
fn emulator(machine: &str, elf: &Path, shift: u32, words: &[&str]) -> Command {
    let words = words.iter().fold(String::new(), |words, word| words + ",arg=" + word);
    let mut qemu = Command::new("qemu-system-arm");
    qemu.args(["-M", machine, "-nodefaults", "-display", "none", "-monitor", "none"]);
    qemu.args(["-icount", &format!("shift={shift},sleep=off"), "-kernel"]).arg(elf);
    qemu.args(["-semihosting-config", &format!("enable=on,target=native{words}")]);
    qemu
}

fn decoded(mut qemu: Command, elf: &Path) -> Run {
    let started = qemu.stdout(Stdio::piped()).stderr(Stdio::null()).spawn();
    let mut qemu = started.expect("QEMU is installed by `cargo xtask setup`");
    let decoded = Command::new("defmt-print")
        .arg("-e")
        .arg(elf)
        .arg("stdin")
        .stdin(qemu.stdout.take().expect("piped"))
        .output()
        .expect("defmt-print is installed by `cargo xtask setup`");
    assert!(decoded.status.success(), "defmt-print: {}", String::from_utf8_lossy(&decoded.stderr));
    let log = String::from_utf8(decoded.stdout).expect("a log is text");
    Run { log: log.lines().map(str::to_owned).collect(), status: qemu.wait().expect("QEMU ends") }
}

impl Run {
    /// The first line that contains `text`, or a panic with the whole log.
    pub(crate) fn line(&self, text: &str) -> &str {
        let line = self.log.iter().find(|line| line.contains(text));
        line.unwrap_or_else(|| panic!("no `{text}` in\n{}", self.log.join("\n")))
    }

    /// The words behind the first `text` in the log.
    pub(crate) fn after(&self, text: &str) -> Vec<&str> {
        let line = self.line(text);
        line[line.find(text).expect("it is in the line") + text.len()..].split_whitespace().collect()
    }

    /// How many lines contain `text`.
    pub(crate) fn count(&self, text: &str) -> usize {
        self.log.iter().filter(|line| line.contains(text)).count()
    }
}
