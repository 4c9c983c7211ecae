//! What a report consists of, as it stands in `results.json`.

use serde::{Deserialize, Serialize};

use evi_benches::comparison::measure::Outcome;
use evi_benches::comparison::methods::{MethodFacts, Resolution};
use evi_benches::comparison::scenes::SceneFacts;

/// Everything that was measured, and with what.
#[derive(Serialize)]
pub(crate) struct Results {
    pub(crate) machine: evi_benches::program::machine::Machine,
    pub(crate) quick: bool,
    /// Accuracies of the verdicts.
    pub(crate) errors: [f64; crate::verdicts::ERRORS.len()],
    pub(crate) scenes: Vec<Scene>,
    pub(crate) methods: Vec<Method>,
    pub(crate) rows: Vec<Row>,
    pub(crate) orders: Vec<crate::orders::Fitted>,
    pub(crate) verdicts: Vec<crate::verdicts::Verdict>,
    pub(crate) speedups: Vec<Speedup>,
    pub(crate) long_runs: Vec<LongRun>,
}

#[derive(Serialize)]
pub(crate) struct Scene {
    pub(crate) name: &'static str,
    summary: &'static str,
    origin: &'static str,
    n_coordinates: usize,
    n_constraints: usize,
    horizon: f64,
    conserves_energy: bool,
    momenta: Vec<&'static str>,
    reference: String,
    /// `‖q‖` at the horizon.
    pub(crate) size: f64,
}

impl From<SceneFacts> for Scene {
    fn from(facts: SceneFacts) -> Self {
        let SceneFacts { name, summary, origin, n_coordinates, n_constraints, .. } = facts;
        let SceneFacts { horizon, conserves_energy, momenta, size, .. } = facts;
        let reference = facts.reference.to_string();
        Self {
            name,
            summary,
            origin,
            n_coordinates,
            n_constraints,
            horizon,
            conserves_energy,
            momenta,
            reference,
            size,
        }
    }
}

#[derive(Serialize)]
pub(crate) struct Method {
    pub(crate) name: &'static str,
    path: &'static str,
    order: u32,
    pub(crate) is_member: bool,
    summary: &'static str,
}

#[cfg(test)]
impl Method {
    pub(crate) const fn named(name: &'static str, is_member: bool) -> Self {
        Self { name, path: "specialised", order: 4, is_member, summary: "" }
    }
}

impl From<MethodFacts> for Method {
    fn from(MethodFacts { name, path, role, order, summary, .. }: MethodFacts) -> Self {
        Self { name, path: path.name(), order, is_member: role.is_member(), summary }
    }
}

/// One run, or why there is none. The fields are the columns of `results.csv`, in their order.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Row {
    pub(crate) scene: String,
    pub(crate) method: String,
    pub(crate) path: String,
    pub(crate) order: u32,
    pub(crate) h: Option<f64>,
    pub(crate) tolerance: Option<f64>,
    pub(crate) horizon: f64,
    pub(crate) seconds: Option<f64>,
    pub(crate) seconds_spread: Option<f64>,
    pub(crate) position_error: Option<f64>,
    pub(crate) energy_error: Option<f64>,
    pub(crate) constraint_error: Option<f64>,
    pub(crate) momentum_error: Option<f64>,
    /// `ok`, or why there are no numbers.
    pub(crate) status: String,
    pub(crate) hidden_constraint_error: Option<f64>,
    pub(crate) steps: Option<u64>,
}

impl Row {
    /// A row without numbers.
    pub(crate) fn without_run(scene: &SceneFacts, method: &MethodFacts, status: impl Into<String>) -> Self {
        Self {
            scene: scene.name.into(),
            method: method.name.into(),
            path: method.path.name().into(),
            order: method.order,
            h: None,
            tolerance: None,
            horizon: scene.horizon,
            seconds: None,
            seconds_spread: None,
            position_error: None,
            energy_error: None,
            constraint_error: None,
            momentum_error: None,
            status: status.into(),
            hidden_constraint_error: None,
            steps: None,
        }
    }

    #[cfg(test)]
    pub(crate) fn empty(scene: &str, method: &str) -> Self {
        let empty = r#"{"path": "specialised", "order": 4, "horizon": 1.0, "status": "ok"}"#;
        let mut row: serde_json::Value = serde_json::from_str(empty).expect("JSON");
        row["scene"] = scene.into();
        row["method"] = method.into();
        serde_json::from_value(row).expect("a row")
    }

    /// At a step size or tolerance.
    pub(crate) fn at(mut self, resolution: Resolution, value: f64) -> Self {
        match resolution {
            Resolution::StepSize => self.h = Some(value),
            Resolution::Tolerance => self.tolerance = Some(value),
        }
        self
    }

    /// With the numbers of a run. Numbers that are not finite are left out and make the status.
    pub(crate) fn with(mut self, outcome: Outcome) -> Self {
        let finite = |value: f64| value.is_finite().then_some(value);
        self.seconds = Some(outcome.seconds);
        self.seconds_spread = outcome.seconds_spread;
        self.steps = Some(outcome.steps);
        self.position_error = finite(outcome.position_error);
        self.energy_error = outcome.deviation.energy.and_then(finite);
        self.constraint_error = outcome.deviation.constraint.and_then(finite);
        self.momentum_error = outcome.deviation.momentum.and_then(finite);
        self.hidden_constraint_error = outcome.deviation.hidden_constraint.and_then(finite);
        if self.position_error.is_none() {
            self.status = "diverged: the end is not finite".into();
        }
        self
    }
}

/// What the specialised code of a scene gains over the generic path, at the same method and step size.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Speedup {
    pub(crate) scene: String,
    pub(crate) method: String,
    pub(crate) h: f64,
    /// Nanoseconds per step.
    pub(crate) specialised_ns: f64,
    pub(crate) generic_ns: f64,
    /// Instructions per step; `None` where valgrind does not run.
    pub(crate) specialised_instructions: Option<f64>,
    pub(crate) generic_instructions: Option<f64>,
}

/// Energy errors over a time much longer than the horizon, at about the same run time for every method.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct LongRun {
    pub(crate) scene: String,
    pub(crate) method: String,
    pub(crate) h: Option<f64>,
    pub(crate) tolerance: Option<f64>,
    /// Ends of the windows.
    pub(crate) times: Vec<f64>,
    /// Largest `|H − H₀|` in each window.
    pub(crate) energy_errors: Vec<f64>,
    pub(crate) status: String,
}
