//! Frames of an animation, one after the other.
//!
//! What frames before saw is carried along by the motion of surfaces, from pixel to pixel, so that noise stays
//! independent, and averaged with what the new frame sees: an accumulated picture with a variance of its own, which is
//! filtered in place of the frame's own (Rousselle, Knaus, Zwicker, "Adaptive Rendering with Non-Local Means
//! Filtering", SIGGRAPH Asia 2012, has a window of neighbouring frames instead). How much of the past counts is told by
//! patches, as in the filter: those of the frame, filtered alone, against those of the filtered frame before.

use steradian_accel::Lanes;
use steradian_math::{Vec2, Vec3};

use super::{
    Denoised,
    estimate::Estimate,
    features::Features,
    filter_by,
    local::{around, map},
    picture::Picture,
    pilot,
    settings::Settings,
};
use crate::{error::Result, falloff::falloff, gbuffer::check_size, image::Image};

/// Patches that tell how much of the past counts reach so many pixels from their middle: light that changes slowly
/// shows in large ones.
const PATCH: i64 = 4;
/// By how many more standard deviations than patches of one frame those of two may differ, and which distance of
/// patches is none.
const PATIENCE: f32 = 1.5;
const IGNORED: f32 = 0.5;
/// Frames that what is remembered counts for at most.
const MOST_FRAMES: f32 = 16.0;
/// By how much depth may differ, as a part of itself, beyond what the slope of the surface explains.
const DEPTH: f32 = 0.02;
/// By how much normals and albedo may differ.
const NORMAL: f32 = 0.4;
const ALBEDO: f32 = 0.2;

/// Filters frames of an animation, each with what those before saw. The first one is filtered as a picture is.
#[derive(Clone, Debug, Default)]
pub struct Sequence {
    settings: Settings,
    before: Option<Memory>,
}

/// Memory of a frame for the next.
#[derive(Clone, Debug)]
struct Memory {
    /// Averaged frames, noisy and filtered; over albedo. Pixels count by the frames that they are the mean of.
    noisy: Estimate,
    filtered: Estimate,
    /// Mean offset of a pixel's samples from its middle.
    offsets: Vec<Vec2>,
    guides: Guides,
}

/// Features that distinguish surfaces.
#[derive(Clone, Debug)]
struct Guides {
    surface: Vec<bool>,
    albedo: Option<Image<Vec3>>,
    normal: Option<Image<Vec3>>,
    depth: Option<Image<f32>>,
}

/// Pixel of the memory that matches a pixel of the frame.
#[derive(Clone, Copy, Debug, Default)]
struct Found {
    place: usize,
    offset: Vec2,
}

impl Sequence {
    /// Before the first frame.
    ///
    /// # Errors
    /// Where a setting is outside its range.
    pub fn new(settings: Settings) -> Result<Self> {
        settings.check()?;
        Ok(Self { settings, before: None })
    }

    /// Filters the next frame. `motion` is by how many pixels what a pixel sees has moved since the frame before, to
    /// the right and down, and by how much away along the camera's axis; what is not finite finds nothing. A frame of
    /// another size than the one before begins anew.
    ///
    /// # Errors
    /// Where images have different sizes or no pixels.
    pub fn frame(&mut self, picture: &Picture<'_>, motion: &Image<Vec3>) -> Result<Denoised> {
        picture.check()?;
        check_size("motion", motion.size(), picture.radiance.size())?;
        let settings = &self.settings;
        let features = Features::new(picture, settings);
        let frame = picture.noisy(&features, Lanes::best());
        let guides = Guides::of(picture);
        // A frame of another size has no past.
        let before = self.before.take().filter(|before| before.noisy.size() == picture.size());
        let (noisy, offsets) = match before {
            None => (frame, vec![Vec2::ZERO; motion.values().len()]),
            Some(before) => {
                // Filter the frame alone, to compare it with the filtered past.
                let alone = pilot(&frame, &features, settings, Lanes::best());
                let found = before.find(&guides, motion);
                let trust = trust(&alone, &before.filtered, &found, settings);
                before.join(&frame, &found, &trust)
            }
        };
        // Filter the accumulated frames, and keep both for the next frame.
        let filtered = filter_by(&[&noisy, &noisy], &features, settings);
        let denoised = picture.finish(&filtered, settings.keeps_mean);
        let filtered = filtered.with_noise_of(&noisy, settings.pilot);
        self.before = Some(Memory { noisy, filtered, offsets, guides });
        Ok(denoised)
    }
}

impl Guides {
    fn of(picture: &Picture<'_>) -> Self {
        let pixels = picture.radiance.values().len();
        Self {
            surface: (0..pixels).map(|place| picture.has_surface(place)).collect(),
            albedo: picture.albedo.cloned(),
            normal: picture.normal.cloned(),
            depth: picture.depth.cloned(),
        }
    }

    /// True if a pixel can see the surface that a pixel of the frame before saw, at a depth that has changed by
    /// `deeper`, where the slope of the surface explains a difference.
    fn fits(&self, place: usize, before: &Self, at: usize, deeper: f32, slope: f32) -> bool {
        // Guides must agree within tolerances; a guide that is missing agrees.
        let near = |a: &Option<Image<Vec3>>, b: &Option<Image<Vec3>>, most: f32| match (a, b) {
            (Some(a), Some(b)) => (a.values()[place] - b.values()[at]).length() <= most,
            _ => true,
        };
        let is_as_deep = match (&self.depth, &before.depth) {
            (Some(now), Some(then)) => {
                // Depth that the motion along the axis explains.
                let expected = now.values()[place] - deeper;
                (then.values()[at] - expected).abs() <= DEPTH * expected.abs() + slope
            }
            _ => true,
        };
        self.surface[place]
            && before.surface[at]
            && is_as_deep
            && near(&self.normal, &before.normal, NORMAL)
            && near(&self.albedo, &before.albedo, ALBEDO)
    }

