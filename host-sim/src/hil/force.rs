//! The operator's forces: `force NAME value X`, `offset X`, `noise A [SEED]`, `stuck`, `open`, and `release NAME`.

use eclss_core::process::{Direction, Force};
use eclss_network_file::ProcessTables;
use eclss_target::board::Forcing;

const FORMS: &str = "force NAME value X, offset X, noise AMPLITUDE [SEED], stuck or open; release NAME";

/// The channels that can be forced.
#[derive(Debug)]
pub(super) struct Channels(Vec<Channel>);

#[derive(Debug)]
struct Channel {
    name: String,
    direction: Direction,
    number: u16,
    range: [f32; 2],
}

impl Channels {
    pub(super) fn new(process: &ProcessTables) -> Self {
        let inputs = (0..).zip(&process.inputs).map(|(number, entry)| {
            let range = [entry.channel().min, entry.channel().max];
            Channel { name: entry.name.clone(), direction: Direction::In, number, range }
        });
        let outputs = (0..).zip(&process.outputs).map(|(number, entry)| {
            let range = [entry.channel().min, entry.channel().max];
            Channel { name: entry.name.clone(), direction: Direction::Out, number, range }
        });
        Self(inputs.chain(outputs).collect())
    }

    /// Reads an order; `None` where it is about something else, why not where it cannot be done.
    pub(super) fn read(&self, line: &str) -> Option<Result<Forcing, String>> {
        let words: Vec<&str> = line.split_whitespace().collect();
        let (name, force) = match words.as_slice() {
            ["release", name] => (*name, Some(Force::None)),
            ["force", name, rest @ ..] => (*name, form(rest)),
            ["force" | "release", ..] => return Some(Err(FORMS.into())),
            _ => return None,
        };
        let Some(force) = force else { return Some(Err(FORMS.into())) };
        let Some(channel) = self.0.iter().find(|channel| channel.name == name) else {
            let names: Vec<&str> = self.0.iter().map(|channel| channel.name.as_str()).collect();
            return Some(Err(format!("no channel is called `{name}`; there are {}", names.join(", "))));
        };
        let [min, max] = channel.range;
        if let Force::Value(value) = force
            && !(min..=max).contains(&value)
        {
            return Some(Err(format!("{name} carries {min} to {max}")));
        }
        Some(Ok(Forcing { direction: channel.direction, channel: channel.number, force }))
    }
}

fn form(words: &[&str]) -> Option<Force> {
    let number = |text: &str| text.parse().ok().filter(|number| f32::is_finite(*number));
    Some(match words {
        ["value", value] => Force::Value(number(value)?),
        ["offset", more] => Force::Offset(number(more)?),
        ["noise", amplitude] => Force::Noise(number(amplitude)?, 1),
        ["noise", amplitude, seed] => Force::Noise(number(amplitude)?, seed.parse().ok()?),
        ["stuck"] => Force::Stuck,
        ["open"] => Force::OpenWire,
        _ => return None,
    })
}
