//! The largest network that the format takes is read in seconds, not minutes.

use std::fmt::Write as _;
use std::time::{Duration, Instant};

use eclss_core::Method;
use eclss_network_file::{limits, parse};

/// A ring of cabins, each with a line to the next that holds a fan, ducts and a valve.
fn ring(cabins: usize) -> String {
    let mut text = String::from("schema = 1\nname = \"ring\"\nreference_pressure_pa = 101325.0\n");
    for index in 0..cabins {
        let next = (index + 1) % cabins;
        let _ = write!(
            text,
            "[[node]]\nid = \"n{index}\"\nkind = \"cabin\"\nvolume_m3 = 60.0\npressure_pa = 101325.0\n\
             temperature_k = 295.15\n\
             [[line]]\nid = \"l{index}\"\nfrom = \"n{index}\"\nto = \"n{next}\"\n\
             [[line.element]]\nid = \"fan{index}\"\nkind = \"fan\"\nshutoff_pa = 300.0\nquadratic_pa_s2_kg2 = 1.3e4\n"
        );
        for duct in 0..14 {
            let _ = write!(
                text,
                "[[line.element]]\nid = \"d{index}_{duct}\"\nkind = \"pipe\"\nresistance_pa_s2_kg2 = 1.{duct}e3\n"
            );
        }
        let _ = write!(
            text,
            "[[line.element]]\nid = \"v{index}\"\nkind = \"valve\"\nopen_resistance_pa_s2_kg2 = 86.0\n\
             exponent = 3.1\n\
             [[schedule]]\ninput = \"v{index}.opening\"\npoints = [[0.0, 1.0], [1.0, 0.5]]\n"
        );
    }
    text
}

#[test]
fn a_network_at_the_limits_is_read_in_seconds() {
    let text = ring(limits::SCHEDULES);
    let start = Instant::now();
    let loaded = parse(&text, "ring.toml").unwrap_or_else(|error| panic!("{error}"));
    let took = start.elapsed();
    println!("{} bytes in {took:?}", text.len());
    assert_eq!(loaded.segments.len(), limits::ELEMENTS);
    assert_eq!(loaded.schedules.len(), limits::SCHEDULES);
    let network = loaded.network();
    for method in Method::ALL {
        assert_eq!(method.check(&network, 1_000), Ok(()), "{method:?}");
    }
    // Without optimisation the time says nothing.
    assert!(cfg!(debug_assertions) || took < Duration::from_mins(1), "{took:?}");
}
