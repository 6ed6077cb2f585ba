//! `eclss-rt hil` under its operator: what is typed, what signals do, and what is left behind.

use std::path::PathBuf;
use std::time::Duration;

use crate::bench::console::Console;
use crate::bench::{network, place, settled};
use eclss_core::mode::Mode;
use eclss_core::protocol::{Link as Session, Outgoing, Role};
use eclss_host_sim::hil::replay::replay;
use eclss_target::wire::{Address, open};

const STEP_US: u32 = 10_000;

/// A plant at rest, and where its link is.
struct Plant {
    console: Console,
    socket: PathBuf,
}

/// Starts `networks/hil.toml` at rest with its link on a socket, and waits until it listens to orders.
fn plant(name: &str, more: &[&str]) -> Plant {
    let source = network("hil.toml");
    let (socket, start) = (place(&format!("{name}.sock")), place(&format!("{name}.eckp")));
    std::fs::write(&start, settled(&source, STEP_US)).unwrap();
    let link = format!("unix-listen:{}", socket.display());
    let words = [
        &["hil", "--network", "networks/hil.toml", "--rate", "100", "--link", &link, "--operator"][..],
        &["--start", start.to_str().unwrap()],
        more,
    ];
    Plant { console: Console::start(&words.concat()), socket }
}

/// Sends good values to the plant at `socket` as long as it is there.
fn hardware(socket: PathBuf) {
    let config = crate::bench::config(&network("hil.toml"), Role::Controller, STEP_US);
    std::thread::spawn(move || {
        let (mut link, _keeper) = open(&Address::Unix { path: socket, listens: false }).unwrap();
        let mut session = Session::new(config, 5);
        let mut bytes = [0; 2_048];
        for tick in 0.. {
            let length = link.read(&mut bytes);
            session.feed(&bytes[..length], tick);
            let values = Outgoing { mode: Mode::Run, values: &[1.0, 1.0], ..Outgoing::default() };
            session.send_tick(tick, tick, &values);
            let taken = link.write(session.outgoing());
            session.sent(taken);
            std::thread::sleep(Duration::from_micros(STEP_US.into()));
        }
    });
}

/// INIT ends at the operator's word, and by the limits of the file.
#[test]
fn init_ends_when_the_operator_says_so() {
    let file = place("restless.toml");
    let text = std::fs::read_to_string("../networks/hil.toml").unwrap();
    let process = "[process]\nsettled_s = 3000.0\n";
    std::fs::write(&file, text.replacen("[process]\n", process, 1)).unwrap();
    let words = ["hil", "--network", file.to_str().unwrap(), "--rate", "100", "--speed", "100", "--operator"];
    let mut console = Console::start(&words);
    console.wait_for("→ INIT");
    console.listen(Duration::from_secs(2));
    assert_eq!(console.count("→ READY"), 0, "it is to stand still for most of an hour");
    console.order("settle");
    console.wait_for("INIT → READY");
    std::fs::write(
        &file,
        text.replacen("[process]\n", "[process]\nsettled_part = 1.0\nsettled_s = 0.0\n", 1),
    )
    .unwrap();
    let mut console = Console::start(&words);
    let line = console.wait_for("→ READY");
    assert!(line.contains("INIT →") || line.contains("POWERUP →"), "{line}");
}

/// A driven input is overridden and released; what was forced stands in the record.
#[test]
fn an_input_is_forced_and_released() {
    let folder = place("forced");
    let mut plant = plant("forced", &["--arm", "--record", folder.to_str().unwrap()]);
    hardware(plant.socket.clone());
    let console = &mut plant.console;
    console.wait_for("READY → RUN");
    console.order("force valve.opening value 7");
    console.wait_for("valve.opening carries 0.02 to 1");
    console.order("force valve.opening value 0.4");
    console.wait_for("operator: force valve.opening value 0.4");
    console.listen(Duration::from_secs(3));
    console.order("release valve.opening");
    console.listen(Duration::from_secs(3));
    console.order("quit");
    assert!(console.end(Duration::from_secs(20)).success());
    let csv = std::fs::read_to_string(folder.join("record.csv")).unwrap();
    let place = csv.lines().next().unwrap().split(',').position(|name| name == "valve.opening").unwrap();
    let openings: Vec<f32> =
        csv.lines().skip(1).filter_map(|line| line.split(',').nth(place)?.parse().ok()).collect();
    let forced = openings.iter().filter(|opening| (**opening - 0.4).abs() < 1e-6).count();
    assert!(forced > 50, "{forced} rows at the forced value");
    assert!(openings.last().is_some_and(|opening| (opening - 1.0).abs() < 1e-6), "the hardware's again");
    assert!(replay(&folder.join("record.mcap")).unwrap().agrees());
}

