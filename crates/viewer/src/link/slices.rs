//! Tracing on the page's one thread.

use super::Asked;
use super::News;
use super::Teller;
use crate::engine::Command;
use crate::engine::Engine;
use crate::hidden::without_shapes;
use dotray_render::Textures;
use dotray_scene::Resolved;
use std::cell::RefCell;
use std::collections::VecDeque;
use wasm_bindgen::JsCast;
use wasm_bindgen::JsValue;
use web_time::Instant;

/// See the module.
pub struct Slices {
    engine: Engine,
    commands: RefCell<VecDeque<Command>>,
    /// A scene that was read and has to be built, after it was drawn.
    unbuilt: Option<Box<(Asked, Resolved, Textures)>>,
}

/// Whether a hand has done something; some browsers tell.
fn is_input_pending() -> bool {
    let get = |object: &JsValue, name: &str| js_sys::Reflect::get(object, &name.into()).ok();
    let scheduling = get(&js_sys::global(), "navigator").and_then(|navigator| get(&navigator, "scheduling"));
    let Some(scheduling) = scheduling.filter(JsValue::is_object) else { return false };
    let Some(asked) = get(&scheduling, "isInputPending") else { return false };
    let Ok(asked) = asked.dyn_into::<js_sys::Function>() else { return false };
    let options = js_sys::Object::new();
    let _ = js_sys::Reflect::set(&options, &"includeContinuous".into(), &JsValue::TRUE);
    asked.call1(&scheduling, &options).is_ok_and(|pending| pending.is_truthy())
}

impl Default for Slices {
    fn default() -> Self {
        let mut engine = Engine::default();
        engine.ask_whether_to_stop(is_input_pending);
        Self { engine, commands: RefCell::default(), unbuilt: None }
    }
}

impl Slices {
    pub fn send(&self, command: Command) {
        self.commands.borrow_mut().push_back(command);
    }

    pub fn read(&mut self, asked: Asked, teller: &Teller) {
        let read = teller.read(&asked, &*asked.source.files);
        self.unbuilt = read.map(|(resolved, textures)| Box::new((asked, resolved, textures)));
    }

    /// All commands and one portion of tracing.
    pub fn work(&mut self, teller: &Teller) {
        if let Some(parts) = self.unbuilt.take() {
            let (asked, resolved, textures) = *parts;
            let start = Instant::now();
            let (rest, prepare) = (Box::new(without_shapes(&resolved)), asked.prepare.clone());
            if let Some(world) = teller.build(&asked, resolved, textures) {
                self.send(Command::World(Some(world)));
                self.send(Command::Rest(rest, prepare));
                teller.tell(News::Prepared(start.elapsed().as_secs_f64()));
            }
        }
        let commands = std::mem::take(&mut *self.commands.borrow_mut());
        for command in commands {
            self.engine.handle(command).into_iter().for_each(|reply| teller.tell(News::Reply(reply)));
        }
        if self.engine.is_busy() {
            self.engine.advance().into_iter().for_each(|reply| teller.tell(News::Reply(reply)));
            (teller.wake)();
        }
    }
}
