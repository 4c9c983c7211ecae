//! Every scene of the gallery by its standard motion: a consistent start, what it conserves, where it ends.

mod ends;
mod names;
mod pairs;
mod starts;
