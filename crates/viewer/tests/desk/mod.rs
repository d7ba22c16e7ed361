//! A display of its own, programs on it, and what can be seen there.

use dotray_image::Image;
use dotray_image::Limits;
use std::io::BufRead;
use std::io::BufReader;
use std::io::Write;
use std::path::Path;
use std::process::Child;
use std::process::Command;
use std::process::Stdio;
use std::sync::Mutex;
use std::sync::MutexGuard;
use std::sync::PoisonError;
use std::thread::sleep;
use std::time::Duration;
use std::time::Instant;
use std::time::SystemTime;
use std::time::UNIX_EPOCH;

/// How long anything may take: software drivers on busy machines are slow.
const PATIENCE: Duration = Duration::from_secs(150);

/// A rectangle of the screen: left, top, width, height.
pub type Part = [usize; 4];

/// One screen at a time: software drivers take all cores.
static ALONE: Mutex<()> = Mutex::new(());

pub struct Desk {
    server: Child,
    _alone: MutexGuard<'static, ()>,
    display: String,
}

/// A hand that is quick: one program that does what it is told as soon as it is told.
pub struct Hand(Child);

pub struct Window<'a> {
    desk: &'a Desk,
    program: Child,
}

impl Desk {
    /// A fresh screen; `None`, said aloud, where the programs for it are missing.
    pub fn new() -> Option<Self> {
        let has = |program: &str| {
            let found = Command::new("sh").arg("-c").arg(format!("command -v {program}")).output();
            found.is_ok_and(|output| output.status.success())
        };
        if let Some(missing) = ["Xvfb", "xdotool", "import"].into_iter().find(|program| !has(program)) {
            let required = std::env::var("RAYVIEW_SCREEN").is_ok_and(|value| value == "required");
            assert!(!required, "{missing} is missing");
            println!("skipped, no {missing}");
            return None;
        }
        let alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
        let mut server = Command::new("Xvfb")
            .args(["-displayfd", "1", "-screen", "0", "1500x1000x24", "-nolisten", "tcp", "-noreset"])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("Xvfb");
        let mut number = String::new();
        BufReader::new(server.stdout.take().expect("its output")).read_line(&mut number).expect("a display");
        Some(Self { server, _alone: alone, display: format!(":{}", number.trim()) })
    }

    /// Opens a scene and waits until the window is there and has the keyboard.
    pub fn open(&self, scene: &Path, arguments: &[&str], scale: &str) -> Window<'_> {
        self.open_by(&[], scene, arguments, scale)
    }

    /// The same with environment variables of its own.
    pub fn open_by(
        &self,
        variables: &[(&str, &str)],
        scene: &Path,
        arguments: &[&str],
        scale: &str,
    ) -> Window<'_> {
        let program = Command::new(env!("CARGO_BIN_EXE_rayview"))
            .arg(scene)
            .args(arguments)
            .envs(variables.iter().copied())
            .env("DISPLAY", &self.display)
            .env("LIBGL_ALWAYS_SOFTWARE", "1")
            .env("WINIT_X11_SCALE_FACTOR", scale)
            .env_remove("WAYLAND_DISPLAY")
            .spawn()
            .expect("rayview");
        let window = Window { desk: self, program };
        self.until("the window opens", || {
            self.tool(&["search", "--onlyvisible", "--name", "rayview", "windowfocus"])
        });
        // The first frame comes after the window.
        self.until("the window is drawn", || self.screen().to_rgb8(false).iter().any(|byte| *byte > 40));
        sleep(Duration::from_secs(2));
        window
    }

    /// A quick hand.
    pub fn hand(&self) -> Hand {
        let started =
            Command::new("xdotool").arg("-").env("DISPLAY", &self.display).stdin(Stdio::piped()).spawn();
        Hand(started.expect("xdotool"))
    }

    fn tool(&self, arguments: &[&str]) -> bool {
        let run = Command::new("xdotool").args(arguments).env("DISPLAY", &self.display).output();
        run.is_ok_and(|output| output.status.success())
    }

    /// What is on the clipboard; `None` where the program that tells is missing.
    pub fn clipboard(&self) -> Option<String> {
        let arguments = ["-selection", "clipboard", "-o"];
        let run = Command::new("xclip").args(arguments).env("DISPLAY", &self.display).output().ok()?;
        Some(String::from_utf8_lossy(&run.stdout).into_owned())
    }

    /// Waits for something.
    pub fn until(&self, what: &str, mut holds: impl FnMut() -> bool) {
        let start = Instant::now();
        while !holds() {
            if start.elapsed() > PATIENCE {
                self.keep("failed");
                panic!("waited in vain: {what}");
            }
            sleep(Duration::from_millis(300));
        }
    }

    fn shot(&self) -> Vec<u8> {
        let shot = Command::new("import")
            .args(["-display", &self.display, "-window", "root", "-depth", "8", "png24:-"])
            .output()
            .expect("import");
        assert!(shot.status.success(), "{}", String::from_utf8_lossy(&shot.stderr));
        shot.stdout
    }

    /// All that is on the screen.
    pub fn screen(&self) -> Image {
        dotray_image::decode(&self.shot(), None, &Limits::default()).expect("a screenshot")
    }

    /// Keeps a screenshot in the folder that `RAYVIEW_SHOTS` names, for people to look at.
    pub fn keep(&self, name: &str) {
        if let Some(folder) = std::env::var_os("RAYVIEW_SHOTS") {
            std::fs::write(Path::new(&folder).join(format!("{name}.png")), self.shot()).expect("written");
        }
    }

    /// A part of the screen, eight bits a channel.
    pub fn part(&self, [left, top, width, height]: Part) -> Vec<u8> {
        self.screen().crop(left, top, width, height).expect("inside").to_rgb8(false)
    }

    /// Where a picture stands on the screen, exactly.
    pub fn find(&self, picture: &[u8], width: u32, height: u32) -> Option<Part> {
        let screen = self.screen();
        let (across, down) = (screen.width(), screen.height());
        let bytes = screen.to_rgb8(false);
        let (width, height) = (width as usize, height as usize);
        let row = |left: usize, top: usize| {
            let start = (top * across + left) * 3;
            &bytes[start..start + width * 3]
        };
        let stands = |left: usize, top: usize| {
            picture.chunks_exact(width * 3).enumerate().all(|(y, wanted)| row(left, top + y) == wanted)
        };
        for top in 0..down.saturating_sub(height) {
            for left in 0..across.saturating_sub(width) {
                if stands(left, top) {
                    return Some([left, top, width, height]);
                }
            }
        }
        None
    }
}

