//! The operator at this computer: lines of the standard input, and interrupts.

use std::io::{BufRead, Read as _};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::sync::mpsc::{Receiver, sync_channel};

use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};

/// Longest line that is an order [bytes].
const LINE: u64 = 256;
/// Lines that may wait: who types faster than orders are taken waits.
const LINES: usize = 4;

/// Lets an interrupt end the run in good order; a second one ends the program.
pub fn interrupts() -> Arc<AtomicBool> {
    let flag = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM, SIGHUP] {
        // The first interrupt arms what the second one finds. Where the system refuses, the program ends as it
        // always did.
        let again = Arc::new(AtomicBool::new(false));
        let _ = signal_hook::flag::register_conditional_default(signal, Arc::clone(&again))
            .and_then(|_| signal_hook::flag::register(signal, again))
            .and_then(|_| signal_hook::flag::register(signal, Arc::clone(&flag)));
    }
    flag
}

/// Reads the standard input in a thread of its own, which ends with the program.
pub fn type_along() -> Receiver<String> {
    let (sender, receiver) = sync_channel(LINES);
    std::thread::spawn(move || {
        let mut input = std::io::stdin().lock();
        while let Some(line) = next_line(&mut input) {
            if sender.send(line).is_err() {
                return;
            }
        }
    });
    receiver
}

/// The next line, cut where it is longer than any order; `None` at the end.
fn next_line(input: &mut impl BufRead) -> Option<String> {
    let mut line = Vec::new();
    input.by_ref().take(LINE).read_until(b'\n', &mut line).ok().filter(|length| *length > 0)?;
    if line.last() != Some(&b'\n') {
        input.skip_until(b'\n').ok()?;
    }
    Some(String::from_utf8_lossy(&line).trim_end().to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_cut_to_the_longest_order() {
        let text = [b"arm\n".as_slice(), &vec![b'x'; 100_000], b"\n\nhold\r\nstop"].concat();
        let mut input = text.as_slice();
        let lines: Vec<String> = std::iter::from_fn(|| next_line(&mut input)).collect();
        assert_eq!(lines[1].len(), 256);
        assert_eq!([&lines[0], &lines[2], &lines[3], &lines[4]], ["arm", "", "hold", "stop"]);
        assert_eq!(lines.len(), 5);
    }
}
