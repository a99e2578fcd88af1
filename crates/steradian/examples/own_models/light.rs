//! A light: a beam along +z of its space, whose intensity is a power of the cosine.

use steradian::schema::{Model, Parameter, Type, light};
use steradian::{Values, core::light::OwnLight, math::Vec3};

pub(crate) static MODEL: Model = Model {
    kind: "my_beam",
    doc: "a beam along +z",
    parameters: &[Parameter::new(Type::Number, "exponent", (0.0, 1e4), "20", "power of the cosine")],
    groups: &[&light::OWN],
    source: "",
};

#[derive(Debug)]
pub(crate) struct Beam(f32);

impl Beam {
    pub(crate) fn new(values: &Values) -> Result<Self, String> {
        Ok(Self(values.number("exponent")? as f32))
    }
}

impl OwnLight for Beam {
    fn share(&self, w: Vec3) -> f32 {
        if w.z > 0.0 { w.z.powf(self.0) } else { 0.0 }
    }
}
