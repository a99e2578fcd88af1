//! Layers of a picture, from the sums on a film.

mod bands;
mod cryptomatte;
mod light;
mod samples;
mod surface;

pub use light::bounce_parts;

use crate::{Film, FirstHit, LayerInputs, Pixel};
use std::{collections::BTreeMap, fmt};
use steradian_image::Image;

/// An auxiliary layer. A new one is a constant like those of `surface.rs` and a line in [`Layer::ALL`].
#[derive(Clone, Copy)]
pub struct Layer(&'static Row);

/// Name, channels and computation of a layer.
struct Row {
    /// Name on the command line.
    name: &'static str,
    /// Names of its channels in a file; of layers of several parts those of the first.
    channels: &'static [&'static str],
    /// Content and channels, in a phrase.
    doc: &'static str,
    /// True if it is among `all` layers.
    in_all: bool,
    /// Measurements that it is made of.
    inputs: LayerInputs,
    write: Write,
}

/// Computation of a layer from the film.
enum Write {
    /// Values of the channels from the mean first hit of a pixel.
    Hits(fn(&FirstHit, &Names) -> [f32; 3]),
    /// Values of the channels from the samples of a pixel.
    Pixels(fn(&Pixel) -> [f32; 3]),
    /// Channels of the whole film.
    Film(fn(&Film, &Names, &mut Image)),
}

macro_rules! layers {
    ($($module:ident::$name:ident,)*) => {
        impl Layer {
            /// All layers.
            pub const ALL: &[Self] = &[$(Self::$name),*];

            $(#[doc = concat!("The layer of `", stringify!($name), "`.")]
            pub const $name: Self = $module::$name;)*
        }
    };
}

layers! {
    surface::ALBEDO,
    surface::NORMAL,
    surface::DENOISE_ALBEDO,
    surface::DENOISE_NORMAL,
    surface::GEOMETRIC_NORMAL,
    surface::POSITION,
    surface::DEPTH,
    surface::MOTION,
    surface::UV,
    surface::IDS,
    samples::VARIANCE,
    samples::SAMPLES,
    surface::ALPHA,
    cryptomatte::CRYPTOMATTE,
    light::LIGHT_GROUPS,
    light::BOUNCES,
    samples::HALVES,
}

impl Layer {
    /// Name on the command line.
    pub fn name(self) -> &'static str {
        self.0.name
    }

    /// Names of the channels in a file; of layers of several parts those of the first.
    pub fn channels(self) -> &'static [&'static str] {
        self.0.channels
    }

    /// The part of the first channel's name before the dot.
    pub fn prefix(self) -> &'static str {
        self.0.channels[0].split('.').next().unwrap_or_default()
    }

    /// Content and channels, in a phrase.
    pub fn doc(self) -> &'static str {
        self.0.doc
    }

    /// True if it is among `all` layers.
    pub fn is_in_all(self) -> bool {
        self.0.in_all
    }

    /// Measurements that it is made of.
    pub fn inputs(self) -> LayerInputs {
        self.0.inputs
    }

    /// The layer of a name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|l| l.name() == name)
    }

    /// Adds its channels to a picture.
    fn write(self, film: &Film, hits: &[FirstHit], names: &Names, image: &mut Image) {
        let values: Vec<[f32; 3]> = match self.0.write {
            // Of films without first hits there is no such layer.
            Write::Hits(_) if hits.is_empty() => return,
            Write::Hits(of) => hits.iter().map(|hit| of(hit, names)).collect(),
            Write::Pixels(of) => film.pixels.iter().map(of).collect(),
            Write::Film(write) => return write(film, names, image),
        };
        for (c, channel) in self.channels().iter().enumerate() {
            push(image, channel, values.iter().map(|v| v[c]).collect());
        }
    }
}

impl LayerInputs {
    /// The union of the inputs of some layers.
    pub fn of(layers: &[Layer]) -> Self {
        layers.iter().fold(Self::NONE, |all, layer| all.with(layer.inputs()))
    }
}

/// Layers have distinct names.
impl PartialEq for Layer {
    fn eq(&self, other: &Self) -> bool {
        self.0.name == other.0.name
    }
}

impl Eq for Layer {}

impl fmt::Debug for Layer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.0.name)
    }
}

/// Channels that [`Layer::HALVES`] begins with.
pub const HALVES: [&str; 2] = ["half_a", "half_b"];

/// Names of the things that layers show.
#[derive(Clone, Debug, Default)]
pub struct Names {
    /// Objects by [`FirstHit::shape`].
    pub objects: BTreeMap<u32, String>,
    /// Materials by [`FirstHit::material`].
    pub materials: BTreeMap<u32, String>,
    /// Groups of lights, in the order of [`crate::LayerSums::by_light`].
    pub light_groups: Vec<String>,
    /// The point of the world that positions are told from.
    pub origin: [f64; 3],
}

/// The picture: linear Rec.709 in `R G B`, premultiplied by [`Layer::ALPHA`] where the background was left out, and the
/// layers asked for. Layers of first hits need a film on which they were gathered.
pub fn develop(film: &Film, layers: &[Layer], names: &Names) -> Image {
    let (w, h) = (film.crop.width() as usize, film.crop.height() as usize);
    let mut image = Image::new(w, h);
    let picture = match layers.contains(&Layer::BOUNCES) {
        true => light::sum_of_bounces(film),
        false => film.pixels.iter().map(|p| p.mean().map(held)).collect(),
    };
    for (c, name) in ["R", "G", "B"].into_iter().enumerate() {
        push(&mut image, name, picture.iter().map(|pixel| pixel[c]).collect());
    }
    let hits: Vec<FirstHit> = film.layers.features.iter().map(|f| f.mean()).collect();
    for layer in layers {
        layer.write(film, &hits, names, &mut image);
    }
    light::bins(film, &mut image);
    bands::write(film, &mut image);
    image
}

/// Adds a plane: layers have distinct names and the length of the picture.
fn push(image: &mut Image, name: &str, data: Vec<f32>) {
    let added = image.push(name, data);
    debug_assert!(added.is_ok(), "{name}: {added:?}");
}

/// A number as `f32`, held at the ends of its range: the squares of large radiances are beyond it.
fn held(v: f64) -> f32 {
    v.clamp(f64::from(f32::MIN), f64::from(f32::MAX)) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inputs_are_those_of_the_layers() {
        assert_eq!(LayerInputs::of(&[]), LayerInputs::NONE);
        let inputs = LayerInputs::of(&[Layer::MOTION, Layer::HALVES]);
        assert!(
            inputs.has(LayerInputs::FIRST_HITS) && inputs.has(LayerInputs::MOTION) && inputs.has(LayerInputs::HALVES)
        );
        assert!(
            !inputs.has(LayerInputs::SEEN_THROUGH)
                && !inputs.has(LayerInputs::MATTES)
                && !inputs.has(LayerInputs::LIGHT_GROUPS)
        );
    }
}
