//! Samples as the file stores them, for textures that should stay small in memory.

use crate::limits::with_room;
use crate::{Encoding, Error, Image, Metadata, Result};
use half::f16;
use steradian_math::Vec3;

/// Interleaved samples in the file's own precision.
#[derive(Clone, Debug, PartialEq)]
pub enum TexelData {
    /// 8 bits, code / 255.
    U8(Vec<u8>),
    /// 16 bits, code / 65535.
    U16(Vec<u16>),
    /// Half floats.
    F16(Vec<f16>),
    /// Floats.
    F32(Vec<f32>),
}

impl TexelData {
    /// Number of samples.
    pub fn len(&self) -> usize {
        match self {
            Self::U8(v) => v.len(),
            Self::U16(v) => v.len(),
            Self::F16(v) => v.len(),
            Self::F32(v) => v.len(),
        }
    }

    /// True if there are no samples.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The stored value as a number: integer codes are scaled to [0, 1], nothing is decoded.
    #[inline]
    pub fn stored(&self, index: usize) -> f32 {
        match self {
            Self::U8(v) => f32::from(v[index]) / 255.0,
            Self::U16(v) => f32::from(v[index]) / 65535.0,
            Self::F16(v) => v[index].to_f32(),
            Self::F32(v) => v[index],
        }
    }
}

/// A picture in the file's own precision: 1 (grey), 2 (grey, alpha), 3 (RGB) or 4 (RGBA) interleaved channels, rows
/// from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Texels {
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels.
    pub height: usize,
    /// Channels per pixel, 1 to 4; the last of 2 or 4 is alpha.
    pub channels: usize,
    /// `width × height × channels` samples.
    pub data: TexelData,
    /// Encoding of the colour samples, by default for this kind of file. Alpha is linear.
    pub encoding: Encoding,
    /// Further metadata of the file (`gamma` of a PNG, `EXPOSURE` of a Radiance file, …); not applied to the samples.
    pub metadata: Metadata,
}

/// Takes a band: the row it begins with and the height of the picture, and its texels.
pub type TakeBand<'a, E> = &'a mut dyn FnMut((usize, usize), &mut Texels) -> std::result::Result<(), E>;

impl Texels {
    pub(crate) fn new(width: usize, height: usize, channels: usize, data: TexelData, encoding: Encoding) -> Self {
        debug_assert_eq!(data.len(), width * height * channels);
        Self { width, height, channels, data, encoding, metadata: Metadata::default() }
    }

    /// Index of the alpha channel.
    pub fn alpha(&self) -> Option<usize> {
        matches!(self.channels, 2 | 4).then(|| self.channels - 1)
    }

    /// Brings colours of other primaries to Rec.709, in the precision of the samples. Numbers that are no colours, such
    /// as normals, stay as they are without it.
    pub fn to_rec709(&mut self) {
        let Some(matrix) = self.metadata.rec709.take().filter(|_| self.channels >= 3) else { return };
        match &mut self.data {
            TexelData::F16(v) => v.chunks_exact_mut(self.channels).for_each(|texel| {
                let color = matrix * Vec3::from([0, 1, 2].map(|c| texel[c].to_f32()));
                color.to_array().into_iter().zip(texel).for_each(|(v, to)| *to = f16::from_f32(v));
            }),
            TexelData::F32(v) => v.chunks_exact_mut(self.channels).for_each(|texel| {
                let color = matrix * Vec3::from([texel[0], texel[1], texel[2]]);
                texel[..3].copy_from_slice(&color.to_array());
            }),
            // Only OpenEXR names primaries.
            TexelData::U8(_) | TexelData::U16(_) => {}
        }
        self.metadata.name_rec709();
    }

    /// The linear value of one sample; `x < width`, `y < height`, `channel < channels`.
    #[inline]
    pub fn linear(&self, x: usize, y: usize, channel: usize) -> f32 {
        let stored = self.data.stored((y * self.width + x) * self.channels + channel);
        if self.alpha() == Some(channel) { stored } else { self.encoding.decode(stored) }
    }

    /// Linear colours times a factor, in single precision; without opacity.
    pub fn tinted(&self, factor: [f32; 3]) -> Self {
        let lanes = if self.channels >= 3 { [0, 1, 2] } else { [0; 3] };
        let texel = |k: usize| [0, 1, 2].map(|c| self.linear(k % self.width, k / self.width, lanes[c]) * factor[c]);
        let data = TexelData::F32((0..self.width * self.height).flat_map(texel).collect());
        let tinted = Self::new(self.width, self.height, 3, data, Encoding::Linear);
        Self { metadata: self.metadata.clone(), ..tinted }
    }

    /// Bytes that the samples take.
    pub fn byte_size(&self) -> usize {
        let sample = match self.data {
            TexelData::U8(_) => 1,
            TexelData::U16(_) | TexelData::F16(_) => 2,
            TexelData::F32(_) => 4,
        };
        self.data.len() * sample
    }

    /// The picture as linear planes: `Y`, `Y A`, `R G B` or `R G B A`.
    ///
    /// # Errors
    /// [`Error::Invalid`] when the fields contradict each other.
    pub fn to_image(&self) -> Result<Image> {
        let names: &[&str] = match self.channels {
            1 => &["Y"],
            2 => &["Y", "A"],
            3 => &["R", "G", "B"],
            4 => &["R", "G", "B", "A"],
            n => return Err(Error::Invalid(format!("texels must have 1 to 4 channels, not {n}"))),
        };
        let samples = self.width.checked_mul(self.height).and_then(|n| n.checked_mul(self.channels));
        if samples != Some(self.data.len()) {
            return Err(Error::Invalid("the number of texels does not match the size".into()));
        }
        let mut image = Image::new(self.width, self.height);
        for (lane, name) in names.iter().enumerate() {
            let encoding = if self.alpha() == Some(lane) { Encoding::Linear } else { self.encoding };
            image.push(*name, self.plane(lane, encoding)?)?;
        }
        image.metadata = self.metadata.clone();
        Ok(image)
    }

    /// One channel, decoded.
    fn plane(&self, lane: usize, encoding: Encoding) -> Result<Vec<f32>> {
        let lanes = self.channels;
        let mut plane = with_room(self.width * self.height)?;
        match &self.data {
            TexelData::U8(v) => {
                let table = encoding.table8();
                plane.extend(v.iter().skip(lane).step_by(lanes).map(|&code| table[usize::from(code)]));
            }
            TexelData::U16(v) => {
                let decoded = |&code: &u16| encoding.decode(f32::from(code) / 65535.0);
                plane.extend(v.iter().skip(lane).step_by(lanes).map(decoded));
            }
            TexelData::F16(v) => plane.extend(v.iter().skip(lane).step_by(lanes).map(|x| encoding.decode(x.to_f32()))),
            TexelData::F32(v) => plane.extend(v.iter().skip(lane).step_by(lanes).map(|&x| encoding.decode(x))),
        }
        Ok(plane)
    }
}
