//! Control: sensors, controllers and actuators of the document, and what of them makes no sense.

use eclss_core::climate::ControlLoop;
use eclss_core::component::Table;
use eclss_core::control::{Actuator, Controller, Pid, Sensor, Thermostat};
use eclss_core::signal::Owner;
use eclss_core::{Output, Signal};

use super::Lowering;
use crate::document::air::{ControlEntry, ControlKind};
use crate::limits;

impl Lowering<'_, '_> {
    /// All controls. First the inputs of each, so that any may drive the set point of any other.
    pub(super) fn controls(&mut self) {
        let file = self.file;
        let path = |index: usize| format!("control[{index}]");
        let mut first_inputs = Vec::new();
        for (index, entry) in file.controls.iter().enumerate() {
            first_inputs.push(self.inputs(&entry.id, &ControlLoop::INPUTS, &entry.starts, &path(index)));
        }
        for (index, (entry, first_input)) in file.controls.iter().zip(first_inputs).enumerate() {
            self.control(entry, &path(index), first_input);
            if self.returns(index) {
                let reason = format!("`{}` drives its own set point in the end, through others", entry.id);
                self.notes.refuse_at(&path(index), &["drives"], reason);
            }
        }
    }

    /// The control whose set point has the name of an input.
    fn of_setpoint(&self, name: &str) -> Option<usize> {
        let id = name.strip_suffix(".setpoint")?;
        self.file.controls.iter().position(|control| control.id == id)
    }

    /// Whether the set points that a control drives lead back to its own by way of others.
    fn returns(&self, index: usize) -> bool {
        let driven = |control: usize| {
            let entry = &self.file.controls[control];
            let names = [Some(&entry.drives), entry.opposite.as_ref()];
            names.into_iter().flatten().filter_map(|name| self.of_setpoint(name)).collect::<Vec<_>>()
        };
        let (mut open, mut seen) = (driven(index), vec![index]);
        while let Some(next) = open.pop() {
            if !seen.contains(&next) {
                seen.push(next);
                let further = driven(next);
                if further.contains(&index) {
                    return true;
                }
                open.extend(further);
            }
        }
        false
    }

