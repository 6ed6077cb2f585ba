//! The wire between a computer's loop and hardware: bytes over a serial port, a Unix socket or UDP, without ever
//! waiting.
//!
//! The loop reads and writes through [`Link`], whose calls return at once whatever the other side does. Opening and
//! closing can take long, so a thread of its own does it: a link that is lost comes back by itself, and what the plant
//! does meanwhile is for the modes to say.

mod address;
mod opened;

pub use address::{Address, AddressError};

use std::io;
use std::os::unix::net::UnixStream;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

use rtrb::{Consumer, Producer, RingBuffer};

use opened::{Opener, Wire};

/// How often a lost link is tried again.
const RETRY: Duration = Duration::from_millis(50);
/// Largest datagram that is taken whole [bytes].
const DATAGRAM: usize = 2_048;
/// Most datagrams that one call looks at, so that no flood of empty ones makes it long.
const DATAGRAMS: usize = 64;
/// Room for what waits [bytes]: what a tick can look through for the newest.
const BACKLOG: usize = 65_536;

/// What a link did with bytes.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, serde::Serialize)]
pub struct LinkCounts {
    /// Bytes that came in.
    pub bytes_in: u64,
    /// Bytes that went out.
    pub bytes_out: u64,
    /// Bytes that nobody was there to take.
    pub bytes_unsent: u64,
    /// Bytes that had waited too long and were left out for newer ones.
    pub bytes_skipped: u64,
    /// How often the other side went away.
    pub lost: u64,
    /// How often there was another side again, the first time included.
    pub opened: u64,
}

/// The loop's end of the wire.
#[derive(Debug)]
pub struct Link {
    wire: Option<Wire>,
    fresh: Consumer<Wire>,
    worn: Producer<Wire>,
    wanted: Arc<AtomicBool>,
    /// What has come and has not been asked for.
    came: Vec<u8>,
    came_from: usize,
    came_to: usize,
    counts: LinkCounts,
}

/// Keeps a thread that opens and closes the wire; dropping it ends the thread.
#[derive(Debug)]
pub struct Keeper {
    ends: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

/// Opens a link, of which the other side need not be there yet. The error names the address.
pub fn open(address: &Address) -> io::Result<(Link, Keeper)> {
    let mut opener = Opener::new(address)?;
    let (mut fresh_in, fresh) = RingBuffer::new(1);
    let (worn, mut worn_out) = RingBuffer::<Wire>::new(4);
    let (wanted, ends) = (Arc::new(AtomicBool::new(true)), Arc::new(AtomicBool::new(false)));
    let (wanted_here, ends_here) = (Arc::clone(&wanted), Arc::clone(&ends));
    let keep = move || {
        while !ends_here.load(Ordering::Acquire) {
            while let Ok(wire) = worn_out.pop() {
                drop(wire);
            }
            if wanted_here.load(Ordering::Acquire)
                && let Some(wire) = opener.try_open()
            {
                wanted_here.store(false, Ordering::Release);
                // There is room: the loop took the last one before it wanted another.
                let _ = fresh_in.push(wire);
            }
            std::thread::sleep(RETRY);
        }
    };
    let thread = std::thread::Builder::new().name("link".into()).spawn(keep)?;
    let link = Link {
        wire: None,
        fresh,
        worn,
        wanted,
        came: vec![0; BACKLOG],
        came_from: 0,
        came_to: 0,
        counts: LinkCounts::default(),
    };
    Ok((link, Keeper { ends, thread: Some(thread) }))
}

/// Two ends of a wire within this program. When one is gone, the other stays without.
pub fn pair() -> io::Result<(Link, Link)> {
    let (one, other) = UnixStream::pair()?;
    one.set_nonblocking(true)?;
    other.set_nonblocking(true)?;
    Ok((Link::around(Wire::Unix(one)), Link::around(Wire::Unix(other))))
}

impl Drop for Keeper {
    fn drop(&mut self) {
        self.ends.store(true, Ordering::Release);
        if let Some(thread) = self.thread.take() {
            // Its panic, if it had one, has been printed.
            let _ = thread.join();
        }
    }
}

impl Link {
    /// A link that has its wire, and gets no other.
    fn around(wire: Wire) -> Self {
        let (_, fresh) = RingBuffer::new(1);
        let (worn, _) = RingBuffer::new(1);
        Self {
            wire: Some(wire),
            fresh,
            worn,
            wanted: Arc::new(AtomicBool::new(false)),
            came: vec![0; BACKLOG],
            came_from: 0,
            came_to: 0,
            counts: LinkCounts { opened: 1, ..LinkCounts::default() },
        }
    }

