//! Writes a network as Rust source: constant tables that a board keeps in flash.
//!
//! The shortest decimal form of an `f32` reads back as the same bits, so the tables are the loaded ones to the
//! bit, and so is the network id.

mod process;

use std::fmt::{Debug, Write as _};

use eclss_core::Method;

use crate::loaded::Loaded;

impl Loaded {
    /// Returns Rust source with the network as `static` tables, to be included into a module of its own.
    ///
    /// It offers `NETWORK`, `NETWORK_ID`, `NAME`, `METHOD`, `STEP_US`, `UNTIL_US`, `Configured` (the
    /// description and the file's settings as an [`eclss_core::Compiled`]), the tables (`NODES`, `LINES` and so
    /// on), the process image (`PROCESS`, `PROCESS_ID` and its channels with their names), `NODE_NAMES`, `LINE_NAMES`, `SEGMENT_NAMES`, `INPUT_NAMES`, and for every method the lengths of its
    /// buffers as a constant (`RELAXATION` and so on, `BUFFERS` for the file's own) of type
    /// [`eclss_core::Sizes`]:
    ///
    /// ```text
    /// #[allow(dead_code, unreachable_pub, clippy::unreadable_literal)] // generated
    /// mod network {
    ///     include!(concat!(env!("OUT_DIR"), "/network.rs"));
    /// }
    /// use network::BUFFERS as LENGTH;
    /// let mut storage =
    ///     Storage::<{ LENGTH.state }, { LENGTH.work }, { LENGTH.inputs }, { LENGTH.cursors }>::new();
    /// ```
    pub fn to_rust(&self) -> String {
        let mut text = String::new();
        text.push_str("// Generated from a network file; do not edit.\n\n");
        text.push_str(
            "#[allow(unused_imports)] // a network need not have channels\n\
             use ::eclss_core::process::{\n    Calibration, Curve, Hold, Image, InputChannel, Order, OutputChannel, \
             Port, Scaling,\n};\n\
             #[allow(unused_imports)] // nor schedules\n\
             use ::eclss_core::{\n    Active, Climate, Interpolation, Line, Method, Network, Node, NodeKind, Plan, Responsive, \
             Schedule, SchedulePoint, Segment,\n    AnyComponent, Output, Settings, Signal, Sizes,\n};\n",
        );
        if !self.climate.volumes.is_empty() {
            text.push_str(
                "#[allow(unused_imports)] // nor everything that a climate may have\n\
                 use ::eclss_core::{\n    climate::{Contents::*, ControlLoop, Volume},\n    \
                 component::{Passage, Placed, Range, Table},\n    control::{Actuator, Controller::*, Sensor},\n    \
                 fluid::Medium,\n};\n",
            );
        }
        self.write_constants(&mut text);
        self.write_tables(&mut text);
        self.write_plan(&mut text);
        self.write_climate(&mut text);
        self.write_network(&mut text);
        process::write(self, &mut text);
        text
    }

    fn write_constants(&self, text: &mut String) {
        let run = &self.run;
        let network = self.network();
        constant(text, "Name of the network.", "NAME", "&str", format!("{:?}", self.file.name));
        constant(text, "Network id.", "NETWORK_ID", "u64", format!("0x{:016x}", network.id()));
        constant(text, "Method of the file.", "METHOD", "Method", format!("Method::{:?}", run.method));
        constant(text, "Step of the file [µs].", "STEP_US", "u32", run.step_us);
        constant(text, "End of a run of the file [µs].", "UNTIL_US", "u64", run.until_us);
        for method in Method::ALL {
            let (name, sizes) = (method.name(), method.sizes(&network));
            let upper = name.to_uppercase().replace('-', "_");
            constant(text, &format!("Buffers that `{name}` needs."), &upper, "Sizes", format!("{sizes:?}"));
        }
        let own = format!("{:?}", run.method.sizes(&network));
        constant(text, "Buffers that the method of the file needs.", "BUFFERS", "Sizes", own);
    }

