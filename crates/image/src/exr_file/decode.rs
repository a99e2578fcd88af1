//! EXR pixels: every part's channels in one picture, at full resolution.

use super::{b44, chroma, dwa, header, primaries};
use crate::limits::zeros;
use crate::{Encoding, Error, FileKind, Image, Limits, Metadata, Result, TexelData, Texels, Value, Window, colour};
use exr::block::chunk::{Chunk, CompressedBlock};
use exr::compression::Compression;
use exr::math::Vec2;
use exr::meta::attribute::{AttributeValue, EnvironmentMap, IntegerBounds, SampleType};
use exr::meta::header::Header;
use half::f16;
use rayon::prelude::*;
use std::panic::{AssertUnwindSafe, catch_unwind};
use steradian_math::{Mat3, Vec3};

const KIND: FileKind = FileKind::Exr;

/// Blocks that are decompressed at the same time.
const BATCH: usize = 64;

/// A channel in the precision of the file.
enum Plane {
    Half(Vec<f16>),
    Float(Vec<f32>),
    Uint(Vec<u32>),
}

impl Plane {
    fn new(kind: SampleType, pixels: usize) -> Result<Self> {
        Ok(match kind {
            SampleType::F16 => Self::Half(zeros(pixels)?),
            SampleType::F32 => Self::Float(zeros(pixels)?),
            SampleType::U32 => Self::Uint(zeros(pixels)?),
        })
    }

    fn sample_bytes(&self) -> usize {
        if matches!(self, Self::Half(_)) { 2 } else { 4 }
    }

    /// Stores consecutive samples, `step` pixels apart, starting at pixel `start`.
    fn store(&mut self, start: usize, step: usize, bytes: &[u8]) {
        fn put<T, const N: usize>(to: &mut [T], step: usize, bytes: &[u8], parse: impl Fn([u8; N]) -> T) {
            for (slot, sample) in to.iter_mut().step_by(step).zip(bytes.as_chunks::<N>().0) {
                *slot = parse(*sample);
            }
        }
        match self {
            Self::Half(v) => put(&mut v[start..], step, bytes, f16::from_ne_bytes),
            Self::Float(v) => put(&mut v[start..], step, bytes, f32::from_ne_bytes),
            Self::Uint(v) => put(&mut v[start..], step, bytes, u32::from_ne_bytes),
        }
    }

    fn at(&self, index: usize) -> f32 {
        match self {
            Self::Half(v) => v[index].to_f32(),
            Self::Float(v) => v[index],
            Self::Uint(v) => v[index] as f32,
        }
    }

    fn into_f32(self) -> Vec<f32> {
        match self {
            Self::Half(v) => v.into_iter().map(f16::to_f32).collect(),
            Self::Float(v) => v,
            Self::Uint(v) => v.into_iter().map(|x| x as f32).collect(),
        }
    }
}

/// The decoded file: planes over the union of the parts' data windows.
struct Picture {
    width: usize,
    height: usize,
    offset: [i32; 2],
    frame: Option<Window>,
    planes: Vec<(String, Plane)>,
    metadata: Metadata,
    /// The matrix to Rec.709, where the colours are of other primaries.
    rec709: Option<Mat3>,
}

/// All channels, as linear `f32` planes; colours are brought to Rec.709.
pub(crate) fn decode_image(bytes: &[u8], limits: &Limits) -> Result<Image> {
    let mut picture = decode(bytes, limits)?;
    if picture.rec709.is_some_and(|matrix| to_rec709(&mut picture.planes, matrix)) {
        picture.metadata.name_rec709();
    }
    let mut image = Image::new(picture.width, picture.height);
    for (name, plane) in picture.planes {
        image.push(name, plane.into_f32())?;
    }
    image.metadata = picture.metadata;
    image.offset = picture.offset;
    image.frame = picture.frame;
    Ok(image)
}

