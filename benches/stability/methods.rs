//! Which methods are tried on which kind of system.

use evi_benches::comparison::methods::{self, Method, MethodFacts};
use evi_benches::comparison::{Refusal, Subject};
use evi_core::prelude::*;

/// On systems without constraints.
pub(crate) fn without_constraints<S: Subject>() -> Vec<Method<S>> {
    vec![
        methods::midpoint(),
        methods::trapezoid(),
        methods::simpson(),
        methods::exponential(),
        methods::midpoint_6(),
        methods::galerkin_4(),
        methods::gauss_4(),
        methods::implicit_midpoint(),
        methods::generalized_alpha(),
        methods::rk4(),
        methods::dop853(),
    ]
}

/// On systems with constraints.
pub(crate) fn with_constraints<S: Subject>() -> Vec<Method<S>> {
    vec![
        methods::midpoint(),
        methods::simpson(),
        methods::exponential(),
        methods::midpoint_6(),
        methods::galerkin_4(),
        methods::rattle(),
        methods::shake(),
        methods::implicit_midpoint(),
        methods::generalized_alpha(),
        methods::rk4(),
        methods::dop853(),
    ]
}

/// Where constraints are the matter: the members by the ways in which they solve for multipliers, and what differentiates constraints.
pub(crate) fn on_constraints<S: Subject>() -> Vec<Method<S>> {
    vec![
        methods::midpoint(),
        methods::trapezoid(),
        methods::midpoint_6(),
        methods::galerkin_4(),
        methods::rattle(),
        methods::generalized_alpha(),
        methods::rk4(),
    ]
}

/// Members on curves of a frequency.
pub(crate) fn on_curves<S: Subject>() -> Vec<Method<S>> {
    vec![methods::midpoint_trig(), methods::trapezoid_trig(), methods::simpson_trig(), methods::exponential()]
}

/// Those that go on for ten million steps.
pub(crate) fn for_long_runs<S: Subject>() -> Vec<Method<S>> {
    vec![
        methods::midpoint(),
        methods::midpoint_compensated(),
        methods::exponential(),
        methods::galerkin_4(),
        methods::rattle(),
        methods::rk4(),
    ]
}

/// Those for which the equations of a step may have no solution.
pub(crate) fn on_the_double_pendulum<S: Subject>() -> Vec<Method<S>> {
    vec![
        methods::midpoint(),
        methods::midpoint_trig(),
        methods::simpson_trig(),
        simpson_trig_rescued(),
        methods::exponential(),
        methods::galerkin_4(),
        methods::rattle(),
    ]
}

/// Where constraints may be dependent: with `R` of them independent, what is told so.
pub(crate) fn on_constraints_of_rank<S: Subject, const R: usize>() -> Vec<Method<S>> {
    let mut methods = on_constraints();
    methods.push(midpoint_of_rank::<S, R>());
    methods
}

/// The midpoint rule with multipliers of least norm.
fn midpoint_of_rank<S: Subject, const R: usize>() -> Method<S> {
    let summary = "midpoint rule, multipliers of least norm";
    let facts = MethodFacts { name: "midpoint_of_rank", summary, ..methods::midpoint::<S>().facts };
    let start: methods::Start<S> = |motion, h| {
        let simulation = Simulation::new(motion.system.clone(), Evi::midpoint(h)).constraints_of_rank::<R>();
        Ok(Box::new(simulation.start(motion.q.clone(), motion.v.clone())?))
    };
    Method { facts, start }
}

/// Simpson's rule on curves of a frequency, steps without a solution in up to eight parts.
fn simpson_trig_rescued<S: Subject>() -> Method<S> {
    let summary = "Simpson's rule on curves, steps without a solution in parts";
    let facts = MethodFacts { name: "simpson_trig_rescued", summary, ..methods::simpson_trig::<S>().facts };
    let start: methods::Start<S> = |motion, h| {
        let frequency = motion.frequency.ok_or(Refusal::NoFrequency)?;
        let scheme = Evi::simpson(h).frequency(frequency).rescued::<3>();
        let simulation = Simulation::new(motion.system.clone(), scheme);
        Ok(Box::new(simulation.start(motion.q.clone(), motion.v.clone())?))
    };
    Method { facts, start }
}
