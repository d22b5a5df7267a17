//! Pictures by instruction set, group, size and error budget, and against the shaders' twin.

use std::sync::Arc;

use glam::{DVec3, Vec2, Vec3};
use tetlux_mesh::procedural::{Split, cuboid, three_cycle};
use tetlux_mesh::{Component, Field, TetMesh};
use tetlux_optics::Classification;
use tetlux_optics::transfer::{ColorNode, OpacityNode, TransferFunction};
use tetlux_optics::transfer_f32::{Weights, integrate, piece_at, pieces};
use tetlux_reference::{Caster, Ray};
use tetlux_scene::{Camera, Method, Projection, Scene, SkipSet, TablePrecision, View};

use super::*;
use crate::cell::Kind;
use crate::device_mesh::{DeviceMesh, NEGATIVE, ascending};
use crate::device_view::DeviceView;
use crate::eye_space::EyeSpace;
use crate::instructions::Instructions;
use crate::lens::Lens;
use crate::opaque;

/// Share of the allowed error that may lie behind opaque pixels.
const HIDDEN_ERROR: f64 = 1e-3;

/// Single precision against double: positions, scalars and weights are each good to some 1e-6.
const EXACT: f64 = 1e-5;

/// Roundings apart: fused or not, and the sums of some twenty segments.
const ROUNDING: f64 = 3e-6;

/// What a picture is drawn from, owned.
struct Drawing {
    mesh: TetMesh,
    transfer: TransferFunction,
    scene: Scene,
    view: View,
    device: Arc<DeviceMesh>,
}

impl Drawing {
    fn new(mesh: TetMesh, transfer: TransferFunction, camera: Camera, size: [u32; 2]) -> Drawing {
        let scalar = mesh.scalar("s", Component::Magnitude).unwrap();
        let (background, method) = ([0.0; 3], Method::default());
        let classification = Classification::OneField(transfer.clone());
        let (second, lighting, emphasis, unit_distance) = (None, None, None, 1.0);
        let surfaces = Vec::new();
        let scene = Scene {
            scalar,
            second,
            no_data: tetlux_optics::NoData::default(),
            classification,
            lighting,
            emphasis,
            surfaces,
            unit_distance,
            camera,
            size,
            background,
            method,
        };
        let view = scene.camera.view(size).unwrap();
        let device = Arc::new(DeviceMesh::new(&mesh, &scene.scalar, &[]));
        Drawing { mesh, transfer, scene, view, device }
    }

    fn draw(&self, level: Level, order: &[u32], groups: &[Range<u32>], max_error: f64) -> Vec<[f32; 4]> {
        let job = Job {
            mesh: &self.device,
            cells: self.mesh.cells(),
            scalar: &self.scene.scalar,
            view: self.lens().view,
            eye: EyeSpace::new(&self.view, &self.mesh, &self.device),
            pieces: &self.pieces(),
            attributes: &[],
            weights: Weights::Direct,
            look: None,
            order,
            groups,
            entry_pieces: &[],
            tables: &[],
            table_precision: TablePrecision::F32,
            table_length: 1.0,
            seen: &[],
            march: None,
            backdrop: None,
            opaque: opaque(HIDDEN_ERROR * max_error, &self.pieces(), None, None),
            kept: SkipSet::default(),
            size: self.view.size,
        };
        draw(level, &job, &Room::default(), &mut Stages::default()).0
    }

    /// Every pixel sorted.
    fn sorted(&self, level: Level) -> Vec<[f32; 4]> {
        let order = self.all();
        let group = 0..order.len() as u32;
        self.draw(level, &order, std::slice::from_ref(&group), 1e-3)
    }

    fn all(&self) -> Vec<u32> {
        (0..self.mesh.cells().len() as u32).collect()
    }

    fn lens(&self) -> Lens {
        let orthographic = self.view.orthographic;
        Lens { view: DeviceView::new(&self.view, &self.mesh, &self.device), orthographic }
    }

    fn pieces(&self) -> Vec<tetlux_optics::transfer_f32::Piece> {
        pieces(&self.transfer, self.scene.scalar.range, 1.0 / self.device.scale)
    }

