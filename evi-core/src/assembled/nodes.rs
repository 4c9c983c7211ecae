//! Nodes of a step on straight curves, of a rule whose length is known at run time.

use crate::scheme::Quadrature;

/// A node of a rule on `[0, 1]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Node {
    /// `c`.
    pub(super) time: f64,
    /// `w`.
    pub(super) weight: f64,
}

/// A rule.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Nodes(Vec<Node>);

impl Nodes {
    pub(super) fn of<const K: usize>(rule: &Quadrature<K>) -> Self {
        let node = |j: usize| Node { time: 0.5 + rule.offsets()[j], weight: rule.weights()[j] };
        Self((0..K).map(node).collect())
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &Node> {
        self.0.iter()
    }

    /// Calls `see` for the numbers that tell this rule from another.
    pub(super) fn for_each_number(&self, mut see: impl FnMut(f64)) {
        for Node { time, weight } in &self.0 {
            see(*time);
            see(*weight);
        }
    }

    /// Whether it is the trapezoidal rule.
    pub(super) fn are_the_ends(&self) -> bool {
        // Exactly: rounded nodes lie beside the ends.
        matches!(self.0[..], [Node { time: 0.0, weight: 0.5 }, Node { time: 1.0, weight: 0.5 }])
    }

    /// `Σ wⱼ (1 − cⱼ)`.
    pub(super) fn start_weight(&self) -> f64 {
        self.0.iter().map(|node| node.weight * (1.0 - node.time)).sum()
    }

    /// `Σ wⱼ cⱼ`.
    pub(super) fn end_weight(&self) -> f64 {
        self.0.iter().map(|node| node.weight * node.time).sum()
    }
}
