//! The rasteriser: a scene's buffers on the GPU, drawn into a picture of its own when the view changes, not when the
//! window is drawn. A driver in software draws a scene of very many shapes as a draft first, with fewer pixels where
//! that is slow all the same, and all of them part by part once the view rests, so that the window never waits.

mod held;

mod pace;

mod pipelines;

mod sight;

use crate::hidden::Hidden;
use crate::pack::Packed;
use crate::pictures::Pictures;
use crate::rays::Line;
use crate::tables;
use crate::tables::Places;
use crate::tables::ViewFrame;
use dotray_geometry::Vec3;
use dotray_scene::Resolved;
use dotray_scene::model::Camera;
use eframe::egui;
use eframe::wgpu;
use egui_wgpu::RenderState;
use held::HeldShapes;
use held::vertex_buffer;
use pace::Pace;
use pipelines::Pipelines;
use sight::Sight;
use std::ops::Range;
use web_time::Duration;
use web_time::Instant;
use wgpu::util::DeviceExt;

/// The scene on the GPU.
#[derive(Debug)]
struct Loaded {
    frame: ViewFrame,
    shapes: HeldShapes,
    draft: Option<HeldShapes>,
    pictures: wgpu::TextureView,
    places: Places,
    place_table: wgpu::TextureView,
    bind_group: wgpu::BindGroup,
    light_count: u32,
    ambient: [f32; 3],
    background: Vec3,
}

/// A picture that is drawn into.
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
    /// What drafts are drawn into.
    rough: Option<Target>,
    /// How a driver draws moves that takes long for many shapes or pixels.
    pace: Option<Pace>,
    /// How many things of the picture are drawn; `None` where it is finished.
    drawn: Option<u64>,
    /// How many are drawn at a time, and when that was done last.
    portion: u64,
    last_portion: Option<Instant>,
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
    permutation: [[u32; 4]; 16],
}

/// The near plane, in parts of the scene's size.
const NEAR: f64 = 1e-5;

/// So many things are drawn at a time at first, and at least.
const PORTIONS: Range<u64> = 2048..1 << 15;

