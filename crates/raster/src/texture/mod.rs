//! Textures: pictures that shaders look up.

mod bilinear;
mod builder;
mod cube;
mod sampler;
mod view;

pub use builder::TextureBuilder;
pub use sampler::{Filter, Lod, Sampler, Wrap};
pub use view::{TextureView, ViewRange};

use glam::Vec4;

use crate::{
    error::{Result, refuse},
    format::{Format, Numeric},
    output::Class,
    render_target::{ColorTarget, DepthTarget, MAX_LAYERS},
    state::{MAX_SIZE, Multisample},
};

/// The dimensions of a texture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TextureKind {
    /// A row.
    D1,
    /// Rows.
    D1Array,
    /// A picture.
    D2,
    /// Pictures.
    D2Array,
    /// A volume.
    D3,
    /// Six square pictures: +x, −x, +y, −y, +z, −z.
    Cube,
    /// Six for each layer.
    CubeArray,
    /// A picture of one level, whose coordinates are texels.
    Rectangle,
    /// A picture with samples.
    D2Multisample,
    /// Pictures with samples.
    D2MultisampleArray,
    /// Texels without filter, wrap or levels, as many as a buffer holds.
    Buffer,
}

/// Size of a texture: texels in x, y and z, and layers (faces count as layers).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TextureSize {
    /// Columns.
    pub width: u32,
    /// Rows; 1 in one dimension.
    pub height: u32,
    /// Slices; 1 but in volumes.
    pub depth: u32,
    /// Layers; 6 for each cube.
    pub layers: u32,
}

impl TextureSize {
    /// A picture of one layer.
    pub const fn d2(width: u32, height: u32) -> Self {
        Self { width, height, depth: 1, layers: 1 }
    }

    /// The size of a level: halves, rounded down, at least 1; layers stay.
    pub const fn level(self, level: u32) -> Self {
        const fn half(x: u32, level: u32) -> u32 {
            // max(1, ⌊size/2^level⌋); shifts beyond the width of a word leave nothing.
            let x = if level > 31 { 0 } else { x >> level };
            if x == 0 { 1 } else { x }
        }
        Self {
            width: half(self.width, level),
            height: half(self.height, level),
            depth: half(self.depth, level),
            ..self
        }
    }

    /// Number of levels down to one texel.
    pub fn levels(self) -> u32 {
        // ⌊log₂ of the largest side⌋ + 1.
        32 - self.width.max(self.height).max(self.depth).max(1).leading_zeros()
    }

    fn texels(self) -> u64 {
        u64::from(self.width) * u64::from(self.height) * u64::from(self.depth) * u64::from(self.layers)
    }
}

impl TextureKind {
    /// True for textures with samples.
    pub const fn is_multisample(self) -> bool {
        matches!(self, Self::D2Multisample | Self::D2MultisampleArray)
    }

    /// True for textures that may have more than one level.
    pub const fn has_levels(self) -> bool {
        !matches!(self, Self::Buffer | Self::Rectangle) && !self.is_multisample()
    }

    /// Checks that a texture of this kind may have this size.
    pub(crate) fn check(self, size: TextureSize, call: &'static str) -> Result<()> {
        let TextureSize { width, height, depth, layers } = size;
        let most = if self == Self::Buffer { 1 << 27 } else { MAX_SIZE };
        if [width, height, depth, layers].contains(&0)
            || width > most
            || height > MAX_SIZE
            || depth > 2048
            || layers > MAX_LAYERS
        {
            return refuse(
                call,
                format!("{size:?}: sides are from 1 to {MAX_SIZE}, slices and layers to {MAX_LAYERS}"),
            );
        }
        let flat = depth == 1;
        // Each kind has the dimensions and layers of its own; faces of cubes are square.
        let fits = match self {
            Self::D1 | Self::Buffer => height == 1 && flat && layers == 1,
            Self::D1Array => height == 1 && flat,
            Self::D2 | Self::Rectangle | Self::D2Multisample => flat && layers == 1,
            Self::D2Array | Self::D2MultisampleArray => flat,
            Self::D3 => layers == 1,
            Self::Cube => flat && layers == 6 && width == height,
            Self::CubeArray => flat && layers.is_multiple_of(6) && width == height,
        };
        if !fits {
            return refuse(call, format!("{size:?} is no size of a {self:?} texture"));
        }
        if size.texels() > 1 << 29 {
            return refuse(call, format!("{} texels; at most 2²⁹", size.texels()));
        }
        Ok(())
    }
}

