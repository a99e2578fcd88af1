//! The film: what samples become on their way to a picture.
//!
//! A sample's radiance is exposed and turned into linear Rec.709 ([`FilmSpec::developed`]) and added to a pixel's sums
//! ([`Pixel`]); contributions that land anywhere are splats of a pass ([`PassFilm`]). Beside the light, a film counts
//! what camera rays see first ([`FirstHitSums`], [`MatteSums`]), the light of each group of lights ([`Film`]), of bands
//! of wavelengths ([`Bands`]) and halves of samples ([`Half`]). [`develop`] makes a picture with layers of it. Sums are
//! taken in an order that does not depend on threads.
//!
//! Sums are `f64`, and the samples of a pixel are added in the order of their index. [`Pixel::add`] is the one gate for
//! NaN and infinity: such a sample counts as black and is counted.

mod bands;
mod crop;
mod film;
pub mod filter;
mod first_hit;
mod half;
mod layer_inputs;
mod layer_sums;
mod layers;
mod matte;
mod pass;
mod pixel;
mod spec;

pub use bands::{BandSample, Bands};
pub use crop::Crop;
pub use film::Film;
pub use filter::{Filter, FilterKind};
pub use first_hit::{FirstHit, FirstHitSums};
pub use half::Half;
pub use layer_inputs::LayerInputs;
pub use layer_sums::LayerSums;
pub use layers::{HALVES, Layer, Names, bounce_parts, develop};
pub use matte::{Hits, MatteSums};
pub use pass::{PassFilm, Splat};
pub use pixel::Pixel;
pub use spec::FilmSpec;
