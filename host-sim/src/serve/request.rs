//! Reads one HTTP request, and refuses whatever is too long, too slow or not from our own page.
//!
//! A page in the same browser may send requests here too. So the `Host` must be this server's own address (otherwise a
//! foreign name could be pointed at it), and where the browser tells an `Origin` or a `Sec-Fetch-Site` it must be
//! ours.

use std::io::{ErrorKind, Read};
use std::net::{IpAddr, SocketAddr, TcpStream};
use std::time::{Duration, Instant};

/// Longest head [bytes].
pub(super) const HEAD: usize = 8 << 10;
/// Longest body [bytes].
pub(super) const BODY: usize = 4 << 10;
/// Time for a whole request, so that a slow one does not hold a thread.
pub(super) const PATIENCE: Duration = Duration::from_secs(3);
/// Most header lines.
const HEADERS: usize = 48;

/// A request that may be answered.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Request {
    /// `GET`, `HEAD` or `POST`.
    pub(super) method: String,
    /// Path, without query.
    pub(super) path: String,
    /// Body of a `POST`.
    pub(super) body: Vec<u8>,
}

/// A status with a reason for people.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Refusal(pub(super) u16, pub(super) &'static str);

const TOO_SLOW: Refusal = Refusal(408, "the request took too long");
const MALFORMED: Refusal = Refusal(400, "not a request");

/// Reads a request from `stream`, at which the server listens as `own`. `None` where nobody asked anything.
pub(super) fn read(stream: &mut TcpStream, own: SocketAddr) -> Result<Option<Request>, Refusal> {
    let until = Instant::now() + PATIENCE;
    let mut bytes = Vec::with_capacity(1024);
    loop {
        let end = end_of_head(&bytes);
        if end.unwrap_or(bytes.len()) > HEAD {
            return Err(Refusal(431, "the head of the request is too long"));
        }
        if let Some(end) = end {
            let (head, length) = parse(&bytes[..end], own)?;
            let mut body = bytes.split_off(end);
            while body.len() < length {
                if !more(stream, &mut body, until)? {
                    return Err(MALFORMED);
                }
            }
            if body.len() > length {
                return Err(Refusal(400, "more than one request"));
            }
            return Ok(Some(Request { body, ..head }));
        }
        if !more(stream, &mut bytes, until)? {
            return if bytes.is_empty() { Ok(None) } else { Err(MALFORMED) };
        }
    }
}

fn end_of_head(bytes: &[u8]) -> Option<usize> {
    bytes.windows(4).position(|window| window == b"\r\n\r\n").map(|at| at + 4)
}

/// Reads some more; false at the end.
fn more(stream: &mut TcpStream, bytes: &mut Vec<u8>, until: Instant) -> Result<bool, Refusal> {
    let left = until.checked_duration_since(Instant::now()).filter(|left| !left.is_zero()).ok_or(TOO_SLOW)?;
    stream.set_read_timeout(Some(left)).map_err(|_| MALFORMED)?;
    let mut part = [0; 1024];
    match stream.read(&mut part) {
        Ok(0) => Ok(false),
        Ok(count) => {
            bytes.extend_from_slice(&part[..count]);
            Ok(true)
        }
        Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => Err(TOO_SLOW),
        Err(error) if error.kind() == ErrorKind::Interrupted => Ok(true),
        Err(_) => Ok(false),
    }
}

/// Checks a whole head; returns the request without its body and the length of that.
fn parse(head: &[u8], own: SocketAddr) -> Result<(Request, usize), Refusal> {
    let mut headers = [httparse::EMPTY_HEADER; HEADERS];
    let mut parsed = httparse::Request::new(&mut headers);
    match parsed.parse(head) {
        Ok(httparse::Status::Complete(_)) => {}
        Err(httparse::Error::TooManyHeaders) => return Err(Refusal(431, "too many headers")),
        Ok(httparse::Status::Partial) | Err(_) => return Err(MALFORMED),
    }
    let all = |name: &str| -> Result<Option<&str>, Refusal> {
        let mut found = parsed.headers.iter().filter(|header| header.name.eq_ignore_ascii_case(name));
        let first = found.next().map(|header| std::str::from_utf8(header.value)).transpose();
        // Two of them are a way to tell two programs different things.
        if found.next().is_some() { Err(MALFORMED) } else { first.map_err(|_| MALFORMED) }
    };
    let host = all("host")?.ok_or(Refusal(400, "no host"))?;
    if !is_own_host(host, own) {
        return Err(Refusal(421, "this is not the host that was asked for"));
    }
    if all("origin")?.is_some_and(|origin| origin.strip_prefix("http://") != Some(host)) {
        return Err(Refusal(403, "asked by another site's page"));
    }
    if all("sec-fetch-site")?.is_some_and(|site| !matches!(site, "same-origin" | "none")) {
        return Err(Refusal(403, "asked by another site's page"));
    }
    if all("transfer-encoding")?.is_some() || all("expect")?.is_some() {
        return Err(Refusal(501, "only plain bodies are read"));
    }
    let length = match all("content-length")? {
        None => 0,
        Some(text) if text.len() <= 9 && text.bytes().all(|byte| byte.is_ascii_digit()) => {
            text.parse().map_err(|_| MALFORMED)?
        }
        Some(_) => return Err(MALFORMED),
    };
    if length > BODY {
        return Err(Refusal(413, "the body is too long"));
    }
    let method = parsed.method.unwrap_or_default();
    if !matches!(method, "GET" | "HEAD" | "POST") {
        return Err(Refusal(405, "only GET, HEAD and POST"));
    }
    if method == "POST" && all("content-type")? != Some("application/json") {
        // Other types are those that a foreign page may send without asking first.
        return Err(Refusal(415, "commands are application/json"));
    }
    if method != "POST" && length > 0 {
        return Err(MALFORMED);
    }
    let target = parsed.path.unwrap_or_default();
    let path = target.split('?').next().unwrap_or_default();
    if !path.starts_with('/') {
        return Err(MALFORMED);
    }
    Ok((Request { method: method.to_owned(), path: path.to_owned(), body: Vec::new() }, length))
}

