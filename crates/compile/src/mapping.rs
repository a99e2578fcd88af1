//! Compiling texture mappings.

use super::Compiler;
use steradian_math::{Vec2, Vec3, transform::Affine};
use steradian_scene::Node;
use steradian_texture::{
    Mapping,
    mapping::{Intermediary, ObjectMap, Projector},
};

#[derive(Clone, Copy)]
enum Kind {
    Uv,
    Spherical,
    Cylindrical,
    Planar,
    Cube,
    Triangle,
    TwoPart,
}

impl Compiler<'_> {
    /// From the world to the space of a texture.
    pub(super) fn texture_space(&mut self, node: &Node) -> Affine {
        self.transform(node, "texture_from_world").affine().unwrap_or_else(|| {
            self.error(node.span, "the texture's transform is singular or not finite");
            Affine::IDENTITY
        })
    }

    /// The mapping that a texture node asks for.
    pub(super) fn mapping(&mut self, node: &Node) -> Mapping {
        let local = self.texture_space(node);
        let kinds = [
            ("uv", Kind::Uv),
            ("spherical", Kind::Spherical),
            ("cylindrical", Kind::Cylindrical),
            ("planar", Kind::Planar),
            ("cube", Kind::Cube),
            ("triangle", Kind::Triangle),
            ("two_part", Kind::TwoPart),
        ];
        let projector = match self.choice(node, "mapping", &kinds) {
            Kind::Uv => match self.given_word(node, "uv_set") {
                Some(name) => Projector::Attribute(name.into()),
                None => Projector::Uv,
            },
            Kind::Spherical => Projector::Spherical,
            Kind::Cylindrical => Projector::Cylindrical,
            Kind::Planar => Projector::Planar(self.vec3(node, "v1"), self.vec3(node, "v2"), Vec2::ZERO),
            Kind::Cube => Projector::Cube,
            Kind::Triangle => self.triangle(node),
            Kind::TwoPart => self.two_part(node),
        };
        Mapping {
            projector,
            local,
            scale: Vec2::new(self.float(node, "scale_u"), self.float(node, "scale_v")),
            delta: Vec2::new(self.float(node, "delta_u"), self.float(node, "delta_v")),
            matrix: self.corresponder(node),
        }
    }

    /// The affine map of texture coordinates: `to_uv`, else glTF's `khr_offset`, `khr_rotation` (degrees) and
    /// `khr_scale`.
    fn corresponder(&mut self, node: &Node) -> [Vec2; 3] {
        let to_uv = self.transform(node, "to_uv");
        let at = |x: f64, y: f64| {
            let p = to_uv.point(steradian_math::DVec3::new(x, y, 0.0));
            Vec2::new(p.x as f32, p.y as f32)
        };
        let origin = at(0.0, 0.0);
        let matrix = [at(1.0, 0.0) - origin, at(0.0, 1.0) - origin, origin];
        if !matrix.iter().all(|m| m.is_finite()) {
            self.error(node.span, "the transform of texture coordinates is not finite");
            return [Vec2::X, Vec2::Y, Vec2::ZERO];
        }
        if !["khr_offset", "khr_rotation", "khr_scale"].iter().any(|p| node.get(p).is_some()) {
            return matrix;
        }
        let mut pair = |name: &str, default: Vec2| match self.list(node, name) {
            None => default,
            Some(v) if v.len() == 2 => Vec2::new(v[0], v[1]),
            Some(v) => {
                let span = node.param(name).and_then(|p| p.span).or(node.span);
                self.error(span, format!("'{name}' needs two numbers, not {}", v.len()));
                default
            }
        };
        let (offset, scale) = (pair("khr_offset", Vec2::ZERO), pair("khr_scale", Vec2::ONE));
        Mapping::khr_texture_transform(offset, self.float(node, "khr_rotation").to_radians(), scale)
    }

    /// The affine map of three points of texture space, `corners`, to three pairs of coordinates, `corner_uvs`.
    fn triangle(&mut self, node: &Node) -> Projector {
        let (x, uv) = (self.list(node, "corners"), self.list(node, "corner_uvs"));
        match (x.as_deref(), uv.as_deref()) {
            (Some(x), Some(uv)) if x.len() == 9 && uv.len() == 6 => {
                let x = [0, 3, 6].map(|i| Vec3::from_slice(&x[i..]));
                let uv = [0, 2, 4].map(|i| Vec2::from_slice(&uv[i..]));
                if let Some(p) = Projector::triangle(x, uv) {
                    return p;
                }
                self.error(node.span, "the three 'corners' of the mapping 'triangle' lie on a line");
            }
            _ => {
                self.error(node.span, "the mapping 'triangle' needs 9 numbers as 'corners' and 6 as 'corner_uvs'");
            }
        }
        Projector::Uv
    }

    fn two_part(&mut self, node: &Node) -> Projector {
        let objects = [
            ("reflection", ObjectMap::Reflection),
            ("normal", ObjectMap::Normal),
            ("centroid", ObjectMap::Centroid),
            ("proxy_normal", ObjectMap::ProxyNormal),
        ];
        let surfaces = [
            ("plane", Intermediary::Plane),
            ("cylinder", Intermediary::Cylinder),
            ("sphere", Intermediary::Sphere),
            ("cube", Intermediary::Cube),
        ];
        Projector::TwoPart(self.choice(node, "object_map", &objects), self.choice(node, "surface", &surfaces))
    }
}
