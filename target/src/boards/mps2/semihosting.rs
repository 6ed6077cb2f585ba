//! Talks to the emulator: what to run, and how it ended.
#![allow(unsafe_code, reason = "a semihosting call is a trap with a pointer")]

use cortex_m_semihosting::{debug, syscall1};
use defmt_semihosting as _;
use heapless::String;

/// Longest command line that is read \[bytes\].
const LINE: usize = 256;

/// Ticks that are made too long on purpose.
#[derive(Clone, Copy)]
pub(super) struct Overload {
    from_tick: u32,
    ticks: u32,
    /// How long each of them busies the processor \[µs\].
    pub(super) duration_us: u32,
}

impl Overload {
    pub(super) fn hits(&self, tick: u32) -> bool {
        tick.wrapping_sub(self.from_tick) < self.ticks
    }
}

/// A way to stop the firmware, for tests of what happens then.
#[derive(Clone, Copy)]
pub(super) enum Trap {
    Panic,
    BadAddress,
    StackOverflow,
}

impl Trap {
    pub(super) fn spring(self) {
        match self {
            Self::Panic => panic!("asked for"),
            // SAFETY: nothing answers at this address, which is the point: the processor traps.
            Self::BadAddress => unsafe { (0xF000_0000 as *mut u32).write_volatile(0) },
            Self::StackOverflow => {
                let depth = dig(core::hint::black_box(0));
                defmt::error!("the stack did not overflow in {=u32} calls", depth);
            }
        }
    }
}

/// Calls itself until the stack is full; what it does after the call keeps it from becoming a loop.
#[allow(unconditional_recursion, reason = "it is meant to run out of stack")]
fn dig(depth: u32) -> u32 {
    let ballast = core::hint::black_box([depth; 64]);
    dig(depth + 1).wrapping_add(ballast[depth as usize % 64])
}

/// Requests on the emulator's command line: words `seconds=N`,
/// `overload=FROM_TICK:TICKS:MICROSECONDS`, `trap=panic|address|stack`, `pace=real|free` (whether to keep step with
/// the wall's clock) and `role=plant|controller`.
pub(super) struct Request {
    pub(super) seconds: u32,
    pub(super) overload: Option<Overload>,
    pub(super) trap: Option<Trap>,
    /// Whether the processor sleeps between ticks, so that the emulator keeps step with the wall's clock.
    pub(super) sleeps: bool,
    /// Whether this end of the link is the controller.
    pub(super) controls: bool,
}

/// Reads the emulator's command line.
pub(crate) fn command_line() -> String<LINE> {
    let mut buffer = [0_u8; LINE];
    let mut block = [buffer.as_mut_ptr() as usize, LINE];
    // SAFETY: the emulator writes at most LINE bytes into `buffer` and the length into `block`.
    let refused = unsafe { syscall1!(GET_CMDLINE, block.as_mut_ptr() as usize) } != 0;
    let length = if refused { 0 } else { block[1].min(LINE) };
    let line = core::str::from_utf8(&buffer[..length]).unwrap_or("?").trim_end_matches('\0');
    String::try_from(line).unwrap_or_default()
}

impl Request {
    /// Reads the command line. Ends the run when a word makes no sense: a test must not pass by a typing error.
    pub(super) fn read() -> Self {
        let line = command_line();
        let mut request = Self { seconds: 10, overload: None, trap: None, sleeps: false, controls: false };
        for word in line.split_ascii_whitespace() {
            if request.take(word).is_none() {
                defmt::error!("cannot make sense of `{=str}`", word);
                exit(false);
            }
        }
        request
    }

    fn take(&mut self, word: &str) -> Option<()> {
        let (name, value) = word.split_once('=')?;
        match name {
            "seconds" => self.seconds = value.parse().ok()?,
            "overload" => {
                let mut numbers = value.split(':').map(|number| number.parse().ok());
                let mut next = || numbers.next().flatten();
                self.overload = Some(Overload { from_tick: next()?, ticks: next()?, duration_us: next()? });
            }
            "pace" => {
                self.sleeps = match value {
                    "real" => true,
                    "free" => false,
                    _ => return None,
                }
            }
            "role" => {
                self.controls = match value {
                    "controller" => true,
                    "plant" => false,
                    _ => return None,
                }
            }
            "trap" => {
                self.trap = Some(match value {
                    "panic" => Trap::Panic,
                    "address" => Trap::BadAddress,
                    "stack" => Trap::StackOverflow,
                    _ => return None,
                });
            }
            _ => return None,
        }
        Some(())
    }
}

/// Ends the emulator; its exit code is 0 only if `well`.
pub(crate) fn exit(well: bool) -> ! {
    loop {
        debug::exit(if well { debug::EXIT_SUCCESS } else { debug::EXIT_FAILURE });
    }
}
