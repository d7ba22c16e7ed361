//! A tracer elsewhere: an object of the page's JavaScript with `postMessage` and `onmessage`, as workers have them.
//! Messages are bytes; one that is `null` says that nobody is there any more.
//!
//! What a hand does is known to the screen with its next frame only, which may be late where the tracers want all
//! cores. It is therefore heard here as it comes, and holds the tracer until that frame is drawn.
//!
//! Turns of the wheel come with a frame all the same: where frames are slow there are few of them (`hover.rs`). Tried
//! and dropped: a slider on the page, for which Chromium hands touches out at once; one tracer on two cores; tracers
//! that are held for every frame, which gains little and loses the tiles under way.

use super::Asked;
use super::News;
use super::Teller;
use crate::bundle::Recorder;
use crate::document::Message;
use crate::engine::Command;
use crate::engine::Reply;
use crate::host::Page;
use crate::host::Served;
use crate::link::Source;
use crate::memory::MOST;
use crate::wire::Ask;
use crate::wire::Style;
use crate::wire::Tell;
use crate::wire::bytes;
use crate::wire::message;
use crate::wire::packed;
use crate::wire::unpacked;
use dotray_image::Channels;
use dotray_image::Image;
use std::cell::Cell;
use std::cell::RefCell;
use std::collections::VecDeque;
use std::path::PathBuf;
use std::rc::Rc;
use std::sync::Arc;
use std::sync::Mutex;
use std::sync::PoisonError;
use std::sync::atomic::Ordering;
use wasm_bindgen::JsCast;
use wasm_bindgen::JsValue;
use wasm_bindgen::closure::Closure;

/// Messages as they came; `None` says that nobody is there any more.
type Arrived = Rc<RefCell<VecDeque<Option<Result<Tell, String>>>>>;

/// Where the tracer takes messages.
#[derive(Clone)]
struct Slot {
    object: JsValue,
    post: js_sys::Function,
    /// Whether large messages are packed, for a wire.
    packing: bool,
    /// Whether it is the page's own, with several threads.
    is_own: bool,
}

impl Slot {
    fn ask(&self, ask: &Ask) {
        let bytes = bytes(ask);
        let bytes = if self.packing { packed(&bytes) } else { bytes };
        let bytes = js_sys::Uint8Array::from(bytes.as_slice());
        // A thread takes a second argument for something else; the page's own tracers are told what cannot wait.
        let waits = matches!(ask, Ask::Look(..) | Ask::Shown | Ask::Store(..) | Ask::GoOn);
        // A tracer that is gone has said so.
        let _ = match self.is_own && !waits {
            true => self.post.call2(&self.object, &bytes, &JsValue::TRUE),
            false => self.post.call1(&self.object, &bytes),
        };
    }
}

/// What may move the camera. The first one comes at once where a browser has it, all other moves with its next frame.
const DEEDS: [&str; 5] = ["pointerrawupdate", "pointermove", "touchmove", "wheel", "keydown"];

/// Whether a hand holds the tracer.
#[derive(Default)]
struct Hold {
    held: Cell<bool>,
    /// How often a hand did something while it was held.
    deeds: Cell<u64>,
}

/// See the module.
pub struct Port {
    slot: Slot,
    /// The picture that is being traced, by its number.
    traced: Rc<Cell<Option<u64>>>,
    hold: Rc<Hold>,
    arrived: Arrived,
    /// What the scene's files are to be stored as.
    outgoing: Arc<Mutex<Vec<Ask>>>,
    /// The pixels that were shown last.
    before: Vec<u8>,
    _listeners: [Closure<dyn FnMut(JsValue)>; 2],
}

fn get(object: &JsValue, name: &str) -> Option<JsValue> {
    js_sys::Reflect::get(object, &name.into()).ok().filter(|value| !value.is_undefined() && !value.is_null())
}

