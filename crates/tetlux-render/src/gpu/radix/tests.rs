//! Sorts and sums on the driver against those of the standard library.

use std::sync::OnceLock;

use super::*;
use crate::gpu::Gpu;

fn open() -> &'static (Open, Radix) {
    static OPEN: OnceLock<(Open, Radix)> = OnceLock::new();
    OPEN.get_or_init(|| {
        let gpu = Gpu::find().unwrap_or_else(|| panic!("these tests need a driver (a software one will do)"));
        let open = gpu.open().unwrap();
        let radix = Radix::new(&open.device).unwrap();
        (open, radix)
    })
}

fn order(keys: &[u32], bits: u32) -> Vec<u32> {
    let (open, radix) = open();
    radix.order(open, keys, bits).unwrap()
}

/// A generator of even bits (Steele, Lea and Flood 2014).
fn noise(count: usize, seed: u64) -> Vec<u32> {
    let number = |i: u64| {
        let mut z = (seed + i).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) as u32
    };
    (0..count as u64).map(number).collect()
}

#[test]
fn pairs_are_sorted_stably() {
    // Around the sizes of rows and blocks, none of them a multiple; and more counts than one block of a scan sums up.
    for count in [0, 1, 2, 31, 255, 256, 257, 4095, 4096, 4097, 20_011, 300_007] {
        let random = noise(count, 7);
        let ascending: Vec<u32> = (0..count as u32).collect();
        let few: Vec<u32> = random.iter().map(|key| key % 3 * 0x4000_0000).collect();
        for (what, keys, bits) in [
            ("any", random.clone(), 32),
            ("as many as tiles", random.iter().map(|key| key % 2500).collect(), 12),
            ("of nine bits", random.iter().map(|key| key % 512).collect(), 9),
            ("of one bit", random.iter().map(|key| key % 2).collect(), 1),
            ("ascending", ascending.clone(), 20),
            ("descending", ascending.into_iter().rev().collect(), 20),
            ("equal", vec![0xffff_ffff; count], 32),
            ("of three kinds", few, 32),
        ] {
            let mut expected: Vec<u32> = (0..count as u32).collect();
            expected.sort_by_key(|&i| keys[i as usize]);
            assert!(order(&keys, bits) == expected, "{count} keys, {what}");
        }
    }
}

#[test]
fn keys_of_no_bits_stay_where_they_are() {
    assert_eq!(order(&[5, 3, 4], 0), [0, 1, 2]);
    // And a bit that is not among those sorted by is not looked at: a comparison would find it.
    assert_eq!(order(&[5, 3, 4], 2), [2, 0, 1]);
}

#[test]
fn depths_are_sorted_by_their_bits() {
    // Positive floats ascend as their bits do.
    let depths: Vec<f32> = noise(5000, 3).into_iter().map(|bits| f32::from_bits(bits >> 2)).collect();
    let keys: Vec<u32> = depths.iter().map(|depth| depth.to_bits()).collect();
    let values = order(&keys, 32);
    assert!(values.windows(2).all(|pair| depths[pair[0] as usize] <= depths[pair[1] as usize]));
}

#[test]
fn sums_leave_out_their_own_number() {
    // The last takes three levels.
    for count in [0, 1, 255, 1023, 1024, 1025, 70_000, 1_100_003] {
        let (Open { device, queue, .. }, radix) = open();
        let make = Maker::new(device, Resources::default());
        let items: Vec<u32> = noise(count, 11).into_iter().map(|bits| bits % 1000).collect();
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST;
        let buffer = make.empty("items", (count.max(1) * 4) as u64, usage);
        queue.write_buffer(&buffer, 0, bytemuck::cast_slice(&items));
        let mut encoder = device.create_command_encoder(&Default::default());
        radix.scan.run(&make, &mut encoder, &buffer, count as u32);
        let readback = make.empty("sums", buffer.size(), wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST);
        encoder.copy_buffer_to_buffer(&buffer, 0, &readback, 0, buffer.size());
        queue.submit([encoder.finish()]);
        let sums: Vec<u32> = bytemuck::pod_collect_to_vec(&mapped(device, &readback).unwrap());
        let mut sum = 0;
        for (i, item) in items.iter().enumerate() {
            assert_eq!(sums[i], sum, "number {i} of {count}");
            sum += item;
        }
    }
}
