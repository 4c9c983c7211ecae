//! The picture of the matrix of a step, `[A G₀ᵀ; G₁ 0]`: where it is zero, constant, varying.

use core::fmt::{self, Formatter};

use crate::system::{Entry, EntryValue, SystemReport};

/// Rows of the largest matrix that is drawn; of a larger one, the entries are counted.
const LARGEST_PICTURE: usize = 32;

#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Cell {
    Zero,
    Constant,
    Varying,
}

/// Draws the matrix, with the names of its rows and columns.
pub(super) fn write_matrix(report: &SystemReport, f: &mut Formatter<'_>) -> fmt::Result {
    let (n, size) = (report.coordinates.len(), report.n_unknowns());
    if size > LARGEST_PICTURE {
        let count = |wanted| {
            let cells = (0..size).flat_map(|row| (0..size).map(move |col| (row, col)));
            cells.filter(|&(row, col)| cell(report, row, col) == wanted).count()
        };
        let (constant, varying) = (count(Cell::Constant), count(Cell::Varying));
        return writeln!(f, "  {size} × {size}: {constant} constant, {varying} varying entries");
    }
    let name = |index: usize| {
        if index < n { report.coordinates[index] } else { report.constraints[index - n] }
    };
    let length = |index: usize| name(index).chars().count();
    let margin = (0..size).map(length).max().unwrap_or(0);
    write!(f, "  {:margin$} ", "")?;
    for col in 0..size {
        write!(f, "{} {}", separator(col, n), name(col))?;
    }
    writeln!(f)?;
    for row in 0..size {
        write!(f, "  {:>margin$} ", name(row))?;
        for col in 0..size {
            let symbol = symbol(cell(report, row, col));
            // In the middle of the column; no blanks at the end of the line.
            let left = length(col).saturating_sub(1) / 2 + 1;
            let right = if col + 1 == size { 0 } else { length(col).saturating_sub(left) };
            write!(f, "{} {symbol:>left$}{:right$}", separator(col, n), "")?;
        }
        writeln!(f)?;
    }
    Ok(())
}

/// Between the columns of coordinates and those of multipliers stands a line.
const fn separator(col: usize, n: usize) -> &'static str {
    if col == n { " │" } else { "" }
}

const fn symbol(cell: Cell) -> char {
    match cell {
        Cell::Zero => '·',
        Cell::Constant => 'c',
        Cell::Varying => 'x',
    }
}

/// A sum of derivatives varies if one of them does.
fn cell(report: &SystemReport, row: usize, col: usize) -> Cell {
    let n = report.coordinates.len();
    let largest = |entries: &[Entry], places: &[(usize, usize)]| {
        let here = entries.iter().filter(|entry| places.contains(&(entry.row, entry.col)));
        let kinds = here.map(|entry| match entry.value {
            EntryValue::Constant(_) => Cell::Constant,
            EntryValue::Varying(_) => Cell::Varying,
        });
        kinds.max().unwrap_or(Cell::Zero)
    };
    let (hessian, jacobian) = (report.structure.hessian, report.structure.jacobian.q);
    let forces = report.structure.forces;
    match (row < n, col < n) {
        (true, true) => {
            let both = [(row, col), (col, row)];
            let of_lagrangian = [hessian.qq, hessian.vq, hessian.vv].map(|block| largest(block, &both));
            // A force is no derivative of one function: its own derivatives are not symmetric.
            let of_forces = [forces.q, forces.v].map(|block| largest(block, &[(row, col)]));
            of_lagrangian.into_iter().chain(of_forces).max()
        }
        (true, false) => Some(largest(jacobian, &[(col - n, row)])),
        (false, true) => Some(largest(jacobian, &[(row - n, col)])),
        (false, false) => None,
    }
    .unwrap_or(Cell::Zero)
}
