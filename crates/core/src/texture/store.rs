//! Where texels are: in memory as the file has them, or in tiles that are brought in when they are wanted.

use super::pages::{PagedTexels, TileView};
use std::sync::Arc;
use steradian_image::{Encoding, TexelData, Texels};

pub use super::pages::Pages;

/// What one sample is kept as.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kind {
    /// 8 bits, code / 255.
    U8,
    /// 16 bits, code / 65535.
    U16,
    /// Half float.
    F16,
    /// Float.
    F32,
}

impl Kind {
    /// The kind of these samples.
    pub fn of(data: &TexelData) -> Self {
        match data {
            TexelData::U8(_) => Self::U8,
            TexelData::U16(_) => Self::U16,
            TexelData::F16(_) => Self::F16,
            TexelData::F32(_) => Self::F32,
        }
    }

    /// Bytes of one sample.
    pub fn bytes(self) -> usize {
        match self {
            Self::U8 => 1,
            Self::U16 | Self::F16 => 2,
            Self::F32 => 4,
        }
    }
}

/// The linear values of stored samples.
#[derive(Clone, Debug)]
pub struct Decoder {
    encoding: Encoding,
    /// Of 8-bit codes.
    table: Arc<[f32; 256]>,
}

impl Decoder {
    /// For an encoding.
    pub fn new(encoding: Encoding) -> Self {
        Self { encoding, table: Arc::new(encoding.table8()) }
    }

    /// Of an 8-bit code.
    #[inline]
    pub fn u8(&self, code: u8) -> f32 {
        self.table[code as usize]
    }

    /// Of any other stored value.
    #[inline]
    pub fn stored(&self, value: f32) -> f32 {
        if self.encoding == Encoding::Linear { value } else { self.encoding.decode(value) }
    }
}

#[derive(Clone, Debug)]
enum Place {
    Memory(Arc<Texels>),
    Pages(Arc<PagedTexels>),
}

/// A picture of a certain size, wherever its texels are.
#[derive(Clone, Debug)]
pub struct Level {
    place: Place,
    size: (usize, usize, usize),
    kind: Kind,
    decoder: Decoder,
    /// For alpha.
    linear: Decoder,
}

impl Level {
    /// Keeps a picture in memory, or moves it to `pages`.
    pub fn new(texels: Arc<Texels>, pages: Option<&Arc<Pages>>) -> std::io::Result<Self> {
        let size = (texels.width, texels.height, texels.channels);
        let (kind, decoder) = (Kind::of(&texels.data), Decoder::new(texels.encoding));
        let place = match pages {
            Some(pages) => Place::Pages(Arc::new(PagedTexels::new(&texels, pages)?)),
            None => Place::Memory(texels),
        };
        Ok(Self { place, size, kind, decoder, linear: Decoder::new(Encoding::Linear) })
    }

    /// The same texels, read in another encoding.
    pub fn with_encoding(&self, encoding: Encoding) -> Self {
        Self { decoder: Decoder::new(encoding), ..self.clone() }
    }

    /// Width in texels.
    #[inline]
    pub fn width(&self) -> usize {
        self.size.0
    }

    /// Height in texels.
    #[inline]
    pub fn height(&self) -> usize {
        self.size.1
    }

    /// Samples per texel.
    #[inline]
    pub fn channels(&self) -> usize {
        self.size.2
    }

    /// What its samples are kept as.
    pub fn kind(&self) -> Kind {
        self.kind
    }

    /// How its colours stand for linear values.
    pub fn encoding(&self) -> Encoding {
        self.decoder.encoding
    }

    /// Bytes of all samples.
    pub fn byte_size(&self) -> usize {
        self.size.0 * self.size.1 * self.size.2 * self.kind.bytes()
    }

    /// Bytes of them that are in memory always.
    pub fn resident_bytes(&self) -> usize {
        if matches!(self.place, Place::Memory(_)) { self.byte_size() } else { 0 }
    }

    /// Index of the alpha channel.
    #[inline]
    pub fn alpha(&self) -> Option<usize> {
        matches!(self.size.2, 2 | 4).then(|| self.size.2 - 1)
    }

    /// Calls `f` with each sample's index in its row and its linear value.
    pub fn linear_row(&self, y: usize, mut f: impl FnMut(usize, f32)) {
        let (width, _, channels) = self.size;
        let alpha = self.alpha();
        match &self.place {
            Place::Memory(texels) => {
                let row = y * width * channels..(y + 1) * width * channels;
                let is_alpha = |i: usize| alpha.is_some_and(|a| i % channels == a);
                let mut give = |i: usize, v: f32| f(i, if is_alpha(i) { v } else { self.decoder.stored(v) });
                match &texels.data {
                    TexelData::U8(d) => d[row].iter().enumerate().for_each(|(i, &v)| {
                        f(i, if is_alpha(i) { self.linear.u8(v) } else { self.decoder.u8(v) });
                    }),
                    TexelData::U16(d) => {
                        d[row].iter().enumerate().for_each(|(i, &v)| give(i, f32::from(v) / 65535.0));
                    }
                    TexelData::F16(d) => d[row].iter().enumerate().for_each(|(i, v)| give(i, v.to_f32())),
                    TexelData::F32(d) => d[row].iter().enumerate().for_each(|(i, &v)| give(i, v)),
                }
            }
            Place::Pages(pages) => {
                let mut view = TileView::new(pages);
                for x in 0..width {
                    for c in 0..channels {
                        let decoder = if alpha == Some(c) { &self.linear } else { &self.decoder };
                        f(x * channels + c, view.linear(x, y, c, decoder));
                    }
                }
            }
        }
    }

