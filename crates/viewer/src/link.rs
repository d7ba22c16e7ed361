//! Between the screen and the work: reading scenes and tracing go on elsewhere, and their news come by and by.

use crate::document::Document;
use crate::document::Message;
use crate::document::Opened;
use crate::document::messages;
use crate::document::open;
use crate::engine::Command;
use crate::engine::Engine;
use crate::engine::Reply;
use dotray_render::PrepareOptions;
use dotray_render::Textures;
use dotray_render::World;
use dotray_scene::Files;
use dotray_scene::Sources;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
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
    /// Ends the tracer's portion, lest a command wait for it.
    interrupt: Arc<AtomicBool>,
}

impl Link {
    /// Starts the tracer.
    pub fn new(wake: Wake) -> Self {
        let (sender, news) = mpsc::channel();
        let (commands, receiver) = mpsc::channel();
        let engine = Engine::default();
        let interrupt = engine.interrupt();
        let (news_of_tracer, wake_of_tracer) = (sender.clone(), wake.clone());
        std::thread::spawn(move || trace(engine, &receiver, &news_of_tracer, &wake_of_tracer));
        Self { news, sender, commands, asked: Arc::default(), wake, interrupt }
    }

    /// Tells the tracer something. What drops the picture under way, or answers a click, ends its portion; what lies
    /// under the pointer can wait so long.
    pub fn send(&self, command: Command) {
        let at_once = !matches!(command, Command::Look(..));
        // A tracer that is gone has told why on the error stream.
        let _ = self.commands.send(command);
        if at_once {
            self.interrupt.store(true, Ordering::Relaxed);
        }
        (self.wake)();
    }

    /// Reads a scene for the screen and the tracer. A first one is shown even if its textures are faulty; where there
    /// is another on the screen, that stays then.
    pub fn open(&mut self, source: Source, prepare: PrepareOptions, first: bool) {
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
            let start = web_time::Instant::now();
            let textures = Textures::load(&resolved, &*source.files, &prepare);
            let textures = textures.map_err(|faults| messages(&faults, &document.sources));
            if !current() {
                return;
            }
            if first || textures.is_ok() {
                tell(News::Opened(Box::new(document)));
            }
            let textures = match textures {
                Ok(textures) => textures,
                Err(messages) => return tell(News::Failed(messages)),
            };
            let world = World::build(resolved, textures, &prepare);
            if !current() {
                return;
            }
            match world {
                Ok(world) => {
                    let _ = commands.send(Command::World(Some(Box::new(world))));
                    tell(News::Prepared(start.elapsed().as_secs_f64()));
                }
                // What is said of a whole scene has no place.
                Err(faults) => tell(News::Failed(messages(&faults, &Sources::default()))),
            }
        };
        std::thread::spawn(task);
    }

    /// What has come since the last time.
    pub fn news(&mut self) -> Vec<News> {
        self.news.try_iter().collect()
    }
}

/// The tracer's thread: commands come before work, so a new camera waits for one portion at most.
fn trace(mut engine: Engine, commands: &mpsc::Receiver<Command>, news: &mpsc::Sender<News>, wake: &Wake) {
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
