//! Network files: TOML in, the tables of `eclss-core` out.
//!
//! [`parse`] reads a file, refuses whatever is wrong with line, column and reason, converts units and derived
//! parameters, and gives the tables that a simulator runs on. [`NetworkFile::to_toml`] saves a document back,
//! [`Loaded::to_rust`] writes it as static tables for a board. The format is described in
//! `docs/network-file.md`.
//!
//! ```
//! let text = r#"
//! schema = 1
//! name = "duct"
//! reference_pressure_pa = 101325.0
//!
//! [[node]]
//! id = "cabin"
//! kind = "cabin"
//! volume_m3 = 60.0
//! pressure_pa = 101325.0
//! temperature_k = 295.15
//!
//! [[line]]
//! id = "loop"
//! from = "cabin"
//! to = "cabin"
//!
//! [[line.element]]
//! id = "duct"
//! kind = "pipe"
//! resistance_pa_s2_kg2 = -800.0
//! "#;
//! let error = eclss_network_file::parse(text, "duct.toml").unwrap_err();
//! assert!(error.to_string().starts_with("duct.toml:21:24: `resistance_pa_s2_kg2` must lie in 0"));
//!
//! let loaded = eclss_network_file::parse(&text.replace('-', ""), "duct.toml")?;
//! assert_eq!(loaded.names.segments, ["duct"]);
//! assert!(loaded.network().check().is_ok());
//! # Ok::<(), eclss_network_file::FileError>(())
//! ```

mod channel;
pub mod document;
mod duration;
mod element;
mod error;
mod flow_row;
pub mod generate;
mod input;
pub mod kinds;
mod leaks;
pub mod limits;
mod loaded;
mod lower;
mod notes;
mod number;
mod plan;
mod process;
mod read;
mod reason;
pub mod reference;
mod rust;
mod signal;
pub mod steady;
mod table;
mod unrest;

use std::fs::File;
use std::io::Read as _;
use std::path::Path;

pub use document::NetworkFile;
pub use duration::{DurationError, duration_us};
pub use error::{FileError, Problem};
pub use leaks::{Leaks, leaks_to_space};
pub use loaded::{ClimateTables, Loaded, Names, RunDefaults};
pub use plan::PlanTables;
pub use process::{InputEntry, OutputEntry, ProcessTables, Scales};
pub use reason::bound_of_step;
pub use signal::NamedSignal;
pub use unrest::{Places, Unrest, unrest};

/// Reads and checks the text of a network file; `name` is the file name shown in errors.
pub fn parse(text: &str, name: &str) -> Result<Loaded, FileError> {
    let mut notes = notes::Notes::default();
    let loaded = read::read(text, &mut notes).and_then(|file| lower::lower(file, &mut notes));
    let Some(mut loaded) = loaded else { return Err(FileError::new(name, text, notes)) };
    loaded.places = Places::new(&loaded, &notes, text);
    Ok(loaded)
}

/// Reads and checks the bytes of a network file, as [`parse`] does with text.
pub fn parse_bytes(bytes: &[u8], name: &str) -> Result<Loaded, FileError> {
    match std::str::from_utf8(bytes) {
        Ok(text) => parse(text, name),
        Err(error) => {
            let mut notes = notes::Notes::default();
            let at = error.valid_up_to();
            notes.refuse(at..at + 1, "not UTF-8 text");
            Err(FileError::new(name, &String::from_utf8_lossy(bytes), notes))
        }
    }
}

/// Reads and checks a network file.
pub fn load(path: &Path) -> Result<Loaded, FileError> {
    let name = path.display().to_string();
    let mut bytes = Vec::new();
    // One byte more than is allowed is enough to see that the file is too long.
    let most = limits::FILE_BYTES as u64 + 1;
    let read = File::open(path).and_then(|file| file.take(most).read_to_end(&mut bytes));
    match read {
        Ok(_) => parse_bytes(&bytes, &name),
        Err(error) => Err(FileError::unreadable(&name, &error)),
    }
}
