//! From tokens to items: the only folder that reads `syn`.
//!
//! In: the tokens of a struct. Out: a [`Declaration`] of fields and items with names unresolved. Every item
//! is parsed by itself, so that the mistakes of all of them are found at once.

mod affine;
mod attribute;
mod elements;
mod expression;
mod indexed;
mod integers;
mod item;
mod labelled;
mod lowering;
mod nesting;
mod rigid_body;
mod shape;
mod spine;
mod sums;
mod vectors;

pub(crate) use attribute::{Declaration, Field, NotAnItem, parse};
pub(crate) use expression::{Expansion, Expression, Resolved, Resolver, lower, lower_index, lower_range};
pub(crate) use indexed::{Bracket, Indexed, Range};
pub(crate) use item::{Constraint, Coordinates, Item, Let};
pub(crate) use labelled::Labelled;
pub(crate) use shape::Coordinate;
