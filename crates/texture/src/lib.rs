#![doc = include_str!("../README.md")]

pub mod adjust;
pub mod card;
mod detail;
pub mod distance_field;
mod eval;
mod ewa;
pub mod exact;
pub mod filter;
pub mod formula;
pub mod grid;
pub mod image;
mod integers;
pub mod kernel;
pub mod levels;
pub mod mapping;
pub mod noise;
mod one_tap;
pub mod own;
pub mod pages;
pub mod pattern;
pub mod ramp;
pub mod sample;
pub mod store;
pub mod summed;
pub mod triplanar;
pub mod wrap;

#[cfg(test)]
mod image_tests;

pub use adjust::Adjust;
pub use distance_field::DistanceField;
pub use filter::Filter;
pub use formula::FormulaTexture;
pub use grid::GridTexture;
pub use image::ImageTexture;
pub use mapping::Mapping;
pub use own::{OwnTexture, OwnValue};
pub use pattern::{Pattern, PatternTexture};
use std::{
    collections::{BTreeSet, HashMap, HashSet},
    sync::Arc,
};
use steradian_math::{
    Spectrum, Vec2, Vec3,
    hash::mix32,
    spectra::{
        ColorMode, Spd, Wavelengths,
        role::{Color, Role},
    },
};
pub use triplanar::Triplanar;
pub use wrap::Wrap;

/// Domain of a mesh attribute: the elements that have one value each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Domain {
    /// Vertex; values are interpolated.
    Vertex,
    /// Face.
    Face,
}

/// Named values that a mesh carries, at a triangle and the barycentric coordinates of its second and third vertex.
pub trait MeshAttributes: std::fmt::Debug + Sync {
    /// An attribute's value (padded with zeros) and channel count; `None` where there is none of this name and domain.
    fn attribute(&self, name: &str, domain: Option<Domain>, triangle: u32, uv: Vec2) -> Option<([f32; 4], usize)>;

    /// The reflectance of an attribute whose spectra were made beforehand.
    fn attribute_spectrum(
        &self,
        name: &str,
        domain: Option<Domain>,
        triangle: u32,
        uv: Vec2,
        lambda: &Wavelengths,
    ) -> Option<Spectrum>;

    /// Change of the barycentric coordinates for a change of the surface's parameters.
    fn barycentric_change(&self, triangle: u32, duv: Vec2) -> Vec2;
}

/// Point at which a texture is looked up.
#[derive(Clone, Copy, Debug)]
pub struct TextureContext<'a> {
    /// World-space point.
    pub p: Vec3,
    /// Surface parameters.
    pub uv: Vec2,
    /// Unit shading normal; zero where there is no surface.
    pub n: Vec3,
    /// Unit direction to the viewer; zero where there is none.
    pub wo: Vec3,
    /// Place in the shutter interval, [0, 1).
    pub time: f32,
    /// Footprint of the lookup.
    pub footprint: Footprint,
    /// Variance of the slopes along u and v that a normal map has within the footprint, where it counts as roughness.
    pub slopes: Vec2,
    /// The mesh, the triangle and the barycentric coordinates of its second and third vertex, where the surface is a
    /// mesh.
    pub mesh: Option<(&'a dyn MeshAttributes, u32, Vec2)>,
}

/// Footprint of one pixel on a surface, to first order: derivatives by the pixel's x and y. Zero is a point.
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

impl Footprint {
    /// A point without extent.
    pub const POINT: Self = Self { dpdx: Vec3::ZERO, dpdy: Vec3::ZERO, duvdx: Vec2::ZERO, duvdy: Vec2::ZERO };

