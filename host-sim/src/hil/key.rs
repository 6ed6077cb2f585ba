//! The key of a link, and the number that makes each of its sessions another one.

use std::collections::hash_map::RandomState;
use std::hash::{BuildHasher as _, Hasher as _};
use std::path::Path;

use eclss_core::protocol::Key;
use eclss_target::wire::Address;

use crate::Failure;

/// Reads the key in a file.
pub fn read_key(path: &Path) -> Result<Key, Failure> {
    let bad = |why: &str| Failure::BadInput(format!("--key: {}: {why}", path.display()));
    let text = std::fs::read_to_string(path).map_err(|error| bad(&format!("cannot be read: {error}")))?;
    Key::from_hex(&text)
        .ok_or_else(|| bad("a key is 64 hexadecimal digits, as `openssl rand -hex 32` gives them"))
}

/// Refuses a plant's link that others can reach over a network, where nothing says who may command.
pub fn check_reach(address: &Address, key: Option<&Key>) -> Result<(), Failure> {
    match address {
        Address::Udp { local, .. } if !local.ip().is_loopback() && key.is_none() => {
            Err(Failure::BadInput(format!(
                "--link: whoever reaches {local} could arm hardware; name the key of those who may with --key FILE"
            )))
        }
        _ => Ok(()),
    }
}

/// A number that nobody can foretell, so that nothing that was recorded fits a later session.
pub fn fresh_nonce() -> u32 {
    // The standard library's hasher is keyed by the system's noise source.
    (RandomState::new().build_hasher().finish() as u32).max(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_this_computer_needs_no_key() {
        let reach = |text: &str, key: Option<&Key>| {
            let peer = text.starts_with("udp").then_some("10.0.0.2:9000");
            check_reach(&Address::read(text, peer).unwrap(), key).is_ok()
        };
        let key = Key::new([1; 32]);
        assert!(reach("udp:9001", None) && reach("unix:a.sock", None) && reach("serial:/dev/ttyACM0", None));
        for open in ["udp:0.0.0.0:9001", "udp:10.0.0.1:9001"] {
            assert!(!reach(open, None) && reach(open, Some(&key)), "{open}");
        }
    }

    #[test]
    fn nonces_differ() {
        let nonces: std::collections::BTreeSet<u32> = (0..1_000).map(|_| fresh_nonce()).collect();
        assert!(nonces.len() > 990 && !nonces.contains(&0), "{}", nonces.len());
    }
}
