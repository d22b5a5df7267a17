// The error function. Twins of the same names in Rust: tetlux-optics, erf_f32. No step makes an infinity or a NaN.
import package::lib::segment::{erfcx};

// erf(x) / x in x^2 for |x| < 0.5: 2/sqrt(pi) (-1)^n / (n! (2n + 1)).
const ERF_SMALL =
    array<f32, 7>(1.1283792, -0.37612639, 0.11283792, -0.026866171, 0.0052239776, -8.548327e-4, 1.2055333e-4);

// 1 - erf(x), for any x.
fn erfc(x: f32) -> f32 {
    let upper = exp(-x * x) * erfcx(abs(x));
    return select(upper, 2.0 - upper, x < 0.0);
}

// The error function, for any x.
fn erf(x: f32) -> f32 {
    let c = ERF_SMALL;
    if abs(x) < 0.5 {
        let y = x * x;
        return x * (c[0] + y * (c[1] + y * (c[2] + y * (c[3] + y * (c[4] + y * (c[5] + y * c[6]))))));
    }
    let beyond = 1.0 - erfc(abs(x));
    return select(beyond, -beyond, x < 0.0);
}

// Mean of exp(-t^2) from t0 to t1 >= t0, both finite.
fn gaussian_mean(t0: f32, t1: f32) -> f32 {
    let span = t1 - t0;
    if span * max(max(abs(t0), abs(t1)), 1.0) <= 0.5 {
        // Three nodes of Gauss and Legendre: a difference of erf would cancel.
        let middle = t0 + 0.5 * span;
        let low = middle - 0.38729833 * span;
        let high = middle + 0.38729833 * span;
        return (exp(-low * low) + exp(-high * high)) * (5.0 / 18.0) + exp(-middle * middle) * (8.0 / 18.0);
    }
    var difference: f32;
    // On one side of 0 both are close to 1.
    if t0 >= 0.0 || t1 <= 0.0 {
        difference = erfc(min(abs(t0), abs(t1))) - erfc(max(abs(t0), abs(t1)));
    } else {
        difference = erf(t1) - erf(t0);
    }
    return 0.88622695 * difference / span;
}
