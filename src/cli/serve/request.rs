//! What a browser asks for, and the status of the answer.

/// What is asked for, of a server that has one page.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Request {
    /// The page.
    Get,
    /// What would be said of the page.
    Head,
}

/// Why there is no page.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Refusal {
    NotARequest,
    NoSuchPage,
    /// A method other than GET and HEAD.
    WrongMethod,
    TooLong,
    TooSlow,
    /// The page of another site, whose name has been made to lead to this machine, must not read this one.
    WrongHost,
}

impl Refusal {
    /// As the first line of an answer has it.
    pub(super) fn status(self) -> &'static str {
        match self {
            Self::NotARequest => "400 Bad Request",
            Self::NoSuchPage => "404 Not Found",
            Self::WrongMethod => "405 Method Not Allowed",
            Self::TooSlow => "408 Request Timeout",
            Self::WrongHost => "421 Misdirected Request",
            Self::TooLong => "431 Request Header Fields Too Large",
        }
    }
}

impl Request {
    /// Reads a request of HTTP/1.0 or 1.1, up to the empty line behind its headers. `is_host` says which hosts are this one.
    pub(super) fn read(head: &[u8], is_host: impl Fn(&str) -> bool) -> Result<Self, Refusal> {
        let text = std::str::from_utf8(head).map_err(|_| Refusal::NotARequest)?;
        let mut lines = text.lines();
        let mut words = lines.next().unwrap_or_default().split(' ');
        let (Some(method), Some(target), Some(version), None) =
            (words.next(), words.next(), words.next(), words.next())
        else {
            return Err(Refusal::NotARequest);
        };
        let is_token = |c: u8| c.is_ascii_alphanumeric() || b"!#$%&'*+-.^_`|~".contains(&c);
        let is_method = !method.is_empty() && method.bytes().all(is_token);
        if !is_method || !target.starts_with(['/', '*']) {
            return Err(Refusal::NotARequest);
        }
        let host = host(lines.take_while(|line| !line.is_empty()))?;
        match (version, host) {
            ("HTTP/1.0", None) => {}
            ("HTTP/1.0" | "HTTP/1.1", Some(host)) if is_host(host) => {}
            ("HTTP/1.0" | "HTTP/1.1", Some(_)) => return Err(Refusal::WrongHost),
            _ => return Err(Refusal::NotARequest),
        }
        let path = target.split('?').next().unwrap_or_default();
        match (path, method) {
            ("/", "GET") => Ok(Self::Get),
            ("/", "HEAD") => Ok(Self::Head),
            ("/", _) => Err(Refusal::WrongMethod),
            _ => Err(Refusal::NoSuchPage),
        }
    }
}

/// The host of the headers, without its port.
fn host<'a>(lines: impl Iterator<Item = &'a str>) -> Result<Option<&'a str>, Refusal> {
    let mut host = None;
    for line in lines {
        let (name, value) = line.split_once(':').ok_or(Refusal::NotARequest)?;
        if name.is_empty() || name.contains(|c: char| c.is_whitespace() || c.is_control()) {
            return Err(Refusal::NotARequest);
        }
        if name.eq_ignore_ascii_case("host") && host.replace(value.trim()).is_some() {
            return Err(Refusal::NotARequest);
        }
    }
    Ok(host.map(without_port))
}

fn without_port(host: &str) -> &str {
    match host.rsplit_once(':') {
        Some((name, port)) if port.bytes().all(|c| c.is_ascii_digit()) => name,
        _ => host,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Request, Refusal> {
        Request::read(text.as_bytes(), |host| {
            host == "localhost" || host == "[::1]"
        })
    }

    #[test]
    fn the_page_is_at_the_root() {
        for host in [
            "Host: localhost",
            "host:localhost:8017",
            "HOST: [::1]:8017 ",
            "Accept: */*\r\nHost: [::1]",
        ] {
            for version in ["1.0", "1.1"] {
                let request = format!("/ HTTP/{version}\r\n{host}\r\n\r\n");
                assert_eq!(read(&format!("GET {request}")), Ok(Request::Get));
                assert_eq!(read(&format!("HEAD {request}")), Ok(Request::Head));
            }
        }
        assert_eq!(read("GET / HTTP/1.0\r\n\r\n"), Ok(Request::Get));
        assert_eq!(read("GET / HTTP/1.0\n\n"), Ok(Request::Get));
        assert_eq!(read("GET /?a=b HTTP/1.0\r\n\r\n"), Ok(Request::Get));
    }

    #[test]
    fn nothing_else_is_here() {
        for path in [
            "/favicon.ico",
            "//",
            "/..",
            "/../etc/passwd",
            "/%2e%2e",
            "*",
            "/index.html",
        ] {
            let request = format!("GET {path} HTTP/1.1\r\nHost: localhost\r\n\r\n");
            assert_eq!(read(&request), Err(Refusal::NoSuchPage), "{path}");
        }
        for method in ["POST", "PUT", "DELETE", "OPTIONS", "get", "X-1"] {
            let request = format!("{method} / HTTP/1.1\r\nHost: localhost\r\n\r\n");
            assert_eq!(read(&request), Err(Refusal::WrongMethod), "{method}");
        }
        for host in [
            "evil.example",
            "localhost.evil.example:8017",
            "",
            "::1:80",
            "localhost:80:x",
        ] {
            let request = format!("GET / HTTP/1.1\r\nHost: {host}\r\n\r\n");
            assert_eq!(read(&request), Err(Refusal::WrongHost), "{host}");
        }
    }

    #[test]
    fn what_is_no_request_is_told_so() {
        for text in [
            "",
            "\r\n\r\n",
            "GET /\r\n\r\n",
            "GET / HTTP/1.1\r\n\r\n",
            "GET / HTTP/2.0\r\nHost: localhost\r\n\r\n",
            "GET  / HTTP/1.0\r\n\r\n",
            "GET / HTTP/1.0 \r\n\r\n",
            "G(T / HTTP/1.0\r\n\r\n",
            "GET http://localhost/ HTTP/1.0\r\n\r\n",
            "GET / HTTP/1.0\r\nno colon\r\n\r\n",
            "GET / HTTP/1.0\r\n: empty\r\n\r\n",
            "GET / HTTP/1.0\r\nHost : localhost\r\n\r\n",
            "GET / HTTP/1.0\r\nHost: localhost\r\n Folded: x\r\n\r\n",
            "GET / HTTP/1.1\r\nHost: localhost\r\nHost: localhost\r\n\r\n",
        ] {
            assert_eq!(read(text), Err(Refusal::NotARequest), "{text:?}");
        }
        let bytes = b"GET / HTTP/1.0\r\nA: \xff\r\n\r\n";
        assert_eq!(Request::read(bytes, |_| true), Err(Refusal::NotARequest));
    }
}
