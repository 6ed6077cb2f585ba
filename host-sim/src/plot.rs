//! Pictures of runs as SVG: figures of panels with axes, units and legends.
//!
//! A [`Figure`] is data; [`Figure::svg`] draws it. Layout never asks for an installed font, so the same
//! figure gives the same bytes on every machine.

mod canvas;
mod clip;
mod draw;
mod figure;
mod legend;
pub mod style;
mod ticks;

pub use clip::{Point, thin};
pub use figure::{Axis, ColourScale, Curve, Dash, Dots, Figure, Level, Mark, Note, Panel};
