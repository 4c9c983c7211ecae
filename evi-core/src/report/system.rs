//! A scene's report as text, and its equations as LaTeX.

use core::fmt::{self, Display, Formatter};

use super::matrix::write_matrix;
use super::words::{LISTED_NAMES, List, write_structure};
use crate::system::{Equation, KernelReport, SystemReport};

impl Display for SystemReport {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", self.name)?;
        writeln!(f, "  coordinates  {}", List(|| self.coordinates.iter(), LISTED_NAMES))?;
        if !self.parameters.is_empty() {
            writeln!(f, "  parameters   {}", List(|| self.parameters.iter(), LISTED_NAMES))?;
        }
        if !self.inputs.is_empty() {
            writeln!(f, "  inputs       {}", List(|| self.inputs.iter(), LISTED_NAMES))?;
        }
        if !self.observables.is_empty() {
            writeln!(f, "  observed     {}", List(|| self.observables.iter(), LISTED_NAMES))?;
        }

        write_equations(self.equations, f)?;

        writeln!(f, "\nStructure")?;
        write_structure(self, f)?;

        writeln!(f, "\nMatrix of a step   · zero, c constant, x varying")?;
        write_matrix(self, f)?;
        write_unknowns(self, f)?;

        writeln!(f)?;
        write_kernels(self.kernels, f)?;

        let mut left_out = self.left_out().peekable();
        if left_out.peek().is_some() {
            writeln!(f, "\nLeft out")?;
        }
        for sentence in left_out {
            writeln!(f, "  {sentence}")?;
        }
        write_warnings(self, f)
    }
}

/// Writes the equations, their left sides under each other.
pub(super) fn write_equations(equations: &[Equation], f: &mut Formatter<'_>) -> fmt::Result {
    writeln!(f, "\nEquations")?;
    let margin = equations.iter().map(|equation| equation.name.chars().count()).max().unwrap_or(0);
    let margin = if margin == 0 { 0 } else { margin + 2 };
    for equation in equations {
        let colon = if equation.name.is_empty() { "" } else { ":" };
        let width = margin.saturating_sub(equation.name.chars().count() + colon.len());
        let (left, right) = (equation.left.unicode, equation.right.unicode);
        writeln!(f, "  {}{colon}{:width$}{left} = {right}", equation.name, "")?;
    }
    Ok(())
}

fn write_unknowns(report: &SystemReport, f: &mut Formatter<'_>) -> fmt::Result {
    let (all, rest) = (report.n_unknowns(), report.n_unknowns_after_elimination());
    write!(f, "  unknowns: {all}")?;
    match (rest == all, rest) {
        (true, _) if report.structure.central_force.is_some() => {
            let rest = report.n_unknowns_of_midpoint_steps();
            writeln!(f, "; {rest} in midpoint steps, a distance, for the force is central")
        }
        (true, _) => writeln!(f),
        (false, 0) => writeln!(f, "; none once the positions are eliminated, for L is quadratic"),
        (false, _) => writeln!(f, "; {rest} once the positions are eliminated, for L is quadratic"),
    }
}

/// Writes what every kernel takes.
pub(super) fn write_kernels(kernels: &[KernelReport], f: &mut Formatter<'_>) -> fmt::Result {
    let mut kernels =
        kernels.iter().filter(|kernel| kernel.statements + kernel.operations.total() > 0).peekable();
    if kernels.peek().is_some() {
        writeln!(f, "Operations per call      + −     ×     ÷  f(x)   temporaries  statements")?;
    }
    kernels.try_for_each(|kernel| write_kernel(kernel, f))
}

fn write_kernel(kernel: &KernelReport, f: &mut Formatter<'_>) -> fmt::Result {
    let operations = kernel.operations;
    let name = kernel.name;
    let counts =
        [operations.additions, operations.multiplications, operations.divisions, operations.functions];
    write!(f, "  {name:<22}")?;
    for count in counts {
        write!(f, "{:>6}", Count(count))?;
    }
    writeln!(f, "{:>14}{:>12}", Count(kernel.temporaries), Count(kernel.statements))
}

fn write_warnings(report: &SystemReport, f: &mut Formatter<'_>) -> fmt::Result {
    let large = || report.kernels.iter().filter(|kernel| kernel.statements > KernelReport::MANY_STATEMENTS);
    if report.repeated_constraints().next().is_none() && large().next().is_none() {
        return Ok(());
    }
    writeln!(f, "\nWarnings")?;
    for (first, second) in report.repeated_constraints() {
        let (first, second) = (report.constraints[first], report.constraints[second]);
        writeln!(f, "  constraint {second} repeats {first}: their multipliers are not unique")?;
    }
    for kernel in large() {
        let (name, statements) = (kernel.name, kernel.statements);
        writeln!(f, "  {name} has {statements} statements: it compiles slowly; look for shared expressions")?;
    }
    Ok(())
}

/// A count, in which nothing is a dot.
struct Count(usize);

impl Display for Count {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        if self.0 == 0 { f.pad("·") } else { Display::fmt(&self.0, f) }
    }
}

impl SystemReport {
    /// The equations as a LaTeX environment `aligned`, to stand in math mode.
    pub const fn latex(&self) -> Latex<'_> {
        Latex(self.equations)
    }
}

/// The equations of a scene as LaTeX.
#[derive(Clone, Copy, Debug)]
pub struct Latex<'a>(pub(super) &'a [Equation]);

impl Display for Latex<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        writeln!(f, "\\begin{{aligned}}")?;
        let last = self.0.len().saturating_sub(1);
        for (index, equation) in self.0.iter().enumerate() {
            write!(f, "  {} &= {}", equation.left.latex, equation.right.latex)?;
            writeln!(f, "{}", if index == last { "" } else { " \\\\" })?;
        }
        writeln!(f, "\\end{{aligned}}")
    }
}
