//! `eclss-rt`: see `eclss_host_sim`.

use std::process::ExitCode;

fn main() -> ExitCode {
    eclss_host_sim::program(&[])
}
