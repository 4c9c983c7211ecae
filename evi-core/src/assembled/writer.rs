//! Sampled states as rows of comma-separated values, written as they come.

use std::io::{self, Write};

use super::{AssembledRun, AssembledStep, AssembledSystem};
use crate::integrator::Tally;

/// Writes time, energy, observed quantities, and positions and velocities of some coordinates, a row per state. Numbers are written with as many digits as it takes to
/// read the same bits again.
///
/// ```
/// # use evi_core::assembled::{AssembledSimulation, AssembledSystem, Family, FamilyVisitor, StateWriter};
/// # use evi_core::prelude::*;
/// # #[derive(MechanicalSystem, Clone)]
/// # #[evi(coordinates(x), kinetic = 0.5 * der(x).powi(2), potential = 0.5 * k * x.powi(2))]
/// # struct Spring { k: f64 }
/// # #[derive(Clone)]
/// # struct Springs(Vec<f64>);
/// # impl Family<Springs> for Spring {
/// #     type Element = Self;
/// #     fn count(springs: &Springs) -> usize { springs.0.len() }
/// #     fn element(springs: &Springs, i: usize) -> Self { Self { k: springs.0[i] } }
/// #     fn coordinates(_: &Springs, i: usize) -> [usize; 1] { [i] }
/// # }
/// # impl AssembledSystem for Springs {
/// #     fn n_coordinates(&self) -> usize { self.0.len() }
/// #     fn visit_families<V: FamilyVisitor<Self>>(&self, visitor: &mut V) { visitor.family::<Spring>() }
/// # }
/// # let simulation = AssembledSimulation::new(Springs(vec![1.0, 4.0]), Evi::midpoint(0.01));
/// let mut run = simulation.start([1.0, 0.5], [0.0; 2])?;
/// let mut rows = Vec::new();
/// let mut writer = StateWriter::of(&run, &mut rows, [1])?;
/// run.advance_sampled(0.3, 10, |run| -> Result<(), Box<dyn std::error::Error>> { Ok(writer.write(run)?) })?;
/// let rows = String::from_utf8(rows)?;
/// assert!(rows.starts_with("t,energy,q[1],der(q[1])\n") && rows.lines().count() == 4);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct StateWriter<W> {
    out: W,
    coordinates: Vec<usize>,
}

impl<W: Write> StateWriter<W> {
    /// Writes the header for all coordinates of a run.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn new<S, M, T>(run: &AssembledRun<S, M, T>, out: W) -> io::Result<Self>
    where
        S: AssembledSystem,
        M: AssembledStep,
        T: Tally,
    {
        Self::of(run, out, 0..run.state().q().len())
    }

    /// Writes the header for some coordinates of a run.
    ///
    /// # Errors
    /// [`io::ErrorKind::InvalidInput`] for a coordinate that the scene does not have, and those of the writer.
    pub fn of<S, M, T>(
        run: &AssembledRun<S, M, T>,
        mut out: W,
        coordinates: impl IntoIterator<Item = usize>,
    ) -> io::Result<Self>
    where
        S: AssembledSystem,
        M: AssembledStep,
        T: Tally,
    {
        let coordinates: Vec<usize> = coordinates.into_iter().collect();
        let n = run.state().q().len();
        if let Some(index) = coordinates.iter().find(|&&index| index >= n) {
            let message = format!("there is no coordinate {index}: the scene has {n}");
            return Err(io::Error::new(io::ErrorKind::InvalidInput, message));
        }
        write!(out, "t,energy")?;
        for name in S::OBSERVABLES {
            write!(out, ",{}", quoted((*name).to_owned()))?;
        }
        let name = |index: &usize| run.system().coordinate_name(*index);
        for name in coordinates.iter().map(name) {
            write!(out, ",{}", quoted(name))?;
        }
        for name in coordinates.iter().map(name) {
            write!(out, ",{}", quoted(format!("der({name})")))?;
        }
        writeln!(out)?;
        Ok(Self { out, coordinates })
    }

    /// Writes the state that a run has reached.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn write<S, M, T>(&mut self, run: &AssembledRun<S, M, T>) -> io::Result<()>
    where
        S: AssembledSystem,
        M: AssembledStep,
        T: Tally,
    {
        let state = run.state();
        write!(self.out, "{},{}", state.t(), run.energy())?;
        for value in run.observe() {
            write!(self.out, ",{value}")?;
        }
        for values in [state.q(), state.v()] {
            for &index in &self.coordinates {
                write!(self.out, ",{}", values[index])?;
            }
        }
        writeln!(self.out)
    }
}

/// A name as a field: between quotes where it has a comma or a quote.
fn quoted(name: String) -> String {
    if name.contains([',', '"', '\n']) { format!("\"{}\"", name.replace('"', "\"\"")) } else { name }
}

#[cfg(test)]
mod tests {
    use super::quoted;

    #[test]
    fn names_with_commas_and_quotes_stay_one_field() {
        assert_eq!(quoted("x1".into()), "x1");
        assert_eq!(quoted("p[3, 1]".into()), "\"p[3, 1]\"");
        assert_eq!(quoted("\"".into()), "\"\"\"\"");
    }
}
