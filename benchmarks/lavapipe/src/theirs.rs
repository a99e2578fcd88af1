//! The frames of lavapipe, through wgpu.

use crate::work::{HEIGHT, Row, Shading, WIDTH};
use std::error::Error;
use steradian_raster::texture::Texture;
use wgpu::util::{BufferInitDescriptor, DeviceExt};

const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
const COLOR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
const SIZE: wgpu::Extent3d = wgpu::Extent3d { width: WIDTH, height: HEIGHT, depth_or_array_layers: 1 };

/// The driver.
pub struct Lavapipe {
    device: wgpu::Device,
    queue: wgpu::Queue,
    /// Its name and version.
    pub name: String,
}

/// Pipeline, buffers and targets of a row.
pub struct Frame<'a> {
    driver: &'a Lavapipe,
    pipeline: wgpu::RenderPipeline,
    bindings: wgpu::BindGroup,
    points: wgpu::Buffer,
    normals: wgpu::Buffer,
    indices: wgpu::Buffer,
    count: u32,
    layers: u32,
    /// Final picture, resolved.
    picture: wgpu::Texture,
    color: Option<wgpu::TextureView>,
    resolved: Option<wgpu::TextureView>,
    depth: wgpu::TextureView,
}

impl Lavapipe {
    /// The first processor that Vulkan knows as a device.
    pub fn open() -> Result<Self, Box<dyn Error>> {
        let mut wanted = wgpu::InstanceDescriptor::new_without_display_handle();
        (wanted.backends, wanted.flags) = (wgpu::Backends::VULKAN, wgpu::InstanceFlags::empty());
        let adapters = pollster::block_on(wgpu::Instance::new(wanted).enumerate_adapters(wgpu::Backends::VULKAN));
        let is_cpu = |adapter: &wgpu::Adapter| adapter.get_info().device_type == wgpu::DeviceType::Cpu;
        let adapter = adapters.into_iter().find(is_cpu).ok_or(
            "Vulkan finds no driver for the processor; lavapipe comes with Debian's package mesa-vulkan-drivers",
        )?;
        let info = adapter.get_info();
        let (device, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor::default()))?;
        Ok(Self { device, queue, name: format!("{}, {}", info.name, info.driver_info) })
    }

    fn texture(&self, format: wgpu::TextureFormat, samples: u32, usage: wgpu::TextureUsages) -> wgpu::Texture {
        self.device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: SIZE,
            mip_level_count: 1,
            sample_count: samples,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: usage | wgpu::TextureUsages::RENDER_ATTACHMENT,
            view_formats: &[],
        })
    }

    fn buffer(&self, contents: &[u8], usage: wgpu::BufferUsages) -> wgpu::Buffer {
        self.device.create_buffer_init(&BufferInitDescriptor { label: None, contents, usage })
    }

    /// All levels of our texture.
    fn board(&self, ours: &Texture) -> wgpu::Texture {
        let bytes: Vec<u8> = (0..ours.level_count()).filter_map(|level| ours.level(level)).flatten().copied().collect();
        let size = ours.size();
        let wanted = wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d { width: size.width, height: size.height, depth_or_array_layers: 1 },
            mip_level_count: ours.level_count(),
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: COLOR,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        };
        self.device.create_texture_with_data(&self.queue, &wanted, wgpu::util::TextureDataOrder::LayerMajor, &bytes)
    }

    /// Pipeline, buffers and targets of a row.
    pub fn frame(&self, row: &Row, texture: &Texture) -> Frame<'_> {
        let floats = |points: &[steradian_raster::glam::Vec3]| -> Vec<u8> {
            points.iter().flat_map(|p| p.to_array()).flat_map(f32::to_le_bytes).collect()
        };
        // A uniform block is filled up to multiples of 16 bytes.
        let layers = [row.layers as f32, 0.0, 0.0, 0.0];
        let uniforms: Vec<u8> =
            row.mesh.matrix.to_cols_array().into_iter().chain(layers).flat_map(f32::to_le_bytes).collect();
        let indices: Vec<u8> = row.mesh.indices.iter().flat_map(|i| i.to_le_bytes()).collect();
        let readable = wgpu::TextureUsages::COPY_SRC;
        let depth = self.texture(DEPTH, row.samples, readable);
        let color = self.texture(COLOR, row.samples, readable);
        let resolved = (row.samples > 1).then(|| self.texture(COLOR, 1, readable));
        let pipeline = self.pipeline(row);
        let view = |texture: &wgpu::Texture| texture.create_view(&Default::default());
        let is_depth = row.shading == Shading::Depth;
        Frame {
            driver: self,
            bindings: self.bindings(&pipeline, row, &uniforms, texture),
            pipeline,
            points: self.buffer(&floats(&row.mesh.points), wgpu::BufferUsages::VERTEX),
            normals: self.buffer(&floats(&row.mesh.normals), wgpu::BufferUsages::VERTEX),
            indices: self.buffer(&indices, wgpu::BufferUsages::INDEX),
            count: row.mesh.indices.len() as u32,
            layers: row.layers,
            depth: view(&depth),
            color: (!is_depth).then(|| view(&color)),
            resolved: resolved.as_ref().map(view),
            picture: if is_depth { depth } else { resolved.unwrap_or(color) },
        }
    }

    fn bindings(&self, of: &wgpu::RenderPipeline, row: &Row, uniforms: &[u8], texture: &Texture) -> wgpu::BindGroup {
        let uniforms = self.buffer(uniforms, wgpu::BufferUsages::UNIFORM);
        let board = self.board(texture).create_view(&Default::default());
        let sampler = self.device.create_sampler(&wgpu::SamplerDescriptor {
            address_mode_u: wgpu::AddressMode::Repeat,
            address_mode_v: wgpu::AddressMode::Repeat,
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            mipmap_filter: wgpu::MipmapFilterMode::Linear,
            ..Default::default()
        });
        let entry = |binding, resource| wgpu::BindGroupEntry { binding, resource };
        let mut entries = vec![entry(0, uniforms.as_entire_binding())];
        if row.shading == Shading::Textured {
            entries.push(entry(1, wgpu::BindingResource::TextureView(&board)));
            entries.push(entry(2, wgpu::BindingResource::Sampler(&sampler)));
        }
        let layout = of.get_bind_group_layout(0);
        self.device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout: &layout, entries: &entries })
    }

    fn pipeline(&self, row: &Row) -> wgpu::RenderPipeline {
        let module = self.device.create_shader_module(wgpu::include_wgsl!("shaders.wgsl"));
        let (vertex, fragment) = match row.shading {
            Shading::Lit => ("lit_vertex", Some("lit")),
            Shading::Phong => ("lit_vertex", Some("phong")),
            Shading::Textured => ("textured_vertex", Some("textured")),
            Shading::Depth => ("depth_vertex", None),
        };
        let points = wgpu::vertex_attr_array![0 => Float32x3];
        let normals = wgpu::vertex_attr_array![1 => Float32x3];
        let stream = |attributes| {
            Some(wgpu::VertexBufferLayout { array_stride: 12, step_mode: wgpu::VertexStepMode::Vertex, attributes })
        };
        let target = [Some(wgpu::ColorTargetState::from(COLOR))];
        self.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: None,
            layout: None,
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some(vertex),
                compilation_options: Default::default(),
                buffers: &[stream(&points), stream(&normals)],
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: Some(wgpu::DepthStencilState {
                format: DEPTH,
                depth_write_enabled: Some(true),
                depth_compare: Some(wgpu::CompareFunction::Less),
                stencil: Default::default(),
                bias: Default::default(),
            }),
            multisample: wgpu::MultisampleState { count: row.samples, ..Default::default() },
            fragment: fragment.map(|name| wgpu::FragmentState {
                module: &module,
                entry_point: Some(name),
                compilation_options: Default::default(),
                targets: &target,
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}

impl Frame<'_> {
    /// Draws the frame, resolves its samples, and waits for it.
    pub fn draw(&self) -> Result<(), Box<dyn Error>> {
        let Lavapipe { device, queue, .. } = self.driver;
        let mut commands = device.create_command_encoder(&Default::default());
        let color = self.color.as_ref().map(|view| wgpu::RenderPassColorAttachment {
            view,
            depth_slice: None,
            resolve_target: self.resolved.as_ref(),
            ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT), store: wgpu::StoreOp::Store },
        });
        let depth_ops = Some(wgpu::Operations { load: wgpu::LoadOp::Clear(1.0), store: wgpu::StoreOp::Store });
        let colors = [color];
        let mut pass = commands.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: if self.color.is_some() { &colors } else { &[] },
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.depth,
                depth_ops,
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.bindings, &[]);
        pass.set_vertex_buffer(0, self.points.slice(..));
        pass.set_vertex_buffer(1, self.normals.slice(..));
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint32);
        pass.draw_indexed(0..self.count, 0, 0..self.layers);
        drop(pass);
        queue.submit([commands.finish()]);
        device.poll(wgpu::PollType::wait_indefinitely())?;
        Ok(())
    }

    /// The bytes of the picture, four to a pixel, row by row.
    pub fn bytes(&self) -> Result<Vec<u8>, Box<dyn Error>> {
        let Lavapipe { device, queue, .. } = self.driver;
        let buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: u64::from(4 * WIDTH * HEIGHT),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * WIDTH), rows_per_image: None };
        let mut commands = device.create_command_encoder(&Default::default());
        let into = wgpu::TexelCopyBufferInfo { buffer: &buffer, layout };
        commands.copy_texture_to_buffer(self.picture.as_image_copy(), into, SIZE);
        queue.submit([commands.finish()]);
        buffer.slice(..).map_async(wgpu::MapMode::Read, |_| ());
        device.poll(wgpu::PollType::wait_indefinitely())?;
        Ok(buffer.slice(..).get_mapped_range()?.to_vec())
    }
}
