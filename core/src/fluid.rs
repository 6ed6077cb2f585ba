//! Fluids: species and media, streams of them, and the books in which every transfer is one rounded number.

pub(crate) mod books;
pub mod medium;
pub mod stream;

pub use books::Account;
pub use medium::{Medium, PARTS, Parts};
pub use stream::{ENERGY, STORED, Stored, Stream};