/// A tick in RUN that takes longer than silence may last is SAFE, though no tick behind it is late.
#[test]
fn a_stall_leads_to_safe() {
    let mut plant = plant("stall", &["--arm", "--stall", "600:300ms"]);
    hardware(plant.socket.clone());
    plant.console.wait_for("READY → RUN");
    let line = plant.console.wait_for("RUN → SAFE");
    assert!(line.contains("µs behind the wall"), "{line}");
}

/// Input without end, signals and time: each ends the run in good order, with its record.
#[test]
fn a_run_ends_whatever_is_typed() {
    use std::io::Write as _;
    for (name, ending) in
        [("duration", None), ("term", Some("TERM")), ("hup", Some("HUP")), ("int", Some("INT"))]
    {
        let folder = place(&format!("endless-{name}"));
        let more = ["--record", folder.to_str().unwrap()];
        let more = if ending.is_none() { [&more[..], &["--duration", "2s"]].concat() } else { more.to_vec() };
        let mut plant = plant(&format!("endless-{name}"), &more);
        plant.console.wait_for("INIT");
        let mut orders = plant.console.orders.take().unwrap();
        let typist = std::thread::spawn(move || {
            let text = "hold\nfly\n\nstep 3\n".repeat(1_000);
            while orders.write_all(text.as_bytes()).is_ok() {}
        });
        plant.console.listen(Duration::from_secs(1));
        if let Some(signal) = ending {
            let pid = plant.console.child.id().to_string();
            assert!(
                std::process::Command::new("kill").args(["-s", signal, &pid]).status().unwrap().success()
            );
        }
        assert!(
            plant.console.end(Duration::from_secs(20)).success(),
            "{name}: {:?}",
            plant.console.said.last()
        );
        typist.join().unwrap();
        let bytes = std::fs::metadata(folder.join("record.mcap")).unwrap().len();
        assert!(bytes < 3_000_000, "{name}: {bytes} bytes of record");
        assert!(plant.console.said.iter().any(|line| line.starts_with("state hash")), "{name}");
    }
}

/// A record of a killed run can be read up to a second before its end, and replayed as far as it goes.
#[test]
fn a_record_outlives_its_program() {
    let folder = place("killed");
    let words = ["hil", "--network", "networks/paper.toml", "--rate", "100", "--every", "10ms", "--record"];
    let mut console = Console::start(&[&words[..], &[folder.to_str().unwrap()]].concat());
    console.wait_for("→ RUN");
    console.listen(Duration::from_millis(3_500));
    console.child.kill().unwrap();
    console.child.wait().unwrap();
    let replayed = replay(&folder.join("record.mcap")).unwrap();
    assert!(replayed.steps >= 100 && replayed.recorded_hash.is_none(), "{replayed:?}");
    let csv = std::fs::read_to_string(folder.join("record.csv")).unwrap();
    assert!(csv.lines().count() > 100, "{} rows", csv.lines().count());
}

/// On a disk that takes no more the run goes on, says so, and leaves what was recorded until then.
#[test]
fn a_full_disk_ends_the_record_and_not_the_run() {
    let folder = place("full");
    let program = env!("CARGO_BIN_EXE_eclss-rt");
    let arguments = "hil --network networks/paper.toml --speed inf --duration 30s --every 10ms --record";
    // A file may grow to half a megabyte.
    let line = format!("trap '' XFSZ; ulimit -f 1024; exec {program} {arguments} {}", folder.display());
    let run = std::process::Command::new("sh").args(["-c", &line]).current_dir("..").output().unwrap();
    let said = String::from_utf8(run.stdout).unwrap() + &String::from_utf8(run.stderr).unwrap();
    assert!(run.status.code() == Some(1) && said.contains("cannot write the record"), "{said}");
    let replayed = replay(&folder.join("record.mcap")).unwrap();
    assert!(replayed.steps >= 100 && replayed.recorded_hash.is_none(), "{replayed:?}");
}

