//! Texel storage: in memory as the file has them (8 and 16 bits, half, float), decoded at lookup, or in tiles that are
//! brought in on demand (`pages`). The bits of a lookup do not depend on the storage.

#![expect(clippy::needless_range_loop, reason = "loops over lanes are unrolled for certain this way")]

use super::{
    pages::{PagedTexels, TILE, TileView},
    sample::{Decoder, Kind, Sample},
};
use half::f16;
use std::{path::Path, sync::Arc};
use steradian_image::{Encoding, Limits, TexelData, Texels};
use steradian_math::{Vec2, Vec4};

pub use super::pages::Pages;

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
    /// Width and height.
    scale: Vec2,
    /// Samples from one row to the next.
    stride: usize,
    /// Index of the alpha channel; one that no channel has if there is none.
    alpha: usize,
    kind: Kind,
    decoder: Decoder,
    /// For alpha.
    linear: Decoder,
}

impl Level {
    /// Keeps a picture in memory, or moves it to `pages`.
    pub fn new(texels: Arc<Texels>, pages: Option<&Arc<Pages>>) -> std::io::Result<Self> {
        let (kind, encoding) = (Kind::of(&texels.data), texels.encoding);
        let size = (texels.width, texels.height, texels.channels);
        let place = match pages {
            Some(pages) => Place::Pages(Arc::new(PagedTexels::new(&texels, pages)?)),
            None => Place::Memory(texels),
        };
        Ok(Self::at(place, size, kind, encoding))
    }

    /// Moves the picture of a file to `pages`, band by band, each of which goes through `mend` first.
    ///
    /// # Errors
    /// Those of reading the file, and of writing to the pages.
    pub fn read(
        file: &Path,
        limits: &Limits,
        pages: &Arc<Pages>,
        mut mend: impl FnMut(&mut Texels),
    ) -> Result<Self, steradian_image::Error> {
        let mut level: Option<(Arc<PagedTexels>, Self)> = None;
        steradian_image::read_bands(file, limits, TILE, &mut |(first, height), band| {
            mend(band);
            let (paged, _) = level.get_or_insert_with(|| {
                let paged = Arc::new(PagedTexels::with_room(band, height, pages));
                let size = (band.width, height, band.channels);
                let level = Self::at(Place::Pages(paged.clone()), size, Kind::of(&band.data), band.encoding);
                (paged, level)
            });
            paged.write_band(first, band)
        })?;
        level.map(|level| level.1).ok_or_else(|| steradian_image::Error::Invalid("the picture has no rows".into()))
    }

    fn at(place: Place, size: (usize, usize, usize), kind: Kind, encoding: Encoding) -> Self {
        let scale = Vec2::new(size.0 as f32, size.1 as f32);
        let alpha = if matches!(size.2, 2 | 4) { size.2 - 1 } else { usize::MAX };
        let (decoder, linear) = (Decoder::new(encoding), Decoder::new(Encoding::Linear));
        Self { place, size, scale, stride: size.0 * size.2, alpha, kind, decoder, linear }
    }

    /// The texels read in another encoding.
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

    /// Width and height, which coordinates in periods are multiplied with.
    #[inline]
    pub fn scale(&self) -> Vec2 {
        self.scale
    }

    /// Samples per texel.
    #[inline]
    pub fn channels(&self) -> usize {
        self.size.2
    }

    /// Storage format of the samples.
    pub fn kind(&self) -> Kind {
        self.kind
    }

    /// Encoding of the colours.
    pub fn encoding(&self) -> Encoding {
        self.decoder.encoding()
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
        (self.alpha < self.size.2).then_some(self.alpha)
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

    /// View of `N` channels from `first` on.
    #[inline(always)]
    pub fn view(&self, first: usize) -> AnyView<'_> {
        let (channels, stride) = (self.size.2, self.stride);
        let decoder = if first == self.alpha { &self.linear } else { &self.decoder };
        macro_rules! view {
            ($data:expr) => {
                Samples { data: $data, stride, channels, first, decoder }
            };
        }
        match &self.place {
            Place::Memory(texels) => match &texels.data {
                TexelData::U8(data) => AnyView::U8(view!(data)),
                TexelData::U16(data) => AnyView::U16(view!(data)),
                TexelData::F16(data) => AnyView::F16(view!(data)),
                TexelData::F32(data) => AnyView::F32(view!(data)),
            },
            Place::Pages(pages) => {
                AnyView::Tiles(Tiles { tiles: TileView::new(pages), width: self.size.0, first, decoder })
            }
        }
    }
}

