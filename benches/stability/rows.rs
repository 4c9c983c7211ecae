//! Rows: what is planned, what is found, and what stands in tables and files.

use std::sync::Arc;

use serde::Serialize;

use crate::check::Check;
use crate::observation::{Course, Ending, Observation, observe};
use crate::series::Series;
use crate::specimen::Specimen;
use crate::theory::{Figure, Theory};
use crate::verdict::{self, Verdict};

/// How thorough the laboratory is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Effort {
    pub(crate) quick: bool,
}

impl Effort {
    /// All values, or for a first look every third, the last one among them.
    pub(crate) fn of<T: Copy>(self, values: &[T]) -> Vec<T> {
        if self.quick { values.iter().rev().step_by(3).rev().copied().collect() } else { values.to_vec() }
    }

    /// Steps after which a method that chooses its own is not followed further: the same row on every machine. The longest of them, of a pendulum that spins at 1e6 rad/s,
    /// takes 4e7.
    pub(crate) const fn most_steps(self) -> u64 {
        if self.quick { 20_000 } else { 100_000_000 }
    }

    /// A course of `steps` steps of which every one is looked at; the slowest oscillation has a period.
    pub(crate) const fn course(self, h: f64, steps: u64, period: f64) -> Course {
        Course { h, steps, steps_per_sample: 1, period, most_steps: self.most_steps() }
    }
}

/// A row that is to be found.
pub(crate) struct Planned {
    pub(crate) case: &'static str,
    pub(crate) parameter: String,
    pub(crate) method: &'static str,
    pub(crate) work: Box<dyn FnOnce() -> Finding + Send>,
}

/// A row that is found.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Row {
    pub(crate) case: &'static str,
    pub(crate) parameter: String,
    pub(crate) method: &'static str,
    #[serde(flatten)]
    pub(crate) finding: Finding,
    pub(crate) seconds: f64,
}

/// What is found of a row.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Finding {
    #[serde(flatten)]
    pub(crate) verdict: Verdict,
    pub(crate) h: f64,
    pub(crate) steps: u64,
    pub(crate) constraint_error: Option<f64>,
    pub(crate) hidden_constraint_error: Option<f64>,
    pub(crate) momentum_error: Option<f64>,
    pub(crate) check: Check,
    pub(crate) theory: Option<Theory>,
    pub(crate) figures: Vec<Figure>,
    /// The run from its start to its end, where a figure shows it.
    #[serde(skip)]
    pub(crate) series: Option<Series>,
    /// What ended the run before its last step, if not its verdict.
    pub(crate) remark: Option<String>,
    /// What must not be: failed checks, other verdicts or numbers than theory admits, panics.
    pub(crate) faults: Vec<String>,
}

impl Finding {
    /// From what was observed of a run.
    pub(crate) fn of(
        observation: &Observation,
        h: f64,
        theory: Option<Theory>,
        figures: Vec<Figure>,
    ) -> Self {
        let verdict = verdict::on(observation);
        let mut faults = Vec::new();
        let check = observation.check;
        if check.has_failed() {
            let (worst, step, equation) = (check.worst, check.worst_step, check.equation);
            faults.push(format!("check: {equation} is left by {worst:.1e} roundings at step {step}"));
        }
        if let Some(theory) = theory.as_ref().filter(|theory| !theory.admits.contains(&verdict.kind())) {
            faults.push(format!("theory: {}", theory.sentence));
        }
        faults.extend(figures.iter().filter(|figure| !figure.agrees()).map(Figure::text));
        let remark = match observation.ending {
            Ending::OutOfSteps { step } => Some(format!("out of steps at step {step}")),
            _ => None,
        };
        Self {
            verdict,
            h,
            steps: observation.taken,
            constraint_error: observation.largest(|sample| sample.constraint),
            hidden_constraint_error: observation.largest(|sample| sample.hidden),
            momentum_error: observation.largest(|sample| sample.momentum),
            check,
            theory,
            figures,
            series: None,
            remark,
            faults,
        }
    }

    /// The worst residual of the checked steps.
    pub(crate) fn check_text(&self) -> String {
        let Check { steps, worst, .. } = self.check;
        if steps == 0 { format!(" {:>10}", "") } else { format!(" check {worst:>4.0}") }
    }

    /// Of a row whose run did not come to an end.
    pub(crate) fn broken(fault: String) -> Self {
        let mut finding = Self::of(&Observation::nothing(), f64::NAN, None, Vec::new());
        finding.verdict = Verdict::Refused { reason: fault.clone() };
        finding.faults.push(fault);
        finding
    }
}

/// What theory says of a method, if anything.
type Says = Box<dyn Fn(&'static str) -> Option<Theory>>;
/// Numbers beside the verdict of a method.
type Measures = Arc<dyn Fn(&'static str, &Observation) -> Vec<Figure> + Send + Sync>;

/// All methods of a specimen on one course.
pub(crate) struct Trial {
    case: &'static str,
    parameter: String,
    specimen: Arc<dyn Specimen>,
    course: Course,
    says: Says,
    measures: Measures,
    is_drawn: bool,
}

impl Trial {
    pub(crate) fn new(
        case: &'static str,
        parameter: impl Into<String>,
        specimen: impl Specimen + 'static,
        course: Course,
    ) -> Self {
        Self {
            case,
            parameter: parameter.into(),
            specimen: Arc::new(specimen),
            course,
            says: Box::new(|_| None),
            measures: Arc::new(|_, _| Vec::new()),
            is_drawn: false,
        }
    }

    pub(crate) fn saying(self, says: impl Fn(&'static str) -> Option<Theory> + 'static) -> Self {
        Self { says: Box::new(says), ..self }
    }

    pub(crate) fn measuring(
        self,
        measures: impl Fn(&'static str, &Observation) -> Vec<Figure> + Send + Sync + 'static,
    ) -> Self {
        Self { measures: Arc::new(measures), ..self }
    }

    /// A figure shows the runs from their start to their end.
    pub(crate) fn drawn(self) -> Self {
        Self { is_drawn: true, ..self }
    }

    /// A row for each method.
    pub(crate) fn rows(self) -> Vec<Planned> {
        let Self { case, parameter, specimen, course, says, measures, is_drawn } = self;
        let plan = |facts: evi_benches::comparison::methods::MethodFacts| {
            let (method, specimen, measures) = (facts.name, Arc::clone(&specimen), Arc::clone(&measures));
            let theory = says(method);
            let work = move || {
                let observation = observe(&*specimen, method, course);
                let figures =
                    if observation.samples.is_empty() { Vec::new() } else { measures(method, &observation) };
                let series = is_drawn.then(|| Series::of(&observation));
                Finding { series, ..Finding::of(&observation, course.h, theory, figures) }
            };
            Planned { case, parameter: parameter.clone(), method, work: Box::new(work) }
        };
        specimen.methods().into_iter().map(plan).collect()
    }
}
