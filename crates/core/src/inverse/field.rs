//! The map at a place, with its derivative.

use crate::error::Error;
use crate::geometry::Frame;
use crate::machine::parallel::for_each_block;
use crate::machine::progress::Progress;
use crate::mls::matrix::Matrix;
use crate::mls::{Dual, Mls};
use crate::softmax::{relative_weights, Dominant};
use crate::weights::Weights;

/// Points that one thread takes at a time.
const BLOCK: usize = 256;

/// A map of space.
pub(super) struct Field<'a, const D: usize> {
    pub weights: &'a Weights,
    pub frame: Frame,
    pub temperature: f64,
    /// In the frame.
    pub mls: Mls<'a, D>,
}

/// Where a point goes, by which local map, and how that changes from place to place.
#[derive(Clone, Copy)]
pub(super) struct Place<const D: usize> {
    pub y: [f64; D],
    pub map: Matrix<D>,
    pub jacobian: Matrix<D>,
}

/// Memory for one point.
struct Scratch<const D: usize> {
    logits: Vec<f64>,
    slopes: Vec<[f64; D]>,
    relative: Vec<f64>,
    duals: Vec<Dual<D>>,
    /// The rotation of the point before, which is often near.
    near: [f64; 4],
}

impl<const D: usize> Field<'_, D> {
    /// Calls `each` with what the map does at each of the points `x` (n x D), and that point's `per` of `out`.
    pub(super) fn visit<T: Send>(
        &self,
        x: &[f64],
        out: &mut [T],
        per: usize,
        progress: &mut Progress<'_>,
        each: impl Fn(Place<D>, &mut [T]) + Sync + Send,
    ) -> Result<(), Error> {
        let said = match self.weights {
            Weights::Neural(trained) | Weights::ShapeAware(trained) => trained.network.slopes(x, progress)?,
            Weights::InverseDistance(_) => Vec::new(),
        };
        let m = self.weights.control_points().len() / D;
        let width = said.len() / (x.len() / D).max(1);
        for_each_block(out, BLOCK * per, |block, out| {
            let mut scratch = Scratch {
                logits: vec![0.0; m],
                slopes: vec![[0.0; D]; m],
                relative: vec![0.0; m],
                duals: vec![Dual { value: 0.0, slope: [0.0; D] }; m],
                near: [1.0, 0.0, 0.0, 0.0],
            };
            for (i, out) in out.chunks_exact_mut(per).enumerate() {
                let i = BLOCK * block + i;
                let x = std::array::from_fn(|k| x[D * i + k]);
                each(self.place(&x, &said[width * i..width * (i + 1)], &mut scratch), out);
            }
        });
        Ok(())
    }

    /// The map at x, of which the network, if there is one, has `said` the logits and their derivatives.
    fn place(&self, x: &[f64; D], said: &[f32], scratch: &mut Scratch<D>) -> Place<D> {
        let at: [f64; D] = self.frame.enter(x);
        match self.weights {
            Weights::InverseDistance(function) => {
                function.slopes(x, &mut scratch.logits, &mut scratch.slopes);
            }
            _ => {
                let m = scratch.logits.len();
                // The network saw the place in single precision.
                let rounded = self.frame.enter_single(x);
                for i in 0..m {
                    let slope: [f64; D] = std::array::from_fn(|k| f64::from(said[m * (1 + k) + i]));
                    let beside: f64 = (0..D).map(|k| slope[k] * (at[k] - f64::from(rounded[k]))).sum();
                    (scratch.logits[i], scratch.slopes[i]) = (f64::from(said[i]) + beside, slope);
                }
            }
        }
        let dominant = self.differentiate_weights(scratch);
        let (local, jacobian) = self.mls.differentiate(&at, &scratch.duals, dominant, &mut scratch.near);
        let y = std::array::from_fn(|k| x[k] + self.frame.half * local.displacement[k]);
        Place { y, map: local.map, jacobian }
    }

    /// `dw_i = w_i (dl_i - sum_j w_j dl_j) / T`, of weights relative to the second-largest.
    fn differentiate_weights(&self, scratch: &mut Scratch<D>) -> Dominant<Dual<D>> {
        let Scratch { logits, slopes, relative, duals, .. } = scratch;
        let Dominant { index, second } = relative_weights(logits, self.temperature, relative);
        let runner = (0..logits.len()).find(|&i| i != index && relative[i] == 1.0).unwrap_or(index);
        let rest: f64 = relative.iter().sum();
        let mut mean = slopes[index].map(|s| (1.0 - second * rest) * s);
        for (r, slope) in relative.iter().zip(&*slopes) {
            (0..D).for_each(|k| mean[k] += second * r * slope[k]);
        }
        for ((dual, &value), slope) in duals.iter_mut().zip(&*relative).zip(&*slopes) {
            let slope = std::array::from_fn(|k| value * (slope[k] - slopes[runner][k]) / self.temperature);
            *dual = Dual { value, slope };
        }
        let slope = std::array::from_fn(|k| second * (slopes[runner][k] - mean[k]) / self.temperature);
        Dominant { index, second: Dual { value: second, slope } }
    }
}