    /// The truth.
    fn reference(&self) -> Vec<[f64; 4]> {
        let caster = Caster::new(tetlux_reference::Scene {
            mesh: &self.mesh,
            scalar: &self.scene.scalar,
            second: None,
            classification: &self.scene.classification,
            lighting: None,
            colors: None,
            unit_distance: self.scene.unit_distance,
            tolerance: 1e-8,
        });
        let ray = |x: u32, y: u32| {
            let (origin, direction) = self.view.ray(f64::from(x) + 0.5, f64::from(y) + 0.5);
            Ray { origin, direction, start: self.view.near, end: f64::INFINITY }
        };
        caster.unwrap().render(self.view.size[0], self.view.size[1], ray, |_| ())
    }

    /// The picture that the shaders' twin makes, every pixel sorted.
    fn twin(&self) -> Vec<[f32; 4]> {
        let (lens, pieces) = (self.lens(), self.pieces());
        let seen = EyeSpace::new(&self.view, &self.mesh, &self.device).seen(&self.device);
        let [width, height] = self.view.size;
        let pixel = |index: u32| {
            let [x, y] =
                [(index % width, width), (index / width, height)].map(|(i, n)| i as f32 + 0.5 - n as f32 * 0.5);
            let mut fragments: Vec<(f32, [f32; 4])> = Vec::new();
            for names in self.mesh.cells().iter().map(|&cell| ascending(cell)) {
                let points = names.map(|v| self.device.points[(v & !NEGATIVE) as usize]);
                let vertices = names.map(|v| {
                    let v = (v & !NEGATIVE) as usize;
                    let [x, y, z, _] = self.device.points[v];
                    lens.vertex(Vec3::new(x, y, z), &seen[v])
                });
                let scalars = points.map(|p| p[3]);
                let cell = lens.project_cell(&vertices, scalars, if names[0] & NEGATIVE == 0 { 1.0 } else { -1.0 });
                if cell.kind == Kind::Hidden {
                    continue;
                }
                let at = Vec2::new(x, y);
                let [low, high] = lens.pixel_bounds(&vertices, cell.kind);
                let reference = lens.cell_reference(&vertices, scalars, cell.kind);
                let range = reference.s.map(|s| piece_at(&pieces, s));
                if at.cmpge(low - 0.03).all()
                    && at.cmple(high + 0.03).all()
                    && let Some(s) = lens.cell_segment(&cell, &reference, at)
                {
                    let color = integrate(&pieces, range, Weights::Direct, s.s_front, s.s_back, s.length);
                    fragments.push((s.depth, color));
                }
            }
            fragments.sort_by(|a, b| a.0.total_cmp(&b.0));
            fragments.iter().fold([0.0; 4], |pixel: [f32; 4], (_, color)| {
                std::array::from_fn(|i| pixel[i] + (1.0 - pixel[3]) * color[i])
            })
        };
        (0..width * height).map(pixel).collect()
    }
}

fn camera(position: DVec3, focal_point: DVec3, projection: Projection) -> Camera {
    Camera { position, focal_point, view_up: DVec3::Z, projection, near: 0.0 }
}

fn transfer(color: &[[f64; 4]], opacity: &[[f64; 2]]) -> TransferFunction {
    TransferFunction::new(
        color.iter().map(|&[s, r, g, b]| ColorNode { s, rgb: [r, g, b] }).collect(),
        opacity.iter().map(|&[s, opacity]| OpacityNode { s, opacity }).collect(),
    )
    .unwrap()
}

/// Steps, a peak and a stretch of nothing: cells on one piece and on several, rising and falling.
fn lively() -> TransferFunction {
    let color = [[-1.0, 0.9, 0.1, 0.2], [0.0, 0.2, 0.8, 0.3], [0.0, 0.1, 0.3, 1.0], [1.5, 1.0, 0.9, 0.2]];
    let opacity = [[-1.0, 1.0], [-0.5, 0.1], [0.2, 0.0], [0.25, 3.0], [0.3, 0.0], [0.9, 0.5], [0.9, 2.0]];
    transfer(&color, &opacity)
}

