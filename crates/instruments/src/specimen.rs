//! A piece of material under the instruments.

use steradian_bsdf::{BsdfEval, BsdfSample, TransportMode};
use steradian_core::{
    ColorMode, Scene,
    material::{self, Scattering},
};
use steradian_math::{Spectrum, Vec2, Vec3, spectra::Wavelengths};
use steradian_texture::TextureContext;

/// Number of strata over which mixtures, which choose one of their parts by a number, are averaged.
pub(crate) const MIXTURE_STRATA: u32 = 64;

/// One material of a scene, at one point of a surface.
#[derive(Clone, Copy, Debug)]
pub struct Specimen<'a> {
    scene: &'a Scene,
    material: u32,
    uv: Vec2,
    lambda: Wavelengths,
}

impl<'a> Specimen<'a> {
    /// The material with this index, at (½, ½) of its textures, and at 450, 550, 600 and 650 nm in spectral scenes.
    pub fn new(scene: &'a Scene, material: u32) -> Self {
        let lambda = Wavelengths::at([450.0, 550.0, 600.0, 650.0]);
        Self { scene, material, uv: Vec2::splat(0.5), lambda }
    }

    /// The material of this name; the last of several, as scene files redefine.
    pub fn named(scene: &'a Scene, name: &str) -> Option<Self> {
        let i = scene.material_names().iter().rposition(|n| n == name)?;
        Some(Self::new(scene, i as u32))
    }

    /// At another place of the textures.
    #[must_use]
    pub fn at(self, uv: Vec2) -> Self {
        Self { uv, ..self }
    }

    /// At another second texture coordinate.
    #[must_use]
    pub(crate) fn across(self, v: f32) -> Self {
        self.at(Vec2::new(self.uv.x, v))
    }

    /// The materials of the scene.
    pub(crate) fn materials(&self) -> &'a [material::Material] {
        self.scene.materials()
    }

    /// The index of its own.
    pub(crate) fn material(&self) -> u32 {
        self.material
    }

    /// At other wavelengths, nm, for scenes in spectral mode.
    #[must_use]
    pub fn with_wavelengths(self, lambda: [f32; 4]) -> Self {
        Self { lambda: Wavelengths::at(lambda), ..self }
    }

    /// Meaning of the lanes of its values.
    pub fn mode(&self) -> ColorMode {
        self.scene.mode()
    }

    /// The wavelengths, nm, of the lanes in spectral mode.
    pub fn wavelengths(&self) -> [f32; 4] {
        self.lambda.lambda
    }

    /// Scattering seen from a side, with a number in [0, 1) for the choices of mixtures.
    fn scattering(&self, front: bool, choice: f32) -> Option<Scattering<'a>> {
        let at = TextureContext::new(Vec3::ZERO, self.uv);
        let mut lambda = self.lambda;
        let s = self.scene;
        material::scattering(s.materials(), s.textures(), self.material, &at, front, choice, &mut lambda)
    }

    /// True if it may be a mixture.
    pub(crate) fn is_mixed(&self) -> bool {
        self.scene.has_mixtures()
    }

    fn strata(&self) -> u32 {
        if self.is_mixed() { MIXTURE_STRATA } else { 1 }
    }

    /// `f·|cosθ_i|` and the density of [`Specimen::sample`], both per steradian.
    pub fn eval(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> BsdfEval {
        let n = self.strata();
        let mut mean = BsdfEval::ZERO;
        for i in 0..n {
            let Some(s) = self.scattering(wo.z > 0.0, (i as f32 + 0.5) / n as f32) else { continue };
            let turn = |w| if s.flipped { turned(w) } else { w };
            let e = s.bsdf.eval(turn(wo), turn(wi), mode);
            mean.value += e.value / n as f32;
            mean.pdf += e.pdf / n as f32;
        }
        mean
    }

    /// Draws a direction by the model's own sampling.
    pub fn sample(&self, wo: Vec3, choice: f32, u: f32, u2: Vec2, mode: TransportMode) -> Option<BsdfSample> {
        let s = self.scattering(wo.z > 0.0, choice)?;
        let turn = |w| if s.flipped { turned(w) } else { w };
        let drawn = s.bsdf.sample(turn(wo), u, u2, mode)?;
        Some(BsdfSample { wi: turn(drawn.wi), ..drawn })
    }

    /// Luminance of a value: Rec.709's in RGB mode, the mean of the lanes in spectral mode.
    pub fn luminance(&self, s: Spectrum) -> f32 {
        match self.scene.mode() {
            ColorMode::Rgb => steradian_math::color::luminance(Vec3::from(s.to_rgb())),
            ColorMode::Spectral => s.mean(),
        }
    }

    /// The lanes that mean something: three in RGB mode, four in spectral.
    pub fn lanes(&self, s: Spectrum) -> Vec<f32> {
        match self.scene.mode() {
            ColorMode::Rgb => s.to_rgb().to_vec(),
            ColorMode::Spectral => s.to_array().to_vec(),
        }
    }
}

/// A direction in the frame turned over about its tangent, and back.
fn turned(w: Vec3) -> Vec3 {
    Vec3::new(w.x, -w.y, -w.z)
}
