//! Speed of single steps; see the bench targets.
