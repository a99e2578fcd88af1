#![doc = include_str!("../README.md")]

pub mod build;
mod carried;
pub mod diagnostic;
pub mod mesh;
pub mod node;
pub mod shared;
pub mod source;

mod desc;
mod lines;

pub use carried::carried;
pub use desc::{Animation, Format, Group, Instance, Movement, SceneDesc, Shape, Unpacked};
pub use diagnostic::{Diagnostic, Diagnostics, Fidelity, Severity};
pub use mesh::{Attribute, Domain, Mesh, MeshFault};
pub use node::{ColorSpace, Node, NodeId, Param, SpectrumValue, Value};
pub use shared::Shared;
pub use source::{FileId, Location, Sources, Span};
pub use steradian_math::Transform;
pub use steradian_schema::{Family, names};
