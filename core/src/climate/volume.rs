//! Well-mixed volumes: what they hold, and how temperature and pressure follow from it.
//!
//! A volume stores deviations from its start, compensated: the mass of every part and the energy. From them
//!
//! ```text
//! C = Σ m·c_v     θ − θ0 = (δE + Σ offset·δm − δC·θ0)/C                       (offset R·T_r for gases, L for liquid)
//! δp = (δRM·T0 + (RM0 + δRM)·δT)/V,   RM = Σ m·R                              (the gauge identity of p·V = m·R·T)
//! δp = (δm + β·m·δT)/Cap                                                      (liquid that expands)
//! ```
//!
//! Outflow carries the volume's state at the step's start (upwind). Where γ times what passes in a step is more than
//! the volume holds, only the share φ of it exchanges with the volume: at constant mass every new fraction and
//! temperature is then a convex combination of old ones, whatever the step. Mass itself is stored in full, or as far as
//! the flow method's own φ says: pressure then moves as that method expects. Where that φ alone leaves less to pass than the
//! volume holds, all rows are stored by it alike, what comes by flows and what crew, heat, fog and removal bring. What is
//! not stored is booked as owed; φ is shown.
//!
//! Temperatures are followed from [`LEAST_K`] to [`MOST_K`]. Beyond, the temperature is held at the end of that band and the
//! energy goes on counting, as boiling or frosting would hold it: the books stay closed, the volume comes back into the
//! band by the heat that took it out, and [`Readings::held`] and the limit monitor say so meanwhile. A volume of which
//! less than [`THIN`] of its start is left is a vacuum: figures per mass are those of [`THIN`].
//!
//! Valid while the volume is mixed: [`Readings::mixed`] says when it no longer is.

use crate::fluid::medium::{self, LIQUID, Medium, NITROGEN, PARTS, Parts, VAPOUR, dot};
use crate::fluid::stream::{ENERGY, STORED, Stored, Stream};
pub use crate::fluid::stream::{LEAST_K, MOST_K};
use crate::parameter::{ParameterError, Reason};
use crate::{Fingerprint, Node, NodeKind, math, moist};

/// What a node holds.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Contents {
    /// Cabin air.
    Air,
    /// The network's coolant.
    Coolant,
}

/// Fixed data of one volume, beside its [`Node`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Volume {
    /// Kind of value that it takes.
    pub contents: Contents,
    /// Mass at the start [kg]; finite and > 0. Any for a boundary.
    pub start_kg: f32,
    /// Mass fractions at the start [1]; of coolant all is part 0.
    pub fractions: Parts,
    /// Longest time in which ventilation turns the volume over while it still counts as mixed [s]; > 0, infinite for
    /// one that is always mixed.
    pub mixing_limit_s: f32,
    /// How fast free water evaporates per pressure difference [kg/(s·Pa)]; finite and ≥ 0. Vapour above saturation
    /// condenses at once.
    pub surface_kg_s_pa: f32,
}

impl Volume {
    pub(super) fn medium<'m>(&self, air: &'m Medium, coolant: &'m Medium) -> &'m Medium {
        match self.contents {
            Contents::Air => air,
            Contents::Coolant => coolant,
        }
    }

    /// Finds the first parameter outside its valid range.
    pub fn check(&self) -> Result<(), ParameterError> {
        ParameterError::unless_positive("start_kg", self.start_kg)?;
        let mut sum = 0.0;
        for fraction in self.fractions {
            ParameterError::unless_fraction("fractions", fraction)?;
            sum += fraction;
        }
        if math::beyond(sum - 1.0, 1e-5) {
            return Err(ParameterError { parameter: "fractions", reason: Reason::OutsideValidity });
        }
        if self.mixing_limit_s.is_nan() || self.mixing_limit_s <= 0.0 {
            return Err(ParameterError { parameter: "mixing_limit_s", reason: Reason::NotPositive });
        }
        ParameterError::unless_not_negative("surface_kg_s_pa", self.surface_kg_s_pa)
    }

    pub(crate) fn feed(&self, hash: &mut Fingerprint) {
        hash.word(self.contents as u32);
        hash.value(self.start_kg);
        hash.values(&self.fractions);
        hash.values(&[self.mixing_limit_s, self.surface_kg_s_pa]);
    }
}

