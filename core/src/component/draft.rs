//! A component's table of a network file on its way to parameters. Runs where files are read, never in a step.

use core::fmt::{self, Arguments};

use super::any::Of;
use super::{AnyComponent, Component};
use crate::parameter::{Carries, InputSpec, Key, Keys, Place, Presence};
use crate::signal::OutputSpec;

/// A kind as network files see it. Implemented for every component; not to be implemented by hand.
pub trait FileKind: Sync {
    /// [`Component::KIND`].
    fn name(&self) -> &'static str;
    /// [`Component::ABOUT`].
    fn about(&self) -> &'static str;
    /// [`Component::KEYS`].
    fn keys(&self) -> Keys;
    /// [`Component::INPUTS`].
    fn inputs(&self) -> &'static [InputSpec];
    /// [`Component::PLACE`].
    fn place(&self) -> Place;
    /// [`Component::SIDES`].
    fn sides(&self) -> &'static [Carries];
    /// [`Component::IDLE_WHEN_LINKED`].
    fn idle_when_linked(&self) -> &'static [&'static str];
    /// [`Component::OUTPUTS`].
    fn outputs(&self) -> &'static [OutputSpec];
    /// Path of the component's type in Rust source.
    fn path(&self) -> &'static str;
    /// Returns the component that a table describes; findings go to the table.
    fn read(&self, table: &mut dyn FileTable, line: LineFacts) -> AnyComponent;
}

impl dyn FileKind {
    /// Returns the kind of the components `C`.
    pub const fn of<C: Component>() -> &'static dyn FileKind {
        Of::<C>::KIND
    }
}

impl fmt::Debug for dyn FileKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl PartialEq for dyn FileKind {
    fn eq(&self, other: &Self) -> bool {
        self.name() == other.name()
    }
}

impl<C: Component> FileKind for Of<C> {
    fn name(&self) -> &'static str {
        C::KIND
    }

    fn about(&self) -> &'static str {
        C::ABOUT
    }

    fn keys(&self) -> Keys {
        C::KEYS
    }

    fn inputs(&self) -> &'static [InputSpec] {
        C::INPUTS
    }

    fn place(&self) -> Place {
        C::PLACE
    }

    fn sides(&self) -> &'static [Carries] {
        C::SIDES
    }

    fn idle_when_linked(&self) -> &'static [&'static str] {
        C::IDLE_WHEN_LINKED
    }

    fn outputs(&self) -> &'static [OutputSpec] {
        C::OUTPUTS
    }

    fn path(&self) -> &'static str {
        core::any::type_name::<C>()
    }

    fn read(&self, table: &mut dyn FileTable, line: LineFacts) -> AnyComponent {
        let mut draft = Draft { table, keys: C::KEYS, line };
        AnyComponent::new::<C>(C::from_file(&mut draft).to_row())
    }
}

/// One table of a network file whose keys, types and ranges were checked.
pub trait FileTable {
    /// Returns a number that the file gives.
    fn number(&self, key: &str) -> Option<f64>;
    /// Returns a flag that the file gives.
    fn flag(&self, key: &str) -> Option<bool>;
    /// Returns the place of a word that the file gives in its key's list.
    fn choice(&self, key: &str) -> Option<usize>;
    /// Notes a finding at a key.
    fn refuse(&mut self, key: &'static str, reason: Arguments<'_>);
}

/// Data of the line that a component may read at the start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LineFacts {
    /// Reference density [kg/m³]; 0 for a line out of a vacuum, or whose coolant is unknown.
    pub density_kg_m3: f64,
    /// Flow area of the component's own `diameter_m` or `area_m2` [m²].
    pub area_m2: Option<f64>,
    /// Absolute pressure of the line's node of higher pressure [Pa].
    pub high_pa: f64,
    /// Temperature of that node [K].
    pub high_k: f64,
    /// Temperature of the `from` node [K].
    pub from_k: f64,
    /// Whether the network has heat and moisture, `[air]`.
    pub has_air: bool,
}

/// A component's table while its parameters are derived, in double precision and rounded once.
pub struct Draft<'a> {
    table: &'a mut dyn FileTable,
    keys: Keys,
    /// The line around the component.
    pub line: LineFacts,
}

impl Draft<'_> {
    fn key(&self, name: &str) -> Option<&'static Key> {
        self.keys.iter().copied().flatten().find(|key| key.name == name)
    }

    /// Returns a number, or the default of its key; 0 for a key that is missing, which was refused when it was read.
    pub fn number(&self, name: &str) -> f64 {
        self.optional(name).unwrap_or(match self.key(name).map(|key| key.presence) {
            Some(Presence::Default(value)) => value,
            _ => 0.0,
        })
    }

    /// Returns a number in single precision, or the default of its key.
    pub fn single(&self, name: &str) -> f32 {
        self.number(name) as f32
    }

    /// Returns a number that the file gives; `None` where it leaves the key out.
    pub fn optional(&self, name: &str) -> Option<f64> {
        self.table.number(name)
    }

    /// Returns a flag; false where the file leaves the key out.
    pub fn flag(&self, name: &str) -> bool {
        self.table.flag(name).unwrap_or(false)
    }

    /// Returns the place of a word in its key's list.
    pub fn choice(&self, name: &str) -> f32 {
        self.table.choice(name).unwrap_or(0) as f32
    }

    /// Refuses the value of a key.
    pub fn refuse(&mut self, key: &'static str, reason: Arguments<'_>) {
        self.table.refuse(key, reason);
    }

    /// Refuses the component in a network without heat and moisture.
    pub fn needs_air(&mut self) {
        if !self.line.has_air {
            self.refuse("kind", format_args!("this needs heat and moisture: add a table `[air]`"));
        }
    }

    /// Rounds a derived parameter and refuses one outside `min … max`.
    pub fn fit(&mut self, key: &'static str, value: f64, (min, max): (f64, f64), unit: &str) -> f32 {
        let rounded = value as f32;
        if (min..=max).contains(&value) && rounded.is_finite() && (value == 0.0 || rounded != 0.0) {
            return rounded;
        }
        self.refuse(key, format_args!("`{key}` comes out as {value:e}, outside {min:e} … {max:e} {unit}"));
        1.0
    }

    /// Returns the reference density of the line [kg/m³] for a key that needs one.
    pub fn density(&mut self, key: &'static str) -> f64 {
        if self.line.density_kg_m3 > 0.0 {
            return self.line.density_kg_m3;
        }
        let reason = "and the line starts in a vacuum or at a boundary of coolant: give it a `reference_density_kg_m3`";
        self.refuse(key, format_args!("`{key}` needs a density, {reason}"));
        1.0
    }

    /// Returns the flow area [m²] for a key that needs one.
    pub fn area(&mut self, key: &'static str) -> f64 {
        self.line.area_m2.unwrap_or_else(|| {
            self.refuse(key, format_args!("`{key}` needs a `diameter_m` or an `area_m2`"));
            1.0
        })
    }
}
