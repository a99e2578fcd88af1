//! Samplers: coordinates to texels to colours.

use glam::{Vec2, Vec3, Vec4};

use super::{TextureKind, TextureView, cube};
use crate::{
    error::{Result, refuse},
    format::Numeric,
    state::Compare,
};

/// Addressing of coordinates beyond 0 and 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wrap {
    /// The texture again.
    Repeat,
    /// The texture turned round, and so on.
    Mirror,
    /// Turned round once, then its border texels.
    MirrorOnce,
    /// The texels at its border.
    ClampToEdge,
    /// The border colour.
    ClampToBorder,
}

impl Wrap {
    /// The texel for a number that may be outside 0…n − 1; `None` for the border colour.
    #[inline(always)]
    pub(super) fn texel(self, i: i64, n: i64) -> Option<u32> {
        let inside = |i: i64| i.clamp(0, n - 1);
        let at = match self {
            Self::Repeat if n & (n - 1) == 0 => i & (n - 1),
            Self::Repeat => i.rem_euclid(n),
            Self::Mirror => {
                // Period 2n: forwards, then backwards.
                let i = i.rem_euclid(2 * n);
                if i < n { i } else { 2 * n - 1 - i }
            }
            Self::MirrorOnce => inside(if i < 0 { -1 - i } else { i }),
            Self::ClampToEdge => inside(i),
            Self::ClampToBorder if i < 0 || i >= n => return None,
            Self::ClampToBorder => i,
        };
        Some(at as u32)
    }
}

/// Filter over texels, or over levels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Filter {
    /// The nearest.
    Nearest,
    /// Weighted by distance.
    Linear,
}

/// Which level of detail is meant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lod {
    /// This one; 0 is the finest.
    Level(f32),
    /// Level for these derivatives of the coordinates from pixel to pixel, in x and in y (GLSL: `textureGrad`).
    Gradients(Vec3, Vec3),
}

/// Addressing and filtering of texture lookups.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampler {
    /// Beyond 0 and 1 in each dimension.
    pub wrap: [Wrap; 3],
    /// Filter for texels that are larger than pixels.
    pub magnify: Filter,
    /// Filter for texels that are smaller than pixels.
    pub minify: Filter,
    /// Between levels; without, level 0 alone.
    pub levels: Option<Filter>,
    /// Added to the level of detail.
    pub lod_bias: f32,
    /// Limits of the level of detail.
    pub lod_range: [f32; 2],
    /// The most samples along the longer axis of a pixel's footprint; 1 for none. Needs gradients.
    pub anisotropy: u32,
    /// The colour beyond the border.
    pub border: Vec4,
    /// The comparison of [`compare`](Self::compare).
    pub compare: Compare,
}

impl Default for Sampler {
    fn default() -> Self {
        Self {
            wrap: [Wrap::Repeat; 3],
            magnify: Filter::Linear,
            minify: Filter::Linear,
            levels: Some(Filter::Linear),
            lod_bias: 0.0,
            lod_range: [-1000.0, 1000.0],
            anisotropy: 1,
            border: Vec4::ZERO,
            compare: Compare::LessEqual,
        }
    }
}

impl Sampler {
    /// The nearest texel of level 0, and those at the border beyond it.
    pub const NEAREST: Self = Self {
        wrap: [Wrap::ClampToEdge; 3],
        magnify: Filter::Nearest,
        minify: Filter::Nearest,
        levels: None,
        lod_bias: 0.0,
        lod_range: [-1000.0, 1000.0],
        anisotropy: 1,
        border: Vec4::ZERO,
        compare: Compare::LessEqual,
    };

