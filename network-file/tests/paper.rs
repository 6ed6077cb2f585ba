//! The shipped description of the paper's experiment gives the paper's figures.

use eclss_core::{Method, Settings, Simulator, Storage, example};
use eclss_network_file::{Loaded, load};
use std::path::Path;

fn paper() -> Loaded {
    load(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../networks/paper.toml")))
        .expect("the shipped file loads")
}

#[test]
fn it_is_the_loop_that_core_has_as_an_example() {
    let loaded = paper();
    let (file, example) = (loaded.network(), example::paper_loop());
    assert_eq!(file.nodes, example.nodes);
    assert_eq!(file.lines, example.lines);
    assert_eq!(file.active, example.active);
    for (ours, theirs) in file.segments.iter().zip(example.segments) {
        assert_eq!(ours.element, theirs.element);
        assert!((ours.inertance_per_m - theirs.inertance_per_m).abs() < 1e-3);
    }
    // Stored volume inside the line; the valve's outlet is the cabin.
    let volumes: Vec<_> = file.segments.iter().map(|segment| segment.outlet_volume_m3).collect();
    assert!(volumes[..5].iter().all(|volume| (volume - 0.015_707_963).abs() < 2e-9));
    assert!(volumes[5].abs() < f32::MIN_POSITIVE);
    assert_eq!(loaded.names.inputs, ["fan.speed", "valve.opening"]);
    assert_eq!(loaded.run.method, Method::Relaxation);
    assert_eq!((loaded.run.step_us, loaded.run.until_us), (1_000, 26_000_000));
}

#[test]
fn it_runs_to_the_figures_of_the_paper() {
    let loaded = paper();
    let network = loaded.network();
    let mut storage = Storage::<256, 256, 8, 8>::new();
    let settings = Settings { method: loaded.run.method, step_us: loaded.run.step_us };
    let mut simulator = Simulator::new(&network, settings, storage.buffers()).expect("the paper's loop runs");
    for (time_s, grams, within) in [(10, 86.4784, 5e-4), (20, 4.0455, 5e-4), (26, 4.0593, 3e-4)] {
        while simulator.time_us() < time_s * 1_000_000 {
            simulator.step();
        }
        let flow = f64::from(simulator.line_flow_kg_s(0)) * 1e3;
        assert!((flow - grams).abs() <= within, "{flow} g/s at {time_s} s");
    }
}
