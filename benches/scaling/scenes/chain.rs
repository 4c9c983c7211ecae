//! Hanging chains of any length: point masses in a line, joined by rods, the first on a pivot at the origin; released from the horizontal.
//! Mass and length are 1 in all.

/// A module with the chain of so many links.
macro_rules! chain {
    ($(#[$documentation:meta])* $module:ident, $links:literal) => {
        $(#[$documentation])*
        pub(crate) mod $module {
            use evi_core::prelude::*;
            use evi_examples::GRAVITY;

            const N: usize = $links;

            #[derive(MechanicalSystem, Clone, Debug)]
            #[evi(
                coordinates(p: [N, 2]),
                kinetic = 0.5 * m * sum(0..N, |i| der(p[i]).norm_squared()),
                potential = m * g * sum(0..N, |i| p[i][1]),
                constraint(first: p[0].norm_squared() == l.powi(2)),
                constraint(link[i in 1..N]: (p[i] - p[i - 1]).norm_squared() == l.powi(2)),
            )]
            pub(crate) struct Chain {
                m: f64,
                l: f64,
                g: f64,
            }

            pub(crate) fn specimen() -> crate::specimen::Specimen<Chain> {
                let share = 1.0 / N as f64;
                let system = Chain { m: share, l: share, g: GRAVITY };
                let q = (1..=N).flat_map(|i| [i as f64 * share, 0.0]).collect();
                crate::specimen::Specimen::at_rest("chain", N, share, system, q)
            }
        }
    };
}

chain!(links_2, 2);
chain!(links_5, 5);
chain!(links_20, 20);
chain!(links_100, 100);
chain!(links_1_000, 1_000);
chain!(links_10_000, 10_000);