    fn write_tables(&self, text: &mut String) {
        table(text, "Nodes.", "NODES", "Node", &self.nodes, |node| {
            format!(
                "Node {{ kind: NodeKind::{:?}, start_gauge_pa: {:?}, temperature_k: {:?} }}",
                node.kind, node.start_gauge_pa, node.temperature_k
            )
        });
        table(text, "Lines.", "LINES", "Line", &self.lines, debug);
        table(text, "Segments of all lines.", "SEGMENTS", "Segment", &self.segments, |segment| {
            format!(
                "Segment {{ element: {}, inertance_per_m: {:?}, outlet_volume_m3: {:?}, first_input: {} }}",
                segment.element.source(),
                segment.inertance_per_m,
                segment.outlet_volume_m3,
                segment.first_input
            )
        });
        table(text, "Segments whose law changes.", "ACTIVE", "Active", &self.active, debug);
        let responsive = &self.responsive;
        table(text, "Lines whose laws respond.", "RESPONSIVE", "Responsive", responsive, debug);
        table(text, "Start values of the inputs.", "INPUTS", "f32", &self.inputs, debug);
        table(text, "Schedules.", "SCHEDULES", "Schedule", &self.schedules, |schedule| {
            format!(
                "Schedule {{ input: {}, first_point: {}, points: {}, interpolation: Interpolation::{:?} }}",
                schedule.input, schedule.first_point, schedule.points, schedule.interpolation
            )
        });
        table(text, "Points of all schedules.", "POINTS", "SchedulePoint", &self.points, debug);
        let names = &self.names;
        table(text, "Ids of the nodes.", "NODE_NAMES", "&str", &names.nodes, debug);
        table(text, "Ids of the lines.", "LINE_NAMES", "&str", &names.lines, debug);
        table(text, "Ids of the elements, one per segment.", "SEGMENT_NAMES", "&str", &names.segments, debug);
        table(text, "Names of the inputs.", "INPUT_NAMES", "&str", &names.inputs, debug);
    }

    fn write_plan(&self, text: &mut String) {
        let plan = &self.plan;
        let lists = [
            ("PLAN_END_START", &plan.end_start),
            ("PLAN_ENDS", &plan.ends),
            ("PLAN_ORDER", &plan.order),
            ("PLAN_ROW_START", &plan.row_start),
            ("PLAN_COLUMNS", &plan.columns),
            ("PLAN_DIAGONAL", &plan.diagonal),
            ("PLAN_ROW_OF", &plan.row_of),
            ("PLAN_COMPOSITE", &plan.composite),
        ];
        for (name, list) in lists {
            let _ = writeln!(text, "\nstatic {name}: [u32; {}] = {list:?};", list.len());
        }
        let _ =
            writeln!(text, "\nstatic PLAN_STAMPS: [[u32; 4]; {}] = {:?};", plan.stamps.len(), plan.stamps);
        let _ =
            writeln!(text, "\nstatic PLAN_LEAVES: [[u32; 2]; {}] = {:?};", plan.leaves.len(), plan.leaves);
        let _ = writeln!(text, "\nstatic PLAN_TERMS: [[u32; 3]; {}] = {:?};", plan.terms.len(), plan.terms);
        let _ =
            writeln!(text, "\nstatic PLAN_SERIES: [[u32; 9]; {}] = {:?};", plan.series.len(), plan.series);
        let _ =
            writeln!(text, "\nstatic PLAN_BETWEEN: [[u32; 2]; {}] = {:?};", plan.between.len(), plan.between);
    }

    fn write_climate(&self, text: &mut String) {
        let climate = &self.climate;
        if climate.volumes.is_empty() {
            return;
        }
        table(text, "What the nodes hold.", "VOLUMES", "Volume", &climate.volumes, debug);
        table(text, "Placed components.", "COMPONENTS", "Placed", &climate.components, debug);
        table(text, "Their kinds.", "TABLES", "Table", &climate.tables, |table| {
            format!("Table::new::<::{}>({:?})", table.kind().path(), table.range)
        });
        table(text, "Passages of streams.", "PASSAGES", "Passage", &climate.passages, debug);
        table(text, "Control loops.", "LOOPS", "ControlLoop", &climate.loops, control);
    }

