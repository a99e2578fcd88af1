//! Writes a picture as a single-part scan-line EXR file, the same bytes every time.

use super::decode::explain;
use super::header;
use crate::{Compression, Error, FileKind, Image, Precision, Result, Value, WriteOptions};
use exr::block::lines::LineRefMut;
use exr::image::write::samples::{SamplesWriter, WritableSamples};
use exr::image::{AnyChannel, AnyChannels, Blocks, Encoding, Layer};
use exr::math::{RoundingMode, Vec2};
use exr::meta::attribute::{
    AttributeValue, Chromaticities, EnvironmentMap, IntegerBounds, LevelMode, LineOrder, SampleType, Text,
};
use exr::meta::header::{Header, ImageAttributes, LayerAttributes, standard_names};
use exr::prelude::WritableImage;
use half::f16;

const KIND: FileKind = FileKind::Exr;

/// The largest half.
const MOST_HALF: f32 = 65504.0;

/// CIE xy of the Rec.709 primaries and D65 (ITU-R BT.709-6, table 1.3).
const REC709: Chromaticities = Chromaticities {
    red: Vec2(0.64, 0.33),
    green: Vec2(0.30, 0.60),
    blue: Vec2(0.15, 0.06),
    white: Vec2(0.3127, 0.3290),
};

/// The bytes of the file.
pub(crate) fn encode(image: &Image, options: &WriteOptions) -> Result<Vec<u8>> {
    if image.channels().is_empty() {
        return Err(Error::unsupported(KIND, "a picture without channels"));
    }
    let mut list: Vec<_> = image.channels().iter().collect();
    list.sort_by(|a, b| a.name.as_bytes().cmp(b.name.as_bytes()));
    let channels = list
        .into_iter()
        .map(|channel| {
            let half = options.exr_precision == Precision::Half && !needs_float(&channel.name);
            Ok(AnyChannel::new(text(&channel.name)?, Plane { data: &channel.data, width: image.width(), half }))
        })
        .collect::<Result<_>>()?;

    let size = Vec2(image.width(), image.height());
    let mut layer_attributes = LayerAttributes::default().with_position(Vec2(image.offset[0], image.offset[1]));
    let elsewhere = |name: &str| name == "chromaticities" || name == "pixelAspectRatio";
    for (name, value) in image.metadata.entries.iter().filter(|(name, _)| !elsewhere(name)) {
        set_attribute(&mut layer_attributes, name, value)?;
    }
    let layer = Layer::new(
        size,
        layer_attributes,
        Encoding {
            compression: match options.exr_compression {
                Compression::None => exr::compression::Compression::Uncompressed,
                Compression::Zip => exr::compression::Compression::ZIP16,
                Compression::Piz => exr::compression::Compression::PIZ,
            },
            blocks: Blocks::ScanLines,
            line_order: LineOrder::Increasing,
        },
        AnyChannels { list: channels },
    );
    let frame = match image.frame {
        None => IntegerBounds::new(Vec2(image.offset[0], image.offset[1]), size),
        Some(window) => {
            let extent = |axis: usize| usize::try_from(i64::from(window.max[axis]) - i64::from(window.min[axis])).ok();
            let (Some(w @ 1..), Some(h @ 1..)) = (extent(0), extent(1)) else {
                return Err(Error::Invalid(format!("the frame {window:?} is empty")));
            };
            IntegerBounds::new(Vec2(window.min[0], window.min[1]), Vec2(w, h))
        }
    };
    let pixel_aspect = match image.metadata.get("pixelAspectRatio") {
        Some(Value::Float(ratio)) if (1e-6..=1e6).contains(ratio) => *ratio,
        _ => 1.0,
    };
    let attributes =
        ImageAttributes { pixel_aspect, chromaticities: Some(chromaticities(image)), ..ImageAttributes::new(frame) };
    let file = exr::image::Image { attributes, layer_data: layer };
    let mut bytes = Vec::new();
    file.write().to_buffered(std::io::Cursor::new(&mut bytes)).map_err(explain)?;
    sort_attributes(&mut bytes)?;
    Ok(bytes)
}

/// A plane of the picture, to be stored as halves or floats; its rows are turned into that as they are written.
#[derive(Clone, Copy)]
struct Plane<'a> {
    data: &'a [f32],
    width: usize,
    half: bool,
}

impl<'a> WritableSamples<'a> for Plane<'_> {
    type Writer = Self;

    fn sample_type(&self) -> SampleType {
        if self.half { SampleType::F16 } else { SampleType::F32 }
    }

    fn infer_level_modes(&self) -> (LevelMode, RoundingMode) {
        (LevelMode::Singular, RoundingMode::Down)
    }

    fn create_samples_writer(&'a self, _: &Header) -> Self {
        *self
    }
}

impl SamplesWriter for Plane<'_> {
    fn extract_line(&self, line: LineRefMut<'_>) {
        let start = line.location.position.y() * self.width + line.location.position.x();
        let samples = &self.data[start..start + line.location.sample_count];
        // Into memory of the right size, which does not fail.
        let _ = if self.half {
            let halves: Vec<f16> = samples.iter().map(|&x| half_clamped(x)).collect();
            line.write_samples_from_slice(&halves)
        } else {
            line.write_samples_from_slice(samples)
        };
    }
}

/// Depths, positions and numbers of things keep 32 bits: a half counts to 2048 only. The ids of Cryptomatte are bits of
/// floats.
fn needs_float(name: &str) -> bool {
    name == "Z"
        || ["Z", "P", "depth", "samples", "object_id", "variance"]
            .iter()
            .any(|layer| name.split('.').next() == Some(layer))
        || name.starts_with("crypto_")
}

