//! Textures: values that vary over a surface.

pub mod image;
pub mod mapping;

use crate::{
    color::{self, Color, ColorMode, Role},
    shape::mesh::TriMesh,
};
pub use image::ImageTexture;
pub use mapping::Mapping;
use std::sync::Arc;
use steradian_math::{Spectrum, Vec2, Vec3, hash::mix32, spectra::Wavelengths};
use steradian_scene::Domain;

/// The textures by name, for the registry.
pub const TEXTURES: &[(&str, &str)] = &[
    ("constant", "the same everywhere; value"),
    (
        "image",
        "a picture by bilinear (or nearest) lookup; file, filter, wrap_u, wrap_v, encoding, raw, origin, scale, invert, mapping",
    ),
    ("checkerboard", "squares or cubes of two values; a, b, dimension (2 or 3), mapping"),
    ("scale", "the product of two textures; texture, scale"),
    ("mix", "linear interpolation; a, b, amount"),
    ("mesh_attribute", "a vertex or face attribute of the mesh; name, domain, scale"),
];

/// Where a texture is looked up.
#[derive(Clone, Copy, Debug)]
pub struct TextureContext<'a> {
    /// World-space point.
    pub p: Vec3,
    /// Surface parameters.
    pub uv: Vec2,
    /// Unit shading normal; zero where there is no surface.
    pub n: Vec3,
    /// How far the lookup reaches.
    pub footprint: Footprint,
    /// The mesh, the triangle and the barycentric coordinates of its second and third vertex, where the surface is a mesh.
    pub mesh: Option<(&'a TriMesh, u32, Vec2)>,
}

/// What one pixel covers of a surface, to first order: derivatives by the pixel's x and y. Zero is a point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Footprint {
    /// World-space point by x.
    pub dpdx: Vec3,
    /// World-space point by y.
    pub dpdy: Vec3,
    /// Surface parameters by x.
    pub duvdx: Vec2,
    /// Surface parameters by y.
    pub duvdy: Vec2,
}

impl TextureContext<'_> {
    /// A lookup at a point in space with surface parameters, without a surface.
    pub fn new(p: Vec3, uv: Vec2) -> Self {
        Self { p, uv, n: Vec3::ZERO, footprint: Footprint::default(), mesh: None }
    }
}

/// Index of a texture in [`Textures`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TextureId(pub u32);

/// One texture; parts of trees have smaller ids than what uses them.
#[derive(Clone, Debug)]
pub enum Texture {
    /// The same everywhere.
    Constant(Color),
    /// A picture.
    Image(Arc<ImageTexture>),
    /// Two values in alternating cells.
    Checkerboard {
        /// Where the sum of cell indices is even.
        a: TextureId,
        /// Where it is odd.
        b: TextureId,
        /// Cells of space instead of the surface.
        solid: bool,
        /// Where the lookup takes place.
        mapping: Mapping,
    },
    /// Product.
    Scale(TextureId, TextureId),
    /// Interpolation from the first to the second by the third.
    Mix(TextureId, TextureId, TextureId),
    /// Data on the mesh.
    MeshAttribute {
        /// The attribute's name, without domain prefix.
        name: Arc<str>,
        /// What it has one value per; `None` for either.
        domain: Option<Domain>,
        /// Factor.
        scale: f32,
    },
}

/// All textures of a scene.
#[derive(Clone, Debug, Default)]
pub struct Textures {
    nodes: Vec<Texture>,
    efforts: Vec<Effort>,
    mode: ColorMode,
}

/// What it takes to evaluate a texture at a point. Parts that are shared count each time they are met, so it may be far more than
/// there are textures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Effort {
    /// Textures met; held at the limit of the type.
    pub lookups: u32,
    /// The longest chain of textures in textures.
    pub depth: u32,
}

/// Deepest tree of textures.
pub const MAX_DEPTH: usize = 64;

/// Most textures met in one evaluation.
pub const MAX_LOOKUPS: u32 = 4096;

impl Textures {
    /// An empty set for a colour mode.
    pub fn new(mode: ColorMode) -> Self {
        Self { nodes: Vec::new(), efforts: Vec::new(), mode }
    }

    /// What the lanes of values are.
    pub fn mode(&self) -> ColorMode {
        self.mode
    }

    /// Adds a texture whose parts are already there.
    pub fn add(&mut self, texture: Texture) -> TextureId {
        let parts = match texture {
            Texture::Constant(_) | Texture::Image(_) | Texture::MeshAttribute { .. } => [None; 3],
            Texture::Checkerboard { a, b, .. } | Texture::Scale(a, b) => [Some(a), Some(b), None],
            Texture::Mix(a, b, amount) => [Some(a), Some(b), Some(amount)],
        };
        let mut effort = Effort { lookups: 1, depth: 1 };
        for part in parts.into_iter().flatten().map(|id| self.effort(id)) {
            effort.lookups = effort.lookups.saturating_add(part.lookups);
            effort.depth = effort.depth.max(part.depth.saturating_add(1));
        }
        self.nodes.push(texture);
        self.efforts.push(effort);
        TextureId(self.nodes.len() as u32 - 1)
    }

    /// What it takes to evaluate a texture.
    pub fn effort(&self, id: TextureId) -> Effort {
        self.efforts[id.0 as usize]
    }

