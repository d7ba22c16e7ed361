//! Work on a page, which has one thread: slices of it, whenever the screen asks for news.

use super::Asked;
use super::News;
use super::Teller;
use crate::engine::Command;
use crate::engine::Engine;
use dotray_render::Textures;
use dotray_scene::Resolved;
use std::cell::RefCell;
use std::collections::VecDeque;
use web_time::Instant;

/// What is left of a scene that is read. Between the steps the screen is drawn, so that it shows what goes on.
enum Step {
    Read(Asked),
    Build(Box<(Asked, Resolved, Textures)>),
}

/// See the module.
pub struct Desk {
    engine: Engine,
    teller: Teller,
    commands: RefCell<VecDeque<Command>>,
    /// The step under way, once the screen has been drawn since it came up.
    next: Option<Step>,
    drawn_since: bool,
}

impl Desk {
    pub fn new(teller: Teller) -> Self {
        Self {
            engine: Engine::default(),
            teller,
            commands: RefCell::default(),
            next: None,
            drawn_since: false,
        }
    }

    pub fn send(&self, command: Command) {
        self.commands.borrow_mut().push_back(command);
    }

    /// A scene that was asked for before is not read any more.
    pub fn open(&mut self, asked: Asked) {
        self.begin(Step::Read(asked));
    }

    fn begin(&mut self, step: Step) {
        (self.next, self.drawn_since) = (Some(step), false);
        (self.teller.wake)();
    }

    /// One step of a scene, or else as many commands as there are and one portion of tracing.
    pub fn work(&mut self) {
        if self.next.is_some() && !std::mem::replace(&mut self.drawn_since, true) {
            (self.teller.wake)();
        } else if let Some(step) = self.next.take() {
            self.step(step);
        }
        let commands = std::mem::take(&mut *self.commands.borrow_mut());
        for command in commands {
            for reply in self.engine.handle(command) {
                self.teller.tell(News::Reply(reply));
            }
        }
        if self.engine.is_busy() {
            if let Some(reply) = self.engine.advance() {
                self.teller.tell(News::Reply(reply));
            }
            (self.teller.wake)();
        }
    }

    fn step(&mut self, step: Step) {
        match step {
            Step::Read(asked) => {
                if let Some((resolved, textures)) = self.teller.read(&asked) {
                    self.begin(Step::Build(Box::new((asked, resolved, textures))));
                }
            }
            Step::Build(parts) => {
                let (asked, resolved, textures) = *parts;
                let start = Instant::now();
                if let Some(world) = self.teller.build(&asked, resolved, textures) {
                    self.commands.borrow_mut().push_back(Command::World(Some(world)));
                    self.teller.tell(News::Prepared(start.elapsed().as_secs_f64()));
                }
            }
        }
    }
}