/// Largest ratio of specific heats of what flows, that of nitrogen and oxygen: what passes carries `c_p`·θ, what rests
/// holds `c_v`·θ.
pub(super) const GAMMA: f32 = 1.4;
/// Share of what a volume of air held at its start below which it counts as empty [1]: there the rounding of what left
/// reaches a percent of what is left.
pub const THIN: f32 = 1e-5;
/// What condenses within one step per pressure above saturation, before the air warms by it [kg/Pa]: so much that every
/// volume ends the step at saturation.
const FOG_KG_PA: f32 = 1.0;
/// How far rounding may take a part below 0, by what the volume held at the start [1].
pub(super) const LEAST_FRACTION: f32 = 1e-6;
/// Figures of a volume beside its fractions: temperature over the reference [K]; absolute pressure [Pa]; mass of gas, or
/// of coolant [kg]; mass that came in and that went out in this step [kg]; φ.
pub(super) type Figures = [f32; 6];

/// Figures that stay: heat capacity at the start [J/K], and Σ m·R there [J/K].
pub(super) type Start = [f32; 2];

/// A volume's state and what a step derives from it.
pub(super) struct Held<'v> {
    pub(super) value: &'v mut Stored,
    pub(super) carry: &'v mut Stored,
    pub(super) owed: &'v mut Stored,
    pub(super) owed_carry: &'v mut Stored,
    pub(super) net: &'v mut Stored,
    pub(super) lost: &'v mut Stored,
    pub(super) fractions: &'v mut Parts,
    pub(super) figures: &'v mut Figures,
    pub(super) start: &'v Start,
}

/// Constants of one volume that a step needs.
#[derive(Clone, Copy)]
pub(super) struct Constants<'c> {
    pub(super) volume: &'c Volume,
    pub(super) node: &'c Node,
    pub(super) medium: &'c Medium,
    pub(super) reference_k: f32,
    pub(super) reference_pa: f32,
}

