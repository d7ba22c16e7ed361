//! Work on a page: done by a tracer that the page's JavaScript has (a worker, or a program behind a socket), else in
//! slices on the one thread, whenever the screen asks for news.

mod port;
mod slices;

use super::Asked;
use super::News;
use super::Teller;
use crate::engine::Command;
use crate::host::Page;
use port::Port;
use slices::Slices;

/// News are told in a frame, which takes them.
pub const IN_FRAMES: bool = true;

enum Tracer {
    Elsewhere(Port),
    Here(Slices),
}

/// See the module.
pub struct Desk {
    teller: Teller,
    tracer: Tracer,
    /// The scene to read, once the screen has been drawn since it was asked for, so that it shows what goes on.
    next: Option<Asked>,
    drawn_since: bool,
}

impl Desk {
    pub fn new(teller: Teller) -> Self {
        let port = Page::find().ok().and_then(|page| Port::open(&page, &teller));
        let tracer = match port {
            Some(port) => Tracer::Elsewhere(port),
            None => Tracer::Here(Slices::default()),
        };
        Self { teller, tracer, next: None, drawn_since: false }
    }

    pub fn send(&self, command: Command) {
        match &self.tracer {
            Tracer::Elsewhere(port) => port.send(command),
            Tracer::Here(slices) => slices.send(command),
        }
    }

    pub fn go_on(&self) {
        match &self.tracer {
            Tracer::Elsewhere(port) => port.go_on(),
            // It traces between two frames of the screen alone.
            Tracer::Here(_) => {}
        }
    }

    /// How many threads trace, where that is known.
    pub fn threads(&self) -> Option<usize> {
        match &self.tracer {
            Tracer::Elsewhere(port) if port.is_served() => None,
            // One leads; more are told of once they have the scene.
            Tracer::Elsewhere(_) | Tracer::Here(_) => Some(1),
        }
    }

    /// A scene that was asked for before is not read any more.
    pub fn open(&mut self, asked: Asked) {
        (self.next, self.drawn_since) = (Some(asked), false);
        (self.teller.wake)();
    }

    /// Reads the scene that was asked for, or else takes what the tracer has.
    pub fn work(&mut self) {
        if self.next.is_some() && !std::mem::replace(&mut self.drawn_since, true) {
            return (self.teller.wake)();
        }
        if let Some(asked) = self.next.take() {
            match &mut self.tracer {
                Tracer::Elsewhere(port) => port.read(asked, &self.teller),
                Tracer::Here(slices) => slices.read(asked, &self.teller),
            }
            return (self.teller.wake)();
        }
        match &mut self.tracer {
            Tracer::Elsewhere(port) => port.work(&self.teller),
            Tracer::Here(slices) => slices.work(&self.teller),
        }
    }
}
