//! Temperature and humidity control: the condenser beside its table, a day of a module, its ledgers.

use eclss_core::climate::Ledger;
use eclss_core::components::coil::Condenser;
use eclss_core::{Health, Settings};

use super::html::{Html, fixed, scientific};
use crate::plot::style::CYCLE;
use crate::plot::{Axis, Curve, Dash, Dots, Figure, Level, Mark, Panel, Point};
use crate::refusal::refused;
use crate::run::{Plan, Wishes};
use crate::{Failure, HostBuffers, Progress, Source};

#[allow(dead_code, reason = "the report takes what it shows of what the tests share")]
#[path = "../../../core/tests/support/effectiveness.rs"]
mod effectiveness;

use effectiveness::{AT_67_F, AT_75_F, Inlet, at_rest};

/// Air flows of the table [cfm].
const FLOWS_CFM: [f32; 9] = [50.0, 100.0, 150.0, 200.0, 250.0, 300.0, 350.0, 400.0, 450.0];
/// How a coil is brought to rest: steps, step [s].
const REST: (u32, f32) = (600, 1.0);
const CONDENSER: &str = "cargo test -p eclss-core --profile checked --test all condenser:: -- --nocapture";

const PATH: &str = "networks/thcs.toml";
const TEXT: &str = include_str!("../../../networks/thcs.toml");
/// Time between two points of a curve [s].
const EVERY_S: u64 = 60;

