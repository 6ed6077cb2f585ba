//! One step of everything beside the flows.

use super::buffers::{Books, State, Work};
use super::condenser::{CELLS, Coil, WallFigures, WallState};
use super::exchanger;
use super::medium::{LIQUID, PARTS, VAPOUR, dot};
use super::parts::Passage;
use super::stream::Stream;
use super::volume::{self, Constants, Contents, ENERGY, Held, STORED, Stored};
use super::{Climate, ControlLoop, Measure, crew};
use crate::control::{ActuatorFault, SensorFault};
use crate::element::Element;
use crate::simulator::Place;
use crate::{Line, Network, NodeKind, math};

/// Copies of the inputs, one for each stage time of a method.
const STAGES: usize = 3;
/// Largest deviation of a temperature from the reference at which a run is trusted [K].
pub(super) const THETA_LIMIT_K: f32 = 100.0;
/// How far rounding may take a mass fraction below 0 [1].
const LEAST_FRACTION: f32 = 1e-6;

impl Books<'_> {
    /// Adds a row.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "part of the loop over lines")]
    fn add(&mut self, node: usize, row: &Stored) {
        if let (Some(net), Some(lost)) = (self.net.get_mut(node), self.lost.get_mut(node)) {
            math::exact_add_row(net, lost, row);
        }
    }
}

/// A stream as a row; taken where `sign` is −1, with the same numbers.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of the loop over lines")]
fn row(stream: &Stream, sign: f32) -> Stored {
    let [a, b, c, d, e, f] = stream.mass_kg;
    [sign * a, sign * b, sign * c, sign * d, sign * e, sign * f, sign * stream.energy_j, 0.0]
}

/// Books a row that came from outside.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of the loop over lines")]
fn supply(ledger: &mut [Stored], row: &Stored) {
    if let [supplied, s, turned, t] = ledger {
        math::compensated_add_row(supplied, s, row);
        math::compensated_add_row(turned, t, &row.map(f32::abs));
    }
}

/// A row of energy alone.
#[inline]
fn heat_row(energy_j: f32) -> Stored {
    let mut row = [0.0; STORED];
    row[ENERGY] = energy_j;
    row
}

