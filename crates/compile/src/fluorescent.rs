//! Compiling matter that gives light back at other wavelengths.

use super::Compiler;
use std::{path::Path, sync::Arc};
use steradian_core::{
    Scene,
    light::{Light, LightContext},
    material::{FluorescentMaterial, Model},
};
use steradian_image::read_regular;
use steradian_math::{
    Vec2, Vec3,
    hash::HashRng,
    spectra::{
        BispectralTable, ColorMode, LAMBDA_COUNT, LAMBDA_MIN, Reradiation, Wavelengths, cie,
        role::{Color, Role},
    },
    warp,
};
use steradian_scene::Node;
use steradian_texture::SpectrumTexture;

/// Largest table.
const MAX_BYTES: u64 = 1 << 26;
/// By how much photons may be more than one, for the rounding of tables.
const SLACK: f32 = 2e-3;

impl Compiler<'_> {
    /// A fluorescent surface; a diffuse one in RGB mode, and where an error is reported.
    pub(super) fn fluorescent(&mut self, node: &Node) -> Model {
        let reflectance = self.spectrum(node, "reflectance", Role::Albedo);
        let plain = Model::Diffuse(reflectance.clone());
        let lifetime = self.float(node, "lifetime");
        let Some(reradiation) = self.reradiation(node) else { return plain };
        if self.mode == ColorMode::Rgb {
            self.approximated(
                node.span,
                "fluorescence takes spectral mode (--color spectral); it is left out in RGB mode",
            );
            return plain;
        }
        if let Some((lambda, photons)) = too_many(&reradiation, &reflectance) {
            let message =
                format!("of one photon of {lambda:.0} nm {photons:.3} leave: a surface cannot create photons");
            self.error(node.span, message);
            return plain;
        }
        let local = self.add(node, plain).id;
        Model::Fluorescent(Box::new(FluorescentMaterial {
            reflectance,
            reradiation: Arc::new(reradiation),
            lifetime,
            local,
        }))
    }

    fn reradiation(&mut self, node: &Node) -> Option<Reradiation> {
        let span = node.param("matrix").and_then(|p| p.span).or(node.span);
        if let Some(path) = self.typed(node, "matrix", "a file", |n| n.path("matrix")) {
            self.superseded(node, "matrix", &["absorption", "emission", "quantum_yield"]);
            return match read(path) {
                Ok(table) => Some(Reradiation::new(|out, from| table.mean(out, from))),
                Err(e) => {
                    self.error(span, format!("cannot use the matrix in '{}': {e}", path.display()));
                    None
                }
            };
        }
        let absorption = self.constant_color(node, "absorption", Role::Unbounded);
        let emission = self.constant_color(node, "emission", Role::Unbounded);
        let quantum_yield = self.float(node, "quantum_yield");
        Some(Reradiation::of_pigment(|l| at(&absorption, l), quantum_yield, |l| at(&emission, l)))
    }
}

/// Light samples by which the light of a scene is known.
const LIGHT_SAMPLES: usize = 256;

/// Has fluorescent materials draw wavelengths by the light of the scene.
pub(super) fn set_illuminants(mut scene: Scene) -> Scene {
    let count = LAMBDA_COUNT;
    if !scene.is_fluorescent() {
        return scene;
    }
    // Light that is stored shone before.
    let mut timetable = None;
    scene.change(|parts| timetable = parts.lights.timetable.take());
    let (mut light, mut rng, bounds) = (vec![0.0f32; count], HashRng::new(1), scene.bounds());
    let is_placed = !bounds.is_empty() && bounds.diagonal().is_finite();
    for _ in 0..LIGHT_SAMPLES {
        let mut number = || rng.next_f32();
        let within = Vec3::new(number(), number(), number());
        let p = if is_placed { bounds.min + bounds.diagonal() * within } else { within };
        let (ctx, u) = (LightContext { p, n: Vec3::ZERO }, Vec2::new(number(), number()));
        let (choice, w) = (number(), warp::uniform_sphere(Vec2::new(number(), number())));
        let lights = scene.lights();
        let chosen = lights.choose(&ctx, choice).map(|(light, _)| light);
        // Each light counts by the shape of its spectrum: one far away is not lost beside one near by.
        let mut add = |of: &dyn Fn(&Wavelengths) -> f32| {
            let at = |bin: usize| {
                of(&Wavelengths::at([0.125, 0.375, 0.625, 0.875].map(|p| LAMBDA_MIN + bin as f32 - 0.5 + p)))
            };
            let found: Vec<f32> = (0..count).map(at).collect();
            let most = found.iter().copied().fold(0.0, f32::max);
            if most > 0.0 && most.is_finite() {
                light.iter_mut().zip(found).for_each(|(sum, v)| *sum += v / most);
            }
        };
        if let Some(light) = chosen {
            add(&|lambda| lights.sample(light, &ctx, u, lambda, scene.textures()).map_or(0.0, |s| s.radiance.mean()));
        }
        for &environment in &lights.environments {
            if let Light::Environment(e) = &lights.lights[environment as usize] {
                add(&|lambda| e.radiance(p, w, lambda).mean());
            }
        }
    }
    scene.changed(|parts| {
        parts.lights.timetable = timetable;
        for material in &mut parts.materials {
            if let Model::Fluorescent(m) = &mut material.model {
                let of = |l: f32| light[((l - LAMBDA_MIN + 0.5) as usize).min(count - 1)];
                Arc::make_mut(&mut m.reradiation).set_illuminant(of);
            }
        }
    })
}

fn read(path: &Path) -> Result<BispectralTable, String> {
    let bytes = read_regular(path, MAX_BYTES).map_err(|e| e.to_string())?;
    BispectralTable::parse(&String::from_utf8_lossy(&bytes)).map_err(|e| e.to_string())
}

fn at(color: &Color, lambda: f32) -> f32 {
    color.eval(&Wavelengths::at([lambda; 4]))[0]
}

/// A wavelength of which more photons leave than come, and how many; textures are not looked at.
fn too_many(reradiation: &Reradiation, reflectance: &SpectrumTexture) -> Option<(f32, f32)> {
    let plain = |lambda| match reflectance {
        SpectrumTexture::Constant(color) => at(color, lambda),
        SpectrumTexture::Texture(..) => 0.0,
    };
    let all = cie::lambdas().map(|l| (l, reradiation.photons(l) + plain(l)));
    all.max_by(|a, b| a.1.total_cmp(&b.1)).filter(|worst| worst.1 > 1.0 + SLACK)
}
