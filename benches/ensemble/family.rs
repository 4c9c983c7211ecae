//! The members that are measured: one scene with unequal parameters and starts.

use evi_core::ensemble::{Member, Quantity};
use evi_examples::{DoublePendulum, Scene, SphericalPendulum};

/// A scene with members by index.
pub(crate) trait Family: Scene {
    /// The scene of a member.
    fn system(index: usize) -> Self;

    /// Its start.
    fn start(&self, index: usize) -> (Self::PerCoordinate<f64>, Self::PerCoordinate<f64>);

    fn member(index: usize) -> Member<Self> {
        let system = Self::system(index);
        let (q, v) = system.start(index);
        Member { parameters: system.parameters(), q, v }
    }

    /// The largest residual of its constraints.
    fn constraint_error() -> Quantity<Self> {
        Quantity::new("constraint error", |sight: &evi_core::ensemble::Sight<'_, Self>| {
            let residual = sight.mechanics.constraint_residual(sight.state);
            residual.as_ref().iter().fold(0.0, |largest: f64, phi| largest.max(phi.abs()))
        })
    }
}

/// A fraction that is different for every member.
pub(crate) fn fraction(index: usize, salt: f64) -> f64 {
    (index as f64 * 0.618_033_988_749_895 + salt).fract()
}

impl Family for DoublePendulum {
    fn system(index: usize) -> Self {
        let [a, b, c, d] = [0.1, 0.3, 0.5, 0.7].map(|salt| fraction(index, salt));
        Self { m1: 0.9 + 0.2 * a, m2: 0.9 + 0.2 * b, l1: 0.9 + 0.2 * c, l2: 0.9 + 0.2 * d, g: 9.81 }
    }

    fn start(&self, index: usize) -> ([f64; 4], [f64; 4]) {
        let start = self.at_angles(0.3 * fraction(index, 0.2), 0.3 * fraction(index, 0.6));
        (start.q, start.v)
    }
}

impl Family for SphericalPendulum {
    fn system(index: usize) -> Self {
        Self { g: 9.0 + fraction(index, 0.1), ..Self::standard() }
    }

    fn start(&self, _index: usize) -> ([f64; 3], [f64; 3]) {
        self.standard_motion()
    }
}