impl Constants<'_> {
    /// Sets the figures of the start.
    pub(super) fn start(&self, fractions: &mut Parts, figures: &mut Figures, start: &mut Start) {
        let masses = self.volume.fractions.map(|fraction| fraction * self.volume.start_kg);
        *start = [dot(&masses, &self.medium.resting_j_kg_k), dot(&masses, &self.medium.gas_j_kg_k)];
        *fractions = self.volume.fractions;
        let pressure = self.reference_pa + self.node.start_gauge_pa;
        let theta = self.node.temperature_k - self.reference_k;
        *figures = [theta, pressure, self.volume.start_kg, 0.0, 0.0, 1.0];
    }

    /// What of the row `net` is stored, and φ of the exchange, where more passes in a step than the volume of `figures`
    /// and `fractions` holds. First the volume fills with the mean of what comes or drains of its own, in full, so that
    /// pressure answers as the flow method expects; then the rest of what passes exchanges with it at constant mass, as
    /// far as its new state stays between the old one and that of what comes. Free water does not pass.
    #[cold]
    fn part(&self, net: &Stored, figures: &Figures, fractions: &Parts) -> (Stored, f32) {
        let [theta, _, mass, _, outward, _] = *figures;
        let medium = self.medium;
        let water = net[LIQUID] * (medium.flowing_j_kg_k[LIQUID] * theta - medium.latent_j_kg);
        let mut gas = *net;
        gas[LIQUID] = 0.0;
        gas[ENERGY] -= water;
        let gained: f32 = gas.iter().take(LIQUID).sum();
        let brought = gained + outward;
        let own = unit(fractions, theta, medium);
        let comes = math::each(&gas, &own, |net, own| (net + outward * own) / brought);
        let mut stored = if gained > 0.0 { comes } else { own }.map(|row| gained * row);
        let (mut filled, mut filling) = ([0.0; PARTS], [0.0; PARTS]);
        for place in 0..LIQUID {
            filling[place] = stored[place];
            filled[place] = mass * fractions[place] + stored[place];
        }
        let sum: f32 = filled.iter().sum();
        let work = stored[ENERGY] - dot(&filling, &medium.resting_j_kg_k) * theta
            + dot(&filling, &medium.offset_j_kg);
        let theta = theta + work / dot(&filled, &medium.resting_j_kg_k);
        let passes = GAMMA * math::smaller(brought, outward);
        let through = if passes > sum { sum / passes } else { 1.0 };
        if passes > 0.0 && sum > 0.0 {
            let own = unit(&filled.map(|part| part / sum), theta, medium);
            let exchanged = through * passes / GAMMA;
            for ((stored, comes), own) in stored.iter_mut().zip(comes).zip(own) {
                *stored += exchanged * (comes - own);
            }
        }
        stored[LIQUID] = net[LIQUID];
        stored[ENERGY] += water;
        (stored, through)
    }

    /// Stores what arrived, of which the flow method stores the share `slowed`, and derives fractions, temperature and
    /// pressure. Returns the gauge pressure [Pa]; `None` for what is held.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "the body of the loop over volumes")]
    pub(super) fn update(&self, held: &mut Held<'_>, slowed: f32) -> Option<f32> {
        let [_, _, mass, inward, outward, _] = *held.figures;
        let mut through = 1.0;
        if GAMMA * math::larger(inward, outward) > mass || slowed < 1.0 {
            let slow = |row: f32| slowed * row;
            let [theta, pressure, mass, inward, outward, phi] = *held.figures;
            let figures = [theta, pressure, mass, slow(inward), slow(outward), phi];
            let mut stored = held.net.map(slow);
            if GAMMA * math::larger(figures[3], figures[4]) > mass {
                (stored, through) = self.part(&stored, &figures, held.fractions);
            }
            store_part(held, &stored);
        } else if self.volume.contents == Contents::Coolant {
            for place in [NITROGEN, ENERGY] {
                held.carry[place] += held.lost[place];
                math::compensated_add(&mut held.value[place], &mut held.carry[place], held.net[place]);
            }
        } else {
            store(held.value, held.carry, held.net, held.lost);
        }
        let [theta, pressure, mass, inward, outward, phi] = held.figures;
        (*inward, *outward, *phi) = (0.0, 0.0, slowed * through);
        (*held.net, *held.lost) = ([0.0; STORED], [0.0; STORED]);
        if self.node.kind == NodeKind::Boundary {
            return None;
        }
        let start_theta = self.node.temperature_k - self.reference_k;
        if self.volume.contents == Contents::Coolant {
            // One part: θ − θ0 = (δE − c·δm·θ0)/C, and δp = (δm + β·m·(θ − θ0))/Cap of its walls or spring.
            let [heat, ..] = self.medium.resting_j_kg_k;
            let [change, ..] = *held.value;
            *mass = self.volume.start_kg + change;
            let rise = (held.value[ENERGY] - heat * change * start_theta) / (heat * *mass);
            let rise = self.followed(rise);
            *theta = start_theta + rise;
            let expanded = change + self.medium.expansion_1_k * (*mass * rise);
            let gauge = self.node.start_gauge_pa + self.node.pressure_per_mass_pa_kg() * expanded;
            *pressure = self.reference_pa + gauge;
            return Some(gauge);
        }
        let [a, b, c, d, e, f, energy, _] = *held.value;
        let change = [a, b, c, d, e, f];
        let mut masses = self.volume.fractions;
        for (mass, change) in masses.iter_mut().zip(&change) {
            *mass = *mass * self.volume.start_kg + change;
        }
        // What lies free does not flow: fractions count per mass of what does.
        let [nitrogen, oxygen, carbon_dioxide, vapour, trace, _] = masses;
        let sum = ((nitrogen + oxygen) + (carbon_dioxide + vapour)) + trace;
        // A volume that has been emptied is filled up with as much nitrogen as rounding may have taken too much; what a
        // source took beyond is seen.
        let floor = THIN * self.volume.start_kg;
        *mass = math::larger(floor, sum);
        if nitrogen >= -LEAST_FRACTION * self.volume.start_kg {
            masses[NITROGEN] += *mass - sum;
        }
        let per_mass = 1.0 / *mass;
        for (fraction, mass) in held.fractions.iter_mut().zip(&masses) {
            *fraction = *mass * per_mass;
        }
        let medium = self.medium;
        let [start_capacity, start_gas] = *held.start;
        let grown = dot(&change, &medium.resting_j_kg_k);
        let offset = dot(&change, &medium.offset_j_kg);
        let capacity = math::larger(THIN * start_capacity, start_capacity + grown);
        let rise = (energy + (offset - grown * start_theta)) / capacity;
        let rise = self.followed(rise);
        *theta = start_theta + rise;
        let NodeKind::Cabin { volume_m3 } = self.node.kind else { return None };
        let gas_change = dot(&change, &medium.gas_j_kg_k);
        let swing = (gas_change * self.node.temperature_k + (start_gas + gas_change) * rise) / volume_m3;
        // Near vacuum the swing's rounding is more than what is left.
        let gauge = math::larger(-self.reference_pa, self.node.start_gauge_pa + swing);
        *pressure = self.reference_pa + gauge;
        Some(gauge)
    }

    /// A rise of temperature over the start [K], held where it would leave the band that is followed; NaN stays NaN.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "the body of the loop over volumes")]
    fn followed(&self, rise: f32) -> f32 {
        let start = self.node.temperature_k;
        math::smaller(MOST_K - start, math::larger(LEAST_K - start, rise))
    }
}

