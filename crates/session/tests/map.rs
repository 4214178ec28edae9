//! Maps: what a fitted session does, says, and keeps.

use neuralmls_core::{Trained, Weights};
use neuralmls_session::{
    read, Bounds, ControlPoint, ControlPoints, ErrorKind, HandlesSetting, Held, Map, Orientation, Session,
    Settings, Transform, WeightsSettings,
};

const CORNERS: [[f64; 3]; 5] =
    [[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.2, -0.8, -0.5]];

fn session(weights: WeightsSettings) -> Session {
    let list =
        CORNERS.iter().enumerate().map(|(i, at)| ControlPoint::new(format!("p{}", i + 1), at.to_vec()));
    let mut session = Session::new(ControlPoints::new(3, list.collect()).unwrap());
    session.settings.weights = weights;
    session.has_settings = true;
    session
}

fn neural() -> WeightsSettings {
    WeightsSettings::Neural { width: 64, steps: None, seed: 0, rate: 6e-4, fourier_sigma: None }
}

fn classic() -> WeightsSettings {
    WeightsSettings::InverseDistance { alpha: 1.0, epsilon: 0.0 }
}

fn fitted(session: &Session) -> Map {
    let bounds = Bounds::new(vec![-1.0; 3], vec![1.0; 3], 3).unwrap();
    session.fit(Some(&bounds), None, &mut |_| true).unwrap()
}

fn places() -> Vec<f64> {
    (0..300).map(|i| (f64::from(i) * 0.7).sin()).collect()
}

fn moved(session: &Session, name: &str, by: [f64; 3]) -> Session {
    Session { points: session.points.moved(name, &by).unwrap(), ..session.clone() }
}

#[test]
fn unmoved_control_points_return_every_place_bit_for_bit() {
    for weights in [neural(), classic()] {
        let map = fitted(&session(weights));
        assert_eq!(map.at(&places(), &mut |_| true).unwrap(), places());
    }
}

#[test]
fn a_saved_map_is_the_same_map_to_the_bit() {
    for weights in [neural(), classic()] {
        let map = fitted(&moved(&session(weights), "p3", [0.1, 0.4, 0.0]));
        let again = Map::from_bytes(&map.to_bytes()).unwrap();
        assert_eq!(again.session(), map.session());
        assert_eq!(again.weights(), map.weights());
        let x = places();
        assert_eq!(again.at(&x, &mut |_| true).unwrap(), map.at(&x, &mut |_| true).unwrap());
    }
}

/// Fitted to points of a spiral, with the elastic finish.
fn elastic(weights: WeightsSettings, relax: f64) -> Map {
    let mut session = session(weights);
    session.settings.relax = relax;
    let spiral = |i: i32| {
        let t = 0.01 * f64::from(i);
        [t.cos() * t / 6.0, t.sin() * t / 6.0, t / 3.0 - 1.0]
    };
    let x: Vec<f64> = (0..600).flat_map(spiral).collect();
    let bounds = Bounds::new(vec![-1.0; 3], vec![1.0; 3], 3).unwrap();
    let shape = neuralmls_core::Shape { x: &x, faces: &[] };
    moved_map(&session.fit(Some(&bounds), Some(shape), &mut |_| true).unwrap())
}

fn moved_map(map: &Map) -> Map {
    map.with(moved(map.session(), "p3", [0.1, 0.4, 0.0])).unwrap()
}

fn relaxing(map: &Map, relax: f64) -> Map {
    let mut session = map.session().clone();
    session.settings.relax = relax;
    map.with(session).unwrap()
}

#[test]
fn a_saved_elastic_map_is_the_same_map_to_the_bit() {
    for weights in [neural(), classic()] {
        let map = elastic(weights, 0.7);
        let bytes = map.to_bytes();
        let again = Map::from_bytes(&bytes).unwrap();
        assert_eq!(again.to_bytes(), bytes);
        let x = places();
        let found = again.at(&x, &mut |_| true).unwrap();
        assert_eq!(found, map.at(&x, &mut |_| true).unwrap());
        assert_ne!(found, relaxing(&map, 0.0).at(&x, &mut |_| true).unwrap());
    }
}

