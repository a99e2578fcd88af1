//! Models that take nothing but their parameters, with these as textures.

use super::albedo;
use steradian_bsdf::{Bsdf, Inputs, MOST_INPUTS, Recipe};
use steradian_math::{Spectrum, Vec3, spectra::Wavelengths};
use steradian_texture::{FloatTexture, SpectrumTexture, TextureContext, Textures};

/// A model and its parameters, each kind of them in the order of the schema.
#[derive(Clone, Debug)]
pub struct Parametric {
    /// Construction of the BSDF from the parameters.
    pub recipe: &'static Recipe,
    /// Reflectances; at most [`MOST_INPUTS`].
    pub colors: Vec<SpectrumTexture>,
    /// Numbers; at most [`MOST_INPUTS`].
    pub numbers: Vec<FloatTexture>,
    /// Index of the chosen word.
    pub choice: usize,
    /// A vector.
    pub vector: Vec3,
}

impl Parametric {
    pub(super) fn bsdf(&self, textures: &Textures, at: &TextureContext, lambda: &Wavelengths) -> Bsdf<'static> {
        let (mut colors, mut numbers) = ([Spectrum::ZERO; MOST_INPUTS], [0.0; MOST_INPUTS]);
        for (color, texture) in colors.iter_mut().zip(&self.colors) {
            *color = albedo(texture.eval(textures, at, lambda));
        }
        for (number, texture) in numbers.iter_mut().zip(&self.numbers) {
            *number = texture.eval(textures, at);
        }
        (self.recipe.make)(&Inputs { colors, numbers, choice: self.choice, vector: self.vector })
    }
}
