//! A material: a diffuse surface that is brighter at its rim, f = ρ/π (1 − s (cosθ_o + cosθ_i)/2).

use std::f32::consts::FRAC_1_PI;
use steradian::bsdf::{Inputs, OwnScatter, TransportMode};
use steradian::math::{Spectrum, Vec3};
use steradian::schema::{Model, Parameter, Type, material::DETAIL};

/// Kind, parameters with their types, ranges and defaults, and the group of parameters of bumps and normal maps.
pub static MODEL: Model = Model {
    kind: "velvet",
    doc: "a diffuse surface that is brighter at its rim",
    parameters: &[
        Parameter::new(Type::Texture, "reflectance", (0.0, 1.0), "0.5", "colour of the rim"),
        Parameter::new(Type::Scalar, "rim", (0.0, 1.0), "0.5", "share by which the middle is darker"),
    ],
    groups: &[&DETAIL],
    source: "",
};

#[derive(Debug)]
pub struct Velvet;

impl OwnScatter for Velvet {
    /// f·cosθ_i. Colours and numbers are in the order of the parameters. Directions are drawn from a cosine lobe, which
    /// `pdf` and `sample` may replace by one that follows the model.
    fn value(&self, at: &Inputs, wo: Vec3, wi: Vec3, _: TransportMode) -> Spectrum {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return Spectrum::ZERO;
        }
        let (reflectance, rim) = (at.colors[0], at.numbers[0]);
        reflectance * (FRAC_1_PI * (1.0 - rim * 0.5 * (wo.z + wi.z)) * wi.z)
    }

    fn is_diffuse(&self) -> bool {
        true
    }
}
