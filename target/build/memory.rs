//! The memory of the board that is built; the root `memory.x` only includes it.

use crate::fit::{MPS2, NUCLEO, Program, Room};
use std::path::{Path, PathBuf};
use std::{env, fs};

/// A board as the build sees it.
pub(crate) struct Board {
    /// Name for messages.
    pub(crate) name: &'static str,
    feature: &'static str,
    script: &'static str,
    program: Program,
    /// cortex-m-rt expects a `device.x` from every device crate; here the vector table stands in Rust.
    own_vectors: bool,
}

const BOARDS: [Board; 5] = [
    Board {
        name: "qemu-mps2-an500",
        feature: "CARGO_FEATURE_QEMU_MPS2_AN500",
        script: "mps2",
        program: MPS2,
        own_vectors: true,
    },
    Board {
        name: "qemu-mps2-an386",
        feature: "CARGO_FEATURE_QEMU_MPS2_AN386",
        script: "mps2",
        program: MPS2,
        own_vectors: true,
    },
    Board {
        name: "nucleo-h743zi2",
        feature: "CARGO_FEATURE_NUCLEO_H743ZI2",
        script: "nucleo_h743zi2",
        program: NUCLEO,
        own_vectors: false,
    },
    // Programs of the tests.
    Board {
        name: "measure",
        feature: "CARGO_FEATURE_MEASURE",
        script: "mps2",
        program: MPS2,
        own_vectors: true,
    },
    Board { name: "bare", feature: "CARGO_FEATURE_BARE", script: "mps2", program: MPS2, own_vectors: false },
];

impl Board {
    /// The microcontroller board of this build; `None` where the build is for a computer.
    pub(crate) fn of_this_build() -> Result<Option<Self>, String> {
        if env::var("CARGO_CFG_TARGET_OS").as_deref() != Ok("none") {
            return Ok(None);
        }
        let chosen = BOARDS.into_iter().find(|board| env::var_os(board.feature).is_some());
        chosen.map(Some).ok_or_else(|| "choose a board: `cargo xtask build BOARD`".into())
    }

    /// Hands the linker the board's memory map and returns what it leaves for a network.
    pub(crate) fn write_memory(&self, out: &Path) -> Result<Room, String> {
        let script = PathBuf::from("src/boards").join(self.script).with_extension("x");
        println!("cargo::rerun-if-changed={}", script.display());
        println!("cargo::rustc-link-search={}", out.display());
        let text = fs::read_to_string(&script).map_err(|error| format!("{}: {error}", script.display()))?;
        fs::write(out.join("board-memory.x"), &text).map_err(|error| error.to_string())?;
        if self.own_vectors {
            fs::write(out.join("device.x"), "").map_err(|error| error.to_string())?;
        }
        let region = |name| length(&text, name).ok_or_else(|| format!("{}: no {name}", script.display()));
        Ok(Room { flash: region("FLASH")?, ram: region("RAM")?, program: self.program })
    }
}

/// Length of a region \[bytes\] in a linker script: `NAME : ORIGIN = …, LENGTH = 512K`.
fn length(script: &str, name: &str) -> Option<u64> {
    let line = script.lines().find(|line| line.split(':').next().map(str::trim) == Some(name))?;
    let (_, length) = line.split_once("LENGTH =")?;
    let length = length.trim();
    let digits = length.trim_end_matches(['K', 'M']);
    let unit = match &length[digits.len()..] {
        "" => 0,
        "K" => 10,
        _ => 20,
    };
    digits.parse().ok().map(|number: u64| number << unit)
}