/// No record is written over.
#[test]
fn a_second_record_in_the_same_folder_is_refused() {
    let folder = place("twice");
    let words =
        ["hil", "--network", "networks/paper.toml", "--speed", "inf", "--duration", "100ms", "--record"];
    let run = || {
        let mut console = Console::start(&[&words[..], &[folder.to_str().unwrap()]].concat());
        (console.end(Duration::from_secs(30)).code(), console.said.join("\n"))
    };
    assert_eq!(run().0, Some(0));
    let files = || ["record.csv", "record.mcap"].map(|name| std::fs::read(folder.join(name)).unwrap());
    let first = files();
    let (code, said) = run();
    assert!(code == Some(2) && said.contains("is there already"), "{said}");
    assert!(files() == first);
}

/// A coupling that `check --hil` refuses is not started unless it is accepted by name; both warn before arming.
#[test]
fn an_unstable_coupling_is_not_started() {
    let file = place("tight.toml");
    let text = std::fs::read_to_string("../networks/hil.toml").unwrap();
    let rig = "\n[[node]]\nid = \"box\"\nkind = \"cabin\"\nvolume_m3 = 0.005\npressure_pa = 101325.0\ntemperature_k = \
               295.15\n\n[[line]]\nid = \"hardware\"\nfrom = \"cabin\"\nto = \"box\"\n\n[[line.element]]\nid = \
               \"rig\"\nkind = \"measured\"\nlargest_flow_kg_s = 0.5\nslope_kg_s_pa = 0.01\n\n[[channel]]\nbind = \
               \"rig.measured_flow\"\ndirection = \"in\"\nsafe_value = 0.0\n\n[[channel]]\nbind = \
               \"box.pressure\"\ndirection = \"out\"\nmin = -1000.0\nmax = 1000.0\nsafe_value = 0.0\n";
    std::fs::write(&file, text + rig).unwrap();
    let (file, socket) = (file.to_str().unwrap(), place("tight.sock"));
    let link = format!("unix-listen:{}", socket.display());
    let run = |words: &[&str]| {
        let mut console = Console::start(words);
        let status = console.end(Duration::from_secs(30));
        (status.code(), console.said.join("\n"))
    };
    let (code, said) = run(&["check", file, "--hil"]);
    assert!(code == Some(1) && said.contains("unstable, margin"), "{said}");
    assert!(said.contains("`valve.opening`: a sudden change by more than 0.1240 is"), "{said}");
    let hil = ["hil", "--network", file, "--link", &link, "--duration", "200ms"];
    let (code, said) = run(&hil);
    assert!(code == Some(2) && said.contains("unstable, margin") && !said.contains("INIT"), "{said}");
    assert!(said.contains("`valve.opening`: a sudden change by more than 0.1240 is"), "{said}");
    let (code, said) = run(&[&hil[..], &["--accept-margin"]].concat());
    assert!(code == Some(0) && said.contains("accepted: ") && said.contains("INIT"), "{said}");
}

/// After the operator has disarmed or stopped, hardware is armed by nobody but the operator.
#[test]
fn arming_is_once_and_the_operator_has_the_last_word() {
    let mut plant = plant("once", &["--arm"]);
    hardware(plant.socket.clone());
    let console = &mut plant.console;
    console.wait_for("READY → RUN");
    console.order("disarm");
    console.wait_for("RUN → READY");
    console.listen(Duration::from_millis(2_500));
    assert_eq!(console.count("READY → RUN"), 1, "{}", console.said.join("\n"));
    console.order("arm");
    console.wait_for("READY → RUN");
    console.order("stop");
    console.wait_for("RUN → SAFE");
    console.order("acknowledge");
    console.wait_for("SAFE → READY");
    console.listen(Duration::from_millis(2_500));
    assert_eq!(console.count("READY → RUN"), 2, "{}", console.said.join("\n"));
    console.order("quit");
    assert!(console.end(Duration::from_secs(20)).success());
}
