//! Laws of reading and writing, for any session and any bytes.

use std::collections::HashSet;
use std::fs;
use std::path::PathBuf;

use neuralmls_session::Bounds;
use neuralmls_session::{
    join, read, ControlPoint, ControlPoints, HandlesSetting, Orientation, Session, Settings, Transform,
    WeightsSettings,
};
use proptest::prelude::*;
use serde_json::{Map, Value};

fn coordinate() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => any::<f64>().prop_filter("finite", |c| c.is_finite()),
        2 => -1e3..1e3f64,
        1 => prop::sample::select(vec![0.0, -0.0, 1.0, 1e16, -1e-5, 5e-324, f64::MAX]),
    ]
}

fn above_0() -> impl Strategy<Value = f64> {
    prop_oneof![1e-300..1e300f64, 0.1..10.0f64, Just(1.0)]
}

fn name() -> impl Strategy<Value = String> {
    prop_oneof!["[a-z]{1,8}", "\\PC{1,8}", any::<String>()]
        .prop_filter("a name", |name| !name.trim().is_empty())
}

/// Keys of other programs; none of them is ours.
fn others() -> impl Strategy<Value = Map<String, Value>> {
    let leaf = prop_oneof![
        Just(Value::Null),
        any::<bool>().prop_map(Value::from),
        any::<i64>().prop_map(Value::from),
        coordinate().prop_map(|c| c.to_string().parse::<Value>().unwrap()),
        any::<String>().prop_map(Value::from),
    ];
    let value = leaf.prop_recursive(3, 8, 3, |inner| {
        prop_oneof![
            prop::collection::vec(inner.clone(), 0..3).prop_map(Value::from),
            prop::collection::vec(("[a-z]{1,3}", inner), 0..3)
                .prop_map(|list| Value::Object(list.into_iter().collect())),
        ]
    });
    prop::collection::vec(("other [a-z\"]{1,3}", value), 0..3).prop_map(|list| list.into_iter().collect())
}

fn orientation(dim: usize) -> impl Strategy<Value = Option<Orientation>> {
    let axis =
        prop::array::uniform3(coordinate()).prop_filter("an axis", |axis| axis.iter().any(|c| *c != 0.0));
    let some = (axis, coordinate(), above_0()).prop_map(move |(axis, degrees, scale)| match dim {
        1 => Orientation::of_scale(scale).unwrap(),
        2 => Orientation::new([0.0, 0.0, 1.0], degrees, scale).unwrap(),
        _ => Orientation::new(axis, degrees, scale).unwrap(),
    });
    prop::option::of(some)
}

fn point(dim: usize) -> impl Strategy<Value = ControlPoint> {
    let places = (prop::collection::vec(coordinate(), dim), prop::collection::vec(coordinate(), dim));
    let rest = (0.0..=1.0f64, any::<bool>(), prop::option::of(name()), others());
    (name(), places, orientation(dim), rest).prop_map(
        |(name, (position, target), orientation, (weight, locked, group, others))| ControlPoint {
            target,
            orientation,
            weight,
            locked,
            group,
            others,
            ..ControlPoint::new(name, position)
        },
    )
}

fn points(dim: usize) -> impl Strategy<Value = ControlPoints> {
    prop::collection::vec(point(dim), 1..6).prop_filter_map("distinct", move |mut list| {
        let names: HashSet<String> = list.iter().map(|point| point.name.clone()).collect();
        if list.len() > 2 && names.len() == list.len() {
            list[1].mirror_of = Some(list[0].name.clone());
        }
        ControlPoints::new(dim, list).ok()
    })
}

fn settings() -> impl Strategy<Value = Settings> {
    let neural = (
        1..=16384usize,
        prop::option::of(1..=1_000_000usize),
        any::<u64>(),
        above_0(),
        prop::option::of(above_0()),
    );
    let weights = prop_oneof![
        neural.prop_map(|(width, steps, seed, rate, fourier_sigma)| WeightsSettings::Neural {
            width,
            steps,
            seed,
            rate,
            fourier_sigma
        }),
        any::<u64>().prop_map(|seed| WeightsSettings::ShapeAware { seed }),
        (above_0(), above_0())
            .prop_map(|(alpha, epsilon)| WeightsSettings::InverseDistance { alpha, epsilon }),
    ];
    let transform = prop::sample::select(vec![Transform::Rigid, Transform::Similarity, Transform::Affine]);
    let handles = prop_oneof![
        prop::sample::select(vec![HandlesSetting::Auto, HandlesSetting::Exact, HandlesSetting::Soft]),
        (0.0..=1.0f64).prop_map(HandlesSetting::Part),
    ];
    (weights, transform, above_0(), handles, 0.0..=1.0f64, any::<bool>()).prop_map(
        |(weights, transform, temperature, handles, relax, no_folds)| {
            // These do not go together.
            let no_folds = no_folds && !matches!(weights, WeightsSettings::ShapeAware { .. });
            let relax = if no_folds { 0.0 } else { relax };
            Settings { weights, transform, temperature, handles, relax, no_folds }
        },
    )
}

