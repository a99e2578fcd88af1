//! A medium: fog over z = 0, whose density falls by e every so many units.

use steradian::math::{Bounds3, Vec3};
use steradian::schema::{Model, Parameter, Type, medium};
use steradian::{Values, core::medium::OwnMedium};

pub(crate) static MODEL: Model = Model {
    kind: "my_fog",
    doc: "fog that grows thin with height",
    parameters: &[
        Parameter::new(Type::Number, "size", (1e-3, 1e6), "10", "edge of its box over z = 0"),
        Parameter::new(Type::Number, "height", (1e-3, 1e6), "1", "height in which the density falls by e"),
    ],
    groups: &[&medium::OWN],
    source: "",
};

#[derive(Debug)]
pub(crate) struct Fog {
    size: f32,
    height: f32,
}

impl Fog {
    pub(crate) fn new(values: &Values) -> Result<Self, String> {
        Ok(Self { size: values.number("size")? as f32, height: values.number("height")? as f32 })
    }
}

impl OwnMedium for Fog {
    fn bounds(&self) -> Bounds3 {
        let half = self.size / 2.0;
        Bounds3::new(Vec3::new(-half, -half, 0.0), Vec3::new(half, half, self.size))
    }

    fn density(&self, p: Vec3) -> f32 {
        (-p.z / self.height).exp()
    }

    fn most(&self, part: &Bounds3) -> f32 {
        self.density(part.min)
    }
}
