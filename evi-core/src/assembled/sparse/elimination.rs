//! What elimination needs to know of a pattern.

use super::ordering::{Column, minimum_degree};

/// An order of elimination and where its products go. Unknowns keep their numbers; columns stand in the order of their pivots.
pub(in super::super) struct Elimination {
    /// The unknown of every pivot.
    pub(super) pivots: Vec<u32>,
    /// Where the entries below the pivot begin, and where the last ones end.
    pub(super) starts: Vec<u32>,
    /// The unknowns of these entries, in the order of their own elimination.
    pub(super) rows: Vec<u32>,
    /// Where the products of two of these entries go, column by column, for every entry those with the ones behind it.
    pub(super) targets: Vec<u32>,
    /// When an unknown is eliminated.
    turns: Vec<u32>,
}

/// What the factorisation of a matrix of few nonzeros takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Effort {
    /// Number of unknowns.
    pub unknowns: usize,
    /// Entries below the diagonal, those included that elimination fills in; 0 where the order is found with every factorisation.
    pub below: usize,
    /// Products of a factorisation of a symmetric matrix.
    pub products: usize,
    /// Whether rows are exchanged in every factorisation, by faer.
    pub is_pivoted: bool,
}

/// Elimination would take too many products.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in super::super) struct TooMuchFill {
    /// As many as were counted before it was given up.
    pub(in super::super) products: usize,
    /// As many as are accepted.
    pub(in super::super) most: usize,
}

/// Where a number of a matrix lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Place {
    /// On the diagonal, of this unknown.
    Diagonal(usize),
    /// In a row that is eliminated after its column.
    Below(usize),
    /// In a column that is eliminated after its row.
    Above(usize),
}

/// Products of an elimination, of which each keeps four bytes: a factorisation of 10 to 20 milliseconds.
const MOST_PRODUCTS: usize = 1 << 25;

impl Elimination {
    /// For matrices with nonzeros where unknowns are `coupled`, in either order. Unknowns with a diagonal that may vanish are `late`.
    ///
    /// # Errors
    /// [`TooMuchFill`].
    pub(in super::super) fn new(
        n_unknowns: usize,
        coupled: impl IntoIterator<Item = (usize, usize)>,
        late: impl Fn(usize) -> bool,
    ) -> Result<Self, TooMuchFill> {
        let columns = minimum_degree(n_unknowns, coupled, late, MOST_PRODUCTS)
            .map_err(|products| TooMuchFill { products, most: MOST_PRODUCTS })?;
        let mut turns = vec![0; n_unknowns];
        for (turn, column) in columns.iter().enumerate() {
            turns[column.pivot as usize] = turn as u32;
        }
        let mut elimination = Self {
            pivots: Vec::with_capacity(n_unknowns),
            starts: vec![0],
            rows: Vec::new(),
            targets: Vec::new(),
            turns,
        };
        for Column { pivot, mut rows } in columns {
            rows.sort_unstable_by_key(|&row| elimination.turns[row as usize]);
            elimination.pivots.push(pivot);
            elimination.rows.extend(rows);
            elimination.starts.push(elimination.rows.len() as u32);
        }
        elimination.find_targets();
        Ok(elimination)
    }

    fn find_targets(&mut self) {
        for column in 0..self.pivots.len() {
            let rows = self.range(column);
            for b in rows.clone() {
                for a in b + 1..rows.end {
                    let target = self.below(self.rows[a] as usize, self.rows[b] as usize);
                    self.targets.push(target as u32);
                }
            }
        }
    }

    /// Where the entries below a pivot stand.
    #[inline(always)]
    pub(super) fn range(&self, column: usize) -> std::ops::Range<usize> {
        self.starts[column] as usize..self.starts[column + 1] as usize
    }

    /// Where the entry of `row`, which is eliminated after `col`, stands.
    fn below(&self, row: usize, col: usize) -> usize {
        let range = self.range(self.turns[col] as usize);
        let turn = self.turns[row];
        let found = self.rows[range.clone()].binary_search_by_key(&turn, |&row| self.turns[row as usize]);
        range.start + found.expect("the pattern holds the entry")
    }

    /// Where an entry of the pattern stands.
    pub(super) fn place(&self, row: usize, col: usize) -> Place {
        match self.turns[row].cmp(&self.turns[col]) {
            std::cmp::Ordering::Equal => Place::Diagonal(row),
            std::cmp::Ordering::Greater => Place::Below(self.below(row, col)),
            std::cmp::Ordering::Less => Place::Above(self.below(col, row)),
        }
    }

    /// What a factorisation takes.
    pub(in super::super) fn effort(&self) -> Effort {
        Effort {
            unknowns: self.n_unknowns(),
            below: self.n_below(),
            products: self.targets.len() + self.n_below(),
            is_pivoted: false,
        }
    }

    /// The unknown that a column eliminates.
    pub(in super::super) fn pivot(&self, column: usize) -> usize {
        self.pivots[column] as usize
    }

    /// Calls `visit` for the unknowns that a column couples: its pivot, and those below it.
    pub(in super::super) fn for_each_unknown(&self, column: usize, mut visit: impl FnMut(usize)) {
        visit(self.pivot(column));
        self.rows[self.range(column)].iter().for_each(|&row| visit(row as usize));
    }

    /// Number of unknowns.
    pub(in super::super) fn n_unknowns(&self) -> usize {
        self.pivots.len()
    }

    /// Whether one unknown is eliminated after another.
    pub(in super::super) fn is_later(&self, unknown: usize, other: usize) -> bool {
        self.turns[unknown] > self.turns[other]
    }

    /// Number of entries below the diagonal.
    pub(in super::super) fn n_below(&self) -> usize {
        self.rows.len()
    }
}
