//! A network that no cache holds: half a million nodes and as many lines.

use std::hint::black_box;

use eclss_parallel::{ParallelBuffers, Threads};
use rayon::prelude::*;

use crate::floor::Floor;
use crate::runner::still_trusted;
use crate::turns::{Contender, take};
use crate::{Description, Failure};

/// Step [µs].
const STEP_US: u32 = 1_000;
/// Turns of every contender.
const TURNS: usize = 15;

/// What a large network costs in `adaptive`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LargeCost {
    /// Nodes and lines.
    pub equations: usize,
    /// Threads that shared every pass.
    pub threads: usize,
    /// Bytes that a step reads or writes: state, tables, connections.
    pub bytes: usize,
    /// Median time per step [ns].
    pub step_ns: f64,
    /// Median time of the scalar floor over as many equations [ns].
    pub floor_ns: f64,
    /// Median time to read and write once what the step keeps in memory [ns].
    pub memory_pass_ns: f64,
    /// Median over the turns of step over floor [1].
    pub ratio_to_floor: f64,
    /// Median over the turns of step over memory pass [1].
    pub ratio_to_memory: f64,
    /// Plant time over wall time at a step of 1 ms [1]; ≥ 1 is real time at 1 kHz.
    pub real_time_factor: f64,
}

/// Measures `adaptive` on a chain of `nodes` nodes and `nodes` + 1 lines, with `threads` threads (0: one for every
/// processor), against the floor over 2·`nodes` equations and against a plain pass over the same number of bytes,
/// both shared by the same threads.
pub fn large_cost(nodes: usize, threads: usize) -> Result<LargeCost, Failure> {
    /// Values that a thread takes of a memory pass at a time.
    const PART: usize = 65_536;
    let threads = Threads::new(threads).map_err(|error| Failure::Threads(error.to_string()))?;
    let description = Description::node_chain(nodes);
    let network = description.network();
    let mut buffers = ParallelBuffers::new(&network);
    let bytes = buffers.bytes() + description.plan_bytes();
    let mut memory = vec![1.0f32; bytes / size_of::<f32>()];
    let mut floor = Floor::new(2 * nodes);
    let mut simulator = buffers.simulator(&network, STEP_US)?;
    let mut contenders = [
        Contender::new(|calls| {
            for _ in 0..calls {
                black_box(threads.step(&mut simulator));
            }
        }),
        Contender::new(|calls| threads.within(|| (0..calls).for_each(|_| floor.run_shared()))),
        Contender::new(|calls| {
            threads.within(|| {
                for _ in 0..calls {
                    black_box(&mut memory)
                        .par_chunks_mut(PART)
                        .for_each(|part| part.iter_mut().for_each(|value| *value += 1.0));
                }
            });
        }),
    ];
    take(&mut contenders, TURNS);
    let [step, floor_pass, memory_pass] = &contenders;
    let cost = LargeCost {
        equations: 2 * nodes,
        threads: threads.number(),
        bytes,
        step_ns: step.median_ns(),
        floor_ns: floor_pass.median_ns(),
        memory_pass_ns: memory_pass.median_ns(),
        ratio_to_floor: step.ratio_to(floor_pass),
        ratio_to_memory: step.ratio_to(memory_pass),
        real_time_factor: f64::from(STEP_US) * 1e3 / step.median_ns(),
    };
    drop(contenders);
    still_trusted(simulator.simulator())?;
    Ok(cost)
}
