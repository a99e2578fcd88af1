//! Denoising of finished pictures, guided by their layers.

pub use crate::oidn_library::oidn_library;
use crate::{Error, Layer};
pub use steradian_denoise::oidn::Oidn;
use steradian_denoise::{
    Image as Values, atrous,
    nlm::{self, Denoised, Picture, Settings, denoise, denoise_halves},
};
use steradian_film::HALVES;
use steradian_image::{Channel, Image, Value};
use steradian_math::Vec3;

/// The layer that keeps the noisy picture, and the one that keeps its variance.
const RAW: [&str; 2] = ["raw", "raw_variance"];
/// The axes of layers of colours.
const RGB: [&str; 3] = ["R", "G", "B"];
/// The attribute of the error that remains.
const ERROR: &str = "steradian:denoised_relative_error";
/// Metadata about the noise of a render, which a picture without it does not have.
const OF_NOISE: [&str; 4] = [ERROR, "steradian:relative_error", "steradian:unreliable", "steradian:error_scale_"];

/// The layers that guide denoising by regression. Of albedo and normal the layers of [`OIDN_GUIDES`] stand in, and
/// the other way round.
pub const GUIDES: [Layer; 4] = [Layer::ALBEDO, Layer::NORMAL, Layer::DEPTH, Layer::VARIANCE];
/// The layers that guide Open Image Denoise: what mirrors and smooth glass show guides it better, and regression
/// less well, as it takes fewer pixels for alike.
pub const OIDN_GUIDES: [Layer; 2] = [Layer::DENOISE_ALBEDO, Layer::DENOISE_NORMAL];

/// A denoised picture, and what it was made from.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// The picture. It keeps all layers, and the noisy picture as `raw.R`, `raw.G`, `raw.B`.
    pub picture: Image,
    /// The guides that there were.
    pub used: Vec<Layer>,
    /// The guides that there were not.
    pub missing: Vec<Layer>,
    /// Pixels whose radiance was not finite; their neighbours filled them.
    pub not_finite: usize,
    /// The relative error that remains, where halves or a second picture told it
    /// ([`steradian_denoise::nlm::denoise_halves`]). Detail that both lost is not in it, so it is a lower bound.
    pub error: Option<f64>,
}

/// Radiance of a picture, which is filtered, and its guides.
struct Guided {
    radiance: Values<Vec3>,
    /// The layers that it has, or what stands in for them, in the order of those asked for.
    layers: Vec<Option<Layer>>,
    variance: Option<Values<Vec3>>,
    albedo: Option<Values<Vec3>>,
    normal: Option<Values<Vec3>>,
    depth: Option<Values<f32>>,
}

impl Guided {
    /// Reads the planes of a picture, with albedo and normal first of the guides asked for.
    fn of(image: &Image, guides: &[Layer]) -> Result<Self, Error> {
        let size = [image.width() as u32, image.height() as u32];
        let rgb = |name: &str| values(image, name, RGB);
        // One sample tells no variance; its layer is zero.
        let tells_variance = !matches!(image.metadata.get("samplesPerPixel"), Some(Value::Int(1)));
        let variance = rgb(RAW[1]).or_else(|| rgb(Layer::VARIANCE.prefix())).filter(|_| tells_variance);
        let first = |layers: [Layer; 3], axes: [&str; 3]| {
            let found = layers.into_iter().find_map(|layer| Some((layer, values(image, layer.prefix(), axes)?)));
            found.map_or((None, None), |(layer, values)| (Some(layer), Some(values)))
        };
        let (albedo_layer, albedo) = first([guides[0], GUIDES[0], OIDN_GUIDES[0]], RGB);
        let (normal_layer, normal) = first([guides[1], GUIDES[1], OIDN_GUIDES[1]], ["X", "Y", "Z"]);
        let depth = image.channel(Layer::DEPTH.prefix()).and_then(|z| Values::new(size[0], size[1], z.to_vec()).ok());
        let pixels = || Ok::<_, Error>(image.to_rgb()?.into_iter().map(Vec3::from_array).collect());
        let guided = Self {
            radiance: match rgb(RAW[0]) {
                Some(raw) => raw,
                None => Values::new(size[0], size[1], pixels()?)?,
            },
            layers: [albedo_layer, normal_layer]
                .into_iter()
                .chain([depth.as_ref().map(|_| GUIDES[2]), variance.as_ref().map(|_| GUIDES[3])])
                .take(guides.len())
                .collect(),
            variance,
            albedo,
            normal,
            depth,
        };
        guided.check()?;
        Ok(guided)
    }