impl Drop for Desk {
    fn drop(&mut self) {
        // A server that is killed outright leaves its lock behind.
        let asked = Command::new("kill").arg(self.server.id().to_string()).status();
        if !asked.is_ok_and(|status| status.success()) {
            let _ = self.server.kill();
        }
        let _ = self.server.wait();
    }
}

impl Window<'_> {
    /// Presses a key.
    pub fn key(&self, key: &str) {
        assert!(self.desk.tool(&["key", key]));
        sleep(Duration::from_millis(300));
    }

    /// Holds a key for a while.
    pub fn hold(&self, key: &str, time: Duration) {
        assert!(self.desk.tool(&["keydown", key]));
        sleep(time);
        assert!(self.desk.tool(&["keyup", key]));
        sleep(Duration::from_millis(300));
    }

    /// Types a text.
    pub fn write(&self, text: &str) {
        assert!(self.desk.tool(&["type", "--delay", "60", text]));
        sleep(Duration::from_millis(300));
    }

    /// Moves the pointer.
    pub fn pointer(&self, x: i32, y: i32) {
        assert!(self.desk.tool(&["mousemove", &x.to_string(), &y.to_string()]));
        sleep(Duration::from_millis(300));
    }

    /// Clicks a button (4 is the wheel, away from the hand).
    pub fn click(&self, button: u32, x: i32, y: i32) {
        self.pointer(x, y);
        assert!(self.desk.tool(&["click", &button.to_string()]));
        sleep(Duration::from_millis(300));
    }

    /// Drags with the left button, in steps that a window takes for a hand's.
    pub fn drag(&self, from: (i32, i32), to: (i32, i32)) {
        self.pointer(from.0, from.1);
        assert!(self.desk.tool(&["mousedown", "1"]));
        for step in 1..=4 {
            let at = |a: i32, b: i32| a + (b - a) * step / 4;
            self.pointer(at(from.0, to.0), at(from.1, to.1));
        }
        assert!(self.desk.tool(&["mouseup", "1"]));
    }
}

impl Hand {
    /// Does it; answers when it was told, in microseconds since 1970.
    pub fn does(&mut self, what: &str) -> u128 {
        let now = SystemTime::now().duration_since(UNIX_EPOCH).expect("after 1970").as_micros();
        writeln!(self.0.stdin.as_mut().expect("its input"), "{what}").expect("it listens");
        now
    }
}

impl Drop for Hand {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// The clock ticks that all programs of the machine have had, and those of this one with its children.
#[derive(Clone, Copy)]
pub struct Ticks {
    all: u64,
    own: u64,
    idle: u64,
}

impl Ticks {
    /// Until now.
    pub fn now() -> Self {
        let numbers =
            |text: &str| text.split_whitespace().filter_map(|it| it.parse().ok()).collect::<Vec<u64>>();
        let stat = std::fs::read_to_string("/proc/stat").unwrap_or_default();
        let first = numbers(stat.lines().next().unwrap_or_default());
        let at = |index: usize| first.get(index).copied().unwrap_or_default();
        let (all, idle) = (at(0) + at(1) + at(2) + at(5) + at(6), at(3) + at(4));
        // Of every process its parent and what it and its dead children have had.
        let processes: Vec<(u64, u64, u64)> = std::fs::read_dir("/proc")
            .into_iter()
            .flatten()
            .flatten()
            .filter_map(|entry| {
                let text = std::fs::read_to_string(entry.path().join("stat")).ok()?;
                let (_, rest) = text.rsplit_once(')')?;
                let fields: Vec<&str> = rest.split_whitespace().collect();
                let ticks = fields.get(11..15)?.iter().filter_map(|it| it.parse::<u64>().ok()).sum();
                Some((entry.file_name().to_str()?.parse().ok()?, fields.get(1)?.parse().ok()?, ticks))
            })
            .collect();
        let mut family = vec![u64::from(std::process::id())];
        let mut next = 0;
        while let Some(parent) = family.get(next).copied() {
            family.extend(processes.iter().filter(|(_, of, _)| *of == parent).map(|(id, _, _)| *id));
            next += 1;
        }
        let own = processes.iter().filter(|(id, _, _)| family.contains(id)).map(|(_, _, ticks)| ticks).sum();
        Self { all, own, idle }
    }

    /// The share of the machine's time that other programs have had since then.
    pub fn others_since(&self, before: &Self) -> f64 {
        let (all, own) = (self.all - before.all, self.own.saturating_sub(before.own));
        all.saturating_sub(own) as f64 / (all + self.idle - before.idle).max(1) as f64
    }
}

impl Drop for Window<'_> {
    fn drop(&mut self) {
        let _ = self.program.kill();
        let _ = self.program.wait();
    }
}