/// How long a portion should take: the window waits for it.
const PORTION_TIME: Range<Duration> = Duration::from_millis(40)..Duration::from_millis(90);

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
        Self {
            state: state.clone(),
            pipelines,
            uniforms,
            loaded: None,
            lines: None,
            target: None,
            rough: None,
            pace: (state.adapter.get_info().device_type == wgpu::DeviceType::Cpu).then(Pace::default),
            drawn: None,
            portion: PORTIONS.end,
            last_portion: None,
        }
    }

    /// Whether the driver draws by software.
    pub fn is_software(&self) -> bool {
        self.pace.is_some()
    }

    /// The device, the interface and the driver that draw, as people read them.
    pub fn device_name(&self) -> String {
        let info = self.state.adapter.get_info();
        let kind = match info.device_type {
            wgpu::DeviceType::Cpu => "software",
            wgpu::DeviceType::DiscreteGpu | wgpu::DeviceType::IntegratedGpu => "GPU",
            wgpu::DeviceType::VirtualGpu => "virtual GPU",
            wgpu::DeviceType::Other => "device",
        };
        let backend = match info.backend {
            wgpu::Backend::Gl => "OpenGL".to_owned(),
            wgpu::Backend::BrowserWebGpu => "WebGPU".to_owned(),
            other @ (wgpu::Backend::Noop
            | wgpu::Backend::Vulkan
            | wgpu::Backend::Metal
            | wgpu::Backend::Dx12) => format!("{other:?}"),
        };
        let driver =
            Some(info.driver_info.trim()).filter(|driver| !driver.is_empty() && *driver != info.name);
        // Browsers keep the name to themselves.
        let name = Some(info.name.trim()).filter(|name| !name.is_empty());
        let parts = [name, Some(kind), Some(backend.as_str()), driver];
        parts.into_iter().flatten().collect::<Vec<_>>().join(" · ")
    }

    /// Takes a scene, and its draft where it has one.
    pub fn load(&mut self, packed: &Packed, draft: Option<&Packed>, pictures: &Pictures, style: &Resolved) {
        let device = &self.state.device;
        let heights = &pictures.heights;
        let pictures = self.picture_layers(pictures);
        let mut places = Places::new(heights, &packed.colors, &packed.frames);
        let place_table = self.table(std::mem::take(&mut places.texels));
        let bind_group = self.tables(&packed.frame, style, &pictures, &places, &place_table);
        self.loaded = Some(Loaded {
            frame: packed.frame,
            shapes: HeldShapes::new(device, packed),
            draft: draft.filter(|_| self.pace.is_some()).map(|draft| HeldShapes::new(device, draft)),
            pictures,
            places,
            place_table,
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
        let Loaded { frame, pictures, places, place_table, .. } = &loaded;
        loaded.bind_group = self.tables(frame, style, pictures, places, place_table);
        loaded.light_count = style.lights.len() as u32;
        loaded.ambient = style.ambient.to_array().map(|x| x as f32);
        loaded.background = style.background;
        self.loaded = Some(loaded);
    }

    /// Takes which shapes are shown.
    pub fn hide(&mut self, hidden: &Hidden) {
        if let Some(loaded) = &mut self.loaded {
            loaded.shapes.hide(hidden);
            loaded.draft.iter_mut().for_each(|draft| draft.hide(hidden));
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

    /// Draws the scene into a picture of this size, or the lines alone over nothing: no picture where there are none.
    /// It may be a draft: see [`Raster::go_on`].
    pub fn draw(&mut self, camera: &Camera, size: [u32; 2], lines_only: bool) -> Option<egui::TextureId> {
        let most = self.state.device.limits().max_texture_dimension_2d;
        let size = size.map(|edge| edge.clamp(1, most));
        fit(&self.state, &mut self.target, size, wgpu::FilterMode::Nearest);
        let loaded = self.loaded.as_mut()?;
        let uniforms = uniforms(loaded, camera, size);
        let sight = Sight::new(uniforms.eye, uniforms.right, uniforms.up, uniforms.ahead);
        loaded.shapes.look(&sight);
        loaded.draft.iter_mut().for_each(|draft| draft.look(&sight));
        let loaded = self.loaded.as_ref()?;
        self.state.queue.write_buffer(&self.uniforms, 0, bytemuck::bytes_of(&uniforms));
        (self.drawn, self.last_portion) = (None, None);
        if lines_only {
            self.lines.as_ref()?;
            self.paint(self.target.as_ref()?, None, Some(wgpu::Color::TRANSPARENT), true);
            return self.target.as_ref().map(|target| target.id);
        }
        let coarseness = self.pace.as_mut().map_or(1, |pace| pace.next(Instant::now()));
        if coarseness == 1 && loaded.draft.is_none() {
            let all = 0..loaded.shapes.count();
            let target = self.target.as_ref()?;
            self.paint(target, Some((&loaded.shapes, all)), Some(loaded.clear()), true);
            return Some(target.id);
        }
        let shapes = loaded.draft.as_ref().unwrap_or(&loaded.shapes);
        let edges = size.map(|edge| edge.div_ceil(coarseness.max(2)));
        fit(&self.state, &mut self.rough, edges, wgpu::FilterMode::Linear);
        let rough = self.rough.as_ref()?;
        self.paint(rough, Some((shapes, 0..shapes.count())), Some(loaded.clear()), true);
        self.drawn = Some(0);
        Some(rough.id)
    }

    /// How many of the scene's things were drawn last, or are to be: those far off the screen are not.
    pub fn things_in_sight(&self) -> u64 {
        self.loaded.as_ref().map_or(0, |loaded| loaded.shapes.count())
    }

    /// Whether what was drawn last is a draft.
    pub fn is_unfinished(&self) -> bool {
        self.drawn.is_some()
    }

    /// Draws a portion of what a draft stands for; at the end, answers with the whole picture.
    pub fn go_on(&mut self) -> Option<egui::TextureId> {
        let (loaded, from) = self.loaded.as_ref().zip(self.drawn)?;
        let now = Instant::now();
        if let Some(last) = self.last_portion.replace(now) {
            let took = now.duration_since(last);
            if took > PORTION_TIME.end {
                self.portion = (self.portion / 2).max(PORTIONS.start);
            } else if took < PORTION_TIME.start {
                self.portion = self.portion.saturating_mul(2);
            }
        }
        let count = loaded.shapes.count();
        let to = count.min(from.saturating_add(self.portion));
        let clear = (from == 0).then(|| loaded.clear());
        let target = self.target.as_ref()?;
        self.paint(target, Some((&loaded.shapes, from..to)), clear, to == count);
        self.drawn = (to < count).then_some(to);
        (to == count).then_some(target.id)
    }

    /// Draws some shapes into a picture, which is cleared before, and lines over them.
    fn paint(
        &self,
        target: &Target,
        shapes: Option<(&HeldShapes, Range<u64>)>,
        clear: Option<wgpu::Color>,
        lines: bool,
    ) {
        let Some(loaded) = &self.loaded else { return };
        let store = wgpu::StoreOp::Store;
        let color = clear.map_or(wgpu::LoadOp::Load, wgpu::LoadOp::Clear);
        let depth = clear.map_or(wgpu::LoadOp::Load, |_| wgpu::LoadOp::Clear(0.0));
        let mut encoder = self.state.device.create_command_encoder(&Default::default());
        {
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("scene"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: &target.color,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations { load: color, store },
                })],
                depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                    view: &target.depth,
                    depth_ops: Some(wgpu::Operations { load: depth, store }),
                    stencil_ops: None,
                }),
                ..Default::default()
            });
            pass.set_bind_group(0, &loaded.bind_group, &[]);
            if let Some((shapes, part)) = shapes {
                shapes.draw(&self.pipelines, &mut pass, &part);
            }
            if let Some((buffer, count)) = self.lines.as_ref().filter(|_| lines) {
                pass.set_vertex_buffer(0, buffer.slice(..));
                for pipeline in [&self.pipelines.faint_lines, &self.pipelines.lines] {
                    pass.set_pipeline(pipeline);
                    pass.draw(0..*count, 0..1);
                }
            }
        }
        self.state.queue.submit([encoder.finish()]);
    }

    /// Waits until what was asked for is drawn; only those who measure need to.
    pub fn finish(&self) {
        // A device that is lost has nothing left to do.
        let _ = self.state.device.poll(wgpu::PollType::wait_indefinitely());
    }

    /// The picture that was drawn last, for those without a window: its size, and red, green, blue, alpha from the
    /// upper left.
    pub fn pixels(&self) -> Option<([u32; 2], Vec<u8>)> {
        let target = self.target.as_ref()?;
        let [width, height] = target.size;
        let row = (width * 4).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let buffer = self.state.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: u64::from(row) * u64::from(height),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let mut encoder = self.state.device.create_command_encoder(&Default::default());
        let layout =
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row), rows_per_image: None };
        let size = wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
        let to = wgpu::TexelCopyBufferInfo { buffer: &buffer, layout };
        encoder.copy_texture_to_buffer(target.color.texture().as_image_copy(), to, size);
        self.state.queue.submit([encoder.finish()]);
        buffer.slice(..).map_async(wgpu::MapMode::Read, |_| {});
        self.finish();
        let mapped = buffer.slice(..).get_mapped_range().ok()?;
        let rows = mapped.chunks_exact(row as usize).flat_map(|line| line.iter().take(4 * width as usize));
        Some((target.size, rows.copied().collect()))
    }

    fn tables(
        &self,
        frame: &ViewFrame,
        style: &Resolved,
        pictures: &wgpu::TextureView,
        places: &Places,
        place_table: &wgpu::TextureView,
    ) -> wgpu::BindGroup {
        let device = &self.state.device;
        let materials = self.table(tables::materials(&style.materials, places));
        let lights = self.table(tables::lights(&style.lights, &style.tints, frame));
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
                entry(5, wgpu::BindingResource::TextureView(place_table)),
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

impl Loaded {
    fn clear(&self) -> wgpu::Color {
        let [r, g, b] = self.background.to_array().map(|x| x.clamp(0.0, 1.0));
        wgpu::Color { r, g, b, a: 1.0 }
    }
}

/// Makes a target this large, whose pixels are shown so where they are larger than the screen's.
fn fit(state: &RenderState, target: &mut Option<Target>, size: [u32; 2], filter: wgpu::FilterMode) {
    if target.as_ref().is_some_and(|target| target.size == size) {
        return;
    }
    let texture = |format, usage| {
        let texture = state.device.create_texture(&wgpu::TextureDescriptor {
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
    let color =
        texture(pipelines::COLOR, wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_SRC);
    let depth = texture(pipelines::DEPTH, wgpu::TextureUsages::empty());
    let mut renderer = state.renderer.write();
    if let Some(old) = target.take() {
        renderer.free_texture(&old.id);
    }
    let id = renderer.register_native_texture(&state.device, &color, filter);
    *target = Some(Target { size, color, depth, id });
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
        counts: [
            loaded.light_count,
            tables::WIDTH as u32,
            loaded.places.first_color,
            loaded.places.first_frame,
        ],
        permutation: tables::permutation(),
    }
}
