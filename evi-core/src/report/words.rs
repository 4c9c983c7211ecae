//! A scene's structure in words.
//!
//! In: the constants of [`Structure`](crate::system::Structure). Out: sentences, each of which is true
//! because of one constant.

use core::fmt::{self, Display, Formatter};

use crate::system::{
    Block, CentralForce, ConstraintStructure, Dependence, MassShape, Potential, Structure, SystemReport,
};

/// Names that a list holds; the others are only counted.
pub(super) const LISTED_NAMES: usize = 12;
/// Pairs that a list holds.
const LISTED_PAIRS: usize = 6;

impl SystemReport {
    /// What the generated code does not hold, and why.
    pub fn left_out(&self) -> impl Iterator<Item = &'static str> {
        let structure = &self.structure;
        let (blocks, m) = (structure.blocks, self.constraints.len());
        let is_potential = |potential| structure.potential == potential;
        let has_constant_jacobian = structure.each_constraint.iter().all(|row| row.gradient.is_constant());
        [
            (blocks.vv == Block::Constant, "mass matrix: constant, folded once per run"),
            (
                structure.is_quadratic_in_velocity(),
                "iteration for the velocity: it is linear in the momentum",
            ),
            (is_potential(Potential::Zero), "potential: zero, no force to evaluate"),
            (is_potential(Potential::Affine), "potential Hessian: zero, the force is uniform"),
            (blocks.qq == Block::Constant, "potential Hessian: constant, folded once per run"),
            (blocks.vq.is_zero(), "coupling of positions and velocities: zero"),
            (
                blocks.vq == Block::Constant,
                "coupling of positions and velocities: constant, folded once per run",
            ),
            (structure.is_autonomous(), "time derivatives: time appears nowhere"),
            (m == 0, "multipliers: the scene has no constraints"),
            (
                matches!(structure.central_force, Some(CentralForce { is_linear: true, .. })),
                "iteration for the distance in midpoint steps: the force is linear in it",
            ),
            (m > 0 && has_constant_jacobian, "constraint Jacobian: constant, folded once per run"),
        ]
        .into_iter()
        .filter_map(|(holds, sentence)| holds.then_some(sentence))
    }

    /// Pairs of constraints of which the second repeats the first, by index.
    pub fn repeated_constraints(&self) -> impl Iterator<Item = (usize, usize)> {
        let each = self.structure.each_constraint.iter().enumerate();
        each.filter_map(|(index, constraint)| Some((constraint.repeats?, index)))
    }
}

/// Writes the section on structure, line by line.
pub(super) fn write_structure(report: &SystemReport, f: &mut Formatter<'_>) -> fmt::Result {
    let structure = &report.structure;
    let blocks = structure.blocks;
    write!(f, "  mass matrix  {}, ", InWords(blocks.vv))?;
    match structure.mass_shape {
        MassShape::Diagonal => writeln!(f, "diagonal")?,
        MassShape::BlockDiagonal(count) => writeln!(f, "{count} uncoupled blocks")?,
        MassShape::Full => writeln!(f, "full")?,
    }
    writeln!(f, "  potential    {}", potential(structure))?;
    writeln!(
        f,
        "  Hessian of L {}",
        BlockList(&[("qq", blocks.qq), ("vq", blocks.vq), ("vv", blocks.vv), ("vt", blocks.vt)])
    )?;
    let at_rest = if structure.momentum_vanishes_at_rest { "zero" } else { "not zero" };
    writeln!(f, "  momentum     {at_rest} at rest")?;
    let time = [
        (structure.lagrangian.on_t, "in the Lagrangian"),
        (structure.constraints.on_t, "in the constraints"),
        (structure.forces.on.on_t, "in the forces"),
    ];
    let places = time.into_iter().filter(|(appears, _)| *appears).map(|(_, place)| place);
    if structure.is_autonomous() {
        writeln!(f, "  time         appears nowhere")?;
    } else {
        writeln!(f, "  time         {}", And(places))?;
    }
    write_forces(report, f)?;
    write_constraints(report, f)
}

