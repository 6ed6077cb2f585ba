//! Components of any kind side by side: shipped kinds by their type, others by a row of parameters and a reference to the
//! functions of their kind.

use core::fmt;
use core::marker::PhantomData;

use super::{AnyComponent, Block, Component, Heat, Parameters, Passing, Placed, Seen, StepContext, Volumes};
use crate::Fingerprint;
use crate::components::each;
use crate::fluid::Stream;
use crate::fluid::books::Accounts;
use crate::law::{Law, Operating};
use crate::parameter::{Carries, InputSpec, ParameterError, Place, StepBound};
use crate::signal::OutputSpec;

/// Most parameters that a component may have.
pub const ROW: usize = 16;

/// Parameters of one component, padded with zeros.
pub type Row = [f32; ROW];

/// Returns a row of at most [`ROW`] parameters.
pub const fn pad(parameters: &[f32]) -> Row {
    let mut row = [0.0; ROW];
    let mut place = 0;
    while place < parameters.len() {
        row[place] = parameters[place];
        place += 1;
    }
    row
}

/// A kind without its type: the functions of [`Component`] over rows of parameters. Implemented for every component;
/// not to be implemented by hand.
pub trait Kind: Sync {
    /// [`Component::KIND`].
    fn name(&self) -> &'static str;
    /// Path of the component's type in Rust source.
    fn path(&self) -> &'static str;
    /// Names of the parameters in the order of the row.
    fn parameters(&self) -> &'static [&'static str];
    /// [`Component::check`].
    fn check(&self, row: &Row) -> Result<(), ParameterError>;
    /// [`Component::input_spec`].
    fn input_spec(&self, row: &Row, index: usize) -> Option<InputSpec>;
    /// [`Component::is_active`].
    fn is_active(&self, row: &Row) -> bool;
    /// [`Component::follows_flow`].
    fn follows_flow(&self, row: &Row) -> bool;
    /// [`Component::may_be_linear`].
    fn may_be_linear(&self, row: &Row) -> bool;
    /// [`Component::least_resistance_pa_s2_kg2`].
    fn least_resistance_pa_s2_kg2(&self, row: &Row) -> f32;
    /// [`Component::responds`].
    fn responds(&self, row: &Row) -> bool;
    /// [`Component::needs_both_ends`].
    fn needs_both_ends(&self, row: &Row) -> bool;
    /// [`Component::chord_over_secant`].
    fn chord_over_secant(&self, row: &Row) -> f32;
    /// [`Component::law`].
    fn law(&self, row: &Row, at: &Operating<'_>) -> Law;
    /// [`Component::reverse_law`].
    fn reverse_law(&self, row: &Row, at: &Operating<'_>) -> Law;
    /// [`Component::memory`].
    fn memory(&self, row: &Row) -> usize;
    /// [`Component::advance`].
    fn advance(&self, row: &Row, at: &Operating<'_>, step_s: f32, memory: &mut [f32]);
    /// [`Component::settles`].
    fn settles(&self, row: &Row) -> bool;
    /// [`Component::removal`].
    fn removal(&self, row: &Row) -> f32;
    /// [`Component::SIDES`].
    fn sides(&self) -> &'static [Carries];
    /// [`Component::PLACE`].
    fn place(&self) -> Place;
    /// [`Component::OUTPUTS`].
    fn output_specs(&self) -> &'static [OutputSpec];
    /// [`Component::STATE`] and [`Component::SCRATCH`].
    fn blocks(&self) -> [usize; 2];
    /// [`Component::SUPPLIES`] and [`Component::SETTLES`].
    fn acts(&self) -> [bool; 2];
    /// [`Component::check_step`].
    fn check_step(&self, row: &Row, step_s: f32) -> Result<(), StepBound>;
    /// [`Component::conductance_w_k`].
    fn conductance_w_k(&self, row: &Row) -> f32;
    /// [`Component::gas_kg_s`].
    fn gas_kg_s(&self, row: &Row, inputs: &[f32]) -> f32;
    /// [`Component::start`] of a table.
    fn start(&self, table: &[Placed], step: &StepContext<'_>, blocks: Block<'_>);
    /// [`Component::supply`] of a table.
    fn supply(
        &self,
        table: &[Placed],
        step: &StepContext<'_>,
        volumes: Volumes<'_>,
        blocks: Block<'_>,
        accounts: &mut Accounts<'_>,
    );
    /// [`Component::begin`] of a table.
    fn begin(&self, table: &[Placed], step: &StepContext<'_>, blocks: Block<'_>);
    /// [`Component::pass`].
    fn pass(
        &self,
        placed: &Placed,
        step: &StepContext<'_>,
        passing: &Passing<'_>,
        block: Block<'_>,
        stream: &mut Stream,
    ) -> Heat;
    /// [`Component::settle`] of a table.
    fn settle(
        &self,
        table: &[Placed],
        step: &StepContext<'_>,
        blocks: Block<'_>,
        accounts: &mut Accounts<'_>,
    );
    /// [`Component::holds`].
    fn holds(&self, row: &Row, state: &[f32], held: &mut dyn FnMut(usize, f32));
    /// [`Component::output`].
    fn output(&self, item: usize, placed: &Placed, step: &StepContext<'_>, seen: Seen<'_>) -> f32;
}

impl fmt::Debug for dyn Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Cuts the blocks of a table's components, one after the other.
struct Blocks<'b>(Block<'b>);

impl Blocks<'_> {
    #[inline]
    fn next<C: Component>(&mut self) -> Block<'_> {
        let Block { state, scratch } = &mut self.0;
        let (own, rest) = core::mem::take(state).split_at_mut_checked(C::STATE).unwrap_or_default();
        *state = rest;
        let (derived, rest) = core::mem::take(scratch).split_at_mut_checked(C::SCRATCH).unwrap_or_default();
        *scratch = rest;
        Block { state: own, scratch: derived }
    }
}

