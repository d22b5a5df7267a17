//! Tables as textures.

use std::sync::Arc;

use tetlux_scene::TablePrecision;
use tetlux_tables::Table;
use wgpu::{BindingType, BufferBindingType, ShaderStages, TextureViewDimension};

use super::frame::Maker;
use super::variant::Variant;
use crate::Job;

/// Laid out as the shader's `Lookup` (shaders/lib/lookup.wgsl).
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub(crate) struct Lookup {
    pub(crate) low: [[f32; 4]; 2],
    pub(crate) range: [[f32; 4]; 2],
    pub(crate) length: [f32; 4],
}

/// The layout of bind group 2, for the stage that shades; `None` if there are no tables.
pub(super) fn layout(
    device: &wgpu::Device,
    variant: &Variant,
    visibility: ShaderStages,
) -> Option<wgpu::BindGroupLayout> {
    if variant.tables().is_empty() {
        return None;
    }
    let entry = |binding, ty| wgpu::BindGroupLayoutEntry { binding, visibility, ty, count: None };
    let lookup =
        BindingType::Buffer { ty: BufferBindingType::Uniform, has_dynamic_offset: false, min_binding_size: None };
    let sample_type = wgpu::TextureSampleType::Float { filterable: false };
    let texture = |&view_dimension: &TextureViewDimension| {
        let binding = if view_dimension == TextureViewDimension::D2 { 1 } else { 2 };
        entry(binding, BindingType::Texture { sample_type, view_dimension, multisampled: false })
    };
    let entries: Vec<_> = std::iter::once(entry(0, lookup)).chain(variant.tables().iter().map(texture)).collect();
    let descriptor = wgpu::BindGroupLayoutDescriptor { label: Some("tables"), entries: &entries };
    Some(device.create_bind_group_layout(&descriptor))
}

/// Bind group 2, made.
pub(super) fn bind(make: &Maker, queue: &wgpu::Queue, layout: &wgpu::BindGroupLayout, job: &Job) -> wgpu::BindGroup {
    let mut lookup = Lookup { low: [[0.0; 4]; 2], range: [[1.0; 4]; 2], length: [job.table_length, 0.0, 0.0, 0.0] };
    let view = |binding, (texture, bytes): (wgpu::Texture, u64)| {
        make.count(0, 1, bytes);
        (binding, texture.create_view(&wgpu::TextureViewDescriptor::default()))
    };
    let textures: Vec<_> = match job.tables {
        // Those of several widgets.
        [first, others @ ..] if !others.is_empty() && job.tables.iter().all(|table| table.axes().len() == 2) => {
            let layers = upload_layers(make.device, queue, first, others, job.table_precision, &mut lookup);
            vec![view(LAYERS, layers)]
        }
        tables => {
            let mut one = |table| upload(make.device, queue, table, job.table_precision, &mut lookup);
            tables.iter().map(|table| view(binding_of(table), one(table))).collect()
        }
    };
    let lookup = make.filled("lookup", bytemuck::bytes_of(&lookup), wgpu::BufferUsages::UNIFORM);
    let entry = |binding, resource| wgpu::BindGroupEntry { binding, resource };
    let textures = textures.iter().map(|(binding, view)| entry(*binding, wgpu::BindingResource::TextureView(view)));
    let entries: Vec<_> = [entry(0, lookup.as_entire_binding())].into_iter().chain(textures).collect();
    make.device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some("tables"), layout, entries: &entries })
}

/// The binding of a table in bind group 2, by the number of its axes; 0 is [`Lookup`].
fn binding_of(table: &Table) -> u32 {
    table.axes().len() as u32 - 1
}

/// The binding of tables that are layers of one texture.
const LAYERS: u32 = 2;

/// Texels as a texture holds them, and how a shader decodes them.
struct Encoded {
    format: wgpu::TextureFormat,
    bytes: Vec<u8>,
    texel_bytes: u32,
    /// Value = low + range * texel.
    low: [f32; 4],
    range: [f32; 4],
}