/// Whether a `Host` names this server: by `localhost` or a loopback address where it listens there, else by any plain
/// address. A name that someone registered is never ours.
fn is_own_host(host: &str, own: SocketAddr) -> bool {
    let (name, port) = match host.rsplit_once(':') {
        // A sign is no part of a port, though it is one of a number.
        Some((name, port)) if port.bytes().all(|byte| byte.is_ascii_digit()) => (name, port.parse().ok()),
        _ => (host, Some(80)),
    };
    let address = match name.strip_prefix('[').and_then(|rest| rest.strip_suffix(']')) {
        Some(inside) => inside.parse().map(IpAddr::V6).ok(),
        None => name.parse().map(IpAddr::V4).ok(),
    };
    let named = match address {
        Some(address) => !own.ip().is_loopback() || address.is_loopback(),
        None => name.eq_ignore_ascii_case("localhost"),
    };
    named && port == Some(own.port())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn own() -> SocketAddr {
        "127.0.0.1:8000".parse().unwrap()
    }

    fn refused(head: &str) -> u16 {
        parse(head.as_bytes(), own()).unwrap_err().0
    }

    #[test]
    fn our_own_page_is_answered() {
        for host in ["127.0.0.1:8000", "localhost:8000", "[::1]:8000"] {
            let head = format!("GET /a?b=c HTTP/1.1\r\nHost: {host}\r\nOrigin: http://{host}\r\n\r\n");
            assert_eq!(parse(head.as_bytes(), own()).unwrap().0.path, "/a", "{host}");
        }
        let post = "POST /c HTTP/1.1\r\nHost: localhost:8000\r\nContent-Type: application/json\r\nContent-Length: 12\r\n\r\n";
        assert_eq!(parse(post.as_bytes(), own()).unwrap().1, 12);
    }

    #[test]
    fn everybody_else_is_not() {
        let with = |rest: &str| format!("GET / HTTP/1.1\r\nHost: localhost:8000\r\n{rest}\r\n\r\n");
        for (head, status) in [
            ("GET / HTTP/1.1\r\n\r\n".to_owned(), 400),
            ("GET / HTTP/1.1\r\nHost: evil.example:8000\r\n\r\n".into(), 421),
            ("GET / HTTP/1.1\r\nHost: localhost:80\r\n\r\n".into(), 421),
            ("GET / HTTP/1.1\r\nHost: 10.0.0.1:8000\r\n\r\n".into(), 421),
            ("GET / HTTP/1.1\r\nHost: [[127.0.0.1]]:8000\r\n\r\n".into(), 421),
            ("GET / HTTP/1.1\r\nHost: [127.0.0.1]:8000\r\n\r\n".into(), 421),
            ("GET / HTTP/1.1\r\nHost: ::1:8000\r\n\r\n".into(), 421),
            ("GET / HTTP/1.1\r\nHost: 127.0.0.1:+8000\r\n\r\n".into(), 421),
            ("GET / HTTP/1.1\r\nHost: 127.0.0.1:\r\n\r\n".into(), 421),
            ("GET / HTTP/1.1\r\nHost: localhost.:8000\r\n\r\n".into(), 421),
            ("GET / HTTP/1.1\r\nHost: a@127.0.0.1:8000\r\n\r\n".into(), 421),
            (with("Host: localhost:8000"), 400),
            (with("Origin: http://evil.example"), 403),
            (with("Origin: null"), 403),
            (with("Sec-Fetch-Site: cross-site"), 403),
            (with("Transfer-Encoding: chunked"), 501),
            (with("Content-Length: -1"), 400),
            (with("Content-Length: 99999999999999999999"), 400),
            (with("Content-Length: 5000"), 413),
            ("POST / HTTP/1.1\r\nHost: localhost:8000\r\nContent-Type: text/plain\r\n\r\n".into(), 415),
            ("DELETE / HTTP/1.1\r\nHost: localhost:8000\r\n\r\n".into(), 405),
            ("GET http://evil.example/ HTTP/1.1\r\nHost: localhost:8000\r\n\r\n".into(), 400),
            ("\0\0\0\0\r\n\r\n".into(), 400),
        ] {
            assert_eq!(refused(&head), status, "{head}");
        }
    }

    #[test]
    fn on_another_address_only_plain_addresses_are_hosts() {
        let own = "0.0.0.0:80".parse().unwrap();
        assert!(
            is_own_host("10.0.0.1", own) && is_own_host("10.0.0.1:80", own) && is_own_host("[fe80::1]", own)
        );
        assert!(!is_own_host("evil.example", own) && !is_own_host("10.0.0.1:81", own));
    }
}