/// A texture with immutable storage: kind, format, size and levels are fixed, texels are not.
#[derive(Clone, Debug)]
pub struct Texture {
    kind: TextureKind,
    format: Format,
    size: TextureSize,
    /// Samples of a texel.
    samples: u32,
    /// Texels of each level: layers, slices, rows, columns, samples.
    levels: Vec<Vec<u8>>,
}

impl Texture {
    /// A texture of zero bits with so many levels.
    ///
    /// # Errors
    /// Kinds with samples, and sizes or levels that the kind does not have.
    pub fn new(kind: TextureKind, format: Format, size: TextureSize, levels: u32) -> Result<Self> {
        const CALL: &str = "Texture::new";
        if kind.is_multisample() {
            return refuse(CALL, format!("a {kind:?} texture has samples"));
        }
        Self::zero(kind, format, size, (levels, 1), CALL)
    }

    /// A texture of zero bits with samples.
    ///
    /// # Errors
    /// For kinds without samples, numbers of samples that there are none of, formats of shared exponents, and where
    /// kind and size do not fit.
    pub fn multisample(kind: TextureKind, format: Format, size: TextureSize, samples: u32) -> Result<Self> {
        const CALL: &str = "Texture::multisample";
        if !kind.is_multisample() {
            return refuse(CALL, format!("a {kind:?} texture has no samples"));
        }
        if format.numeric() == Numeric::SharedExponent {
            return refuse(CALL, format!("{format:?} cannot be drawn to"));
        }
        Multisample::check(samples, CALL)?;
        Self::zero(kind, format, size, (1, samples), CALL)
    }

    fn zero(
        kind: TextureKind,
        format: Format,
        size: TextureSize,
        (levels, samples): (u32, u32),
        call: &'static str,
    ) -> Result<Self> {
        kind.check(size, call)?;
        let most = if kind.has_levels() { size.levels() } else { 1 };
        if levels == 0 || levels > most {
            return refuse(call, format!("{levels} levels for {size:?}; from 1 to {most}"));
        }
        if size.texels() * u64::from(samples) > 1 << 29 {
            return refuse(call, format!("{} texels of {samples} samples; at most 2²⁹ in all", size.texels()));
        }
        let bytes = |level: u32| size.level(level).texels() as usize * samples as usize * format.bytes();
        Ok(Self { kind, format, size, samples, levels: (0..levels).map(|level| vec![0; bytes(level)]).collect() })
    }

    /// A picture of these colours, row by row, with all levels if `mipmapped`.
    ///
    /// # Errors
    /// Where the number of colours is not that of the texels, or the size is none.
    pub fn from_colors(format: Format, width: u32, height: u32, colors: &[Vec4], mipmapped: bool) -> Result<Self> {
        const CALL: &str = "Texture::from_colors";
        let size = TextureSize::d2(width, height);
        TextureKind::D2.check(size, CALL)?;
        if colors.len() as u64 != size.texels() {
            return refuse(CALL, format!("{} colours for {width} × {height} texels", colors.len()));
        }
        let mut texture = Self::new(TextureKind::D2, format, size, if mipmapped { size.levels() } else { 1 })?;
        for (texel, color) in texture.levels[0].chunks_exact_mut(format.bytes()).zip(colors) {
            format.write(*color, texel);
        }
        if mipmapped {
            texture.generate_levels()?;
        }
        Ok(texture)
    }

    /// The layers of a drawn target, samples averaged, as a picture, an array, or a cube of six.
    ///
    /// # Errors
    /// Where the target has no size of this kind.
    pub fn from_target(kind: TextureKind, target: &ColorTarget) -> Result<Self> {
        let extent = target.extent();
        let size = TextureSize { width: extent.width, height: extent.height, depth: 1, layers: extent.layers };
        // Resolve the samples and copy layer by layer.
        let mut texture = Self::new(kind, target.format(), size, 1)?;
        let resolved = target.resolve();
        texture.levels[0] = (0..extent.layers).flat_map(|layer| resolved.to_bytes(layer)).collect();
        Ok(texture)
    }

