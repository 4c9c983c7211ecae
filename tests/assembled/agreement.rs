//! The steps are those of `Simulation` to round-off.

use evi_core::array::Array;
use evi_core::assembled::{AssembledScheme, AssembledSimulation, AssembledSystem, Family, FamilyVisitor};
use evi_core::prelude::*;
use evi_examples::{AndrewsSqueezer, CarAxis, Chain5, Chain20, DrivenPendulum, Start};
use evi_tests::largest_difference;
use evi_tests::trusses::{Placed, chain};

/// The largest difference of positions, and of velocities as a share of the largest.
#[track_caller]
fn differences<S, F, const N: usize>(specialised: S, assembled: Placed, scheme: F, end: f64) -> [f64; 2]
where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]>,
    F: Scheme<S> + AssembledScheme + Clone,
{
    let Placed { truss, q } = assembled;
    let start: [f64; N] = q.clone().try_into().expect("as many coordinates");
    let mut one = Simulation::new(specialised, scheme.clone()).start(start, [0.0; N]).expect("a start");
    let mut other = AssembledSimulation::new(truss, scheme).start(q, vec![0.0; N]).expect("a start");
    one.advance_to(end).expect("every step");
    other.advance_to(end).expect("every step");
    assert_eq!(one.steps(), other.steps());
    assert!((one.energy() - other.energy()).abs() < 1e-13, "{} {}", one.energy(), other.energy());
    let (one, other) = (one.state(), other.state());
    let speed = largest_difference(other.v(), &[0.0; N]);
    assert!(speed > 0.1, "it moves");
    [largest_difference(one.q(), other.q()), largest_difference(one.v(), other.v()) / speed]
}

#[test]
fn chains_move_as_those_of_the_gallery() {
    let order_4 = Evi::midpoint(0.01).composed(Composition::suzuki_4());
    let of_five = differences(Chain5::UNIT, chain(5), order_4, 0.2);
    let of_twenty = differences(Chain20::UNIT, chain(20), Evi::midpoint(0.005), 0.1);
    let by_passes = differences(Chain5::UNIT, chain(5), Galerkin::<3>::new(0.02), 0.2);
    println!("{of_five:?} {of_twenty:?} {by_passes:?}");
    // 6.4e-15 measured, of velocities.
    assert!([of_five, of_twenty, by_passes].into_iter().flatten().all(|difference| difference < 1e-14));
}

/// Two scenes that do not touch each other, their coordinates in turn.
#[derive(Clone)]
pub(crate) struct Twice<E>(pub(crate) E);

/// Either of them.
struct Either<E>(core::marker::PhantomData<E>);

impl<E: MechanicalSystem + Clone + 'static> Family<Twice<E>> for Either<E> {
    type Element = E;

    fn count(_: &Twice<E>) -> usize {
        2
    }

    fn element(Twice(scene): &Twice<E>, _: usize) -> E {
        scene.clone()
    }

    fn coordinates(_: &Twice<E>, copy: usize) -> E::PerCoordinate<usize> {
        Array::from_fn(|i| 2 * i + copy)
    }
}

impl<E: MechanicalSystem + Clone + 'static> AssembledSystem for Twice<E> {
    fn n_coordinates(&self) -> usize {
        2 * E::N_COORDINATES
    }

    fn visit_families<V: FamilyVisitor<Self>>(&self, visitor: &mut V) {
        visitor.family::<Either<E>>();
    }
}

/// Either copy ends where the scene itself does, to round-off of the largest number: 4.0e-15 of it measured, of velocities that Galerkin steps of 0.2 ms find
/// from positions.
#[track_caller]
fn check_twice<E, F, const N: usize>(scene: E, start: Start<N>, scheme: F, end: f64)
where
    E: MechanicalSystem<PerCoordinate<f64> = [f64; N]> + Clone + 'static,
    F: Scheme<E> + AssembledScheme + Clone,
{
    let mut one = Simulation::new(scene.clone(), scheme.clone()).start(start.q, start.v).expect("a start");
    let doubled = |x: [f64; N]| x.into_iter().flat_map(|x| [x, x]).collect::<Vec<_>>();
    let two = AssembledSimulation::new(Twice(scene), scheme);
    let mut two = two.start(doubled(start.q), doubled(start.v)).expect("a start");
    one.advance_to(end).expect("every step");
    two.advance_to(end).expect("every step");
    for (one, start, two) in
        [(one.state().q(), start.q, two.state().q()), (one.state().v(), start.v, two.state().v())]
    {
        let difference = largest_difference(&doubled(*one), two) / largest_difference(one, &[0.0; N]);
        println!("{}: {difference:e}", core::panic::Location::caller());
        assert!(difference < 5e-15, "{difference:e}");
        assert!(largest_difference(one, &start) > 1e-3, "it moves");
    }
}

#[test]
fn scenes_of_every_structure_move_side_by_side_as_alone() {
    // A mass that varies, and constraints; constraints and a potential that vary with time; friction.
    let squeezer = AndrewsSqueezer::STANDARD;
    check_twice(squeezer, squeezer.standard_start(), Evi::midpoint(5e-5), 1e-3);
    check_twice(squeezer, squeezer.standard_start(), Galerkin::<3>::new(2e-4), 1e-3);
    check_twice(CarAxis::STANDARD, CarAxis::STANDARD.standard_start(), Evi::simpson(0.01), 0.3);
    let damped = DrivenPendulum::STANDARD;
    check_twice(damped, damped.horizontal(), Evi::midpoint(0.01), 0.3);
    check_twice(damped, damped.horizontal(), Galerkin::<3>::new(0.02), 0.3);
}
