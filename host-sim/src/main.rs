//! `eclss-rt`: see `eclss_host_sim`.

use std::io::{BufWriter, stderr, stdout};
use std::process::ExitCode;

fn main() -> ExitCode {
    let mut out = BufWriter::new(stdout().lock());
    ExitCode::from(eclss_host_sim::main(std::env::args_os(), &mut out, &mut stderr()))
}
