//! What layers want of every eye ray, kept while whole streams are traced: the renderer runs as ever and is listened
//! to, so that layers cost little more than the picture.

use crate::query::Nearest;
use crate::query::Tests;
use crate::shapes::WorldSurface;
use dotray_geometry::Vec3;

/// What became of an eye ray.
#[derive(Clone, Debug, Default)]
pub struct EyeRecord {
    /// What it met; `None` where it saw the background.
    pub met: Option<MetByEye>,
    /// What the point gives off by itself and by the lights; the background where nothing is met.
    pub direct: Vec3,
    /// What the mirrored ray adds.
    pub reflected: Vec3,
    /// What the refracted ray adds.
    pub transmitted: Vec3,
    /// All rays that it led to, itself included.
    pub rays: u64,
    /// What all these rays were tested against.
    pub tests: Tests,
    /// The sum of S_i over the lights (and their samples) that face the point, and how many those are.
    facing: (Vec3, u32),
}

/// The point that an eye ray met.
#[derive(Clone, Copy, Debug)]
pub struct MetByEye {
    /// The shape and the place on it.
    pub nearest: Nearest,
    /// The point in the world and in the shape's own coordinates.
    pub surface: WorldSurface,
    /// The material's number in the resolved scene.
    pub material: u32,
    /// n̂: the shading normal, flipped where the ray leaves.
    pub normal: Vec3,
}

impl EyeRecord {
    /// The mean of S_i over the lights (and samples) that face the point; 1 where none does.
    pub fn light_share(&self) -> Vec3 {
        let (sum, count) = self.facing;
        if count > 0 { sum / f64::from(count) } else { Vec3::ONE }
    }
}

/// Which of the two secondary rays.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Part {
    Reflected,
    Transmitted,
}

/// The records of the eye rays under way.
#[derive(Debug)]
pub(crate) struct Recorder {
    /// Whether each ray walks alone, so that its tests do not depend on its company.
    pub alone: bool,
    pub records: Vec<EyeRecord>,
    /// Of each ray of the streams under way, deepest last: to which eye ray it goes back.
    eyes: Vec<Vec<usize>>,
}

impl Recorder {
    pub fn new(eye_rays: usize, alone: bool) -> Self {
        Self { alone, records: vec![EyeRecord::default(); eye_rays], eyes: Vec::new() }
    }

    /// A stream of eye rays begins, the first of which has this number.
    pub fn open_eyes(&mut self, first: usize, count: usize) {
        self.eyes.push((first..first + count).collect());
    }

    /// A stream begins whose rays these of the stream above have sent.
    pub fn open(&mut self, senders: impl Iterator<Item = usize>) {
        let above = self.top();
        let eyes = senders.filter_map(|sender| above.get(sender).copied()).collect();
        self.eyes.push(eyes);
    }

    /// The innermost stream is done.
    pub fn close(&mut self) {
        self.eyes.pop();
    }

    fn top(&self) -> &[usize] {
        self.eyes.last().map_or(&[], Vec::as_slice)
    }

    /// Whether the innermost stream holds the eye rays themselves.
    pub fn at_eye(&self) -> bool {
        self.eyes.len() == 1
    }

    /// What rays of the innermost stream cost; `rays` says which of them each test belongs to.
    pub fn cost(&mut self, rays: impl Iterator<Item = usize>, tests: &[Tests]) {
        let Some(eyes) = self.eyes.last() else { return };
        for (ray, tests) in rays.zip(tests) {
            if let Some(record) = eyes.get(ray).and_then(|&eye| self.records.get_mut(eye)) {
                record.rays += 1;
                record.tests.boxes += tests.boxes;
                record.tests.shapes += tests.shapes;
            }
        }
    }

    /// Shows the record of an eye ray of the innermost stream, if that is the eye rays'.
    pub fn eye(&mut self, index: usize, tell: impl FnOnce(&mut EyeRecord)) {
        if self.at_eye()
            && let Some(record) = self.top().get(index).copied().and_then(|eye| self.records.get_mut(eye))
        {
            tell(record);
        }
    }

    /// What the lights left of each eye ray's colour.
    pub fn direct(&mut self, colors: &[Vec3]) {
        for (index, &color) in colors.iter().enumerate() {
            self.eye(index, |record| record.direct = color);
        }
    }

    /// S_i of a lamp that faces the point.
    pub fn filter(&mut self, index: usize, filter: Vec3) {
        self.eye(index, |EyeRecord { facing: (sum, count), .. }| {
            *sum += filter;
            *count += 1;
        });
    }

    /// What a secondary ray adds to its sender.
    pub fn adds(&mut self, index: usize, part: Part, color: Vec3) {
        self.eye(index, |record| match part {
            Part::Reflected => record.reflected = color,
            Part::Transmitted => record.transmitted = color,
        });
    }
}
