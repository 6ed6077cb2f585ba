//! Watches the air that people breathe during a run, and all volumes for what makes their figures doubtful: which limits
//! were broken, where, and for how long.

use eclss_core::climate::monitor::{Limit, Monitor};
use eclss_core::components::Crew;
use eclss_core::{Element, Simulator};
use eclss_network_file::Loaded;

/// Plant time between two looks [µs].
const EVERY_US: u64 = 1_000_000;

/// A limit that was broken in a volume.
#[derive(Debug, Clone, serde::Serialize)]
pub struct Breach {
    /// Id of the volume.
    pub node: String,
    /// The limit, in words.
    pub limit: &'static str,
    /// When it was broken first [s].
    pub first_s: f64,
    /// For how long it was broken in all [s].
    pub broken_s: f64,
}

/// All volumes, with monitors of those with a crew, and what they found.
#[derive(Debug, Default)]
pub(super) struct Watch {
    volumes: Vec<(String, Option<Monitor>)>,
    breaches: Vec<(usize, Limit, Breach)>,
    last_us: u64,
}

impl Watch {
    /// Watches the volumes of `loaded`, those that have a crew by what people bear.
    pub(super) fn of(loaded: &Loaded) -> Self {
        let climate = &loaded.climate;
        let volume = |(node, id): (usize, &String)| {
            let crewed =
                climate.climate().components_of::<Crew>().any(|(_, placed)| placed.node as usize == node);
            (id.clone(), crewed.then(Monitor::default))
        };
        let nodes = loaded.names.nodes.iter().take(climate.volumes.len());
        Self { volumes: nodes.enumerate().map(volume).collect(), ..Self::default() }
    }

    /// Whether it is time for a look.
    pub(super) fn is_due<E: Element>(&self, counters: &Simulator<'_, E>) -> bool {
        !self.volumes.is_empty() && counters.time_us() >= self.last_us + EVERY_US
    }

    /// Looks at all volumes.
    pub(super) fn look<E: Element>(&mut self, simulator: &Simulator<'_, E>) {
        let now = simulator.time_us();
        let time_s = (now - self.last_us) as f64 * 1e-6;
        self.last_us = now;
        for (node, (id, monitor)) in self.volumes.iter_mut().enumerate() {
            let warned = simulator.warnings(node);
            let air = monitor.as_mut().zip(simulator.air(node));
            let broken = air.map(|(monitor, air)| monitor.watch(&air, time_s as f32)).unwrap_or_default();
            if broken.is_none() && warned.is_none() {
                continue;
            }
            let found = Limit::ALL.into_iter().filter(|limit| broken.has(*limit) || warned.has(*limit));
            for limit in found {
                let known = self.breaches.iter_mut().find(|(of, known, _)| *of == node && *known == limit);
                if let Some((_, _, breach)) = known {
                    breach.broken_s += time_s;
                } else {
                    let first_s = now as f64 * 1e-6;
                    let breach = Breach { node: id.clone(), limit: limit.text(), first_s, broken_s: time_s };
                    self.breaches.push((node, limit, breach));
                }
            }
        }
    }

    /// What was found, in the order in which it came.
    pub(super) fn breaches(self) -> Vec<Breach> {
        self.breaches.into_iter().map(|(_, _, breach)| breach).collect()
    }
}
