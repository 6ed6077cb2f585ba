//! Watches the air that people breathe during a run: which limits were broken, where, and for how long.

use eclss_core::climate::monitor::{Limit, Monitor};
use eclss_core::{Element, Simulator};
use eclss_network_file::Loaded;

/// Plant time between two looks [µs].
const EVERY_US: u64 = 1_000_000;

/// A limit that was broken in a cabin.
#[derive(Debug, Clone, serde::Serialize)]
pub struct Breach {
    /// Id of the cabin.
    pub node: String,
    /// The limit, in words.
    pub limit: &'static str,
    /// When it was broken first [s].
    pub first_s: f64,
    /// For how long it was broken in all [s].
    pub broken_s: f64,
}

/// Monitors of all cabins with a crew, and what they found.
#[derive(Debug, Default)]
pub(super) struct Watch {
    cabins: Vec<(usize, String, Monitor)>,
    breaches: Vec<(usize, Limit, Breach)>,
    last_us: u64,
}

impl Watch {
    /// Watches the cabins of `loaded` that have a crew.
    pub(super) fn of(loaded: &Loaded) -> Self {
        let mut nodes: Vec<usize> = loaded.climate.crews.iter().map(|crew| crew.node as usize).collect();
        nodes.sort_unstable();
        nodes.dedup();
        let cabin = |node: usize| (node, loaded.names.nodes[node].clone(), Monitor::default());
        Self { cabins: nodes.into_iter().map(cabin).collect(), ..Self::default() }
    }

    /// Whether it is time for a look.
    pub(super) fn is_due<E: Element>(&self, counters: &Simulator<'_, E>) -> bool {
        !self.cabins.is_empty() && counters.time_us() >= self.last_us + EVERY_US
    }

    /// Looks at all cabins.
    pub(super) fn look<E: Element>(&mut self, simulator: &Simulator<'_, E>) {
        let now = simulator.time_us();
        let time_s = (now - self.last_us) as f64 * 1e-6;
        self.last_us = now;
        for (node, id, monitor) in &mut self.cabins {
            let Some(air) = simulator.air(*node) else { continue };
            let broken = monitor.watch(&air, time_s as f32);
            if broken.is_none() {
                continue;
            }
            for limit in Limit::ALL.into_iter().filter(|limit| broken.has(*limit)) {
                let known = self.breaches.iter_mut().find(|(of, known, _)| of == node && *known == limit);
                if let Some((_, _, breach)) = known {
                    breach.broken_s += time_s;
                } else {
                    let first_s = now as f64 * 1e-6;
                    let breach = Breach { node: id.clone(), limit: limit.text(), first_s, broken_s: time_s };
                    self.breaches.push((*node, limit, breach));
                }
            }
        }
    }

    /// What was found, in the order in which it came.
    pub(super) fn breaches(self) -> Vec<Breach> {
        self.breaches.into_iter().map(|(_, _, breach)| breach).collect()
    }
}