    /// Checks that this sampler may look up this view.
    ///
    /// # Errors
    /// For filters of formats that cannot be averaged, buffers, samples, rectangles with levels or repetition, and
    /// values that are no numbers.
    pub fn check(&self, view: &TextureView) -> Result<()> {
        const CALL: &str = "Sampler::check";
        let linear = [self.magnify, self.minify].contains(&Filter::Linear) || self.levels == Some(Filter::Linear);
        if linear && !view.format.is_filterable() {
            return refuse(CALL, format!("{:?} cannot be averaged; the filters must be Nearest", view.format));
        }
        if view.kind == TextureKind::Buffer {
            return refuse(CALL, "buffers are fetched, not sampled");
        }
        if view.kind.is_multisample() {
            return refuse(CALL, "samples are fetched, not filtered");
        }
        let clamps = |wrap: &Wrap| matches!(wrap, Wrap::ClampToEdge | Wrap::ClampToBorder);
        if view.kind == TextureKind::Rectangle && (self.levels.is_some() || !self.wrap[..2].iter().all(clamps)) {
            return refuse(CALL, "rectangles have one level, and coordinates beyond are clamped");
        }
        if self.lod_bias.is_nan() || self.lod_range.iter().any(|x| x.is_nan()) || self.lod_range[0] > self.lod_range[1]
        {
            return refuse(CALL, format!("levels from {:?} with bias {}", self.lod_range, self.lod_bias));
        }
        if self.anisotropy == 0 || self.anisotropy > 16 {
            return refuse(CALL, format!("anisotropy {}; from 1 to 16", self.anisotropy));
        }
        Ok(())
    }

    /// The colour at coordinates: (s), (s, layer), (s, t), (s, t, layer), (s, t, r), a direction, or a direction and a
    /// layer. Those of rectangles are in texels.
    pub fn sample(&self, view: &TextureView, at: Vec4, lod: Lod) -> Vec4 {
        self.lookup(view, at, lod, &|texel| texel)
    }

    /// Share of the texels that pass the comparison of `reference` with them, filtered: 1 if all do.
    pub fn compare(&self, view: &TextureView, at: Vec4, reference: f32, lod: Lod) -> f32 {
        // References are clamped for fixed-point depths, whose values lie in [0, 1].
        let fixed = view.format.numeric() == Numeric::Depth && view.format.bits()[0] != 32;
        let reference = if fixed { reference.clamp(0.0, 1.0) } else { reference };
        self.lookup(view, at, lod, &|texel| Vec4::splat(f32::from(u8::from(self.compare.passes(reference, texel.x))))).x
    }

    #[inline]
    fn lookup(&self, view: &TextureView, at: Vec4, lod: Lod, value: &impl Fn(Vec4) -> Vec4) -> Vec4 {
        let place = Place::new(view, at);
        let (lod, samples, axis) = match lod {
            Lod::Level(level) => (level, 1, Vec3::ZERO),
            Lod::Gradients(dx, dy) => self.footprint(view, &place, dx, dy),
        };
        // λ = λ_base + bias, clamped to the range of the sampler.
        let lod = (lod + self.lod_bias).clamp(self.lod_range[0], self.lod_range[1]);
        let lod = if lod.is_nan() { 0.0 } else { lod };
        if samples == 1 {
            return self.at_lod(view, &place, lod, value);
        }
        let mut sum = Vec4::ZERO;
        // Average samples spread evenly along the longer axis of the footprint.
        for i in 0..samples {
            let along = (i as f32 + 0.5) / samples as f32 - 0.5;
            let moved = Place { at: place.at + axis * along, ..place };
            sum += self.at_lod(view, &moved, lod, value);
        }
        sum / samples as f32
    }

    /// Level of detail, number of samples and the axis they lie along (OpenGL 4.6, sections 8.14.1;
    /// `EXT_texture_filter_anisotropic`).
    #[inline]
    fn footprint(&self, view: &TextureView, place: &Place, dx: Vec3, dy: Vec3) -> (f32, u32, Vec3) {
        let size = view.size(0);
        let texels = match view.kind {
            TextureKind::Rectangle => Vec3::ONE,
            _ => Vec3::new(size.width as f32, size.height as f32, size.depth as f32),
        };
        // Lengths of the footprint's axes in texels of level 0.
        let (dx, dy) = place.on_face(dx, dy);
        if self.anisotropy == 1 {
            let longer = (dx * texels).length_squared().max((dy * texels).length_squared()).sqrt();
            return (longer.log2(), 1, Vec3::ZERO);
        }
        let (px, py) = ((dx * texels).length(), (dy * texels).length());
        let (longer, shorter) = (px.max(py), px.min(py));
        // N = ⌈ρ_max/ρ_min⌉ samples, at most the limit; where that bites, the shorter axis is taken to be longer.
        let samples = if longer > 0.0 {
            (longer / shorter.max(longer / self.anisotropy as f32)).ceil().clamp(1.0, self.anisotropy as f32)
        } else {
            1.0
        };
        let axis = if samples > 1.0 { if px > py { dx } else { dy } } else { Vec3::ZERO };
        // λ = log₂(ρ_max/N).
        ((longer / samples).log2(), samples as u32, axis)
    }

