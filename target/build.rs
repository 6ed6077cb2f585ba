//! Hands the linker the memory of the board that is built; the root `memory.x` only includes it.

use std::path::PathBuf;
use std::{env, fs};

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    if env::var("CARGO_CFG_TARGET_OS").as_deref() != Ok("none") {
        return;
    }
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
    let memory = ["mps2", "nucleo-h743zi2"].into_iter().find(|board| {
        let variable = format!("CARGO_FEATURE_{}", board.replace('-', "_").to_uppercase());
        env::var_os(variable).is_some()
    });
    let Some(board) = memory else {
        panic!("choose a board: `cargo xtask build BOARD`");
    };
    let script = PathBuf::from("src/boards").join(board.replace('-', "_")).with_extension("x");
    println!("cargo:rerun-if-changed={}", script.display());
    fs::copy(&script, out.join("board-memory.x")).unwrap_or_else(|e| panic!("{}: {e}", script.display()));
    if board == "mps2" {
        // cortex-m-rt expects one from every device crate; our vector table stands in Rust.
        fs::write(out.join("device.x"), "").expect("OUT_DIR can be written");
    }
    println!("cargo:rustc-link-search={}", out.display());
}