    /// The footprint of two displacements in the tangent plane; the parameters change by least squares.
    /// Parametrisations that are degenerate, and displacements out of range, give none.
    pub fn new(dpdx: Vec3, dpdy: Vec3, dpdu: Vec3, dpdv: Vec3) -> Self {
        // A change of a million periods averages over everything.
        const MOST: f32 = 1e6;
        if !(dpdx.is_finite() && dpdy.is_finite()) {
            return Self::POINT;
        }
        let (uu, uv, vv) = (dpdu.dot(dpdu), dpdu.dot(dpdv), dpdv.dot(dpdv));
        let det = uu * vv - uv * uv;
        let solve = |dp: Vec3| {
            let (u, v) = (dpdu.dot(dp), dpdv.dot(dp));
            let duv = Vec2::new(vv * u - uv * v, uu * v - uv * u) / det;
            if duv.is_finite() { duv.clamp(Vec2::splat(-MOST), Vec2::splat(MOST)) } else { Vec2::ZERO }
        };
        Self { dpdx, dpdy, duvdx: solve(dpdx), duvdy: solve(dpdy) }
    }
}

impl TextureContext<'_> {
    /// Context without a point, for textures that need none.
    pub const NOWHERE: Self = Self {
        p: Vec3::ZERO,
        uv: Vec2::ZERO,
        n: Vec3::ZERO,
        wo: Vec3::ZERO,
        time: 0.0,
        footprint: Footprint::POINT,
        slopes: Vec2::ZERO,
        mesh: None,
    };

    /// A lookup at a point in space with surface parameters, without a surface.
    pub fn new(p: Vec3, uv: Vec2) -> Self {
        Self { p, uv, ..Self::NOWHERE }
    }
}

impl TextureContext<'_> {
    /// Roughnesses α along u and v, with the slopes that the footprint hides.
    #[inline]
    pub fn roughened(&self, u: f32, v: f32) -> (f32, f32) {
        if self.slopes == Vec2::ZERO {
            return (u, v);
        }
        ((u * u + 2.0 * self.slopes.x).sqrt(), (v * v + 2.0 * self.slopes.y).sqrt())
    }
}

/// Index of a texture in [`Textures`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TextureId(pub u32);

/// One texture; parts of trees have smaller ids than what uses them.
#[derive(Clone, Debug)]
pub enum Texture {
    /// One value everywhere.
    Constant(Color),
    /// A picture.
    Image(Arc<ImageTexture>),
    /// The coverage of a mask by its distance field.
    DistanceField(Arc<DistanceField>),
    /// Numbers on a grid of space.
    Grid(Arc<GridTexture>),
    /// A procedural pattern.
    Pattern(Arc<PatternTexture>),
    /// Product.
    Scale(TextureId, TextureId),
    /// Sum.
    Add(TextureId, TextureId),
    /// Interpolation from the first to the second by the third, which may lead beyond either.
    Mix(TextureId, TextureId, TextureId),
    /// Three textures, blended by how much the surface faces the axes.
    Triplanar([TextureId; 3], Box<Triplanar>),
    /// A formula.
    Formula(Arc<FormulaTexture>),
    /// A texture of a program's own, at the point that a mapping gives.
    Own(Arc<dyn OwnTexture>, Box<Mapping>),
    /// The moment of the exposure.
    Time,
    /// A colour, changed.
    Adjust(TextureId, Box<Adjust>),
    /// Data on the mesh.
    MeshAttribute {
        /// The attribute's name, without domain prefix.
        name: Arc<str>,
        /// Domain of the attribute; `None` for either.
        domain: Option<Domain>,
        /// Factor.
        scale: f32,
    },
}

impl Texture {
    /// Textures that it is made of.
    fn parts(&self) -> [Option<&TextureId>; 3] {
        match self {
            Self::Constant(_)
            | Self::Image(_)
            | Self::DistanceField(_)
            | Self::MeshAttribute { .. }
            | Self::Grid(_)
            | Self::Pattern(_)
            | Self::Formula(_)
            | Self::Own(..)
            | Self::Time => [None; 3],
            Self::Scale(a, b) | Self::Add(a, b) => [Some(a), Some(b), None],
            Self::Mix(a, b, amount) => [Some(a), Some(b), Some(amount)],
            Self::Triplanar(parts, _) => parts.each_ref().map(Some),
            Self::Adjust(part, _) => [Some(part), None, None],
        }
    }