impl Port {
    /// The page's tracer, where it has one.
    pub fn open(page: &Page, teller: &Teller) -> Option<Self> {
        let object = get(&page.given, "tracer")?;
        let packing = get(&page.given, "packing").is_some_and(|packing| packing.is_truthy());
        let is_own = get(&object, "threads").is_some();
        let post = get(&object, "postMessage")?.dyn_into().ok()?;
        let arrived = Arrived::default();
        let (queue, of_page) = (arrived.clone(), teller.clone());
        let listener = Closure::new(move |event: JsValue| {
            let bytes = get(&event, "data").map(|data| js_sys::Uint8Array::new(&data).to_vec());
            let tell = bytes.map(|bytes| if packing { unpacked(&bytes) } else { Ok(bytes) });
            let tell = tell.map(|bytes| bytes.and_then(|bytes| message(&bytes)));
            of_page.wake_for(matches!(tell, Some(Ok(Tell::Seen(_)))));
            queue.borrow_mut().push_back(tell);
        });
        let taken = js_sys::Reflect::set(&object, &"onmessage".into(), listener.as_ref());
        taken.ok()?;
        let slot = Slot { object, post, packing, is_own };
        let (traced, hold) = (Rc::new(Cell::new(None)), Rc::new(Hold::default()));
        let brake = brake(page, &slot, &traced, &hold, teller);
        Some(Self {
            slot,
            traced,
            hold,
            arrived,
            outgoing: Arc::default(),
            before: Vec::new(),
            _listeners: [listener, brake],
        })
    }

    /// Whether another program traces.
    pub fn is_served(&self) -> bool {
        self.slot.packing
    }

    /// The screen has seen what the hand did. Where frames are drawn by software, the one that shows it has the cores
    /// for itself.
    pub fn go_on(&self) {
        if !self.hold.held.get() {
            return;
        }
        let (slot, hold, seen) = (self.slot.clone(), self.hold.clone(), self.hold.deeds.get());
        after_a_frame(move || {
            // What a hand did since has a frame of its own.
            if hold.deeds.get() == seen && hold.held.replace(false) {
                slot.ask(&Ask::GoOn);
            }
        });
    }

    pub fn send(&self, command: Command) {
        match &command {
            Command::Draw(request) => self.traced.set(Some(request.serial)),
            Command::Stop => self.traced.set(None),
            Command::World(_)
            | Command::Rest(..)
            | Command::Style(_)
            | Command::Hide(_)
            | Command::Look(..)
            | Command::Inspect(..)
            | Command::Help(_) => {}
        }
        self.slot.ask(&match command {
            // Worlds are built where they are traced.
            Command::World(_) | Command::Rest(..) | Command::Help(_) => return,
            Command::Hide(hidden) => Ask::Hide(hidden),
            Command::Style(style) => Ask::Style(Box::new(Style::of(&style))),
            Command::Draw(request) => Ask::Draw(request),
            Command::Stop => Ask::Stop,
            Command::Look(request, x, y) => Ask::Look(request, x, y),
            Command::Inspect(request, x, y) => Ask::Inspect(request, x, y),
        });
    }

    /// Reads a scene for the screen, and has the tracer read it, too.
    pub fn read(&mut self, asked: Asked, teller: &Teller) {
        let recorder = Recorder::new(&*asked.source.files, MOST);
        if teller.read(&asked, &recorder).is_none() {
            return;
        }
        let files =
            if asked.source.files.is_known_elsewhere() { Vec::new() } else { recorder.kept().files() };
        let (path, accel) = (asked.source.path.to_string_lossy().into_owned(), asked.prepare.accel.name());
        self.slot.ask(&Ask::Open { number: asked.number, path, accel: accel.to_owned(), files });
    }

    /// Takes what has come.
    pub fn work(&mut self, teller: &Teller) {
        let outgoing = std::mem::take(&mut *self.outgoing.lock().unwrap_or_else(PoisonError::into_inner));
        outgoing.iter().for_each(|ask| self.slot.ask(ask));
        let arrived = std::mem::take(&mut *self.arrived.borrow_mut());
        for tell in arrived {
            match tell {
                Some(Ok(tell)) => self.take(tell, teller),
                Some(Err(fault)) => teller.tell(News::Notice(fault)),
                None => teller.tell(News::Notice("the tracer is gone: load the page again".to_owned())),
            }
        }
    }

