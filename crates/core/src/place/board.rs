//! What control points are chosen from.

use super::along::Along;

/// The places of a shape, and what is known of them.
#[derive(Clone, Copy)]
pub(super) struct Board<'a> {
    pub(super) along: &'a Along,
    pub(super) seen: &'a [bool],
    /// Whether the shape is made of parts, as furniture is, rather than one piece.
    pub(super) of_parts: bool,
}
