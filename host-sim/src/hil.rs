//! Hardware in the loop on a Linux computer: the loop of `eclss_target::control` at a fixed rate, with a link to
//! hardware, a recorder and a report.

pub mod arming;
pub mod board;
mod force;
pub mod handover;
pub mod key;
pub mod loopback;
pub mod operator;
pub mod pace;
pub mod page;
pub mod plant;
pub mod realtime;
pub mod recorder;
pub mod replay;
pub mod report;
pub mod runner;
pub mod shot;
pub mod tap;
pub mod timing;
pub mod watch;
