//! The whole validation as one HTML file that opens from disk: figures, tables, budgets, costs, conservation.
//!
//! Whatever can be computed in a minute or two is computed when the report is made; what takes other people's solvers or an
//! emulator is taken from the project's documents. Each figure and each table names the command that makes it.

mod climate;
mod conservation;
mod cost;
mod documents;
mod drawings;
mod experiment;
mod hardware;
mod html;
mod maps;
mod transients;

use crate::{Failure, Progress, Source};

pub use html::Html;

/// What goes into a report.
#[derive(Debug, Clone)]
pub struct Contents {
    /// Equations of the chains whose cost is measured.
    pub sizes: Vec<usize>,
    /// Plant time of the ledgers [s].
    pub ledger_s: u32,
    /// Plant time of the day of a module [s].
    pub day_s: u32,
    /// Openings and steps of a stability map.
    pub map: (usize, usize),
}

impl Contents {
    /// Everything, as it is promised.
    pub fn whole() -> Self {
        Self { sizes: eclss_bench::PAPER_SIZES.to_vec(), ledger_s: 600, day_s: 86_400, map: (50, 25) }
    }
}

/// Computes everything and returns the page.
pub fn report(contents: &Contents, progress: &Progress) -> Result<String, Failure> {
    // What this program was built with: a report is about a version, not about what lies in some folder.
    let source = Source::shipped()?;
    let mut page = Html::new("eclss-rt: validation");
    page.paragraph(&format!(
        "Version {}. Everything below is computed by the program when this file is made, except where a document of \
         the project is quoted. (p) is printed in the paper: {}. (d) is derived here: the paper's parameters were not \
         printed; those of networks/paper.toml were chosen, or fitted to the two flows by AMESim, and its file says \
         which.",
        env!("CARGO_PKG_VERSION"),
        crate::paper::printed::SOURCE
    ));
    page.contents();
    experiment::write(&mut page, &source, progress)?;
    progress.say("stability maps");
    maps::write(&mut page, &source, contents.map)?;
    progress.say("physical transients");
    transients::write(&mut page)?;
    progress.say("condenser");
    climate::write(&mut page, contents.day_s, progress)?;
    hardware::write(&mut page);
    progress.say("ledgers");
    conservation::write(&mut page, contents.ledger_s)?;
    progress.say("costs");
    cost::write(&mut page, &contents.sizes)?;
    drawings::write(&mut page)?;
    documents::write(&mut page);
    Ok(page.finish())
}