/// The colour channels, halves kept as halves, in the primaries of the file.
pub(crate) fn decode_texels(bytes: &[u8], limits: &Limits) -> Result<Texels> {
    let mut picture = decode(bytes, limits)?;
    let names: Vec<&str> = picture.planes.iter().map(|(name, _)| name.as_str()).collect();
    let Some(chosen) = colour::channels(&names) else {
        return Err(Error::MissingChannels { wanted: "R, G, B or Y".into(), present: names.join(", ") });
    };
    let (note, is_colour) = (colour::note(&names), colour::holds_colours(&names, &chosen));
    let lanes = chosen.len();
    let chosen: Vec<Option<&Plane>> = chosen.iter().map(|i| i.map(|i| &picture.planes[i].1)).collect();
    let pixels = picture.width * picture.height;
    let data = if chosen.iter().flatten().all(|p| matches!(p, Plane::Half(_))) {
        let mut data = vec![f16::ZERO; pixels * lanes];
        for (lane, plane) in chosen.iter().enumerate() {
            if let Some(Plane::Half(v)) = plane {
                data.iter_mut().skip(lane).step_by(lanes).zip(v).for_each(|(to, &from)| *to = from);
            }
        }
        TexelData::F16(data)
    } else {
        let mut data = vec![0.0; pixels * lanes];
        for (lane, plane) in chosen.iter().enumerate() {
            let Some(plane) = plane else { continue };
            data.iter_mut().skip(lane).step_by(lanes).enumerate().for_each(|(i, to)| *to = plane.at(i));
        }
        TexelData::F32(data)
    };
    let mut texels = Texels::new(picture.width, picture.height, lanes, data, Encoding::Linear);
    texels.metadata = std::mem::take(&mut picture.metadata);
    texels.metadata.notes.extend(note);
    texels.metadata.rec709 = picture.rec709.filter(|_| is_colour);
    Ok(texels)
}

fn decode(bytes: &[u8], limits: &Limits) -> Result<Picture> {
    header::check(bytes, limits)?;
    // The decoder is not ours: should it panic on a damaged block, that becomes an error here.
    match catch_unwind(AssertUnwindSafe(|| decode_checked(bytes, limits))) {
        Ok(result) => result,
        Err(_) => Err(Error::malformed(KIND, "the pixel decoder gave up on damaged data")),
    }
}

fn decode_checked(bytes: &[u8], limits: &Limits) -> Result<Picture> {
    let header::Normalized { bytes: plain, steps } = header::normalized(bytes)?;
    let reader = exr::block::read(std::io::Cursor::new(&plain[..]), false).map_err(explain)?;
    let mut meta = reader.meta_data().clone();
    for (part, steps) in meta.headers.iter_mut().zip(&steps) {
        for (channel, &[x, y]) in part.channels.list.iter_mut().zip(steps) {
            channel.sampling = Vec2(x as usize, y as usize);
        }
    }
    let headers = &meta.headers;
    let Some(first) = headers.first() else { return Err(Error::malformed(KIND, "no parts")) };

    let window = headers.iter().map(|h| bounds(h.data_window())).reduce(union).unwrap_or(bounds(first.data_window()));
    let [width, height] = [0, 1].map(|axis| (i64::from(window.max[axis]) - i64::from(window.min[axis])).max(0) as u64);
    let channel_count: usize = headers.iter().map(|h| h.channels.list.len()).sum();
    let pixels = limits.check(KIND, width, height, 4 * channel_count as u64)?;
    let width = width as usize;

    let mut planes = Vec::with_capacity(channel_count);
    let mut first_plane = Vec::with_capacity(headers.len());
    for part in headers {
        first_plane.push(planes.len());
        for channel in &part.channels.list {
            planes.push((
                channel_name(part, &latin_or_utf8(channel.name.as_slice()), headers.len() > 1),
                Plane::new(channel.sample_type, pixels)?,
            ));
        }
    }

    let mut chunks = reader.all_chunks(false).map_err(explain)?;
    loop {
        let batch: Vec<Chunk> = chunks.by_ref().take(BATCH).collect::<exr::error::Result<_>>().map_err(explain)?;
        if batch.is_empty() {
            break;
        }
        let blocks: Vec<Option<Block>> =
            batch.into_par_iter().map(|chunk| decompress(chunk, headers)).collect::<Result<_>>()?;
        for block in blocks.into_iter().flatten() {
            let part = &headers[block.part];
            let own = &mut planes[first_plane[block.part]..][..part.channels.list.len()];
            place(&block, part, own, window.min, width)?;
        }
    }
    to_full_resolution(&mut planes, headers, width);
    let mut metadata = metadata(first);
    let rec709 = rec709_matrix(first, &mut metadata);
    Ok(Picture {
        width,
        height: height as usize,
        offset: window.min,
        frame: Some(bounds(first.shared_attributes.display_window)).filter(|frame| *frame != window),
        planes,
        metadata,
        rec709,
    })
}

