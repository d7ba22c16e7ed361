//! One page and its tracer: a socket, a thread that traces, and one that packs what goes to the page, so that nothing
//! the page asks waits for a picture to be packed.

use crate::bundle::Bundle;
use crate::bundle::Recorder;
use crate::clerk::Clerk;
use crate::host::Home;
use crate::letters::Next;
use crate::letters::Receiver;
use crate::letters::letters;
use crate::link::Wake;
use crate::memory;
use crate::watch::Watch;
use crate::wire;
use crate::wire::Ask;
use crate::wire::Sent;
use crate::wire::Tell;
use dotray_render::PrepareOptions;
use dotray_render::Textures;
use dotray_scene::files::Disk;
use dotray_scene::load::LoadOptions;
use dotray_scene::load::load;
use dotray_scene::resolve::resolve;
use std::io::ErrorKind;
use std::net::TcpStream;
use std::path::Path;
use std::sync::Arc;
use std::sync::Mutex;
use std::sync::PoisonError;
use std::sync::atomic::Ordering;
use std::sync::mpsc;
use std::time::Duration;
use std::time::Instant;
use tungstenite::Message;
use tungstenite::WebSocket;
use tungstenite::protocol::Role;
use tungstenite::protocol::WebSocketConfig;

/// For how long the page is listened to before the tracer is.
const TURN: Duration = Duration::from_millis(4);

/// For how long a message may be on its way: a page that takes nothing any more is gone.
const MOST_UNSENT: Duration = Duration::from_secs(60);

/// Bytes that a message of the page may have: a scene's file that is written back is the largest.
const MOST_ASKED: usize = 256 << 20;

/// The scene as the page has it: what the tracer reads, too.
type Current = Arc<Mutex<Arc<Bundle>>>;

fn current(bundle: &Current) -> Arc<Bundle> {
    bundle.lock().unwrap_or_else(PoisonError::into_inner).clone()
}

struct Session<'a> {
    socket: WebSocket<TcpStream>,
    scene: &'a Path,
    bundle: Current,
    watch: Option<Watch>,
    /// Where tells are packed.
    packer: mpsc::Sender<Tell>,
    /// Since when the wire has not taken the last message whole.
    unsent_since: Option<Instant>,
}

fn is_waiting(fault: &std::io::Error) -> bool {
    matches!(fault.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut)
}

/// Serves a page until it goes.
pub fn run(stream: TcpStream, scene: &Path) {
    let prepared = stream.set_read_timeout(Some(TURN)).and(stream.set_write_timeout(Some(TURN)));
    if prepared.and(stream.set_nodelay(true)).is_err() {
        return;
    }
    let config =
        WebSocketConfig::default().max_message_size(Some(MOST_ASKED)).max_frame_size(Some(MOST_ASKED));
    let socket = WebSocket::from_raw_socket(stream, Role::Server, Some(config));
    let bundle = Current::default();
    let clerk = Clerk::default();
    let interrupt = clerk.interrupt();
    let (asks, asked) = letters(interrupt.clone());
    let (teller, told) = mpsc::channel();
    let (packer, packed) = mpsc::channel();
    let (bundle_of_tracer, packer_of_session) = (bundle.clone(), teller.clone());
    let mut session =
        Session { socket, scene, bundle, watch: None, packer: packer_of_session, unsent_since: None };
    let tracer = std::thread::spawn(move || trace(clerk, asked, &teller, &bundle_of_tracer));
    std::thread::spawn(move || pack(&told, &packer));
    // Whoever does not listen any more has gone.
    let _ = session.send_scene();
    while let Some(ask) = session.turn(&packed) {
        let Some(ask) = ask else { continue };
        let at_once = !matches!(ask, Ask::Look(..) | Ask::Shown);
        if matches!(ask, Ask::Hold) {
            asks.hold();
        } else if matches!(ask, Ask::GoOn) {
            asks.go_on();
        } else if !asks.send(ask, at_once) {
            break;
        }
    }
    drop(asks);
    interrupt.store(true, Ordering::SeqCst);
    // What the tracer has to say of its end it has said on the error stream.
    let _ = tracer.join();
}

