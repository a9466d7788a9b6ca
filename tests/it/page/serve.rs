//! `page --serve`: one page, for programs of this machine, whoever else is connected.

use std::io::{BufRead, BufReader, ErrorKind, Read, Write};
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr, TcpStream, UdpSocket};
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use crate::common::command::Workplace;

/// Longer than any answer takes on a machine that does much else.
const LONG: Duration = Duration::from_secs(60);

/// A server in a process of its own, which ends with it.
struct Served {
    child: Child,
    address: SocketAddr,
    workplace: Workplace,
}

impl Served {
    /// `page ball.json` at a free port.
    fn new() -> Self {
        Self::with("--serve=0")
    }

    fn with(flags: &str) -> Self {
        let workplace = Workplace::with_ball();
        let mut child = Command::new(env!("CARGO_BIN_EXE_photosurface"))
            .args("page ball.json -q".split(' ').chain(flags.split(' ')))
            .current_dir(workplace.path(""))
            .stdout(Stdio::piped())
            .spawn()
            .expect("the program starts");
        let mut line = String::new();
        let mut stdout = BufReader::new(child.stdout.take().expect("a pipe"));
        stdout.read_line(&mut line).expect("text");
        let address = line
            .strip_prefix("http://")
            .and_then(|rest| rest.strip_suffix("/\n"));
        let address = address.and_then(|address| address.parse().ok());
        Self {
            child,
            address: address.unwrap_or_else(|| panic!("no address: {line:?}")),
            workplace,
        }
    }

    fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect_timeout(&self.address, LONG).expect("it listens");
        stream.set_read_timeout(Some(LONG)).expect("a time");
        stream
    }

    /// The head of the answer to a request, and what follows it.
    fn ask(&self, request: &str) -> (String, Vec<u8>) {
        let mut stream = self.connect();
        stream.write_all(request.as_bytes()).expect("it reads");
        let mut answer = vec![];
        stream
            .read_to_end(&mut answer)
            .expect("an answer that ends");
        let end = answer.windows(4).position(|bytes| bytes == b"\r\n\r\n");
        let body = answer.split_off(end.expect("an empty line") + 4);
        (String::from_utf8(answer).expect("text"), body)
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

#[test]
fn the_page_is_served_as_it_would_be_written() {
    let served = Served::new();
    assert_eq!(served.address.ip(), IpAddr::V4(Ipv4Addr::LOCALHOST));
    let port = served.address.port();
    assert_eq!(
        served.workplace.files(),
        ["ball.json", "square.obj"],
        "nothing is written"
    );
    let page = served.workplace.run("page ball.json -o -").success().stdout;
    let head = format!(
        "HTTP/1.1 200 OK\r\nContent-Type: text/html; charset=utf-8\r\nContent-Length: {}\r\nCache-Control: no-store\r\n\
         X-Content-Type-Options: nosniff\r\nConnection: close\r\n\r\n",
        page.len()
    );
    for rest in [
        "/ HTTP/1.0\r\n\r\n".to_owned(),
        format!("/ HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nAccept: */*\r\n\r\n"),
        "/ HTTP/1.1\r\nhost: localhost:9000\r\nConnection: keep-alive\r\n\r\n".to_owned(),
    ] {
        let (found, body) = served.ask(&format!("GET {rest}"));
        assert_eq!(found, head);
        assert!(body == page);
        let (found, body) = served.ask(&format!("HEAD {rest}"));
        assert_eq!(found, head);
        assert!(body.is_empty());
    }
}

#[test]
fn nothing_else_is_served() {
    let served = Served::new();
    let huge = format!(
        "GET / HTTP/1.1\r\nHost: localhost\r\nA: {}",
        "a".repeat(500_000)
    );
    let posted = format!(
        "POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 100000\r\n\r\n{}",
        "a".repeat(100_000)
    );
    for (request, status) in [
        ("GET /ball.json HTTP/1.0\r\n\r\n", "404 Not Found"),
        ("GET /../ball.json HTTP/1.0\r\n\r\n", "404 Not Found"),
        (
            "GET /favicon.ico HTTP/1.1\r\nHost: localhost\r\n\r\n",
            "404 Not Found",
        ),
        (&posted, "405 Method Not Allowed"),
        ("DELETE / HTTP/1.0\r\n\r\n", "405 Method Not Allowed"),
        ("hello\r\n\r\n", "400 Bad Request"),
        ("\u{16}\u{3}\u{1}\r\n\r\n", "400 Bad Request"),
        ("GET / HTTP/1.1\r\n\r\n", "400 Bad Request"),
        (
            "GET / HTTP/1.1\r\nHost: evil.example\r\n\r\n",
            "421 Misdirected Request",
        ),
        (&huge, "431 Request Header Fields Too Large"),
    ] {
        let (head, body) = served.ask(request);
        let shown = &request[..request.len().min(60)];
        assert!(
            head.starts_with(&format!("HTTP/1.1 {status}\r\n")),
            "{shown:?}: {head}"
        );
        assert!(
            head.contains(&format!("\r\nContent-Length: {}\r\n", body.len())),
            "{head}"
        );
        assert!(
            head.contains("\r\nX-Content-Type-Options: nosniff\r\n"),
            "{head}"
        );
        assert_eq!(
            head.contains("\r\nAllow: GET, HEAD\r\n"),
            status.starts_with("405")
        );
        assert_eq!(body, status.as_bytes());
    }
    let (head, body) = served.ask("HEAD /nothing HTTP/1.0\r\n\r\n");
    assert!(head.starts_with("HTTP/1.1 404 "), "{head}");
    // It is there as before.
    assert!(
        !body.starts_with(b"<!doctype")
            && served
                .ask("GET / HTTP/1.0\r\n\r\n")
                .1
                .starts_with(b"<!doctype")
    );
}

#[test]
fn silent_and_slow_clients_keep_nobody_waiting() {
    let served = Served::new();
    let mut silent: Vec<_> = (0..20).map(|_| served.connect()).collect();
    for half in &mut silent[10..] {
        half.write_all(b"GET / HTTP/1.1\r\nHost:")
            .expect("it reads");
    }
    // One asks and does not listen to the answer.
    let mut deaf = served.connect();
    deaf.write_all(b"GET / HTTP/1.0\r\n\r\n").expect("it reads");
    let (head, _) = served.ask("GET / HTTP/1.0\r\n\r\n");
    assert!(head.starts_with("HTTP/1.1 200 "), "{head}");
    // The others had their answers not before the good one had its own.
    let mut byte = [0];
    for stream in &mut silent {
        stream.set_nonblocking(true).expect("a socket");
        let read = stream.read(&mut byte).map_err(|error| error.kind());
        assert_eq!(read, Err(ErrorKind::WouldBlock));
        stream.set_nonblocking(false).expect("a socket");
    }
    // In the end they are told.
    for stream in &mut silent {
        let mut answer = String::new();
        stream.read_to_string(&mut answer).expect("an answer");
        assert!(answer.starts_with("HTTP/1.1 408 "), "{answer}");
    }
}

#[test]
fn other_addresses_of_this_machine_are_not_bound() {
    let served = Served::new();
    let port = served.address.port();
    let mut others = vec![IpAddr::V6(Ipv6Addr::LOCALHOST)];
    if cfg!(target_os = "linux") {
        others.push(Ipv4Addr::new(127, 0, 0, 2).into());
    }
    // The address from which this machine would speak to another one: nothing is sent.
    let socket = UdpSocket::bind((Ipv4Addr::UNSPECIFIED, 0)).expect("a socket");
    if socket.connect((Ipv4Addr::new(192, 0, 2, 1), 9)).is_ok() {
        let own = socket.local_addr().expect("an address").ip();
        others.extend((!own.is_loopback()).then_some(own));
    }
    for other in others {
        let tried = TcpStream::connect_timeout(&SocketAddr::new(other, port), LONG);
        assert!(tried.is_err(), "{other} is bound");
    }
    assert!(TcpStream::connect(served.address).is_ok());
}

#[test]
fn another_address_is_bound_where_it_is_asked_for() {
    if cfg!(target_os = "linux") {
        let served = Served::with("--serve=0 --host 127.0.0.2");
        assert_eq!(served.address.ip(), IpAddr::from([127, 0, 0, 2]));
        assert!(
            served
                .ask("GET / HTTP/1.0\r\n\r\n")
                .0
                .starts_with("HTTP/1.1 200 ")
        );
        let here = SocketAddr::from((Ipv4Addr::LOCALHOST, served.address.port()));
        assert!(TcpStream::connect(here).is_err());
    }
}

#[test]
fn a_port_that_is_taken_is_told_and_the_usual_one_is_left() {
    let first = Served::with("--serve");
    let second = Served::with("--serve");
    assert_ne!(first.address, second.address);
    let port = second.address.port();
    let run = second
        .workplace
        .run(&format!("page ball.json --serve={port}"));
    run.error(&["--serve", &format!("127.0.0.1:{port}")]);
}

#[test]
fn impossible_flags_are_refused() {
    let workplace = Workplace::with_ball();
    for (flags, words) in [
        ("ball.json --serve -o out.html", "cannot be used with"),
        ("ball.json --host 127.0.0.1", "--serve"),
        ("ball.json --serve --host example.org", "--host"),
        ("ball.json --serve=70000", "--serve"),
        ("--serve 8017", "--serve=8017"),
        ("ball.json --serve=0 --host 192.0.2.1", "192.0.2.1"),
        ("nosuch.json --serve", "nosuch.json"),
    ] {
        workplace.run(&format!("page {flags}")).error(&[words]);
    }
}

#[test]
#[cfg(unix)]
fn an_interrupt_ends_it() {
    let mut served = Served::new();
    let pid = served.child.id().to_string();
    let sent = Command::new("kill").args(["-s", "INT", &pid]).status();
    assert!(sent.expect("kill is there").success());
    assert_eq!(served.child.wait().expect("it ends").code(), Some(130));
}
