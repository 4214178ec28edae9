//! The sparse system of a frame: which entries it has is found once, what they are in every round.
//!
//! By QDLDL as Clarabel has it, in scalars: its order of additions is the same on every machine (see `weights/shape_graph/cholesky.rs`).

use clarabel::algebra::CscMatrix;
use clarabel::qdldl::{QDLDLFactorisation, QDLDLSettings};

/// The entries of `L + diag(k)` of the nodes that are free, of which the first is `fixed`.
pub(super) struct System {
    fixed: usize,
    /// Upper triangle of the entries, and where in it those of the links and the diagonal are.
    entries: CscMatrix<f64>,
    of_links: Vec<Option<usize>>,
    of_diagonal: Vec<usize>,
    order: Vec<usize>,
}

/// The system with the values of a round.
pub(super) struct Factors {
    factors: QDLDLFactorisation<f64>,
    values: Vec<f64>,
    all: Vec<usize>,
}

impl System {
    /// Of `count` nodes.
    pub(super) fn new(fixed: usize, count: usize, links: &[[u32; 2]]) -> System {
        let free = count - fixed;
        let place = |[a, b]: [u32; 2]| (a.max(b) as usize, a.min(b) as usize);
        let mut wanted: Vec<(usize, usize, Option<usize>)> =
            (0..free).map(|node| (node, node, None)).collect();
        for (link, ends) in links.iter().enumerate() {
            let (column, row) = place(*ends);
            if row >= fixed {
                wanted.push((column - fixed, row - fixed, Some(link)));
            }
        }
        wanted.sort_unstable();
        let mut starts = vec![0; free + 1];
        let (mut of_links, mut of_diagonal) = (vec![None; links.len()], vec![0; free]);
        for (at, &(column, _, link)) in wanted.iter().enumerate() {
            starts[column + 1] += 1;
            match link {
                Some(link) => of_links[link] = Some(at),
                None => of_diagonal[column] = at,
            }
        }
        (0..free).for_each(|column| starts[column + 1] += starts[column]);
        let rows = wanted.iter().map(|(_, row, _)| *row).collect();
        let values = wanted.iter().map(|(_, _, link)| f64::from(u8::from(link.is_none()))).collect();
        let entries = CscMatrix::new(free, free, starts, rows, values);
        let mut system = System { fixed, entries, of_links, of_diagonal, order: Vec::new() };
        system.order = if free == 0 { Vec::new() } else { system.factors(None).factors.perm };
        system
    }

    /// Room for its factors, by which `order` the equations are.
    fn factors(&self, order: Option<Vec<usize>>) -> Factors {
        // Positive definite, so that nothing is to be regularised.
        let settings = QDLDLSettings { regularize_enable: false, perm: order, ..QDLDLSettings::default() };
        let factors = QDLDLFactorisation::new(&self.entries, Some(settings)).expect("positive definite");
        let count = self.entries.nzval.len();
        Factors { factors, values: vec![0.0; count], all: (0..count).collect() }
    }

    /// For the rounds of a frame; `None` where nothing is free.
    pub(super) fn prepared(&self) -> Option<Factors> {
        (!self.order.is_empty()).then(|| self.factors(Some(self.order.clone())))
    }

    /// Factors the system of links as stiff as this, and of the `ground` of each free node.
    pub(super) fn factor(
        &self,
        links: &[[u32; 2]],
        stiffness: &[f64],
        ground: impl Fn(usize) -> f64,
        into: &mut Factors,
    ) {
        for (free, &at) in self.of_diagonal.iter().enumerate() {
            into.values[at] = ground(free);
        }
        for ((ends, stiff), at) in links.iter().zip(stiffness).zip(&self.of_links) {
            for end in ends.iter().filter(|end| **end as usize >= self.fixed) {
                into.values[self.of_diagonal[*end as usize - self.fixed]] += stiff;
            }
            if let Some(at) = at {
                into.values[*at] = -stiff;
            }
        }
        into.factors.update_values(&into.all, &into.values);
        into.factors.refactor().expect("positive definite");
    }
}

impl Factors {
    /// Solves for the three coordinates, each an array.
    pub(super) fn solve(&mut self, b: &mut [Vec<f64>; 3]) {
        b.iter_mut().for_each(|column| self.factors.solve(column));
    }
}
