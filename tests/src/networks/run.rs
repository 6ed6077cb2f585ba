//! Steps a random network with every method and compares it with its steady state in `f64`.

use eclss_core::{BuildError, Fault, Health, Method, MethodError, Network, NodeKind, Simulator};
use eclss_network_file::steady::{Steady, SteadyError, steady};

use super::draw::Drawn;
use super::slowest::{self, Storage};
use crate::dice::Dice;
use crate::product::with_simulator;

/// Methods that take any network.
pub const METHODS: [Method; 3] = [Method::Adaptive, Method::ImplicitEuler, Method::TrBdf2];

/// What came of a run whose inputs jump between constant values.
#[derive(Debug, Clone, Default)]
pub struct Jumps {
    /// Steps taken.
    pub steps: u64,
    /// Smallest φ of any step.
    pub smallest_phi: f32,
    /// Largest growth of max|p − p*| in one step as part of the largest pressure or head in it [1].
    pub growth: f64,
    /// Whether the growth could be watched: no island loses mass for ever.
    pub watched: bool,
    /// The method does not take the network.
    pub refused: bool,
}

/// Why a run counts as failed.
#[derive(Debug, Clone)]
pub enum Trouble {
    /// The simulator was not built.
    Build(BuildError),
    /// The run left its range.
    Fault(Fault),
    /// The independent solver found no steady state.
    Steady(SteadyError),
}

/// Runs `phases` times `steps` steps with constant inputs and a jump before each but the first.
///
/// # Panics
/// Where the simulator refuses the network or an input, which is a mistake of the drawing.
pub fn jumps(
    drawn: &Drawn,
    method: Method,
    dice: &mut Dice,
    phases: u32,
    steps: u32,
) -> Result<Jumps, Trouble> {
    let start = drawn.inputs.clone();
    let network = drawn.network(&start);
    let run = |simulator: &mut Simulator<'_>| {
        let mut result = Jumps { smallest_phi: 1.0, watched: true, ..Jumps::default() };
        let mut inputs = start.clone();
        for phase in 0..phases {
            if phase > 0 {
                inputs = drawn.drawn_inputs(dice);
            }
            for (slot, &value) in inputs.iter().enumerate() {
                simulator.set_input(slot, value).expect("drawn within its range");
            }
            // An island that is drained for ever has no steady state to stay near.
            let target = match steady(&network, &inputs) {
                Err(
                    SteadyError::Drained { .. }
                    | SteadyError::BelowVacuum { .. }
                    | SteadyError::BeyondRange { .. },
                ) => None,
                Err(error) => return Err(Trouble::Steady(error)),
                Ok(target) => Some(target),
            };
            result.watched &= target.is_some();
            let mut last = target.as_ref().map(|target| distance_pa(simulator, &network, target));
            for _ in 0..steps {
                if let Health::Faulted(fault) = simulator.step() {
                    return Err(Trouble::Fault(fault));
                }
                let now = target.as_ref().map(|target| distance_pa(simulator, &network, target));
                if let (Some(now), Some(last)) = (&now, &last) {
                    result.growth = result.growth.max((now.error_pa - last.error_pa) / now.size_pa);
                }
                result.smallest_phi = result.smallest_phi.min(simulator.margin().phi);
                result.steps += 1;
                last = now;
            }
        }
        Ok(result)
    };
    match with_simulator(&network, method, drawn.step_us, run) {
        Err(BuildError::Method(MethodError::Junction(_))) => Ok(Jumps { refused: true, ..Jumps::default() }),
        Err(error) => Err(Trouble::Build(error)),
        Ok(done) => done,
    }
}

/// Largest |p − p*| and the largest number that its rounding can come from [Pa].
struct Distance {
    error_pa: f64,
    size_pa: f64,
}

