//! Hardware in the loop: how strongly hardware may load a volume, by delay, hold and filter.

use eclss_core::Method;

use super::html::{Html, fixed};
use crate::coupling::{Loop, mean_over_step};
use crate::plot::style::CYCLE;
use crate::plot::{Axis, Curve, Dash, Figure, Panel, Point};

/// Longest delay of the table [ticks].
const TICKS: u32 = 10;
const COMMAND: &str =
    "eclss-rt check NETWORK.toml --hil; cargo test -p eclss-host-sim --profile checked --test all coupling::";

/// Names, method, whether the hold goes on along a line, and the filter's time over the step.
const WAYS: [(&str, Method, bool, f64); 5] = [
    ("adaptive, zero hold", Method::Adaptive, false, 0.0),
    ("tr-bdf2, zero hold", Method::TrBdf2, false, 0.0),
    ("tr-bdf2, linear hold", Method::TrBdf2, true, 0.0),
    ("implicit-euler, linear hold", Method::ImplicitEuler, true, 0.0),
    ("tr-bdf2, zero hold, filter of 5 steps", Method::TrBdf2, false, 5.0),
];

/// Writes the section.
pub(super) fn write(page: &mut Html) {
    page.section("Hardware in the loop: delay limits");
    page.paragraph(
        "A volume gives out its pressure, hardware answers with a flow some ticks later. With h the step, c the volume's \
         rise of pressure with mass and G the hardware's conductance the loop is stable while h·c·G stays below the \
         limit of its delay. How the bits of a run, its link, its latency and its inputs are held, follows below from \
         the document on hosts.",
    );
    let limit = |ticks: u32, (_, method, linear, filter): (&str, Method, bool, f64)| {
        Loop { ticks, filter, mean: mean_over_step(method, linear) }.limit()
    };
    let rows: Vec<_> = (1..=TICKS)
        .map(|ticks| {
            let mut cells = std::array::from_fn::<String, 6, _>(|_| ticks.to_string());
            for (cell, way) in cells[1..].iter_mut().zip(WAYS) {
                *cell = fixed(limit(ticks, way), 4);
            }
            cells
        })
        .collect();
    let [a, b, c, d, e] = WAYS.map(|way| way.0);
    page.table(
        ["delay [ticks]", a, b, c, d, e],
        &rows,
        "Largest h·c·G with which the loop is stable. That of adaptive is 2·sin(π/(2·(2d + 1))).",
        COMMAND,
    );
    let mut panel = Panel::new(
        "",
        Axis::linear("delay [ticks]", 0.5, f64::from(TICKS) + 0.5),
        Axis::logarithmic("largest h·c·G [1]", 0.05, 2.0),
    );
    for ((way, colour), dash) in
        WAYS.into_iter().zip(CYCLE).zip([Dash::Solid, Dash::Solid, Dash::Dashed, Dash::Dashed, Dash::Dotted])
    {
        let points: Vec<Point> = (1..=TICKS).map(|ticks| (f64::from(ticks), limit(ticks, way))).collect();
        panel.curves.push(Curve::new(way.0, colour, dash, points));
    }
    let figure = Figure {
        title: "How strongly hardware may load a volume".into(),
        panels: vec![panel],
        columns: 1,
        panel_size: (900, 360),
        remarks: vec![
            "Below its line a loop comes to rest, above it it diverges. Losses of the plant only damp it."
                .into(),
        ],
    };
    page.figure(&figure.svg(), "The same, drawn.", COMMAND);
}
