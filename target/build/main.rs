//! Makes what a board's build needs: the memory map for the linker and the network as constant tables.
//!
//! `ECLSS_NETWORK` names the network file, relative to the workspace; without it the paper's loop is taken. A file
//! that is wrong, or a network that the board's memory cannot hold, ends the build with what is wrong.

#[path = "../src/fit.rs"]
#[allow(unreachable_pub, reason = "public where it is part of the library")]
mod fit;
mod large;
mod memory;

use eclss_network_file::{Loaded, parse};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::{env, fs};

/// The network of a build that names none.
const DEFAULT: &str = "networks/paper.toml";
/// Heat, moisture, composition and control: the day that is measured beside the paper's loop.
const THCS: &str = "networks/thcs.toml";
/// That of the emulated board with hardware on its link.
const HIL: &str = "tests/files/hil_emulated.toml";

fn main() -> ExitCode {
    match build() {
        Ok(()) => ExitCode::SUCCESS,
        Err(problems) => {
            for problem in problems {
                println!("cargo::error={problem}");
            }
            ExitCode::FAILURE
        }
    }
}

fn build() -> Result<(), Vec<String>> {
    println!("cargo::rerun-if-changed=build");
    println!("cargo::rerun-if-changed=src/fit.rs");
    println!("cargo::rerun-if-env-changed=ECLSS_NETWORK");
    let out = PathBuf::from(env::var_os("OUT_DIR").ok_or(["no OUT_DIR".to_owned()])?);
    let board = memory::Board::of_this_build().map_err(|problem| vec![problem])?;
    let path = env::var("ECLSS_NETWORK").unwrap_or_else(|_| {
        if env::var_os("CARGO_FEATURE_HIL").is_some() { HIL.into() } else { DEFAULT.into() }
    });
    let loaded = load(&path)?;
    let need = fit::Need::of(&loaded.network(), loaded.run.method);
    if let Some(board) = &board {
        let room = board.write_memory(&out).map_err(|problem| vec![problem])?;
        let network = format!("`{}` ({path})", loaded.file.name);
        fit::check(board.name, &network, loaded.run.method.name(), need, room)
            .map_err(|problem| vec![problem])?;
    }
    write(&out, "network.rs", &(loaded.to_rust() + &need.constants()))?;
    if env::var_os("CARGO_FEATURE_MEASURE").is_some() {
        write(&out, "chain.rs", &generated("chain", &large::chain(1_100))?.to_rust())?;
        write(&out, "general.rs", &generated("general", &large::general(550))?.to_rust())?;
        write(&out, "quick.rs", &quick(loaded).to_rust())?;
        write(&out, "thcs.rs", &quick(load(THCS)?).to_rust())?;
    }
    Ok(())
}

fn load(path: &str) -> Result<Loaded, Vec<String>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap_or(Path::new("."));
    let full = root.join(path);
    println!("cargo::rerun-if-changed={}", full.display());
    let text = fs::read_to_string(&full).map_err(|error| vec![format!("{}: {error}", full.display())])?;
    parse(&text, path).map_err(|error| error.problems().iter().map(ToString::to_string).collect())
}

fn generated(name: &str, text: &str) -> Result<Loaded, Vec<String>> {
    parse(text, name).map_err(|error| error.problems().iter().map(ToString::to_string).collect())
}

/// The same network with its schedules a thousand times as fast: short enough to be traced instruction by
/// instruction.
fn quick(mut loaded: Loaded) -> Loaded {
    for point in &mut loaded.points {
        point.time_us /= 1_000;
    }
    loaded
}

fn write(out: &Path, name: &str, text: &str) -> Result<(), Vec<String>> {
    fs::write(out.join(name), text).map_err(|error| vec![format!("cannot write {name}: {error}")])
}