/// Present value of input `slot`.
#[inline]
fn input(inputs: &[f32], slot: u32) -> f32 {
    inputs.get(slot as usize).copied().unwrap_or(0.0)
}

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
    let (state, mut work) = (State::of(climate, state), Work::of(network, work));
    for (index, (fractions, figures)) in work.fractions.iter_mut().zip(work.figures.iter_mut()).enumerate() {
        if let Some(constants) = constants(network, index) {
            constants.start(fractions, figures);
        }
    }
    for (exchanger, shown) in climate.exchangers.iter().zip(work.shown.iter_mut()) {
        shown[2] = exchanger.start_k - climate.reference_k;
    }
    for (control, state) in climate.loops.iter().zip(state.loops) {
        let measured = measure(climate, &mut work, control.measure);
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
pub(crate) fn control<E>(
    network: &Network<'_, E>,
    step_s: f32,
    tick: u64,
    state: &mut [f32],
    work: &mut [f32],
    inputs: &mut [f32],
) {
    let climate = &network.climate;
    let (state, mut work) = (State::of(climate, state), Work::of(network, work));
    let slots = network.inputs.len();
    for (control, state) in climate.loops.iter().zip(state.loops) {
        let first = control.first_input;
        let [setpoint, bias] = [input(inputs, first), input(inputs, first + 1)];
        let sensor_fault = SensorFault::of_input(input(inputs, first + 2));
        let actuator_fault = ActuatorFault::of_input(input(inputs, first + 3));
        let measured = measure(climate, &mut work, control.measure);
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
        for (state, value) in state.iter_mut().zip(sensor.iter().chain(&controller).chain(&actuator)) {
            *state = *value;
        }
    }
}

/// What a sensor sees.
fn measure(climate: &Climate<'_>, work: &mut Work<'_>, measure: Measure) -> f32 {
    let of = |node: u32| {
        let index = node as usize;
        let (figures, fractions) = (work.figures.get(index), work.fractions.get(index));
        figures.copied().zip(fractions.copied()).unwrap_or(([0.0; 6], [0.0; PARTS]))
    };
    let partial = |node: u32, part: u32| {
        let ([_, pressure, ..], fractions) = of(node);
        volume::partial_pressure_pa(part as usize, &fractions, pressure)
    };
    let temperature = |node: u32| climate.reference_k + of(node).0[0];
    match measure {
        Measure::Temperature(node) => temperature(node),
        Measure::DewPoint(node) => crate::moist::dew_point_k(partial(node, VAPOUR as u32)),
        Measure::RelativeHumidity(node) => {
            crate::moist::relative_humidity(partial(node, VAPOUR as u32), temperature(node))
        }
        Measure::Pressure(node) => of(node).0[1],
        Measure::Partial(node, part) => partial(node, part),
        Measure::AirOutlet(exchanger) => {
            climate.reference_k + work.shown.get(exchanger as usize).map_or(0.0, |shown| shown[2])
        }
    }
}

/// What a step needs from outside.
#[derive(Clone, Copy)]
pub(crate) struct Stepped<'s> {
    /// Step [s].
    pub(crate) step_s: f32,
    /// Inputs of the step.
    pub(crate) inputs: &'s [f32],
    /// What all lines have given.
    pub(crate) given: Given<'s>,
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
/// without a pressure to ask for the method's φ, then with the new gauge pressure [Pa] of a gas volume. Returns the
/// first volume that left its range.
pub(crate) fn step<E: Element>(
    network: &Network<'_, E>,
    at: Stepped<'_>,
    state: &mut [f32],
    work: &mut [f32],
    mut flow: impl FnMut(usize, Option<f32>) -> f32,
) -> Option<Place> {
    let climate = &network.climate;
    let (mut state, mut work) = (State::of(climate, state), Work::of(network, work));
    begin_coils(climate, &mut state, &mut work);
    move_lines(network, at, &mut state, &mut work);
    settle_coils(climate, at, &mut state, &mut work);
    supply_volumes(network, at, &mut state, &mut work);
    pass_walls(climate, at, &mut state, &mut work);
    let mut place = None;
    for index in 0..climate.volumes.len() {
        let Some(constants) = constants(network, index) else { continue };
        let (Some(value), Some(carry), Some(owed), Some(owed_carry)) = (
            state.value.get_mut(index),
            state.carry.get_mut(index),
            state.owed.get_mut(index),
            state.owed_carry.get_mut(index),
        ) else {
            continue;
        };
        let (Some(net), Some(lost), Some(fractions), Some(figures), Some(passed)) = (
            work.books.net.get_mut(index),
            work.books.lost.get_mut(index),
            work.fractions.get_mut(index),
            work.figures.get_mut(index),
            work.passed.get_mut(index),
        ) else {
            continue;
        };
        let [_, _, _, inward, outward, _] = *figures;
        *passed = [inward, outward];
        let mut held = Held { value, carry, owed, owed_carry, net, lost, fractions, figures };
        let slowed = flow(index, None);
        if let Some(pressure) = constants.update(&mut held, slowed) {
            flow(index, Some(pressure));
        }
        let [theta, _, mass, ..] = *held.figures;
        // No part can be taken out that is not there.
        let least = held.fractions.iter().fold(0.0, |least, part| math::smaller(least, *part));
        if least < -LEAST_FRACTION
            || math::beyond(theta, THETA_LIMIT_K)
            || math::beyond(1.0 / mass, f32::MAX)
            || mass < 0.0
        {
            place = place.or(Some(Place::Node(index as u32)));
        }
    }
    place
}

/// One coil of the network while it is stepped.
fn coil<'c>(
    climate: &'c Climate<'_>,
    index: usize,
    walls: &'c mut [WallState],
    figures: &'c mut [WallFigures],
) -> Option<Coil<'c>> {
    let exchanger = climate.exchangers.get(index)?;
    let range = CELLS * index..CELLS * (index + 1);
    Some(Coil {
        condenser: &exchanger.condenser,
        air: &climate.air,
        reference_k: climate.reference_k,
        start_theta_k: exchanger.start_k - climate.reference_k,
        walls: walls.get_mut(range.clone())?,
        figures: figures.get_mut(range)?,
    })
}

fn begin_coils(climate: &Climate<'_>, state: &mut State<'_>, work: &mut Work<'_>) {
    for index in 0..climate.exchangers.len() {
        if let Some(mut coil) = coil(climate, index, state.coils, work.coils) {
            coil.begin();
        }
    }
}

