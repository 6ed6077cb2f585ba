//! Inputs and the schedules that drive them.

use std::collections::{HashMap, HashSet};

use eclss_core::{AnyComponent, Element, InputSpec, Interpolation, Schedule, SchedulePoint};

use crate::document::{Entry, NetworkFile};
use crate::limits;
use crate::notes::Notes;

/// One input slot while a file is converted.
#[derive(Debug)]
pub(crate) struct Slot {
    /// Name as in `valve.opening`.
    pub(crate) name: String,
    /// Range and default.
    pub(crate) spec: InputSpec,
    /// Value at the start, where the file gives one.
    start: Option<f64>,
    /// Path of the element's table.
    path: String,
}

impl Slot {
    /// A slot of the thing `id` whose table is at `path`.
    pub(crate) fn new(id: &str, spec: InputSpec, start: Option<f64>, path: &str) -> Self {
        Self { name: format!("{id}.{}", spec.name), spec, start, path: path.to_owned() }
    }
}

/// A component of a file with its place there.
#[derive(Clone, Copy)]
pub(crate) struct Named<'a> {
    pub(crate) id: &'a str,
    pub(crate) entry: &'a Entry,
    /// Path of its table.
    pub(crate) path: &'a str,
}

/// Adds the slots of one component.
pub(crate) fn slots_of(
    component: &AnyComponent,
    Named { id, entry, path }: Named<'_>,
    slots: &mut Vec<Slot>,
    notes: &mut Notes,
) {
    let first = slots.len();
    let starts = &entry.starts;
    let specs = (0..).map_while(|index| component.input_spec(index));
    slots.extend(specs.map(|spec| Slot::new(id, spec, starts.get(spec.name).copied(), path)));
    for (name, start) in starts {
        match slots[first..].iter().find(|slot| slot.spec.name == *name) {
            Some(slot) if !limits::of(&slot.spec).values.contains(start) => {
                let range = limits::of(&slot.spec);
                notes.refuse_at(path, &[name], format!("`{name}` must lie in {range}, not at {start:?}"));
            }
            // Its loss is the only one that decides by a key whether an input exists.
            None if *name == "opening" => {
                notes.refuse_at(path, &[name], "an `opening` is for an element with `blockable = true`");
            }
            Some(_) | None => {}
        }
    }
}

/// Start values, schedules and points.
#[derive(Debug, Default)]
pub(crate) struct Driven {
    pub(crate) inputs: Vec<f32>,
    pub(crate) schedules: Vec<Schedule>,
    pub(crate) points: Vec<SchedulePoint>,
}

/// Converts all schedules and sets every start value.
pub(crate) fn drive(file: &NetworkFile, slots: &[Slot], notes: &mut Notes) -> Driven {
    let start = |slot: &Slot| slot.start.map_or(slot.spec.default, |start| start as f32);
    let mut driven = Driven { inputs: slots.iter().map(start).collect(), ..Driven::default() };
    let total: usize = file.schedules.iter().map(|schedule| schedule.points.len()).sum();
    if total > limits::SCHEDULE_POINTS {
        let most = limits::SCHEDULE_POINTS;
        notes.refuse_at(
            "schedule",
            &[],
            format!("{total} points in all schedules, at most {most} are allowed"),
        );
        return driven;
    }
    for slot in slots.iter().filter(|slot| slot.spec.is_code()) {
        if let Some(start) = slot.start.filter(|start| (libm::rint(*start) - *start).abs() > 0.0) {
            let reason = format!("`{}` is a code, {start} is no whole number", slot.name);
            notes.refuse_at(&slot.path, &[slot.spec.name], reason);
        }
    }
    let by_name: HashMap<&str, usize> =
        slots.iter().enumerate().map(|(slot, data)| (data.name.as_str(), slot)).collect();
    let mut taken = HashSet::new();
    for (index, entry) in file.schedules.iter().enumerate() {
        let path = format!("schedule[{index}]");
        let Some(&slot) = by_name.get(entry.input.as_str()) else {
            let names: Vec<_> = slots.iter().take(20).map(|slot| slot.name.as_str()).collect();
            let span = notes.place(&path, &["input"]);
            let help = format!("inputs of this network: {}", names.join(", "));
            notes.refuse_with(span, format!("there is no input `{}`", entry.input), help);
            continue;
        };
        if !taken.insert(slot) {
            notes.refuse_at(&path, &["input"], format!("`{}` has a schedule already", entry.input));
            continue;
        }
        let points = points(&entry.points, &slots[slot].spec, &path, notes);
        if slots[slot].start.is_some() {
            let reason =
                format!("`{}` follows a schedule, so it has no start value of its own", slots[slot].name);
            notes.refuse_at(&slots[slot].path, &[slots[slot].spec.name], reason);
        }
        // What the schedule says at time zero: its first point, or the last of several there.
        let at_start = points.iter().rev().find(|point| point.time_us == 0).or(points.first());
        if let Some(point) = at_start {
            driven.inputs[slot] = point.value;
        }
        let whole = slots[slot].spec.is_code();
        if whole && entry.interpolation.as_deref() != Some("hold") && entry.points.len() > 1 {
            let reason = format!(
                "`{}` is a code, which has no values between two: say `interpolation = \"hold\"`",
                entry.input
            );
            notes.refuse_at(&path, &["interpolation", "input"], reason);
        }
        let interpolation = match entry.interpolation.as_deref() {
            Some("hold") => Interpolation::Hold,
            _ => Interpolation::Linear,
        };
        driven.schedules.push(Schedule {
            input: slot as u32,
            first_point: driven.points.len() as u32,
            points: points.len() as u32,
            interpolation,
        });
        driven.points.extend(points);
    }
    driven
}

/// Converts points, whose times must not fall and whose values must suit the input.
fn points(pairs: &[(f64, f64)], spec: &InputSpec, path: &str, notes: &mut Notes) -> Vec<SchedulePoint> {
    let mut points: Vec<SchedulePoint> = Vec::with_capacity(pairs.len());
    for (index, &(time_s, value)) in pairs.iter().enumerate() {
        // Whole microseconds; the range of times makes the conversion exact.
        let point = SchedulePoint { time_us: libm::round(time_s * 1e6) as u64, value: value as f32 };
        let place = format!("{path}.points[{index}]");
        if points.last().is_some_and(|last| last.time_us > point.time_us) {
            notes.refuse_at(&place, &[], format!("time {time_s} s lies before that of the point above it"));
        }
        if points.len() >= 2 && points[points.len() - 2..].iter().all(|last| last.time_us == point.time_us) {
            notes.refuse_at(&place, &[], format!("a third point at {time_s} s; a jump has two"));
        }
        if !(spec.min..=spec.max).contains(&point.value) {
            let reason = format!("`{}` must lie in {} … {}, not at {value}", spec.name, spec.min, spec.max);
            notes.refuse_at(&place, &[], reason);
        }
        if spec.is_code() && (libm::rint(value) - value).abs() > 0.0 {
            notes.refuse_at(&place, &[], format!("`{}` is a code, {value} is no whole number", spec.name));
        }
        points.push(point);
    }
    points
}
