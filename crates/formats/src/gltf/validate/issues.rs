//! Broken rules of a document: a bounded list of JSON pointers with messages.

use std::collections::HashMap;

/// Most messages that are alike.
const MOST_ALIKE: usize = 5;
/// Most messages in all.
const MOST: usize = 100;

/// A broken rule.
#[derive(Debug)]
pub(in crate::gltf) struct Issue {
    /// JSON pointer of what is wrong.
    pub pointer: String,
    pub message: String,
}

/// The broken rules of a document. Messages that differ only in numbers are alike: some are kept, all are counted.
#[derive(Debug, Default)]
pub(in crate::gltf) struct Issues {
    kept: Vec<Issue>,
    /// Count and first index of each kind of message.
    alike: HashMap<String, (usize, usize)>,
    left_out: usize,
}

impl Issues {
    pub fn add(&mut self, pointer: impl Into<String>, message: impl Into<String>) {
        if self.kept.len() >= MOST {
            self.left_out += 1;
            return;
        }
        let (pointer, message) = (pointer.into(), message.into());
        let kind = without_numbers(&pointer) + ":" + &without_numbers(&message);
        let (count, _) = self.alike.entry(kind).or_insert((0, self.kept.len()));
        *count += 1;
        if *count <= MOST_ALIKE {
            self.kept.push(Issue { pointer, message });
        }
    }

    /// All, then the counts of those that were not kept.
    pub fn finish(mut self) -> Vec<Issue> {
        let mut more: Vec<(usize, usize)> = self.alike.into_values().filter(|(n, _)| *n > MOST_ALIKE).collect();
        more.sort_by_key(|(_, first)| *first);
        for (count, first) in more {
            let Issue { pointer, message } = &self.kept[first];
            let message = format!("{} more places like {pointer} break the rule: {message}", count - MOST_ALIKE);
            self.kept.push(Issue { pointer: String::new(), message });
        }
        if self.left_out > 0 {
            let message = format!("glTF's rules are broken at {} more places", self.left_out);
            self.kept.push(Issue { pointer: String::new(), message });
        }
        self.kept
    }
}

/// A text in which each run of digits is one sign.
fn without_numbers(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '0'..='9' if out.ends_with('#') => {}
            '0'..='9' => out.push('#'),
            _ => out.push(c),
        }
    }
    out
}

/// A text or value of a file as it may be shown: not too long.
pub(super) fn shown(value: impl ToString) -> String {
    let text = value.to_string();
    let mut short: String = text.chars().take(60).collect();
    if short.len() < text.len() {
        short.push('…');
    }
    short
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_are_bounded_and_counted() {
        let mut issues = Issues::default();
        for k in 0..20 {
            issues.add(format!("/nodes/{k}"), format!("{k} is wrong"));
        }
        let list = issues.finish();
        assert_eq!(list.len(), MOST_ALIKE + 1);
        assert_eq!(list[5].message, "15 more places like /nodes/0 break the rule: 0 is wrong");
        let mut issues = Issues::default();
        for k in 0..1_000 {
            issues.add("/a", "x".repeat(k));
        }
        let list = issues.finish();
        assert_eq!((list.len(), list[MOST].message.as_str()), (MOST + 1, "glTF's rules are broken at 900 more places"));
    }
}
