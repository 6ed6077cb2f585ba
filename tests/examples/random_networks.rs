//! Random networks with every method: finite, inside the bound, settling to the independent steady state.
//!
//! `cargo run --release -p eclss-tests --example random_networks -- 10000 [FIRST_SEED] [check-valves] [METHOD …]`
//!
//! With names of methods only these are run.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

use eclss_core::Method;
use eclss_tests::networks::examine::{Outcome, PHASES, examine};
use eclss_tests::networks::run::METHODS;

/// Notes that are shown for each method.
const SHOWN: usize = 20;

fn main() {
    let argument = |index| std::env::args().nth(index).and_then(|text: String| text.parse().ok());
    let (networks, first) = (argument(1).unwrap_or(1_000), argument(2).unwrap_or(0));
    let named = |name: &str| std::env::args().any(|word| word == name);
    let check_valves = named("check-valves");
    let any = METHODS.iter().any(|method| named(method.name()));
    let methods: Vec<Method> = METHODS.into_iter().filter(|method| !any || named(method.name())).collect();
    let next = AtomicU64::new(first);
    let sums = Mutex::new(vec![Outcome::default(); methods.len()]);
    let threads = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                loop {
                    let seed = next.fetch_add(1, Ordering::Relaxed);
                    if seed >= first + networks {
                        break;
                    }
                    let outcomes: Vec<_> =
                        methods.iter().map(|&method| examine(seed, method, check_valves)).collect();
                    let mut sums = sums.lock().unwrap_or_else(PoisonError::into_inner);
                    for (sum, outcome) in sums.iter_mut().zip(outcomes) {
                        sum.add(outcome);
                    }
                }
            });
        }
    });
    let sums = sums.into_inner().unwrap_or_else(PoisonError::into_inner);
    for (sum, method) in sums.iter().zip(&methods) {
        report(sum, *method);
    }
    if sums.iter().any(|sum| !sum.notes.is_empty()) {
        std::process::exit(1);
    }
}

fn report(sum: &Outcome, method: Method) {
    println!(
        "{}: {} runs with {} jumps each, {} steps in all",
        method.name(),
        sum.runs,
        PHASES.0 - 1,
        sum.steps
    );
    println!("    {} not finite, refused or without a steady state", sum.troubles);
    println!("    {} settled, {} of them wrong, largest error {:.1e}", sum.settled, sum.wrong, sum.error);
    if method == Method::Adaptive {
        let phi = sum.smallest_phi.unwrap_or(1.0);
        println!("    slowed a node in {} runs, smallest phi {phi:.1e}", sum.slowed);
        println!(
            "    bound watched in {} runs, left in {}, largest growth of max|p - p*| in a step {:.1e} of the largest pressure",
            sum.watched, sum.outside, sum.growth
        );
    }
    for note in sum.notes.iter().take(SHOWN) {
        println!("    {note}");
    }
}
