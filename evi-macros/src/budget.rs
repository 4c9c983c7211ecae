//! Whether the code is small enough for rustc.
//!
//! In: the programs. Out: nothing, or a mistake at the equation that contributes most to the largest of them.

use crate::diagnostics::Diagnostics;
use crate::expr::{ExprId, Graph};
use crate::model::Model;
use crate::schedule::{Operations, Programs};

/// Statements of the largest kernel that is emitted, ten times as many as the report warns of: a limit of
/// good sense, since such a system is better written as loops over its parts. rustc's time and memory grow
/// with the statements.
const LARGEST_KERNEL: usize = 50_000;
/// Coordinates in arrays of literal sizes whose sums and families are written out term by term: what the straight-line eliminations and a state on
/// the stack bear. Larger scenes stay loops over their elements.
pub(crate) const MOST_UNROLLED_COORDINATES: usize = 96;
/// Equations of one index of a family that is written out: more than any solver here takes in one piece.
pub(crate) const MOST_UNROLLED_EQUATIONS: i64 = 1_000;
/// Numbers of a vector that is written out number by number: beyond, a kernel of its elements nears [`LARGEST_KERNEL`].
pub(crate) const LONGEST_VECTOR: u64 = 10_000;
/// Levels of vectors of vectors, and sizes of an array: twice as many as tensors of mechanics have. Everything that goes through them is recursive.
pub(crate) const MOST_SIZES: usize = 8;
/// Contributions that a message lists.
const LISTED_CONTRIBUTIONS: usize = 5;

/// Reports a system with a kernel that is too large.
pub(crate) fn check(graph: &Graph, model: &Model, programs: &Programs, diagnostics: &mut Diagnostics) {
    let kernels = programs.kernels().into_iter();
    let Some((kernel, program)) = kernels.max_by_key(|(_, program)| program.n_statements()) else {
        return;
    };
    let statements = program.n_statements();
    if statements <= LARGEST_KERNEL {
        return;
    }
    let operations = |root: ExprId| Operations::below(graph, root).total();
    let energies = model
        .energies
        .iter()
        .map(|energy| (operations(energy.root), format!("`{}`", energy.keyword), energy.keyword.span()));
    let constraints = model.constraints.iter().map(|constraint| {
        (operations(constraint.root), format!("constraint `{}`", constraint.name), constraint.span)
    });
    let dissipation = model
        .forces
        .dissipation
        .iter()
        .map(|(keyword, root)| (operations(*root), "`dissipation`".to_owned(), keyword.span()));
    let forces = model
        .forces
        .generalized
        .iter()
        .map(|(_, force)| (operations(force.root), format!("the force on `{}`", force.name), force.span));
    let forces = dissipation.chain(forces);
    let observables = model.observables.iter().map(|observed| {
        (operations(observed.root), format!("`observe({}: ..)`", observed.name), observed.span)
    });
    let mut contributions: Vec<_> = match kernel {
        "constants" => energies.chain(constraints).chain(forces).chain(observables).collect(),
        "observables" => observables.collect(),
        _ if kernel.starts_with("force") => forces.collect(),
        _ if kernel.starts_with("constraint") => constraints.collect(),
        _ => energies.collect(),
    };
    // Stable: equal contributions stay in the order of the source.
    contributions.sort_by_key(|(operations, ..)| std::cmp::Reverse(*operations));
    let Some(&(_, ref largest, span)) = contributions.first() else {
        return;
    };
    let others = contributions.len().saturating_sub(LISTED_CONTRIBUTIONS);
    let listed = contributions.iter().take(LISTED_CONTRIBUTIONS);
    let mut listed: Vec<String> = listed.map(|(count, name, _)| format!("{name} {count}")).collect();
    if others > 0 {
        listed.push(format!("{others} more"));
    }
    let message = format!(
        "{largest} makes the generated code too large: the kernel `{kernel}` has {statements} statements, \
         at most {LARGEST_KERNEL} are emitted\noperations as written: {}; give repeated subexpressions a `let`, or \
         leave terms out",
        listed.join(", ")
    );
    diagnostics.report(span, message);
}

#[cfg(test)]
mod tests {
    use crate::pipeline::expand;

    /// A system whose potential is a sum of sines of literal multiples of `x`, in balanced parentheses.
    fn with_terms(count: usize) -> String {
        let mut terms: Vec<String> = (0..count).map(|k| format!("({k}.25 * x).sin()")).collect();
        while terms.len() > 1 {
            terms = terms.chunks(2).map(|pair| format!("({})", pair.join(" + "))).collect();
        }
        let expansion = expand(
            format!(
                "#[evi(coordinates(x), kinetic = 0.5 * m * der(x).powi(2), potential = {},
                 constraint(c: x == m))]
                 struct Large {{ m: f64 }}",
                terms[0]
            )
            .parse()
            .expect("tokens"),
        );
        expansion.to_string()
    }

    #[test]
    fn a_kernel_of_more_than_50_000_statements_is_refused_at_the_largest_contributor() {
        let expansion = with_terms(50_500);
        assert!(expansion.contains("compile_error"), "{} characters", expansion.len());
        let message = expansion.split('"').nth(1).expect("a message");
        assert!(message.starts_with("`potential` makes the generated code too large"), "{message}");
        assert!(
            message.contains("`lagrangian_derivatives` has ") && message.contains("`kinetic` 3"),
            "{message}"
        );
    }

    #[test]
    fn a_kernel_of_10_000_statements_is_not() {
        assert!(!with_terms(10_000).contains("compile_error"));
    }
}
