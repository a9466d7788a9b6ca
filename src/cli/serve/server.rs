//! The server: a thread for each of several browsers, none of which keeps others waiting.

use std::io::{self, ErrorKind, Read, Write};
use std::net::{IpAddr, Shutdown, SocketAddr, TcpListener, TcpStream};
use std::thread;
use std::time::{Duration, Instant};

use anyhow::Context;

use super::request::{Refusal, Request};

/// Browsers that are answered at once; others wait.
const THREADS: usize = 64;

/// Bytes of a request, up to the empty line behind its headers.
const MAX_REQUEST: usize = 16 * 1024;

/// How long a request takes at most, from the first to the last byte.
const REQUEST_TIME: Duration = Duration::from_secs(10);

/// How long an answer takes at most, besides the time of its bytes at the least rate.
const ANSWER_TIME: Duration = Duration::from_secs(30);
const MIN_BYTES_PER_SECOND: usize = 50_000;

/// How long, and for how many bytes, a refused client is listened to: an answer to one who still speaks would be lost.
const FAREWELL_TIME: Duration = Duration::from_secs(1);
const FAREWELL_BYTES: usize = 1 << 20;

/// A server of one page.
pub(in crate::cli) struct Server {
    listener: TcpListener,
    address: SocketAddr,
}

impl Server {
    /// A server that listens at the first of these ports that is free; 0 is any free port.
    pub(in crate::cli) fn bind(host: IpAddr, ports: &[u16]) -> anyhow::Result<Self> {
        let addresses: Vec<_> = ports
            .iter()
            .map(|&port| SocketAddr::new(host, port))
            .collect();
        let listener = TcpListener::bind(&*addresses);
        let named = || {
            addresses
                .first()
                .map_or(String::new(), SocketAddr::to_string)
        };
        let listener = listener.with_context(named)?;
        let address = listener.local_addr().context("the server's address")?;
        Ok(Self { listener, address })
    }

    /// Where a browser finds the page.
    pub(in crate::cli) fn url(&self) -> String {
        format!("http://{}/", self.address)
    }

    /// Answers browsers for ever.
    pub(in crate::cli) fn run(&self, page: &[u8]) -> anyhow::Result<()> {
        thread::scope(|scope| {
            for number in 0..THREADS {
                let thread = thread::Builder::new().name(format!("browser {number}"));
                let spawned = thread.spawn_scoped(scope, || self.answer_one_by_one(page));
                // Fewer threads do, if there is one.
                if number == 0 {
                    spawned.context("a thread of the server")?;
                }
            }
            Ok(())
        })
    }

    fn answer_one_by_one(&self, page: &[u8]) {
        loop {
            match self.listener.accept() {
                // A browser that breaks off is nobody's fault.
                Ok((stream, _)) => drop(self.answer(&stream, page, REQUEST_TIME)),
                // Such as too many open files: they become fewer.
                Err(_) => thread::sleep(Duration::from_millis(100)),
            }
        }
    }

    fn answer(&self, mut stream: &TcpStream, page: &[u8], time: Duration) -> io::Result<()> {
        let request = read_head(stream, Instant::now() + time)?
            .and_then(|head| Request::read(&head, |host| self.is_host(host)));
        let (status, kind, body) = match request {
            Ok(_) => ("200 OK", "text/html", page),
            Err(refusal) => {
                let status = refusal.status();
                (status, "text/plain", status.as_bytes())
            }
        };
        let mut head = format!(
            "HTTP/1.1 {status}\r\nContent-Type: {kind}; charset=utf-8\r\nContent-Length: {}\r\nCache-Control: no-store\r\n\
             X-Content-Type-Options: nosniff\r\nConnection: close\r\n",
            body.len()
        );
        if request == Err(Refusal::WrongMethod) {
            head.push_str("Allow: GET, HEAD\r\n");
        }
        head.push_str("\r\n");
        let seconds = (body.len() / MIN_BYTES_PER_SECOND) as u64;
        let deadline = Instant::now() + ANSWER_TIME + Duration::from_secs(seconds);
        write_until(stream, head.as_bytes(), deadline)?;
        if request != Ok(Request::Head) {
            write_until(stream, body, deadline)?;
        }
        stream.flush()?;
        stream.shutdown(Shutdown::Write)?;
        listen_on(stream)
    }

    /// Whether a request names this server as its host.
    fn is_host(&self, host: &str) -> bool {
        !is_of_this_machine(self.address.ip()) || names_this_machine(host)
    }
}

/// Whether nobody but programs of this machine reaches the address.
fn is_of_this_machine(address: IpAddr) -> bool {
    address.is_loopback()
}

/// Whether a host is this machine, whatever a server of names says of it.
fn names_this_machine(host: &str) -> bool {
    let literal = host
        .strip_prefix('[')
        .and_then(|host| host.strip_suffix(']'));
    let address: Option<IpAddr> = literal.unwrap_or(host).parse().ok();
    host.eq_ignore_ascii_case("localhost") || address.is_some_and(is_of_this_machine)
}

