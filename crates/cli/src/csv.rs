//! Tables of comma-separated values, RFC 4180 but for the ends of lines.

/// A line for each row; cells are quoted where they have to be.
pub fn table(rows: impl IntoIterator<Item = Vec<String>>) -> String {
    let field = |text: &String| match text.contains([',', '"', '\n', '\r']) {
        true => format!("\"{}\"", text.replace('"', "\"\"")),
        false => text.clone(),
    };
    rows.into_iter().map(|cells| cells.iter().map(field).collect::<Vec<_>>().join(",") + "\n").collect()
}