    fn parts_mut(&mut self) -> [Option<&mut TextureId>; 3] {
        match self {
            Self::Constant(_)
            | Self::Image(_)
            | Self::DistanceField(_)
            | Self::MeshAttribute { .. }
            | Self::Grid(_)
            | Self::Pattern(_)
            | Self::Formula(_)
            | Self::Own(..)
            | Self::Time => [None, None, None],
            Self::Scale(a, b) | Self::Add(a, b) => [Some(a), Some(b), None],
            Self::Mix(a, b, amount) => [Some(a), Some(b), Some(amount)],
            Self::Triplanar(parts, _) => parts.each_mut().map(Some),
            Self::Adjust(part, _) => [Some(part), None, None],
        }
    }
}

/// All textures of a scene.
#[derive(Clone, Debug, Default)]
pub struct Textures {
    nodes: Vec<Texture>,
    efforts: Vec<LookupCost>,
    /// Linear Rec.709 of constants that are spectra.
    rgbs: HashMap<u32, Vec3>,
    mode: ColorMode,
}

/// Cost of evaluating a texture at a point. Parts that are shared count each time they are met, so it may be far more
/// than there are textures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LookupCost {
    /// Textures met; held at the limit of the type.
    pub lookups: u32,
    /// True if any of them is averaged over footprints.
    pub is_filtered: bool,
}

/// Most textures met in one evaluation, in scenes from files: more would take longer than a picture is worth.
pub const MAX_LOOKUPS: u32 = 1 << 16;

impl Textures {
    /// An empty set for a colour mode.
    pub fn new(mode: ColorMode) -> Self {
        Self { mode, ..Self::default() }
    }

    /// True if any texture changes over the exposure.
    pub fn is_timed(&self) -> bool {
        self.nodes.iter().any(|t| match t {
            Texture::Time => true,
            Texture::Formula(formula) => formula.is_timed(),
            Texture::Own(own, _) => own.is_timed(),
            _ => false,
        })
    }

    /// Meaning of the lanes of values.
    pub fn mode(&self) -> ColorMode {
        self.mode
    }

    /// Adds a texture whose parts are already there.
    pub fn add(&mut self, texture: Texture) -> TextureId {
        let is_filtered = match &texture {
            Texture::Image(image) => image.filter.is_prefiltered(),
            Texture::DistanceField(_) => true,
            Texture::Pattern(pattern) => pattern.is_filtered(),
            Texture::Own(own, _) => own.is_filtered(),
            _ => false,
        };
        let mut effort = LookupCost { lookups: 1, is_filtered };
        for part in texture.parts().into_iter().flatten().map(|id| self.effort(*id)) {
            effort.lookups = effort.lookups.saturating_add(part.lookups);
            effort.is_filtered |= part.is_filtered;
        }
        if let Texture::Constant(Color::Spectral(spectrum)) = &texture {
            let role = if matches!(spectrum, Spd::Illuminant(_)) { Role::Illuminant } else { Role::Unbounded };
            if let Color::Lanes(rgb) = Color::curve(spectrum, role, ColorMode::Rgb) {
                self.rgbs.insert(self.nodes.len() as u32, Vec3::from(rgb.to_rgb()));
            }
        }
        self.nodes.push(texture);
        self.efforts.push(effort);
        TextureId(self.nodes.len() as u32 - 1)
    }

