//! The kinds that come with this crate, one file each.

/// Names every kind once: its file and its type.
macro_rules! components {
    ($($file:ident: $name:ident,)*) => {
        $(pub mod $file; pub use $file::$name;)*

        /// The kinds that come with this crate, in the order of the format's document.
        pub static KINDS: &[&dyn FileKind] = &[$(<dyn FileKind>::of::<$name>()),*];
    };
}

pub mod coil;
mod head_curve;
pub mod isentropic;
pub mod loss;
mod seat;
pub mod separator;
mod turbomachine;

use crate::component::FileKind;
pub use head_curve::HeadCurve;

components! {
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
