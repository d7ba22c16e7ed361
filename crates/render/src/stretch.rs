//! The runs of a scene in few words: where every shape stands in a group of its own, there are as many runs as shapes,
//! one like the other.

use dotray_scene::model::ShapeKind;
use dotray_scene::resolved::Run;
use dotray_scene::resolved::RunColors;

/// A run; or runs of one shape each that follow each other in every list, each alone in its group.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// The first run, with the number of all shapes.
    pub run: Run,
    /// Whether each shape has a transform of its own, which no other shape has: then their numbers follow each other.
    pub alone: bool,
}

impl Stretch {
    /// The run of shape `number`, which stands here.
    #[inline]
    pub fn run(&self, number: u32) -> Run {
        let run = self.run;
        if !self.alone {
            return run;
        }
        let step = number - run.first_shape;
        let colors = match run.colors {
            RunColors::Shapes { list, first } => RunColors::Shapes { list, first: first + step },
            RunColors::No | RunColors::Vertices => run.colors,
        };
        Run { first: run.first + step, count: 1, frame: run.frame + step, first_shape: number, colors, ..run }
    }

    /// The runs it stands for.
    pub fn runs(&self) -> impl Iterator<Item = Run> {
        let (first, count) = (self.run.first_shape, if self.alone { self.run.count } else { 1 });
        (0..count).map(move |step| self.run(first + step))
    }

    /// The place of shape `number`, which stands here, in its file's list.
    #[inline]
    pub fn entry(&self, number: u32) -> usize {
        (self.run.first + (number - self.run.first_shape)) as usize
    }

    /// The number of the transform of shape `number`, which stands here.
    #[inline]
    pub fn frame(&self, number: u32) -> usize {
        (if self.alone { self.run.frame + (number - self.run.first_shape) } else { self.run.frame }) as usize
    }

    /// Whether its only shape, which is alone, is the one after these.
    fn goes_on(&self, next: &Run) -> bool {
        let own = &self.run;
        self.alone && self.run(own.first_shape + own.count) == *next
    }
}

/// All runs of a scene, and which of them holds a shape.
#[derive(Debug, Default)]
pub struct Stretches {
    list: Vec<Stretch>,
    /// The stretch of every so many-th shape, and the last one.
    marks: Vec<u32>,
}

/// The shapes from mark to mark.
const STEP: u32 = 16;

/// Up to so many shapes alone in their groups, their transforms and inverses are held ready like any others: they stay
/// in a cache, and to compute them anew for each ray took up to a tenth of a picture's time.
const FEW: usize = 1 << 14;

/// Which of the transforms one shape has alone.
fn own_frames(runs: &[Run], frame_count: usize) -> Vec<bool> {
    // More than one are all the same.
    let mut users = vec![0_u8; frame_count];
    for run in runs {
        let users = &mut users[run.frame as usize];
        *users = if *users == 0 && may_be_alone(run) { 1 } else { 2 };
    }
    users.into_iter().map(|users| users == 1).collect()
}

/// Whether it is one shape, and there is a form for such a shape that holds its transform.
pub fn may_be_alone(run: &Run) -> bool {
    let has_form = match run.kind {
        ShapeKind::Sphere | ShapeKind::Cuboid | ShapeKind::Cylinder | ShapeKind::Cone => true,
        ShapeKind::Triangle | ShapeKind::IndexedTriangle | ShapeKind::Torus | ShapeKind::Open => false,
    };
    has_form && run.frame != 0 && run.count == 1
}

impl Stretches {
    /// These runs of `shape_count` shapes under so many transforms.
    pub fn new(runs: &[Run], frame_count: usize, shape_count: u32) -> Self {
        Self::where_more_than(FEW, runs, frame_count, shape_count)
    }

    /// The same; no more than `few` shapes alone in their groups are nothing special.
    fn where_more_than(few: usize, runs: &[Run], frame_count: usize, shape_count: u32) -> Self {
        let mut own = own_frames(runs, frame_count);
        if own.iter().filter(|own| **own).count() <= few {
            own.fill(false);
        }
        let mut list: Vec<Stretch> = Vec::new();
        for run in runs {
            let alone = own[run.frame as usize];
            match list.last_mut() {
                Some(last) if alone && last.goes_on(run) => last.run.count += 1,
                Some(_) | None => list.push(Stretch { run: *run, alone }),
            }
        }
        list.shrink_to_fit();
        let mut stretch = 0;
        let mut holder = |number: u32| {
            while list.get(stretch + 1).is_some_and(|next| next.run.first_shape <= number) {
                stretch += 1;
            }
            stretch as u32
        };
        let mut marks: Vec<_> = (0..shape_count).step_by(STEP as usize).map(&mut holder).collect();
        marks.push(list.len().saturating_sub(1) as u32);
        Self { list, marks }
    }

