//! A texture: rings about the origin of its space, the value a sine of the distance.

use steradian::schema::{Model, Parameter, Type, texture::MAPPING};
use steradian::texture::{OwnTexture, OwnValue, own::OwnPoint};
use steradian::{Values, math::Vec3};

pub(crate) static MODEL: Model = Model {
    kind: "my_rings",
    doc: "rings about the origin",
    parameters: &[
        Parameter::new(Type::Number, "rings", (0.0, 1e4), "4", "rings per unit"),
        Parameter::new(Type::Word("grey, warm"), "palette", (0.0, 1.0), "grey", "colours of the rings"),
    ],
    groups: &[&MAPPING],
    source: "",
};

#[derive(Debug)]
pub(crate) struct Rings {
    rings: f32,
    is_warm: bool,
}

impl Rings {
    pub(crate) fn new(values: &Values) -> Result<Self, String> {
        Ok(Self { rings: values.number("rings")? as f32, is_warm: values.word("palette")? == "warm" })
    }
}

impl OwnTexture for Rings {
    fn value(&self, at: &OwnPoint<'_>) -> OwnValue {
        let wave = 0.5 + 0.5 * (std::f32::consts::TAU * self.rings * at.p.length()).sin();
        match self.is_warm {
            true => OwnValue::Rgb(Vec3::new(0.7, 0.2, 0.1).lerp(Vec3::new(0.9, 0.8, 0.6), wave)),
            false => OwnValue::Number(wave),
        }
    }
}
