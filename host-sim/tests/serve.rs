//! A served plant without a page: frames, commands, malfunctions, scenarios.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use eclss_core::{Method, Settings};
use eclss_host_sim::Source;
use eclss_host_sim::serve::feed::{InputState, Malfunction};
use eclss_host_sim::serve::{Command, Feed, Frame, Plant, feed};

/// A plant on a thread of its own; it is stopped when dropped.
struct Running {
    feed: Feed,
    stop: Arc<AtomicBool>,
    thread: Option<std::thread::JoinHandle<()>>,
    frame: Frame,
}

impl Running {
    fn start(path: &str, method: Method) -> Self {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../networks").join(path);
        let plant = Plant::new(Source::file(&path).unwrap(), Settings { method, step_us: 1_000 }).unwrap();
        let (publisher, feed) = feed(plant.catalogue(true));
        let stop = Arc::new(AtomicBool::new(false));
        let own = Arc::clone(&stop);
        let thread = std::thread::spawn(move || plant.run(publisher, &own).unwrap());
        Self { feed, stop, thread: Some(thread), frame: Frame::default() }
    }

    fn ask(&self, command: Command) {
        assert!(self.feed.command(command), "{command:?}");
    }

    /// Waits for a frame that `holds`.
    #[track_caller]
    fn wait(&mut self, what: &str, holds: impl Fn(&Self) -> bool) {
        let until = Instant::now() + Duration::from_secs(20);
        loop {
            if self.feed.fetch(&mut self.frame) && holds(self) {
                return;
            }
            assert!(Instant::now() < until, "never: {what}; {:?}", self.frame);
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    fn value(&self, id: &str) -> f32 {
        let place = self.feed.catalogue.values.iter().position(|value| value.id == id);
        self.frame.values[place.unwrap_or_else(|| panic!("{id} is not published"))]
    }

    fn input(&self, id: &str) -> usize {
        self.feed.catalogue.inputs.iter().position(|input| input.id == id).unwrap()
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        let ended = self.thread.take().map(std::thread::JoinHandle::join);
        assert!(std::thread::panicking() || matches!(ended, Some(Ok(()))), "the plant's thread panicked");
    }
}

#[test]
fn it_is_held_steps_and_runs_on() {
    let mut plant = Running::start("paper.toml", Method::Relaxation);
    plant.ask(Command::Pause { on: true });
    plant.wait("held", |plant| plant.frame.figures.paused);
    let tick = plant.frame.figures.tick;
    plant.ask(Command::Step { steps: 250 });
    plant.wait("stepped", |plant| plant.frame.figures.tick != tick);
    plant.wait("all steps", |plant| plant.frame.figures.tick == tick + 250);
    assert!((plant.frame.figures.t_s - (tick + 250) as f64 * 1e-3).abs() < 1e-9);
    plant.ask(Command::Speed { factor: 20.0 });
    plant.ask(Command::Pause { on: false });
    plant.wait("open and settled", |plant| plant.frame.figures.t_s > 8.0);
    assert!((plant.value("loop.mass_flow") - 0.0865).abs() < 1e-3);
    plant.wait("the schedule has shut the valve", |plant| plant.value("valve.opening") < 0.021);
    // φ of the only line is the smallest φ, but for the flow, which has moved by one step since.
    plant.wait("slowed", |plant| plant.frame.figures.phi < 0.5);
    let (line, least) = (plant.value("loop.phi"), plant.frame.figures.phi);
    assert!((line / least - 1.0).abs() < 0.02, "{line} and {least}");
    assert!(plant.frame.figures.trusted && plant.frame.figures.closure < 1e-9);
}

#[test]
fn schedules_are_not_overruled_and_by_hand_there_are_none() {
    let mut plant = Running::start("paper.toml", Method::Relaxation);
    let valve = plant.input("valve.opening");
    plant.ask(Command::Set { input: valve, value: 0.5 });
    plant.ask(Command::Break { input: valve, how: Some(Malfunction::Low) });
    plant.wait("both are refused", |plant| plant.frame.figures.refused == 2);
    assert_eq!(plant.frame.inputs[valve], InputState::Scheduled);
    plant.ask(Command::Scenario { number: 1 });
    plant.wait("by hand", |plant| plant.frame.inputs[valve] == InputState::Free);
    plant.ask(Command::Set { input: valve, value: 0.5 });
    plant.wait("it follows", |plant| (plant.value("valve.opening") - 0.5).abs() < 1e-6);
    for wrong in [
        Command::Set { input: 99, value: 0.0 },
        Command::Set { input: valve, value: f32::NAN },
        Command::Break { input: 99, how: None },
        Command::Scenario { number: 9 },
        Command::Speed { factor: 0.0 },
        Command::Speed { factor: f32::NAN },
    ] {
        plant.ask(wrong);
    }
    plant.wait("all are refused", |plant| plant.frame.figures.refused == 8);
    plant.ask(Command::Set { input: valve, value: 7.0 });
    plant.wait("kept within its range", |plant| (plant.value("valve.opening") - 1.0).abs() < 1e-6);
}

#[test]
fn a_broken_input_ignores_its_slider_until_it_is_repaired() {
    let mut plant = Running::start("station.toml", Method::TrBdf2);
    let fan = plant.input("lab_node1_fan.speed");
    let speed = |plant: &Running| plant.value("lab_node1_fan.speed");
    plant.ask(Command::Break { input: fan, how: Some(Malfunction::Low) });
    plant.wait("it stops", |plant| speed(plant) < 1e-6 && plant.frame.inputs[fan] == InputState::Low);
    plant.ask(Command::Set { input: fan, value: 0.8 });
    plant.wait("the air slows", |plant| plant.value("lab_node1.mass_flow") < 0.05);
    assert!(speed(&plant) < 1e-6, "the slider moved a broken fan");
    plant.ask(Command::Break { input: fan, how: None });
    plant.wait("it follows again", |plant| (speed(plant) - 0.8).abs() < 1e-6);
    plant.ask(Command::Break { input: fan, how: Some(Malfunction::Stuck) });
    plant.ask(Command::Set { input: fan, value: 0.1 });
    plant.wait("it is stuck", |plant| plant.frame.inputs[fan] == InputState::Stuck);
    assert!((speed(&plant) - 0.8).abs() < 1e-6);
}

#[test]
fn what_a_method_slows_is_published_and_nothing_else() {
    for (method, slowed) in [(Method::Adaptive, "lab.phi"), (Method::TrBdf2, "")] {
        let mut plant = Running::start("station.toml", method);
        plant.wait("a frame", |plant| plant.frame.figures.tick > 5);
        let published: Vec<_> = plant
            .feed
            .catalogue
            .values
            .iter()
            .filter(|value| value.id.rsplit('.').next() == Some("phi"))
            .collect();
        assert_eq!(published.first().map_or("", |value| &value.id), slowed);
        if method == Method::Adaptive {
            assert_eq!(published.len(), plant.feed.catalogue.nodes.len());
            let least = published.iter().map(|value| plant.value(&value.id)).fold(1.0, f32::min);
            assert!((least - plant.frame.figures.phi).abs() < 1e-6);
        }
        assert!(plant.frame.values.iter().all(|value| value.is_finite()), "{:?}", plant.frame);
    }
}
