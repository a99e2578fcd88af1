//! Textures of a program's own.

use crate::{Mapping, TextureContext, mapping::Coordinates2};
use std::fmt::Debug;
use steradian_math::Vec3;

/// A texture of a program's own. Values that are not finite count as 0.
pub trait OwnTexture: Debug + Send + Sync {
    /// The value at a point.
    fn value(&self, at: &OwnPoint<'_>) -> OwnValue;

    /// True if it is averaged over the footprint; others are taken at points.
    fn is_filtered(&self) -> bool {
        false
    }

    /// True if it changes during the exposure.
    fn is_timed(&self) -> bool {
        false
    }
}

/// Point of a texture of a program's own, after its mapping.
#[derive(Clone, Copy, Debug)]
pub struct OwnPoint<'a> {
    /// Coordinates u and v, and their derivatives by the pixel's x and y.
    pub uv: Coordinates2,
    /// The point in the texture's space.
    pub p: Vec3,
    /// The point as it is on the surface: normal, moment, footprint.
    pub surface: &'a TextureContext<'a>,
}

/// Value of a texture of a program's own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OwnValue {
    /// A number.
    Number(f32),
    /// Linear Rec.709.
    Rgb(Vec3),
}

/// The value at a point of a surface.
pub(crate) fn value(texture: &dyn OwnTexture, mapping: &Mapping, at: &TextureContext) -> OwnValue {
    let point = OwnPoint { uv: mapping.coordinates(at), p: mapping.solid(at.p), surface: at };
    match texture.value(&point) {
        OwnValue::Number(v) => OwnValue::Number(if v.is_finite() { v } else { 0.0 }),
        OwnValue::Rgb(v) => OwnValue::Rgb(Vec3::from_array(v.to_array().map(|v| if v.is_finite() { v } else { 0.0 }))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Texture, Textures};
    use std::sync::Arc;
    use steradian_math::Vec2;

    #[derive(Debug)]
    struct Stripes;

    impl OwnTexture for Stripes {
        fn value(&self, at: &OwnPoint<'_>) -> OwnValue {
            match at.uv.uv.x < 1.0 {
                true => OwnValue::Rgb(Vec3::new(at.p.x, f32::NAN, at.surface.time)),
                false => OwnValue::Number(f32::INFINITY),
            }
        }
    }

    /// The mapping counts, and what is no number is 0.
    #[test]
    fn own_textures_are_mapped_and_sound() {
        let mut textures = Textures::default();
        let mapping = Mapping { scale: Vec2::new(4.0, 1.0), ..Mapping::default() };
        let id = textures.add(Texture::Own(Arc::new(Stripes), Box::new(mapping)));
        let at = |u: f32| TextureContext { time: 0.5, ..TextureContext::new(Vec3::splat(3.0), Vec2::new(u, 0.0)) };
        assert_eq!(textures.rgb(id, &at(0.2)), Vec3::new(3.0, 0.0, 0.5));
        assert_eq!(textures.float(id, &at(0.3)), 0.0);
    }
}
