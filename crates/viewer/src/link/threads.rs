//! Work on threads: one that traces, and one for each scene that is read.

use super::Asked;
use super::News;
use super::Teller;
use crate::engine::Command;
use crate::engine::Engine;
use crate::hidden::without_shapes;
use crate::letters::Next;
use crate::letters::Receiver;
use crate::letters::Sender;
use crate::letters::letters;

/// Threads tell between two frames.
pub const IN_FRAMES: bool = false;

/// See the module.
pub struct Desk {
    commands: Sender<Command>,
    teller: Teller,
}

impl Desk {
    pub fn new(teller: Teller) -> Self {
        let engine = Engine::default();
        let (commands, receiver) = letters(engine.interrupt());
        let of_tracer = teller.clone();
        std::thread::spawn(move || trace(engine, receiver, &of_tracer));
        Self { commands, teller }
    }

    /// What drops the picture under way, or answers a click, ends the portion; what lies under the pointer can wait.
    pub fn send(&self, command: Command) {
        let at_once = !matches!(command, Command::Look(..));
        // A tracer that is gone has told why on the error stream.
        self.commands.send(command, at_once);
    }

    /// A window's frame comes right after what a hand does: nothing is held before.
    pub fn go_on(&self) {}

    pub fn open(&mut self, asked: Asked) {
        let (teller, commands) = (self.teller.clone(), self.commands.clone());
        std::thread::spawn(move || {
            let Some((resolved, textures)) = teller.read(&asked, &*asked.source.files) else { return };
            let start = web_time::Instant::now();
            let rest = Box::new(without_shapes(&resolved));
            if let Some(world) = teller.build(&asked, resolved, textures) {
                commands.send(Command::World(Some(world)), false);
                commands.send(Command::Rest(rest, asked.prepare.clone()), false);
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

/// The tracer's thread: commands come before work.
fn trace(mut engine: Engine, mut commands: Receiver<Command>, teller: &Teller) {
    loop {
        let replies = match commands.next(engine.is_busy()) {
            Next::Letter(command) => engine.handle(command),
            Next::Work => engine.advance().into_iter().collect(),
            Next::End => return,
        };
        replies.into_iter().for_each(|reply| teller.tell(News::Reply(reply)));
    }
}
