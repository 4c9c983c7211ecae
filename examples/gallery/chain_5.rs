//! Hanging chain of five point masses: 5 rods in 10 coordinates of the family in `chain.rs`.

use evi_core::prelude::*;

use crate::chain::chain;
use crate::{Reference, ReferenceOrigin, Scene, Start};

chain! {
    /// Chain of five point masses, pivot at the origin, y upwards; SI units.
    Chain5: (x1, y1) on rod1,
        (x2, y2) on rod2 from (x1, y1),
        (x3, y3) on rod3 from (x2, y2),
        (x4, y4) on rod4 from (x3, y3),
        (x5, y5) on rod5 from (x4, y4),
}

impl Scene for Chain5 {
    const NAME: &'static str = "chain_5";
    const SUMMARY: &'static str = "Five point masses on rods in a line, released from the horizontal.";
    const ORIGIN: &'static str = "Tomaszewski, Pieranski, Géminard, Am. J. Phys. 74 (2006) 776, for rods of equal length; mass and length 1 in all";
    const HORIZON: f64 = 1.0;
    const CONSERVES_ENERGY: bool = true;

    fn standard() -> Self {
        Self::UNIT
    }

    fn standard_motion(&self) -> ([f64; 10], [f64; 10]) {
        let Start { q, v } = self.horizontal();
        (q, v)
    }

    fn reference() -> Reference<Self> {
        Reference {
            origin: ReferenceOrigin::Certified,
            q: [
                -0.1999930808267285,
                0.0016636169732343207,
                -0.3905973405403808,
                0.06224427542963093,
                -0.5903081962485696,
                0.05149373533608174,
                -0.7796537781159742,
                -0.01291317910090999,
                -0.9424915084690596,
                -0.12903326165968124,
            ],
            v: [
                -0.005122522669252436,
                -0.6158082699990912,
                0.08714776348059254,
                -0.3254992830504511,
                0.0732998273821659,
                -0.06824865713365863,
                0.022143313803222642,
                0.08214295709882741,
                0.0069494845281945225,
                0.10344959605394205,
            ],
        }
    }
}
