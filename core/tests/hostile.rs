//! A hundred thousand hostile byte strings against decoder and link, and a hundred thousand frames over a bad wire.
//! The whole campaigns: `cargo run --release -p eclss-core --features protocol --example hostile -- 10000000` and
//! `… --example hostile -- wire 1000000`.

mod bytes;
mod wire;

#[test]
fn hostile_bytes_are_counted_once_and_never_believed() {
    let tally = bytes::run(100_000, 1);
    println!("{tally:?}");
    assert!(tally.frames > tally.cases / 2 && tally.good > 1_000 && tally.forged_good > 200);
}

#[test]
fn a_bad_wire_loses_nothing_that_is_not_counted() {
    let report = wire::run(100_000, 2);
    println!("{report:?}");
    assert!(report.spoiled > 1_000 && report.lost > 1_000 && report.late > 100 && report.duplicate > 1_000);
}