/// Passes every line's stream from the volume upstream through its stations to the volume downstream.
fn move_lines<E>(network: &Network<'_, E>, at: Stepped<'_>, state: &mut State<'_>, work: &mut Work<'_>) {
    let climate = &network.climate;
    let mut stations = climate.stations;
    for (index, line) in network.lines.iter().enumerate() {
        let count = stations.iter().take_while(|station| station.line as usize == index).count();
        let (here, rest) = stations.split_at_checked(count).unwrap_or((&[], &[]));
        stations = rest;
        let Some(&[sum, carry]) =
            at.given.sums.get(index * at.given.stride..).and_then(|rest| rest.first_chunk())
        else {
            continue;
        };
        let Some([last_sum, last_carry]) = work.given.get_mut(index) else { continue };
        // What the method's compensated sum grew by in this step.
        let mass = (sum - *last_sum) - (carry - *last_carry);
        (*last_sum, *last_carry) = (sum, carry);
        let reversed = mass < 0.0;
        let (up, down) = ends(line, reversed);
        let Some(constants) = constants(network, up) else { continue };
        let (Some(fractions), Some(figures)) = (work.fractions.get(up), work.figures.get_mut(up)) else {
            continue;
        };
        figures[4] += mass.abs();
        let (theta, pressure) = (figures[0], figures[1]);
        let mut stream = Stream::of(mass.abs(), fractions, theta, constants.medium);
        if let Some(figures) = work.figures.get_mut(down) {
            figures[3] += mass.abs();
        }
        work.books.add(up, &row(&stream, -1.0));
        for place in 0..here.len() {
            let place = if reversed { here.len() - 1 - place } else { place };
            if let Some(station) = here.get(place) {
                pass(climate, at, &station.passage, &mut stream, (pressure, reversed), state, work);
            }
        }
        work.books.add(down, &row(&stream, 1.0));
    }
}

/// Nodes upstream and downstream.
#[inline]
fn ends(line: &Line, reversed: bool) -> (usize, usize) {
    let (from, to) = (line.from as usize, line.to as usize);
    if reversed { (to, from) } else { (from, to) }
}

/// What a stream at `pressure` [Pa] meets at one station.
fn pass(
    climate: &Climate<'_>,
    at: Stepped<'_>,
    passage: &Passage,
    stream: &mut Stream,
    (pressure, reversed): (f32, bool),
    state: &mut State<'_>,
    work: &mut Work<'_>,
) {
    match *passage {
        Passage::Machine { power_w, speed_input } => {
            let speed = input(at.inputs, speed_input);
            let heat = power_w * speed * speed * speed * at.step_s;
            stream.energy_j += heat;
            supply(state.ledger, &heat_row(heat));
        }
        Passage::Heater { power_input } => {
            let heat = input(at.inputs, power_input) * at.step_s;
            stream.energy_j += heat;
            supply(state.ledger, &heat_row(heat));
        }
        Passage::Condenser(of) => {
            let index = of as usize;
            let before = *stream;
            if let Some(mut coil) = coil(climate, index, state.coils, work.coils) {
                coil.pass_air(stream, at.step_s, pressure, reversed);
            }
            if let Some([heat, water, theta, _]) = work.shown.get_mut(index) {
                *water = before.vapour_kg() - stream.vapour_kg();
                *theta = stream.theta_k(&climate.air);
                // What condenses leaves as a liquid, which lies below its vapour by the evaporation enthalpy.
                let liquid = climate.air.flowing_j_kg_k[LIQUID] * *theta - climate.air.latent_j_kg;
                *heat = (before.energy_j - stream.energy_j) - *water * liquid;
            }
        }
        Passage::CoolantSide(of) => {
            let index = of as usize;
            let before = stream.energy_j;
            if let Some(mut coil) = coil(climate, index, state.coils, work.coils) {
                coil.pass_coolant(stream, at.step_s, &climate.coolant);
            }
            if let Some([_, _, _, taken]) = work.shown.get_mut(index) {
                *taken = stream.energy_j - before;
            }
        }
    }
}

/// Coolant from outside, then heat and water of all coils.
fn settle_coils(climate: &Climate<'_>, at: Stepped<'_>, state: &mut State<'_>, work: &mut Work<'_>) {
    for (index, exchanger) in climate.exchangers.iter().enumerate() {
        let slot = exchanger.first_input;
        let Some(mut coil) = coil(climate, index, state.coils, work.coils) else { continue };
        if exchanger.own_coolant {
            let mass = input(at.inputs, slot + 1) * at.step_s;
            let theta = input(at.inputs, slot + 2) - climate.reference_k;
            let mut stream = Stream { mass_kg: [mass, 0.0, 0.0, 0.0, 0.0, 0.0], energy_j: 0.0 };
            let before = stream.capacity_j_k(&climate.coolant) * theta;
            stream.energy_j = before;
            coil.pass_coolant(&mut stream, at.step_s, &climate.coolant);
            supply(state.ledger, &heat_row(before - stream.energy_j));
            if let Some([_, _, _, taken]) = work.shown.get_mut(index) {
                *taken = stream.energy_j - before;
            }
        }
        let drained = coil.settle();
        let Some(stores) = state.stores.get_mut(index) else { continue };
        let lost = exchanger::separate(exchanger, stores, drained, input(at.inputs, slot), at.step_s);
        let node = exchanger.outlet_node as usize;
        let mut back = heat_row(lost.energy_j);
        back[LIQUID] = lost.water_kg;
        work.books.add(node, &back);
    }
}