    /// How `N` channels from `first` on are looked at.
    #[inline]
    pub fn view(&self, first: usize) -> AnyView<'_> {
        let (width, _, channels) = self.size;
        let decoder = if self.alpha() == Some(first) { &self.linear } else { &self.decoder };
        macro_rules! view {
            ($data:expr) => {
                Samples { data: $data, width, channels, first, decoder }
            };
        }
        match &self.place {
            Place::Memory(texels) => match &texels.data {
                TexelData::U8(data) => AnyView::U8(view!(data)),
                TexelData::U16(data) => AnyView::U16(view!(data)),
                TexelData::F16(data) => AnyView::F16(view!(data)),
                TexelData::F32(data) => AnyView::F32(view!(data)),
            },
            Place::Pages(pages) => AnyView::Tiles(TileView::new(pages), first, decoder),
        }
    }
}

/// Something that gives linear values of texels.
pub trait View<const N: usize> {
    /// The values of the texel at `x`, `y`, which are within the picture.
    fn texel(&mut self, x: usize, y: usize) -> [f32; N];
}

/// A view of texels, whatever they are kept as.
pub enum AnyView<'a> {
    /// 8-bit codes.
    U8(Samples<'a, u8>),
    /// 16-bit codes.
    U16(Samples<'a, u16>),
    /// Half floats.
    F16(Samples<'a, half::f16>),
    /// Floats.
    F32(Samples<'a, f32>),
    /// Tiles.
    Tiles(TileView<'a>, usize, &'a Decoder),
}

/// Samples in memory, row by row.
pub struct Samples<'a, T> {
    data: &'a [T],
    width: usize,
    channels: usize,
    first: usize,
    decoder: &'a Decoder,
}

impl<T> Samples<'_, T> {
    #[inline]
    fn get<const N: usize>(&self, x: usize, y: usize, decode: impl Fn(&T) -> f32) -> [f32; N] {
        let i = (y * self.width + x) * self.channels + self.first;
        let texel = &self.data[i..i + N];
        std::array::from_fn(|c| decode(&texel[c]))
    }
}

impl<const N: usize> View<N> for Samples<'_, u8> {
    #[inline]
    fn texel(&mut self, x: usize, y: usize) -> [f32; N] {
        self.get(x, y, |&v| self.decoder.u8(v))
    }
}

impl<const N: usize> View<N> for Samples<'_, u16> {
    #[inline]
    fn texel(&mut self, x: usize, y: usize) -> [f32; N] {
        self.get(x, y, |&v| self.decoder.stored(f32::from(v) / 65535.0))
    }
}

impl<const N: usize> View<N> for Samples<'_, half::f16> {
    #[inline]
    fn texel(&mut self, x: usize, y: usize) -> [f32; N] {
        self.get(x, y, |v| self.decoder.stored(v.to_f32()))
    }
}

impl<const N: usize> View<N> for Samples<'_, f32> {
    #[inline]
    fn texel(&mut self, x: usize, y: usize) -> [f32; N] {
        self.get(x, y, |&v| self.decoder.stored(v))
    }
}

/// Tiles, read as channels from the first one on.
pub struct Tiles<'a, 'b>(pub &'b mut TileView<'a>, pub usize, pub &'b Decoder);

impl<const N: usize> View<N> for Tiles<'_, '_> {
    #[inline]
    fn texel(&mut self, x: usize, y: usize) -> [f32; N] {
        std::array::from_fn(|c| self.0.linear(x, y, self.1 + c, self.2))
    }
}

/// Evaluates an expression for the view that a level has, once for each type of view.
macro_rules! on_level {
    ($level:expr, $first:expr, |$view:ident| $body:expr) => {
        match $level.view($first) {
            $crate::texture::store::AnyView::U8(mut v) => {
                let $view = &mut v;
                $body
            }
            $crate::texture::store::AnyView::U16(mut v) => {
                let $view = &mut v;
                $body
            }
            $crate::texture::store::AnyView::F16(mut v) => {
                let $view = &mut v;
                $body
            }
            $crate::texture::store::AnyView::F32(mut v) => {
                let $view = &mut v;
                $body
            }
            $crate::texture::store::AnyView::Tiles(mut t, first, decoder) => {
                let $view = &mut $crate::texture::store::Tiles(&mut t, first, decoder);
                $body
            }
        }
    };
}
pub(super) use on_level;
