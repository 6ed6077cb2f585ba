//! What left its range when a run is no longer trusted: which quantity, its value, and the range.

use core::fmt::{Display, Formatter, Result};

use super::{Fault, Health, Place, Simulator};
use crate::component::Element;
use crate::fluid::medium;

/// What can leave its range.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Strayed {
    /// Mass flow of a line [kg/s].
    MassFlow,
    /// Absolute pressure [Pa].
    Pressure,
    /// Temperature [K].
    Temperature,
    /// Mass of gas or of coolant [kg].
    Mass,
    /// Mass of this part of the air, as in [`medium::NAMES`] [kg].
    Part(u32),
}

/// What left its range; shown as "pressure -12.5 Pa, trusted 0 … 10101325 Pa".
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Excursion {
    /// The quantity.
    pub quantity: Strayed,
    /// Its value; may be NaN or infinite.
    pub value: f32,
    /// Least and most that a run is trusted with; infinite where there is no most.
    pub range: [f32; 2],
}

impl Strayed {
    /// Name and unit.
    const fn words(self) -> (&'static str, &'static str) {
        match self {
            Self::MassFlow => ("mass flow", "kg/s"),
            Self::Pressure => ("pressure", "Pa"),
            Self::Temperature => ("temperature", "K"),
            Self::Mass => ("mass", "kg"),
            Self::Part(_) => ("mass of", "kg"),
        }
    }
}

impl Display for Excursion {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let (name, unit) = self.quantity.words();
        f.write_str(name)?;
        if let Strayed::Part(part) = self.quantity {
            write!(f, " {}", medium::NAMES.get(part as usize).copied().unwrap_or("a part"))?;
        }
        if self.value.is_finite() {
            write!(f, " {} {unit}", self.value)?;
        } else {
            f.write_str(" is no finite number")?;
        }
        let [least, most] = self.range;
        if most.is_finite() {
            write!(f, ", trusted {least} … {most} {unit}")
        } else {
            write!(f, ", trusted above {least} {unit}")
        }
    }
}

impl<E: Element> Simulator<'_, E> {
    /// What left its range; `None` for a run that may be trusted.
    #[cold]
    pub fn excursion(&self) -> Option<Excursion> {
        let Health::Faulted(fault) = self.health() else { return None };
        match fault.place {
            Place::Line(line) => {
                let limit = Fault::FLOW_LIMIT_KG_S;
                let line = line as usize;
                let own = self.network().lines.get(line).map_or(0..0, |line| {
                    line.first_segment as usize..(line.first_segment + line.segments) as usize
                });
                // The first that is too large, or is no number at all.
                let mut value = self.line_flow_kg_s(line);
                for flow in own.rev().map(|segment| self.segment_flow_at_end_kg_s(line, segment)) {
                    if !crate::math::beyond(value, limit) {
                        value = flow;
                    }
                }
                Some(Excursion { quantity: Strayed::MassFlow, value, range: [-limit, limit] })
            }
            Place::Node(node) => {
                let (gauge, reference) = (self.node_gauge_pa(node as usize), self.network().reference_pa);
                let range = [0.0, reference + Fault::GAUGE_LIMIT_PA];
                let pressure = Excursion { quantity: Strayed::Pressure, value: reference + gauge, range };
                let climate = self.climate_excursion(node as usize);
                if Fault::outside(gauge, reference) { Some(pressure) } else { climate.or(Some(pressure)) }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::string::ToString;

    use super::*;

    #[test]
    fn it_names_quantity_value_and_range() {
        let excursion = Excursion { quantity: Strayed::Part(2), value: -0.5, range: [0.0, f32::INFINITY] };
        assert_eq!(excursion.to_string(), "mass of carbon_dioxide -0.5 kg, trusted above 0 kg");
        let excursion = Excursion { quantity: Strayed::MassFlow, value: f32::NAN, range: [-1e3, 1e3] };
        assert_eq!(excursion.to_string(), "mass flow is no finite number, trusted -1000 … 1000 kg/s");
    }
}
