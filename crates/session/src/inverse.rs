//! A map the other way: from where points came, and how the map changes from place to place.

use neuralmls_core::progress::Progress;
use neuralmls_core::{Inverse, Motion};

use crate::error::Error;
use crate::map::Map;
use crate::text::{general, tuple};

impl Map {
    /// The Jacobian `dy/dx` of the whole map at each of the points `x` (n x dim), row-major: n x dim x dim. Unlike the local maps of [`Map::deform`] it
    /// has in it how the weights change.
    ///
    /// # Errors
    /// Where the points do not fit; with `relax`; [`neuralmls_core::Error::Cancelled`].
    ///
    /// ```
    /// use neuralmls_session::{read, WeightsSettings};
    /// let mut session = read(b"name,x,y,target_x,target_y\na,0,0,0,0\nb,1,0,0,1\n", "points.csv").unwrap().session;
    /// session.settings.weights = WeightsSettings::InverseDistance { alpha: 1.0, epsilon: 0.0 };
    /// let map = session.fit(None, None, &mut |_| true).unwrap();
    /// let jacobian = map.jacobian(&[0.5, 0.0], &mut |_| true).unwrap(); // a quarter turn
    /// assert!(jacobian[0].abs() < 1e-9 && (jacobian[2] - 1.0).abs() < 1e-9);
    /// ```
    pub fn jacobian(&self, x: &[f64], progress: &mut Progress<'_>) -> Result<Vec<f64>, Error> {
        match self.steps() {
            Some(composed) => Ok(composed.jacobians(x, progress)?),
            None => self.in_motion(|motion| Ok(motion.jacobians(x, progress)?)),
        }
    }

    /// From where the points `y` (n x dim) came: `x` with `f(x) = y` and `det J(x) > 0`; with the maps back if `maps`. Where none was found they are
    /// named in `missed`.
    ///
    /// # Errors
    /// As [`Map::jacobian`].
    pub fn inverse_where_found(
        &self,
        y: &[f64],
        maps: bool,
        progress: &mut Progress<'_>,
    ) -> Result<Inverse, Error> {
        match self.steps() {
            Some(composed) => Ok(composed.inverse(y, maps, progress)?),
            None => self.in_motion(|motion| Ok(motion.inverse(y, maps, progress)?)),
        }
    }

    /// The same of points that all came from somewhere.
    ///
    /// # Errors
    /// As [`Map::jacobian`]; where one of them did not, or it was not found: how many, and the first of them.
    pub fn inverse(&self, y: &[f64], maps: bool, progress: &mut Progress<'_>) -> Result<Inverse, Error> {
        let found = self.inverse_where_found(y, maps, progress)?;
        let Some(&first) = found.missed.first() else { return Ok(found) };
        let dim = self.weights().dim();
        let place = tuple(&y[dim * first..][..dim], |c| general(c, 6));
        Err(Error::argument(format!(
            "points: no place was found that goes to {} of {}, as where the map folds; the first is point {first}, {place}",
            found.missed.len(),
            y.len() / dim
        )))
    }

    /// Calls `work` with the map, of one step, as the core has it.
    fn in_motion<R>(&self, work: impl FnOnce(&Motion<'_>) -> Result<R, Error>) -> Result<R, Error> {
        let settings = &self.session().settings;
        if settings.relax > 0.0 {
            return Err(Error::argument(
                "relax: a map with an elastic finish has neither inverse nor Jacobian here; set relax to 0",
            ));
        }
        let (aim, posed) = (self.aim()?, self.session().posed());
        work(&Motion::new(self.weights(), posed.aimed(&aim), settings.temperature, settings.transform)?)
    }
}
