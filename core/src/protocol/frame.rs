//! Frames: COBS(packet ‖ CRC-32) and a zero byte.
//!
//! A zero stands nowhere but at a frame's end, so that a receiver finds the next frame whatever came before. The
//! check sum is CRC-32/ISO-HDLC (that of Ethernet and zip), lowest byte first. Sources: S. Cheshire and M. Baker,
//! "Consistent overhead byte stuffing", 1999; G. Cook, "Catalogue of parametrised CRC algorithms".

use super::message::{Packet, VERSION};
use crc::{CRC_32_ISO_HDLC, Crc};

/// Longest packet \[bytes\].
pub const PAYLOAD_BYTES: usize = 500;
/// Longest frame with its zero \[bytes\]: the check sum and one byte in 254 more.
pub const FRAME_BYTES: usize = 512;
const CHECK_BYTES: usize = 4;
/// Shortest packet: five numbers and an empty message.
const SHORTEST: usize = 6;

static CRC: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);

/// Returns the check sum of `bytes`.
pub(super) fn check_sum(bytes: &[u8]) -> u32 {
    CRC.checksum(bytes)
}

/// Most bytes of a frame with `values` values, their quality and that of `seen` values of the peer's: every number at
/// its longest.
pub(super) fn data_bytes(values: usize, seen: usize) -> usize {
    // Version, session, sequence, tick, time, kind; mode, cause; echo; three lengths.
    let packet = (1 + 5 + 5 + 10 + 10 + 1) + (1 + 1) + (5 + 10 + 5) + 3 + 5 * values + seen;
    let coded = packet + CHECK_BYTES;
    coded + coded / 254 + 1 + 1
}

/// Why a frame is not taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BadFrame {
    /// No COBS.
    Cobs,
    /// Wrong check sum.
    Crc,
    /// Longer than [`FRAME_BYTES`].
    Oversize,
    /// Shorter than any packet.
    Truncated,
    /// The check sum is right, but it is no packet.
    Malformed,
    /// A packet of another version.
    Version,
}

/// Finds frames in a stream of bytes.
#[derive(Debug, Clone)]
pub struct Framer {
    bytes: [u8; FRAME_BYTES],
    length: usize,
    /// Whether the present frame is too long already: what is left of it is skipped.
    oversize: bool,
}

impl Default for Framer {
    fn default() -> Self {
        Self::new()
    }
}

impl Framer {
    /// Between two frames.
    pub const fn new() -> Self {
        Self { bytes: [0; FRAME_BYTES], length: 0, oversize: false }
    }

    /// Takes one byte; returns the frame that it ends, if it ends one. Zeros between frames are nothing.
    pub fn push(&mut self, byte: u8) -> Option<Result<Packet, BadFrame>> {
        if byte != 0 {
            match self.bytes.get_mut(self.length) {
                // Room is kept for the zero, so that every frame that is taken can also be sent.
                Some(place) if self.length + 1 < FRAME_BYTES => {
                    *place = byte;
                    self.length += 1;
                }
                _ => self.oversize = true,
            }
            return None;
        }
        let (length, oversize) = (self.length, self.oversize);
        (self.length, self.oversize) = (0, false);
        match self.bytes.get_mut(..length) {
            _ if oversize => Some(Err(BadFrame::Oversize)),
            Some(frame) if !frame.is_empty() => Some(decode(frame)),
            _ => None,
        }
    }
}

/// Decodes a frame without its zero, in place.
fn decode(frame: &mut [u8]) -> Result<Packet, BadFrame> {
    let length = cobs::decode_in_place(frame).map_err(|_| BadFrame::Cobs)?;
    let decoded = frame.get(..length).unwrap_or(&[]);
    let (payload, check) = decoded.split_last_chunk::<CHECK_BYTES>().ok_or(BadFrame::Truncated)?;
    if payload.len() < SHORTEST {
        return Err(BadFrame::Truncated);
    }
    if check_sum(payload) != u32::from_le_bytes(*check) {
        return Err(BadFrame::Crc);
    }
    if payload.first() != Some(&VERSION) {
        return Err(BadFrame::Version);
    }
    match postcard::take_from_bytes(payload) {
        Ok((packet, [])) => Ok(packet),
        _ => Err(BadFrame::Malformed),
    }
}

/// Writes a packet as a frame with its zero into `out`; returns its length, `None` where there is no room.
pub fn encode(packet: &Packet, out: &mut [u8]) -> Option<usize> {
    let mut bytes = [0; PAYLOAD_BYTES + CHECK_BYTES];
    let length = postcard::to_slice(packet, bytes.get_mut(..PAYLOAD_BYTES)?).ok()?.len();
    let check = check_sum(bytes.get(..length)?);
    bytes.get_mut(length..length + CHECK_BYTES)?.copy_from_slice(&check.to_le_bytes());
    let coded = cobs::try_encode(bytes.get(..length + CHECK_BYTES)?, out).ok()?;
    *out.get_mut(coded)? = 0;
    Some(coded + 1)
}

#[cfg(test)]
mod tests {
    use super::super::message::{Body, Data, Echo, Hello, Role};
    use super::*;
    use crate::mode::Mode;
    use crate::process::CHANNELS;
    use heapless::Vec;
    use std::vec;

