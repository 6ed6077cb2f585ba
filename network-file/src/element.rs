//! Components of a line: from the entry of the file to the core's parameters.
//!
//! Derived parameters are computed in `f64` by the component itself and rounded once, so that a file gives the same
//! bits on every machine.

use std::fmt::Arguments;

use eclss_core::AnyComponent;
use eclss_core::component::{FileTable, LineFacts};
use eclss_core::parameter::KeyType;

use crate::document::{ElementEntry, Entry};
use crate::limits::{self, Range};
use crate::notes::Notes;
use crate::number::single;

/// One component of a line while it is converted.
pub(crate) struct Conversion<'a> {
    pub(crate) notes: &'a mut Notes,
    pub(crate) entry: &'a ElementEntry,
    /// Path of its table.
    pub(crate) path: &'a str,
    /// The line around it; the area is the component's own.
    pub(crate) line: LineFacts,
    /// Whether the outlet is the line's end, whose volume is the node's.
    pub(crate) last: bool,
}

/// The keys of an entry as the component reads them.
pub(crate) struct Keys<'a> {
    pub(crate) notes: &'a mut Notes,
    pub(crate) entry: &'a Entry,
    pub(crate) path: &'a str,
}

impl FileTable for Keys<'_> {
    fn number(&self, key: &str) -> Option<f64> {
        self.entry.number(key)
    }

    fn flag(&self, key: &str) -> Option<bool> {
        self.entry.flag(key)
    }

    fn choice(&self, key: &str) -> Option<usize> {
        let word = self.entry.text(key)?;
        let key = self.entry.kind.keys().iter().copied().flatten().find(|known| known.name == key)?;
        let KeyType::Choice(words) = key.holds else { return None };
        words.iter().position(|known| *known == word)
    }

    fn refuse(&mut self, key: &'static str, reason: Arguments<'_>) {
        self.notes.refuse_at(self.path, &[key], reason.to_string());
    }
}

/// Flow area [m²] from diameter or area.
fn area(entry: &ElementEntry) -> Option<f64> {
    let round = |diameter: f64| core::f64::consts::FRAC_PI_4 * diameter * diameter;
    entry.area_m2.or(entry.diameter_m.map(round))
}

impl Conversion<'_> {
    /// Returns component, inertance [1/m] and outlet volume [m³]. Findings are in the notes.
    pub(crate) fn convert(&mut self) -> (AnyComponent, f32, f32) {
        let entry = &self.entry.entry;
        let mut keys = Keys { notes: self.notes, entry, path: self.path };
        let line = LineFacts { area_m2: area(self.entry), ..self.line };
        let component = entry.kind.read(&mut keys, line);
        let (inertance, volume) = self.column();
        (component, inertance, volume)
    }

    /// Inertance L/A and outlet volume L·A of the fluid column.
    fn column(&mut self) -> (f32, f32) {
        let entry = self.entry;
        let area = area(self.entry);
        if let (Some(_), Some(_)) = (entry.diameter_m, entry.area_m2) {
            self.refuse("area_m2", "give the cross-section once: as `diameter_m` or as `area_m2`");
        }
        if let (Some(_), Some(_)) = (entry.length_m, entry.inertance_per_m) {
            self.refuse("inertance_per_m", "give the inertance once: as `length_m` or as `inertance_per_m`");
        }
        let needed = entry.length_m.is_some_and(|length| length > 0.0);
        if needed && area.is_none() {
            self.refuse("length_m", "`length_m` needs a `diameter_m` or an `area_m2`");
        }
        let (length, area) = (entry.length_m.unwrap_or(0.0), area.unwrap_or(1.0));
        let inertance = entry.inertance_per_m.unwrap_or(length / area);
        let inside = if self.last { 0.0 } else { length * area };
        let volume = entry.outlet_volume_m3.unwrap_or(inside);
        let key = if entry.inertance_per_m.is_some() { "inertance_per_m" } else { "length_m" };
        let inertance = self.fit(key, inertance, &limits::INERTANCE);
        let key = if entry.outlet_volume_m3.is_some() { "outlet_volume_m3" } else { "length_m" };
        (inertance, self.fit(key, volume, &limits::OUTLET_VOLUME))
    }

    /// Rounds a derived parameter and checks its range.
    fn fit(&mut self, key: &str, value: f64, range: &Range) -> f32 {
        match single(value) {
            Some(rounded) if range.values.contains(&value) => rounded,
            _ => {
                self.refuse(key, format!("`{key}` comes out as {value:e}, outside {range}"));
                1.0
            }
        }
    }

    fn refuse(&mut self, key: &str, reason: impl Into<String>) {
        self.notes.refuse_at(self.path, &[key], reason);
    }
}
