//! The box around positions.

/// Least and greatest corner.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Bounds {
    pub low: Vec<f64>,
    pub high: Vec<f64>,
}

impl Bounds {
    /// Of positions of `dim` numbers each.
    pub(crate) fn of(positions: &[f64], dim: usize) -> Bounds {
        match dim {
            3 => Bounds::of_columns::<3>(positions),
            2 => Bounds::of_columns::<2>(positions),
            _ => Bounds::of_columns::<1>(positions),
        }
    }

    fn of_columns<const DIM: usize>(positions: &[f64]) -> Bounds {
        let (mut low, mut high) = ([f64::INFINITY; DIM], [f64::NEG_INFINITY; DIM]);
        for position in positions.as_chunks::<DIM>().0 {
            for k in 0..DIM {
                low[k] = low[k].min(position[k]);
                high[k] = high[k].max(position[k]);
            }
        }
        Bounds { low: low.to_vec(), high: high.to_vec() }
    }

    /// The longest side.
    pub(crate) fn longest(&self) -> f64 {
        self.low.iter().zip(&self.high).map(|(low, high)| high - low).fold(0.0, f64::max)
    }

    /// The size of the largest coordinate along each axis.
    pub(crate) fn largest(&self) -> Vec<f64> {
        self.low.iter().zip(&self.high).map(|(low, high)| low.abs().max(high.abs())).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_column_by_column() {
        let bounds = Bounds::of(&[1.0, -5.0, 2.0, 3.0, -1.0, 0.0], 2);
        assert_eq!((&bounds.low[..], &bounds.high[..]), (&[-1.0, -5.0][..], &[2.0, 3.0][..]));
        assert_eq!((bounds.longest(), bounds.largest()), (8.0, vec![2.0, 5.0]));
        assert_eq!(Bounds::of(&[7.0], 1).longest(), 0.0);
    }
}
