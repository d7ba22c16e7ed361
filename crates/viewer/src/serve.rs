//! `rayview --serve`: the page from this program, for machines without a display, with the tracing done here.
//!
//! It listens on 127.0.0.1 alone. Whoever wants anything must know the random token in the address, and must come from
//! a page of this very address: pages of other origins, and names that others point here, are refused.
//! What can be had is a fixed list of files and one socket; no path of a request ever reaches the disk.

mod files;
mod gate;
mod session;

use files::PAGE;
use gate::Gate;
use gate::Verdict;
use std::io::Read;
use std::io::Write;
use std::net::Ipv4Addr;
use std::net::TcpListener;
use std::net::TcpStream;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicUsize;
use std::sync::atomic::Ordering;
use std::time::Duration;
use std::time::Instant;

/// Requests that are answered at a time.
const MOST_REQUESTS: usize = 64;

/// Pages that are served at a time: each has the scene in memory once more.
const MOST_PAGES: usize = 4;

/// What the head of a request may have in bytes, and how long it may take.
const MOST_HEAD: usize = 16 << 10;
const HEAD_TIME: Duration = Duration::from_secs(5);

/// A count that falls again where this is dropped.
struct Counted(Arc<AtomicUsize>);

impl Counted {
    fn below(most: usize, count: &Arc<AtomicUsize>) -> Option<Self> {
        let counted = Self(count.clone());
        (count.fetch_add(1, Ordering::SeqCst) < most).then_some(counted)
    }
}

impl Drop for Counted {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::SeqCst);
    }
}

/// What all requests share.
struct Served {
    gate: Gate,
    scene: Option<PathBuf>,
    pages: Arc<AtomicUsize>,
}

/// Serves the page until the process is ended; without a scene the page takes what is dropped on it, and traces by
/// itself.
///
/// # Errors
/// Why the port cannot be had.
pub fn run(scene: Option<PathBuf>, port: u16) -> Result<(), String> {
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).map_err(|fault| {
        format!("cannot listen on port {port} of 127.0.0.1: {fault}; name another by --port")
    })?;
    let port = listener.local_addr().map_err(|fault| fault.to_string())?.port();
    let gate = Gate::new(port)?;
    println!("rayview: http://127.0.0.1:{port}/{}/", gate.token());
    println!("rayview: whoever has this address sees and writes the scene; Ctrl + C ends it");
    let served = Arc::new(Served { gate, scene, pages: Arc::default() });
    let requests = Arc::default();
    for stream in listener.incoming() {
        // Somebody who is gone already, or no thread to be had: the next one may fare better.
        let Ok(stream) = stream else { continue };
        let Some(counted) = Counted::below(MOST_REQUESTS, &requests) else { continue };
        let served = served.clone();
        let _ = std::thread::Builder::new().spawn(move || {
            let _counted = counted;
            // Whoever is not answered has gone.
            let _ = answer(stream, &served);
        });
    }
    Ok(())
}

fn answer(mut stream: TcpStream, served: &Served) -> std::io::Result<()> {
    stream.set_write_timeout(Some(Duration::from_secs(20)))?;
    let Some(head) = head(&mut stream)? else { return Ok(()) };
    match served.gate.judge(&head) {
        Verdict::Refused(status, why) => {
            respond(&mut stream, status, "text/plain; charset=utf-8", &[], why.as_bytes())
        }
        Verdict::File(name) => match PAGE.iter().find(|file| file.name == name) {
            Some(file) if file.name == "index.html" && served.scene.is_some() => {
                let text =
                    String::from_utf8_lossy(file.bytes).replace("data-socket=\"\"", "data-socket=\"socket\"");
                respond(&mut stream, "200 OK", file.kind, &[], text.as_bytes())
            }
            Some(file) => {
                let packed: &[&str] = if file.packed { &["Content-Encoding: gzip"] } else { &[] };
                respond(&mut stream, "200 OK", file.kind, packed, file.bytes)
            }
            None => respond(&mut stream, "404 Not Found", "text/plain", &[], b"there is no such file\n"),
        },
        Verdict::Socket(accept) => {
            let counted = Counted::below(MOST_PAGES, &served.pages);
            let (Some(_counted), Some(scene)) = (counted, &served.scene) else {
                return respond(
                    &mut stream,
                    "503 Service Unavailable",
                    "text/plain",
                    &[],
                    b"too many pages\n",
                );
            };
            let head = "HTTP/1.1 101 Switching Protocols\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n";
            write!(stream, "{head}Sec-WebSocket-Accept: {accept}\r\n\r\n")?;
            session::run(stream, scene);
            Ok(())
        }
    }
}

/// The head of a request; `None` where there is none in time, or too much of it.
fn head(stream: &mut TcpStream) -> std::io::Result<Option<Vec<u8>>> {
    let start = Instant::now();
    let mut head = Vec::new();
    let mut piece = [0; 2048];
    while !head.windows(4).any(|end| end == b"\r\n\r\n") {
        let Some(left) = HEAD_TIME.checked_sub(start.elapsed()).filter(|left| !left.is_zero()) else {
            return Ok(None);
        };
        stream.set_read_timeout(Some(left))?;
        let count = stream.read(&mut piece)?;
        head.extend_from_slice(piece.get(..count).unwrap_or_default());
        if count == 0 || head.len() > MOST_HEAD {
            return Ok(None);
        }
    }
    Ok(Some(head))
}

/// What a page of ours may do: run what came from here, and talk to here.
const POLICY: &str = "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; worker-src 'self'; \
                      style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; connect-src 'self'; \
                      base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

fn respond(
    stream: &mut TcpStream,
    status: &str,
    kind: &str,
    more: &[&str],
    body: &[u8],
) -> std::io::Result<()> {
    let mut head = format!(
        "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {}\r\nContent-Security-Policy: {POLICY}\r\n",
        body.len()
    );
    let always = [
        "Connection: close",
        "Cache-Control: no-store",
        "Referrer-Policy: no-referrer",
        "X-Content-Type-Options: nosniff",
        "Cross-Origin-Resource-Policy: same-origin",
        "Cross-Origin-Opener-Policy: same-origin",
        // With this one the page may share memory with its tracers.
        "Cross-Origin-Embedder-Policy: require-corp",
    ];
    for line in always.iter().chain(more) {
        head.push_str(line);
        head.push_str("\r\n");
    }
    head.push_str("\r\n");
    stream.write_all(head.as_bytes())?;
    stream.write_all(body)?;
    stream.flush()
}
