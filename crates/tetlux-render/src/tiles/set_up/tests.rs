use fearless_simd::dispatch;

use super::store::ROWS;
use super::*;
use crate::Instructions;
use crate::device_mesh::{self, NEGATIVE};
use crate::tiles::record::Record;

#[test]
fn vertices_of_many_cells_are_sorted_as_those_of_one() {
    // Every order of four, and cells with equal vertices.
    let mut cells = [[0; 4]; CHUNK];
    for (code, cell) in cells.iter_mut().enumerate() {
        let order = [code % 4, (code / 4 + 1) % 4, (code / 16 + 2) % 4, 3 - code % 3];
        *cell = order.map(|i| [7, 900, 12, 40_000][i]);
    }
    let permutations = (0..24).map(|code| {
        let mut left = vec![3, 5, 8, 13];
        [code / 6, code / 2 % 3, code % 2, 0].map(|place| left.remove(place))
    });
    cells.iter_mut().zip(permutations).for_each(|(cell, permutation)| *cell = permutation);
    let (names, parity) = ascending(&cells);
    for (lane, &cell) in cells.iter().enumerate() {
        let [a, b, c, d] = device_mesh::ascending(cell);
        assert_eq!([0, 1, 2, 3].map(|i: usize| names[i][lane]), [a & !NEGATIVE, b, c, d]);
        assert_eq!(parity[lane], if a & NEGATIVE == 0 { 1.0 } else { -1.0 }, "{cell:?}");
    }
}

#[test]
fn every_field_is_stored_in_its_place() {
    #[inline(always)]
    fn filled<S: Simd>(simd: S) -> Vec<Record> {
        let value = |field: usize| S::f64s::from_fn(simd, |lane| (100 * lane + field + 1) as f64);
        let mut fields = [[S::f64s::splat(simd, 0.0); 2]; 15];
        for (place, pair) in fields.iter_mut().enumerate() {
            *pair = [value(place), value(place + ROWS)];
        }
        let mut records = vec![Record::default(); S::f64s::LEN];
        store(simd, fields, &mut records);
        records
    }
    for set in Instructions::all() {
        let mut records = dispatch!(set.0, simd => filled(simd));
        for (lane, record) in records.iter_mut().enumerate() {
            let numbers = *record.floats_mut();
            for (place, &number) in numbers.iter().enumerate() {
                let expected = if place % ROWS == ROWS - 1 { 0.0 } else { (100 * lane + place + 1) as f32 };
                assert_eq!(number, expected, "{}: lane {lane}, place {place}", set.name());
            }
            // As its members are named.
            assert_eq!((record.planes[0][1], record.lean[2], record.nearest), (numbers[1], numbers[14], numbers[16]));
            assert_eq!((record.scalar[0], record.along, record.level), (numbers[17], numbers[20], numbers[24]));
        }
    }
}

#[test]
fn front_faces_come_first_and_are_counted() {
    // Of every choice of sides, and both parities: each plane is named by its face.
    #[inline(always)]
    fn sorted<S: Simd>(simd: S, sides: [f64; 4], parity: f64) -> ([f64; 4], f64, [bool; 4]) {
        let splat = |x: f64| S::f64s::splat(simd, x);
        let mut planes = [0.0, 1.0, 2.0, 3.0].map(|face| [splat(face), splat(10.0 + face), splat(20.0 + face)]);
        let (fronts, back) = fronts_first(simd, &mut planes, sides.map(splat), splat(parity));
        for plane in &planes {
            assert_eq!((plane[1][0], plane[2][0]), (plane[0][0] + 10.0, plane[0][0] + 20.0));
        }
        (planes.map(|plane| plane[0][0]), fronts[0], back.map(|back| back.to_bitmask() & 1 != 0))
    }
    for set in Instructions::all() {
        for code in 0..32 {
            let sides = [0, 1, 2, 3].map(|face| if code >> face & 1 == 0 { 0.0 } else { -2.0 });
            let parity = if code >> 4 == 0 { 1.0 } else { -1.0 };
            // The normals of the first and the third face point inwards where the parity is even.
            let is_front = |face: usize| {
                let toward = if sides[face] >= 0.0 { parity } else { -parity };
                (if face.is_multiple_of(2) { -toward } else { toward }) > 0.0
            };
            let (faces, fronts, back) = dispatch!(set.0, simd => sorted(simd, sides, parity));
            let count = (0..4).filter(|&face| is_front(face)).count();
            assert_eq!(fronts, count as f64, "{}: {code}", set.name());
            for (place, face) in faces.into_iter().enumerate() {
                assert_eq!(is_front(face as usize), place < count, "{}: {code}", set.name());
                assert_eq!(back[place], place >= count);
            }
            let mut all = faces.map(|face| face as usize);
            all.sort_unstable();
            assert_eq!(all, [0, 1, 2, 3]);
        }
    }
}
