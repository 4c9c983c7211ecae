//! A solver of `diffsol` at a state.

use std::cell::RefCell;

use diffsol::{
    NalgebraLU, NalgebraMat, OdeBuilder, OdeEquations, OdeSolverMethod, OdeSolverStopReason, Vector,
};
use evi_core::comparison::{Failure, Solver};
use evi_core::system::MechanicalSystem;

use super::super::Tolerances;
use super::super::index_one::{IndexOne, split};
use super::{DiffsolError, DiffsolMethod};

/// The cube root of round-off: the relative step of a central difference quotient whose errors balance.
const DIFFERENCE: f64 = 6e-6;

type Matrix = NalgebraMat<f64>;
type Lu = NalgebraLU<f64>;

pub(super) struct Run<S: MechanicalSystem> {
    equations: IndexOne<S>,
    method: DiffsolMethod,
    tolerances: Tolerances,
    state: State<S>,
}

/// Where the solver stands.
struct State<S: MechanicalSystem> {
    t: f64,
    q: S::PerCoordinate<f64>,
    v: S::PerCoordinate<f64>,
    p: S::PerCoordinate<f64>,
    steps: u64,
}

// Written out, since a derive would demand the same of `S`.
impl<S: MechanicalSystem> Clone for State<S> {
    fn clone(&self) -> Self {
        Self { t: self.t, q: self.q.clone(), v: self.v.clone(), p: self.p.clone(), steps: self.steps }
    }
}

impl<S: MechanicalSystem> Run<S> {
    pub(super) fn new(
        system: &S,
        method: DiffsolMethod,
        q: &S::PerCoordinate<f64>,
        v: &S::PerCoordinate<f64>,
        tolerances: Tolerances,
    ) -> Self {
        let equations = IndexOne::new(system);
        let p = equations.mechanics.momentum_at(0.0, q, v);
        let state = State { t: 0.0, q: q.clone(), v: v.clone(), p, steps: 0 };
        Self { equations, method, tolerances, state }
    }

    /// Moves to `target` and hands over every state on the way.
    fn integrate(&mut self, target: f64, mut each: impl FnMut(State<S>)) -> Result<(), DiffsolError> {
        let State { t, q, v, mut steps, .. } = self.state.clone();
        if target == t {
            return Ok(());
        }
        if !target.is_finite() {
            return Err(DiffsolError::NotFinite { t, target });
        }
        let (n, len) = (S::N_COORDINATES, 2 * S::N_COORDINATES);
        let Self { equations, method, tolerances, .. } = self;
        let quotient = Quotient::new(len);
        let mut reached = t;
        let mut outcome = || -> Result<(), diffsol::error::DiffsolError> {
            let problem = OdeBuilder::<Matrix>::new()
                .t0(t)
                .h0((target - t) * DIFFERENCE)
                .rtol(tolerances.relative)
                .atol([tolerances.absolute])
                .rhs_implicit(
                    |y, _, t, slope| equations.slope(t, y, slope),
                    |y, _, t, direction, product| quotient.evaluate(equations, t, y, direction, product),
                )
                .init(|_, _, y| (0..len).for_each(|i| y[i] = if i < n { q[i] } else { v[i - n] }), len)
                .build()?;
            let mut each = |t: f64, y: Vec<f64>| {
                let (q, v) = split::<S>(&y);
                let p = equations.mechanics.momentum_at(t, &q, &v);
                steps += 1;
                reached = t;
                each(State { t, q, v, p, steps });
            };
            match method {
                DiffsolMethod::Bdf => take_steps(problem.bdf::<Lu>()?, target, &mut each),
                DiffsolMethod::TrBdf2 => take_steps(problem.tr_bdf2::<Lu>()?, target, &mut each),
                DiffsolMethod::Esdirk34 => take_steps(problem.esdirk34::<Lu>()?, target, &mut each),
            }
        };
        let outcome = outcome();
        match (outcome, self.equations.take_singular()) {
            (Ok(()), _) => Ok(()),
            (Err(_), Some((t, matrix))) => Err(DiffsolError::Singular { t, matrix }),
            (Err(cause), None) => Err(DiffsolError::Stopped { t: reached, message: cause.to_string() }),
        }
    }
}

/// Takes steps up to `target`, and shows the state after each.
fn take_steps<'a, E: OdeEquations<T = f64> + 'a>(
    mut solver: impl OdeSolverMethod<'a, E>,
    target: f64,
    each: &mut impl FnMut(f64, Vec<f64>),
) -> Result<(), diffsol::error::DiffsolError> {
    solver.set_stop_time(target)?;
    loop {
        let reason = solver.step()?;
        let state = solver.state();
        each(state.t, state.y.clone_as_vec());
        if matches!(reason, OdeSolverStopReason::TstopReached) {
            return Ok(());
        }
    }
}

/// A central difference quotient along a direction, with room for its points.
struct Quotient {
    room: RefCell<[Vec<f64>; 3]>,
}

impl Quotient {
    fn new(len: usize) -> Self {
        Self { room: RefCell::new([vec![0.0; len], vec![0.0; len], vec![0.0; len]]) }
    }

    fn evaluate<S: MechanicalSystem>(
        &self,
        equations: &IndexOne<S>,
        t: f64,
        y: &[f64],
        direction: &[f64],
        product: &mut [f64],
    ) {
        let largest = |x: &[f64]| x.iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
        let length = largest(direction);
        if length == 0.0 {
            product.fill(0.0);
            return;
        }
        let step = DIFFERENCE * largest(y).max(1.0) / length;
        let [point, ahead, behind] = &mut *self.room.borrow_mut();
        for (sign, slope) in [(step, &mut *ahead), (-step, &mut *behind)] {
            for i in 0..y.len() {
                point[i] = y[i] + sign * direction[i];
            }
            equations.slope(t, point, slope);
        }
        for i in 0..y.len() {
            product[i] = (ahead[i] - behind[i]) / (2.0 * step);
        }
    }
}

impl<S: MechanicalSystem> Solver for Run<S> {
    fn t(&self) -> f64 {
        self.state.t
    }

    fn q(&self) -> &[f64] {
        self.state.q.as_ref()
    }

    fn v(&self) -> &[f64] {
        self.state.v.as_ref()
    }

    fn p(&self) -> &[f64] {
        self.state.p.as_ref()
    }

    fn steps(&self) -> u64 {
        self.state.steps
    }

    fn advance_to(&mut self, t: f64) -> Result<(), Failure> {
        let mut last = None;
        let outcome = self.integrate(t, |state| last = Some(state));
        if let Some(state) = last {
            self.state = state;
        }
        Ok(outcome?)
    }

    fn advance_visiting(&mut self, t: f64, visit: &mut dyn FnMut(&dyn Solver)) -> Result<(), Failure> {
        let mut states = Vec::new();
        let outcome = self.integrate(t, |state| states.push(state));
        for state in states {
            self.state = state;
            visit(self);
        }
        Ok(outcome?)
    }
}
