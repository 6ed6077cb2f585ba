//! Prints a network file as Rust tables: `cargo run -p eclss-network-file --example to_rust -- networks/paper.toml`.

use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    let Some(path) = std::env::args().nth(1) else {
        eprintln!("usage: to_rust NETWORK.toml");
        return ExitCode::from(2);
    };
    match eclss_network_file::load(Path::new(&path)) {
        Ok(loaded) => {
            print!("{}", loaded.to_rust());
            ExitCode::SUCCESS
        }
        Err(error) => {
            for problem in error.problems() {
                eprintln!("{problem}");
            }
            ExitCode::from(2)
        }
    }
}
