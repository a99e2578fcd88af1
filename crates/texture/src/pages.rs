//! Texels on disk, in square tiles of 64 × 64 in Morton order, of which those that were used last are in memory: scenes
//! may have more textures than memory. What is looked up has the same bits as without.

use super::sample::{Decoder, Kind, from_half};
use half::f16;
use std::{
    collections::HashMap,
    fs::File,
    io,
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering},
    },
};
use steradian_image::{TexelData, Texels};

/// Edge of a tile, texels.
pub const TILE: usize = 64;

/// The index of a texel in its tile: the bits of x and y in turn (Morton 1966), so that neighbours are near each other
/// in memory.
#[inline]
pub fn morton(x: usize, y: usize) -> usize {
    spread(x) | spread(y) << 1
}

/// Six bits with gaps between them.
#[inline]
fn spread(v: usize) -> usize {
    let v = (v | v << 4) & 0b0011_0000_1111;
    let v = (v | v << 2) & 0b0011_0011_0011;
    (v | v << 1) & 0b0101_0101_0101
}

/// A file of tiles with those of them that were used last.
#[derive(Debug)]
pub struct Pages {
    file: File,
    /// File offset of the next tile.
    end: AtomicU64,
    /// Most bytes of tiles in memory.
    limit: usize,
    used: AtomicUsize,
    /// The most that ever were.
    peak: AtomicUsize,
    shards: Vec<Mutex<Shard>>,
    /// Tiles that were brought in.
    loads: AtomicU64,
    /// Set once a tile could not be read; it counts as black.
    failed: AtomicBool,
}

#[derive(Debug, Default)]
struct Shard {
    tiles: HashMap<u64, Held>,
    clock: u64,
}

#[derive(Debug)]
struct Held {
    bytes: Arc<[u8]>,
    last_use: u64,
}

const SHARDS: usize = 16;

impl Pages {
    /// A store that holds at most about `limit` bytes of tiles in memory, backed by a nameless file among the temporary
    /// ones.
    pub fn new(limit: usize) -> io::Result<Arc<Self>> {
        Ok(Arc::new(Self {
            file: tempfile::tempfile()?,
            end: AtomicU64::new(0),
            limit,
            used: AtomicUsize::new(0),
            peak: AtomicUsize::new(0),
            shards: (0..SHARDS).map(|_| Mutex::default()).collect(),
            loads: AtomicU64::new(0),
            failed: AtomicBool::new(false),
        }))
    }

    /// Bytes on disk, bytes in memory, and how often tiles were brought in.
    pub fn usage(&self) -> (u64, usize, u64) {
        (self.end.load(Ordering::Relaxed), self.used.load(Ordering::Relaxed), self.loads.load(Ordering::Relaxed))
    }

    /// Most bytes in memory at any time, room that was taken included.
    pub fn peak(&self) -> usize {
        self.peak.load(Ordering::Relaxed)
    }

