//! One step of everything beside the flows.

use super::buffers::{Running, State, Work};
use super::lines::{begin, move_lines, settle};
use super::observe::Rows;
use super::supply::own_blocks;
pub(crate) use super::supply::supply;
use super::volume::{Constants, Held, LEAST_FRACTION};
use super::{ControlLoop, density};
use crate::component::Element;
use crate::control::{ActuatorFault, SensorFault};
use crate::simulator::{Fault, Place};
use crate::unroll::every;
use crate::{Network, math};

/// Copies of the inputs, one for each stage time of a method.
const STAGES: usize = 3;

/// Present value of input `slot`.
#[inline]
pub(super) fn input(inputs: &[f32], slot: u32) -> f32 {
    inputs.get(slot as usize).copied().unwrap_or(0.0)
}

#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
fn constants<'c, E>(network: &'c Network<'_, E>, index: usize) -> Option<Constants<'c>> {
    let climate = &network.climate;
    let volume = climate.volumes.get(index)?;
    Some(Constants {
        volume,
        node: network.nodes.get(index)?,
        medium: volume.medium(&climate.air, &climate.coolant),
        reference_k: climate.reference_k,
        reference_pa: network.reference_pa,
    })
}

/// Sets the start state.
pub(crate) fn start<E>(network: &Network<'_, E>, state: &mut [f32], work: &mut [f32], inputs: &[f32]) {
    state.fill(0.0);
    work.fill(0.0);
    let climate = &network.climate;
    let (state, work) = (State::of(climate, state), Work::of(network, work));
    let rows = work.fractions.iter_mut().zip(work.figures.iter_mut()).zip(work.start.iter_mut());
    for (index, ((fractions, figures), start)) in rows.enumerate() {
        if let Some(constants) = constants(network, index) {
            constants.start(fractions, figures, start);
        }
    }
    density::derive(network, work.figures, work.fractions, work.virtual_k);
    let step = climate.context(1.0, inputs);
    for table in climate.tables {
        let blocks = own_blocks(table, state.components, work.scratch);
        table.kind().start(climate.placed_of(table), &step, blocks);
    }
    let rows = Rows::of(&work, state.components);
    for (control, state) in climate.loops.iter().zip(state.loops) {
        // Nothing has passed yet, so the step does not count.
        let measured = rows.read(climate, 1.0, control.measures);
        let driven = input(inputs, control.drives);
        let sensor = control.sensor.start(measured);
        let actuator = control.actuator.start(driven);
        let controller = control.controller.start(sensor[1], actuator[0]);
        for (state, value) in state.iter_mut().zip(sensor.iter().chain(&controller).chain(&actuator)) {
            *state = *value;
        }
    }
}

/// Runs the control loops on what the last step left, and sets the inputs that they drive at all stage times.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
pub(crate) fn control<E, const UNROLL: bool>(
    network: &Network<'_, E>,
    step_s: f32,
    tick: u64,
    running: &mut Running<'_>,
    inputs: &mut [f32],
) {
    let climate = &network.climate;
    let state = &mut running.state;
    let rows = Rows::of(&running.work, state.components);
    every!(UNROLL, climate.loops.iter().zip(state.loops.iter_mut()), (control, state) => {
        let measured = rows.read(climate, step_s, control.measures);
        act(control, network.inputs.len(), step_s, tick, measured, state, inputs);
    });
}

