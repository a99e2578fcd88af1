//! A shape: a torus around z, met by steps of its distance (Hart, "Sphere tracing", 1996).

use steradian::Values;
use steradian::core::shape::OwnShape;
use steradian::math::DVec3;
use steradian::schema::{Model, Parameter, Type};

pub(crate) static MODEL: Model = Model {
    kind: "my_torus",
    doc: "a torus around z",
    parameters: &[
        Parameter::new(Type::Number, "radius", (0.0, 1e6), "1", "radius of the circle in its middle"),
        Parameter::new(Type::Number, "tube", (0.0, 1e6), "0.25", "radius of the tube"),
    ],
    groups: &[],
    source: "",
};

#[derive(Debug)]
pub(crate) struct Torus {
    radius: f64,
    tube: f64,
}

impl Torus {
    pub(crate) fn new(values: &Values) -> Result<Self, String> {
        let (radius, tube) = (values.number("radius")?, values.number("tube")?);
        match tube > 0.0 && tube < radius {
            true => Ok(Self { radius, tube }),
            false => Err(format!("its tube, {tube}, is to be above 0 and below its radius, {radius}")),
        }
    }

    fn off_circle(&self, p: DVec3) -> DVec3 {
        p - DVec3::new(p.x, p.y, 0.0).normalize_or(DVec3::X) * self.radius
    }
}

impl OwnShape for Torus {
    fn corners(&self) -> [DVec3; 2] {
        let half = DVec3::new(self.radius + self.tube, self.radius + self.tube, self.tube);
        [-half, half]
    }

    fn sample(&self, p: DVec3) -> (f64, DVec3) {
        let off_circle = self.off_circle(p);
        (off_circle.length() - self.tube, off_circle.normalize_or_zero())
    }

    fn first(&self, origin: DVec3, direction: DVec3, [mut t, end]: [f64; 2]) -> Option<f64> {
        let (length, side) = (direction.length(), (self.sample(origin + direction * t).0).signum());
        for _ in 0..10_000 {
            let distance = self.sample(origin + direction * t).0 * side;
            if t > end || distance < 1e-9 * self.radius {
                return (t <= end).then_some(t);
            }
            t += distance / length;
        }
        None
    }
}