/// Encodes a table of one channel as one, of more as four.
fn encode(table: &Table, precision: TablePrecision) -> Encoded {
    use wgpu::TextureFormat as Format;
    let given = table.spec().channels().len();
    let channels = if given == 1 { 1 } else { 4 };
    let (formats, bytes) = match precision {
        TablePrecision::U8 => ([Format::R8Unorm, Format::Rgba8Unorm], 1),
        TablePrecision::U16 => ([Format::R16Unorm, Format::Rgba16Unorm], 2),
        TablePrecision::F16 => ([Format::R16Float, Format::Rgba16Float], 2),
        TablePrecision::Auto | TablePrecision::F32 => ([Format::R32Float, Format::Rgba32Float], 4),
    };
    let mut encoded = Encoded {
        format: formats[usize::from(channels == 4)],
        bytes: Vec::with_capacity(table.texels().len() / given * channels * bytes as usize),
        texel_bytes: bytes * channels as u32,
        low: [0.0; 4],
        range: [1.0; 4],
    };
    let integer = matches!(precision, TablePrecision::U8 | TablePrecision::U16);
    if integer {
        for c in 0..given {
            let values = || table.texels().iter().skip(c).step_by(given).copied();
            let (low, high) = (values().fold(f32::INFINITY, f32::min), values().fold(f32::NEG_INFINITY, f32::max));
            (encoded.low[c], encoded.range[c]) = (low, high - low);
        }
    }
    for texel in table.texels().chunks_exact(given) {
        for c in 0..channels {
            let value = texel.get(c).copied().unwrap_or(0.0);
            // A channel of one value has no range, and decodes to it whatever is stored.
            let range = if encoded.range[c] > 0.0 { f64::from(encoded.range[c]) } else { 1.0 };
            let share = (f64::from(value) - f64::from(encoded.low[c])) / range;
            match precision {
                TablePrecision::U8 => encoded.bytes.push((share * 255.0).round() as u8),
                TablePrecision::U16 => encoded.bytes.extend(((share * 65535.0).round() as u16).to_ne_bytes()),
                TablePrecision::F16 => {
                    // The largest half instead of an infinity, which interpolation would make a NaN.
                    let limit = half::f16::MAX.to_f32();
                    encoded.bytes.extend(half::f16::from_f32(value.clamp(-limit, limit)).to_ne_bytes());
                }
                TablePrecision::Auto | TablePrecision::F32 => encoded.bytes.extend(value.to_ne_bytes()),
            }
        }
    }
    encoded
}

/// A table as a texture, with its decoding written to `lookup`, and its bytes.
fn upload(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    table: &Table,
    precision: TablePrecision,
    lookup: &mut Lookup,
) -> (wgpu::Texture, u64) {
    let encoded = encode(table, precision);
    let slot = table.axes().len() - 2;
    (lookup.low[slot], lookup.range[slot]) = (encoded.low, encoded.range);
    let dimension = if slot == 0 { wgpu::TextureDimension::D2 } else { wgpu::TextureDimension::D3 };
    let texture = texture(device, queue, &table.spec().id, table.spec().size, dimension, &encoded);
    (texture, encoded.bytes.len() as u64)
}

/// Up to four tables of two axes, one channel and one size as the layers of one texture, with their decoding in the
/// components of the first of `lookup`, and their bytes.
fn upload_layers(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    first: &Table,
    others: &[Arc<Table>],
    precision: TablePrecision,
    lookup: &mut Lookup,
) -> (wgpu::Texture, u64) {
    let [width, height, _] = first.spec().size;
    let mut all = encode(first, precision);
    (lookup.low[0][0], lookup.range[0][0]) = (all.low[0], all.range[0]);
    for (table, layer) in others.iter().zip(1..) {
        let encoded = encode(table, precision);
        (lookup.low[0][layer], lookup.range[0][layer]) = (encoded.low[0], encoded.range[0]);
        all.bytes.extend(encoded.bytes);
    }
    let size = [width, height, 1 + others.len() as u32];
    let texture = texture(device, queue, "widgets", size, wgpu::TextureDimension::D2, &all);
    (texture, all.bytes.len() as u64)
}