/// Fills subsampled channels, and turns luminance and chroma into colours.
fn to_full_resolution(planes: &mut [(String, Plane)], headers: &[Header], width: usize) {
    let steps = headers.iter().flat_map(|part| part.channels.list.iter().map(|c| [c.sampling.x(), c.sampling.y()]));
    for ((_, plane), step) in planes.iter_mut().zip(steps).filter(|(_, step)| *step != [1, 1]) {
        let mut values = std::mem::replace(plane, Plane::Uint(Vec::new())).into_f32();
        chroma::upsample(&mut values, width, step);
        *plane = Plane::Float(values);
    }
    let find = |name: &str| planes.iter().position(|(n, _)| n == name);
    let (Some(y), Some(ry), Some(by), None) = (find("Y"), find("RY"), find("BY"), find("R")) else { return };
    let mut values = [y, ry, by].map(|i| std::mem::replace(&mut planes[i].1, Plane::Uint(Vec::new())).into_f32());
    let [luma, red, blue] = &mut values;
    chroma::to_rgb(luma, red, blue, headers[0].shared_attributes.chromaticities);
    for ((index, name), plane) in [(ry, "R"), (y, "G"), (by, "B")].into_iter().zip({
        let [g, r, b] = values;
        [r, g, b]
    }) {
        planes[index] = (name.into(), Plane::Float(plane));
    }
}

/// The matrix from the file's colours to Rec.709, where it names other primaries; one that there is none for is noted.
fn rec709_matrix(header: &Header, metadata: &mut Metadata) -> Option<Mat3> {
    let named = header.shared_attributes.chromaticities.filter(|&c| !primaries::are_rec709(c))?;
    let matrix = primaries::to_rec709(named);
    if matrix.is_none() {
        let what = "the 'chromaticities' of this picture span no gamut: its colours are taken for Rec.709";
        metadata.notes.push(what.into());
    }
    matrix.map(|m| m.as_mat3())
}

/// Turns the colours of all layers into Rec.709.
fn to_rec709(planes: &mut [(String, Plane)], matrix: Mat3) -> bool {
    let names: Vec<&str> = planes.iter().map(|(name, _)| name.as_str()).collect();
    let groups = colour::groups(&names);
    for group in &groups {
        let mut values = group.map(|i| std::mem::replace(&mut planes[i].1, Plane::Uint(Vec::new())).into_f32());
        let [red, green, blue] = &mut values;
        for ((r, g), b) in red.iter_mut().zip(green).zip(blue) {
            [*r, *g, *b] = (matrix * Vec3::new(*r, *g, *b)).to_array();
        }
        for (&index, plane) in group.iter().zip(values) {
            planes[index].1 = Plane::Float(plane);
        }
    }
    !groups.is_empty()
}

/// A decompressed block of the full-resolution level.
struct Block {
    part: usize,
    /// Position in the part's data window, and size.
    rect: IntegerBounds,
    data: Vec<u8>,
}

/// Decompresses one chunk; `None` for the coarser levels of mip and rip maps.
fn decompress(chunk: Chunk, headers: &[Header]) -> Result<Option<Block>> {
    let bad = |what: &str| Error::malformed(KIND, what);
    let header = headers.get(chunk.layer_index).ok_or_else(|| bad("a block of an unknown part"))?;
    let tile = header.get_block_data_indices(&chunk.compressed_block).map_err(explain)?;
    if (tile.level_index.x(), tile.level_index.y()) != (0, 0) {
        return Ok(None);
    }
    let rect = header.get_absolute_block_pixel_coordinates(tile).map_err(explain)?;
    rect.validate(Some(header.layer_size)).map_err(explain)?;
    let (CompressedBlock::Tile(exr::block::chunk::CompressedTileBlock { compressed_pixels_le: stored, .. })
    | CompressedBlock::ScanLine(exr::block::chunk::CompressedScanLineBlock {
        compressed_pixels_le: stored, ..
    })) = chunk.compressed_block
    else {
        return Err(Error::unsupported(KIND, "deep data"));
    };

    if matches!(header.compression, Compression::DWAA(_) | Compression::DWAB(_)) {
        dwa::check(&stored, &rect, header)?;
    }
    // The decoder reckons a block as area × bytes per pixel, without subsampling; it is told the average of this very
    // block.
    let area = rect.size.area();
    let expected: usize = block_lines(&rect, header).map(|line| line.bytes).sum();
    let data = if matches!(header.compression, Compression::B44 | Compression::B44A) {
        b44::decompress(&stored, &rect, header)?
    } else if expected == area * header.channels.bytes_per_pixel {
        header.compression.decompress_image_section_from_le(header, stored, rect, false).map_err(explain)?
    } else if area != 0 && expected.is_multiple_of(area) {
        let mut reckoned = header.clone();
        reckoned.channels.bytes_per_pixel = expected / area;
        header.compression.decompress_image_section_from_le(&reckoned, stored, rect, false).map_err(explain)?
    } else {
        return Err(Error::unsupported(KIND, "this pattern of subsampled channels"));
    };
    if data.len() != expected {
        return Err(bad("a block has the wrong size"));
    }
    Ok(Some(Block { part: chunk.layer_index, rect, data }))
}