/// The kind of the components `C`.
pub(super) struct Of<C>(PhantomData<fn() -> C>);

impl<C: Component> Of<C> {
    pub(super) const KIND: &'static Self = &Self(PhantomData);
}

/// Forwards every function to the component that a row describes.
macro_rules! forward {
    ($($function:ident($($argument:ident: $kind:ty),*) $(-> $result:ty)?;)*) => {
        $(
            #[inline]
            fn $function(&self, row: &Row $(, $argument: $kind)*) $(-> $result)? {
                C::from_row(row).$function($($argument),*)
            }
        )*
    };
}

impl<C: Component> Kind for Of<C> {
    fn name(&self) -> &'static str {
        C::KIND
    }

    fn path(&self) -> &'static str {
        core::any::type_name::<C>()
    }

    fn parameters(&self) -> &'static [&'static str] {
        <C as Parameters>::NAMES
    }

    forward! {
        check() -> Result<(), ParameterError>;
        input_spec(index: usize) -> Option<InputSpec>;
        is_active() -> bool;
        follows_flow() -> bool;
        may_be_linear() -> bool;
        least_resistance_pa_s2_kg2() -> f32;
        responds() -> bool;
        needs_both_ends() -> bool;
        chord_over_secant() -> f32;
        law(at: &Operating<'_>) -> Law;
        reverse_law(at: &Operating<'_>) -> Law;
        memory() -> usize;
        advance(at: &Operating<'_>, step_s: f32, memory: &mut [f32]);
        settles() -> bool;
        removal() -> f32;
        check_step(step_s: f32) -> Result<(), StepBound>;
        conductance_w_k() -> f32;
        gas_kg_s(inputs: &[f32]) -> f32;
        holds(state: &[f32], held: &mut dyn FnMut(usize, f32));
    }

    fn sides(&self) -> &'static [Carries] {
        C::SIDES
    }

    fn place(&self) -> Place {
        C::PLACE
    }

    fn output_specs(&self) -> &'static [OutputSpec] {
        C::OUTPUTS
    }

    fn blocks(&self) -> [usize; 2] {
        [C::STATE, C::SCRATCH]
    }

    fn acts(&self) -> [bool; 2] {
        [C::SUPPLIES, C::SETTLES]
    }

    fn start(&self, table: &[Placed], step: &StepContext<'_>, blocks: Block<'_>) {
        let mut blocks = Blocks(blocks);
        for placed in table {
            C::from_row(&placed.row).start(placed, step, blocks.next::<C>());
        }
    }

    fn supply(
        &self,
        table: &[Placed],
        step: &StepContext<'_>,
        volumes: Volumes<'_>,
        blocks: Block<'_>,
        accounts: &mut Accounts<'_>,
    ) {
        let mut blocks = Blocks(blocks);
        for placed in table {
            let (block, volume) = (blocks.next::<C>(), volumes.view(placed.node));
            let mut account = accounts.account(placed.node);
            C::from_row(&placed.row).supply(placed, step, &volume, block, &mut account);
        }
    }

    fn begin(&self, table: &[Placed], step: &StepContext<'_>, blocks: Block<'_>) {
        let mut blocks = Blocks(blocks);
        for placed in table {
            C::from_row(&placed.row).begin(placed, step, blocks.next::<C>());
        }
    }

    #[inline]
    fn pass(
        &self,
        placed: &Placed,
        step: &StepContext<'_>,
        passing: &Passing<'_>,
        block: Block<'_>,
        stream: &mut Stream,
    ) -> Heat {
        C::from_row(&placed.row).pass(placed, step, passing, block, stream)
    }

    fn settle(
        &self,
        table: &[Placed],
        step: &StepContext<'_>,
        blocks: Block<'_>,
        accounts: &mut Accounts<'_>,
    ) {
        let mut blocks = Blocks(blocks);
        for placed in table {
            let block = blocks.next::<C>();
            C::from_row(&placed.row).settle(placed, step, block, &mut accounts.account(placed.node));
        }
    }

    fn output(&self, item: usize, placed: &Placed, step: &StepContext<'_>, seen: Seen<'_>) -> f32 {
        C::from_row(&placed.row).output(item, placed, step, seen)
    }
}

