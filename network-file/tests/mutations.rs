//! Spoiled network files never make anything panic: each is refused with place and reason, or runs.

use eclss_core::{BuildError, Health, Method, Settings, Simulator};
use eclss_network_file::{FileError, Loaded, parse, parse_bytes};

/// The files that are spoiled.
const FILES: [&str; 4] = [
    include_str!("../../networks/paper.toml"),
    include_str!("files/zoo.toml"),
    include_str!("files/junction.toml"),
    include_str!("files/malfunctions.toml"),
];

/// Values that a hand or a script might leave in a file.
const VALUES: [&str; 22] = [
    "nan",
    "inf",
    "-inf",
    "-1",
    "-1.0",
    "1e308",
    "-1e308",
    "1e39",
    "1e-60",
    "0",
    "0.0",
    "-0.0",
    "1",
    "1e6",
    "1e-3",
    "0.5",
    "\"\"",
    "\"x\"",
    "true",
    "[]",
    "{}",
    "1979-05-27",
];

/// Random numbers that are the same in every run (xorshift64*).
struct Dice(u64);

impl Dice {
    /// Starts a sequence of its own for every seed.
    fn new(seed: u64) -> Self {
        let mut dice = Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1);
        for _ in 0..8 {
            dice.roll();
        }
        dice
    }

    fn roll(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 16
    }

    /// A number below `end`.
    fn below(&mut self, end: usize) -> usize {
        (self.roll() % end.max(1) as u64) as usize
    }

    /// One of a list.
    fn pick<'a, T>(&mut self, list: &'a [T]) -> &'a T {
        &list[self.below(list.len())]
    }
}

fn lines(text: &str) -> Vec<String> {
    text.lines().map(str::to_owned).collect()
}

/// Replaces the value of a random `key = value`.
fn replace_value(text: &str, dice: &mut Dice) -> String {
    let mut lines = lines(text);
    let places: Vec<usize> = (0..lines.len()).filter(|&line| lines[line].contains(" = ")).collect();
    let line = &mut lines[*dice.pick(&places)];
    let key = line.split(" = ").next().unwrap_or_default().to_owned();
    *line = format!("{key} = {}", dice.pick(&VALUES));
    lines.join("\n")
}

/// Multiplies a random number by a power of ten, so that files stay close to right.
fn scale_number(text: &str, dice: &mut Dice) -> String {
    let mut lines = lines(text);
    let number = |line: &str| line.split(" = ").nth(1)?.split(" #").next()?.trim().parse::<f64>().ok();
    let places: Vec<usize> = (0..lines.len()).filter(|&line| number(&lines[line]).is_some()).collect();
    let line = &mut lines[*dice.pick(&places)];
    let scaled = number(line).unwrap_or(1.0) * dice.pick(&[1e-6, 1e-3, 0.1, 10.0, 1e3, 1e6]);
    *line = format!("{} = {scaled:?}", line.split(" = ").next().unwrap_or_default());
    lines.join("\n")
}

/// Deletes, doubles or swaps lines.
fn move_lines(text: &str, dice: &mut Dice) -> String {
    let mut lines = lines(text);
    let (one, other) = (dice.below(lines.len()), dice.below(lines.len()));
    match dice.below(3) {
        0 => drop(lines.remove(one)),
        1 => lines.insert(other, lines[one].clone()),
        _ => lines.swap(one, other),
    }
    lines.join("\n")
}

/// Deletes, doubles or shuffles whole tables.
fn move_tables(text: &str, dice: &mut Dice) -> String {
    let mut tables: Vec<&str> = text.split("\n\n").collect();
    let (one, other) = (dice.below(tables.len()), dice.below(tables.len()));
    match dice.below(3) {
        0 => drop(tables.remove(one)),
        1 => tables.insert(other, tables[one]),
        _ => tables.swap(one, other),
    }
    tables.join("\n\n")
}

/// Flips, inserts or deletes bytes.
fn spoil_bytes(text: &str, dice: &mut Dice) -> Vec<u8> {
    let mut bytes = text.as_bytes().to_vec();
    let place = dice.below(bytes.len());
    match dice.below(4) {
        0 => bytes[place] ^= 1 << dice.below(8),
        1 => bytes.insert(place, *dice.pick(b"[]{}=\"'#.,\n\t -+e0197_\\\xc2\xff")),
        2 => drop(bytes.remove(place)),
        _ => bytes.truncate(place),
    }
    bytes
}