    /// The layers of drawn depths (first samples) as a picture, an array, or a cube of six, of floats.
    ///
    /// # Errors
    /// Where the target has no size of this kind.
    pub fn from_depths(kind: TextureKind, target: &DepthTarget) -> Result<Self> {
        let extent = target.extent();
        let size = TextureSize { width: extent.width, height: extent.height, depth: 1, layers: extent.layers };
        let mut texture = Self::new(kind, Format::Depth32Float, size, 1)?;
        let depths = (0..extent.layers).flat_map(|layer| target.to_rows(layer));
        texture.levels[0] = depths.flat_map(f32::to_le_bytes).collect();
        Ok(texture)
    }

    /// Its kind.
    pub fn kind(&self) -> TextureKind {
        self.kind
    }

    /// Its format.
    pub fn format(&self) -> Format {
        self.format
    }

    /// Its size at level 0.
    pub fn size(&self) -> TextureSize {
        self.size
    }

    /// Samples of a texel.
    pub fn samples(&self) -> u32 {
        self.samples
    }

    /// Number of levels.
    pub fn level_count(&self) -> u32 {
        self.levels.len() as u32
    }

    /// The bytes of a level: layers, slices, rows, columns, samples.
    pub fn level(&self, level: u32) -> Option<&[u8]> {
        self.levels.get(level as usize).map(Vec::as_slice)
    }

    /// The bytes of a level, to be written.
    pub fn level_mut(&mut self, level: u32) -> Option<&mut [u8]> {
        self.levels.get_mut(level as usize).map(Vec::as_mut_slice)
    }

    /// Byte offset of a texel, its first sample, in its level.
    #[inline]
    pub(crate) fn place(&self, level: u32, [x, y, z]: [u32; 3], layer: u32) -> Option<usize> {
        let size = self.size.level(level);
        if x >= size.width || y >= size.height || z >= size.depth || layer >= size.layers || level >= self.level_count()
        {
            return None;
        }
        // One of slices and layers is 1.
        let slice = (layer * size.depth + z) as usize;
        let texel = (slice * size.height as usize + y as usize) * size.width as usize + x as usize;
        Some(texel * self.samples as usize * self.format.bytes())
    }

    /// Writes one texel, its first sample; `false` outside.
    pub fn set(&mut self, level: u32, at: [u32; 3], layer: u32, color: Vec4) -> bool {
        let Some(place) = self.place(level, at, layer) else { return false };
        self.format.write(color, &mut self.levels[level as usize][place..]);
        true
    }

    /// Makes each level the mean of the one before: over the part of it that a texel takes in, so also for odd sizes.
    ///
    /// # Errors
    /// For formats that cannot be averaged.
    pub fn generate_levels(&mut self) -> Result<()> {
        if !self.format.is_filterable() || self.format.class() != Class::Float {
            return refuse("Texture::generate_levels", format!("{:?} cannot be averaged", self.format));
        }
        // Level by level, each from the one before.
        for level in 1..self.level_count() {
            let size = self.size.level(level);
            for layer in 0..size.layers {
                for z in 0..size.depth {
                    for (y, x) in (0..size.height).flat_map(|y| (0..size.width).map(move |x| (y, x))) {
                        let mean = self.mean(level - 1, level, [x, y, z], layer);
                        self.set(level, [x, y, z], layer, mean);
                    }
                }
            }
        }
        Ok(())
    }

    fn mean(&self, from: u32, to: u32, at: [u32; 3], layer: u32) -> Vec4 {
        let (fine, coarse) = (self.size.level(from), self.size.level(to));
        let parts = |axis: usize| {
            let [fine, coarse] = [fine, coarse].map(|s| f64::from([s.width, s.height, s.depth][axis]));
            // A texel of the coarse level covers this interval of fine texels; partial ones count by their share.
            let (low, high) = (f64::from(at[axis]) * fine / coarse, f64::from(at[axis] + 1) * fine / coarse);
            let texels = low as u32..high.ceil() as u32;
            texels.map(move |i| (i, (high.min(f64::from(i + 1)) - low.max(f64::from(i))) as f32))
        };
        let (mut sum, mut total) = (Vec4::ZERO, 0.0);
        // Box filter, separable in the weights.
        for (z, wz) in parts(2) {
            for (y, wy) in parts(1) {
                for (x, wx) in parts(0) {
                    if let Some(place) = self.place(from, [x, y, z], layer) {
                        sum += self.format.read(&self.levels[from as usize][place..]) * (wx * wy * wz);
                        total += wx * wy * wz;
                    }
                }
            }
        }
        sum / total
    }
}