/// A component of a kind that this crate does not list: its parameters and a reference to its kind.
#[derive(Clone, Copy)]
pub struct Foreign {
    kind: &'static dyn Kind,
    row: Row,
}

impl PartialEq for Foreign {
    fn eq(&self, other: &Self) -> bool {
        self.kind.name() == other.kind.name() && self.row == other.row
    }
}

/// Writes the functions of a component in a network's tables. Shipped kinds are called by their type, so that those of a
/// network that is known when a program is compiled leave only their arithmetic.
macro_rules! erased {
    ($($(#[doc = $doc:literal])* $(#[inline($inline:ident)])? $function:ident($($argument:ident: $kind:ty),*) $(-> $result:ty)?;)*) => {
        /// The functions of a component in a network's tables.
        pub trait Element {
            $(
                $(#[doc = $doc])*
                fn $function(&self $(, $argument: $kind)*) $(-> $result)?;
            )*

            /// Adds kind and parameters to a network's id.
            fn hash_into(&self, hash: &mut Fingerprint);
        }

        #[allow(clippy::inline_always, reason = "specialised by a network that is compiled in")]
        impl Element for AnyComponent {
            $(
                $(#[inline($inline)])?
                fn $function(&self $(, $argument: $kind)*) $(-> $result)? {
                    each!(
                        self,
                        component => Component::$function(component $(, $argument)*),
                        foreign => foreign.kind.$function(&foreign.row $(, $argument)*)
                    )
                }
            )*

            fn hash_into(&self, hash: &mut Fingerprint) {
                for byte in self.kind().bytes() {
                    hash.word(u32::from(byte));
                }
                for (_, value) in self.parameters() {
                    hash.value(value);
                }
            }
        }
    };
}

impl AnyComponent {
    /// Returns a component of a kind that this crate does not list, with its parameters in the order of their names.
    pub const fn foreign<C: Component>(parameters: &[f32]) -> Self {
        Self::Foreign(Foreign { kind: Of::<C>::KIND, row: pad(parameters) })
    }

    /// Returns a component of kind `C` with its parameters as a row.
    pub fn new<C: Component>(row: Row) -> Self {
        Self::erase(Of::<C>::KIND, row)
    }

    pub(super) fn erase(kind: &'static dyn Kind, row: Row) -> Self {
        Self::shipped(kind.name(), &row).unwrap_or(Self::Foreign(Foreign { kind, row }))
    }

    /// Returns the component as its own type; `None` if it is of another kind.
    pub fn get<C: Component>(&self) -> Option<C> {
        self.is::<C>().then(|| C::from_row(&self.row()))
    }

    /// Whether the component is of kind `C`.
    pub fn is<C: Component>(&self) -> bool {
        self.kind() == C::KIND
    }

    /// Returns the functions of its kind.
    pub fn erased(&self) -> &'static dyn Kind {
        fn of<C: Component>(_: &C) -> &'static dyn Kind {
            Of::<C>::KIND
        }
        each!(self, component => of(component), foreign => foreign.kind)
    }

    /// Returns the parameters as a row.
    pub fn row(&self) -> Row {
        each!(self, component => component.to_row(), foreign => foreign.row)
    }

    /// Returns the word of its kind in network files.
    pub fn kind(&self) -> &'static str {
        self.erased().name()
    }

    /// Returns the component as Rust source: an expression for constant tables.
    pub fn source(&self) -> impl fmt::Display + use<> {
        Source(*self)
    }

    /// Returns the parameters by their names.
    pub fn parameters(&self) -> impl Iterator<Item = (&'static str, f32)> {
        self.erased().parameters().iter().copied().zip(self.row())
    }
}

/// A component as Rust source.
struct Source(AnyComponent);

impl fmt::Display for Source {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let path = self.0.erased().path();
        if let AnyComponent::Foreign(_) = self.0 {
            let row = self.0.row();
            let given = row.get(..self.0.erased().parameters().len()).unwrap_or(&row);
            return write!(f, "AnyComponent::foreign::<::{path}>(&{given:?})");
        }
        write!(f, "::{path} {{ ")?;
        for (name, value) in self.0.parameters() {
            write!(f, "{name}: {value:?}, ")?;
        }
        f.write_str("}.into_any()")
    }
}

