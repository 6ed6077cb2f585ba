//! Reference of components, `docs/components.md`: written from the list of kinds, so that it says what is checked.

use std::fmt::{self, Write as _};

use eclss_core::InputSpec;
use eclss_core::component::FileKind;
use eclss_core::parameter::{Carries, Key, KeyType, Place, Presence};
use eclss_core::signal::OutputSpec;

use crate::kinds;
use crate::limits::{self, Range, short};

const HEAD: &str = "\
# Components

This file is generated from the list of kinds in `core/src/components.rs`; a test compares both.
`eclss-rt kinds --markdown` prints it. [network-file.md](network-file.md) has the laws, the keys that all elements of a line
share (`id`, `kind`, `length_m`, `diameter_m` …) and the table of malfunctions.

- **Key**: *needed*, or its default. Without either it may be left out, and its meaning says what happens then.
- **Input**: changes during a run, by schedule, control, channel or operator. It is also a key of the table: the value at the
  start, where no schedule sets it. The unit `1` is a ratio.
- **Output**: a signal `<id>.<output>`, beside those of every element (`eclss-rt signals FILE` lists all).

";

/// Returns the reference of all kinds: `docs/components.md`, and behind it the kinds that this program registered.
pub fn components() -> String {
    markdown(kinds::all())
}

/// Returns the reference of these kinds in Markdown.
pub fn markdown(kinds: &[&dyn FileKind]) -> String {
    let mut text = String::from(HEAD);
    // Writing to a string does not fail.
    let _ = write(&mut text, kinds);
    text
}

fn write(text: &mut String, kinds: &[&dyn FileKind]) -> fmt::Result {
    writeln!(text, "| kind | |\n|---|---|")?;
    for kind in kinds {
        writeln!(text, "| [`{0}`](#{0}) | {1} |", kind.name(), kind.about())?;
    }
    kinds.iter().try_for_each(|kind| section(text, *kind))
}

fn section(text: &mut String, kind: &dyn FileKind) -> fmt::Result {
    writeln!(text, "\n## `{}`\n\n{}\n{}", kind.name(), kind.about(), place(kind))?;
    if let Some(file) = source(kind) {
        writeln!(text, "Law, source and validity: [{file}](../{file}).")?;
    }
    let keys: Vec<_> = kind.keys().iter().copied().flatten().collect();
    if !keys.is_empty() {
        writeln!(text, "\n| key | default | meaning | range |\n|---|---|---|---|")?;
        keys.iter().try_for_each(|key| key_row(text, key))?;
    }
    if !kind.inputs().is_empty() {
        writeln!(text, "\n| input | unit | range | default |\n|---|---|---|---|")?;
        kind.inputs().iter().try_for_each(|input| input_row(text, input))?;
    }
    if !kind.outputs().is_empty() {
        writeln!(text, "\n| output | unit | meaning |\n|---|---|---|")?;
        kind.outputs().iter().try_for_each(|output| output_row(text, output))?;
    }
    Ok(())
}

/// File of a kind that comes with the core.
fn source(kind: &dyn FileKind) -> Option<String> {
    let module = kind.path().strip_prefix("eclss_core::components::")?.split("::").next()?;
    Some(format!("core/src/components/{module}.rs"))
}

/// Returns where a kind stands, in one or two sentences.
fn place(kind: &dyn FileKind) -> String {
    let contents = |carries| match carries {
        Carries::Any => "air or coolant",
        Carries::Air => "air",
        Carries::Coolant => "coolant",
    };
    let mut text = match kind.place() {
        Place::Line => match kind.sides().first() {
            Some(side) => format!("A `[[line.element]]` of a line of {}.", contents(*side)),
            None => "A `[[line.element]]`.".to_owned(),
        },
        Place::Node { holds, boundary } => {
            let boundary = if boundary { ", a boundary too" } else { ", not a boundary" };
            format!(
                "A table `[[{}]]` with `id` and `node`, a node of {}{boundary}.",
                kind.name(),
                contents(holds)
            )
        }
    };
    if let Some(side) = kind.sides().get(1) {
        let _ = write!(
            text,
            " The line of a component that names it passes its second side and carries {}",
            contents(*side)
        );
        let idle: Vec<_> = kind.idle_when_linked().iter().map(|input| format!("`{input}`")).collect();
        if !idle.is_empty() {
            let _ = write!(text, "; {} do nothing then", idle.join(" and "));
        }
        text.push('.');
    }
    text
}

fn key_row(text: &mut String, key: &Key) -> fmt::Result {
    let range = match key.holds {
        KeyType::Number { unit, min, max } => Range { values: min..=max, unit }.to_string(),
        KeyType::Flag => "true, false".to_owned(),
        KeyType::Choice(words) => words.iter().map(|word| format!("`{word}`")).collect::<Vec<_>>().join(", "),
        KeyType::Component => "id of a component".to_owned(),
    };
    let default = match key.presence {
        Presence::Required => "needed".to_owned(),
        Presence::Default(value) => short(value),
        Presence::Optional if key.holds == KeyType::Flag => "false".to_owned(),
        Presence::Optional => String::new(),
    };
    let Key { name, about, .. } = key;
    writeln!(text, "| `{name}` | {default} | {} | {range} |", cell(about))
}

fn input_row(text: &mut String, input: &InputSpec) -> fmt::Result {
    let Range { values, unit } = limits::of(input);
    let (min, max) = (short(*values.start()), short(*values.end()));
    writeln!(text, "| `{}` | {unit} | {min} … {max} | {} |", input.name, short(f64::from(input.default)))
}

fn output_row(text: &mut String, output: &OutputSpec) -> fmt::Result {
    writeln!(text, "| `{}` | {} | {} |", output.name, output.display.unit(), cell(output.label))
}

/// Text in a cell: a bar would end it.
fn cell(text: &str) -> String {
    text.replace('|', "\\|")
}
