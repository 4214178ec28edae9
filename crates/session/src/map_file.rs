//! Saved maps: a safetensors file, of the weights bit for bit, with the session as its metadata. Reading it executes nothing, and every
//! array's type and shape are checked before it is read.
//!
//! | array | type, shape | of |
//! |---|---|---|
//! | `control_points` | f64 (m, d) | all |
//! | `centre`, `half` | f64 (d), (1) | all: the frame |
//! | `weight0` to `weight2`, `bias0` to `bias2` | f32 (outputs, inputs), (outputs) | networks |
//! | `frequencies` | f32 (k, d) | networks: of the Fourier features, k = 0 without |
//! | `losses`, `loss` | f64 (steps), (1) | networks |
//! | `missed` | f64 (m) | shape-aware, where it was measured at the fit |
//! | `alpha`, `epsilon` | f64 (1) | inverse distance |
//! | `elastic_nodes`, `elastic_areas` | f64 (k, d), (k) | maps that were fitted with `relax` |
//! | `elastic_links`, `elastic_stiffness` | u32 (l, 2), f64 (l) | the same |
//! | `watched` | f64 (k, d) | maps that were fitted with `no_folds`: places of the shape |
//! | `step0_targets`, `step0_orientations` | f64 (m, d), (m, d, d) | maps with `no_folds`: where the first step aims, and how, if they are oriented |
//! | `step1_targets` and so on | the same, and all of the step's weights | the further steps, up to 63: the arrays above with `step1_` before |
//! | `misses` | f64 (m) | maps with `no_folds`: how far each control point stays from where it was to go |
//! | `found`, `found_at` | f64 (3), (d) | the same: the least det J, the folded parts of the shape and of what is around it, and where |
//!
//! Its one entry of metadata, `neuralmls-map`, is JSON: `version`, `weights` (their kind), and `session`, a session file; a file of weights alone
//! has none. (One entry, since several would be written in any order, and the same map is to be the same bytes.)

use std::borrow::Cow;
use std::collections::HashMap;
use std::rc::Rc;
use std::sync::Arc;

use neuralmls_core::{
    Body, Composed, Elastic, Found, Frame, InverseDistance, Layer, Network, Step, Trained, Watched, Weights,
    MOST_CONTROL_POINTS,
};
use safetensors::tensor::{serialize, Dtype, SafeTensors, TensorView, View};
use serde_json::{json, Value};

use crate::files::MAP_METADATA;
use crate::{read, Error, Map, Session};

const VERSION: u64 = 1;
/// Of maps with steps, which a reader of the first version would take for their first one alone.
const WITH_STEPS: u64 = 2;

impl Map {
    /// The map as a file.
    pub fn to_bytes(&self) -> Vec<u8> {
        let dim = self.weights().dim();
        let mut arrays = weight_arrays(self.weights());
        arrays.extend(self.shared_elastic().iter().flat_map(|elastic| body_arrays(elastic.body(), dim)));
        if let Some(watched) = self.watched() {
            let places = watched.places();
            arrays.push(("watched".into(), Array::doubles(&[places.len() / dim, dim], places)));
        }
        arrays.extend(self.composed().iter().flat_map(|composed| step_arrays(composed, dim)));
        let version = if self.composed().is_some() { WITH_STEPS } else { VERSION };
        write(
            arrays,
            json!({"version": version, "weights": self.weights().kind()}),
            Some(self.session().to_json()),
        )
    }

