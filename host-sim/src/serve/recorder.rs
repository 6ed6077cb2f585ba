//! Writes frames into a file on this machine, where whoever started the server has named a folder for it.
//!
//! A page names the file, nothing more: plain letters, into that folder alone, and never over a file that is there.

use std::fs::{File, OpenOptions};
use std::io::{BufWriter, Write};
use std::path::PathBuf;
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};

use super::feed::{Catalogue, Frame};

/// Longest name of a file [letters].
const NAME: usize = 64;
/// Largest file [bytes]; a recording that reaches it ends.
const LARGEST: u64 = 4 << 30;

/// The recorder of a server.
#[derive(Debug, Default)]
pub(super) struct Recorder {
    folder: OnceLock<PathBuf>,
    now: Mutex<Now>,
}

/// What is or was last recorded.
#[derive(Debug, Default)]
struct Now {
    file: Option<BufWriter<File>>,
    name: String,
    rows: u64,
    bytes: u64,
    /// Why it ended by itself.
    ended: Option<&'static str>,
}

/// What a page asks of the recorder: a file to begin, or nothing to end.
#[derive(Debug, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Wish {
    pub(super) file: Option<String>,
}

/// What the page is told.
#[derive(Debug, serde::Serialize)]
struct State<'s> {
    on: bool,
    file: &'s str,
    rows: u64,
    ended: Option<&'static str>,
}

impl Recorder {
    /// Allows recordings in `folder`; the first call counts.
    pub(super) fn allow(&self, folder: PathBuf) {
        let _ = self.folder.set(folder);
    }

    /// Whether recordings are allowed.
    pub(super) fn allowed(&self) -> bool {
        self.folder.get().is_some()
    }

    fn now(&self) -> MutexGuard<'_, Now> {
        self.now.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// What is recorded, as JSON.
    pub(super) fn state(&self) -> String {
        let now = self.now();
        let state = State { on: now.file.is_some(), file: &now.name, rows: now.rows, ended: now.ended };
        serde_json::to_string(&state).unwrap_or_else(|_| "{}".into())
    }

    /// Begins or ends a recording; why not, where it is refused.
    pub(super) fn ask(&self, wish: &Wish, catalogue: &Catalogue) -> Result<(), &'static str> {
        let Some(name) = &wish.file else {
            self.end(None);
            return Ok(());
        };
        let folder =
            self.folder.get().ok_or("this server writes no files; start it with --recordings DIR")?;
        let plain = |letter: char| letter.is_ascii_alphanumeric() || "-_.".contains(letter);
        if name.is_empty() || name.len() > NAME || name.starts_with('.') || !name.chars().all(plain) {
            return Err(
                "a file's name is up to 64 letters, digits, - _ and ., and does not begin with a point",
            );
        }
        let name = format!("{}.csv", name.strip_suffix(".csv").unwrap_or(name));
        let mut now = self.now();
        if now.file.is_some() {
            return Err("a recording runs already");
        }
        // Not through a link, not over anything.
        let file = OpenOptions::new().write(true).create_new(true).open(folder.join(&name));
        let file = file.map_err(|error| match error.kind() {
            std::io::ErrorKind::AlreadyExists => "there is a file of this name already",
            _ => "the folder of recordings takes no file",
        })?;
        let mut file = BufWriter::new(file);
        let mut head = String::from("t_s,tick");
        for value in &catalogue.values {
            head.push(',');
            head.push_str(&value.id);
        }
        head.push('\n');
        file.write_all(head.as_bytes()).map_err(|_| "the folder of recordings takes no file")?;
        *now = Now { file: Some(file), name, rows: 0, bytes: head.len() as u64, ended: None };
        Ok(())
    }

    /// Writes a frame, where a recording runs.
    pub(super) fn note(&self, frame: &Frame) {
        use std::fmt::Write as _;
        let mut now = self.now();
        let Some(file) = &mut now.file else { return };
        let mut row = String::with_capacity(24 + 12 * frame.values.len());
        let _ = write!(row, "{:.6},{}", frame.figures.t_s, frame.figures.tick);
        for value in &frame.values {
            // What is not a number is an empty cell.
            let _ = if value.is_finite() { write!(row, ",{value}") } else { write!(row, ",") };
        }
        row.push('\n');
        let written = file.write_all(row.as_bytes()).is_ok();
        now.rows += u64::from(written);
        now.bytes += row.len() as u64;
        let full = now.bytes >= LARGEST;
        drop(now);
        if !written {
            self.end(Some("the disk took no more"));
        } else if full {
            self.end(Some("the file is full"));
        }
    }

    /// Ends a recording and its file.
    pub(super) fn end(&self, why: Option<&'static str>) {
        let mut now = self.now();
        if let Some(mut file) = now.file.take() {
            let lost = file.flush().is_err().then_some("the disk took no more");
            now.ended = why.or(lost);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::serve::feed::tests::catalogue;

    #[test]
    fn a_recording_is_a_table_and_nothing_is_written_unasked() {
        let folder = std::env::temp_dir().join(format!("eclss-recorder-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let catalogue = catalogue();
        assert_eq!(catalogue.values.len(), 1);
        let recorder = Recorder::default();
        let begin = |name: &str| recorder.ask(&Wish { file: Some(name.into()) }, &catalogue);
        assert!(begin("a").unwrap_err().contains("--recordings"));
        recorder.allow(folder.clone());
        for name in ["", ".a", "..", "a/b", "../a", "a\\b", "a b", "a\0", "ä", &"a".repeat(65)] {
            assert!(begin(name).is_err(), "{name:?}");
        }
        let frame = |value: f32| Frame { values: vec![value], ..Frame::default() };
        recorder.note(&frame(0.0));
        begin("run-1").unwrap();
        assert!(begin("run-2").is_err(), "one at a time");
        recorder.note(&frame(1.5));
        recorder.note(&frame(f32::NAN));
        assert!(
            recorder.state().contains(r#""on":true,"file":"run-1.csv","rows":2"#),
            "{}",
            recorder.state()
        );
        recorder.ask(&Wish { file: None }, &catalogue).unwrap();
        recorder.note(&frame(2.5));
        let text = std::fs::read_to_string(folder.join("run-1.csv")).unwrap();
        assert_eq!(text, "t_s,tick,a.pressure\n0.000000,0,1.5\n0.000000,0,\n");
        assert!(begin("run-1.csv").unwrap_err().contains("already"), "never over a file");
        assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 1);
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
