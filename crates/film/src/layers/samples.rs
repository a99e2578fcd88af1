//! Layers of the samples themselves: their number, their variance, their halves.

use super::{Layer, Row, Write, held, push};
use crate::{Film, LayerInputs};
use steradian_image::Image;

/// Variance of the pixel's mean.
pub const VARIANCE: Layer = Layer(&Row {
    name: "variance",
    channels: &["variance.R", "variance.G", "variance.B"],
    doc: "estimated variance of the pixel's mean: variance.R variance.G variance.B",
    in_all: true,
    inputs: LayerInputs::NONE,
    write: Write::Pixels(|pixel| pixel.variance_of_mean().map(held)),
});

/// Number of samples.
pub const SAMPLES: Layer = Layer(&Row {
    name: "samples",
    channels: &["samples.Y"],
    doc: "samples taken: samples.Y",
    in_all: true,
    inputs: LayerInputs::NONE,
    write: Write::Pixels(|pixel| [pixel.samples as f32, 0.0, 0.0]),
});

/// The picture by each half of the samples, which err independently of each other.
pub const HALVES: Layer = Layer(&Row {
    name: "halves",
    channels: &["half_a.R", "half_a.G", "half_a.B", "half_b.R", "half_b.G", "half_b.B"],
    doc: "the picture by each half of its samples: half_a.R .G .B half_b.R .G .B; not among 'all'",
    in_all: false,
    inputs: LayerInputs::HALVES,
    write: Write::Film(|film, _, image| halves(film, image)),
});

/// Adds both halves of the samples, where every pixel has both.
fn halves(film: &Film, image: &mut Image) {
    let means: Option<Vec<_>> = film.halves.iter().zip(&film.pixels).map(|(half, p)| half.means(p)).collect();
    let Some(means) = means.filter(|means| !means.is_empty()) else { return };
    for (k, name) in HALVES.channels().iter().enumerate() {
        push(image, name, means.iter().map(|m| held(m[k / 3][k % 3])).collect());
    }
}
