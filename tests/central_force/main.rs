//! One central force: which scenes have it, and that their midpoint steps, found by the distance alone, are those of the equations in all coordinates.

mod found;
mod geometry;
mod paths;
mod scenes;
