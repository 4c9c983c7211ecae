//! A light body moves beside a heavy one as it does alone, whatever the ratio of their masses: it does not vanish in the metric of the mass matrix.

use evi_core::assembled::{AssembledScheme, AssembledSimulation, AssembledSystem};
use evi_core::sensitivity::{Course, StateGradient};

use super::*;

/// A planet about a fixed sun, whose mass depends on where it is, beside a weight that rests on a spring.
#[derive(MechanicalSystem)]
#[evi(
    coordinates(x, y, u, v),
    kinetic = 0.5 * heavy * (der(x).powi(2) + der(y).powi(2))
            + 0.5 * light * ((1.0 + 0.3 * v.sin()) * der(u).powi(2) + der(v).powi(2)),
    potential = 0.5 * heavy * ((x - 2.0).powi(2) + (y - 1.0).powi(2)) - light / (u.powi(2) + v.powi(2)).sqrt(),
)]
struct PlanetAndWeight {
    heavy: f64,
    light: f64,
}

/// The same with a constant mass, and a rod that swings the planet.
#[derive(MechanicalSystem)]
#[evi(
    coordinates(x, y, u, v),
    kinetic = 0.5 * heavy * (der(x).powi(2) + der(y).powi(2)) + 0.5 * light * (der(u).powi(2) + der(v).powi(2)),
    potential = 0.5 * heavy * ((x - 2.0).powi(2) + (y - 1.0).powi(2)) + 9.81 * light * v,
    constraint(rod: u.powi(2) + v.powi(2) == 0.25),
)]
struct BobAndWeight {
    heavy: f64,
    light: f64,
}

/// What a mass of the weight changes of where the light body comes to.
#[track_caller]
fn check<S, F>(system: impl Fn(f64) -> S, scheme: F, start: ([f64; 2], [f64; 2]))
where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; 4]>,
    F: Scheme<S> + Copy,
{
    let ([u, v], [u_rate, v_rate]) = start;
    let end = |heavy: f64| {
        let simulation = Simulation::new(system(heavy), scheme);
        let mut run = simulation.start([2.0, 1.0, u, v], [0.0, 0.0, u_rate, v_rate]).expect("a start");
        for _ in 0..STEPS {
            run.advance().expect("a step");
        }
        let [_, _, u, v] = *run.state().q();
        [u, v]
    };
    let alike = end(1.0);
    for heavy in [1e6, 1e12, 1e20, 1e30] {
        let difference = largest_difference(&end(heavy), &alike);
        assert!(difference <= ROUND_OFF, "beside {heavy:e} kg: {difference:e}");
    }
}

/// The motion amplifies the round-off of its steps: 2.9e-14 measured.
const ROUND_OFF: f64 = 4e-14;
const PLANET: ([f64; 2], [f64; 2]) = ([0.4, 0.0], [0.1, 1.3]);
const BOB: ([f64; 2], [f64; 2]) = ([0.5, 0.0], [0.0, 0.7]);

fn planet(heavy: f64) -> PlanetAndWeight {
    PlanetAndWeight { heavy, light: 1.0 }
}

fn bob(heavy: f64) -> BobAndWeight {
    BobAndWeight { heavy, light: 1.0 }
}

#[test]
fn passes() {
    check(planet, Gauss::<4>::new(H), PLANET);
    check(planet, Galerkin::<4>::new(H), PLANET);
    check(bob, Galerkin::<4>::new(H), BOB);
}

#[test]
fn newton() {
    check(planet, Evi::midpoint(H), PLANET);
    check(planet, Gauss::<4>::new(H).by_newton(), PLANET);
    check(planet, Galerkin::<4>::new(H).by_newton(), PLANET);
    check(bob, Galerkin::<4>::new(H).by_newton(), BOB);
    check(bob, Evi::midpoint(H), BOB);
}

/// The derivatives of where both bodies come to, the heavy one weighed by its mass, by the start of the light one.
#[test]
fn gradients() {
    let gradient = |heavy: f64| {
        let course = Course::new([2.0, 1.0, 0.5, 0.0], [0.5, 0.0, 0.0, 0.7], 100);
        let cost = |steps: u64, state: &State<BobAndWeight>, gradient: &mut StateGradient<BobAndWeight>| {
            if steps < 100 {
                return 0.0;
            }
            gradient.q[0] += heavy;
            gradient.q[2] += 1.0;
            heavy * state.q()[0] + state.q()[2]
        };
        let found = Simulation::new(bob(heavy), Galerkin::<4>::new(H)).gradient_of(&course, &cost);
        let start = found.expect("a gradient").start;
        [start.q[2], start.q[3], start.v[2], start.v[3]]
    };
    let alike = gradient(1.0);
    for heavy in [1e6, 1e12, 1e20, 1e30] {
        let difference = largest_difference(&gradient(heavy), &alike);
        assert!(difference <= ROUND_OFF, "beside {heavy:e} kg: {difference:e}");
    }
}

const N: usize = 3;

/// Pendulums side by side.
#[derive(MechanicalSystem, Clone)]
#[evi(
    coordinates(p: [N, 2]),
    kinetic = sum(0..N, |i| 0.5 * m[i] * der(p[i]).norm_squared()),
    potential = sum(0..N, |i| m[i] * g[i] * p[i][1]),
    constraint(rod[i in 0..N]: p[i].norm_squared() == 1.0),
)]
struct Pendulums {
    m: [f64; N],
    g: [f64; N],
}

/// The same, of masses that depend on where they are.
#[derive(MechanicalSystem, Clone)]
#[evi(
    coordinates(p: [N, 2]),
    kinetic = sum(0..N, |i| 0.5 * m[i] * (1.0 + 0.3 * p[i][0].sin()) * der(p[i]).norm_squared()),
    potential = sum(0..N, |i| m[i] * g[i] * p[i][1]),
    constraint(rod[i in 0..N]: p[i].norm_squared() == 1.0),
)]
struct VaryingPendulums {
    m: [f64; N],
    g: [f64; N],
}

/// What the mass of the first pendulum, which hangs at rest, changes of where the others come to.
#[track_caller]
fn check_many<S: AssembledSystem + Clone>(
    system: impl Fn([f64; N], [f64; N]) -> S,
    scheme: impl AssembledScheme + Copy,
) {
    let end = |heavy: f64| {
        let system = system([heavy, 1.0, 0.7], [0.0, 9.0, 7.0]);
        let (q, v) = (vec![0.0, -1.0, 1.0, 0.0, 0.6, 0.8], vec![0.0, 0.0, 0.0, 0.3, 0.8, -0.6]);
        let mut run = AssembledSimulation::new(system, scheme).start(q, v).expect("a start");
        for _ in 0..100 {
            run.advance().expect("a step");
        }
        run.state().q()[2..].to_vec()
    };
    let alike = end(1.0);
    for heavy in [1e6, 1e12, 1e20, 1e30] {
        let difference = largest_difference(&end(heavy), &alike);
        assert!(difference <= ROUND_OFF, "beside {heavy:e} kg: {difference:e}");
    }
}

#[test]
fn of_many() {
    let pendulums = |m, g| Pendulums { m, g };
    check_many(pendulums, Evi::midpoint(H));
    check_many(pendulums, Galerkin::<4>::new(H));
    let varying = |m, g| VaryingPendulums { m, g };
    check_many(varying, Evi::midpoint(H));
    check_many(varying, Galerkin::<4>::new(H));
}