/// A kilogram of what flows out of a volume.
fn unit(fractions: &Parts, theta: f32, medium: &Medium) -> Stored {
    let stream = Stream::of(1.0, fractions, theta, medium);
    let [a, b, c, d, e, f] = stream.mass_kg;
    [a, b, c, d, e, f, stream.energy_j, 0.0]
}

/// Adds what arrived.
#[inline(always)]
#[allow(clippy::inline_always, reason = "the body of the loop over volumes")]
fn store(value: &mut Stored, carry: &mut Stored, net: &Stored, lost: &Stored) {
    if !math::VECTORS {
        // The last place stays 0.
        for place in 0..STORED - 1 {
            carry[place] += lost[place];
            math::compensated_add(&mut value[place], &mut carry[place], net[place]);
        }
        return;
    }
    *carry = math::each(carry, lost, |carry, lost| carry + lost);
    math::compensated_add_row(value, carry, net);
}

/// Adds the part `stored` of what arrived; the rest is owed.
#[cold]
fn store_part(held: &mut Held<'_>, stored: &Stored) {
    for (place, stored) in stored.iter().enumerate() {
        let (mut rest, mut lost) = (held.net[place], held.lost[place]);
        math::exact_add(&mut rest, &mut lost, -stored);
        math::compensated_add(&mut held.value[place], &mut held.carry[place], *stored);
        held.owed_carry[place] += lost;
        math::compensated_add(&mut held.owed[place], &mut held.owed_carry[place], rest);
    }
}

/// Vapour that free water gives to the air within `step_s` [kg]; negative where vapour condenses. Above saturation it
/// becomes fog at once (droplets take seconds, less than volumes do), which counts as free water.
#[inline]
pub(super) fn evaporated_kg(
    volume: &Volume,
    figures: &Figures,
    fractions: &Parts,
    medium: &Medium,
    reference_k: f32,
    step_s: f32,
) -> f32 {
    let [theta, pressure, mass, ..] = *figures;
    let vapour = medium::partial_pressure_pa(VAPOUR, fractions, pressure);
    let temperature = reference_k + theta;
    let saturation = moist::saturation_pressure_pa(temperature);
    // Solved implicitly, so that no step passes equilibrium: a kilogram raises the vapour's pressure by R_v·T/V and cools
    // what it comes from, and with it saturation, by L/(m·c_v)·dp_s/dT (Clausius and Clapeyron).
    let latent = moist::evaporation_enthalpy_j_kg(temperature);
    let gas = medium::GAS_CONSTANTS_J_KG_K[VAPOUR];
    let cooled = latent / (gas * temperature);
    let heat = dot(fractions, &medium.resting_j_kg_k);
    let per_kg = (gas * pressure / dot(fractions, &medium.gas_j_kg_k)
        + saturation * cooled * latent / (temperature * heat))
        / mass;
    let rate = if vapour > saturation { FOG_KG_PA } else { volume.surface_kg_s_pa * step_s };
    math::smaller(rate * (saturation - vapour) / (1.0 + rate * per_kg), mass * fractions[LIQUID])
}