    /// Takes room for other work on textures: as many bytes fewer are for tiles until it is given back.
    pub fn take_room(&self, bytes: usize) -> PageReservation<'_> {
        self.used.fetch_add(bytes, Ordering::Relaxed);
        // Tiles that were not used for the longest time go, a quarter of each shard's in turn, as long as there are
        // any.
        let mut are_left = true;
        while are_left && self.used.load(Ordering::Relaxed) > self.limit {
            are_left = false;
            for shard in &self.shards {
                let mut shard = shard.lock().unwrap_or_else(PoisonError::into_inner);
                self.evict(&mut shard);
                are_left |= !shard.tiles.is_empty();
            }
        }
        self.peak.fetch_max(self.used.load(Ordering::Relaxed), Ordering::Relaxed);
        PageReservation { pages: self, bytes }
    }

    /// True if a tile could not be read back, and counts as black.
    pub fn has_failed(&self) -> bool {
        self.failed.load(Ordering::Relaxed)
    }

    /// Most bytes of tiles in memory.
    pub fn limit(&self) -> usize {
        self.limit
    }

    /// The tile at an offset of the file.
    fn tile(&self, offset: u64, bytes: usize) -> Arc<[u8]> {
        // Tiles lie one after the other: their numbers spread over the shards.
        let shard = &self.shards[(offset / bytes as u64) as usize % SHARDS];
        {
            let mut shard = shard.lock().unwrap_or_else(PoisonError::into_inner);
            shard.clock += 1;
            let now = shard.clock;
            if let Some(held) = shard.tiles.get_mut(&offset) {
                held.last_use = now;
                return held.bytes.clone();
            }
        }
        let mut tile: Arc<[u8]> = std::iter::repeat_n(0, bytes).collect();
        if let Some(place) = Arc::get_mut(&mut tile)
            && read_at(&self.file, place, offset).is_err()
        {
            place.fill(0);
            self.failed.store(true, Ordering::Relaxed);
        }
        self.loads.fetch_add(1, Ordering::Relaxed);
        let mut shard = shard.lock().unwrap_or_else(PoisonError::into_inner);
        let now = shard.clock;
        if shard.tiles.insert(offset, Held { bytes: tile.clone(), last_use: now }).is_none() {
            self.used.fetch_add(bytes, Ordering::Relaxed);
        }
        if self.used.load(Ordering::Relaxed) > self.limit {
            self.evict(&mut shard);
        }
        self.peak.fetch_max(self.used.load(Ordering::Relaxed), Ordering::Relaxed);
        tile
    }

    /// Drops the tiles of a shard that were not used for the longest time: a quarter of them, so that it is seldom
    /// done.
    fn evict(&self, shard: &mut Shard) {
        if shard.tiles.is_empty() {
            return;
        }
        let mut uses: Vec<u64> = shard.tiles.values().map(|t| t.last_use).collect();
        let quarter = uses.len().div_ceil(4) - 1;
        let oldest = *uses.select_nth_unstable(quarter).1;
        let mut freed = 0;
        shard.tiles.retain(|_, t| {
            let keep = t.last_use > oldest;
            if !keep {
                freed += t.bytes.len();
            }
            keep
        });
        self.used.fetch_sub(freed, Ordering::Relaxed);
    }
}

/// Bytes that are not for tiles, until it is dropped.
#[derive(Debug)]
pub struct PageReservation<'a> {
    pages: &'a Pages,
    bytes: usize,
}

impl Drop for PageReservation<'_> {
    fn drop(&mut self) {
        self.pages.used.fetch_sub(self.bytes, Ordering::Relaxed);
    }
}

/// A picture in [`Pages`].
#[derive(Debug)]
pub struct PagedTexels {
    pages: Arc<Pages>,
    offset: u64,
    tiles_x: usize,
    channels: usize,
    kind: Kind,
}

impl PagedTexels {
    /// Writes a picture tile by tile.
    pub fn new(texels: &Texels, pages: &Arc<Pages>) -> io::Result<Self> {
        let level = Self::with_room(texels, texels.height, pages);
        level.write_band(0, texels)?;
        Ok(level)
    }

    /// Room for a picture of `height` rows like those of `band`, which [`Self::write_band`] fills.
    pub fn with_room(band: &Texels, height: usize, pages: &Arc<Pages>) -> Self {
        let (tiles_x, tiles_y) = (band.width.div_ceil(TILE), height.div_ceil(TILE));
        let kind = Kind::of(&band.data);
        let level = Self { pages: pages.clone(), offset: 0, tiles_x, channels: band.channels, kind };
        let bytes = (tiles_x * tiles_y * level.tile_bytes()) as u64;
        Self { offset: pages.end.fetch_add(bytes, Ordering::Relaxed), ..level }
    }

