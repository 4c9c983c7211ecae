//! What the compiler knows about a scene, as known by hand; and that the generated code holds nothing else.

mod printed;

use evi_core::prelude::*;
use evi_core::system::{
    Block, Dependence, Entry, EntryValue, KernelOperations, KernelReport, MassShape, Operations, Potential,
    Structure, SystemReport,
};
use evi_examples::{
    DoublePendulum, DrivenPendulum, HarmonicOscillator, Pendulum, SliderCrank, SphericalPendulum,
    StiffSpringPendulum,
};
use evi_tests::scenes::{
    ChargedParticle, ChargedSphericalPendulum, DampedOscillator, DampedPendulum, DoublePendulumInAngles,
    Dumbbell, KapitzaPendulum, ModulatedPendulum, MotorisedDoublePendulum, RelativisticBead,
};
use expect_test::{Expect, expect};

const NOTHING: Operations = Operations { additions: 0, multiplications: 0, divisions: 0, functions: 0 };

/// A varying block by the letters that it depends on.
fn varying(on: &str) -> Block {
    Block::Varying(Dependence { on_q: on.contains('q'), on_v: on.contains('v'), on_t: on.contains('t') })
}

#[track_caller]
fn check_blocks<S: MechanicalSystem>([qq, vq, vv, vt]: [Block; 4]) {
    let blocks = S::STRUCTURE.blocks;
    assert_eq!([blocks.qq, blocks.vq, blocks.vv, blocks.vt], [qq, vq, vv, vt], "{}", S::REPORT.name);
}

#[test]
fn blocks_of_the_hessian_are_classified_as_by_hand() {
    use Block::{Constant, Zero};
    check_blocks::<DoublePendulum>([Zero, Zero, Constant, Zero]);
    check_blocks::<HarmonicOscillator>([Constant, Zero, Constant, Zero]);
    check_blocks::<Pendulum>([varying("q"), Zero, Constant, Zero]);
    check_blocks::<SphericalPendulum>([Zero, Zero, Constant, Zero]);
    check_blocks::<StiffSpringPendulum>([varying("q"), Zero, Constant, Zero]);
    check_blocks::<DoublePendulumInAngles>([varying("qv"), varying("qv"), varying("q"), Zero]);
    check_blocks::<ChargedParticle>([varying("q"), Constant, Constant, Zero]);
    check_blocks::<ModulatedPendulum>([varying("qt"), Zero, Constant, Zero]);
    check_blocks::<DampedPendulum>([varying("qt"), Zero, varying("t"), varying("vt")]);
    check_blocks::<RelativisticBead>([Zero, Zero, varying("v"), Zero]);
    check_blocks::<KapitzaPendulum>([Zero, Zero, Constant, Zero]);
    check_blocks::<Dumbbell>([Zero, Zero, Constant, Zero]);
}

#[track_caller]
fn check_energies<S: MechanicalSystem>(
    shape: MassShape,
    potential: Potential,
    momentum_vanishes_at_rest: bool,
) {
    let found = (S::STRUCTURE.mass_shape, S::STRUCTURE.potential, S::STRUCTURE.momentum_vanishes_at_rest);
    assert_eq!(found, (shape, potential, momentum_vanishes_at_rest), "{}", S::REPORT.name);
}

#[test]
fn mass_potential_and_momentum_at_rest_are_classified_as_by_hand() {
    use MassShape::{BlockDiagonal, Diagonal, Full};
    check_energies::<DoublePendulum>(Diagonal, Potential::Affine, true);
    check_energies::<HarmonicOscillator>(Diagonal, Potential::Quadratic, true);
    check_energies::<Pendulum>(Diagonal, Potential::General, true);
    check_energies::<DoublePendulumInAngles>(Full, Potential::Inseparable, true);
    check_energies::<ChargedParticle>(Diagonal, Potential::General, false);
    check_energies::<ChargedSphericalPendulum>(Diagonal, Potential::Affine, false);
    check_energies::<DampedPendulum>(Diagonal, Potential::General, true);
    check_energies::<RelativisticBead>(Full, Potential::Affine, true);
    check_energies::<Dumbbell>(Diagonal, Potential::Zero, true);
    check_energies::<Chain>(BlockDiagonal(2), Potential::Quadratic, true);
}

/// Every kind of constraint once, and one that repeats another.
#[derive(MechanicalSystem)]
#[evi(
    coordinates(a, b, c),
    kinetic = 0.5 * m * (der(a) + der(b)).powi(2) + der(b).powi(2) + der(c).powi(2),
    potential = 0.5 * k * (t.cos() + 2.0) * (a.powi(2) + b * c),
    constraint(plane: a + b == l),
    constraint(turning: t.cos() * b + t.sin() * c == 0.0),
    constraint(circle: b.powi(2) + c.powi(2) == l.powi(2)),
    constraint(again: l == a + b),
    constraint(alone: c == 3.0 * l),
)]
struct Chain {
    m: f64,
    k: f64,
    l: f64,
}

