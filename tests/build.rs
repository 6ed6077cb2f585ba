//! Writes network files as Rust tables, for the tests that compile them.

use std::error::Error;
use std::path::Path;
use std::{env, fs};

/// Files, relative to this package, and the names of their tables.
const FILES: [(&str, &str); 3] = [
    ("../networks/paper.toml", "paper.rs"),
    ("../networks/thcs.toml", "thcs.rs"),
    ("../network-file/tests/files/zoo.toml", "zoo.rs"),
];

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo::rerun-if-changed=build.rs");
    let out = env::var_os("OUT_DIR").ok_or("no OUT_DIR")?;
    for (path, name) in FILES {
        println!("cargo::rerun-if-changed={path}");
        fs::write(Path::new(&out).join(name), eclss_network_file::load(Path::new(path))?.to_rust())?;
    }
    Ok(())
}
