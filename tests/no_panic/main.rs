//! Steps in which the optimiser finds no path to a panic: every function below links only if that is proved, with all that takes over where a first
//! attempt fails. Starts may panic, in a scheme that is prepared with a broken invariant.

mod scenes;

use std::hint::black_box;

use evi_core::baseline::Rattle;
use evi_core::integrator::{Compensated, Composed, LinearisedAt, MatrixEvi, OfRank, Rescued};
use evi_core::prelude::*;
use evi_examples::{DoublePendulum, DoublePendulumAngles, Kepler, StiffSpringPendulum};
use no_panic::no_panic;
use scenes::{CarriedPendulum, PolarBead};

/// A run that counts nothing.
type RunOf<S, F> = Run<S, <F as Scheme<S>>::Step, ()>;

/// Functions that take a step, with the name that the linker complains of.
macro_rules! steps {
    ($($(#[$attribute:meta])* $name:ident: $scene:ident by $scheme:ty;)*) => {$(
        $(#[$attribute])*
        #[no_panic]
        #[inline(never)]
        fn $name(run: &mut RunOf<$scene, $scheme>) -> bool {
            run.advance().is_ok()
        }
    )*};
}

steps! {
    /// Folded, on straight curves.
    folded: DoublePendulum by Evi<1>;
    /// Folded, three nodes on trigonometric curves.
    folded_on_curves: DoublePendulum by Evi<3, Frequency>;
    /// Seventeen folded stages.
    composed: DoublePendulum by Composed<Evi<1>, 17>;
    /// A kick, a drift and a kick.
    leapfrog: StiffSpringPendulum by Evi<2>;
    /// Found by a distance, along which the force is linear.
    spring: StiffSpringPendulum by Evi<1>;
    /// Found by a distance.
    orbit: Kepler by Evi<1>;
    /// Newton's iteration on positions.
    general: StiffSpringPendulum by Evi<3>;
    /// The same with time, constraints, forces and an input.
    driven: CarriedPendulum by Evi<1>;
    /// With lost digits kept.
    compensated: DoublePendulum by Compensated<Evi<1>>;
    /// In up to sixteen parts.
    rescued: DoublePendulum by Rescued<Evi<1>, 4>;
    /// A quadratic part integrated exactly.
    exact: DoublePendulum by MatrixEvi<2, LinearisedAt<[f64; 4]>>;
    /// The same on Simpson's nodes.
    exact_on_nodes: DoublePendulum by MatrixEvi<3, LinearisedAt<[f64; 4]>>;
    /// On the null space of constraints of stated rank.
    of_rank: TwoConstraintsOfRank by Evi<1>;
    /// Passes over lanes with a constant mass and constraints.
    galerkin: DoublePendulum by Galerkin<3>;
    /// The same with every lane in use.
    galerkin_of_all_lanes: DoublePendulum by Galerkin<8>;
    /// The same with time, constraints, forces and an input.
    galerkin_driven: CarriedPendulum by Galerkin<4>;
    /// Without constraints.
    galerkin_free: StiffSpringPendulum by Galerkin<4>;
    /// Passes over points, with a mass that varies and a constraint.
    galerkin_on_points: PolarBead by Galerkin<3>;
    /// The same without constraints.
    galerkin_on_free_points: DoublePendulumAngles by Galerkin<3>;
    /// Newton's iteration on mixed curves.
    galerkin_on_curves: DoublePendulum by Galerkin<3, Frequency>;
    /// Three stages, each with passes and Newton's iteration.
    galerkin_composed: DoublePendulum by Composed<Galerkin<2>, 3>;
    /// With lost digits kept.
    galerkin_compensated: DoublePendulum by Compensated<Galerkin<3>>;
    /// In up to sixteen parts.
    galerkin_rescued: DoublePendulum by Rescued<Galerkin<3>, 4>;
    /// Canonical variables, a constant mass.
    gauss: StiffSpringPendulum by Gauss<3>;
    /// A mass that varies.
    gauss_of_angles: DoublePendulumAngles by Gauss<4>;
    /// With lost digits kept.
    gauss_compensated: DoublePendulumAngles by Compensated<Gauss<2>>;
    /// The classical form.
    rattle: DoublePendulum by Rattle;
}

/// Of both constraints of the scene, both are independent.
type TwoConstraintsOfRank = OfRank<DoublePendulum, 2>;

/// Takes a step from a state of which the optimiser knows nothing.
fn take<S, F, const N: usize>(system: S, scheme: F, start: [f64; N], step: impl Fn(&mut RunOf<S, F>) -> bool)
where
    S: MechanicalSystem<PerCoordinate<f64> = [f64; N]>,
    F: Scheme<S>,
{
    let simulation = Simulation::new(system, black_box(scheme));
    let run = simulation.start_projected(0.0, start, [0.0; N]).expect("near the constraints");
    println!("{}", step(&mut black_box(run.with_tally(()))));
}

fn main() {
    let double = || DoublePendulum { m1: 1.0, m2: 0.5, l1: 1.0, l2: 0.8, g: 9.81 };
    let bent = [0.6, -0.8, 1.08, -1.44];
    let midpoint = Evi::midpoint(0.01);
    take(double(), midpoint, bent, folded);
    take(double(), Evi::simpson(0.01).frequency(3.0), bent, folded_on_curves);
    take(double(), midpoint.composed(Composition::kahan_li_8()), bent, composed);
    let stiff = || StiffSpringPendulum::with_stiffness(1e3);
    take(stiff(), Evi::trapezoid(0.01), [1.0, 0.0], leapfrog);
    take(stiff(), midpoint, [1.0, 0.0], spring);
    take(Kepler::UNIT, midpoint, [1.0, 0.0], orbit);
    take(stiff(), Evi::simpson(0.01), [1.0, 0.0], general);
    let carried = || CarriedPendulum { m: 1.0, l: 1.0, c: 0.1, w: 2.0, g: 9.81 };
    take(carried(), midpoint, [0.6, -0.8], driven);
    let angles = || DoublePendulumAngles { m1: 1.0, m2: 0.5, l1: 1.0, l2: 0.8, g: 9.81 };
    take(double(), midpoint.compensated(), bent, compensated);
    take(double(), midpoint.rescued::<4>(), bent, rescued);
    let hanging = [0.0, -1.0, 0.0, -1.8];
    take(double(), Evi::trapezoid(0.01).linearised_at(hanging), bent, exact);
    take(double(), Evi::simpson(0.01).linearised_at(hanging), bent, exact_on_nodes);
    take(OfRank::<_, 2>(double()), midpoint, bent, of_rank);
    let passes = Galerkin::<3>::new(0.1);
    take(double(), passes, bent, galerkin);
    take(double(), Galerkin::<8>::new(0.1), bent, galerkin_of_all_lanes);
    take(carried(), Galerkin::<4>::new(0.1), [0.6, -0.8], galerkin_driven);
    take(stiff(), Galerkin::<4>::new(0.01), [1.0, 0.0], galerkin_free);
    take(PolarBead { m: 1.0, c: 0.4, l: 1.0, g: 9.81 }, passes, [1.4, 0.0], galerkin_on_points);
    take(angles(), passes, [0.6, 0.9], galerkin_on_free_points);
    take(double(), passes.frequency(3.0), bent, galerkin_on_curves);
    take(double(), Galerkin::<2>::new(0.1).composed(Composition::triple_jump_4()), bent, galerkin_composed);
    take(double(), passes.compensated(), bent, galerkin_compensated);
    take(double(), passes.rescued::<4>(), bent, galerkin_rescued);
    take(stiff(), Gauss::<3>::new(0.01), [1.0, 0.0], gauss);
    take(angles(), Gauss::<4>::new(0.1), [0.6, 0.9], gauss_of_angles);
    take(angles(), Gauss::<2>::new(0.1).compensated(), [0.6, 0.9], gauss_compensated);
    take(double(), Rattle::new(0.01), bent, rattle);
}
