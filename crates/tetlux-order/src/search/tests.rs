use proptest::prelude::*;

use super::*;

/// A graph of arrows: up to four a cell across faces, the rest across gaps.
#[derive(Debug, Clone)]
struct Arrows {
    neighbors: Vec<[u32; 4]>,
    states: Vec<u8>,
    gaps: Vec<u64>,
}

impl Arrows {
    fn new(cells: usize, faces: &[(usize, usize)], gaps: &[(usize, usize)]) -> Arrows {
        let mut arrows = Arrows { neighbors: vec![[NONE; 4]; cells], states: vec![0; cells], gaps: vec![] };
        for &(from, to) in faces.iter().filter(|(from, to)| from != to) {
            let place = arrows.states[from].trailing_ones() as usize;
            if place < 4 {
                arrows.neighbors[from][place] = to as u32;
                arrows.states[from] |= 1 << place;
            }
        }
        for &(from, to) in gaps.iter().filter(|(from, to)| from != to) {
            arrows.gaps.push((from as u64) << 32 | to as u64);
            arrows.states[from] |= GAPS;
        }
        arrows.gaps.sort_unstable();
        arrows.gaps.dedup();
        arrows
    }

    fn graph(&self) -> Graph<'_> {
        Graph { neighbors: &self.neighbors, steps: None, gaps: &self.gaps }
    }

    fn list(&self) -> Vec<(usize, usize)> {
        let faces = self.neighbors.iter().enumerate();
        let faces = faces.flat_map(|(c, around)| around.iter().filter(|&&n| n != NONE).map(move |&n| (c, n as usize)));
        faces.chain(self.gaps.iter().map(|&arrow| ((arrow >> 32) as usize, arrow as u32 as usize))).collect()
    }

    /// Whether each cell leads to each, by as many steps as there are cells.
    fn leads(&self) -> Vec<Vec<bool>> {
        let n = self.states.len();
        let mut leads = vec![vec![false; n]; n];
        self.list().iter().for_each(|&(from, to)| leads[from][to] = true);
        for via in 0..n {
            for from in 0..n {
                if leads[from][via] {
                    for to in 0..n {
                        leads[from][to] |= leads[via][to];
                    }
                }
            }
        }
        leads
    }
}

fn positions(cells: &[u32]) -> Vec<usize> {
    let mut positions = vec![usize::MAX; cells.len()];
    cells.iter().enumerate().for_each(|(place, &cell)| positions[cell as usize] = place);
    assert!(!positions.contains(&usize::MAX), "every cell once: {cells:?}");
    positions
}

fn pairs(count: usize) -> impl Strategy<Value = Vec<(usize, usize)>> {
    prop::collection::vec((0..CELLS, 0..CELLS), 0..count)
}

const CELLS: usize = 24;

proptest! {
    #[test]
    fn arrows_point_back_and_components_stay_together(
        faces in pairs(50), gaps in pairs(12), seeds in prop::collection::vec(0..CELLS as u32, 0..6),
    ) {
        let arrows = Arrows::new(CELLS, &faces, &gaps);
        let leads = arrows.leads();
        let mut search = Search::default();
        let (mut cells, mut groups) = (vec![0; CELLS], vec![]);
        let acyclic = (0..CELLS).all(|cell| !leads[cell][cell]);
        prop_assert_eq!(search.sort(arrows.graph(), &mut arrows.states.clone(), &seeds, &mut cells), acyclic);
        if acyclic {
            let at = positions(&cells);
            prop_assert!(arrows.list().iter().all(|&(from, to)| at[from] < at[to]));
            // By steps, of which some are too long, the same.
            let step = |c: usize, n: u32| if (c + n as usize).is_multiple_of(5) { 0 } else { n.wrapping_sub(c as u32) as i16 };
            let around = arrows.neighbors.iter().enumerate();
            let steps: Vec<[i16; 4]> =
                around.map(|(c, around)| around.map(|n| if n == NONE { 0 } else { step(c, n) })).collect();
            let graph = Graph { steps: Some(&steps), ..arrows.graph() };
            let mut by_steps = vec![0; CELLS];
            prop_assert!(search.sort(graph, &mut arrows.states.clone(), &seeds, &mut by_steps));
            prop_assert_eq!(&by_steps, &cells);
        }
        search.sort_components(arrows.graph(), &mut arrows.states.clone(), &seeds, &mut cells, &mut groups);
        let at = positions(&cells);
        let group = |cell: usize| groups.iter().position(|g| g.contains(&(at[cell] as u32)));
        for from in 0..CELLS {
            for to in 0..CELLS {
                let together = from != to && leads[from][to] && leads[to][from];
                prop_assert_eq!(together, from != to && group(from).is_some() && group(from) == group(to));
                prop_assert!(!leads[from][to] || together || from == to || at[from] < at[to]);
            }
        }
        prop_assert!(groups.windows(2).all(|w| w[0].end <= w[1].start));
        prop_assert!(groups.iter().all(|g| g.len() > 1));
    }

    #[test]
    fn graphs_without_cycles_are_found_so(faces in pairs(50), gaps in pairs(20)) {
        let onward = |pairs: &[(usize, usize)]| pairs.iter().map(|&(a, b)| (a.min(b), a.max(b))).collect::<Vec<_>>();
        let arrows = Arrows::new(CELLS, &onward(&faces), &onward(&gaps));
        let mut cells = vec![0; CELLS];
        prop_assert!(Search::default().sort(arrows.graph(), &mut arrows.states.clone(), &[], &mut cells));
        let at = positions(&cells);
        prop_assert!(arrows.list().iter().all(|&(from, to)| at[from] < at[to]));
    }
}

#[test]
fn what_the_first_seed_leads_to_is_last() {
    // Two chains without an arrow between them.
    let arrows = Arrows::new(4, &[(0, 1), (2, 3)], &[]);
    let mut cells = vec![0; 4];
    assert!(Search::default().sort(arrows.graph(), &mut arrows.states.clone(), &[2, 0], &mut cells));
    assert_eq!(cells, [0, 1, 2, 3]);
    assert!(Search::default().sort(arrows.graph(), &mut arrows.states.clone(), &[0, 2], &mut cells));
    assert_eq!(cells, [2, 3, 0, 1]);
}
