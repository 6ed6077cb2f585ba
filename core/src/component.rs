//! Components: the one contract of everything that a line or a volume holds.
//!
//! A component is one file in `components/` that implements [`Component`] and one name in its list. Everything else
//! follows from the list: keys, ranges and tables of network files, inputs, checks, network id, laws, generated source.
//!
//! Every component of a line receives the inlet pressure from upstream and the outlet mass flow from downstream and
//! gives outlet pressure and inlet mass flow (Qiu et al. 2017, conclusion 3). Its pressure side is a [`Law`], its mass
//! side a removal fraction.
//!
//! Signs: w > 0 from `from` to `to`; head > 0 raises the pressure in the direction of flow; removal > 0 out of the air.
//!
//! Networks hold components of any kind side by side, so a kind is *erased* there: [`AnyComponent`] keeps the parameters
//! as a row of numbers and a reference to its [`Kind`]. A laboratory's own kinds need no entry in this crate.

mod any;
mod draft;
mod faces;
mod placed;

pub use crate::components::AnyComponent;
pub use any::{Element, Foreign, Kind, ROW, Row, pad};
pub use draft::{Draft, FileKind, FileTable, LineFacts};
pub use faces::Volumes;
pub use faces::{Block, Heat, Passing, Seen, StepContext, VolumeView};
pub use placed::{Passage, Placed, Range, Table};

use crate::fluid::{Account, Stream};
use crate::law::{Law, Operating};
use crate::parameter::{Carries, InputSpec, Keys, ParameterError, Place, StepBound};
use crate::signal::OutputSpec;

/// The parameters of a component as a row of numbers; written by [`crate::parameters!`].
pub trait Parameters: Copy + 'static {
    /// Names of the parameters in the order of the row.
    const NAMES: &'static [&'static str];

    /// Returns the parameters as a row, padded with zeros.
    fn to_row(self) -> Row;

    /// Returns the parameters of a row.
    fn from_row(row: &Row) -> Self;
}

/// The contract. A face that a component lacks keeps its default and costs nothing.
pub trait Component: Parameters {
    /// `kind = "…"` in network files and the word in network ids.
    const KIND: &'static str;
    /// One sentence for the format's document.
    const ABOUT: &'static str;
    /// Keys of its table in a network file.
    const KEYS: Keys;
    /// Inputs in the order of their slots. Each is also a key of the table: the value at the start.
    const INPUTS: &'static [InputSpec] = &[];

