//! The pairs, as data: each an artifact of the literature beside what cures it.

use tetlux_scene::{Classification, Integrator, Interpolation, Method, Order, TablePrecision, Target};

use super::meshes::{Setting, cube, graded_cube, log_radius, long_cells};

/// One half of a pair: its name, and the method as a change of the default.
pub(super) type Half = (&'static str, fn(&mut Method));

pub(super) struct Case {
    /// Of the file.
    pub(super) name: &'static str,
    pub(super) title: &'static str,
    pub(super) source: &'static str,
    /// What is to be seen.
    pub(super) shows: &'static str,
    pub(super) setting: Setting,
    /// Left, top and side of the inset, in parts of the picture's side.
    pub(super) inset: [f32; 3],
    /// Contrast of the inset.
    pub(super) gain: f32,
    pub(super) artifact: Half,
    pub(super) cure: Half,
}

/// Seen from here, a ray crosses a hundred cells and more.
const HAZE: Setting = Setting {
    mesh: cube::<40>,
    field: |p| p.length(),
    color: &[[0.0, 1.0, 0.9, 0.5], [0.6, 0.9, 0.35, 0.15], [1.1, 0.15, 0.35, 0.9], [1.8, 0.05, 0.1, 0.5]],
    opacity: &[[0.0, 1.2], [0.6, 0.5], [0.9, 0.15], [1.8, 0.08]],
    unit_distance: 1.0,
    eye: [2.2, -5.4, 1.7],
    focus: [0.0, 0.0, 0.0],
    view_angle: 27.0,
};

pub(super) const CASES: &[Case] = &[
    Case {
        name: "perspective",
        title: "Interpolation in perspective",
        source: "Kraus, Qiao and Ebert 2004, figure 8",
        shows: "Flat sheets through large cells near the eye. Linear in the picture, they bend in every cell and break at its edges.",
        setting: Setting {
            mesh: cube::<2>,
            field: |p| p.y + 0.35 * p.x + 0.2 * p.z,
            color: &[[-1.55, 0.1, 0.35, 1.0], [-0.2, 0.15, 0.9, 0.5], [0.3, 1.0, 0.8, 0.2], [1.55, 1.0, 0.2, 0.1]],
            opacity: &[
                [-1.1, 0.0],
                [-1.06, 14.0],
                [-1.02, 0.0],
                [-0.5, 0.0],
                [-0.46, 14.0],
                [-0.42, 0.0],
                [0.1, 0.0],
                [0.14, 14.0],
                [0.18, 0.0],
                [0.7, 0.0],
                [0.74, 14.0],
                [0.78, 0.0],
            ],
            unit_distance: 1.0,
            eye: [1.75, -0.7, 0.75],
            focus: [-0.1, -0.1, 0.0],
            view_angle: 80.0,
        },
        inset: [0.68, 0.3, 0.25],
        gain: 1.2,
        artifact: ("screen-linear", |m| m.interpolation = Interpolation::ScreenLinear),
        cure: ("perspective", |m| m.interpolation = Interpolation::Perspective),
    },
    Case {
        name: "table-precision",
        title: "Precision of tables",
        source: "Kraus, Qiao and Ebert 2004, figure 7 (a)",
        shows: "Haze round an opaque core, pre-integrated. The opacity of a cell in the haze is about one of the 255 steps \
                that the core's range is cut into: colours are lost, and rings appear.",
        setting: Setting { opacity: &[[0.0, 40.0], [0.25, 40.0], [0.3, 0.5], [0.9, 0.15], [1.8, 0.08]], ..HAZE },
        inset: [0.15, 0.3, 0.3],
        gain: 1.5,
        artifact: ("preint, u8", |m| {
            m.integrator = Integrator::Preint;
            m.table_precision = TablePrecision::U8;
        }),
        cure: ("preint, u16", |m| {
            m.integrator = Integrator::Preint;
            m.table_precision = TablePrecision::U16;
        }),
    },
    Case {
        name: "target-precision",
        title: "Precision of the target",
        source: "Kraus, Qiao and Ebert 2004, figure 7 (b)",
        shows: "Faint haze. 8 bits round after each of a hundred cells: what is less than half a step is lost, what is more \
                is a whole one, and bands follow the grid.",
        setting: HAZE,
        inset: [0.15, 0.3, 0.3],
        gain: 1.5,
        artifact: ("rgba8", |m| m.target = Target::Rgba8),
        cure: ("rgba16f", |m| m.target = Target::Rgba16f),
    },
    Case {
        name: "dithering",
        title: "Dithered alpha",
        source: "Kraus, Qiao and Ebert 2004, figure 9",
        shows: "Fainter haze of pure colours, most cells of which are less than half of an 8-bit step. Rounded at random, the \
                alpha of each is right in the mean: what was lost is seen, with noise. Colours that are not pure lose as \
                before, since blending rounds again, as the authors say.",
        setting: Setting {
            color: &[[0.0, 1.0, 1.0, 0.0], [0.65, 1.0, 1.0, 0.0], [0.7, 0.0, 1.0, 1.0], [1.8, 0.0, 1.0, 1.0]],
            opacity: &[[0.0, 0.16], [0.6, 0.12], [0.9, 0.06], [1.8, 0.03]],
            ..HAZE
        },
        inset: [0.15, 0.3, 0.3],
        gain: 1.5,
        artifact: ("rgba8", |m| m.target = Target::Rgba8),
        cure: ("rgba8-dither", |m| m.target = Target::Rgba8Dither),
    },
    Case {
        name: "thickness-axis",
        title: "Axis of thickness",
        source: "Kraus, Qiao and Ebert 2004, figure 10",
        shows: "A shell in small cells of a mesh whose edges range from 1e-5 to 1. All of its cells are thinner than the first of 64 equal steps, and opaque at it.",
        setting: Setting {
            mesh: graded_cube,
            field: log_radius,
            color: &[[0.0, 1.0, 0.6, 0.1], [0.5, 1.0, 0.5, 0.1], [0.56, 0.2, 0.6, 1.0], [1.2, 0.2, 0.6, 1.0]],
            opacity: &[[0.0, 0.0], [0.47, 0.0], [0.5, 900.0], [0.53, 0.0], [1.0, 0.001], [1.2, 0.001]],
            unit_distance: 1.0,
            eye: [0.006, -0.014, 0.005],
            focus: [0.0, 0.0, 0.0],
            view_angle: 40.0,
        },
        inset: [0.35, 0.35, 0.25],
        gain: 1.0,
        artifact: ("preint, 64 equal steps", |m| m.integrator = Integrator::Preint),
        cure: ("preint-log, 16 doubling steps", |m| m.integrator = Integrator::PreintLog),
    },
    Case {
        name: "sampling",
        title: "Adaptive sampling",
        source: "Moreland and Angel 2004, figure 3",
        shows: "A sharp sphere in large cells. Classified at the vertices alone, it is what the mesh makes of it.",
        setting: Setting {
            mesh: cube::<12>,
            field: |p| p.length(),
            color: &[[0.0, 1.0, 0.7, 0.2], [0.75, 1.0, 0.45, 0.1], [0.85, 0.2, 0.4, 0.9], [1.8, 0.1, 0.2, 0.6]],
            opacity: &[[0.0, 0.1], [0.72, 0.1], [0.75, 25.0], [0.78, 0.1], [1.8, 0.05]],
            unit_distance: 1.0,
            eye: [2.2, -5.4, 1.7],
            focus: [0.0, 0.0, 0.0],
            view_angle: 24.0,
        },
        inset: [0.2, 0.25, 0.25],
        gain: 1.0,
        artifact: ("vertex", |m| m.classification = Classification::Vertex),
        cure: ("post-clip", |m| m.classification = Classification::PostClip),
    },
    Case {
        name: "pre-integration",
        title: "Partial pre-integration",
        source: "Moreland and Angel 2004, figure 8",
        shows: "A block whose outermost layer of cells fades from yellow to blue, ten optical depths deep. The mean luminance \
                of a segment takes as much of its far end as of its near one: blue bleeds through the yellow.",
        setting: Setting {
            mesh: cube::<5>,
            field: |p| p.abs().max_element(),
            color: &[[0.0, 0.02, 0.1, 1.0], [0.6, 0.02, 0.1, 1.0], [1.0, 1.0, 0.75, 0.02]],
            opacity: &[[0.0, 25.0], [1.0, 25.0]],
            unit_distance: 1.0,
            eye: [2.6, -4.8, 2.2],
            focus: [0.0, 0.0, 0.0],
            view_angle: 30.0,
        },
        inset: [0.35, 0.4, 0.25],
        gain: 1.5,
        artifact: ("average", |m| m.integrator = Integrator::Average),
        cure: ("psi", |m| m.integrator = Integrator::Psi),
    },
    Case {
        name: "order",
        title: "Order of cells",
        source: "centroids as in Shirley and Tuchman 1990; exact order after Williams 1992 and Cook et al. 2004",
        shows: "Stripes across cells twenty times as long as wide, as they are near walls. A far cell whose centroid is \
                nearer is drawn over a near one.",
        setting: Setting {
            mesh: long_cells,
            field: |p| (5.0 * p.y).sin() + (4.0 * p.z + p.x).sin(),
            color: &[
                [-2.0, 0.1, 0.2, 0.9],
                [-0.6, 0.1, 0.8, 0.7],
                [0.1, 1.0, 0.9, 0.5],
                [0.8, 1.0, 0.4, 0.1],
                [2.0, 0.7, 0.05, 0.1],
            ],
            opacity: &[[-2.0, 12.0], [-0.5, 4.0], [0.5, 4.0], [2.0, 12.0]],
            unit_distance: 1.0,
            eye: [4.4, -2.6, 1.7],
            focus: [0.0, 0.0, 0.0],
            view_angle: 34.0,
        },
        inset: [0.08, 0.4, 0.25],
        gain: 1.5,
        artifact: ("centroid", |m| m.order = Order::Centroid),
        cure: ("exact", |m| m.order = Order::Exact),
    },
];
