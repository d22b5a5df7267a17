//! In which cells widgets may be seen, for functions that change while the mesh and its fields stay.

use rayon::prelude::*;
use tetlux_optics::BivariateFunction;

/// Cells that are looked at together: their boxes stay in the first cache while the widgets pass.
const BLOCK: usize = 256;

/// Blocks that a thread takes at a time.
const RUN: usize = 16;

/// The range of two fields in each cell of a mesh, 16 bytes a cell.
///
/// In single precision, rounded outwards: a cell that a widget touches is never missed (Song et al. 2009, section 3.1, with
/// boxes around the cells instead of their vertices, which miss a widget that lies between them).
#[derive(Debug, Clone)]
pub struct CellBoxes {
    blocks: Vec<Block>,
    cells: usize,
}

/// Lower and upper ends along both axes. Of cells without data, and behind the last one, they are NaN: no comparison with
/// them holds.
#[derive(Debug, Clone)]
struct Block {
    low: [[f32; BLOCK]; 2],
    high: [[f32; BLOCK]; 2],
    /// Around all of them: lower ends, upper ends.
    around: [[f32; 2]; 2],
}

impl CellBoxes {
    /// From the ranges of both fields, a cell each ([`tetlux_mesh::TetMesh::scalar_ranges`]); cells that one of the lists
    /// lacks are left out.
    pub fn new(first: &[[f64; 2]], second: &[[f64; 2]]) -> CellBoxes {
        let cells = first.len().min(second.len());
        let blocks = first[..cells].par_chunks(BLOCK).zip(second[..cells].par_chunks(BLOCK));
        CellBoxes { blocks: blocks.map(|(x, y)| Block::new([x, y])).collect(), cells }
    }

    /// Whether both fields have values in a cell.
    pub fn has_data(&self, cell: usize) -> bool {
        self.blocks.get(cell / BLOCK).is_some_and(|block| !block.low[0][cell % BLOCK].is_nan())
    }

    /// For each cell whether the function may be seen there: no means that it is not, or, of Gaussians, below
    /// [`tetlux_optics::widget::GAUSSIAN_TAIL`] of their peaks.
    pub fn visible(&self, function: &BivariateFunction) -> Vec<bool> {
        let widgets: Vec<[[f32; 2]; 2]> = function
            .widgets
            .iter()
            .map(|widget| {
                let footprint = widget.footprint();
                [[below(footprint.s[0]), below(footprint.g[0])], [above(footprint.s[1]), above(footprint.g[1])]]
            })
            .collect();
        let mut visible = vec![false; self.blocks.len() * BLOCK];
        let runs = visible.par_chunks_mut(RUN * BLOCK).zip(self.blocks.par_chunks(RUN));
        runs.for_each(|(visible, blocks)| {
            for (visible, block) in visible.chunks_exact_mut(BLOCK).zip(blocks) {
                block.mark(&widgets, visible);
            }
        });
        visible.truncate(self.cells);
        visible
    }
}

impl Block {
    fn new(ranges: [&[[f64; 2]]; 2]) -> Block {
        let mut block = Block {
            low: [[f32::NAN; BLOCK]; 2],
            high: [[f32::NAN; BLOCK]; 2],
            around: [[f32::INFINITY; 2], [f32::NEG_INFINITY; 2]],
        };
        for (i, (x, y)) in ranges[0].iter().zip(ranges[1]).enumerate() {
            // Where one has no data neither counts.
            if x[0].is_nan() || y[0].is_nan() {
                continue;
            }
            for (axis, &[low, high]) in [x, y].into_iter().enumerate() {
                let (low, high) = (below(low), above(high));
                (block.low[axis][i], block.high[axis][i]) = (low, high);
                block.around[0][axis] = block.around[0][axis].min(low);
                block.around[1][axis] = block.around[1][axis].max(high);
            }
        }
        block
    }

    /// Without branches, so that it is a few vector instructions for several cells: the largest of four differences is
    /// not above 0 where two boxes meet.
    fn mark(&self, widgets: &[[[f32; 2]; 2]], visible: &mut [bool]) {
        let meets = |[low, high]: &[[f32; 2]; 2]| {
            (0..2).all(|axis| low[axis] <= self.around[1][axis] && self.around[0][axis] <= high[axis])
        };
        let mut gaps = [f32::INFINITY; BLOCK];
        let mut any = false;
        for [low, high] in widgets.iter().filter(|widget| meets(widget)) {
            any = true;
            for i in 0..BLOCK {
                let x = larger(self.low[0][i] - high[0], low[0] - self.high[0][i]);
                let y = larger(self.low[1][i] - high[1], low[1] - self.high[1][i]);
                let gap = larger(x, y);
                gaps[i] = if gap < gaps[i] { gap } else { gaps[i] };
            }
        }
        if any {
            visible.iter_mut().zip(&gaps).for_each(|(visible, gap)| *visible = *gap <= 0.0);
        }
    }
}

