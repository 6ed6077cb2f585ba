//! The networks that a board runs: the one that is compiled in, and one that is loaded at run time.

use crate::control::SHOWN_OUTPUTS;
use crate::coupling::{self, Coupling};
use crate::plant::{Plant, Untrusted};
use eclss_core::process::{Applied, CHANNELS, Image, InputState, OutputState, Process};
use eclss_core::protocol::{Config, Link, Role};
use eclss_core::{
    BuildError, Compiled as _, CompiledSimulator, Fingerprint, Health, LiveInput, Settings, Signal,
    Simulator, Storage,
};
use static_cell::{ConstStaticCell, StaticCell};

/// The compiled-in network's tables, generated from its file.
#[allow(clippy::unreadable_literal, clippy::excessive_precision, reason = "generated")]
#[allow(missing_docs, dead_code, unreachable_pub, reason = "generated")]
pub(crate) mod table {
    include!(concat!(env!("OUT_DIR"), "/network.rs"));
}

/// Most segments for which the step is specialised at compile time; beyond, code would grow with the network.
const SPECIALISED_UP_TO: usize = 64;
const SPECIALISED: bool = table::SEGMENTS.len() <= SPECIALISED_UP_TO;

// The build counted bytes on the host, whose pointers are wider, to see whether the network fits.
const _: () = assert!(table::Configured::NETWORK.flash_bytes() <= table::FLASH_BYTES);

/// How the step runs; the bits are the same.
enum Stepper {
    Specialised(CompiledSimulator<'static, table::Configured>),
    General(Simulator<'static>),
}

/// A network and its process image.
pub struct NetworkPlant {
    stepper: Stepper,
    name: &'static str,
    line_names: &'static [&'static str],
    /// Mass flows of the first lines \[kg/s\].
    flows_kg_s: [f32; SHOWN_OUTPUTS],
    /// Inputs that hardware drives, by channel, once they have been looked up.
    live: [Option<LiveInput>; CHANNELS],
}

/// Builds the plant from the network that is compiled in, with its file's method and step. To be called once.
///
/// # Panics
/// When called twice.
pub fn compiled_in() -> Result<NetworkPlant, BuildError> {
    const LENGTH: eclss_core::Sizes = table::BUFFERS;
    type Buffers = Storage<{ LENGTH.state }, { LENGTH.work }, { LENGTH.inputs }, { LENGTH.cursors }>;
    const _: () = assert!(size_of::<Buffers>() == table::RAM_BYTES);
    static STORAGE: ConstStaticCell<Buffers> = ConstStaticCell::new(Storage::new());
    let storage = STORAGE.take();
    let simulator = Simulator::new(&table::NETWORK, table::Configured::SETTINGS, storage.buffers())?;
    let stepper = if SPECIALISED {
        // The simulator was built with these very settings, so it is always taken.
        CompiledSimulator::new(simulator).map(Stepper::Specialised)
    } else {
        Some(Stepper::General(simulator))
    };
    Ok(NetworkPlant {
        stepper: stepper.expect("description and settings are the simulator's"),
        name: table::NAME,
        line_names: &table::LINE_NAMES,
        flows_kg_s: [0.0; SHOWN_OUTPUTS],
        live: [None; CHANNELS],
    })
}

/// A network's end of a link; `None` where no channel goes over one.
pub fn link(plant: &NetworkPlant, image: &Image<'_>, role: Role, nonce: u32) -> Option<Link> {
    let (inputs, outputs) = coupling::link_counts(image);
    let config = Config {
        role,
        network_id: plant.network_id(),
        process_id: image.id(),
        step_us: plant.settings().step_us,
        inputs,
        outputs,
        // A session outlives the silence that leads to SAFE.
        silent_ticks: image.safe_after_ticks.saturating_mul(10),
        stale_us: match role {
            Role::Plant => u64::from(image.safe_after_ticks) * u64::from(plant.settings().step_us),
            Role::Controller => u64::MAX,
        },
        ..Config::default()
    };
    (inputs + outputs > 0).then(|| Link::new(config, nonce))
}

/// The compiled-in network's end of a link; `None` where no channel goes over one.
pub fn compiled_in_link(plant: &NetworkPlant, role: Role, nonce: u32) -> Option<Link> {
    link(plant, &table::PROCESS, role, nonce)
}

/// The compiled-in process image with the link that `link` makes. To be called once.
///
/// # Panics
/// When called twice.
pub fn compiled_in_coupling(link: impl FnOnce() -> Option<Link>) -> &'static mut Coupling<'static> {
    const INPUTS: usize = table::INPUT_CHANNELS.len();
    const OUTPUTS: usize = table::OUTPUT_CHANNELS.len();
    static IN: ConstStaticCell<[InputState; INPUTS]> =
        ConstStaticCell::new([const { InputState::new(0.0) }; INPUTS]);
    static OUT: ConstStaticCell<[OutputState; OUTPUTS]> =
        ConstStaticCell::new([const { OutputState::new(0.0) }; OUTPUTS]);
    // Kilobytes that are made where they stay instead of on the stack.
    static COUPLING: StaticCell<Coupling<'static>> = StaticCell::new();
    COUPLING.init_with(|| {
        let step_s = table::STEP_US as f32 * 1e-6;
        let process = Process::new(table::PROCESS, step_s, IN.take(), OUT.take());
        Coupling::new(process.expect("one state a channel"), step_s, link())
    })
}

/// Makes a plant of a simulator that was built at run time.
pub fn loaded(
    simulator: Simulator<'static>,
    name: &'static str,
    line_names: &'static [&'static str],
) -> NetworkPlant {
    NetworkPlant {
        stepper: Stepper::General(simulator),
        name,
        line_names,
        flows_kg_s: [0.0; SHOWN_OUTPUTS],
        live: [None; CHANNELS],
    }
}

