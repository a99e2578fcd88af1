//! Values of fields and attributes, as both encodings of layers have them.

use std::{borrow::Cow, collections::BTreeMap, sync::Arc};

/// A value. Tuples, matrices and their arrays are flat lists of numbers; the type's name tells how many go together.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value {
    /// Blocks the opinions of weaker layers.
    Block,
    Bool(bool),
    Number(f64),
    /// A string, token or path.
    Text(String),
    /// The name of a file.
    Asset(String),
    /// Numbers of single or half precision.
    Floats(Arc<[f32]>),
    /// Numbers of double precision, and integers.
    Numbers(Arc<[f64]>),
    Texts(Arc<[String]>),
    List(Arc<ListOp>),
    /// Values by time code, in rising order.
    Samples(Arc<[(f64, Value)]>),
    Dictionary(Arc<BTreeMap<String, Value>>),
}

/// An item of a list operation: a name, a path, or the target of a reference.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Item {
    /// The file of a reference; empty for the layer stack itself.
    pub asset: String,
    /// A path in it, or a name.
    pub path: String,
    /// Offset and scale of times in the file.
    pub retime: Retime,
}

/// From the time codes of a layer to those of the layer that names it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Retime {
    pub offset: f64,
    pub scale: f64,
}

impl Default for Retime {
    fn default() -> Self {
        Self { offset: 0.0, scale: 1.0 }
    }
}

impl Retime {
    /// This one, of times that `inner` has changed already.
    pub fn after(self, inner: Self) -> Self {
        Self { offset: self.offset + self.scale * inner.offset, scale: self.scale * inner.scale }
    }

    /// The time code in the layer.
    pub fn inward(self, time: f64) -> f64 {
        if self.scale == 0.0 || !self.scale.is_finite() { time } else { (time - self.offset) / self.scale }
    }
}

/// Edits of a list, or the whole of it.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct ListOp {
    pub explicit: Option<Vec<Item>>,
    pub prepended: Vec<Item>,
    pub appended: Vec<Item>,
    pub deleted: Vec<Item>,
}

impl ListOp {
    /// Edits the list that weaker layers made.
    pub fn edit(&self, list: &mut Vec<Item>) {
        if let Some(items) = &self.explicit {
            list.clone_from(items);
        }
        let is_same = |a: &Item, b: &Item| a.asset == b.asset && a.path == b.path;
        let without = |list: &mut Vec<Item>, items: &[Item]| {
            if !items.is_empty() {
                list.retain(|item| !items.iter().any(|other| is_same(item, other)));
            }
        };
        without(list, &self.deleted);
        without(list, &self.prepended);
        list.splice(0..0, self.prepended.iter().cloned());
        without(list, &self.appended);
        list.extend(self.appended.iter().cloned());
    }
}

impl Value {
    pub fn bool(&self) -> Option<bool> {
        match self {
            Self::Bool(v) => Some(*v),
            Self::Number(v) => Some(*v != 0.0),
            _ => None,
        }
    }

    pub fn number(&self) -> Option<f64> {
        match self {
            Self::Bool(v) => Some(f64::from(u8::from(*v))),
            Self::Number(v) => Some(*v),
            Self::Floats(v) if v.len() == 1 => v.first().map(|v| f64::from(*v)),
            Self::Numbers(v) if v.len() == 1 => v.first().copied(),
            _ => None,
        }
    }

    pub fn text(&self) -> Option<&str> {
        match self {
            Self::Text(text) | Self::Asset(text) => Some(text),
            _ => None,
        }
    }

    /// Texts of a list, or the one text.
    pub fn texts(&self) -> &[String] {
        match self {
            Self::Texts(texts) => texts,
            Self::Text(text) | Self::Asset(text) => std::slice::from_ref(text),
            _ => &[],
        }
    }

    pub fn floats(&self) -> Option<Cow<'_, [f32]>> {
        match self {
            Self::Floats(v) => Some(Cow::Borrowed(v)),
            Self::Numbers(v) => Some(v.iter().map(|v| *v as f32).collect()),
            Self::Number(v) => Some(vec![*v as f32].into()),
            // An empty list has no type in text.
            Self::Texts(v) if v.is_empty() => Some(Cow::Borrowed(&[])),
            _ => None,
        }
    }

    pub fn numbers(&self) -> Option<Cow<'_, [f64]>> {
        match self {
            Self::Numbers(v) => Some(Cow::Borrowed(v)),
            Self::Floats(v) => Some(v.iter().map(|v| f64::from(*v)).collect()),
            Self::Texts(v) if v.is_empty() => Some(Cow::Borrowed(&[])),
            _ => self.number().map(|v| vec![v].into()),
        }
    }

    /// A tuple of so many numbers.
    pub fn tuple<const N: usize>(&self) -> Option<[f64; N]> {
        self.numbers()?.as_ref().try_into().ok()
    }

    /// A value between two of the same kind and length; the first where they are not.
    pub fn between(&self, other: &Self, t: f64) -> Self {
        match (self, other) {
            (Self::Number(a), Self::Number(b)) => Self::Number(a + (b - a) * t),
            (Self::Floats(a), Self::Floats(b)) if a.len() == b.len() => {
                Self::Floats(a.iter().zip(b.iter()).map(|(a, b)| a + (b - a) * t as f32).collect())
            }
            (Self::Numbers(a), Self::Numbers(b)) if a.len() == b.len() => {
                Self::Numbers(a.iter().zip(b.iter()).map(|(a, b)| a + (b - a) * t).collect())
            }
            _ => self.clone(),
        }
    }
}

/// True for types whose values are interpolated in time.
pub(super) fn is_continuous(type_name: &str) -> bool {
    let kinds = [
        "float", "double", "half", "point", "vector", "normal", "color", "texCoord", "matrix", "quat", "frame",
        "timecode",
    ];
    kinds.iter().any(|kind| type_name.starts_with(kind))
}

/// True for types whose numbers are read in double precision.
pub(super) fn is_double(type_name: &str) -> bool {
    let name = type_name.trim_end_matches("[]");
    ["double", "int", "uint", "matrix", "frame", "timecode", "bool", "uchar"].iter().any(|kind| name.starts_with(kind))
        || ["point", "vector", "normal", "color", "texCoord", "quat"].iter().any(|kind| name.starts_with(kind))
            && name.ends_with('d')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_are_edited_in_order() {
        let items = |names: &str| -> Vec<Item> {
            names.chars().map(|c| Item { path: c.to_string(), ..Item::default() }).collect()
        };
        let mut list = items("abc");
        let op = ListOp { prepended: items("xc"), appended: items("a"), deleted: items("b"), explicit: None };
        op.edit(&mut list);
        assert_eq!(list, items("xca"));
        ListOp { explicit: Some(items("q")), ..ListOp::default() }.edit(&mut list);
        assert_eq!(list, items("q"));
    }

    #[test]
    fn times_are_changed_in_order() {
        let outer = Retime { offset: 10.0, scale: 2.0 };
        let both = outer.after(Retime { offset: 1.0, scale: 3.0 });
        // A key at 5 stands at 16 in the middle file and at 42 in the outer one.
        assert_eq!(both.inward(42.0), 5.0);
    }
}
