//! How each kind of thing is drawn.

use crate::pack::Ball;
use crate::pack::Corner;
use crate::pack::Solid;
use eframe::wgpu;

/// The format of the picture that is drawn into.
pub const COLOR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// Near is 1 and infinity 0, where floating point is finest.
pub const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// One pipeline a kind.
pub struct Pipelines {
    /// What the shader reads besides vertices.
    pub layout: wgpu::BindGroupLayout,
    /// How textures are read.
    pub sampler: wgpu::Sampler,
    /// Spheres.
    pub balls: wgpu::RenderPipeline,
    /// Other round shapes.
    pub solids: wgpu::RenderPipeline,
    /// Boxes.
    pub boxes: wgpu::RenderPipeline,
    /// Triangles.
    pub triangles: wgpu::RenderPipeline,
    /// Lines that shapes hide.
    pub lines: wgpu::RenderPipeline,
    /// Lines that shine through.
    pub faint_lines: wgpu::RenderPipeline,
}

/// What differs from pipeline to pipeline.
struct Kind<'a> {
    vertex: &'a str,
    fragment: &'a str,
    stride: usize,
    step: wgpu::VertexStepMode,
    attributes: &'a [wgpu::VertexAttribute],
    topology: wgpu::PrimitiveTopology,
    over: bool,
    depth: wgpu::CompareFunction,
}

impl Pipelines {
    /// All of them.
    pub fn new(device: &wgpu::Device) -> Self {
        let shader = device.create_shader_module(wgpu::include_wgsl!("view.wgsl"));
        let layout = bind_group_layout(device);
        let all = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: None,
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let make = |kind: &Kind<'_>| pipeline(device, &shader, &all, kind);
        let ball = Kind {
            vertex: "ball_vertex",
            fragment: "ball_fragment",
            stride: size_of::<Ball>(),
            step: wgpu::VertexStepMode::Instance,
            attributes: &wgpu::vertex_attr_array![0 => Float32x4, 1 => Uint32],
            topology: wgpu::PrimitiveTopology::TriangleStrip,
            over: false,
            depth: wgpu::CompareFunction::Greater,
        };
        let rows = wgpu::vertex_attr_array![
            0 => Float32x4, 1 => Float32x4, 2 => Float32x4, 3 => Uint32, 4 => Uint32, 5 => Float32x2, 6 => Uint32
        ];
        let solid = Kind {
            vertex: "solid_vertex",
            fragment: "solid_fragment",
            stride: size_of::<Solid>(),
            attributes: &rows,
            ..ball
        };
        let triangle_list = wgpu::PrimitiveTopology::TriangleList;
        let cuboid =
            Kind { vertex: "box_vertex", fragment: "surface_fragment", topology: triangle_list, ..solid };
        let corners = wgpu::vertex_attr_array![
            0 => Float32x3, 1 => Snorm16x2, 2 => Float32x2, 3 => Uint32, 6 => Uint32
        ];
        let triangle = Kind {
            vertex: "corner_vertex",
            stride: size_of::<Corner>(),
            step: wgpu::VertexStepMode::Vertex,
            attributes: &corners,
            ..cuboid
        };
        let ends = wgpu::vertex_attr_array![0 => Float32x3, 1 => Unorm8x4];
        let line = Kind {
            vertex: "line_vertex",
            fragment: "line_fragment",
            stride: 16,
            step: wgpu::VertexStepMode::Vertex,
            attributes: &ends,
            topology: wgpu::PrimitiveTopology::LineList,
            over: true,
            depth: wgpu::CompareFunction::GreaterEqual,
        };
        let faint = Kind { fragment: "faint_fragment", depth: wgpu::CompareFunction::Always, ..line };
        Self {
            balls: make(&ball),
            solids: make(&solid),
            boxes: make(&cuboid),
            triangles: make(&triangle),
            lines: make(&line),
            faint_lines: make(&faint),
            layout,
            sampler: repeating(device),
        }
    }
}

/// How textures are read: over and over, and smoothly.
fn repeating(device: &wgpu::Device) -> wgpu::Sampler {
    device.create_sampler(&wgpu::SamplerDescriptor {
        address_mode_u: wgpu::AddressMode::Repeat,
        address_mode_v: wgpu::AddressMode::Repeat,
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        ..Default::default()
    })
}

fn bind_group_layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    let entry = |binding, ty| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
        ty,
        count: None,
    };
    let texture = |filterable, view_dimension| wgpu::BindingType::Texture {
        sample_type: wgpu::TextureSampleType::Float { filterable },
        view_dimension,
        multisampled: false,
    };
    let uniform = wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Uniform,
        has_dynamic_offset: false,
        min_binding_size: None,
    };
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: None,
        entries: &[
            entry(0, uniform),
            entry(1, texture(false, wgpu::TextureViewDimension::D2)),
            entry(2, texture(false, wgpu::TextureViewDimension::D2)),
            entry(3, texture(true, wgpu::TextureViewDimension::D2Array)),
            entry(4, wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering)),
            entry(5, texture(false, wgpu::TextureViewDimension::D2)),
        ],
    })
}

fn pipeline(
    device: &wgpu::Device,
    shader: &wgpu::ShaderModule,
    layout: &wgpu::PipelineLayout,
    kind: &Kind<'_>,
) -> wgpu::RenderPipeline {
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(kind.vertex),
        layout: Some(layout),
        vertex: wgpu::VertexState {
            module: shader,
            entry_point: Some(kind.vertex),
            compilation_options: Default::default(),
            buffers: &[Some(wgpu::VertexBufferLayout {
                array_stride: kind.stride as u64,
                step_mode: kind.step,
                attributes: kind.attributes,
            })],
        },
        primitive: wgpu::PrimitiveState { topology: kind.topology, ..Default::default() },
        depth_stencil: Some(wgpu::DepthStencilState {
            format: DEPTH,
            depth_write_enabled: Some(!kind.over),
            depth_compare: Some(kind.depth),
            stencil: Default::default(),
            bias: Default::default(),
        }),
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module: shader,
            entry_point: Some(kind.fragment),
            compilation_options: Default::default(),
            targets: &[Some(wgpu::ColorTargetState {
                format: COLOR,
                blend: kind.over.then_some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
                write_mask: wgpu::ColorWrites::ALL,
            })],
        }),
        multiview_mask: None,
        cache: None,
    })
}
