//! Pictures that are made for a format which cannot say how those that are there are used.

use super::exchange::Exchange;
use std::path::Path;
use steradian_image::{Encoding, Precision};
use steradian_image::{FileKind, Image, Limits, Texels, WriteOptions, encode, read_texels, read_texels_bytes};
use steradian_math::{Vec2, Vec3, warp};
use steradian_scene::{Node, Value};

/// Samples along each side of a texel where a picture is resampled.
const SAMPLES: usize = 4;
/// Most rows of an environment that is resampled.
const MOST_ROWS: usize = 2048;

impl Exchange<'_> {
    /// The picture of a file, on disk or in memory.
    pub fn texels(&mut self, node: &Node, file: &Path) -> Option<Texels> {
        let limits = Limits::default();
        let read = match self.desc.embedded.get(file) {
            Some(bytes) => read_texels_bytes(bytes, Some(file), &limits),
            None => read_texels(file, &limits),
        };
        let mut texels =
            read.map_err(|e| self.dropped(node, format!("a picture cannot be read and is left out: {e}"))).ok()?;
        if !node.bool("raw").unwrap_or(false) {
            texels.to_rec709();
        }
        Some(texels)
    }

    /// True if a format that chooses the encoding by file type decodes an image texture as it is meant.
    pub fn is_plain(&self, node: &Node) -> bool {
        let plain_encoding = match node.get("encoding") {
            None => true,
            Some(Value::String(word)) => match word.as_str() {
                "auto" => true,
                "srgb" => is_byte_file(node) && !node.bool("raw").unwrap_or(false),
                "linear" => !is_byte_file(node) || node.bool("raw").unwrap_or(false),
                _ => false,
            },
            Some(_) => node.bool("raw").unwrap_or(false),
        };
        plain_encoding
            && node.float("scale").unwrap_or(1.0) == 1.0
            && !node.bool("invert").unwrap_or(false)
            && node.string("channel").unwrap_or("color") == "color"
    }

    /// The linear values of an image texture times a factor, with its own scale, inversion and channel applied.
    pub fn developed(&mut self, node: &Node, factor: [f64; 3]) -> Option<Image> {
        let texels = self.texels(node, node.path("file")?)?;
        let encoding = match node.get("encoding") {
            _ if node.bool("raw").unwrap_or(false) => Encoding::Linear,
            Some(Value::String(word)) if word == "srgb" => Encoding::Srgb,
            Some(Value::String(word)) if word == "linear" => Encoding::Linear,
            Some(Value::Float(gamma)) => Encoding::Gamma(*gamma as f32),
            _ => texels.encoding,
        };
        let texels = Texels { encoding, ..texels };
        let (scale, invert) = (node.float("scale").unwrap_or(1.0) as f32, node.bool("invert").unwrap_or(false));
        let colours = texels.channels - usize::from(texels.alpha().is_some());
        let lane = |c: usize| match node.string("channel").unwrap_or("color") {
            "r" => 0,
            "g" => 1.min(colours - 1),
            "b" => colours - 1,
            "a" => texels.alpha().unwrap_or(usize::MAX),
            _ => c.min(colours - 1),
        };
        let mut pixels = Vec::with_capacity(texels.width * texels.height);
        for y in 0..texels.height {
            for x in 0..texels.width {
                pixels.push(std::array::from_fn(|c| {
                    // A picture without alpha is opaque.
                    let stored = if lane(c) < texels.channels { texels.linear(x, y, lane(c)) } else { 1.0 };
                    let v = stored * scale;
                    let v = if invert { (1.0 - v).max(0.0) } else { v };
                    v * factor[c] as f32
                }));
            }
        }
        Image::from_rgb(texels.width, texels.height, &pixels).ok()
    }

    /// Writes that picture as an OpenEXR file beside the document; returns its name there.
    pub fn baked(&mut self, node: &Node, factor: [f64; 3]) -> Option<String> {
        let key = format!("{:?} {:?} {factor:?}", node.path("file"), node.params);
        if let Some(name) = self.made.get(&key) {
            return Some(name.clone());
        }
        let image = self.developed(node, factor)?;
        let name = self.keep(&image, Precision::Half)?;
        self.made.insert(key, name.clone());
        Some(name)
    }

    /// A picture of one colour; its name.
    pub fn plain_picture(&mut self, color: [f64; 3]) -> Option<String> {
        let key = format!("plain {color:?}");
        if let Some(name) = self.made.get(&key) {
            return Some(name.clone());
        }
        let image = Image::from_rgb(2, 2, &[color.map(|v| v as f32); 4]).ok()?;
        let name = self.keep(&image, Precision::Float)?;
        self.made.insert(key, name.clone());
        Some(name)
    }

    fn keep(&mut self, image: &Image, precision: Precision) -> Option<String> {
        let options = WriteOptions { exr_precision: precision, ..WriteOptions::default() };
        let bytes = encode(FileKind::Exr, image, &options).ok()?;
        Some(self.beside.add("pictures", "made.exr", bytes))
    }

    /// An environment in pbrt's octahedral map as one by longitude and latitude with +y up, rows at the poles and
    /// Mitsuba's orientation, or the other way round.
    pub fn resampled_environment(&mut self, node: &Node, file: &Path, to_octahedral: bool) -> Option<String> {
        let key = format!("environment {} {to_octahedral}", file.display());
        if let Some(name) = self.made.get(&key) {
            return Some(name.clone());
        }
        let texels = self.texels(node, file)?;
        let at = |x: usize, y: usize| -> Vec3 {
            let lane = |c: usize| c.min(texels.channels.min(3) - 1);
            Vec3::from([0, 1, 2].map(|c| texels.linear(x, y, if texels.channels < 3 { 0 } else { lane(c) })))
        };
        let rows = texels.height.clamp(4, MOST_ROWS);
        let (width, height) = if to_octahedral { (rows, rows) } else { (2 * rows, rows) };
        let (w, h) = (texels.width, texels.height);
        // Bilinear; longitudes wrap round, other edges are held.
        let lookup = |u: f32, v: f32, rounds: bool, poles: bool| -> Vec3 {
            let x = u * w as f32 - 0.5;
            let y = if poles { v * (h - 1) as f32 } else { v * h as f32 - 0.5 };
            let (x0, y0) = (x.floor(), y.floor());
            let column = |x: i64| (if rounds { x.rem_euclid(w as i64) } else { x.clamp(0, w as i64 - 1) }) as usize;
            let row = |y: i64| y.clamp(0, h as i64 - 1) as usize;
            let corner = |dx: i64, dy: i64| at(column(x0 as i64 + dx), row(y0 as i64 + dy));
            let (s, t) = (x - x0, y - y0);
            (corner(0, 0) * (1.0 - s) + corner(1, 0) * s) * (1.0 - t)
                + (corner(0, 1) * (1.0 - s) + corner(1, 1) * s) * t
        };
        let poles = node.string("rows") == Some("poles");
        let mut pixels = Vec::with_capacity(width * height);
        for row in 0..height {
            for column in 0..width {
                let mut sum = Vec3::ZERO;
                for k in 0..SAMPLES * SAMPLES {
                    let part = |i: usize| (i as f32 + 0.5) / SAMPLES as f32;
                    let x = (column as f32 + part(k % SAMPLES)) / width as f32;
                    sum += if to_octahedral {
                        let y = (row as f32 + part(k / SAMPLES)) / height as f32;
                        let d = warp::equal_area_square_to_sphere(Vec2::new(x, y));
                        // Longitude as Mitsuba has it, about +z of pbrt instead of +y.
                        let phi = d.y.atan2(d.x).rem_euclid(std::f32::consts::TAU);
                        lookup(
                            phi / std::f32::consts::TAU,
                            d.z.clamp(-1.0, 1.0).acos() / std::f32::consts::PI,
                            true,
                            poles,
                        )
                    } else {
                        let y = (row as f32 - 0.5 + part(k / SAMPLES)) / (height - 1) as f32;
                        let (sin, cos) = (y.clamp(0.0, 1.0) * std::f32::consts::PI).sin_cos();
                        let (sp, cp) = (x * std::f32::consts::TAU).sin_cos();
                        let uv = warp::equal_area_sphere_to_square(Vec3::new(cp * sin, sp * sin, cos));
                        lookup(uv.x, uv.y, false, false)
                    };
                }
                pixels.push((sum / (SAMPLES * SAMPLES) as f32).to_array());
            }
        }
        let image = Image::from_rgb(width, height, &pixels).ok()?;
        let name = self.keep(&image, Precision::Float)?;
        self.made.insert(key, name.clone());
        Some(name)
    }
}

/// True unless a picture's file type is a floating-point one (OpenEXR, HDR, PFM): integers are sRGB by custom.
pub(super) fn is_byte_file(node: &Node) -> bool {
    let extension = node.path("file").and_then(Path::extension).map(|e| e.to_string_lossy().to_ascii_lowercase());
    !matches!(extension.as_deref(), Some("exr" | "hdr" | "pfm"))
}
