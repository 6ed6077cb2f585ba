//! Runs a network frame by frame, for an instruction counter that watches `eclss_frame`.
//!
//! `eclss-frames METHOD STEP_US UNTIL_MS [NODES | FILE.toml]`: the paper's valve scenario, a chain of so many nodes, or a
//! network file.

use std::error::Error;
use std::hint::black_box;

use eclss_bench::{Description, Runner};
use eclss_core::{Health, Method, Network};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (method, step_us, until_ms, nodes) = match arguments.as_slice() {
        [method, step_us, until_ms] => (method, step_us, until_ms, None),
        [method, step_us, until_ms, file]
            if std::path::Path::new(file).extension().is_some_and(|end| end == "toml") =>
        {
            let loaded = eclss_network_file::load(file.as_ref())?;
            return run(&loaded.network(), method, step_us.parse()?, until_ms.parse()?);
        }
        [method, step_us, until_ms, nodes] => (method, step_us, until_ms, Some(nodes.parse()?)),
        _ => return Err("usage: eclss-frames METHOD STEP_US UNTIL_MS [NODES]".into()),
    };
    let (step_us, until_ms): (u32, u64) = (step_us.parse()?, until_ms.parse()?);
    let description = nodes.map_or_else(Description::paper_loop, Description::node_chain);
    let network = description.network();
    run(&network, method, step_us, until_ms)
}

/// Runs a network frame by frame and prints how many there were.
fn run(network: &Network<'_>, method: &str, step_us: u32, until_ms: u64) -> Result<(), Box<dyn Error>> {
    let method = Method::from_name(method).ok_or("no such method")?;
    let mut runner = Runner::new(network, method);
    let mut simulator = runner.simulator(network, method, step_us)?;
    let mut frames = 0u32;
    while simulator.time_us() < until_ms * 1_000 {
        if eclss_frame(|| simulator.step()) != Health::Trusted {
            return Err("the run left its range".into());
        }
        frames += 1;
    }
    println!("{frames} frames");
    Ok(())
}

/// One frame; its name is what the counter looks for.
#[inline(never)]
fn eclss_frame(step: impl FnOnce() -> Health) -> Health {
    black_box(step())
}
