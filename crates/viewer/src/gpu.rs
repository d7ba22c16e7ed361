//! The rasteriser: a scene's buffers on the GPU, drawn into a picture of its own when the view changes, not when the
//! window is drawn.

mod pipelines;

use crate::hidden::Hidden;
use crate::pack::Batch;
use crate::pack::Packed;
use crate::pictures::Pictures;
use crate::rays::Line;
use crate::tables;
use crate::tables::ViewFrame;
use dotray_geometry::Vec3;
use dotray_scene::Resolved;
use dotray_scene::model::Camera;
use eframe::egui;
use eframe::wgpu;
use egui_wgpu::RenderState;
use pipelines::Pipelines;
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

fn vertex_buffer(device: &wgpu::Device, contents: &[u8]) -> wgpu::Buffer {
    let usage = wgpu::BufferUsages::VERTEX;
    device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: None, contents, usage })
}

/// The scene on the GPU.
#[derive(Debug)]
struct Loaded {
    frame: ViewFrame,
    balls: Vec<Held>,
    rounds: Vec<Held>,
    boxes: Vec<Held>,
    triangles: Vec<Held>,
    pictures: wgpu::TextureView,
    bind_group: wgpu::BindGroup,
    light_count: u32,
    ambient: [f32; 3],
    background: Vec3,
}

/// The picture that is drawn into.
struct Target {
    size: [u32; 2],
    color: wgpu::TextureView,
    depth: wgpu::TextureView,
    id: egui::TextureId,
}

/// See the module.
pub struct Raster {
    state: RenderState,
    pipelines: Pipelines,
    uniforms: wgpu::Buffer,
    loaded: Option<Loaded>,
    lines: Option<(wgpu::Buffer, u32)>,
    target: Option<Target>,
}

/// The numbers of the shader's `View`.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
struct Uniforms {
    eye: [f32; 4],
    right: [f32; 4],
    up: [f32; 4],
    ahead: [f32; 4],
    ambient: [f32; 4],
    counts: [u32; 4],
}

/// The near plane, in parts of the scene's size.
const NEAR: f64 = 1e-5;

impl Raster {
    /// Builds what does not depend on the scene.
    pub fn new(state: &RenderState) -> Self {
        let uniforms = state.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("view"),
            size: size_of::<Uniforms>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let pipelines = Pipelines::new(&state.device);
        Self { state: state.clone(), pipelines, uniforms, loaded: None, lines: None, target: None }
    }

    /// The device and the interface that draw, as people read them.
    pub fn device_name(&self) -> String {
        let info = self.state.adapter.get_info();
        let kind = match info.device_type {
            wgpu::DeviceType::Cpu => "software",
            wgpu::DeviceType::DiscreteGpu | wgpu::DeviceType::IntegratedGpu => "GPU",
            wgpu::DeviceType::VirtualGpu => "virtual GPU",
            wgpu::DeviceType::Other => "device",
        };
        format!("{} · {kind} · {:?}", info.name, info.backend)
    }

    /// Takes a scene.
    pub fn load(&mut self, packed: &Packed, pictures: &Pictures, style: &Resolved) {
        let device = &self.state.device;
        let pictures = self.picture_layers(pictures);
        let bind_group = self.tables(&packed.frame, style, &pictures);
        self.loaded = Some(Loaded {
            frame: packed.frame,
            balls: Held::all(device, &packed.balls),
            rounds: Held::all(device, &packed.rounds),
            boxes: Held::all(device, &packed.boxes),
            triangles: Held::all(device, &packed.triangles),
            pictures,
            bind_group,
            light_count: style.lights.len() as u32,
            ambient: style.ambient.to_array().map(|x| x as f32),
            background: style.background,
        });
        self.lines = None;
    }

    /// Takes other lights, materials and colours.
    pub fn restyle(&mut self, style: &Resolved) {
        let Some(mut loaded) = self.loaded.take() else { return };
        loaded.bind_group = self.tables(&loaded.frame, style, &loaded.pictures);
        loaded.light_count = style.lights.len() as u32;
        loaded.ambient = style.ambient.to_array().map(|x| x as f32);
        loaded.background = style.background;
        self.loaded = Some(loaded);
    }

