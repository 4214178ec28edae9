//! The little linear algebra of D x D matrices, D = 1, 2 or 3.

/// Row-major `D x D` matrix.
pub type Matrix<const D: usize> = [[f64; D]; D];

pub fn identity<const D: usize>() -> Matrix<D> {
    std::array::from_fn(|r| std::array::from_fn(|c| f64::from(u8::from(r == c))))
}

pub fn apply<const D: usize>(m: &Matrix<D>, v: &[f64; D]) -> [f64; D] {
    std::array::from_fn(|r| (0..D).map(|c| m[r][c] * v[c]).sum())
}

pub fn transposed<const D: usize>(m: &Matrix<D>) -> Matrix<D> {
    std::array::from_fn(|r| std::array::from_fn(|c| m[c][r]))
}

pub fn scaled<const D: usize>(m: &Matrix<D>, s: f64) -> Matrix<D> {
    m.map(|row| row.map(|e| e * s))
}

pub fn norm<const D: usize>(m: &Matrix<D>) -> f64 {
    // Scaled first, so that entries of 1e-200 keep their norm.
    let largest = m.iter().flatten().fold(0.0, |l: f64, e| l.max(e.abs()));
    if largest == 0.0 || !largest.is_finite() {
        return largest;
    }
    largest * m.iter().flatten().map(|e| (e / largest) * (e / largest)).sum::<f64>().sqrt()
}

/// `tr(A B)`.
pub fn trace_of_product<const D: usize>(a: &Matrix<D>, b: &Matrix<D>) -> f64 {
    (0..D).map(|r| (0..D).map(|c| a[r][c] * b[c][r]).sum::<f64>()).sum()
}

/// `L` with `L L^T = s`; `None` where rounding has made `s` indefinite.
pub fn cholesky<const D: usize>(s: &Matrix<D>) -> Option<Matrix<D>> {
    let mut l = [[0.0; D]; D];
    for r in 0..D {
        for c in 0..=r {
            let rest = s[r][c] - (0..c).map(|k| l[r][k] * l[c][k]).sum::<f64>();
            if r != c {
                l[r][c] = rest / l[c][c];
            } else if rest > 0.0 {
                l[r][r] = rest.sqrt();
            } else {
                return None;
            }
        }
    }
    Some(l)
}

/// `x` with `L L^T x = b`.
pub fn solve<const D: usize>(l: &Matrix<D>, mut b: [f64; D]) -> [f64; D] {
    for r in 0..D {
        b[r] = (b[r] - (0..r).map(|k| l[r][k] * b[k]).sum::<f64>()) / l[r][r];
    }
    for r in (0..D).rev() {
        b[r] = (b[r] - (r + 1..D).map(|k| l[k][r] * b[k]).sum::<f64>()) / l[r][r];
    }
    b
}
