//! A colour target.

use glam::Vec4;
use rayon::prelude::*;
use steradian_image::Image;

use super::{Extent, TILE_PIXELS};
use crate::{
    error::{Error, Result, refuse},
    format::{Format, decode_rgba8, encode_rgba8},
    output::Class,
};

/// A picture that is drawn into.
#[derive(Clone, Debug)]
pub struct ColorTarget {
    extent: Extent,
    format: Format,
    /// Texels tile by tile ([`Extent::place`]).
    pub(super) texels: Vec<u8>,
}

impl ColorTarget {
    /// A target of this size and format; all bits are zero.
    ///
    /// # Errors
    /// Where the size is beyond the limits, or the format cannot be drawn to.
    pub fn new(extent: Extent, format: Format) -> Result<Self> {
        const CALL: &str = "ColorTarget::new";
        extent.check(CALL)?;
        if !format.is_color_renderable() {
            return refuse(CALL, format!("colours cannot be drawn to {format:?}"));
        }
        let texels = vec![0; extent.tiles() * extent.samples as usize * TILE_PIXELS * format.bytes()];
        Ok(Self { extent, format, texels })
    }

    /// Its size.
    pub fn extent(&self) -> Extent {
        self.extent
    }

    /// Its format.
    pub fn format(&self) -> Format {
        self.format
    }

    pub(super) fn tile_bytes(&self) -> usize {
        TILE_PIXELS * self.extent.samples as usize * self.format.bytes()
    }

    /// Fills all layers and samples. Integers as bits.
    pub fn clear(&mut self, color: Vec4) {
        let mut texel = [0; 16];
        self.format.write(color, &mut texel);
        let bytes = self.format.bytes();
        let plane = texel[..bytes].repeat(TILE_PIXELS);
        self.texels.par_chunks_exact_mut(plane.len()).for_each(|part| part.copy_from_slice(&plane));
    }

    /// The colour of a sample; `None` outside.
    pub fn sample(&self, pixel: [u32; 2], layer: u32, sample: u32) -> Option<Vec4> {
        let start = self.extent.place(pixel, layer, sample)? * self.format.bytes();
        Some(self.format.read(&self.texels[start..]))
    }

    /// The colour of the first sample of a pixel of layer 0; `None` outside.
    pub fn pixel(&self, x: u32, y: u32) -> Option<Vec4> {
        self.sample([x, y], 0, 0)
    }

    /// The bytes of a layer's first samples, row by row without gaps.
    pub fn to_bytes(&self, layer: u32) -> Vec<u8> {
        self.extent.untile(&self.texels, self.format.bytes(), layer)
    }

    /// Takes a row of a layer, all samples of each pixel one after the other.
    pub(crate) fn load(&mut self, y: u32, layer: u32, row: &[u8]) {
        for (place, texel) in self.row_places(y, layer).zip(row.chunks_exact(self.format.bytes())) {
            self.texels[place..][..texel.len()].copy_from_slice(texel);
        }
    }

    /// Gives a row of a layer, all samples of each pixel one after the other.
    pub(crate) fn store(&self, y: u32, layer: u32, row: &mut [u8]) {
        for (place, texel) in self.row_places(y, layer).zip(row.chunks_exact_mut(self.format.bytes())) {
            texel.copy_from_slice(&self.texels[place..][..texel.len()]);
        }
    }

    /// First bytes of the samples of a row.
    fn row_places(&self, y: u32, layer: u32) -> impl Iterator<Item = usize> + use<> {
        let (extent, bytes) = (self.extent, self.format.bytes());
        let samples = (0..extent.width).flat_map(move |x| (0..extent.samples).map(move |sample| (x, sample)));
        samples.filter_map(move |(x, sample)| Some(extent.place([x, y], layer, sample)? * bytes))
    }

    /// Means of the samples as a target with one sample. Integer formats keep sample 0.
    pub fn resolve(&self) -> Self {
        let extent = self.extent.samples(1);
        let bytes = self.format.bytes();
        let tiles = extent.tiles();
        let mut texels = vec![0; tiles * TILE_PIXELS * bytes];
        let samples = self.extent.samples as usize;
        let averaged = self.format.class() == Class::Float;
        let resolve = |(target, source): (&mut [u8], &[u8])| {
            if self.format == Format::Rgba8Unorm && samples > 1 {
                return mean_of_levels(target, source, samples);
            }
            for (i, texel) in target.chunks_exact_mut(bytes).enumerate() {
                let stored = |s: usize| &source[(s * TILE_PIXELS + i) * bytes..][..bytes];
                if averaged && samples > 1 {
                    let sum = (0..samples).fold(Vec4::ZERO, |sum, s| sum + self.format.read(stored(s)));
                    self.format.write(sum / samples as f32, texel);
                } else {
                    texel.copy_from_slice(stored(0));
                }
            }
        };
        let targets = texels.par_chunks_exact_mut(TILE_PIXELS * bytes);
        targets.zip(self.texels.par_chunks_exact(self.tile_bytes())).for_each(resolve);
        Self { extent, format: self.format, texels }
    }

    /// Layer 0 as a picture with channels `R`, `G`, `B`, `A`; samples are averaged.
    ///
    /// # Errors
    /// For integer formats.
    pub fn to_image(&self) -> Result<Image> {
        const CALL: &str = "ColorTarget::to_image";
        if self.format.class() != Class::Float {
            return refuse(CALL, format!("{:?} holds integers", self.format));
        }
        let resolved = self.resolve();
        let Extent { width, height, .. } = self.extent;
        let mut image = Image::new(width as usize, height as usize);
        for (channel, name) in ["R", "G", "B", "A"].into_iter().enumerate() {
            let rows = (0..height).flat_map(|y| (0..width).map(move |x| [x, y]));
            let data = rows.map(|p| resolved.sample(p, 0, 0).map_or(0.0, |c| c[channel])).collect();
            image.push(name, data).map_err(|error| Error { call: CALL, rule: error.to_string() })?;
        }
        Ok(image)
    }
}

/// Means over samples of four channels of 8 bits, the samples of a tile one after the other.
fn mean_of_levels(target: &mut [u8], source: &[u8], samples: usize) {
    let plane = target.len();
    for (place, texel) in (0..).step_by(4).zip(target.chunks_exact_mut(4)) {
        let stored =
            |s: usize| source[s * plane + place..].first_chunk().map_or(Vec4::ZERO, |texel| decode_rgba8(*texel));
        let sum = (0..samples).fold(Vec4::ZERO, |sum, s| sum + stored(s));
        texel.copy_from_slice(&encode_rgba8(sum / samples as f32));
    }
}