fn mutated(seed: u64) -> Vec<u8> {
    let mut dice = Dice::new(seed);
    let mut text = (*dice.pick(&FILES)).to_owned();
    for _ in 0..dice.below(3) {
        text = match dice.below(4) {
            0 => replace_value(&text, &mut dice),
            1 => scale_number(&text, &mut dice),
            2 => move_lines(&text, &mut dice),
            _ => move_tables(&text, &mut dice),
        };
    }
    match dice.below(5) {
        0 => spoil_bytes(&text, &mut dice),
        1 => replace_value(&text, &mut dice).into_bytes(),
        2 => move_lines(&text, &mut dice).into_bytes(),
        3 => move_tables(&text, &mut dice).into_bytes(),
        _ => scale_number(&text, &mut dice).into_bytes(),
    }
}

/// How a run of a spoiled file went.
#[derive(Debug, PartialEq, Eq)]
enum Ran {
    /// The method refused the network.
    Refused,
    /// To the end.
    Through,
    /// Until the simulator named the place that left its range, such as a cabin that a fan empties.
    Stopped,
}

/// Runs up to 200 steps of `method`; whatever happens, every value stays finite.
fn run(seed: u64, loaded: &Loaded, method: Method) -> Ran {
    let network = loaded.network();
    let settings = Settings { method, step_us: loaded.run.step_us };
    let sizes = settings.method.sizes(&network);
    let (mut state, mut work) = (vec![0.0; sizes.state], vec![0.0; sizes.work]);
    let (mut inputs, mut cursors) = (vec![0.0; sizes.inputs], vec![0; sizes.cursors]);
    let buffers = eclss_core::Buffers {
        state: &mut state,
        work: &mut work,
        inputs: &mut inputs,
        cursors: &mut cursors,
    };
    let mut simulator = match Simulator::new(&network, settings, buffers) {
        Ok(simulator) => simulator,
        Err(BuildError::Method(_)) => return Ran::Refused,
        Err(error) => panic!("seed {seed}: accepted and then refused for {error}"),
    };
    let trusted = (0..200).all(|_| simulator.step() == Health::Trusted);
    for line in 0..network.lines.len() {
        assert!(simulator.line_flow_kg_s(line).is_finite(), "seed {seed}");
    }
    for node in 0..network.nodes.len() {
        assert!(simulator.node_gauge_pa(node).is_finite(), "seed {seed}");
    }
    if trusted { Ran::Through } else { Ran::Stopped }
}

fn has_place_and_reason(seed: u64, error: &FileError) {
    assert!(!error.problems().is_empty(), "seed {seed}");
    for problem in error.problems() {
        assert!(problem.line > 0 && problem.column > 0, "seed {seed}: {problem}");
        assert!(problem.reason.len() > 5, "seed {seed}: {problem}");
        assert!(!problem.reason.contains("internal"), "seed {seed}: {problem}");
    }
}

/// Saved and read again it is the same document and the same network.
fn saves_back(seed: u64, loaded: &Loaded) {
    let again = parse(&loaded.file.to_toml(), "saved").unwrap_or_else(|error| panic!("seed {seed}: {error}"));
    assert_eq!(loaded.file, again.file, "seed {seed}");
    assert_eq!(loaded.network().id(), again.network().id(), "seed {seed}");
}

#[test]
fn three_thousand_spoiled_files_are_refused_with_a_reason_or_run() {
    let mut ran = [0; Method::ALL.len()];
    let (mut refused, mut stopped) = (0, 0);
    for seed in 0..3_000 {
        match parse_bytes(&mutated(seed), "mutated.toml") {
            Ok(loaded) => {
                saves_back(seed, &loaded);
                for (count, method) in ran.iter_mut().zip(Method::ALL) {
                    // Plain Euler is there to diverge.
                    if method != Method::Euler {
                        let ran = run(seed, &loaded, method);
                        *count += usize::from(ran == Ran::Through);
                        stopped += usize::from(ran == Ran::Stopped);
                    }
                }
            }
            Err(error) => {
                has_place_and_reason(seed, &error);
                refused += 1;
            }
        }
    }
    println!("refused {refused}; ran {ran:?} with {:?}; stopped {stopped}", Method::ALL);
    // Both answers must be met often, or the test shows nothing.
    assert!(refused > 500, "{refused}");
    for (count, method) in ran.iter().zip(Method::ALL) {
        assert!(*count > 100 || method == Method::Euler, "{method:?} ran {count}");
    }
    // What is accepted makes sense as a rule.
    assert!(100 * stopped < ran.iter().sum::<usize>(), "{stopped} of {ran:?}");
}
