//! Kinds of a program's own, beside those of the schema.

use crate::{Family, Model, Parameter, names::did_you_mean};
use std::sync::Arc;

/// Models that a program has beside those of the schema, by family and kind. Cheap to copy.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Kinds(Arc<Vec<(Family, &'static Model)>>);

/// Reason why a model cannot be added.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Taken {
    /// The family.
    pub family: Family,
    /// The kind, which there is already.
    pub kind: &'static str,
}

impl std::fmt::Display for Taken {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "the {} '{}' is there already", self.family.noun(), self.kind)
    }
}

impl std::error::Error for Taken {}

impl Kinds {
    /// Adds a model.
    ///
    /// # Errors
    /// [`Taken`] where its kind is one of the schema or was added before.
    pub fn add(&mut self, family: Family, model: &'static Model) -> Result<(), Taken> {
        if self.model(family, model.kind).is_some() {
            return Err(Taken { family, kind: model.kind });
        }
        Arc::make_mut(&mut self.0).push((family, model));
        Ok(())
    }

    /// Models of the program's own.
    pub fn own(&self, family: Family) -> impl Iterator<Item = &'static Model> + Clone {
        self.0.iter().filter(move |own| own.0 == family).map(|own| own.1)
    }

    /// The model of a kind: of the schema, or of the program's own.
    pub fn model(&self, family: Family, kind: &str) -> Option<&'static Model> {
        family.model(kind).or_else(|| self.own(family).find(|m| m.kind == kind))
    }

    /// Parameters of a kind, with those of its groups and family; `None` for kinds that are not there.
    pub fn parameters(
        &self,
        family: Family,
        kind: &str,
    ) -> Option<impl Iterator<Item = &'static Parameter> + Clone + use<>> {
        Some(family.parameters_of(self.model(family, kind)?))
    }

    /// The parameter of a kind; for kinds that are not there, that of the first kind of the schema which has it.
    pub fn parameter(&self, family: Family, kind: &str, name: &str) -> Option<&'static Parameter> {
        match self.own(family).find(|m| m.kind == kind) {
            // What is common to a family has the defaults of its other kinds.
            Some(model) => family.parameters_of(model).find(|p| p.name == name).or_else(|| family.parameter("", name)),
            None => family.parameter(kind, name),
        }
    }

    /// Looks for a parameter that does not exist, as [`Model::unknown`]; `None` for kinds that are not there, too.
    /// Models of the program's own have the parameters that are common to their family.
    pub fn unknown(&self, family: Family, kind: &str, name: &str) -> Option<Option<String>> {
        if let Some(model) = family.model(kind) {
            return model.unknown(name);
        }
        let mut known = self.parameters(family, kind)?;
        let is_known = known.clone().any(|p| p.name == name);
        (!is_known).then(|| did_you_mean(name, known.by_ref().map(|p| p.name)))
    }

    /// The names of all kinds of a family.
    pub fn names(&self, family: Family) -> impl Iterator<Item = &'static str> + Clone {
        family.kinds().chain(self.own(family).map(|m| m.kind))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Type;

    static VELVET: Model = Model {
        kind: "velvet",
        doc: "cloth",
        parameters: &[Parameter::new(Type::Scalar, "sheen", (0.0, 1.0), "0.5", "strength")],
        groups: &[],
        source: "",
    };

    #[test]
    fn own_kinds_are_beside_those_of_the_schema() {
        let mut kinds = Kinds::default();
        assert_eq!(kinds.model(Family::Material, "velvet"), None);
        kinds.add(Family::Material, &VELVET).unwrap();
        assert_eq!(kinds.model(Family::Material, "velvet"), Some(&VELVET));
        assert_eq!(kinds.model(Family::Texture, "velvet"), None);
        assert!(kinds.model(Family::Material, "diffuse").is_some());
        assert_eq!(kinds.parameter(Family::Material, "velvet", "sheen").and_then(Parameter::default_number), Some(0.5));
        assert!(kinds.parameter(Family::Material, "velvet", "bump").is_some());
        assert!(kinds.parameter(Family::Material, "diffuse", "reflectance").is_some());
        assert_eq!(kinds.names(Family::Material).last(), Some("velvet"));
        let unknown = |name| kinds.unknown(Family::Material, "velvet", name);
        assert_eq!((unknown("sheen"), unknown("bump")), (None, None));
        assert_eq!(unknown("shen"), Some(Some("did you mean 'sheen'?".into())));
    }

    #[test]
    fn a_kind_is_there_once() {
        let mut kinds = Kinds::default();
        kinds.add(Family::Material, &VELVET).unwrap();
        let taken = kinds.add(Family::Material, &VELVET).unwrap_err();
        assert_eq!(taken.to_string(), "the material 'velvet' is there already");
        static DIFFUSE: Model = Model { kind: "diffuse", ..VELVET };
        assert!(kinds.add(Family::Material, &DIFFUSE).is_err() && kinds.add(Family::Texture, &DIFFUSE).is_ok());
    }
}