/// A grid with displaced points from outside and within, both projections.
fn drawings(size: [u32; 2]) -> Vec<Drawing> {
    let mut parts = cuboid([4, 3, 3], Split::Six, [-DVec3::ONE, DVec3::ONE]);
    let mut state = 7u32;
    let mut random = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state >> 8) / f64::from(1 << 24) - 0.5
    };
    for p in &mut parts.points {
        *p += DVec3::new(random(), random(), random()) * 0.1;
    }
    let field = parts.sample(|p| (2.0 * p.x).sin() + p.y * p.z);
    let mesh = TetMesh::assemble(&parts.points, &parts.cells, vec![Field::point("s", 1, field)]).unwrap();
    let (outside, inside) = (DVec3::new(2.5, -3.0, 1.8), DVec3::new(0.2, 0.1, -0.3));
    [
        camera(outside, DVec3::ZERO, Projection::Perspective { view_angle: 35.0 }),
        camera(outside, DVec3::ZERO, Projection::Orthographic { parallel_scale: 1.6 }),
        camera(inside, DVec3::X, Projection::Perspective { view_angle: 90.0 }),
        camera(inside, DVec3::X, Projection::Orthographic { parallel_scale: 1.2 }),
    ]
    .map(|camera| Drawing::new(mesh.clone(), lively(), camera, size))
    .into()
}

fn difference<T: Copy + Into<f64>>(a: &[[f32; 4]], b: &[[T; 4]]) -> f64 {
    assert_eq!(a.len(), b.len());
    let values = a.iter().flatten().zip(b.iter().flatten());
    values.map(|(&x, &y)| (f64::from(x) - y.into()).abs()).fold(0.0, |m, d| if d > m || d.is_nan() { d } else { m })
}

/// The instruction sets that this processor has.
fn levels() -> Vec<Level> {
    Instructions::all().into_iter().map(|instructions| instructions.0).collect()
}

#[test]
fn every_instruction_set_draws_the_truth() {
    for drawing in drawings([45, 37]) {
        let truth = drawing.reference();
        let first = drawing.sorted(Level::new());
        for level in levels() {
            let picture = drawing.sorted(level);
            let error = difference(&picture, &truth);
            println!("{level:?}, {:?}: {error:.1e}", drawing.scene.camera.projection);
            assert!(error <= EXACT, "{level:?}: {error:.1e}");
            assert!(difference(&picture, &first) <= ROUNDING, "{level:?}");
            assert_eq!(picture, drawing.sorted(level), "the same bit for bit");
        }
        assert!(truth.iter().filter(|p| p[3] > 0.1).count() > 200, "the mesh is seen");
    }
}

#[test]
fn pictures_of_any_size() {
    for size in [[1, 1], [3, 2], [16, 16], [17, 33], [5, 64]] {
        for drawing in drawings(size) {
            let error = difference(&drawing.sorted(Level::new()), &drawing.reference());
            assert!(error <= EXACT, "{size:?}: {error:.1e}");
        }
    }
}

/// Arithmetic in single precision throughout, where a ray grazes a face of a peak of slope 60.
const TWIN: f64 = 5e-5;

#[test]
fn the_shaders_twin_draws_the_same() {
    for drawing in drawings([40, 30]) {
        let (tiles, twin) = (drawing.sorted(Level::new()), drawing.twin());
        let apart = difference(&tiles, &twin);
        assert!(apart <= TWIN, "{:?}: {apart:.1e}", drawing.scene.camera.projection);
    }
}

/// Three cells each of which hides a part of the next.
fn cycle() -> Drawing {
    let parts = three_cycle();
    let field = Field::cell("s", 1, vec![0.0, 1.0, 2.0]);
    let mesh = TetMesh::assemble(&parts.points, &parts.cells, vec![field]).unwrap();
    let color = [[0.0, 1.0, 0.0, 0.0], [1.0, 0.0, 1.0, 0.0], [2.0, 0.0, 0.0, 1.0]];
    let perspective = Projection::Perspective { view_angle: 14.0 };
    let camera = camera(DVec3::splat(12.0), DVec3::splat(0.5), perspective);
    Drawing::new(mesh, transfer(&color, &[[0.0, 2.0]]), camera, [96, 96])
}

#[test]
fn a_cycle_is_drawn_as_a_group_and_in_no_order() {
    let drawing = cycle();
    assert_eq!(drawing.mesh.cells().len(), 3);
    let truth = drawing.reference();
    for order in [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]] {
        for level in levels() {
            let error = difference(&drawing.draw(level, &order, std::slice::from_ref(&(0..3)), 1e-3), &truth);
            assert!(error <= EXACT, "{order:?}, {level:?}: {error:.1e}");
        }
        let error = difference(&drawing.draw(Level::new(), &order, &[], 1e-3), &truth);
        assert!(error > 1e-2, "{order:?} is no order: {error:.1e}");
    }
}