    fn take(&mut self, tell: Tell, teller: &Teller) {
        let current = |number: u64| teller.last_asked.load(Ordering::Relaxed) == number;
        match tell {
            Tell::Scene { path, files } => {
                let files = Arc::new(Served::new(files, self.outgoing.clone()));
                teller.tell(News::Sent(Source { path: PathBuf::from(path), files }));
            }
            Tell::Prepared(number, seconds) if current(number) => teller.tell(News::Prepared(seconds)),
            Tell::Failed(number, texts) if current(number) => {
                let messages = texts.into_iter().map(|text| Message { error: true, text }).collect();
                teller.tell(News::Failed(messages));
            }
            Tell::Tracers(number, count) if current(number) => teller.tell(News::Tracers(count)),
            // What tracers tell each other goes to no screen.
            Tell::Prepared(..) | Tell::Failed(..) | Tell::Tracers(..) | Tell::Part(_) => {}
            Tell::Picture(sent) => {
                let slot = self.slot.clone();
                after_a_frame(move || slot.ask(&Ask::Shown));
                if sent.film.is_some() && self.traced.get() == Some(sent.serial) {
                    self.traced.set(None);
                }
                let sent = sent.whole(&self.before);
                self.before.clone_from(&sent.pixels);
                let size = sent.size.map(|edge| edge as usize);
                let image = sent.film.and_then(|film| image(size, &film));
                teller.tell(News::Reply(Reply::Picture {
                    serial: sent.serial,
                    size,
                    pixels: Arc::new(sent.pixels),
                    progress: sent.progress,
                    image: image.map(Arc::new),
                }));
            }
            Tell::Seen(seen) => teller.tell(News::Reply(Reply::Seen(seen))),
            Tell::Rays(rows) => teller.tell(News::Reply(Reply::Rays(Arc::new(rows)))),
            Tell::Refused(sentence) => teller.tell(News::Reply(Reply::Refused(sentence))),
            Tell::Notice(sentence) => teller.tell(News::Notice(sentence)),
        }
    }
}

/// Has the tracer held as soon as a hand does something over the canvas while a picture is traced, and then a frame
/// drawn, which lets the tracer go on.
fn brake(
    page: &Page,
    slot: &Slot,
    traced: &Rc<Cell<Option<u64>>>,
    hold: &Rc<Hold>,
    teller: &Teller,
) -> Closure<dyn FnMut(JsValue)> {
    let (slot, traced, hold, wake) = (slot.clone(), traced.clone(), hold.clone(), teller.wake.clone());
    let listener: Closure<dyn FnMut(JsValue)> = Closure::new(move |event: JsValue| {
        // A pointer that only hovers moves nothing.
        let hovers = get(&event, "buttons").and_then(|buttons| buttons.as_f64()) == Some(0.0);
        let is_wheel = get(&event, "deltaY").is_some();
        if traced.get().is_some() && (is_wheel || !hovers) {
            hold.deeds.set(hold.deeds.get() + 1);
            if !hold.held.replace(true) {
                slot.ask(&Ask::Hold);
            }
            wake();
        }
    });
    for deed in DEEDS {
        // A browser that lets nobody listen shows its deeds with the next frame.
        let _ = page.canvas.add_event_listener_with_callback_and_bool(
            deed,
            listener.as_ref().unchecked_ref(),
            true,
        );
    }
    listener
}

/// Does something once this frame has been drawn: the browser's next frame but one comes no sooner.
fn after_a_frame(deed: impl FnOnce() + 'static) {
    let call = |call: JsValue| {
        let later = get(&js_sys::global(), "requestAnimationFrame")?.dyn_into::<js_sys::Function>().ok()?;
        later.call1(&JsValue::NULL, &call).ok()
    };
    let next = move || drop(call(Closure::once_into_js(deed)));
    call(Closure::once_into_js(next));
}

/// The finished picture of its samples' bytes.
fn image([width, height]: [usize; 2], film: &[u8]) -> Option<Image> {
    let samples: Vec<f32> = bytemuck::pod_collect_to_vec(film);
    let channels = if samples.len() == width * height * 4 { Channels::Rgba } else { Channels::Rgb };
    Image::from_samples(width, height, channels, samples).ok()
}
