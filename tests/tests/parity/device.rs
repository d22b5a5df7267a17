//! A compute shader over rows of numbers, passed as bits.

use std::sync::OnceLock;

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
        pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor::default())).unwrap()
    })
}

/// Runs `source` on rows of numbers: it sees `var<storage, read> inputs: array<u32>` (group 1, binding 0) and writes
/// `var<storage, read_write> outputs: array<u32>` (group 1, binding 1), `width` a row; entry point `main`, workgroups
/// of 64 rows. `storage` is bound to group 0, binding 1, unless it is empty.
pub(crate) fn run(source: &str, storage: &[u8], inputs: &[f32], rows: usize, width: usize) -> Vec<f32> {
    let (device, queue) = device();
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
    let buffer = |contents: &[u8]| {
        let usage = wgpu::BufferUsages::STORAGE;
        device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: None, contents, usage })
    };
    let size = (rows * width * 4) as u64;
    let make =
        |usage| device.create_buffer(&wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false });
    let output = make(wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC);
    let readback = make(wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST);
    let input = buffer(bytemuck::cast_slice(inputs));
    let scene = buffer(if storage.is_empty() { &[0; 16] } else { storage });
    fn entry(binding: u32, b: &wgpu::Buffer) -> wgpu::BindGroupEntry<'_> {
        wgpu::BindGroupEntry { binding, resource: b.as_entire_binding() }
    }
    let group = |index, entries: &[wgpu::BindGroupEntry]| {
        let layout = &pipeline.get_bind_group_layout(index);
        device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries })
    };
    let mut encoder = device.create_command_encoder(&Default::default());
    let mut pass = encoder.begin_compute_pass(&Default::default());
    pass.set_pipeline(&pipeline);
    if !storage.is_empty() {
        pass.set_bind_group(0, &group(0, &[entry(1, &scene)]), &[]);
    }
    pass.set_bind_group(1, &group(1, &[entry(0, &input), entry(1, &output)]), &[]);
    pass.dispatch_workgroups(rows.div_ceil(64) as u32, 1, 1);
    drop(pass);
    encoder.copy_buffer_to_buffer(&output, 0, &readback, 0, size);
    queue.submit([encoder.finish()]);
    readback.map_async(wgpu::MapMode::Read, .., |result| result.unwrap());
    device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
    let bytes = readback.get_mapped_range(..).unwrap();
    bytemuck::pod_collect_to_vec(&bytes)
}
