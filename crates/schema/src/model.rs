//! A model of a family: its kind and what can be set of it.

use crate::{names::did_you_mean, parameter::Parameter};

/// Parameters that several models share.
#[derive(Debug, PartialEq)]
pub struct Group {
    /// Its name in documentation.
    pub name: &'static str,
    /// What it is for, in a phrase.
    pub doc: &'static str,
    /// What can be set.
    pub parameters: &'static [Parameter],
    /// Where the equations are from; may be empty.
    pub source: &'static str,
}

/// A kind of material, texture, light and so on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Model {
    /// Its name in descriptions.
    pub kind: &'static str,
    /// What it is, in a phrase.
    pub doc: &'static str,
    /// What can be set of it alone.
    pub parameters: &'static [Parameter],
    /// What can be set of others, too.
    pub groups: &'static [&'static Group],
    /// Where the equations are from; may be empty.
    pub source: &'static str,
}

impl Model {
    /// All that can be set.
    pub fn all(&self) -> impl Iterator<Item = &'static Parameter> + Clone + use<> {
        self.parameters.iter().chain(self.groups.iter().flat_map(|g| g.parameters))
    }

    /// The parameter of a name.
    pub fn parameter(&self, name: &str) -> Option<&'static Parameter> {
        self.all().find(|p| p.name == name)
    }

    /// Whether there is no parameter of a name; then with the nearest that there is, if any is near.
    pub fn unknown(&self, name: &str) -> Option<Option<String>> {
        self.parameter(name).is_none().then(|| did_you_mean(name, self.all().map(|p| p.name)))
    }
}
