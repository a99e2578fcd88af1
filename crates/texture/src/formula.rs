//! Textures by formula.

use crate::{Mapping, TextureContext};
use steradian_math::{Vec3, expression::Expression};

/// Variables of a formula: the coordinates u and v; the point x, y and z in the texture's space; the moment t of the
/// exposure.
pub const VARIABLES: [&str; 6] = ["u", "v", "x", "y", "z", "t"];

/// A formula of the variables.
pub type Formula = Expression<6>;

/// A number or linear Rec.709 at each point, by formulas. It is taken at points, without regard to footprints; where a
/// formula is not defined it is 0.
#[derive(Clone, Debug)]
pub struct FormulaTexture {
    /// From a point to the variables.
    pub mapping: Mapping,
    /// The formulas.
    pub components: Components,
}

/// Formulas of the components of a texture.
#[derive(Clone, Debug)]
pub enum Components {
    /// One number.
    Number(Formula),
    /// Red, green and blue.
    Rgb(Box<[Formula; 3]>),
}

impl FormulaTexture {
    /// True if it changes during the exposure.
    pub(crate) fn is_timed(&self) -> bool {
        let uses_time = |formula: &Formula| formula.uses(VARIABLES.len() - 1);
        match &self.components {
            Components::Number(formula) => uses_time(formula),
            Components::Rgb(formulas) => formulas.iter().any(uses_time),
        }
    }

    /// The value at a point, and the number of its components.
    pub(crate) fn value(&self, at: &TextureContext) -> (Vec3, usize) {
        let (uv, p) = (self.mapping.uv(at), self.mapping.solid(at.p));
        let variables = [uv.x, uv.y, p.x, p.y, p.z, at.time].map(f64::from);
        let one = |formula: &Formula| {
            let value = formula.value(variables) as f32;
            if value.is_finite() { value } else { 0.0 }
        };
        match &self.components {
            Components::Number(formula) => (Vec3::splat(one(formula)), 1),
            Components::Rgb(formulas) => (Vec3::from_array(formulas.each_ref().map(one)), 3),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Texture, Textures};
    use std::sync::Arc;
    use steradian_math::Vec2;

    /// Values of a texture at (u, v) = (0.25, 0.5), at the point (1, 2, 3), halfway through the exposure.
    fn value(formulas: [&str; 3]) -> (Textures, Vec3, f32) {
        let [r, g, b] = formulas.map(|text| Formula::new(text, &VARIABLES).unwrap());
        let components = Components::Rgb(Box::new([r, g, b]));
        let mut textures = Textures::default();
        let id = textures.add(Texture::Formula(Arc::new(FormulaTexture { mapping: Mapping::default(), components })));
        let at = TextureContext { time: 0.5, ..TextureContext::new(Vec3::new(1.0, 2.0, 3.0), Vec2::new(0.25, 0.5)) };
        let values = (textures.rgb(id, &at), textures.float(id, &at));
        (textures, values.0, values.1)
    }

    #[test]
    fn formulas_are_of_coordinates_point_and_time() {
        let (_, rgb, mean) = value(["u + 2*v", "x + y*z", "t"]);
        assert_eq!((rgb, mean), (Vec3::new(1.25, 7.0, 0.5), 8.75 / 3.0));
    }

    /// Values that are not defined, or beyond the range of numbers, are 0.
    #[test]
    fn undefined_values_are_zero() {
        let (_, rgb, _) = value(["log(u - 1)", "1/(x - 1)", "exp(1000)"]);
        assert_eq!(rgb, Vec3::ZERO);
    }

    /// Only formulas of t change during the exposure.
    #[test]
    fn formulas_of_time_are_timed() {
        assert!(value(["u", "v", "2*t"]).0.is_timed() && !value(["u", "v", "x"]).0.is_timed());
    }
}