/// The samples of one channel in one row of a block.
pub(super) struct Line {
    pub channel: usize,
    /// Row in the part.
    y: usize,
    step: [usize; 2],
    pub bytes: usize,
}

/// The lines of a block in stored order: row by row, channel by channel; a subsampled channel is in every `step`-th
/// row.
pub(super) fn block_lines<'a>(rect: &IntegerBounds, header: &'a Header) -> impl Iterator<Item = Line> + 'a {
    let (top, width, height) = (rect.position.y().max(0) as usize, rect.size.x(), rect.size.y());
    (top..top + height).flat_map(move |y| {
        header.channels.list.iter().enumerate().filter_map(move |(channel, description)| {
            let step = [description.sampling.x().max(1), description.sampling.y().max(1)];
            let bytes = width.div_ceil(step[0]) * description.sample_type.bytes_per_sample();
            y.is_multiple_of(step[1]).then_some(Line { channel, y, step, bytes })
        })
    })
}

/// Copies a block into the planes; a subsampled value goes to the first pixel of those it stands for.
fn place(block: &Block, part: &Header, planes: &mut [(String, Plane)], origin: [i32; 2], width: usize) -> Result<()> {
    let position = part.own_attributes.layer_position;
    let left = (i64::from(position.x()) - i64::from(origin[0]) + i64::from(block.rect.position.x())) as usize;
    let top = (i64::from(position.y()) - i64::from(origin[1])) as usize;
    let mut at = 0;
    for line in block_lines(&block.rect, part) {
        let plane = &mut planes[line.channel].1;
        debug_assert_eq!(line.bytes % plane.sample_bytes(), 0);
        let samples = &block.data[at..at + line.bytes];
        plane.store((top + line.y) * width + left, line.step[0], samples);
        at += line.bytes;
    }
    Ok(())
}

/// `channel`, or `part.channel` in a file of several parts.
fn channel_name(part: &Header, channel: &str, several: bool) -> String {
    let name = part.own_attributes.layer_name.as_ref().map(|name| latin_or_utf8(name.as_slice()));
    match name {
        Some(name) if several && !channel.starts_with(&format!("{name}.")) => format!("{name}.{channel}"),
        _ => channel.to_owned(),
    }
}

fn bounds(b: IntegerBounds) -> Window {
    let [x, y] = [b.position.x(), b.position.y()];
    let end = |start: i32, size: usize| (i64::from(start) + size as i64).min(i64::from(i32::MAX)) as i32;
    Window { min: [x, y], max: [end(x, b.size.x()), end(y, b.size.y())] }
}

fn union(a: Window, b: Window) -> Window {
    Window {
        min: [a.min[0].min(b.min[0]), a.min[1].min(b.min[1])],
        max: [a.max[0].max(b.max[0]), a.max[1].max(b.max[1])],
    }
}

