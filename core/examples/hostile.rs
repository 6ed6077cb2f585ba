//! The campaigns of `core/tests/hostile.rs` at any length:
//!
//! ```text
//! cargo run --release -p eclss-core --features protocol --example hostile -- 10000000 [SEED]
//! cargo run --release -p eclss-core --features protocol --example hostile -- wire 1000000 [SEED]
//! ```

#[path = "../tests/hostile/bytes.rs"]
mod bytes;
#[path = "../tests/hostile/wire.rs"]
mod wire;

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let over_wire = words.first().is_some_and(|word| word == "wire");
    let mut numbers = words.iter().filter_map(|word| word.parse().ok());
    let (count, seed) = (numbers.next().unwrap_or(1_000_000), numbers.next().unwrap_or(1));
    if over_wire {
        println!("{:?}", wire::run(u32::try_from(count).unwrap_or(u32::MAX), seed));
    } else {
        println!("{:?}", bytes::run(count, seed));
    }
}
