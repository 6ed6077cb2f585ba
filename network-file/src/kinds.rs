//! The one list of kinds that network files may name: those of `eclss-core`, and a laboratory's own behind them.

use std::fmt;
use std::sync::OnceLock;

use eclss_core::component::FileKind;
use eclss_core::components::KINDS;
use eclss_core::parameter::Place;

/// Keys of every component's table.
const COMMON: [&str; 2] = ["id", "kind"];
/// Keys of every table in a line.
const IN_A_LINE: [&str; 5] = ["length_m", "diameter_m", "area_m2", "inertance_per_m", "outlet_volume_m3"];
/// Tables and keys of a file's root.
const ROOT: [&str; 12] = [
    "schema",
    "name",
    "title",
    "reference_pressure_pa",
    "run",
    "air",
    "node",
    "line",
    "control",
    "schedule",
    "process",
    "channel",
];

/// Kinds one after the other.
pub type Kinds<'k> = &'k [&'static dyn FileKind];

static LIST: OnceLock<Vec<&'static dyn FileKind>> = OnceLock::new();

/// Reason for which kinds were not registered; the list is as before then.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum RegisterError {
    /// Kinds were registered before, or a network file was read.
    Late,
    /// This kind's name is that of another kind, or of another table of the format.
    Kind(&'static str),
    /// This kind has a key or an input of this name twice, or one of a name that the format uses.
    Key(&'static str, &'static str),
}

impl fmt::Display for RegisterError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Late => f.write_str("kinds are registered once, before the first network file is read"),
            Self::Kind(kind) => write!(f, "kind `{kind}`: the name is taken"),
            Self::Key(kind, key) => write!(f, "kind `{kind}`: the key or input `{key}` is taken"),
        }
    }
}

impl std::error::Error for RegisterError {}

/// Adds a laboratory's own kinds to those of `eclss-core`, for every file that this process reads. To be called once,
/// before the first file is read.
pub fn register(own: Kinds<'_>) -> Result<(), RegisterError> {
    let list = joined(KINDS, own)?;
    LIST.set(list).map_err(|_| RegisterError::Late)
}

/// Returns all kinds that a file may name, in the order of the tables that are made of them.
pub fn all() -> &'static [&'static dyn FileKind] {
    LIST.get_or_init(|| KINDS.to_vec())
}

/// Returns the `shipped` kinds with `own` behind them.
fn joined(shipped: Kinds<'_>, own: Kinds<'_>) -> Result<Vec<&'static dyn FileKind>, RegisterError> {
    let mut list = shipped.to_vec();
    for kind in own {
        let name = kind.name();
        if ROOT.contains(&name) || list.iter().any(|known| known.name() == name) {
            return Err(RegisterError::Kind(name));
        }
        let mut taken = COMMON.to_vec();
        taken.extend_from_slice(if kind.place() == Place::Line { &IN_A_LINE } else { &["node"] });
        let keys = kind.keys().iter().copied().flatten().map(|key| key.name);
        for key in keys.chain(kind.inputs().iter().map(|input| input.name)) {
            if taken.contains(&key) {
                return Err(RegisterError::Key(name, key));
            }
            taken.push(key);
        }
        list.push(*kind);
    }
    Ok(list)
}

#[cfg(test)]
mod tests {
    use super::*;
    use eclss_core::component::{Component, Draft};
    use eclss_core::parameter::{Key, Keys, ParameterError};
    use eclss_core::parameters;

    macro_rules! kind {
        ($type:ident, $kind:literal, $place:expr, $key:literal) => {
            parameters! {
                /// A kind for a test.
                pub struct $type {
                    /// Its parameter.
                    pub value: f32,
                }
            }

            impl Component for $type {
                const KIND: &'static str = $kind;
                const ABOUT: &'static str = "A kind for a test.";
                const PLACE: Place = $place;
                const KEYS: Keys = &[&[Key::required($key, "1", (0.0, 1.0), "Its key.")]];

                fn from_file(draft: &mut Draft<'_>) -> Self {
                    Self { value: draft.single($key) }
                }

                fn check(&self) -> Result<(), ParameterError> {
                    ParameterError::unless_finite("value", self.value)
                }
            }
        };
    }

    const NODE: Place = Place::Node { holds: eclss_core::parameter::Carries::Any, boundary: true };
    kind!(Fan, "fan", Place::Line, "share");
    kind!(Channel, "channel", NODE, "share");
    kind!(Long, "long", Place::Line, "length_m");
    kind!(Good, "good", Place::Line, "share");
    kind!(Tank, "tank", NODE, "length_m");

    #[test]
    fn names_that_are_taken_are_refused_and_named() {
        let refused = |own: &[&'static dyn FileKind]| joined(KINDS, own).expect_err("a clash").to_string();
        assert_eq!(refused(&[<dyn FileKind>::of::<Fan>()]), "kind `fan`: the name is taken");
        assert_eq!(refused(&[<dyn FileKind>::of::<Channel>()]), "kind `channel`: the name is taken");
        let good = <dyn FileKind>::of::<Good>();
        assert_eq!(refused(&[good, good]), "kind `good`: the name is taken");
        let long = "kind `long`: the key or input `length_m` is taken";
        assert_eq!(refused(&[<dyn FileKind>::of::<Long>()]), long);
    }

    #[test]
    fn own_kinds_stand_behind_the_shipped_ones() {
        // `length_m` is a key of tables in lines only.
        let list =
            joined(KINDS, &[<dyn FileKind>::of::<Good>(), <dyn FileKind>::of::<Tank>()]).expect("no clash");
        let names: Vec<_> = list.iter().map(|kind| kind.name()).collect();
        assert_eq!(names[KINDS.len()..], ["good", "tank"]);
    }

    #[test]
    fn shipped_kinds_would_be_accepted_as_a_laboratorys_own() {
        assert_eq!(joined(&[], KINDS).expect("no clash"), KINDS);
    }
}
