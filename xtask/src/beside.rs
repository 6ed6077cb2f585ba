//! A stage that runs beside others, as a child that gives way to them.

use crate::Outcome;
use crate::process::{command, present};
use crate::project;
use std::fs::{self, File};
use std::io::{Read, Write, stdin, stdout};
use std::os::unix::process::CommandExt;
use std::path::PathBuf;
use std::process::{Child, Stdio};

/// The command of this program that the child is.
pub(crate) const COMMAND: &str = "beside";

/// A stage that has been started ahead of its turn. What it says is kept until then; it ends when this is dropped.
pub(crate) struct Beside {
    child: Child,
    said: PathBuf,
}

impl Beside {
    /// Starts a stage, where there is a way to make it give way.
    pub(crate) fn start(stage: &str) -> Outcome<Option<Self>> {
        if !present("nice") {
            return Ok(None);
        }
        let explain = |e| format!("cannot start stage `{stage}`: {e}");
        let said = project::output_folder()?.join(format!("{stage}.log"));
        let program = std::env::current_exe().map_err(explain)?.to_string_lossy().into_owned();
        let file = File::create(&said).map_err(explain)?;
        let mut nice = command("nice", &["-n", "19", &program, COMMAND, stage]);
        // Leader of a group of its own, which ends with it. It lives as long as its input is open: until we end.
        nice.process_group(0).stdin(Stdio::piped());
        nice.stderr(file.try_clone().map_err(explain)?).stdout(file);
        Ok(Some(Self { child: nice.spawn().map_err(explain)?, said }))
    }

    /// Waits for the stage, then says what it said and how it ended.
    pub(crate) fn finish(mut self) -> Outcome {
        // `wait` closes an input that is still its own.
        let _open = self.child.stdin.take();
        let ended = self.child.wait().map_err(|e| format!("lost the stage: {e}"))?;
        let said = fs::read(&self.said).map_err(|e| format!("cannot read {}: {e}", self.said.display()))?;
        stdout().write_all(&said).map_err(|e| format!("cannot print: {e}"))?;
        if ended.success() { Ok(()) } else { Err("what ran beside other stages failed, see above".into()) }
    }
}

impl Drop for Beside {
    fn drop(&mut self) {
        // Its input ends, and so does the child with all that it has started.
        drop(self.child.stdin.take());
        let _ = self.child.wait();
    }
}

/// In the child: its group ends when its input does, because nobody waits for it any more.
pub(crate) fn end_with_parent() {
    std::thread::spawn(|| {
        let _ = stdin().read_to_end(&mut Vec::new());
        let group = format!("kill -s KILL -- -{}", std::process::id());
        let _ = command("sh", &["-c", &group]).status();
    });
}
