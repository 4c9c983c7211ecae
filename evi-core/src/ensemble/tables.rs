//! Selected states as rows of a table: at samples, at the end, and on a section.

use core::ops::ControlFlow;

use super::failure::Failure;
use super::gather::{Gather, Part, Sight};
use crate::columns::{Column, Table};
use crate::system::MechanicalSystem;

impl Part for Table {
    fn absorb(&mut self, later: Self) {
        self.append(later);
    }
}

/// `member`, `sample`, `t`, then configuration and velocity under the names of the coordinates.
fn columns<S: MechanicalSystem>() -> Vec<Column> {
    let mut columns = vec![Column::index("member"), Column::index("sample"), Column::number("t")];
    columns.extend(S::COORDINATES.iter().map(|name| Column::number(*name)));
    columns.extend(S::COORDINATES.iter().map(|name| Column::number(format!("d{name}"))));
    columns
}

fn push<S: MechanicalSystem>(table: &mut Table, sight: &Sight<'_, S>) {
    let state = sight.state;
    let motion = state.q().as_ref().iter().chain(state.v().as_ref()).copied();
    table.push([sight.member as f64, sight.sample as f64, state.t()].into_iter().chain(motion));
}

/// Gathers the states of some members at every sample, as a table.
pub struct States<F> {
    is_selected: F,
}

impl<F: Fn(usize, usize) -> bool + Sync> States<F> {
    /// Those for which `is_selected(member, sample)`.
    pub const fn of(is_selected: F) -> Self {
        Self { is_selected }
    }
}

impl<S: MechanicalSystem, F: Fn(usize, usize) -> bool + Sync> Gather<S> for States<F> {
    type Part = Table;

    fn blank(&self) -> Table {
        Table::new(columns::<S>())
    }

    fn see(&self, part: &mut Table, sight: &Sight<'_, S>) {
        if (self.is_selected)(sight.member, sight.sample) {
            push(part, sight);
        }
    }
}

/// Gathers the last state of every member that came to an end, as a table.
#[derive(Clone, Copy, Debug)]
pub struct Ends;

impl<S: MechanicalSystem> Gather<S> for Ends {
    type Part = Table;

    fn blank(&self) -> Table {
        Table::new(columns::<S>())
    }

    fn end(&self, part: &mut Table, end: Result<&Sight<'_, S>, &Failure>) {
        if let Ok(sight) = end {
            push(part, sight);
        }
    }
}

/// Gathers where members cross the section of the ensemble, as a table: a Poincaré section.
#[derive(Clone, Copy, Debug)]
pub struct Crossings {
    ends_there: bool,
}

impl Crossings {
    /// All crossings.
    pub const fn all() -> Self {
        Self { ends_there: false }
    }

    /// The first crossing of every member, which moves no further.
    pub const fn first() -> Self {
        Self { ends_there: true }
    }
}

impl<S: MechanicalSystem> Gather<S> for Crossings {
    type Part = Table;

    fn blank(&self) -> Table {
        Table::new(columns::<S>())
    }

    fn cross(&self, part: &mut Table, sight: &Sight<'_, S>) -> ControlFlow<()> {
        push(part, sight);
        if self.ends_there { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}