/// Crew, sources, removal and free water.
fn supply_volumes<E>(network: &Network<'_, E>, at: Stepped<'_>, state: &mut State<'_>, work: &mut Work<'_>) {
    let climate = &network.climate;
    for crew in climate.crews {
        let [count, activity] = [input(at.inputs, crew.first_input), input(at.inputs, crew.first_input + 1)];
        let (heat, parts) = crew::person(activity);
        give(climate, state, work, crew.node, count * at.step_s, heat, &parts);
    }
    for source in climate.sources {
        let first = source.first_input as usize;
        let Some([heat, parts @ ..]) = at.inputs.get(first..first + PARTS + 1) else { continue };
        let mut rates = [0.0; PARTS];
        for (rate, part) in rates.iter_mut().zip(parts) {
            *rate = *part;
        }
        give(climate, state, work, source.node, at.step_s, *heat, &rates);
    }
    for remover in climate.removers {
        let (node, part) = (remover.node as usize, remover.part as usize);
        let flow = input(at.inputs, remover.first_input) * input(at.inputs, remover.first_input + 1);
        let (Some([theta, pressure, ..]), Some(fractions)) =
            (work.figures.get(node), work.fractions.get(node))
        else {
            continue;
        };
        // ρ = p_i/(R_i·T) of this part alone
        let partial = volume::partial_pressure_pa(part, fractions, *pressure);
        let gas = super::medium::GAS_CONSTANTS_J_KG_K.get(part).copied().unwrap_or(1.0);
        let mut rates = [0.0; PARTS];
        if let Some(rate) = rates.get_mut(part) {
            *rate = -flow * partial / (gas * (climate.reference_k + *theta));
        }
        give(climate, state, work, remover.node, at.step_s, 0.0, &rates);
    }
    for (node, volume) in climate.volumes.iter().enumerate() {
        let (Some(figures), Some(fractions)) = (work.figures.get(node), work.fractions.get(node)) else {
            continue;
        };
        let held = network.nodes.get(node).is_some_and(|node| node.kind == NodeKind::Boundary);
        if volume.contents == Contents::Air && volume.surface_kg_s_pa > 0.0 && !held {
            let vapour = volume::evaporated_kg(
                volume,
                figures,
                fractions,
                &climate.air,
                climate.reference_k,
                at.step_s,
            );
            let mut change = [0.0; STORED];
            (change[VAPOUR], change[LIQUID]) = (vapour, -vapour);
            work.books.add(node, &change);
        }
    }
}

/// Heat [W] and masses [kg/s] from outside for `time_s` [s, or person-seconds], the masses at the temperature of their
/// volume.
#[inline]
fn give(
    climate: &Climate<'_>,
    state: &mut State<'_>,
    work: &mut Work<'_>,
    node: u32,
    time_s: f32,
    heat_w: f32,
    rates_kg_s: &[f32; PARTS],
) {
    let theta = work.figures.get(node as usize).map_or(0.0, |[theta, ..]| *theta);
    let mut given = [0.0; STORED];
    for (given, rate) in given.iter_mut().zip(rates_kg_s) {
        *given = rate * time_s;
    }
    let carried =
        dot(rates_kg_s, &climate.air.flowing_j_kg_k) * theta - rates_kg_s[LIQUID] * climate.air.latent_j_kg;
    given[ENERGY] = (heat_w + carried) * time_s;
    work.books.add(node as usize, &given);
    supply(state.ledger, &given);
}

/// Heat between volumes, walls and surroundings.
fn pass_walls(climate: &Climate<'_>, at: Stepped<'_>, state: &mut State<'_>, work: &mut Work<'_>) {
    for (wall, index) in climate.walls.iter().zip(0..) {
        let (Some(figures), Some([energy, carry])) =
            (work.figures.get(wall.node as usize), state.walls.get_mut(index))
        else {
            continue;
        };
        let theta = (wall.start_k - climate.reference_k) + *energy / wall.capacity_j_k;
        let outside = input(at.inputs, wall.first_input) - climate.reference_k;
        let inner = wall.inner_w_k * (figures[0] - theta) * at.step_s;
        let outer = wall.outer_w_k * (outside - theta) * at.step_s;
        math::compensated_add(energy, carry, inner);
        math::compensated_add(energy, carry, outer);
        work.books.add(wall.node as usize, &heat_row(-inner));
        supply(state.ledger, &heat_row(outer));
    }
}
