//! The dense products of a training step, cut into blocks of neurons that any thread may do.

use super::parameters::Layer;
use crate::machine::parallel::for_each_block;

/// Multiplications a block: fewer are done before another thread has begun.
const WORK: usize = 1 << 18;

/// Neurons a block, each with so many multiplications.
fn rows(work: usize) -> usize {
    (WORK / work.max(1)).max(1).next_multiple_of(64)
}

/// A matrix of which a product reads `rows x columns` numbers, `row` and `column` apart.
#[derive(Clone, Copy)]
pub(super) struct View<'a> {
    pub data: &'a [f32],
    pub row: usize,
    pub column: usize,
}

/// `out = A B + beta out`, A n x k, B k x m, out n x m row by row.
pub(super) fn multiply(n: usize, k: usize, m: usize, a: View<'_>, b: View<'_>, beta: f32, out: &mut [f32]) {
    if n == 0 || m == 0 || k == 0 {
        return;
    }
    let last =
        |view: View<'_>, rows: usize, columns: usize| (rows - 1) * view.row + (columns - 1) * view.column;
    assert!(last(a, n, k) < a.data.len() && last(b, k, m) < b.data.len() && n * m <= out.len());
    // SAFETY: the largest offset that is read from each matrix, and the n x m numbers written, lie in its slice, as asserted.
    unsafe {
        matrixmultiply::sgemm(
            n,
            k,
            m,
            1.0,
            a.data.as_ptr(),
            a.row as isize,
            a.column as isize,
            b.data.as_ptr(),
            b.row as isize,
            b.column as isize,
            beta,
            out.as_mut_ptr(),
            m as isize,
            1,
        );
    }
}

/// `out = W input + b`; `input` is inputs x m, `out` outputs x m.
pub(super) fn forward(layer: &Layer, input: &[f32], m: usize, out: &mut [f32]) {
    let k = layer.inputs();
    let size = rows(k * m);
    for_each_block(out, size * m, |block, out| {
        let (first, rows) = (size * block, out.len() / m);
        for (row, bias) in out.chunks_exact_mut(m).zip(&layer.bias[first..]) {
            row.fill(*bias);
        }
        let weight = View { data: &layer.weight[k * first..], row: k, column: 1 };
        multiply(rows, k, m, weight, View { data: input, row: m, column: 1 }, 1.0, out);
    });
}
