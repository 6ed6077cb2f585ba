//! Wires of every kind, with somebody at the other end in this program.

use super::*;
use std::io::{Read as _, Write as _};
use std::net::UdpSocket;
use std::os::unix::net::UnixListener;
use std::path::PathBuf;
use std::time::Instant;

fn until(mut done: impl FnMut() -> bool) {
    let begun = Instant::now();
    while !done() {
        assert!(begun.elapsed() < Duration::from_secs(10), "it never happens");
        std::thread::sleep(Duration::from_millis(1));
    }
}

fn socket(name: &str) -> PathBuf {
    std::env::temp_dir().join(format!("eclss-{}-{name}.sock", std::process::id()))
}

#[test]
fn a_lost_socket_comes_back_by_itself() {
    let path = socket("lost");
    let _ = std::fs::remove_file(&path);
    let address = Address::Unix { path: path.clone(), listens: false };
    let (mut link, _keeper) = open(&address).unwrap();
    let mut buffer = [0; 64];
    assert_eq!((link.read(&mut buffer), link.write(b"nobody")), (0, 6));
    let listener = UnixListener::bind(&path).unwrap();
    for round in 1..=3 {
        let (mut other, _) = listener.accept().unwrap();
        other.write_all(b"hello").unwrap();
        let mut length = 0;
        until(|| {
            length = link.read(&mut buffer);
            length > 0
        });
        assert_eq!(&buffer[..length], b"hello");
        assert_eq!(link.write(b"yes"), 3);
        other.read_exact(&mut buffer[..3]).unwrap();
        assert_eq!(&buffer[..3], b"yes");
        drop(other);
        until(|| link.read(&mut buffer) == 0 && !link.is_open());
        assert_eq!((link.counts().opened, link.counts().lost), (round, round));
    }
    assert_eq!(link.counts().bytes_unsent, 6);
    let _ = std::fs::remove_file(path);
}

/// A pseudo-terminal stands in for the port: raw bytes of every value, both ways, and a port that goes away.
#[test]
fn a_serial_port_carries_every_byte() {
    use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
    let other = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY).unwrap();
    grantpt(&other).unwrap();
    unlockpt(&other).unwrap();
    let name = ptsname(&other, Vec::new()).unwrap();
    let path = PathBuf::from(name.to_str().unwrap());
    let mut other = std::fs::File::from(other);
    let (mut link, _keeper) = open(&Address::Serial { path, baud: 921_600 }).unwrap();
    until(|| {
        link.renew();
        link.is_open()
    });
    let bytes: Vec<u8> = (0..=255).collect();
    other.write_all(&bytes).unwrap();
    let (mut all, mut buffer) = (Vec::new(), [0; 256]);
    until(|| {
        let length = link.read(&mut buffer);
        all.extend_from_slice(&buffer[..length]);
        all.len() == bytes.len()
    });
    assert_eq!(all, bytes);
    assert_eq!(link.write(&bytes), bytes.len());
    other.read_exact(&mut buffer).unwrap();
    assert_eq!(buffer.as_slice(), bytes);
    drop(other);
    until(|| link.read(&mut buffer) == 0 && !link.is_open());
}

#[test]
fn others_can_connect_to_us() {
    let path = socket("listens");
    let address = Address::Unix { path: path.clone(), listens: true };
    let (mut link, _keeper) = open(&address).unwrap();
    let mut other = UnixStream::connect(&path).unwrap();
    other.write_all(b"hello").unwrap();
    let mut buffer = [0; 64];
    until(|| link.read(&mut buffer) == 5);
}

/// A socket left by a killed program is taken over; a socket in use is refused, and so is a file.
#[test]
fn a_socket_that_was_left_behind_is_taken_over() {
    let path = socket("stale");
    let _ = std::fs::remove_file(&path);
    drop(UnixListener::bind(&path).unwrap());
    assert!(path.exists(), "nobody removed it");
    let address = Address::Unix { path: path.clone(), listens: true };
    let (first, keeper) = open(&address).unwrap();
    assert!(open(&address).is_err(), "somebody listens");
    drop((first, keeper));
    std::fs::write(&path, "a file").unwrap();
    assert!(open(&address).is_err());
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "a file");
    std::fs::remove_file(path).unwrap();
}