    #[inline]
    fn at_lod(&self, view: &TextureView, place: &Place, lod: f32, value: &impl Fn(Vec4) -> Vec4) -> Vec4 {
        // Magnification: a texel covers more than a pixel.
        if lod <= 0.0 {
            return self.at_level(view, place, 0, self.magnify, value);
        }
        let last = view.levels - 1;
        match self.levels {
            None => self.at_level(view, place, 0, self.minify, value),
            Some(Filter::Nearest) => {
                // ⌈λ + ½⌉ − 1: the nearest, of two the finer.
                let level = ((lod + 0.5).ceil() - 1.0).min(last as f32) as u32;
                self.at_level(view, place, level, self.minify, value)
            }
            Some(Filter::Linear) => {
                // Trilinear: blend the two levels on either side of λ.
                let fine = (lod as u32).min(last);
                let weight = if fine == last { 0.0 } else { lod - fine as f32 };
                let first = self.at_level(view, place, fine, self.minify, value);
                if weight == 0.0 {
                    return first;
                }
                first.lerp(self.at_level(view, place, fine + 1, self.minify, value), weight)
            }
        }
    }

    #[inline]
    fn at_level(
        &self,
        view: &TextureView,
        place: &Place,
        level: u32,
        filter: Filter,
        value: &impl Fn(Vec4) -> Vec4,
    ) -> Vec4 {
        let size = view.size(level);
        let n = [size.width, size.height, size.depth];
        let texel = |i: [i64; 3]| value(self.texel(view, place, level, n, i));
        let texels = |d: usize| if view.kind == TextureKind::Rectangle { 1.0 } else { n[d] as f32 };
        let at: [f32; 3] = std::array::from_fn(|d| place.at[d] * texels(d));
        // The texel that contains the point.
        if filter == Filter::Nearest {
            return texel(std::array::from_fn(|d| whole(at[d])));
        }
        let flat = matches!(view.kind, TextureKind::D2 | TextureKind::D2Array);
        if flat && let Some(mean) = self.bilinear(view, (level, place.layer), Vec2::new(at[0], at[1]), value) {
            return mean;
        }
        let mut first = [0; 3];
        let mut weight = [0.0; 3];
        for d in 0..place.dimensions {
            // Texel centres are at halves.
            let u = at[d] - 0.5;
            first[d] = whole(u);
            weight[d] = if u.is_finite() { u - u.floor() } else { 0.0 };
        }
        let mut sum = Vec4::ZERO;
        // Multilinear: 2^d texels, each weighted by the product of its distances.
        for corner in 0..1usize << place.dimensions {
            let bit = |d: usize| corner >> d & 1;
            let w: f32 = (0..place.dimensions).map(|d| if bit(d) == 1 { weight[d] } else { 1.0 - weight[d] }).product();
            if w > 0.0 {
                sum +=
                    texel(std::array::from_fn(|d| first[d] + if d < place.dimensions { bit(d) as i64 } else { 0 })) * w;
            }
        }
        sum
    }