/// Something that gives linear values of texels: of `N` channels, in the first lanes.
pub trait View<'a>: Sized {
    /// View of another level of the picture; `None` if that level is stored otherwise.
    fn of(&self, level: &'a Level) -> Option<Self>;

    /// Two texels from `x`, `y` on to the right and the two below them, all of which are within the picture.
    #[inline(always)]
    fn square<const N: usize>(&mut self, x: usize, y: usize) -> [Vec4; 4] {
        [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(i, j)| self.texel::<N>(x + i, y + j))
    }

    /// [`Self::square`] of two levels of a picture.
    #[inline(always)]
    fn squares<const N: usize>(&mut self, at: [usize; 2], other: &mut Self, there: [usize; 2]) -> [[Vec4; 4]; 2] {
        [self.square::<N>(at[0], at[1]), other.square::<N>(there[0], there[1])]
    }

    /// The values of the texel at `x`, `y`, which are within the picture.
    fn texel<const N: usize>(&mut self, x: usize, y: usize) -> Vec4;

    /// The values of a texel by its number, where rows follow each other.
    fn numbered<const N: usize>(&mut self, number: usize) -> Vec4;

    /// At most four texels from `x`, `y` on to the right, one in each lane, for each of `N` channels; all are within
    /// the picture.
    #[inline(always)]
    fn lanes<const N: usize, const K: usize>(&mut self, x: usize, y: usize) -> [Vec4; N] {
        let strip: [Vec4; 4] = std::array::from_fn(|k| if k < K { self.texel::<N>(x + k, y) } else { Vec4::ZERO });
        let [a, b, c, d] = strip.map(|texel| texel.to_array());
        std::array::from_fn(|n| Vec4::new(a[n], b[n], c[n], d[n]))
    }

    /// `K` texels from `x`, `y` on to the right, all of which are within the picture.
    #[inline(always)]
    fn strip<const N: usize, const K: usize>(&mut self, x: usize, y: usize) -> [Vec4; K] {
        let mut strip = [Vec4::ZERO; K];
        for k in 0..K {
            strip[k] = self.texel::<N>(x + k, y);
        }
        strip
    }
}

