//! The scene's tree step by step, instances expanded: on the heap however deep it is, and within limits, because
//! a short file can place itself exponentially often.

use crate::model::Item;
use crate::model::SceneFile;
use crate::model::ShapeKind;
use crate::span::FileId;

/// One step of the walk. What opens closes again, even in a file whose groups do not match.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// A group begins.
    OpenGroup {
        /// The file in which it stands.
        file: FileId,
        /// The number of its matrix in [`SceneFile::groups`].
        group: u32,
    },
    /// It ends.
    CloseGroup,
    /// An instance begins: the steps of `target` follow.
    OpenInstance {
        /// The file in which it stands.
        file: FileId,
        /// The number in [`SceneFile::includes`].
        include: u32,
        /// The file that it places.
        target: FileId,
    },
    /// It ends.
    CloseInstance,
    /// Consecutive shapes of one kind.
    Shapes {
        /// The file whose lists hold them.
        file: FileId,
        /// Which list.
        kind: ShapeKind,
        /// The first entry.
        first: u32,
        /// How many: at least one.
        count: u32,
    },
}

/// Why a walk stops early.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum WalkError {
    /// A file places itself, by itself or through others.
    #[error("the file includes itself")]
    Cycle {
        /// The file with the instance that closes the circle.
        file: FileId,
        /// The number in [`SceneFile::includes`].
        include: u32,
    },
    /// Instances of instances multiply beyond the limit.
    #[error("the instances multiply to more than {0} steps")]
    TooLong(u64),
    /// A number in [`SceneFile::items`] names nothing: no parser writes that.
    #[error("item {item} of the file names something that does not exist")]
    Broken {
        /// The file.
        file: FileId,
        /// The number in [`SceneFile::items`].
        item: u64,
    },
}

/// Steps that instances may multiply to.
pub const DEFAULT_STEPS: u64 = 40_000_000;

/// An iterator over the steps of file 0; after an error it ends.
#[derive(Debug)]
pub struct Walk<'a> {
    files: &'a [SceneFile],
    levels: Vec<Level>,
    active: Vec<bool>,
    limit: u64,
    taken: u64,
}

/// A file being walked.
#[derive(Clone, Copy, Debug)]
struct Level {
    file: FileId,
    next_item: usize,
    open_groups: u64,
}

impl<'a> Walk<'a> {
    /// A walk of at most `limit` steps, or of as many as stand in the files without multiplying them.
    pub fn new(files: &'a [SceneFile], limit: u64) -> Self {
        // One step an item, one for the end of each file, and one for each group that is not closed.
        let written: u64 = files.iter().map(|file| 2 * file.items.len() as u64 + 1).sum();
        let root = Level { file: FileId(0), next_item: 0, open_groups: 0 };
        let levels = if files.is_empty() { Vec::new() } else { vec![root] };
        let active = (0..files.len()).map(|file| file == 0).collect();
        Self { files, levels, active, limit: limit.max(written), taken: 0 }
    }

    /// The next step, `Ok(None)` at the end of the last file.
    fn advance(&mut self) -> Result<Option<Step>, WalkError> {
        while let Some(level) = self.levels.last_mut() {
            let file = level.file;
            let Some(scene_file) = self.files.get(file.0 as usize) else { return Ok(None) };
            self.taken += 1;
            if self.taken > self.limit {
                return Err(WalkError::TooLong(self.limit));
            }
            let broken = WalkError::Broken { file, item: level.next_item as u64 };
            let item = scene_file.items.get(level.next_item).copied();
            level.next_item += 1;
            match item {
                Some(Item::Open(group)) if (group as usize) < scene_file.groups.len() => {
                    level.open_groups += 1;
                    return Ok(Some(Step::OpenGroup { file, group }));
                }
                Some(Item::Close) if level.open_groups > 0 => {
                    level.open_groups -= 1;
                    return Ok(Some(Step::CloseGroup));
                }
                Some(Item::Run { count: 0, .. } | Item::Close) => {}
                Some(Item::Run { kind, first, count }) => {
                    let end = first as usize + count as usize;
                    let whole = end <= scene_file.shape_count(kind);
                    return if whole {
                        Ok(Some(Step::Shapes { file, kind, first, count }))
                    } else {
                        Err(broken)
                    };
                }
                Some(Item::Instance(include)) => {
                    let target = scene_file.includes.get(include as usize).ok_or(broken)?.value.file;
                    return self.enter(file, include, target, broken).map(Some);
                }
                Some(Item::Open(_)) => return Err(broken),
                None if level.open_groups > 0 => {
                    level.open_groups -= 1;
                    return Ok(Some(Step::CloseGroup));
                }
                None => {
                    self.levels.pop();
                    if let Some(active) = self.active.get_mut(file.0 as usize) {
                        *active = false;
                    }
                    return Ok((!self.levels.is_empty()).then_some(Step::CloseInstance));
                }
            }
        }
        Ok(None)
    }

