//! Keys: who may command. A tag is HMAC-SHA-256 (RFC 2104, FIPS 198-1), cut to 16 bytes, over what makes the command this
//! session's and this packet's: both nonces, the sequence number and the command as it is sent.

use super::message::{CommandFrame, TAG_BYTES};
use hmac::{Hmac, KeyInit as _, Mac as _};
use sha2::Sha256;

/// Bytes of a key.
pub const KEY_BYTES: usize = 32;
/// Begin of everything that is signed, so that a key that is used elsewhere proves nothing here.
const DOMAIN: &[u8] = b"eclss-rt command 1";
/// Room for a command as it is sent.
const COMMAND_BYTES: usize = 32;

/// Secret key shared by both ends.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Key([u8; KEY_BYTES]);

impl core::fmt::Debug for Key {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("Key(…)")
    }
}

impl Key {
    /// Makes a key of bytes, which should be random.
    pub const fn new(bytes: [u8; KEY_BYTES]) -> Self {
        Self(bytes)
    }

    /// Reads a key of 64 hexadecimal digits, with white space around them; `None` for anything else.
    pub fn from_hex(text: &str) -> Option<Self> {
        let digits = text.trim().as_bytes();
        let mut bytes = [0; KEY_BYTES];
        let digit = |place: usize| digits.get(place).and_then(|byte| char::from(*byte).to_digit(16));
        for (place, byte) in bytes.iter_mut().enumerate() {
            *byte = (16 * digit(2 * place)? + digit(2 * place + 1)?) as u8;
        }
        (digits.len() == 2 * KEY_BYTES).then_some(Self(bytes))
    }

    fn mac(
        &self,
        [plant, controller]: [u32; 2],
        sequence: u32,
        frame: &CommandFrame,
    ) -> Option<Hmac<Sha256>> {
        let mut bytes = [0; COMMAND_BYTES];
        let command = postcard::to_slice(frame, &mut bytes).ok()?;
        let mut mac = Hmac::<Sha256>::new_from_slice(&self.0).ok()?;
        mac.update(DOMAIN);
        for number in [plant, controller, sequence] {
            mac.update(&number.to_le_bytes());
        }
        mac.update(command);
        Some(mac)
    }

    /// The tag of a command in packet `sequence` of the session that both `nonces` make, the plant's first.
    pub(super) fn sign(&self, nonces: [u32; 2], sequence: u32, frame: &CommandFrame) -> [u8; TAG_BYTES] {
        let whole = self.mac(nonces, sequence, frame).map(|mac| mac.finalize().into_bytes());
        let mut tag = [0; TAG_BYTES];
        for (to, from) in tag.iter_mut().zip(whole.into_iter().flatten()) {
            *to = from;
        }
        tag
    }

    /// Whether a tag is the command's, found out in a time that tells nothing about it.
    pub(super) fn verifies(
        &self,
        nonces: [u32; 2],
        sequence: u32,
        frame: &CommandFrame,
        tag: &[u8; TAG_BYTES],
    ) -> bool {
        self.mac(nonces, sequence, frame).is_some_and(|mac| mac.verify_truncated_left(tag).is_ok())
    }
}

#[cfg(test)]
mod tests {
    use super::super::message::Command;
    use super::*;
    use crate::mode::Request;
    use std::format;
    use std::string::String;

    /// The second test case of RFC 4231, over the same library.
    #[test]
    fn the_library_is_hmac_sha_256() {
        let mut mac = Hmac::<Sha256>::new_from_slice(b"Jefe").unwrap();
        mac.update(b"what do ya want for nothing?");
        let hex: std::vec::Vec<String> =
            mac.finalize().into_bytes().iter().map(|byte| format!("{byte:02x}")).collect();
        let hex = hex.concat();
        assert_eq!(hex, "5bdcc146bf60754e6a042426089575c75a003f089d2739839dec58b964ec3843");
    }

    #[test]
    fn a_tag_is_good_for_one_packet_of_one_session() {
        let key = Key::new([7; KEY_BYTES]);
        let frame = CommandFrame { id: 1, command: Command::Mode(Request::Arm) };
        let other = CommandFrame { id: 1, command: Command::Mode(Request::Resume) };
        let tag = key.sign([1, 2], 3, &frame);
        assert!(key.verifies([1, 2], 3, &frame, &tag));
        assert!(!key.verifies([1, 2], 4, &frame, &tag) && !key.verifies([1, 2], 3, &other, &tag));
        assert!(!key.verifies([2, 1], 3, &frame, &tag) && !key.verifies([1, 9], 3, &frame, &tag));
        assert!(!Key::new([8; KEY_BYTES]).verifies([1, 2], 3, &frame, &tag));
        for bit in 0..8 * TAG_BYTES {
            let mut turned = tag;
            turned[bit / 8] ^= 1 << (bit % 8);
            assert!(!key.verifies([1, 2], 3, &frame, &turned), "bit {bit}");
        }
    }

    #[test]
    fn keys_are_read_or_refused() {
        let hex = "00ff".repeat(16);
        assert_eq!(
            Key::from_hex(&format!(" {hex}\n")),
            Some(Key::new(core::array::from_fn(|i| if i % 2 == 0 { 0 } else { 255 })))
        );
        for wrong in ["", "00", &hex[1..], &format!("{hex}0"), &hex.replace('f', "g")] {
            assert_eq!(Key::from_hex(wrong), None, "{wrong}");
        }
        assert_eq!(format!("{:?}", Key::new([1; KEY_BYTES])), "Key(…)");
    }

    /// The bytes that `docs/protocol.md` shows are those that are made.
    #[test]
    fn the_documents_tag_is_the_codes() {
        let key = Key::new(core::array::from_fn(|i| i as u8));
        let frame = CommandFrame { id: 1, command: Command::Mode(Request::Arm) };
        let tag =
            key.sign([5, 7], 3, &frame).iter().fold(String::new(), |text, byte| format!("{text} {byte:02x}"));
        let document = include_str!("../../../docs/protocol.md");
        assert!(document.contains(&format!("tag  {tag}\n")), "docs/protocol.md lacks\ntag  {tag}");
    }
}
