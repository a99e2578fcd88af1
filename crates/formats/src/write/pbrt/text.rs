//! Directives with their parameters.

use crate::write::colour::Colour;
use std::fmt::Write;

/// Longest directive on one line.
const LINE: usize = 110;
/// Numbers on one line of a long list.
const NUMBERS: usize = 24;

/// A directive, a kind, and parameters.
#[derive(Clone, Debug)]
pub(super) struct Directive {
    head: String,
    parts: Vec<String>,
}

/// A number in as few characters as tell it.
pub(super) fn number(v: f64) -> String {
    shortest(v == 0.0, v.abs(), v.to_string(), format!("{v:e}"))
}

fn single(v: f32) -> String {
    shortest(v == 0.0, f64::from(v).abs(), v.to_string(), format!("{v:e}"))
}

fn shortest(is_zero: bool, size: f64, plain: String, scientific: String) -> String {
    match () {
        () if is_zero => "0".into(),
        () if (1e-4..1e16).contains(&size) => plain,
        () => scientific,
    }
}

/// A string in quotes. pbrt knows the escapes of C.
pub(super) fn quoted(text: &str) -> String {
    let mut out = String::from("\"");
    for c in text.chars() {
        match c {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out.push('"');
    out
}

impl Directive {
    /// A word and the strings that follow it.
    pub fn new(word: &str, strings: &[&str]) -> Self {
        let strings: String = strings.iter().map(|s| format!(" {}", quoted(s))).collect();
        Self { head: format!("{word}{strings}"), parts: Vec::new() }
    }

    fn list(&mut self, kind: &str, name: &str, values: impl IntoIterator<Item = String>) {
        let values: Vec<String> = values.into_iter().collect();
        let lines: Vec<String> = values.chunks(NUMBERS).map(|c| c.join(" ")).collect();
        self.parts.push(format!("\"{kind} {name}\" [ {} ]", lines.join("\n")));
    }

    pub fn float(&mut self, name: &str, value: f64) {
        self.list("float", name, [number(value)]);
    }

    pub fn floats(&mut self, kind: &str, name: &str, values: impl IntoIterator<Item = f64>) {
        self.list(kind, name, values.into_iter().map(number));
    }

    /// Numbers that have the precision of `f32`.
    pub fn singles<'a>(&mut self, kind: &str, name: &str, values: impl IntoIterator<Item = &'a f32>) {
        self.list(kind, name, values.into_iter().map(|v| single(*v)));
    }

    pub fn integers(&mut self, name: &str, values: impl IntoIterator<Item = i64>) {
        self.list("integer", name, values.into_iter().map(|v| v.to_string()));
    }

    pub fn bool(&mut self, name: &str, value: bool) {
        self.list("bool", name, [value.to_string()]);
    }

    pub fn string(&mut self, name: &str, value: &str) {
        self.list("string", name, [quoted(value)]);
    }

    pub fn strings(&mut self, name: &str, values: &[String]) {
        self.list("string", name, values.iter().map(|v| quoted(v)));
    }

    pub fn texture(&mut self, name: &str, value: &str) {
        self.list("texture", name, [quoted(value)]);
    }

    /// A reflectance or an unbounded quantity.
    pub fn spectrum(&mut self, name: &str, value: &Colour) {
        match value {
            Colour::Grey(v) => self.floats("rgb", name, [*v; 3]),
            Colour::Rgb(c) => self.floats("rgb", name, *c),
            Colour::Curve(l, v) => self.curve(name, l, v),
        }
    }

    /// Emission, whose RGB is relative to D65.
    pub fn emission(&mut self, name: &str, value: &Colour) {
        match value {
            Colour::Grey(v) => self.curve(name, &[360.0, 830.0], &[*v as f32; 2]),
            other => self.spectrum(name, other),
        }
    }

    fn curve(&mut self, name: &str, lambdas: &[f32], values: &[f32]) {
        self.singles("spectrum", name, lambdas.iter().zip(values).flat_map(|(l, v)| [l, v]));
    }

    /// As text, on lines of their own where it is long.
    pub fn text(&self, depth: usize) -> String {
        let length: usize = self.head.len() + self.parts.iter().map(|p| p.len() + 1).sum::<usize>();
        let mut out = self.head.clone();
        let space = "    ".repeat(depth + 1);
        for part in &self.parts {
            if length <= LINE {
                let _ = write!(out, " {part}");
            } else {
                let _ = write!(out, "\n{space}{}", part.replace('\n', &format!("\n{space}")));
            }
        }
        out
    }
}
