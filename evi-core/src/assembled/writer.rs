//! Sampled states as rows, written as they come: comma-separated values, or Parquet with the feature `parquet`.

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
        let coordinates = checked(run, coordinates)?;
        let names: Vec<String> = names(run, &coordinates).map(quoted).collect();
        writeln!(out, "{}", names.join(","))?;
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
        let mut separator = "";
        for value in row(run, &self.coordinates) {
            write!(self.out, "{separator}{value}")?;
            separator = ",";
        }
        writeln!(self.out)
    }
}

/// The same rows as a Parquet file. [`finish`](Self::finish) ends it.
///
/// ```
/// # use evi_core::assembled::{AssembledSimulation, AssembledSystem, Family, FamilyVisitor, ParquetStates};
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
/// let mut states = ParquetStates::of(&run, Vec::new(), [1])?;
/// run.advance_sampled(0.3, 10, |run| -> Result<(), Box<dyn std::error::Error>> { Ok(states.write(run)?) })?;
/// let file = states.finish()?;
/// assert!(file.starts_with(b"PAR1") && file.ends_with(b"PAR1"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[cfg(feature = "parquet")]
pub struct ParquetStates<W: Write + Send> {
    rows: crate::columns::ParquetRows<W>,
    coordinates: Vec<usize>,
}

#[cfg(feature = "parquet")]
impl<W: Write + Send> ParquetStates<W> {
    /// A file for some coordinates of a run.
    ///
    /// # Errors
    /// As for [`StateWriter::of`]; those of the format are [`io::ErrorKind::Other`].
    pub fn of<S, M, T>(
        run: &AssembledRun<S, M, T>,
        out: W,
        coordinates: impl IntoIterator<Item = usize>,
    ) -> io::Result<Self>
    where
        S: AssembledSystem,
        M: AssembledStep,
        T: Tally,
    {
        let coordinates = checked(run, coordinates)?;
        let columns: Vec<_> = names(run, &coordinates).map(crate::columns::Column::number).collect();
        let rows = crate::columns::ParquetRows::new(&columns, out).map_err(io::Error::other)?;
        Ok(Self { rows, coordinates })
    }

    /// Adds the state that a run has reached.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn write<S, M, T>(&mut self, run: &AssembledRun<S, M, T>) -> io::Result<()>
    where
        S: AssembledSystem,
        M: AssembledStep,
        T: Tally,
    {
        self.rows.push(row(run, &self.coordinates)).map_err(io::Error::other)
    }

    /// Ends the file, which cannot be read without.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn finish(self) -> io::Result<W> {
        self.rows.finish().map_err(io::Error::other)
    }
}

/// The coordinates, if the scene has them.
fn checked<S: AssembledSystem, M: AssembledStep, T: Tally>(
    run: &AssembledRun<S, M, T>,
    coordinates: impl IntoIterator<Item = usize>,
) -> io::Result<Vec<usize>> {
    let coordinates: Vec<usize> = coordinates.into_iter().collect();
    let n = run.state().q().len();
    match coordinates.iter().find(|&&index| index >= n) {
        Some(index) => {
            let message = format!("there is no coordinate {index}: the scene has {n}");
            Err(io::Error::new(io::ErrorKind::InvalidInput, message))
        }
        None => Ok(coordinates),
    }
}

/// Names of the columns.
fn names<S: AssembledSystem, M: AssembledStep, T: Tally>(
    run: &AssembledRun<S, M, T>,
    coordinates: &[usize],
) -> impl Iterator<Item = String> {
    let name = |index: &usize| run.system().coordinate_name(*index);
    let observed = S::OBSERVABLES.iter().map(|name| (*name).to_owned());
    let rates = coordinates.iter().map(move |index| format!("der({})", name(index)));
    ["t", "energy"]
        .map(str::to_owned)
        .into_iter()
        .chain(observed)
        .chain(coordinates.iter().map(name))
        .chain(rates)
}

/// Time, energy, observed quantities, positions and velocities.
fn row<S: AssembledSystem, M: AssembledStep, T: Tally>(
    run: &AssembledRun<S, M, T>,
    coordinates: &[usize],
) -> impl Iterator<Item = f64> {
    let state = run.state();
    let of = |values: &[f64]| -> Vec<f64> { coordinates.iter().map(|&index| values[index]).collect() };
    [state.t(), run.energy()].into_iter().chain(run.observe()).chain(of(state.q())).chain(of(state.v()))
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
