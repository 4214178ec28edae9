//! Few of many places from which the way to all others is short: k-medoids.
//!
//! `min sum_i area_i min_j cost[i][j]` over the chosen j, some of which are fixed. Starts: Arthur, Vassilvitskii, "k-means++", 2007; then
//! each place goes to the chosen one that is nearest, and each chosen one to the middle of its places, until nothing changes (Lloyd 1957).

use crate::machine::random::Random;

/// Random starts, beside the one that always takes the farthest.
const STARTS: usize = 8;
const ROUNDS: usize = 30;

/// What there is to choose from.
pub(super) struct Choice<'a> {
    /// From each candidate (row) to each place.
    pub(super) cost: &'a [f64],
    pub(super) areas: &'a [f64],
    /// Candidates that are chosen before.
    pub(super) fixed: &'a [usize],
}

/// Candidates of one kind, and how many of them are to be chosen.
pub(super) struct Kind {
    pub(super) candidates: Vec<usize>,
    pub(super) count: usize,
}

/// The fixed ones, and of each kind as many as are asked for, if it has so many; and what they cost. None where nothing has area.
pub(super) fn medoids(choice: &Choice<'_>, kinds: &[Kind], random: &mut Random) -> (Vec<usize>, f64) {
    let starts = (0..=STARTS)
        .map(|start| choice.settled(choice.start(kinds, (start > 0).then_some(&mut *random)), kinds));
    starts.reduce(|best, next| if next.1 < best.1 { next } else { best }).expect("a start")
}

impl Choice<'_> {
    fn row(&self, candidate: usize) -> &[f64] {
        &self.cost[candidate * self.areas.len()..][..self.areas.len()]
    }

    /// The fixed ones, then of each kind in turn the farthest from what is chosen, or one drawn by area and squared distance.
    fn start(&self, kinds: &[Kind], mut random: Option<&mut Random>) -> Vec<usize> {
        let mut chosen = self.fixed.to_vec();
        let mut nearest = vec![f64::INFINITY; self.areas.len()];
        self.fixed.iter().for_each(|&one| nearer(&mut nearest, self.row(one)));
        for kind in kinds {
            for _ in 0..kind.count {
                let free = kind
                    .candidates
                    .iter()
                    .copied()
                    .filter(|one| !chosen.contains(one) && self.areas[*one] > 0.0);
                let size = |one: usize| if nearest[one].is_finite() { nearest[one] } else { 1.0 };
                let next = match &mut random {
                    None => free.reduce(|best, next| if size(next) > size(best) { next } else { best }),
                    Some(random) => {
                        let free: Vec<usize> = free.collect();
                        let share = |one: usize| self.areas[one] * size(one) * size(one);
                        let mut left = random.unit() * free.iter().map(|&one| share(one)).sum::<f64>();
                        let drawn = free.iter().copied().find(|&one| {
                            left -= share(one);
                            left < 0.0
                        });
                        drawn.or(free.last().copied())
                    }
                };
                let Some(next) = next else { break };
                chosen.push(next);
                nearer(&mut nearest, self.row(next));
            }
        }
        chosen
    }

    /// Moves what is not fixed until it stays.
    fn settled(&self, mut chosen: Vec<usize>, kinds: &[Kind]) -> (Vec<usize>, f64) {
        if chosen.is_empty() || !self.areas.iter().any(|area| *area > 0.0) {
            return (Vec::new(), f64::INFINITY);
        }
        let mut kind_of = vec![usize::MAX; self.areas.len()];
        for (number, kind) in kinds.iter().enumerate() {
            kind.candidates.iter().for_each(|&one| kind_of[one] = number);
        }
        let mut best = (chosen.clone(), self.price(&self.owners(&chosen), &chosen));
        for _ in 0..ROUNDS {
            let owners = self.owners(&chosen);
            for at in self.fixed.len()..chosen.len() {
                let mine: Vec<usize> = (0..owners.len())
                    .filter(|&place| owners[place] == at && self.areas[place] > 0.0)
                    .collect();
                let price = |one: usize| -> f64 {
                    mine.iter().map(|&place| self.areas[place] * self.row(one)[place]).sum()
                };
                let own = chosen[at];
                let others = mine
                    .iter()
                    .copied()
                    .filter(|&one| kind_of[one] == kind_of[own] && !chosen.contains(&one));
                let priced = others.map(|one| (one, price(one)));
                chosen[at] =
                    priced.fold((own, price(own)), |best, next| if next.1 < best.1 { next } else { best }).0;
            }
            let price = self.price(&self.owners(&chosen), &chosen);
            if price >= best.1 {
                break;
            }
            best = (chosen.clone(), price);
        }
        best
    }

    /// Which of the chosen each place is nearest to.
    fn owners(&self, chosen: &[usize]) -> Vec<usize> {
        let of = |place: usize| {
            let each = chosen.iter().enumerate().map(|(at, &one)| (at, self.row(one)[place]));
            each.fold((0, f64::INFINITY), |best, next| if next.1 < best.1 { next } else { best }).0
        };
        (0..self.areas.len()).map(of).collect()
    }

    fn price(&self, owners: &[usize], chosen: &[usize]) -> f64 {
        let of = |(place, &owner): (usize, &usize)| self.areas[place] * self.row(chosen[owner])[place];
        owners.iter().enumerate().map(of).sum::<f64>() / self.areas.iter().sum::<f64>()
    }
}

fn nearer(nearest: &mut [f64], row: &[f64]) {
    nearest.iter_mut().zip(row).for_each(|(near, far)| *near = near.min(*far));
}
