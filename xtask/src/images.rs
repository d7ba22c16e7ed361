//! Whole programs, text to picture: dotray beside Tachyon and POV-Ray.

use crate::child::measure;
use crate::clock::Usage;
use crate::figures::median;
use crate::files;
use crate::peers::Peers;
use crate::picture::mean_difference;
use crate::place::Place;
use crate::results::ImageRow;
use crate::write::HEIGHT;
use crate::write::Kind;
use crate::write::LEVELS;
use crate::write::WIDTH;
use std::path::PathBuf;

/// No program may take longer, seconds.
const LIMIT: f64 = 400.0;
/// What takes longer than this runs once only, seconds.
const LONG: f64 = 60.0;

/// A program and how it is run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Program {
    Dotray { threads: u32 },
    Tachyon,
    PovRay { bounding: u32 },
}

impl Program {
    /// In the order in which they take turns.
    const ALL: [Self; 5] = [
        Self::Dotray { threads: 1 },
        Self::Tachyon,
        Self::PovRay { bounding: 1 },
        Self::PovRay { bounding: 2 },
        Self::Dotray { threads: 2 },
    ];

    fn name(self) -> String {
        match self {
            Self::Dotray { threads: 1 } => "dotray".to_owned(),
            Self::Dotray { threads } => format!("dotray, {threads} threads"),
            Self::Tachyon => "Tachyon".to_owned(),
            Self::PovRay { bounding } => format!("POV-Ray +BM{bounding}"),
        }
    }

    fn kind(self) -> Kind {
        match self {
            Self::Dotray { .. } => Kind::Ray,
            Self::Tachyon => Kind::Tachyon,
            Self::PovRay { .. } => Kind::PovRay,
        }
    }

    fn picture(self, place: &Place, scene: &str) -> PathBuf {
        let file = match self {
            Self::Dotray { threads } => format!("{scene}.dotray{threads}.png"),
            Self::Tachyon => format!("{scene}.tachyon.ppm"),
            Self::PovRay { bounding } => format!("{scene}.povray{bounding}.png"),
        };
        place.file("pictures", &file)
    }

    fn command(self, place: &Place, text: &str, picture: &str) -> Vec<String> {
        let words = |line: &str| line.split(' ').map(str::to_owned).collect::<Vec<_>>();
        let file = |option: &str, path: &str| vec![format!("{option}{path}")];
        match self {
            Self::Dotray { threads } => [
                vec![place.program("dotray"), "render".to_owned(), text.to_owned(), picture.to_owned()],
                words(&format!("--size {WIDTH}x{HEIGHT} --threads {threads}")),
                words(&format!("--recursion {} --cutoff 0", LEVELS - 1)),
            ]
            .concat(),
            Self::Tachyon => [
                vec!["tachyon".to_owned(), text.to_owned()],
                words("-numthreads 1 -format PPM -o"),
                vec![picture.to_owned()],
            ]
            .concat(),
            // Without a curve in the file, so that pictures can be compared.
            Self::PovRay { bounding } => [
                words("povray +FN File_Gamma=1.0 -D -V -A +WT1"),
                file("+I", text),
                file("+O", picture),
                words(&format!("+W{WIDTH} +H{HEIGHT} +BM{bounding}")),
            ]
            .concat(),
        }
    }
}

/// What came of a program's runs.
struct Course {
    program: Program,
    runs: Vec<Usage>,
    missing: Option<String>,
}

impl Course {
    fn run(&mut self, place: &Place, scene: &str) {
        let long = self.runs.iter().any(|usage| usage.wall > LONG);
        if self.missing.is_some() || long {
            return;
        }
        let once = || {
            let text = files::scene(place, scene, self.program.kind())?;
            let picture = self.program.picture(place, scene);
            let command = self.program.command(place, &text.to_string_lossy(), &picture.to_string_lossy());
            let log = place.file("logs", &format!("{scene}.{}.txt", self.program.name().replace(' ', "-")));
            let usage = measure(&command, &log, LIMIT)?;
            if usage.fine {
                Ok(usage)
            } else {
                Err(format!("failed, or ran for {LIMIT} s; see {}", log.display()))
            }
        };
        match once() {
            Ok(usage) => self.runs.push(usage),
            Err(why) => self.missing = Some(why),
        }
    }

    fn row(&self, place: &Place, scene: &str) -> ImageRow {
        let of = |value: fn(&Usage) -> f64| {
            median(&self.runs.iter().map(value).collect::<Vec<_>>()).unwrap_or_default()
        };
        let ours = Program::Dotray { threads: 1 };
        let theirs = self.program.picture(place, scene);
        // Tachyon's camera is left-handed.
        let is_mirrored = self.program == Program::Tachyon;
        let difference = (self.program != ours && self.missing.is_none())
            .then(|| mean_difference(&ours.picture(place, scene), &theirs, is_mirrored).ok());
        ImageRow {
            scene: scene.to_owned(),
            program: self.program.name(),
            runs: self.runs.len(),
            cpu: of(Usage::cpu),
            user: of(|usage| usage.user),
            wall: of(|usage| usage.wall),
            peak_mib: of(|usage| usage.peak_mib),
            difference: difference.flatten(),
            missing: self.missing.clone(),
        }
    }
}

/// Runs all programs on a scene, in turns.
pub fn run(place: &Place, peers: &Peers, scene: &str, rounds: usize) -> Vec<ImageRow> {
    let missing = |program: Program| match program {
        Program::Dotray { .. } => None,
        Program::Tachyon => peers.tachyon.as_ref().err().cloned(),
        Program::PovRay { .. } => peers.povray.as_ref().err().cloned(),
    };
    let course = |program| Course { program, runs: Vec::new(), missing: missing(program) };
    let mut courses = Program::ALL.map(course);
    for _ in 0..rounds {
        courses.iter_mut().for_each(|course| course.run(place, scene));
    }
    let rows: Vec<_> = courses.iter().map(|course| course.row(place, scene)).collect();
    for row in &rows {
        match &row.missing {
            Some(why) => eprintln!("  {scene} {}: not available: {why}", row.program),
            None => eprintln!(
                "  {scene} {}: {:.2} s CPU, {:.2} s, {:.0} MiB{}",
                row.program,
                row.cpu,
                row.wall,
                row.peak_mib,
                row.difference.map(|d| format!(", difference {d:.4}")).unwrap_or_default()
            ),
        }
    }
    rows
}
