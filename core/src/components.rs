//! The kinds that come with this crate, one file each.

/// Names every kind once: its file and its type. The first token is a dollar sign, for the macro that this one writes.
macro_rules! components {
    (($d:tt) $($file:ident: $name:ident,)*) => {
        $(pub mod $file; pub use $file::$name;)*

        /// The kinds that come with this crate, in the order of the format's document.
        pub static KINDS: &[&dyn FileKind] = &[$(<dyn FileKind>::of::<$name>()),*];

        /// A component of any kind, for the tables of a network.
        #[derive(Clone, Copy, PartialEq)]
        pub enum AnyComponent {
            $(
                #[doc = concat!("See [`", stringify!($name), "`].")]
                $name($name),
            )*
            /// A component of a kind that this crate does not list.
            Foreign(Foreign),
        }

        impl AnyComponent {
            /// Returns the component of a shipped kind with these parameters.
            pub(crate) fn shipped(kind: &str, row: &Row) -> Option<Self> {
                $(
                    if kind == <$name as Component>::KIND {
                        return Some(Self::$name($name::from_row(row)));
                    }
                )*
                None
            }
        }

        $(
            impl $name {
                /// Returns the component for a network's tables.
                pub const fn into_any(self) -> AnyComponent {
                    AnyComponent::$name(self)
                }
            }
        )*

        /// Calls one function of a component, by its type where the kind is shipped.
        macro_rules! each {
            ($d any:expr, $d component:ident => $d own:expr, $d foreign:ident => $d other:expr) => {
                match $d any {
                    $($d crate::component::AnyComponent::$name($d component) => $d own,)*
                    $d crate::component::AnyComponent::Foreign($d foreign) => $d other,
                }
            };
        }
        pub(crate) use each;
    };
}

pub mod coil;
mod head_curve;
pub mod isentropic;
pub mod loss;
mod seat;
pub mod separator;
mod turbomachine;

use crate::component::{Component, FileKind, Foreign, Parameters, Row};
pub use head_curve::HeadCurve;

components! {
    ($)
    pipe: Pipe,
    reference_pipe: ReferencePipe,
    valve: Valve,
    fan: Fan,
    pump: Pump,
    heat_exchanger: HeatExchanger,
    bed: Bed,
    condensing_heat_exchanger: CondensingHeatExchanger,
    coolant_side: CoolantSide,
    interface_exchanger: InterfaceExchanger,
    heater: Heater,
    measured: Measured,
    orifice: Orifice,
    leak: Leak,
    check_valve: CheckValve,
    relief_valve: ReliefValve,
    pressure_regulator: PressureRegulator,
    hatch: Hatch,
    crew: Crew,
    source: Source,
    remover: Remover,
    wall: Wall,
}
