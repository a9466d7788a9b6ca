//! Tables: for people, and as CSV.

use std::io::Write;

use serde::Serialize;
use serde_json::Value;

/// Columns, each flush right below its heading.
pub(super) fn table<const N: usize>(
    headings: [&str; N],
    lines: impl Iterator<Item = [String; N]>,
    out: &mut dyn Write,
) -> anyhow::Result<()> {
    let mut rows = vec![headings.map(str::to_owned)];
    rows.extend(lines);
    let width = |column: usize| rows.iter().map(|row| row[column].len()).max().unwrap_or(0);
    let widths: [usize; N] = std::array::from_fn(width);
    for row in &rows {
        let cells = row.iter().zip(widths);
        let cells: Vec<String> = cells
            .map(|(cell, width)| format!("{cell:>width$}"))
            .collect();
        writeln!(out, "{}", cells.join("  "))?;
    }
    Ok(())
}

/// Columns with their names in the first line, and where their numbers stand in the JSON of a row; what is not known is
/// empty.
pub(super) fn csv<const N: usize>(columns: [(&str, &str); N], rows: &[impl Serialize]) -> String {
    let mut lines = vec![columns.map(|(name, _)| name).join(",")];
    for row in rows {
        let json = serde_json::to_value(row).expect("names and numbers");
        let cells = columns.map(|(_, place)| match json.pointer(place) {
            None | Some(Value::Null) => String::new(),
            Some(Value::String(text)) if text.contains([',', '"', '\n', '\r']) => {
                format!("\"{}\"", text.replace('"', "\"\""))
            }
            Some(Value::String(text)) => text.clone(),
            Some(value) => value.to_string(),
        });
        lines.push(cells.join(","));
    }
    lines.join("\n") + "\n"
}
