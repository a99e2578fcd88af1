//! Holds a document against the schema.

use super::{
    Issues,
    extensions::EXTENSIONS,
    issues::shown,
    kinds::{Kind, Object},
    schema::ROOT,
    uri,
};
use serde_json::{Map, Value};
use std::collections::HashSet;

/// A place in the document, up to its root.
struct Place<'p> {
    above: Option<&'p Self>,
    step: Step<'p>,
}

enum Step<'p> {
    Member(&'p str),
    Item(usize),
}

impl Place<'_> {
    fn pointer(&self) -> String {
        let mut pointer = self.above.map(Self::pointer).unwrap_or_default();
        match self.step {
            // Of the document itself.
            Step::Member("") if self.above.is_none() => {}
            Step::Member(name) => pointer = format!("{pointer}/{}", shown(name.replace('~', "~0").replace('/', "~1"))),
            Step::Item(index) => pointer = format!("{pointer}/{index}"),
        }
        pointer
    }
}

/// Holds the values of one document against the schema.
struct Walker<'a> {
    root: &'a Value,
    /// Names of `extensionsUsed`.
    used: HashSet<&'a str>,
    issues: &'a mut Issues,
}

/// Finds what breaks the schema.
pub(super) fn check(root: &Value, issues: &mut Issues) {
    let used = root.get("extensionsUsed").and_then(Value::as_array).into_iter().flatten();
    let mut walker = Walker { root, used: used.filter_map(Value::as_str).collect(), issues };
    walker.value(&Place { above: None, step: Step::Member("") }, root, &Kind::Object(&ROOT));
}

