//! Shapes in the GPU's memory, drawn at once or part by part.

use super::pipelines::Pipelines;
use crate::hidden::Hidden;
use crate::pack::Batch;
use crate::pack::Packed;
use eframe::wgpu;
use std::ops::Range;
use wgpu::util::DeviceExt;

/// One buffer of things, and which of them are shown.
#[derive(Debug)]
struct Held {
    buffer: wgpu::Buffer,
    numbers: Vec<u32>,
    shown: Vec<Range<u32>>,
}

impl Held {
    fn all<T: bytemuck::Pod>(device: &wgpu::Device, batches: &[Batch<T>]) -> Vec<Self> {
        let held = |batch: &Batch<T>| Self {
            buffer: vertex_buffer(device, bytemuck::cast_slice(&batch.things)),
            numbers: batch.numbers.clone(),
            shown: Hidden::default().shown(&batch.numbers),
        };
        batches.iter().map(held).collect()
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
            list.iter_mut().for_each(|held| held.shown = hidden.shown(&held.numbers));
        }
    }

    /// How many things are shown.
    pub fn count(&self) -> u64 {
        let all = [&self.balls, &self.rounds, &self.boxes, &self.triangles].into_iter().flatten();
        all.flat_map(|held| &held.shown).map(|range| range.len() as u64).sum()
    }

    /// Draws a part of the things that are shown, in their order.
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
                for range in &held.shown {
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