    /// Reads what [`Map::to_bytes`] wrote.
    ///
    /// # Errors
    /// Where it is no such file.
    pub fn from_bytes(bytes: &[u8]) -> Result<Map, Error> {
        let Parsed { arrays, weights, said } = parse(bytes)?;
        let session = said.get("session").map(Value::to_string);
        let session = session.ok_or_else(|| broken("it holds weights without a session: it is no map"))?;
        let read = read(session.as_bytes(), "session.json")
            .map_err(|error| broken(&format!("its session: {error}")))?;
        let session = read.session;
        let body = arrays.has("elastic_nodes").then(|| body(&arrays, weights.dim())).transpose()?;
        let elastic = body.map(|body| Elastic::of(&weights, body)).transpose().map_err(refused)?;
        let watched = arrays.has("watched").then(|| watched(&arrays, weights.dim())).transpose()?;
        let composed =
            (said["version"] == WITH_STEPS).then(|| composed(&arrays, &weights, &session)).transpose()?;
        Map::of_file(session, weights, elastic, watched, composed).map_err(|error| broken(&error.message))
    }
}

/// Weights alone as a file.
pub fn weights_to_bytes(weights: &Weights) -> Vec<u8> {
    write(weight_arrays(weights), json!({"version": VERSION, "weights": weights.kind()}), None)
}

/// Reads the weights of a file: of weights alone, or of a map.
///
/// # Errors
/// Where it is no such file.
pub fn weights_from_bytes(bytes: &[u8]) -> Result<Weights, Error> {
    Ok(parse(bytes)?.weights)
}

/// An array of a file that is written.
struct Array {
    dtype: Dtype,
    shape: Vec<usize>,
    bytes: Vec<u8>,
}

impl Array {
    fn doubles(shape: &[usize], numbers: &[f64]) -> Array {
        let bytes = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
        Array { dtype: Dtype::F64, shape: shape.to_vec(), bytes }
    }

    fn indices(shape: &[usize], numbers: &[u32]) -> Array {
        let bytes = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
        Array { dtype: Dtype::U32, shape: shape.to_vec(), bytes }
    }

    fn singles(shape: &[usize], numbers: &[f32]) -> Array {
        let bytes = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
        Array { dtype: Dtype::F32, shape: shape.to_vec(), bytes }
    }
}

impl View for &Array {
    fn dtype(&self) -> Dtype {
        self.dtype
    }

    fn shape(&self) -> &[usize] {
        &self.shape
    }

    fn data(&self) -> Cow<'_, [u8]> {
        Cow::Borrowed(&self.bytes)
    }

    fn data_len(&self) -> usize {
        self.bytes.len()
    }
}

/// Arrays of a file, by their names.
type Named = Vec<(String, Array)>;

fn weight_arrays(weights: &Weights) -> Named {
    let (p, dim, frame) = (weights.control_points(), weights.dim(), weights.frame());
    let mut arrays = vec![
        ("control_points".to_string(), Array::doubles(&[p.len() / dim, dim], p)),
        ("centre".into(), Array::doubles(&[dim], &frame.centre[..dim])),
        ("half".into(), Array::doubles(&[1], &[frame.half])),
    ];
    match weights {
        Weights::Neural(trained) | Weights::ShapeAware(trained) => {
            for (i, layer) in trained.network.layers().iter().enumerate() {
                let shape = [layer.bias.len(), layer.inputs()];
                arrays.push((format!("weight{i}"), Array::singles(&shape, &layer.weight)));
                arrays.push((format!("bias{i}"), Array::singles(&shape[..1], &layer.bias)));
            }
            let frequencies = trained.network.frequencies();
            arrays.push(("frequencies".into(), Array::singles(&[frequencies.len() / dim, dim], frequencies)));
            arrays.push(("losses".into(), Array::doubles(&[trained.losses.len()], &trained.losses)));
            arrays.push(("loss".into(), Array::doubles(&[1], &[trained.loss])));
            if !trained.missed.is_empty() {
                arrays.push(("missed".into(), Array::doubles(&[trained.missed.len()], &trained.missed)));
            }
        }
        Weights::InverseDistance(function) => {
            arrays.push(("alpha".into(), Array::doubles(&[1], &[function.alpha()])));
            arrays.push(("epsilon".into(), Array::doubles(&[1], &[function.epsilon()])));
        }
    }
    arrays
}

