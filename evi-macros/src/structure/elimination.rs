//! Symbolic elimination of a sparse matrix.
//!
//! In: the places of its nonzero entries, structurally symmetric. Out: an order of the pivots, and the entries that the
//! factors occupy, fill included; no values are known here.

use std::collections::BTreeSet;

/// An order of elimination and what it fills.
pub(crate) struct Elimination {
    /// Size of the matrix.
    pub(crate) dimension: usize,
    /// Rows in the order in which their pivots are taken.
    pub(crate) order: Vec<usize>,
    /// For every pivot, in that order, the later rows that it is coupled with.
    pub(crate) coupled: Vec<Vec<usize>>,
    /// Places of the matrix's own nonzero entries.
    pub(crate) entries: BTreeSet<(usize, usize)>,
}

impl Elimination {
    /// Orders a matrix by minimum degree (Markowitz, Management Science 3 (1957) 255): next is the row with fewest
    /// couplings. A row whose diagonal entry is structurally zero waits until a neighbour has filled it. `None` if some
    /// row never gets a pivot.
    pub(crate) fn of(dimension: usize, entries: BTreeSet<(usize, usize)>) -> Option<Self> {
        let mut neighbours: Vec<BTreeSet<usize>> = vec![BTreeSet::new(); dimension];
        let mut has_pivot: Vec<bool> = (0..dimension).map(|row| entries.contains(&(row, row))).collect();
        for &(row, col) in entries.iter().filter(|(row, col)| row != col) {
            neighbours[row].insert(col);
            neighbours[col].insert(row);
        }
        let (mut order, mut coupled) = (Vec::new(), Vec::new());
        let mut remaining: BTreeSet<usize> = (0..dimension).collect();
        while !remaining.is_empty() {
            let candidates = remaining.iter().filter(|&&row| has_pivot[row]);
            let pivot = *candidates.min_by_key(|&&row| neighbours[row].len())?;
            remaining.remove(&pivot);
            let around = std::mem::take(&mut neighbours[pivot]);
            for &row in &around {
                neighbours[row].remove(&pivot);
                neighbours[row].extend(around.iter().filter(|&&other| other != row));
                has_pivot[row] = true;
            }
            order.push(pivot);
            coupled.push(around.into_iter().collect());
        }
        Some(Self { dimension, order, coupled, entries })
    }

    /// Multiplications of the factorization.
    pub(crate) fn cost(&self) -> usize {
        self.coupled.iter().map(|rows| rows.len() * (rows.len() + 1)).sum()
    }
}
