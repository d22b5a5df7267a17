// Interpolation over a triangle of the picture, from its vertices' own places.
//
// Rasterisers interpolate too; but they round vertices to 1/256 pixel, and compute what they interpolate from its value at
// the picture's corner, in single precision. Where a cell is seen some pixels wide this leaves four digits.
import package::lib::silhouette::{cross2};

// What counts as no area, of places in pixels.
const NO_AREA = 1e-12;

// The shares of the vertices a, b and c in what is interpolated at p: negative beyond the edge opposite. Of a triangle without
// area all are.
fn shares_of(p: vec2<f32>, a: vec2<f32>, b: vec2<f32>, c: vec2<f32>) -> vec3<f32> {
    let ab = b - a;
    let ac = c - a;
    let area = cross2(ab, ac);
    if !(abs(area) > NO_AREA) {
        return vec3<f32>(-1.0);
    }
    let share_b = cross2(p - a, ac) / area;
    let share_c = cross2(ab, p - a) / area;
    return vec3<f32>(1.0 - share_b - share_c, share_b, share_c);
}
