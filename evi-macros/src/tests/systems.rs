//! The small systems of the gallery, with the equations as they stand there.

/// Two constraints, constant mass matrix, uniform gravity.
pub(super) const DOUBLE_PENDULUM: &str = "
    #[derive(MechanicalSystem)]
    #[evi(
        coordinates(x1, y1, x2, y2),
        kinetic   = 0.5 * m1 * (der(x1).powi(2) + der(y1).powi(2))
                  + 0.5 * m2 * (der(x2).powi(2) + der(y2).powi(2)),
        potential = g * (m1 * y1 + m2 * y2),
        constraint(rod1: x1.powi(2) + y1.powi(2) == l1.powi(2)),
        constraint(rod2: (x2 - x1).powi(2) + (y2 - y1).powi(2) == l2.powi(2)),
    )]
    pub struct DoublePendulum { pub m1: f64, pub m2: f64, pub l1: f64, pub l2: f64, pub g: f64 }";

/// One angle, no constraint.
pub(super) const PENDULUM: &str = "
    #[derive(MechanicalSystem)]
    #[evi(
        coordinates(theta),
        kinetic = 0.5 * m * l.powi(2) * der(theta).powi(2),
        potential = -m * g * l * theta.cos(),
    )]
    pub struct Pendulum { pub m: f64, pub l: f64, pub g: f64 }";

/// One constraint in space.
pub(super) const SPHERICAL_PENDULUM: &str = "
    #[derive(MechanicalSystem)]
    #[evi(
        coordinates(x, y, z),
        kinetic = 0.5 * m * (der(x).powi(2) + der(y).powi(2) + der(z).powi(2)),
        potential = m * g * z,
        constraint(rod: x.powi(2) + y.powi(2) + z.powi(2) == l.powi(2)),
    )]
    pub struct SphericalPendulum { pub m: f64, pub l: f64, pub g: f64 }";

/// A shared subexpression, a dense Hessian of the potential.
pub(super) const STIFF_SPRING_PENDULUM: &str = "
    #[derive(MechanicalSystem)]
    #[evi(
        coordinates(x, y),
        let stretch = (x.powi(2) + y.powi(2)).sqrt() - l,
        kinetic = 0.5 * m * (der(x).powi(2) + der(y).powi(2)),
        potential = 0.5 * k * stretch.powi(2) + m * g * y,
    )]
    pub struct StiffSpringPendulum { pub m: f64, pub l: f64, pub k: f64, pub g: f64 }";

/// Everything is linear.
pub(super) const HARMONIC_OSCILLATOR: &str = "
    #[derive(MechanicalSystem)]
    #[evi(coordinates(x), kinetic = 0.5 * m * der(x).powi(2), potential = 0.5 * k * x.powi(2))]
    pub struct HarmonicOscillator { pub m: f64, pub k: f64 }";

/// Forces of every kind, an input, a frequency, an observed quantity; not of the gallery.
pub(super) const PUSHED_OSCILLATOR: &str = "
    #[derive(MechanicalSystem)]
    #[evi(
        coordinates(x, y),
        kinetic = 0.5 * m * (der(x).powi(2) + der(y).powi(2)),
        potential = 0.5 * k * x.powi(2),
        input(push),
        let follow = push * x,
        dissipation = 0.5 * c * der(x).powi(2),
        force(y: follow + a * (w * t).cos()),
        frequency(x: (k / m).sqrt()),
        observe(power: follow * der(y)),
    )]
    pub struct PushedOscillator { pub m: f64, pub k: f64, pub c: f64, pub a: f64, pub w: f64 }";

/// All of them.
pub(super) const SMALL_SYSTEMS: [&str; 6] = [
    DOUBLE_PENDULUM,
    PENDULUM,
    SPHERICAL_PENDULUM,
    STIFF_SPRING_PENDULUM,
    HARMONIC_OSCILLATOR,
    PUSHED_OSCILLATOR,
];
