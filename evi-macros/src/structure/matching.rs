//! A column for every row: whether a matrix can be regular, whatever its values.

use std::collections::{BTreeSet, VecDeque};

/// Which rows without a diagonal entry have pivots.
///
/// The rows eliminated so far are a leading block `[A Gᵀ; G 0]`, whose hollow rows `G` need to be independent in the columns of the others.
/// Whatever the values, they are not unless every one can have a column of its own: a bipartite matching, found along
/// augmenting paths (Berge, Proc. Natl. Acad. Sci. 43 (1957) 842).
pub(super) struct Matching {
    /// Rows that every row is coupled with in the matrix itself.
    coupled: Vec<Vec<usize>>,
    /// Whether a row has been eliminated that a hollow one may have as its own.
    is_offered: Vec<bool>,
    /// The hollow row that has it.
    owner: Vec<Option<usize>>,
}

impl Matching {
    pub(super) fn of(neighbours: &[BTreeSet<usize>]) -> Self {
        let coupled = neighbours.iter().map(|rows| rows.iter().copied().collect()).collect();
        Self { coupled, is_offered: vec![false; neighbours.len()], owner: vec![None; neighbours.len()] }
    }

    /// A row that has been eliminated.
    pub(super) fn offer(&mut self, row: usize) {
        self.is_offered[row] = true;
    }

    /// Gives a hollow row a column of its own, if there is one without loss to the others.
    pub(super) fn take(&mut self, hollow: usize) -> bool {
        // Breadth first: how the search has come to each column, by which row.
        let mut found_by: Vec<Option<usize>> = vec![None; self.owner.len()];
        let mut searching = VecDeque::from([hollow]);
        while let Some(row) = searching.pop_front() {
            for &column in self.coupled[row].iter().filter(|&&column| self.is_offered[column]) {
                if found_by[column].is_some() {
                    continue;
                }
                found_by[column] = Some(row);
                match self.owner[column] {
                    Some(owner) => searching.push_back(owner),
                    None => {
                        self.reassign(hollow, column, &found_by);
                        return true;
                    }
                }
            }
        }
        false
    }

    /// Hands every column on the path from `hollow` to the free `column` to the row that has found it.
    fn reassign(&mut self, hollow: usize, mut column: usize, found_by: &[Option<usize>]) {
        while let Some(row) = found_by[column] {
            let left = self.owner.iter().position(|&owner| owner == Some(row));
            self.owner[column] = Some(row);
            match left {
                Some(left) if row != hollow => column = left,
                _ => return,
            }
        }
    }
}
