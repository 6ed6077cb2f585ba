//! What a step of every method costs, with the state that it ends in.

use super::{steps, trace_begin, trace_end};
use crate::network::table;
use core::hint::black_box;
use defmt::error;
use eclss_core::{
    AnyComponent, Compiled, CompiledSimulator, Health, Method, Network, Settings, Simulator, Sizes, Storage,
};
use static_cell::ConstStaticCell;

macro_rules! generated {
    ($(#[$about:meta])* $module:ident, $file:literal) => {
        $(#[$about])*
        #[allow(clippy::unreadable_literal, clippy::excessive_precision, clippy::enum_glob_use, reason = "generated")]
        #[allow(missing_docs, dead_code, unreachable_pub, reason = "generated")]
        mod $module {
            include!(concat!(env!("OUT_DIR"), "/", $file));
        }
    };
}
generated!(
    /// The paper's loop with its schedule a thousand times as fast.
    quick,
    "quick.rs"
);
generated!(
    /// Temperature and humidity control over a day that passes a thousand times as fast.
    thcs,
    "thcs.rs"
);
generated!(
    /// 1099 pipes and a valve.
    chain,
    "chain.rs"
);
generated!(
    /// 550 nodes and 550 lines.
    general,
    "general.rs"
);

/// A compiled-in network under one of the methods.
struct With<N, const METHOD: usize>(core::marker::PhantomData<N>);

impl<N: Compiled<Element = AnyComponent>, const METHOD: usize> Compiled for With<N, METHOD> {
    type Element = AnyComponent;
    const NETWORK: Network<'static> = N::NETWORK;
    const SETTINGS: Settings = Settings { method: Method::ALL[METHOD], step_us: N::SETTINGS.step_us };
}

/// Steps of the paper's scenario: 26 s.
const PAPER_STEPS: u32 = 26_000;
/// Steps of the fast day: 86.4 s.
pub(super) const DAY_STEPS: u32 = 8_640;
/// Steps of the large networks: past the closing of their valve.
const LARGE_STEPS: u32 = 400;
/// Steps of the fast scenario.
const QUICK_STEPS: u32 = 26;

/// Enough for the paper's loop with any method.
const MOST: Sizes = {
    let all = [table::EULER, table::RELAXATION, table::ADAPTIVE, table::IMPLICIT_EULER, table::TR_BDF2];
    let mut most = all[0];
    let mut index = 1;
    while index < all.len() {
        let Sizes { state, work, .. } = all[index];
        if state > most.state {
            most.state = state;
        }
        if work > most.work {
            most.work = work;
        }
        index += 1;
    }
    most
};
type Small = Storage<{ MOST.state }, { MOST.work }, { MOST.inputs }, { MOST.cursors }>;

/// Measures everything. False when a network was refused.
pub(super) fn measure() -> bool {
    let mut storage = Small::new();
    let small = paper::<0>(&mut storage)
        .and_then(|()| paper::<1>(&mut storage))
        .and_then(|()| paper::<2>(&mut storage))
        .and_then(|()| paper::<3>(&mut storage))
        .and_then(|()| paper::<4>(&mut storage));
    small.and_then(|()| large_chain()).and_then(|()| large_general()).is_some()
}

fn built<'a>(
    network: &'a Network<'a>,
    settings: Settings,
    buffers: eclss_core::Buffers<'a>,
) -> Option<Simulator<'a>> {
    Simulator::new(network, settings, buffers).map_err(|refused| error!("refused: {}", refused)).ok()
}

/// The paper's scenario with one method: specialised, then in general form without and with its schedule.
fn paper<const METHOD: usize>(storage: &mut Small) -> Option<()> {
    let settings = With::<table::Configured, METHOD>::SETTINGS;
    let name = settings.method.name();
    let simulator = built(&table::NETWORK, settings, storage.buffers())?;
    let mut simulator = CompiledSimulator::<With<table::Configured, METHOD>>::new(simulator)?;
    steps("paper", name, PAPER_STEPS, &mut simulator, specialised, |simulator| simulator);
    let mut simulator = built(&table::NETWORK, settings, storage.buffers())?;
    steps("paper-loaded", name, PAPER_STEPS, &mut simulator, general_step, |simulator| simulator);
    Some(())
}

