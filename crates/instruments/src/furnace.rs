//! A piece of material in even light, as an integrating sphere has it.
//!
//! Of a surface the part of light from a direction is told that leaves it. Models of fibres are not reciprocal, and
//! look at where across the fibre the viewer meets it, `h`: what is told of them is what a white furnace shows, the
//! light of all directions that a viewer sees, in the mean over `h`.

use crate::{Specimen, TransportMode, direction};
use steradian_bsdf::{BsdfSample, Lobe};
use steradian_core::material::{Material, Model};
use steradian_math::{Vec2, Vec3, sobol::shuffled_scrambled_sobol_4d};

/// Orientation of a fibre in its shading frame.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Fibre {
    /// Along the tangent: `h` is twice the second texture coordinate, less one.
    Strip,
    /// Along the bitangent, and really round: the normal says `h`.
    Tube,
}

impl Fibre {
    /// Orientation of the fibre that a material is, or has as a part; `None` without one.
    fn of(materials: &[Material], material: u32) -> Option<Self> {
        let mut is_part = vec![false; materials.len()];
        *is_part.get_mut(material as usize)? = true;
        // Wrappers refer to materials with smaller indices.
        for (id, material) in materials.iter().enumerate().rev() {
            match &material.model {
                _ if !is_part[id] => {}
                Model::Hair(hair) => return Some(if hair.is_round { Self::Tube } else { Self::Strip }),
                Model::Mix(a, b, _) | Model::TwoSided(a, b) => {
                    (is_part[*a as usize], is_part[*b as usize]) = (true, true);
                }
                _ => {}
            }
        }
        None
    }

    /// The specimen where its width is at a share of it, and the direction to a viewer at an angle (degrees) from the
    /// plane across the fibre.
    fn seen<'a>(self, specimen: &Specimen<'a>, theta: f64, share: f32) -> (Specimen<'a>, Vec3) {
        let (sin, cos) = theta.to_radians().sin_cos();
        let (sin, cos) = (sin as f32, cos.abs() as f32);
        match self {
            Self::Strip => (specimen.across(share), Vec3::new(sin, 0.0, cos)),
            Self::Tube => {
                let h = 2.0 * share - 1.0;
                (*specimen, Vec3::new(h * cos, sin, (1.0 - h * h).max(0.0).sqrt() * cos))
            }
        }
    }

    /// True if a direction leads on behind the fibre, as a viewer sees it.
    fn is_behind(self, wo: Vec3, wi: Vec3) -> bool {
        match self {
            Self::Strip => wo.y * wi.y + wo.z * wi.z < 0.0,
            Self::Tube => wo.x * wi.x + wo.z * wi.z < 0.0,
        }
    }
}

/// A specimen in even light.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Furnace<'s, 'a> {
    specimen: &'s Specimen<'a>,
    fibre: Option<Fibre>,
}

impl<'s, 'a> Furnace<'s, 'a> {
    pub fn new(specimen: &'s Specimen<'a>) -> Self {
        Self { specimen, fibre: Fibre::of(specimen.materials(), specimen.material()) }
    }

    /// Follows light from an angle (degrees; beyond 90 from below) in the plane of the tangent, or of a fibre what a
    /// viewer sees at this angle from the plane across it. The sample is the `i`th of its series.
    pub fn sample(&self, theta: f64, i: u32, series: u32) -> Option<BsdfSample> {
        let [choice, u, x, y] = shuffled_scrambled_sobol_4d(i, series);
        let (u2, at) = (Vec2::new(x, y), direction(theta, 0.0));
        let Some(fibre) = self.fibre else {
            return self.specimen.sample(at, choice, u, u2, TransportMode::Importance);
        };
        let [share, ..] = shuffled_scrambled_sobol_4d(i, !series);
        let (place, wo) = fibre.seen(self.specimen, theta, share);
        let drawn = place.sample(wo, choice, u, u2, TransportMode::Radiance)?;
        let side = if fibre.is_behind(wo, drawn.wi) { Lobe::TRANSMISSION } else { Lobe::REFLECTION };
        let kinds = [Lobe::DIFFUSE, Lobe::GLOSSY, Lobe::SPECULAR];
        let lobe = kinds.into_iter().filter(|kind| drawn.lobe.contains(*kind)).fold(side, Lobe::with);
        Some(BsdfSample { lobe, ..drawn })
    }
}
