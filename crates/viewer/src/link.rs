//! Between the screen and the work: reading scenes and tracing go on elsewhere, and their news come by and by.

#[cfg_attr(target_arch = "wasm32", path = "link/page.rs")]
#[cfg_attr(not(target_arch = "wasm32"), path = "link/threads.rs")]
mod desk;

use crate::document::Document;
use crate::document::Message;
use crate::document::Opened;
use crate::document::messages;
use crate::document::open;
use crate::engine::Command;
use crate::engine::Reply;
use crate::host::Home;
use dotray_render::PrepareOptions;
use dotray_render::Textures;
use dotray_render::World;
use dotray_scene::Files;
use dotray_scene::Resolved;
use dotray_scene::Sources;
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
    /// What reads and stores it and the files that it names.
    pub files: Arc<dyn Home>,
}

/// What has come.
pub enum News {
    /// A scene for the screen.
    Opened(Box<Document>),
    /// A scene that cannot be shown.
    Failed(Vec<Message>),
    /// The tracer has the scene, after so many seconds.
    Prepared(f64),
    /// So many threads trace it.
    Tracers(usize),
    /// A scene that was sent from elsewhere, or has changed there.
    Sent(Source),
    /// Something that the user should know.
    Notice(String),
    /// What the tracer tells.
    Reply(Reply),
}

impl News {
    /// Whether it can wait until the hand rests: frames that are drawn by software are dear.
    fn is_idle(&self) -> bool {
        matches!(self, Self::Reply(Reply::Seen(_)))
    }
}

/// Wakes the screen.
pub type Wake = Arc<dyn Fn() + Send + Sync>;

/// A scene to read.
struct Asked {
    source: Source,
    prepare: PrepareOptions,
    /// Whether nothing is on the screen: then the scene is shown even if its textures are faulty.
    first: bool,
    number: u64,
}

/// Where news are told, as long as they concern the scene asked for last: what older askings bring is dropped.
#[derive(Clone)]
struct Teller {
    news: mpsc::Sender<News>,
    wake: Wake,
    /// Wakes it soon.
    nudge: Wake,
    last_asked: Arc<AtomicU64>,
}

impl Teller {
    fn tell(&self, news: News) {
        let is_idle = news.is_idle();
        // Nobody listens where the window is closed.
        let _ = self.news.send(news);
        if !desk::IN_FRAMES {
            self.wake_for(is_idle);
        }
    }

    /// Has the screen see news; idle ones soon.
    fn wake_for(&self, is_idle: bool) {
        if is_idle { (self.nudge)() } else { (self.wake)() }
    }

    fn is_current(&self, asked: &Asked) -> bool {
        self.last_asked.load(Ordering::Relaxed) == asked.number
    }

    /// Reads the scene; what the tracer needs of it comes back.
    fn read(&self, asked: &Asked, files: &dyn Files) -> Option<(Resolved, Textures)> {
        let opened = open(&asked.source.path, files);
        if !self.is_current(asked) {
            return None;
        }
        let Opened { document, resolved } = match opened {
            Ok(opened) => opened,
            Err(messages) => {
                self.tell(News::Failed(messages));
                return None;
            }
        };
        let textures = Textures::load(&resolved, files, &asked.prepare);
        let textures = textures.map_err(|faults| messages(&faults, &document.sources));
        if !self.is_current(asked) {
            return None;
        }
        if asked.first || textures.is_ok() {
            self.tell(News::Opened(Box::new(document)));
        }
        match textures {
            Ok(textures) => Some((resolved, textures)),
            Err(messages) => {
                self.tell(News::Failed(messages));
                None
            }
        }
    }

    /// Builds what the tracer traces.
    fn build(&self, asked: &Asked, resolved: Resolved, textures: Textures) -> Option<Box<World>> {
        let world = World::build(resolved, textures, &asked.prepare);
        if !self.is_current(asked) {
            return None;
        }
        match world {
            Ok(world) => Some(Box::new(world)),
            // What is said of a whole scene has no place.
            Err(faults) => {
                self.tell(News::Failed(messages(&faults, &Sources::default())));
                None
            }
        }
    }
}

/// See the module.
pub struct Link {
    news: mpsc::Receiver<News>,
    teller: Teller,
    desk: desk::Desk,
}

impl Link {
    /// Starts the tracer. `nudge` wakes the screen soon.
    pub fn new(wake: Wake, nudge: Wake) -> Self {
        let (sender, news) = mpsc::channel();
        let teller = Teller { news: sender, wake, nudge, last_asked: Arc::default() };
        let desk = desk::Desk::new(teller.clone());
        Self { news, teller, desk }
    }

    /// Tells the tracer something.
    pub fn send(&self, command: Command) {
        let is_idle = matches!(command, Command::Look(..));
        self.desk.send(command);
        self.teller.wake_for(is_idle);
    }

    /// Reads a scene for the screen and the tracer. A first one is shown even if its textures are faulty; where there
    /// is another on the screen, that stays then.
    pub fn open(&mut self, source: Source, prepare: PrepareOptions, first: bool) {
        let number = self.teller.last_asked.fetch_add(1, Ordering::Relaxed) + 1;
        self.desk.open(Asked { source, prepare, first, number });
    }

    /// How many threads trace, where that is known: another program does not tell.
    pub fn threads(&self) -> Option<usize> {
        self.desk.threads()
    }

    /// Lets the tracer go on, which a page has held since a hand did something: the screen has seen it.
    pub fn go_on(&self) {
        self.desk.go_on();
    }

    /// What has come since the last time; on a page this does a slice of the work.
    pub fn news(&mut self) -> Vec<News> {
        self.desk.work();
        self.news.try_iter().collect()
    }
}