/// One step of one loop, and the inputs that it drives.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
fn act(
    control: &ControlLoop,
    slots: usize,
    step_s: f32,
    tick: u64,
    measured: f32,
    state: &mut [f32; ControlLoop::STATE],
    inputs: &mut [f32],
) {
    let first = control.first_input;
    let [setpoint, bias] = [input(inputs, first), input(inputs, first + 1)];
    let sensor_fault = SensorFault::of_input(input(inputs, first + 2));
    let actuator_fault = ActuatorFault::of_input(input(inputs, first + 3));
    let [followed, reading, integral, carry, last, output, position, moves] = *state;
    let (mut sensor, mut actuator) = ([followed, reading], [position, moves]);
    let mut controller = [integral, carry, last, output];
    let reading = control.sensor.step(&mut sensor, measured, bias, sensor_fault, step_s, tick);
    let command = control.controller.step(&mut controller, setpoint, reading, step_s);
    let value = control.actuator.step(&mut actuator, command, actuator_fault, step_s);
    let rest = control.actuator.closed + control.actuator.open - value;
    for stage in 0..STAGES {
        if let Some(slot) = inputs.get_mut(stage * slots + control.drives as usize) {
            *slot = value;
        }
        if control.opposite != ControlLoop::NONE
            && let Some(slot) = inputs.get_mut(stage * slots + control.opposite as usize)
        {
            *slot = rest;
        }
    }
    let ([followed, reading], [integral, carry, last, output]) = (sensor, controller);
    let [position, moves] = actuator;
    *state = [followed, reading, integral, carry, last, output, position, moves];
}

/// What a step needs from outside.
#[derive(Clone, Copy)]
pub(crate) struct Stepped<'s> {
    /// Step [s].
    pub(crate) step_s: f32,
    /// Inputs of the step.
    pub(crate) inputs: &'s [f32],
}

/// What all lines have given to their outlet nodes since the start, as the flow method sums it.
#[derive(Clone, Copy)]
pub(crate) struct Given<'s> {
    /// Sum and carry of the first line, and so on [kg].
    pub(crate) sums: &'s [f32],
    /// Places between two lines.
    pub(crate) stride: usize,
}

/// Moves masses and energy with the flows of the step that the method has just taken. Calls `flow` with every volume:
/// without a pressure to ask for the method's φ, then with the new gauge pressure [Pa]. Returns the first volume that
/// left its range.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a step that may be specialised")]
pub(crate) fn step<E: Element, const UNROLL: bool>(
    network: &Network<'_, E>,
    at: Stepped<'_>,
    given: Given<'_>,
    running: Running<'_>,
    mut flow: impl FnMut(usize, Option<f32>) -> f32,
) -> Option<Place> {
    let climate = &network.climate;
    let Running { mut state, mut work } = running;
    let context = climate.context(at.step_s, at.inputs);
    begin(climate, &context, &mut state, &mut work);
    move_lines::<E, UNROLL>(network, at, given, &mut state, &mut work);
    settle(climate, &context, &mut state, &mut work);
    let mut place = None;
    let states = state.value.iter_mut().zip(state.carry).zip(state.owed.iter_mut().zip(state.owed_carry));
    let books = work.books.net.iter_mut().zip(work.books.lost.iter_mut());
    let shown = work.fractions.iter_mut().zip(work.figures.iter_mut());
    let shown = shown.zip(work.passed.iter_mut().zip(work.start.iter()));
    let rows = states.zip(books).zip(shown).enumerate();
    every!(UNROLL, rows, (index, ((held, (net, lost)), ((fractions, figures), (passed, start)))) => {
        let ((value, carry), (owed, owed_carry)) = held;
        let [_, _, _, inward, outward, _] = *figures;
        *passed = [inward, outward];
        let mut held = Held { value, carry, owed, owed_carry, net, lost, fractions, figures, start };
        let slowed = flow(index, None);
        let pressure = constants(network, index).and_then(|constants| constants.update(&mut held, slowed));
        let mut outside = false;
        if let Some(gauge_pa) = pressure {
            flow(index, pressure);
            outside = Fault::outside(gauge_pa, network.reference_pa);
        }
        let [theta, _, mass, ..] = *held.figures;
        // No part can be taken out that is not there.
        let least = held.fractions.iter().fold(0.0, |least, part| math::smaller(least, *part));
        let start_kg = climate.volumes.get(index).map_or(0.0, |volume| volume.start_kg);
        if least * mass < -LEAST_FRACTION * start_kg
            || theta.is_nan()
            || outside
            || !(f32::MIN_POSITIVE..=f32::MAX).contains(&mass)
        {
            place = place.or(Some(Place::Node(index as u32)));
        }
    });
    density::derive(network, work.figures, work.fractions, work.virtual_k);
    place
}