fn body_arrays(body: &Body, dim: usize) -> Named {
    let Body { nodes, links, stiffness, areas } = body;
    let (nodes_in_all, links_in_all) = (areas.len(), links.len());
    vec![
        ("elastic_nodes".to_string(), Array::doubles(&[nodes_in_all, dim], nodes)),
        ("elastic_areas".into(), Array::doubles(&[nodes_in_all], areas)),
        ("elastic_links".into(), Array::indices(&[links_in_all, 2], links.as_flattened())),
        ("elastic_stiffness".into(), Array::doubles(&[links_in_all], stiffness)),
    ]
}

fn step_arrays(composed: &Composed, dim: usize) -> Named {
    let (found, misses) = (composed.found(), composed.misses());
    let numbers = [found.least, found.folded, found.folded_around];
    let mut arrays = vec![
        ("misses".to_string(), Array::doubles(&[misses.len()], misses)),
        ("found".into(), Array::doubles(&[3], &numbers)),
        ("found_at".into(), Array::doubles(&[dim], &found.place)),
    ];
    for (k, Step { weights, targets, orientations }) in composed.steps().iter().enumerate() {
        let m = misses.len();
        arrays.push((format!("step{k}_targets"), Array::doubles(&[m, dim], targets)));
        if let Some(orientations) = orientations {
            arrays.push((format!("step{k}_orientations"), Array::doubles(&[m, dim, dim], orientations)));
        }
        if k > 0 {
            arrays.extend(
                weight_arrays(weights).into_iter().map(|(name, array)| (format!("step{k}_{name}"), array)),
            );
        }
    }
    arrays
}

fn write(arrays: Named, mut said: Value, session: Option<String>) -> Vec<u8> {
    if let Some(session) = session {
        said["session"] = serde_json::from_str(&session).expect("a session is written as JSON");
    }
    let metadata = HashMap::from([(MAP_METADATA.to_string(), said.to_string())]);
    let views = arrays.iter().map(|(name, array)| (name.as_str(), array));
    serialize(views, Some(metadata)).expect("arrays whose shapes fit their bytes")
}

/// What a file holds.
struct Parsed<'a> {
    arrays: Arrays<'a>,
    weights: Weights,
    said: Value,
}

fn parse(bytes: &[u8]) -> Result<Parsed<'_>, Error> {
    let unread = |error: safetensors::SafeTensorError| broken(&error.to_string());
    let (_, head) = SafeTensors::read_metadata(bytes).map_err(unread)?;
    let tensors = Rc::new(SafeTensors::deserialize(bytes).map_err(unread)?);
    let metadata = head.metadata().as_ref().and_then(|metadata| metadata.get(MAP_METADATA));
    let said: Value = metadata
        .and_then(|text| serde_json::from_str(text).ok())
        .ok_or_else(|| broken("its metadata has no neuralmls-map"))?;
    let arrays = Arrays { tensors, of: String::new() };
    let expected = if arrays.has("step0_targets") { WITH_STEPS } else { VERSION };
    if said["version"].as_u64() != Some(expected) {
        let found = crate::text::shown(&said["version"].to_string());
        return Err(broken(&format!("version: expected {expected}, found {found}")));
    }
    let weights = weights(&arrays, said["weights"].as_str())?;
    Ok(Parsed { arrays, weights, said })
}