/// The attributes that say something about the picture, sorted by name; those that describe the storage, and a few that
/// have no place in ours, are left out.
fn metadata(header: &Header) -> Metadata {
    const STORAGE: [&[u8]; 12] = [
        b"name",
        b"type",
        b"Type",
        b"version",
        b"chunkCount",
        b"dwaCompressionLevel",
        b"screenWindowCenter",
        b"adoptedNeutral",
        b"renderingTransform",
        b"lookModTransform",
        b"framesPerSecond",
        b"deepImageState",
    ];
    let mut metadata = Metadata::default();
    for (name, value) in header.all_named_attributes() {
        let join = |numbers: &[f32]| numbers.iter().map(f32::to_string).collect::<Vec<_>>().join(" ");
        let default_value = match value {
            AttributeValue::F32(x) => (name == b"pixelAspectRatio" || name == b"screenWindowWidth") && x == 1.0,
            _ => false,
        };
        if default_value || STORAGE.contains(&name) {
            continue;
        }
        let value = match value {
            AttributeValue::Text(text) => Value::Text(latin_or_utf8(text.as_slice())),
            AttributeValue::F32(x) => Value::Float(x),
            AttributeValue::F64(x) => Value::Float(x as f32),
            AttributeValue::I32(x) => Value::Int(x),
            AttributeValue::Matrix4x4(m) => Value::Matrix(m),
            AttributeValue::Chromaticities(c) => Value::Text(primaries::text(c)),
            AttributeValue::FloatVec2(v) => Value::Text(join(&[v.x(), v.y()])),
            AttributeValue::FloatVec3((x, y, z)) => Value::Text(join(&[x, y, z])),
            AttributeValue::Rational((n, d)) => Value::Text(format!("{n}/{d}")),
            AttributeValue::EnvironmentMap(EnvironmentMap::LatitudeLongitude) => Value::Text("latlong".into()),
            AttributeValue::EnvironmentMap(EnvironmentMap::Cube) => Value::Text("cube".into()),
            _ => continue,
        };
        metadata.set(latin_or_utf8(name), value);
    }
    metadata.entries.sort_by(|a, b| a.0.cmp(&b.0));
    metadata
}

/// Texts are bytes in EXR: UTF-8 by today's custom, Latin-1 in old files.
fn latin_or_utf8(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap_or_else(|_| bytes.iter().map(|&b| char::from(b)).collect())
}

/// The decoder's error as ours.
pub(super) fn explain(error: exr::error::Error) -> Error {
    match error {
        exr::error::Error::NotSupported(what) => Error::unsupported(KIND, what),
        exr::error::Error::Invalid(what) => Error::malformed(KIND, what),
        exr::error::Error::Io(error) => Error::malformed(KIND, format!("the file ends early ({error})")),
        exr::error::Error::Aborted => Error::malformed(KIND, "aborted"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use exr::image::{AnyChannel, AnyChannels, FlatSamples, Layer};
    use exr::meta::header::LayerAttributes;
    use exr::prelude::WritableImage;

    /// A part with one constant channel.
    fn part(
        name: &str,
        channel: &str,
        value: f32,
        position: [i32; 2],
        size: [usize; 2],
    ) -> Layer<AnyChannels<FlatSamples>> {
        let samples = FlatSamples::F32(vec![value; size[0] * size[1]]);
        Layer::new(
            Vec2(size[0], size[1]),
            LayerAttributes::named(name).with_position(Vec2(position[0], position[1])),
            exr::image::Encoding::SMALL_LOSSLESS,
            AnyChannels::sort(smallvec_of(AnyChannel::new(channel, samples))),
        )
    }

    fn smallvec_of<T>(item: T) -> exr::prelude::SmallVec<[T; 4]> {
        std::iter::once(item).collect()
    }

    #[test]
    fn parts_are_layers_in_one_picture() {
        let layers = [part("beauty", "R", 1.0, [0, 0], [4, 4]), part("depth", "Z", 2.0, [2, 1], [4, 4])];
        let frame = IntegerBounds::new(Vec2(0, 0), Vec2(4, 4));
        let file = exr::image::Image::from_layers(exr::meta::header::ImageAttributes::new(frame), layers.to_vec());
        let mut bytes = Vec::new();
        file.write().to_buffered(std::io::Cursor::new(&mut bytes)).unwrap();

        let image = decode_image(&bytes, &Limits::default()).unwrap();
        assert_eq!((image.width(), image.height()), (6, 5));
        let at = |name: &str, x: usize, y: usize| image.channel(name).unwrap()[y * 6 + x];
        // Outside its own window a part is zero.
        assert_eq!((at("beauty.R", 3, 3), at("beauty.R", 4, 3)), (1.0, 0.0));
        assert_eq!((at("depth.Z", 1, 1), at("depth.Z", 2, 1), at("depth.Z", 5, 4)), (0.0, 2.0, 2.0));
        assert_eq!(image.frame, Some(Window { min: [0, 0], max: [4, 4] }));
    }
}
