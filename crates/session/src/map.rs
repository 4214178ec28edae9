//! A fitted session: a map of space, `f: R^d -> R^d`, whatever file it is applied to.

use std::sync::Arc;

use neuralmls_core::{
    progress::Progress, Aim, Composed, Deformed, Deformer, Elastic, Frame, Handles, PointTree, Pose, Relaxed,
    Shape, Soft, Trained, Transform, Watched, Weights,
};

use crate::{Bounds, Error, HandlesSetting, Session};

/// A control point that is farther from where it was to go than this part of the longest side has not arrived.
pub(crate) const ARRIVED: f64 = 1e-6;

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
    /// Of a map that was fitted with `no_folds`: where folds are looked for.
    watched: Option<Arc<Watched>>,
    /// With `no_folds`: the steps.
    composed: Option<Arc<Composed>>,
}

/// The part of a fit with `no_folds` that is its first training, for its progress.
const FIRST_FIT: f64 = 0.2;

impl Session {
    /// Fits the weights to the control points: in the session's own frame, else in `bounds`, the box around the shapes, else in the box of
    /// the control points. `shape` is what shape-aware weights learn from, what `relax` takes stiffness from, and where `no_folds` looks for
    /// folds: all points and faces of the shapes.
    ///
    /// # Errors
    /// Where a setting is out of its range, a box has no size; for shape-aware weights, `relax` or `no_folds` without a shape; for `relax`
    /// in 1D.
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
        let first = if self.settings.no_folds { FIRST_FIT } else { 1.0 };
        let weights = self.settings.weights.fit(&p, dim, frame, shape, &mut |done| progress(first * done))?;
        let further = &mut |done| progress(first + (1.0 - first) * done);
        Map::of_shape(session, Arc::new(weights), shape, further)
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
        Map::over_shape(session, weights, None)
    }

    /// The same, of a session that may have `relax` or `no_folds` set, which need the shape.
    ///
    /// # Errors
    /// As [`Map::over`]; for `relax` or `no_folds` without a shape; for `relax` in 1D.
    pub fn over_shape(
        session: Session,
        weights: Arc<Weights>,
        shape: Option<Shape<'_>>,
    ) -> Result<Map, Error> {
        Map::of_shape(session, weights, shape, &mut |_| true)
    }

    fn of_shape(
        session: Session,
        weights: Arc<Weights>,
        shape: Option<Shape<'_>>,
        progress: &mut Progress<'_>,
    ) -> Result<Map, Error> {
        let needed = |why: &str| shape.ok_or_else(|| Error::argument(format!("shapes: {why}")));
        let elastic = match session.settings.relax > 0.0 {
            true => {
                let shape = needed("relax needs at least one shape, whose stiffness decides")?;
                Some(Arc::new(Elastic::new(&weights, shape)?))
            }
            false => None,
        };
        let watched = match session.settings.no_folds {
            true => {
                let shape = needed("no_folds needs at least one shape, where folds are looked for")?;
                Some(Arc::new(Watched::new(shape.x, weights.dim(), shape.faces)?))
            }
            false => None,
        };
        Map::made(session, weights, elastic, watched)?.unfolded(progress)
    }

    /// The same, of what a file holds.
    pub(crate) fn of_file(
        session: Session,
        weights: Weights,
        elastic: Option<Elastic>,
        watched: Option<Watched>,
        composed: Option<Composed>,
    ) -> Result<Map, Error> {
        let map = Map::made(session, Arc::new(weights), elastic.map(Arc::new), watched.map(Arc::new))?;
        if map.session.settings.no_folds != composed.is_some() {
            return Err(Error::argument("no_folds: expected the steps of the map with it, and none without"));
        }
        Ok(Map { composed: composed.map(Arc::new), ..map })
    }

    /// Without the steps, where there are any.
    fn made(
        session: Session,
        weights: Arc<Weights>,
        elastic: Option<Arc<Elastic>>,
        watched: Option<Arc<Watched>>,
    ) -> Result<Map, Error> {
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
        if session.settings.no_folds && watched.is_none() {
            return Err(Error::argument(
                "no_folds: the map was fitted without, and knows no shape; fit it with no_folds",
            ));
        }
        let handles = Arc::new(Handles::new(&weights, session.settings.transform)?);
        Ok(Map { session, weights, handles, elastic, watched, composed: None })
    }

    /// With the steps that `no_folds` asks for.
    fn unfolded(self, progress: &mut Progress<'_>) -> Result<Map, Error> {
        let Some(watched) = self.watched.as_ref().filter(|_| self.session.settings.no_folds) else {
            return Ok(self);
        };
        let composed = self.session.unfold(self.weights.clone(), watched, progress)?;
        Ok(Map { composed: Some(Arc::new(composed)), ..self })
    }

    /// The same weights with other targets, transform, temperature, handles, `relax` or `no_folds`; with `no_folds` the steps are searched for
    /// anew.
    ///
    /// # Errors
    /// Where the control points at rest or the settings of the weights are others, or `relax` or `no_folds` is set and was not at the fit: these
    /// need a fit.
    pub fn with(&self, session: Session) -> Result<Map, Error> {
        if session.settings.weights != self.session.settings.weights {
            return Err(Error::argument("weights: the map was fitted with other weights"));
        }
        let session = Session { frame: self.session.frame.clone(), ..session };
        let same_way = session.points == self.session.points && session.settings == self.session.settings;
        if same_way
            || session.points.sources() == self.weights.control_points()
                && session.settings.transform == self.session.settings.transform
                && (session.settings.relax == 0.0 || self.elastic.is_some())
                && !session.settings.no_folds
        {
            session.settings.check()?;
            let composed = self.composed.clone().filter(|_| same_way);
            return Ok(Map { session, composed, ..self.clone() });
        }
        let map = Map::made(session, self.weights.clone(), self.elastic.clone(), self.watched.clone())?;
        map.unfolded(&mut |_| true)
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

    /// Where it looks for folds, where it was fitted with `no_folds`.
    pub fn watched(&self) -> Option<&Watched> {
        self.watched.as_deref()
    }

    /// Its steps, with `no_folds`, and what was found of them.
    pub fn composed(&self) -> Option<&Composed> {
        self.composed.as_deref()
    }

    /// The same where they are more than one, so that the map is another one than without.
    pub(crate) fn steps(&self) -> Option<&Arc<Composed>> {
        self.composed.as_ref().filter(|composed| composed.steps().len() > 1)
    }

    /// Where the control points land, and the local maps there.
    ///
    /// # Errors
    /// As [`Map::aim`].
    pub fn landed(&self, aim: &Aim) -> Result<Deformed, Error> {
        let (posed, temperature) = (self.session.posed(), self.session.settings.temperature);
        match self.steps() {
            Some(composed) => Ok(composed.land()?),
            None => Ok(self.handles.land_with_maps(posed.aimed(aim), temperature)?),
        }
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

    /// Where to aim so that the control points arrive, as closely as the handles and each one's weight say; with several steps, in the first.
    ///
    /// # Errors
    /// Where the orientations do not fit.
    pub fn aim(&self) -> Result<Aim, Error> {
        if let Some(composed) = self.steps() {
            let misses = composed.misses().to_vec();
            let farthest = (0..misses.len()).max_by(|&a, &b| misses[a].total_cmp(&misses[b]));
            let unreached = farthest.filter(|&i| misses[i] > ARRIVED * self.side());
            let soft = unreached.map(|i| Soft::Unreached(i, misses[i]));
            return Ok(Aim { targets: composed.steps()[0].targets.clone(), misses, soft });
        }
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
        if let Some(composed) = self.steps() {
            return Ok(composed.deform(bound, maps, progress)?);
        }
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
        if let Some(composed) = self.steps() {
            return Ok(composed.deform_into(bound, y, maps, progress)?);
        }
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