    /// Refuses a picture without any pixel to fill others from.
    fn check(&self) -> Result<(), Error> {
        let pixels = self.radiance.values();
        if pixels.is_empty() || pixels.iter().any(|pixel| pixel.is_finite()) {
            return Ok(());
        }
        let is_unknown = |c: &usize| pixels.iter().all(|pixel| !pixel[*c].is_finite());
        let unknown: Vec<String> = (0..3).filter(is_unknown).map(|c| format!("'{}'", RGB[c])).collect();
        Err(Error::NothingFinite(match unknown.as_slice() {
            [] => "no pixel has finite values of 'R', 'G' and 'B' at once".into(),
            [one] => format!("no value of the channel {one} is finite"),
            more => format!("no value of the channels {} is finite", more.join(", ")),
        }))
    }

    fn picture(&self) -> Picture<'_> {
        Picture {
            radiance: &self.radiance,
            variance: self.variance.as_ref(),
            albedo: self.albedo.as_ref(),
            normal: self.normal.as_ref(),
            depth: self.depth.as_ref(),
        }
    }
}

/// A layer of three channels, where a picture has it.
fn values(image: &Image, name: &str, axes: [&str; 3]) -> Option<Values<Vec3>> {
    let plane = |suffix| image.channel(&format!("{name}.{suffix}"));
    let [x, y, z] = axes.map(plane);
    let pixels = x?.iter().zip(y?).zip(z?).map(|((x, y), z)| Vec3::new(*x, *y, *z)).collect();
    Values::new(image.width() as u32, image.height() as u32, pixels).ok()
}

/// A half of a picture, unknown where the picture is.
fn known(mut half: Values<Vec3>, picture: &Values<Vec3>) -> Values<Vec3> {
    let pixels = half.values_mut().iter_mut().zip(picture.values());
    pixels.filter(|(_, whole)| !whole.is_finite()).for_each(|(value, _)| *value = Vec3::NAN);
    half
}

/// A picture by each half of its samples.
struct Halves {
    radiance: [Values<Vec3>; 2],
    /// Variance of either half: twice that of the picture.
    variance: Option<Values<Vec3>>,
}

impl Halves {
    /// Halves of a picture that has [`Layer::HALVES`].
    fn of(image: &Image, guided: &Guided) -> Option<Self> {
        let [a, b] = HALVES.map(|name| values(image, name, RGB).map(|half| known(half, &guided.radiance)));
        let mut variance = guided.variance.clone();
        variance.iter_mut().flat_map(Values::values_mut).for_each(|v| *v *= 2.0);
        Some(Self { radiance: [a?, b?], variance })
    }

    /// Both with the layers that guide the picture.
    fn pictures<'a>(&'a self, guided: &'a Guided) -> [Picture<'a>; 2] {
        self.radiance.each_ref().map(|radiance| Picture {
            radiance,
            variance: self.variance.as_ref(),
            ..guided.picture()
        })
    }
}

/// Denoises a picture by regression ([`steradian_denoise::nlm`]), with those of [`GUIDES`] that it has; one that
/// was denoised before, from its layer `raw`. `half` is another picture of the view with as many samples and another
/// seed: the two guide each other, and the outcome is their mean. Without it, the halves of the picture's samples do so
/// where it has [`Layer::HALVES`]. `strength` is 1 by default; more filters more.
///
/// # Errors
/// For pictures without colours, of two sizes, and for a strength that is not above 0.
pub fn picture(image: &Image, half: Option<&Image>, strength: f32) -> Result<Outcome, Error> {
    let default = Settings::default();
    let settings = Settings { damping: default.damping * strength, ..default };
    let guided = Guided::of(image, &GUIDES)?;
    let half = half.map(|half| Guided::of(half, &GUIDES)).transpose()?;
    let halves = Halves::of(image, &guided).filter(|_| half.is_none());
    let pair = match (&half, &halves) {
        (Some(half), _) => Some([guided.picture(), half.picture()]),
        (None, Some(halves)) => Some(halves.pictures(&guided)),
        (None, None) => None,
    };
    let (Denoised { radiance, not_finite }, error) = match &pair {
        None => (denoise(&guided.picture(), &settings)?, None),
        Some([a, b]) => {
            let (denoised, error) = denoise_halves([a, b], &settings)?;
            (denoised, Some(error))
        }
    };
    outcome(image, &guided, (radiance, not_finite, error), &GUIDES, "first-order regression")
}

/// Denoises the frames of an animation by regression, each with what those before saw
/// ([`steradian_denoise::nlm::Sequence`]).
#[derive(Clone, Debug, Default)]
pub struct Sequence(nlm::Sequence);

