//! What a Linux computer can do for a thread that must not be late: priority, locked memory, a core of its own.
//!
//! None of it is guaranteed: without the rights the loop runs all the same, and every thing that is missing is named
//! with what would give it.

use std::fmt;

use rustix::mm::{MlockAllFlags, mlockall};
use rustix::thread::{CpuSet, sched_setaffinity};
use thread_priority::{
    RealtimeThreadSchedulePolicy, ThreadPriority, ThreadSchedulePolicy, set_thread_priority_and_policy,
    thread_native_id,
};

/// Priority among real-time threads: above the kernel's own interrupt threads, at 50, it would starve them.
pub const PRIORITY: u8 = 40;

/// What is asked of the computer.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Wishes {
    /// The core on which the loop runs; any when absent.
    pub core: Option<usize>,
}

/// Something that the loop had to do without.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Missing {
    /// Real-time priority; the text is the system's.
    Priority(String),
    /// Locked memory: a page fault can delay a tick.
    LockedMemory(String),
    /// The core that was asked for.
    Core(usize, String),
}

impl fmt::Display for Missing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Priority(why) => write!(
                f,
                "no real-time priority (SCHED_FIFO {PRIORITY}): {why}; `ulimit -r {PRIORITY}` or CAP_SYS_NICE \
                 gives it"
            ),
            Self::LockedMemory(why) => write!(
                f,
                "memory is not locked, a page fault can delay a tick: {why}; `ulimit -l unlimited` or \
                 CAP_IPC_LOCK gives it"
            ),
            Self::Core(core, why) => write!(f, "not bound to core {core}: {why}"),
        }
    }
}

/// Makes the calling thread as punctual as it may be and returns what it has to do without. To be called when
/// everything that the thread needs has been allocated.
pub fn become_real_time(wishes: Wishes) -> Vec<Missing> {
    let mut missing = Vec::new();
    // What is mapped later stays unlocked on purpose: under a limit, locking it would make allocations of other
    // threads fail, and the loop itself allocates nothing.
    if let Err(error) = mlockall(MlockAllFlags::CURRENT) {
        missing.push(Missing::LockedMemory(error.to_string()));
    }
    if let Some(core) = wishes.core {
        let mut cores = CpuSet::new();
        if core < CpuSet::MAX_CPU {
            cores.set(core);
        }
        // The calling thread alone.
        if let Err(error) = sched_setaffinity(None, &cores) {
            missing.push(Missing::Core(core, error.to_string()));
        }
    }
    let fifo = ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo);
    let asked =
        ThreadPriority::from_posix(thread_priority::ScheduleParams { sched_priority: PRIORITY.into() });
    if let Err(error) = set_thread_priority_and_policy(thread_native_id(), asked, fifo) {
        let why = match error {
            thread_priority::Error::OS(code) => std::io::Error::from_raw_os_error(code).to_string(),
            other => other.to_string(),
        };
        missing.push(Missing::Priority(why));
    }
    missing
}

#[cfg(test)]
mod tests {
    use super::*;

    /// With or without rights: it returns, names what is missing, and a core that does not exist is missing.
    #[test]
    fn what_is_missing_is_named_with_its_remedy() {
        let missing = std::thread::spawn(|| become_real_time(Wishes { core: Some(100_000) })).join().unwrap();
        assert!(missing.iter().any(|thing| matches!(thing, Missing::Core(100_000, _))), "{missing:?}");
        for thing in missing {
            let text = thing.to_string();
            assert!(text.contains("ulimit") || text.contains("core 100000"), "{text}");
        }
    }

    #[test]
    fn the_first_core_can_be_had() {
        let missing = std::thread::spawn(|| become_real_time(Wishes { core: Some(0) })).join().unwrap();
        assert!(!missing.iter().any(|thing| matches!(thing, Missing::Core(..))), "{missing:?}");
    }
}
