// The weights of a ray segment without division, table or gather: for compute and for processors without fast division.
//
// With x = (a + b)/2, e = (a - b)/2 and E = exp(-x/2): alpha = 2 E sinh(x/2), w_b - w_f = E F(x^2, e); F is entire and
// even in x. Symbols as in lib::segment. Every function here has a twin of the same name in Rust (tetlux-optics,
// symmetric_f32), line by line. No step makes an infinity or a NaN, whatever the inputs.
import package::lib::segment::{clean, horner4, horner5, horner6, weights_direct};

// 8 terms for x <= 0.5, error 8.9e-7 of alpha: e^1.., then x^2 e^0.., then x^4.
const SHIFT_8_0 = array<f32, 4>(0.33333245, 0.033333275, 0.0023903833, 1.3216006e-4);
const SHIFT_8_1 = array<f32, 3>(-0.16666563, 0.008352269, 5.974582e-4);
const SHIFT_8_2 = -0.004180521;

// 15 terms for x <= 1, error 1.9e-8 of alpha: e^1.., then x^2 e^0.., x^4 e^0.., x^6.
const SHIFT_15_0 = array<f32, 6>(0.33333334, 0.033333328, 0.0023808074, 1.3228777e-4, 6.0855546e-6, 2.3003716e-7);
const SHIFT_15_1 = array<f32, 5>(-0.16666669, 0.008333145, 5.9520657e-4, 3.3383665e-5, 1.5055925e-6);
const SHIFT_15_2 = array<f32, 3>(-0.004166474, 7.491231e-5, 4.1784674e-6);
const SHIFT_15_3 = -3.754286e-5;

// 19 terms for x <= 3, error 5.2e-6 of alpha: e^1.., then x^2 e^0.., x^4 e^0.., x^6 e^0...
const SHIFT_19_0 =
    array<f32, 7>(0.33333325, 0.03333451, 0.0023810465, 1.3196279e-4, 6.0035845e-6, 2.480651e-7, 8.142434e-9);
const SHIFT_19_1 = array<f32, 6>(-0.16667941, 0.008333603, 5.9413724e-4, 3.3007e-5, 1.6031001e-6, 6.097493e-8);
const SHIFT_19_2 = array<f32, 4>(-0.004154674, 7.427586e-5, 4.3827526e-6, 1.9910162e-7);
const SHIFT_19_3 = array<f32, 2>(-3.9937688e-5, 3.645473e-7);

// 2 sinh(x/2) = x (c_0 + c_1 x^2 + ..), x <= 3. Relative error 1.5e-8.
const TWO_SINH_HALF = array<f32, 6>(1.0, 0.041666668, 5.2083336e-4, 3.1001985e-6, 1.0764578e-8, 2.446495e-11);

// Beyond this extinction times length at an end, cutting costs more than weights_direct.
const MAX_CUT = 24.0;

fn horner1(c: array<f32, 2>, x: f32) -> f32 {
    return c[0] + x * c[1];
}

fn horner2(c: array<f32, 3>, x: f32) -> f32 {
    return c[0] + x * (c[1] + x * c[2]);
}

fn horner3(c: array<f32, 4>, x: f32) -> f32 {
    return c[0] + x * (c[1] + x * (c[2] + x * c[3]));
}

// F for x <= 0.5, |e| <= x; x2 is x^2.
fn shift_8(x2: f32, e: f32) -> f32 {
    return e * horner3(SHIFT_8_0, e) + x2 * (horner2(SHIFT_8_1, e) + x2 * SHIFT_8_2);
}

// F for x <= 1, |e| <= x; x2 is x^2.
fn shift_15(x2: f32, e: f32) -> f32 {
    return e * horner5(SHIFT_15_0, e) + x2 * (horner4(SHIFT_15_1, e) + x2 * (horner2(SHIFT_15_2, e) + x2 * SHIFT_15_3));
}

// F for x <= 3, |e| <= x; x2 is x^2.
fn shift_19(x2: f32, e: f32) -> f32 {
    let high = horner3(SHIFT_19_2, e) + x2 * horner1(SHIFT_19_3, e);
    return e * horner6(SHIFT_19_0, e) + x2 * (horner5(SHIFT_19_1, e) + x2 * high);
}

// F by the smallest of the fits that holds.
fn shift(x: f32, e: f32) -> f32 {
    if x <= 0.5 {
        return shift_8(x * x, e);
    }
    if x <= 1.0 {
        return shift_15(x * x, e);
    }
    return shift_19(x * x, e);
}

// (alpha, w_b, w_f) of a segment of optical depth x = (a + b)/2 <= 3, for cleaned a, b.
fn weights_symmetric_thin(a: f32, b: f32) -> vec3<f32> {
    let x = 0.5 * (a + b);
    let half = exp(-0.5 * x);
    let alpha = half * x * horner5(TWO_SINH_HALF, x * x);
    let difference = half * shift(x, 0.5 * (a - b));
    return vec3<f32>(alpha, 0.5 * (alpha + difference), 0.5 * (alpha - difference));
}

// The same of a denser segment, cut into equal pieces that are each at most 3 at either end.
fn weights_symmetric_cut(a: f32, b: f32) -> vec3<f32> {
    let count = ceil(max(a, b) / 3.0);
    let width = 1.0 / count;
    var transmittance = 1.0;
    var alpha = 0.0;
    var w_b = 0.0;
    var w_f = 0.0;
    var near = 0.0;
    // By pieces, whose depths are a and b there times the width; near and far are the distances of their ends.
    while near < count {
        let far = near + 1.0;
        let back = (b * (count - far) + a * far) * width * width;
        let front = (b * (count - near) + a * near) * width * width;
        let part = weights_symmetric_thin(back, front);
        w_b += transmittance * (near * part.x + part.y) * width;
        w_f += transmittance * ((count - far) * part.x + part.z) * width;
        alpha += transmittance * part.x;
        transmittance *= exp(-0.5 * (back + front));
        near = far;
    }
    return vec3<f32>(alpha, w_b, w_f);
}

// (alpha, w_b, w_f): opacity and the weights of the back and front luminance, for any a, b.
fn weights_symmetric(a: f32, b: f32) -> vec3<f32> {
    let back = clean(a);
    let front = clean(b);
    if back + front <= 6.0 {
        return weights_symmetric_thin(back, front);
    }
    if max(back, front) <= MAX_CUT {
        return weights_symmetric_cut(back, front);
    }
    return weights_direct(back, front);
}