fn texture(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    label: &str,
    [width, height, depth]: [u32; 3],
    dimension: wgpu::TextureDimension,
    encoded: &Encoded,
) -> wgpu::Texture {
    let size = wgpu::Extent3d { width, height, depth_or_array_layers: depth };
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension,
        format: encoded.format,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let layout = wgpu::TexelCopyBufferLayout {
        offset: 0,
        bytes_per_row: Some(width * encoded.texel_bytes),
        rows_per_image: Some(height),
    };
    queue.write_texture(texture.as_image_copy(), &encoded.bytes, layout, size);
    texture
}

#[cfg(test)]
mod tests {
    use tetlux_tables::{Precision, TableKind, TableSpec};

    use super::*;

    /// The value of a texel, as the shader decodes it.
    fn decoded(encoded: &Encoded, index: usize, precision: TablePrecision) -> f32 {
        let at = index * encoded.texel_bytes as usize;
        let b = &encoded.bytes[at..];
        let stored = match precision {
            TablePrecision::U8 => f32::from(b[0]) / 255.0,
            TablePrecision::U16 => f32::from(u16::from_ne_bytes([b[0], b[1]])) / 65535.0,
            TablePrecision::F16 => half::f16::from_ne_bytes([b[0], b[1]]).to_f32(),
            _ => f32::from_ne_bytes([b[0], b[1], b[2], b[3]]),
        };
        encoded.low[0] + encoded.range[0] * stored
    }

    #[test]
    fn texels_are_what_the_table_of_that_precision_holds() {
        let spec = |precision| TableSpec { id: "t".into(), kind: TableKind::Psi, size: [40, 30, 1], precision };
        let singles = Table::build(&spec(Precision::F32)).unwrap();
        for (precision, same) in [
            (TablePrecision::U8, Precision::U8),
            (TablePrecision::U16, Precision::U16),
            (TablePrecision::F16, Precision::F16),
            (TablePrecision::F32, Precision::F32),
        ] {
            let table = Table::build(&spec(same)).unwrap();
            let encoded = encode(&singles, precision);
            assert_eq!(encoded.bytes.len(), 1200 * encoded.texel_bytes as usize);
            for (index, &value) in table.texels().iter().enumerate() {
                // Two roundings of values up to 1; a wrong step would be off by 1.5e-5 at least.
                let error = (decoded(&encoded, index, precision) - value).abs();
                assert!(error <= 2.0 * f32::EPSILON, "{precision} texel {index}: {error:e}");
            }
        }
    }

    #[test]
    fn halves_that_overflow_stay_finite() {
        let transfer = tetlux_tables::TransferSpec {
            color: vec![[0.0, 1.0, 1.0, 1.0]],
            opacity: vec![[0.0, 1.0]],
            range: [0.0, 1.0],
            unit_distance: 1e-6,
            max_length: 1.0,
        };
        let kind = TableKind::MeanExtinction { transfer };
        let spec = TableSpec { id: "t".into(), kind, size: [2, 2, 1], precision: Precision::F32 };
        let encoded = encode(&Table::build(&spec).unwrap(), TablePrecision::F16);
        for index in 0..4 {
            assert_eq!(decoded(&encoded, index, TablePrecision::F16), 65504.0);
        }
    }

    #[test]
    fn three_channels_are_stored_as_four() {
        let transfer = tetlux_tables::TransferSpec {
            color: vec![[0.0, 0.25, 0.5, 0.75]],
            opacity: vec![[0.0, 1.0]],
            range: [0.0, 1.0],
            unit_distance: 1.0,
            max_length: 1.0,
        };
        let kind = TableKind::ColorRatio { transfer };
        let table =
            Table::build(&TableSpec { id: "t".into(), kind, size: [2, 2, 2], precision: Precision::F32 }).unwrap();
        for precision in [TablePrecision::U8, TablePrecision::F32] {
            let encoded = encode(&table, precision);
            assert_eq!(encoded.bytes.len(), 8 * encoded.texel_bytes as usize);
            // One luminance throughout: it decodes to itself even where 8 bits have no step for it.
            for index in 0..8 {
                assert!((decoded(&encoded, index, precision) - 0.25).abs() < 1e-6);
            }
        }
    }
}