fn weights(arrays: &Arrays<'_>, kind: Option<&str>) -> Result<Weights, Error> {
    let shape = arrays.shape("control_points", 2)?;
    let (m, dim) = (shape[0], shape[1]);
    if !(1..=3).contains(&dim) || !(1..=MOST_CONTROL_POINTS).contains(&m) {
        return Err(broken(&format!(
            "control_points: expected 1 to {MOST_CONTROL_POINTS} of 1 to 3 coordinates, found {m} of {dim}"
        )));
    }
    let p = arrays.doubles("control_points", &[m, dim])?;
    if p.iter().any(|c| !c.is_finite()) {
        return Err(broken("control_points: expected finite numbers"));
    }
    let mut frame = Frame { centre: [0.0; 3], half: arrays.number("half")? };
    frame.centre[..dim].copy_from_slice(&arrays.doubles("centre", &[dim])?);
    if !(frame.half > 0.0 && frame.half.is_finite()) || frame.centre.iter().any(|c| !c.is_finite()) {
        return Err(broken("expected a finite frame with a size above 0"));
    }
    let weights = match kind {
        Some(kind @ ("neural" | "shape-aware")) => {
            let trained = Trained {
                network: network(arrays, m, dim, frame)?,
                losses: arrays.doubles("losses", &arrays.shape("losses", 1)?)?,
                loss: arrays.number("loss")?,
                // Of shape-aware weights, since it is measured.
                missed: if arrays.has("missed") { arrays.doubles("missed", &[m])? } else { Vec::new() },
                control_points: p,
            };
            if trained.losses.iter().chain([&trained.loss]).any(|loss| !loss.is_finite()) {
                return Err(broken("losses: expected finite numbers"));
            }
            if trained.missed.iter().any(|part| !(0.0..=1.0).contains(part)) {
                return Err(broken("missed: expected parts from 0 to 1"));
            }
            if kind == "neural" {
                Weights::Neural(trained)
            } else {
                Weights::ShapeAware(trained)
            }
        }
        Some("inverse-distance") => {
            let (alpha, epsilon) = (arrays.number("alpha")?, arrays.number("epsilon")?);
            Weights::InverseDistance(InverseDistance::new(&p, dim, frame, alpha, epsilon).map_err(refused)?)
        }
        _ => return Err(broken("weights: expected neural, shape-aware or inverse-distance")),
    };
    Ok(weights)
}

fn refused(error: neuralmls_core::Error) -> Error {
    broken(&error.to_string())
}

fn watched(arrays: &Arrays<'_>, dim: usize) -> Result<Watched, Error> {
    let count = arrays.shape("watched", 2)?[0];
    Watched::of(arrays.doubles("watched", &[count, dim])?, dim).map_err(refused)
}

fn composed(arrays: &Arrays<'_>, first: &Weights, session: &Session) -> Result<Composed, Error> {
    let (m, dim) = (session.points.len(), first.dim());
    let mut steps: Vec<Step> = Vec::new();
    while arrays.has(&format!("step{}_targets", steps.len())) {
        let of_step = arrays.of_step(steps.len());
        let weights = match steps.is_empty() {
            true => first.clone(),
            false => weights(&of_step, Some(first.kind()))?,
        };
        let oriented = of_step.has("orientations");
        let targets = of_step.doubles("targets", &[m, dim])?;
        if targets.iter().any(|c| !c.is_finite()) {
            return Err(broken("targets: expected finite numbers"));
        }
        steps.push(Step {
            weights: Arc::new(weights),
            targets,
            orientations: oriented.then(|| of_step.doubles("orientations", &[m, dim, dim])).transpose()?,
        });
    }
    let [least, folded, folded_around] = arrays.doubles("found", &[3])?[..] else {
        unreachable!("of this shape")
    };
    let found = Found { least, folded, folded_around, place: arrays.doubles("found_at", &[dim])? };
    let misses = arrays.doubles("misses", &[m])?;
    let said = || [least].into_iter().chain(found.place.iter().copied()).chain(misses.iter().copied());
    if said().any(|number| !number.is_finite())
        || [folded, folded_around].iter().any(|part| !(0.0..=1.0).contains(part))
    {
        return Err(broken("found, found_at, misses: expected finite numbers, and parts from 0 to 1"));
    }
    let settings = &session.settings;
    Composed::of(steps, settings.transform, settings.temperature, misses, found).map_err(refused)
}

