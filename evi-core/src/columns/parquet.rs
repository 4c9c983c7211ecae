//! Parquet: columns of 64-bit integers and floats, required, in groups of rows.

use std::io::Write;
use std::sync::Arc;

use ::parquet::basic::{Repetition, Type as Physical};
use ::parquet::data_type::{DoubleType, Int64Type};
use ::parquet::errors::Result;
use ::parquet::file::properties::WriterProperties;
use ::parquet::file::writer::SerializedFileWriter;
use ::parquet::schema::types::Type;

use super::table::{Column, ColumnKind, Table};

/// Numbers that are held until a group of rows is written, which readers take at a time.
const HELD: usize = 1 << 20;

pub(super) fn write(table: &Table, out: &mut (impl Write + Send)) -> Result<()> {
    let mut rows = ParquetRows::new(table.columns(), out)?;
    for row in table.rows() {
        rows.push(row.iter().copied())?;
    }
    rows.finish().map(drop)
}

/// Rows that are written as they come, a group of up to 8 MB at a time.
///
/// A Parquet file ends with the places of its groups: without [`finish`](Self::finish) it cannot be read.
pub struct ParquetRows<W: Write + Send> {
    writer: SerializedFileWriter<W>,
    kinds: Vec<ColumnKind>,
    /// Row by row.
    held: Vec<f64>,
}

impl<W: Write + Send> ParquetRows<W> {
    /// A file of rows with these columns.
    ///
    /// # Errors
    /// Those of the format, as for a name that is given twice, and of the writer.
    pub fn new(columns: &[Column], out: W) -> Result<Self> {
        let fields = columns.iter().map(|column| {
            let physical = match column.kind {
                ColumnKind::Index => Physical::INT64,
                ColumnKind::Number => Physical::DOUBLE,
            };
            let field = Type::primitive_type_builder(&column.name, physical);
            field.with_repetition(Repetition::REQUIRED).build().map(Arc::new)
        });
        let fields = fields.collect::<Result<Vec<_>>>()?;
        let schema = Arc::new(Type::group_type_builder("rows").with_fields(fields).build()?);
        let properties = Arc::new(WriterProperties::builder().build());
        let writer = SerializedFileWriter::new(out, schema, properties)?;
        Ok(Self { writer, kinds: columns.iter().map(|column| column.kind).collect(), held: Vec::new() })
    }

    /// Adds a row.
    ///
    /// # Errors
    /// Those of the writer.
    ///
    /// # Panics
    /// If it has not one number per column.
    pub fn push(&mut self, row: impl IntoIterator<Item = f64>) -> Result<()> {
        self.held.extend(row);
        assert!(self.held.len().is_multiple_of(self.kinds.len()), "a row has one number per column");
        if self.held.len() >= HELD { self.write_group() } else { Ok(()) }
    }

    /// Writes what is held, and the end of the file.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn finish(mut self) -> Result<W> {
        self.write_group()?;
        let mut out = self.writer.into_inner()?;
        out.flush()?;
        Ok(out)
    }

    fn write_group(&mut self) -> Result<()> {
        let Self { writer, kinds, held } = self;
        if held.is_empty() {
            return Ok(());
        }
        let mut columns = writer.next_row_group()?;
        let mut place = 0;
        while let Some(mut column) = columns.next_column()? {
            let cells = held.iter().skip(place).step_by(kinds.len());
            match kinds[place] {
                ColumnKind::Index => {
                    let cells: Vec<i64> = cells.map(|cell| *cell as i64).collect();
                    column.typed::<Int64Type>().write_batch(&cells, None, None)?;
                }
                ColumnKind::Number => {
                    let cells: Vec<f64> = cells.copied().collect();
                    column.typed::<DoubleType>().write_batch(&cells, None, None)?;
                }
            }
            column.close()?;
            place += 1;
        }
        columns.close()?;
        held.clear();
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use ::parquet::file::reader::{FileReader, SerializedFileReader};
    use ::parquet::record::RowAccessor;

    use super::super::{Column, Table};

    #[test]
    fn a_file_reads_back_to_the_same_bits() {
        let mut table = Table::new(vec![Column::index("member"), Column::number("x")]);
        let x = |k: usize| (k as f64).sin() / 3.0;
        (0..1000).for_each(|k| table.push([k as f64, x(k)]));
        let path = std::env::temp_dir().join(format!("evi-columns-{}.parquet", std::process::id()));
        table.save(&path).expect("written");
        let file = std::fs::File::open(&path).expect("a file");
        let reader = SerializedFileReader::new(file).expect("Parquet");
        let rows = reader.get_row_iter(None).expect("rows").map(|row| row.expect("a row"));
        let mut count = 0;
        for (k, row) in rows.enumerate() {
            assert_eq!(row.get_long(0).expect("an index"), k as i64);
            assert_eq!(row.get_double(1).expect("a number").to_bits(), x(k).to_bits());
            count += 1;
        }
        assert_eq!(count, 1000);
        std::fs::remove_file(path).expect("removed");
    }
}
