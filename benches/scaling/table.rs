//! Costs and solutions as text.

use crate::measure::Cost;
use crate::solution::Solution;

/// Cost of a step, body by body, with the ratio to the chain of twenty.
pub(crate) fn of_costs(costs: &[Cost]) -> String {
    let mut table = format!(
        "{:<10} {:>7} {:<11} {:>12} {:>9} {:>6} {:>14} {:>9} {:>6} {:>7} {:>9}\n",
        "scene",
        "bodies",
        "method",
        "ns/step",
        "ns/body",
        "/20",
        "instructions",
        "/body",
        "/20",
        "Newton",
        "|φ|"
    );
    let mut scene = ("", 0);
    for cost in costs {
        if scene != (cost.scene, cost.bodies) {
            scene = (cost.scene, cost.bodies);
            table.push('\n');
        }
        if let Some(failure) = &cost.failure {
            table.push_str(&format!("{:<10} {:>7} {:<11} {failure}\n", cost.scene, cost.bodies, cost.method));
            continue;
        }
        let of_twenty = costs
            .iter()
            .find(|other| other.bodies == 20 && (other.scene, other.method) == (cost.scene, cost.method));
        let instructions = |cost: &Cost| Some(cost.instructions_per_step? / cost.bodies as f64);
        let ratio = |quantity: &dyn Fn(&Cost) -> Option<f64>| Some(quantity(cost)? / quantity(of_twenty?)?);
        table.push_str(&format!(
            "{:<10} {:>7} {:<11} {:>12} {:>9} {:>6} {:>14} {:>9} {:>6} {:>7} {:>9}\n",
            cost.scene,
            cost.bodies,
            cost.method,
            or_empty(cost.ns_per_step, |ns| format!("{ns:.0}")),
            or_empty(cost.ns_per_body, |ns| format!("{ns:.0}")),
            or_empty(ratio(&|cost| cost.ns_per_body), |ratio| format!("{ratio:.2}")),
            or_empty(cost.instructions_per_step, |count| format!("{count:.0}")),
            or_empty(instructions(cost), |count| format!("{count:.0}")),
            or_empty(ratio(&instructions), |ratio| format!("{ratio:.2}")),
            or_empty(cost.newton_iterations, |count| format!("{count:.2}")),
            or_empty(cost.max_constraint_error, |error| format!("{error:.1e}")),
        ));
    }
    table
}

/// Errors and times at the end, solver by solver.
pub(crate) fn of_solutions(title: &str, solutions: &[Solution]) -> String {
    let mut table = format!("{title}\n\n{:<22} {:>9} {:>12} {:>12}\n", "method", "steps", "error", "µs");
    for Solution { method, steps, position_error, microseconds, .. } in solutions {
        table.push_str(&format!("{method:<22} {steps:>9} {position_error:>12.1e} {microseconds:>12.1}\n"));
    }
    table
}

fn or_empty(value: Option<f64>, text: impl Fn(f64) -> String) -> String {
    value.map_or(String::new(), text)
}
