//! Which shapes are not shown, as ranges of shape numbers: a million shapes of a group are one range.

use dotray_scene::Resolved;
use dotray_scene::resolved::Run;
use dotray_scene::resolved::RunColors;
use dotray_scene::resolved::TreeEvent;
use serde::Deserialize;
use serde::Serialize;
use std::ops::Range;

/// The shapes that are hidden.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Hidden {
    /// Apart from each other, in rising order, none empty.
    ranges: Vec<Range<u32>>,
}

impl Hidden {
    /// Whether every shape is shown.
    pub fn is_empty(&self) -> bool {
        self.ranges.is_empty()
    }

    /// The hidden ranges in rising order.
    pub fn ranges(&self) -> &[Range<u32>] {
        &self.ranges
    }

    /// Whether a shape is hidden.
    pub fn contains(&self, number: u32) -> bool {
        let after = self.ranges.partition_point(|range| range.start <= number);
        after.checked_sub(1).and_then(|at| self.ranges.get(at)).is_some_and(|range| number < range.end)
    }

    /// Whether all shapes of a range are hidden.
    pub fn covers(&self, range: &Range<u32>) -> bool {
        let after = self.ranges.partition_point(|other| other.start <= range.start);
        let before = after.checked_sub(1).and_then(|at| self.ranges.get(at));
        range.is_empty() || before.is_some_and(|other| range.end <= other.end)
    }

    /// Hides shapes.
    pub fn hide(&mut self, range: Range<u32>) {
        if range.is_empty() {
            return;
        }
        let first = self.ranges.partition_point(|other| other.end < range.start);
        let last = self.ranges.partition_point(|other| other.start <= range.end);
        let touched = self.ranges.get(first..last).unwrap_or_default();
        let start = touched.first().map_or(range.start, |other| other.start.min(range.start));
        let end = touched.last().map_or(range.end, |other| other.end.max(range.end));
        self.ranges.splice(first..last, std::iter::once(start..end));
    }

    /// Shows shapes.
    pub fn show(&mut self, range: Range<u32>) {
        let mut left = Vec::with_capacity(self.ranges.len() + 1);
        for other in &self.ranges {
            let before = other.start..other.end.min(range.start);
            let after = other.start.max(range.end)..other.end;
            left.extend([before, after].into_iter().filter(|part| !part.is_empty()));
        }
        if !range.is_empty() {
            self.ranges = left;
        }
    }

    /// Shows these shapes alone, of `count`.
    pub fn isolate(&mut self, range: Range<u32>, count: u32) {
        self.ranges = vec![0..range.start, range.end.max(range.start)..count];
        self.ranges.retain(|part| !part.is_empty());
    }

    /// Shows everything.
    pub fn clear(&mut self) {
        self.ranges.clear();
    }

    /// The parts of a range of shapes that are shown, in rising order.
    pub fn shown_of(&self, range: Range<u32>) -> Vec<Range<u32>> {
        let mut shown = Vec::new();
        let mut from = range.start;
        let first = self.ranges.partition_point(|other| other.end <= range.start);
        for other in self.ranges.iter().skip(first).take_while(|other| other.start < range.end) {
            if other.start > from {
                shown.push(from..other.start);
            }
            from = from.max(other.end);
        }
        if from < range.end {
            shown.push(from..range.end);
        }
        shown
    }

    /// The number of the shape that is the `index`-th of those shown.
    pub fn number_of_shown(&self, index: u32) -> u32 {
        let mut number = index;
        for range in &self.ranges {
            if range.start > number {
                break;
            }
            number = number.saturating_add(range.len() as u32);
        }
        number
    }

    /// Which entries of a list of shape numbers in rising order are shown: as few ranges as there can be. It costs as
    /// much as there are hidden ranges, not shapes.
    pub fn shown(&self, numbers: &[u32]) -> Vec<Range<u32>> {
        let mut shown = Vec::new();
        let mut from = 0;
        for range in &self.ranges {
            let start = numbers.partition_point(|&number| number < range.start);
            let end = numbers.partition_point(|&number| number < range.end);
            if start > from {
                shown.push(from as u32..start as u32);
            }
            from = from.max(end);
        }
        if from < numbers.len() {
            shown.push(from as u32..numbers.len() as u32);
        }
        shown
    }
}

