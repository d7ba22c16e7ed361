//! What a scene will take in memory, told before it is taken.

use crate::options::Options;
use crate::options::PrepareOptions;
use crate::stats::MemoryPart;
use crate::stretch::may_be_alone;
use dotray_accel::Kind;
use dotray_geometry::Affine;
use dotray_geometry::Cuboid;
use dotray_geometry::Shape;
use dotray_geometry::Sphere;
use dotray_geometry::Transform;
use dotray_geometry::shape::OrientedCone;
use dotray_geometry::shape::OrientedCylinder;
use dotray_scene::Resolved;
use dotray_scene::model::SceneFile;
use dotray_scene::model::ShapeKind;
use dotray_scene::resolved::Run;
use dotray_scene::resolved::TreeEvent;
use std::fmt;

/// Numbers of shape, material and stretch, and the slot.
const PLACE: u64 = 16;
/// A shape that is alone in its group, with the transform; now and then a little more.
const OWN: u64 = 112;
/// What rules spheres out in single precision: balls and boxes.
const SPHERE_CULL: u64 = 40;
/// What rules any shape out: balls, bars, boxes and corners.
const ANY_CULL: u64 = 92;
/// What is sorted while a hierarchy of boxes is built, and its nodes.
const HIERARCHY: u64 = 32 + 28;
/// Octree and BSP tree name a shape up to four times; each name stands in a list of the cell that is being divided, and
/// in the finished one.
const CELLS: u64 = 240;

fn baked(run: &Run) -> u64 {
    let form = match run.kind {
        ShapeKind::Sphere => size_of::<Sphere>(),
        ShapeKind::Cuboid => size_of::<Cuboid>(),
        ShapeKind::Cylinder => size_of::<OrientedCylinder>(),
        ShapeKind::Cone => size_of::<OrientedCone>(),
        ShapeKind::Triangle | ShapeKind::IndexedTriangle => 72,
        ShapeKind::Torus | ShapeKind::Open => size_of::<Shape>(),
    };
    let own = if may_be_alone(run) { OWN } else { 0 };
    u64::from(run.count) * ((form as u64).max(own) + PLACE)
}

/// How many transforms are kept for several shapes, at most.
fn shared_frames(resolved: &Resolved) -> u64 {
    let shared = resolved.runs.iter().filter(|run| run.frame != 0 && !may_be_alone(run)).count();
    shared.min(resolved.frames.len()) as u64
}

fn bytes<T>(list: &[T]) -> u64 {
    size_of_val(list) as u64
}

/// The bytes of the lists of shapes as the files write them.
pub(crate) fn written(files: &[SceneFile]) -> u64 {
    let of_file = |file: &SceneFile| {
        bytes(&file.spheres.shapes)
            + bytes(&file.cuboids.shapes)
            + bytes(&file.cylinders.shapes)
            + bytes(&file.cones.shapes)
            + bytes(&file.triangles.shapes)
            + bytes(&file.indexed_triangles.shapes)
            + bytes(&file.tori.shapes)
            + bytes(&file.open_sides.shapes)
            + bytes(&file.vertices)
            + bytes(&file.vertex_colors)
            + file.colors.iter().map(|list| bytes(&list.colors)).sum::<u64>()
    };
    files.iter().map(of_file).sum()
}

/// About what preparing and rendering a scene will hold at its worst moment, by part; textures tell their size only
/// when they are read, and then have a limit of their own.
pub fn estimate(resolved: &Resolved, prepare: &PrepareOptions, options: Option<&Options>) -> Vec<MemoryPart> {
    let shapes = u64::from(resolved.shape_count);
    let scene = written(&resolved.files)
        + resolved.files.iter().map(|file| bytes(&file.items) + bytes(&file.groups)).sum::<u64>()
        + (resolved.runs.len() * size_of::<Run>()) as u64
        + (resolved.frames.len() * size_of::<Affine>()) as u64
        + shared_frames(resolved) * size_of::<Transform>() as u64
        + (resolved.tree.len() * 2 * size_of::<TreeEvent>()) as u64;
    let only_spheres = resolved.runs.iter().all(|run| run.kind == ShapeKind::Sphere);
    let cull = if only_spheres { SPHERE_CULL } else { ANY_CULL };
    let (cull, accelerator) = match prepare.accel {
        Kind::Brute => (0, 0),
        Kind::Octree | Kind::Bsp => (0, CELLS),
        Kind::Boxes | Kind::Bvh => (cull, HIERARCHY),
    };
    let mut parts = vec![
        MemoryPart { name: "scene", bytes: scene },
        MemoryPart { name: "shapes", bytes: resolved.runs.iter().map(baked).sum::<u64>() + shapes * cull },
        MemoryPart { name: "accelerator", bytes: shapes * accelerator },
    ];
    if let Some(options) = options {
        let window = options.window();
        let channels = if options.transparent { 4 } else { 3 };
        // Once as floats and once as the bytes of its file.
        let pixel = 2 * channels * size_of::<f32>() as u64;
        let pixels = u64::from(window.width) * u64::from(window.height);
        parts.push(MemoryPart { name: "picture", bytes: pixels.saturating_mul(pixel) });
    }
    parts
}

/// A scene whose picture would take more memory than is allowed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TooMuchMemory {
    /// What it would take, by part.
    pub parts: Vec<MemoryPart>,
    /// What is allowed.
    pub limit: u64,
}

impl std::error::Error for TooMuchMemory {}

impl fmt::Display for TooMuchMemory {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let total = total(&self.parts);
        write!(f, "this would take about {} of memory (", Bytes(total))?;
        for (index, part) in self.parts.iter().enumerate() {
            let comma = if index == 0 { "" } else { ", " };
            write!(f, "{comma}{} {}", part.name, Bytes(part.bytes))?;
        }
        write!(f, "); the limit is {} (--max-memory allows more)", Bytes(self.limit))
    }
}

