//! The pixel image: named planes of linear `f32` values, and metadata.

use crate::{Error, Result, colour};
use steradian_math::Mat3;

/// One named plane of an [`Image`], rows from the top, `width × height` values.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// The name, with layers before a dot: `R`, `albedo.G`, `N.X`, `Z`.
    pub name: String,
    /// The values, row by row from the top left.
    pub data: Vec<f32>,
}

/// A metadata value.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// Text.
    Text(String),
    /// A real number.
    Float(f32),
    /// An integer.
    Int(i32),
    /// A 4×4 matrix in the order the file stores it (EXR `m44f`: row by row).
    Matrix([f32; 16]),
}

/// Ordered `(name, value)` pairs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Metadata {
    /// The pairs, in order; names are unique.
    pub entries: Vec<(String, Value)>,
    /// Messages about what reading the file guessed or left out. They are not written.
    pub notes: Vec<String>,
    /// The matrix to Rec.709, where texels have colours of other primaries; see [`crate::Texels::to_rec709`].
    pub rec709: Option<Mat3>,
}

impl Metadata {
    /// The value with this name.
    pub fn get(&self, name: &str) -> Option<&Value> {
        self.entries.iter().find(|(n, _)| n == name).map(|(_, value)| value)
    }

    /// Sets a value, replacing one of the same name in its place.
    pub fn set(&mut self, name: impl Into<String>, value: Value) {
        let name = name.into();
        match self.entries.iter_mut().find(|(n, _)| *n == name) {
            Some(entry) => entry.1 = value,
            None => self.entries.push((name, value)),
        }
    }

    /// Notes that colours are of Rec.709 now: `chromaticities` says so, `sourceChromaticities` keeps what it was.
    pub(crate) fn name_rec709(&mut self) {
        if let Some(source) = self.get("chromaticities").cloned() {
            self.set("sourceChromaticities", source);
        }
        self.set_text("chromaticities", "0.64 0.33 0.3 0.6 0.15 0.06 0.3127 0.329");
        self.entries.sort_by(|a, b| a.0.cmp(&b.0));
    }

    /// Sets a text.
    pub fn set_text(&mut self, name: impl Into<String>, text: impl Into<String>) {
        self.set(name, Value::Text(text.into()));
    }
}

/// A rectangle of pixels: `min` inclusive, `max` exclusive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// Left and top.
    pub min: [i32; 2],
    /// Right and bottom, exclusive.
    pub max: [i32; 2],
}

/// A picture: named planes of linear values.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Image {
    width: usize,
    height: usize,
    channels: Vec<Channel>,
    /// Free-form metadata, kept by EXR and (texts and numbers) PNG.
    pub metadata: Metadata,
    /// Position of pixel (0, 0) in the whole frame; not (0, 0) for crops. Kept by EXR.
    pub offset: [i32; 2],
    /// The whole frame, when it differs from the pixels that are there. Kept by EXR.
    pub frame: Option<Window>,
}

/// The three colour planes of an image; all three are the same plane for a grey image.
#[derive(Clone, Copy, Debug)]
pub struct RgbPlanes<'a> {
    /// Red.
    pub r: &'a [f32],
    /// Green.
    pub g: &'a [f32],
    /// Blue.
    pub b: &'a [f32],
}

impl RgbPlanes<'_> {
    /// The colour of the pixel with this index (`y × width + x`).
    #[inline]
    pub fn at(&self, index: usize) -> [f32; 3] {
        [self.r[index], self.g[index], self.b[index]]
    }
}

impl Image {
    /// A picture of this size without channels.
    pub fn new(width: usize, height: usize) -> Self {
        Self { width, height, ..Self::default() }
    }

    /// A picture with channels `R`, `G`, `B` from `width × height` pixels.
    ///
    /// # Errors
    /// [`Error::SizeMismatch`] when the number of pixels differs.
    pub fn from_rgb(width: usize, height: usize, pixels: &[[f32; 3]]) -> Result<Self> {
        let mut image = Self::new(width, height);
        for (lane, name) in ["R", "G", "B"].into_iter().enumerate() {
            image.push(name, pixels.iter().map(|p| p[lane]).collect())?;
        }
        Ok(image)
    }

