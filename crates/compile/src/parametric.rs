//! Compiling the models that take nothing but their parameters: their schema is all that there is to know.

use super::Compiler;
use steradian_core::material::InputTextures;
use steradian_math::spectra::role::Role;
use steradian_scene::Node;
use steradian_schema::{Model, Type};
use steradian_texture::FloatTexture;

impl Compiler<'_> {
    /// The parameters of a material that takes nothing else.
    pub(super) fn input_textures(&mut self, node: &Node, model: &'static Model) -> InputTextures {
        let mut made = InputTextures::default();
        let mut named: Vec<(&str, FloatTexture)> = Vec::new();
        for p in model.parameters {
            match p.kind {
                Type::Texture => {
                    made.colors.push(self.spectrum(node, p.name, Role::Albedo));
                }
                Type::Scalar => {
                    // Where it is absent, another one may count.
                    let other = named.iter().find(|n| n.0 == p.usual_default() && node.get(p.name).is_none());
                    let default = p.default_number().unwrap_or_default();
                    let number = other.map_or_else(|| self.float_texture_or(node, p.name, default), |n| n.1);
                    named.push((p.name, number));
                    made.numbers.push(number);
                }
                Type::Word(_) => {
                    let words: Vec<_> = p.words().zip(0..).collect();
                    let usual = words.iter().find(|w| w.0 == p.usual_default()).map_or(0, |w| w.1);
                    made.choice = self.choice_or(node, p.name, usual, &words);
                }
                Type::Vector => {
                    made.vector = self.vec3(node, p.name);
                }
                _ => {
                    unreachable!("a test sees that models with recipes have none of these, and registries refuse them")
                }
            }
        }
        made
    }
}

#[cfg(test)]
mod tests {
    use steradian_bsdf::{MOST_INPUTS, recipes};
    use steradian_schema::{Family, Type};

    #[test]
    fn recipes_take_what_the_schema_has() {
        for recipe in recipes() {
            let model = Family::Material.model(recipe.kind).expect("a kind of material");
            let count = |wanted: fn(Type) -> bool| model.parameters.iter().filter(|p| wanted(p.kind)).count();
            let (colors, numbers) = (count(|t| t == Type::Texture), count(|t| t == Type::Scalar));
            let (words, vectors) = (count(|t| matches!(t, Type::Word(_))), count(|t| t == Type::Vector));
            assert!(colors <= MOST_INPUTS && numbers <= MOST_INPUTS && words <= 1 && vectors <= 1, "{}", recipe.kind);
            assert_eq!(colors + numbers + words + vectors, model.parameters.len(), "{}", recipe.kind);
        }
        assert!(recipes().count() >= 6);
    }
}
