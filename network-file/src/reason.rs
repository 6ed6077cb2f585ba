//! The core's errors in the words and at the places of the file.

use eclss_core::climate::ClimateError;
use eclss_core::parameter::StepBound;
use eclss_core::{MethodError, NetworkError, ParameterError, Reason};

use crate::loaded::Loaded;
use crate::notes::Notes;

/// The keys from which a parameter of the core comes, the likeliest first.
pub(crate) fn keys_of(parameter: &'static str) -> &'static [&'static str] {
    match parameter {
        "reference_pa" => &["reference_pressure_pa"],
        "start_gauge_pa" => &["pressure_pa"],
        "start_flow_kg_s" => &["initial_flow_kg_s"],
        "laminar_below_pa" => &["laminar_below_pa"],
        "resistance_pa_s2_kg2" => &["resistance_pa_s2_kg2", "loss_coefficient"],
        "shutoff_pa" => &["shutoff_pa", "h0_m"],
        "linear_pa_s_kg" => &["linear_pa_s_kg", "h1_s_m2"],
        "quadratic_pa_s2_kg2" => &["quadratic_pa_s2_kg2", "h2_s2_m5"],
        "inertance_per_m" => &["inertance_per_m", "length_m"],
        "outlet_volume_m3" => &["outlet_volume_m3", "length_m"],
        "volume_m3" => &["volume_m3"],
        "temperature_k" => &["temperature_k"],
        "pressure_drop_pa" => &["pressure_drop_pa"],
        "mass_flow_kg_s" => &["mass_flow_kg_s"],
        "exponent" => &["exponent"],
        "open_resistance_pa_s2_kg2" => {
            &["open_resistance_pa_s2_kg2", "resistance_pa_s2_kg2", "loss_coefficient"]
        }
        "leakage_opening" => &["leakage_opening", "seat_leak_kg_d"],
        "liquid_fraction" => &["liquid_fraction"],
        "separator_efficiency" => &["separator_efficiency"],
        "mass_fraction" => &["mass_fraction"],
        "capture_efficiency" => &["capture_efficiency"],
        "electrical" => &["electrical"],
        "engineering" => &["scale"],
        "wire" => &["wire"],
        "min" => &["min"],
        "max" => &["max", "min"],
        "max_rate_per_s" => &["max_rate_per_s"],
        "event_step" => &["event_step"],
        "filter_s" => &["filter_s"],
        "safe_value" => &["safe_value"],
        "safe_rate_per_s" => &["safe_rate_per_s"],
        "effective_area_m2" => &["discharge_coefficient", "leak_kg_d"],
        "reverse_pa_s_kg" => &["reverse_leak_kg_s"],
        "crack_pa" => &["crack_pa"],
        "reseat_pa" => &["reseat_pa"],
        "set_point_pa" => &["set_point_pa"],
        "band_pa" => &["band_pa"],
        "lag_s" => &["lag_s"],
        _ => &[],
    }
}

/// A refused parameter in words.
pub(crate) fn text(error: ParameterError) -> String {
    let reason = match error.reason {
        Reason::NotFinite => "must be finite in single precision",
        Reason::Negative => "must not be below 0",
        Reason::NotPositive => "must be above 0",
        Reason::NotAFraction => "must lie in 0 … 1",
        Reason::OutsideValidity => "lies outside the range for which its law is known",
        Reason::NotFalling => "does not make the head curve fall with flow",
    };
    let reason = match error.parameter {
        "gain" if error.reason == Reason::NotPositive => "must not be 0",
        "reseat_pa" if error.reason == Reason::OutsideValidity => "must lie below `crack_pa`",
        _ => reason,
    };
    format!("`{}` {reason}", keys_of(error.parameter).first().unwrap_or(&error.parameter))
}

/// Path of the table of segment `index`.
fn element_path(loaded: &Loaded, index: u32) -> String {
    let line = loaded.lines.iter().position(|line| {
        (line.first_segment..line.first_segment.saturating_add(line.segments)).contains(&index)
    });
    let line = line.unwrap_or(0);
    let first = loaded.lines.get(line).map_or(0, |line| line.first_segment);
    format!("line[{line}].element[{}]", index.saturating_sub(first))
}

/// Ties an error of the network's check to its place.
pub(crate) fn network(loaded: &Loaded, error: NetworkError, notes: &mut Notes) {
    let (path, keys, reason): (String, &[&str], String) = match error {
        NetworkError::Empty => (String::new(), &["node", "line"], "there is no node or no line".into()),
        NetworkError::Reference(error) => (String::new(), keys_of(error.parameter), text(error)),
        NetworkError::Node(index, error) => (format!("node[{index}]"), keys_of(error.parameter), text(error)),
        NetworkError::UnconnectedNode(index) => {
            (format!("node[{index}]"), &["id"], "no line reaches this node".into())
        }
        NetworkError::NoSuchNode(index) => {
            (format!("line[{index}]"), &["from", "to"], "names a node that does not exist".into())
        }
        NetworkError::Line(index, error) => (format!("line[{index}]"), keys_of(error.parameter), text(error)),
        NetworkError::LineWithoutLoss(index) => (
            format!("line[{index}]"),
            &["id"],
            "the line loses no pressure at any flow, so its flow has no value; give an element a loss".into(),
        ),
        NetworkError::Segment(index, error) => {
            (element_path(loaded, index), keys_of(error.parameter), text(error))
        }
        NetworkError::InputRange(index) | NetworkError::InputValue(index) => (
            element_path(loaded, index),
            &["opening", "speed"],
            "the start value of an input is out of its range".into(),
        ),
        NetworkError::Schedule(index) => {
            (format!("schedule[{index}]"), &["points"], "input, points or times do not fit".into())
        }
        // These follow from the tables that this crate builds and say that it built them wrong.
        NetworkError::SegmentRange(index) | NetworkError::FlowSegment(index) => {
            (format!("line[{index}]"), &[], format!("internal: {error}"))
        }
        NetworkError::ActiveList | NetworkError::ResponsiveList(_) | NetworkError::Plan(_) => {
            (String::new(), &["line"], format!("internal: {error}"))
        }
    };
    notes.refuse_at(&path, keys, reason);
}

/// Names nodes whose pressure nothing fixes, at the first of them.
pub(crate) fn floating(loaded: &Loaded, nodes: &[u32], notes: &mut Notes) {
    let ids: Vec<&str> = nodes.iter().map(|&node| loaded.names.nodes[node as usize].as_str()).collect();
    let path = format!("node[{}]", nodes.first().copied().unwrap_or(0));
    let span = notes.place(&path, &["kind"]);
    let reason =
        format!("nothing fixes the pressure of {}: no volume and no boundary among them", ids.join(", "));
    notes.refuse_with(span, reason, "give one of them a volume, or join them to a boundary");
}

/// Ties an error of the method's check to its place.
pub(crate) fn method(loaded: &Loaded, error: MethodError, notes: &mut Notes) {
    let run = &loaded.file.run;
    let (step, method) = (&run.step, &run.method);
    let (path, keys, reason, help): (String, &[&str], String, &str) = match error {
        MethodError::Step { longest_us } => (
            "run".into(),
            &["step", "method"],
            format!("step {step} is too long for method {method}, which takes up to {longest_us} µs"),
            "take a shorter step, or an implicit method",
        ),
        MethodError::NodeTooSmall(index) => (
            format!("node[{index}]"),
            &["volume_m3"],
            format!("too small for method {method} with step {step}"),
            "take a shorter step in [run], or join the volume with its neighbour",
        ),
        MethodError::Junction(index) => (
            format!("node[{index}]"),
            &["kind"],
            format!("method {method} takes no junction"),
            "give the node a volume, or take an implicit method in [run]",
        ),
        MethodError::TooMuchRemoved(index) => (
            format!("line[{index}]"),
            &["id"],
            format!("drains more than 11.8 % of its flow, too much for method {method}"),
            "take an implicit method, or split the line at a node",
        ),
        MethodError::PressureDifference(index) => (
            format!("line[{index}]"),
            &["from", "id"],
            format!("starts over more than 10 kPa, too much for the pseudo-time of method {method}"),
            "take another method in [run]",
        ),
        MethodError::Responsive(index) => (
            format!("line[{index}]"),
            &["density", "id"],
            format!("has laws that respond to pressures or density, which method {method} does not take"),
            "take `adaptive` or an implicit method in [run]",
        ),
        MethodError::SeveralBetweenNodes(index) => (
            format!("line[{index}]"),
            &["id"],
            format!(
                "has several elements that need the pressures at both their ends, method {method} takes one"
            ),
            "put a node between them, or take an implicit method in [run]",
        ),
        MethodError::NothingResists(index) => (
            element_path(loaded, index),
            &["id"],
            format!("has neither inertance nor a loss at rest, so method {method} finds no flow"),
            "give it a length, or its line a laminar limit",
        ),
        MethodError::Liquid(index) => (
            format!("node[{index}]"),
            &["kind"],
            format!("method {method} moves gas only, this node is liquid"),
            "take an implicit method in [run]",
        ),
        MethodError::Climate => (
            "run".into(),
            &["method"],
            format!("the flows of method {method} are pseudo-time; heat and moisture need physical ones"),
            "take adaptive or an implicit method in [run]",
        ),
        MethodError::Plan(error) => ("run".into(), &["method"], format!("internal: {error}"), ""),
    };
    let span = notes.place(&path, keys);
    notes.refuse_with(span, reason, help);
}

/// Names the bound that a step of `step_us` [µs] sets to a component's figures, where the core refused one.
pub fn bound_of_step(error: &ClimateError, step_us: u32) -> Option<String> {
    let step_ms = f64::from(step_us) * 1e-3;
    let bound = match *error {
        ClimateError::ComponentStep(_, StepBound { parameter, least, unit }) => {
            format!("`{parameter}` must be at least {least:.4} {unit}")
        }
        ClimateError::Conductance(_, most) => {
            format!("`inner_w_k` must be at most {most:.4} W/K in all walls of its node together")
        }
        _ => return None,
    };
    Some(format!("{bound} for a step of {step_ms} ms"))
}

/// Ties an error of the climate's check to its place.
pub(crate) fn climate(loaded: &Loaded, error: ClimateError, notes: &mut Notes) {
    let bound = bound_of_step(&error, loaded.run.step_us).unwrap_or_default();
    let part = |kind: &str, index: u32| format!("{kind}[{index}]");
    let component = |index: u32| loaded.climate.paths.get(index as usize).cloned().unwrap_or_default();
    let (path, keys, reason): (String, &[&str], String) = match error {
        ClimateError::Volume(index, ParameterError { parameter: "start_kg", .. }) => (
            part("node", index),
            &["pressure_pa", "volume_m3"],
            "holds nothing at the start: with `[air]` a volume must hold some air, which a network that comes to rest \
             in vacuum does not leave it"
                .into(),
        ),
        ClimateError::Volume(index, error) => {
            (part("node", index), &["volume_m3", "pressure_pa"], text(error))
        }
        ClimateError::Junction(index) => {
            (part("node", index), &["kind"], "has no volume for its contents".into())
        }
        ClimateError::Media(index) => {
            (part("line", index), &["from", "to"], "joins air and coolant, which do not mix".into())
        }
        ClimateError::GasLaw(index) => (
            part("line", index),
            &["density", "id"],
            "holds coolant: `orifice`, `leak`, `pressure_regulator` and a density that follows are laws of gases".into(),
        ),
        ClimateError::InnerVolume(index) => (
            element_path(loaded, index),
            &["outlet_volume_m3", "length_m"],
            "has a volume inside its line; with `[air]` volumes are nodes: set outlet_volume_m3 = 0".into(),
        ),
        ClimateError::Removal(index) => (
            element_path(loaded, index),
            &["liquid_fraction", "capture_efficiency"],
            "takes out a fixed share; with `[air]` use a condenser or a remover".into(),
        ),
        ClimateError::Component(index, error) => (component(index), &[error.parameter], text(error)),
        ClimateError::ComponentStep(index, error) => (component(index), &[error.parameter], bound),
        ClimateError::Conductance(index, _) => (component(index), &["inner_w_k"], bound),
        ClimateError::ComponentNode(index) => {
            let (path, reason) = (component(index), "has no volume of what it needs around it");
            (path, &["node", "id"], reason.into())
        }
        ClimateError::Sides(index) => (
            component(index),
            &["id"],
            "needs one side of its own and at most one coolant side, and behind it what it carries".into(),
        ),
        ClimateError::Passage(index) => {
            let segment = loaded.climate.passages.get(index as usize).map_or(0, |passage| passage.segment);
            (element_path(loaded, segment), &["kind"], "stands in a line of the wrong medium".into())
        }
        ClimateError::Loop(index, error) => (part("control", index), &[error.parameter], text(error)),
        ClimateError::LoopTarget(index) => (
            part("control", index),
            &["drives", "opposite"],
            "measures or drives what does not exist, or what something else drives already".into(),
        ),
        ClimateError::Input(slot) => {
            let name = loaded.names.inputs.get(slot as usize).cloned().unwrap_or_default();
            (String::new(), &["air"], format!("the start value of `{name}` is out of its range"))
        }
        ClimateError::Volumes | ClimateError::Table(_) => {
            (String::new(), &["air"], format!("internal: {error}"))
        }
    };
    notes.refuse_at(&path, keys, reason);
}