    /// A copy of a tree of textures, each changed by `change`. Trees that are too large to evaluate are not copied.
    pub fn rewritten(&mut self, root: TextureId, change: impl Fn(&mut Texture)) -> TextureId {
        if self.effort(root).lookups > MAX_LOOKUPS {
            return root;
        }
        let mut met = BTreeSet::new();
        let mut stack = vec![root];
        while let Some(id) = stack.pop() {
            if met.insert(id.0) {
                stack.extend(self.nodes[id.0 as usize].parts().into_iter().flatten());
            }
        }
        // Parts have smaller ids, so they are copied first.
        let mut copies = HashMap::new();
        for id in met {
            let mut copy = self.nodes[id as usize].clone();
            for part in copy.parts_mut().into_iter().flatten() {
                *part = copies.get(&part.0).copied().unwrap_or(*part);
            }
            change(&mut copy);
            copies.insert(id, self.add(copy));
        }
        copies.get(&root.0).copied().unwrap_or(root)
    }

    /// True if any texture is averaged over footprints.
    pub fn is_filtered(&self) -> bool {
        self.efforts.iter().any(|e| e.is_filtered)
    }

    /// Bytes of the textures and of the pictures and grids that they keep in memory, each once.
    pub fn bytes(&self) -> usize {
        let mut seen = HashSet::new();
        let mut once = |address: usize, bytes: usize| if seen.insert(address) { bytes } else { 0 };
        let pictures = self.nodes.iter().map(|t| match t {
            Texture::Image(image) => {
                let sums = image.sums.as_ref().map_or(0, |s| once(Arc::as_ptr(s).addr(), s.byte_size()));
                once(Arc::as_ptr(&image.levels).addr(), image.levels.resident_bytes()) + sums
            }
            Texture::DistanceField(field) => {
                once(Arc::as_ptr(&field.image.levels).addr(), field.image.levels.resident_bytes())
            }
            Texture::Grid(grid) => once(Arc::as_ptr(&grid.grid).addr(), size_of_val(&grid.grid.data[..])),
            _ => 0,
        });
        pictures.sum::<usize>() + size_of_val(&self.nodes[..])
    }

    /// Cost of evaluating a texture.
    pub fn effort(&self, id: TextureId) -> LookupCost {
        self.efforts[id.0 as usize]
    }

    /// The texture with this id.
    pub fn get(&self, id: TextureId) -> &Texture {
        &self.nodes[id.0 as usize]
    }

    /// Number of textures.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// True if there are no textures.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }
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
    /// True if it is the same everywhere.
    pub fn is_constant(&self) -> bool {
        matches!(self, Self::Constant(_))
    }

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
    /// True if it is the same everywhere.
    pub fn is_constant(&self) -> bool {
        matches!(self, Self::Constant(_))
    }

    /// The value at a point.
    #[inline]
    pub fn eval(&self, textures: &Textures, at: &TextureContext) -> f32 {
        match self {
            Self::Constant(v) => *v,
            Self::Texture(id) => textures.float(*id, at),
        }
    }
}

/// A number in `[0, 1)` from a point and a direction: decisions at a surface (alpha, mixtures) that must come out the
/// same whenever the same ray meets the same point.
#[inline]
pub fn hash_point(p: Vec3, d: Vec3, salt: u32) -> f32 {
    let mut h = salt;
    for v in [p.x, p.y, p.z, d.x, d.y, d.z] {
        h = mix32(h ^ v.to_bits().wrapping_mul(0x9e37_79b9));
    }
    steradian_math::hash::unit_f32(h)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_change_with_the_tangents() {
        let (u, v) = (Vec3::new(2.0, 0.0, 0.0), Vec3::new(1.0, 4.0, 0.0));
        let f = Footprint::new(u * 0.5 + v * 0.25, v * -2.0, u, v);
        assert!((f.duvdx - Vec2::new(0.5, 0.25)).length() < 1e-6 && (f.duvdy - Vec2::new(0.0, -2.0)).length() < 1e-6);
        // Degenerate parametrisations, and what is out of range, have no extent.
        assert_eq!(Footprint::new(Vec3::X, Vec3::Y, Vec3::X, Vec3::X).duvdx, Vec2::ZERO);
        assert_eq!(Footprint::new(Vec3::splat(f32::NAN), Vec3::Y, Vec3::X, Vec3::Y), Footprint::POINT);
    }
}
