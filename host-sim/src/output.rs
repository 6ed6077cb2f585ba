//! Files of a run.

use std::fs;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use crate::Failure;

/// An output folder.
#[derive(Debug, Clone)]
pub(crate) struct Folder {
    path: PathBuf,
}

impl Folder {
    /// Makes the folder if it is not there.
    pub(crate) fn make(path: &Path) -> Result<Self, Failure> {
        fs::create_dir_all(path).map_err(|error| Failure::file("make the folder", path, &error))?;
        Ok(Self { path: path.to_owned() })
    }

    /// Writes a text file and returns its path.
    pub(crate) fn text(&self, name: &str, text: &str) -> Result<PathBuf, Failure> {
        let path = self.path.join(name);
        write_text(&path, text)?;
        Ok(path)
    }

    /// Writes a file piece by piece and returns its path.
    pub(crate) fn file(
        &self,
        name: &str,
        write: impl FnOnce(&mut BufWriter<fs::File>) -> io::Result<()>,
    ) -> Result<PathBuf, Failure> {
        let path = self.path.join(name);
        let failed = |error: io::Error| Failure::file("write", &path, &error);
        let mut out = BufWriter::new(fs::File::create(&path).map_err(failed)?);
        write(&mut out).and_then(|()| out.flush()).map_err(failed)?;
        Ok(path)
    }
}

/// Writes a file as a whole or not at all: whoever finds it under its name finds all of it.
#[cfg_attr(not(feature = "hil"), allow(dead_code, reason = "checkpoints belong to the loop with hardware"))]
pub(crate) fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    let failed = |error: io::Error| Failure::file("write", path, &error);
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let part = path.with_file_name(format!(".{name}.{}.part", std::process::id()));
    let written = fs::File::create(&part)
        .and_then(|mut file| file.write_all(bytes).and_then(|()| file.sync_all()))
        .and_then(|()| fs::rename(&part, path));
    if written.is_err() {
        // The remains are of no use.
        let _ = fs::remove_file(&part);
    }
    written.map_err(failed)
}

/// Writes a text file.
pub(crate) fn write_text(path: &Path, text: &str) -> Result<(), Failure> {
    fs::write(path, text).map_err(|error| Failure::file("write", path, &error))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Readers see the old file or the new one, never a part; where it cannot be written the old one stays.
    #[test]
    fn a_file_is_there_as_a_whole_or_not_at_all() {
        let folder = std::env::temp_dir().join(format!("eclss-whole-{}", std::process::id()));
        let path = folder.join("state.eckp");
        assert!(write_whole(&path, b"new").is_err(), "there is no such folder");
        fs::create_dir_all(&folder).unwrap();
        let sizes = [1_000_usize, 3_000_000];
        write_whole(&path, &vec![0; sizes[0]]).unwrap();
        let reader = {
            let path = path.clone();
            std::thread::spawn(move || {
                (0..400).for_each(|_| {
                    let length = fs::read(&path).unwrap().len();
                    assert!(sizes.contains(&length), "{length} bytes");
                });
            })
        };
        while !reader.is_finished() {
            for length in sizes {
                write_whole(&path, &vec![1; length]).unwrap();
            }
        }
        reader.join().unwrap();
        assert_eq!(fs::read_dir(&folder).unwrap().count(), 1, "nothing else is left");
        fs::remove_dir_all(folder).unwrap();
    }
}
