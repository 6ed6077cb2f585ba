//! How good a drawing is to read: what one layout is chosen by among several.

use super::geometry::{At, GRID};
use super::layout::Drawing;
use super::strip::Facing;

/// What a crossing, a bend and a strip that runs to the left cost, in steps of wire.
const CROSSING: i64 = 50;
const BEND: i64 = 4;
const LEFTWARD: i64 = 3;
/// Width over height of a page's place for drawings, in tenths.
const PAGE: i32 = 16;

impl Drawing {
    /// The less, the easier to read: short wires with few bends and crossings, on a sheet that a page shows large.
    pub(super) fn strain(&self, facings: impl Iterator<Item = Facing>) -> i64 {
        let stretches = || self.wires.iter().flat_map(|wire| wire.windows(2).map(|pair| (pair[0], pair[1])));
        let length: i64 =
            stretches().map(|(a, b)| i64::from((a.x - b.x).abs() + (a.y - b.y).abs())).sum::<i64>();
        let bends: usize = self.wires.iter().map(|wire| wire.len().saturating_sub(2)).sum();
        let leftward = facings.filter(|facing| matches!(facing, Facing::Left)).count();
        // A page shows the sheet the smaller, the wider or the higher it is.
        let side = self.width.max(self.height * PAGE / 10);
        length / i64::from(GRID)
            + BEND * bends as i64
            + CROSSING * self.crossings() as i64
            + LEFTWARD * leftward as i64
            + i64::from(side / GRID) * (self.wires.len() as i64 + 8) / 8
    }

    /// Points at which two wires cross.
    pub fn crossings(&self) -> usize {
        let upright = |(a, b): &(At, At)| a.x == b.x;
        let stretches = self.wires.iter().flat_map(|wire| wire.windows(2).map(|pair| (pair[0], pair[1])));
        let (down, across): (Vec<_>, Vec<_>) = stretches.partition(upright);
        let inside = |value: i32, one: i32, other: i32| one.min(other) < value && value < one.max(other);
        let crossed = |(a, b): &(At, At), (c, d): &(At, At)| inside(a.x, c.x, d.x) && inside(c.y, a.y, b.y);
        down.iter().map(|one| across.iter().filter(|other| crossed(one, other)).count()).sum()
    }
}
