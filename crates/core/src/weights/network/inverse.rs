//! The inverse of a symmetric positive definite matrix in double precision, by Cholesky's factorisation.

use crate::machine::parallel::for_each_block;

/// Sums side by side: one alone waits for each of its additions.
const SUMS: usize = 8;

/// The inverse of the m x m matrix.
pub(super) fn inverse(mut matrix: Vec<f64>, m: usize) -> Vec<f64> {
    // matrix = U^T U; U takes the place of the upper half, row by row.
    for k in 0..m {
        let (above, below) = matrix.split_at_mut((k + 1) * m);
        let row = &mut above[k * m..];
        let scale = row[k].max(f64::MIN_POSITIVE).sqrt().recip();
        row[k..].iter_mut().for_each(|u| *u *= scale);
        for (i, below) in below.chunks_exact_mut(m).enumerate().map(|(i, below)| (k + 1 + i, below)) {
            let factor = row[i];
            below[i..].iter_mut().zip(&row[i..]).for_each(|(value, u)| *value -= factor * u);
        }
    }
    let mut inverse = vec![0.0; m * m];
    for_each_block(&mut inverse, m, |j, x| {
        // U^T y = e_j, of which what is before j is 0; then U x = y.
        x[j] = 1.0;
        for k in j..m {
            let row = &matrix[k * m..(k + 1) * m];
            x[k] /= row[k];
            let y = x[k];
            x[k + 1..].iter_mut().zip(&row[k + 1..]).for_each(|(x, u)| *x -= u * y);
        }
        for k in (0..m).rev() {
            let row = &matrix[k * m..(k + 1) * m];
            x[k] = (x[k] - dot(&row[k + 1..], &x[k + 1..])) / row[k];
        }
    });
    inverse
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    let (a, last_a) = a.as_chunks::<SUMS>();
    let (b, last_b) = b.as_chunks::<SUMS>();
    let mut sums = [0.0; SUMS];
    for (a, b) in a.iter().zip(b) {
        sums.iter_mut().zip(a.iter().zip(b)).for_each(|(sum, (a, b))| *sum += a * b);
    }
    sums.iter().sum::<f64>() + last_a.iter().zip(last_b).map(|(a, b)| a * b).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_matrix_times_its_inverse_is_the_identity() {
        for m in [1, 2, 9, 40] {
            let a: Vec<f64> = (0..m * m).map(|i| (1.7 * i as f64).sin()).collect();
            let entry = |i: usize, j: usize| dot(&a[i * m..(i + 1) * m], &a[j * m..(j + 1) * m]);
            let matrix: Vec<f64> =
                (0..m * m).map(|at| entry(at / m, at % m) + f64::from(u8::from(at / m == at % m))).collect();
            let inverse = inverse(matrix.clone(), m);
            for at in 0..m * m {
                let (i, j) = (at / m, at % m);
                let sum: f64 = (0..m).map(|k| matrix[i * m + k] * inverse[k * m + j]).sum();
                assert!((sum - f64::from(u8::from(i == j))).abs() < 1e-9, "{m}: {i} {j} {sum}");
            }
        }
    }
}
