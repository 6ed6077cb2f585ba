//! Steps large networks with several threads.
//!
//! The core takes a step of `adaptive` in ranges of lines and ranges of nodes that may be done side by side
//! ([`eclss_core::SplitSimulator`]); here threads do them. The bits are the same for any number of threads, and
//! those of a plain [`eclss_core::Simulator`].
//!
//! ```
//! use eclss_core::{Method, example};
//! use eclss_parallel::{ParallelBuffers, Threads};
//!
//! let network = example::paper_loop();
//! let mut buffers = ParallelBuffers::new(&network);
//! let mut simulator = buffers.simulator(&network, 1_000)?;
//! let threads = Threads::new(2)?;
//! for _ in 0..1_000 {
//!     threads.step(&mut simulator);
//! }
//! assert!((simulator.simulator().line_flow_kg_s(0) - 0.086_477_6).abs() < 1e-4);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use eclss_core::{Buffers, BuildError, Element, Health, Join, Method, Network, SplitBuffers, SplitSimulator};
use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};

/// Threads that share the ranges of a step.
#[derive(Debug)]
pub struct Threads {
    pool: ThreadPool,
}

/// Leaves it to the pool that the caller is in who does what.
struct Shared;

impl Join for Shared {
    fn join<A: Send, B: Send>(
        &self,
        first: impl FnOnce() -> A + Send,
        second: impl FnOnce() -> B + Send,
    ) -> (A, B) {
        rayon::join(first, second)
    }
}

impl Threads {
    /// Starts `number` threads, one for every processor where it is 0.
    pub fn new(number: usize) -> Result<Self, ThreadPoolBuildError> {
        Ok(Self { pool: ThreadPoolBuilder::new().num_threads(number).build()? })
    }

    /// How many there are.
    pub fn number(&self) -> usize {
        self.pool.current_num_threads()
    }

    /// Advances by one step.
    pub fn step<E: Element + Sync>(&self, simulator: &mut SplitSimulator<'_, E>) -> Health {
        self.pool.install(|| simulator.step(&Shared))
    }

    /// Runs `work` among the threads, so that what is called in it finds them at hand.
    pub fn within<R: Send>(&self, work: impl FnOnce() -> R + Send) -> R {
        self.pool.install(work)
    }
}

/// Owns the numbers of one simulator that steps in ranges.
#[derive(Debug, Default)]
pub struct ParallelBuffers {
    state: Vec<f32>,
    work: Vec<f32>,
    inputs: Vec<f32>,
    cursors: Vec<u32>,
    between: Vec<[u32; 2]>,
    passed: Vec<[f32; 2]>,
    both_ends: Vec<[[f32; 2]; 2]>,
    pressures: Vec<f32>,
    constants: Vec<[f32; 3]>,
}

impl ParallelBuffers {
    /// Allocates what `network` needs.
    pub fn new<E: Element>(network: &Network<'_, E>) -> Self {
        let sizes = Method::Adaptive.sizes(network);
        let (nodes, lines) = (network.nodes.len(), network.lines.len());
        Self {
            state: vec![0.0; sizes.state],
            work: vec![0.0; sizes.work],
            inputs: vec![0.0; sizes.inputs],
            cursors: vec![0; sizes.cursors],
            between: vec![[0; 2]; lines],
            passed: vec![[0.0; 2]; lines],
            both_ends: vec![[[0.0; 2]; 2]; SplitBuffers::special_lines(network)],
            pressures: vec![0.0; nodes],
            constants: vec![[0.0; 3]; nodes],
        }
    }

    /// Bytes that a step reads or writes: all but those of the work that only a step in one piece needs.
    pub fn bytes(&self) -> usize {
        let laws = 12 * self.between.len();
        size_of_val(&*self.state)
            + laws
            + size_of_val(&*self.between)
            + size_of_val(&*self.passed)
            + size_of_val(&*self.pressures)
            + size_of_val(&*self.constants)
    }

    /// Builds a simulator of `adaptive` at its start state with a step of `step_us` [µs].
    pub fn simulator<'s, E: Element>(
        &'s mut self,
        network: &'s Network<'s, E>,
        step_us: u32,
    ) -> Result<SplitSimulator<'s, E>, BuildError> {
        let buffers = Buffers {
            state: &mut self.state,
            work: &mut self.work,
            inputs: &mut self.inputs,
            cursors: &mut self.cursors,
        };
        let split = SplitBuffers {
            between: &mut self.between,
            passed: &mut self.passed,
            both_ends: &mut self.both_ends,
            pressures: &mut self.pressures,
            constants: &mut self.constants,
        };
        SplitSimulator::new(network, step_us, buffers, split)
    }
}
