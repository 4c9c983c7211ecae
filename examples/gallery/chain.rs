//! Hanging chains: point masses in a line, joined by massless rods, the first on a pivot at the origin; released from the horizontal.
//!
//! A chain has `N` rods in `2N` Cartesian coordinates. Its matrix of constraints is banded: a rod shares coordinates with its
//! neighbours alone. Energy is conserved. With more and more rods the chain becomes a rope, whose end falls faster than a free body
//! (Tomaszewski, Pieranski, Géminard, *The motion of a freely falling chain tip*, Am. J. Phys. 74 (2006) 776).

/// A chain: its name, its first point mass and rod, then every point mass and rod with the point mass before it.
macro_rules! chain {
    (
        $(#[$documentation:meta])*
        $name:ident: ($x_first:ident, $y_first:ident) on $rod_first:ident
        $(, ($x:ident, $y:ident) on $rod:ident from ($x_before:ident, $y_before:ident))* $(,)?
    ) => {
        $(#[$documentation])*
        #[derive(MechanicalSystem, Clone, Copy, Debug)]
        #[evi(
            coordinates($x_first, $y_first $(, $x, $y)*),
            kinetic = 0.5 * m * (der($x_first).powi(2) + der($y_first).powi(2) $(+ der($x).powi(2) + der($y).powi(2))*),
            potential = m * g * ($y_first $(+ $y)*),
            constraint($rod_first: $x_first.powi(2) + $y_first.powi(2) == l.powi(2)),
            $(constraint($rod: ($x - $x_before).powi(2) + ($y - $y_before).powi(2) == l.powi(2)),)*
        )]
        pub struct $name {
            /// Mass of every point.
            pub m: f64,
            /// Length of every rod.
            pub l: f64,
            /// Gravitational acceleration.
            pub g: f64,
        }

        impl $name {
            /// Mass and length 1 in all.
            pub const UNIT: Self = {
                let share = 1.0 / (<Self as MechanicalSystem>::N_CONSTRAINTS as f64);
                Self { m: share, l: share, g: $crate::GRAVITY }
            };

            /// At rest, stretched out horizontally.
            pub fn horizontal(&self) -> $crate::Start<{ <$name as MechanicalSystem>::N_COORDINATES }> {
                let place = |i| if i % 2 == 0 { (i / 2 + 1) as f64 * self.l } else { 0.0 };
                $crate::Start { q: core::array::from_fn(place), v: [0.0; <$name as MechanicalSystem>::N_COORDINATES] }
            }
        }
    };
}

pub(crate) use chain;
