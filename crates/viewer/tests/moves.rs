//! How soon the tracer behind the screen hears a move. Alone in its file: other tests would take its threads away.

mod heavy;

use dotray_render::Antialias;
use dotray_render::Options;
use dotray_render::PrepareOptions;
use dotray_render::World;
use dotray_scene::files::Disk;
use dotray_scene::load::LoadOptions;
use dotray_scene::load::load_text;
use dotray_scene::resolve::resolve;
use rayview::engine::Command;
use rayview::engine::Engine;
use rayview::engine::Request;
use std::sync::atomic::Ordering;
use std::sync::mpsc::TryRecvError;
use std::time::Duration;
use std::time::Instant;

fn heavy_world() -> Box<World> {
    let scene = load_text("heavy.ray", heavy::text(), &Disk, &LoadOptions::default()).scene.expect("a scene");
    let resolved = resolve(scene).resolved.expect("resolved");
    Box::new(World::prepare(resolved, &Disk, &PrepareOptions::default()).expect("a world"))
}

/// Moves come at any time while a picture is traced that takes minutes; each is to be heard within 50 ms.
#[test]
fn a_move_is_heard_within_50_milliseconds() {
    let world = heavy_world();
    let options = Options {
        width: 120,
        height: 90,
        recursion: 4,
        threshold: 0.0,
        antialias: Antialias::Grid(8),
        ..Options::default()
    };
    let camera = *world.camera();
    let request = |serial| Box::new(Request { serial, camera, options: options.clone() });
    let requests: Vec<_> = (0..24).map(request).collect();
    let mut engine = Engine::default();
    let interrupt = engine.interrupt();
    engine.handle(Command::World(Some(world)));
    let (moves, received) = std::sync::mpsc::channel::<(Instant, Box<Request>)>();
    let tracer = std::thread::spawn(move || {
        let (mut waits, mut longest) = (Vec::new(), Duration::ZERO);
        loop {
            // As the window's own thread does it: what was interrupted for is heard next.
            engine.interrupt().store(false, Ordering::Relaxed);
            match received.try_recv() {
                Ok((sent, request)) => {
                    engine.handle(Command::Draw(request));
                    waits.push(sent.elapsed());
                }
                Err(TryRecvError::Empty) => {
                    let start = Instant::now();
                    engine.advance();
                    longest = longest.max(start.elapsed());
                }
                Err(TryRecvError::Disconnected) => break,
            }
        }
        (waits, longest)
    });
    for (request, pause) in
        requests.into_iter().zip([2000].into_iter().chain((1..).map(|k| 150 + k * 97 % 300)))
    {
        moves.send((Instant::now(), request)).expect("it listens");
        interrupt.store(true, Ordering::Relaxed);
        std::thread::sleep(Duration::from_millis(pause));
    }
    interrupt.store(true, Ordering::Relaxed);
    drop(moves);
    let (mut waits, longest) = tracer.join().expect("it ended");
    waits.sort();
    // Nothing but the interruption ends such a portion in time.
    assert!(longest > Duration::from_millis(150), "the scene is too light to tell anything: {longest:?}");
    // Other programs may take the cores away for a while, which makes single waits longer.
    let (most, last) = (waits[waits.len() * 3 / 4], waits[waits.len() - 1]);
    assert!(most < Duration::from_millis(50) && last < Duration::from_millis(1000), "{waits:?}");
    println!("longest portion {longest:?}, waits: three quarters {most:?}, all {last:?}");
}
