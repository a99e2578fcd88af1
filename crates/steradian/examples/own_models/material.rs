//! A material: a cosine lobe about the mirror direction over a diffuse part, f = ρ_d/π + ρ_s (n + 2)/2π cosⁿα
//! (Lafortune and Willems, "Using the modified Phong reflectance model for physically based rendering", 1994).

use std::f32::consts::{FRAC_1_PI, TAU};
use steradian::bsdf::{Draw, Inputs, OwnScatter, TransportMode};
use steradian::math::{Frame, Spectrum, Vec2, Vec3, warp::cosine_hemisphere};
use steradian::schema::{Model, Parameter, Type, material::DETAIL};

pub(crate) static MODEL: Model = Model {
    kind: "my_glossy",
    doc: "a cosine lobe over a diffuse part",
    parameters: &[
        Parameter::new(Type::Texture, "diffuse", (0.0, 1.0), "0.5", "albedo of the diffuse part"),
        Parameter::new(Type::Texture, "glossy", (0.0, 1.0), "0.2", "albedo of the lobe"),
        Parameter::new(Type::Scalar, "exponent", (0.0, 1e4), "30", "sharpness of the lobe"),
    ],
    groups: &[&DETAIL],
    source: "Lafortune and Willems 1994",
};

#[derive(Debug)]
pub(crate) struct Glossy;

/// cosⁿ of the angle from the mirror direction.
fn power(at: &Inputs, wo: Vec3, wi: Vec3) -> f32 {
    Vec3::new(-wo.x, -wo.y, wo.z).dot(wi).max(0.0).powf(at.numbers[0])
}

impl OwnScatter for Glossy {
    fn value(&self, at: &Inputs, wo: Vec3, wi: Vec3, _: TransportMode) -> Spectrum {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return Spectrum::ZERO;
        }
        let lobe = (at.numbers[0] + 2.0) / TAU * power(at, wo, wi);
        (at.colors[0] * FRAC_1_PI + at.colors[1] * lobe) * wi.z
    }

    /// Half of the draws by the cosine, half by the lobe, whose directions may be below the surface.
    fn pdf(&self, at: &Inputs, wo: Vec3, wi: Vec3, _: TransportMode) -> f32 {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return 0.0;
        }
        0.5 * wi.z * FRAC_1_PI + 0.5 * (at.numbers[0] + 1.0) / TAU * power(at, wo, wi)
    }

    fn sample(&self, at: &Inputs, wo: Vec3, u: f32, u2: Vec2, _: TransportMode) -> Option<Draw> {
        if u < 0.5 {
            return Some(Draw::Spread(cosine_hemisphere(u2)));
        }
        let cos = u2.x.powf(1.0 / (at.numbers[0] + 1.0));
        let (sin, phi) = ((1.0 - cos * cos).max(0.0).sqrt(), TAU * u2.y);
        let mirror = Frame::from_z(Vec3::new(-wo.x, -wo.y, wo.z));
        let wi = mirror.to_world(Vec3::new(sin * phi.cos(), sin * phi.sin(), cos));
        (wi.z > 0.0).then_some(Draw::Spread(wi))
    }
}
