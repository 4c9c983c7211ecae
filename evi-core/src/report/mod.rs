//! What there is to read: a scene's [`SystemReport`], and statistics of runs.
//!
//! In: the constants that the derive wrote, or a time series. Out: text, or a trend. Printing a scene needs
//! no `std`.

#[cfg(feature = "std")]
mod assembled;
#[cfg(feature = "std")]
mod drift;
mod matrix;
mod system;
mod words;

#[cfg(feature = "std")]
pub use drift::Drift;
pub use system::Latex;

pub use crate::system::SystemReport;
