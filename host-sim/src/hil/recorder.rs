//! The recorder: takes rows from the loop and writes CSV and MCAP, in a thread that has no hurry.

mod container;
mod decimate;
mod table;
mod trigger;

pub use decimate::{Bucket, Decimator};
pub use trigger::{Capture, Captured, Trigger};

pub(super) use container::{BEGIN, INPUTS, NETWORK, PLANT, RUN, START};

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use mcap::McapResult;

use super::handover::Row;
use crate::Failure;
use container::Container;

/// What is recorded and where.
#[derive(Debug, Clone)]
pub struct Order<'a> {
    /// Folder of the files.
    pub folder: &'a Path,
    /// Names of the figures.
    pub names: &'a [String],
    /// Ticks in a row of the record.
    pub every: u64,
    /// What starts a capture.
    pub triggers: &'a [Trigger],
    /// Ticks before a trigger that are captured.
    pub before: usize,
    /// Ticks after it.
    pub after: u64,
    /// Wall time of the start [ns since 1970].
    pub epoch_ns: u64,
    /// The network file.
    pub network: &'a str,
    /// Checkpoint of the start.
    pub start: &'a [u8],
    /// Data known when the run begins.
    pub begin: &'a BTreeMap<String, String>,
}

/// Files that are being written.
pub struct Recorder {
    folder: PathBuf,
    names: Vec<String>,
    every: u64,
    decimator: Decimator,
    capture: Capture,
    rows: BufWriter<File>,
    captured: Option<BufWriter<File>>,
    container: Container<BufWriter<File>>,
    files: Vec<PathBuf>,
    taken: u64,
    dropped: u32,
}

impl Recorder {
    /// Opens the files.
    pub fn new(order: &Order<'_>) -> Result<Self, Failure> {
        let made = |path: &Path, error| Failure::file("create", path, &error);
        std::fs::create_dir_all(order.folder).map_err(|error| made(order.folder, error))?;
        let (csv, mcap) = (order.folder.join("record.csv"), order.folder.join("record.mcap"));
        // A record is a proof: none is written over.
        let made = |path: &Path, error: std::io::Error| match error.kind() {
            std::io::ErrorKind::AlreadyExists => Failure::BadInput(format!(
                "--record: {} is there already, and no record is written over; name another folder",
                path.display()
            )),
            _ => made(path, error),
        };
        let mut rows = BufWriter::new(File::create_new(&csv).map_err(|error| made(&csv, error))?);
        table::write_names(&mut rows, order.names, order.every)
            .map_err(|error| Failure::file("write", &csv, &error))?;
        let file = BufWriter::new(File::create_new(&mcap).map_err(|error| made(&mcap, error))?);
        let container =
            Container::new(file, order.names, order.epoch_ns, order.network, order.start, order.begin)
                .map_err(|error| Failure::Failed(format!("cannot write {}: {error}", mcap.display())))?;
        let capture = Capture::new(order.triggers, order.names, order.before, order.after)
            .map_err(|error| Failure::BadInput(format!("--capture: {error}")))?;
        Ok(Self {
            folder: order.folder.to_owned(),
            names: order.names.to_vec(),
            every: order.every,
            decimator: Decimator::new(order.every),
            capture,
            rows,
            captured: None,
            container,
            files: vec![csv, mcap],
            taken: 0,
            dropped: 0,
        })
    }

    /// Takes one tick.
    pub fn row(&mut self, row: &Row) -> Result<(), Failure> {
        self.taken += 1;
        self.dropped = row.head.dropped;
        self.write(row).map_err(|error| failed(&self.folder, &error))
    }

    fn write(&mut self, row: &Row) -> McapResult<()> {
        if row.head.stepped {
            self.container.inputs(row)?;
        }
        if let Some(bucket) = self.decimator.add(row) {
            table::write_bucket(&mut self.rows, &bucket, self.every)?;
            self.container.bucket(&bucket, self.every)?;
        }
        match self.capture.add(row) {
            Captured::Nothing => {}
            Captured::Begins { number, by, rows } => {
                let path = self.folder.join(format!("capture_{number}.csv"));
                let mut file = BufWriter::new(File::create(&path)?);
                self.files.push(path);
                table::write_names(&mut file, &self.names, 1)?;
                let text = format!("capture {number}: {by}");
                self.container.event(row.head.begun_us, row.head.tick, &text)?;
                for row in &rows {
                    table::write_row(&mut file, row)?;
                    self.container.captured(row)?;
                }
                self.captured = Some(file);
            }
            Captured::GoesOn => self.captured_row(row)?,
            Captured::Ends => {
                self.captured_row(row)?;
                if let Some(mut file) = self.captured.take() {
                    file.flush()?;
                }
            }
        }
        Ok(())
    }

    fn captured_row(&mut self, row: &Row) -> McapResult<()> {
        if let Some(file) = &mut self.captured {
            table::write_row(file, row)?;
        }
        self.container.captured(row)
    }

    /// Hands everything that was taken to the system, so that it outlives this program.
    pub fn flush(&mut self) -> Result<(), Failure> {
        let flushed = self.rows.flush().and_then(|()| self.captured.as_mut().map_or(Ok(()), Write::flush));
        let flushed = flushed.map_err(mcap::McapError::from).and_then(|()| self.container.flush());
        flushed.map_err(|error| failed(&self.folder, &error))
    }

    /// Writes an event down.
    pub fn event(&mut self, begun_us: u64, tick: u64, event: &str) -> Result<(), Failure> {
        self.container.event(begun_us, tick, event).map_err(|error| failed(&self.folder, &error))
    }

    /// Rows taken.
    pub fn taken(&self) -> u64 {
        self.taken
    }

    /// Captures made.
    pub fn captures(&self) -> u32 {
        self.capture.captures()
    }

    /// Ends the files with what is known of the run; `dropped` is the loop's own count of rows that it could not hand
    /// over. Returns the files.
    pub fn finish(self, mut run: BTreeMap<String, String>, dropped: u32) -> Result<Vec<PathBuf>, Failure> {
        run.insert("rows".into(), self.taken.to_string());
        run.insert("rows_dropped".into(), dropped.max(self.dropped).to_string());
        let folder = self.folder.clone();
        self.end(run).map_err(|error| failed(&folder, &error))
    }

    fn end(mut self, run: BTreeMap<String, String>) -> McapResult<Vec<PathBuf>> {
        if let Some(bucket) = self.decimator.rest() {
            table::write_bucket(&mut self.rows, &bucket, self.every)?;
            self.container.bucket(&bucket, self.every)?;
        }
        self.rows.flush()?;
        if let Some(file) = &mut self.captured {
            file.flush()?;
        }
        self.container.finish(run)?;
        Ok(self.files)
    }
}

fn failed(folder: &Path, error: &mcap::McapError) -> Failure {
    Failure::Failed(format!("cannot write the record in {}: {error}", folder.display()))
}
