//! One use only for each buffer view and accessor, and the strides that it allows.

use super::{Issues, document::Document};
use std::collections::HashMap;

/// Use of a buffer view or accessor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Use {
    Attribute,
    Indices,
    InverseBindMatrices,
    AnimationInput,
    AnimationOutput,
    Image,
}

impl Use {
    fn name(self) -> &'static str {
        match self {
            Self::Attribute => "vertex attributes",
            Self::Indices => "indices",
            Self::InverseBindMatrices => "inverse bind matrices",
            Self::AnimationInput => "the input of animations",
            Self::AnimationOutput => "the output of animations",
            Self::Image => "an image",
        }
    }

    /// Use of the buffer view that holds such an accessor: inputs and outputs of animations are one.
    fn of_view(self) -> Self {
        if self == Self::AnimationInput { Self::AnimationOutput } else { self }
    }
}

/// The uses that were met.
#[derive(Debug, Default)]
pub(super) struct Uses {
    pub accessors: HashMap<usize, Use>,
    views: HashMap<usize, Use>,
    /// The first accessor of vertex attributes in each view.
    first: HashMap<usize, usize>,
}

impl Uses {
    /// Notes that an accessor is used at a place.
    pub fn accessor(&mut self, document: &Document<'_>, index: usize, usage: Use, place: &str, issues: &mut Issues) {
        let before = *self.accessors.entry(index).or_insert(usage);
        if before != usage {
            let message = format!("accessor {index} is used as {} and as {}", before.name(), usage.name());
            issues.add(place, message);
        }
        let Some(accessor) = document.accessors.get(index) else { return };
        let (Some(number), Some(view)) = (accessor.view, document.view(accessor)) else { return };
        if usage == Use::Attribute {
            let stride = view.get("byteStride").and_then(|s| s.as_u64());
            let first = *self.first.entry(number).or_insert(index);
            if first != index && stride.is_none() {
                let message =
                    format!("accessors {first} and {index} share buffer view {number}, which needs a 'byteStride'");
                issues.add(place, message);
            }
            let step = stride.unwrap_or(accessor.element());
            if accessor.is_known() && !(accessor.offset.is_multiple_of(4) && step.is_multiple_of(4)) {
                issues.add(place, "each vertex of an attribute must start at a multiple of 4 bytes");
            }
        }
        self.view(document, number, usage, place, issues);
    }

    /// Notes that a buffer view is used at a place.
    pub fn view(&mut self, document: &Document<'_>, number: usize, usage: Use, place: &str, issues: &mut Issues) {
        let Some(view) = document.list("bufferViews").get(number) else { return };
        let target = match view["target"].as_u64() {
            Some(34962) => Some(Use::Attribute),
            Some(34963) => Some(Use::Indices),
            _ => None,
        };
        let of_view = usage.of_view();
        let before = *self.views.entry(number).or_insert(target.unwrap_or(of_view));
        if before != of_view {
            let message = format!("buffer view {number} holds {} and is used as {}", before.name(), usage.name());
            issues.add(place, message);
        }
        if usage != Use::Attribute && view.get("byteStride").is_some() {
            let message = format!("buffer view {number} is used as {} and must have no 'byteStride'", usage.name());
            issues.add(place, message);
        }
    }
}
