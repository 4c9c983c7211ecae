//! Symmetric compositions: high order from many short steps of one symmetric scheme.
//!
//! In: a [`Symmetric`] scheme of step size `h` and a [`Composition`], fractions `γ` that add up to 1 and mirror each other. Out: a
//! scheme of the same step size, `Ψ_{γ_s h} ∘ … ∘ Ψ_{γ_1 h}`. Whatever the base keeps (symplectic form, momentum maps, constraints) the
//! composition keeps. Some fractions are negative: those stages go back in time.

use super::{Compensable, CompensableStep, OneStep, Rescued, Scheme, StepError, Tally};
use crate::mechanics::{LostDigits, Mechanics, State};
use crate::memory::{Memory, memory};
use crate::scheme::SchemeError;
use crate::system::MechanicalSystem;

/// A scheme whose step of size `−h` undoes its step of size `h`.
///
/// The error of such a scheme has even powers of `h` only, so that compositions gain two orders at a time (Hairer, Lubich, Wanner,
/// Geometric Numerical Integration, sec. II.4 and V.3). Explicit Runge-Kutta methods are none of them:
///
/// ```compile_fail,E0599
/// # use evi_core::{baseline::Rk4, prelude::*};
/// let refused = Rk4::new(0.1).composed(Composition::suzuki_4());
/// ```
pub trait Symmetric: Clone {
    /// Step size.
    fn step_size(&self) -> f64;

    /// The same scheme with steps of size `h`.
    #[must_use]
    fn with_step_size(&self, h: f64) -> Self;

    /// Whether this value of the type is symmetric, where that depends on its nodes.
    ///
    /// # Errors
    /// [`SchemeError::AsymmetricNodes`].
    fn check_symmetry(&self) -> Result<(), SchemeError>;

    /// Takes the steps of this scheme as the stages of a composition. The step size, and the time that a step takes, stay what
    /// they were: every stage is a fraction of it.
    ///
    /// ```
    /// # use evi_core::prelude::*;
    /// let order_8 = Evi::midpoint(0.1).composed(Composition::kahan_li_8());
    /// # let _ = order_8;
    /// ```
    fn composed<const N: usize>(self, composition: Composition<N>) -> Composed<Self, N> {
        Composed { base: self, composition }
    }

    /// Takes a step that fails for its length ([`StepError::NoSolution`], [`StepError::Singular`], [`StepError::Projection`]) in `2` parts, if those
    /// fail in `4`, and so on to `2^K`; the times of steps stay what they are. Where no number of parts helps, the error is that of the whole
    /// step.
    ///
    /// Opt-in, for something is lost: steps of one length follow a modified energy, and one of another length follows another. A
    /// rescued step is symplectic and on the constraints as every step is, but whether it is taken in parts depends on the state, so that the
    /// map as a whole is not, nor does a step back undo it; the energy jumps by about the difference of both modified energies, once per
    /// rescued step. Momenta are kept. How many steps that were is counted, by [`RescuedStep::rescues`](super::RescuedStep::rescues) and
    /// [`Statistics`](super::Statistics). A motion that needs rescue often wants smaller steps.
    ///
    /// ```
    /// # use evi_core::prelude::*;
    /// # #[derive(MechanicalSystem)]
    /// # #[evi(
    /// #     coordinates(x1, y1, x2, y2),
    /// #     kinetic = 0.5 * (der(x1).powi(2) + der(y1).powi(2) + der(x2).powi(2) + der(y2).powi(2)),
    /// #     potential = 9.81 * (y1 + y2),
    /// #     constraint(rod1: x1.powi(2) + y1.powi(2) == l.powi(2)),
    /// #     constraint(rod2: (x2 - x1).powi(2) + (y2 - y1).powi(2) == l.powi(2)),
    /// # )]
    /// # struct DoublePendulum { l: f64 }
    /// // The double pendulum from the horizontal at a step that is too large for its fastest moments.
    /// let scheme = Evi::midpoint(0.1).frequency(3.132).rescued::<6>();
    /// let mut run = Simulation::new(DoublePendulum { l: 1.0 }, scheme).start([1.0, 0.0, 2.0, 0.0], [0.0; 4])?;
    /// run.advance_to(10.0)?;
    /// assert!(run.map().rescues().steps > 0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// A rescued scheme is not symmetric: compose first.
    ///
    /// ```compile_fail,E0599
    /// # use evi_core::prelude::*;
    /// let refused = Evi::midpoint(0.1).rescued::<4>().composed(Composition::suzuki_4());
    /// ```
    fn rescued<const K: usize>(self) -> Rescued<Self, K> {
        Rescued::new(self)
    }
}

