//! Finished pictures at once: the edge-avoiding à-trous wavelet filter, for previews.
//!
//! Dammertz, Sewtz, Hanika and Lensch, "Edge-Avoiding À-Trous Wavelet Transform for fast Global Illumination
//! Filtering", HPG 2010, with the weights of Schied and others, "Spatiotemporal Variance-Guided Filtering", HPG 2017,
//! equations 1 to 5: the kernels of [`svgf`](crate::svgf), without a history. Colours are divided by the albedo
//! meanwhile.
//!
//! Departures: there is no number of the object, so depth, normal and luminance alone tell surfaces apart; pixels whose
//! samples all found the same light, such as those of lamps, keep their bits, as pixels without a surface do; the light
//! that the weights lost is given back.

use steradian_accel::Lanes;
use steradian_math::{Vec2, Vec3, color::space::REC709};

use crate::{
    balance::{Amount, give_back},
    error::Result,
    image::Image,
    nlm::{Denoised, Picture, calm_variance},
    svgf::{Settings, Surface, filter_spatially},
};

/// Filter settings of finished pictures. Normals and depths may differ more than in frames of a rasteriser, since they
/// are means over pixels.
pub const SETTINGS: Settings = Settings {
    alpha: 1.0,
    moments_alpha: 1.0,
    clamp_history: false,
    iterations: 4,
    sigma_depth: 4.0,
    normal_power: 16,
    sigma_luminance: 3.0,
    // A finished picture is balanced with its variance.
    keeps_mean: false,
};

/// The largest numbers that are calculated with: squares stay finite.
const MOST: f32 = 1e15;
const MOST_VARIANCE: f32 = 1e30;
/// The variance of a pixel over that of the calmest window around: of 2 to 16, 4 leaves the least error where there is
/// one sample for each pixel.
const CALMEST: f32 = 4.0;
/// A standard deviation that is this part of the radiance, or less, is that of rounding.
const ROUNDING: f32 = 1e-4;

/// Filters a picture by settings such as [`SETTINGS`]. Pixels without a surface stay as they are, and so do those that
/// have light and no variance. Uses the rayon pool it is called in; the bits of the result depend neither on the number
/// of threads nor on the instruction set.
///
/// # Errors
/// Where images have different sizes or no pixels, and where a setting is outside its range.
pub fn denoise(picture: &Picture<'_>, settings: &Settings) -> Result<Denoised> {
    settings.check()?;
    picture.check()?;
    let [width, height] = picture.radiance.size();
    let place = |x: u32, y: u32| y as usize * width as usize + x as usize;
    // Demodulate: filter irradiance, so that textures stay sharp, and multiply the albedo back at the end.
    let factors = Image::by_rows(width, height, |x, y| picture.factor(place(x, y)));
    let surfaces = Image::by_rows(width, height, |x, y| surface(picture, [x, y]));
    let colors = Image::by_rows(width, height, |x, y| {
        let radiance = picture.radiance.at(x, y);
        let held = radiance.clamp(Vec3::splat(-MOST), Vec3::splat(MOST)) / factors.at(x, y);
        if radiance.is_finite() { held } else { Vec3::NAN }
    });
    let weights = REC709.luminance_weights_f32();
    let variance = match picture.variance {
        Some(variance) => Image::by_rows(width, height, |x, y| {
            // Channels err together.
            let deviation = weights.dot(deviation(variance.at(x, y)) / factors.at(x, y));
            (deviation * deviation).min(MOST_VARIANCE)
        }),
        // Without a variance take that of the calmest window around, which an edge does not raise.
        None => {
            let held = |color: Vec3| if color.is_finite() { weights.dot(color) } else { 0.0 };
            let luminance: Vec<f32> = colors.values().iter().map(|color| held(*color)).collect();
            let variance = calm_variance(picture.size(), &luminance).into_iter().map(|v| CALMEST * v);
            Image::new(width, height, variance.collect())?
        }
    };
    // The wavelet passes, guided by depth, normal and the luminance's standard deviation.
    let filtered = filter_spatially(&surfaces, &colors, &variance, (Lanes::best(), settings));
    // Keep the bits of pixels without a surface, and of those whose samples all agree.
    let is_kept = |place: usize| {
        let radiance = picture.radiance.values()[place];
        let is_sure = picture.variance.is_some_and(|variance| is_sure(radiance, variance.values()[place]));
        radiance.is_finite() && (is_sure || !picture.has_surface(place))
    };
    let mut radiance = Image::by_rows(width, height, |x, y| match is_kept(place(x, y)) {
        true => picture.radiance.at(x, y),
        false => filtered.at(x, y) * factors.at(x, y),
    });
    // Give back the light that the weights lost, to the pixels that were filtered.
    let counts = |place: usize| picture.radiance.values()[place].is_finite() && !is_kept(place);
    let held = picture.radiance_held();
    give_back(&mut radiance, &held, picture.variance, counts, Amount::ALL);
    let not_finite = picture.radiance.values().iter().filter(|radiance| !radiance.is_finite()).count();
    Ok(Denoised { radiance, not_finite })
}

/// The standard deviations of variances; that of what is not known is 0.
fn deviation(variance: Vec3) -> Vec3 {
    let of = |v: f32| if v > 0.0 { v.min(MOST_VARIANCE).sqrt() } else { 0.0 };
    Vec3::new(of(variance.x), of(variance.y), of(variance.z))
}

/// True if all samples found the same light, and not none.
fn is_sure(radiance: Vec3, variance: Vec3) -> bool {
    // Sure is a standard deviation that rounding alone would leave.
    let (most, noise) = (radiance.max_element(), deviation(variance).max_element());
    variance.is_finite() && most > 0.0 && noise <= ROUNDING * most
}

/// Surface of a pixel, with the depth differences to its neighbouring columns and rows.
fn surface(picture: &Picture<'_>, [x, y]: [u32; 2]) -> Surface {
    let normal = picture.normal.map_or(Vec3::ZERO, |normal| normal.at(x, y).normalize_or_zero());
    let id = u32::from(picture.has_surface(y as usize * picture.size()[0] + x as usize));
    let Some(depths) = picture.depth else { return Surface { depth: 1.0, gradient: Vec2::ZERO, normal, id } };
    let depth = depths.at(x, y);
    // Gradient of depth from the neighbour on the side where it changes less, which an edge does not cross.
    let at = |x: u32, y: u32| depths.get(x, y).copied().unwrap_or(f32::NAN);
    let across = smaller(depth - at(x.wrapping_sub(1), y), at(x + 1, y) - depth);
    let down = smaller(depth - at(x, y.wrapping_sub(1)), at(x, y + 1) - depth);
    Surface { depth, gradient: Vec2::new(across, down), normal, id }
}

/// The smaller of the differences to the neighbours on both sides, of those that are finite.
fn smaller(a: f32, b: f32) -> f32 {
    match [a.is_finite(), b.is_finite()] {
        [true, true] if a.abs() <= b.abs() => a,
        [_, true] => b,
        [true, false] => a,
        [false, false] => 0.0,
    }
}
