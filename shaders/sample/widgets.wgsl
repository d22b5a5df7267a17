// Widgets at a point. The twin in Rust is tetlux-optics, widgets_f32.
import package::lib::widget::{widgets, track, track_rate};

// Colour and, in w, extinction per device unit at a point of normalised scalars: of several widgets the extinction-weighted
// mean colour.
fn classify(at: vec2<f32>) -> vec4<f32> {
    var sum = vec4<f32>(0.0);
    for (var i = 0u; i < arrayLength(&widgets); i++) {
        let t = track(i, at, at, 1.0);
        if t.begin < t.end {
            let rate = track_rate(t, 0.0);
            sum += vec4<f32>(widgets[i].color.rgb * rate, rate);
        }
    }
    if sum.w > 0.0 {
        return vec4<f32>(sum.rgb / sum.w, sum.w);
    }
    return sum;
}