    /// Unit of what an input takes; of a set point that of what is measured.
    fn unit_of(&self, slot: u32) -> &'static str {
        let Some(slot) = self.tables.slots.get(slot as usize) else { return "" };
        let Some(control) = self.of_setpoint(&slot.name) else { return slot.spec.unit };
        let signal = self.measured(&self.file.controls[control].measures);
        signal.map_or("", |signal| self.climate.climate().spec_of_signal(signal).unit())
    }

    /// Signal of a volume or an exchanger by its name.
    fn measured(&self, text: &str) -> Option<Signal> {
        let (id, what) = text.rsplit_once('.')?;
        let climate = self.climate.climate();
        let is = |signal: &Signal| climate.spec_of_signal(*signal).name == what;
        if let Some(index) = self.climate.names.iter().position(|name| name == id) {
            return climate.component_signals(index).find(is);
        }
        let node = self.file.nodes.iter().position(|node| node.id == id)?;
        climate.volume_signals(node).find(is)
    }

    /// Refuses a control that could be built and would make no sense.
    fn sense(&mut self, entry: &ControlEntry, path: &str, first_input: u32, driven: [Option<u32>; 2]) {
        let own = first_input..first_input + ControlLoop::INPUTS.len() as u32;
        for (key, slot) in ["drives", "opposite"].into_iter().zip(driven) {
            let Some(slot) = slot.filter(|slot| own.contains(slot)) else { continue };
            let reason =
                format!("`{}` is an input of this control itself", self.tables.slots[slot as usize].name);
            self.notes.refuse_at(path, &[key], reason);
        }
        for name in [Some(&entry.drives), entry.opposite.as_ref()].into_iter().flatten() {
            let Some(inner) = self.of_setpoint(name).map(|index| &self.file.controls[index]) else {
                continue;
            };
            let range = inner.sensor_min..=inner.sensor_max;
            if !range.contains(&entry.closed) || !range.contains(&entry.open) {
                let reason = format!(
                    "drives `{name}` over {} … {}, and its sensor reads {} … {}",
                    entry.closed, entry.open, inner.sensor_min, inner.sensor_max
                );
                self.notes.refuse_at(path, &["closed", "open"], reason);
            }
        }
        if let [Some(drives), Some(opposite)] = driven {
            let (drives, opposite) = (self.unit_of(drives), self.unit_of(opposite));
            if drives != opposite {
                let reason = format!(
                    "`drives` takes a value in {drives}, `opposite` one in {opposite}: what is left of \
                                      the one says nothing about the other"
                );
                self.notes.refuse_at(path, &["opposite"], reason);
            }
        }
        if (entry.closed - entry.open).abs() <= 0.0 {
            let reason = "`closed` and `open` are the same, so this control moves nothing";
            self.notes.refuse_at(path, &["open", "closed"], reason);
        }
        let range = entry.sensor_min..=entry.sensor_max;
        let unreachable = |value: f64| {
            let (least, most) = (entry.sensor_min, entry.sensor_max);
            format!("a set point of {value} lies outside what the sensor reads, {least} … {most}")
        };
        if let Some(&value) = entry.starts.get("setpoint").filter(|value| !range.contains(value)) {
            self.notes.refuse_at(path, &["setpoint"], unreachable(value));
        }
        let setpoint = format!("{}.setpoint", entry.id);
        for (index, schedule) in
            self.file.schedules.iter().enumerate().filter(|(_, other)| other.input == setpoint)
        {
            for (point, (_, value)) in
                schedule.points.iter().enumerate().filter(|(_, (_, value))| !range.contains(value))
            {
                self.notes.refuse_at(&format!("schedule[{index}].points[{point}]"), &[], unreachable(*value));
            }
        }
    }

    fn control(&mut self, entry: &ControlEntry, path: &str, first_input: u32) {
        let measures = self.measured(&entry.measures);
        if measures.is_none() {
            let span = self.notes.place(path, &["measures"]);
            let help = format!("measured are {}", measurable(&self.climate.tables));
            self.notes.refuse_with(span, format!("there is nothing `{}` to measure", entry.measures), help);
        }
        let setpoint = format!("{}.setpoint", entry.id);
        let scheduled = self.file.schedules.iter().any(|schedule| schedule.input == setpoint);
        if !scheduled && !entry.starts.contains_key("setpoint") {
            self.notes.refuse_at(path, &["setpoint", "id"], "`setpoint` is missing, and no schedule sets it");
        }
        let mut slot = |key: &'static str, name: &str, values: &[f64]| {
            let found = self.tables.slots.iter().position(|slot| slot.name == name);
            match found {
                None => self.notes.refuse_at(path, &[key], format!("there is no input `{name}`")),
                Some(found) => {
                    let spec = self.tables.slots[found].spec;
                    if !values.iter().all(|value| (spec.min..=spec.max).contains(&(*value as f32))) {
                        let reason =
                            format!("`{name}` takes {}, more than that is driven", limits::of(&spec));
                        self.notes.refuse_at(path, &["closed", "open"], reason);
                    }
                    if self.file.schedules.iter().any(|schedule| schedule.input == name) {
                        let reason = format!("`{name}` follows a schedule, it cannot be driven as well");
                        self.notes.refuse_at(path, &[key], reason);
                    }
                }
            }
            found.map(|found| found as u32)
        };
        let values = [entry.closed, entry.open];
        let drives = slot("drives", &entry.drives, &values);
        let opposite = entry.opposite.as_ref().and_then(|name| slot("opposite", name, &values));
        self.sense(entry, path, first_input, [drives, opposite]);
        let controller = controller(&entry.kind);
        let sensor = Sensor {
            min: entry.sensor_min as f32,
            max: entry.sensor_max as f32,
            lag_s: entry.sensor_lag_s.unwrap_or(0.0) as f32,
            noise: entry.sensor_noise.unwrap_or(0.0) as f32,
            seed: entry.seed.map_or_else(|| seed_of(&entry.id), |seed| seed as u32),
        };
        let actuator = Actuator {
            rate_per_s: (1.0 / entry.travel_s.unwrap_or(1.0)) as f32,
            stiction: entry.stiction.unwrap_or(0.0) as f32,
            closed: entry.closed as f32,
            open: entry.open as f32,
        };
        for error in
            [sensor.check(), controller.check(), actuator.check()].into_iter().filter_map(Result::err)
        {
            if error.parameter == "max" {
                self.notes.refuse_at(path, &["sensor_max"], "`sensor_max` must lie above `sensor_min`");
            } else {
                self.notes.refuse_at(path, &[error.parameter], crate::reason::text(error));
            }
        }
        self.climate.loops.push(ControlLoop {
            measures: measures.unwrap_or(Output::Temperature.of(0)),
            sensor,
            controller,
            actuator,
            drives: drives.unwrap_or(0),
            opposite: opposite.unwrap_or(ControlLoop::NONE),
            first_input,
        });
    }
}

/// Names of everything that a sensor can look at, with the figures of the components in these tables.
fn measurable(tables: &[Table]) -> String {
    let signals = Output::ALL.iter().flat_map(|output| (0..output.items()).map(|item| output.item(0, item)));
    let name = |signal: Signal| match signal.output.owner() {
        Owner::Volume | Owner::Air => Some(format!("<node>.{}", signal.spec().name)),
        _ => None,
    };
    let of_kind = |kind: &Table| {
        let specs = kind.kind().output_specs();
        specs.iter().map(|spec| format!("<{}>.{}", kind.kind().name(), spec.name)).collect::<Vec<_>>()
    };
    signals.filter_map(name).chain(tables.iter().flat_map(of_kind)).collect::<Vec<_>>().join(", ")
}

/// Seed of the noise of a sensor by its name (FNV-1a), so that no two sensors have the same noise and a file has the same
/// noise everywhere.
fn seed_of(id: &str) -> u32 {
    id.bytes().fold(0x811c_9dc5, |hash, byte| (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193))
}

fn controller(kind: &ControlKind) -> Controller {
    match kind {
        ControlKind::Pid { gain, integral_s, derivative_s, dead_band, bias, rate_per_s } => {
            Controller::Pid(Pid {
                gain: *gain as f32,
                integral_s: integral_s.map_or(f32::INFINITY, |time| time as f32),
                derivative_s: derivative_s.unwrap_or(0.0) as f32,
                dead_band: dead_band.unwrap_or(0.0) as f32,
                bias: bias.unwrap_or(0.0) as f32,
                rate_per_s: rate_per_s.map_or(f32::INFINITY, |rate| rate as f32),
            })
        }
        ControlKind::Thermostat { half_band, on_when } => Controller::Thermostat(Thermostat {
            half_band: *half_band as f32,
            on_when_high: on_when == "high",
        }),
    }
}