    /// By how much depth differs from pixel to pixel on the side of a pixel where it differs less, down and across.
    fn slope(&self, place: usize) -> f32 {
        let Some(depth) = &self.depth else { return 0.0 };
        let (width, values) = (depth.width() as usize, depth.values());
        // The lesser of the differences to both neighbours along an axis.
        let along = |before: Option<usize>, after: usize, has_after: bool| {
            let by = |other: usize| (values[other] - values[place]).abs();
            let [before, after] = [before.map(by), has_after.then(|| by(after))];
            let least = before.unwrap_or(f32::INFINITY).min(after.unwrap_or(f32::INFINITY));
            if least.is_finite() { least } else { 0.0 }
        };
        let column = place % width;
        along((column > 0).then(|| place - 1), place + 1, column + 1 < width)
            + along(place.checked_sub(width), place + width, place + width < values.len())
    }
}

impl Memory {
    /// Matches the pixels of a frame to the memory: of the pixels nearest to the former position, the one whose mean
    /// position is nearest to that.
    fn find(&self, guides: &Guides, motion: &Image<Vec3>) -> Vec<Option<Found>> {
        let size = self.noisy.size();
        map(size, |x, y| {
            let place = y * size[0] + x;
            let moved = motion.values()[place];
            // Backward reprojection of the pixel's middle.
            let was = Vec2::new(x as f32 + 0.5, y as f32 + 0.5) - moved.truncate();
            let is_inside = was.cmpge(Vec2::ZERO).all() && was.x < size[0] as f32 && was.y < size[1] as f32;
            if !is_inside || !moved.z.is_finite() {
                return None;
            }
            let slope = 2.0 * guides.slope(place);
            let middle = |at: usize| Vec2::new((at % size[0]) as f32 + 0.5, (at / size[0]) as f32 + 0.5);
            // Of the 3×3 pixels there, those of the same surface; the one whose samples lie nearest.
            around(size, [was.x as usize, was.y as usize], 1)
                .filter(|at| self.noisy.count(*at) > 0.0 && guides.fits(place, &self.guides, *at, moved.z, slope))
                .map(|at| Found { place: at, offset: middle(at) + self.offsets[at] - was })
                .min_by(|a, b| a.offset.length_squared().total_cmp(&b.offset.length_squared()))
        })
    }

    /// Joins a frame with the memory, as far as that is trusted: values and variances, and mean offsets from the
    /// middles of pixels.
    fn join(&self, frame: &Estimate, found: &[Option<Found>], trust: &[f32]) -> (Estimate, Vec<Vec2>) {
        let size = frame.size();
        // Frames that the past counts for: trust times its length, up to a limit.
        let of = |place: usize| found[place].map(|f| (f, (trust[place] * self.noisy.count(f.place)).min(MOST_FRAMES)));
        let channels = [0, 1, 2].map(|c| {
            let joined = |place: usize| {
                let (own, noise) = frame.channel(c, place);
                let Some((Found { place: at, .. }, past)) = of(place).filter(|(_, past)| *past > 0.0) else {
                    return (own, noise);
                };
                let (other, other_noise) = self.noisy.channel(c, at);
                // Means by their counts of frames, and the variance of the weighted mean of independent values.
                let part = frame.count(place) / (frame.count(place) + past);
                let rest = 1.0 - part;
                (part * own + rest * other, part * part * noise + rest * rest * other_noise)
            };
            let value = map(size, |x, y| joined(y * size[0] + x).0);
            let variance = map(size, |x, y| joined(y * size[0] + x).1);
            (value, variance)
        });
        let all = map(size, |x, y| {
            let place = y * size[0] + x;
            frame.count(place) + of(place).map_or(0.0, |(_, past)| past)
        });
        // The mean position of samples drifts from the middle by the part that came from elsewhere.
        let offset = |(place, count): (usize, &f32)| match of(place) {
            Some((found, past)) if past > 0.0 => found.offset * (past / count),
            _ => Vec2::ZERO,
        };
        let offsets = all.iter().enumerate().map(offset).collect();
        (Estimate::new(size, channels, all), offsets)
    }
}

/// Trust in the memory, from 0 to 1: by the distance of patches, as in the filter. Pixels without a match do not count.
fn trust(frame: &Estimate, before: &Estimate, found: &[Option<Found>], settings: &Settings) -> Vec<f32> {
    let size = frame.size();
    let square = (PATIENCE * settings.damping).powi(2);
    let distances = map(size, |x, y| {
        let place = y * size[0] + x;
        let Some(found) = found[place] else { return f32::NAN };
        let of = |c: usize| {
            // The distance of non-local means between now and then.
            let ((p, vp), (q, vq)) = (frame.channel(c, place), before.channel(c, found.place));
            ((p - q) * (p - q) - (vp + vq)) / (1e-20 + square * (vp + vq))
        };
        (of(0) + of(1) + of(2)) * (1.0 / 3.0)
    });
    map(size, |x, y| {
        if found[y * size[0] + x].is_none() {
            return 0.0;
        }
        // Average distances over a large patch; trust falls off as weights do.
        let (mut sum, mut count) = (0.0, 0.0);
        for distance in around(size, [x, y], PATCH).map(|place| distances[place]) {
            if !distance.is_nan() {
                (sum, count) = (sum + distance, count + 1.0);
            }
        }
        falloff((sum / count - IGNORED).max(0.0))
    })
}
