//! The tutorial: its file is written, its commands are run, its figures are compared.

use crate::common::Folder;

const TUTORIAL: &str = include_str!("../../docs/first-cabin.md");
/// Command line before its arguments.
const CALLS: [&str; 2] = ["cargo run --release -- ", "eclss-rt "];

/// Fenced blocks with their languages.
fn blocks(text: &str) -> Vec<(&str, &str)> {
    let fenced = text.split("\n```").skip(1).step_by(2);
    fenced.map(|block| block.split_once('\n').expect("a fence stands in a line of its own")).collect()
}

/// Writes or continues the file that a block's first line names.
fn write(folder: &Folder, block: &str) {
    let (first, rest) = block.split_once('\n').expect("a block has a line that names its file");
    let name = first.strip_prefix("# ").expect("a comment names the file");
    let (name, mut text) = match name.strip_prefix("at the end of ") {
        Some(name) => {
            (name, std::fs::read_to_string(folder.path(name)).expect("it was written before") + "\n")
        }
        None => (name, String::new()),
    };
    text.push_str(rest);
    text.push('\n');
    std::fs::write(folder.path(name), text).expect("the folder takes a file");
}

/// Whether two words are equal, numbers to one per cent.
fn agree(shown: &str, printed: &str) -> bool {
    match (shown.parse::<f64>(), printed.parse::<f64>()) {
        (Ok(shown), Ok(printed)) => (shown - printed).abs() <= 0.01 * shown.abs(),
        _ => shown == printed,
    }
}

fn has_line(output: &str, shown: &str) -> bool {
    let words: Vec<_> = shown.split_whitespace().collect();
    output.lines().any(|line| {
        let printed: Vec<_> = line.split_whitespace().collect();
        printed.len() == words.len()
            && words.iter().zip(printed).all(|(shown, printed)| agree(shown, printed))
    })
}

#[test]
fn every_command_of_the_tutorial_does_as_shown() {
    let folder = Folder::new("first_cabin");
    let (mut commands, mut lines, mut output) = (0, 0, String::new());
    for (language, block) in blocks(TUTORIAL) {
        match language {
            "toml" => write(&folder, block),
            "sh" => {
                output.clear();
                for command in block.lines() {
                    let arguments = CALLS.iter().find_map(|call| command.strip_prefix(call));
                    let arguments = arguments.unwrap_or_else(|| panic!("`{command}` is none of eclss-rt"));
                    let arguments: Vec<_> = arguments.split_whitespace().collect();
                    let (code, out, err) = folder.say(&arguments);
                    assert_eq!(code, 0, "{command}: {err}");
                    output.push_str(&out);
                    commands += 1;
                }
            }
            "text" => {
                for shown in block.lines() {
                    assert!(has_line(&output, shown), "`{shown}` is not in\n{output}");
                    lines += 1;
                }
            }
            other => panic!("a block of `{other}`, which no test reads"),
        }
    }
    assert!(commands >= 5 && lines >= 5, "{commands} commands, {lines} lines");
    assert!(folder.path("cabin.svg").exists() && folder.path("results/cabin/run_tr-bdf2.csv").exists());
}

#[test]
fn figures_are_compared() {
    let output = "  cabin.temperature                 37.5236 °C\n";
    assert!(has_line(output, "cabin.temperature 37.5 °C"));
    for wrong in ["cabin.temperature 38.5 °C", "cabin.temperature 37.5 K", "cabin.temperature 37.5"] {
        assert!(!has_line(output, wrong), "{wrong}");
    }
}
