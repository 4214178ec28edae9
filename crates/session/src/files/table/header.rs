//! What the titles of columns mean, as landmark tools and people write them.

/// What the column of the names is called, the likeliest first.
pub const NAMES: [&str; 9] =
    ["name", "label", "landmark", "point", "landmarkname", "pointname", "pointid", "id", "index"];
/// What positions are called before or after the axis; with nothing, too.
const SOURCES: [&str; 7] = ["source", "src", "position", "pos", "from", "start", "rest"];
/// What targets are called. No single letters: `qx` is a quaternion's, `tx` a translation's.
const TARGETS: [&str; 7] = ["target", "tgt", "destination", "dest", "dst", "to", "end"];
const AXES: [&str; 3] = ["x", "y", "z"];

/// What a column holds.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub enum Known {
    /// Names.
    Name(&'static str),
    /// A coordinate.
    Axis {
        /// Of the target, not of the position.
        target: bool,
        /// What such columns are called.
        prefix: &'static str,
        /// 0 to 2.
        axis: usize,
    },
    /// Something else.
    Other,
}

/// What a title in small letters means: `x`, `target_x`, `Target X (mm)`, `x_target`, `targetX`, `destination.x`.
pub fn known(title: &str) -> Known {
    // A unit in brackets.
    let title = title.split(['(', '[']).next().unwrap_or_default().trim();
    let between = [' ', '_', '.', '-', ':'];
    let whole = title.replace(between, "");
    if let Some(name) = NAMES.iter().find(|name| **name == whole) {
        return Known::Name(name);
    }
    if let Some(axis) = AXES.iter().position(|axis| *axis == title) {
        return Known::Axis { target: false, prefix: "", axis };
    }
    for (target, prefixes) in [(false, SOURCES), (true, TARGETS)] {
        for prefix in prefixes {
            for (axis, letter) in AXES.iter().enumerate() {
                let before = title.strip_prefix(prefix).map(|rest| rest.trim_matches(between));
                let after = title.strip_suffix(prefix).and_then(|rest| rest.strip_suffix(between));
                if before == Some(letter) || after.map(str::trim) == Some(letter) {
                    return Known::Axis { target, prefix, axis };
                }
            }
        }
    }
    Known::Other
}
