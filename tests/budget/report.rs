//! The document: one table for each question.

use std::path::Path;

use eclss_core::Method;

use crate::emulator::{MACHINES, elf, memory};
use crate::figures::{Figure, firmware, measure};
use crate::table::{MISSED, Table};
use crate::trace::{Part, Step, steps};

/// The machine whose program is traced: both run the same one.
const TRACED: &str = "mps2-an386";
/// The method of `networks/thcs.toml`.
const DAY_METHOD: &str = "implicit-euler";
/// A step that is counted and one that is traced may differ by how they are called [instructions]: they are two programs, and
/// the compiler keeps other registers over the call (the largest difference seen is ten).
const CALLING: u32 = 12;

/// What was measured.
pub(crate) struct Report {
    /// The compiler that built the programs.
    pub(crate) compiler: String,
    /// Tables of the document.
    pub(crate) tables: Vec<Table>,
    /// Places where two ways of measuring do not agree.
    pub(crate) disagreements: Vec<String>,
}

const HEAD: &str = "# Budgets

What a step costs, counted. `cargo xtask budget` measures and writes this document; `cargo xtask budget --check`,
a part of `cargo xtask test`, fails when a figure has grown by more than 2 % or a bar is no longer met. Another
compiler than the one named below makes other code of the same source: with it, 15 % are allowed.

Instructions are counted by QEMU under `-icount`, exactly and the same in every run. The paper's valve scenario
is 26 s at 1 ms: open, closing within one second to 2 %, and closed. *Compiled in* is the step specialised for a
network that is known when the firmware is built, *loaded* the step of a network that arrives at run time. Plain
Euler diverges while the valve closes; its steps are counted up to there. Both emulated boards run the same
program, and every instruction of it takes as long on one as on the other.
";

/// Measures everything; `folder` takes the traces.
pub(crate) fn make(folder: &Path) -> Report {
    let boards = MACHINES.map(|machine| (machine, measure(machine)));
    let traces = Method::ALL.map(|method| (method, steps(TRACED, method.name(), folder)));
    let ticks = MACHINES.map(|machine| (machine, firmware(machine)));
    let traced = boards.iter().find(|(machine, _)| *machine == TRACED).map_or([].as_slice(), |(_, all)| all);
    let disagreements = disagreements(traced, &traces);
    let tables = vec![
        bars(&boards, &traces),
        scenario(&boards),
        parts(&traces),
        day(&boards),
        laws(&boards),
        link(&boards),
        large(&boards),
        cycles(&traces),
        whole_tick(&ticks),
        memories(&ticks),
    ];
    let compiler = std::env::var("ECLSS_COMPILER").unwrap_or_else(|_| "unknown".into());
    Report { compiler, tables, disagreements }
}

impl Report {
    /// The document.
    pub(crate) fn text(&self) -> String {
        let mut text = format!("{HEAD}\nCompiler: {}\n", self.compiler);
        self.tables.iter().for_each(|table| table.write(&mut text));
        text
    }
}

fn find<'f>(figures: &'f [Figure], kind: &str, name: &str) -> &'f Figure {
    let found = figures.iter().find(|figure| figure.kind == kind && figure.name == name);
    found.unwrap_or_else(|| panic!("{kind} {name} was not measured"))
}

/// Mean over steps.
fn mean(steps: &[Step], figure: impl Fn(&Step) -> u32) -> f64 {
    steps.iter().map(|step| f64::from(figure(step))).sum::<f64>() / steps.len() as f64
}

/// What the method itself does: its equations with the laws they need and the margin they report.
fn method_alone(step: &Step) -> u32 {
    [Part::Equations, Part::Laws, Part::Margin].iter().map(|part| step.parts[*part as usize]).sum()
}

fn bars(boards: &[(&str, Vec<Figure>)], traces: &[(Method, Vec<Step>)]) -> Table {
    let about = "What was promised. The first two are of the paper's loop, compiled in: the method with its laws and \
                 margin, without schedule, ledger, range check and clock, which the tables below show.";
    let mut table = Table::new("Bars", about, 1, &["what", "most", "bar", "verdict"]);
    let mut add = |what: String, most: f64, bar: f64, digits: usize| {
        let verdict = if most <= bar { "met" } else { MISSED };
        table.rows.push(vec![what, format!("{most:.digits$}"), format!("{bar}"), verdict.into()]);
    };
    for (method, bar) in [(Method::Relaxation, 300.0), (Method::TrBdf2, 2_500.0)] {
        let steps = &traces.iter().find(|(traced, _)| *traced == method).expect("all are traced").1;
        let most = steps.iter().map(method_alone).max().unwrap_or(0);
        add(format!("{}, method alone [instructions]", method.name()), f64::from(most), bar, 0);
    }
    for (machine, figures) in boards {
        for (kind, method, bar) in
            [("chain-1100", "relaxation", 25_000.0), ("general-550", "adaptive", 66_000.0)]
        {
            let most = f64::from(find(figures, kind, method).max);
            add(format!("{method}, {kind}, whole step on {machine} [instructions]"), most, bar, 0);
        }
        let day = find(figures, "thcs", DAY_METHOD);
        let what = "temperature and humidity control, whole step";
        add(format!("{what} on {machine} [instructions]"), f64::from(day.max), 12_000.0, 0);
        add(format!("{what}, largest over mean on {machine} [1]"), day.spread(), 1.05, 3);
        for method in Method::ALL {
            let spread = find(figures, "paper", method.name()).spread();
            add(format!("{}, largest over mean on {machine} [1]", method.name()), spread, 1.05, 3);
        }
    }
    table
}

