//! A mistaken system that is used as if it were right: only the mistakes are reported.

use evi_core::prelude::*;

/// Every use that depends on the sizes of a system with two coordinates and one constraint.
macro_rules! use_fully {
    ($system:expr, $type:ty) => {{
        const N: usize = <$type as MechanicalSystem>::N_COORDINATES + <$type as MechanicalSystem>::N_CONSTRAINTS;
        let sizes: [f64; N] = [0.0; 3];
        let system: $type = $system;
        let mut run = Simulation::new(system, Evi::midpoint(0.01)).start([1.0, 0.0], [0.0; 2]).unwrap();
        let trajectory = run.integrate(1.0).unwrap();
        let residual: [f64; 1] = run.mechanics().constraint_residual(trajectory.last());
        let q: &[f64; 2] = trajectory.last().q();
        let names: [&str; 2] = [<$type>::COORDINATES[0], <$type>::CONSTRAINTS[0]];
        println!("{sizes:?} {residual:?} {q:?} {names:?} {}", run.energy());
    }};
}

#[derive(MechanicalSystem)]
#[evi(coordinates(x, y), kinetic = 0.5 * m * (der(x).powi(2) + der(y).powi(2)), potential = z,
      constraint(rod: x == y))]
struct UnknownName { m: f64 }

#[derive(MechanicalSystem)]
#[evi(coordinates(x, y), kinetic = 0.5 * m * (der(x).powi(2) + der(y).powi(2)), potential = m * y,
      constraint(rod: x == der(y)))]
struct DerInConstraint { m: f64 }

#[derive(MechanicalSystem)]
#[evi(coordinates(x, y), kinetic = 0.5 * m * (der(x)^2 + der(y).powi(2)), potential = m * y,
      constraint(rod: x == y))]
struct Caret { m: f64 }

#[derive(MechanicalSystem)]
#[evi(coordinates(x, y), kinetic = 0.5 * m * (der(x).powi(2) + der(y).powi(2)), potential = m * y,
      constraint(rod: x = y))]
struct Assignment { m: f64 }

#[derive(MechanicalSystem)]
#[evi(coordinates(x, y), kinetic = 0.5 * m * (der(x).powi(2) + der(y).powi(2)), potential = m * y,
      constraint(x == y))]
struct Unnamed { m: f64 }

#[derive(MechanicalSystem)]
#[evi(coordinates(x, y), kinetic = 0.5 * m * (der(x).powi(2) + der(y).powi(2)) +, potential = m * y,
      constraint(rod: x + == y))]
struct BreaksOff { m: f64 }

#[derive(MechanicalSystem)]
#[evi(coordinates(x, y), kinetik = 0.5 * m * (der(x).powi(2) + der(y).powi(2)), potential = m * y,
      constrain(rod: x == y))]
struct UnknownItem { m: f64 }

#[derive(MechanicalSystem)]
#[evi(coordinates(x, y) kinetic = 0.5 * m * (der(x).powi(2) + der(y).powi(2)) potential = m * y
      constraint(rod: x == y))]
struct Commas { m: f64 }

#[derive(MechanicalSystem)]
#[evi(coordinates(x, y), kinetic = 0.5 * m * der(x).powi(2), potential = m * y, constraint(rod: x == y))]
struct NoInertia { m: f64 }

#[derive(MechanicalSystem)]
#[evi(coordinates(x, y), potential = m * y, constraint(rod: m == 1.0))]
struct NoKinetic { m: f64 }

#[derive(MechanicalSystem)]
#[evi(coordinates(x, y), kinetic = 0.5 * m * (der(x).powi(2) + der(y).powi(2)), potential = m * y,
      constraint(rod: x == y))]
struct Single { m: f32 }

#[derive(MechanicalSystem)]
#[evi(coordinates(x, y), kinetic = 0.5 * t * (der(x).powi(2) + der(y).powi(2)), potential = t * y,
      constraint(rod: x == y))]
struct Reserved { t: f64 }

#[derive(MechanicalSystem)]
#[evi(coordinates(x, y), kinetic = 0.5 * (der(x).powi(2) + der(y).powi(2)), potential = 0.0,
      constraint(rod: x == y))]
enum Shape { M(f64) }

fn main() {
    use_fully!(UnknownName { m: 1.0 }, UnknownName);
    use_fully!(DerInConstraint { m: 1.0 }, DerInConstraint);
    use_fully!(Caret { m: 1.0 }, Caret);
    use_fully!(Assignment { m: 1.0 }, Assignment);
    use_fully!(Unnamed { m: 1.0 }, Unnamed);
    use_fully!(BreaksOff { m: 1.0 }, BreaksOff);
    use_fully!(UnknownItem { m: 1.0 }, UnknownItem);
    use_fully!(Commas { m: 1.0 }, Commas);
    use_fully!(NoInertia { m: 1.0 }, NoInertia);
    use_fully!(NoKinetic { m: 1.0 }, NoKinetic);
    use_fully!(Single { m: 1.0 }, Single);
    use_fully!(Reserved { t: 1.0 }, Reserved);
    use_fully!(Shape::M(1.0), Shape);
}
