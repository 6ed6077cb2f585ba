//! Schematics: a network file as a piping drawing, laid out by itself.
//!
//! [`Graph`] is what is drawn, [`Drawing`] where it stands, [`Drawing::svg`] how it looks. The same drawing is what the
//! live page fills with values: ids in it are `n`, `l`, `e` (node, line, element) and a number in file order.

mod collide;
pub mod geometry;
mod graph;
mod layout;
mod place;
mod route;
mod score;
mod strip;
mod svg;
mod symbol;
mod wires;

pub use graph::{Element, Graph, Line, MOST_NODES, Node};
pub use layout::{Drawing, DrawingError, NodeBox};
pub use strip::{Glyph, Strip, Style};
pub(crate) use svg::escaped;
pub use svg::{Dress, STYLE};
