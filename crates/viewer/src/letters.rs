//! What is sent to a tracer on a thread of its own. What cannot wait ends the portion of the picture under way at once,
//! and a hand that may move the camera holds the tracer until the screen has seen what became of it.

use std::fs::File;
use std::io::Write;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::sync::atomic::AtomicU64;
use std::sync::atomic::Ordering;
use std::sync::mpsc;
use std::time::Duration;
use std::time::Instant;
use std::time::SystemTime;
use std::time::UNIX_EPOCH;

/// For how long a tracer is held at most: a screen that draws nothing tells nothing.
const HELD: Duration = Duration::from_millis(300);

/// The variable that names a file where the time of each letter that could not wait is written, in microseconds since
/// 1970, as soon as nothing of the old picture is traced any more.
pub const HEARD: &str = "RAYVIEW_HEARD";

enum Letter<T> {
    This(T),
    Hold,
    GoOn,
}

/// What both ends know.
#[derive(Debug, Default)]
struct Shared {
    /// How many letters that cannot wait were sent, or will be at once.
    announced: AtomicU64,
    /// Whether a hand holds the tracer.
    held: AtomicBool,
}

/// Where letters are sent; see the module.
pub struct Sender<T> {
    letters: mpsc::Sender<(Letter<T>, bool)>,
    shared: Arc<Shared>,
    interrupt: Arc<AtomicBool>,
}

impl<T> Clone for Sender<T> {
    fn clone(&self) -> Self {
        let Self { letters, shared, interrupt } = self;
        Self { letters: letters.clone(), shared: shared.clone(), interrupt: interrupt.clone() }
    }
}

/// Where the tracer takes letters.
pub struct Receiver<T> {
    letters: mpsc::Receiver<(Letter<T>, bool)>,
    shared: Arc<Shared>,
    interrupt: Arc<AtomicBool>,
    /// How many of the letters that could not wait have come.
    heard: u64,
    held_until: Option<Instant>,
    log: Option<File>,
}

/// What is to be done next.
#[derive(Debug, PartialEq, Eq)]
pub enum Next<T> {
    /// This.
    Letter(T),
    /// What was begun.
    Work,
    /// Nothing any more: nobody sends letters.
    End,
}

/// Letters to a tracer that stops in the midst of its work where `interrupt` is set.
pub fn letters<T>(interrupt: Arc<AtomicBool>) -> (Sender<T>, Receiver<T>) {
    let (sender, letters) = mpsc::channel();
    let shared: Arc<Shared> = Arc::default();
    let sender = Sender { letters: sender, shared: shared.clone(), interrupt: interrupt.clone() };
    let log =
        std::env::var_os(HEARD).and_then(|path| File::options().append(true).create(true).open(path).ok());
    (sender, Receiver { letters, shared, interrupt, heard: 0, held_until: None, log })
}

impl<T> Sender<T> {
    fn post(&self, letter: Letter<T>, at_once: bool) -> bool {
        if at_once {
            // In this order: a letter that comes was announced, and one that was announced comes.
            self.shared.announced.fetch_add(1, Ordering::SeqCst);
            self.interrupt.store(true, Ordering::SeqCst);
        }
        self.letters.send((letter, at_once)).is_ok()
    }

    /// Sends a letter, for which work under way is interrupted where it is to be read `at_once`; answers whether there
    /// is somebody to read it.
    pub fn send(&self, letter: T, at_once: bool) -> bool {
        self.post(Letter::This(letter), at_once)
    }

    /// Has the tracer wait until it may [go on](Sender::go_on), or a moment has passed.
    pub fn hold(&self) {
        if !self.shared.held.swap(true, Ordering::SeqCst) {
            self.post(Letter::Hold, true);
        }
    }

    /// Has the tracer go on.
    pub fn go_on(&self) {
        if self.shared.held.swap(false, Ordering::SeqCst) {
            self.post(Letter::GoOn, false);
        }
    }
}

impl<T> Receiver<T> {
    /// What is to be done next by somebody who has work under way, or none.
    pub fn next(&mut self, is_busy: bool) -> Next<T> {
        loop {
            let wait = self.held_until.map(|until| until.saturating_duration_since(Instant::now()));
            let came = if !is_busy || self.shared.announced.load(Ordering::SeqCst) > self.heard {
                self.letters.recv().map_err(|mpsc::RecvError| mpsc::RecvTimeoutError::Disconnected)
            } else {
                // Without waiting where nobody holds it.
                self.letters.recv_timeout(wait.unwrap_or_default())
            };
            match came {
                Ok((letter, at_once)) => {
                    if at_once {
                        self.hear(is_busy);
                    }
                    match letter {
                        Letter::This(letter) => return Next::Letter(letter),
                        Letter::Hold => self.held_until = Some(Instant::now() + HELD),
                        Letter::GoOn => self.held_until = None,
                    }
                }
                Err(mpsc::RecvTimeoutError::Timeout) => {
                    if self.held_until.take().is_some() {
                        self.shared.held.store(false, Ordering::SeqCst);
                    }
                    return Next::Work;
                }
                Err(mpsc::RecvTimeoutError::Disconnected) => return Next::End,
            }
        }
    }

    /// One that could not wait has come; another may be on its way.
    fn hear(&mut self, is_busy: bool) {
        self.heard += 1;
        self.interrupt.store(false, Ordering::SeqCst);
        if self.shared.announced.load(Ordering::SeqCst) > self.heard {
            self.interrupt.store(true, Ordering::SeqCst);
        }
        if let Some(log) = self.log.as_mut().filter(|_| is_busy) {
            let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
            // Whoever measures sees what is missing.
            let _ = writeln!(log, "{}", now.as_micros());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_come_before_work_and_what_is_urgent_interrupts() {
        let interrupt = Arc::new(AtomicBool::new(false));
        let (sender, mut receiver) = letters(interrupt.clone());
        assert_eq!(receiver.next(true), Next::Work);
        assert!(sender.send(1, false) && !interrupt.load(Ordering::SeqCst));
        assert!(sender.send(2, true) && sender.send(3, true) && interrupt.load(Ordering::SeqCst));
        assert_eq!(receiver.next(true), Next::Letter(1));
        assert_eq!(receiver.next(true), Next::Letter(2));
        // The third one is on its way.
        assert!(interrupt.load(Ordering::SeqCst));
        assert_eq!(receiver.next(true), Next::Letter(3));
        assert!(!interrupt.load(Ordering::SeqCst));
        assert_eq!(receiver.next(true), Next::Work);
        drop(sender);
        assert_eq!(receiver.next(true), Next::End);
    }

    #[test]
    fn who_is_held_waits_for_leave_or_for_a_moment() {
        let interrupt = Arc::new(AtomicBool::new(false));
        let (sender, mut receiver) = letters(interrupt.clone());
        sender.hold();
        sender.hold();
        assert!(interrupt.load(Ordering::SeqCst));
        assert!(sender.send(1, true));
        assert_eq!(receiver.next(true), Next::Letter(1));
        assert!(!interrupt.load(Ordering::SeqCst));
        sender.go_on();
        assert_eq!(receiver.next(true), Next::Work);
        sender.hold();
        let start = Instant::now();
        assert_eq!(receiver.next(true), Next::Work);
        assert!(start.elapsed() >= HELD);
        assert_eq!(receiver.next(true), Next::Work);
        assert!(start.elapsed() < 2 * HELD);
        // Letters are read all the same.
        sender.hold();
        assert!(sender.send(2, false));
        assert_eq!(receiver.next(true), Next::Letter(2));
    }
}
