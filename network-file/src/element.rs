//! Elements: from what the file says to what the core computes with.
//!
//! Derived parameters are computed in `f64` and rounded once, so that a file gives the same bits on every
//! machine.

use eclss_core::element::{
    Bed, CheckValve, Fan, Hatch, HeadCurve, HeatExchanger, Law, Measured, Orifice, Pipe, PressureRegulator,
    Pump, ReferencePipe, ReliefValve, Valve,
};
use eclss_core::{StdElement, air};

use crate::document::{Curve, ElementEntry, ElementKind, Loss, Passage, Seat};
use crate::limits::{self, Range};
use crate::notes::Notes;
use crate::number::single;

/// Seconds of a day.
const SECONDS_A_DAY: f64 = 86_400.0;

/// One element while it is converted.
pub(crate) struct Conversion<'a> {
    pub(crate) notes: &'a mut Notes,
    pub(crate) entry: &'a ElementEntry,
    /// Path of the element's table.
    pub(crate) path: &'a str,
    /// Reference density of the line [kg/m³]; 0 for a line out of a vacuum, or whose coolant is unknown.
    pub(crate) density_kg_m3: f64,
    /// Pressure [Pa] and temperature [K] of the line's node of higher pressure at the start.
    pub(crate) high_side: (f64, f64),
    /// Whether the outlet is the line's end, whose volume is the node's.
    pub(crate) last: bool,
}

