//! The program `eclss-rt serve` as a child, and its answers to programs.

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use serde_json::Value;

use super::driver::PATIENCE;

/// A running `eclss-rt serve`; it is ended when dropped.
pub(crate) struct Plant {
    child: Child,
    /// Where the page is.
    pub(crate) link: String,
}

impl Plant {
    /// Serves a shipped network with control at a port, 0 for any.
    pub(crate) fn start(network: &str, port: u16) -> Self {
        Self::with(network, port, &[])
    }

    /// The same with further arguments.
    pub(crate) fn with(network: &str, port: u16, further: &[&str]) -> Self {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../networks").join(network);
        let mut child = Command::new(env!("CARGO_BIN_EXE_eclss-rt"))
            .arg("serve")
            .arg(path)
            .args(["--control", "--port", &port.to_string()])
            .args(further)
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .spawn()
            .expect("the program starts");
        let mut lines = BufReader::new(child.stdout.take().expect("its output")).lines();
        let link = lines.next().and_then(Result::ok).expect("it says where the page is");
        // What else it says, such as what real time it has to do without, belongs to the test's output.
        std::thread::spawn(move || lines.map_while(Result::ok).for_each(|line| println!("{line}")));
        Self { child, link }
    }

    /// The port.
    pub(crate) fn port(&self) -> u16 {
        let port = self.link.trim_end_matches('/').rsplit(':').next();
        port.and_then(|port| port.parse().ok()).expect("a link with a port")
    }

    /// The latest frame.
    pub(crate) fn frame(&self) -> Value {
        for _ in 0..100 {
            if let Ok(mut answer) = ureq::get(format!("{}frame", self.link)).call() {
                let text = answer.body_mut().read_to_string().expect("a body");
                return serde_json::from_str(&text).expect("JSON");
            }
            sleep(Duration::from_millis(20));
        }
        panic!("no frame from {}", self.link)
    }

    /// A published value of the latest frame.
    pub(crate) fn value(&self, id: &str) -> f64 {
        let mut answer = ureq::get(format!("{}network", self.link)).call().expect("an answer");
        let network: Value =
            serde_json::from_str(&answer.body_mut().read_to_string().expect("a body")).expect("JSON");
        let values = network["values"].as_array().expect("values");
        let place = values.iter().position(|value| value["id"] == id).expect("a published value");
        self.frame()["values"][place].as_f64().expect("a number")
    }
}

impl Plant {
    /// Waits until a published value is as it should be.
    #[track_caller]
    pub(crate) fn wait(&self, id: &str, wanted: &str, is: impl Fn(f64) -> bool) {
        let until = Instant::now() + PATIENCE;
        loop {
            let value = self.value(id);
            if is(value) {
                return;
            }
            assert!(Instant::now() < until, "{id} is {value}, never {wanted}");
            sleep(Duration::from_millis(50));
        }
    }

    /// The tick at which a plant stands that is held: the same over several frames.
    #[track_caller]
    pub(crate) fn still(&self) -> u64 {
        let tick = || self.frame()["figures"]["tick"].as_u64().expect("a tick");
        let until = Instant::now() + PATIENCE;
        let mut last = tick();
        loop {
            sleep(Duration::from_millis(300));
            let next = tick();
            if next == last {
                return next;
            }
            assert!(Instant::now() < until, "it is not held: tick {next}");
            last = next;
        }
    }
}

impl Drop for Plant {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
