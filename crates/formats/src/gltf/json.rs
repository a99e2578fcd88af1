//! Values of the JSON document with their pointers (RFC 6901), and checked ways to read them.

use super::Reader;
use serde_json::Value;

/// A value and where it stands.
#[derive(Clone, Debug)]
pub(super) struct At<'r> {
    pub value: &'r Value,
    pub pointer: String,
}

impl<'r> At<'r> {
    /// The document.
    pub fn root(value: &'r Value) -> Self {
        Self { value, pointer: String::new() }
    }

    /// A member of an object.
    pub fn get(&self, name: &str) -> Option<Self> {
        let value = self.value.as_object()?.get(name)?;
        Some(Self { value, pointer: format!("{}/{}", self.pointer, name.replace('~', "~0").replace('/', "~1")) })
    }

    /// A member of the member `extensions`.
    pub fn extension(&self, name: &str) -> Option<Self> {
        self.get("extensions")?.get(name)
    }

    /// An item of an array.
    pub fn item(&self, index: usize) -> Option<Self> {
        let value = self.value.as_array()?.get(index)?;
        Some(Self { value, pointer: format!("{}/{index}", self.pointer) })
    }

    /// The items of an array; none of anything else.
    pub fn items(&self) -> impl Iterator<Item = Self> + use<'r> {
        let pointer = self.pointer.clone();
        self.value
            .as_array()
            .into_iter()
            .flatten()
            .enumerate()
            .map(move |(i, value)| Self { value, pointer: format!("{pointer}/{i}") })
    }

    /// The items of the array called `name`.
    pub fn list(&self, name: &str) -> impl Iterator<Item = Self> + use<'r> {
        self.get(name).into_iter().flat_map(|list| list.items())
    }

    /// Length of the array called `name`; 0 where there is none.
    pub fn count(&self, name: &str) -> usize {
        self.value.get(name).and_then(Value::as_array).map_or(0, Vec::len)
    }

    /// The text of the member `name`.
    pub fn text(&self, name: &str) -> Option<&'r str> {
        self.value.as_object()?.get(name)?.as_str()
    }

    /// The text of the member `name` if it may be shown: not too long.
    pub fn label(&self) -> Option<String> {
        self.text("name").filter(|n| !n.is_empty()).map(|n| n.chars().take(200).collect())
    }
}

impl Reader<'_> {
    /// A finite number in a range, or the default where it is missing; what is wrong is reported and clamped.
    pub(super) fn number(&mut self, at: &At<'_>, name: &str, default: f64, (least, most): (f64, f64)) -> f64 {
        let Some(member) = at.get(name) else { return default };
        match member.value.as_f64() {
            Some(v) if (least..=most).contains(&v) => v,
            Some(v) => {
                let to = v.clamp(least, most);
                self.approximated(&member, format!("{v} is outside of {least} to {most}; {to} is used"));
                to
            }
            None => {
                self.error(&member, "a number is expected");
                default
            }
        }
    }

    /// So many finite numbers.
    pub(super) fn numbers<const N: usize>(&mut self, at: &At<'_>, name: &str, default: [f64; N]) -> [f64; N] {
        let Some(member) = at.get(name) else { return default };
        let found: Option<Vec<f64>> =
            member.value.as_array().map(|a| a.iter().filter_map(Value::as_f64).filter(|v| v.abs() < 1e30).collect());
        match found.and_then(|v| <[f64; N]>::try_from(v).ok()) {
            Some(v) if member.value.as_array().is_some_and(|a| a.len() == N) => v,
            _ => {
                self.error(&member, format!("{N} numbers are expected"));
                default
            }
        }
    }

    /// An index into the array `of` of the document; what points past its end is an error.
    pub(super) fn index<'r>(&mut self, root: &At<'r>, at: &At<'_>, name: &str, of: &str) -> Option<(usize, At<'r>)> {
        let member = at.get(name)?;
        let index = member.value.as_u64().and_then(|v| usize::try_from(v).ok());
        let Some(index) = index else {
            self.error(&member, format!("an index into '{of}' is expected"));
            return None;
        };
        let Some(item) = root.get(of).and_then(|list| list.item(index)) else {
            let there = root.count(of);
            self.error(&member, format!("there is no {of}[{index}]: there are {there}"));
            return None;
        };
        Some((index, item))
    }
}
