//! Shapes in the GPU's memory, drawn at once or part by part.

use super::pipelines::Pipelines;
use super::sight::Sight;
use crate::hidden::Hidden;
use crate::pack::Batch;
use crate::pack::Bounded;
use crate::pack::Packed;
use eframe::wgpu;
use glam::Vec3;
use rayon::prelude::*;
use std::ops::Range;
use wgpu::util::DeviceExt;

/// One buffer of things, and which of them are shown.
#[derive(Debug)]
struct Held {
    buffer: wgpu::Buffer,
    numbers: Vec<u32>,
    shown: Vec<Range<u32>>,
    /// Boxes around every so many things, and which of those that are shown can be on the screen.
    chunks: Vec<[Vec3; 2]>,
    in_sight: Vec<Range<u32>>,
}

/// Things that are looked at together: groups stand together in a file, and mostly in space.
const CHUNK: usize = 512;

fn around<T: Bounded>(things: &[T]) -> [Vec3; 2] {
    let nothing = [Vec3::INFINITY, Vec3::NEG_INFINITY];
    let grown = |[low, high]: [Vec3; 2], [a, b]: [Vec3; 2]| [low.min(a), high.max(b)];
    things.iter().map(Bounded::corners).fold(nothing, grown)
}

impl Held {
    fn all<T: bytemuck::Pod + Bounded + Sync>(device: &wgpu::Device, batches: &[Batch<T>]) -> Vec<Self> {
        let held = |batch: &Batch<T>| {
            let shown = Hidden::default().shown(&batch.numbers);
            Self {
                buffer: vertex_buffer(device, bytemuck::cast_slice(&batch.things)),
                numbers: batch.numbers.clone(),
                in_sight: shown.clone(),
                shown,
                chunks: batch.things.par_chunks(CHUNK).map(around).collect(),
            }
        };
        batches.iter().map(held).collect()
    }

    /// Keeps what can be seen of what is shown: as few ranges as there can be.
    fn look(&mut self, sight: &Sight) {
        self.in_sight.clear();
        let mut seen: Vec<Range<u32>> = Vec::new();
        for (number, chunk) in self.chunks.iter().enumerate() {
            if sight.misses(*chunk) {
                continue;
            }
            let (first, end) = ((number * CHUNK) as u32, ((number + 1) * CHUNK) as u32);
            match seen.last_mut() {
                Some(last) if last.end == first => last.end = end,
                Some(_) | None => seen.push(first..end),
            }
        }
        for seen in seen {
            let first = self.shown.partition_point(|range| range.end <= seen.start);
            let shown = self.shown.iter().skip(first).take_while(|range| range.start < seen.end);
            self.in_sight.extend(shown.map(|range| range.start.max(seen.start)..range.end.min(seen.end)));
        }
    }
}

/// A buffer of vertices or instances.
pub fn vertex_buffer(device: &wgpu::Device, contents: &[u8]) -> wgpu::Buffer {
    let usage = wgpu::BufferUsages::VERTEX;
    device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: None, contents, usage })
}

/// See the module.
#[derive(Debug)]
pub struct HeldShapes {
    balls: Vec<Held>,
    rounds: Vec<Held>,
    boxes: Vec<Held>,
    triangles: Vec<Held>,
}

impl HeldShapes {
    /// Takes all shapes.
    pub fn new(device: &wgpu::Device, packed: &Packed) -> Self {
        Self {
            balls: Held::all(device, &packed.balls),
            rounds: Held::all(device, &packed.rounds),
            boxes: Held::all(device, &packed.boxes),
            triangles: Held::all(device, &packed.triangles),
        }
    }

    /// Takes which shapes are shown.
    pub fn hide(&mut self, hidden: &Hidden) {
        for list in [&mut self.balls, &mut self.rounds, &mut self.boxes, &mut self.triangles] {
            for held in list {
                held.shown = hidden.shown(&held.numbers);
                held.in_sight.clone_from(&held.shown);
            }
        }
    }

    /// Leaves out what is off the screen, until the next look.
    pub fn look(&mut self, sight: &Sight) {
        for list in [&mut self.balls, &mut self.rounds, &mut self.boxes, &mut self.triangles] {
            list.iter_mut().for_each(|held| held.look(sight));
        }
    }

    /// How many things are shown and can be seen.
    pub fn count(&self) -> u64 {
        let all = [&self.balls, &self.rounds, &self.boxes, &self.triangles].into_iter().flatten();
        all.flat_map(|held| &held.in_sight).map(|range| range.len() as u64).sum()
    }

    /// Draws a part of the things that are shown and can be seen, in their order.
    pub fn draw(&self, pipelines: &Pipelines, pass: &mut wgpu::RenderPass<'_>, part: &Range<u64>) {
        let kinds = [
            (&pipelines.balls, &self.balls, Some(4)),
            (&pipelines.solids, &self.rounds, Some(4)),
            (&pipelines.boxes, &self.boxes, Some(18)),
            (&pipelines.triangles, &self.triangles, None),
        ];
        let mut at = 0;
        for (pipeline, list, vertices) in kinds {
            for held in list {
                let mut ready = false;
                for range in &held.in_sight {
                    let length = range.len() as u64;
                    let from = part.start.max(at).min(at + length) - at;
                    let to = part.end.max(at).min(at + length) - at;
                    at += length;
                    if from == to {
                        continue;
                    }
                    if !ready {
                        pass.set_pipeline(pipeline);
                        pass.set_vertex_buffer(0, held.buffer.slice(..));
                        ready = true;
                    }
                    let (first, end) = (range.start + from as u32, range.start + to as u32);
                    match vertices {
                        Some(vertices) => pass.draw(0..vertices, first..end),
                        None => pass.draw(3 * first..3 * end, 0..1),
                    }
                }
            }
        }
    }
}
