//! The other end of a link: a controller that holds the first value that the plant sends by the first that it sets.
//!
//! `u = u0 + Kp·e + Ki·∫e dt`, e the set point minus the measured value, u within its range. The integral stands still
//! while u is at its limit and would be driven further (clamping, K. J. Åström and R. M. Murray, "Feedback Systems",
//! section 10.4). Gains and set point are parameters, numbered from 0 in the order of [`Parameters`].

use crate::account::{Account, Tick};
use crate::board::Board;
use crate::control::{Event, SHOWN_OUTPUTS, Settings};
use crate::coupling::{LinkReport, read_link};
use crate::schedule::Schedule;
use eclss_core::mode::{Mode, Refusal, Request};
use eclss_core::protocol::{Command, CommandFrame, Link, Outcome, Outgoing};

/// What an operator can set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameters {
    /// What the first value shall be, in its unit.
    pub set_point: f32,
    /// Proportional gain \[1/unit\].
    pub proportional: f32,
    /// Integral gain \[1/(unit·s)\].
    pub integral: f32,
}

/// For the flow through the valve of `networks/hil.toml`: gains chosen such that the flow follows within seconds.
pub const FLOW: Parameters = Parameters { set_point: 0.06, proportional: 4.0, integral: 6.0 };

/// Fastest change of what it sets \[1/s\]: slower than the valve's channel believes.
const RATE_PER_S: f32 = 3.0;

/// The controller's state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Controller {
    /// What an operator can set.
    pub parameters: Parameters,
    min: f32,
    max: f32,
    output: f32,
    sum: f32,
    step_s: f32,
}

impl Controller {
    /// Starts with `output` within `min` and `max`, for ticks of `step_s` \[s\].
    pub fn new(parameters: Parameters, output: f32, [min, max]: [f32; 2], step_s: f32) -> Self {
        Self { parameters, min, max, output, sum: output, step_s }
    }

    /// What it sets now.
    pub fn output(&self) -> f32 {
        self.output
    }

    /// Takes a measured value. While the plant does not run there is nothing to integrate.
    pub fn measure(&mut self, value: f32, running: bool) {
        if !value.is_finite() || !running {
            self.sum = self.output;
            return;
        }
        let error = self.parameters.set_point - value;
        let sum = self.sum + self.parameters.integral * error * self.step_s;
        let wanted = sum + self.parameters.proportional * error;
        // 0·∞, where set point and value are further apart than any number.
        if wanted.is_nan() {
            return;
        }
        let saturated = (wanted > self.max && error > 0.0) || (wanted < self.min && error < 0.0);
        if !saturated {
            self.sum = sum;
        }
        let most = RATE_PER_S * self.step_s;
        self.output = wanted.clamp(self.output - most, self.output + most).clamp(self.min, self.max);
    }

    fn parameter(&mut self, number: u16) -> Option<&mut f32> {
        let Parameters { set_point, proportional, integral } = &mut self.parameters;
        [set_point, proportional, integral].into_iter().nth(usize::from(number))
    }

    /// Does a command about a parameter.
    pub fn command(&mut self, command: Command) -> Outcome {
        match command {
            Command::Get { parameter } => {
                self.parameter(parameter).map_or(Outcome::NoSuchParameter, |value| Outcome::Value(*value))
            }
            Command::Set { parameter, value } => match self.parameter(parameter) {
                None => Outcome::NoSuchParameter,
                Some(_) if !(value.is_finite() && value >= 0.0) => Outcome::OutOfRange,
                Some(place) => {
                    *place = value;
                    Outcome::Value(value)
                }
            },
            Command::Mode(_) => Outcome::Refused(Refusal::Mode),
        }
    }
}

