//! Hardware in the loop on a Linux computer: the loop of `eclss_target::control` at a fixed rate, with a link to
//! hardware, a recorder and a report.

pub mod handover;
pub mod link;
pub mod realtime;
pub mod recorder;
pub mod timing;
