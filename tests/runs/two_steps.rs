//! The two-step view has the positions of the one-step map.

use super::*;

/// Every configuration follows from the two before it.
#[track_caller]
fn check_two_step_view<S, F, const N: usize, const K: usize>(
    system: S,
    scheme: Evi<K, F>,
    t: f64,
    start: Start<N>,
) where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]>,
    F: Interpolant<S>,
{
    let mut run = Simulation::new(system, scheme).start_at(t, start.q, start.v).unwrap();
    let trajectory = run.integrate(1.0).unwrap();
    let map: &EviStep<S, F, K> = run.map();
    let mut largest = 0.0_f64;
    for states in trajectory.states().windows(3) {
        let [prev, curr, next] = states else { unreachable!("windows of three") };
        let q = map.next_configuration(prev.t(), prev.q(), curr.q()).expect("the step exists");
        largest = largest.max(largest_difference(&q, next.q()));
    }
    assert!(trajectory.states().len() > 50);
    // A difference of positions of size 2 stands for a velocity, and is off by 2 ε, as much as is measured.
    assert!(largest <= 8.0 * EPSILON, "{:.1} ε", largest / EPSILON);
}

#[test]
fn the_two_step_view_has_the_positions_of_the_one_step_map() {
    check_two_step_view(UNEQUAL, Evi::midpoint(0.01), 0.0, moving());
    check_two_step_view(UNEQUAL, Evi::simpson(0.01), 0.0, moving());
    check_two_step_view(UNEQUAL, Evi::new(Quadrature::<2>::uniform(), 0.01), 0.0, moving());
    let spherical = SphericalPendulum::UNIT;
    check_two_step_view(spherical, Evi::midpoint(0.01), 0.0, spherical.one_radian());
    let spring = StiffSpringPendulum::with_stiffness(1e3);
    check_two_step_view(spring, Evi::simpson(0.01), 0.0, spring.horizontal());
}

#[test]
fn the_two_step_view_has_the_positions_of_the_exponential_maps() {
    check_two_step_view(UNEQUAL, Evi::midpoint(0.01).frequency(2.4), 0.0, moving());
    check_two_step_view(UNEQUAL, Evi::simpson(0.01).frequency(2.4), 0.0, moving());
    check_two_step_view(UNEQUAL, Evi::simpson(0.01).frequency(Frequency::Hyperbolic(2.4)), 0.0, moving());
    let per_body = [Frequency::ZERO, Frequency::ZERO, 2.4.into(), 2.4.into()];
    check_two_step_view(UNEQUAL, Evi::simpson(0.01).frequencies(per_body), 0.0, moving());
}

#[test]
fn the_two_step_view_knows_the_time_and_couplings_of_position_and_velocity() {
    let kapitza = KapitzaPendulum::STANDARD;
    check_two_step_view(kapitza, Evi::midpoint(0.01), 0.0, kapitza.near_inverted());
    check_two_step_view(kapitza, Evi::simpson(0.01).frequency(5.0), 0.0, kapitza.near_inverted());
    let charged = ChargedSphericalPendulum::STANDARD;
    check_two_step_view(charged, Evi::simpson(0.01).frequency(2.4), 5.0, charged.one_radian());
    let start = RelativisticBead::at_angle(1.0, 0.5);
    check_two_step_view(RelativisticBead::STANDARD, Evi::midpoint(0.01), 0.0, start);
}
