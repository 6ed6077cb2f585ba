//! Elements: what a line is made of, and the one contract that they all keep.
//!
//! Every element receives the inlet pressure from upstream and the outlet mass flow from downstream and gives
//! outlet pressure and inlet mass flow (Qiu et al. 2017, conclusion 3). Its pressure side is a [`Law`], its
//! mass side a removal fraction.
//!
//! Signs: w > 0 from `from` to `to`; head > 0 raises the pressure in the direction of flow; removal > 0 out of
//! the air.

mod bed;
mod check_valve;
mod hatch;
mod head_curve;
mod heat_exchanger;
pub mod isentropic;
mod machine;
mod measured;
mod orifice;
mod pipe;
mod pressure_regulator;
mod reference_pipe;
mod relief_valve;
mod valve;

pub use bed::Bed;
pub use check_valve::CheckValve;
pub use hatch::Hatch;
pub use head_curve::HeadCurve;
pub use heat_exchanger::HeatExchanger;
pub use machine::{Fan, Pump};
pub use measured::Measured;
pub use orifice::Orifice;
pub use pipe::Pipe;
pub use pressure_regulator::PressureRegulator;
pub use reference_pipe::ReferencePipe;
pub use relief_valve::ReliefValve;
pub use valve::Valve;

use crate::control::ActuatorFault;
use crate::{Fingerprint, math};

/// Input of a valve that acts by itself: 0 sound, 1 stuck as it stands, 2 open, 3 closed.
const FAULT: InputSpec = InputSpec { name: "fault", unit: "1", min: 0.0, max: 3.0, default: 0.0 };

/// Smallest share of an opening that may remain when closed [1]: its square is still a normal number.
const LEAST_LEAKAGE: f32 = 1e-18;

/// The fault of a valve that acts by itself.
fn fault(inputs: &[f32]) -> ActuatorFault {
    ActuatorFault::of_input(inputs.first().copied().unwrap_or(0.0))
}

/// Pressure law of an element around its present flow:
/// `p_in − p_out = resistance·w·|w| + linear·w − head`.
///
/// An element whose law is not of this form gives the one that touches its own at the present flow in value
/// and slope.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Law {
    /// Quadratic flow resistance R [Pa·s²/kg²], ≥ 0.
    pub resistance: f32,
    /// Linear (laminar) flow resistance [Pa·s/kg], ≥ 0.
    pub linear: f32,
    /// Head at zero flow [Pa], positive in the direction from `from` to `to`.
    pub head: f32,
}

impl Law {
    /// Resistance of a closed seat [Pa·s²/kg²], and the largest of any: 1 bar drives 3e-8 kg/d through it. R·w² at
    /// 1000 kg/s and 4·R·Δp at 60 MPa stay within single precision.
    pub const TIGHT_PA_S2_KG2: f32 = 1e30;

    /// Linear resistance of a source of flow [Pa·s/kg]: 1 bar adds 1e-13 kg/s to what it carries.
    pub const SOURCE_PA_S_KG: f32 = 1e18;

    /// The law of a source of flow, whatever the pressures.
    pub fn source(flow_kg_s: f32) -> Self {
        Self { resistance: 0.0, linear: Self::SOURCE_PA_S_KG, head: Self::SOURCE_PA_S_KG * flow_kg_s }
    }

    /// Whether pressures have no say in the flow: that of a source, or none through a seat as tight as one.
    pub fn is_source(&self) -> bool {
        self.resistance <= 0.0 && self.linear >= Self::SOURCE_PA_S_KG
    }

    /// Whether it is that of a closed seat, through which nothing passes that anybody would measure.
    pub fn is_tight(&self) -> bool {
        self.resistance >= 0.5 * Self::TIGHT_PA_S2_KG2
    }

    /// A law with a quadratic loss that grows without end as an opening closes: held at [`Self::TIGHT_PA_S2_KG2`].
    pub fn closing(resistance: f32) -> Self {
        Self::quadratic(math::smaller(resistance, Self::TIGHT_PA_S2_KG2))
    }

    /// A law with a quadratic loss only.
    pub const fn quadratic(resistance: f32) -> Self {
        Self { resistance, linear: 0.0, head: 0.0 }
    }
}

/// What an element may look at when it states its [`Law`].
#[derive(Debug, Clone, Copy)]
pub struct Operating<'a> {
    /// The element's inputs in the order of [`Element::input_spec`].
    pub inputs: &'a [f32],
    /// Present mass flow at the element's inlet [kg/s].
    pub mass_flow_kg_s: f32,
    /// Present inlet density over the density for which the parameters hold, > 0; 1 where density is fixed.
    pub density_ratio: f32,
    /// Absolute pressure at the inlet [Pa], ≥ 0; present only for an element that [`Element::responds`].
    pub inlet_pa: f32,
    /// Absolute pressure at the outlet [Pa], ≥ 0; likewise.
    pub outlet_pa: f32,
    /// Temperature of the gas that comes to the element [K], > 0: of dry air as dense as that gas is at its pressure;
    /// likewise.
    pub temperature_k: f32,
    /// The element's own memory, as many slots as [`Element::memory`] says; likewise.
    pub memory: &'a [f32],
}

