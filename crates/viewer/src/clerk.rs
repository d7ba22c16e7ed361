//! The tracer's side of a wire: prepares scenes, has pictures traced and sends no more of them than the screen shows.

use crate::bundle::Bundle;
use crate::document::Message;
use crate::document::messages;
use crate::engine::Command;
use crate::engine::Engine;
use crate::engine::Reply;
use crate::engine::Share;
use crate::hidden::without_shapes;
use crate::wire::Ask;
use crate::wire::Sent;
use crate::wire::SentPart;
use crate::wire::Tell;
use dotray_accel::Kind;
use dotray_render::PrepareOptions;
use dotray_render::Textures;
use dotray_render::World;
use dotray_scene::Files;
use dotray_scene::Resolved;
use dotray_scene::Sources;
use dotray_scene::load::LoadOptions;
use dotray_scene::load::load;
use dotray_scene::resolve::resolve;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;
use web_time::Instant;

/// How many times as long as it has taken to show a picture the next one waits, unless it is finished, and how long at
/// most.
const QUIET: u32 = 6;
const MOST_QUIET: Duration = Duration::from_secs(2);

/// Whether this is a finished picture.
fn is_complete(tell: &Tell) -> bool {
    matches!(tell, Tell::Picture(sent) if sent.film.is_some())
}

/// See the module.
#[derive(Debug, Default)]
pub struct Clerk {
    engine: Engine,
    /// Lights, materials and colours of the scene as they were read.
    style: Option<Box<Resolved>>,
    /// Since when a picture is on its way that the screen has not shown yet.
    awaited: Option<Instant>,
    /// Until when no other goes there: a screen that draws hears of nothing else.
    quiet_until: Option<Instant>,
    /// The newest picture that could not be sent.
    held: Option<Tell>,
    /// Whether it was told to wait.
    waits: bool,
}

impl Clerk {
    /// Whether there is more to trace, now.
    pub fn is_busy(&self) -> bool {
        self.engine.is_busy() && !self.waits
    }

    /// Ends the portion under way.
    pub fn interrupt(&self) -> Arc<AtomicBool> {
        self.engine.interrupt()
    }

    /// Does what was asked for. `kept` is where a scene is read that comes without its files.
    pub fn handle(&mut self, ask: Ask, kept: &dyn Files) -> Vec<Tell> {
        let command = match ask {
            Ask::Open { number, path, accel, files } => {
                let bundle = Bundle::new(files);
                let files: &dyn Files = if bundle.is_empty() { kept } else { &bundle };
                return vec![self.open(number, Path::new(&path), &accel, files)];
            }
            Ask::Style(style) => match self.style.as_ref().and_then(|old| style.put_on(old)) {
                Some(resolved) => Command::Style(Box::new(resolved)),
                None => return Vec::new(),
            },
            Ask::Draw(request) => {
                (self.held, self.quiet_until) = (None, None);
                Command::Draw(request)
            }
            Ask::Stop => {
                self.held = None;
                Command::Stop
            }
            Ask::Hide(hidden) => {
                self.held = None;
                Command::Hide(hidden)
            }
            Ask::Help(share) => Command::Help(share),
            Ask::Look(request, x, y) => Command::Look(request, x, y),
            Ask::Inspect(request, x, y) => Command::Inspect(request, x, y),
            Ask::Shown => {
                let took = self.awaited.take().map(|since| since.elapsed()).unwrap_or_default();
                self.quiet_until = Some(Instant::now() + (took * QUIET).min(MOST_QUIET));
                let held = self.held.take_if(|held| is_complete(held));
                self.awaited = held.as_ref().map(|_| Instant::now());
                return held.into_iter().collect();
            }
            Ask::Hold | Ask::GoOn => {
                self.waits = matches!(ask, Ask::Hold);
                return Vec::new();
            }
            // Whoever can store files has done so.
            Ask::Store(..) => return Vec::new(),
        };
        let replies = self.engine.handle(command);
        replies.into_iter().filter_map(|reply| self.tell(reply)).collect()
    }