/// Runs the controller until [`Settings::ticks`] have run, on the same grid and with the same account as a plant.
/// It acknowledges and arms the plant by itself, or restarts one that cannot be trusted: it is the bench's operator as
/// well.
pub async fn run<B: Board>(
    board: &mut B,
    link: &mut Link,
    controller: &mut Controller,
    settings: &Settings,
    mut tell: impl FnMut(Event),
) {
    let first_us = board.now_us() + u64::from(settings.period_us.get());
    let mut schedule = Schedule::new(first_us, settings.period_us);
    let mut account = Account::new(first_us, settings.period_us, settings.startup_ticks);
    let (mut mode, mut measured, mut restart) = (Mode::PowerUp, f32::NAN, false);
    let mut until_status = settings.status_every.get();
    while settings.ticks.is_none_or(|ticks| account.ticks < ticks) {
        let release_us = schedule.release_us();
        board.sleep_until(release_us).await;
        let begun_us = board.now_us();
        let begun = board.counter();
        board.feed_watchdog();
        read_link(board, link, begun_us);
        let was = mode;
        if let Some(data) = link.take_data() {
            mode = data.mode;
            measured = data.value(0).unwrap_or(f32::NAN);
        }
        let stepping = board.counter();
        controller.measure(measured, mode == Mode::Run);
        let stepped = board.counter();
        if let Some(CommandFrame { id, command }) = link.take_command() {
            link.acknowledge(id, controller.command(command));
        }
        if let Some(ack) = link.take_ack() {
            restart = ack.outcome == Outcome::Refused(Refusal::Plant);
        }
        let request = match mode {
            Mode::Ready => Some(Request::Arm),
            Mode::Safe if restart => Some(Request::Restart),
            Mode::Safe => Some(Request::Acknowledge),
            _ => None,
        };
        if let Some(request) = request.filter(|_| !link.is_commanding()) {
            link.command(Command::Mode(request));
        }
        let values = [controller.output(), 1.0];
        let tick = account.ticks;
        link.send_tick(tick, begun_us, &Outgoing { mode: Mode::Run, values: &values, ..Outgoing::default() });
        let taken = board.write_link(link.outgoing());
        link.sent(taken);
        let tick_counts = board.counter().wrapping_sub(begun);
        let step_counts = stepped.wrapping_sub(stepping);
        let skipped = schedule.finish(board.now_us());
        let link_counts = tick_counts.wrapping_sub(step_counts);
        account.book(&Tick { release_us, begun_us, tick_counts, step_counts, link_counts, skipped });
        if mode != was {
            tell(Event::Mode { tick, from: was, to: mode });
        }
        until_status -= 1;
        if until_status == 0 {
            until_status = settings.status_every.get();
            let mut outputs = [f32::NAN; SHOWN_OUTPUTS];
            outputs[0] = measured;
            outputs[1] = controller.output();
            tell(Event::Status { account, outputs, mode, link: Some(report(link)) });
        }
    }
    tell(Event::Ended { account, state_hash: 0, values_hash: 0, mode, link: Some(report(link)) });
}

fn report(link: &Link) -> LinkReport {
    LinkReport {
        connected: link.is_connected(),
        counters: *link.counters(),
        sent: link.sent_packets(),
        silence: link.silence_ticks(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A first-order lag of 0.2 s follows the set point without a lasting error, and does not wind up at the limit.
    #[test]
    fn it_follows_and_does_not_wind_up() {
        let mut controller = Controller::new(FLOW, 0.5, [0.02, 1.0], 1e-3);
        let mut value = 0.04_f32;
        let mut run = |controller: &mut Controller, ticks: u32| {
            for _ in 0..ticks {
                value += (0.1 * controller.output() - value) * 1e-3 / 0.2;
                controller.measure(value, true);
            }
            value
        };
        assert!((run(&mut controller, 60_000) - 0.06).abs() < 1e-4);
        controller.parameters.set_point = 1.0;
        run(&mut controller, 60_000);
        assert!((controller.output() - 1.0).abs() < 1e-6, "at its limit");
        controller.parameters.set_point = 0.06;
        run(&mut controller, 2_000);
        assert!(controller.output() < 0.95, "away from it at once");
    }

    /// Whatever is measured and set, what comes out is a number within the range.
    #[test]
    fn no_measurement_and_no_parameter_makes_it_anything_but_a_number() {
        let far = [0.0, 1.0, f32::MAX];
        for (set_point, gain) in far.into_iter().flat_map(|set_point| far.map(|gain| (set_point, gain))) {
            let parameters = Parameters { set_point, proportional: gain, integral: 1.0 - gain };
            let parameters = Parameters { integral: parameters.integral.max(0.0), ..parameters };
            let mut controller = Controller::new(parameters, 0.5, [0.02, 1.0], 1e-3);
            for value in [f32::MIN, f32::NAN, f32::MAX, f32::NEG_INFINITY, 0.0, f32::MIN, f32::MIN] {
                controller.measure(value, true);
                assert!((0.02..=1.0).contains(&controller.output()), "{parameters:?}, {value}");
            }
        }
    }

    #[test]
    fn parameters_are_told_set_and_checked() {
        let mut controller = Controller::new(FLOW, 0.5, [0.02, 1.0], 1e-3);
        assert_eq!(controller.command(Command::Get { parameter: 2 }), Outcome::Value(6.0));
        assert_eq!(controller.command(Command::Set { parameter: 0, value: 0.05 }), Outcome::Value(0.05));
        assert_eq!(controller.command(Command::Set { parameter: 0, value: f32::NAN }), Outcome::OutOfRange);
        assert_eq!(controller.command(Command::Get { parameter: 3 }), Outcome::NoSuchParameter);
        assert!((controller.parameters.set_point - 0.05).abs() < 1e-9);
    }
}
