//! A fitted session: a map of space, `f: R^d -> R^d`, whatever file it is applied to.

use std::sync::Arc;

use neuralmls_core::{
    progress::Progress, Aim, Deformed, Deformer, Elastic, Frame, Handles, PointTree, Pose, Relaxed, Shape,
    Trained, Transform, Weights,
};

use crate::{Bounds, Error, HandlesSetting, Session};

/// Control points, the weights that were fitted to them, and what is set: where each point of space goes.
///
/// The weights are trained in the session's frame, so that the same session gives the same map on every file. What only moves the control
/// points or changes the transform, the temperature or the handles needs no new fit: [`Map::with`].
///
/// ```
/// use neuralmls_session::{read, WeightsSettings};
/// let mut session = read(b"name,x,y,target_x,target_y\na,0,0,0,0\nb,1,0,0,1\n", "points.csv").unwrap().session;
/// session.settings.weights = WeightsSettings::InverseDistance { alpha: 1.0, epsilon: 0.0 };
/// let map = session.fit(None, None, &mut |_| true).unwrap();
/// let moved = map.at(&[0.5, 0.0], &mut |_| true).unwrap(); // half of the way, turned by a quarter
/// assert!((moved[0] - 0.0).abs() < 1e-9 && (moved[1] - 0.5).abs() < 1e-9);
/// ```
#[derive(Clone)]
pub struct Map {
    session: Session,
    weights: Arc<Weights>,
    handles: Arc<Handles>,
    /// Of a map that was fitted with `relax`.
    elastic: Option<Arc<Elastic>>,
}

impl Session {
    /// Fits the weights to the control points: in the session's own frame, else in `bounds`, the box around the shapes, else in the box of
    /// the control points. `shape` is what shape-aware weights learn from, and what `relax` takes stiffness from: all points and faces of the
    /// shapes.
    ///
    /// # Errors
    /// Where a setting is out of its range, a box has no size; for shape-aware weights or `relax` without a shape; for `relax` in 1D.
    pub fn fit(
        &self,
        bounds: Option<&Bounds>,
        shape: Option<Shape<'_>>,
        progress: &mut Progress<'_>,
    ) -> Result<Map, Error> {
        self.settings.check()?;
        let mut session = self.clone();
        session.frame = self.frame.clone().or_else(|| bounds.cloned());
        let (p, dim) = (self.points.sources(), self.points.dim());
        let frame = match &session.frame {
            Some(bounds) => bounds.frame(dim)?,
            None => Frame::around(&p, dim),
        };
        let weights = self.settings.weights.fit(&p, dim, frame, shape, progress)?;
        Map::over_shape(session, Arc::new(weights), shape)
    }
}

impl Session {
    /// Where to aim so that control points arrive as closely as the handles and each one's weight say; `handles` are those of a map of this
    /// session, or of its logits elsewhere.
    ///
    /// # Errors
    /// Where the targets do not fit.
    pub fn aim(&self, handles: &Handles, pose: Pose<'_>) -> Result<Aim, Error> {
        let (temperature, adherence) = (self.settings.temperature, self.adherence());
        Ok(match self.settings.handles {
            HandlesSetting::Exact => handles.aim(pose, temperature, &adherence)?,
            _ => handles.aim_carefully(pose, temperature, &adherence)?,
        })
    }

    /// How much of the way each control point is taken from where plain moving least squares takes it to its target.
    pub(crate) fn adherence(&self) -> Vec<f64> {
        let all = match self.settings.handles {
            HandlesSetting::Auto | HandlesSetting::Exact => 1.0,
            HandlesSetting::Soft => 0.0,
            HandlesSetting::Part(part) => part,
        };
        self.points.weights().into_iter().map(|weight| all * weight).collect()
    }
}

impl Map {
    /// The map of weights that were fitted already.
    ///
    /// # Errors
    /// Where they are of another kind, or belong to other control points.
    pub fn of(session: Session, weights: Weights) -> Result<Map, Error> {
        Map::over(session, Arc::new(weights))
    }