#[test]
fn relax_slides_from_moving_least_squares_to_the_elastic_shape_and_control_points_stay() {
    let map = elastic(classic(), 1.0);
    let at = |relax: f64, x: &[f64]| relaxing(&map, relax).at(x, &mut |_| true).unwrap();
    let x = places();
    for ((none, half), all) in at(0.0, &x).iter().zip(at(0.5, &x)).zip(at(1.0, &x)) {
        assert!((half - 0.5 * (none + all)).abs() < 1e-12);
    }
    let p = map.session().points.sources();
    for (none, all) in at(0.0, &p).iter().zip(at(1.0, &p)) {
        assert!((none - all).abs() < 1e-9, "{none} {all}");
    }
    let plain = fitted(&session(classic()));
    assert_eq!(plain.at(&p, &mut |_| true).unwrap(), p);
}

#[test]
fn what_no_shape_was_known_for_cannot_relax() {
    let mut session = session(classic());
    session.settings.relax = 0.5;
    let error = session.fit(None, None, &mut |_| true).err().unwrap();
    assert_eq!(error.message, "shapes: relax needs at least one shape, whose stiffness decides");
    let error = fitted(&self::session(classic())).with(session).err().unwrap();
    let expected = "relax: the map was fitted without, and knows no shape; fit it with relax above 0";
    assert_eq!((error.kind, &error.message[..]), (ErrorKind::Argument, expected));
}

/// Two control points that change places, among points of a spiral.
fn unfolded(weights: WeightsSettings) -> Map {
    let mut session = moved(&moved(&session(weights), "p3", [0.1, -1.7, -0.4]), "p5", [-0.2, 1.7, 0.4]);
    session.settings.no_folds = true;
    let bounds = Bounds::new(vec![-1.0; 3], vec![1.0; 3], 3).unwrap();
    let x: Vec<f64> = (0..3000).map(|i| (f64::from(i) * 0.7).sin()).collect();
    let shape = neuralmls_core::Shape { x: &x, faces: &[] };
    session.fit(Some(&bounds), Some(shape), &mut |_| true).unwrap()
}

#[test]
fn a_saved_map_has_all_of_its_steps_to_the_bit() {
    for weights in [neural(), classic()] {
        let map = unfolded(weights);
        let report = map.report(&map.aim().unwrap(), None).unwrap();
        assert!(report.steps > 1 && report.folded == Some(0.0) && report.least.unwrap() > 0.0, "{report:?}");
        assert!(report.control_points.iter().all(|point| point.distance_to_target < 2e-6));
        assert_eq!(report.handles, "exact");
        let bytes = map.to_bytes();
        let again = Map::from_bytes(&bytes).unwrap();
        assert_eq!(again.to_bytes(), bytes);
        let x = places();
        let found = again.at(&x, &mut |_| true).unwrap();
        assert_eq!(found, map.at(&x, &mut |_| true).unwrap());
        assert_eq!(again.report(&again.aim().unwrap(), None).unwrap(), report);
        // Other targets are searched for anew, and the same ones found again.
        let other = moved_map(&again);
        assert_ne!(other.at(&x, &mut |_| true).unwrap(), found);
        assert_eq!(other.with(map.session().clone()).unwrap().to_bytes(), bytes);
        let mut one = map.session().clone();
        one.settings.no_folds = false;
        let one = map.with(one).unwrap();
        assert_eq!(one.report(&one.aim().unwrap(), None).unwrap().steps, 1);
        assert_eq!(one.with(map.session().clone()).unwrap().to_bytes(), bytes);
    }
}

#[test]
fn steps_are_undone() {
    let map = unfolded(classic());
    let x = places();
    let y = map.at(&x, &mut |_| true).unwrap();
    let back = map.inverse(&y, false, &mut |_| true).unwrap();
    assert!(back.points.iter().zip(&x).all(|(a, b)| (a - b).abs() < 1e-7)); // logits of points are of single precision
}

#[test]
fn a_map_without_its_steps_is_refused() {
    let bytes = unfolded(classic()).to_bytes();
    for (array, other) in
        [("step1_alpha", "step1_alphb"), ("step0_targets", "step0_targetz"), ("found_at", "found_az")]
    {
        let at = bytes.windows(array.len()).position(|window| window == array.as_bytes()).unwrap();
        let mut broken = bytes.clone();
        broken[at..at + array.len()].copy_from_slice(other.as_bytes());
        assert!(Map::from_bytes(&broken).err().unwrap().message.starts_with("this is no map"), "{array}");
    }
}