impl Walker<'_> {
    fn broken(&mut self, place: &Place<'_>, message: impl Into<String>) {
        self.issues.add(place.pointer(), message);
    }

    fn expected(&mut self, place: &Place<'_>, what: &str, value: &Value) {
        self.broken(place, format!("{what} is expected, not {}", shown(value)));
    }

    fn value(&mut self, place: &Place<'_>, value: &Value, kind: &Kind) {
        match (kind, value) {
            (Kind::Bool, Value::Bool(_)) | (Kind::Text, Value::String(_)) => {}
            (Kind::Bool, _) => self.expected(place, "true or false", value),
            (Kind::Version, Value::String(text)) if is_version(text) => {}
            (Kind::Version, Value::String(_)) => self.expected(place, "a version such as \"2.0\"", value),
            (Kind::Uri, Value::String(text)) => {
                if let Err(why) = uri::check(text) {
                    self.broken(place, why);
                }
            }
            (Kind::Word(words), Value::String(text)) if words.contains(&text.as_str()) => {}
            (Kind::Word(words), Value::String(_)) => {
                self.broken(place, format!("{} is not one of '{}'", shown(value), words.join("', '")));
            }
            (Kind::Text | Kind::Version | Kind::Uri | Kind::Word(_), _) => self.expected(place, "text", value),
            (Kind::Code(_) | Kind::Integer { .. } | Kind::Index(_), _) => self.integer(place, value, kind),
            (Kind::Number { .. } | Kind::Above(_), _) => self.number(place, value, kind),
            (Kind::List(of, lengths), Value::Array(items)) => {
                if items.is_empty() {
                    self.broken(place, "an array must not be empty; leave it out instead");
                } else if !lengths.is_empty() && !lengths.contains(&items.len()) {
                    let lengths: Vec<String> = lengths.iter().map(ToString::to_string).collect();
                    self.broken(
                        place,
                        format!("{} values stand here instead of {}", items.len(), lengths.join(" or ")),
                    );
                }
                self.items(place, items, of);
            }
            (Kind::Set(of), Value::Array(items)) => {
                if items.is_empty() {
                    self.broken(place, "an array must not be empty; leave it out instead");
                }
                let mut met = HashSet::new();
                for (k, item) in items.iter().enumerate() {
                    if !met.insert(item.to_string()) {
                        let item_place = Place { above: Some(place), step: Step::Item(k) };
                        self.broken(&item_place, format!("{} stands more than once in this array", shown(item)));
                    }
                }
                self.items(place, items, of);
            }
            (Kind::List(..) | Kind::Set(_), _) => self.expected(place, "an array", value),
            (Kind::Map(of), Value::Object(members)) => {
                if members.is_empty() {
                    self.broken(place, "an object must not be empty here; leave it out instead");
                }
                for (name, member) in members {
                    self.value(&Place { above: Some(place), step: Step::Member(name) }, member, of);
                }
            }
            (Kind::Object(object), Value::Object(members)) => self.object(place, members, object),
            (Kind::Map(_) | Kind::Object(_), _) => self.expected(place, "an object", value),
        }
    }

    fn items(&mut self, place: &Place<'_>, items: &[Value], of: &Kind) {
        for (k, item) in items.iter().enumerate() {
            self.value(&Place { above: Some(place), step: Step::Item(k) }, item, of);
        }
    }

    fn integer(&mut self, place: &Place<'_>, value: &Value, kind: &Kind) {
        let Some(number) = value.as_u64() else {
            if value.as_f64().is_some_and(|v| v >= 0.0 && v.fract() == 0.0) {
                self.broken(place, format!("the whole number {value} must be written without a fraction"));
            } else if value.as_i64().is_some() && !matches!(kind, Kind::Index(_)) {
                self.broken(place, format!("{value} is negative"));
            } else {
                self.expected(place, "a whole number that is not negative", value);
            }
            return;
        };
        match kind {
            Kind::Code(codes) if !codes.contains(&number) => {
                let codes: Vec<String> = codes.iter().map(ToString::to_string).collect();
                self.broken(place, format!("{number} is not one of {}", codes.join(", ")));
            }
            Kind::Integer { least, .. } if number < *least => {
                self.broken(place, format!("{number} is less than {least}"));
            }
            Kind::Integer { most, .. } if number > *most => {
                self.broken(place, format!("{number} is more than {most}"));
            }
            Kind::Integer { multiple, .. } if !number.is_multiple_of(*multiple) => {
                self.broken(place, format!("{number} is not a multiple of {multiple}"));
            }
            Kind::Index(of) if !of.is_empty() => {
                let list = self.root.pointer(&format!("/{of}"));
                let there = list.and_then(Value::as_array).map_or(0, Vec::len);
                if number >= there as u64 {
                    self.broken(place, format!("there is no {of}[{number}]: there are {there}"));
                }
            }
            _ => {}
        }
    }

    fn number(&mut self, place: &Place<'_>, value: &Value, kind: &Kind) {
        let Some(number) = value.as_f64() else {
            return self.expected(place, "a number", value);
        };
        match kind {
            Kind::Number { least, most } if !(*least..=*most).contains(&number) => {
                let range = match (least.is_finite(), most.is_finite()) {
                    (true, true) => format!("outside of {least} to {most}"),
                    (true, false) => format!("less than {least}"),
                    _ => format!("more than {most}"),
                };
                self.broken(place, format!("{number} is {range}"));
            }
            Kind::Above(bound) if number <= *bound => {
                self.broken(place, format!("{number} is not more than {bound}"));
            }
            _ => {}
        }
    }

    fn object(&mut self, place: &Place<'_>, members: &Map<String, Value>, object: &Object) {
        for member in object.members {
            match members.get(member.name) {
                Some(value) => {
                    self.value(&Place { above: Some(place), step: Step::Member(member.name) }, value, &member.kind);
                    if let Some(needed) = member.needs.filter(|n| !members.contains_key(*n)) {
                        let message = format!("'{}' needs '{needed}' beside it", member.name);
                        self.broken(&Place { above: Some(place), step: Step::Member(member.name) }, message);
                    }
                }
                None if member.is_required => {
                    let name = object.name;
                    self.broken(place, format!("'{}' is missing: each {name} must have it", member.name));
                }
                None => {}
            }
        }
        let one_of = object.one_of.iter().filter(|name| members.contains_key(**name)).count();
        if !object.one_of.is_empty() && one_of != 1 {
            let names = object.one_of.join("' and '");
            self.broken(place, format!("exactly one of '{names}' must be there, not {one_of}"));
        }
        if let Some(extensions) = members.get("extensions") {
            self.extensions(&Place { above: Some(place), step: Step::Member("extensions") }, extensions, object);
        }
    }

    fn extensions(&mut self, place: &Place<'_>, extensions: &Value, object: &Object) {
        let Value::Object(members) = extensions else {
            return self.expected(place, "an object", extensions);
        };
        for (name, value) in members {
            let place = Place { above: Some(place), step: Step::Member(name) };
            if !self.used.contains(name.as_str()) {
                self.broken(&place, "this extension is not declared in 'extensionsUsed'");
            }
            let Some(extension) = EXTENSIONS.iter().find(|e| e.name == name) else {
                if !value.is_object() {
                    self.expected(&place, "an object", value);
                }
                continue;
            };
            match extension.places.iter().find(|(name, _)| *name == object.name) {
                Some((_, object)) => self.value(&place, value, &Kind::Object(object)),
                None => self.broken(&place, format!("this extension does not belong to a {}", object.name)),
            }
        }
    }
}

/// Digits, a point, digits.
fn is_version(text: &str) -> bool {
    let is_number = |part: &str| !part.is_empty() && part.bytes().all(|b| b.is_ascii_digit());
    text.split_once('.').is_some_and(|(major, minor)| is_number(major) && is_number(minor))
}
