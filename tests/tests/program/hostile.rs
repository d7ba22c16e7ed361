//! No input crashes, hangs or fills memory: scenes cut off at every byte, and with bytes changed at random.

use dotray_accel::Kind;
use dotray_render::Options;
use dotray_tests::corpus;
use dotray_tests::pictures;
use std::sync::mpsc;
use std::time::Duration;

/// What one input may take, on a loaded machine.
const PATIENCE: Duration = Duration::from_secs(60);

/// Small scenes that use most of the language.
const SCENES: [&str; 6] = [
    "slides_example.ray",
    "syntax_lenient.ray",
    "syntax_forms.ray",
    "light_area.ray",
    "bump_shapes.ray",
    "group_shear.ray",
];

fn text_of(scene: &str) -> Vec<u8> {
    std::fs::read(corpus::root().join("tests/conformance").join(scene)).expect("a scene")
}

/// Reads, resolves and renders; whatever comes of it, it comes.
fn survives(name: &str, text: Vec<u8>) -> bool {
    let path = corpus::root().join("tests/conformance").join(name);
    let scene = pictures::scene_of_text(&path.to_string_lossy(), text);
    let world = scene.and_then(|scene| pictures::world(scene, Kind::Bvh));
    let options = Options { width: 8, height: 8, light_samples: 4, threads: Some(1), ..Options::default() };
    world.is_ok_and(|world| {
        pictures::picture(&world, &options).is_ok_and(|image| {
            // Values may be huge, but a number that is none must not come of finite input.
            assert!(!image.samples().iter().any(|sample| sample.is_nan()), "{name}: not a number");
            true
        })
    })
}

/// Goes through the inputs on a thread of its own, so that one that hangs is named.
fn all_survive(name: &'static str, inputs: Vec<Vec<u8>>) -> usize {
    let (tell, told) = mpsc::channel();
    let total = inputs.len();
    let shown = inputs.clone();
    let worker = std::thread::spawn(move || {
        for input in inputs {
            let rendered = survives(name, input);
            if tell.send(rendered).is_err() {
                return;
            }
        }
    });
    let mut rendered = 0;
    for input in shown.iter().take(total) {
        match told.recv_timeout(PATIENCE) {
            Ok(done) => rendered += usize::from(done),
            Err(mpsc::RecvTimeoutError::Timeout) => {
                panic!("{name} hangs:\n{}", String::from_utf8_lossy(input))
            }
            Err(mpsc::RecvTimeoutError::Disconnected) => {
                panic!("{name} crashes:\n{}", String::from_utf8_lossy(input));
            }
        }
    }
    worker.join().expect("it came to its end");
    rendered
}

#[test]
fn scenes_cut_off_at_every_byte_survive() {
    for name in SCENES {
        let text = text_of(name);
        let step = text.len().div_ceil(2500);
        let inputs: Vec<Vec<u8>> = (0..text.len()).step_by(step).map(|end| text[..end].to_vec()).collect();
        let count = inputs.len();
        let rendered = all_survive(name, inputs);
        println!("{name}: {rendered} of {count} rendered");
        assert!(rendered < count, "{name}: some cut must be an error");
    }
}

/// Xorshift: the same inputs in every run.
struct Random(u64);

impl Random {
    fn below(&mut self, end: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % end.max(1) as u64) as usize
    }
}

/// Words that mean trouble.
const TROUBLE: [&str; 16] = [
    "nan",
    "-inf",
    "1e308",
    "-1e308",
    "1e-320",
    "0",
    "-1",
    "99999999999999999999",
    "#group_end",
    "#group_begin",
    "!",
    "\"",
    "/*",
    "#",
    "1e400",
    "4294967296",
];

/// Changes a few bytes or words.
fn changed(text: &[u8], random: &mut Random) -> Vec<u8> {
    let mut text = text.to_vec();
    for _ in 0..=random.below(3) {
        let at = random.below(text.len());
        match random.below(6) {
            0 => text[at] = random.below(256) as u8,
            1 => text[at] ^= 1 << random.below(8),
            2 => {
                text.remove(at);
            }
            3 => text.insert(at, b"0123456789.-+e#! \n"[random.below(18)]),
            4 => {
                let end = (at + random.below(60)).min(text.len());
                let copy = text[at..end].to_vec();
                text.splice(at..at, copy);
            }
            _ => {
                // A whole word makes place for one that means trouble.
                let blank = |byte: &u8| byte.is_ascii_whitespace();
                let start = text[..at].iter().rposition(blank).map_or(0, |found| found + 1);
                let end = text[at..].iter().position(blank).map_or(text.len(), |found| at + found);
                text.splice(start..end, TROUBLE[random.below(TROUBLE.len())].bytes());
            }
        }
        if text.is_empty() {
            break;
        }
    }
    text
}

#[test]
fn scenes_with_random_changes_survive() {
    let mut random = Random(0x9e37_79b9_7f4a_7c15);
    for name in SCENES {
        let text = text_of(name);
        let inputs: Vec<Vec<u8>> = (0..1500).map(|_| changed(&text, &mut random)).collect();
        let rendered = all_survive(name, inputs);
        println!("{name}: {rendered} of 1500 rendered");
        assert!(rendered > 50, "{name}: changes that break everything test little");
    }
}

#[test]
fn bytes_that_are_no_scene_survive() {
    let mut random = Random(7);
    let inputs = (0..2000).map(|i| (0..i % 200).map(|_| random.below(256) as u8).collect()).collect();
    all_survive("noise", inputs);
}