#[test]
fn where_no_folds_are_looked_for_there_must_be_a_shape() {
    let mut session = session(classic());
    session.settings.no_folds = true;
    let error = session.fit(None, None, &mut |_| true).err().unwrap();
    assert_eq!(error.message, "shapes: no_folds needs at least one shape, where folds are looked for");
    let error = fitted(&self::session(classic())).with(session).err().unwrap();
    assert_eq!(
        error.message,
        "no_folds: the map was fitted without, and knows no shape; fit it with no_folds"
    );
}

#[test]
fn a_session_keeps_the_frame_in_which_it_was_fitted() {
    let map = fitted(&session(neural()));
    let frame = map.session().frame.clone().unwrap();
    assert_eq!((frame.min, frame.max), (vec![-1.0; 3], vec![1.0; 3]));
    // Fitted again for another shape it is the same map of space.
    let other = Bounds::new(vec![-9.0; 3], vec![9.0; 3], 3).unwrap();
    let again = map.session().fit(Some(&other), None, &mut |_| true).unwrap();
    assert_eq!(again.weights(), map.weights());
}

#[test]
fn other_targets_and_settings_need_no_fit_and_other_weights_are_refused() {
    let map = fitted(&session(neural()));
    let further = moved(map.session(), "p1", [0.0, 0.5, 0.0]);
    let settings = Settings { transform: Transform::Affine, temperature: 2.0, ..further.settings.clone() };
    let with = map.with(Session { settings, ..further }).unwrap();
    assert_eq!(with.weights(), map.weights());
    assert_ne!(with.at(&places(), &mut |_| true).unwrap(), places());
    let error = map.with(session(classic())).err().unwrap();
    assert_eq!(error.kind, ErrorKind::Argument);
    assert_eq!(error.message, "weights: the map was fitted with other weights");
}

#[test]
fn handles_say_how_closely_control_points_arrive() {
    let to = |handles: HandlesSetting| {
        let mut session = moved(&session(neural()), "p3", [0.0, 0.3, 0.0]);
        session.settings.handles = handles;
        let map = fitted(&session);
        let report = map.report(&map.aim().unwrap(), None).unwrap();
        (report.control_points[2].distance_to_target, report.handles)
    };
    let (soft, said) = to(HandlesSetting::Soft);
    assert_eq!(said, "soft");
    let (half, said) = to(HandlesSetting::Part(0.5));
    assert_eq!(said, "0.5 of the way");
    let (auto, said) = to(HandlesSetting::Auto);
    assert_eq!(said, "exact");
    assert!(soft > 1e-3 && auto < 1e-6, "{soft} {auto}");
    assert!((half - 0.5 * soft).abs() < 1e-6, "{half} of {soft}");
}

#[test]
fn a_point_of_little_weight_is_met_less_closely() {
    let with = |weight: f64| {
        let session = moved(&session(neural()), "p3", [0.0, 0.3, 0.0]);
        let mut list = session.points.into_list();
        list[2].weight = weight;
        let map = fitted(&Session::new(ControlPoints::new(3, list).unwrap()));
        let report = map.report(&map.aim().unwrap(), None).unwrap();
        let said = if weight < 1.0 { "as closely as their weights say" } else { "exact" };
        assert_eq!(report.handles, said);
        report.control_points[2].distance_to_target
    };
    let (none, half, whole) = (with(0.0), with(0.5), with(1.0));
    assert!(none > half && half > whole && whole < 1e-6, "{none} {half} {whole}");
}

#[test]
fn what_a_file_cannot_hold_is_what_is_reported() {
    let far = |c: &mut f64| *c += 5e6;
    let mut list = session(classic()).points.into_list();
    list.iter_mut().for_each(|point| point.position.iter_mut().chain(&mut point.target).for_each(far));
    list[0].target[0] += 0.05;
    let mut session = Session::new(ControlPoints::new(3, list).unwrap());
    session.settings.weights = classic();
    let map = session.fit(None, None, &mut |_| true).unwrap();
    let round = |x: &[f64]| x.iter().map(|c| f64::from(*c as f32)).collect::<Vec<_>>();
    let held = Held { format: "PLY", round: &round, step: 0.5 };
    let report = map.report(&map.aim().unwrap(), Some(&held)).unwrap();
    assert!((report.control_points[0].distance_to_target - 0.05).abs() < 1e-6);
    assert!(
        report.warnings[0].contains("this PLY file holds coordinates in steps of 0.5 here"),
        "{report:?}"
    );
}

