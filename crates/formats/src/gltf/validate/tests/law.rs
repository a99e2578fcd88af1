//! Every member of every object that the specification and the extensions have is followed or told.

use super::*;
use crate::{
    gltf::validate::{
        extensions::EXTENSIONS,
        kinds::{Kind, Object},
        schema::ROOT,
    },
    law::{Outcome, Reading, judge, outcome},
};
use std::path::Path;

/// A document with the objects that others refer to.
fn stage() -> Value {
    let mut document = sound(&buffer());
    document["extensionsUsed"] = EXTENSIONS.iter().map(|e| e.name).collect();
    document["scenes"] = json!([{ "nodes": [0, 1] }, { "nodes": [1] }]);
    document["extensions"] = json!({
        "KHR_lights_punctual": {
            "lights": [{ "type": "spot", "spot": { "outerConeAngle": 0.7 } }, { "type": "point" }],
        },
        "KHR_materials_variants": { "variants": [{ "name": "v" }, { "name": "w" }] },
    });
    document["images"] = json!([{ "uri": "picture.png" }, { "uri": "other.png" }]);
    document["textures"] = json!([{ "source": 0, "sampler": 0 }, { "source": 1 }]);
    document["materials"][0]["extensions"] = json!({
        "KHR_materials_transmission": { "transmissionFactor": 0.5 },
        "KHR_materials_volume": { "thicknessFactor": 0.5 },
    });
    document["nodes"][1]["extensions"] = json!({ "KHR_lights_punctual": { "light": 0 } });
    document
}

/// The least value that is valid.
fn least(kind: &Kind) -> Value {
    match kind {
        Kind::Bool => json!(true),
        Kind::Text => json!("v"),
        Kind::Version => json!("2.0"),
        Kind::Uri => json!("other.png"),
        Kind::Word(words) => json!(words[0]),
        Kind::Code(codes) => json!(codes[0]),
        Kind::Integer { least, .. } => json!((*least).max(1)),
        Kind::Index(_) => json!(0),
        Kind::Number { least, most } => json!(0.5_f64.clamp(*least, *most)),
        Kind::Above(bound) => json!(bound + 0.5),
        Kind::List(of, lengths) => Value::Array(vec![least(of); lengths.first().copied().unwrap_or(1)]),
        Kind::Set(of) => Value::Array(vec![least(of)]),
        Kind::Object(object) => {
            let needed = |name: &str| object.one_of.first() == Some(&name);
            let members = object.members.iter().filter(|m| m.is_required || needed(m.name));
            Value::Object(members.map(|m| (m.name.to_owned(), least(&m.kind))).collect())
        }
        Kind::Map(of) => json!({ "POSITION": least(of) }),
    }
}

/// Values, of which one differs from the default.
fn values(kind: &Kind) -> Vec<Value> {
    let numbers = |low: f64, high: f64| {
        let all = [0.25, 0.75, 1.5, 3.0, -0.5, 0.0, 1.0];
        all.into_iter().filter(move |v| (low..=high).contains(v))
    };
    match kind {
        Kind::Bool => vec![json!(true), json!(false)],
        Kind::Version => ["2.0", "2.1", "3.0"].map(Value::from).into(),
        Kind::Word(words) => words.iter().map(|w| json!(w)).collect(),
        Kind::Code(codes) => codes.iter().map(|c| json!(c)).collect(),
        Kind::Integer { least, most, .. } => {
            [0, 1, 2, 4, 8, 12, 36].into_iter().filter(|v| (*least..=*most).contains(v)).map(Value::from).collect()
        }
        Kind::Index(_) => (0..4).map(Value::from).collect(),
        Kind::Number { least, most } => numbers(*least, *most).map(Value::from).collect(),
        Kind::Above(bound) => numbers(*bound + 1e-9, f64::INFINITY).map(Value::from).collect(),
        Kind::List(of, lengths) => {
            let inner = values(of);
            let lengths = if lengths.is_empty() { &[1][..] } else { lengths };
            let lists = lengths.iter().flat_map(|&n| {
                let mixed: Vec<Value> = inner.iter().cycle().take(n).cloned().collect();
                inner.iter().map(move |v| vec![v.clone(); n]).chain([mixed])
            });
            lists.map(Value::Array).collect()
        }
        Kind::Set(of) => values(of).into_iter().map(|v| Value::Array(vec![v])).collect(),
        other => vec![least(other)],
    }
}

/// Texts for people, whatever they say, and the mark of buffers that need not be there.
const WITHOUT_MEANING: [&str; 4] = ["name", "copyright", "generator", "fallback"];