    /// Traces a portion.
    pub fn advance(&mut self) -> Option<Tell> {
        let reply = self.engine.advance()?;
        self.tell(reply)
    }

    /// Who is asked every now and then whether to stop, where no other thread can interrupt.
    pub fn ask_whether_to_stop(&mut self, ask: fn() -> bool) {
        self.engine.ask_whether_to_stop(ask);
    }

    /// So many tiles for another tracer of the same scene; `None` where nothing is left to give away.
    pub fn lend(&mut self, count: usize) -> Option<Share> {
        self.engine.lend(count)
    }

    /// Takes tiles that another has traced.
    pub fn accept(&mut self, part: SentPart) -> Option<Tell> {
        let reply = self.engine.accept(&part.part())?;
        self.tell(reply)
    }

    fn open(&mut self, number: u64, path: &Path, accel: &str, files: &dyn Files) -> Tell {
        let accel = Kind::ALL.into_iter().find(|kind| kind.name() == accel).unwrap_or_default();
        let start = Instant::now();
        let options = PrepareOptions { accel, ..PrepareOptions::default() };
        match prepared(path, files, &options) {
            Ok((world, rest)) => {
                self.style = Some(Box::new(Resolved { tree: Vec::new(), ..rest.clone() }));
                self.held = None;
                self.engine.handle(Command::World(Some(Box::new(world))));
                self.engine.handle(Command::Rest(Box::new(rest), options));
                Tell::Prepared(number, start.elapsed().as_secs_f64())
            }
            Err(messages) => Tell::Failed(number, messages.into_iter().map(|message| message.text).collect()),
        }
    }

    fn tell(&mut self, reply: Reply) -> Option<Tell> {
        let tell = match reply {
            Reply::Picture { serial, size, pixels, progress, image } => Tell::Picture(Box::new(Sent {
                serial,
                size: size.map(|edge| u32::try_from(edge).unwrap_or(u32::MAX)),
                pixels: Arc::unwrap_or_clone(pixels),
                differs: false,
                progress,
                film: image.map(|image| bytemuck::cast_slice(image.samples()).to_vec()),
            })),
            Reply::Seen(seen) => return Some(Tell::Seen(seen)),
            Reply::Rays(rows) => return Some(Tell::Rays(Arc::unwrap_or_clone(rows))),
            Reply::Refused(sentence) => return Some(Tell::Refused(sentence)),
            Reply::Part(part) => return Some(Tell::Part(Box::new(SentPart::of(&part)))),
        };
        let is_quiet = self.quiet_until.is_some_and(|until| Instant::now() < until) && !is_complete(&tell);
        if self.awaited.is_some() || is_quiet {
            self.held = Some(tell);
            return None;
        }
        (self.awaited, self.held) = (Some(Instant::now()), None);
        Some(tell)
    }
}

/// The scene for the tracer, and what it was built of besides shapes.
fn prepared(
    path: &Path,
    files: &dyn Files,
    options: &PrepareOptions,
) -> Result<(World, Resolved), Vec<Message>> {
    let loaded = load(path, files, &LoadOptions::default());
    let (mut diagnostics, sources) = (loaded.diagnostics, loaded.sources);
    let resolved = loaded.scene.map(resolve).and_then(|outcome| {
        diagnostics.extend(outcome.diagnostics);
        outcome.resolved
    });
    let Some(resolved) = resolved else { return Err(messages(&diagnostics, &sources)) };
    let rest = without_shapes(&resolved);
    let textures = Textures::load(&resolved, files, options).map_err(|faults| messages(&faults, &sources))?;
    drop(sources);
    let world = World::build(resolved, textures, options);
    // What is said of a whole scene has no place.
    let world = world.map_err(|faults| messages(&faults, &Sources::default()))?;
    Ok((world, rest))
}