fn scenario(boards: &[(&str, Vec<Figure>)]) -> Table {
    let about = "Whole steps of the paper's loop over the valve scenario, with schedule, laws, margin, ledger and range check \
                 [instructions].";
    let columns = ["board", "method", "network", "steps", "min", "mean", "max", "max/mean"];
    let mut table = Table::new("A step of the paper's loop", about, 3, &columns);
    for (machine, figures) in boards {
        for method in Method::ALL {
            for (kind, network) in [("paper", "compiled in"), ("paper-loaded", "loaded")] {
                let figure = find(figures, kind, method.name());
                let mut row = [*machine, method.name(), network].map(str::to_owned).to_vec();
                row.extend(figure_cells(figure, true));
                table.rows.push(row);
            }
        }
    }
    table
}

fn day(boards: &[(&str, Vec<Figure>)]) -> Table {
    let about = "Whole steps of `networks/thcs.toml` (7 volumes, 8 lines, a condenser of 12 walls, 4 control loops) with its \
                 method and its day of sleep, work, exercise and a failed fan a thousand times as fast: schedule, control, \
                 flows, heat, moisture, composition and all ledgers [instructions].";
    let columns = ["board", "network", "steps", "min", "mean", "max", "max/mean"];
    let mut table = Table::new("A step of temperature and humidity control", about, 2, &columns);
    for (machine, figures) in boards {
        for (kind, network) in [("thcs", "compiled in"), ("thcs-loaded", "loaded")] {
            let mut row = [*machine, network].map(str::to_owned).to_vec();
            row.extend(figure_cells(find(figures, kind, DAY_METHOD), true));
            table.rows.push(row);
        }
    }
    table
}

fn figure_cells(figure: &Figure, steps: bool) -> Vec<String> {
    let mut cells = vec![
        figure.min.to_string(),
        format!("{:.0}", figure.mean),
        figure.max.to_string(),
        format!("{:.3}", figure.spread()),
    ];
    if steps {
        cells.insert(0, figure.samples.to_string());
    }
    cells
}

fn parts(traces: &[(Method, Vec<Step>)]) -> Table {
    let about = "Mean over the same scenario run a thousand times as fast, compiled in, from a trace of every instruction and \
                 the source line that it comes from [instructions]. The compiler mixes lines, so that a part is \
                 sharp to a few instructions; the sum is exact.";
    let mut columns = vec!["method"];
    columns.extend(Part::ALL.map(|(_, name)| name));
    columns.extend(["method alone", "whole step"]);
    let mut table = Table::new("Where they go", about, 1, &columns);
    for (method, steps) in traces {
        let mut row = vec![method.name().to_owned()];
        row.extend(
            Part::ALL.map(|(part, _)| format!("{:.0}", mean(steps, |step| step.parts[part as usize]))),
        );
        row.push(format!("{:.0}", mean(steps, method_alone)));
        row.push(format!("{:.0}", mean(steps, Step::instructions)));
        table.rows.push(row);
    }
    table
}

fn laws(boards: &[(&str, Vec<Figure>)]) -> Table {
    let about = "One evaluation of a component's law over inputs from shut to overspeed, flows both ways and outlets \
                 from vacuum to reverse, with the choice among components and the call [instructions].";
    let mut table =
        Table::new("Component laws", about, 2, &["component", "board", "min", "mean", "max", "max/mean"]);
    for (machine, figures) in boards {
        for figure in figures.iter().filter(|figure| figure.kind == "law") {
            let mut row = vec![figure.name.clone(), (*machine).to_owned()];
            row.extend(figure_cells(figure, false));
            table.rows.push(row);
        }
    }
    table
}

fn link(boards: &[(&str, Vec<Figure>)]) -> Table {
    let about = "What hardware in the loop adds to a tick, by number of channels each way: a frame received and judged \
                 (COBS, check sum, packet, sequence), a frame sent, all inputs judged, filtered and applied, all outputs \
                 limited [instructions].";
    let columns = ["what and channels", "board", "min", "mean", "max", "max/mean"];
    let mut table = Table::new("The link and the process image", about, 2, &columns);
    for (machine, figures) in boards {
        for figure in figures.iter().filter(|figure| figure.kind == "link") {
            let mut row = vec![figure.name.clone(), (*machine).to_owned()];
            row.extend(figure_cells(figure, false));
            table.rows.push(row);
        }
    }
    table
}

