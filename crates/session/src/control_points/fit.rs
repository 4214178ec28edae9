//! How well one rotation, or one mirroring, takes all sources to their targets.
