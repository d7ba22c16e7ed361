//! Who is let in.

use httparse::EMPTY_HEADER;
use httparse::Request;
use std::fmt::Write;
use tungstenite::handshake::derive_accept_key;

/// The address, with its token.
pub struct Gate {
    port: u16,
    token: String,
}

/// What becomes of a request.
#[derive(Debug, PartialEq, Eq)]
pub enum Verdict {
    /// A status and a sentence.
    Refused(&'static str, &'static str),
    /// The file of this name, where there is one.
    File(String),
    /// The socket, with the answer to the browser's key.
    Socket(String),
}

const FORBIDDEN: &str = "403 Forbidden";

/// Whether two texts are equal, in a time that does not tell where they differ.
fn same(a: &str, b: &str) -> bool {
    a.len() == b.len() && a.bytes().zip(b.bytes()).fold(0, |differs, (a, b)| differs | (a ^ b)) == 0
}

impl Gate {
    /// For this port, with a new token.
    ///
    /// # Errors
    /// That the system has no random numbers.
    pub fn new(port: u16) -> Result<Self, String> {
        let mut bytes = [0; 16];
        getrandom::fill(&mut bytes).map_err(|fault| format!("no random token can be had: {fault}"))?;
        let mut token = String::new();
        for byte in bytes {
            let _ = write!(token, "{byte:02x}");
        }
        Ok(Self { port, token })
    }

    /// The first part of every path.
    pub fn token(&self) -> &str {
        &self.token
    }

    /// Whether a name is this server's own.
    fn is_own(&self, host: &str) -> bool {
        [format!("127.0.0.1:{}", self.port), format!("localhost:{}", self.port)].iter().any(|own| own == host)
    }

    /// Judges the head of a request.
    pub fn judge(&self, head: &[u8]) -> Verdict {
        let mut headers = [EMPTY_HEADER; 64];
        let mut request = Request::new(&mut headers);
        let whole = matches!(request.parse(head), Ok(httparse::Status::Complete(_)));
        let (Some(method), Some(path), true) = (request.method, request.path, whole) else {
            return Verdict::Refused("400 Bad Request", "this is no request\n");
        };
        let values = |name: &str| {
            let named = request.headers.iter().filter(|header| header.name.eq_ignore_ascii_case(name));
            named.map(|header| std::str::from_utf8(header.value).unwrap_or_default()).collect::<Vec<_>>()
        };
        let [host] = values("Host")[..] else {
            return Verdict::Refused("400 Bad Request", "a request names one host\n");
        };
        if !self.is_own(host) {
            return Verdict::Refused(
                FORBIDDEN,
                "this server has another name: use the address that it prints\n",
            );
        }
        let origins = values("Origin");
        let own_origin = |origin: &&str| origin.strip_prefix("http://") == Some(host);
        if !origins.iter().all(own_origin) {
            return Verdict::Refused(FORBIDDEN, "pages of other origins get nothing here\n");
        }
        let mut parts = path.split('?').next().unwrap_or_default().trim_start_matches('/').splitn(2, '/');
        if !same(parts.next().unwrap_or_default(), &self.token) {
            return Verdict::Refused(
                FORBIDDEN,
                "the address lacks the token: use the one that was printed\n",
            );
        }
        if method != "GET" {
            return Verdict::Refused("405 Method Not Allowed", "there is only GET here\n");
        }
        match parts.next() {
            None => Verdict::Refused("404 Not Found", "the address ends in a stroke\n"),
            Some("socket") => {
                match (origins.is_empty(), &values("Upgrade")[..], &values("Sec-WebSocket-Key")[..]) {
                    // Browsers always say whose page opens a socket.
                    (false, [upgrade], [key]) if upgrade.eq_ignore_ascii_case("websocket") => {
                        Verdict::Socket(derive_accept_key(key.as_bytes()))
                    }
                    _ => Verdict::Refused(FORBIDDEN, "here is a socket for the page\n"),
                }
            }
            Some("") => Verdict::File("index.html".to_owned()),
            Some(name) => Verdict::File(name.to_owned()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn judged(gate: &Gate, path: &str, headers: &str) -> Verdict {
        gate.judge(format!("GET {path} HTTP/1.1\r\n{headers}\r\n").as_bytes())
    }

    #[test]
    fn only_this_servers_pages_are_let_in() {
        let gate = Gate::new(8000).unwrap();
        let path = |rest: &str| format!("/{}/{rest}", gate.token());
        let own = "Host: 127.0.0.1:8000\r\n";
        let refused = |verdict: Verdict| matches!(verdict, Verdict::Refused(FORBIDDEN, _));
        assert_eq!(judged(&gate, &path(""), own), Verdict::File("index.html".into()));
        assert_eq!(judged(&gate, &path("page.js?1"), own), Verdict::File("page.js".into()));
        assert_eq!(judged(&gate, &path("x"), "Host: localhost:8000\r\n"), Verdict::File("x".into()));
        // A name that somebody else's server points here, other ports, other tokens, other origins.
        assert!(refused(judged(&gate, &path(""), "Host: evil.example:8000\r\n")));
        assert!(refused(judged(&gate, &path(""), "Host: 127.0.0.1:8001\r\n")));
        assert!(refused(judged(&gate, "/", own)));
        assert!(refused(judged(&gate, "/0123456789abcdef0123456789abcdef/", own)));
        let foreign = format!("{own}Origin: http://127.0.0.1:8001\r\n");
        assert!(refused(judged(&gate, &path(""), &foreign)));
        let nowhere = format!("{own}Origin: null\r\n");
        assert!(refused(judged(&gate, &path(""), &nowhere)));
        assert!(matches!(judged(&gate, &path(""), ""), Verdict::Refused("400 Bad Request", _)));
        assert!(matches!(gate.judge(b"\0\0\r\n\r\n"), Verdict::Refused("400 Bad Request", _)));
        let post = format!("POST {} HTTP/1.1\r\n{own}\r\n", path(""));
        assert!(matches!(gate.judge(post.as_bytes()), Verdict::Refused("405 Method Not Allowed", _)));
        assert_ne!(Gate::new(8000).unwrap().token(), gate.token());
    }

    #[test]
    fn a_socket_wants_an_origin() {
        let gate = Gate::new(8000).unwrap();
        let path = format!("/{}/socket", gate.token());
        let socket =
            "Host: localhost:8000\r\nUpgrade: websocket\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n";
        assert!(matches!(judged(&gate, &path, socket), Verdict::Refused(FORBIDDEN, _)));
        let foreign = format!("{socket}Origin: http://evil.example\r\n");
        assert!(matches!(judged(&gate, &path, &foreign), Verdict::Refused(FORBIDDEN, _)));
        let own = format!("{socket}Origin: http://localhost:8000\r\n");
        assert_eq!(judged(&gate, &path, &own), Verdict::Socket("s3pPLMBiTxaQ9kYGzzhZRbK+xOo=".into()));
    }
}