/// A map whose network did not learn so much of what each control point was to have.
fn missing(parts: &[f64]) -> Map {
    let mut session = session(neural());
    let Weights::Neural(trained) = fitted(&session).weights().clone() else { panic!("a network") };
    session.settings.weights = WeightsSettings::ShapeAware { seed: 0 };
    Map::of(session, Weights::ShapeAware(Trained { missed: parts.to_vec(), ..trained })).unwrap()
}

#[test]
fn what_a_network_did_not_learn_is_said_where_it_is_more_than_negligible() {
    let said = |parts: &[f64]| {
        let map = missing(parts);
        map.report(&map.aim().unwrap(), None).unwrap().warnings
    };
    for little in [&[][..], &[0.0; 5], &[0.003, 0.0, 0.003, 0.003, 0.0]] {
        assert!(said(little).is_empty());
    }
    let warnings = said(&[0.001, 0.02, 0.0, 0.04, 0.0]);
    assert_eq!(warnings.len(), 1);
    assert!(warnings[0].starts_with("6.1 % of the shape does not follow"), "{warnings:?}");
    assert!(warnings[0].contains("above all 'p4' and 'p2':"), "{warnings:?}");
}

#[test]
fn what_a_network_did_not_learn_is_kept_and_maps_without_it_are_read() {
    for parts in [&[0.0, 0.01, 0.0, 0.02, 0.0][..], &[]] {
        let map = missing(parts);
        let again = Map::from_bytes(&map.to_bytes()).unwrap();
        assert_eq!(again.weights(), map.weights());
        assert_eq!(again.to_bytes(), map.to_bytes());
    }
    for (parts, why) in
        [(&[2.0; 5][..], "missed: expected parts from 0 to 1"), (&[0.1; 4], "missed: expected F64 [5]")]
    {
        let error = Map::from_bytes(&missing(parts).to_bytes()).err().unwrap();
        assert!(error.message.contains(why), "{error}");
    }
}

#[test]
fn the_angle_that_a_rotation_misses_is_told() {
    let mut session = session(classic());
    let quarter = Orientation::new([0.0, 0.0, 1.0], 90.0, 1.0).unwrap();
    session.points = session.points.oriented("p2", quarter).unwrap();
    let map = fitted(&session);
    let report = map.report(&map.aim().unwrap(), None).unwrap();
    let told = report.control_points[1].orientation.clone().unwrap();
    assert_eq!((told.degrees, told.scale), (90.0, 1.0));
    assert!(told.degrees_to_rotation < 1e-3, "{told:?}");
    assert_eq!(report.control_points[0].orientation, None);
}

#[test]
fn advice_names_a_fold_and_who_is_about_it() {
    let p = read(b"name,x,y\na,0,0\nb,0.4,0.5\nc,0.6,0.5\nd,1,1\n", "p.csv").unwrap().session;
    let mut session = Session { points: p.points.moved("b", &[0.5, 0.0]).unwrap(), ..p };
    session.points = session.points.moved("c", &[-0.5, 0.0]).unwrap();
    session.settings.weights = classic();
    let map = session.fit(None, None, &mut |_| true).unwrap();
    let x: Vec<f64> = (0..1000).flat_map(|i| [f64::from(i % 37) / 36.0, f64::from(i / 37) / 27.0]).collect();
    let found = map.advise(&map.probe(&x, &[]).unwrap(), &mut || None, true).unwrap();
    let fold = found.iter().find(|advice| advice.kind == "folds").unwrap();
    assert!(fold.sentence.ends_with("steps, with no_folds, it is 0 %"), "{}", fold.sentence);
    assert!(fold.sentence.contains("of the shape is folded over, most of all near '"), "{}", fold.sentence);
    assert!(fold.control_points.iter().all(|i| [1, 2].contains(i)), "{fold:?}");
}

#[test]
fn files_that_are_no_maps_are_refused_in_a_sentence() {
    let whole = fitted(&session(neural())).to_bytes();
    let mut hostile: Vec<Vec<u8>> =
        vec![Vec::new(), b"v 0 0 0\n".to_vec(), whole[..whole.len() / 2].to_vec()];
    hostile.push((u64::MAX.to_le_bytes()).to_vec());
    let (at, _) = whole.windows(7).enumerate().find(|(_, bytes)| bytes == b"weight0").unwrap();
    let mut renamed = whole.clone();
    renamed[at + 6] = b'9';
    hostile.push(renamed);
    for bytes in hostile {
        let error = Map::from_bytes(&bytes).err().unwrap();
        assert_eq!(error.kind, ErrorKind::File);
        assert!(error.message.starts_with("this is no map that was saved by NeuralMLS: "), "{error}");
        assert!(!error.message.contains('\n'));
    }
}

