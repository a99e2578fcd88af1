//! Models of a program's own, by their kinds.

use std::{collections::BTreeMap, fmt, sync::Arc};
use steradian_bsdf::{MOST_INPUTS, OwnScatter};
use steradian_core::{camera::OwnCamera, light::OwnLight, medium::OwnMedium, shape::OwnShape};
use steradian_math::DVec3;
use steradian_schema::{Family, Group, Kinds, Model, Taken, Type, light, medium};
use steradian_texture::OwnTexture;

/// Constructor of a model of a program's own from the values of its parameters; `Err` with the reason where these make
/// none.
pub type Make<T> = Arc<dyn Fn(&Values) -> Result<Arc<T>, String> + Send + Sync>;

/// Models of a program's own. Scene files name them by their kinds as they name those of the schema, whose rules hold
/// for their parameters: types, ranges, defaults. Cheap to copy.
#[derive(Clone, Default)]
pub struct Registry(Arc<Inner>);

#[derive(Clone, Default)]
struct Inner {
    kinds: Kinds,
    materials: BTreeMap<&'static str, Arc<dyn OwnScatter>>,
    textures: BTreeMap<&'static str, Make<dyn OwnTexture>>,
    shapes: BTreeMap<&'static str, Make<dyn OwnShape>>,
    lights: BTreeMap<&'static str, Make<dyn OwnLight>>,
    media: BTreeMap<&'static str, Make<dyn OwnMedium>>,
    cameras: BTreeMap<&'static str, Make<dyn OwnCamera>>,
}

