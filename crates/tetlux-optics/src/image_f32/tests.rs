use super::*;
use crate::accuracy::Random;
use crate::segment::weights;

/// A random image, and the range it spans.
fn random_image(random: &mut Random) -> ImageFunction {
    let [width, height] = [0; 2].map(|_| 2 + (6.0 * random.unit()) as usize);
    let texels = (0..width * height)
        .map(|_| {
            let mut unit = || random.unit() as f32;
            let opacity = if unit() < 0.3 { 0.0 } else { 6.0 * unit() };
            [unit(), unit(), unit(), opacity]
        })
        .collect();
    ImageFunction::new(width, texels, [[-1.0, 2.0], [10.0, 12.0]]).unwrap()
}

/// In f64: so many pieces that their linear ends do not matter.
fn exact(image: &ImageFunction, front: [f64; 2], back: [f64; 2], length: f64) -> [f64; 4] {
    const PIECES: usize = 4000;
    let at = |k: usize| {
        let u = k as f64 / PIECES as f64;
        image.at([0, 1].map(|axis| front[axis] * (1.0 - u) + back[axis] * u))
    };
    let mut result = [0.0; 4];
    let mut near = at(0);
    for k in 1..=PIECES {
        let far = at(k);
        let part = length / PIECES as f64;
        let w = weights(far[3] * part, near[3] * part);
        let through = 1.0 - result[3];
        for channel in 0..3 {
            result[channel] += through * (near[channel] * w.front + far[channel] * w.back);
        }
        result[3] += through * w.alpha;
        near = far;
    }
    result
}

#[test]
fn the_bound_holds() {
    let mut random = Random::new(8);
    let mut worst = [0.0_f64; 3];
    for _ in 0..150 {
        let function = random_image(&mut random);
        // The fields' ranges reach beyond the image's.
        let ranges = [[-2.0, 3.0], [9.0, 13.0]];
        let device = image(&function, ranges, 1.0);
        let ends = [0; 2].map(|_| [random.unit() as f32, random.unit() as f32]);
        let length = random.decades(-1.0, 0.5);
        let place = |p: [f32; 2]| [0, 1].map(|k| ranges[k][0] + (ranges[k][1] - ranges[k][0]) * f64::from(p[k]));
        let exact = exact(&function, place(ends[0]), place(ends[1]), f64::from(length));
        for (k, bound) in [1e-2, 1e-3, 1e-4].into_iter().enumerate() {
            let got = integrate(&device, ends[0], ends[1], length, bound as f32);
            let error = (0..3).map(|c| (f64::from(got[c]) - exact[c]).abs()).fold(0.0, f64::max);
            // Second order in 1/4000 of the truth here, and the rounding of places.
            assert!(error <= bound + 1e-5, "{error:e} for {bound:e}");
            assert!((f64::from(got[3]) - exact[3]).abs() < 1e-5, "{got:?} {exact:?}");
            worst[k] = worst[k].max(error / bound);
        }
    }
    println!("largest error / bound: {worst:?}");
    assert!(worst[2] > 1e-3, "something was tested");
}

#[test]
fn a_constant_image_is_a_slab() {
    for size in [1, 2, 5] {
        let texels = vec![[0.5, 1.0, 0.25, 2.0]; size * size];
        let function = ImageFunction::new(size, texels, [[0.0, 1.0]; 2]).unwrap();
        let device = image(&function, [[-1.0, 2.0]; 2], 1.5);
        for (front, back) in [([0.0; 2], [1.0; 2]), ([0.5; 2], [0.5; 2]), ([1.0, 0.3], [0.0, 0.3])] {
            let got = integrate(&device, front, back, 0.5, 1e-3);
            let alpha = 1.0 - (-1.5_f64).exp();
            assert!((f64::from(got[3]) - alpha).abs() < 2e-6 && (f64::from(got[0]) - 0.5 * alpha).abs() < 2e-6);
        }
    }
}