    fn largest() -> Packet {
        let mut data = Data { mode: Mode::Safe, cause: 255, ..Data::default() };
        data.echo.sequence = u32::MAX;
        data.echo.time_us = u64::MAX;
        data.echo.age_us = u32::MAX;
        for _ in 0..CHANNELS {
            data.values.push(f32::MIN).unwrap();
            data.quality.push(255).unwrap();
            data.seen.push(255).unwrap();
        }
        let body = Body::Data(data);
        Packet {
            version: VERSION,
            session: u32::MAX,
            sequence: u32::MAX,
            tick: u64::MAX,
            time_us: u64::MAX,
            body,
        }
    }

    fn smallest() -> Packet {
        let data = Data { values: Vec::new(), ..Data::default() };
        Packet { version: VERSION, session: 0, sequence: 0, tick: 0, time_us: 0, body: Body::Data(data) }
    }

    fn received(bytes: &[u8]) -> vec::Vec<Result<Packet, BadFrame>> {
        let mut framer = Framer::new();
        bytes.iter().filter_map(|byte| framer.push(*byte)).collect()
    }

    #[test]
    fn the_check_sum_is_the_catalogues() {
        assert_eq!(check_sum(b"123456789"), 0xCBF4_3926);
    }

    #[test]
    fn the_largest_and_the_smallest_packet_come_through() {
        for packet in [largest(), smallest()] {
            let mut out = [0; FRAME_BYTES];
            let length = encode(&packet, &mut out).expect("it fits");
            let Body::Data(data) = &packet.body else { unreachable!() };
            assert!(length <= data_bytes(data.values.len(), data.seen.len()));
            assert_eq!(out[..length].iter().position(|byte| *byte == 0), Some(length - 1));
            assert_eq!(received(&out[..length]), [Ok(packet)]);
        }
        assert_eq!(encode(&largest(), &mut [0; 100]), None, "no room");
    }

    /// Every single flipped bit is seen, and the frame behind it comes through.
    #[test]
    fn every_flipped_bit_is_one_bad_frame_or_two() {
        let mut out = [0; FRAME_BYTES];
        let length = encode(&largest(), &mut out).unwrap();
        for bit in 0..8 * (length - 1) {
            let mut frame = out[..length].to_vec();
            frame[bit / 8] ^= 1 << (bit % 8);
            // A byte that became zero ends a frame early: then there are two bad ones, unless one is empty.
            let parts = frame[..length - 1].split(|byte| *byte == 0);
            let frames = parts.filter(|part| !part.is_empty()).count();
            frame.extend_from_slice(&out[..length]);
            let got = received(&frame);
            assert_eq!(got.len(), frames + 1, "bit {bit}");
            assert!(got[..frames].iter().all(Result::is_err) && got[frames].is_ok(), "bit {bit}");
        }
    }

    #[test]
    fn what_is_wrong_is_named() {
        let mut out = [0; FRAME_BYTES];
        let length = encode(&smallest(), &mut out).unwrap();
        let long = [&[1; 3 * FRAME_BYTES][..], &[0], &out[..length]].concat();
        assert_eq!(received(&long), [Err(BadFrame::Oversize), Ok(smallest())]);
        assert_eq!(received(&[9, 1, 0]), [Err(BadFrame::Cobs)]);
        assert_eq!(received(&[3, 1, 1, 0]), [Err(BadFrame::Truncated)]);
        assert_eq!(received(&[0, 0, 0]), []);
        let mut other = smallest();
        other.version = 2;
        let length = encode(&other, &mut out).unwrap();
        assert_eq!(received(&out[..length]), [Err(BadFrame::Version)]);
    }

    /// A right check sum over a packet with a byte too many.
    #[test]
    fn a_packet_with_something_behind_it_is_malformed() {
        let mut payload = [0; 64];
        let length = postcard::to_slice(&smallest(), &mut payload).unwrap().len() + 1;
        let check = check_sum(&payload[..length]).to_le_bytes();
        let mut out = [0; 128];
        let coded = cobs::try_encode(&[&payload[..length], &check].concat(), &mut out).unwrap();
        assert_eq!(received(&out[..=coded]), [Err(BadFrame::Malformed)]);
    }

    /// The bytes that `docs/protocol.md` shows are those that are written.
    #[test]
    fn the_documents_bytes_are_the_codes() {
        let document = include_str!("../../../docs/protocol.md");
        let hello = Body::Hello(Hello {
            role: Role::Controller,
            network_id: 0x1122_3344_5566_7788,
            process_id: 42,
            step_us: 1_000,
            inputs: 1,
            outputs: 2,
            nonce: 7,
            echo: 0,
        });
        let hello =
            Packet { version: VERSION, session: 0, sequence: 0, tick: 3, time_us: 3_000, body: hello };
        let data = Body::Data(Data {
            mode: Mode::Run,
            cause: 0,
            echo: Echo { sequence: 9, time_us: 4_000, age_us: 250 },
            values: Vec::from_slice(&[0.0625, -1.5]).unwrap(),
            quality: Vec::from_slice(&[0, 3]).unwrap(),
            seen: Vec::new(),
        });
        let data = Packet {
            version: VERSION,
            session: 0x0102_0304,
            sequence: 1,
            tick: 5,
            time_us: 5_000,
            body: data,
        };
        for (name, packet) in [("hello", hello), ("data ", data)] {
            let mut out = [0; FRAME_BYTES];
            let length = encode(&packet, &mut out).unwrap();
            let hex = out[..length]
                .iter()
                .fold(std::string::String::new(), |text, byte| std::format!("{text} {byte:02x}"));
            let line = std::format!("{name}{hex}\n");
            assert!(document.contains(&line), "docs/protocol.md lacks\n{line}");
        }
    }
}
