//! The scene file as a graph of objects with typed properties, before any meaning is given to them.

use std::collections::HashMap;
use steradian_scene::{Span, SpectrumValue, Transform};

/// Category of the object that an XML element declares.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Category {
    Scene,
    Integrator,
    Sensor,
    Sampler,
    Film,
    Filter,
    Emitter,
    Shape,
    Bsdf,
    Texture,
    Volume,
    Medium,
    Phase,
}

impl Category {
    /// The category an element name stands for.
    pub fn from_tag(tag: &str) -> Option<Self> {
        Some(match tag {
            "scene" => Self::Scene,
            "integrator" => Self::Integrator,
            "sensor" | "camera" => Self::Sensor,
            "sampler" => Self::Sampler,
            "film" => Self::Film,
            "rfilter" => Self::Filter,
            "emitter" | "luminaire" => Self::Emitter,
            "shape" => Self::Shape,
            "bsdf" => Self::Bsdf,
            "texture" => Self::Texture,
            "volume" => Self::Volume,
            "medium" => Self::Medium,
            "phase" => Self::Phase,
            _ => return None,
        })
    }

    /// The word for it in messages.
    pub fn noun(self) -> &'static str {
        match self {
            Self::Scene => "scene",
            Self::Integrator => "integrator",
            Self::Sensor => "sensor",
            Self::Sampler => "sampler",
            Self::Film => "film",
            Self::Filter => "reconstruction filter",
            Self::Emitter => "emitter",
            Self::Shape => "shape",
            Self::Bsdf => "BSDF",
            Self::Texture => "texture",
            Self::Volume => "volume",
            Self::Medium => "medium",
            Self::Phase => "phase function",
        }
    }
}

/// Index of an object in [`Graph::objects`].
pub(super) type ObjectId = usize;

/// The value of a property as the file states it.
#[derive(Clone, Debug)]
pub(super) enum Raw {
    Bool(bool),
    Int(i64),
    Float(f64),
    String(String),
    Vec3([f64; 3]),
    Rgb([f64; 3]),
    Spectrum(SpectrumValue),
    Transform(Transform),
    Object(ObjectId),
    /// A reference by id, until [`super::Reader::resolve`] replaces it.
    Ref(String),
}

impl Raw {
    /// The word for its type in messages.
    pub fn noun(&self) -> &'static str {
        match self {
            Self::Bool(_) => "a boolean",
            Self::Int(_) => "an integer",
            Self::Float(_) => "a float",
            Self::String(_) => "a string",
            Self::Vec3(_) => "a vector",
            Self::Rgb(_) => "a colour",
            Self::Spectrum(_) => "a spectrum",
            Self::Transform(_) => "a transform",
            Self::Object(_) | Self::Ref(_) => "an object",
        }
    }
}

/// One property of an object.
#[derive(Clone, Debug)]
pub(super) struct Prop {
    /// Empty for nested objects that the file leaves unnamed.
    pub name: String,
    pub value: Raw,
    /// Source span of the property as a whole (its name).
    pub span: Span,
    /// Source span of its value.
    pub value_span: Span,
    /// Set once a translator asks for it.
    pub used: bool,
}

/// One object (a plugin instance) of the file.
#[derive(Debug)]
pub(super) struct Object {
    pub category: Category,
    /// The `type` attribute.
    pub plugin: String,
    pub id: Option<String>,
    /// Source span: the `type` attribute's value, else the element's name.
    pub span: Span,
    /// True if the file is of a version before 2.
    pub legacy: bool,
    pub props: Vec<Prop>,
    /// Set once a translator reads it; properties never asked for then count as unused.
    pub visited: bool,
    /// Names that a translator asked for: what a misspelt name may have meant.
    pub asked: Vec<&'static str>,
}

/// All objects of a scene and its includes. The first is the scene itself.
#[derive(Debug, Default)]
pub(super) struct Graph {
    pub objects: Vec<Object>,
    pub ids: HashMap<String, ObjectId>,
}

impl Graph {
    /// A property in messages: by its name, or by what it is where the file leaves it unnamed.
    pub fn called(&self, prop: &Prop) -> String {
        match prop.value {
            Raw::Object(child) if prop.name.is_empty() => {
                let child = &self.objects[child];
                format!("the nested {} '{}'", child.category.noun(), child.plugin)
            }
            _ if prop.name.is_empty() => "this object".into(),
            _ => format!("'{}'", prop.name),
        }
    }

    /// The property of this name; it counts as used from now on.
    pub fn take(&mut self, object: ObjectId, name: &'static str) -> Option<Prop> {
        let object = &mut self.objects[object];
        #[cfg(test)]
        crate::law::note(format!("{} {}", object.category.noun(), object.plugin), name, Vec::new());
        object.visited = true;
        if !object.asked.contains(&name) {
            object.asked.push(name);
        }
        let prop = object.props.iter_mut().find(|p| p.name == name)?;
        prop.used = true;
        Some(prop.clone())
    }

    /// Tests for a property of that name, without marking it as used.
    pub fn has(&self, object: ObjectId, name: &str) -> bool {
        self.objects[object].props.iter().any(|p| p.name == name)
    }

    /// The nested objects of a category in file order with their property names; they count as used from now on.
    pub fn children(&mut self, object: ObjectId, category: Category) -> Vec<(String, ObjectId)> {
        let categories: Vec<Option<Category>> = self.objects[object]
            .props
            .iter()
            .map(|p| match p.value {
                Raw::Object(child) => self.objects.get(child).map(|c| c.category),
                _ => None,
            })
            .collect();
        let object = &mut self.objects[object];
        object.visited = true;
        let of_category = object.props.iter_mut().zip(categories).filter(|(_, c)| *c == Some(category));
        of_category
            .filter_map(|(p, _)| {
                p.used = true;
                match p.value {
                    Raw::Object(child) => Some((p.name.clone(), child)),
                    _ => None,
                }
            })
            .collect()
    }
}
