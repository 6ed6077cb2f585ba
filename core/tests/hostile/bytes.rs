//! Hostile bytes for the decoder: frames of the corpus, spoiled in every way that a wire or an attacker can think of.
//!
//! What must hold for any bytes: no panic; each frame is counted in exactly one place; a packet that is taken is one
//! that somebody sent, bit for bit, unless the attacker computed a right check sum; a link's counters and its newest
//! data stay within their types whatever came.

use std::collections::HashSet;

use eclss_core::mode::Mode;
use eclss_core::protocol::{Config, FRAME_BYTES, Framer, Link, Outgoing, Role};

/// The corpus: one file a frame, some good, some not.
pub(crate) const CORPUS: [&[u8]; 24] = [
    include_bytes!("../corpus/hello_controller"),
    include_bytes!("../corpus/hello_controller_echo"),
    include_bytes!("../corpus/hello_plant_same_role"),
    include_bytes!("../corpus/hello_other_network"),
    include_bytes!("../corpus/refused"),
    include_bytes!("../corpus/data"),
    include_bytes!("../corpus/data_quality"),
    include_bytes!("../corpus/data_infinite"),
    include_bytes!("../corpus/data_64"),
    include_bytes!("../corpus/data_65"),
    include_bytes!("../corpus/data_length_huge"),
    include_bytes!("../corpus/data_other_session"),
    include_bytes!("../corpus/command_arm"),
    include_bytes!("../corpus/command_set"),
    include_bytes!("../corpus/command_get"),
    include_bytes!("../corpus/ack_mode"),
    include_bytes!("../corpus/ack_refused"),
    include_bytes!("../corpus/body_unknown"),
    include_bytes!("../corpus/version_2"),
    include_bytes!("../corpus/varint_too_long"),
    include_bytes!("../corpus/no_cobs"),
    include_bytes!("../corpus/truncated"),
    include_bytes!("../corpus/zeros"),
    include_bytes!("../corpus/oversize"),
];

/// Knuth's MMIX generator: the same bytes everywhere.
pub(crate) struct Dice(pub(crate) u64);

impl Dice {
    pub(crate) fn roll(&mut self, most: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % most.max(1)
    }

    fn byte(&mut self) -> u8 {
        // Small numbers, ends of ranges and anything.
        match self.roll(4) {
            0 => self.roll(4) as u8,
            1 => 255 - self.roll(4) as u8,
            _ => self.roll(256) as u8,
        }
    }
}

/// One case: bytes, and whether a check sum in them was computed over spoiled content.
fn case(dice: &mut Dice) -> (Vec<u8>, bool) {
    let mut bytes = CORPUS[dice.roll(CORPUS.len())].to_vec();
    let mut forged = false;
    match dice.roll(8) {
        0 => bytes = (0..dice.roll(80)).map(|_| dice.byte()).collect(),
        1 => {
            forged = true;
            bytes = forge(&bytes, dice);
        }
        2 => {
            let other = CORPUS[dice.roll(CORPUS.len())];
            bytes.truncate(dice.roll(bytes.len() + 1));
            bytes.extend_from_slice(&other[dice.roll(other.len())..]);
        }
        3 => bytes.truncate(dice.roll(bytes.len() + 1)),
        _ => {}
    }
    for _ in 0..dice.roll(4) {
        if bytes.is_empty() {
            break;
        }
        let place = dice.roll(bytes.len());
        match dice.roll(4) {
            0 => bytes[place] ^= 1 << dice.roll(8),
            1 => bytes[place] = dice.byte(),
            2 => bytes.insert(place, dice.byte()),
            _ => drop(bytes.remove(place)),
        }
    }
    (bytes, forged)
}

