//! What an element is: its kind, with the keys of each.

use serde::Serialize;

use super::air::{CoilEntry, PlatesEntry, Starts};

/// Kinds of element.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum ElementKind {
    /// Duct, filter or grille.
    Pipe {
        /// Its loss.
        #[serde(flatten)]
        loss: Loss,
        /// Whether and how far it can be blocked.
        #[serde(flatten)]
        blockage: Blockage,
    },
    /// Loss known by one measured point.
    ReferencePipe {
        /// Measured pressure loss [Pa].
        pressure_drop_pa: f64,
        /// Mass flow of the measurement [kg/s].
        mass_flow_kg_s: f64,
        /// Exponent of the flow [1].
        exponent: f64,
        /// Density of the measurement [kg/m³]; the line's when absent.
        #[serde(skip_serializing_if = "Option::is_none")]
        density_kg_m3: Option<f64>,
    },
    /// Control valve.
    Valve {
        /// Resistance when fully open [Pa·s²/kg²].
        open_resistance_pa_s2_kg2: f64,
        /// Exponent of the opening [1].
        exponent: f64,
        /// What it lets through when closed.
        #[serde(flatten)]
        seat: Seat,
        /// Opening at the start [1]; 1 when absent.
        #[serde(skip_serializing_if = "Option::is_none")]
        opening: Option<f64>,
    },
    /// Fan.
    Fan(Machine),
    /// Pump.
    Pump(Machine),
    /// Condensing heat exchanger.
    HeatExchanger {
        /// Its loss.
        #[serde(flatten)]
        loss: Loss,
        /// Mass of liquid per mass of air that leaves [1].
        liquid_fraction: f64,
        /// Share of the liquid that the separator takes out [1].
        separator_efficiency: f64,
    },
    /// Condensing heat exchanger with walls, films and separator; needs `[air]`.
    Condenser {
        /// Its loss.
        #[serde(flatten)]
        loss: Loss,
        /// Whether and how far it can be blocked.
        #[serde(flatten)]
        blockage: Blockage,
        /// Everything else.
        #[serde(flatten)]
        coil: CoilEntry,
    },
    /// Coolant side of a condenser; needs `[air]`.
    CoolantSide {
        /// Its loss.
        #[serde(flatten)]
        loss: Loss,
        /// Whether and how far it can be blocked.
        #[serde(flatten)]
        blockage: Blockage,
        /// Id of the condenser.
        condenser: String,
    },
    /// Heat exchanger between two loops of coolant, or to coolant from outside; needs `[air]`.
    InterfaceExchanger {
        /// Its loss.
        #[serde(flatten)]
        loss: Loss,
        /// Whether and how far it can be blocked.
        #[serde(flatten)]
        blockage: Blockage,
        /// Everything else.
        #[serde(flatten)]
        plates: PlatesEntry,
    },
    /// Heater, cold plate or heat load in a line; needs `[air]`.
    Heater {
        /// Its loss.
        #[serde(flatten)]
        loss: Loss,
        /// Whether and how far it can be blocked.
        #[serde(flatten)]
        blockage: Blockage,
        /// Start value of its power.
        #[serde(flatten)]
        starts: Starts,
    },
    /// Adsorption bed.
    Bed {
        /// Its loss.
        #[serde(flatten)]
        loss: Loss,
        /// Mass fraction of the captured species in the air that enters [1].
        mass_fraction: f64,
        /// Share of the species that is captured [1].
        capture_efficiency: f64,
    },
    /// Real hardware, whose flow is an input.
    Measured {
        /// Largest flow that is believed [kg/s].
        largest_flow_kg_s: f64,
        /// How strongly its flow answers to pressure, at most [kg/(s·Pa)].
        slope_kg_s_pa: f64,
    },
    /// Opening of the element's own area with isentropic, choked flow.
    Orifice {
        /// Discharge coefficient on the area [1].
        discharge_coefficient: f64,
        /// Share of the area that is open at the start [1]; 1 when absent.
        #[serde(skip_serializing_if = "Option::is_none")]
        opening: Option<f64>,
    },
    /// Orifice known by one measured leak.
    Leak {
        /// Measured leak [kg/d].
        leak_kg_d: f64,
        /// Pressure difference of the measurement [Pa].
        pressure_drop_pa: f64,
        /// Absolute pressure before the leak in the measurement [Pa]; that of the line's node of higher pressure
        /// when absent.
        #[serde(skip_serializing_if = "Option::is_none")]
        inlet_pressure_pa: Option<f64>,
        /// Share of the leak that is open at the start [1]; 1 when absent.
        #[serde(skip_serializing_if = "Option::is_none")]
        opening: Option<f64>,
    },
    /// Passes forward flow only.
    CheckValve {
        /// Its loss in forward flow.
        #[serde(flatten)]
        loss: Loss,
        /// Leak in reverse [kg/s].
        reverse_leak_kg_s: f64,
        /// Pressure difference at which it leaks so much [Pa].
        reverse_pressure_pa: f64,
    },
    /// Opens at one pressure difference and closes at a lower one.
    ReliefValve {
        /// Pressure difference at which it opens [Pa].
        crack_pa: f64,
        /// Pressure difference at which it closes [Pa].
        reseat_pa: f64,
        /// What it loses, or lets through, when open.
        #[serde(flatten)]
        passage: Passage,
        /// What it lets through when closed.
        #[serde(flatten)]
        seat: Seat,
    },
    /// Holds the pressure at its outlet.
    PressureRegulator(Regulator),
    /// Opening between modules.
    Hatch {
        /// Its loss when open.
        #[serde(flatten)]
        loss: Loss,
        /// What it lets through when closed.
        #[serde(flatten)]
        seat: Seat,
        /// Opening at the start [1]; 1 when absent.
        #[serde(skip_serializing_if = "Option::is_none")]
        opening: Option<f64>,
    },
}