impl Session<'_> {
    /// Listens for a moment, then sends what was packed; what the page asks of the tracer comes back, and `None`
    /// where the page is gone.
    fn turn(&mut self, packed: &mpsc::Receiver<Vec<u8>>) -> Option<Option<Ask>> {
        let ask = match self.socket.read() {
            Ok(Message::Binary(bytes)) => {
                // Whoever sends anything else is no page of ours.
                let ask = wire::unpacked(&bytes).and_then(|bytes| wire::message(&bytes)).ok()?;
                self.take(ask)?
            }
            Ok(Message::Close(_) | Message::Text(_)) => return None,
            Ok(Message::Ping(_) | Message::Pong(_) | Message::Frame(_)) => None,
            Err(tungstenite::Error::Io(fault)) if is_waiting(&fault) => None,
            Err(_) => return None,
        };
        // One at a time: the next thing that the page asks may wait already.
        let sent = match self.unsent_since {
            Some(_) => Some(self.socket.flush()),
            None => packed.try_recv().ok().map(|bytes| self.socket.send(Message::binary(bytes))),
        };
        match sent {
            Some(Ok(())) => self.unsent_since = None,
            // A slow wire takes a picture by and by; what the page asks is heard meanwhile.
            Some(Err(tungstenite::Error::Io(fault))) if is_waiting(&fault) => {
                let since = *self.unsent_since.get_or_insert_with(Instant::now);
                (since.elapsed() < MOST_UNSENT).then_some(())?;
            }
            Some(Err(_)) => return None,
            None => {}
        }
        if matches!(self.watch.as_mut().map(Watch::changed), Some(Ok(true))) {
            self.send_scene()?;
        }
        Some(ask)
    }

    /// Does what is done here; the rest is for the tracer.
    fn take(&mut self, ask: Ask) -> Option<Option<Ask>> {
        match ask {
            Ask::Store(path, bytes) => {
                let sentence = match self.store(Path::new(&path), &bytes) {
                    Ok(()) => format!("written: {path}"),
                    Err(sentence) => sentence,
                };
                self.send(Tell::Notice(sentence))?;
                Some(None)
            }
            // The tracer has the files from here, never from the page.
            Ask::Open { number, accel, .. } => {
                let path = self.scene.to_string_lossy().into_owned();
                Some(Some(Ask::Open { number, path, accel, files: Vec::new() }))
            }
            // Pages lead no crews.
            Ask::Help(_) => None,
            Ask::Style(_)
            | Ask::Hide(_)
            | Ask::Draw(_)
            | Ask::Stop
            | Ask::Look(..)
            | Ask::Inspect(..)
            | Ask::Hold
            | Ask::GoOn
            | Ask::Shown => Some(Some(ask)),
        }
    }

    /// Stores a file that belongs to the scene and is what the page was sent; no other.
    fn store(&self, path: &Path, bytes: &[u8]) -> Result<(), String> {
        use dotray_scene::Files;
        let bundle = current(&self.bundle);
        let Ok(sent) = bundle.read(path) else {
            return Err(format!("`{}` is no file of the scene: nothing was written", path.display()));
        };
        if !Disk.is_as_read(path, &sent) {
            return Err(format!("`{}` has changed on the disk: nothing was written", path.display()));
        }
        Disk.store(path, bytes)?;
        bundle.add(path, bytes.to_vec());
        Ok(())
    }

    /// Sends the scene, unless the page has it as it is.
    fn send_scene(&mut self) -> Option<()> {
        let bundle = Arc::new(read(self.scene));
        let wake: Wake = Arc::new(|| {});
        let paths = bundle.paths();
        let paths = paths.iter().map(|path| path.as_path()).chain([self.scene]);
        self.watch = Watch::new(paths, wake);
        if bundle.is_same(&current(&self.bundle)) {
            return Some(());
        }
        let files = bundle.files();
        *self.bundle.lock().unwrap_or_else(PoisonError::into_inner) = bundle;
        let path = self.scene.to_string_lossy().into_owned();
        self.send(Tell::Scene { path, files })
    }

    fn send(&self, tell: Tell) -> Option<()> {
        self.packer.send(tell).ok()
    }
}

/// The packer's thread: it ends with those who tell.
fn pack(told: &mpsc::Receiver<Tell>, packed: &mpsc::Sender<Vec<u8>>) {
    // The picture that was sent last.
    let mut before = Sent::default();
    for tell in told {
        let tell = match tell {
            Tell::Picture(sent) => {
                let last = std::mem::replace(&mut before, Sent { film: None, ..(*sent).clone() });
                Tell::Picture(Box::new(sent.against(&last)))
            }
            Tell::Scene { .. }
            | Tell::Prepared(..)
            | Tell::Failed(..)
            | Tell::Seen(_)
            | Tell::Rays(_)
            | Tell::Refused(_)
            | Tell::Notice(_)
            | Tell::Tracers(..)
            | Tell::Part(_) => tell,
        };
        let bytes = wire::bytes(&tell);
        drop(tell);
        if packed.send(wire::packed(&bytes)).is_err() {
            return;
        }
    }
}

/// All that the scene is made of, as far as it can be read.
fn read(scene: &Path) -> Bundle {
    let recorder = Recorder::new(&Disk, memory::MOST);
    let loaded = load(scene, &recorder, &LoadOptions::default());
    if let Some(resolved) = loaded.scene.and_then(|scene| resolve(scene).resolved) {
        // What is wrong with textures is told where they are shown.
        let _ = Textures::load(&resolved, &recorder, &PrepareOptions::default());
    }
    recorder.kept()
}

/// The tracer's thread: what is asked comes before work.
fn trace(mut clerk: Clerk, mut asked: Receiver<Ask>, tells: &mpsc::Sender<Tell>, bundle: &Current) {
    loop {
        let told = match asked.next(clerk.is_busy()) {
            Next::Letter(ask) => clerk.handle(ask, &*current(bundle)),
            Next::Work => clerk.advance().into_iter().collect(),
            Next::End => return,
        };
        for tell in told {
            if tells.send(tell).is_err() {
                return;
            }
        }
    }
}