/// Reason why a model cannot be added to a [`Registry`].
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RegistryError {
    /// Its kind is there already.
    #[error("{0}")]
    Taken(#[from] Taken),
    /// A parameter has a type that models of the family cannot have.
    #[error("parameter '{parameter}' of {} '{kind}' cannot be a {type_}: {help}", .family.noun())]
    Parameter {
        /// The family.
        family: Family,
        /// The kind.
        kind: &'static str,
        /// The parameter.
        parameter: &'static str,
        /// Its type in words.
        type_: String,
        /// Types that it can have.
        help: &'static str,
    },
    /// A group of parameters that it needs is not among its groups.
    #[error("{} '{kind}' needs the group '{group}' among its groups", .family.noun())]
    Group {
        /// The family.
        family: Family,
        /// The kind.
        kind: &'static str,
        /// The group.
        group: &'static str,
    },
}

/// Values of the parameters of a model's own, by their names. Parameters that are absent have their defaults.
#[derive(Clone, Debug, Default)]
pub struct Values(pub(super) BTreeMap<&'static str, OwnParameter>);

/// Value of a parameter.
#[derive(Clone, Debug, PartialEq)]
pub enum OwnParameter {
    /// A number; whole numbers, too.
    Number(f64),
    /// Three numbers.
    Vector(DVec3),
    /// True or false.
    Flag(bool),
    /// A word, or text.
    Word(String),
    /// Some numbers.
    List(Vec<f32>),
}

macro_rules! values {
    ($($(#[$doc:meta])* $name:ident: $type:ty = $variant:ident($v:ident) => $value:expr;)*) => {
        impl Values {
            $($(#[$doc])*
            ///
            /// # Errors
            /// A message where the model has no such parameter.
            pub fn $name(&self, name: &str) -> Result<$type, String> {
                match self.0.get(name) {
                    Some(OwnParameter::$variant($v)) => Ok($value),
                    _ => Err(format!("its model has no parameter '{name}' of this type ({})", stringify!($name))),
                }
            })*
        }
    };
}

values! {
    /// A number.
    number: f64 = Number(v) => *v;
    /// Three numbers.
    vector: DVec3 = Vector(v) => *v;
    /// True or false.
    flag: bool = Flag(v) => *v;
    /// A word, or text.
    word: &str = Word(v) => v;
    /// Some numbers; none where the parameter is absent.
    list: &[f32] = List(v) => v;
}

/// Types of parameters that are the same everywhere.
const OF_VALUES: &str = "models of one's own take numbers, whole numbers, flags, words, text, vectors and lists";
/// Types of parameters of materials.
const OF_MATERIALS: &str = "materials of one's own take at most four textures of colour (Type::Texture), four of \
                            numbers (Type::Scalar), one word and one vector";

macro_rules! families {
    ($($(#[$doc:meta])* $name:ident, $find:ident: $field:ident, $family:ident, $type:ident, $group:expr;)*) => {
        impl Registry {
            $($(#[$doc])*
            ///
            /// # Errors
            /// [`RegistryError`] where the kind is there already, or the model has parameters of a type that it cannot
            /// have.
            pub fn $name<T: $type + 'static>(
                mut self,
                model: &'static Model,
                make: impl Fn(&Values) -> Result<T, String> + Send + Sync + 'static,
            ) -> Result<Self, RegistryError> {
                self.admit(Family::$family, model, $group)?;
                let make: Make<dyn $type> = Arc::new(move |values| Ok(Arc::new(make(values)?)));
                Arc::make_mut(&mut self.0).$field.insert(model.kind, make);
                Ok(self)
            }

            pub(super) fn $find(&self, kind: &str) -> Option<&Make<dyn $type>> {
                self.0.$field.get(kind)
            }
            )*
        }
    };
}

families! {
    /// Adds a texture; with the group `texture::MAPPING` among its model's groups it has a mapping.
    texture, own_texture: textures, Texture, OwnTexture, None;
    /// Adds a shape.
    shape, own_shape: shapes, Shape, OwnShape, None;
    /// Adds a light at a point; its model has the group `light::OWN`.
    light, own_light: lights, Light, OwnLight, Some(&light::OWN);
    /// Adds a medium; its model has the group `medium::OWN`.
    medium, own_medium: media, Medium, OwnMedium, Some(&medium::OWN);
    /// Adds a camera.
    camera, own_camera: cameras, Camera, OwnCamera, None;
}

impl Registry {
    /// Adds a material. Its textures are evaluated at each hit: colours in the order of the model's parameters become
    /// `Inputs::colors`, numbers `Inputs::numbers`, the number of a word `Inputs::choice`, a vector `Inputs::vector`.
    /// With the group `material::DETAIL` among the model's groups it takes bumps and normal maps.
    ///
    /// # Errors
    /// [`RegistryError`] where the kind is there already, or the model has other parameters.
    pub fn material(
        mut self,
        model: &'static Model,
        scatter: impl OwnScatter + 'static,
    ) -> Result<Self, RegistryError> {
        let mut left = [MOST_INPUTS, MOST_INPUTS, 1, 1];
        for p in model.parameters {
            let number = match p.kind {
                Type::Texture => Some(0),
                Type::Scalar => Some(1),
                Type::Word(_) => Some(2),
                Type::Vector => Some(3),
                _ => None,
            };
            match number.map(|n| &mut left[n]) {
                Some(left) if *left > 0 => *left -= 1,
                _ => {
                    let (kind, parameter, type_) = (model.kind, p.name, p.values());
                    let family = Family::Material;
                    return Err(RegistryError::Parameter { family, kind, parameter, type_, help: OF_MATERIALS });
                }
            }
        }
        let inner = Arc::make_mut(&mut self.0);
        inner.kinds.add(Family::Material, model)?;
        inner.materials.insert(model.kind, Arc::new(scatter));
        Ok(self)
    }

    /// Adds an integrator's model, so that scenes may name it.
    ///
    /// # Errors
    /// [`RegistryError`] where the kind is there already.
    pub fn integrator(mut self, model: &'static Model) -> Result<Self, RegistryError> {
        Arc::make_mut(&mut self.0).kinds.add(Family::Integrator, model)?;
        Ok(self)
    }

    fn admit(&mut self, family: Family, model: &'static Model, group: Option<&Group>) -> Result<(), RegistryError> {
        use Type::{Flag, Integer, List, Number, Text, Vector, Word};
        let kind = model.kind;
        let is_value = |p: Type| matches!(p, Number | Integer | Flag | Word(_) | Text | Vector | List);
        if let Some(p) = model.parameters.iter().find(|p| !is_value(p.kind)) {
            let (parameter, type_) = (p.name, p.values());
            return Err(RegistryError::Parameter { family, kind, parameter, type_, help: OF_VALUES });
        }
        if let Some(group) = group.filter(|group| !model.groups.iter().any(|g| g.name == group.name)) {
            return Err(RegistryError::Group { family, kind, group: group.name });
        }
        Ok(Arc::make_mut(&mut self.0).kinds.add(family, model)?)
    }

    /// All kinds, for readers of scene files.
    pub fn kinds(&self) -> &Kinds {
        &self.0.kinds
    }

    pub(super) fn own_material(&self, kind: &str) -> Option<&Arc<dyn OwnScatter>> {
        self.0.materials.get(kind)
    }

    /// Memory address of its models, which tells registries apart; 0 for all empty ones.
    pub(super) fn address(&self) -> usize {
        if self.is_empty() { 0 } else { Arc::as_ptr(&self.0).addr() }
    }

    fn is_empty(&self) -> bool {
        self.0.kinds == Kinds::default()
    }
}

impl PartialEq for Registry {
    /// True for copies of one registry, and for empty ones.
    fn eq(&self, other: &Self) -> bool {
        self.address() == other.address()
    }
}

impl fmt::Debug for Registry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // The address tells registries apart whose models have the same names.
        f.debug_tuple("Registry").field(&self.address()).field(&self.0.kinds).finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Options;

    /// Options without models of one's own are the same, so that what was compiled with them is kept.
    #[test]
    fn empty_registries_are_one() {
        let (a, b) = (Options::default(), Options::default());
        assert_eq!((a.registry.address(), &a), (b.registry.address(), &b));
        static OURS: Model = Model { kind: "ours", doc: "", parameters: &[], groups: &[], source: "" };
        let ours = || Registry::default().integrator(&OURS).expect("a kind of its own");
        let (one, other) = (ours(), ours());
        assert!(one == one.clone() && one != other && one != a.registry);
    }
}