/// Bodies on surfaces, one of them a sphere about the origin on which a single mass moves.
#[derive(MechanicalSystem)]
#[evi(
    coordinates(x, y, z, u, v, w),
    kinetic = 0.5 * m1 * (der(x).powi(2) + der(y).powi(2)) + 0.5 * m2 * (der(z).powi(2) + der(u).powi(2))
        + 0.5 * m2 * der(v).powi(2) + 0.5 * m2 * (1.0 + t * t) * der(w).powi(2),
    potential = 0.0,
    constraint(ellipse: x.powi(2) + 2.0 * y.powi(2) == l.powi(2)),
    constraint(two_masses: y.powi(2) + z.powi(2) == l.powi(2)),
    constraint(circle: u.powi(2) + v.powi(2) == l.powi(2)),
    constraint(varying_mass: w.powi(2) == l.powi(2)),
)]
struct Surfaces {
    m1: f64,
    m2: f64,
    l: f64,
}

#[test]
fn constraints_are_classified_one_by_one() {
    let each = Chain::STRUCTURE.each_constraint;
    let gradients: Vec<Block> = each.iter().map(|constraint| constraint.gradient).collect();
    let constant = Block::Constant;
    assert_eq!(gradients, [constant, varying("t"), varying("q"), constant, constant]);
    let affine: Vec<bool> = each.iter().map(|constraint| constraint.is_affine()).collect();
    assert_eq!(affine, [true, true, false, true, true]);
    let on_t: Vec<bool> = each.iter().map(|constraint| constraint.on_t).collect();
    assert_eq!(on_t, [false, true, false, false, false]);
    let quadratic: Vec<bool> = each.iter().map(|constraint| constraint.is_quadratic).collect();
    // The curvature of `turning` depends on q through its second derivative in time.
    assert_eq!(quadratic, [true, false, true, true, true]);
    assert!(DoublePendulum::STRUCTURE.has_quadratic_constraints());
    let spheres = |structure: Structure| {
        structure.each_constraint.iter().map(|each| each.is_sphere).collect::<Vec<_>>()
    };
    assert_eq!(spheres(DoublePendulum::STRUCTURE), [true, false]);
    assert_eq!(spheres(SphericalPendulum::STRUCTURE), [true]);
    assert!(
        SphericalPendulum::STRUCTURE.has_constant_gram() && !DoublePendulum::STRUCTURE.has_constant_gram()
    );
    assert_eq!(spheres(Surfaces::STRUCTURE), [false, false, true, false]);
    // Twice something each; a slope of `turning` is constant.
    assert_eq!([DoublePendulum::STRUCTURE.jacobian.content, Chain::STRUCTURE.jacobian.content], [2.0, 1.0]);
    // `turning` depends on time, a crank's constraints are trigonometric.
    assert!(!Chain::STRUCTURE.has_quadratic_constraints());
    assert!(!SliderCrank::STRUCTURE.has_quadratic_constraints());
    let repeats: Vec<Option<usize>> = each.iter().map(|constraint| constraint.repeats).collect();
    assert_eq!(repeats, [None, None, None, Some(0), None]);
    let graph = [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (1, 4), (2, 3), (2, 4)];
    assert_eq!(Chain::STRUCTURE.constraint_graph, graph);
    assert!(Chain::REPORT.to_string().contains("constraint again repeats plane"));
    assert_eq!(DoublePendulum::STRUCTURE.constraint_graph, [(0, 1)]);
}

#[test]
fn a_scene_without_constraints_has_no_operations_for_them() {
    fn check<S: MechanicalSystem>() {
        let KernelOperations { constraints, constraint_slopes, constraint_curvature, .. } =
            S::STRUCTURE.operations;
        assert_eq!([constraints, constraint_slopes, constraint_curvature], [NOTHING; 3]);
        assert!(S::REPORT.left_out().any(|sentence| sentence.starts_with("multipliers: ")));
    }
    check::<HarmonicOscillator>();
    check::<Pendulum>();
    check::<DoublePendulumInAngles>();
    assert_ne!(DoublePendulum::STRUCTURE.operations.constraint_slopes, NOTHING);
}