    /// The texture with this id.
    pub fn get(&self, id: TextureId) -> &Texture {
        &self.nodes[id.0 as usize]
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// The spectral value at a point. `role` says what RGB texels stand for.
    pub fn spectrum(&self, id: TextureId, at: &TextureContext, role: Role, lambda: &Wavelengths) -> Spectrum {
        match &self.nodes[id.0 as usize] {
            Texture::Constant(c) => c.eval(lambda),
            Texture::Image(image) => match image.rgb(at) {
                Some(rgb) => color::texel(rgb, role, lambda, self.mode),
                None => Spectrum::ZERO,
            },
            Texture::Checkerboard { a, b, solid, mapping } => {
                self.spectrum(if checker_is_even(*solid, mapping, at) { *a } else { *b }, at, role, lambda)
            }
            Texture::Scale(a, b) => {
                self.spectrum(*a, at, role, lambda) * self.spectrum(*b, at, Role::Unbounded, lambda)
            }
            Texture::Mix(a, b, amount) => match self.float(*amount, at) {
                t if t <= 0.0 => self.spectrum(*a, at, role, lambda),
                t if t >= 1.0 => self.spectrum(*b, at, role, lambda),
                t => self.spectrum(*a, at, role, lambda).lerp(self.spectrum(*b, at, role, lambda), t),
            },
            Texture::MeshAttribute { name, domain, scale } => match attribute(name, *domain, at) {
                Some((v, 1)) => Spectrum::splat(v[0] * scale),
                Some((v, _)) => color::texel(Vec3::new(v[0], v[1], v[2]) * *scale, role, lambda, self.mode),
                None => Spectrum::ZERO,
            },
        }
    }

    /// The scalar value at a point: the mean of the components of coloured textures.
    pub fn float(&self, id: TextureId, at: &TextureContext) -> f32 {
        match &self.nodes[id.0 as usize] {
            Texture::Constant(c) => match (c, self.mode) {
                (Color::Lanes(s), ColorMode::Rgb) => (s[0] + s[1] + s[2]) / 3.0,
                (Color::Lanes(s), ColorMode::Spectral) => s[0],
                (c, _) => c.luminance(self.mode),
            },
            Texture::Image(image) => image.float(at),
            Texture::Checkerboard { a, b, solid, mapping } => {
                self.float(if checker_is_even(*solid, mapping, at) { *a } else { *b }, at)
            }
            Texture::Scale(a, b) => self.float(*a, at) * self.float(*b, at),
            Texture::Mix(a, b, amount) => {
                let t = self.float(*amount, at);
                self.float(*a, at) * (1.0 - t) + self.float(*b, at) * t
            }
            Texture::MeshAttribute { name, domain, scale } => match attribute(name, *domain, at) {
                Some((v, 1)) => v[0] * scale,
                Some((v, _)) => (v[0] + v[1] + v[2]) / 3.0 * scale,
                None => 0.0,
            },
        }
    }
}

fn checker_is_even(solid: bool, mapping: &Mapping, at: &TextureContext) -> bool {
    let cell = |v: f32| v.floor() as i64;
    let sum = if solid {
        let p = mapping.solid(at.p);
        cell(p.x).wrapping_add(cell(p.y)).wrapping_add(cell(p.z))
    } else {
        let uv = mapping.uv(at);
        cell(uv.x).wrapping_add(cell(uv.y))
    };
    sum & 1 == 0
}

fn attribute(name: &str, domain: Option<Domain>, at: &TextureContext) -> Option<([f32; 4], usize)> {
    let (mesh, triangle, uv) = at.mesh?;
    mesh.attribute(name, domain, triangle, uv)
}

/// A spectral parameter: one colour, or a texture in a role.
#[derive(Clone, Debug)]
pub enum SpectrumTexture {
    /// One colour.
    Constant(Color),
    /// A texture.
    Texture(TextureId, Role),
}

impl SpectrumTexture {
    /// The value at a point.
    #[inline]
    pub fn eval(&self, textures: &Textures, at: &TextureContext, lambda: &Wavelengths) -> Spectrum {
        match self {
            Self::Constant(c) => c.eval(lambda),
            Self::Texture(id, role) => textures.spectrum(*id, at, *role, lambda),
        }
    }
}

/// A scalar parameter: one number, or a texture.
#[derive(Clone, Copy, Debug)]
pub enum FloatTexture {
    /// One number.
    Constant(f32),
    /// A texture.
    Texture(TextureId),
}

impl FloatTexture {
    /// The value at a point.
    #[inline]
    pub fn eval(&self, textures: &Textures, at: &TextureContext) -> f32 {
        match self {
            Self::Constant(v) => *v,
            Self::Texture(id) => textures.float(*id, at),
        }
    }
}

/// A number in `[0, 1)` from a point and a direction: decisions at a surface (alpha, mixtures) that must come out the same whenever
/// the same ray meets the same point.
#[inline]
pub fn hash_point(p: Vec3, d: Vec3, salt: u32) -> f32 {
    let mut h = salt;
    for v in [p.x, p.y, p.z, d.x, d.y, d.z] {
        h = mix32(h ^ v.to_bits().wrapping_mul(0x9e37_79b9));
    }
    steradian_math::hash::unit_f32(h)
}