fn sessions() -> impl Strategy<Value = Session> {
    (1..=3usize).prop_flat_map(|dim| {
        let corner = prop::collection::vec(-1e6..1e6f64, dim);
        let frame = prop::option::of((corner, 0.1..10.0f64));
        (points(dim), prop::option::of(settings()), frame, others()).prop_map(
            move |(points, settings, frame, others)| {
                let frame = frame.map(|(min, side)| {
                    let max = min.iter().map(|c| c + side).collect();
                    Bounds::new(min, max, dim).unwrap()
                });
                let has_settings = settings.is_some();
                Session { points, settings: settings.unwrap_or_default(), has_settings, frame, others }
            },
        )
    })
}

/// Files to begin with.
fn files() -> Vec<Vec<u8>> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../tests/sessions");
    let mut files = Vec::new();
    for kind in ["json", "table", "landmarks", "broken"] {
        let mut paths: Vec<PathBuf> =
            fs::read_dir(folder.join(kind)).unwrap().map(|entry| entry.unwrap().path()).collect();
        paths.sort();
        files.extend(paths.iter().map(|path| fs::read(path).unwrap()).filter(|bytes| bytes.len() < 2000));
    }
    files
}

/// Reads bytes under every ending; whatever comes is one line, and what is read can be written and read.
fn check(bytes: &[u8]) {
    for name in ["a.json", "a.csv", "a.fcsv", "a.land", "a"] {
        let sentences = match read(bytes, name) {
            Ok(read) => {
                let again = neuralmls_session::read(read.session.to_json().as_bytes(), "a.json").unwrap();
                assert_eq!(again.session, read.session);
                read.notes
            }
            Err(error) => vec![error.message],
        };
        for sentence in sentences {
            assert!(!sentence.is_empty() && sentence.chars().count() < 1000, "{sentence}");
            assert!(!sentence.contains(char::is_control), "{sentence:?}");
        }
    }
}

proptest! {
    #[test]
    fn a_session_comes_back_bit_for_bit(session in sessions()) {
        let text = session.to_json();
        let again = read(text.as_bytes(), "a.json").unwrap();
        prop_assert_eq!(&again.session, &session);
        prop_assert_eq!(again.session.to_json(), text);
        let bits = |points: &ControlPoints| -> Vec<u64> {
            points.sources().iter().chain(&points.targets()).map(|c| c.to_bits()).collect()
        };
        prop_assert_eq!(bits(&again.session.points), bits(&session.points));
    }

    #[test]
    fn csv_keeps_names_and_numbers_or_is_refused(session in sessions()) {
        let more = |point: &ControlPoint| point.orientation.is_some() || point.group.is_some() || point.locked;
        let more = session.points.iter().any(more);
        match session.to_csv() {
            Err(error) => {
                prop_assert!(more);
                let what = error.message.strip_prefix("a CSV file holds no ").unwrap();
                let what = what.strip_suffix(": write a file that ends in .json").unwrap();
                prop_assert!(["rotations", "groups", "locks"].contains(&what), "{}", what);
            }
            Ok(text) => {
                prop_assert!(!more);
                // 9999 in every coordinate and names with blanks around them are the format's own.
                let again = read(text.as_bytes(), "a.csv").unwrap().session.points;
                for (again, point) in again.iter().zip(session.points.iter()) {
                    prop_assert_eq!(&*again.name, point.name.trim());
                    prop_assert_eq!(&again.position, &point.position);
                    prop_assert_eq!(&again.target, &point.target);
                }
            }
        }
    }

    #[test]
    fn a_session_joined_with_itself_does_not_move(session in sessions(), by_order: bool) {
        let whole = read(session.to_json().as_bytes(), "a.json").unwrap();
        let joined = join(whole.clone(), whole, by_order).unwrap().session;
        prop_assert_eq!(joined.points.targets(), session.points.sources());
        prop_assert_eq!(joined.points.len(), session.points.len());
    }

    #[test]
    fn any_bytes_are_read_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        check(&bytes);
    }

    #[test]
    fn any_text_is_read_or_refused(text in "[\\PC\\n,;\"0-9.xyzname-]{0,120}") {
        check(text.as_bytes());
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn damaged_files_are_read_or_refused(
        file in prop::sample::select(files()),
        damage in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>(), 0..4usize), 1..4),
    ) {
        let mut bytes = file;
        for (place, byte, kind) in damage {
            if bytes.is_empty() {
                break;
            }
            let at = place.index(bytes.len());
            match kind {
                0 => bytes[at] = byte,
                1 => bytes.insert(at, byte),
                2 => drop(bytes.remove(at)),
                _ => bytes.truncate(at),
            }
        }
        check(&bytes);
    }
}
