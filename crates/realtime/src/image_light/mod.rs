//! Light of environments without rays: on diffuse surfaces by nine coefficients (Ramamoorthi and Hanrahan, "An
//! efficient representation for irradiance environment maps", 2001), on facets by prefiltered maps.
//!
//! The clamped cosine leaves little of what has a degree above 2, so that the irradiance of any environment is a
//! quadratic polynomial of the normal to about a hundredth. Nothing casts a shadow: the environment is seen by the
//! whole hemisphere.

mod prefiltered;

use crate::options::EnvironmentKind;
use prefiltered::Prefiltered;
use steradian_bsdf::{Bsdf, SplitSum};
use steradian_core::{Scene, light::Light};
use steradian_math::{
    Spectrum, Vec2, Vec3,
    harmonics::{clamped_cosine, index, visit},
    spectra::Wavelengths,
    warp,
};
use steradian_transport::power_heuristic;

/// Directions by which an environment is projected, by each of two techniques.
const DIRECTIONS: u32 = 1 << 15;

/// An environment.
#[derive(Clone, Debug)]
struct ImageLight {
    light: u32,
    /// Its group of lights.
    group: u32,
    /// Coefficients of its irradiance over π.
    irradiance: [Vec3; 9],
    /// Blurred maps, where the options ask for them.
    prefiltered: Option<Prefiltered>,
}

/// Environments as functions of normals and directions.
#[derive(Clone, Debug, Default)]
pub struct ImageLights {
    lights: Vec<ImageLight>,
    kind: EnvironmentKind,
}

impl ImageLights {
    /// Projects the environments of a scene in RGB mode. Those behind portals, which look different from each point,
    /// are left out.
    pub fn new(scene: &Scene, kind: EnvironmentKind) -> Self {
        let all = &scene.lights().lights;
        let lights = scene.lights().environments.iter().filter_map(|&light| match &all[light as usize] {
            Light::Environment(e) if e.portal.is_none() => {
                let radiance = |w| Vec3::from_array(e.beyond(w, &Wavelengths::RGB).to_rgb());
                let (draw, density) = (|u| e.sample(Vec3::ZERO, u), |w| e.pdf(Vec3::ZERO, w));
                let is_prefiltered = kind == EnvironmentKind::Prefiltered;
                Some(ImageLight {
                    light,
                    group: scene.light_groups().of_lights[light as usize],
                    irradiance: project(radiance, draw, density),
                    prefiltered: is_prefiltered.then(|| Prefiltered::new(radiance, draw, density)),
                })
            }
            _ => None,
        });
        Self { lights: lights.collect(), kind }
    }

    /// True if the light is one of these.
    pub fn has(&self, light: u32) -> bool {
        self.lights.iter().any(|known| known.light == light)
    }

    /// The factors of a surface that these light; `None` for those that are lit by rays.
    pub fn split(&self, bsdf: &Bsdf<'_>, wo: Vec3) -> Option<SplitSum> {
        let is_lit = self.kind == EnvironmentKind::Prefiltered || matches!(bsdf, Bsdf::Diffuse(_));
        bsdf.split_sum(wo).filter(|_| is_lit)
    }

    /// Light that a surface with these factors sends on, with the group of each environment. `mirrored` is the mirrored
    /// direction of the view.
    pub fn reflected(&self, split: SplitSum, normal: Vec3, mirrored: Vec3) -> impl Iterator<Item = (u32, Spectrum)> {
        let rgb = |light: Vec3| {
            let [r, g, b] = light.max(Vec3::ZERO).to_array();
            Spectrum::rgb(r, g, b)
        };
        // Lobes of rough facets lean from the mirrored direction to the normal (Lagarde, de Rousiers 2014, "Moving Frostbite
        // to physically based rendering", section 4.9.3).
        let alpha = split.alpha.min(1.0);
        let lean = (1.0 - alpha) * ((1.0 - alpha).sqrt() + alpha);
        let axis = (normal + (mirrored - normal) * lean).normalize_or(normal);
        self.lights.iter().map(move |known| {
            let mut irradiance = Vec3::ZERO;
            visit(2, normal, |l, m, y| irradiance += known.irradiance[index(l, m)] * y);
            let by_facets = known.prefiltered.as_ref().map_or(Vec3::ZERO, |maps| maps.at(axis, split.alpha));
            (known.group, split.diffuse * rgb(irradiance) + split.facets * rgb(by_facets))
        })
    }
}

/// Coefficients A_l L_lm / π of the irradiance, by directions that are even over the sphere and such as the light
/// draws, weighted by the power heuristic: bright suns are small. Both sets are Hammersley points.
fn project(
    radiance: impl Fn(Vec3) -> Vec3,
    draw: impl Fn(Vec2) -> Option<(Vec3, f32)>,
    density: impl Fn(Vec3) -> f32,
) -> [Vec3; 9] {
    const EVEN: f32 = 0.25 * std::f32::consts::FRAC_1_PI;
    let mut sums = [Vec3::ZERO; 9];
    let mut add = |w: Vec3, share: f32| {
        let light = radiance(w) * (share / DIRECTIONS as f32);
        if light.is_finite() {
            visit(2, w, |l, m, y| sums[index(l, m)] += light * y);
        }
    };
    for k in 0..DIRECTIONS {
        let u = Vec2::new((k as f32 + 0.5) / DIRECTIONS as f32, k.reverse_bits() as f32 / 4_294_967_296.0);
        let w = warp::uniform_sphere(u);
        add(w, power_heuristic(EVEN, density(w)) / EVEN);
        if let Some((w, pdf)) = draw(u.min(Vec2::splat(1.0 - f32::EPSILON))) {
            add(w, power_heuristic(pdf, EVEN) / pdf);
        }
    }
    for l in 0..=2_usize {
        for m in -(l as i32)..=l as i32 {
            sums[index(l, m)] *= clamped_cosine(l) * std::f32::consts::FRAC_1_PI;
        }
    }
    sums
}
