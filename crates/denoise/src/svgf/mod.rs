//! Spatiotemporal variance-guided filtering: terms of about one sample per pixel become pictures without noise, by what
//! frames before have seen and by what neighbours see (Schied, Kaplanyan, Wyman, Patney, Chaitanya, Burgess, Liu,
//! Dachsbacher, Lefohn and Salvi, "Spatiotemporal Variance-Guided Filtering: Real-Time Reconstruction for Path-Traced
//! Global Illumination", HPG 2017).
//!
//! A [`Denoiser`] keeps histories from frame to frame. [`Denoiser::frame`] takes the frame's terms, such as direct
//! light, indirect light and ambient occlusion, and filters each by itself:
//!
//! 1. Radiance is divided by albedo, for terms that have it.
//! 2. The history is found where motion vectors point to, if it shows the same surface, and the frame is added to it.
//! 3. The variance of luminance is taken from its first two moments over time; over the neighbourhood while the history
//!    is short.
//! 4. An à-trous wavelet filter goes over the picture several times, each time with gaps twice as wide. It stops at
//!    edges of depth, normal, object, and of luminance where these are larger than the noise.
//! 5. Albedo is put back.
//!
//! What the first passage of the filter gives is the next frame's history.
//!
//! Radiance that is not finite is left out and counted: the pixel keeps its history, or, where there is none, takes the
//! value of its neighbours; where these have none, 0. Components beyond ±10¹⁵ count as that.

mod accumulate;
mod atrous;
mod denoiser;
mod estimates;
mod geometry;
mod history;
mod reproject;
mod settings;
mod spatial;
mod surface;
mod term;
mod variance;

pub use denoiser::Denoiser;
pub use settings::Settings;
pub(crate) use spatial::filter_spatially;
pub(crate) use surface::Surface;
pub use term::{Filtered, Term};