#[test]
fn uniform_gravity_costs_no_entries_of_the_hessian_and_no_operations() {
    for structure in [DoublePendulum::STRUCTURE, SphericalPendulum::STRUCTURE, KapitzaPendulum::STRUCTURE] {
        assert!(structure.hessian.qq.is_empty() && structure.hessian.vq.is_empty());
        // Second derivatives cost nothing beyond the first.
        assert_eq!(structure.operations.lagrangian_derivatives, structure.operations.lagrangian_gradient);
    }
}

#[test]
fn a_constant_mass_has_no_varying_entries() {
    fn varying_entries(entries: &[Entry]) -> usize {
        entries.iter().filter(|entry| matches!(entry.value, EntryValue::Varying(_))).count()
    }
    let of = |structure: Structure| varying_entries(structure.hessian.vv);
    assert_eq!(
        [of(DoublePendulum::STRUCTURE), of(Pendulum::STRUCTURE), of(ChargedParticle::STRUCTURE)],
        [0; 3]
    );
    assert_eq!(of(DoublePendulumInAngles::STRUCTURE), 1, "only the coupling of the angles varies");
    // Nor does evaluating a mass that is a product of parameters cost an operation.
    let KernelOperations { lagrangian_gradient, lagrangian_derivatives, .. } =
        HarmonicOscillator::STRUCTURE.operations;
    assert_eq!(lagrangian_derivatives, lagrangian_gradient);
    let left_out =
        |report: SystemReport| report.left_out().any(|line| line.starts_with("mass matrix: constant"));
    assert!(left_out(DoublePendulum::REPORT) && left_out(Pendulum::REPORT));
    assert!(!left_out(DoublePendulumInAngles::REPORT));
}

/// The double pendulum with fields that no equation names.
#[derive(MechanicalSystem)]
#[evi(
    coordinates(x1, y1, x2, y2),
    kinetic   = 0.5 * m1 * (der(x1).powi(2) + der(y1).powi(2))
              + 0.5 * m2 * (der(x2).powi(2) + der(y2).powi(2)),
    potential = g * (m1 * y1 + m2 * y2),
    constraint(rod1: x1.powi(2) + y1.powi(2) == l1.powi(2)),
    constraint(rod2: (x2 - x1).powi(2) + (y2 - y1).powi(2) == l2.powi(2)),
)]
#[expect(dead_code, reason = "fields that no equation names are what is tested")]
struct WithUnusedFields {
    label: String,
    m1: f64,
    colour: f64,
    m2: f64,
    l1: f64,
    l2: f64,
    g: f64,
}

#[test]
fn an_unused_field_changes_no_operation_count() {
    let (with, without) = (WithUnusedFields::STRUCTURE.operations, DoublePendulum::STRUCTURE.operations);
    assert_ne!(without.lagrangian_derivatives, NOTHING);
    assert_eq!(format!("{with:?}"), format!("{without:?}"));
    assert_eq!(WithUnusedFields::PARAMETERS, DoublePendulum::PARAMETERS);
}

#[test]
fn a_kernel_of_more_than_5000_statements_is_warned_of() {
    const KERNEL: KernelReport = DoublePendulum::REPORT.kernels[3];
    let allowed = &[KernelReport { statements: 5_000, ..KERNEL }];
    let large = &[KernelReport { statements: 5_001, ..KERNEL }];
    let report =
        |kernels: &'static [KernelReport]| SystemReport { kernels, ..DoublePendulum::REPORT }.to_string();
    assert!(!report(allowed).contains("Warnings"));
    assert!(report(large).contains("lagrangian_derivatives has 5001 statements"), "{}", report(large));
}

#[test]
fn unknowns_are_counted_before_and_after_elimination() {
    fn check<S: MechanicalSystem>(expected: (usize, usize)) {
        assert_eq!((S::REPORT.n_unknowns(), S::REPORT.n_unknowns_after_elimination()), expected);
    }
    check::<DoublePendulum>((6, 2));
    check::<HarmonicOscillator>((1, 0));
    check::<Pendulum>((1, 1));
    check::<SphericalPendulum>((4, 1));
    check::<ChargedSphericalPendulum>((4, 1));
    check::<DoublePendulumInAngles>((2, 2));
    check::<StiffSpringPendulum>((2, 2));
    assert_eq!(StiffSpringPendulum::REPORT.n_unknowns_of_midpoint_steps(), 1);
    assert_eq!(DoublePendulum::REPORT.n_unknowns_of_midpoint_steps(), 2);
}

#[track_caller]
fn check_equations<S: MechanicalSystem>(expected: &[&str]) {
    let text = |equation: &evi_core::system::Equation| {
        let name = if equation.name.is_empty() { String::new() } else { format!("{}: ", equation.name) };
        format!("{name}{} = {}", equation.left.unicode, equation.right.unicode)
    };
    assert_eq!(S::REPORT.equations.iter().map(text).collect::<Vec<_>>(), expected);
}

