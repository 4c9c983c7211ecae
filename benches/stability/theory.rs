//! What theory says of a row, and whether the row agrees.
//!
//! The limits are those of the linear test equation `ÿ = −μ² y` (Kosmas & Leyendecker's family on one frequency): with `S₂ = Σ wⱼ sin² uσⱼ`,
//! `C₂ = 1 − S₂`, a step turns the phase by `θ`, `tan² ½θ = tan² ½u (μ² C₂ − ω² S₂) / (ω² C₂ − μ² S₂)`; where the right side is negative the mode
//! grows.

use serde::Serialize;

use crate::verdict::Kind;

/// What theory admits as the verdict on a row.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Theory {
    pub(crate) sentence: String,
    pub(crate) admits: &'static [Kind],
}

impl Theory {
    pub(crate) fn new(sentence: impl Into<String>, admits: &'static [Kind]) -> Self {
        Self { sentence: sentence.into(), admits }
    }
}

/// A number beside the verdict, and what theory says it is.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Figure {
    pub(crate) name: &'static str,
    pub(crate) measured: f64,
    pub(crate) theory: Option<Expected>,
}

/// What a number should be.
#[derive(Clone, Copy, Debug, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Expected {
    About { value: f64, within: f64 },
    AtMost(f64),
    AtLeast(f64),
}

impl Figure {
    /// A number that theory says nothing of.
    pub(crate) const fn seen(name: &'static str, measured: f64) -> Self {
        Self { name, measured, theory: None }
    }

    /// A number that is `value` but for the part `within` of it.
    pub(crate) const fn about(name: &'static str, measured: f64, value: f64, within: f64) -> Self {
        Self { name, measured, theory: Some(Expected::About { value, within }) }
    }

    pub(crate) const fn at_most(name: &'static str, measured: f64, value: f64) -> Self {
        Self { name, measured, theory: Some(Expected::AtMost(value)) }
    }

    pub(crate) const fn at_least(name: &'static str, measured: f64, value: f64) -> Self {
        Self { name, measured, theory: Some(Expected::AtLeast(value)) }
    }

    /// Written so that a NaN does not.
    pub(crate) fn agrees(&self) -> bool {
        let Self { measured, theory, .. } = *self;
        theory.is_none_or(|expected| match expected {
            Expected::About { value, within } => (measured - value).abs() <= within * value.abs(),
            Expected::AtMost(value) => measured <= value,
            Expected::AtLeast(value) => measured >= value,
        })
    }

    /// As in tables.
    pub(crate) fn text(&self) -> String {
        let Self { name, measured, theory } = self;
        let mark = if self.agrees() { "" } else { " (!)" };
        match theory {
            None => format!("{name} {measured:.2e}"),
            Some(Expected::About { value, .. }) => format!("{name} {measured:.4e}, theory {value:.4e}{mark}"),
            Some(Expected::AtMost(value)) => format!("{name} {measured:.2e}, theory ≤ {value:.2e}{mark}"),
            Some(Expected::AtLeast(value)) => format!("{name} {measured:.2e}, theory ≥ {value:.2e}{mark}"),
        }
    }
}

/// A mode of frequency `μ` on curves of frequency `ω` with `h ω = u`, by the offsets `σⱼ` and weights `wⱼ` of the nodes.
#[derive(Clone, Copy)]
pub(crate) struct Mode<'a> {
    pub(crate) nodes: &'a [(f64, f64)],
    pub(crate) omega: f64,
    pub(crate) mu: f64,
    pub(crate) h: f64,
}

impl Mode<'_> {
    fn u(&self) -> f64 {
        self.omega * self.h
    }

    fn s2(&self) -> f64 {
        self.nodes.iter().map(|(node, weight)| weight * (self.u() * (node - 0.5)).sin().powi(2)).sum()
    }

    /// `tan² ½θ`.
    pub(crate) fn tan_squared(&self) -> f64 {
        let (s2, u) = (self.s2(), self.u());
        let c2 = 1.0 - s2;
        let [mu, omega] = [self.mu.powi(2), self.omega.powi(2)];
        (0.5 * u).tan().powi(2) * (mu * c2 - omega * s2) / (omega * c2 - mu * s2)
    }

    /// Growth per unit of time; 0 of what oscillates.
    pub(crate) fn growth_rate(&self) -> f64 {
        let squared = self.tan_squared();
        if squared >= 0.0 {
            return 0.0;
        }
        // tan ½θ = i tanh ½ρ; beyond 1 it is i coth ½ρ, growth with alternating sign.
        let tanh = (-squared).sqrt();
        2.0 * if tanh < 1.0 { tanh.atanh() } else { (1.0 / tanh).atanh() } / self.h.abs()
    }

    /// `u² (C₂ cos² ½u − S₂ sin² ½u) / sin² u`: the share of the inertia that ties the end of a free step to its start. It vanishes at `π/2`
    /// for the trapezoid, at `2π/3` for Simpson's rule.
    pub(crate) fn inertia(&self) -> f64 {
        let (s2, u) = (self.s2(), self.u());
        let (sine, cosine) = (0.5 * u).sin_cos();
        u * u * ((1.0 - s2) * cosine.powi(2) - s2 * sine.powi(2)) / u.sin().powi(2)
    }

    /// `κ_t = u κ / sin u`: the factor between the momenta of the method and those of the motion, where `μ = ω`.
    pub(crate) fn momentum_factor(&self) -> f64 {
        self.u() * (1.0 - 2.0 * self.s2()) / self.u().sin()
    }
}