impl<'a> Operating<'a> {
    /// An operating point for elements that look at inputs and flow only: fixed density, and for all others the
    /// same sea-level pressure on both sides.
    pub const fn plain(inputs: &'a [f32], mass_flow_kg_s: f32) -> Self {
        Self {
            inputs,
            mass_flow_kg_s,
            density_ratio: 1.0,
            inlet_pa: 101_325.0,
            outlet_pa: 101_325.0,
            temperature_k: 293.15,
            memory: &[],
        }
    }
}

/// Name, unit and valid range of one input of an element.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InputSpec {
    /// Name within the element, as in `valve.opening`.
    pub name: &'static str,
    /// Unit, `1` for a ratio.
    pub unit: &'static str,
    /// Smallest allowed value.
    pub min: f32,
    /// Largest allowed value.
    pub max: f32,
    /// Value when nobody sets it.
    pub default: f32,
}

impl InputSpec {
    /// Whether its values are whole numbers that stand for something: a fault.
    pub fn is_code(&self) -> bool {
        self.name == "fault" || self.name.ends_with("_fault")
    }
}

/// Why a parameter was refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Reason {
    /// NaN or infinite.
    NotFinite,
    /// Below zero where only zero and more make sense.
    Negative,
    /// Zero or below where only more than zero makes sense.
    NotPositive,
    /// Outside 0…1.
    NotAFraction,
    /// Outside the range for which the law is known.
    OutsideValidity,
    /// The head curve does not fall strictly with flow.
    NotFalling,
}

/// A parameter that was refused, and why.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ParameterError {
    /// Name of the parameter as in the element's struct.
    pub parameter: &'static str,
    /// What is wrong with it.
    pub reason: Reason,
}

impl ParameterError {
    /// Refuses NaN and infinities.
    pub const fn unless_finite(parameter: &'static str, value: f32) -> Result<(), Self> {
        if value.is_finite() { Ok(()) } else { Err(Self { parameter, reason: Reason::NotFinite }) }
    }

    /// Refuses NaN, infinities and values below zero.
    pub fn unless_not_negative(parameter: &'static str, value: f32) -> Result<(), Self> {
        Self::unless_finite(parameter, value)?;
        if value < 0.0 { Err(Self { parameter, reason: Reason::Negative }) } else { Ok(()) }
    }

    /// Refuses NaN, infinities, zero and values below zero.
    pub fn unless_positive(parameter: &'static str, value: f32) -> Result<(), Self> {
        Self::unless_finite(parameter, value)?;
        if value > 0.0 { Ok(()) } else { Err(Self { parameter, reason: Reason::NotPositive }) }
    }

    /// Refuses what lies outside 0…1.
    pub fn unless_fraction(parameter: &'static str, value: f32) -> Result<(), Self> {
        Self::unless_finite(parameter, value)?;
        if (0.0..=1.0).contains(&value) {
            Ok(())
        } else {
            Err(Self { parameter, reason: Reason::NotAFraction })
        }
    }
}

/// The contract of an element. A laboratory implements it for its own enum and gets every method for it.
pub trait Element {
    /// Name, unit and range of input `index`; `None` from the first index that does not exist.
    fn input_spec(&self, index: usize) -> Option<InputSpec>;

    /// Whether the law depends on inputs, flow or density; a law that does not is evaluated once, and must be
    /// purely quadratic.
    fn is_active(&self) -> bool;

    /// Whether the law changes with the flow, so that a method which solves for the flow has to ask again.
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

    /// Whether the element looks at more than inputs and flow: at the pressures at its ends, at the direction of
    /// flow, or at a memory of its own. It is active then, and its line is a [`crate::Responsive`] one, whose laws
    /// are stated anew in every step.
    fn responds(&self) -> bool {
        false
    }

    /// Whether the law itself depends on the pressures at both ends. `adaptive`, whose lines have pressures at
    /// their nodes only, takes one such element a line.
    fn needs_both_ends(&self) -> bool {
        false
    }

    /// Largest chord slope of the flow over either pressure, per secant w/y, that the law can have [1]: κ of the
    /// operator's bound. (1 + √2)/2 for a root law, with a smaller conductance for reversed flow or not.
    fn chord_over_secant(&self) -> f32 {
        1.207_107
    }