erased! {
    /// See [`Component::check`].
    check() -> Result<(), ParameterError>;
    /// See [`Component::input_spec`].
    input_spec(index: usize) -> Option<InputSpec>;
    /// See [`Component::is_active`].
    #[inline(always)]
    is_active() -> bool;
    /// See [`Component::follows_flow`].
    #[inline(always)]
    follows_flow() -> bool;
    /// See [`Component::may_be_linear`].
    #[inline(always)]
    may_be_linear() -> bool;
    /// See [`Component::least_resistance_pa_s2_kg2`].
    least_resistance_pa_s2_kg2() -> f32;
    /// See [`Component::responds`].
    #[inline(always)]
    responds() -> bool;
    /// See [`Component::needs_both_ends`].
    needs_both_ends() -> bool;
    /// See [`Component::chord_over_secant`].
    chord_over_secant() -> f32;
    /// See [`Component::law`].
    #[inline(always)]
    law(at: &Operating<'_>) -> Law;
    /// See [`Component::reverse_law`].
    reverse_law(at: &Operating<'_>) -> Law;
    /// See [`Component::memory`].
    memory() -> usize;
    /// See [`Component::advance`].
    advance(at: &Operating<'_>, step_s: f32, memory: &mut [f32]);
    /// See [`Component::settles`].
    settles() -> bool;
    /// See [`Component::removal`].
    #[inline(always)]
    removal() -> f32;
}

impl fmt::Debug for AnyComponent {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut text = f.debug_struct(self.kind());
        for (name, value) in self.parameters() {
            text.field(name, &value);
        }
        text.finish()
    }
}
