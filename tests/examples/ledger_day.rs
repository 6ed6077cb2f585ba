//! The mass ledger over a day, with every method that keeps running: the paper's loop with a dynamic cabin of 60 m³,
//! the valve closing to 2 % and staying there; and open, with a supply that makes up for what is drained.
//!
//! `cargo run --release -p eclss-tests --example ledger_day -- [HOURS] [STEP_US] [METHOD …]`, 24 hours, 1000 µs and all
//! methods when absent.
//! A day of a method takes one to a few minutes of one processor; every line is printed as soon as it is known.

use std::process::ExitCode;
use std::time::Instant;

use eclss_core::Method;
use eclss_tests::ledger::{close, closing, supplied};

/// Largest part of the total mass that may be missing after a day [1].
const MOST: f64 = 1e-6;

fn main() -> ExitCode {
    let argument = |index| std::env::args().nth(index).and_then(|text: String| text.parse().ok());
    let (hours, step_us) = (argument(1).unwrap_or(24.0), argument(2).unwrap_or(1_000.0));
    let until_us = (3.6e9 * hours) as u64;
    let named = |method: &Method| std::env::args().any(|word| word == method.name());
    let any = Method::ALL.iter().any(named);
    let methods =
        Method::ALL.into_iter().filter(|method| *method != Method::Euler && (!any || named(method)));
    let cases = [("closing", closing()), ("supplied", supplied())];
    println!(
        "{hours} h at {step_us} µs: what is missing, as part of the total mass; ≤ {MOST:.0e} is promised"
    );
    let mut good = true;
    for method in methods {
        for (name, loaded) in &cases {
            let begun = Instant::now();
            match close(loaded, method, step_us as u32, until_us) {
                Ok(closure) => {
                    good &= closure.relative() <= MOST;
                    println!(
                        "{:15} {name:9} {:8.1e}   of {:.3} kg, drained {:9.4} kg, entered {:9.4} kg, \
                         fictitious {:8.1e} kg; {:.0} s",
                        method.name(),
                        closure.relative(),
                        closure.total_kg,
                        closure.drained_kg,
                        closure.entered_kg,
                        closure.fictitious_kg,
                        begun.elapsed().as_secs_f64()
                    );
                }
                Err(error) => {
                    good = false;
                    println!("{:15} {name:9} refused: {error:?}", method.name());
                }
            }
        }
    }
    if good { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