    /// The stretches in the order of their shapes.
    #[inline]
    pub fn list(&self) -> &[Stretch] {
        &self.list
    }

    /// The same, to be changed.
    pub fn list_mut(&mut self) -> &mut [Stretch] {
        &mut self.list
    }

    /// Lets go of what finds shapes.
    pub fn forget_shapes(&mut self) {
        self.marks = Vec::new();
    }

    /// Which of the stretches holds shape `number`.
    #[inline]
    pub fn find(&self, number: u32) -> usize {
        let list = &self.list;
        if list.len() == 1 {
            return 0;
        }
        let mark = (number / STEP) as usize;
        let (first, last) = (self.marks[mark] as usize, self.marks[mark + 1] as usize);
        // Where every shape is a stretch of its own, the search would wait for memory several times over.
        let guess = (first + (number % STEP) as usize).min(last);
        if list[guess].run.first_shape == number && list[guess].run.count > 0 {
            return guess;
        }
        first + list[first..=last].partition_point(|stretch| stretch.run.first_shape <= number) - 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dotray_scene::span::FileId;

    fn run(kind: ShapeKind, count: u32, frame: u32) -> Run {
        let colors = RunColors::No;
        Run { file: FileId(0), kind, first: 0, count, frame, material_base: 0, first_shape: 0, colors }
    }

    /// Gives the runs their places, as if all shapes of a kind followed each other.
    fn placed(mut runs: Vec<Run>) -> Vec<Run> {
        let (mut shapes, mut entries) = (0, [0; ShapeKind::ALL.len()]);
        for run in &mut runs {
            let entry = &mut entries[run.kind as usize];
            (run.first_shape, run.first) = (shapes, *entry);
            (shapes, *entry) = (shapes + run.count, *entry + run.count);
        }
        runs
    }

    #[test]
    fn every_shape_is_found_in_its_run() {
        let lengths = [1, 1, 40, 3, 16, 1, 1, 1, 100, 15, 17, 1];
        let lengths = lengths.into_iter().cycle().take(50);
        let runs = placed(lengths.map(|length| run(ShapeKind::Sphere, length, 0)).collect());
        let count = runs.iter().map(|run| run.count).sum();
        let stretches = Stretches::new(&runs, 1, count);
        assert_eq!(stretches.list().len(), runs.len());
        for number in 0..count {
            let run = stretches.list()[stretches.find(number)].run(number);
            assert!((run.first_shape..run.first_shape + run.count).contains(&number), "{number}: {run:?}");
        }
    }

    #[test]
    fn shapes_alone_in_their_groups_are_one_stretch() {
        use ShapeKind::{Cone, Cylinder, Triangle};
        let mut runs: Vec<_> = (1..=40).map(|frame| run(Cylinder, 1, frame)).collect();
        runs.push(run(Cone, 1, 41));
        // Two of one group, and what has no such form.
        runs.extend([run(Cylinder, 1, 42), run(Cone, 1, 42), run(Cylinder, 2, 43), run(Triangle, 1, 44)]);
        runs.extend((45..60).map(|frame| run(Cylinder, 1, frame)));
        // A colour for each, from another place of the list.
        let mut runs = placed(runs);
        for run in &mut runs[50..] {
            run.colors = RunColors::Shapes { list: 0, first: run.first + 7 };
        }
        let count = runs.iter().map(|run| run.count).sum();
        let stretches = Stretches::where_more_than(0, &runs, 60, count);
        let shapes: Vec<_> = stretches.list().iter().map(|s| (s.run.count, s.alone)).collect();
        let expected =
            [(40, true), (1, true), (1, false), (1, false), (2, false), (1, false), (5, true), (10, true)];
        assert_eq!(shapes, expected);
        let few = Stretches::where_more_than(56, &runs, 60, count);
        assert_eq!(few.list().len(), runs.len());
        assert!(few.list().iter().all(|stretch| !stretch.alone));
        assert_eq!(stretches.list().iter().flat_map(Stretch::runs).collect::<Vec<_>>(), runs);
        for run in &runs {
            let found = stretches.list()[stretches.find(run.first_shape)];
            assert_eq!(found.run(run.first_shape), *run);
            assert_eq!(found.frame(run.first_shape), run.frame as usize);
            assert_eq!(found.entry(run.first_shape), run.first as usize);
        }
    }
}
