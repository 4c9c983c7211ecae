//! Comma-separated values with a head; numbers in the shortest form that reads back to the same bits.

use std::io::{self, Write};

use super::table::{Column, ColumnKind, Table};

pub(super) fn write(table: &Table, out: &mut impl Write) -> io::Result<()> {
    let names: Vec<String> = table.columns().iter().map(|column| quoted(&column.name)).collect();
    writeln!(out, "{}", names.join(","))?;
    for row in table.rows() {
        let mut separator = "";
        for (cell, Column { kind, .. }) in row.iter().zip(table.columns()) {
            match kind {
                ColumnKind::Index => write!(out, "{separator}{}", *cell as i64)?,
                ColumnKind::Number => write!(out, "{separator}{cell:?}")?,
            }
            separator = ",";
        }
        writeln!(out)?;
    }
    Ok(())
}

/// A name as a cell (RFC 4180).
fn quoted(name: &str) -> String {
    if name.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", name.replace('"', "\"\""))
    } else {
        name.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_read_back_to_the_same_bits() {
        let mut table = Table::new(vec![Column::index("member"), Column::number("x, \"scaled\"")]);
        for (member, x) in [(0.0, 0.1 + 0.2), (1.0, -1e-300), (7.0, f64::NAN)] {
            table.push([member, x]);
        }
        let mut text = Vec::new();
        write(&table, &mut text).expect("memory");
        let text = String::from_utf8(text).expect("text");
        assert_eq!(text, "member,\"x, \"\"scaled\"\"\"\n0,0.30000000000000004\n1,-1e-300\n7,NaN\n");
    }
}