/// A symmetric composition of `N` stages: the fraction of the step that each takes.
///
/// | | order | stages | largest fraction | source |
/// |---|---|---|---|---|
/// | [`triple_jump_4`](Composition::triple_jump_4) | 4 | 3 | 1.71 | Yoshida, Phys. Lett. A 150 (1990) 262 |
/// | [`suzuki_4`](Composition::suzuki_4) | 4 | 5 | 0.66 | Suzuki, Phys. Lett. A 146 (1990) 319 |
/// | [`yoshida_6`](Composition::yoshida_6) | 6 | 7 | 1.32 | Yoshida 1990, solution A |
/// | [`kahan_li_6`](Composition::kahan_li_6) | 6 | 9 | 0.80 | Kahan & Li, Math. Comp. 66 (1997) 1089 |
/// | [`kahan_li_8`](Composition::kahan_li_8) | 8 | 17 | 0.61 | Kahan & Li 1997 |
///
/// The orders are those on a base of order 2. A step costs as many steps of the base as it has stages. Whatever bounds the step
/// size of the base (resonant frequencies, solvability) bounds the largest stage. Backward stages turn damping into growth: the
/// strongly damped are better served by another method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Composition<const N: usize> {
    fractions: [f64; N],
}

impl Composition<3> {
    /// Order 4 in three stages: forward, back, forward (Yoshida; Suzuki; Creutz & Gocksch). Its stages are long, its errors the
    /// larger of the two members of order 4.
    pub const fn triple_jump_4() -> Self {
        // 1/(2 − 2^(1/3))
        Self::mirrored([1.351_207_191_959_657_6])
    }
}

impl Composition<5> {
    /// Order 4 in five stages: two forward, one back, two forward.
    pub const fn suzuki_4() -> Self {
        // 1/(4 − 4^(1/3))
        Self::mirrored([0.414_490_771_794_375_74; 2])
    }
}

impl Composition<7> {
    /// Order 6 in seven stages.
    pub const fn yoshida_6() -> Self {
        Self::mirrored([0.784_513_610_477_557_3, 0.235_573_213_359_358_13, -1.177_679_984_178_871])
    }
}

impl Composition<9> {
    /// Order 6 in nine stages (Hairer, Lubich, Wanner, Geometric Numerical Integration, sec. V.3).
    pub const fn kahan_li_6() -> Self {
        Self::mirrored([
            0.392_161_444_007_314_1,
            0.332_599_136_789_359_45,
            -0.706_246_172_557_639_4,
            0.082_213_596_293_550_8,
        ])
    }
}

impl Composition<17> {
    /// Order 8 in seventeen stages (Hairer, Lubich, Wanner, Geometric Numerical Integration, sec. V.3).
    pub const fn kahan_li_8() -> Self {
        Self::mirrored([
            0.130_202_483_088_890_08,
            0.561_162_981_775_108_4,
            -0.389_474_962_644_847_3,
            0.158_841_906_555_155_6,
            -0.395_903_894_133_237_57,
            0.184_539_640_978_315_7,
            0.258_374_387_686_322_03,
            0.295_011_723_609_310_3,
        ])
    }
}

impl<const N: usize> Composition<N> {
    /// The composition with the fractions of `half` on either side of a stage that takes what they leave, so that time is exact.
    const fn mirrored<const HALF: usize>(half: [f64; HALF]) -> Self {
        assert!(N == 2 * HALF + 1, "a middle stage and the same number on either side");
        let mut fractions = [0.0; N];
        let mut sum = 0.0;
        let mut i = 0;
        while i < HALF {
            fractions[i] = half[i];
            fractions[N - 1 - i] = half[i];
            sum += half[i];
            i += 1;
        }
        fractions[HALF] = 1.0 - 2.0 * sum;
        Self { fractions }
    }

    /// Where in the step each stage starts: the sums of the fractions before it.
    fn starts(&self) -> [f64; N] {
        core::array::from_fn(|stage| self.fractions[..stage].iter().sum())
    }

    /// The fraction of the step that each stage takes, in their order; negative for a stage that goes back in time.
    pub const fn fractions(&self) -> &[f64; N] {
        &self.fractions
    }
}

/// A symmetric scheme, composed; made by [`Symmetric::composed`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Composed<B, const N: usize> {
    base: B,
    composition: Composition<N>,
}

impl<B: Symmetric, const N: usize> Symmetric for Composed<B, N> {
    fn step_size(&self) -> f64 {
        self.base.step_size()
    }

    fn with_step_size(&self, h: f64) -> Self {
        Self { base: self.base.with_step_size(h), composition: self.composition }
    }

    fn check_symmetry(&self) -> Result<(), SchemeError> {
        self.base.check_symmetry()
    }
}

impl<B: Symmetric, const N: usize> Composed<B, N> {
    /// The scheme of every stage, with the fraction of the step at which it starts.
    #[cfg(feature = "std")]
    pub(crate) fn stages(&self) -> impl Iterator<Item = (B, f64)> {
        let h = self.step_size();
        let stage = move |fraction: f64| self.base.with_step_size(fraction * h);
        self.composition.fractions.into_iter().map(stage).zip(self.composition.starts())
    }
}

impl<B: Compensable, const N: usize> Compensable for Composed<B, N> {}

impl<S: MechanicalSystem, B: Symmetric + Scheme<S>, const N: usize> Scheme<S> for Composed<B, N> {
    type Step = ComposedStep<S, B::Step, N>;