    /// Width in pixels.
    #[inline]
    pub fn width(&self) -> usize {
        self.width
    }

    /// Height in pixels.
    #[inline]
    pub fn height(&self) -> usize {
        self.height
    }

    /// Width × height.
    #[inline]
    pub fn pixel_count(&self) -> usize {
        self.width * self.height
    }

    /// All channels, in order.
    pub fn channels(&self) -> &[Channel] {
        &self.channels
    }

    /// The channels themselves, whoever takes them keeps their memory.
    pub fn into_channels(self) -> Vec<Channel> {
        self.channels
    }

    /// The plane with this name.
    pub fn channel(&self, name: &str) -> Option<&[f32]> {
        self.channels.iter().find(|c| c.name == name).map(|c| &c.data[..])
    }

    /// The plane with this name, to change.
    pub fn channel_mut(&mut self, name: &str) -> Option<&mut [f32]> {
        self.channels.iter_mut().find(|c| c.name == name).map(|c| &mut c.data[..])
    }

    /// Adds a plane.
    ///
    /// # Errors
    /// [`Error::SizeMismatch`] when `data` is not `width × height` long, [`Error::DuplicateChannel`].
    pub fn push(&mut self, name: impl Into<String>, data: Vec<f32>) -> Result<()> {
        let name = name.into();
        if data.len() != self.pixel_count() {
            return Err(Error::SizeMismatch {
                left: format!("{}x{} pixels", self.width, self.height),
                right: format!("{} values of channel `{name}`", data.len()),
            });
        }
        if self.channel(&name).is_some() {
            return Err(Error::DuplicateChannel(name));
        }
        self.channels.push(Channel { name, data });
        Ok(())
    }

    /// Adds the three planes `layer.R`, `layer.G`, `layer.B` (or any three suffixes, e.g. `["X", "Y", "Z"]`); an empty
    /// layer name gives the suffixes alone.
    ///
    /// # Errors
    /// As [`Image::push`].
    pub fn push_layer(&mut self, layer: &str, suffixes: [&str; 3], pixels: &[[f32; 3]]) -> Result<()> {
        for (lane, suffix) in suffixes.into_iter().enumerate() {
            let name = if layer.is_empty() { suffix.to_owned() } else { format!("{layer}.{suffix}") };
            self.push(name, pixels.iter().map(|p| p[lane]).collect())?;
        }
        Ok(())
    }

