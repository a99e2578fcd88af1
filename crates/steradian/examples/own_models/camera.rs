//! A camera: an equidistant fisheye, whose angle from the axis grows with the distance from the middle of the frame.

use steradian::math::{Vec2, Vec3};
use steradian::schema::{Model, Parameter, Type};
use steradian::{Values, core::camera::OwnCamera};

pub(crate) static MODEL: Model = Model {
    kind: "my_fisheye",
    doc: "an equidistant fisheye over the width and the height of the frame",
    parameters: &[Parameter::new(Type::Number, "angle", (1.0, 360.0), "180", "from edge to edge").unit("degrees")],
    groups: &[],
    source: "",
};

#[derive(Debug)]
pub(crate) struct Fisheye {
    half: f32,
}

impl Fisheye {
    pub(crate) fn new(values: &Values) -> Result<Self, String> {
        Ok(Self { half: values.number("angle")?.to_radians() as f32 / 2.0 })
    }
}

impl OwnCamera for Fisheye {
    fn ray(&self, film: Vec2, _lens: Vec2) -> (Vec3, Vec3) {
        let from_middle = Vec2::new(film.x - 0.5, 0.5 - film.y) * 2.0;
        let (sin, cos) = (from_middle.length() * self.half).sin_cos();
        let across = from_middle.normalize_or_zero() * sin;
        (Vec3::ZERO, Vec3::new(across.x, across.y, cos))
    }
}
