//! From tokens to items: the only folder that reads `syn`.
//!
//! In: the tokens of a struct. Out: a [`Declaration`] of fields and items with names unresolved. Every item
//! is parsed by itself, so that the mistakes of all of them are found at once.

mod attribute;
mod expression;
mod integers;
mod item;
mod labelled;
mod nesting;
mod spine;

pub(crate) use attribute::{Declaration, Field, NotAnItem, parse};
pub(crate) use expression::{Expression, Resolved, Resolver, lower};
pub(crate) use item::{Constraint, Coordinates, Item, Let};
pub(crate) use labelled::Labelled;
