//! `$parameters`: values that the caller or `<default>` elements give, put in wherever attributes name them.

use std::collections::{BTreeMap, BTreeSet};

/// Most bytes that parameters may put into attributes: a chain of defaults that double each other would have no bound.
const MOST_BYTES: usize = 64 << 20;

struct Parameter {
    value: String,
    used: bool,
}

/// All parameters known so far.
pub(super) struct Parameters {
    by_name: BTreeMap<String, Parameter>,
    /// The lengths of names: longer ones go first, so that `$resx` is not taken for `$res` with an x.
    lengths: BTreeSet<usize>,
    bytes: usize,
}

/// Why a text cannot be completed.
#[derive(Debug, PartialEq)]
pub(super) enum Fault {
    /// No parameter of this name has a value.
    Undefined(String),
    TooLong,
}

impl Parameters {
    /// Parameters defined by the caller.
    pub fn new(defines: &BTreeMap<String, String>) -> Self {
        let mut parameters = Self { by_name: BTreeMap::new(), lengths: BTreeSet::new(), bytes: 0 };
        for (name, value) in defines {
            parameters.insert(name, value, false);
        }
        parameters
    }

    fn insert(&mut self, name: &str, value: &str, used: bool) {
        self.lengths.insert(name.len());
        self.by_name.insert(name.into(), Parameter { value: value.into(), used });
    }

    /// Gives a parameter a value where it has none.
    pub fn default(&mut self, name: &str, value: &str) {
        if !self.by_name.contains_key(name) {
            self.insert(name, value, true);
        }
    }

    /// The names of all parameters.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.by_name.keys().map(String::as_str)
    }

    /// The names of what the caller defined and no attribute asked for.
    pub fn unused(&self) -> impl Iterator<Item = &str> {
        self.by_name.iter().filter(|(_, p)| !p.used).map(|(name, _)| name.as_str())
    }

    /// The name of the parameter that a text starts with.
    fn at_start<'t>(&self, text: &'t str) -> Option<&'t str> {
        // Half open: of an empty text there is no range from 1 to 0.
        let mut candidates = self.lengths.range(1..text.len() + 1).rev().filter_map(|&length| text.get(..length));
        candidates.find(|name| self.by_name.contains_key(*name))
    }

    /// A text with the values of parameters where it has `$name`; `\$` is a dollar sign.
    pub fn substitute(&mut self, text: &str) -> Result<String, Fault> {
        let mut out = String::new();
        let mut rest = text;
        while let Some(dollar) = rest.find('$') {
            let (before, after) = (&rest[..dollar], &rest[dollar + 1..]);
            if let Some(before) = before.strip_suffix('\\') {
                out.push_str(before);
                out.push('$');
                rest = after;
                continue;
            }
            out.push_str(before);
            let named = self.at_start(after);
            let Some((name, p)) = named.and_then(|name| Some((name, self.by_name.get_mut(name)?))) else {
                let name = after.chars().take_while(|c| c.is_ascii_alphanumeric() || *c == '_').collect();
                return Err(Fault::Undefined(name));
            };
            p.used = true;
            self.bytes += p.value.len();
            if self.bytes > MOST_BYTES {
                return Err(Fault::TooLong);
            }
            out.push_str(&p.value);
            rest = &after[name.len()..];
        }
        out.push_str(rest);
        Ok(out)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn longest_names_win_and_dollars_can_be_escaped() {
        let mut p = Parameters::new(&[("res".to_owned(), "1".to_owned()), ("resx".to_owned(), "22".to_owned())].into());
        p.default("res", "never");
        p.default("spp", "16");
        assert_eq!(p.substitute("$resx/$res-$spp\\$res"), Ok("22/1-16$res".into()));
        assert_eq!(p.substitute("a$other b"), Err(Fault::Undefined("other".into())));
        assert_eq!(p.substitute("a$"), Err(Fault::Undefined(String::new())));
        assert_eq!(p.unused().count(), 0);
        assert_eq!(Parameters::new(&[("a".to_owned(), String::new())].into()).unused().collect::<Vec<_>>(), ["a"]);
    }

    #[test]
    fn doubling_defaults_are_bounded() {
        let mut p = Parameters::new(&BTreeMap::new());
        p.default("a0", "0123456789");
        let mut result = Ok(String::new());
        for i in 0..60 {
            result = p.substitute(&format!("$a{i}$a{i}"));
            let Ok(value) = &result else { break };
            p.default(&format!("a{}", i + 1), value);
        }
        assert_eq!(result, Err(Fault::TooLong));
    }
}
