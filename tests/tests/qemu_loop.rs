//! The loop on emulated boards: on time, the same every time, and safe when it is not.

use crate::emulator::{MACHINES, Run, run};

fn on_all_boards(words: &[&str], check: impl Fn(&Run)) {
    for machine in MACHINES {
        check(&run(machine, words));
    }
}

#[test]
fn ten_seconds_without_an_overrun() {
    on_all_boards(&["seconds=10"], |run| {
        run.line("overruns 0, 0 in start-up, 0 in a row, skipped 0");
        run.line("ended after 10000 ticks");
        run.line("tick 10000: 999998 mHz of 1000000");
        assert_eq!(run.count("of plant time"), 1);
        assert!(run.status.success());
    });
}

#[test]
fn two_runs_give_identical_logs() {
    for machine in MACHINES {
        let [first, second] = [0, 1].map(|_| run(machine, &["seconds=10"]));
        assert!(first.log.len() > 20, "{}", first.log.join("\n"));
        assert_eq!(first.log, second.log);
    }
}

/// Three slow ticks of 2.5 periods: each skips two releases, and afterwards all is as before.
#[test]
fn a_short_overload_is_counted_and_skipped_over() {
    on_all_boards(&["seconds=1", "overload=200:3:2500"], |run| {
        assert_eq!(run.count("overran, 2 skipped"), 3);
        run.line("overruns 3, 0 in start-up, 3 in a row, skipped 6");
        assert_eq!(run.count("ERROR"), 0);
        assert!(run.status.success());
    });
}

#[test]
fn an_overload_during_start_up_is_told_apart() {
    on_all_boards(&["seconds=1", "overload=0:2:1500"], |run| {
        run.line("overruns 2, 2 in start-up, 2 in a row, skipped 2");
    });
}

#[test]
fn a_long_overload_goes_safe_and_says_so() {
    on_all_boards(&["seconds=1", "overload=200:9:1500"], |run| {
        run.line("safe from tick 204: 5 overruns in a row");
        run.line("us, SAFE");
        assert!(!run.status.success());
    });
}

/// Each way to die leads through a reset, after which the firmware knows why.
#[test]
fn faults_are_reported_after_the_reset() {
    for (trap, report) in [
        ("panic", "reset: panic at line "),
        ("address", "reset: hard fault at "),
        ("stack", "reset: stack overflow at "),
    ] {
        on_all_boards(&[&format!("trap={trap}")], |run| {
            assert_eq!(run.count("reset: power-on"), 1, "{}", run.log.join("\n"));
            run.line(report);
            assert!(!run.status.success());
        });
    }
}

/// A word that makes no sense must not pass for a quiet run.
#[test]
fn a_misspelt_request_is_refused() {
    on_all_boards(&["secnods=1"], |run| {
        run.line("cannot make sense of `secnods=1`");
        assert!(!run.status.success());
    });
}
