//! The family of maps.

/// The family of maps that the local map is chosen from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Transform {
    /// Rotation and translation: lengths and angles survive.
    Rigid,
    /// Rotation, one scale, translation: angles survive.
    Similarity,
    /// Any linear map and translation.
    Affine,
}
