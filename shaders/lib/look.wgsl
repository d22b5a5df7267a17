// What a scene of two fields or with light says once for all segments.

struct Look {
    // The light: ambient, diffuse, specular, shininess.
    shares: vec4<f32>,
    // Unit vector to the light in eye space; 0 if it is at the eye.
    direction: vec3<f32>,
    // Exponent of the silhouette.
    silhouette: f32,
    // Errors of the colour and of the light of a segment, for an opacity of 1.
    errors: vec2<f32>,
    // Bounds of the lit luminance's slope and curvature over the normal's angle.
    slope: f32,
    curvature: f32,
    // Place on the grid of an image function of a normalised scalar p: p scale + origin.
    scale: vec2<f32>,
    origin: vec2<f32>,
    // Texels of the image along each axis.
    size: vec2<u32>,
    // Of two lists of pieces, how many are in the first.
    color_pieces: u32,
    // Of the published modes: equal pieces a segment; unit distances per device unit; the length in device units that is 1 in
    // the table.
    pieces: u32,
    emission: f32,
    unit: f32,
    unused: vec2<f32>,
    // Luminance and extinction per device unit of cells without data.
    no_data: vec4<f32>,
}

@group(0) @binding(10) var<storage, read> look: Look;
