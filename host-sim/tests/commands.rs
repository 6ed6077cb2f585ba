//! Commands, exit codes and refusals.

use std::io::Read;
use std::process::Stdio;

use crate::common::Folder;

const PAPER: &str = include_str!("../../networks/paper.toml");

#[test]
fn help_and_version_are_good() {
    let folder = Folder::new("help");
    for arguments in [&["--help"][..], &["run", "--help"], &["--version"]] {
        let (code, out, err) = folder.say(arguments);
        assert!(code == 0 && !out.is_empty() && err.is_empty(), "{arguments:?}");
    }
}

#[test]
fn wrong_usage_is_exit_code_2_with_a_reason() {
    let folder = Folder::new("usage");
    std::fs::write(folder.path("paper.toml"), PAPER).unwrap();
    std::fs::write(folder.path("binary.toml"), b"schema = 1\nname = \"\xff\"\n").unwrap();
    for (arguments, reason) in [
        (&["fly"][..], "fly"),
        (&["run", "--method", "magic"], "there are euler, relaxation"),
        (&["run", "--step", "1"], "number and a unit"),
        (&["run", "--step", "0.5us"], "whole number of microseconds"),
        (&["run", "--step", "20ms"], "too long for method `relaxation`"),
        (&["run", "--at", "1.5ms"], "not a whole number of steps"),
        (&["run", "--at", "2s", "--until", "1s"], "behind the end"),
        (&["run", "missing.toml"], "missing.toml: cannot be read"),
        (&["check", "missing.toml"], "missing.toml"),
        (&["stability", "--line", "nowhere"], "no line `nowhere`; there are loop"),
        (&["stability", "--input", "valve.speed"], "no input `valve.speed`"),
        (&["stability", "--from", "0.5", "--to", "0.2"], "moves within"),
        (&["stability", "--step", "20ms"], "too long for method `relaxation`"),
        (&["check", "binary.toml"], "binary.toml:2:9: not UTF-8 text"),
        (&["run", "paper.toml", "--step", "7ms"], "paper.toml: [run] until = 26 s is not a whole number"),
        (&["check", "paper.toml", "--save", "./paper.toml"], "--save needs another one"),
        (&["bench", "--sizes", "1"], "1"),
        (&["serve", "--control", "--listen", "0.0.0.0"], "--control would let anyone on the network"),
        (&["serve", "--listen", "somewhere"], "somewhere"),
        (&["serve", "--step", "20ms", "--port", "0"], "too long for method `relaxation`"),
        (&["schematic", "missing.toml"], "missing.toml: cannot be read"),
    ] {
        let (code, out, err) = folder.say(arguments);
        assert_eq!(code, 2, "{arguments:?}: {err}");
        assert!(err.starts_with("error: ") && err.contains(reason), "{arguments:?}: {err}");
        assert!(out.is_empty(), "{out}");
    }
}

#[test]
fn a_bad_file_is_refused_with_file_line_column_and_the_line_itself() {
    let folder = Folder::new("bad_file");
    let bad = PAPER.replace("volume_m3 = 60.0", "volume_m3 = -60.0");
    std::fs::write(folder.path("bad.toml"), &bad).unwrap();
    let line = bad.lines().position(|line| line.contains("-60.0")).unwrap() + 1;
    for command in ["run", "check", "stability"] {
        let (code, out, err) = folder.say(&[command, "bad.toml"]);
        assert_eq!(code, 2);
        assert!(err.starts_with(&format!("error: bad.toml:{line}:")), "{err}");
        assert!(err.contains("volume_m3 = -60.0") && err.contains("^^^"), "{err}");
        assert!(out.is_empty());
    }
}

#[test]
fn check_names_everything_and_saves_what_it_read() {
    let folder = Folder::new("check");
    std::fs::write(folder.path("paper.toml"), PAPER).unwrap();
    let (code, out, _) = folder.say(&["check", "paper.toml", "--save", "again.toml"]);
    assert_eq!(code, 0, "{out}");
    for part in
        ["cabin: cabin, 60 m³", "its flow stands at valve", "valve.opening: 1, scheduled", "0 warnings"]
    {
        assert!(out.contains(part), "{part} not in {out}");
    }
    let id = |out: &str| out.lines().find(|line| line.starts_with("network id")).map(str::to_owned);
    let (code, again, _) = folder.say(&["check", "again.toml"]);
    assert_eq!((code, id(&again)), (0, id(&out)), "the saved file is the same network");
}