fn large(boards: &[(&str, Vec<Figure>)]) -> Table {
    let about = "The paper's largest size, whole steps of networks that are loaded, over the closing of a valve [instructions]: \
                 a chain of 1 099 pipes and a valve (1 100 equations), and 550 nodes with 550 lines in a random tree closed by a fan and \
                 a valve.";
    let columns = ["network", "method", "board", "steps", "min", "mean", "max", "max/mean"];
    let mut table = Table::new("Large networks", about, 3, &columns);
    for (machine, figures) in boards {
        for (kind, method) in [("chain-1100", "relaxation"), ("general-550", "adaptive")] {
            let mut row = vec![kind.to_owned(), method.to_owned(), (*machine).to_owned()];
            row.extend(figure_cells(find(figures, kind, method), true));
            table.rows.push(row);
        }
    }
    table
}

fn cycles(traces: &[(Method, Vec<Step>)]) -> Table {
    let about = "An estimate for a Cortex-M4F from the same trace with the core's published timing (Arm DDI 0439, tables 3-1 \
                 and 7-1), at the upper end of every range: memory without wait states, 3 cycles behind a taken branch, loads \
                 and stores that never overlap, 14 cycles for a division or a root, 12 for a division of integers, one more where \
                 a floating-point result is used at once. Real boards count cycles themselves (DWT) and log them; \
                 none has run yet.";
    let columns = ["method", "mean cycles", "most cycles", "cycles per instruction", "Cortex-M7 at 480 MHz"];
    let mut table = Table::new("Cycles", about, 1, &columns);
    for (method, steps) in traces {
        let cycles = mean(steps, |step| step.cycles);
        let most = steps.iter().map(|step| step.cycles).max().unwrap_or(0);
        let ratio = cycles / mean(steps, Step::instructions);
        let figures =
            [format!("{cycles:.0}"), most.to_string(), format!("{ratio:.2}"), "not measured".into()];
        table.rows.push([vec![method.name().to_owned()], figures.to_vec()].concat());
    }
    table
}

fn whole_tick(ticks: &[(&str, ([f64; 3], u64))]) -> Table {
    let about = "From reading inputs to having written outputs, in the firmware with the paper's loop and its file's method, over \
                 the scenario [instructions, to within two]. A tick of 1 ms has 31 250.";
    let mut table = Table::new("A whole tick", about, 1, &["board", "min", "mean", "max"]);
    for (machine, (figures, _)) in ticks {
        let mut row = vec![format!("qemu-{machine}")];
        row.extend(figures.map(|figure| format!("{figure:.0}")));
        table.rows.push(row);
    }
    table.rows.push([vec!["nucleo-h743zi2".to_owned()], vec!["not measured".to_owned(); 3]].concat());
    table
}

fn memories(ticks: &[(&str, ([f64; 3], u64))]) -> Table {
    let about = "The firmware with the paper's loop [bytes]. The stack is painted at start-up and looked at after the run; what \
                 no board has run is not measured.";
    let mut table = Table::new("Memory", about, 1, &["board", "flash", "statics", "worst stack"]);
    for (machine, (_, stack)) in ticks {
        table.rows.push(memory_row(&format!("qemu-{machine}"), stack.to_string()));
    }
    table.rows.push(memory_row("nucleo-h743zi2", "not measured".into()));
    table
}

fn memory_row(board: &str, stack: String) -> Vec<String> {
    let (flash, ram) = memory(&elf(board));
    vec![board.to_owned(), flash.to_string(), ram.to_string(), stack]
}

/// Counting by the clock and by the trace must find the same steps while the valve is open. Later ones differ in
/// how far the valve moves in a step, and in what the compiler makes of the schedule's times.
fn disagreements(counted: &[Figure], traces: &[(Method, Vec<Step>)]) -> Vec<String> {
    const OPEN: usize = 10;
    let mut found = Vec::new();
    for (method, steps) in traces {
        let figure = find(counted, "paper", method.name());
        let range = figure.min.saturating_sub(CALLING)..=figure.max + CALLING;
        let counts = steps.iter().take(OPEN).map(Step::instructions);
        found.extend(counts.filter(|count| !range.contains(count)).map(|count| {
            let (name, min, max) = (method.name(), figure.min, figure.max);
            format!("{name}: a traced step has {count} instructions, counted were {min}…{max}")
        }));
        // Plain Euler ends where it diverges, at the latest when the valve is shut.
        let expected = if *method == Method::Euler { 10..=26 } else { 26..=26 };
        if !expected.contains(&steps.len()) {
            found.push(format!("{}: {} steps were traced instead of 26", method.name(), steps.len()));
        }
    }
    found
}