    /// The texel of these numbers, which may be outside.
    fn texel(&self, view: &TextureView, place: &Place, level: u32, n: [u32; 3], i: [i64; 3]) -> Vec4 {
        if let Some(face) = place.face {
            let inside = |d: usize| (0..i64::from(n[d])).contains(&i[d]);
            if inside(0) && inside(1) {
                return view.fetch(level, [i[0] as u32, i[1] as u32, 0], place.layer * 6 + face);
            }
            // Beyond the border the neighbour face goes on.
            let centre = |d: usize| (i[d] as f32 + 0.5) / n[d] as f32;
            let (face, at) = cube::face(cube::direction(face, [centre(0), centre(1)]));
            let near = |d: usize| whole(at[d] * n[d] as f32).clamp(0, i64::from(n[d]) - 1) as u32;
            return view.fetch(level, [near(0), near(1), 0], place.layer * 6 + face);
        }
        let mut at = [0; 3];
        for d in 0..place.dimensions {
            match self.wrap[d].texel(i[d], i64::from(n[d])) {
                Some(texel) => at[d] = texel,
                None => return self.border,
            }
        }
        view.fetch(level, at, place.layer)
    }
}

/// The whole part, rounded down; what is too large or no number becomes a number that wraps can take.
#[inline]
fn whole(x: f32) -> i64 {
    x.floor().clamp(-1e9, 1e9) as i64
}

/// Coordinates taken apart.
#[derive(Clone, Copy)]
struct Place {
    at: Vec3,
    dimensions: usize,
    layer: u32,
    face: Option<u32>,
    direction: Vec3,
}

impl Place {
    #[inline]
    fn new(view: &TextureView, at: Vec4) -> Self {
        // The nearest layer; halves up.
        let layer = |x: f32, count: u32| (x + 0.5).floor().clamp(0.0, (count - 1) as f32) as u32;
        let flat =
            |at: Vec3, dimensions: usize, layer: u32| Self { at, dimensions, layer, face: None, direction: Vec3::ZERO };
        match view.kind {
            TextureKind::D1 | TextureKind::Buffer => flat(Vec3::new(at.x, 0.0, 0.0), 1, 0),
            TextureKind::D1Array => flat(Vec3::new(at.x, 0.0, 0.0), 1, layer(at.y, view.layers)),
            TextureKind::D2 | TextureKind::Rectangle | TextureKind::D2Multisample => {
                flat(Vec3::new(at.x, at.y, 0.0), 2, 0)
            }
            TextureKind::D2Array | TextureKind::D2MultisampleArray => {
                flat(Vec3::new(at.x, at.y, 0.0), 2, layer(at.z, view.layers))
            }
            TextureKind::D3 => flat(at.truncate(), 3, 0),
            TextureKind::Cube | TextureKind::CubeArray => {
                let direction = at.truncate();
                let (face, [s, t]) = cube::face(direction);
                let layer = if view.kind == TextureKind::Cube { 0 } else { layer(at.w, view.layers / 6) };
                Self { at: Vec3::new(s, t, 0.0), dimensions: 2, layer, face: Some(face), direction }
            }
        }
    }

    /// Changes of the coordinates on the face of a cube, of changes of the direction; others as they are.
    #[inline]
    fn on_face(&self, dx: Vec3, dy: Vec3) -> (Vec3, Vec3) {
        let Some(face) = self.face else {
            let used =
                |d: Vec3| Vec3::from_array(std::array::from_fn(|i| if i < self.dimensions { d[i] } else { 0.0 }));
            return (used(dx), used(dy));
        };
        // s = ½(sc/|ma| + 1): the derivative of a quotient.
        // With ma the major coordinate: ds = ½(d(sc) − (sc/ma)·d(ma))/|ma|.
        let axis = (face / 2) as usize;
        let major = self.direction[axis].abs().max(1e-20);
        let [s, t] = [self.at.x, self.at.y].map(|x| 2.0 * x - 1.0);
        let change = |d: Vec3| {
            let sign = if self.direction[axis] < 0.0 { -1.0 } else { 1.0 };
            let (ds, dt) = match face {
                0 => (-d.z, -d.y),
                1 => (d.z, -d.y),
                2 => (d.x, d.z),
                3 => (d.x, -d.z),
                4 => (d.x, -d.y),
                _ => (-d.x, -d.y),
            };
            Vec3::new(ds - s * sign * d[axis], dt - t * sign * d[axis], 0.0) * (0.5 / major)
        };
        (change(dx), change(dy))
    }
}