/// The members of a document's objects, one after the other.
struct Walk<'a> {
    folder: &'a Path,
    outcomes: Vec<(String, Outcome)>,
}

/// An object and those around it, innermost last: their pointers and kinds.
type Chain<'c> = [(String, &'c Object)];

fn with(document: &Value, object: &str, name: &str, value: Value) -> Value {
    let mut document = document.clone();
    if let Some(Value::Object(members)) = document.pointer_mut(object) {
        members.insert(name.into(), value);
    }
    document
}

impl Walk<'_> {
    fn reading(&self, document: &Value) -> Reading {
        let defines = [("at", "0.4"), ("variant", "v")].map(|(a, b)| (a.to_owned(), b.to_owned())).into();
        let options = Options { defines, ..Options::default() };
        Reading::of(&import_bytes(&self.folder.join("a.gltf"), document.to_string().into(), &options))
    }

    fn member(&self, document: &Value, chain: &Chain<'_>, name: &str, kind: &Kind) -> Outcome {
        let (object, _) = &chain[chain.len() - 1];
        let beside = |document: &Value| {
            let mut without = document.clone();
            let there = without.pointer_mut(object).and_then(Value::as_object_mut).and_then(|o| o.remove(name));
            let without = self.reading(if there.is_some() { document } else { &without });
            let values = values(kind).into_iter().map(|value| self.reading(&with(document, object, name, value)));
            // Messages about broken rules point at their place, which may be that of another member.
            if without.is_refused { Outcome::Refused } else { outcome("", &without, values) }
        };
        let mut best = beside(document);
        for (around, kind) in chain.iter().rev().take(3) {
            for other in kind.members.iter().filter(|m| around != object || m.name != name) {
                for company in values(&other.kind) {
                    if best >= Outcome::Told {
                        return best;
                    }
                    let of = beside(&with(document, around, other.name, company));
                    best = if of >= Outcome::Told { of } else { best };
                }
            }
        }
        best
    }

    fn object(&mut self, document: &Value, chain: &[(String, &'static Object)]) {
        let (pointer, object) = chain[chain.len() - 1].clone();
        for member in object.members.iter().filter(|m| !WITHOUT_MEANING.contains(&m.name)) {
            // Lists of objects are their members; of maps the names are not fixed.
            let is_container = matches!(member.kind, Kind::List(Kind::Object(_), _) | Kind::Map(_));
            if !is_container {
                let of = self.member(document, chain, member.name, &member.kind);
                // Of objects that say nothing by themselves, the members count.
                if of != Outcome::Silent || !matches!(member.kind, Kind::Object(_)) {
                    self.outcomes.push((format!("{pointer}/{}", member.name), of));
                }
                // A message about an object stands for all its members.
                if of == Outcome::Told {
                    continue;
                }
            }
            let inner = format!("{pointer}/{}", member.name);
            let inner = match &member.kind {
                Kind::Object(object) => (inner, *object),
                Kind::List(Kind::Object(object), _) => (format!("{inner}/0"), *object),
                _ => continue,
            };
            let has = document.pointer(&inner.0).is_some();
            let filled =
                if has { document.clone() } else { with(document, &pointer, member.name, least(&member.kind)) };
            self.object(&filled, &[chain, &[inner]].concat());
        }
        for extension in EXTENSIONS {
            let Some((_, own)) = extension.places.iter().find(|(name, _)| *name == object.name) else { continue };
            let (at, name) = (format!("{pointer}/extensions"), extension.name);
            let mut filled = document.clone();
            if filled.pointer(&at).is_none() {
                filled = with(&filled, &pointer, "extensions", json!({}));
            }
            if filled.pointer(&format!("{at}/{name}")).is_none() {
                filled = with(&filled, &at, name, least(&Kind::Object(own)));
            }
            self.object(&filled, &[chain, &[(format!("{at}/{name}"), *own)]].concat());
        }
    }
}

#[test]
fn every_member_is_followed_or_told() {
    let folder = tempfile::tempdir().unwrap();
    for picture in ["picture.png", "other.png"] {
        std::fs::write(folder.path().join(picture), b"\x89PNG\r\n\x1a\n").unwrap();
    }
    let mut walk = Walk { folder: folder.path(), outcomes: Vec::new() };
    let document = stage();
    let plain = walk.reading(&document);
    assert!(!plain.is_refused, "{}", plain.messages());
    walk.object(&document, &[(String::new(), &ROOT)]);
    judge(&walk.outcomes, 150);
}