fn distance_pa(simulator: &Simulator<'_>, network: &Network<'_>, target: &Steady) -> Distance {
    let mut distance = Distance { error_pa: 0.0, size_pa: 500.0 };
    for (index, node) in network.nodes.iter().enumerate() {
        let pressure = f64::from(simulator.node_gauge_pa(index));
        distance.size_pa = distance.size_pa.max(pressure.abs()).max(target.gauge_pa[index].abs());
        if node.kind != NodeKind::Boundary {
            distance.error_pa = distance.error_pa.max((pressure - target.gauge_pa[index]).abs());
        }
    }
    distance
}

/// What came of a run that was given the time to settle.
#[derive(Debug, Clone, Copy, Default)]
pub struct Settled {
    /// Steps taken.
    pub steps: u64,
    /// Largest error of any line: of its flow as part of the largest, or of the pressure that drives it (with an
    /// implicit method: through the part of the line that has this flow, between two volumes) in units of 1 Pa (more where single precision does not resolve that), whichever is smaller [1].
    pub error: f64,
    /// The line that has it.
    pub line: usize,
}

/// Most steps that a network may need.
pub const MOST_STEPS: f64 = 1e5;
/// Farthest from the reference that a pressure is known to less than a third of 0.1 mPa [Pa].
const FINE_PA: f64 = 512.0;
/// Slowest time constants that it is given.
pub const TIME_CONSTANTS: f64 = 20.0;

/// Lets a network settle with its start inputs; `None` where it takes too long or its pressures fall for ever.
pub fn settle(drawn: &Drawn, method: Method) -> Result<Option<Settled>, Trouble> {
    let network = drawn.network(&drawn.inputs);
    let target = match steady(&network, &drawn.inputs) {
        Err(
            SteadyError::Drained { .. } | SteadyError::BelowVacuum { .. } | SteadyError::BeyondRange { .. },
        ) => return Ok(None),
        Err(error) => return Err(Trouble::Steady(error)),
        Ok(target) => target,
    };
    let step_s = f64::from(drawn.step_us) * 1e-6;
    let storage = if method == Method::Adaptive { Storage::Slowed(step_s) } else { Storage::Whole };
    let most_s = MOST_STEPS * step_s / TIME_CONSTANTS;
    let steps = TIME_CONSTANTS * slowest::time_constant_s(&network, &target, storage, most_s) / step_s;
    if steps > MOST_STEPS || steps.is_nan() {
        return Ok(None);
    }
    let steps = steps.max(50.0) as u64;
    let run = |simulator: &mut Simulator<'_>| {
        for _ in 0..steps {
            if let Health::Faulted(fault) = simulator.step() {
                return Err(Trouble::Fault(fault));
            }
        }
        Ok(Some(compare(simulator, &network, &target, storage, steps)))
    };
    match with_simulator(&network, method, drawn.step_us, run) {
        Err(BuildError::Method(MethodError::Junction(_))) => Ok(None),
        Err(error) => Err(Trouble::Build(error)),
        Ok(done) => done,
    }
}

fn compare(
    simulator: &Simulator<'_>,
    network: &Network<'_>,
    target: &Steady,
    storage: Storage,
    steps: u64,
) -> Settled {
    let largest = target.flow_kg_s.iter().fold(f64::MIN_POSITIVE, |largest, w| largest.max(w.abs()));
    // A pressure is kept in single precision: far from the reference it has a coarser grid than 0.1 mPa.
    let farthest = target.gauge_pa.iter().fold(0.0f64, |farthest, gauge| farthest.max(gauge.abs()));
    let grid = (farthest / FINE_PA).max(1.0);
    let mut settled = Settled { steps, ..Settled::default() };
    for (index, line) in network.lines.iter().enumerate() {
        let (found, exact) = (f64::from(simulator.line_flow_kg_s(index)), target.flow_kg_s[index]);
        let drive = slowest::losses_of_flow(network, line, exact, storage).apart_pa(found);
        let error = ((found - exact).abs() / largest).min(drive / grid);
        if error > settled.error || error.is_nan() {
            settled = Settled { error, line: index, ..settled };
        }
    }
    settled
}
