// The linear closed form of Williams, Max and Stein 1998, for comparison only: it is not stable.
//
// a = tau_b D and b = tau_f D as in lib::segment. Off by any amount for thin, dense and nearly constant segments;
// exponents are limited and the weights clamped to [0, 1], so that no infinity or NaN is made. The twin in Rust is
// tetlux-optics, published_f32.
import package::lib::segment::{clean, dawson, erfcx, opacity};

// Largest exponent of a power: the product with the largest factor here stays finite.
const MAX_EXPONENT = 60.0;

// The published form's factors sqrt(pi) and 2/sqrt(pi).
const ROOT_PI = 1.7724539;
const TWO_OVER_ROOT_PI = 1.1283792;

// erf(x) for x >= 0.
fn erf_published(x: f32) -> f32 {
    return 1.0 - exp(-x * x) * erfcx(x);
}

// erf(i x) / i for x >= 0, not beyond the limit of exponents.
fn erfi_published(x: f32) -> f32 {
    return TWO_OVER_ROOT_PI * exp(min(x * x, MAX_EXPONENT)) * dawson(x);
}

// Mean transmittance to the front by the published form, for cleaned a, b.
fn psi_published(a: f32, b: f32) -> f32 {
    if a == b {
        return opacity(a) / max(a, 1e-30);
    }
    let r = sqrt(max(2.0 * abs(a - b), 1e-30));
    let p = b / r;
    let t = a / r;
    if a > b {
        return ROOT_PI / r * exp(min(p * p, MAX_EXPONENT)) * (erf_published(t) - erf_published(p));
    }
    return ROOT_PI / r * exp(-p * p) * (erfi_published(p) - erfi_published(t));
}

// (alpha, w_b, w_f) by the published form, each in [0, 1] but otherwise with any error, for any a, b.
fn linear_published(a: f32, b: f32) -> vec3<f32> {
    let back = clean(a);
    let front = clean(b);
    let zeta = exp(-0.5 * (back + front));
    let psi = psi_published(back, front);
    return vec3<f32>(1.0 - zeta, clamp(psi - zeta, 0.0, 1.0), clamp(1.0 - psi, 0.0, 1.0));
}
