//! Observables, accelerations, multipliers, and what parameters are.

use super::*;

#[test]
fn observables_are_the_formulas_of_a_textbook() {
    let DoublePendulum { m1, m2, l1, l2, g } = UNEQUAL;
    let Start { q: [x1, y1, x2, y2], v: [u1, w1, u2, w2] } = moving();
    let (q, v) = ([x1, y1, x2, y2], [u1, w1, u2, w2]);
    let mechanics = Mechanics::new(&UNEQUAL);
    let kinetic = 0.5 * m1 * (u1 * u1 + w1 * w1) + 0.5 * m2 * (u2 * u2 + w2 * w2);
    let energy = kinetic + g * (m1 * y1 + m2 * y2);
    check_near(&[mechanics.energy_at(0.0, &q, &v)], &[energy], 8.0 * EPSILON * energy.abs());
    check_near(&mechanics.momentum_at(0.0, &q, &v), &[m1 * u1, m1 * w1, m2 * u2, m2 * w2], 2.0 * EPSILON);
    // Away from the constraints, where the residuals are not zero.
    let q = [x1 + 0.1, y1, x2, y2 - 0.2];
    let rod = [q[2] - q[0], q[3] - q[1]];
    let lengths = [q[0] * q[0] + q[1] * q[1] - l1 * l1, rod[0] * rod[0] + rod[1] * rod[1] - l2 * l2];
    check_near(&mechanics.constraint_residual_at(0.0, &q), &lengths, 8.0 * EPSILON);
    let rates = [q[0] * u1 + q[1] * w1, rod[0] * (u2 - u1) + rod[1] * (w2 - w1)].map(f64::abs);
    let speed = v.iter().map(|v| v * v).sum::<f64>().sqrt();
    let gradients = [q[0].hypot(q[1]), 2.0_f64.sqrt() * rod[0].hypot(rod[1])];
    let relative = [rates[0] / (gradients[0] * speed), rates[1] / (gradients[1] * speed)];
    assert!(relative.iter().all(|relative| *relative > 1e-2), "vacuous: {relative:?}");
    check_near(&mechanics.hidden_constraint_residual_at(0.0, &q, &v), &relative, 8.0 * EPSILON);
}

#[test]
fn observables_of_a_state_are_those_at_its_numbers() {
    let mut run = midpoint_run();
    run.advance_to(0.3).unwrap();
    let (state, mechanics) = (run.state().clone(), run.mechanics());
    let (t, q, v) = (state.t(), state.q(), state.v());
    assert_eq!(run.energy(), mechanics.energy_at(t, q, v));
    assert_eq!(mechanics.constraint_residual(&state), mechanics.constraint_residual_at(t, q));
    assert_eq!(
        mechanics.hidden_constraint_residual(&state),
        mechanics.hidden_constraint_residual_at(t, q, v)
    );
    check_near(state.p(), &mechanics.momentum_at(t, q, v), 8.0 * EPSILON);
}

#[test]
fn a_hidden_constraint_at_rest_has_no_residual() {
    let mechanics = Mechanics::new(&UNEQUAL);
    assert_eq!(mechanics.hidden_constraint_residual_at(0.0, &moving().q, &[0.0; 4]), [0.0; 2]);
}

