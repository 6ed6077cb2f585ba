//! A volume that `adaptive` slows behaves like one that is larger by 1/φ, for everything that happens in it: crew, heat, removal
//! and fog as well as what flows. So it comes to the same rest.

use crate::support::{assert_closed, with_network};
use eclss_core::Health;

/// A cabin beside a short duct, which is stiff for a step of 10 ms.
const CABIN: &str = r#"
schema = 1
name = "slowed"
reference_pressure_pa = 101325.0
[run]
method = "adaptive"
step = "10ms"
[air]
[[node]]
id = "cabin"
kind = "cabin"
volume_m3 = 10.0
pressure_pa = 101325.0
temperature_k = 295.15
carbon_dioxide_pa = 1000.0
[[node]]
id = "ambient"
kind = "boundary"
pressure_pa = 101325.0
temperature_k = 295.15
[[line]]
id = "duct"
from = "cabin"
to = "ambient"
[[line.element]]
id = "pipe"
kind = "pipe"
resistance_pa_s2_kg2 = 100.0
"#;

/// Moist air beside a near vacuum, behind a door that opens after a second.
const AIRLOCK: &str = r#"
schema = 1
name = "airlock"
reference_pressure_pa = 101325.0
[run]
method = "METHOD"
step = "10ms"
[air]
[[node]]
id = "cabin"
kind = "cabin"
volume_m3 = 60.0
pressure_pa = 101325.0
temperature_k = 295.15
dew_point_k = 285.0
[[node]]
id = "lock"
kind = "cabin"
volume_m3 = 60.0
pressure_pa = 500.0
temperature_k = 295.15
[[line]]
id = "doorway"
density = "follows"
from = "cabin"
to = "lock"
[[line.element]]
id = "door"
kind = "hatch"
loss_coefficient = 1.5
area_m2 = 1.0
[[schedule]]
input = "door.opening"
points = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]
"#;

#[test]
fn heat_and_removal_are_slowed_with_the_volume_and_not_lost() {
    let heat = CABIN.to_owned() + "[[source]]\nid = \"lamp\"\nnode = \"cabin\"\nheat = 100.0\n";
    with_network(&heat, |_, simulator| {
        assert_eq!(simulator.step_times(60_000), Health::Trusted);
        let (phi, rise) = (simulator.storage_phi(0).unwrap(), simulator.node_temperature_k(0) - 295.15);
        assert!((1e-3..0.9).contains(&phi), "φ {phi} of a volume that is slowed");
        // 12 kg at constant pressure take 12.1 kJ/K.
        let expected = phi * 100.0 * 600.0 / 12_080.0;
        assert!((rise / expected - 1.0).abs() < 0.05, "{rise} K, {expected} K expected at φ {phi}");
    });
    let scrubber = "[[remover]]\nid = \"bed\"\nnode = \"cabin\"\npart = \"carbon_dioxide\"\nair_flow = 0.1\nefficiency = 1.0\n";
    with_network(&(CABIN.to_owned() + scrubber), |_, simulator| {
        assert_eq!(simulator.step_times(60_000), Health::Trusted);
        let (phi, left) =
            (simulator.storage_phi(0).unwrap(), simulator.air(0).unwrap().partial_pa[2] / 1_000.0);
        let expected = libm::expf(-phi * 0.1 * 600.0 / 11.95);
        assert!((left / expected - 1.0).abs() < 0.02, "{left} left, {expected} expected at φ {phi}");
    });
}

#[test]
fn fog_in_a_slowed_volume_is_water_and_no_more_than_there_is() {
    let rest = |method: &str| {
        with_network(&AIRLOCK.replace("METHOD", method), |_, simulator| {
            assert_eq!(
                simulator.step_times(60_000),
                Health::Trusted,
                "{method}: {:?}",
                simulator.excursion()
            );
            assert_closed(simulator);
            [0, 1].map(|node| simulator.air(node).unwrap())
        })
    };
    let (slowed, exact) = (rest("adaptive"), rest("implicit-euler"));
    for (slowed, exact) in slowed.iter().zip(&exact) {
        assert!(slowed.liquid_kg < 0.7, "{} kg of fog of 0.6 kg of water", slowed.liquid_kg);
        assert!((slowed.pressure_pa / exact.pressure_pa - 1.0).abs() < 0.03, "{slowed:?} {exact:?}");
    }
}
