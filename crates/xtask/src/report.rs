//! Tables, as Markdown for people and JSON for programs.

use serde_json::{Value, json};
use std::{error::Error, fmt::Write, path::Path};

/// Measurements, table by table.
#[derive(Debug, Default)]
pub struct Report {
    tables: Vec<Table>,
}

/// A table.
#[derive(Debug)]
pub struct Table {
    title: &'static str,
    note: String,
    columns: Vec<&'static str>,
    rows: Vec<Vec<Value>>,
}

impl Table {
    /// Without rows.
    pub fn new(title: &'static str, columns: &[&'static str]) -> Self {
        Self { title, note: String::new(), columns: columns.to_vec(), rows: Vec::new() }
    }

    /// Adds a row, and prints it so that one sees how it goes on.
    pub fn row(&mut self, cells: Vec<Value>) {
        let named = self.columns.iter().zip(&cells).map(|(name, cell)| format!("{name} {}", text(cell)));
        println!("{}: {}", self.title, named.collect::<Vec<_>>().join(", "));
        self.rows.push(cells);
    }

    /// Sets the note below the table.
    pub fn note(&mut self, note: impl Into<String>) {
        self.note = note.into();
    }
}

impl Report {
    /// Adds a table.
    pub fn add(&mut self, table: Table) {
        self.tables.push(table);
    }

    /// Writes `bench.md` and `bench.json`.
    pub fn write(&self, folder: &Path) -> Result<(), Box<dyn Error>> {
        let mut markdown = String::from("# Benchmarks of Steradian\n");
        for table in &self.tables {
            let _ = write!(markdown, "\n## {}\n\n| {} |\n", table.title, table.columns.join(" | "));
            let _ = writeln!(markdown, "|{}", "---|".repeat(table.columns.len()));
            for row in &table.rows {
                let _ = writeln!(markdown, "| {} |", row.iter().map(text).collect::<Vec<_>>().join(" | "));
            }
            if !table.note.is_empty() {
                let _ = writeln!(markdown, "\n{}", table.note);
            }
        }
        let tables = self.tables.iter().map(|t| {
            let row = |row: &Vec<Value>| -> Value {
                t.columns.iter().zip(row).map(|(name, cell)| ((*name).to_owned(), cell.clone())).collect()
            };
            json!({ "title": t.title, "note": t.note, "rows": t.rows.iter().map(row).collect::<Vec<_>>() })
        });
        let tables: Vec<Value> = tables.collect();
        std::fs::write(folder.join("bench.md"), markdown)?;
        std::fs::write(
            folder.join("bench.json"),
            serde_json::to_string_pretty(&json!({ "schema": 1, "tables": tables }))?,
        )?;
        println!("wrote {}", folder.join("bench.md").display());
        Ok(())
    }
}

/// A cell with no more digits than mean something.
fn text(cell: &Value) -> String {
    match cell {
        Value::String(s) => s.clone(),
        Value::Number(n) if n.is_f64() => {
            let x = n.as_f64().unwrap_or(0.0);
            let digits = if x == 0.0 { 0 } else { (2 - x.abs().log10().floor() as i32).clamp(0, 6) };
            format!("{x:.*}", digits as usize)
        }
        other => other.to_string(),
    }
}
