//! A tracer in a thread of its own beside the page: a worker, which runs the same program.

use crate::bundle::Bundle;
use crate::clerk::Clerk;
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
    post: js_sys::Function,
    later: js_sys::Function,
    /// What goes on after messages that have come meanwhile.
    go_on: Option<Closure<dyn FnMut()>>,
    waiting: bool,
}

type Shared = Rc<RefCell<Worker>>;

fn global(name: &str) -> Option<js_sys::Function> {
    js_sys::Reflect::get(&js_sys::global(), &name.into()).ok()?.dyn_into().ok()
}

impl Worker {
    fn tell(&self, tells: impl IntoIterator<Item = Tell>) {
        for tell in tells {
            let bytes = js_sys::Uint8Array::from(bytes(&tell).as_slice());
            // A page that is gone ends its workers.
            let _ = self.post.call1(&js_sys::global(), &bytes);
        }
    }

    /// Goes on as soon as the messages that wait were taken.
    fn go_on_later(&mut self) {
        if let Some(go_on) = self.go_on.as_ref().filter(|_| self.clerk.is_busy() && !self.waiting) {
            self.waiting = self.later.call1(&js_sys::global(), go_on.as_ref()).is_ok();
        }
    }
}

/// Works for the page that started it, until that ends it.
pub fn run() {
    let (Some(post), Some(later)) = (global("postMessage"), global("setTimeout")) else { return };
    let worker = Worker { clerk: Clerk::default(), post, later, go_on: None, waiting: false };
    let shared: Shared = Rc::new(RefCell::new(worker));
    let of_rest = shared.clone();
    let go_on = Closure::new(move || {
        let mut worker = of_rest.borrow_mut();
        worker.waiting = false;
        let tell = worker.clerk.advance();
        worker.tell(tell);
        worker.go_on_later();
    });
    shared.borrow_mut().go_on = Some(go_on);
    let listener: Closure<dyn FnMut(JsValue)> = Closure::new(move |event: JsValue| {
        let Ok(data) = js_sys::Reflect::get(&event, &"data".into()) else { return };
        let mut worker = shared.borrow_mut();
        let tells = match message(&js_sys::Uint8Array::new(&data).to_vec()) {
            Ok(ask) => worker.clerk.handle(ask, &Bundle::default()),
            Err(fault) => vec![Tell::Notice(fault)],
        };
        worker.tell(tells);
        worker.go_on_later();
    });
    let _ = js_sys::Reflect::set(&js_sys::global(), &"onmessage".into(), listener.as_ref());
    // It lives as long as the worker.
    listener.forget();
    let _ = global("postMessage").map(|post| post.call1(&js_sys::global(), &JsValue::NULL));
}