impl Conversion<'_> {
    /// Returns element, inertance [1/m] and outlet volume [m³]. What is refused is in the notes.
    pub(crate) fn convert(&mut self) -> (StdElement, f32, f32) {
        let element = self.element();
        let (inertance, volume) = self.column();
        (element, inertance, volume)
    }

    fn element(&mut self) -> StdElement {
        match &self.entry.kind {
            // For the flow these are a loss; what else they do is the climate's.
            ElementKind::Pipe { loss, blockage }
            | ElementKind::Condenser { loss, blockage, .. }
            | ElementKind::CoolantSide { loss, blockage, .. }
            | ElementKind::InterfaceExchanger { loss, blockage, .. }
            | ElementKind::Heater { loss, blockage, .. } => {
                let resistance = self.resistance(loss);
                if blockage.blockable == Some(true) {
                    // A free share C of the area, as of a hatch.
                    let (open_resistance_pa_s2_kg2, leakage_opening) =
                        (resistance, limits::BLOCKED_OPENING as f32);
                    StdElement::Hatch(Hatch { open_resistance_pa_s2_kg2, leakage_opening })
                } else {
                    StdElement::Pipe(Pipe { resistance_pa_s2_kg2: resistance })
                }
            }
            ElementKind::ReferencePipe { pressure_drop_pa, mass_flow_kg_s, exponent, density_kg_m3 } => {
                // Δp = Δp_ref·(ρ_ref/ρ)·(w/w_ref)^n: the loss that the same flow has at the line's density.
                let drop = match density_kg_m3 {
                    None => *pressure_drop_pa,
                    Some(measured) => pressure_drop_pa * measured / self.density("density_kg_m3"),
                };
                StdElement::ReferencePipe(ReferencePipe {
                    pressure_drop_pa: self.fit("pressure_drop_pa", drop, &limits::REFERENCE_DROP),
                    mass_flow_kg_s: *mass_flow_kg_s as f32,
                    exponent: *exponent as f32,
                })
            }
            ElementKind::Valve { open_resistance_pa_s2_kg2, exponent, seat, .. } => {
                let leakage = self.remaining_of_loss(seat, *open_resistance_pa_s2_kg2, *exponent);
                StdElement::Valve(Valve {
                    open_resistance_pa_s2_kg2: *open_resistance_pa_s2_kg2 as f32,
                    exponent: *exponent as f32,
                    leakage_opening: leakage,
                })
            }
            ElementKind::Fan(machine) => StdElement::Fan(Fan { curve: self.curve(&machine.curve) }),
            ElementKind::Pump(machine) => StdElement::Pump(Pump { curve: self.curve(&machine.curve) }),
            ElementKind::HeatExchanger { loss, liquid_fraction, separator_efficiency } => {
                StdElement::HeatExchanger(HeatExchanger {
                    resistance_pa_s2_kg2: self.resistance(loss),
                    liquid_fraction: *liquid_fraction as f32,
                    separator_efficiency: *separator_efficiency as f32,
                })
            }
            ElementKind::Bed { loss, mass_fraction, capture_efficiency } => StdElement::Bed(Bed {
                resistance_pa_s2_kg2: self.resistance(loss),
                mass_fraction: *mass_fraction as f32,
                capture_efficiency: *capture_efficiency as f32,
            }),
            ElementKind::Measured { largest_flow_kg_s, slope_kg_s_pa } => StdElement::Measured(Measured {
                largest_flow_kg_s: *largest_flow_kg_s as f32,
                slope_kg_s_pa: *slope_kg_s_pa as f32,
            }),
            ElementKind::Orifice { discharge_coefficient, .. } => StdElement::Orifice(Orifice {
                effective_area_m2: self.effective_area(*discharge_coefficient),
            }),
            ElementKind::Leak { leak_kg_d, pressure_drop_pa, inlet_pressure_pa, .. } => {
                self.leak(*leak_kg_d, *pressure_drop_pa, *inlet_pressure_pa)
            }
            ElementKind::CheckValve { loss, reverse_leak_kg_s, reverse_pressure_pa } => {
                let reverse = reverse_pressure_pa / reverse_leak_kg_s;
                StdElement::CheckValve(CheckValve {
                    resistance_pa_s2_kg2: self.resistance(loss),
                    reverse_pa_s_kg: self.fit("reverse_leak_kg_s", reverse, &limits::SEAT_RESISTANCE),
                })
            }
            ElementKind::ReliefValve { crack_pa, reseat_pa, passage, seat } => {
                let (resistance_pa_s2_kg2, effective_area_m2) = match passage {
                    Passage::Discharge { discharge_coefficient } => {
                        (0.0, self.effective_area(*discharge_coefficient))
                    }
                    Passage::Loss(loss) => (self.resistance(loss), 0.0),
                };
                let leakage_opening = if effective_area_m2 > 0.0 {
                    self.remaining_of_area(seat, effective_area_m2)
                } else {
                    self.remaining_of_loss(seat, f64::from(resistance_pa_s2_kg2), 2.0)
                };
                StdElement::ReliefValve(ReliefValve {
                    crack_pa: *crack_pa as f32,
                    reseat_pa: *reseat_pa as f32,
                    resistance_pa_s2_kg2,
                    effective_area_m2,
                    leakage_opening,
                })
            }
            ElementKind::PressureRegulator(regulator) => {
                let effective_area_m2 = self.effective_area(regulator.discharge_coefficient);
                StdElement::PressureRegulator(PressureRegulator {
                    effective_area_m2,
                    set_point_pa: regulator.set_point_pa as f32,
                    band_pa: regulator.band_pa as f32,
                    lag_s: regulator.lag_s as f32,
                    leakage_opening: self.remaining_of_area(&regulator.seat, effective_area_m2),
                })
            }
            ElementKind::Hatch { loss, seat, .. } => {
                let open_resistance_pa_s2_kg2 = self.resistance(loss);
                StdElement::Hatch(Hatch {
                    open_resistance_pa_s2_kg2,
                    leakage_opening: self.remaining_of_loss(seat, f64::from(open_resistance_pa_s2_kg2), 2.0),
                })
            }
        }
    }

    /// Opening that a closed loss k·C⁻ⁿ keeps: with the measured leak m at Δp it resists Δp/m², without one it is tight.
    fn remaining_of_loss(&mut self, seat: &Seat, open_resistance: f64, exponent: f64) -> f32 {
        let closed = match (seat.leakage_opening, seat.seat_leak_kg_d, seat.seat_leak_pressure_pa) {
            (Some(opening), ..) => return opening as f32,
            (None, Some(leak_kg_d), Some(pressure_pa)) if leak_kg_d > 0.0 => {
                let leak_kg_s = leak_kg_d / SECONDS_A_DAY;
                f64::min(pressure_pa / (leak_kg_s * leak_kg_s), f64::from(Law::TIGHT_PA_S2_KG2))
            }
            _ => f64::from(Law::TIGHT_PA_S2_KG2),
        };
        // A loss that no opening changes never closes.
        let opening = if exponent > 0.0 { libm::pow(open_resistance / closed, 1.0 / exponent) } else { 1.0 };
        self.remaining(seat, opening)
    }

    /// Opening that a closed area keeps.
    fn remaining_of_area(&mut self, seat: &Seat, open_area_m2: f32) -> f32 {
        match (seat.leakage_opening, seat.seat_leak_kg_d, seat.seat_leak_pressure_pa) {
            (Some(opening), ..) => opening as f32,
            (None, Some(leak_kg_d), Some(pressure_pa)) => {
                let (start_pa, temperature_k) = self.high_side;
                let high = f64::max(start_pa, pressure_pa);
                let per_area = flow_per_area(high, high - pressure_pa, temperature_k);
                self.remaining(seat, leak_kg_d / SECONDS_A_DAY / per_area / f64::from(open_area_m2))
            }
            _ => limits::TIGHT_OPENING as f32,
        }
    }

    fn remaining(&mut self, seat: &Seat, opening: f64) -> f32 {
        if opening > 1.0 && seat.seat_leak_kg_d.is_some() {
            self.refuse("seat_leak_kg_d", "the closed seat would let more through than the open element");
        }
        f64::min(f64::max(opening, limits::TIGHT_OPENING), 1.0) as f32
    }

    /// The orifice that leaks as was measured.
    fn leak(&mut self, leak_kg_d: f64, pressure_drop_pa: f64, inlet_pressure_pa: Option<f64>) -> StdElement {
        let (start_pa, temperature_k) = self.high_side;
        let high = inlet_pressure_pa.unwrap_or(start_pa);
        if pressure_drop_pa > high {
            let reason =
                format!("`pressure_drop_pa` = {pressure_drop_pa} is more than the {high} Pa before it");
            self.refuse("pressure_drop_pa", reason);
        }
        let per_area = flow_per_area(high, high - pressure_drop_pa, temperature_k);
        let area = leak_kg_d / SECONDS_A_DAY / per_area;
        StdElement::Orifice(Orifice {
            effective_area_m2: self.fit("leak_kg_d", area, &limits::EFFECTIVE_AREA),
        })
    }

    /// Effective area `C_d·A` of an opening.
    fn effective_area(&mut self, discharge_coefficient: f64) -> f32 {
        let key = "discharge_coefficient";
        let area = self.area();
        if area.is_none() {
            self.refuse(key, "`discharge_coefficient` needs a `diameter_m` or an `area_m2`");
        }
        self.fit(key, discharge_coefficient * area.unwrap_or(1.0), &limits::EFFECTIVE_AREA)
    }

    /// R, given or from ξ: `R = ξ/(2·ρ·A²)`.
    fn resistance(&mut self, loss: &Loss) -> f32 {
        match loss {
            Loss::Resistance { resistance_pa_s2_kg2 } => *resistance_pa_s2_kg2 as f32,
            Loss::Coefficient { loss_coefficient } => {
                let density = self.density("loss_coefficient");
                let area = self.area();
                if area.is_none() {
                    self.refuse(
                        "loss_coefficient",
                        "`loss_coefficient` needs a `diameter_m` or an `area_m2`",
                    );
                }
                let area = area.unwrap_or(1.0);
                let resistance = Pipe::resistance_of_loss_coefficient(*loss_coefficient, area, density);
                self.fit("loss_coefficient", resistance, &limits::RESISTANCE)
            }
        }
    }

    /// Head curve over mass flow: Δp = ρ·g·h(w/ρ).
    fn curve(&mut self, curve: &Curve) -> HeadCurve {
        match curve {
            Curve::Pressure { shutoff_pa, linear_pa_s_kg, quadratic_pa_s2_kg2 } => HeadCurve {
                shutoff_pa: *shutoff_pa as f32,
                linear_pa_s_kg: linear_pa_s_kg.unwrap_or(0.0) as f32,
                quadratic_pa_s2_kg2: *quadratic_pa_s2_kg2 as f32,
            },
            Curve::Head { h0_m, h1_s_m2, h2_s2_m5 } => {
                let density = self.density("h0_m");
                let [shutoff, linear, quadratic] =
                    HeadCurve::parameters_of_head(*h0_m, h1_s_m2.unwrap_or(0.0), *h2_s2_m5, density);
                HeadCurve {
                    shutoff_pa: self.fit("h0_m", shutoff, &limits::PRESSURE),
                    linear_pa_s_kg: self.fit("h1_s_m2", linear, &limits::LINEAR_FALL),
                    quadratic_pa_s2_kg2: self.fit("h2_s2_m5", quadratic, &limits::SOME_RESISTANCE),
                }
            }
        }
    }

    /// Inertance L/A and outlet volume L·A of the fluid column.
    fn column(&mut self) -> (f32, f32) {
        let entry = self.entry;
        let area = self.area();
        if let (Some(_), Some(_)) = (entry.diameter_m, entry.area_m2) {
            self.refuse("area_m2", "give the cross-section once: as `diameter_m` or as `area_m2`");
        }
        if let (Some(_), Some(_)) = (entry.length_m, entry.inertance_per_m) {
            self.refuse("inertance_per_m", "give the inertance once: as `length_m` or as `inertance_per_m`");
        }
        let needed = entry.length_m.is_some_and(|length| length > 0.0);
        if needed && area.is_none() {
            self.refuse("length_m", "`length_m` needs a `diameter_m` or an `area_m2`");
        }
        let (length, area) = (entry.length_m.unwrap_or(0.0), area.unwrap_or(1.0));
        let inertance = entry.inertance_per_m.unwrap_or(length / area);
        let inside = if self.last { 0.0 } else { length * area };
        let volume = entry.outlet_volume_m3.unwrap_or(inside);
        let key = if entry.inertance_per_m.is_some() { "inertance_per_m" } else { "length_m" };
        let inertance = self.fit(key, inertance, &limits::INERTANCE);
        let key = if entry.outlet_volume_m3.is_some() { "outlet_volume_m3" } else { "length_m" };
        (inertance, self.fit(key, volume, &limits::OUTLET_VOLUME))
    }

    /// Flow area [m²] from diameter or area.
    fn area(&self) -> Option<f64> {
        let round = |diameter: f64| core::f64::consts::FRAC_PI_4 * diameter * diameter;
        self.entry.area_m2.or(self.entry.diameter_m.map(round))
    }

    /// The line's reference density, for a parameter that needs one.
    fn density(&mut self, key: &str) -> f64 {
        if self.density_kg_m3 > 0.0 {
            return self.density_kg_m3;
        }
        let reason = "and the line starts in a vacuum or at a boundary of coolant: give it a `reference_density_kg_m3`";
        self.refuse(key, format!("`{key}` needs a density, {reason}"));
        1.0
    }

    /// Rounds a derived parameter and checks its range.
    fn fit(&mut self, key: &str, value: f64, range: &Range) -> f32 {
        match single(value) {
            Some(rounded) if range.values.contains(&value) => rounded,
            _ => {
                self.refuse(key, format!("`{key}` comes out as {value:e}, outside {range}"));
                1.0
            }
        }
    }

    fn refuse(&mut self, key: &str, reason: impl Into<String>) {
        self.notes.refuse_at(self.path, &[key], reason);
    }
}

/// Isentropic flow per effective area [kg/(s·m²)] of dry air, γ = 1.4, from `high` to `low` [Pa, absolute]; the law of
/// [`eclss_core::element::isentropic`] in `f64`.
fn flow_per_area(high: f64, low: f64, temperature_k: f64) -> f64 {
    const GAMMA: f64 = 1.4;
    let critical = libm::pow(2.0 / (GAMMA + 1.0), GAMMA / (GAMMA - 1.0));
    let ratio = f64::max(low / high, critical);
    let fall = libm::pow(ratio, 2.0 / GAMMA) - libm::pow(ratio, (GAMMA + 1.0) / GAMMA);
    let gas = f64::from(air::GAS_CONSTANT_J_KG_K) * temperature_k;
    high / libm::sqrt(gas) * libm::sqrt(2.0 * GAMMA / (GAMMA - 1.0) * fall)
}
