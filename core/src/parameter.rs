//! Parameters, inputs, outputs and file keys: how a component declares them, and why one is refused.

/// Reason for which a parameter was refused.
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

/// A refused parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ParameterError {
    /// Name of the parameter as in the component's struct.
    pub parameter: &'static str,
    /// The reason.
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

/// Name, unit and valid range of one input of a component.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InputSpec {
    /// Name within the component, as in `valve.opening`.
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
    /// Opening of a valve or of a free cross-section, open by default.
    pub const OPENING: Self = Self { name: "opening", unit: "1", min: 0.0, max: 1.0, default: 1.0 };
    /// Speed of a fan or pump over its rated speed.
    pub const SPEED: Self = Self { name: "speed", unit: "1", min: 0.0, max: 2.0, default: 1.0 };
    /// Fault of a valve that acts by itself: 0 none, 1 stuck, 2 open, 3 closed.
    pub const FAULT: Self = Self { name: "fault", unit: "1", min: 0.0, max: 3.0, default: 0.0 };

    /// Whether its values are whole numbers that stand for something: a fault.
    pub fn is_code(&self) -> bool {
        self.name == "fault" || self.name.ends_with("_fault")
    }
}

/// Contents of a line or a volume that a component needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Carries {
    /// Air or coolant.
    Any,
    /// Air.
    Air,
    /// Coolant.
    Coolant,
}

/// Where a component stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// In a line, as a `[[line.element]]`.
    Line,
    /// At a node of its own key `node`, as a table of its kind's name.
    Node {
        /// Contents of the node.
        holds: Carries,
        /// Whether the node may be a boundary.
        boundary: bool,
    },
}

/// A parameter that a step does not allow.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct StepBound {
    /// Name of the parameter.
    pub parameter: &'static str,
    /// Smallest value that the step allows, in the parameter's unit.
    pub least: f32,
    /// Its unit.
    pub unit: &'static str,
}

/// Kind of value that a key of a network file takes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum KeyType {
    /// A number in a unit.
    Number {
        /// Unit, `1` for a ratio.
        unit: &'static str,
        /// Smallest allowed value.
        min: f64,
        /// Largest allowed value.
        max: f64,
    },
    /// True or false.
    Flag,
    /// One of these words.
    Choice(&'static [&'static str]),
    /// Id of another component.
    Component,
}

/// Whether a key must be given.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Presence {
    /// It must.
    Required,
    /// It may be left out; the component says in its text what happens then.
    Optional,
    /// It may be left out and then has this value.
    Default(f64),
}

/// One key of a component's table in a network file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Key {
    /// The key, with its unit as suffix.
    pub name: &'static str,
    /// Kind of value that it takes.
    pub holds: KeyType,
    /// Whether it must be given.
    pub presence: Presence,
    /// Meaning, one sentence for the format's document.
    pub about: &'static str,
}

impl Key {
    /// Returns a number that must be given.
    pub const fn required(
        name: &'static str,
        unit: &'static str,
        (min, max): (f64, f64),
        about: &'static str,
    ) -> Self {
        Self { name, holds: KeyType::Number { unit, min, max }, presence: Presence::Required, about }
    }

    /// Returns a number that may be left out.
    pub const fn optional(
        name: &'static str,
        unit: &'static str,
        (min, max): (f64, f64),
        about: &'static str,
    ) -> Self {
        Self { name, holds: KeyType::Number { unit, min, max }, presence: Presence::Optional, about }
    }

    /// Returns the same key with the value that it has when it is left out.
    #[must_use]
    pub const fn or(self, default: f64) -> Self {
        Self { presence: Presence::Default(default), ..self }
    }

    /// Returns a flag, false when left out.
    pub const fn flag(name: &'static str, about: &'static str) -> Self {
        Self { name, holds: KeyType::Flag, presence: Presence::Optional, about }
    }

    /// Returns a word out of a list, which must be given.
    pub const fn choice(name: &'static str, words: &'static [&'static str], about: &'static str) -> Self {
        Self { name, holds: KeyType::Choice(words), presence: Presence::Required, about }
    }

    /// Returns the id of another component, which must be given.
    pub const fn component(name: &'static str, about: &'static str) -> Self {
        Self { name, holds: KeyType::Component, presence: Presence::Required, about }
    }
}

/// Groups of keys, so that components share those of a loss or of a head curve.
pub type Keys = &'static [&'static [Key]];