/// The larger of two; NaN if the second is: one instruction, where [`f32::max`] takes several.
fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// The largest single-precision number that is not above a value.
pub(crate) fn below(value: f64) -> f32 {
    let single = value as f32;
    if f64::from(single) > value { single.next_down() } else { single }
}

/// The smallest one that is not below it.
pub(crate) fn above(value: f64) -> f32 {
    let single = value as f32;
    if f64::from(single) < value { single.next_up() } else { single }
}

#[cfg(test)]
mod tests {
    use tetlux_optics::accuracy::Random;
    use tetlux_optics::widget::{Rectangle, Shape, Widget};

    use super::*;

    fn ranges(random: &mut Random, count: usize) -> Vec<[f64; 2]> {
        (0..count)
            .map(|_| {
                let low = random.unit();
                if random.unit() < 0.05 { [f64::NAN; 2] } else { [low, low + 0.1 * random.unit().powi(3)] }
            })
            .collect()
    }

    #[test]
    fn nothing_that_a_widget_touches_is_missed_and_little_else_is_drawn() {
        let mut random = Random::new(5);
        // More than one run, the last block in part.
        let count = RUN * BLOCK + 3 * BLOCK + 17;
        let (x, y) = (ranges(&mut random, count), ranges(&mut random, count));
        let boxes = CellBoxes::new(&x, &y);
        let (mut seen, mut spared) = (0, 0);
        for _ in 0..40 {
            let widgets = (0..3).map(|i| {
                // Rims that are some cell's own ends: touching counts.
                let [a, b] = [&x, &y].map(|ranges| ranges[(random.unit() * count as f64) as usize]);
                let finite = |v: f64| if v.is_nan() { 0.5 } else { v };
                let [s, g] = [finite(a[1]), finite(b[0])];
                let support = Rectangle { s: [s - 0.05, s], g: [g, g + 0.07] };
                let opacity = if i == 2 { 0.0 } else { 1.0 };
                Widget::new(Shape::Uniform, Some(support), opacity, [1.0; 3]).unwrap()
            });
            let function = BivariateFunction { widgets: widgets.collect() };
            let visible = boxes.visible(&function);
            assert_eq!(visible.len(), count);
            for i in 0..count {
                let exact = function.is_visible_over(&Rectangle { s: x[i], g: y[i] });
                assert!(visible[i] || !exact, "cell {i}: {:?} {:?} of {function:?}", x[i], y[i]);
                assert_eq!(boxes.has_data(i), !x[i][0].is_nan() && !y[i][0].is_nan());
                seen += usize::from(exact);
                spared += usize::from(visible[i] && !exact);
            }
        }
        assert!(seen > 1000 && spared < seen / 1000, "{spared} beside {seen}");
    }

    #[test]
    fn boxes_are_rounded_outwards() {
        for value in [0.1, -0.1, 1e-300, -1e-300, 1e300, -1e300, 0.0, 3.0] {
            let (low, high) = (below(value), above(value));
            assert!(f64::from(low) <= value && value <= f64::from(high), "{value}: {low} {high}");
            assert!(low == high || low.next_up() == high, "{value}: {low} {high}");
        }
        assert!(below(f64::NAN).is_nan() && above(f64::NAN).is_nan());
    }

    #[test]
    fn widgets_without_bounds_are_seen_wherever_there_are_data() {
        let everywhere = Widget::new(Shape::Uniform, None, 1.0, [1.0; 3]).unwrap();
        let function = BivariateFunction { widgets: vec![everywhere] };
        let boxes = CellBoxes::new(&[[0.0, 1.0], [f64::NAN; 2], [2.0, 2.0]], &[[5.0, 6.0]; 3]);
        assert_eq!(boxes.visible(&function), [true, false, true]);
        assert_eq!(boxes.visible(&BivariateFunction::default()), [false; 3]);
        assert!(CellBoxes::new(&[], &[]).visible(&function).is_empty() && !boxes.has_data(3));
    }
}
