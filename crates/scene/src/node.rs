//! The nodes of a description: a kind with named values.

use crate::source::Span;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use steradian_math::Transform;
use steradian_schema::Family;

/// Index of a node in [`crate::SceneDesc::nodes`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct NodeId(pub u32);

/// RGB colour spaces that scene files name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum ColorSpace {
    /// Rec.709 primaries, D65.
    #[default]
    Srgb,
    /// DCI-P3 primaries, D65.
    DciP3,
    /// Rec.2020 primaries, D65.
    Rec2020,
    /// ACES2065-1 (AP0, D60).
    Aces,
}

/// A spectral quantity. Whether it is a reflectance, an emission or unbounded is known by the parameter that holds it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum SpectrumValue {
    /// One value at every wavelength.
    Constant(f64),
    /// Linear components in a colour space.
    Rgb([f64; 3], ColorSpace),
    /// Piecewise linear over increasing wavelengths in nm.
    Sampled {
        /// Wavelengths, nm, strictly increasing.
        lambdas: Vec<f32>,
        /// Values, as many.
        values: Vec<f32>,
    },
    /// Planck's law at a temperature in kelvin, scaled to a maximum of one (pbrt's `blackbody`).
    Blackbody(f64),
    /// A measured spectrum known by name, in pbrt's spelling (`metal-Ag-eta`, `glass-BK7`, `stdillum-D65`).
    Named(String),
}

/// The value of a parameter.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "names say what they are")]
pub enum Value {
    Bool(bool),
    Int(i64),
    Float(f64),
    String(String),
    /// A file, resolved against the scene's search path.
    Path(PathBuf),
    Vec3([f64; 3]),
    Floats(Vec<f64>),
    Ints(Vec<i64>),
    Transform(Transform),
    Spectrum(SpectrumValue),
    /// A reference to another node: a texture, a nested material, a medium.
    Node(NodeId),
    Nodes(Vec<NodeId>),
}

/// A named value.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Param {
    /// In Steradian's vocabulary.
    pub name: String,
    /// Its value.
    pub value: Value,
    /// Source span in the file.
    pub span: Option<Span>,
}

/// One thing of the description.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Node {
    /// Family of the node.
    pub family: Family,
    /// Which model, in Steradian's vocabulary (or the file's own word for models Steradian lacks).
    pub kind: String,
    /// The name the file gave it.
    pub name: Option<String>,
    /// Parameters that are set; all others have the default of their table in the schema.
    pub params: Vec<Param>,
    /// Source span of its declaration in the file.
    pub span: Option<Span>,
}

impl Node {
    /// A node without parameters.
    pub fn new(family: Family, kind: impl Into<String>, span: Option<Span>) -> Self {
        Self { family, kind: kind.into(), name: None, params: Vec::new(), span }
    }

    /// Sets a parameter, replacing an earlier value.
    pub fn set(&mut self, name: impl Into<String>, value: impl Into<Value>, span: Option<Span>) -> &mut Self {
        let name = name.into();
        self.params.retain(|p| p.name != name);
        self.params.push(Param { name, value: value.into(), span });
        self
    }

    /// Sets a parameter, for building a node in one expression.
    #[must_use]
    pub fn with(mut self, name: impl Into<String>, value: impl Into<Value>) -> Self {
        self.set(name, value, None);
        self
    }

    /// The parameter of that name.
    pub fn param(&self, name: &str) -> Option<&Param> {
        self.params.iter().find(|p| p.name == name)
    }

    /// The value of that name.
    pub fn get(&self, name: &str) -> Option<&Value> {
        self.param(name).map(|p| &p.value)
    }

    /// A number (integers count), or `None` if absent or of another type.
    pub fn float(&self, name: &str) -> Option<f64> {
        match self.get(name)? {
            Value::Float(v) | Value::Spectrum(SpectrumValue::Constant(v)) => Some(*v),
            Value::Int(v) => Some(*v as f64),
            _ => None,
        }
    }

    /// An integer, or `None` if absent or of another type.
    pub fn int(&self, name: &str) -> Option<i64> {
        match self.get(name)? {
            Value::Int(v) => Some(*v),
            Value::Float(v) if v.fract() == 0.0 && v.abs() < 9e15 => Some(*v as i64),
            _ => None,
        }
    }

    /// A truth value, or `None` if absent or of another type.
    pub fn bool(&self, name: &str) -> Option<bool> {
        match self.get(name)? {
            Value::Bool(v) => Some(*v),
            _ => None,
        }
    }

    /// A string, or `None` if absent or of another type.
    pub fn string(&self, name: &str) -> Option<&str> {
        match self.get(name)? {
            Value::String(v) => Some(v),
            _ => None,
        }
    }

    /// A file, or `None` if absent or of another type.
    pub fn path(&self, name: &str) -> Option<&Path> {
        match self.get(name)? {
            Value::Path(v) => Some(v),
            _ => None,
        }
    }

    /// Three numbers, or `None` if absent or of another type.
    pub fn vec3(&self, name: &str) -> Option<[f64; 3]> {
        match self.get(name)? {
            Value::Vec3(v) => Some(*v),
            _ => None,
        }
    }

    /// A list of numbers, or `None` if absent or of another type; three are a vector, too.
    pub fn floats(&self, name: &str) -> Option<&[f64]> {
        match self.get(name)? {
            Value::Floats(v) => Some(v),
            Value::Vec3(v) => Some(v),
            _ => None,
        }
    }

    /// A transform, or `None` if absent or of another type.
    pub fn transform(&self, name: &str) -> Option<Transform> {
        match self.get(name)? {
            Value::Transform(v) => Some(*v),
            _ => None,
        }
    }

    /// A reference, or `None` if absent or of another type.
    pub fn node(&self, name: &str) -> Option<NodeId> {
        match self.get(name)? {
            Value::Node(v) => Some(*v),
            _ => None,
        }
    }
}

macro_rules! value_from {
    ($($variant:ident: $t:ty),* $(,)?) => {$(
        impl From<$t> for Value {
            fn from(v: $t) -> Self {
                Self::$variant(v)
            }
        }
    )*};
}
value_from!(Bool: bool, Int: i64, Float: f64, String: String, Path: PathBuf, Vec3: [f64; 3], Floats: Vec<f64>, Ints: Vec<i64>,
    Transform: Transform, Spectrum: SpectrumValue, Node: NodeId, Nodes: Vec<NodeId>);

impl From<&str> for Value {
    fn from(v: &str) -> Self {
        Self::String(v.into())
    }
}
