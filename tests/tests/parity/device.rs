//! A compute shader over rows of numbers, passed as bits.

use std::sync::OnceLock;

use tetlux_tables::Table;
use wgpu::util::DeviceExt;

/// A device and its queue, one a process.
fn device() -> &'static (wgpu::Device, wgpu::Queue) {
    static DEVICE: OnceLock<(wgpu::Device, wgpu::Queue)> = OnceLock::new();
    DEVICE.get_or_init(|| {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
        let adapters = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::PRIMARY));
        let Some(adapter) = adapters.into_iter().next() else {
            panic!("there is no graphics adapter: these tests need a driver (a software one will do)")
        };
        println!("on {}", adapter.get_info().name);
        let descriptor = wgpu::DeviceDescriptor { required_limits: adapter.limits(), ..Default::default() };
        pollster::block_on(adapter.request_device(&descriptor)).unwrap()
    })
}

/// What a shader sees besides its rows: a group, a binding, and what is bound there.
pub(crate) enum Bound<'a> {
    Uniform(u32, u32, &'a [u8]),
    Storage(u32, u32, &'a [u8]),
    /// In single precision.
    Texture(u32, u32, &'a Table),
    /// Tables of two axes and one size, the layers of one texture.
    Layers(u32, u32, &'a [Table]),
}

/// What a test's shader is run by.
const ROWS: &str = "
@group(3) @binding(0) var<storage, read> inputs: array<u32>;
@group(3) @binding(1) var<storage, read_write> outputs: array<u32>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x < ROWS {
        row(id.x);
    }
}
";

/// Runs `source` on rows of numbers: its function `row(i: u32)` sees row i of `inputs`, and writes that of `outputs`, both
/// arrays of `u32`; `width` numbers a row are written.
pub(crate) fn run(source: &str, bound: &[Bound], inputs: &[f32], rows: usize, width: usize) -> Vec<f32> {
    let (device, queue) = device();
    let source = source.to_owned() + &ROWS.replace("ROWS", &format!("{rows}u"));
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: None,
        source: wgpu::ShaderSource::Wgsl(source.into()),
    });
    let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: None,
        layout: None,
        module: &module,
        entry_point: Some("main"),
        compilation_options: Default::default(),
        cache: None,
    });
    let buffer = |contents: &[u8], usage| {
        device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: None, contents, usage })
    };
    let size = (rows * width * 4) as u64;
    let make =
        |usage| device.create_buffer(&wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false });
    let output = make(wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC);
    let readback = make(wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST);
    let input = buffer(bytemuck::cast_slice(inputs), wgpu::BufferUsages::STORAGE);
    enum Made {
        Buffer(wgpu::Buffer),
        View(wgpu::TextureView),
    }
    let mut made: Vec<(u32, u32, Made)> = bound
        .iter()
        .map(|bound| match *bound {
            Bound::Uniform(g, b, bytes) => (g, b, Made::Buffer(buffer(bytes, wgpu::BufferUsages::UNIFORM))),
            Bound::Storage(g, b, bytes) => (g, b, Made::Buffer(buffer(bytes, wgpu::BufferUsages::STORAGE))),
            Bound::Texture(g, b, table) => (g, b, Made::View(texture(device, queue, std::slice::from_ref(table)))),
            Bound::Layers(g, b, tables) => (g, b, Made::View(texture(device, queue, tables))),
        })
        .collect();
    made.push((3, 0, Made::Buffer(input)));
    made.push((3, 1, Made::Buffer(output.clone())));
    let mut encoder = device.create_command_encoder(&Default::default());
    let mut pass = encoder.begin_compute_pass(&Default::default());
    pass.set_pipeline(&pipeline);
    for group in 0..4 {
        let of_group = made.iter().filter(|(g, ..)| *g == group);
        let entries: Vec<_> = of_group
            .map(|(_, binding, made)| wgpu::BindGroupEntry {
                binding: *binding,
                resource: match made {
                    Made::Buffer(buffer) => buffer.as_entire_binding(),
                    Made::View(view) => wgpu::BindingResource::TextureView(view),
                },
            })
            .collect();
        let layout = &pipeline.get_bind_group_layout(group);
        let descriptor = wgpu::BindGroupDescriptor { label: None, layout, entries: &entries };
        pass.set_bind_group(group, &device.create_bind_group(&descriptor), &[]);
    }
    pass.dispatch_workgroups(rows.div_ceil(64) as u32, 1, 1);
    drop(pass);
    encoder.copy_buffer_to_buffer(&output, 0, &readback, 0, size);
    queue.submit([encoder.finish()]);
    readback.map_async(wgpu::MapMode::Read, .., |result| result.unwrap());
    device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
    let bytes = readback.get_mapped_range(..).unwrap();
    bytemuck::pod_collect_to_vec(&bytes)
}

/// A table of one channel, or of more stored as four; or several as layers.
fn texture(device: &wgpu::Device, queue: &wgpu::Queue, tables: &[Table]) -> wgpu::TextureView {
    let table = &tables[0];
    let given = table.spec().channels().len();
    let channels = if given == 1 { 1 } else { 4 };
    let padded = |texel: &[f32]| -> Vec<f32> { (0..channels).map(|c| texel.get(c).copied().unwrap_or(0.0)).collect() };
    let texels: Vec<f32> = tables.iter().flat_map(|t| t.texels().chunks_exact(given)).flat_map(padded).collect();
    let [width, height, depth] = table.spec().size;
    let descriptor = wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width, height, depth_or_array_layers: depth * tables.len() as u32 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: if table.axes().len() == 2 { wgpu::TextureDimension::D2 } else { wgpu::TextureDimension::D3 },
        format: if channels == 1 { wgpu::TextureFormat::R32Float } else { wgpu::TextureFormat::Rgba32Float },
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    };
    let order = wgpu::util::TextureDataOrder::LayerMajor;
    let texture = device.create_texture_with_data(queue, &descriptor, order, bytemuck::cast_slice(&texels));
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}