/// A request up to the empty line behind its headers.
fn read_head(mut stream: &TcpStream, deadline: Instant) -> io::Result<Result<Vec<u8>, Refusal>> {
    let mut head = Vec::new();
    let mut piece = [0; 4096];
    loop {
        let Some(left) = time_left(deadline) else {
            return Ok(Err(Refusal::TooSlow));
        };
        stream.set_read_timeout(Some(left))?;
        let count = match stream.read(&mut piece) {
            Ok(0) => return Ok(Err(Refusal::NotARequest)),
            Ok(count) => count,
            Err(error) if is_in_vain(&error) => continue,
            Err(error) => return Err(error),
        };
        // The end of the headers may have begun before.
        let from = head.len().saturating_sub(3);
        head.extend_from_slice(&piece[..count]);
        if let Some(end) = end_of_head(&head, from) {
            return Ok(match end <= MAX_REQUEST {
                true => {
                    head.truncate(end);
                    Ok(head)
                }
                false => Err(Refusal::TooLong),
            });
        }
        if head.len() > MAX_REQUEST {
            return Ok(Err(Refusal::TooLong));
        }
    }
}

/// Where the empty line ends; lines end with `\r\n`, or with `\n` as careless programs have it.
fn end_of_head(head: &[u8], from: usize) -> Option<usize> {
    (from..head.len()).find_map(|at| match &head[at..] {
        [b'\r', b'\n', b'\r', b'\n', ..] => Some(at + 4),
        [b'\n', b'\n', ..] => Some(at + 2),
        _ => None,
    })
}

fn write_until(mut stream: &TcpStream, mut bytes: &[u8], deadline: Instant) -> io::Result<()> {
    while !bytes.is_empty() {
        let left = time_left(deadline).ok_or(ErrorKind::TimedOut)?;
        stream.set_write_timeout(Some(left))?;
        match stream.write(bytes) {
            Ok(0) => return Err(ErrorKind::WriteZero.into()),
            Ok(count) => bytes = &bytes[count..],
            Err(error) if is_in_vain(&error) => {}
            Err(error) => return Err(error),
        }
    }
    Ok(())
}

/// Reads what a client still says, until it has heard the answer.
fn listen_on(mut stream: &TcpStream) -> io::Result<()> {
    let deadline = Instant::now() + FAREWELL_TIME;
    let (mut piece, mut heard) = ([0; 4096], 0);
    while let Some(left) = time_left(deadline) {
        stream.set_read_timeout(Some(left))?;
        match stream.read(&mut piece) {
            Ok(0) => break,
            Ok(count) => heard += count,
            Err(error) if is_in_vain(&error) => {}
            Err(error) => return Err(error),
        }
        if heard > FAREWELL_BYTES {
            break;
        }
    }
    Ok(())
}

/// The time until then, unless it is over.
fn time_left(deadline: Instant) -> Option<Duration> {
    let left = deadline.saturating_duration_since(Instant::now());
    (!left.is_zero()).then_some(left)
}

/// Whether nothing came in time, or a signal did.
fn is_in_vain(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    const HERE: IpAddr = IpAddr::V4(std::net::Ipv4Addr::LOCALHOST);

    /// What a client gets that says these pieces, one a little after the other, and then waits.
    fn answer_to(pieces: &[&[u8]], time: Duration) -> String {
        let server = Server::bind(HERE, &[0]).unwrap();
        let mut client = TcpStream::connect(server.address).unwrap();
        thread::scope(|scope| {
            scope.spawn(|| {
                let (stream, _) = server.listener.accept().unwrap();
                let _ = server.answer(&stream, b"the page", time);
            });
            for piece in pieces {
                client.write_all(piece).unwrap();
                thread::sleep(Duration::from_millis(30));
            }
            let mut answer = String::new();
            client.read_to_string(&mut answer).unwrap();
            answer
        })
    }

    #[test]
    fn requests_come_in_pieces() {
        let pieces: [&[u8]; 4] = [b"GET / HT", b"TP/1.0\r", b"\n\r", b"\n"];
        let answer = answer_to(&pieces, REQUEST_TIME);
        assert!(answer.starts_with("HTTP/1.1 200 OK\r\n"), "{answer}");
        assert!(answer.ends_with("\r\n\r\nthe page"), "{answer}");
    }

    #[test]
    fn slow_clients_are_told_so() {
        let answer = answer_to(
            &[b"GET / HTTP/1.1\r\n", b"Host:"],
            Duration::from_millis(200),
        );
        assert!(answer.starts_with("HTTP/1.1 408 "), "{answer}");
    }

    #[test]
    fn long_requests_are_refused_at_the_limit() {
        let of_length = |length: usize| {
            let (start, end) = ("GET / HTTP/1.0\r\nA: ", "\r\n\r\n");
            let value = "a".repeat(length - start.len() - end.len());
            let request = format!("{start}{value}{end}");
            answer_to(&[request.as_bytes()], REQUEST_TIME)
        };
        assert!(of_length(MAX_REQUEST).starts_with("HTTP/1.1 200 "));
        assert!(of_length(MAX_REQUEST + 1).starts_with("HTTP/1.1 431 "));
    }

    #[test]
    fn a_port_that_is_taken_is_told_or_left() {
        let taken = Server::bind(HERE, &[0]).unwrap();
        let port = taken.address.port();
        let error = Server::bind(HERE, &[port]).err().unwrap();
        assert!(
            format!("{error:#}").contains(&format!("127.0.0.1:{port}: ")),
            "{error:#}"
        );
        let other = Server::bind(HERE, &[port, 0]).unwrap();
        assert_ne!(other.address.port(), port);
    }

    #[test]
    fn only_this_machine_is_its_host() {
        for host in ["localhost", "LocalHost", "127.0.0.1", "127.1.2.3", "[::1]"] {
            assert!(names_this_machine(host), "{host}");
        }
        for host in [
            "",
            "evil.example",
            "localhost.evil.example",
            "192.168.0.1",
            "[fe80::1]",
            "[",
            "127.0.0.1.nip.io",
        ] {
            assert!(!names_this_machine(host), "{host}");
        }
    }
}