fn body(arrays: &Arrays<'_>, dim: usize) -> Result<Body, Error> {
    let nodes = arrays.shape("elastic_nodes", 2)?[0];
    let links = arrays.shape("elastic_links", 2)?[0];
    let (pairs, _) = arrays.bytes("elastic_links", Dtype::U32, &[links, 2])?.as_chunks::<8>();
    let end = |bytes: &[u8]| u32::from_le_bytes(bytes.try_into().expect("four bytes"));
    Ok(Body {
        nodes: arrays.doubles("elastic_nodes", &[nodes, dim])?,
        areas: arrays.doubles("elastic_areas", &[nodes])?,
        links: pairs.iter().map(|pair| [end(&pair[..4]), end(&pair[4..])]).collect(),
        stiffness: arrays.doubles("elastic_stiffness", &[links])?,
    })
}

fn network(arrays: &Arrays<'_>, m: usize, dim: usize, frame: Frame) -> Result<Network, Error> {
    let features = arrays.shape("frequencies", 2)?[0];
    let frequencies = arrays.singles("frequencies", &[features, dim])?;
    let width = arrays.shape("bias0", 1)?[0];
    let second = arrays.shape("bias1", 1)?[0];
    let inputs = dim + 2 * features;
    let mut layers = Vec::with_capacity(3);
    for (i, shape) in [[width, inputs], [second, width], [m, second]].iter().enumerate() {
        let weight = arrays.singles(&format!("weight{i}"), shape)?;
        let bias = arrays.singles(&format!("bias{i}"), &shape[..1])?;
        if weight.iter().chain(&bias).any(|number| !number.is_finite()) {
            return Err(broken(&format!("layer {i}: expected finite numbers")));
        }
        layers.push(Layer { weight, bias });
    }
    let layers: [Layer; 3] = layers.try_into().expect("three layers");
    Network::new(dim, frame, frequencies, layers).map_err(|error| broken(&error.to_string()))
}

/// The arrays of a file; each is asked for with the type and shape that it must have.
struct Arrays<'a> {
    tensors: Rc<SafeTensors<'a>>,
    /// What their names begin with.
    of: String,
}

impl<'a> Arrays<'a> {
    /// Those of a step alone.
    fn of_step(&self, k: usize) -> Arrays<'a> {
        Arrays { tensors: self.tensors.clone(), of: format!("step{k}_") }
    }

    fn tensor(&self, name: &str) -> Result<TensorView<'a>, Error> {
        let name = format!("{}{name}", self.of);
        self.tensors.tensor(&name).map_err(|_| broken(&format!("{name}: there is no such array")))
    }

    fn has(&self, name: &str) -> bool {
        self.tensor(name).is_ok()
    }

    fn shape(&self, name: &str, dimensions: usize) -> Result<Vec<usize>, Error> {
        let array = self.tensor(name)?;
        if array.shape().len() != dimensions {
            let found = array.shape().len();
            return Err(broken(&format!("{name}: expected {dimensions} dimensions, found {found}")));
        }
        Ok(array.shape().to_vec())
    }

    fn bytes(&self, name: &str, dtype: Dtype, shape: &[usize]) -> Result<&'a [u8], Error> {
        let array = self.tensor(name)?;
        if array.dtype() != dtype || array.shape() != shape {
            let (found, has) = (array.dtype(), array.shape());
            return Err(broken(&format!("{name}: expected {dtype:?} {shape:?}, found {found:?} {has:?}")));
        }
        Ok(array.data())
    }

    fn doubles(&self, name: &str, shape: &[usize]) -> Result<Vec<f64>, Error> {
        let (numbers, _) = self.bytes(name, Dtype::F64, shape)?.as_chunks::<8>();
        Ok(numbers.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect())
    }

    fn singles(&self, name: &str, shape: &[usize]) -> Result<Vec<f32>, Error> {
        let (numbers, _) = self.bytes(name, Dtype::F32, shape)?.as_chunks::<4>();
        Ok(numbers.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect())
    }

    fn number(&self, name: &str) -> Result<f64, Error> {
        Ok(self.doubles(name, &[1])?[0])
    }
}

fn broken(why: &str) -> Error {
    Error::file(format!("this is no map that was saved by NeuralMLS: {why}"))
}