impl Sequence {
    /// Denoises the next frame with those of [`GUIDES`] that it has, and [`Layer::MOTION`], from its layer `raw` where
    /// it was denoised before. A frame without motion, or of another size than the one before, begins anew. Frames are
    /// to err independently: each needs a seed of its own.
    ///
    /// # Errors
    /// For pictures without colours.
    pub fn picture(&mut self, image: &Image) -> Result<Outcome, Error> {
        let guided = Guided::of(image, &GUIDES)?;
        let [width, height] = guided.radiance.size();
        let unknown = || Values::filled(width, height, Vec3::NAN);
        let motion = values(image, Layer::MOTION.prefix(), ["X", "Y", "Z"]).unwrap_or_else(unknown);
        let Denoised { radiance, not_finite } = self.0.frame(&guided.picture(), &motion)?;
        outcome(image, &guided, (radiance, not_finite, None), &GUIDES, "first-order regression, with frames before")
    }
}

/// Denoises a picture at once, for previews, by an à-trous wavelet filter ([`steradian_denoise::atrous`]), with those
/// of [`GUIDES`] that it has; one that was denoised before, from its layer `raw`.
///
/// # Errors
/// For pictures without colours.
pub fn quick(image: &Image) -> Result<Outcome, Error> {
    let guided = Guided::of(image, &GUIDES)?;
    let Denoised { radiance, not_finite } = atrous::denoise(&guided.picture(), &atrous::SETTINGS)?;
    outcome(image, &guided, (radiance, not_finite, None), &GUIDES, "an à-trous wavelet filter")
}

/// Denoises a picture by Open Image Denoise, guided by those of [`OIDN_GUIDES`] that it has; one that was denoised
/// before, from its layer `raw`.
///
/// # Errors
/// For pictures without colours, and where the library fails.
pub fn by_oidn(image: &Image, oidn: &Oidn) -> Result<Outcome, Error> {
    let mut guided = Guided::of(image, &OIDN_GUIDES)?;
    let raw = guided.radiance.clone();
    let not_finite = fill(&mut guided.radiance);
    let radiance = oidn.denoise(&guided.radiance, guided.albedo.as_ref(), guided.normal.as_ref())?;
    guided.radiance = raw;
    let [major, minor] = oidn.version();
    outcome(image, &guided, (radiance, not_finite, None), &OIDN_GUIDES, &format!("Open Image Denoise {major}.{minor}"))
}

/// Gives pixels that are not finite the mean of those around that are, and tells how many there were.
fn fill(image: &mut Values<Vec3>) -> usize {
    let [width, height] = image.size().map(|n| n as usize);
    let bad: Vec<usize> = (0..width * height).filter(|place| !image.values()[*place].is_finite()).collect();
    let filled = bad.iter().map(|place| {
        let ([x, y], mut sum, mut count) = ([place % width, place / width], Vec3::ZERO, 0.0);
        for y in y.saturating_sub(1)..(y + 2).min(height) {
            for x in x.saturating_sub(1)..(x + 2).min(width) {
                let near = image.values()[y * width + x];
                if near.is_finite() {
                    (sum, count) = (sum + near, count + 1.0);
                }
            }
        }
        sum / f32::max(count, 1.0)
    });
    let filled: Vec<Vec3> = filled.collect();
    bad.iter().zip(filled).for_each(|(place, value)| image.values_mut()[*place] = value);
    bad.len()
}

/// Result for a picture: its new radiance, the number of its pixels that were not finite, and its error, which a method
/// found by some of the layers asked for.
fn outcome(
    image: &Image,
    guided: &Guided,
    (radiance, not_finite, error): (Values<Vec3>, usize, Option<f64>),
    guides: &[Layer],
    method: &str,
) -> Result<Outcome, Error> {
    let used = guided.layers.iter().flatten().copied().collect();
    let missing = guides.iter().zip(&guided.layers).filter(|(_, found)| found.is_none());
    let missing = missing.map(|(guide, _)| *guide).collect();
    let mut picture = Image::new(image.width(), image.height());
    (picture.offset, picture.frame, picture.metadata) = (image.offset, image.frame, image.metadata.clone());
    picture.metadata.entries.retain(|(name, _)| !OF_NOISE.iter().any(|start| name.starts_with(start)));
    picture.metadata.set_text("steradian:denoised", method);
    if let Some(error) = error {
        picture.metadata.set(ERROR, Value::Float(error as f32));
    }
    let pixels: Vec<[f32; 3]> = radiance.values().iter().map(|v| v.to_array()).collect();
    picture.push_layer("", RGB, &pixels)?;
    let raw: Vec<[f32; 3]> = guided.radiance.values().iter().map(|v| v.to_array()).collect();
    picture.push_layer(RAW[0], RGB, &raw)?;
    for Channel { name, data } in image.channels() {
        // Variance is that of the noisy picture.
        let name = match name.split_once('.') {
            Some((layer, suffix)) if layer == Layer::VARIANCE.prefix() => format!("{}.{suffix}", RAW[1]),
            _ => name.clone(),
        };
        if !matches!(name.as_str(), "R" | "G" | "B" | "Y") && !name.starts_with("raw.") {
            picture.push(name, data.clone())?;
        }
    }
    Ok(Outcome { picture, used, missing, not_finite, error })
}