    fn enter(
        &mut self,
        file: FileId,
        include: u32,
        target: FileId,
        broken: WalkError,
    ) -> Result<Step, WalkError> {
        match self.active.get_mut(target.0 as usize) {
            None => Err(broken),
            Some(true) => Err(WalkError::Cycle { file, include }),
            Some(active) => {
                *active = true;
                self.levels.push(Level { file: target, next_item: 0, open_groups: 0 });
                Ok(Step::OpenInstance { file, include, target })
            }
        }
    }
}

impl Iterator for Walk<'_> {
    type Item = Result<Step, WalkError>;

    fn next(&mut self) -> Option<Self::Item> {
        let step = self.advance().transpose()?;
        if step.is_err() {
            self.levels.clear();
        }
        Some(step)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Include;
    use crate::model::Placed;
    use crate::span::Span;
    use dotray_geometry::Mat4;
    use dotray_geometry::Sphere;
    use dotray_geometry::Vec3;

    /// A file with three spheres, one group matrix and includes of the files named.
    fn file(items: &[Item], includes: &[u32]) -> SceneFile {
        let mut file = SceneFile { items: items.to_vec(), ..SceneFile::default() };
        file.groups.push(Placed { value: Mat4::IDENTITY, span: Span::default() });
        file.spheres.shapes = vec![Sphere::new(Vec3::ZERO, 1.0).unwrap(); 3];
        for &target in includes {
            let value = Include { name: format!("{target}.ray"), file: FileId(target) };
            file.includes.push(Placed { value, span: Span::default() });
        }
        file
    }

    fn run(first: u32, count: u32) -> Item {
        Item::Run { kind: ShapeKind::Sphere, first, count }
    }

    fn spheres(file: u32, first: u32, count: u32) -> Step {
        Step::Shapes { file: FileId(file), kind: ShapeKind::Sphere, first, count }
    }

    #[test]
    fn instances_are_expanded_in_file_order() {
        let files = [
            file(&[run(0, 1), Item::Open(0), Item::Instance(0), Item::Close, Item::Instance(0)], &[1]),
            file(&[run(1, 2)], &[]),
        ];
        let steps: Result<Vec<_>, _> = Walk::new(&files, 100).collect();
        let open = Step::OpenInstance { file: FileId(0), include: 0, target: FileId(1) };
        assert_eq!(
            steps.unwrap(),
            [
                spheres(0, 0, 1),
                Step::OpenGroup { file: FileId(0), group: 0 },
                open,
                spheres(1, 1, 2),
                Step::CloseInstance,
                Step::CloseGroup,
                open,
                spheres(1, 1, 2),
                Step::CloseInstance,
            ]
        );
    }

    #[test]
    fn no_file_no_step() {
        assert_eq!(Walk::new(&[], 10).count(), 0);
        assert_eq!(Walk::new(&[SceneFile::default()], 10).count(), 0);
    }

    #[test]
    fn groups_that_do_not_match_are_evened_out() {
        let files = [file(&[Item::Close, Item::Open(0), Item::Open(0), run(0, 0), Item::Close], &[])];
        let steps: Vec<_> = Walk::new(&files, 0).map(Result::unwrap).collect();
        let open = Step::OpenGroup { file: FileId(0), group: 0 };
        assert_eq!(steps, [open, open, Step::CloseGroup, Step::CloseGroup]);
    }

    #[test]
    fn a_circle_is_found() {
        let files = [file(&[Item::Instance(0)], &[1]), file(&[run(0, 1), Item::Instance(0)], &[0])];
        let last = Walk::new(&files, 100).last();
        assert_eq!(last, Some(Err(WalkError::Cycle { file: FileId(1), include: 0 })));
    }

    #[test]
    fn doubling_sixty_times_stops_at_the_limit() {
        let mut files: Vec<_> =
            (1..60).map(|next| file(&[Item::Instance(0), Item::Instance(0)], &[next])).collect();
        files.push(file(&[], &[]));
        let mut walk = Walk::new(&files, 10_000);
        let steps = walk.by_ref().take_while(Result::is_ok).count();
        assert!((1000..=10_000).contains(&steps), "{steps}");
        assert_eq!(walk.next(), None);
        assert_eq!(Walk::new(&files, 10_000).last(), Some(Err(WalkError::TooLong(10_000))));
    }

    #[test]
    fn numbers_that_name_nothing_are_found() {
        for item in [Item::Open(1), Item::Instance(0), run(1, 3), run(u32::MAX, u32::MAX)] {
            let files = [file(&[run(0, 3), item], &[])];
            let steps: Vec<_> = Walk::new(&files, 100).collect();
            assert_eq!(steps[0], Ok(spheres(0, 0, 3)));
            assert_eq!(steps[1], Err(WalkError::Broken { file: FileId(0), item: 1 }));
        }
        let files = [file(&[Item::Instance(0)], &[7])];
        assert_eq!(Walk::new(&files, 100).last(), Some(Err(WalkError::Broken { file: FileId(0), item: 0 })));
    }

    #[test]
    fn a_hundred_thousand_groups_deep() {
        let depth = 100_000;
        let mut items = vec![Item::Open(0); depth];
        items.push(run(0, 3));
        items.extend(vec![Item::Close; depth]);
        assert_eq!(Walk::new(&[file(&items, &[])], 0).count(), 2 * depth + 1);
    }
}
