//! Random networks of any topology: every method stays finite, `adaptive` keeps its bound at every step, and
//! what has the time to settle agrees with the independent steady state. A short selection; all of them with
//! `cargo run --release -p eclss-tests --example random_networks -- 10000`.

use eclss_core::Method;
use eclss_network_file::steady::steady_flows;
use eclss_tests::dice::Dice;
use eclss_tests::networks::draw::{Drawn, Kinds};
use eclss_tests::networks::examine::{ERROR, Outcome, ROUNDING, examine};
use eclss_tests::networks::rule::{Explicit, Rule};

const NETWORKS: u64 = 60;

/// Runs the networks with one method and returns the sum of what came of them, if none missed anything.
fn holds(method: Method, check_valves: bool) -> Outcome {
    let mut sum = Outcome::default();
    (0..NETWORKS).for_each(|seed| sum.add(examine(seed, method, check_valves)));
    let notes = &sum.notes;
    assert!(notes.is_empty(), "{}: {} missed\n{}", method.name(), notes.len(), notes.join("\n"));
    assert!(sum.settled >= 5, "only {} networks had the time to settle within {ERROR}", sum.settled);
    sum
}

#[test]
fn adaptive_keeps_its_bound_and_settles() {
    assert!(holds(Method::Adaptive, false).watched >= 40);
}

#[test]
fn adaptive_keeps_its_bound_and_settles_with_check_valves() {
    assert!(holds(Method::Adaptive, true).watched >= 40);
}

#[test]
fn implicit_euler_stays_finite_and_settles() {
    holds(Method::ImplicitEuler, false);
}

#[test]
fn implicit_euler_stays_finite_and_settles_with_check_valves() {
    holds(Method::ImplicitEuler, true);
}

#[test]
fn tr_bdf2_stays_finite_and_settles() {
    holds(Method::TrBdf2, false);
}

#[test]
fn tr_bdf2_stays_finite_and_settles_with_check_valves() {
    holds(Method::TrBdf2, true);
}

/// Networks of the whole campaign that taught something: two parallel laminar lines, one of which is drained; a swing that a
/// closed valve damps near rest only; drains whose flow turns between the solves of a stage; drains behind a volume whose
/// pressure is rounded coarsely.
#[test]
fn what_was_missed_once_settles() {
    for (seed, method) in [
        (625, Method::TrBdf2),
        (1974, Method::TrBdf2),
        (4434, Method::TrBdf2),
        (6056, Method::TrBdf2),
        (900, Method::ImplicitEuler),
        (2469, Method::TrBdf2),
    ] {
        let outcome = examine(seed, method, false);
        assert!(outcome.notes.is_empty(), "{:?}", outcome.notes);
        assert_eq!(outcome.settled, 1, "seed {seed} has the time to settle");
    }
}

/// A near vacuum beside small volumes in lines without inertance: the first step takes pressures for rest that are not.
#[test]
fn a_start_beside_a_near_vacuum_stays_in_range() {
    let outcome = examine(5211, Method::ImplicitEuler, true);
    assert!(outcome.notes.is_empty(), "{:?}", outcome.notes);
    assert_eq!((outcome.runs, outcome.settled), (1, 1));
}

/// Networks in which max|p − p*| grows at some step, and in which it ends larger than it began.
fn growing(rule: Rule, theta: f64) -> (u32, u32, u32) {
    let (mut seen, mut grew, mut ended_larger) = (0, 0, 0);
    for seed in 0..200 {
        let drawn = Drawn::new(&mut Dice::new(seed), Kinds::default());
        let network = drawn.network(&drawn.inputs);
        let target = steady_flows(&network, &drawn.inputs).expect("a steady state").gauge_pa;
        let mut explicit = Explicit::new(&drawn, &drawn.inputs);
        let first = explicit.distance_pa(&target);
        let (mut last, mut worst) = (first, 0.0f64);
        for _ in 0..300 {
            explicit.step(rule, theta);
            let now = explicit.distance_pa(&target);
            worst = worst.max(now - last);
            last = now;
        }
        seen += 1;
        grew += u32::from(worst > 1e-6);
        ended_larger += u32::from(last > first);
    }
    (seen, grew, ended_larger)
}

#[test]
fn the_tangent_is_no_proof_and_the_secant_is() {
    let (seen, grew, larger) = growing(Rule::Secant, 0.8);
    assert_eq!((grew, larger), (0, 0), "secant, of {seen}");
    let (_, grew, larger) = growing(Rule::Tangent, 1.0);
    println!("tangent, theta 1: grows in {grew} of {seen}, ends larger in {larger}");
    assert!(grew > seen / 4, "the tangent rule grew in {grew} of {seen} only");
    // Twice the secant's own limit of 0.828 is where the tangent stands: with its θ halved it is the secant.
    assert!(growing(Rule::Secant, 1.0).1 > 0, "beyond 0.828 nothing is promised");
}

#[test]
fn rounding_is_what_the_bound_allows() {
    // Four units in the last place of the largest pressure: one each for the two pressures of a line, the
    // node's own and the comparison.
    assert!((ROUNDING - 4.0 * f64::from(f32::EPSILON)).abs() < 1e-12);
}
