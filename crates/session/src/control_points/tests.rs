use super::*;

fn point(name: &str, position: &[f64]) -> ControlPoint {
    ControlPoint::new(name, position.to_vec())
}

fn seat_and_back() -> ControlPoints {
    ControlPoints::new(2, vec![point("seat", &[0.0, 0.0]), point("back", &[1.0, 0.0])]).unwrap()
}

fn refused(dim: usize, list: Vec<ControlPoint>) -> String {
    let error = ControlPoints::new(dim, list).unwrap_err();
    assert_eq!(error.kind, crate::ErrorKind::ControlPoint);
    error.message
}

#[test]
fn unusable_control_points_are_refused_by_name() {
    assert_eq!(refused(3, vec![]), "there are no control points; at least one is needed");
    assert_eq!(refused(1, vec![point(" ", &[0.0])]), "control point 1 has no name");
    let twice = vec![point("a", &[0.0]), point("a", &[1.0])];
    assert_eq!(refused(1, twice), "the name 'a' is given to more than one control point");
    let together = vec![point("a", &[0.0, 0.95]), point("b", &[-0.0, 0.95])];
    assert_eq!(refused(2, together), "'a' and 'b' are at the same place, (0, 0.95)");
    let endless = vec![point("a", &[0.0, f64::INFINITY])];
    assert_eq!(refused(2, endless), "the position of 'a' is not finite: (0.0, inf)");
    let far = vec![ControlPoint { target: vec![f64::NAN], ..point("a", &[0.0]) }];
    assert_eq!(refused(1, far), "the target of 'a' is not finite: (nan)");
    let heavy = vec![ControlPoint { weight: 1.5, ..point("a", &[0.0]) }];
    assert_eq!(refused(1, heavy), "the weight of 'a' is 1.5: expected a number of at least 0 and at most 1");
    let turning = Orientation::new([0.0, 0.0, 1.0], 3.0, 1.0).ok();
    let line = vec![ControlPoint { orientation: turning, ..point("a", &[0.0]) }];
    assert_eq!(refused(1, line), "'a' has 1 coordinate, and cannot turn");
    let twin = vec![ControlPoint { mirror_of: Some("b".into()), ..point("a", &[0.0]) }];
    assert_eq!(refused(1, twin), "'a' is said to be the mirror image of 'b', which is not there");
}

#[test]
fn moved_adds_to_the_target_of_the_named_only() {
    let moved = seat_and_back().moved("back", &[0.5, -1.0]).unwrap();
    assert_eq!(moved.targets(), [0.0, 0.0, 1.5, -1.0]);
    assert_eq!(moved.sources(), seat_and_back().sources());
}

#[test]
fn moving_an_unknown_control_point_names_the_nearest() {
    let says = |name: &str, by: &[f64]| seat_and_back().moved(name, by).unwrap_err().message;
    assert_eq!(says("bakc", &[0.0, 0.0]), "there is no control point 'bakc'; the nearest name is 'back'");
    assert_eq!(says("seat", &[0.0, f64::NAN]), "'seat' needs 2 finite numbers to move by, found (0, nan)");
}

#[test]
fn orientations_add_up_and_nan_stands_for_none() {
    let turn = |degrees| Orientation::new([0.0, 0.0, 1.0], degrees, 2.0).unwrap();
    assert_eq!(seat_and_back().orientations(), None);
    let points = seat_and_back().oriented("back", turn(30.0)).unwrap().oriented("back", turn(60.0)).unwrap();
    let all = points.orientations().unwrap();
    assert!(all[..4].iter().all(|c| c.is_nan()));
    assert!((all[6] - 4.0).abs() < 1e-14);
    let tilted = Orientation::new([1.0, 0.0, 0.0], 10.0, 1.0).unwrap();
    let error = points.oriented("seat", tilted).unwrap_err();
    assert_eq!(error.message, "'seat' is in the plane: it turns about no axis");
}

#[test]
fn targets_are_exchanged_whole() {
    let points = seat_and_back().with_targets(&[1.0, 2.0, 3.0, 4.0]).unwrap();
    assert_eq!(points.targets(), [1.0, 2.0, 3.0, 4.0]);
    let error = points.with_targets(&[1.0]).unwrap_err();
    assert_eq!(error.message, "expected as many targets as sources, 4 numbers, found 1");
}

#[test]
fn control_points_far_outside_are_named() {
    let far = ControlPoints::new(
        3,
        vec![
            point("seat", &[500.0, 1000.0, 500.0]),
            ControlPoint { target: vec![0.0, 4000.0, 0.0], ..point("back", &[0.0, 1.0, 0.0]) },
        ],
    );
    let warnings = far.unwrap().check((&[0.0; 3], &[1.0, 2.0, 1.0])).unwrap();
    assert!(warnings[0].starts_with("the position of 'seat' lies up to "));
    assert_eq!(
        warnings[1],
        "the target of 'seat' and 'back' lies up to 3998 units outside of the shape, whose longest side is 2: wrong \
         coordinates are the usual mistake"
    );
    let error = seat_and_back().check((&[0.0; 3], &[1.0; 3])).unwrap_err();
    assert_eq!(error.message, "the control points have 2 coordinates each, but the shape has 3");
}

fn moved(list: &[([f64; 3], [f64; 3])]) -> ControlPoints {
    let point = |(i, (p, q)): (usize, &([f64; 3], [f64; 3]))| ControlPoint {
        target: q.to_vec(),
        ..point(&format!("p{i}"), p)
    };
    ControlPoints::new(3, list.iter().enumerate().map(point).collect()).unwrap()
}

const BAR: (&[f64], &[f64]) = (&[0.0, 0.0, 0.0], &[6.0, 1.0, 1.0]);

#[test]
fn mirrored_targets_are_told_from_rotated_ones() {
    let places = [[0.0, 0.0, 0.0], [6.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [3.0, 0.5, 0.5]];
    let mirrored = moved(&places.map(|[x, y, z]| ([x, y, z], [-x, y, z])));
    let warnings = mirrored.check(BAR).unwrap();
    assert!(warnings[0].starts_with("the targets are the mirror image of the sources: "));
    let turned = moved(&places.map(|[x, y, z]| ([x, y, z], [-x, -y, z])));
    assert_eq!(turned.check(BAR).unwrap(), [""; 0]);
}

#[test]
fn control_points_on_a_line_are_told() {
    let line = moved(&[0.0, 3.0, 6.0].map(|x| ([x, 0.5, 0.5], [x, 0.5, 0.5])));
    assert!(line.check(BAR).unwrap()[0].starts_with("the control points are on a line"));
    let held = line.oriented("p0", Orientation::of_scale(1.0).unwrap()).unwrap();
    assert_eq!(held.check(BAR).unwrap(), [""; 0]);
    let thin = moved(&[0.0, 3.0, 6.0].map(|x| ([x, 0.5 + x * x * 1e-6, 0.5], [x, 0.5, 0.5])));
    assert_eq!(thin.check(BAR).unwrap(), [""; 0]);
}

#[test]
fn flipped_sources_are_told() {
    let flipped = moved(&[[0.0, 0.0], [-6.0, 0.0], [0.0, -1.0]].map(|[x, y]| ([x, y, 0.0], [x, y, 0.0])));
    let warnings = flipped.check(BAR).unwrap();
    assert!(warnings.iter().any(|warning| warning.contains("x and y negated, as between LPS and RAS")));
}