    /// Takes which shapes are shown.
    pub fn hide(&mut self, hidden: &Hidden) {
        if let Some(loaded) = &mut self.loaded {
            for list in [&mut loaded.balls, &mut loaded.rounds, &mut loaded.boxes, &mut loaded.triangles] {
                list.iter_mut().for_each(|held| held.shown = hidden.shown(&held.numbers));
            }
        }
    }

    /// Takes the lines to draw over the scene.
    pub fn set_lines(&mut self, lines: &[Line]) {
        #[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
        #[repr(C)]
        struct End {
            point: [f32; 3],
            color: [u8; 4],
        }
        let Some(loaded) = &self.loaded else { return };
        let end =
            |point: Vec3, color| End { point: loaded.frame.point(point).to_array().map(|x| x as f32), color };
        let ends: Vec<End> =
            lines.iter().flat_map(|line| line.ends.map(|point| end(point, line.color))).collect();
        self.lines = (!ends.is_empty())
            .then(|| (vertex_buffer(&self.state.device, bytemuck::cast_slice(&ends)), ends.len() as u32));
    }

    /// Draws the scene into a picture of this size, or the lines alone over nothing.
    pub fn draw(&mut self, camera: &Camera, size: [u32; 2], lines_only: bool) -> Option<egui::TextureId> {
        let most = self.state.device.limits().max_texture_dimension_2d;
        let size = size.map(|edge| edge.clamp(1, most));
        self.fit(size);
        let (loaded, target) = (self.loaded.as_ref()?, self.target.as_ref()?);
        let uniforms = uniforms(loaded, camera, size);
        self.state.queue.write_buffer(&self.uniforms, 0, bytemuck::bytes_of(&uniforms));
        let [r, g, b] = loaded.background.to_array().map(|x| x.clamp(0.0, 1.0));
        let clear = if lines_only { wgpu::Color::TRANSPARENT } else { wgpu::Color { r, g, b, a: 1.0 } };
        let mut encoder = self.state.device.create_command_encoder(&Default::default());
        {
            let ops = wgpu::Operations { load: wgpu::LoadOp::Clear(clear), store: wgpu::StoreOp::Store };
            let depth = wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Discard };
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("scene"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: &target.color,
                    depth_slice: None,
                    resolve_target: None,
                    ops,
                })],
                depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                    view: &target.depth,
                    depth_ops: Some(depth),
                    stencil_ops: None,
                }),
                ..Default::default()
            });
            pass.set_bind_group(0, &loaded.bind_group, &[]);
            if !lines_only {
                self.draw_shapes(loaded, &mut pass);
            }
            if let Some((buffer, count)) = &self.lines {
                pass.set_vertex_buffer(0, buffer.slice(..));
                for pipeline in [&self.pipelines.faint_lines, &self.pipelines.lines] {
                    pass.set_pipeline(pipeline);
                    pass.draw(0..*count, 0..1);
                }
            }
        }
        self.state.queue.submit([encoder.finish()]);
        Some(target.id)
    }

    fn draw_shapes(&self, loaded: &Loaded, pass: &mut wgpu::RenderPass<'_>) {
        let instanced = [
            (&self.pipelines.balls, &loaded.balls, 4),
            (&self.pipelines.solids, &loaded.rounds, 4),
            (&self.pipelines.boxes, &loaded.boxes, 18),
        ];
        for (pipeline, list, vertices) in instanced {
            for held in list.iter().filter(|held| !held.shown.is_empty()) {
                pass.set_pipeline(pipeline);
                pass.set_vertex_buffer(0, held.buffer.slice(..));
                held.shown.iter().for_each(|range| pass.draw(0..vertices, range.clone()));
            }
        }
        for held in loaded.triangles.iter().filter(|held| !held.shown.is_empty()) {
            pass.set_pipeline(&self.pipelines.triangles);
            pass.set_vertex_buffer(0, held.buffer.slice(..));
            held.shown.iter().for_each(|range| pass.draw(3 * range.start..3 * range.end, 0..1));
        }
    }

    /// Makes the target this large.
    fn fit(&mut self, size: [u32; 2]) {
        if self.target.as_ref().is_some_and(|target| target.size == size) {
            return;
        }
        let device = &self.state.device;
        let texture = |format, usage| {
            let texture = device.create_texture(&wgpu::TextureDescriptor {
                label: Some("scene"),
                size: wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT | usage,
                view_formats: &[],
            });
            texture.create_view(&wgpu::TextureViewDescriptor::default())
        };
        let color = texture(pipelines::COLOR, wgpu::TextureUsages::TEXTURE_BINDING);
        let depth = texture(pipelines::DEPTH, wgpu::TextureUsages::empty());
        let mut renderer = self.state.renderer.write();
        if let Some(old) = self.target.take() {
            renderer.free_texture(&old.id);
        }
        let id = renderer.register_native_texture(device, &color, wgpu::FilterMode::Nearest);
        self.target = Some(Target { size, color, depth, id });
    }

    fn tables(&self, frame: &ViewFrame, style: &Resolved, pictures: &wgpu::TextureView) -> wgpu::BindGroup {
        let device = &self.state.device;
        let materials = self.table(tables::materials(&style.materials));
        let lights = self.table(tables::lights(&style.lights, frame));
        let entry = |binding, resource| wgpu::BindGroupEntry { binding, resource };
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("scene"),
            layout: &self.pipelines.layout,
            entries: &[
                entry(0, self.uniforms.as_entire_binding()),
                entry(1, wgpu::BindingResource::TextureView(&materials)),
                entry(2, wgpu::BindingResource::TextureView(&lights)),
                entry(3, wgpu::BindingResource::TextureView(pictures)),
                entry(4, wgpu::BindingResource::Sampler(&self.pipelines.sampler)),
            ],
        })
    }

    fn table(&self, texels: Vec<[f32; 4]>) -> wgpu::TextureView {
        let most = self.state.device.limits().max_texture_dimension_2d as usize;
        let mut texels = tables::padded(texels);
        texels.truncate(most * tables::WIDTH);
        let rows = (texels.len() / tables::WIDTH) as u32;
        let size = wgpu::Extent3d { width: tables::WIDTH as u32, height: rows, depth_or_array_layers: 1 };
        self.texture(size, wgpu::TextureFormat::Rgba32Float, bytemuck::cast_slice(&texels))
            .create_view(&wgpu::TextureViewDescriptor::default())
    }

    fn picture_layers(&self, pictures: &Pictures) -> wgpu::TextureView {
        let edge = pictures.edge.max(1);
        let bytes = edge as usize * edge as usize * 4;
        let most = self.state.device.limits().max_texture_array_layers as usize;
        // WebGL takes a texture of one layer for a plain one, and one of six for a cube.
        let count = pictures.layers.len().clamp(2, most);
        let count = if count.is_multiple_of(6) { count + 1 } else { count };
        let mut texels: Vec<u8> = pictures.layers.iter().take(most).flatten().copied().collect();
        texels.resize(count * bytes, 255);
        let size = wgpu::Extent3d { width: edge, height: edge, depth_or_array_layers: count as u32 };
        self.texture(size, wgpu::TextureFormat::Rgba8Unorm, &texels).create_view(
            &wgpu::TextureViewDescriptor {
                dimension: Some(wgpu::TextureViewDimension::D2Array),
                ..Default::default()
            },
        )
    }

    fn texture(&self, size: wgpu::Extent3d, format: wgpu::TextureFormat, texels: &[u8]) -> wgpu::Texture {
        let descriptor = wgpu::TextureDescriptor {
            label: None,
            size,
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        };
        let order = wgpu::util::TextureDataOrder::LayerMajor;
        self.state.device.create_texture_with_data(&self.state.queue, &descriptor, order, texels)
    }
}

fn uniforms(loaded: &Loaded, camera: &Camera, size: [u32; 2]) -> Uniforms {
    let ahead = camera.direction.normalize();
    let right = ahead.cross(camera.up).normalize();
    let tan_height = libm::tan(camera.half_angle);
    let tan_width = tan_height * f64::from(size[0]) / f64::from(size[1]);
    let four = |v: Vec3, w: f64| v.extend(w).to_array().map(|x| x as f32);
    let [r, g, b] = loaded.ambient;
    Uniforms {
        eye: four(loaded.frame.point(camera.position), loaded.frame.unit),
        right: four(right, tan_width),
        up: four(right.cross(ahead), tan_height),
        ahead: four(ahead, NEAR),
        ambient: [r, g, b, 0.0],
        counts: [loaded.light_count, tables::WIDTH as u32, 0, 0],
    }
}
