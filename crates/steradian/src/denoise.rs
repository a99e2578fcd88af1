//! Denoising of finished pictures, guided by their layers.

use crate::{Error, Layer};
use steradian_denoise::{
    Image as Values,
    nlm::{Denoised, Picture, Settings, denoise, denoise_halves},
};
use steradian_image::{Channel, Image, Value};
use steradian_math::Vec3;

/// The layer that keeps the noisy picture, and the one that keeps its variance.
const RAW: [&str; 2] = ["raw", "raw_variance"];
/// What tells of the noise of a render, and not of a picture without it.
const OF_NOISE: [&str; 3] = ["steradian:relative_error", "steradian:unreliable", "steradian:error_scale_"];

/// The layers that guide denoising.
pub const GUIDES: [Layer; 4] = [Layer::Albedo, Layer::Normal, Layer::Depth, Layer::Variance];

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
    /// The relative error that remains, where a second picture told it.
    pub error: Option<f64>,
}

/// What of a picture is filtered, and what guides.
struct Guided {
    radiance: Values<Vec3>,
    variance: Option<Values<Vec3>>,
    albedo: Option<Values<Vec3>>,
    normal: Option<Values<Vec3>>,
    depth: Option<Values<f32>>,
}

impl Guided {
    fn of(image: &Image) -> Result<Self, Error> {
        let size = [image.width() as u32, image.height() as u32];
        let values = |name: &str, [x, y, z]: [&str; 3]| {
            let plane = |suffix| image.channel(&format!("{name}.{suffix}"));
            let (x, y, z) = (plane(x)?, plane(y)?, plane(z)?);
            let pixels = x.iter().zip(y).zip(z).map(|((x, y), z)| Vec3::new(*x, *y, *z)).collect();
            Values::new(size[0], size[1], pixels).ok()
        };
        let rgb = |name: &str| values(name, ["R", "G", "B"]);
        // One sample tells no variance; its layer is zero.
        let tells_variance = !matches!(image.metadata.get("samplesPerPixel"), Some(Value::Int(1)));
        let variance = rgb(RAW[1]).or_else(|| rgb(Layer::Variance.prefix())).filter(|_| tells_variance);
        let pixels = || Ok::<_, Error>(image.to_rgb()?.into_iter().map(Vec3::from_array).collect());
        Ok(Self {
            radiance: match rgb(RAW[0]) {
                Some(raw) => raw,
                None => Values::new(size[0], size[1], pixels()?)?,
            },
            variance,
            albedo: rgb(Layer::Albedo.prefix()),
            normal: values(Layer::Normal.prefix(), ["X", "Y", "Z"]),
            depth: image.channel(Layer::Depth.prefix()).and_then(|z| Values::new(size[0], size[1], z.to_vec()).ok()),
        })
    }

    fn has(&self, guide: Layer) -> bool {
        match guide {
            Layer::Albedo => self.albedo.is_some(),
            Layer::Normal => self.normal.is_some(),
            Layer::Depth => self.depth.is_some(),
            Layer::Variance => self.variance.is_some(),
            _ => false,
        }
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

/// Denoises a picture by non-local means ([`steradian_denoise::nlm`]), with those of [`GUIDES`] that it has; one that
/// was denoised before, from its layer `raw`. `half` is another picture of the view with as many samples and another
/// seed: the two guide each other, and the outcome is their mean. `strength` is 1 by default; more filters more.
///
/// # Errors
/// For pictures without colours, of two sizes, and for a strength that is not above 0.
pub fn picture(image: &Image, half: Option<&Image>, strength: f32) -> Result<Outcome, Error> {
    let default = Settings::default();
    let settings = Settings { damping: default.damping * strength, ..default };
    let guided = Guided::of(image)?;
    let half = half.map(Guided::of).transpose()?;
    let (Denoised { radiance, not_finite }, error) = match &half {
        None => (denoise(&guided.picture(), &settings)?, None),
        Some(half) => {
            let (denoised, error) = denoise_halves([&guided.picture(), &half.picture()], &settings)?;
            (denoised, Some(error))
        }
    };
    let (used, missing) = GUIDES.into_iter().partition(|guide| guided.has(*guide));
    let mut picture = Image::new(image.width(), image.height());
    (picture.offset, picture.frame, picture.metadata) = (image.offset, image.frame, image.metadata.clone());
    picture.metadata.entries.retain(|(name, _)| !OF_NOISE.iter().any(|start| name.starts_with(start)));
    picture.metadata.set_text("steradian:denoised", "non-local means");
    let pixels: Vec<[f32; 3]> = radiance.values().iter().map(|v| v.to_array()).collect();
    picture.push_layer("", ["R", "G", "B"], &pixels)?;
    let raw: Vec<[f32; 3]> = guided.radiance.values().iter().map(|v| v.to_array()).collect();
    picture.push_layer(RAW[0], ["R", "G", "B"], &raw)?;
    for Channel { name, data } in image.channels() {
        // Variance is that of the noisy picture.
        let name = match name.split_once('.') {
            Some((layer, suffix)) if layer == Layer::Variance.prefix() => format!("{}.{suffix}", RAW[1]),
            _ => name.clone(),
        };
        if !matches!(name.as_str(), "R" | "G" | "B" | "Y") && !name.starts_with("raw.") {
            picture.push(name, data.clone())?;
        }
    }
    Ok(Outcome { picture, used, missing, not_finite, error })
}
