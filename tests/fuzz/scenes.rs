//! Scenes of every structure, with random parameters.

use std::fmt::Debug;

use evi_core::prelude::*;
use evi_examples::{
    CarAxis, DoublePendulum, HarmonicOscillator, HenonHeiles, Pendulum, SphericalPendulum,
    StiffSpringPendulum,
};
use evi_tests::scenes::{
    ChargedSphericalPendulum, DampedPendulum, MotorisedDoublePendulum, PushedDumbbell, RelativisticBead,
};

use crate::numbers::parameter;
use crate::random_choices::Choices;
use crate::steps_are_taken_as_their_equations_say_or_refused;

/// A scene with random parameters.
pub(crate) trait Random: MechanicalSystem + Debug + 'static {
    fn random(choices: &mut Choices) -> Self;
}

macro_rules! scenes {
    ($($name:ident: $scene:ident { $($field:ident),* })*) => {$(
        impl Random for $scene {
            fn random(choices: &mut Choices) -> Self {
                Self { $($field: parameter(choices)),* }
            }
        }

        #[test]
        fn $name() {
            steps_are_taken_as_their_equations_say_or_refused::<$scene>();
        }
    )*};
}

scenes! {
    car_axis: CarAxis { m, eps, l, l0, r, w, g }
    charged_spherical_pendulum: ChargedSphericalPendulum { m, l, g, b }
    damped_pendulum: DampedPendulum { g, c }
    double_pendulum: DoublePendulum { m1, m2, l1, l2, g }
    harmonic_oscillator: HarmonicOscillator { m, k }
    henon_heiles: HenonHeiles { coupling }
    motorised_double_pendulum: MotorisedDoublePendulum { m1, m2, l1, l2, g, inner, outer, torque, w }
    pendulum: Pendulum { m, l, g }
    pushed_dumbbell: PushedDumbbell { m1, m2, l, c1, c2 }
    relativistic_bead: RelativisticBead { m, c, g }
    spherical_pendulum: SphericalPendulum { m, l, g }
    stiff_spring_pendulum: StiffSpringPendulum { m, l, k, g }
}
