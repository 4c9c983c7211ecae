//! Lyapunov exponents: the mean rates at which small deviations of a motion grow.
//!
//! The method of Benettin, Galgani, Giorgilli, Strelcyn (Meccanica 15 (1980) 9 and 21): vectors tangent to the constraint manifold are moved by the derivative of
//! the steps and made orthonormal again from time to time; the means of the logarithms of their lengths are the exponents, the largest first.
//!
//! The sum of all of them is the growth of a volume. In the volume of Liouville, `√det(Wᵀ J W)` of a frame `W` of the tangent space of `T*N`, steps that are
//! symplectic on the manifold change it by round-off alone: [`LyapunovRun::liouville_rate`] is a test of that, of size `ε / h`.

use std::vec::Vec;

use super::{DerivativeError, Differentiable, Differentiate, Direction, StateTangent, TangentRun};
use crate::array::Array;
use crate::integrator::{Scheme, Simulation};
use crate::linear::InPlaceLu;
use crate::mechanics::State;
use crate::system::MechanicalSystem;

/// A run with the growth of tangent vectors along it.
///
/// ```
/// use evi_core::prelude::*;
/// use evi_core::sensitivity::LyapunovRun;
/// # #[derive(MechanicalSystem)]
/// # #[evi(coordinates(theta), kinetic = 0.5 * der(theta).powi(2), potential = -rate.powi(2) * theta.cos())]
/// # struct Pendulum { rate: f64 }
/// // Upside down at rest: deviations grow and decay as exp(±3 t).
/// let simulation = Simulation::new(Pendulum { rate: 3.0 }, Evi::midpoint(0.01));
/// let mut run = LyapunovRun::new(&simulation, [core::f64::consts::PI], [0.0], 2, 10)?;
/// run.advance_to(5.0)?;
/// let exponents = run.exponents();
/// assert!((exponents[0] - 3.0).abs() < 0.1 && (exponents[1] + 3.0).abs() < 0.1);
/// # Ok::<(), evi_core::sensitivity::DerivativeError>(())
/// ```
pub struct LyapunovRun<S: MechanicalSystem, M: Differentiable<S>> {
    run: TangentRun<S, M>,
    /// Steps between two orthonormalizations.
    every: u64,
    /// Logarithms of the lengths so far.
    growth: Vec<f64>,
    volume: LiouvilleVolume,
    /// The logarithm of the volume of the frame as it was made, and what the volumes have grown by since the start.
    volume_of_frame: f64,
    volume_growth: f64,
}

impl<S: MechanicalSystem, M: Differentiable<S>> LyapunovRun<S, M> {
    /// A run from a start, for the `count` largest exponents; the vectors are made orthonormal after every so many steps.
    ///
    /// The first vectors point in directions at random, the same in every run.
    ///
    /// # Errors
    /// [`DerivativeError::Dimension`] for more exponents than the phase space on the constraints has dimensions, or none, and for no steps;
    /// [`DerivativeError`] of a run that does not start.
    pub fn new<F: Scheme<S, Step = M>>(
        simulation: &Simulation<S, F>,
        q: impl Into<S::PerCoordinate<f64>>,
        v: impl Into<S::PerCoordinate<f64>>,
        count: usize,
        every: u64,
    ) -> Result<Self, DerivativeError> {
        let dimension = 2 * (S::N_COORDINATES - S::STATED_RANK.unwrap_or(S::N_CONSTRAINTS));
        if count == 0 || count > dimension || every == 0 {
            return Err(DerivativeError::Dimension { asked: count, dimension });
        }
        let mut random = Weyl(0.0);
        let mut vector = || S::PerCoordinate::<f64>::from_fn(|_| random.next());
        let directions: Vec<_> = (0..count).map(|_| Direction::of_start(vector(), vector())).collect();
        let run = simulation.start_with_tangents(q, v, &directions)?;
        let mut run = Self {
            run,
            every,
            growth: std::vec![0.0; count],
            volume: LiouvilleVolume::new(count),
            volume_of_frame: 0.0,
            volume_growth: 0.0,
        };
        run.make_orthonormal()?;
        run.growth.fill(0.0);
        run.volume_growth = 0.0;
        Ok(run)
    }

    /// The state reached.
    pub const fn state(&self) -> &State<S> {
        self.run.state()
    }