/// So many steps of a day of temperature and humidity control with its file's method: specialised, then in general form.
pub(super) fn day(count: u32) -> Option<()> {
    const LENGTH: Sizes = thcs::BUFFERS;
    static STORAGE: ConstStaticCell<
        Storage<{ LENGTH.state }, { LENGTH.work }, { LENGTH.inputs }, { LENGTH.cursors }>,
    > = ConstStaticCell::new(Storage::new());
    let storage = STORAGE.take();
    let settings = thcs::Configured::SETTINGS;
    let name = settings.method.name();
    let simulator = built(&thcs::NETWORK, settings, storage.buffers())?;
    let mut simulator = CompiledSimulator::<thcs::Configured>::new(simulator)?;
    steps("thcs", name, count, &mut simulator, specialised, |simulator| simulator);
    let mut simulator = built(&thcs::NETWORK, settings, storage.buffers())?;
    steps("thcs-loaded", name, count, &mut simulator, general_step, |simulator| simulator);
    Some(())
}

fn large_chain() -> Option<()> {
    const LENGTH: Sizes = chain::BUFFERS;
    static STORAGE: ConstStaticCell<
        Storage<{ LENGTH.state }, { LENGTH.work }, { LENGTH.inputs }, { LENGTH.cursors }>,
    > = ConstStaticCell::new(Storage::new());
    let mut simulator = built(&chain::NETWORK, chain::Configured::SETTINGS, STORAGE.take().buffers())?;
    steps("chain-1100", "relaxation", LARGE_STEPS, &mut simulator, general_step, |simulator| simulator);
    Some(())
}

fn large_general() -> Option<()> {
    const LENGTH: Sizes = general::BUFFERS;
    static STORAGE: ConstStaticCell<
        Storage<{ LENGTH.state }, { LENGTH.work }, { LENGTH.inputs }, { LENGTH.cursors }>,
    > = ConstStaticCell::new(Storage::new());
    let mut simulator = built(&general::NETWORK, general::Configured::SETTINGS, STORAGE.take().buffers())?;
    steps("general-550", "adaptive", LARGE_STEPS, &mut simulator, general_step, |simulator| simulator);
    Some(())
}

#[inline(never)]
fn specialised<N: Compiled<Element = AnyComponent>>(simulator: &mut CompiledSimulator<'_, N>) -> Health {
    simulator.step()
}

#[inline(never)]
fn general_step(simulator: &mut Simulator<'_>) -> Health {
    simulator.step()
}

/// Runs the fast scenario with the method of this name. False when there is none or the network was refused.
pub(super) fn trace(method: &str) -> bool {
    let traces = [traced::<0>, traced::<1>, traced::<2>, traced::<3>, traced::<4>];
    let all = Method::ALL.iter().zip(traces);
    let mut chosen = all.filter(|(candidate, _)| candidate.name() == method);
    chosen.next().is_some_and(|(_, trace)| trace().is_some())
}

fn traced<const METHOD: usize>() -> Option<()> {
    let mut storage = Small::new();
    let settings = With::<quick::Configured, METHOD>::SETTINGS;
    let simulator = built(&quick::NETWORK, settings, storage.buffers())?;
    let mut simulator = CompiledSimulator::<With<quick::Configured, METHOD>>::new(simulator)?;
    for _ in 0..QUICK_STEPS {
        trace_begin();
        let health = black_box(specialised(&mut simulator));
        trace_end();
        // What stands still costs nothing.
        if health != Health::Trusted {
            break;
        }
    }
    Some(())
}