/// The constraint forces `−2 λ₁ r₁ + 2 λ₂ d` and `−2 λ₂ d` (`d` along the outer rod) from Newton's laws for
/// the bobs and the accelerations `r₁·a₁ = −v₁²`, `d·(a₂ − a₁) = −(v₂ − v₁)²` of rigid rods: two equations,
/// by Cramer's rule.
#[test]
fn accelerations_and_multipliers_are_those_of_newtons_laws() {
    let DoublePendulum { m1, m2, l1, l2, g } = UNEQUAL;
    let Start { q: [x1, y1, x2, y2], v: [u1, w1, u2, w2] } = moving();
    let [dx, dy] = [x2 - x1, y2 - y1];
    let cosine = x1 * dx + y1 * dy;
    let (a11, a12, b1) = (2.0 * l1 * l1 / m1, -2.0 * cosine / m1, u1 * u1 + w1 * w1 - g * y1);
    let (a21, a22) = (-2.0 * cosine / m1, 2.0 * l2 * l2 * (1.0 / m1 + 1.0 / m2));
    let b2 = (u2 - u1).powi(2) + (w2 - w1).powi(2);
    let determinant = a11 * a22 - a12 * a21;
    let lambda = [(b1 * a22 - a12 * b2) / determinant, (a11 * b2 - b1 * a21) / determinant];
    let inner = [
        (-2.0 * lambda[0] * x1 + 2.0 * lambda[1] * dx) / m1,
        (-2.0 * lambda[0] * y1 + 2.0 * lambda[1] * dy) / m1 - g,
    ];
    let outer = [-2.0 * lambda[1] * dx / m2, -2.0 * lambda[1] * dy / m2 - g];

    let Ok(found) = Mechanics::new(&UNEQUAL).acceleration(0.0, &[x1, y1, x2, y2], &[u1, w1, u2, w2]) else {
        panic!("masses and rods determine the acceleration");
    };
    // Both eliminations round forces of size 10: 4 ε and 8 ε measured.
    check_near(&found.multipliers, &lambda, 16.0 * EPSILON);
    check_near(&found.acceleration, &[inner[0], inner[1], outer[0], outer[1]], 32.0 * EPSILON);
    assert!(lambda.iter().all(|lambda| lambda.abs() > 1.0), "vacuous: {lambda:?}");
}

#[test]
fn multipliers_of_a_moving_constraint_know_its_acceleration() {
    // Hanging at rest below the pivot at the turn of its motion: the bob follows the pivot, a = −A w².
    let system = KapitzaPendulum::STANDARD;
    let (t, pivot) = (0.0, system.a);
    let Ok(found) = Mechanics::new(&system).acceleration(t, &[0.0, pivot - system.l], &[0.0; 2]) else {
        panic!("mass and rod determine the acceleration");
    };
    let follows = -system.a * system.w.powi(2);
    check_near(&found.acceleration, &[0.0, follows], 8.0 * EPSILON * follows.abs());
    // m a = −m g − Gᵀλ with G = (0, −2 l).
    let lambda = system.m * (follows + system.g) / (2.0 * system.l);
    check_near(&found.multipliers, &[lambda], 8.0 * EPSILON * lambda.abs());
}

#[test]
fn parameters_are_numbers_of_the_run_not_of_the_build() {
    let Start { q, v } = Dumbbell::STANDARD.turning();
    let end = |system: Dumbbell| {
        let mut run = Simulation::new(system, Evi::midpoint(0.01)).start(q, v).unwrap();
        *run.advance_to(1.0).unwrap().q()
    };
    let standard = end(Dumbbell::STANDARD);
    let heavier = end(Dumbbell { m2: 5.0, ..Dumbbell::STANDARD });
    assert!(largest_difference(&standard, &heavier) > 1e-2);
    // Only the ratio of the masses matters. Equality of bits: powers of two are exact.
    assert_eq!(standard, end(Dumbbell { m1: 4.0, m2: 8.0, ..Dumbbell::STANDARD }));
}

#[test]
fn fourfold_gravity_is_the_same_motion_in_half_the_time() {
    let Start { q, .. } = moving();
    let end = |g: f64, h: f64| {
        let system = DoublePendulum { g, ..UNEQUAL };
        let mut run = Simulation::new(system, Evi::midpoint(h)).start(q, [0.0; 4]).unwrap();
        (0..100).for_each(|_| assert!(run.advance().is_ok()));
        run.state().clone()
    };
    let (slow, fast) = (end(9.81, 0.01), end(4.0 * 9.81, 0.005));
    // Equality of bits: every factor is a power of two.
    assert_eq!(slow.q(), fast.q());
    assert_eq!(slow.v().map(|v| 2.0 * v), *fast.v());
    assert!(largest_difference(slow.q(), &q) > 1e-2, "the run stood still");
}

#[test]
fn mechanics_is_a_copy_of_the_parameters() {
    let mut system = UNEQUAL;
    let mechanics = Mechanics::new(&system);
    let Start { q, v } = moving();
    let energy = mechanics.energy_at(0.0, &q, &v);
    system.g = 1.62;
    assert_eq!(mechanics.clone().energy_at(0.0, &q, &v), energy);
    assert_ne!(Mechanics::new(&system).energy_at(0.0, &q, &v), energy);
}
