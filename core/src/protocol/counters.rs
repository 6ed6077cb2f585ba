//! What has come over the wire, frame by frame: each is counted in exactly one place.

use super::frame::BadFrame;

/// Counts since the link was made.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Counters {
    /// Packets of the session that were taken.
    pub accepted: u32,
    /// Those of them whose data were too old to be used.
    pub stale: u32,
    /// Those of them that were commands of a peer that did not prove that it has the key.
    pub unproven: u32,
    /// Packets of the session that had come before.
    pub duplicate: u32,
    /// Packets of the session that came after a newer one; they are not taken.
    pub late: u32,
    /// Packets of the session that came so late that nobody knows whether they had come before.
    pub ancient: u32,
    /// Packets of all sessions that never came.
    pub lost: u32,
    /// Packets of the handshake that were taken.
    pub handshake: u32,
    /// Frames that were no COBS.
    pub bad_cobs: u32,
    /// Frames with a wrong check sum.
    pub bad_crc: u32,
    /// Frames longer than any that is allowed.
    pub oversize: u32,
    /// Frames shorter than any packet.
    pub truncated: u32,
    /// Frames with a right check sum and no meaning.
    pub malformed: u32,
    /// Packets of another version.
    pub foreign_version: u32,
    /// Packets of another session.
    pub foreign_session: u32,
    /// Hellos of another network, process image, step or role.
    pub foreign_id: u32,
    /// Packets of our own that found no room.
    pub unsent: u32,
    /// Sessions that began.
    pub sessions: u32,
}

impl Counters {
    pub(super) fn bad(&mut self, frame: BadFrame) {
        let counter = match frame {
            BadFrame::Cobs => &mut self.bad_cobs,
            BadFrame::Crc => &mut self.bad_crc,
            BadFrame::Oversize => &mut self.oversize,
            BadFrame::Truncated => &mut self.truncated,
            BadFrame::Malformed => &mut self.malformed,
            BadFrame::Version => &mut self.foreign_version,
        };
        *counter = counter.saturating_add(1);
    }

    /// Frames that were damaged.
    pub fn damaged(&self) -> u32 {
        [self.bad_cobs, self.bad_crc, self.oversize, self.truncated, self.malformed]
            .into_iter()
            .fold(0, u32::saturating_add)
    }

    /// Packets that were sound and not meant for this end.
    pub fn foreign(&self) -> u32 {
        self.foreign_version.saturating_add(self.foreign_session).saturating_add(self.foreign_id)
    }

    /// All frames that came.
    pub fn frames(&self) -> u32 {
        [
            self.accepted,
            self.duplicate,
            self.late,
            self.ancient,
            self.handshake,
            self.damaged(),
            self.foreign(),
        ]
        .into_iter()
        .fold(0, u32::saturating_add)
    }
}
