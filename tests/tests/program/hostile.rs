//! No input crashes, hangs or fills memory: scenes cut off at every byte, and with bytes changed at random.

use super::bytes::Random;
use super::bytes::changed;
use dotray_accel::Kind;
use dotray_render::Options;
use dotray_tests::corpus;
use dotray_tests::pictures;
use std::sync::mpsc;
use std::time::Duration;
use std::time::Instant;

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

/// Small scenes of every dialect.
const DIALECTS: [&str; 5] = [
    "../../scenes/dialects/table-uva.ray",
    "../../scenes/dialects/table-jhu.ray",
    "../../scenes/dialects/ring-jhu.ray",
    "../../scenes/dialects/pipes-hmc.ray",
    "../../scenes/dialects/blocks-unisa.scene",
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

/// As much of an input as a reader of the report can bear.
fn start_of(input: &[u8]) -> String {
    format!("{} bytes: {}", input.len(), String::from_utf8_lossy(&input[..input.len().min(4000)]))
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
                panic!("{name} hangs:\n{}", start_of(input))
            }
            Err(mpsc::RecvTimeoutError::Disconnected) => {
                panic!("{name} crashes:\n{}", start_of(input));
            }
        }
    }
    worker.join().expect("it came to its end");
    rendered
}

#[test]
fn scenes_cut_off_at_every_byte_survive() {
    for name in SCENES.into_iter().chain(DIALECTS) {
        let text = text_of(name);
        let step = text.len().div_ceil(2500);
        let inputs: Vec<Vec<u8>> = (0..text.len()).step_by(step).map(|end| text[..end].to_vec()).collect();
        let count = inputs.len();
        let rendered = all_survive(name, inputs);
        println!("{name}: {rendered} of {count} rendered");
        assert!(rendered < count, "{name}: some cut must be an error");
    }
}

#[test]
fn scenes_with_random_changes_survive() {
    let mut random = Random::new(0x9e37_79b9_7f4a_7c15);
    for name in SCENES.into_iter().chain(DIALECTS) {
        let text = text_of(name);
        let inputs: Vec<Vec<u8>> = (0..1500).map(|_| changed(&text, &mut random)).collect();
        let rendered = all_survive(name, inputs);
        println!("{name}: {rendered} of 1500 rendered");
        assert!(rendered > 50, "{name}: changes that break everything test little");
    }
}

#[test]
fn bytes_that_are_no_scene_survive() {
    let mut random = Random::new(7);
    let inputs = (0..2000).map(|i| (0..i % 200).map(|_| random.below(256) as u8).collect()).collect();
    all_survive("noise", inputs);
}

/// The most memory that this process has held so far.
fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()?.checked_mul(1024)
}

#[test]
fn lines_of_a_million_words_survive() {
    const WORDS: usize = 1_000_000;
    const OPEN: &str = "#group_begin 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 ";
    let begin = "#camera 0 0 9 0 0 -1 0 1 0 .4 #light_dir 1 1 1 0 0 -1 ";
    let line = |words: &str| {
        let count = WORDS.div_ceil(words.split_whitespace().count());
        format!("{begin}{}", words.repeat(count)).into_bytes()
    };
    let nested =
        |end: &str| format!("{begin}{}#shape_sphere -1 0 0 0 1 {}", OPEN.repeat(60_000), end.repeat(60_000));
    let inputs: Vec<(bool, Vec<u8>)> = vec![
        (true, line("#shape_sphere -1 0 0 0 1 ")),
        (true, line("#shape_box -1 0 0 0 1 1 1 ")),
        (true, line("#light_point .1 .1 .1 0 0 5 1 0 0 ")),
        (true, line(&format!("{OPEN}#shape_sphere -1 0 0 0 1 #group_end "))),
        (true, nested("#group_end ").into_bytes()),
        (false, nested(" ").into_bytes()),
        (false, line(OPEN)),
        (false, line("#group_end ")),
        (false, line("#ambient ")),
        (false, line("#wrong ")),
        (false, line("1 ")),
        (false, line("1e308 -1e308 ")),
        (false, line("#sphere 1 1 1 ")),
        (false, line("#cylinder #cone #torus #material ")),
        (false, line("#ray_file nowhere ")),
        (false, line("#texture nowhere.png ")),
        (false, line("#material 0 0 0 0 0 0 0 0 0 0 0 0 0 0 1 -1 !a! #shape_sphere 99999 0 0 0 1 ")),
        (false, format!("{begin}#ambient {} 1 1", "1".repeat(WORDS)).into_bytes()),
        (false, format!("{begin}#{}", "a".repeat(WORDS)).into_bytes()),
        (false, format!("{begin}#texture \"{}\"", "a ".repeat(WORDS)).into_bytes()),
        (false, format!("{begin}/* {}", "* / ".repeat(WORDS)).into_bytes()),
        (true, format!("{begin}#shape_sphere -1 0 0 0 1 /* {} */", "words ".repeat(WORDS)).into_bytes()),
        (
            true,
            format!(
                "{begin}#shape_sphere 0 0 0 0 1 #material 0 0 0 1 1 1 0 0 0 0 0 0 0 0 1 -1 !{}!",
                "a ".repeat(WORDS)
            )
            .into_bytes(),
        ),
    ];
    for (sound, input) in inputs {
        let start: String = String::from_utf8_lossy(&input[begin.len()..]).chars().take(60).collect();
        let before = Instant::now();
        let rendered = all_survive("words.ray", vec![input]);
        println!("{start}…: {:?}", before.elapsed());
        assert_eq!(rendered == 1, sound, "{start}…");
    }
    if let Some(peak) = peak_memory() {
        assert!(peak < 3 << 30, "{peak} bytes were held");
    }
}