    /// Writes the rows of a band, the first of which is row `first` of the picture, a multiple of [`TILE`], tile by
    /// tile.
    pub fn write_band(&self, first: usize, band: &Texels) -> io::Result<()> {
        let bytes = self.tile_bytes();
        let mut tile = vec![0; bytes];
        for (ty, tx) in (0..band.height.div_ceil(TILE)).flat_map(|ty| (0..self.tiles_x).map(move |tx| (ty, tx))) {
            for y in ty * TILE..((ty + 1) * TILE).min(band.height) {
                for x in tx * TILE..((tx + 1) * TILE).min(band.width) {
                    let from = (y * band.width + x) * band.channels;
                    let to = morton(x % TILE, y % TILE) * band.channels;
                    copy_texel(&band.data, from, band.channels, &mut tile, to);
                }
            }
            let number = (first / TILE + ty) * self.tiles_x + tx;
            write_at(&self.pages.file, &tile, self.offset + (number * bytes) as u64)?;
        }
        Ok(())
    }

    fn tile_bytes(&self) -> usize {
        TILE * TILE * self.channels * self.kind.bytes()
    }
}

/// Copies the samples of a texel, as bytes, to sample number `to` of a tile.
fn copy_texel(data: &TexelData, from: usize, channels: usize, tile: &mut [u8], to: usize) {
    match data {
        TexelData::U8(d) => tile[to..to + channels].copy_from_slice(&d[from..from + channels]),
        TexelData::U16(d) => put(tile, to, d[from..from + channels].iter().map(|v| v.to_ne_bytes())),
        TexelData::F16(d) => put(tile, to, d[from..from + channels].iter().map(|v| v.to_ne_bytes())),
        TexelData::F32(d) => put(tile, to, d[from..from + channels].iter().map(|v| v.to_ne_bytes())),
    }
}

fn put<const B: usize>(tile: &mut [u8], to: usize, samples: impl Iterator<Item = [u8; B]>) {
    tile[to * B..].chunks_exact_mut(B).zip(samples).for_each(|(place, bytes)| place.copy_from_slice(&bytes));
}

/// Looks at a picture in pages; keeps the tile that it looked at last.
pub struct TileView<'a> {
    level: &'a PagedTexels,
    current: Option<(usize, Arc<[u8]>)>,
}

impl<'a> TileView<'a> {
    /// A view that has not looked yet.
    pub fn new(level: &'a PagedTexels) -> Self {
        Self { level, current: None }
    }

    /// A sample's linear value.
    #[inline]
    pub fn linear(&mut self, x: usize, y: usize, channel: usize, decoder: &Decoder) -> f32 {
        let level = self.level;
        let number = y / TILE * level.tiles_x + x / TILE;
        let tile = match &self.current {
            Some((current, tile)) if *current == number => tile,
            _ => {
                let bytes = level.tile_bytes();
                let tile = level.pages.tile(level.offset + (number * bytes) as u64, bytes);
                &self.current.insert((number, tile)).1
            }
        };
        let i = morton(x % TILE, y % TILE) * level.channels + channel;
        match level.kind {
            Kind::U8 => decoder.u8(tile[i]),
            Kind::U16 => decoder.stored(f32::from(u16::from_ne_bytes([tile[2 * i], tile[2 * i + 1]])) / 65535.0),
            Kind::F16 => decoder.stored(from_half(f16::from_ne_bytes([tile[2 * i], tile[2 * i + 1]]))),
            Kind::F32 => {
                decoder.stored(f32::from_ne_bytes([tile[4 * i], tile[4 * i + 1], tile[4 * i + 2], tile[4 * i + 3]]))
            }
        }
    }
}

#[cfg(unix)]
fn read_at(file: &File, buffer: &mut [u8], offset: u64) -> io::Result<()> {
    std::os::unix::fs::FileExt::read_exact_at(file, buffer, offset)
}

#[cfg(unix)]
fn write_at(file: &File, bytes: &[u8], offset: u64) -> io::Result<()> {
    std::os::unix::fs::FileExt::write_all_at(file, bytes, offset)
}

