//! The page's server against requests that are oversized, malformed, foreign, or slow: each is refused, nothing
//! panics, and whoever asks properly is answered all the while.

use std::io::{Read, Write};
use std::net::{Shutdown, SocketAddr, TcpStream};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use eclss_host_sim::Source;
use eclss_host_sim::serve::{Feed, Plant, Publisher, Server, feed};

static PANICS: AtomicUsize = AtomicUsize::new(0);

fn serving(control: bool) -> (Server, Publisher, Feed) {
    let source = Source::shipped().unwrap();
    let run = source.loaded.run;
    let settings = eclss_core::Settings { method: run.method, step_us: run.step_us };
    let plant = Plant::new(source, settings).unwrap();
    let (publisher, feed) = feed(plant.catalogue(control));
    let server = Server::start("127.0.0.1:0".parse().unwrap(), feed.clone(), Some("<svg/>".into())).unwrap();
    (server, publisher, feed)
}

/// Sends bytes and returns the status of the answer; `None` where the connection was closed without one.
fn status(address: SocketAddr, bytes: &[u8]) -> Option<u16> {
    let mut stream = TcpStream::connect(address).unwrap();
    stream.set_read_timeout(Some(Duration::from_secs(10))).unwrap();
    // A refusal may come before everything was sent.
    let _ = stream.write_all(bytes);
    let _ = stream.shutdown(Shutdown::Write);
    let mut answer = Vec::new();
    let _ = stream.read_to_end(&mut answer);
    let text = String::from_utf8_lossy(&answer);
    text.split(' ').nth(1)?.parse().ok()
}

fn get(address: SocketAddr, path: &str) -> Vec<u8> {
    format!("GET {path} HTTP/1.1\r\nHost: {address}\r\n\r\n").into_bytes()
}

fn post(address: SocketAddr, body: &str) -> Vec<u8> {
    post_to(address, "/command", body)
}

fn post_to(address: SocketAddr, path: &str, body: &str) -> Vec<u8> {
    let length = body.len();
    format!(
        "POST {path} HTTP/1.1\r\nHost: {address}\r\nOrigin: http://{address}\r\nContent-Type: application/json\r\n\
         Content-Length: {length}\r\n\r\n{body}"
    )
    .into_bytes()
}

/// Numbers from a seed (`SplitMix64`, Steele et al. 2014).
struct Dice(u64);

impl Dice {
    fn below(&mut self, most: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((mixed ^ (mixed >> 31)) % most.max(1) as u64) as usize
    }
}

/// A request that nobody should answer with more than a refusal.
fn hostile(dice: &mut Dice, address: SocketAddr) -> Vec<u8> {
    let line = |head: &str| format!("GET / HTTP/1.1\r\nHost: {address}\r\n{head}\r\n\r\n").into_bytes();
    match dice.below(17) {
        0 => line(&format!("X: {}", "a".repeat(9_000 + dice.below(60_000)))),
        1 => line(&"X: 1\r\n".repeat(60 + dice.below(200))),
        2 => get(address, &format!("/{}", "a/".repeat(5_000 + dice.below(20_000)))),
        3 => {
            let ways = [
                "/../../etc/passwd",
                "/..%2f..%2fetc%2fpasswd",
                "//etc/passwd",
                "/%2e%2e/%2e%2e/etc/passwd",
                "/..\\..\\windows\\win.ini",
                "/page.css/../../Cargo.toml",
                "/main.js%00.html",
                "/./index.html",
                "/.git/config",
            ];
            get(address, ways[dice.below(ways.len())])
        }
        4 => {
            let hosts =
                ["evil.example", "127.0.0.1.evil.example", "localhost", "[::1", "", "127.0.0.1:1", "0"];
            format!("GET / HTTP/1.1\r\nHost: {}\r\n\r\n", hosts[dice.below(hosts.len())]).into_bytes()
        }
        5 => {
            let origins =
                ["http://evil.example", "null", "https://127.0.0.1", "file://", "http://localhost:1"];
            line(&format!("Origin: {}", origins[dice.below(origins.len())]))
        }
        6 => line("Sec-Fetch-Site: cross-site"),
        7 => {
            let body = "{\"do\":\"pause\",\"on\":true}";
            let origin = format!("Origin: http://{address}");
            let text = String::from_utf8(post(address, body)).unwrap();
            text.replace(&origin, "Origin: http://evil.example").into_bytes()
        }
        8 => {
            let text = String::from_utf8(post(address, "{\"do\":\"pause\",\"on\":true}")).unwrap();
            text.replace("application/json", "text/plain").into_bytes()
        }
        9 => {
            let bodies = [
                "{}",
                "[",
                "\"do\"",
                "{\"do\":\"set\",\"input\":-1,\"value\":0}",
                "{\"do\":\"set\",\"input\":0,\"value\":\"1\"}",
                "{\"do\":\"step\",\"steps\":1e99}",
                "{\"do\":\"open\",\"file\":\"/etc/passwd\"}",
                "\u{0}",
            ];
            post(address, bodies[dice.below(bodies.len())])
        }
        10 => post(address, &"[".repeat(3_000)),
        11 => {
            let lengths = ["-1", "99999999999999999999", "1e3", "+5", "0x10", "5, 5", "8192"];
            line(&format!("Content-Length: {}", lengths[dice.below(lengths.len())]))
        }
        12 => {
            let starts = [
                "\r\n\r\n",
                "GET\r\n\r\n",
                "GET / HTTP/9.9\r\n\r\n",
                "\u{16}\u{3}\u{1}\u{2}\0\u{1}",
                "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n",
            ];
            starts[dice.below(starts.len())].as_bytes().to_vec()
        }
        13 => {
            let bodies = [
                "{\"network\":99}",
                "{\"network\":-1}",
                "{\"network\":\"/etc/passwd\"}",
                "{\"network\":0,\"file\":\"a\"}",
            ];
            post_to(address, "/networks", bodies[dice.below(bodies.len())])
        }
        14 => {
            let names = ["a", "../a", "/etc/cron.d/a", ".profile", "a\\u0000", "a/../b", "~/a"];
            post_to(address, "/recording", &format!("{{\"file\":\"{}\"}}", names[dice.below(names.len())]))
        }
        15 => {
            // One request after another, and two ways to say where a body ends.
            let twice = [get(address, "/"), get(address, "/")].concat();
            let text = String::from_utf8(post(address, "{\"do\":\"pause\",\"on\":true}")).unwrap();
            let both = text.replace("Content-Length", "Transfer-Encoding: chunked\r\nContent-Length");
            let lengths = text.replace("Content-Length", "Content-Length: 5\r\nContent-Length");
            let folded = text.replace("Origin", "X: a\r\n b\r\nOrigin");
            vec![twice, both.into_bytes(), lengths.into_bytes(), folded.into_bytes()]
                .swap_remove(dice.below(4))
        }
        _ => (0..dice.below(12_000)).map(|_| dice.below(256) as u8).collect(),
    }
}

