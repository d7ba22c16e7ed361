//! Work on threads: one that traces, and one for each scene that is read.

use super::Asked;
use super::News;
use super::Teller;
use crate::engine::Command;
use crate::engine::Engine;
use crate::hidden::without_shapes;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::sync::atomic::Ordering;
use std::sync::mpsc;

/// See the module.
pub struct Desk {
    commands: mpsc::Sender<Command>,
    teller: Teller,
    /// Ends the tracer's portion, lest a command wait for it.
    interrupt: Arc<AtomicBool>,
}

impl Desk {
    pub fn new(teller: Teller) -> Self {
        let (commands, receiver) = mpsc::channel();
        let engine = Engine::default();
        let interrupt = engine.interrupt();
        let of_tracer = teller.clone();
        std::thread::spawn(move || trace(engine, &receiver, &of_tracer));
        Self { commands, teller, interrupt }
    }

    /// What drops the picture under way, or answers a click, ends the portion; what lies under the pointer can wait.
    pub fn send(&self, command: Command) {
        let at_once = !matches!(command, Command::Look(..));
        // A tracer that is gone has told why on the error stream.
        let _ = self.commands.send(command);
        if at_once {
            self.interrupt.store(true, Ordering::Relaxed);
        }
    }

    pub fn open(&mut self, asked: Asked) {
        let (teller, commands) = (self.teller.clone(), self.commands.clone());
        std::thread::spawn(move || {
            let Some((resolved, textures)) = teller.read(&asked, &*asked.source.files) else { return };
            let start = web_time::Instant::now();
            let rest = Box::new(without_shapes(&resolved));
            if let Some(world) = teller.build(&asked, resolved, textures) {
                let _ = commands.send(Command::World(Some(world)));
                let _ = commands.send(Command::Rest(rest, asked.prepare.clone()));
                teller.tell(News::Prepared(start.elapsed().as_secs_f64()));
            }
        });
    }

    /// How many threads trace.
    pub fn threads(&self) -> Option<usize> {
        Some(rayon::current_num_threads())
    }

    /// Threads need nobody to push them.
    pub fn work(&mut self) {}
}

/// The tracer's thread: commands come before work, so a new camera waits for one portion at most.
fn trace(mut engine: Engine, commands: &mpsc::Receiver<Command>, teller: &Teller) {
    let interrupt = engine.interrupt();
    loop {
        interrupt.store(false, Ordering::Relaxed);
        let command = if engine.is_busy() {
            match commands.try_recv() {
                Ok(command) => Some(command),
                Err(mpsc::TryRecvError::Empty) => None,
                Err(mpsc::TryRecvError::Disconnected) => return,
            }
        } else {
            match commands.recv() {
                Ok(command) => Some(command),
                Err(mpsc::RecvError) => return,
            }
        };
        let replies = match command {
            Some(command) => engine.handle(command),
            None => engine.advance().into_iter().collect(),
        };
        replies.into_iter().for_each(|reply| teller.tell(News::Reply(reply)));
    }
}
