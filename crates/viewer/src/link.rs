//! Between the screen and the work: reading scenes and tracing go on elsewhere, and their news come by and by.

use crate::document::Document;
use crate::document::Message;
use crate::document::Opened;
use crate::document::open;
use crate::engine::Command;
use crate::engine::Engine;
use crate::engine::Reply;
use dotray_render::PrepareOptions;
use dotray_render::World;
use dotray_scene::Files;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicU64;
use std::sync::atomic::Ordering;
use std::sync::mpsc;

/// Where a scene is read from.
#[derive(Clone)]
pub struct Source {
    /// Its file.
    pub path: PathBuf,
    /// What reads it and the files that it names.
    pub files: Arc<dyn Files + Send + Sync>,
}

/// What has come.
#[derive(Debug)]
pub enum News {
    /// A scene for the screen.
    Opened(Box<Document>),
    /// A scene that cannot be shown.
    Failed(Vec<Message>),
    /// The tracer has the scene, after so many seconds.
    Prepared(f64),
    /// What the tracer tells.
    Reply(Reply),
}

/// Wakes the screen.
pub type Wake = Arc<dyn Fn() + Send + Sync>;

/// See the module.
pub struct Link {
    news: mpsc::Receiver<News>,
    sender: mpsc::Sender<News>,
    commands: mpsc::Sender<Command>,
    /// The number of the scene asked for last: what older askings bring is dropped.
    asked: Arc<AtomicU64>,
    wake: Wake,
    #[cfg(target_arch = "wasm32")]
    here: Here,
}

/// A page has one thread: the work is done in slices whenever the screen asks for news.
#[cfg(target_arch = "wasm32")]
struct Here {
    engine: Engine,
    commands: mpsc::Receiver<Command>,
    tasks: std::collections::VecDeque<Box<dyn FnOnce()>>,
}

impl Link {
    /// Starts the tracer.
    pub fn new(wake: Wake) -> Self {
        let (sender, news) = mpsc::channel();
        let (commands, receiver) = mpsc::channel();
        #[cfg(not(target_arch = "wasm32"))]
        {
            let (sender, wake) = (sender.clone(), wake.clone());
            std::thread::spawn(move || trace(&receiver, &sender, &wake));
        }
        Self {
            news,
            sender,
            commands,
            asked: Arc::default(),
            wake,
            #[cfg(target_arch = "wasm32")]
            here: Here { engine: Engine::default(), commands: receiver, tasks: Default::default() },
        }
    }

    /// Tells the tracer something.
    pub fn send(&self, command: Command) {
        // A tracer that is gone has told why on the error stream.
        let _ = self.commands.send(command);
        (self.wake)();
    }

    /// Reads a scene: for the screen and the tracer, or for the tracer alone where the screen has it already.
    pub fn open(&mut self, source: Source, prepare: PrepareOptions, screen: bool) {
        let number = self.asked.fetch_add(1, Ordering::Relaxed) + 1;
        let asked = self.asked.clone();
        let (sender, commands, wake) = (self.sender.clone(), self.commands.clone(), self.wake.clone());
        let tell = move |news: News| {
            // Nobody listens where the window is closed.
            let _ = sender.send(news);
            wake();
        };
        let task = move || {
            let current = || asked.load(Ordering::Relaxed) == number;
            let opened = open(&source.path, &*source.files);
            if !current() {
                return;
            }
            let Opened { document, resolved } = match opened {
                Ok(opened) => opened,
                Err(messages) => return tell(News::Failed(messages)),
            };
            if screen {
                tell(News::Opened(Box::new(document)));
            }
            let start = web_time::Instant::now();
            let world = World::prepare(resolved, &*source.files, &prepare);
            if !current() {
                return;
            }
            match world {
                Ok(world) => {
                    let _ = commands.send(Command::World(Some(Box::new(world))));
                    tell(News::Prepared(start.elapsed().as_secs_f64()));
                }
                Err(faults) => {
                    let sources = dotray_scene::Sources::default();
                    tell(News::Failed(crate::document::messages(&faults, &sources)));
                }
            }
        };
        #[cfg(not(target_arch = "wasm32"))]
        std::thread::spawn(task);
        #[cfg(target_arch = "wasm32")]
        self.here.tasks.push_back(Box::new(task));
    }

    /// What has come since the last time; in a page this does a slice of the work.
    pub fn news(&mut self) -> Vec<News> {
        #[cfg(target_arch = "wasm32")]
        self.work_here();
        self.news.try_iter().collect()
    }

    #[cfg(target_arch = "wasm32")]
    fn work_here(&mut self) {
        const SLICE: std::time::Duration = std::time::Duration::from_millis(24);
        if let Some(task) = self.here.tasks.pop_front() {
            task();
        }
        while let Ok(command) = self.here.commands.try_recv() {
            for reply in self.here.engine.handle(command) {
                let _ = self.sender.send(News::Reply(reply));
            }
        }
        let start = web_time::Instant::now();
        while self.here.engine.is_busy() && start.elapsed() < SLICE {
            if let Some(reply) = self.here.engine.advance() {
                let _ = self.sender.send(News::Reply(reply));
            }
        }
        if self.here.engine.is_busy() || !self.here.tasks.is_empty() {
            (self.wake)();
        }
    }
}

/// The tracer's thread: commands come before work, so a new camera waits for one portion at most.
#[cfg(not(target_arch = "wasm32"))]
fn trace(commands: &mpsc::Receiver<Command>, news: &mpsc::Sender<News>, wake: &Wake) {
    let mut engine = Engine::default();
    loop {
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
        let any = !replies.is_empty();
        for reply in replies {
            if news.send(News::Reply(reply)).is_err() {
                return;
            }
        }
        if any {
            wake();
        }
    }
}
