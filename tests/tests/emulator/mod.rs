//! Runs firmware in QEMU and returns its decoded log.

use std::process::{Command, ExitStatus, Stdio};

/// QEMU's machines, each with the variable in which `cargo xtask test` hands over its firmware.
pub(crate) const BOARDS: [(&str, &str); 2] =
    [("mps2-an500", "ECLSS_ELF_QEMU_MPS2_AN500"), ("mps2-an386", "ECLSS_ELF_QEMU_MPS2_AN386")];

/// How a run ended.
pub(crate) struct Run {
    /// The log's lines.
    pub(crate) log: Vec<String>,
    /// The emulator's, hence the guest's.
    pub(crate) status: ExitStatus,
}

/// Runs a board's firmware with the given words as its command line. Guest time is tied to instructions.
pub(crate) fn run(machine: &str, variable: &str, words: &[&str]) -> Run {
    let elf = std::env::var(variable).expect("the firmware is built and handed over by `cargo xtask test`");
    let words = words.iter().fold(String::new(), |words, word| words + ",arg=" + word);
    let mut qemu = Command::new("qemu-system-arm")
        .args(["-M", machine, "-nodefaults", "-display", "none", "-monitor", "none"])
        .args(["-icount", "shift=5,sleep=off", "-kernel", &elf])
        .args(["-semihosting-config", &format!("enable=on,target=native{words}")])
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .expect("QEMU is installed by `cargo xtask setup`");
    let decoded = Command::new("defmt-print")
        .args(["-e", &elf, "stdin"])
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

    /// How many lines contain `text`.
    pub(crate) fn count(&self, text: &str) -> usize {
        self.log.iter().filter(|line| line.contains(text)).count()
    }
}
