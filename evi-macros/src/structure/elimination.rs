//! Symbolic elimination of a sparse matrix.
//!
//! In: the places of its nonzero entries, structurally symmetric. Out: an order of the pivots, and the entries that the
//! factors occupy, fill included; no values are known here.

use std::collections::BTreeSet;

use super::matching::Matching;

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
    /// couplings. A row whose diagonal entry is structurally zero waits until its pivot cannot vanish for want of rank
    /// ([`Matching`]). `None` if some row never gets a pivot.
    pub(crate) fn of(dimension: usize, entries: BTreeSet<(usize, usize)>) -> Option<Self> {
        let mut neighbours: Vec<BTreeSet<usize>> = vec![BTreeSet::new(); dimension];
        let is_hollow: Vec<bool> = (0..dimension).map(|row| !entries.contains(&(row, row))).collect();
        for &(row, col) in entries.iter().filter(|(row, col)| row != col) {
            neighbours[row].insert(col);
            neighbours[col].insert(row);
        }
        let mut matching = Matching::of(&neighbours);
        let (mut order, mut coupled) = (Vec::new(), Vec::new());
        let mut remaining: BTreeSet<usize> = (0..dimension).collect();
        while !remaining.is_empty() {
            let mut candidates: Vec<usize> = remaining.iter().copied().collect();
            candidates.sort_by_key(|&row| neighbours[row].len());
            let pivot = candidates.into_iter().find(|&row| !is_hollow[row] || matching.take(row))?;
            remaining.remove(&pivot);
            if !is_hollow[pivot] {
                matching.offer(pivot);
            }
            let around = std::mem::take(&mut neighbours[pivot]);
            for &row in &around {
                neighbours[row].remove(&pivot);
                neighbours[row].extend(around.iter().filter(|&&other| other != row));
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

#[cfg(test)]
mod tests {
    use super::*;

    /// The order for coordinates with a diagonal, and constraints on the coordinates that are listed.
    fn order(n_coordinates: usize, constraints: &[&[usize]]) -> Option<Vec<usize>> {
        let mut entries: BTreeSet<(usize, usize)> = (0..n_coordinates).map(|row| (row, row)).collect();
        for (constraint, coordinates) in constraints.iter().enumerate() {
            for &coordinate in *coordinates {
                entries.insert((n_coordinates + constraint, coordinate));
                entries.insert((coordinate, n_coordinates + constraint));
            }
        }
        let elimination = Elimination::of(n_coordinates + constraints.len(), entries)?;
        Some(elimination.order)
    }

    fn places<const K: usize>(order: &[usize], rows: [usize; K]) -> [usize; K] {
        rows.map(|row| order.iter().position(|&pivot| pivot == row).expect("every row has its turn"))
    }

    #[test]
    fn two_constraints_need_two_coordinates() {
        // Both share coordinate 0, of fewest couplings: after it alone the second of them would have no pivot.
        let order = order(3, &[&[0, 1], &[0, 1], &[1, 2]]).expect("three constraints on three coordinates");
        let [a, b, first, second] = places(&order, [0, 1, 3, 4]);
        assert!(first.max(second) > a.max(b), "{order:?}");
    }

    #[test]
    fn a_column_is_handed_on() {
        // Constraint 3 may have coordinate 0 or 1, constraint 4 coordinate 0 alone: where 3 has taken 0, it moves to 1.
        let order = order(3, &[&[0, 1], &[0], &[1, 2]]).expect("three constraints on three coordinates");
        assert_eq!(order.len(), 6);
    }

    #[test]
    fn more_constraints_than_coordinates_have_no_order() {
        assert_eq!(order(2, &[&[0, 1], &[0, 1], &[0, 1]]), None);
    }
}
