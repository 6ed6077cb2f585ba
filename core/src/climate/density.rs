//! How dense the air of a node is, for lines whose laws look at it.
//!
//! One number says it: the *virtual temperature* `T·R/Rg`, at which dry air of the same pressure would be as dense,
//! `ρ = p/(Rg·T_v)`. It is that of the volume at the step's start, so a law that asks several times within a step finds
//! the same gas.
//!
//! Source: ideal gas with R = Σ xᵢ·Rᵢ over mass fractions; the virtual temperature of meteorology (ASHRAE
//! Fundamentals, psychrometrics), here for every part of the air.

use super::Climate;
use super::volume::{Contents, Figures};
use crate::fluid::medium::{GAS_CONSTANTS_J_KG_K, Parts, dot};
use crate::{Network, air};

/// Nodes whose virtual temperature is kept: all, where a line responds to density or temperature.
pub(super) fn kept<E>(network: &Network<'_, E>) -> usize {
    let responds = !(network.climate.is_none() || network.responsive.is_empty());
    if responds { network.nodes.len() } else { 0 }
}

/// The virtual temperatures of all nodes [K] at the end of a work buffer; none where no line asks.
pub(crate) fn virtual_k<'w, E>(network: &Network<'_, E>, work: &'w [f32]) -> &'w [f32] {
    let first = work.len().saturating_sub(kept(network));
    work.get(first..).unwrap_or(&[])
}

/// Derives the virtual temperatures of the nodes of all lines that respond.
pub(super) fn derive<E>(
    network: &Network<'_, E>,
    figures: &[Figures],
    fractions: &[Parts],
    virtual_k: &mut [f32],
) {
    for entry in network.responsive {
        let Some(line) = network.lines.get(entry.line as usize) else { continue };
        for node in [line.from as usize, line.to as usize] {
            if let (Some(kept), Some([theta, ..]), Some(fractions)) =
                (virtual_k.get_mut(node), figures.get(node), fractions.get(node))
            {
                *kept = virtual_temperature_k(fractions, network.climate.reference_k + theta);
            }
        }
    }
}

/// Virtual temperature [K] of air of these mass fractions at `temperature_k` [K].
fn virtual_temperature_k(fractions: &Parts, temperature_k: f32) -> f32 {
    temperature_k * (dot(fractions, &GAS_CONSTANTS_J_KG_K) * (1.0 / air::GAS_CONSTANT_J_KG_K))
}

impl Climate<'_> {
    /// Virtual temperature of node `node` at the start [K], where it holds air of the climate.
    pub fn virtual_start_k(&self, node: usize, temperature_k: f32) -> Option<f32> {
        let volume = self.volumes.get(node).filter(|volume| volume.contents == Contents::Air)?;
        Some(virtual_temperature_k(&volume.fractions, temperature_k))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn humid_air_is_as_dense_as_dry_air_at_its_virtual_temperature() {
        // Saturated at 25 °C and 101 325 Pa: ρ = Σ p_i·M_i/(R·T) in double precision, with nitrogen and oxygen as 79:21.
        let (temperature, vapour_pa, total_pa) = (298.15f64, 3_169.0f64, 101_325.0f64);
        let dry_pa = total_pa - vapour_pa;
        let molar = [(0.79 * dry_pa, 28.013_4), (0.21 * dry_pa, 31.998), (0.0, 44.009), (vapour_pa, 18.015)];
        let sum: f64 = molar.iter().map(|(p, m)| p * m).sum();
        let density = sum / (8_314.463 * temperature);
        let mut fractions: Parts = [0.0; 6];
        for (fraction, (p, m)) in fractions.iter_mut().zip(molar) {
            *fraction = (p * m / sum) as f32;
        }
        let virtual_k = virtual_temperature_k(&fractions, temperature as f32);
        let found = air::density_kg_m3(total_pa as f32, virtual_k);
        assert!((f64::from(found) / density - 1.0).abs() < 1e-6, "{found} against {density}");
        // Meteorology's T·(1 + 0.608·q) for air of 28.965 g/mol; 79:21 is 0.4 % lighter.
        assert!((virtual_k / (298.15 * (1.0 + 0.608 * fractions[3])) - 1.004).abs() < 1e-3, "{virtual_k}");
    }
}
