//! Tracers in threads of their own beside the page: workers, which run the same program. One leads the others.

use crate::bundle::Bundle;
use crate::clerk::Clerk;
use crate::crew::Crew;
use crate::crew::Post;
use crate::wire::Tell;
use crate::wire::bytes;
use crate::wire::message;
use std::cell::RefCell;
use std::rc::Rc;
use wasm_bindgen::JsCast;
use wasm_bindgen::JsValue;
use wasm_bindgen::closure::Closure;

/// What a worker has.
struct Worker {
    clerk: Clerk,
    /// What leads others; they answer by ports.
    crew: Crew,
    mates: Vec<JsValue>,
    /// Where it is led from; the page, for the one that leads.
    leader: JsValue,
    later: js_sys::Function,
    /// What goes on after messages that have come meanwhile.
    go_on: Option<Closure<dyn FnMut()>>,
    waiting: bool,
    /// The page's count of what could not wait, as far as the leader had heard of it when it wrote last.
    turn: f64,
}

type Shared = Rc<RefCell<Worker>>;

/// Bytes that the instances of all workers may have together: each has the scene.
const MOST: usize = 3 << 30;

fn get(object: &JsValue, name: &str) -> Option<JsValue> {
    js_sys::Reflect::get(object, &name.into()).ok().filter(|value| !value.is_undefined() && !value.is_null())
}

/// What the worker's JavaScript has put into its global `rayview`.
fn given(name: &str) -> Option<JsValue> {
    get(&js_sys::global(), "rayview").and_then(|given| get(&given, name))
}

/// Whether the page has something that cannot wait; it costs about a millisecond to know where no memory is shared.
fn is_stopped() -> bool {
    let stopped = given("stopped").and_then(|stopped| stopped.dyn_into::<js_sys::Function>().ok());
    stopped.is_some_and(|stopped| stopped.call0(&JsValue::NULL).is_ok_and(|stopped| stopped.is_truthy()))
}

/// For how many mates there is room beside an instance as large as this one.
fn room() -> usize {
    const PAGE: usize = 64 << 10;
    let bytes = core::arch::wasm32::memory_size(0) * PAGE;
    (MOST / bytes.max(1)).saturating_sub(1)
}

/// Sends to a port, a worker or a page.
fn send(to: &JsValue, what: &JsValue) {
    let post = get(to, "postMessage").and_then(|post| post.dyn_into::<js_sys::Function>().ok());
    // A page that is gone ends its workers.
    let _ = post.map(|post| post.call1(to, what));
}

fn array(bytes: &[u8]) -> JsValue {
    js_sys::Uint8Array::from(bytes).into()
}

impl Worker {
    /// Sends what is to be sent; mates learn how far their leader has heard.
    fn post(&self, post: Post) {
        post.tells.iter().for_each(|tell| send(&self.leader, &array(&bytes(tell))));
        let turn = given("turn").unwrap_or(JsValue::from_f64(0.0));
        for (number, ask) in &post.asks {
            let Some(mate) = self.mates.get(*number) else { continue };
            let letter = js_sys::Object::new();
            let _ = js_sys::Reflect::set(&letter, &"bytes".into(), &array(&bytes(ask)));
            let _ = js_sys::Reflect::set(&letter, &"turn".into(), &turn);
            send(mate, &letter);
        }
    }

    /// Tells the mates that what the page could not wait for has been heard.
    fn tell_turn(&self) {
        let Some(turn) = given("turn").filter(|turn| turn.as_f64() != Some(self.turn)) else { return };
        let letter = js_sys::Object::new();
        let _ = js_sys::Reflect::set(&letter, &"turn".into(), &turn);
        self.mates.iter().for_each(|mate| send(mate, &letter));
    }

