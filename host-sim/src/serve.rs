//! A live page of a running plant, served from this machine alone.
//!
//! Three parts that wait for each other as little as can be: a plant ([`plant`], or whoever else holds a
//! [`Publisher`]) that publishes frames into one slot, a hub that hands them to the open pages, and a small HTTP server
//! with a fixed set of answers. The page itself is part of the program and loads nothing from elsewhere.

mod answer;
pub mod feed;
mod hand;
mod hub;
pub(crate) mod pace;
pub mod plant;
pub(crate) mod reading;
mod recorder;
mod request;
mod server;

pub use feed::{Catalogue, Command, Feed, Figures, Frame, Publisher, Value, feed};
pub use plant::Plant;
pub use server::Server;
