//! A model of a family: its kind and its parameters.

use crate::{names::did_you_mean, parameter::Parameter};

/// Parameters that several models share.
#[derive(Debug, PartialEq)]
pub struct Group {
    /// Its name in documentation.
    pub name: &'static str,
    /// Purpose, in a phrase.
    pub doc: &'static str,
    /// Parameters of the group.
    pub parameters: &'static [Parameter],
    /// Source of the equations; may be empty.
    pub source: &'static str,
}

/// A kind of material, texture, light and so on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Model {
    /// Its name in descriptions.
    pub kind: &'static str,
    /// Definition, in a phrase.
    pub doc: &'static str,
    /// Parameters of this model alone.
    pub parameters: &'static [Parameter],
    /// Groups of parameters shared with other models.
    pub groups: &'static [&'static Group],
    /// Source of the equations; may be empty.
    pub source: &'static str,
}

impl Model {
    /// All parameters: the model's own, then those of its groups.
    pub fn all(&self) -> impl Iterator<Item = &'static Parameter> + Clone + use<> {
        self.parameters.iter().chain(self.groups.iter().flat_map(|g| g.parameters))
    }

    /// The parameter of a name.
    pub fn parameter(&self, name: &str) -> Option<&'static Parameter> {
        self.all().find(|p| p.name == name)
    }

    /// Looks for a parameter that does not exist: `Some` if there is none of this name, with the most similar name that
    /// exists, if any is similar.
    pub fn unknown(&self, name: &str) -> Option<Option<String>> {
        self.parameter(name).is_none().then(|| did_you_mean(name, self.all().map(|p| p.name)))
    }
}
