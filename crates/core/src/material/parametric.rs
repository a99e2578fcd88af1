//! Models that take nothing but their parameters, with these as textures.

use super::albedo;
use std::sync::Arc;
use steradian_bsdf::{Bsdf, Inputs, MOST_INPUTS, Own, OwnScatter, Recipe};
use steradian_math::{Spectrum, Vec3, spectra::Wavelengths};
use steradian_texture::{FloatTexture, SpectrumTexture, TextureContext, Textures};

/// The parameters of a model, each kind of them in the order of the schema.
#[derive(Clone, Debug, Default)]
pub struct InputTextures {
    /// Reflectances; at most [`MOST_INPUTS`].
    pub colors: Vec<SpectrumTexture>,
    /// Numbers; at most [`MOST_INPUTS`].
    pub numbers: Vec<FloatTexture>,
    /// Index of the chosen word.
    pub choice: u32,
    /// A vector.
    pub vector: Vec3,
}

/// A model of the schema and its parameters.
#[derive(Clone, Debug)]
pub struct Parametric {
    /// Construction of the BSDF from the parameters.
    pub recipe: &'static Recipe,
    /// The parameters.
    pub inputs: InputTextures,
}

/// A model of a program's own and its parameters.
#[derive(Clone, Debug)]
pub struct OwnMaterial {
    /// The model.
    pub model: Arc<dyn OwnScatter>,
    /// The parameters.
    pub inputs: InputTextures,
}

impl InputTextures {
    /// Values at a point.
    fn at(&self, textures: &Textures, at: &TextureContext, lambda: &Wavelengths) -> Inputs {
        let (mut colors, mut numbers) = ([Spectrum::ZERO; MOST_INPUTS], [0.0; MOST_INPUTS]);
        for (color, texture) in colors.iter_mut().zip(&self.colors) {
            *color = albedo(texture.eval(textures, at, lambda));
        }
        for (number, texture) in numbers.iter_mut().zip(&self.numbers) {
            *number = texture.eval(textures, at);
        }
        Inputs { colors, numbers, choice: self.choice, vector: self.vector }
    }
}

impl Parametric {
    pub(super) fn bsdf(&self, textures: &Textures, at: &TextureContext, lambda: &Wavelengths) -> Bsdf<'static> {
        (self.recipe.make)(&self.inputs.at(textures, at, lambda))
    }
}

impl OwnMaterial {
    pub(super) fn bsdf(&self, textures: &Textures, at: &TextureContext, lambda: &Wavelengths) -> Bsdf<'_> {
        Bsdf::Own(Own { model: &*self.model, at: self.inputs.at(textures, at, lambda) })
    }
}
