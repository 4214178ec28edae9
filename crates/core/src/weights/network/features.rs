//! Random Fourier features: `x -> [x, sin(2 pi B x), cos(2 pi B x)]`, `B` normal with deviation sigma.
//!
//! Tancik et al., "Fourier features let networks learn high frequency functions in low dimensional domains", 2020; 32
//! frequencies as in the published NeuralMLS code. That code also reveals the frequencies one after the other during its fixed number of
//! training steps; here all count from the start.

/// What the first layer sees of a point.
pub(super) fn width(dim: usize, frequencies: &[f32]) -> usize {
    dim + 2 * (frequencies.len() / dim)
}

/// Appends the features of `x` to `out`. `frequencies` is `B`, row by row: 32 x d, or empty for x alone.
pub(super) fn append(x: &[f32], frequencies: &[f32], out: &mut Vec<f32>) {
    out.extend_from_slice(x);
    let angles = |row: &[f32]| -> f64 {
        let turns: f64 = row.iter().zip(x).map(|(b, x)| f64::from(*b) * f64::from(*x)).sum();
        std::f64::consts::TAU * turns
    };
    out.extend(frequencies.chunks_exact(x.len()).map(|row| angles(row).sin() as f32));
    out.extend(frequencies.chunks_exact(x.len()).map(|row| angles(row).cos() as f32));
}

/// Appends the derivatives of the features of `x` by one of its coordinates.
pub(super) fn append_slopes(x: &[f32], frequencies: &[f32], axis: usize, out: &mut Vec<f32>) {
    out.extend((0..x.len()).map(|k| f32::from(u8::from(k == axis))));
    let rows = || frequencies.chunks_exact(x.len());
    let turn = |row: &[f32]| {
        let turns: f64 = row.iter().zip(x).map(|(b, x)| f64::from(*b) * f64::from(*x)).sum();
        ((std::f64::consts::TAU * turns).sin_cos(), std::f64::consts::TAU * f64::from(row[axis]))
    };
    out.extend(rows().map(|row| {
        let ((_, cos), rate) = turn(row);
        (cos * rate) as f32
    }));
    out.extend(rows().map(|row| {
        let ((sin, _), rate) = turn(row);
        (-sin * rate) as f32
    }));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn features_are_the_point_then_sines_then_cosines() {
        let mut out = Vec::new();
        append(&[0.5], &[1.0, 0.5], &mut out);
        let expected = [0.5, 0.0, 1.0, -1.0, 0.0];
        assert_eq!(out.len(), width(1, &[1.0, 0.5]));
        for (a, b) in out.iter().zip(expected) {
            assert!((a - b).abs() < 1e-6, "{out:?}");
        }
    }

    #[test]
    fn without_frequencies_the_point_is_its_own_feature() {
        let mut out = Vec::new();
        append(&[1.0, 2.0], &[], &mut out);
        assert_eq!(out, [1.0, 2.0]);
    }
}
