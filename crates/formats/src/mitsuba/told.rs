//! Properties that are understood but not followed: a message says so, once for a kind of object.

use super::{
    graph::{ObjectId, Raw},
    reader::Reader,
};

/// The reason that a property has no effect, where it is about the means alone.
pub(super) const NOISE: &str = "it changes the noise only";

/// The reason that a property has no effect, where it is about time and memory alone.
pub(super) const SPEED: &str = "it changes the speed only";

/// Tells if a value is the one that a text stands for.
fn is(value: &Raw, text: &str) -> bool {
    match value {
        Raw::Bool(v) => text == v.to_string(),
        Raw::Int(v) => text.parse() == Ok(*v as f64),
        Raw::Float(v) => text.parse() == Ok(*v),
        Raw::String(v) => v.eq_ignore_ascii_case(text),
        _ => false,
    }
}

impl Reader<'_> {
    /// Takes properties that change nothing in the picture, and notes why.
    pub fn no_effect(&mut self, object: ObjectId, names: &[&'static str], why: &str) {
        for name in names {
            let Some(prop) = self.graph.take(object, name) else { continue };
            let message = format!("{} has no effect: {why}", self.property_of(object, name));
            if self.said.insert(message.clone()) {
                self.note(prop.span, message);
            }
        }
    }

    /// Takes a property that changes the picture and is not followed, and reports so unless it has one of the values
    /// with which nothing changes.
    pub fn left_out(&mut self, object: ObjectId, name: &'static str, harmless: &[&str], why: &str) {
        let Some(prop) = self.graph.take(object, name) else { return };
        let message = format!("{} is left out: {why}", self.property_of(object, name));
        if !harmless.iter().any(|text| is(&prop.value, text)) && self.said.insert(message.clone()) {
            self.dropped(prop.span, message);
        }
    }

    fn property_of(&self, object: ObjectId, name: &str) -> String {
        format!("'{name}' of the {} '{}'", self.graph.objects[object].category.noun(), self.plugin(object))
    }
}