#[test]
fn check_warns_where_plain_euler_is_unstable() {
    let folder = Folder::new("check_euler");
    std::fs::write(folder.path("paper.toml"), PAPER).unwrap();
    let (code, out, _) = folder.say(&["check", "paper.toml", "--method", "euler"]);
    assert!(code == 0 && out.contains("warning: line `loop` is unstable with `euler`"), "{out}");
}

#[test]
fn stability_finds_the_papers_edge() {
    let folder = Folder::new("stability");
    let (code, out, _) = folder.say(&["stability"]);
    assert_eq!(code, 0);
    let line = out.lines().find(|line| line.contains("without φ at:")).unwrap();
    let edge: f64 = line.rsplit(' ').next().unwrap().parse().unwrap();
    assert!((edge - 0.198).abs() < 0.003, "{edge}");
    assert!(out.contains("with φ at:    nowhere") && out.contains("stable over the whole range"), "{out}");
}

#[test]
fn a_reader_that_leaves_early_is_no_error() {
    let folder = Folder::new("pipe");
    let mut child = folder
        .program(&["run", "--until", "1s"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let mut err = String::new();
    child.stderr.take().unwrap().read_to_string(&mut err).unwrap();
    assert!(child.wait().unwrap().success());
    assert!(err.is_empty(), "{err}");
}

#[test]
fn a_folder_that_cannot_be_made_is_a_failure() {
    let folder = Folder::new("no_folder");
    std::fs::write(folder.path("file"), "").unwrap();
    let (code, _, err) = folder.say(&["run", "--until", "1s", "--out", "file/inside"]);
    assert!(code == 1 && err.contains("cannot make the folder"), "{err}");
}

#[test]
#[cfg(unix)]
fn a_file_without_an_end_is_not_read_to_its_end() {
    let folder = Folder::new("endless");
    let (code, _, err) = folder.say(&["check", "/dev/zero"]);
    assert!(code == 2 && err.contains("are allowed"), "{err}");
}

#[test]
fn a_file_that_cannot_be_written_does_not_hide_the_result() {
    let folder = Folder::new("no_file");
    std::fs::create_dir_all(folder.path("out/run_relaxation.csv")).unwrap();
    let (code, out, err) = folder.say(&["run", "--until", "1s", "--json", "--out", "out"]);
    assert!(code == 1 && err.contains("cannot write") && out.contains("state_hash"), "{err}{out}");
    let (code, out, _) = folder.say(&["run", "--until", "1s", "--out", "out"]);
    assert!(code == 1 && out.contains("weakest proof"), "{out}");
}

#[test]
fn a_range_that_is_outside_everywhere_is_called_so() {
    let folder = Folder::new("outside");
    let (code, out, err) = folder.say(&["stability", "--to", "0.1"]);
    assert!(code == 0 && out.contains("without φ at: outside everywhere"), "{out}{err}");
    assert!(out.contains("with φ at:    nowhere"), "{out}");
}

#[test]
fn check_names_what_it_did_not_examine_and_warns_of_lines_without_inputs() {
    let folder = Folder::new("check_two");
    // Pseudo-time takes no vacuum.
    let two = include_str!("two_cabins.toml").replace("pressure_pa = 0.0", "pressure_pa = 101320.0");
    std::fs::write(folder.path("two.toml"), two).unwrap();
    let (code, out, _) = folder.say(&["check", "two.toml", "--method", "relaxation"]);
    assert!(code == 0 && out.matches("not examined").count() == 2, "{out}");
    assert!(out.contains("0 warnings"), "{out}");
    let (code, out, _) = folder.say(&["check", "two.toml", "--method", "euler"]);
    assert!(code == 0 && out.contains("warning: line `leak` is unstable at rest with `euler`"), "{out}");
}

#[test]
fn a_guard_is_not_counted_as_a_proof() {
    let folder = Folder::new("guard");
    let (_, out, _) = folder.say(&["run", "--until", "1s", "--out", "out"]);
    assert!(out.contains("`short step` is a guard") && !out.contains("without a proof   0 steps"), "{out}");
}
