//! Rows of numbers under named columns.

use crate::memory::{Memory, Recall, Record};

/// What the numbers of a column are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColumnKind {
    /// Whole numbers, up to 2⁵³.
    Index,
    /// Numbers.
    Number,
}

/// Name and kind of a column.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Column {
    /// Its name.
    pub name: String,
    /// What its numbers are.
    pub kind: ColumnKind,
}

impl Column {
    /// A column of whole numbers.
    pub fn index(name: impl Into<String>) -> Self {
        Self { name: name.into(), kind: ColumnKind::Index }
    }

    /// A column of numbers.
    pub fn number(name: impl Into<String>) -> Self {
        Self { name: name.into(), kind: ColumnKind::Number }
    }
}

/// A table with numbers in every cell.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    columns: Vec<Column>,
    /// Row by row.
    cells: Vec<f64>,
}

impl Table {
    /// A table without rows.
    pub const fn new(columns: Vec<Column>) -> Self {
        Self { columns, cells: Vec::new() }
    }

    /// Adds a row.
    ///
    /// # Panics
    /// If it has not one number per column.
    pub fn push(&mut self, row: impl IntoIterator<Item = f64>) {
        self.cells.extend(row);
        assert!(self.cells.len().is_multiple_of(self.columns.len()), "a row has one number per column");
    }

    /// Adds the rows of another table with the same columns.
    pub fn append(&mut self, mut rows: Self) {
        debug_assert_eq!(self.columns, rows.columns);
        self.cells.append(&mut rows.cells);
    }

    /// The columns.
    pub fn columns(&self) -> &[Column] {
        &self.columns
    }

    /// The rows.
    pub fn rows(&self) -> impl ExactSizeIterator<Item = &[f64]> {
        self.cells.chunks_exact(self.columns.len())
    }
}

/// The rows; columns are known where they are recalled.
impl Memory for Table {
    fn record(&self, words: &mut Record<'_>) {
        words.index(&self.cells.len());
        self.cells.iter().for_each(|cell| words.number(cell));
    }

    fn recall(&mut self, words: &mut Recall<'_>) {
        let mut count = 0;
        words.index(&mut count);
        self.cells.clear();
        for _ in 0..count {
            let mut cell = 0.0;
            words.number(&mut cell);
            self.cells.push(cell);
        }
    }
}
