//! Normal maps: normals in the tangent frame or in the space of the object, and a second map on top of the first.
//!
//! Two maps are combined by reorienting the second (Barré-Brisebois, Hill, "Blending in Detail", 2012): the shortest
//! rotation that takes the z axis to the first map's normal `n₁` is applied to the second's `n₂`. With `t = n₁ + z` and
//! `u = (−x₂, −y₂, z₂)` that is `t (t·u)/t_z − u`.

use super::{detail::Base, normal_code::NormalCode, normal_filter::FilteredNormals};
use std::sync::Arc;
use steradian_math::Vec3;
use steradian_texture::{TextureContext, TextureId, Textures};

/// Space of the normals of a map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum NormalSpace {
    /// The tangent frame: x along ∂p/∂u, z along the shading normal.
    #[default]
    Tangent,
    /// The space of the object, in which its vertices are given. Normals are turned to the side of the surface's own.
    Object,
}

/// The spaces by name.
pub const NORMAL_SPACES: [(&str, NormalSpace); 2] =
    [("tangent", NormalSpace::Tangent), ("object", NormalSpace::Object)];

/// A normal map.
#[derive(Clone, Debug)]
pub struct NormalMap {
    /// Texture of the normals.
    pub texture: TextureId,
    /// Encoding of the texture's values.
    pub code: NormalCode,
    /// Space of the normals.
    pub space: NormalSpace,
    /// y points along ∂p/∂v, as in MikkTSpace and glTF, also where the parametrisation is mirrored; else along z × x,
    /// as pbrt and Mitsuba have it.
    pub mirrors: bool,
    /// Factor on x and y in the tangent frame.
    pub strength: f32,
    /// The map averaged over footprints, where its spread is to count as roughness.
    pub filtered: Option<Arc<FilteredNormals>>,
    /// Another map in the tangent frame, on top of this one.
    pub over: Option<Box<NormalMap>>,
}

impl NormalMap {
    /// The normal of a texel's value, with x and y times the strength; not of unit length.
    pub fn decode(&self, value: Vec3) -> Vec3 {
        self.strengthened(self.code.decode(value))
    }

    fn strengthened(&self, n: Vec3) -> Vec3 {
        Vec3::new(n.x * self.strength, n.y * self.strength, n.z)
    }

    /// The normal in the world. `bends`: maps that point into the surface are turned over.
    pub(super) fn normal(&self, textures: &Textures, at: &TextureContext, base: &Base, bends: bool) -> Vec3 {
        let (frame, mirrored) = base.tangent_frame(self.mirrors);
        let turned = |m: Vec3| if mirrored { Vec3::new(m.x, -m.y, m.z) } else { m };
        let mut m = match (self.space, &self.filtered) {
            (NormalSpace::Object, _) => {
                let n = self.code.decode(textures.rgb(self.texture, at));
                let n = base.object.map_or(n, |object| object.normal(n)).normalize_or(base.ns);
                self.strengthened(turned(frame.to_local(if n.dot(base.ns) < 0.0 { -n } else { n })))
            }
            (NormalSpace::Tangent, Some(filtered)) => filtered.normal(at).0,
            (NormalSpace::Tangent, None) => self.decode(textures.rgb(self.texture, at)),
        };
        if let Some(over) = &self.over {
            m = reoriented(m, over.decode(textures.rgb(over.texture, at)));
        }
        let n = frame.to_world(turned(m)).normalize_or(base.ns);
        if bends && n.dot(base.n) < 0.0 { -n } else { n }
    }
}