/// Whether an element of fixed loss can be blocked: it has an input `opening` then.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Blockage {
    /// Whether it can; no when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub blockable: Option<bool>,
    /// Free share of the area at the start [1]; 1 when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub opening: Option<f64>,
}

/// What a closed valve, regulator or hatch lets through; it is tight when nothing is given.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Seat {
    /// Opening that remains when closed [1].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub leakage_opening: Option<f64>,
    /// Leak of the seat [kg/d], instead.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seat_leak_kg_d: Option<f64>,
    /// Pressure difference at which it leaks so much [Pa].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seat_leak_pressure_pa: Option<f64>,
}

/// What an open relief valve is to its flow.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Passage {
    /// An opening of the element's own area with isentropic, choked flow.
    Discharge {
        /// Discharge coefficient on the area [1].
        discharge_coefficient: f64,
    },
    /// A quadratic loss.
    Loss(Loss),
}

/// A quadratic loss, given in one of two ways.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Loss {
    /// By resistance.
    Resistance {
        /// R in Δp = R·w·|w| [Pa·s²/kg²].
        resistance_pa_s2_kg2: f64,
    },
    /// By loss coefficient ξ on the element's own flow area.
    Coefficient {
        /// ξ in Δp = ξ·ρ·v²/2 [1].
        loss_coefficient: f64,
    },
}

/// Fan or pump: head curve at rated speed and start speed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Machine {
    /// Head curve.
    #[serde(flatten)]
    pub curve: Curve,
    /// Speed at the start [1, 1 = rated]; 1 when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub speed: Option<f64>,
    /// Electric power at rated speed, which heats what it moves [W]; from the efficiency when absent, needs `[air]`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub power_w: Option<f64>,
    /// Largest hydraulic power over the electric one [1]; [`crate::limits::MACHINE_EFFICIENCY`] when both are absent, needs
    /// `[air]`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub efficiency: Option<f64>,
}

/// Pressure regulator.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Regulator {
    /// Discharge coefficient on the element's own area when fully open [1].
    pub discharge_coefficient: f64,
    /// Absolute pressure at the outlet at which it closes [Pa].
    pub set_point_pa: f64,
    /// Fully open below the set point by this [Pa].
    pub band_pa: f64,
    /// Lag of the actuator [s].
    pub lag_s: f64,
    /// What it lets through when closed.
    #[serde(flatten)]
    pub seat: Seat,
}

/// A head curve, given in one of two ways.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Curve {
    /// By pressure over mass flow at the line's reference density.
    Pressure {
        /// Pressure rise at zero flow [Pa].
        shutoff_pa: f64,
        /// Linear fall [Pa·s/kg]; 0 when absent.
        #[serde(skip_serializing_if = "Option::is_none")]
        linear_pa_s_kg: Option<f64>,
        /// Quadratic fall [Pa·s²/kg²].
        quadratic_pa_s2_kg2: f64,
    },
    /// By head over volume flow, h = h0 − h1·Q − h2·Q².
    Head {
        /// Head at zero flow [m].
        h0_m: f64,
        /// Linear fall [s/m²]; 0 when absent.
        #[serde(skip_serializing_if = "Option::is_none")]
        h1_s_m2: Option<f64>,
        /// Quadratic fall [s²/m⁵].
        h2_s2_m5: f64,
    },
}