    /// Takes steps until the next one would end beyond `t` by more than half a step.
    ///
    /// # Errors
    /// [`DerivativeError`] of the first step that fails, and for vectors that leave the numbers or fall together between two orthonormalizations.
    pub fn advance_to(&mut self, t: f64) -> Result<(), DerivativeError> {
        for _ in 0..self.run.steps_to(t)? {
            self.run.advance()?;
            if self.run.run().steps().is_multiple_of(self.every) {
                self.make_orthonormal()?;
            }
        }
        Ok(())
    }

    /// The exponents up to the last orthonormalization, per unit of time.
    pub fn exponents(&self) -> Vec<f64> {
        let elapsed = self.elapsed();
        self.growth.iter().map(|growth| growth / elapsed).collect()
    }

    /// The rate of growth of the volume of Liouville that the vectors span, per unit of time: that of all exponents together is zero to round-off. `None`
    /// for an odd number of vectors, which span none.
    pub fn liouville_rate(&self) -> Option<f64> {
        self.growth.len().is_multiple_of(2).then(|| self.volume_growth / self.elapsed())
    }

    /// The time up to the last orthonormalization.
    fn elapsed(&self) -> f64 {
        let steps = self.run.run().steps() / self.every * self.every;
        // The cast of a signed number is one instruction; no run has 2⁶³ steps.
        steps as i64 as f64 * self.run.h()
    }

    /// Gram and Schmidt's method, twice, on positions and velocities in the units of the scene: exponents do not depend on what a length is.
    fn make_orthonormal(&mut self) -> Result<(), DerivativeError> {
        let t = self.run.state().t;
        self.volume_growth += self.volume.logarithm(self.run.tangents()) - self.volume_of_frame;
        let tangents = self.run.tangents_mut();
        for k in 0..tangents.len() {
            let (known, rest) = tangents.split_at_mut(k);
            let tangent = &mut rest[0];
            for _ in 0..2 {
                for known in &*known {
                    let share = product(known, tangent);
                    add_multiple(tangent, -share, known);
                }
            }
            let length = product(tangent, tangent).sqrt();
            let is_sound = length.is_finite() && length > 0.0;
            if !is_sound {
                return Err(DerivativeError::NotFinite { t });
            }
            multiply(tangent, 1.0 / length);
            self.growth[k] += length.ln();
        }
        self.volume_of_frame = self.volume.logarithm(self.run.tangents());
        Ok(())
    }
}

/// Numbers between −1 and 1 without a pattern: multiples of the golden ratio, squared in phase.
struct Weyl(f64);

impl Weyl {
    fn next(&mut self) -> f64 {
        const GOLDEN: f64 = 0.618_033_988_749_894_9;
        self.0 += 1.0;
        2.0 * (self.0 * self.0 * GOLDEN).fract() - 1.0
    }
}

fn product<S: MechanicalSystem>(a: &StateTangent<S>, b: &StateTangent<S>) -> f64 {
    (0..S::N_COORDINATES).map(|i| a.q[i] * b.q[i] + a.v[i] * b.v[i]).sum()
}

fn add_multiple<S: MechanicalSystem>(sum: &mut StateTangent<S>, factor: f64, x: &StateTangent<S>) {
    for i in 0..S::N_COORDINATES {
        sum.q[i] += factor * x.q[i];
        sum.v[i] += factor * x.v[i];
        sum.p[i] += factor * x.p[i];
    }
}

fn multiply<S: MechanicalSystem>(x: &mut StateTangent<S>, factor: f64) {
    for i in 0..S::N_COORDINATES {
        x.q[i] *= factor;
        x.v[i] *= factor;
        x.p[i] *= factor;
    }
}

/// The volume of Liouville of a frame.
struct LiouvilleVolume {
    form: Vec<f64>,
    factors: InPlaceLu,
}

impl LiouvilleVolume {
    fn new(count: usize) -> Self {
        Self { form: std::vec![0.0; count * count], factors: InPlaceLu::new(count) }
    }

    /// `½ ln det(Wᵀ J W)`; 0 for frames without a volume.
    fn logarithm<S: MechanicalSystem>(&mut self, frame: &[StateTangent<S>]) -> f64 {
        let count = frame.len();
        if !count.is_multiple_of(2) {
            return 0.0;
        }
        for (row, a) in frame.iter().enumerate() {
            for (col, b) in frame.iter().enumerate() {
                self.form[col * count + row] =
                    (0..S::N_COORDINATES).map(|i| a.q[i] * b.p[i] - a.p[i] * b.q[i]).sum();
            }
        }
        match self.factors.factor(&mut self.form) {
            Ok(()) => 0.5 * (0..count).map(|k| self.form[k * count + k].abs().ln()).sum::<f64>(),
            Err(_) => f64::NAN,
        }
    }
}