#[test]
fn a_map_is_no_file_of_control_points_and_is_called_what_it_is() {
    for weights in [neural(), classic()] {
        let error = read(&fitted(&session(weights)).to_bytes(), "points.map").err().unwrap();
        assert_eq!(error.kind, ErrorKind::File);
        assert_eq!(
            error.message,
            "this is a saved map, not control points: `neuralmls deform --map` takes it"
        );
    }
}

#[test]
fn shape_aware_weights_are_refused_where_no_shape_is_known() {
    let error =
        session(WeightsSettings::ShapeAware { seed: 0 }).fit(None, None, &mut |_| true).err().unwrap();
    assert!(error.message.contains("shape-aware weights need at least one shape to learn from"), "{error}");
}

/// p1 and p2 in a group, or locked, and what a map's local maps are between them, at p3, and far from both.
fn held(session: &Session, at: [f64; 3]) -> (Vec<f64>, Vec<f64>) {
    let map = fitted(session);
    let bound = map.bind(at.to_vec(), None, &mut |_| true).unwrap();
    let deformed = map.deform(&bound, &map.aim().unwrap(), true, &mut |_| true).unwrap();
    (deformed.positions, deformed.maps.unwrap())
}

#[test]
fn what_is_around_a_group_turns_with_it() {
    let free = session(classic());
    let points = free.points.grouped(&["p3".into(), "p4".into()], Some("tips")).unwrap();
    let tips = Session { points, ..free.clone() };
    let quarter = Orientation::new([1.0, 0.0, 0.0], 90.0, 1.0).unwrap();
    let turned = tips.points.oriented("tips", quarter).unwrap();
    let as_one = Session { points: turned.clone(), ..tips.clone() };
    let each = Session { points: turned.grouped(&["p3".into(), "p4".into()], None).unwrap(), ..free };
    let off = |session: &Session| {
        let (_, map) = held(session, [0.0, 0.97, 0.02]);
        let maps = map.iter().zip(quarter.matrix());
        maps.map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
    };
    assert!(off(&as_one) < 0.1, "{}", off(&as_one));
    assert!(off(&each) > 2.0 * off(&as_one), "{}", off(&each));
    let report = fitted(&as_one).report(&fitted(&as_one).aim().unwrap(), None).unwrap();
    assert_eq!((report.handles.as_str(), report.warnings), ("exact", vec![]));
}

#[test]
fn a_locked_control_point_stays_and_what_is_around_it_does_not_turn() {
    let pulled = moved(&moved(&session(classic()), "p1", [0.5, 0.9, 0.0]), "p3", [0.9, 0.0, 0.0]);
    let locked = Session { points: pulled.points.with_locked(&["p3".into()]).unwrap(), ..pulled.clone() };
    let plain = Session {
        points: locked
            .points
            .with_targets(&{
                let mut q = pulled.points.targets();
                q[6..9].copy_from_slice(&CORNERS[2]);
                q
            })
            .unwrap()
            .with_locked(&[])
            .unwrap(),
        ..pulled
    };
    let off = |session: &Session| {
        let (place, map) = held(session, CORNERS[2]);
        let from_identity =
            map.iter().enumerate().map(|(at, e)| (e - f64::from(u8::from(at % 4 == 0))).powi(2));
        (place, from_identity.sum::<f64>().sqrt())
    };
    let ((held_at, held_by), (_, free_by)) = (off(&locked), off(&plain));
    assert!(held_at.iter().zip(CORNERS[2]).all(|(a, b)| (a - b).abs() < 1e-6), "{held_at:?}");
    assert!(held_by < 1e-3 && free_by > 0.05, "{held_by} {free_by}");
    let map = fitted(&locked);
    let report = map.report(&map.aim().unwrap(), None).unwrap();
    assert_eq!(report.control_points[2].moved, 0.0);
    assert!(
        report.warnings[0].contains("the targets and rotations of 'p3' are not used"),
        "{:?}",
        report.warnings
    );
}
