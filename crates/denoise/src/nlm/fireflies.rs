//! Pixels far brighter than all around, held back: few paths found what they saw.
//!
//! They would shine through the weights, or stay as points. What they lose is given back to the picture in the end
//! ([`balance`](crate::balance)).

use steradian_accel::Lanes;
use steradian_math::color::space::REC709;

use super::{
    features::Features,
    local::{around, map},
    plane::Plane,
};

/// Distance up to which pixels are compared.
const REACH: i64 = 5;
/// By how many standard deviations of those around a pixel may be brighter.
const DEVIATIONS: f32 = 1.5;
/// Pixels around that are needed to tell.
const FEWEST: f32 = 4.0;
/// The least quotient of a pixel's own standard deviation and what is beyond the mean, for it to be noise.
const NOISE: f32 = 0.3;

/// Holds values and variances of three channels of pixels to what those around have that show the same surface.
pub(super) fn hold(
    channels: &mut [(Vec<f32>, Vec<f32>); 3],
    size: [usize; 2],
    features: &Features,
    is_known: impl Fn(usize) -> bool + Sync,
    lanes: Lanes,
) {
    let weights = REC709.luminance_weights_f32();
    let luminance = |of: [f32; 3]| weights.x * of[0] + weights.y * of[1] + weights.z * of[2];
    let value: Vec<f32> =
        (0..channels[0].0.len()).map(|place| luminance(channels.each_ref().map(|c| c.0[place]))).collect();
    let plane = |of: &(dyn Fn(usize) -> f32 + Sync)| {
        Plane::new(size, |place| if is_known(place) { of(place) } else { 0.0 }).with_edge(0.0)
    };
    let planes = [plane(&|_| 1.0), plane(&|place| value[place]), plane(&|place| value[place] * value[place])];
    // The rim of a lamp is uncertain, but beside what is sure to be as bright.
    let is_sure: Vec<bool> = map(size, |x, y| {
        let place = y * size[0] + x;
        luminance(channels.each_ref().map(|c| c.1[place].sqrt())) < NOISE * value[place]
    });
    let has_bright_neighbour = |place: usize| {
        around(size, [place % size[0], place / size[0]], 1).any(|at| is_sure[at] && value[at] >= value[place])
    };
    // Without the pixel itself.
    let sums = features.sums((REACH, 0.0), (planes.each_ref(), []), lanes);
    for (place, sums) in sums.iter().enumerate() {
        let [count, sum, squares] = sums.values;
        if count.is_nan() || count <= FEWEST {
            continue;
        }
        let mean = sum / count;
        let most = mean + DEVIATIONS * (squares / count - mean * mean).max(0.0).sqrt();
        let own = luminance(channels.each_ref().map(|c| c.1[place].sqrt()));
        let is_noise = own > NOISE * (value[place] - mean) && !has_bright_neighbour(place);
        if value[place] > most && most >= 0.0 && is_noise {
            let part = most / value[place];
            for (value, variance) in &mut *channels {
                value[place] *= part;
                variance[place] *= part * part;
            }
        }
    }
}