#[test]
fn cells_in_order_and_groups_between_them() {
    // Cubes in a row along the view, nearest last in the mesh: in order by cubes, six cells each, themselves unsorted.
    let parts = cuboid([1, 1, 6], Split::Six, [DVec3::ZERO, DVec3::new(1.0, 1.0, 6.0)]);
    let field = Field::point("s", 1, parts.sample(|p| 0.4 * p.z - 1.0 + 0.3 * p.x));
    let mesh = TetMesh::assemble(&parts.points, &parts.cells, vec![field]).unwrap();
    let position = DVec3::new(0.5, 0.4, 12.0);
    let mut camera = camera(position, position - DVec3::Z, Projection::Orthographic { parallel_scale: 0.7 });
    camera.view_up = DVec3::Y;
    let drawing = Drawing::new(mesh, lively(), camera, [40, 40]);
    let order: Vec<u32> = (0..6).rev().flat_map(|cube| 6 * cube..6 * cube + 6).collect();
    let truth = drawing.reference();
    let groups = |cubes: &[u32]| -> Vec<Range<u32>> { cubes.iter().map(|c| 6 * c..6 * c + 6).collect() };
    let error = |groups: &[Range<u32>]| difference(&drawing.draw(Level::new(), &order, groups, 1e-3), &truth);
    assert!(error(&groups(&[0, 1, 2, 3, 4, 5])) <= EXACT);
    assert!(error(&[0..12, 12..18, 18..36]) <= EXACT);
    assert!(error(&groups(&[1, 4])) > 1e-4, "the other cubes' cells are not in order");
}

#[test]
fn what_is_hidden_is_left_out_within_its_share_of_the_error() {
    // Dense: transmittance falls to e^-24 on the way through.
    let parts = cuboid([3, 3, 12], Split::Six, [DVec3::ZERO, DVec3::new(1.0, 1.0, 4.0)]);
    let field = Field::point("s", 1, parts.sample(|p| p.z));
    let mesh = TetMesh::assemble(&parts.points, &parts.cells, vec![field]).unwrap();
    let mut camera = camera(
        DVec3::new(0.5, 0.5, -6.0),
        DVec3::new(0.5, 0.5, 0.0),
        Projection::Orthographic { parallel_scale: 0.45 },
    );
    camera.view_up = DVec3::Y;
    let dense = transfer(&[[0.0, 1.0, 0.2, 0.1], [4.0, 0.1, 0.9, 2.0]], &[[0.0, 6.0]]);
    let drawing = Drawing::new(mesh, dense, camera, [33, 20]);
    let order: Vec<u32> = drawing.all();
    let exact = drawing.draw(Level::new(), &order, &[], 1e-12);
    for max_error in [1e-3, 1.0, 30.0] {
        let picture = drawing.draw(Level::new(), &order, &[], max_error);
        let change = difference(&picture, &exact);
        let bound = HIDDEN_ERROR * max_error;
        assert!(change <= bound + 1e-7, "{max_error}: {change:.1e}");
        assert!(max_error < 1.0 || change > 0.01 * bound, "{max_error}: nothing was left out: {change:.1e}");
    }
}

#[test]
fn batches_cut_no_group() {
    let (batch, n) = (BATCH as u32, 3 * BATCH);
    let cases: [&[(u32, u32)]; 5] =
        [&[], &[(0, n as u32)], &[(5, 9), (batch - 1, batch + 1)], &[(batch - 7, batch)], &[(batch, 2 * batch)]];
    for groups in cases {
        let groups: Vec<Range<u32>> = groups.iter().map(|&(start, end)| start..end).collect();
        let batches = batches(n, &groups);
        assert_eq!(batches.first().map(|b| b.start), Some(0));
        assert_eq!(batches.last().map(|b| b.end), Some(n));
        assert!(batches.windows(2).all(|pair| pair[0].end == pair[1].start && !pair[0].is_empty()));
        for group in &groups {
            let inside: Vec<_> =
                batches.iter().flat_map(|batch| groups_in(std::slice::from_ref(group), batch)).collect();
            assert_eq!(inside.len(), 1);
            let holder = batches.iter().find(|b| b.contains(&(group.start as usize))).unwrap();
            assert!(group.end as usize <= holder.end, "{group:?} in {holder:?}");
        }
    }
    assert!(batches(0, &[]).is_empty());
}