#[test]
fn a_thousand_hostile_requests_are_refused_and_our_own_page_is_served_meanwhile() {
    let usual = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |info| {
        // Other tests have threads too.
        if matches!(std::thread::current().name(), Some("accept" | "frames" | "page")) {
            PANICS.fetch_add(1, Ordering::Relaxed);
        }
        usual(info);
    }));
    let (server, publisher, _feed) = serving(true);
    let address = server.address();
    let mut dice = Dice(7);
    let mut seen = std::collections::BTreeMap::new();
    for number in 0..1_000 {
        let request = hostile(&mut dice, address);
        let answer = status(address, &request);
        *seen.entry(answer).or_insert(0) += 1;
        let refused = answer.is_none_or(|status| (400..=599).contains(&status));
        assert!(
            refused,
            "{number}: {answer:?} to {}",
            String::from_utf8_lossy(&request[..request.len().min(300)])
        );
        if number % 100 == 0 {
            assert_eq!(status(address, &get(address, "/")), Some(200), "our own page");
        }
    }
    println!("{seen:?}");
    for wanted in [400, 403, 404, 413, 415, 421, 431, 501] {
        assert!(seen.contains_key(&Some(wanted)), "{wanted} was never the answer: {seen:?}");
    }
    assert!(publisher.command().is_none(), "none of them reached the plant");
    assert_eq!(status(address, &post(address, "{\"do\":\"pause\",\"on\":true}")), Some(204));
    assert!(publisher.command().is_some(), "our own command does");
    drop(server);
    assert_eq!(PANICS.load(Ordering::Relaxed), 0, "a thread panicked");
}

#[test]
fn without_control_no_command_is_taken() {
    let (server, publisher, _feed) = serving(false);
    let address = server.address();
    assert_eq!(status(address, &post(address, "{\"do\":\"pause\",\"on\":true}")), Some(403));
    assert!(publisher.command().is_none());
    assert_eq!(status(address, &get(address, "/network")), Some(200));
    assert_eq!(status(address, b""), None);
}

#[test]
fn slow_connections_are_given_up_and_hold_nobody_else_for_long() {
    let (server, _publisher, _feed) = serving(false);
    let address = server.address();
    let began = Instant::now();
    // More of them than there are places, each of which would like to take for ever.
    let mut slow: Vec<_> = (0..80).filter_map(|_| TcpStream::connect(address).ok()).collect();
    for stream in &mut slow {
        let _ = stream.write_all(b"GET / HTTP/1.1\r\nHo");
    }
    loop {
        for stream in &mut slow {
            let _ = stream.write_all(b"s");
        }
        if status(address, &get(address, "/")) == Some(200) {
            break;
        }
        assert!(began.elapsed() < Duration::from_secs(15), "never answered again");
        std::thread::sleep(Duration::from_millis(100));
    }
    // A place is given back after three seconds at most, however often a byte came.
    assert!(began.elapsed() < Duration::from_secs(6), "{:?}", began.elapsed());
}
