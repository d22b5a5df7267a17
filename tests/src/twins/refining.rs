//! Finer meshes of the same body with the same field.

use std::collections::HashMap;

use tetlux_mesh::Field;
use tetlux_mesh::procedural::{Parts, Split, cuboid};

use super::Twins;
use crate::{FIELD, Random, Recipe};

/// Every cell in four at its middle (Alfeld 1984).
pub fn into_four(first: Recipe, _: u64) -> Twins {
    let all = 0..first.parts.cells.len();
    Twins::new(&first, &Finer::new(&first).at_middles(all))
}

/// Every cell in eight: a new point on every edge, and a diagonal through what the four corners leave (Bey 1995).
pub fn into_eight(first: Recipe, _: u64) -> Twins {
    Twins::new(&first, &Finer::new(&first).at_all_edges())
}

/// One cell in four at its middle.
pub fn one_cell(first: Recipe, seed: u64) -> Twins {
    let cell = Random::new(seed).below(first.parts.cells.len());
    Twins::new(&first, &Finer::new(&first).at_middles(cell..cell + 1))
}

/// Every cell about one edge in two at the edge's middle.
pub fn one_edge(first: Recipe, seed: u64) -> Twins {
    let [a, b, _, _] = first.parts.cells[Random::new(seed).below(first.parts.cells.len())];
    Twins::new(&first, &Finer::new(&first).at_edge([a, b]))
}

/// A box with a linear field, in two grids that share no point but the corners.
pub fn another_mesh(first: Recipe, _: u64) -> Twins {
    let (low, high) = (first.parts.points[0].signum() * 1.5, -first.parts.points[0].signum() * 1.5);
    let boxed = |counts, split| {
        let parts = cuboid(counts, split, [low, high]);
        // Over the range of the transfer function, which is the first mesh's.
        let [bottom, top] = crate::range_of(&first.field);
        let share = |x: f64| x / 3.0 + 0.5;
        let values =
            parts.sample(|p| bottom + (top - bottom) * (0.5 * share(p.x) + 0.3 * share(p.y) + 0.2 * share(p.z)));
        Recipe { field: Field::point(FIELD, 1, values), parts, ..first.clone() }
    };
    // Powers of two: every point of both is exact.
    Twins::new(&boxed([2, 1, 2], Split::Five), &boxed([4, 8, 4], Split::Six))
}

/// A recipe on its way to a finer mesh. New values are means of old ones: the field stays what it is.
struct Finer {
    recipe: Recipe,
    /// The points in the middles of edges.
    middles: HashMap<[u32; 2], u32>,
}

impl Finer {
    fn new(recipe: &Recipe) -> Finer {
        Finer { recipe: recipe.clone(), middles: HashMap::new() }
    }

    /// A new point between some.
    fn between<const N: usize>(&mut self, names: [u32; N]) -> u32 {
        let Recipe { parts: Parts { points, .. }, field, .. } = &mut self.recipe;
        let share = 1.0 / N as f64;
        points.push(names.iter().map(|&v| points[v as usize] * share).sum());
        for k in 0..field.components {
            let value = |&v: &u32| field.values[v as usize * field.components + k] * share;
            field.values.push(names.iter().map(value).sum());
        }
        points.len() as u32 - 1
    }

    fn middle(&mut self, a: u32, b: u32) -> u32 {
        let edge = [a.min(b), a.max(b)];
        if let Some(&known) = self.middles.get(&edge) {
            return known;
        }
        let middle = self.between(edge);
        self.middles.insert(edge, middle);
        middle
    }

    fn at_middles(mut self, which: std::ops::Range<usize>) -> Recipe {
        for cell in which {
            let names = self.recipe.parts.cells[cell];
            let middle = self.between(names);
            // Each part has the new point in place of one vertex.
            let mut parts = [names; 4];
            (0..4).for_each(|k| parts[k][k] = middle);
            let cells = &mut self.recipe.parts.cells;
            cells[cell] = parts[0];
            cells.extend(&parts[1..]);
        }
        self.recipe
    }

    fn at_all_edges(mut self) -> Recipe {
        let cells = std::mem::take(&mut self.recipe.parts.cells);
        for [a, b, c, d] in cells {
            let [ab, ac, ad, bc, bd, cd] =
                [(a, b), (a, c), (a, d), (b, c), (b, d), (c, d)].map(|(p, q)| self.middle(p, q));
            let corners = [[a, ab, ac, ad], [ab, b, bc, bd], [ac, bc, c, cd], [ad, bd, cd, d]];
            // About the diagonal from ac to bd.
            let inner = [[ab, ac, ad, bd], [ab, ac, bc, bd], [ac, ad, bd, cd], [ac, bc, bd, cd]];
            self.recipe.parts.cells.extend(corners.into_iter().chain(inner));
        }
        self.recipe
    }

    fn at_edge(mut self, edge: [u32; 2]) -> Recipe {
        let middle = self.middle(edge[0], edge[1]);
        for cell in 0..self.recipe.parts.cells.len() {
            let names = self.recipe.parts.cells[cell];
            if edge.iter().all(|end| names.contains(end)) {
                let half = |end: u32| names.map(|v| if v == end { middle } else { v });
                self.recipe.parts.cells[cell] = half(edge[0]);
                self.recipe.parts.cells.push(half(edge[1]));
            }
        }
        self.recipe
    }
}