fn total(parts: &[MemoryPart]) -> u64 {
    parts.iter().fold(0, |sum, part| sum.saturating_add(part.bytes))
}

/// Refuses a scene that would take more memory than `limit`, before any is taken.
///
/// # Errors
/// [`TooMuchMemory`], which names the estimate and its parts.
pub fn check_memory(
    resolved: &Resolved,
    prepare: &PrepareOptions,
    options: Option<&Options>,
    limit: u64,
) -> Result<(), TooMuchMemory> {
    let parts = estimate(resolved, prepare, options);
    if total(&parts) > limit { Err(TooMuchMemory { parts, limit }) } else { Ok(()) }
}

/// A number of bytes for people: three figures and a unit of 1024s.
struct Bytes(u64);

impl fmt::Display for Bytes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        const UNITS: [&str; 5] = ["KiB", "MiB", "GiB", "TiB", "PiB"];
        let mut value = self.0 as f64;
        let mut shown = "B";
        for unit in UNITS {
            if value < 1000.0 {
                break;
            }
            (value, shown) = (value / 1024.0, unit);
        }
        let digits = if shown == "B" || value >= 100.0 { 0 } else { 1 };
        write!(f, "{value:.digits$} {shown}")
    }
}

/// The memory that this machine has, or that the system lets this program have; where the system does not say it,
/// 16 GiB.
pub fn machine_memory() -> u64 {
    const UNKNOWN: u64 = 16 << 30;
    let read = |path: &str| std::fs::read_to_string(path).ok();
    let machine = read("/proc/meminfo").and_then(|text| {
        let line = text.lines().find_map(|line| line.strip_prefix("MemTotal:"))?;
        line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()?.checked_mul(1024)
    });
    let limits = cgroup_limits(&read).into_iter().chain(address_space(&read));
    limits.chain(machine).min().unwrap_or(UNKNOWN)
}

/// What the groups that this process is in may take: a container, or a job of a scheduler, has less than its machine.
fn cgroup_limits(read: &impl Fn(&str) -> Option<String>) -> Vec<u64> {
    let groups = read("/proc/self/cgroup").unwrap_or_default();
    // `0::/a/b` in the second version of groups; `4:memory:/a/b` in the first one, where both may be there.
    let second = groups.lines().find_map(|line| line.strip_prefix("0::")).unwrap_or("/");
    let first = groups.lines().find_map(|line| line.split_once(":memory:")).map_or("/", |(_, group)| group);
    let mut files = Vec::new();
    for (mut group, folder, file) in [
        (second.trim_end_matches('/'), "/sys/fs/cgroup", "memory.max"),
        (first.trim_end_matches('/'), "/sys/fs/cgroup/memory", "memory.limit_in_bytes"),
    ] {
        loop {
            files.push(format!("{folder}{group}/{file}"));
            match group.rsplit_once('/') {
                Some((around, _)) => group = around,
                None => break,
            }
        }
    }
    files.iter().filter_map(|path| read(path)?.trim().parse().ok()).collect()
}

/// The addresses that the C library sets aside for each thread that asks it for memory.
const ADDRESSES_OF_A_THREAD: u64 = 64 << 20;

/// What `ulimit -v` leaves: addresses that are taken already, such as those of the program itself, count, and so do
/// those that threads will set aside; but never more than half of what is left, lest little work be refused.
fn address_space(read: &impl Fn(&str) -> Option<String>) -> Option<u64> {
    let limits = read("/proc/self/limits")?;
    let line = limits.lines().find_map(|line| line.strip_prefix("Max address space"))?;
    let limit: u64 = line.split_whitespace().next()?.parse().ok()?;
    let status = read("/proc/self/status")?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmSize:"))?;
    let taken: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    let left = limit.saturating_sub(taken.saturating_mul(1024));
    let threads = std::thread::available_parallelism().map_or(1, |threads| threads.get() as u64);
    Some(left - (threads * ADDRESSES_OF_A_THREAD).min(left / 2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_are_shown_with_three_figures() {
        let shown =
            [(0, "0 B"), (999, "999 B"), (1024, "1.0 KiB"), (5 << 30, "5.0 GiB"), (u64::MAX, "16384 PiB")];
        for (bytes, text) in shown {
            assert_eq!(Bytes(bytes).to_string(), text);
        }
        assert!(machine_memory() > 1 << 26);
    }

    #[test]
    fn the_narrowest_group_counts() {
        let read = |path: &str| match path {
            "/proc/self/cgroup" => Some("0::/jobs/one\n".to_owned()),
            "/sys/fs/cgroup/jobs/memory.max" => Some("123\n".to_owned()),
            "/sys/fs/cgroup/jobs/one/memory.max" => Some("max\n".to_owned()),
            "/proc/self/limits" => Some("Max address space   5000    unlimited   bytes\n".to_owned()),
            "/proc/self/status" => Some("VmSize:\t       1 kB\n".to_owned()),
            _ => None,
        };
        assert_eq!(cgroup_limits(&read), [123]);
        assert_eq!(address_space(&read), Some((5000 - 1024) / 2));
    }

    #[test]
    fn what_is_refused_is_told_by_part() {
        let parts =
            vec![MemoryPart { name: "scene", bytes: 1 << 30 }, MemoryPart { name: "shapes", bytes: 3 << 30 }];
        let message = TooMuchMemory { parts, limit: 1 << 20 }.to_string();
        assert_eq!(
            message,
            "this would take about 4.0 GiB of memory (scene 1.0 GiB, shapes 3.0 GiB); the limit is 1.0 MiB \
             (--max-memory allows more)"
        );
    }
}
