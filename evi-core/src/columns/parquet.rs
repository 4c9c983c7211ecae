//! Parquet: columns of 64-bit integers and floats, required, in groups of rows.

use std::io::Write;
use std::sync::Arc;

use ::parquet::basic::{Repetition, Type as Physical};
use ::parquet::data_type::{DoubleType, Int64Type};
use ::parquet::errors::Result;
use ::parquet::file::properties::WriterProperties;
use ::parquet::file::writer::SerializedFileWriter;
use ::parquet::schema::types::Type;

use super::table::{ColumnKind, Table};

/// Rows that readers take at a time.
const GROUP: usize = 1 << 16;

pub(super) fn write(table: &Table, out: &mut (impl Write + Send)) -> Result<()> {
    let fields = table.columns().iter().map(|column| {
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
    let mut writer = SerializedFileWriter::new(out, schema, properties)?;
    let rows: Vec<&[f64]> = table.rows().collect();
    for group in rows.chunks(GROUP) {
        let mut columns = writer.next_row_group()?;
        let mut place = 0;
        while let Some(mut column) = columns.next_column()? {
            match table.columns()[place].kind {
                ColumnKind::Index => {
                    let cells: Vec<i64> = group.iter().map(|row| row[place] as i64).collect();
                    column.typed::<Int64Type>().write_batch(&cells, None, None)?;
                }
                ColumnKind::Number => {
                    let cells: Vec<f64> = group.iter().map(|row| row[place]).collect();
                    column.typed::<DoubleType>().write_batch(&cells, None, None)?;
                }
            }
            column.close()?;
            place += 1;
        }
        columns.close()?;
    }
    writer.close()?;
    Ok(())
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