    /// Prepares one map per stage: what depends on its length is computed once per run. Stages of equal length do not share theirs, since
    /// a map predicts multipliers from its own past, which then is that of the same stage one, two and three steps ago.
    /// (On the double pendulum at h = 0.02 with `kahan_li_8` a stage needs 2.09 corrections so, 2.78 where stages of equal length share
    /// a past, 3.86 without any.)
    ///
    /// # Errors
    /// [`SchemeError::AsymmetricNodes`] for a base that is not symmetric, and what the base says about a stage of its length.
    fn prepare(&self, mechanics: Mechanics<S>) -> Result<Self::Step, SchemeError> {
        self.base.check_symmetry()?;
        let h = self.step_size();
        let mut refusal = None;
        let stages = self.composition.fractions.map(|fraction| {
            let stage = self.base.with_step_size(fraction * h);
            stage.prepare(mechanics.clone()).map_err(|error| refusal = Some(error)).ok()
        });
        match refusal {
            Some(error) => Err(error),
            None => {
                let stages = stages.map(|stage| stage.expect("a stage is prepared or refused"));
                Ok(ComposedStep { mechanics, stages, starts: self.composition.starts().map(|c| c * h), h })
            }
        }
    }
}

/// The one-step map of a [`Composed`] scheme.
pub struct ComposedStep<S: MechanicalSystem, M, const N: usize> {
    mechanics: Mechanics<S>,
    stages: [M; N],
    /// Time from the start of the step to that of each stage.
    starts: [f64; N],
    h: f64,
}

impl<S: MechanicalSystem, M: OneStep<S>, const N: usize> OneStep<S> for ComposedStep<S, M, N> {
    fn h(&self) -> f64 {
        self.h
    }

    fn mechanics(&self) -> &Mechanics<S> {
        &self.mechanics
    }

    #[inline]
    fn advance(&mut self, state: &mut State<S>, tally: &mut impl Tally) -> Result<(), StepError> {
        self.take_stages(state, |stage, reached| stage.advance(reached, tally))
    }
}

impl<S: MechanicalSystem, M: CompensableStep<S>, const N: usize> CompensableStep<S>
    for ComposedStep<S, M, N>
{
    #[inline]
    fn advance_compensated(
        &mut self,
        state: &mut State<S>,
        lost: &mut LostDigits<S>,
        tally: &mut impl Tally,
    ) -> Result<(), StepError> {
        let mut lost_so_far = lost.clone();
        self.take_stages(state, |stage, reached| {
            stage.advance_compensated(reached, &mut lost_so_far, tally)
        })?;
        *lost = lost_so_far;
        Ok(())
    }
}

impl<S: MechanicalSystem, M, const N: usize> ComposedStep<S, M, N> {
    /// The maps of the stages, in their order.
    pub const fn stages(&self) -> &[M; N] {
        &self.stages
    }

    /// Overwrites `state` with where the stages lead one after the other.
    #[inline(always)]
    pub(crate) fn take_stages<E>(
        &mut self,
        state: &mut State<S>,
        mut take: impl FnMut(&mut M, &mut State<S>) -> Result<(), E>,
    ) -> Result<(), E> {
        let mut reached = state.clone();
        for (stage, start) in self.stages.iter_mut().zip(&self.starts) {
            // Not what the stages before have added up: their roundings are felt by constraints that move.
            reached.t = state.t + start;
            take(stage, &mut reached)?;
        }
        reached.t = state.t + self.h;
        *state = reached;
        Ok(())
    }
}

memory!([S: MechanicalSystem, M: Memory, const N: usize] ComposedStep<S, M, N>, |words|
    Self { mechanics: _, stages, starts, h } => {
        for start in starts {
            words.fixed(*start);
        }
        words.fixed(*h);
        for stage in stages {
            words.part(stage);
        }
    }
);

#[cfg(test)]
mod tests {
    use super::*;

    /// `Σ γᵏ` for the odd powers that a composition of order `order` of a method of order 2 annihilates, and the fractions' sum.
    #[track_caller]
    fn check<const N: usize>(composition: Composition<N>, stages: usize, order: i32) {
        let fractions = composition.fractions();
        assert_eq!(fractions.len(), stages);
        let power_sum = |k: i32| fractions.iter().map(|fraction| fraction.powi(k)).sum::<f64>();
        assert!((power_sum(1) - 1.0).abs() <= 2.0 * f64::EPSILON, "{}", power_sum(1));
        for k in (3..order).step_by(2) {
            // Fractions of 16 digits, up to 17 of them; 4e-16 measured.
            assert!(power_sum(k).abs() < 2e-15, "power {k}: {:e}", power_sum(k));
        }
        assert!(power_sum(order + 1).abs() > 1e-5, "a higher order than said");
        assert!(fractions.iter().eq(fractions.iter().rev()), "{fractions:?}");
    }

    #[test]
    fn fractions_mirror_each_other_and_annihilate_the_power_sums_of_their_order() {
        check(Composition::triple_jump_4(), 3, 4);
        check(Composition::suzuki_4(), 5, 4);
        check(Composition::yoshida_6(), 7, 6);
        check(Composition::kahan_li_6(), 9, 6);
        check(Composition::kahan_li_8(), 17, 8);
    }
}