#[cfg(windows)]
fn read_at(file: &File, mut buffer: &mut [u8], mut offset: u64) -> io::Result<()> {
    while !buffer.is_empty() {
        match std::os::windows::fs::FileExt::seek_read(file, buffer, offset)? {
            0 => return Err(io::ErrorKind::UnexpectedEof.into()),
            n => {
                buffer = &mut buffer[n..];
                offset += n as u64;
            }
        }
    }
    Ok(())
}

#[cfg(windows)]
fn write_at(file: &File, mut bytes: &[u8], mut offset: u64) -> io::Result<()> {
    while !bytes.is_empty() {
        let n = std::os::windows::fs::FileExt::seek_write(file, bytes, offset)?;
        bytes = &bytes[n..];
        offset += n as u64;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian_image::Encoding;

    #[test]
    fn morton_order_is_a_bijection() {
        let mut seen = [false; TILE * TILE];
        for y in 0..TILE {
            for x in 0..TILE {
                assert!(!std::mem::replace(&mut seen[morton(x, y)], true));
            }
        }
        assert!(seen.iter().all(|s| *s));
        assert_eq!((morton(1, 0), morton(0, 1), morton(3, 5)), (1, 2, 0b100111));
    }

    /// M216: windows of 4 × 4 texels, wherever they lie in a tile, touch fewer lines of a cache (64 bytes, four-byte
    /// texels) than in rows.
    #[test]
    fn morton_order_keeps_neighbours_in_few_cache_lines() {
        let lines = |number: fn(usize, usize) -> usize| {
            let window = |x0: usize, y0: usize| {
                let touched = (0..16).map(|i| number(x0 + i % 4, y0 + i / 4) * 4 / 64);
                touched.collect::<std::collections::HashSet<_>>().len()
            };
            let places = (0..TILE - 3).flat_map(|y| (0..TILE - 3).map(move |x| (x, y)));
            places.map(|(x, y)| window(x, y)).sum::<usize>() as f64 / ((TILE - 3) * (TILE - 3)) as f64
        };
        let (morton, rows) = (lines(morton), lines(|x, y| y * TILE + x));
        // A line holds 4 × 4 texels of the tile, or 16 of a row: about (7/4)² against 4 · 19/16.
        assert!(morton < 3.1 && rows > 4.5, "{morton} {rows}");
    }

    #[test]
    fn every_texel_comes_back_though_few_tiles_fit() {
        let (width, height, channels) = (200, 131, 3);
        let codes = (0..width * height * channels).map(|i| (i as u32).wrapping_mul(2_654_435_761) >> 16);
        let float = |v: u32| v as f32 - 3e4;
        let kinds = [
            TexelData::U8(codes.clone().map(|v| v as u8).collect()),
            TexelData::U16(codes.clone().map(|v| v as u16).collect()),
            TexelData::F16(codes.clone().map(|v| f16::from_f32(float(v))).collect()),
            TexelData::F32(codes.map(float).collect()),
        ];
        for data in kinds {
            let texels =
                Texels { width, height, channels, data, encoding: Encoding::Linear, metadata: Default::default() };
            let bytes = TILE * TILE * channels * Kind::of(&texels.data).bytes();
            let pages = Pages::new(2 * bytes).unwrap();
            let level = PagedTexels::new(&texels, &pages).unwrap();
            let mut view = TileView::new(&level);
            let decoder = Decoder::new(Encoding::Linear);
            for i in (0..width * height).map(|i| i * 7919 % (width * height)) {
                let (x, y) = (i % width, i / width);
                for c in 0..channels {
                    assert_eq!(view.linear(x, y, c, &decoder), texels.data.stored(i * channels + c));
                }
            }
            let (_, used, loads) = pages.usage();
            assert!(used <= 3 * bytes && loads > 12 && !pages.has_failed(), "{used} {loads}");
        }
    }
}
