// What balanced cell projection (Moreland and Angel 2004, section 3.1) knows of a cell besides its vertices: for each of
// these where its ray meets the face opposite. The ray meets the other three faces in the vertex itself.
struct Balanced {
    // By how much the inverse depth at the vertex exceeds the one at the opposite face (orthographic: the depth falls
    // short), per device unit: positive if the face is a back face, negative if it is a front face. Four front faces mean
    // a cell to be drawn as a whole; four zeros one that is not seen.
    distances: vec4<f32>,
    // The scalar at the opposite face, times the inverse depth there if perspective.
    scalars: vec4<f32>,
}

// A bit for each front face.
fn balanced_fronts(balanced: Balanced) -> u32 {
    let bits = select(vec4<u32>(0u), vec4<u32>(1u, 2u, 4u, 8u), balanced.distances < vec4<f32>(0.0));
    return bits.x | bits.y | bits.z | bits.w;
}
