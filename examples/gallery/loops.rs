//! Scenes of many bodies, whose sums and families stay loops: their code is that of one body, whatever the constants are.

use evi_core::assembled::AssembledSystem;

/// A scene of the gallery that is a sum of repeated elements.
pub trait LoopScene: AssembledSystem + Clone + 'static {
    /// Name, such as `long_chain`.
    const NAME: &'static str;
    /// One sentence: what moves, and what is special about it.
    const SUMMARY: &'static str;

    /// The scene with standard parameters, and where it is let go from rest.
    fn standard() -> (Self, Vec<f64>);
}

/// Sees the scenes of many bodies.
pub trait LoopVisitor {
    /// Sees the next one.
    fn visit<S: LoopScene>(&mut self);
}

/// Shows the visitor every scene of many bodies, in alphabetical order.
pub fn visit_loops(visitor: &mut impl LoopVisitor) {
    visitor.visit::<crate::LongChain>();
    visitor.visit::<crate::Net>();
}