    /// The same, of weights that are shared.
    ///
    /// # Errors
    /// Where they are of another kind, or belong to other control points.
    pub fn over(session: Session, weights: Arc<Weights>) -> Result<Map, Error> {
        Map::made(session, weights, None)
    }

    /// The same, of a session that may have `relax` set, which takes its stiffness from the shape.
    ///
    /// # Errors
    /// As [`Map::over`]; for `relax` without a shape, or in 1D.
    pub fn over_shape(
        session: Session,
        weights: Arc<Weights>,
        shape: Option<Shape<'_>>,
    ) -> Result<Map, Error> {
        if session.settings.relax == 0.0 {
            return Map::over(session, weights);
        }
        let shape = shape.ok_or_else(|| {
            Error::argument("shapes: relax needs at least one shape, whose stiffness decides")
        })?;
        let elastic = Elastic::new(&weights, shape)?;
        Map::made(session, weights, Some(Arc::new(elastic)))
    }

    /// The same, of an elastic shape too.
    pub(crate) fn elastic(
        session: Session,
        weights: Weights,
        elastic: Option<Elastic>,
    ) -> Result<Map, Error> {
        Map::made(session, Arc::new(weights), elastic.map(Arc::new))
    }

    fn made(session: Session, weights: Arc<Weights>, elastic: Option<Arc<Elastic>>) -> Result<Map, Error> {
        session.settings.check()?;
        let (expected, found) = (session.settings.weights.kind(), weights.kind());
        if found != expected {
            return Err(Error::argument(format!(
                "weights: the session has {expected} ones, found {found} ones"
            )));
        }
        if weights.control_points() != session.points.sources() {
            return Err(Error::argument("the weights were fitted to other control points at rest"));
        }
        if session.settings.relax > 0.0 && elastic.is_none() {
            return Err(Error::argument(
                "relax: the map was fitted without, and knows no shape; fit it with relax above 0",
            ));
        }
        let handles = Arc::new(Handles::new(&weights, session.settings.transform)?);
        Ok(Map { session, weights, handles, elastic })
    }

    /// The same weights with other targets, transform, temperature, handles or `relax`.
    ///
    /// # Errors
    /// Where the control points at rest or the settings of the weights are others, or `relax` is above 0 and was not at the fit: these need a
    /// fit.
    pub fn with(&self, session: Session) -> Result<Map, Error> {
        if session.settings.weights != self.session.settings.weights {
            return Err(Error::argument("weights: the map was fitted with other weights"));
        }
        let session = Session { frame: self.session.frame.clone(), ..session };
        if session.points.sources() == self.weights.control_points()
            && session.settings.transform == self.session.settings.transform
            && (session.settings.relax == 0.0 || self.elastic.is_some())
        {
            session.settings.check()?;
            return Ok(Map { session, ..self.clone() });
        }
        Map::made(session, self.weights.clone(), self.elastic.clone())
    }

    /// The control points, the settings, and the frame in which the weights were trained.
    pub fn session(&self) -> &Session {
        &self.session
    }

    /// The weights.
    pub fn weights(&self) -> &Weights {
        &self.weights
    }

    /// What the training of a network left, where the weights are one.
    pub fn trained(&self) -> Option<&Trained> {
        match &*self.weights {
            Weights::Neural(trained) | Weights::ShapeAware(trained) => Some(trained),
            Weights::InverseDistance(_) => None,
        }
    }

    /// The weights, shared.
    pub fn shared_weights(&self) -> Arc<Weights> {
        self.weights.clone()
    }

    /// What it knows of the shape's stiffness, where it was fitted with `relax`.
    pub fn shared_elastic(&self) -> Option<Arc<Elastic>> {
        self.elastic.clone()
    }