    /// The colour planes: `R`, `G`, `B`; else the grey plane `Y`, or the only channel, three times; else those of a
    /// layer that has all three, the one called `rgba`, `Combined` or `beauty` before others; else those of a layer
    /// with one colour, three times. `None` where the layer with most colours has two.
    pub fn rgb(&self) -> Option<RgbPlanes<'_>> {
        let names: Vec<&str> = self.channels.iter().map(|c| c.name.as_str()).collect();
        let plane = |index: usize| &self.channels[index].data[..];
        match colour::channels(&names)?[..] {
            [r, g, b, ..] => Some(RgbPlanes { r: plane(r?), g: plane(g?), b: plane(b?) }),
            [y, ..] => y.map(plane).map(|y| RgbPlanes { r: y, g: y, b: y }),
            [] => None,
        }
    }

    /// A message about the colour planes where their names leave a doubt: one layer of several was chosen, or the
    /// picture is a depth.
    pub fn colour_note(&self) -> Option<String> {
        colour::note(&self.channels.iter().map(|c| c.name.as_str()).collect::<Vec<_>>())
    }

    /// The planes `layer.R`, `layer.G`, `layer.B`; of the root for an empty layer name.
    pub fn layer_rgb(&self, layer: &str) -> Option<RgbPlanes<'_>> {
        let plane = |suffix: &str| {
            if layer.is_empty() { self.channel(suffix) } else { self.channel(&format!("{layer}.{suffix}")) }
        };
        Some(RgbPlanes { r: plane("R")?, g: plane("G")?, b: plane("B")? })
    }

    /// A layer as a picture of its own: the channel of that name, or all that are called `name.` and something. One
    /// channel becomes `Y`; up to four become `R`, `G`, `B`, `A` in the order of red, green, blue, alpha, of X, Y, Z,
    /// or of U, V, and what lacks to three is zero. Metadata are kept. `None` where there is no such channel, and where
    /// there are more.
    pub fn layer(&self, name: &str) -> Option<Self> {
        let exact = self.channels.iter().find(|c| c.name == name);
        let prefix = format!("{name}.");
        let rank = |c: &Channel| "RXUYGVBZA".find(c.name.strip_prefix(&prefix).unwrap_or("A"));
        let mut found: Vec<&Channel> = match exact {
            Some(channel) => vec![channel],
            None => self.channels.iter().filter(|c| c.name.starts_with(&prefix)).collect(),
        };
        found.sort_by_key(|c| rank(c));
        let names: &[&str] = match found.len() {
            0 | 5.. => return None,
            1 => &["Y"],
            _ => &["R", "G", "B", "A"],
        };
        let mut picture = Self { metadata: self.metadata.clone(), ..Self::new(self.width, self.height) };
        for (i, name) in names.iter().enumerate().take(found.len().max(names.len().min(3))) {
            let data = found.get(i).map_or_else(|| vec![0.0; self.pixel_count()], |c| c.data.clone());
            picture.push(*name, data).ok()?;
        }
        Some(picture)
    }

    /// Planes of [`Image::rgb`], or an error that lists the channels there are.
    ///
    /// # Errors
    /// [`Error::MissingChannels`].
    pub fn require_rgb(&self) -> Result<RgbPlanes<'_>> {
        self.rgb()
            .ok_or_else(|| Error::MissingChannels { wanted: "R, G, B or Y".into(), present: self.channel_names() })
    }

    /// The colours of all pixels.
    ///
    /// # Errors
    /// As [`Image::require_rgb`].
    pub fn to_rgb(&self) -> Result<Vec<[f32; 3]>> {
        let planes = self.require_rgb()?;
        Ok((0..self.pixel_count()).map(|i| planes.at(i)).collect())
    }

    /// Comma-separated channel names.
    pub fn channel_names(&self) -> String {
        self.channels.iter().map(|c| c.name.as_str()).collect::<Vec<_>>().join(", ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_layer_is_a_picture_of_its_own() {
        let mut image = Image::from_rgb(1, 1, &[[1.0, 2.0, 3.0]]).unwrap();
        for (name, value) in [("N.Z", 6.0), ("N.Y", 5.0), ("N.X", 4.0), ("Z", 7.0), ("uv.V", 9.0), ("uv.U", 8.0)] {
            image.push(name, vec![value]).unwrap();
        }
        let colour = |name: &str| image.layer(name).unwrap().rgb().unwrap().at(0);
        assert_eq!(colour("N"), [4.0, 5.0, 6.0]);
        assert_eq!((colour("Z"), colour("N.Y")), ([7.0; 3], [5.0; 3]));
        assert_eq!(colour("uv"), [8.0, 9.0, 0.0]);
        assert!(image.layer("n").is_none() && image.layer("").is_none());
    }

    #[test]
    fn planes_are_found_by_name_and_checked() {
        let mut image = Image::from_rgb(2, 1, &[[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]).unwrap();
        image.push_layer("N", ["X", "Y", "Z"], &[[0.0; 3]; 2]).unwrap();
        assert_eq!(image.rgb().unwrap().at(1), [4.0, 5.0, 6.0]);
        assert_eq!(image.channel("N.Z").unwrap(), [0.0, 0.0]);
        assert!(matches!(image.push("R", vec![0.0; 2]), Err(Error::DuplicateChannel(_))));
        assert!(matches!(image.push("Q", vec![0.0; 3]), Err(Error::SizeMismatch { .. })));
    }

    #[test]
    fn grey_serves_as_colour() {
        let mut image = Image::new(1, 1);
        assert!(image.rgb().is_none());
        image.push("Y", vec![0.5]).unwrap();
        assert_eq!(image.rgb().unwrap().at(0), [0.5; 3]);
    }

    #[test]
    fn metadata_keeps_order_and_replaces() {
        let mut metadata = Metadata::default();
        metadata.set("b", Value::Int(1));
        metadata.set_text("a", "x");
        metadata.set("b", Value::Float(2.0));
        assert_eq!(metadata.entries[0], ("b".into(), Value::Float(2.0)));
        assert_eq!(metadata.get("a"), Some(&Value::Text("x".into())));
    }
}