/// The scene without its hidden shapes, as if they were not in its file: those that are left are numbered anew, in the
/// same order.
pub fn without(whole: &Resolved, hidden: &Hidden) -> Resolved {
    let mut count = 0;
    let (mut runs, mut parts) = (Vec::new(), Vec::with_capacity(whole.runs.len()));
    for run in &whole.runs {
        let first_part = runs.len() as u32;
        for shapes in hidden.shown_of(run.first_shape..run.first_shape + run.count) {
            let skipped = shapes.start - run.first_shape;
            let colors = match run.colors {
                RunColors::Shapes { list, first } => RunColors::Shapes { list, first: first + skipped },
                RunColors::No | RunColors::Vertices => run.colors,
            };
            let (first, length) = (run.first + skipped, shapes.len() as u32);
            runs.push(Run { first, count: length, first_shape: count, colors, ..*run });
            count += length;
        }
        parts.push(first_part..runs.len() as u32);
    }
    let event = |event: &TreeEvent| match event {
        TreeEvent::Open | TreeEvent::Close => vec![*event],
        TreeEvent::Run(run) => {
            parts.get(*run as usize).cloned().unwrap_or_default().map(TreeEvent::Run).collect()
        }
    };
    let tree = whole.tree.iter().flat_map(event).collect();
    Resolved { runs, tree, shape_count: count, ..whole.clone() }
}

/// What is left of a scene where its shapes are kept elsewhere: all but the files, the runs and the transforms.
pub fn without_shapes(whole: &Resolved) -> Resolved {
    Resolved {
        camera: whole.camera,
        background: whole.background,
        secondary_background: whole.secondary_background,
        ambient: whole.ambient,
        lights: whole.lights.clone(),
        tints: whole.tints.clone(),
        materials: whole.materials.clone(),
        textures: whole.textures.clone(),
        frames: Vec::new(),
        runs: Vec::new(),
        tree: whole.tree.clone(),
        shape_count: 0,
        files: Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every state reached by hiding and showing agrees with a plain list of flags.
    #[test]
    fn ranges_agree_with_flags() {
        let count = 12;
        let mut hidden = Hidden::default();
        let mut flags = vec![false; count as usize];
        let mut seed = 7_u32;
        for step in 0..3000 {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let (a, b) = (seed >> 8 & 15, seed >> 16 & 15);
            let range = a.min(b).min(count)..a.max(b).min(count);
            let hide = seed >> 28 & 1 == 1;
            if hide {
                hidden.hide(range.clone())
            } else {
                hidden.show(range.clone())
            }
            flags[range.start as usize..range.end as usize].fill(hide);
            for number in 0..count {
                assert_eq!(hidden.contains(number), flags[number as usize], "step {step} of {hidden:?}");
            }
            assert_eq!(
                hidden.covers(&range),
                flags[range.start as usize..range.end as usize].iter().all(|x| *x)
            );
            let ordered = hidden.ranges().windows(2).all(|pair| pair[0].end < pair[1].start);
            assert!(ordered && hidden.ranges().iter().all(|range| !range.is_empty()), "{hidden:?}");
            let left: Vec<u32> = hidden.shown_of(range.clone()).into_iter().flatten().collect();
            assert!(left.iter().copied().eq(range.filter(|number| !flags[*number as usize])));
            let shown = (0..count).filter(|number| !flags[*number as usize]);
            assert!(shown.enumerate().all(|(at, number)| hidden.number_of_shown(at as u32) == number));
            // Each shape stands twice in the list, as a shape of two triangles would.
            let numbers: Vec<u32> = (0..2 * count).map(|entry| entry / 2).collect();
            let shown = hidden.shown(&numbers);
            for (entry, number) in numbers.iter().enumerate() {
                let is_shown = shown.iter().any(|range| range.contains(&(entry as u32)));
                assert_eq!(is_shown, !flags[*number as usize]);
            }
        }
    }

    #[test]
    fn isolating_leaves_one_range() {
        let mut hidden = Hidden::default();
        hidden.isolate(3..5, 10);
        assert!(hidden.shown(&(0..10).collect::<Vec<_>>()).into_iter().eq(std::iter::once(3..5)));
        assert_eq!(hidden.shown(&[9]), []);
        hidden.clear();
        assert!(hidden.is_empty());
    }
}