    /// Where the nodes of the elastic shape go with what [`Map::aim`] found; `None` without `relax`, or where nothing moves.
    ///
    /// # Errors
    /// As [`Map::aim`].
    pub fn relaxed(&self, aim: &Aim) -> Result<Option<Relaxed>, Error> {
        let settings = &self.session.settings;
        let Some(elastic) = self.elastic.as_ref().filter(|_| settings.relax > 0.0) else { return Ok(None) };
        let posed = self.session.posed();
        Ok(elastic.relax(posed.aimed(aim), settings.temperature, settings.transform)?)
    }

    /// The control points as points that are moved themselves.
    pub fn handles(&self) -> &Handles {
        &self.handles
    }

    /// The longest side of the frame: what lengths are measured by.
    pub fn side(&self) -> f64 {
        2.0 * self.weights.frame().half
    }

    /// The local map that is set.
    pub fn transform(&self) -> Transform {
        self.session.settings.transform
    }

    /// Where to aim so that the control points arrive, as closely as the handles and each one's weight say.
    ///
    /// # Errors
    /// Where the orientations do not fit.
    pub fn aim(&self) -> Result<Aim, Error> {
        self.session.aim(&self.handles, self.session.posed().pose())
    }

    /// Binds the points `x` (n x dim); `tree`, where there is one, holds the same points.
    ///
    /// # Errors
    /// Where they do not fit, or there is not enough memory; [`neuralmls_core::Error::Cancelled`].
    pub fn bind(
        &self,
        x: Vec<f64>,
        tree: Option<&PointTree>,
        progress: &mut Progress<'_>,
    ) -> Result<Deformer, Error> {
        let bound = Deformer::new(x, &self.weights, tree, self.transform(), progress)?;
        match &self.elastic {
            Some(elastic) => Ok(bound.lifted(elastic)?),
            None => Ok(bound),
        }
    }

    /// Where bound points go with what [`Map::aim`] found; with the local maps if `maps`.
    ///
    /// # Errors
    /// As [`Deformer::deform`]; with `relax`, where the points were bound by a map that was fitted without.
    pub fn deform(
        &self,
        bound: &Deformer,
        aim: &Aim,
        maps: bool,
        progress: &mut Progress<'_>,
    ) -> Result<Deformed, Error> {
        let (settings, posed) = (&self.session.settings, self.session.posed());
        let mut deformed = bound.deform(posed.aimed(aim), settings.temperature, maps, progress)?;
        if let Some(relaxed) = self.relaxed(aim)? {
            let maps = deformed.maps.as_deref_mut();
            bound.relax(&relaxed, settings.relax, &mut deformed.positions, maps)?;
        }
        Ok(deformed)
    }

    /// [`Map::deform`] into memory that the caller has: `y` (n x dim), and `maps` (n x dim x dim) where they are wanted.
    ///
    /// # Errors
    /// As [`Map::deform`], and where `y` or `maps` have another size. What they hold then is not a result.
    pub fn deform_into(
        &self,
        bound: &Deformer,
        aim: &Aim,
        y: &mut [f64],
        mut maps: Option<&mut [f64]>,
        progress: &mut Progress<'_>,
    ) -> Result<(), Error> {
        let (settings, posed) = (&self.session.settings, self.session.posed());
        bound.deform_into(posed.aimed(aim), settings.temperature, y, maps.as_deref_mut(), progress)?;
        if let Some(relaxed) = self.relaxed(aim)? {
            bound.relax(&relaxed, settings.relax, y, maps)?;
        }
        Ok(())
    }

    /// Where the points `x` (n x dim) go.
    ///
    /// # Errors
    /// As [`Map::bind`].
    pub fn at(&self, x: &[f64], progress: &mut Progress<'_>) -> Result<Vec<f64>, Error> {
        let bound = self.bind(x.to_vec(), None, progress)?;
        Ok(self.deform(&bound, &self.aim()?, false, progress)?.positions)
    }
}