    /// Where it stands.
    const PLACE: Place = Place::Line;
    /// Streams that it meets, by side: its own line first, then the line of a component that names it.
    const SIDES: &'static [Carries] = &[];
    /// Inputs that do nothing where a stream passes its second side.
    const IDLE_WHEN_LINKED: &'static [&'static str] = &[];
    /// Published figures.
    const OUTPUTS: &'static [OutputSpec] = &[];
    /// Numbers that last from step to step; each integrated one with its carry.
    const STATE: usize = 0;
    /// Numbers that a step derives.
    const SCRATCH: usize = 0;
    /// Whether it acts on its volume before the flows of a step are solved: [`Self::supply`].
    const SUPPLIES: bool = false;
    /// Whether it works before and after the streams of a step pass: [`Self::begin`], [`Self::settle`].
    const SETTLES: bool = false;

    /// Returns the parameters of a table in a network file. Findings go to the draft.
    fn from_file(draft: &mut Draft<'_>) -> Self;

    /// Finds the first parameter outside its valid range.
    fn check(&self) -> Result<(), ParameterError>;

    /// Finds the first parameter that a step of `step_s` [s] does not allow.
    fn check_step(&self, _step_s: f32) -> Result<(), StepBound> {
        Ok(())
    }

    /// Returns name, unit and range of input `index` of this component; `None` from the first index that does not
    /// exist. Differs from [`Self::INPUTS`] where parameters decide that an input exists, or its range.
    fn input_spec(&self, index: usize) -> Option<InputSpec> {
        Self::INPUTS.get(index).copied()
    }

    /// Whether the law depends on inputs, flow or density; a law that does not is evaluated once, and must be
    /// purely quadratic.
    fn is_active(&self) -> bool {
        false
    }

    /// Whether the law changes with the flow, so that a method which solves for the flow evaluates it again.
    fn follows_flow(&self) -> bool {
        false
    }

    /// Whether the law may ever have a linear part.
    fn may_be_linear(&self) -> bool {
        self.is_active()
    }

    /// Smallest quadratic resistance that inputs within their ranges give at the line's reference density
    /// [Pa·s²/kg²]; 0 where nothing is known of it.
    fn least_resistance_pa_s2_kg2(&self) -> f32 {
        0.0
    }

    /// Whether the law depends on more than inputs and flow: on the pressures at its ends, the direction of flow, or a
    /// memory of its own. It is active then, its line is a [`crate::Responsive`] one, and its law is stated every step.
    fn responds(&self) -> bool {
        false
    }

    /// Whether the law depends on the pressures at both ends. `adaptive`, whose lines have pressures at their nodes
    /// only, takes one such component a line.
    fn needs_both_ends(&self) -> bool {
        false
    }

    /// Largest chord slope of the flow over either pressure, per secant w/y, that the law can have [1]: κ of the
    /// operator's bound. (1 + √2)/2 for a root law, with a smaller conductance for reversed flow or not.
    fn chord_over_secant(&self) -> f32 {
        1.207_107
    }

    /// States the pressure law at the present operating point; for a component with a law of its own for reversed
    /// flow that for forward flow. Never panics and never returns NaN for inputs in range. For pressures in range
    /// it is a resistance: the loss never falls with flow.
    fn law(&self, _at: &Operating<'_>) -> Law {
        Law::quadratic(0.0)
    }

    /// States the law for reversed flow, of a component that [`Self::responds`].
    fn reverse_law(&self, at: &Operating<'_>) -> Law {
        self.law(at)
    }

    /// Number of `f32` that the component remembers from step to step. They are part of the state; at the start they
    /// are 0 and then advanced once by a step without end.
    fn memory(&self) -> usize {
        0
    }

    /// Advances the memory by one step of `step_s` [s, > 0, may be infinite], before the step's laws are stated.
    /// This is the only place where it changes.
    fn advance(&self, _at: &Operating<'_>, _step_s: f32, _memory: &mut [f32]) {}

    /// Whether the memory is an opening within 0…1 that follows the pressures continuously and is brought back by the
    /// pressures that it causes, so that its rest can be bracketed; otherwise it switches.
    fn settles(&self) -> bool {
        false
    }

    /// Mass taken out at the outlet per mass that leaves it, s in `w_in = (1 + s)·w_out` [≥ 0]. It acts on forward
    /// flow only: nothing is put back into reversed flow.
    fn removal(&self) -> f32 {
        0.0
    }

    /// Conductance between the component and its volume [W/K]: within a step no volume may pass the temperature of its
    /// walls.
    fn conductance_w_k(&self) -> f32 {
        0.0
    }

    /// Gas that it brings into its volume at these inputs [kg/s], whatever the volume holds.
    fn gas_kg_s(&self, _inputs: &[f32]) -> f32 {
        0.0
    }

    /// Sets state and scratch at the start; both are 0 before.
    fn start(&self, _placed: &Placed, _step: &StepContext<'_>, _block: Block<'_>) {}

    /// Exchanges masses and energy with its volume, before the flows of the step are solved.
    fn supply(
        &self,
        _placed: &Placed,
        _step: &StepContext<'_>,
        _volume: &VolumeView<'_>,
        _block: Block<'_>,
        _account: &mut Account<'_, '_>,
    ) {
    }

    /// Derives the scratch that the streams of the step meet.
    fn begin(&self, _placed: &Placed, _step: &StepContext<'_>, _block: Block<'_>) {}

    /// Lets a stream pass; of a stream at rest nothing passes, heat included.
    fn pass(
        &self,
        _placed: &Placed,
        _step: &StepContext<'_>,
        _passing: &Passing<'_>,
        _block: Block<'_>,
        _stream: &mut Stream,
    ) -> Heat {
        Heat::default()
    }

    /// Moves what the streams of the step brought into the state.
    fn settle(
        &self,
        _placed: &Placed,
        _step: &StepContext<'_>,
        _block: Block<'_>,
        _account: &mut Account<'_, '_>,
    ) {
    }

    /// Tells the ledgers the masses [kg] and energy [J] that it holds beyond its start: calls `held` with a place of
    /// [`Stored`](crate::fluid::Stored) and a summand, as often as needed. The ledgers sum in double precision; a board does not.
    fn holds(&self, _state: &[f32], _held: &mut dyn FnMut(usize, f32)) {}

    /// Returns the value of figure `item` of [`Self::OUTPUTS`].
    fn output(&self, _item: usize, _placed: &Placed, _step: &StepContext<'_>, _seen: Seen<'_>) -> f32 {
        f32::NAN
    }
}

/// Writes the struct of a component's parameters, all of them `f32`, and its conversions to and from a row. For kinds
/// outside this crate.
#[macro_export]
macro_rules! parameters {
    ($(#[$doc:meta])* pub struct $name:ident { $($(#[$about:meta])* pub $field:ident: f32,)* }) => {
        $crate::component_parameters! {
            $(#[$doc])*
            pub struct $name { $($(#[$about])* pub $field: f32,)* }
        }

        impl $name {
            /// Returns the component for a network's tables.
            pub const fn into_any(self) -> $crate::AnyComponent {
                $crate::AnyComponent::foreign::<Self>(&[$(self.$field),*])
            }
        }
    };
}

/// Writes the struct of a component's parameters and its conversions to and from a row.
#[doc(hidden)]
#[macro_export]
macro_rules! component_parameters {
    ($(#[$doc:meta])* pub struct $name:ident { $($(#[$about:meta])* pub $field:ident: f32,)* }) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub struct $name {
            $($(#[$about])* pub $field: f32,)*
        }

        impl $crate::component::Parameters for $name {
            const NAMES: &'static [&'static str] = &[$(stringify!($field)),*];

            #[inline]
            fn to_row(self) -> $crate::component::Row {
                $crate::component::pad(&[$(self.$field),*])
            }

            #[inline]
            fn from_row(row: &$crate::component::Row) -> Self {
                let [$($field,)* ..] = *row;
                Self { $($field),* }
            }
        }
    };
}