    /// States the pressure law at the present operating point; for an element with a law of its own for reversed
    /// flow that for forward flow. Never panics and never returns NaN for inputs in range. For pressures in range
    /// it is a resistance: what it loses never falls with flow.
    fn law(&self, at: &Operating<'_>) -> Law;

    /// States the law for reversed flow; asked only of an element that [`Self::responds`].
    fn reverse_law(&self, at: &Operating<'_>) -> Law {
        self.law(at)
    }

    /// Number of `f32` that the element remembers from step to step. They are part of the state; at the start they
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

    /// Mass taken out at the element's outlet per mass that leaves it, s in `w_in = (1 + s)·w_out` [≥ 0]. It
    /// acts on forward flow only: nothing is put back into reversed flow.
    fn removal(&self) -> f32 {
        0.0
    }

    /// Finds the first parameter outside its valid range.
    fn check(&self) -> Result<(), ParameterError>;

    /// Adds kind and parameters to the network's id.
    fn feed(&self, hash: &mut Fingerprint);
}

/// The elements that come with this crate.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum StdElement {
    /// Duct, filter or grille with a quadratic loss.
    Pipe(Pipe),
    /// Loss known by one measured point and an exponent.
    ReferencePipe(ReferencePipe),
    /// Control valve.
    Valve(Valve),
    /// Fan.
    Fan(Fan),
    /// Pump.
    Pump(Pump),
    /// Condensing heat exchanger, as a resistance with condensate taken out.
    HeatExchanger(HeatExchanger),
    /// Adsorption bed, as a resistance with a species taken out.
    Bed(Bed),
    /// Real hardware whose flow is an input.
    Measured(Measured),
    /// Leak or opening with isentropic, choked flow.
    Orifice(Orifice),
    /// Passes forward flow only.
    CheckValve(CheckValve),
    /// Opens at one pressure and closes at a lower one.
    ReliefValve(ReliefValve),
    /// Holds the pressure at its outlet.
    PressureRegulator(PressureRegulator),
    /// Opening between modules.
    Hatch(Hatch),
}

/// Calls one method of the element inside, whichever it is.
macro_rules! each {
    ($element:expr, $inner:ident => $call:expr) => {
        match $element {
            StdElement::Pipe($inner) => $call,
            StdElement::ReferencePipe($inner) => $call,
            StdElement::Valve($inner) => $call,
            StdElement::Fan($inner) => $call,
            StdElement::Pump($inner) => $call,
            StdElement::HeatExchanger($inner) => $call,
            StdElement::Bed($inner) => $call,
            StdElement::Measured($inner) => $call,
            StdElement::Orifice($inner) => $call,
            StdElement::CheckValve($inner) => $call,
            StdElement::ReliefValve($inner) => $call,
            StdElement::PressureRegulator($inner) => $call,
            StdElement::Hatch($inner) => $call,
        }
    };
}

/// Laws are inlined so that a description known at compile time leaves only the arithmetic of its elements.
#[allow(clippy::inline_always, reason = "specialised by a compiled network")]
impl Element for StdElement {
    fn input_spec(&self, index: usize) -> Option<InputSpec> {
        each!(self, element => element.input_spec(index))
    }

    #[inline(always)]
    fn is_active(&self) -> bool {
        each!(self, element => element.is_active())
    }

    #[inline(always)]
    fn follows_flow(&self) -> bool {
        each!(self, element => element.follows_flow())
    }

    #[inline(always)]
    fn may_be_linear(&self) -> bool {
        each!(self, element => element.may_be_linear())
    }

    #[inline(always)]
    fn law(&self, at: &Operating<'_>) -> Law {
        each!(self, element => element.law(at))
    }

    #[inline(always)]
    fn responds(&self) -> bool {
        each!(self, element => element.responds())
    }

    fn least_resistance_pa_s2_kg2(&self) -> f32 {
        each!(self, element => element.least_resistance_pa_s2_kg2())
    }

    fn needs_both_ends(&self) -> bool {
        each!(self, element => element.needs_both_ends())
    }

    fn chord_over_secant(&self) -> f32 {
        each!(self, element => element.chord_over_secant())
    }

    fn reverse_law(&self, at: &Operating<'_>) -> Law {
        each!(self, element => element.reverse_law(at))
    }

    fn memory(&self) -> usize {
        each!(self, element => element.memory())
    }

    fn advance(&self, at: &Operating<'_>, step_s: f32, memory: &mut [f32]) {
        each!(self, element => element.advance(at, step_s, memory));
    }

    fn settles(&self) -> bool {
        each!(self, element => element.settles())
    }

    #[inline(always)]
    fn removal(&self) -> f32 {
        each!(self, element => element.removal())
    }

    fn check(&self) -> Result<(), ParameterError> {
        each!(self, element => element.check())
    }

    fn feed(&self, hash: &mut Fingerprint) {
        each!(self, element => element.feed(hash));
    }
}
