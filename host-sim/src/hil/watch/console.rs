//! The operator of a board that is watched: orders in, answers and a line a second out.

use std::collections::VecDeque;
use std::io::Write;
use std::sync::mpsc::Receiver;

use eclss_core::mode::Request;
use eclss_core::protocol::{Command, Link as Session, Outcome};
use eclss_network_file::Loaded;

use super::super::arming::Arming;
use super::desk::Desk;

const ORDERS: &str = "orders are settle, arm, hold, resume, disarm, acknowledge, restart, stop, set NAME VALUE, get NAME, quit";

/// What an operator asks for.
#[derive(Debug, Clone, PartialEq)]
enum Order {
    Mode(Request),
    Set(String, f32),
    Get(String),
    Quit,
}

/// Orders that wait, and where answers go.
#[derive(Debug)]
pub(super) struct Console {
    /// Names of the input slots, in the order of the board's parameters.
    slots: Vec<String>,
    shows: bool,
    waiting: VecDeque<(Command, String)>,
    /// What the command under way was, by its number.
    asked: Option<(u32, String)>,
}

impl Console {
    pub(super) fn new(loaded: &Loaded, shows: bool) -> Self {
        Self { slots: loaded.names.inputs.clone(), shows, waiting: VecDeque::new(), asked: None }
    }

    pub(super) fn say(&self, out: &mut dyn Write, text: &str) {
        if self.shows {
            // Who does not read our output does not stop the bench.
            let _ = writeln!(out, "            {text}");
            let _ = out.flush();
        }
    }

    /// A line about the board.
    pub(super) fn line(&self, out: &mut dyn Write, desk: &Desk, session: &Session) {
        if !self.shows {
            return;
        }
        let state = match (session.is_connected(), session.refused()) {
            (true, _) => format!("{}, {:.1} Hz{}", desk.state(), desk.rate_hz(), desk.line()),
            (false, Some(reason)) => format!("no session: the board runs another {reason:?}"),
            (false, None) => "no session".to_owned(),
        };
        let counters = session.counters();
        let _ = writeln!(out, "{state}, {} lost, {} damaged", counters.lost, counters.damaged());
        let _ = out.flush();
    }

    /// Takes orders; returns whether the end was one of them.
    pub(super) fn orders(
        &mut self,
        out: &mut dyn Write,
        lines: &Receiver<String>,
        desk: &mut Desk,
        arming: &mut Arming,
    ) -> bool {
        // One a turn, so that typing without end does not keep the bench from its work.
        if let Ok(line) = lines.try_recv() {
            let line = line.trim();
            match parse(line) {
                Some(Order::Quit) => return true,
                Some(Order::Mode(request)) => {
                    arming.request(request);
                    self.waiting.push_back((Command::Mode(request), line.to_owned()));
                }
                Some(Order::Set(name, value)) => match (desk.set(&name, value), self.slot(&name)) {
                    (Some(Ok(())), _) => self.say(out, &format!("{line}: on its way")),
                    (Some(Err(why)), _) => self.say(out, &format!("{line}: refused, {why}")),
                    (None, Some(parameter)) => {
                        self.waiting.push_back((Command::Set { parameter, value }, line.to_owned()));
                    }
                    (None, None) => self.unknown(out, &name),
                },
                Some(Order::Get(name)) => match (desk.value(&name), self.slot(&name)) {
                    (Some(value), _) => self.say(out, &format!("{name} is {value}")),
                    (None, Some(parameter)) => {
                        self.waiting.push_back((Command::Get { parameter }, line.to_owned()));
                    }
                    (None, None) => self.unknown(out, &name),
                },
                None if line.is_empty() => {}
                None => self.say(out, ORDERS),
            }
        }
        false
    }

    fn slot(&self, name: &str) -> Option<u16> {
        self.slots.iter().position(|slot| slot == name).and_then(|slot| slot.try_into().ok())
    }

    fn unknown(&self, out: &mut dyn Write, name: &str) {
        self.say(out, &format!("nothing is called `{name}`; inputs are {}", self.slots.join(", ")));
    }

    /// Gives the board its next command, where none is under way.
    pub(super) fn command(&mut self, session: &mut Session) {
        if session.is_commanding() {
            return;
        }
        if let Some((command, text)) = self.waiting.pop_front() {
            match session.command(command) {
                Some(id) => self.asked = Some((id, text)),
                // There is no session yet.
                None => self.waiting.push_front((command, text)),
            }
        }
    }

    /// Tells what became of a command.
    pub(super) fn acknowledged(&mut self, out: &mut dyn Write, session: &mut Session) {
        let Some(ack) = session.take_ack() else { return };
        let Some((_, asked)) = self.asked.take_if(|(id, _)| *id == ack.id) else { return };
        let answer = match ack.outcome {
            Outcome::Mode(mode) => format!("granted, {}", mode.name()),
            Outcome::Value(value) => format!("it is {value}"),
            Outcome::Refused(reason) => format!("refused: {reason:?}"),
            Outcome::NoSuchParameter => "refused: a channel or a schedule drives it".to_owned(),
            Outcome::OutOfRange => "refused: out of range".to_owned(),
            Outcome::Busy => "refused: busy".to_owned(),
        };
        self.say(out, &format!("{asked}: {answer}"));
    }
}

fn parse(line: &str) -> Option<Order> {
    let mut words = line.split_whitespace();
    let order = match (words.next()?, words.next(), words.next()) {
        ("arm", None, _) => Order::Mode(Request::Arm),
        ("hold", None, _) => Order::Mode(Request::Hold),
        ("resume", None, _) => Order::Mode(Request::Resume),
        ("disarm", None, _) => Order::Mode(Request::Disarm),
        ("acknowledge", None, _) => Order::Mode(Request::Acknowledge),
        ("restart", None, _) => Order::Mode(Request::Restart),
        ("stop", None, _) => Order::Mode(Request::Stop),
        ("settle", None, _) => Order::Mode(Request::Settle),
        ("quit", None, _) => Order::Quit,
        ("get", Some(name), None) => Order::Get(name.to_owned()),
        ("set", Some(name), Some(value)) => {
            Order::Set(name.to_owned(), value.parse().ok().filter(|value| f32::is_finite(*value))?)
        }
        _ => return None,
    };
    words.next().is_none().then_some(order)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn orders_are_read_or_not_taken() {
        assert_eq!(parse("arm"), Some(Order::Mode(Request::Arm)));
        assert_eq!(parse("set valve.opening 0.5"), Some(Order::Set("valve.opening".into(), 0.5)));
        assert_eq!(parse("get fan.speed"), Some(Order::Get("fan.speed".into())));
        for wrong in ["", "fly", "arm now", "set x", "set x nan", "set x 1 2", "get", "get a b"] {
            assert_eq!(parse(wrong), None, "{wrong}");
        }
    }
}