/// Number of finite values of a picture that are beyond the range of halves, and are clamped to it where a file keeps
/// halves.
pub fn clamped_to_half(image: &Image) -> usize {
    let channels = image.channels().iter().filter(|c| !needs_float(&c.name));
    channels.flat_map(|c| &c.data).filter(|v| v.is_finite() && v.abs() > MOST_HALF).count()
}

/// The nearest half; finite values stay finite.
fn half_clamped(x: f32) -> f16 {
    if x.is_finite() { f16::from_f32(x.clamp(-MOST_HALF, MOST_HALF)) } else { f16::from_f32(x) }
}

/// The name of a channel or attribute.
fn text(s: &str) -> Result<Text> {
    if (1..256).contains(&s.len()) && !s.contains('\0') {
        Ok(utf8(s))
    } else {
        Err(Error::unsupported(KIND, format!("the name {s:?} (1 to 255 bytes)")))
    }
}

fn utf8(s: &str) -> Text {
    Text::from_slice_unchecked(s.as_bytes())
}

/// Metadata become attributes; those that EXR itself defines by this name go to their own place.
fn set_attribute(to: &mut LayerAttributes, name: &str, value: &Value) -> Result<()> {
    // Formats that keep texts alone, such as PNG, have numbers as texts.
    let number = match value {
        Value::Text(s) if standard_names::ALL.contains(&name.as_bytes()) => s.trim().parse().ok().map(Value::Float),
        _ => None,
    };
    let is_text = ["owner", "comments", "capDate", "software", "wrapmodes", "view", "envmap"].contains(&name);
    match (name, number.as_ref().filter(|_| !is_text).unwrap_or(value)) {
        ("owner", Value::Text(s)) => to.owner = Some(utf8(s)),
        ("comments", Value::Text(s)) => to.comments = Some(utf8(s)),
        ("capDate", Value::Text(s)) => to.capture_date = Some(utf8(s)),
        ("software", Value::Text(s)) => to.software_name = Some(utf8(s)),
        ("wrapmodes", Value::Text(s)) => to.wrap_mode_name = Some(utf8(s)),
        ("view", Value::Text(s)) => to.view_name = Some(utf8(s)),
        ("whiteLuminance", Value::Float(x)) => to.white_luminance = Some(*x),
        ("expTime", Value::Float(x)) => to.exposure = Some(*x),
        ("aperture", Value::Float(x)) => to.aperture = Some(*x),
        ("focus", Value::Float(x)) => to.focus = Some(*x),
        ("isoSpeed", Value::Float(x)) => to.iso_speed = Some(*x),
        ("near", Value::Float(x)) => to.near_clip_plane = Some(*x),
        ("far", Value::Float(x)) => to.far_clip_plane = Some(*x),
        ("fieldOfViewHorizontal", Value::Float(x)) => to.horizontal_field_of_view = Some(*x),
        ("fieldOfViewVertical", Value::Float(x)) => to.vertical_field_of_view = Some(*x),
        ("xDensity", Value::Float(x)) => to.horizontal_density = Some(*x),
        ("utcOffset", Value::Float(x)) => to.utc_offset = Some(*x),
        ("longitude", Value::Float(x)) => to.longitude = Some(*x),
        ("latitude", Value::Float(x)) => to.latitude = Some(*x),
        ("altitude", Value::Float(x)) => to.altitude = Some(*x),
        ("screenWindowWidth", Value::Float(x)) => to.screen_window_width = *x,
        ("worldToCamera", Value::Matrix(m)) => to.world_to_camera = Some(*m),
        ("worldToNDC", Value::Matrix(m)) => to.world_to_normalized_device = Some(*m),
        ("envmap", Value::Text(s)) if s == "latlong" => to.environment_map = Some(EnvironmentMap::LatitudeLongitude),
        ("envmap", Value::Text(s)) if s == "cube" => to.environment_map = Some(EnvironmentMap::Cube),
        _ if standard_names::ALL.contains(&name.as_bytes()) => {
            return Err(Error::unsupported(
                KIND,
                format!("metadata `{name}` = {value:?}: EXR uses this name for something else"),
            ));
        }
        _ => {
            let value = match value {
                Value::Text(s) => AttributeValue::Text(utf8(s)),
                Value::Float(x) => AttributeValue::F32(*x),
                Value::Int(i) => AttributeValue::I32(*i),
                Value::Matrix(m) => AttributeValue::Matrix4x4(*m),
            };
            to.other.insert(text(name)?, value);
        }
    }
    Ok(())
}

/// The primaries that the metadata name as eight numbers, as files that were read have it; Rec.709 otherwise.
fn chromaticities(image: &Image) -> Chromaticities {
    let Some(Value::Text(s)) = image.metadata.get("chromaticities") else { return REC709 };
    let numbers: Vec<f32> = s.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    let &[rx, ry, gx, gy, bx, by, wx, wy] = &numbers[..] else { return REC709 };
    Chromaticities { red: Vec2(rx, ry), green: Vec2(gx, gy), blue: Vec2(bx, by), white: Vec2(wx, wy) }
}

/// Puts the header's attributes in order of their names: the encoder keeps them in a hash map, whose order changes from
/// run to run. The length of the header, and so every offset in the file, stays.
fn sort_attributes(bytes: &mut [u8]) -> Result<()> {
    let parts = header::attributes(bytes)?;
    let Some(part) = parts.first().filter(|part| !part.is_empty()) else { return Ok(()) };
    let mut order: Vec<_> = part.iter().map(|a| (a.name, a.span.clone())).collect();
    let start = order[0].1.start;
    order.sort_by(|a, b| a.0.cmp(b.0));
    let sorted: Vec<u8> = order.into_iter().flat_map(|(_, span)| bytes[span].to_vec()).collect();
    bytes[start..start + sorted.len()].copy_from_slice(&sorted);
    Ok(())
}