/// The second normal in the frame that the first one makes of the tangent frame; of unit length.
fn reoriented(first: Vec3, second: Vec3) -> Vec3 {
    let t = first.normalize_or(Vec3::Z) + Vec3::Z;
    let n = second.normalize_or(Vec3::Z);
    let u = Vec3::new(-n.x, -n.y, n.z);
    // A normal straight down has no shortest rotation; any half turn serves.
    if t.z > 0.0 { t * (t.dot(u) / t.z) - u } else { Vec3::new(n.x, -n.y, -n.z) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::SurfaceDetail;
    use steradian_math::{
        Spectrum, Vec2,
        hash::HashRng,
        spectra::{ColorMode, role::Color},
        transform::Affine,
    };
    use steradian_texture::Texture;

    const FLAT: Base = Base { n: Vec3::Z, ns: Vec3::Z, dpdu: Vec3::X, dpdv: Vec3::Y, tangent: None, object: None };

    /// A map of one normal.
    fn map(textures: &mut Textures, n: Vec3, space: NormalSpace) -> NormalMap {
        let c = (n + 1.0) * 0.5;
        let texture = textures.add(Texture::Constant(Color::Lanes(Spectrum::rgb(c.x, c.y, c.z))));
        let code = NormalCode::Xyz;
        NormalMap { texture, code, space, mirrors: true, strength: 1.0, filtered: None, over: None }
    }

    fn seen(textures: &Textures, map: NormalMap, base: &Base) -> Vec3 {
        let detail = SurfaceDetail { normal_map: Some(map), ..SurfaceDetail::default() };
        detail.shading_normal(textures, &TextureContext::new(Vec3::ZERO, Vec2::ZERO), base, base.n, false)
    }

    fn near(a: Vec3, b: Vec3) {
        assert!((a - b).length() < 2e-6, "{a} {b}");
    }

    /// Two tilts by hand: both about y add up; one about y and one about x turn the second with the first.
    #[test]
    fn a_second_map_is_turned_with_the_first() {
        let tilt = |degrees: f32| Vec3::new(degrees.to_radians().sin(), 0.0, degrees.to_radians().cos());
        near(reoriented(tilt(20.0), tilt(25.0)), tilt(45.0));
        near(reoriented(tilt(30.0), tilt(-30.0)), Vec3::Z);
        let (s, c) = (0.6, 0.8);
        // The frame of (0.6, 0, 0.8) has its y axis along y: (0, 0.6, 0.8) becomes 0.6 y + 0.8 n.
        near(reoriented(Vec3::new(s, 0.0, c), Vec3::new(0.0, s, c)), Vec3::new(c * s, s, c * c));
        near(reoriented(Vec3::new(2.0 * s, 0.0, 2.0 * c), Vec3::Z), Vec3::new(s, 0.0, c));
        assert!(reoriented(-Vec3::Z, tilt(10.0)).is_normalized());
    }

    #[test]
    fn a_flat_map_below_or_above_changes_nothing() {
        let mut rng = HashRng::new(5);
        for space in [NormalSpace::Tangent, NormalSpace::Object] {
            for _ in 0..50 {
                let mut textures = Textures::new(ColorMode::Rgb);
                let n = Vec3::new(rng.next_f32() - 0.5, rng.next_f32() - 0.5, 0.8).normalize();
                let mut below = map(&mut textures, n, space);
                let alone = seen(&textures, below.clone(), &FLAT);
                near(alone, n);
                below.over = Some(Box::new(map(&mut textures, Vec3::Z, NormalSpace::Tangent)));
                near(seen(&textures, below, &FLAT), alone);
                let mut flat = map(&mut textures, Vec3::Z, space);
                flat.over = Some(Box::new(map(&mut textures, n, NormalSpace::Tangent)));
                near(seen(&textures, flat, &FLAT), n);
            }
        }
    }

    /// Normals of the object go to the world as normals do, whatever the tangents, and keep to the side of the surface.
    #[test]
    fn normals_of_the_object_need_no_tangents() {
        let mut textures = Textures::new(ColorMode::Rgb);
        let n = Vec3::new(0.6, 0.0, 0.8);
        let object = map(&mut textures, n, NormalSpace::Object);
        near(seen(&textures, object.clone(), &Base { dpdu: Vec3::Y, dpdv: Vec3::X, ..FLAT }), n);
        near(seen(&textures, object.clone(), &Base { dpdu: Vec3::ZERO, dpdv: Vec3::ZERO, ..FLAT }), n);
        let turned = Base { n: -Vec3::Z, ns: -Vec3::Z, ..FLAT };
        near(seen(&textures, object.clone(), &turned), -n);
        // Twice as long in x: normals lean half as far.
        let stretched = steradian_math::Transform::scale(steradian_math::DVec3::new(2.0, 1.0, 1.0)).affine();
        assert!(stretched.is_some_and(|a: Affine| a.m.determinant() == 2.0));
        near(
            seen(&textures, object.clone(), &Base { object: stretched, ..FLAT }),
            Vec3::new(0.3, 0.0, 0.8).normalize(),
        );
        let weaker = NormalMap { strength: 0.5, ..object };
        near(seen(&textures, weaker, &FLAT), Vec3::new(0.3, 0.0, 0.8).normalize());
    }
}
