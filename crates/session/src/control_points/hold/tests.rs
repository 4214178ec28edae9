use super::*;
use proptest::prelude::*;

/// A square of side 2 about the origin in a group, and one far from it that is free.
fn square() -> ControlPoints {
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let mut list: Vec<ControlPoint> = corners
        .iter()
        .enumerate()
        .map(|(i, [x, y])| ControlPoint {
            group: Some("square".into()),
            ..ControlPoint::new(format!("p{i}"), vec![*x, *y, 0.0])
        })
        .collect();
    list.push(ControlPoint::new("free", vec![5.0, 0.0, 0.0]));
    ControlPoints::new(3, list).unwrap()
}

fn with_lock(name: &str) -> ControlPoints {
    square().with_locked(&[name.to_string()]).unwrap()
}

fn is_near(found: &[f64], expected: &[f64]) -> bool {
    found.len() == expected.len() && found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-8)
}

const QUARTER: [f64; 9] = [0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];
const IDENTITY: [f64; 9] = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];

fn turned(scale: f64) -> Vec<f64> {
    square().sources().chunks(3).flat_map(|p| [-scale * p[1] + 7.0, scale * p[0], p[2]]).collect()
}

#[test]
fn a_group_takes_its_motion_to_each_of_its_control_points() {
    let points = square().with_targets(&turned(1.0)).unwrap();
    let posed = points.posed(Transform::Rigid);
    assert!(is_near(&posed.targets, &points.targets()));
    let orientations = posed.orientations.clone().unwrap();
    (0..4).for_each(|i| assert!(is_near(&orientations[9 * i..][..9], &QUARTER)));
    assert!(orientations[36..].iter().all(|c| c.is_nan()));
    assert_eq!(points.left_by_holding(&posed, Transform::Rigid, 1e-6), [""; 0]);
}

#[test]
fn targets_that_are_no_rigid_motion_are_met_as_nearly_as_one_gets() {
    let points = square().with_targets(&turned(3.0)).unwrap();
    let rigid = points.posed(Transform::Rigid);
    assert!(is_near(&rigid.targets[..12], &turned(1.0)[..12]));
    assert_eq!(rigid.targets[12..], points.targets()[12..]);
    let sentences = points.left_by_holding(&rigid, Transform::Rigid, 1e-6);
    assert_eq!(
        sentences,
        [
            "a group moves as one piece, and its targets are no rigid motion of it: control points end off their \
            targets, those of 'square' by up to 2.83"
        ]
    );
    let similar = points.posed(Transform::Similarity);
    assert!(is_near(&similar.targets, &points.targets()));
    let of_three = [0.0, -3.0, 0.0, 3.0, 0.0, 0.0, 0.0, 0.0, 3.0];
    assert!(is_near(&similar.orientations.unwrap()[..9], &of_three));
    // Affine maps still move a piece as one.
    assert_eq!(points.posed(Transform::Affine).targets, rigid.targets);
}

#[test]
fn an_orientation_of_its_own_stays() {
    let own = Orientation::new([1.0, 0.0, 0.0], 30.0, 1.0).unwrap();
    let points = square().with_targets(&turned(1.0)).unwrap().oriented("p2", own).unwrap();
    let orientations = points.posed(Transform::Rigid).orientations.unwrap();
    assert_eq!(orientations[18..27], own.matrix());
    assert!(is_near(&orientations[..9], &QUARTER));
}

#[test]
fn what_is_locked_stays_and_holds_whatever_its_target() {
    let own = Orientation::new([1.0, 0.0, 0.0], 30.0, 1.0).unwrap();
    let points = with_lock("free").with_targets(&turned(1.0)).unwrap().oriented("free", own).unwrap();
    let posed = points.posed(Transform::Rigid);
    assert_eq!(posed.targets[12..], [5.0, 0.0, 0.0]);
    assert_eq!(posed.orientations.as_ref().unwrap()[36..], IDENTITY);
    assert_eq!(points.targets()[12..], [7.0, 5.0, 0.0], "the target is kept as it was given");
    assert_eq!(points.stay(), [false, false, false, false, true]);
    assert_eq!(
        points.left_by_holding(&posed, Transform::Rigid, 1e-6),
        ["locked control points and their groups stay as they are at rest: the targets and rotations of 'free' are not used"]
    );
}

#[test]
fn a_locked_control_point_keeps_its_group() {
    let points = with_lock("p1").moved("square", &[1.0, 0.0, 0.0]).unwrap();
    let posed = points.posed(Transform::Similarity);
    assert_eq!(posed.targets, points.sources());
    let sentences = points.left_by_holding(&posed, Transform::Similarity, 1e-6);
    assert!(sentences[0].ends_with("of 'p0', 'p1', 'p2' and 'p3' are not used"), "{sentences:?}");
}

#[test]
fn a_group_holds_where_it_is_not_moved_and_one_alone_is_free() {
    let posed = square().posed(Transform::Rigid);
    assert_eq!(posed.targets, square().sources());
    assert_eq!(posed.orientations.unwrap()[..9], IDENTITY);
    let one = square().grouped(&["p1", "p2", "p3"].map(String::from), None).unwrap();
    assert_eq!(one.posed(Transform::Rigid).orientations, None);
}

#[test]
fn a_group_moves_and_turns_by_its_name() {
    let quarter = Orientation::new([0.0, 0.0, 1.0], 90.0, 1.0).unwrap();
    let points = square().moved("square", &[7.0, 0.0, 0.0]).unwrap().oriented("square", quarter).unwrap();
    assert!(is_near(&points.targets()[..12], &turned(1.0)[..12]));
    assert_eq!(points[4], square()[4]);
    assert_eq!(points.orientations(), None);
    // A control point of that name comes first.
    let mut list = square().into_list();
    list[4].name = "square".into();
    let both = ControlPoints::new(3, list).unwrap().moved("square", &[1.0, 0.0, 0.0]).unwrap();
    assert_eq!(both.targets()[..12], square().sources()[..12]);
}

#[test]
fn groups_have_names_and_members_that_are_there() {
    let said = |error: Result<ControlPoints, Error>| error.unwrap_err().message;
    assert_eq!(said(square().grouped(&["p1".into()], Some(" "))), "the group of 'p1' has no name");
    assert!(said(square().grouped(&["p9".into()], None)).starts_with("there is no control point 'p9'"));
    assert!(said(square().with_locked(&["p9".into()])).starts_with("there is no control point 'p9'"));
}

proptest! {
    #[test]
    fn without_groups_and_locks_nothing_changes(q in prop::collection::vec(-9.0..9.0f64, 15), degrees in 0.0..360.0f64) {
        let free = square().grouped(&["p0", "p1", "p2", "p3"].map(String::from), None).unwrap();
        let turn = Orientation::new([0.0, 0.0, 1.0], degrees, 1.0).unwrap();
        let points = free.with_targets(&q).unwrap().oriented("p1", turn).unwrap();
        let posed = points.posed(Transform::Rigid);
        prop_assert_eq!(&posed.targets, &q);
        let bits = |all: Option<Vec<f64>>| all.map(|all| all.into_iter().map(f64::to_bits).collect::<Vec<_>>());
        prop_assert_eq!(bits(posed.orientations), bits(points.orientations()));
    }
}
