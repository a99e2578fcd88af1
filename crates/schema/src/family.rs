//! The families of models.

use crate::{
    camera, film, integrator, light, material, medium,
    model::{Group, Model},
    parameter::Parameter,
    shape, texture,
};
use serde::{Deserialize, Serialize};

/// Subject of a node; with the kind it names a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[expect(missing_docs, reason = "the names are those of the families")]
pub enum Family {
    Shape,
    Material,
    Texture,
    Light,
    Medium,
    Phase,
    Camera,
    Film,
    Filter,
    Sampler,
    Integrator,
    Accelerator,
}

/// All families.
pub const FAMILIES: [Family; 12] = {
    use Family::*;
    [Shape, Material, Texture, Light, Medium, Phase, Camera, Film, Filter, Sampler, Integrator, Accelerator]
};

impl Family {
    /// The word for it in messages.
    pub fn noun(self) -> &'static str {
        match self {
            Self::Shape => "shape",
            Self::Material => "material",
            Self::Texture => "texture",
            Self::Light => "light",
            Self::Medium => "medium",
            Self::Phase => "phase function",
            Self::Camera => "camera",
            Self::Film => "film",
            Self::Filter => "pixel filter",
            Self::Sampler => "sampler",
            Self::Integrator => "integrator",
            Self::Accelerator => "accelerator",
        }
    }

    /// Its models; none for families that are listed elsewhere.
    pub fn models(self) -> &'static [Model] {
        match self {
            Self::Shape => shape::SHAPES,
            Self::Material => material::MATERIALS,
            Self::Texture => texture::TEXTURES,
            Self::Light => light::LIGHTS,
            Self::Medium => medium::MEDIA,
            Self::Phase => medium::PHASES,
            Self::Camera => camera::CAMERAS,
            Self::Film => film::FILMS,
            Self::Filter => film::FILTERS,
            Self::Sampler => film::SAMPLERS,
            Self::Integrator => integrator::INTEGRATORS,
            Self::Accelerator => &[],
        }
    }

    /// Parameters of all its kinds, those that Steradian lacks with them.
    pub fn common(self) -> Option<&'static Group> {
        match self {
            Self::Shape => Some(&shape::ANY_SHAPE),
            Self::Material => Some(&material::DETAIL),
            Self::Camera => Some(&camera::ANY_CAMERA),
            _ => None,
        }
    }

    /// The model of a kind.
    pub fn model(self, kind: &str) -> Option<&'static Model> {
        self.models().iter().find(|m| m.kind == kind)
    }

    /// Parameters of a kind, with those of its groups and family; `None` for kinds that the tables do not describe.
    pub fn parameters(self, kind: &str) -> Option<impl Iterator<Item = &'static Parameter> + Clone + use<>> {
        Some(self.parameters_of(self.model(kind)?))
    }

    /// Parameters of a model of the family, with those of its groups and of the family.
    pub(crate) fn parameters_of(
        self,
        model: &'static Model,
    ) -> impl Iterator<Item = &'static Parameter> + Clone + use<> {
        let common = self.common().into_iter().flat_map(|group| group.parameters);
        model.all().chain(common.filter(|p| model.parameter(p.name).is_none()))
    }

    /// The parameter of a name; for kinds that the tables do not describe, that of the first kind which has it.
    pub fn parameter(self, kind: &str, name: &str) -> Option<&'static Parameter> {
        match self.model(kind) {
            Some(model) => model.parameter(name),
            None => self.models().iter().find_map(|m| m.parameter(name)),
        }
    }

    /// The names of its models.
    pub fn kinds(self) -> impl Iterator<Item = &'static str> + Clone {
        self.models().iter().map(|m| m.kind)
    }

    /// Plural noun of the family, as `steradian list` takes it.
    pub fn plural(self) -> &'static str {
        match self {
            Self::Shape => "shapes",
            Self::Material => "materials",
            Self::Texture => "textures",
            Self::Light => "lights",
            Self::Medium => "media",
            Self::Phase => "phases",
            Self::Camera => "cameras",
            Self::Film => "films",
            Self::Filter => "filters",
            Self::Sampler => "samplers",
            Self::Integrator => "integrators",
            Self::Accelerator => "accelerators",
        }
    }

    /// The groups of parameters that its models share, in the order in which these name them.
    pub fn groups(self) -> Vec<&'static Group> {
        let mut groups: Vec<&'static Group> = Vec::new();
        for group in self.models().iter().flat_map(|m| m.groups) {
            if !groups.iter().any(|g| std::ptr::eq(*g, *group)) {
                groups.push(group);
            }
        }
        groups
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Condition, Type};
    use std::collections::HashSet;

    /// Names are unique, everything is explained, and every default is what it says: a value of the parameter's type
    /// and within its range, or another parameter.
    #[test]
    fn names_are_unique_and_everything_is_explained() {
        for family in FAMILIES {
            let mut kinds: HashSet<_> = family.groups().into_iter().map(|g| g.name).collect();
            assert_eq!(kinds.len(), family.groups().len(), "groups of {}", family.plural());
            for m in family.models() {
                assert!(kinds.insert(m.kind) && !m.doc.is_empty(), "{}", m.kind);
                let mut names = HashSet::new();
                for p in m.all() {
                    let at = format!("{} '{}': {}", family.noun(), m.kind, p.name);
                    assert!(names.insert(p.name) && !p.doc.is_empty() && !p.default.is_empty(), "{at}");
                    assert!(p.range.0 < p.range.1, "{at}");
                    if let Condition::Given(name) | Condition::Is(name, _) = p.condition {
                        assert!(m.parameter(name).is_some(), "{at} counts with '{name}', which is not there");
                    }
                    let default = p.usual_default();
                    let is_other = ["none", "needed"].contains(&default) || m.parameter(default).is_some();
                    let is_value = match p.kind {
                        Type::Flag => default.parse::<bool>().is_ok(),
                        Type::Word(_) | Type::WordOrNumber(_) => p.words().any(|w| w == default),
                        // A number, or one for each colour.
                        kind if kind.is_numeric() => default
                            .split(", ")
                            .all(|v| v.parse::<f64>().is_ok_and(|v| (p.range.0..=p.range.1).contains(&v))),
                        _ => true,
                    };
                    assert!(is_other || is_value || default.ends_with("'s"), "{at}: default '{default}'");
                }
            }
        }
    }

    #[test]
    fn defaults_have_types() {
        let row = |family: Family, kind, name| family.parameter(kind, name).expect("a parameter");
        assert_eq!(row(Family::Material, "grating", "period").default_number(), Some(1600.0));
        assert_eq!(row(Family::Material, "grating", "transmission").default_flag(), Some(false));
        assert_eq!(row(Family::Material, "lafortune", "coefficients").default_numbers(), Some([-1.0, -1.0, 1.0]));
        assert_eq!(
            row(Family::Material, "openpbr", "subsurface_radius_scale").default_numbers(),
            Some([1.0, 0.5, 0.25])
        );
        assert_eq!(row(Family::Light, "point", "position").default_numbers::<2>(), None);
        assert_eq!(row(Family::Light, "point", "power").default_number(), None);
        // Of a kind that is not there, the first one that has it counts.
        assert_eq!(row(Family::Film, "unheard-of", "iso").default_number(), Some(100.0));
        assert!(Family::Film.parameter("rgb", "sigma").is_none());
    }
}