/// Where forces act that are no derivatives of `L`, and what they depend on; nothing where there are none.
fn write_forces(report: &SystemReport, f: &mut Formatter<'_>) -> fmt::Result {
    let forces = &report.structure.forces;
    if !forces.exist() {
        return Ok(());
    }
    let names = || forces.forced.iter().map(|&i| report.coordinates[i]);
    write!(f, "  forces       on {}", List(names, LISTED_NAMES))?;
    let Dependence { on_q, on_v, on_t } = forces.on;
    let variables = [(on_q, "q"), (on_v, "v"), (on_t, "t"), (forces.on_inputs, "inputs")];
    let variables = variables.into_iter().filter(|(depends, _)| *depends).map(|(_, name)| name);
    if variables.clone().next().is_none() {
        writeln!(f, "; constant")
    } else {
        writeln!(f, "; vary with {}", And(variables))
    }
}

fn write_constraints(report: &SystemReport, f: &mut Formatter<'_>) -> fmt::Result {
    let each = report.structure.each_constraint;
    if each.is_empty() {
        return writeln!(f, "  constraints  none");
    }
    let mut heading = "constraints";
    let kinds = ["affine in q, gradient constant", "affine in q, gradient varies with t", "nonlinear in q"];
    let kind_of = |row: &ConstraintStructure| match (row.gradient.is_constant(), row.is_affine()) {
        (true, _) => kinds[0],
        (false, true) => kinds[1],
        (false, false) => kinds[2],
    };
    for kind in kinds {
        let names = || {
            each.iter().zip(report.constraints).filter(|(row, _)| kind_of(row) == kind).map(|(_, name)| name)
        };
        if names().next().is_some() {
            writeln!(f, "  {heading:<12} {kind}: {}", List(names, LISTED_NAMES))?;
            heading = "";
        }
    }
    let graph = report.structure.constraint_graph;
    if !graph.is_empty() {
        let pairs = || graph.iter().map(|&(a, b)| Pair(report.constraints[a], report.constraints[b]));
        writeln!(f, "  {:<12} share a coordinate: {}", "", List(pairs, LISTED_PAIRS))?;
    }
    Ok(())
}

const fn potential(structure: &Structure) -> &'static str {
    match (structure.potential, structure.central_force) {
        (Potential::Zero, _) => "zero",
        (Potential::Affine, _) => "affine in q",
        (Potential::Quadratic, _) => "quadratic in q",
        (Potential::General, None) => "general in q",
        (Potential::General, Some(CentralForce { is_linear, is_beside_uniform_force })) => {
            match (is_linear, is_beside_uniform_force) {
                (true, true) => "quadratic in one distance, with terms affine in q",
                (true, false) => "quadratic in one distance",
                (false, true) => "general in one distance, with terms affine in q",
                (false, false) => "general in one distance",
            }
        }
        (Potential::Inseparable, _) => "not separable: the kinetic energy depends on q",
    }
}

/// A block in words.
struct InWords(Block);

impl Display for InWords {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Dependence { on_q, on_v, on_t } = match self.0 {
            Block::Zero => return f.write_str("zero"),
            Block::Constant => return f.write_str("constant"),
            Block::Varying(dependence) => dependence,
        };
        let variables = [(on_q, "q"), (on_v, "v"), (on_t, "t")].into_iter().filter(|(depends, _)| *depends);
        write!(f, "varies with {}", And(variables.map(|(_, variable)| variable)))
    }
}

/// Words joined by `and`.
struct And<I>(I);

impl<I: Iterator<Item = &'static str> + Clone> Display for And<I> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        for (position, word) in self.0.clone().enumerate() {
            write!(f, "{}{word}", if position == 0 { "" } else { " and " })?;
        }
        Ok(())
    }
}

/// Named blocks in words.
struct BlockList<'a>(&'a [(&'a str, Block)]);

impl Display for BlockList<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        for (position, (name, block)) in self.0.iter().enumerate() {
            write!(f, "{}{name} {}", if position == 0 { "" } else { ", " }, InWords(*block))?;
        }
        Ok(())
    }
}

/// Two names that belong together.
struct Pair(&'static str, &'static str);

impl Display for Pair {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "{}–{}", self.0, self.1)
    }
}

/// The first items of a list, and how many others there are.
pub(super) struct List<F>(pub(super) F, pub(super) usize);

impl<T: Display, I: Iterator<Item = T>, F: Fn() -> I> Display for List<F> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        for (position, item) in (self.0)().take(self.1).enumerate() {
            write!(f, "{}{item}", if position == 0 { "" } else { ", " })?;
        }
        match (self.0)().skip(self.1).count() {
            0 => Ok(()),
            more => write!(f, " and {more} more"),
        }
    }
}