    /// What the page or the leader asks.
    fn take(&mut self, event: &JsValue) {
        let Some(data) = get(event, "data") else { return };
        let asked =
            get(&data, "bytes").or_else(|| data.is_instance_of::<js_sys::Uint8Array>().then(|| data.clone()));
        if let Some(asked) = asked {
            let post = match message(&js_sys::Uint8Array::new(&asked).to_vec()) {
                Ok(ask) if self.mates.is_empty() => {
                    Post { tells: self.clerk.handle(ask, &Bundle::default()), asks: Vec::new() }
                }
                Ok(ask) => self.crew.take(ask, &mut self.clerk),
                Err(fault) => Post { tells: vec![Tell::Notice(fault)], asks: Vec::new() },
            };
            self.post(post);
        }
        self.tell_turn();
        let turn = get(&data, "turn").and_then(|turn| turn.as_f64());
        self.turn = turn.unwrap_or(self.turn);
        self.go_on_later();
    }

    /// What a mate tells.
    fn heard(&mut self, mate: usize, event: &JsValue) {
        let Some(data) = get(event, "data") else { return };
        // A mate's rubbish is worth nothing: the leader traces what it had.
        if let Ok(tell) = message(&js_sys::Uint8Array::new(&data).to_vec()) {
            let post = self.crew.heard(mate, tell, &mut self.clerk);
            self.post(post);
        }
        self.go_on_later();
    }

    /// Traces a portion, unless the page has something new that the leader has not told of yet.
    fn go_on(&mut self) {
        self.waiting = false;
        let heard = given("turn").and_then(|turn| turn.as_f64()).unwrap_or(0.0);
        if heard > self.turn || !self.clerk.is_busy() {
            return;
        }
        if let Some(tell) = self.clerk.advance() {
            self.post(Post { tells: vec![tell], asks: Vec::new() });
        }
        self.go_on_later();
    }

    /// Goes on as soon as the messages that wait were taken.
    fn go_on_later(&mut self) {
        if let Some(go_on) = self.go_on.as_ref().filter(|_| self.clerk.is_busy() && !self.waiting) {
            self.waiting = self.later.call1(&js_sys::global(), go_on.as_ref()).is_ok();
        }
    }
}

/// Has `take` called with what comes to a port, a worker or its page.
fn listen(to: &JsValue, take: impl FnMut(JsValue) + 'static) {
    let listener: Closure<dyn FnMut(JsValue)> = Closure::new(take);
    let _ = js_sys::Reflect::set(to, &"onmessage".into(), listener.as_ref());
    // It lives as long as the worker.
    listener.forget();
}

/// Works for the page that started it, until that ends it. The worker's JavaScript may have put into its global
/// `rayview`: `mates`, the ports of those whom this one leads; `leader`, the port of the one who leads it; `turn`, how
/// many things the page has asked that could not wait, `stopped`, a function that says whether there is another one;
/// and `later`, a function that calls another as soon as the messages that wait were taken.
pub fn run() {
    let function = |value: JsValue| value.dyn_into::<js_sys::Function>().ok();
    let global: JsValue = js_sys::global().into();
    let later = given("later").or_else(|| get(&global, "setTimeout")).and_then(function);
    let Some(later) = later else { return };
    let mates: Vec<JsValue> =
        given("mates").map_or_else(Vec::new, |mates| js_sys::Array::from(&mates).to_vec());
    let mut clerk = Clerk::default();
    if given("stopped").is_some() {
        clerk.ask_whether_to_stop(is_stopped);
    }
    let leader = given("leader").unwrap_or_else(|| global.clone());
    let crew = Crew::new(mates.len(), room);
    let worker = Worker {
        clerk,
        crew,
        mates: mates.clone(),
        leader: leader.clone(),
        later,
        go_on: None,
        waiting: false,
        turn: 0.0,
    };
    let shared: Shared = Rc::new(RefCell::new(worker));
    let of_rest = shared.clone();
    shared.borrow_mut().go_on = Some(Closure::new(move || of_rest.borrow_mut().go_on()));
    for (number, mate) in mates.iter().enumerate() {
        let of_mate = shared.clone();
        listen(mate, move |event| of_mate.borrow_mut().heard(number, &event));
    }
    listen(&leader, move |event| shared.borrow_mut().take(&event));
    send(&global, &JsValue::NULL);
}