/// A view of texels, whatever they are kept as.
pub enum AnyView<'a> {
    /// 8-bit codes.
    U8(Samples<'a, u8>),
    /// 16-bit codes.
    U16(Samples<'a, u16>),
    /// Half floats.
    F16(Samples<'a, f16>),
    /// Floats.
    F32(Samples<'a, f32>),
    /// Tiles.
    Tiles(Tiles<'a>),
}

/// Samples in memory, row by row.
#[derive(Clone, Copy)]
pub struct Samples<'a, T> {
    data: &'a [T],
    /// Samples from one row to the next.
    stride: usize,
    channels: usize,
    first: usize,
    decoder: &'a Decoder,
}

impl<T: Sample> Samples<'_, T> {
    #[inline(always)]
    fn at<const N: usize>(&self, i: usize) -> Vec4 {
        let texel = &self.data[i..i + N];
        let mut values = [0.0; 4];
        for c in 0..N {
            values[c] = texel[c].linear(self.decoder);
        }
        Vec4::from_array(values)
    }

    /// `K` texels of `C` channels, the first of which are looked at.
    #[inline(always)]
    fn row<const N: usize, const K: usize, const C: usize>(&self, start: usize) -> [Vec4; K] {
        let row = &self.data[start..start + (K - 1) * C + N];
        let mut strip = [Vec4::ZERO; K];
        for k in 0..K {
            let mut values = [0.0; 4];
            for c in 0..N {
                values[c] = row[k * C + c].linear(self.decoder);
            }
            strip[k] = Vec4::from_array(values);
        }
        strip
    }

    /// [`View::lanes`] for `C` channels, or for however many there are if that is none.
    #[inline(always)]
    fn lanes_of<const N: usize, const K: usize, const C: usize>(&self, x: usize, y: usize) -> [Vec4; N] {
        let channels = if C == 0 { self.channels } else { C };
        let row = &self.data[y * self.stride + x * channels + self.first..][..(K - 1) * channels + N];
        let mut lanes = [Vec4::ZERO; N];
        for c in 0..N {
            let mut values = [0.0; 4];
            for k in 0..K {
                values[k] = row[k * channels + c].linear(self.decoder);
            }
            lanes[c] = Vec4::from_array(values);
        }
        lanes
    }

    #[inline(always)]
    fn index(&self, x: usize, y: usize) -> usize {
        y * self.stride + x * self.channels + self.first
    }
}

impl<T: Sample> Samples<'_, T> {
    /// [`View::square`] for `C` channels, or for however many there are if that is none.
    #[inline(always)]
    fn square_of<const N: usize, const C: usize>(&self, [x, y]: [usize; 2]) -> [Vec4; 4] {
        let channels = if C == 0 { self.channels } else { C };
        let start = y * self.stride + x * channels + self.first;
        let mut square = [Vec4::ZERO; 4];
        for j in 0..2 {
            let row = &self.data[start + j * self.stride..][..channels + N];
            for k in 0..2 {
                let mut values = [0.0; 4];
                for c in 0..N {
                    values[c] = row[k * channels + c].linear(self.decoder);
                }
                square[2 * j + k] = Vec4::from_array(values);
            }
        }
        square
    }
}

impl<'a, T: Sample> View<'a> for Samples<'a, T> {
    #[inline(always)]
    fn of(&self, level: &'a Level) -> Option<Self> {
        match &level.place {
            Place::Memory(texels) => Some(Self { data: T::of(&texels.data)?, stride: level.stride, ..*self }),
            Place::Pages(_) => None,
        }
    }

    #[inline(always)]
    fn squares<const N: usize>(&mut self, at: [usize; 2], other: &mut Self, there: [usize; 2]) -> [[Vec4; 4]; 2] {
        macro_rules! of {
            ($channels:literal) => {
                [self.square_of::<N, $channels>(at), other.square_of::<N, $channels>(there)]
            };
        }
        match self.channels {
            3 => of!(3),
            4 => of!(4),
            _ => of!(0),
        }
    }

    #[inline(always)]
    fn lanes<const N: usize, const K: usize>(&mut self, x: usize, y: usize) -> [Vec4; N] {
        match self.channels {
            3 => self.lanes_of::<N, K, 3>(x, y),
            4 => self.lanes_of::<N, K, 4>(x, y),
            _ => self.lanes_of::<N, K, 0>(x, y),
        }
    }

    #[inline(always)]
    fn square<const N: usize>(&mut self, x: usize, y: usize) -> [Vec4; 4] {
        match self.channels {
            3 => self.square_of::<N, 3>([x, y]),
            4 => self.square_of::<N, 4>([x, y]),
            _ => self.square_of::<N, 0>([x, y]),
        }
    }

    #[inline(always)]
    fn texel<const N: usize>(&mut self, x: usize, y: usize) -> Vec4 {
        self.at::<N>(self.index(x, y))
    }

    #[inline(always)]
    fn numbered<const N: usize>(&mut self, number: usize) -> Vec4 {
        self.at::<N>(number * self.channels + self.first)
    }

    #[inline(always)]
    fn strip<const N: usize, const K: usize>(&mut self, x: usize, y: usize) -> [Vec4; K] {
        let start = self.index(x, y);
        match self.channels {
            // The usual numbers need but one test whether all is within the picture.
            3 => self.row::<N, K, 3>(start),
            4 => self.row::<N, K, 4>(start),
            channels => {
                let mut strip = [Vec4::ZERO; K];
                for k in 0..K {
                    strip[k] = self.at::<N>(start + k * channels);
                }
                strip
            }
        }
    }
}

/// Tiles.
pub struct Tiles<'a> {
    tiles: TileView<'a>,
    width: usize,
    first: usize,
    decoder: &'a Decoder,
}

impl<'a> View<'a> for Tiles<'a> {
    #[inline(always)]
    fn of(&self, level: &'a Level) -> Option<Self> {
        match &level.place {
            Place::Pages(pages) => Some(Self {
                tiles: TileView::new(pages),
                width: level.size.0,
                first: self.first,
                decoder: self.decoder,
            }),
            Place::Memory(_) => None,
        }
    }

    #[inline(never)]
    fn texel<const N: usize>(&mut self, x: usize, y: usize) -> Vec4 {
        let mut values = [0.0; 4];
        for c in 0..N {
            values[c] = self.tiles.linear(x, y, self.first + c, self.decoder);
        }
        Vec4::from_array(values)
    }

    #[inline]
    fn numbered<const N: usize>(&mut self, number: usize) -> Vec4 {
        self.texel::<N>(number % self.width, number / self.width)
    }
}

/// Evaluates an expression for the view that a level has, once for each type of view.
macro_rules! on_level {
    ($level:expr, $first:expr, |$view:ident| $body:expr) => {
        match $level.view($first) {
            $crate::store::AnyView::U8(mut $view) => $body,
            $crate::store::AnyView::U16(mut $view) => $body,
            $crate::store::AnyView::F16(mut $view) => $body,
            $crate::store::AnyView::F32(mut $view) => $body,
            $crate::store::AnyView::Tiles(mut $view) => $body,
        }
    };
}
pub(super) use on_level;