#[test]
fn equations_read_as_they_were_written() {
    check_equations::<Pendulum>(&["L = T − V", "T = ½ m l² θ̇²", "V = −m g l cos θ"]);
    check_equations::<StiffSpringPendulum>(&[
        "L = T − V",
        "T = ½ m (ẋ² + ẏ²)",
        "V = ½ k stretch² + m g y",
        "stretch = √(x² + y²) − l",
    ]);
    check_equations::<DoublePendulumInAngles>(&[
        "L = T − V",
        "T = ½ (m₁ + m₂) l₁² ȧ² + ½ m₂ l₂² ḃ² + m₂ l₁ l₂ ȧ ḃ cos(a − b)",
        "V = −(m₁ + m₂) g l₁ cos a − m₂ g l₂ cos b",
    ]);
    check_equations::<ChargedParticle>(&["L = ½ m (ẋ² + ẏ²) + ½ b (x ẏ − y ẋ) − (¼ x⁴ + ½ x² y + y²)"]);
    check_equations::<DampedPendulum>(&["L = exp(c t) (½ θ̇² + g cos θ)"]);
    check_equations::<RelativisticBead>(&["L = −m c² √(1 − (ẋ² + ẏ²)/c²) − m g y", "circle: x² + y² = 1"]);
}

#[test]
fn forces_inputs_frequencies_and_observed_quantities_are_reported() {
    check_equations::<DampedOscillator>(&[
        "L = T − V",
        "T = ½ m ẋ²",
        "V = ½ k x²",
        "D = ½ c ẋ²",
        "f_x = push",
        "ω_x = √(k/m)",
        "energy = ½ m ẋ² + ½ k x²",
    ]);
    let report = DampedOscillator::REPORT.to_string();
    for line in
        ["  inputs       push\n", "  observed     energy\n", "  forces       on x; vary with v and inputs\n"]
    {
        assert!(report.contains(line), "{line} is missing in {report}");
    }
    // No folded step: the oscillator's L is quadratic, but a force acts.
    assert!(report.contains("  unknowns: 1\n"), "{report}");
    expect![[r#"
        \begin{aligned}
          L &= T - V \\
          T &= \frac{1}{2} (m_1 + m_2) l_1^2 \dot{a}^2 + \frac{1}{2} m_2 l_2^2 \dot{b}^2 + m_2 l_1 l_2 \dot{a} \dot{b} \cos(a - b) \\
          V &= -(m_1 + m_2) g l_1 \cos a - m_2 g l_2 \cos b \\
          D &= \frac{1}{2} \mathrm{inner} \dot{a}^2 + \frac{1}{4} \mathrm{outer} (\dot{b} - \dot{a})^4 \\
          f_{b} &= \mathrm{torque} \sin(a - 2 b) \cos(w t)
        \end{aligned}
    "#]].assert_eq(&MotorisedDoublePendulum::REPORT.latex().to_string());
    let of = MotorisedDoublePendulum::STRUCTURE.forces;
    assert_eq!(
        (of.forced, of.on, of.on_inputs),
        (&[0, 1][..], Dependence { on_q: true, on_v: true, on_t: true }, false)
    );
}

#[test]
fn equations_as_latex() {
    expect![[r#"
        \begin{aligned}
          L &= T - V \\
          T &= \frac{1}{2} m_1 (\dot{x}_1^2 + \dot{y}_1^2) + \frac{1}{2} m_2 (\dot{x}_2^2 + \dot{y}_2^2) \\
          V &= g (m_1 y_1 + m_2 y_2) \\
          x_1^2 + y_1^2 &= l_1^2 \\
          (x_2 - x_1)^2 + (y_2 - y_1)^2 &= l_2^2
        \end{aligned}
    "#]]
    .assert_eq(&DoublePendulum::REPORT.latex().to_string());
    expect![[r#"
        \begin{aligned}
          L &= T - V \\
          T &= \frac{1}{2} m (\dot{x}^2 + \dot{y}^2) \\
          V &= \frac{1}{2} k \mathrm{stretch}^2 + m g y \\
          \mathrm{stretch} &= \sqrt{x^2 + y^2} - l
        \end{aligned}
    "#]]
    .assert_eq(&StiffSpringPendulum::REPORT.latex().to_string());
}

#[test]
fn the_text_of_the_generated_code_is_left_out_unless_asked_for() {
    // Examples ask for it, and are built together with this test or not.
    assert!(DoublePendulum::SOURCE.is_none_or(|source| source.contains("fn lagrangian_derivatives")));
}
