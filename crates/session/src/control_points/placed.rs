//! Control points where the core put them, with names.

use neuralmls_core::place::Placed;

use super::{ControlPoint, ControlPoints};
use crate::error::Error;

impl ControlPoints {
    /// The places as control points p1, p2, ...; of a pair `.L` is on the side to which the plane's normal points (greater x, where the
    /// plane is across x), and `.R` its mirror image.
    ///
    /// # Errors
    /// Control points, where two are in one place.
    pub fn placed(placed: &Placed, dim: usize) -> Result<ControlPoints, Error> {
        let places: Vec<Vec<f64>> = placed.points.chunks_exact(dim).map(<[f64]>::to_vec).collect();
        let mut list: Vec<ControlPoint> = Vec::with_capacity(places.len());
        let mut number = 0;
        for (place, image_of) in places.into_iter().zip(&placed.mirror_of) {
            number += usize::from(image_of.is_none());
            let mut point = ControlPoint::new(format!("p{number}"), place);
            if let Some(first) = *image_of {
                list[first].name = format!("p{number}.L");
                point.name = format!("p{number}.R");
                point.mirror_of = Some(list[first].name.clone());
            }
            list.push(point);
        }
        ControlPoints::new(dim, list)
    }
}
