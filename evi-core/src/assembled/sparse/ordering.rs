//! In which order unknowns are eliminated.

use std::collections::BTreeSet;

/// A pivot, and the unknowns that are coupled with it when its turn comes, ascending.
pub(super) struct Column {
    pub(super) pivot: u32,
    pub(super) rows: Vec<u32>,
}

/// Eliminates the unknown with fewest neighbours first (minimum degree; George & Liu, SIAM Rev. 31 (1989) 1): on trees nothing is filled in,
/// on chains and rings a number per unknown. Those that are `late`, whose own diagonal entry may vanish, come after all those that they are coupled
/// with from the beginning, which gives them one. Of equals the first is taken, so that neighbours in memory are eliminated one after the other.
///
/// Returns the columns in this order, or how many products elimination would take where these are more than `most`.
pub(super) fn minimum_degree(
    n_unknowns: usize,
    coupled: impl IntoIterator<Item = (usize, usize)>,
    late: impl Fn(usize) -> bool,
    most: usize,
) -> Result<Vec<Column>, usize> {
    let mut neighbours = adjacency(n_unknowns, coupled);
    let mut waiting: Vec<usize> = vec![0; n_unknowns];
    let mut followers: Vec<Vec<u32>> = vec![Vec::new(); n_unknowns];
    for unknown in (0..n_unknowns).filter(|&unknown| late(unknown)) {
        for &other in neighbours[unknown].iter().filter(|&&other| !late(other as usize)) {
            waiting[unknown] += 1;
            followers[other as usize].push(unknown as u32);
        }
    }
    let mut queue: BTreeSet<(usize, usize)> =
        (0..n_unknowns).filter(|&i| waiting[i] == 0).map(|i| (neighbours[i].len(), i)).collect();
    let mut columns = Vec::with_capacity(n_unknowns);
    let mut products = 0;
    while let Some((degree, pivot)) = queue.pop_first() {
        products += degree * degree;
        if products > most {
            return Err(products);
        }
        let rows = std::mem::take(&mut neighbours[pivot]);
        for &row in &rows {
            let row = row as usize;
            let merged = merge(&neighbours[row], &rows, [row as u32, pivot as u32]);
            if waiting[row] == 0 {
                queue.remove(&(neighbours[row].len(), row));
                queue.insert((merged.len(), row));
            }
            neighbours[row] = merged;
        }
        for &follower in &followers[pivot] {
            let follower = follower as usize;
            waiting[follower] -= 1;
            if waiting[follower] == 0 {
                queue.insert((neighbours[follower].len(), follower));
            }
        }
        columns.push(Column { pivot: pivot as u32, rows });
    }
    Ok(columns)
}

/// The neighbours of every unknown, ascending.
fn adjacency(n_unknowns: usize, coupled: impl IntoIterator<Item = (usize, usize)>) -> Vec<Vec<u32>> {
    let mut neighbours: Vec<Vec<u32>> = vec![Vec::new(); n_unknowns];
    for (a, b) in coupled {
        if a != b {
            neighbours[a].push(b as u32);
            neighbours[b].push(a as u32);
        }
    }
    for list in &mut neighbours {
        list.sort_unstable();
        list.dedup();
    }
    neighbours
}

/// The union of two ascending lists without two numbers.
fn merge(a: &[u32], b: &[u32], without: [u32; 2]) -> Vec<u32> {
    let mut merged = Vec::with_capacity(a.len() + b.len());
    let (mut a, mut b) = (a.iter().copied().peekable(), b.iter().copied().peekable());
    loop {
        let next = match (a.peek(), b.peek()) {
            (Some(&x), Some(&y)) => x.min(y),
            (Some(&x), None) => x,
            (None, Some(&y)) => y,
            (None, None) => return merged,
        };
        a.next_if_eq(&next);
        b.next_if_eq(&next);
        if !without.contains(&next) {
            merged.push(next);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Entries that elimination fills in beside those of the pattern.
    fn fill(n: usize, coupled: &[(usize, usize)]) -> usize {
        let columns = minimum_degree(n, coupled.iter().copied(), |_| false, usize::MAX).expect("no limit");
        columns.iter().map(|column| column.rows.len()).sum::<usize>() - coupled.len()
    }

    #[test]
    fn chains_and_trees_fill_nothing_and_a_ring_one_number_per_unknown() {
        let chain: Vec<_> = (1..100).map(|i| (i - 1, i)).collect();
        assert_eq!(fill(100, &chain), 0);
        let tree: Vec<_> = (1..127).map(|i| ((i - 1) / 2, i)).collect();
        assert_eq!(fill(127, &tree), 0);
        let ring: Vec<_> = (0..100).map(|i| (i, (i + 1) % 100)).collect();
        assert_eq!(fill(100, &ring), 97);
    }

    #[test]
    fn late_unknowns_come_after_those_that_they_are_coupled_with() {
        // Coordinates 0, 2, 4, .. in a chain of constraints 1, 3, ..
        let coupled: Vec<_> = (1..21).map(|i| (i - 1, i)).collect();
        let columns = minimum_degree(21, coupled, |i| i % 2 == 1, usize::MAX).expect("no limit");
        let place =
            |i: usize| columns.iter().position(|column| column.pivot == i as u32).expect("eliminated");
        for i in (1..20).step_by(2) {
            assert!(place(i) > place(i - 1) && place(i) > place(i + 1), "{i}");
        }
        assert_eq!(columns.len(), 21);
    }

    #[test]
    fn more_products_than_allowed_are_refused() {
        let full: Vec<_> = (0..20).flat_map(|i| (0..i).map(move |j| (i, j))).collect();
        let all: usize = (0..20).map(|degree| degree * degree).sum();
        assert!(minimum_degree(20, full.clone(), |_| false, all).is_ok());
        assert!(minimum_degree(20, full, |_| false, all - 1).is_err());
    }
}