/// Spoils the content of a frame and gives it a right check sum.
fn forge(frame: &[u8], dice: &mut Dice) -> Vec<u8> {
    let mut decoded = frame.to_vec();
    let end = decoded.iter().position(|byte| *byte == 0).unwrap_or(decoded.len());
    decoded.truncate(end);
    let Ok(length) = cobs::decode_in_place(&mut decoded) else { return frame.to_vec() };
    decoded.truncate(length.saturating_sub(4));
    for _ in 0..=dice.roll(3) {
        if decoded.is_empty() {
            break;
        }
        let place = dice.roll(decoded.len());
        match dice.roll(3) {
            0 => decoded[place] = dice.byte(),
            1 => decoded.insert(place, dice.byte()),
            _ => drop(decoded.remove(place)),
        }
    }
    let check = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC).checksum(&decoded);
    decoded.extend_from_slice(&check.to_le_bytes());
    let mut out = vec![0; decoded.len() + decoded.len() / 254 + 2];
    let length = cobs::try_encode(&decoded, &mut out).expect("there is room");
    out.truncate(length + 1);
    out
}

/// What the cases came to.
#[derive(Debug, Default, PartialEq, Eq)]
pub(crate) struct Tally {
    pub(crate) cases: u64,
    pub(crate) frames: u64,
    pub(crate) good: u64,
    pub(crate) forged_good: u64,
}

/// A plant's end that the corpus' packets are meant for.
fn plant() -> Link {
    let config = Config {
        role: Role::Plant,
        network_id: 7,
        process_id: 9,
        step_us: 1_000,
        inputs: 2,
        outputs: 2,
        silent_ticks: 50,
        ..Config::default()
    };
    Link::new(config, 11)
}

/// Feeds so many cases to a framer and to a link.
pub(crate) fn run(cases: u64, seed: u64) -> Tally {
    let mut dice = Dice(seed);
    let mut tally = Tally { cases, ..Tally::default() };
    let sound: HashSet<Vec<u8>> = CORPUS.iter().flat_map(|frame| packets(frame)).collect();
    let mut link = plant();
    let mut counted = 0_u64;
    for number in 0..cases {
        if number % 1_024 == 0 {
            // Counters are 32 bits wide and saturate: a link of its own for every thousand.
            assert_eq!(u64::from(link.counters().frames()), counted);
            link = plant();
            counted = 0;
        }
        let (mut bytes, forged) = case(&mut dice);
        bytes.push(0);
        let frames = bytes.split(|byte| *byte == 0).filter(|frame| !frame.is_empty()).count() as u64;
        counted += frames;
        tally.frames += frames;
        let got = packets(&bytes);
        if forged {
            tally.forged_good += got.len() as u64;
        } else {
            tally.good += got.len() as u64;
            for packet in got {
                assert!(sound.contains(&packet), "case {number}: accepted what nobody sent: {bytes:02x?}");
            }
        }
        link.feed(&bytes, number);
        if let Some(data) = link.take_data() {
            assert!(data.values.len() <= 64);
            assert!((0..70).all(|index| data.value(index).is_none() || index < data.values.len()));
        }
        if let Some(command) = link.take_command() {
            link.acknowledge(command.id, eclss_core::protocol::Outcome::NoSuchParameter);
        }
        link.send_tick(
            number,
            number,
            &Outgoing { mode: Mode::Ready, values: &[1.0], ..Outgoing::default() },
        );
        assert!(link.outgoing().len() <= 2 * FRAME_BYTES);
        link.sent(link.outgoing().len());
    }
    tally
}

/// Packets in these bytes, as they are written again.
fn packets(bytes: &[u8]) -> Vec<Vec<u8>> {
    let mut framer = Framer::new();
    let taken = bytes.iter().filter_map(|byte| framer.push(*byte));
    let written = |packet: &eclss_core::protocol::Packet| {
        let mut out = vec![0; FRAME_BYTES];
        // Whatever can be read can be written: a varint may only get shorter.
        let length = eclss_core::protocol::encode(packet, &mut out).expect("it was short enough to be read");
        out.truncate(length);
        out
    };
    taken.filter_map(Result::ok).map(|packet| written(&packet)).collect()
}