/// The same share of the inertia on hyperbolic curves of rate `u/h`: it falls like `u² e^(−u)`.
pub(crate) fn hyperbolic_inertia(nodes: &[(f64, f64)], u: f64) -> f64 {
    let share = |node: f64| (u * (1.0 - node)).cosh() / u.sinh() * ((u * node).cosh() / u.sinh());
    u * u * nodes.iter().map(|(node, weight)| weight * share(*node)).sum::<f64>()
}

/// The largest `h w` at which a method is stable for an oscillation of frequency `w` that forces make; `None` where theory has no short
/// answer.
pub(crate) fn limit_of_forces(method: &str) -> Option<f64> {
    match method {
        "trapezoid" | "rattle" | "shake" => Some(2.0),
        "simpson" => Some(12.0_f64.sqrt()),
        "midpoint" | "implicit_midpoint" => Some(f64::INFINITY),
        // On the imaginary axis: Hairer & Wanner, Solving ODEs II, sec. IV.2.
        "rk4" => Some(8.0_f64.sqrt()),
        _ => None,
    }
}

/// The same for an oscillation that constraints make of a uniform force: every straight member is RATTLE.
pub(crate) fn limit_of_constraints(method: &str) -> Option<f64> {
    match method {
        "midpoint" | "trapezoid" | "simpson" | "rattle" => Some(2.0),
        _ => None,
    }
}

/// What the limit of an oscillation that constraints make says of a row: below it, too, a step need not exist, which is then proved.
pub(crate) fn beside_constraints(phase: f64, method: &str) -> Option<Theory> {
    const KEPT_OR_NONE: &[Kind] = &[Kind::Stable, Kind::Bounded, Kind::NoSolution];
    let theory = beside(limit_of_constraints(method)?, phase, method);
    let admits = if theory.admits == Kind::KEPT { KEPT_OR_NONE } else { theory.admits };
    Some(Theory { admits, ..theory })
}

/// What a limit says of a row with `h w`.
pub(crate) fn beside(limit: f64, phase: f64, method: &str) -> Theory {
    /// Next to the limit the nonlinear motion decides.
    const NEXT: f64 = 0.02;
    /// Where the mode of the spring turns by nearly π in every step, the motion excites it parametrically: seen from 1e3 on, and of
    /// the limit `k → ∞` in closed form.
    const PARAMETRIC: f64 = 500.0;
    const ANY: &[Kind] = &[Kind::Stable, Kind::Bounded, Kind::Drifting, Kind::Diverged, Kind::NoSolution];
    /// Runge and Kutta's method damps what it does not resolve, and its energy drifts.
    const DAMPED: &[Kind] = &[Kind::Stable, Kind::Bounded, Kind::Drifting];
    if limit.is_infinite() && phase > PARAMETRIC {
        let sentence = format!("stable for every h w of a linear mode; parametric at h w = {phase:.3e}");
        return Theory::new(sentence, ANY);
    }
    let admits = match phase / limit {
        ratio if (ratio - 1.0).abs() < NEXT => ANY,
        ratio if ratio > 1.0 => Kind::NOT_STABLE,
        _ if method == "rk4" => DAMPED,
        _ => Kind::KEPT,
    };
    let limit = if limit.is_finite() {
        format!("stable for h w < {limit:.3}")
    } else {
        "stable for every h w".into()
    };
    Theory::new(format!("{limit}, h w = {phase:.3e}"), admits)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::action::{MIDPOINT, SIMPSON, TRAPEZOID};
    use evi_core::scheme::{Frequency, Quadrature, growth_rate};

    #[test]
    fn growth_is_that_of_the_library_by_another_formula() {
        for mu in [0.0, 0.7, 2.9, 8.0] {
            let mode = |nodes| Mode { nodes, omega: 3.0, mu, h: 0.4 }.growth_rate();
            let pairs = [
                (
                    mode(MIDPOINT),
                    growth_rate(Frequency::from(3.0), &Quadrature::<1>::midpoint(), 0.4, mu * mu),
                ),
                (
                    mode(TRAPEZOID),
                    growth_rate(Frequency::from(3.0), &Quadrature::<2>::uniform(), 0.4, mu * mu),
                ),
                (mode(SIMPSON), growth_rate(Frequency::from(3.0), &Quadrature::<3>::uniform(), 0.4, mu * mu)),
            ];
            println!("{mu}: {pairs:?}");
            assert!(pairs.iter().all(|(a, b)| (a - b).abs() <= 1e-13), "{pairs:?}");
        }
    }

    #[test]
    fn the_own_frequency_turns_by_its_phase_on_any_nodes() {
        for nodes in [MIDPOINT, TRAPEZOID, SIMPSON] {
            let mode = Mode { nodes, omega: 2.0, mu: 2.0, h: 0.6 };
            assert!((mode.tan_squared() - 0.6_f64.tan().powi(2)).abs() < 1e-15);
        }
    }

    #[test]
    fn a_figure_agrees_within_its_part_and_no_nan_does() {
        assert!(Figure::about("", 1.01, 1.0, 0.02).agrees() && !Figure::about("", 1.03, 1.0, 0.02).agrees());
        assert!(Figure::at_most("", 1.0, 2.0).agrees() && !Figure::at_most("", f64::NAN, 2.0).agrees());
        assert!(Figure::seen("", f64::NAN).agrees());
    }

    #[test]
    fn a_limit_admits_no_blow_up_below_and_no_stability_above() {
        assert_eq!(beside(2.0, 1.0, "trapezoid").admits, Kind::KEPT);
        assert!(!beside(2.0, 2.2, "trapezoid").admits.contains(&Kind::Stable));
        assert!(beside(f64::INFINITY, 1e6, "midpoint").sentence.contains("every"));
    }
}