impl NetworkPlant {
    fn simulator(&self) -> &Simulator<'static> {
        match &self.stepper {
            Stepper::Specialised(simulator) => simulator,
            Stepper::General(simulator) => simulator,
        }
    }

    /// Name of the network.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// Names of its lines, where they are known.
    pub fn line_names(&self) -> &'static [&'static str] {
        self.line_names
    }

    /// Id of the network's description.
    pub fn network_id(&self) -> u64 {
        self.simulator().network_id()
    }

    /// Method and step.
    pub fn settings(&self) -> Settings {
        self.simulator().settings()
    }
}

impl Plant for NetworkPlant {
    fn restart(&mut self) {
        match &mut self.stepper {
            Stepper::Specialised(simulator) => simulator.restart(),
            Stepper::General(simulator) => simulator.restart(),
        }
    }
    fn apply(&mut self, channel: usize, slot: u32, applied: Applied) {
        let Some(live) = self.live.get_mut(channel) else { return };
        if live.is_none_or(|live| live.slot() != slot as usize) {
            // Looked up by a search, but once only.
            let simulator = match &self.stepper {
                Stepper::Specialised(simulator) => simulator,
                Stepper::General(simulator) => simulator,
            };
            *live = simulator.live_input(slot as usize).ok();
        }
        let Some(live) = *live else { return };
        // What is out of range leaves what there is.
        let _ = match &mut self.stepper {
            Stepper::Specialised(simulator) => simulator.set_live(&live, applied.value, applied.slope_per_s),
            Stepper::General(simulator) => simulator.set_live(&live, applied.value, applied.slope_per_s),
        };
    }
    fn set(&mut self, slot: u32, value: f32) -> bool {
        let slot = slot as usize;
        match &mut self.stepper {
            Stepper::Specialised(simulator) => simulator.set_input(slot, value).is_ok(),
            Stepper::General(simulator) => simulator.set_input(slot, value).is_ok(),
        }
    }
    fn input(&self, slot: u32) -> Option<f32> {
        self.simulator().inputs().get(slot as usize).copied()
    }
    fn signal(&self, signal: Signal) -> f32 {
        self.simulator().signal(signal)
    }
    #[cfg_attr(feature = "nucleo-h743zi2", unsafe(link_section = ".itcm.step"))]
    #[allow(unsafe_code, reason = "on the board with tightly coupled memory, the step runs from it")]
    #[inline(never)]
    fn step(&mut self) -> Result<(), Untrusted> {
        let health = match &mut self.stepper {
            Stepper::Specialised(simulator) if SPECIALISED => simulator.step(),
            Stepper::Specialised(_) => Health::Trusted,
            Stepper::General(simulator) => simulator.step(),
        };
        let simulator = self.simulator();
        let lines = simulator.network().lines.len();
        let mut flows_kg_s = [0.0; SHOWN_OUTPUTS];
        for (line, flow) in flows_kg_s.iter_mut().enumerate().take(lines) {
            *flow = simulator.line_flow_kg_s(line);
        }
        self.flows_kg_s = flows_kg_s;
        match health {
            Health::Trusted => Ok(()),
            Health::Faulted(fault) => Err(fault),
        }
    }
    fn outputs(&self) -> &[f32] {
        let lines = self.simulator().network().lines.len();
        self.flows_kg_s.get(..lines).unwrap_or(&self.flows_kg_s)
    }
    fn state_hash(&self) -> u64 {
        self.simulator().state_hash()
    }
    fn values_hash(&self) -> u64 {
        let mut hash = Fingerprint::default();
        hash.values(self.simulator().state());
        hash.finish()
    }
}
