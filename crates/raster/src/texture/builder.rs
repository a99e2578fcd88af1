//! Textures whose levels are given one by one: they may be incomplete.

use super::{Texture, TextureKind, TextureSize};
use crate::{
    error::{Result, refuse},
    format::Format,
};

/// Levels of a texture that may or may not fit each other. [`finish`](Self::finish) says whether the texture is
/// complete.
#[derive(Clone, Debug)]
pub struct TextureBuilder {
    kind: TextureKind,
    base: u32,
    largest: u32,
    levels: Vec<Option<(Format, TextureSize, Vec<u8>)>>,
}

const CALL: &str = "TextureBuilder::finish";

impl TextureBuilder {
    /// No levels yet.
    pub fn new(kind: TextureKind) -> Self {
        Self { kind, base: 0, largest: 1000, levels: Vec::new() }
    }

    /// The levels that count: `TEXTURE_BASE_LEVEL` and `TEXTURE_MAX_LEVEL`.
    pub fn range(self, base: u32, largest: u32) -> Self {
        Self { base, largest, ..self }
    }

    /// Gives a level, in the place of one given before.
    pub fn level(mut self, level: u32, format: Format, size: TextureSize, texels: &[u8]) -> Self {
        let level = level.min(31) as usize;
        if self.levels.len() <= level {
            self.levels.resize(level + 1, None);
        }
        self.levels[level] = Some((format, size, texels.to_vec()));
        self
    }

    /// The texture, if it is complete: the base level is there and is of the kind's size, and with `mipmapped` all
    /// levels down to one texel or the last that counts are there, of one format, each half the size of the one before.
    ///
    /// # Errors
    /// The rule that is broken.
    pub fn finish(self, mipmapped: bool) -> Result<Texture> {
        let Some(Some((format, size, _))) = self.levels.get(self.base as usize) else {
            return refuse(CALL, format!("level {}, the base, is not there", self.base));
        };
        let (format, size) = (*format, *size);
        self.kind.check(size, CALL)?;
        // Levels run from the base to one texel, or to the last one that counts.
        let last = if mipmapped { (self.base + size.levels() - 1).min(self.largest.max(self.base)) } else { self.base };
        let count = last - self.base + 1;
        let mut texture = Texture::new(self.kind, format, size, count)?;
        // Every level must be there, of one format, of half the size of the one before, with all of its bytes.
        for number in 0..count {
            let Some(Some((other, given, texels))) = self.levels.get((self.base + number) as usize) else {
                return refuse(CALL, format!("level {} is not there", self.base + number));
            };
            if *other != format {
                return refuse(CALL, format!("level {} is {other:?}, the base {format:?}", self.base + number));
            }
            if *given != size.level(number) {
                let wanted = size.level(number);
                return refuse(CALL, format!("level {} is {given:?}, not {wanted:?}", self.base + number));
            }
            let target = &mut texture.levels[number as usize];
            if texels.len() != target.len() {
                let (have, want) = (texels.len(), target.len());
                return refuse(CALL, format!("level {} has {have} bytes, not {want}", self.base + number));
            }
            target.copy_from_slice(texels);
        }
        Ok(texture)
    }
}
