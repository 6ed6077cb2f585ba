//! Tables of figures as Markdown: written, read back, compared.

use std::fmt::Write as _;

/// A table under a heading. Figures grow only when someone writes the table anew.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Table {
    /// Heading.
    pub(crate) title: String,
    /// What stands above the table.
    pub(crate) about: String,
    /// Names of the columns; the first [`Self::keys`] of them name a row.
    pub(crate) columns: Vec<String>,
    /// How many columns name a row.
    pub(crate) keys: usize,
    /// Cells.
    pub(crate) rows: Vec<Vec<String>>,
}

/// How much a figure may grow unseen [1].
pub(crate) const TOLERANCE: f64 = 0.02;
/// The same where another compiler built the programs: what it does to one figure or another is not ours.
pub(crate) const OTHER_COMPILER: f64 = 0.15;
/// Columns that are shown but not judged: how much was measured, and shares of a sum that is judged itself.
const SHOWN: [&str; 8] = ["steps", "equations", "laws", "margin", "schedule", "ledger", "health", "rest"];
/// Longest line of text.
const WIDTH: usize = 110;
/// Verdict on a bar that is not reached.
pub(crate) const MISSED: &str = "missed";

impl Table {
    /// Makes an empty table; the first `keys` columns name a row.
    pub(crate) fn new(title: &str, about: &str, keys: usize, columns: &[&str]) -> Self {
        let columns = columns.iter().map(|column| (*column).to_owned()).collect();
        Self { title: title.into(), about: about.into(), columns, keys, rows: Vec::new() }
    }

    /// Writes heading, text and table.
    pub(crate) fn write(&self, text: &mut String) {
        let about = wrapped(&self.about);
        let _ = write!(text, "\n## {}\n\n{about}\n\n| {} |\n", self.title, self.columns.join(" | "));
        for index in 0..self.columns.len() {
            text.push_str(if index < self.keys { "|---" } else { "|---:" });
        }
        text.push_str("|\n");
        for row in &self.rows {
            let _ = writeln!(text, "| {} |", row.join(" | "));
        }
    }

    /// The cells of a row that name it.
    fn key<'r>(&self, row: &'r [String]) -> &'r [String] {
        &row[..self.keys.min(row.len())]
    }
}

/// Breaks text into lines.
fn wrapped(text: &str) -> String {
    let mut lines = vec![String::new()];
    for word in text.split_whitespace() {
        let line = lines.last_mut().filter(|line| line.chars().count() + 1 + word.chars().count() <= WIDTH);
        match line {
            Some(line) if line.is_empty() => line.push_str(word),
            Some(line) => line.extend([" ", word]),
            None => lines.push(word.to_owned()),
        }
    }
    lines.join("\n")
}

/// Reads the tables of a document: title, columns and rows.
pub(crate) fn read(text: &str) -> Vec<Table> {
    let mut tables: Vec<Table> = Vec::new();
    for line in text.lines() {
        if let Some(title) = line.strip_prefix("## ") {
            tables.push(Table { title: title.into(), ..Table::default() });
        }
        let (Some(table), Some(cells)) = (tables.last_mut(), line.strip_prefix("| ")) else { continue };
        let cells = cells.trim_end_matches(" |").split(" | ").map(str::to_owned).collect();
        if table.columns.is_empty() { table.columns = cells } else { table.rows.push(cells) }
    }
    tables
}

/// What has become worse between the recorded tables and today's, one sentence each: figures that grew by more than
/// `tolerance` [1], and bars that are no longer met, unless the figure behind them may grow.
pub(crate) fn worse(recorded: &[Table], today: &[Table], tolerance: f64) -> Vec<String> {
    let mut found = Vec::new();
    for table in today {
        let Some(old) = recorded.iter().find(|old| old.title == table.title) else {
            found.push(format!("{}: not in the document", table.title));
            continue;
        };
        for row in &table.rows {
            let key = table.key(row);
            let name = format!("{}, {}", table.title, key.join(", "));
            let Some(before) = old.rows.iter().find(|before| table.key(before) == key) else {
                found.push(format!("{name}: not in the document"));
                continue;
            };
            for (index, column) in table.columns.iter().enumerate().skip(table.keys) {
                let was = old.columns.iter().position(|old| old == column).and_then(|at| before.get(at));
                let reason = was.map_or(Some("is new".into()), |was| grown(was, &row[index], tolerance));
                if let Some(reason) = reason.filter(|_| !SHOWN.contains(&column.as_str())) {
                    found.push(format!("{name}: {column} {reason}"));
                }
            }
        }
    }
    found
}

/// Why a cell is worse than it was.
fn grown(was: &str, is: &str, tolerance: f64) -> Option<String> {
    if let (Ok(was), Ok(is)) = (was.parse::<f64>(), is.parse::<f64>()) {
        // Not by their ratio, of which 1020 / 1000 is a rounding above 1.02.
        return (is > was && is - was > tolerance * was)
            .then(|| format!("grew from {was} to {is} ({:+.1} %)", 100.0 * (is / was - 1.0)));
    }
    (is == MISSED && was != MISSED && tolerance <= TOLERANCE).then(|| "is missed".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(figure: &str, verdict: &str) -> Table {
        let mut table = Table::new("Steps", "What they cost.", 1, &["method", "steps", "mean", "verdict"]);
        table.rows.push(["relaxation", "100", figure, verdict].map(str::to_owned).to_vec());
        table
    }

    fn verdict(was: &Table, is: &Table) -> Vec<String> {
        let mut text = String::from("# Budgets\n");
        was.write(&mut text);
        worse(&read(&text), std::slice::from_ref(is), TOLERANCE)
    }

    #[test]
    fn a_figure_may_fall_and_hardly_grow() {
        let was = table("1000", "met");
        assert_eq!(verdict(&was, &table("1020", "met")), [""; 0]);
        assert_eq!(verdict(&was, &table("5", "met")), [""; 0]);
        assert_eq!(
            verdict(&was, &table("1021", "met")),
            ["Steps, relaxation: mean grew from 1000 to 1021 (+2.1 %)"]
        );
    }

    #[test]
    fn another_compiler_may_take_more_but_not_anything() {
        let (was, mut text) = (table("1000", "met"), String::new());
        was.write(&mut text);
        let told = |is: &str| worse(&read(&text), &[table(is, MISSED)], OTHER_COMPILER).len();
        assert_eq!((told("1150"), told("1151")), (0, 1));
    }

    #[test]
    fn what_is_new_or_no_longer_met_is_told() {
        let was = table("1000", "met");
        assert_eq!(verdict(&was, &table("1000", MISSED)), ["Steps, relaxation: verdict is missed"]);
        assert_eq!(verdict(&table("1000", MISSED), &table("1000", MISSED)), [""; 0]);
        let mut other = table("1000", "met");
        other.rows[0][0] = "adaptive".into();
        assert_eq!(verdict(&was, &other), ["Steps, adaptive: not in the document"]);
        assert_eq!(worse(&[], &[was], TOLERANCE), ["Steps: not in the document"]);
    }
}