    /// Reads what is there, as much as `buffer` holds; 0 when there is nothing for now. The rest waits.
    pub fn read(&mut self, buffer: &mut [u8]) -> usize {
        self.renew();
        let mut length = 0;
        for _ in 0..DATAGRAMS {
            let came = self.came.get(self.came_from..self.came_to).unwrap_or(&[]);
            let place = buffer.get_mut(length..).unwrap_or(&mut []);
            let count = came.len().min(place.len());
            for (place, byte) in place.iter_mut().zip(came) {
                *place = *byte;
            }
            length += count;
            self.came_from += count;
            if length == buffer.len() || !self.refill() {
                break;
            }
        }
        self.counts.bytes_in += length as u64;
        length
    }

    /// Takes the next datagram or part of the stream in, behind what waits; returns whether there was one.
    fn refill(&mut self) -> bool {
        let Some(wire) = &mut self.wire else { return false };
        if self.came_from == self.came_to {
            (self.came_from, self.came_to) = (0, 0);
        }
        let place = self.came.get_mut(self.came_to..).unwrap_or(&mut []);
        if place.len() < DATAGRAM {
            return false;
        }
        let Ok(length) = wire.read(place) else {
            self.lose();
            return false;
        };
        self.came_to += length;
        length > 0
    }

    /// Takes in what waits and leaves out the oldest whole frames until at most `keep` bytes are left to be read: of a
    /// side that sends faster than it is read, the newest counts. The frame that has been read in part stays.
    pub fn skip(&mut self, keep: usize) {
        self.renew();
        self.came.copy_within(self.came_from..self.came_to, 0);
        (self.came_from, self.came_to) = (0, self.came_to - self.came_from);
        for _ in 0..DATAGRAMS {
            if !self.refill() {
                break;
            }
        }
        let came = self.came.get(..self.came_to).unwrap_or(&[]);
        if came.len() <= keep {
            return;
        }
        let end_after = |at: usize| {
            let rest = came.get(at..).unwrap_or(&[]);
            rest.iter().position(|byte| *byte == 0).map_or(came.len(), |zero| at + zero + 1)
        };
        // A frame longer than half of what is kept is none of the session's.
        let head = Some(end_after(0)).filter(|head| 2 * head <= keep).unwrap_or(0);
        let tail = end_after(came.len() - (keep - head));
        if tail > head {
            self.counts.bytes_skipped += (tail - head) as u64;
            self.came.copy_within(tail..self.came_to, head);
            self.came_to -= tail - head;
        }
    }

    /// Hands over bytes and returns how many were taken; the rest is to be offered again. Where there is no other
    /// side they are taken and lost, because what it would find later is old.
    pub fn write(&mut self, bytes: &[u8]) -> usize {
        self.renew();
        let Some(wire) = &mut self.wire else {
            self.counts.bytes_unsent += bytes.len() as u64;
            return bytes.len();
        };
        let Ok(sent) = wire.write(bytes) else {
            self.lose();
            return bytes.len();
        };
        self.counts.bytes_out += sent as u64;
        sent
    }

    /// Whether there is another side, as far as is known.
    pub fn is_open(&self) -> bool {
        self.wire.is_some()
    }

    /// What was counted.
    pub fn counts(&self) -> LinkCounts {
        self.counts
    }

    fn renew(&mut self) {
        if self.wire.is_none()
            && let Ok(wire) = self.fresh.pop()
        {
            self.wire = Some(wire);
            self.counts.opened += 1;
            (self.came_from, self.came_to) = (0, 0);
        }
    }

    fn lose(&mut self) {
        if let Some(wire) = self.wire.take() {
            self.counts.lost += 1;
            // Closing a serial port waits for what it still has to send, so the keeper does it.
            if let Err(rtrb::PushError::Full(wire)) = self.worn.push(wire) {
                drop(wire);
            }
            self.wanted.store(true, Ordering::Release);
        }
    }
}

#[cfg(test)]
mod tests;