    /// The field `climate` of the network.
    fn climate_field(&self) -> String {
        let climate = &self.climate;
        if climate.volumes.is_empty() {
            return "Climate::NONE".to_owned();
        }
        format!(
            "Climate {{\n            reference_k: {:?},\n            air: {:?},\n            coolant: {:?},\n            \
             volumes: &VOLUMES,\n            components: &COMPONENTS,\n            tables: &TABLES,\n            \
             passages: &PASSAGES,\n            loops: &LOOPS,\n        }}",
            climate.reference_k, climate.air, climate.coolant
        )
    }

    fn write_network(&self, text: &mut String) {
        let _ = write!(
            text,
            "\n/// The description with the method and step of the file, for a step specialised at compile time.\n\
             #[derive(Debug, Clone, Copy)]\n\
             pub struct Configured;\n\n\
             impl ::eclss_core::Compiled for Configured {{\n    \
                 type Element = AnyComponent;\n    \
                 const NETWORK: Network<'static> = Network {{\n        \
                     reference_pa: {:?},\n        nodes: &NODES,\n        lines: &LINES,\n        \
                     segments: &SEGMENTS,\n        active: &ACTIVE,\n        responsive: &RESPONSIVE,\n        \
                     inputs: &INPUTS,\n        \
                     schedules: &SCHEDULES,\n        points: &POINTS,\n        \
                     plan: Plan {{\n            \
                         end_start: &PLAN_END_START,\n            ends: &PLAN_ENDS,\n            \
                         order: &PLAN_ORDER,\n            row_start: &PLAN_ROW_START,\n            \
                         columns: &PLAN_COLUMNS,\n            diagonal: &PLAN_DIAGONAL,\n            \
                         stamps: &PLAN_STAMPS,\n            row_of: &PLAN_ROW_OF,\n            \
                         leaves: &PLAN_LEAVES,\n            terms: &PLAN_TERMS,\n            \
                         series: &PLAN_SERIES,\n            \
                         composite: &PLAN_COMPOSITE,\n            between: &PLAN_BETWEEN,\n        \
                     }},\n        climate: {},\n    }};\n    \
                 const SETTINGS: Settings = Settings {{ method: METHOD, step_us: STEP_US }};\n\
             }}\n\n\
             /// The description.\n\
             pub static NETWORK: Network<'static> = <Configured as ::eclss_core::Compiled>::NETWORK;\n",
            self.reference_pa,
            self.climate_field()
        );
    }
}

/// A control loop; the variants of a controller have the names of their contents, and infinity is no Rust number.
fn control(control: &eclss_core::climate::ControlLoop) -> String {
    format!("{control:?}")
        .replace("Pid(Pid {", "Pid(::eclss_core::control::Pid {")
        .replace("Thermostat(Thermostat {", "Thermostat(::eclss_core::control::Thermostat {")
        .replace(": inf", ": f32::INFINITY")
        .replace("{ output: ", "{ output: Output::")
}

fn constant(text: &mut String, about: &str, name: &str, kind: &str, value: impl std::fmt::Display) {
    let _ = write!(text, "\n/// {about}\npub const {name}: {kind} = {value};\n");
}

/// The derived `Debug` of the core's plain structs is their own Rust form.
fn debug(item: &impl Debug) -> String {
    format!("{item:?}")
}

fn table<T>(text: &mut String, about: &str, name: &str, kind: &str, items: &[T], one: impl Fn(&T) -> String) {
    let _ = write!(text, "\n/// {about}\npub static {name}: [{kind}; {}] = [", items.len());
    for item in items {
        let _ = write!(text, "\n    {},", one(item));
    }
    text.push_str(if items.is_empty() { "];\n" } else { "\n];\n" });
}