/// Panels of the day: title of the axis, curves by the ids of published values, factor and offset, and limits.
type Sheet = (&'static str, &'static [(&'static str, &'static str)], f64, f64, &'static [f64]);
const DAY: [Sheet; 6] = [
    (
        "temperature [°C]",
        &[
            ("cabin", "cabin.temperature"),
            ("cabin's dew point", "cabin.dew_point"),
            ("behind the condenser", "che.air_outlet"),
        ],
        1.0,
        -273.15,
        &[18.0, 27.0],
    ),
    ("relative humidity [%]", &[("cabin", "cabin.relative_humidity")], 100.0, 0.0, &[25.0, 75.0]),
    ("partial pressure of CO2 [kPa]", &[("cabin", "cabin.carbon_dioxide")], 1e-3, 0.0, &[0.4]),
    ("partial pressure of O2 [kPa]", &[("cabin", "cabin.oxygen")], 1e-3, 0.0, &[]),
    ("condensate [g/h]", &[("condenser", "che.condensate")], 3.6e6, 0.0, &[]),
    (
        "mass flow of air [g/s]",
        &[
            ("through the condenser", "che_way.mass_flow"),
            ("bypass", "bypass_way.mass_flow"),
            ("fan", "intake.mass_flow"),
        ],
        1e3,
        0.0,
        &[],
    ),
];

/// Runs and writes the section.
pub(super) fn write(page: &mut Html, day_s: u32, progress: &Progress) -> Result<(), Failure> {
    page.section("Temperature and humidity control");
    page.paragraph(
        "The condensing heat exchanger is counterflow in four cells with a wet wall. Three conductance figures are fitted \
         to the rows at 67 °F; the rows at 75 °F were not looked at. Table: SAE 2005-01-2801, through V-HAB; coolant \
         600 lb/h at 40 °F. The source does not say which effectiveness it is; the temperature reading fits better and \
         is used.",
    );
    let mut panels = Vec::new();
    for (air_f, rows, role) in [(67.0, &AT_67_F, "fitted"), (75.0, &AT_75_F, "not fitted")] {
        panels.push(condenser(page, air_f, rows, role));
    }
    let figure = Figure {
        title: "Effectiveness of the condensing heat exchanger".into(),
        panels,
        columns: 2,
        panel_size: (540, 400),
        remarks: vec!["Rings: printed. Lines: ours. Dew points in °F.".into()],
    };
    page.figure(&figure.svg(), "The same, drawn.", CONDENSER);
    progress.say("a day of a module");
    day(page, day_s)
}

/// Writes the table of one air temperature and returns its panel.
fn condenser(page: &mut Html, air_f: f32, rows: &[(f32, [f32; 9]); 4], role: &str) -> Panel {
    let title = format!("air at {air_f} °F, {role}");
    let x = Axis::linear("air flow [cfm]", 30.0, 470.0);
    let mut panel = Panel::new(&title, x, Axis::linear("effectiveness [1]", 0.5, 1.02));
    let (mut table, mut errors) = (Vec::new(), Vec::new());
    for ((dew_point_f, printed), colour) in rows.iter().zip(CYCLE) {
        let mut cells = std::array::from_fn::<String, 10, _>(|_| String::new());
        cells[0] = format!("{dew_point_f} °F");
        let mut ours = Vec::new();
        for ((cfm, printed), cell) in FLOWS_CFM.iter().zip(printed).zip(&mut cells[1..]) {
            let inlet = Inlet::of_table(air_f, *dew_point_f, *cfm);
            let found = at_rest(&Condenser::CCAA, inlet, REST.0, REST.1).by_temperature;
            errors.push(f64::from((found / printed - 1.0).abs()));
            *cell = format!("{printed:.3} / {found:.3}");
            ours.push((f64::from(*cfm), f64::from(found)));
        }
        table.push(cells);
        let points = FLOWS_CFM.iter().zip(printed).map(|(x, y)| ((f64::from(*x), f64::from(*y)), colour));
        panel.dots.push(Dots {
            label: String::new(),
            mark: Mark::Ring,
            radius: 3.6,
            points: points.collect(),
        });
        panel.curves.push(Curve::new(&format!("{dew_point_f}"), colour, Dash::Solid, ours));
    }
    let largest = errors.iter().copied().fold(0.0, f64::max) * 100.0;
    let mean = errors.iter().sum::<f64>() / errors.len() as f64 * 100.0;
    page.table(
        ["dew point", "50 cfm", "100", "150", "200", "250", "300", "350", "400", "450"],
        &table,
        &format!(
            "Effectiveness, printed (p) / ours (d), air at {air_f} °F, {role}: largest error {} %, mean {} %.",
            fixed(largest, 1),
            fixed(mean, 1)
        ),
        CONDENSER,
    );
    panel
}

/// Runs the day of the module and writes its curves and ledgers.
fn day(page: &mut Html, day_s: u32) -> Result<(), Failure> {
    let source = Source::built_in(TEXT, PATH)?;
    let settings =
        Settings { method: source.loaded.run.method, step_us: Plan::step_us(&source, &Wishes::default())? };
    let network = source.loaded.network();
    let mut buffers = HostBuffers::default();
    let mut simulator =
        buffers.simulator(&network, settings).map_err(|error| refused(&source, settings, &error))?;
    let signals = source.loaded.signals();
    let of = |id: &str| {
        let found = signals.iter().find(|named| named.name == id);
        let lost = || Failure::Failed(format!("{PATH} publishes no {id}"));
        found.map(|named| named.signal).ok_or_else(lost)
    };
    let mut sheets = Vec::new();
    for (_, curves, ..) in &DAY {
        let curves = curves.iter().map(|(_, id)| Ok((of(id)?, Vec::<Point>::new())));
        sheets.push(curves.collect::<Result<Vec<_>, Failure>>()?);
    }
    let until_us = u64::from(day_s) * 1_000_000;
    let every = (EVERY_S * 1_000_000).min(until_us / 10).max(u64::from(settings.step_us));
    while simulator.time_us() < until_us {
        if simulator.step() != Health::Trusted {
            return Err(Failure::Failed(format!("{PATH}: the run left its range")));
        }
        if simulator.time_us().is_multiple_of(every) {
            let hours = simulator.time_us() as f64 / 3.6e9;
            for ((signal, points), (_, _, factor, offset, _)) in
                sheets.iter_mut().zip(&DAY).flat_map(|(curves, sheet)| {
                    curves.iter_mut().map(move |(signal, points)| ((*signal, points), sheet))
                })
            {
                points.push((hours, f64::from(simulator.signal(signal)) * factor + offset));
            }
        }
    }
    let hours = f64::from(day_s) / 3600.0;
    let mut panels = Vec::new();
    for ((label, curves, _, _, limits), found) in DAY.iter().zip(sheets) {
        let all = found.iter().flat_map(|(_, points)| points.iter().map(|point| point.1));
        let all = all.chain(limits.iter().copied());
        let mut panel =
            Panel::new("", Axis::linear("time of day [h]", 0.0, hours), Axis::around(label, all, 0.01));
        panel.levels.extend(limits.iter().map(|limit| Level { value: *limit, label: String::new() }));
        for (((name, _), (_, points)), colour) in curves.iter().zip(found).zip(CYCLE) {
            panel.curves.push(Curve::new(name, colour, Dash::Solid, points));
        }
        panels.push(panel);
    }
    let figure = Figure {
        title: format!("A day of {PATH}"),
        panels,
        columns: 2,
        panel_size: (540, 300),
        remarks: vec![
            "Sleep until 7 h, exercise at 16 h, the fan fails for half an hour at 20 h, sleep from 23 h.".into(),
            "Levels: limits of NASA-STD-3001 vol. 2, quoted second hand; for CO2 it is that of an hour's mean.".into(),
        ],
    };
    let command = "eclss-rt run networks/thcs.toml";
    page.figure(
        &figure.svg(),
        "Four people, equipment, control of temperature, pressure and oxygen.",
        command,
    );
    let rows: Vec<_> = simulator.ledgers().iter().map(row).collect();
    page.table(
        ["ledger", "supplied", "turned over", "lacks", "lacks, of what was turned over"],
        &rows,
        &format!("Ledgers after {} h at {} ms.", fixed(hours, 1), f64::from(settings.step_us) * 1e-3),
        "eclss-rt run networks/thcs.toml",
    );
    Ok(())
}

fn row(ledger: &Ledger) -> [String; 5] {
    let part = ledger.gap().abs() / ledger.turned_over.max(f64::MIN_POSITIVE);
    let (unit, factor) = if ledger.unit == "J" { ("MJ", 1e-6) } else { (ledger.unit, 1.0) };
    [
        ledger.name.replace('_', " "),
        format!("{} {unit}", fixed(ledger.supplied * factor, 4)),
        format!("{} {unit}", fixed(ledger.turned_over * factor, 4)),
        format!("{} {unit}", scientific(ledger.gap() * factor, 1)),
        if ledger.turned_over > 0.0 { scientific(part, 1) } else { "nothing moved".into() },
    ]
}