/// A side that does not read cannot make a call wait, and gets everything that was taken, in order.
#[test]
fn a_side_that_does_not_keep_up_makes_nobody_wait() {
    let path = socket("slow");
    let address = Address::Unix { path: path.clone(), listens: true };
    let (mut link, _keeper) = open(&address).unwrap();
    let mut other = UnixStream::connect(&path).unwrap();
    until(|| {
        link.renew();
        link.is_open()
    });
    let mut sent = Vec::new();
    for number in 0..10_000u32 {
        let begun = Instant::now();
        let bytes = [number.to_le_bytes(); 25].concat();
        sent.extend_from_slice(&bytes[..link.write(&bytes)]);
        assert!(begun.elapsed() < Duration::from_secs(1));
    }
    assert!(sent.len() < 1_000_000);
    other.set_read_timeout(Some(Duration::from_millis(200))).unwrap();
    let mut all = Vec::new();
    // Ends with the time-out, after everything that is there.
    let _ = other.read_to_end(&mut all);
    assert!(all == sent);
}

/// Of what waits, the newest whole frames are left, and the frame that was read in part is read to its end.
#[test]
fn the_newest_frames_are_kept() {
    let (mut link, mut other) = pair().unwrap();
    let frame = |number: u32| {
        [[number as u8 | 1; 30].as_slice(), &number.to_le_bytes().map(|byte| byte | 1), &[0]].concat()
    };
    let sent: Vec<Vec<u8>> = (0..1_500).map(|number| frame(2 * number)).collect();
    assert_eq!(other.write(&sent.concat()), 1_500 * 35);
    let mut buffer = [0; 256];
    assert_eq!(link.read(&mut buffer[..20]), 20);
    link.skip(200);
    let length = link.read(&mut buffer);
    assert_eq!(buffer[..15], sent[0][20..], "the frame that had begun");
    let kept: Vec<&[u8]> = buffer[15..length].split_inclusive(|byte| *byte == 0).collect();
    assert_eq!(kept, &sent[1_500 - kept.len()..]);
    assert_eq!(kept.len(), 5, "as many as fit");
    assert_eq!(link.counts().bytes_skipped, (1_500 - 1 - 5) * 35);
    // Bytes that end no frame are dropped as a whole; the frames after them are read.
    assert_eq!(other.write(&[7; 1_000]), 1_000);
    link.skip(200);
    assert_eq!(link.read(&mut buffer), 0);
    other.write(&[&[7, 0], &sent[3][..]].concat());
    link.skip(200);
    assert_eq!(link.read(&mut buffer), 37);
}

/// Datagrams come out as one stream of bytes, whatever is asked for at a time.
#[test]
fn datagrams_larger_than_a_call_are_not_cut() {
    let ours = UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
    let peer = UdpSocket::bind("127.0.0.1:0").unwrap();
    let address = Address::Udp { local: ours, peer: peer.local_addr().unwrap() };
    let (mut link, _keeper) = open(&address).unwrap();
    until(|| {
        link.renew();
        link.is_open()
    });
    let sent: Vec<u8> = (0..1_500u32).map(|number| number as u8).collect();
    for part in sent.chunks(700) {
        peer.send_to(part, ours).unwrap();
    }
    let (mut all, mut buffer) = (Vec::new(), [0; 256]);
    until(|| {
        let length = link.read(&mut buffer);
        all.extend_from_slice(&buffer[..length]);
        all.len() == sent.len()
    });
    assert!(all == sent);
}

#[test]
fn over_udp_only_the_listed_peer_is_heard() {
    let ours = UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
    let (peer, foreign) = (UdpSocket::bind("127.0.0.1:0").unwrap(), UdpSocket::bind("127.0.0.1:0").unwrap());
    let address = Address::Udp { local: ours, peer: peer.local_addr().unwrap() };
    let (mut link, _keeper) = open(&address).unwrap();
    until(|| {
        link.renew();
        link.is_open()
    });
    let mut buffer = [0; 64];
    for _ in 0..1_000 {
        foreign.send_to(b"foreign", ours).unwrap();
    }
    peer.send_to(b"peer", ours).unwrap();
    let mut heard = Vec::new();
    until(|| {
        let length = link.read(&mut buffer);
        heard.push(buffer[..length].to_vec());
        length > 0
    });
    assert_eq!(heard.last().map(Vec::as_slice), Some(b"peer".as_slice()));
    assert!(heard.iter().all(|bytes| bytes.is_empty() || bytes == b"peer"));
    assert_eq!(link.write(b"answer"), 6);
    assert_eq!(peer.recv(&mut buffer).unwrap(), 6);
}
