//! Life-support fluid networks in hard real time: `no_std`, no heap, `f32`, no panics.
//!
//! Three things are kept apart:
//!
//! - a **description** ([`Network`]): nodes, lines, elements and parameters; constant data that may sit in flash;
//! - a **state** (flat `f32` slices owned by a [`Storage`]): small, copyable, hashable;
//! - a **method** ([`Method`]): advances the state by one fixed step with a fixed sequence of operations.
//!
//! [`Simulator`] joins the three. Everything that can be wrong is found by [`Simulator::new`]; a step never
//! fails, it can only report that the run has left the range in which it may be trusted ([`Health`]).
//!
//! ```
//! use eclss_core::{Method, Settings, Simulator, Storage, example};
//!
//! // The ventilation loop of Qiu et al. 2017 with the valve held open: 86.4776 g/s.
//! let network = example::paper_loop();
//! let mut storage = Storage::<64, 128, 8, 4>::new();
//! let settings = Settings { method: Method::Relaxation, step_us: 1_000 };
//! let mut simulator = Simulator::new(&network, settings, storage.buffers())?;
//! for _ in 0..30_000 {
//!     simulator.step();
//! }
//! assert!((simulator.line_flow_kg_s(0) - 0.086_477_6).abs() < 1e-6);
//! # Ok::<(), eclss_core::BuildError>(())
//! ```
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

pub mod air;
pub mod climate;
pub mod component;
pub mod components;
pub mod control;
pub mod example;
mod fingerprint;
pub mod fluid;
pub mod law;
mod limits;
pub mod math;
mod method;
pub mod mode;
pub mod moist;
mod network;
mod node;
pub mod operator;
pub mod parameter;
mod plan;
pub mod process;
#[cfg(feature = "protocol")]
pub mod protocol;
mod schedule;
pub mod signal;
mod simulator;
mod storage;
mod unroll;

pub use climate::Climate;
pub use component::{AnyComponent, Component, Element};
pub use fingerprint::Fingerprint;
pub use law::{Law, Operating};
pub use method::{Method, MethodError};
pub use network::{Active, Line, Network, NetworkError, Responsive, Segment};
pub use node::{Node, NodeKind};
pub use operator::{Margin, Proof};
pub use parameter::{InputSpec, ParameterError, Reason};
pub use plan::{End, Plan, PlanError, Series};
pub use schedule::{Interpolation, Schedule, SchedulePoint};
pub use signal::{Output, Signal};
pub use simulator::{
    BuildError, CheckpointError, Compiled, CompiledSimulator, Excursion, Fault, Health, InputError,
    LiveInput, Place, Settings, Simulator, Strayed,
};
pub use storage::{Buffers, Sizes, Storage};
