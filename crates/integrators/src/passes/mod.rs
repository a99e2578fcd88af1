//! Methods by passes ([`steradian_engine::Pass`]): those that start at lights, or whose paths land on other pixels than
//! their own.
//!
//! Contributions are added in the order of pieces of work (`Run::in_order`), so that splats need no atomics and bits do
//! not depend on threads. The spread between passes gives the variance of pixels.
//!
//! `subpath` traces subpaths from the camera or from lights, `vertex` scatters at their vertices, on a `surface` or in a
//! medium, and `passage` is the way between two of them. `pair` connects subpaths for the methods of `bidirectional`:
//! `light`, `bdpt` and `vcm`; `mlt` (`pssmlt`, `mmlt`) drives the same code with Markov chains; `sppm` and
//! `photon_map` gather photons. `missed` estimates the caustics that no path from the camera finds. The emission of
//! lights is in `steradian_core::light::emission`, the importance of cameras in `steradian_core::camera::importance`.

mod bidirectional;
mod missed;
mod mlt;
mod pair;
mod passage;
mod photon_map;
mod photons;
mod radius;
mod sppm;
mod subpath;
mod surface;
mod vertex;

pub use bidirectional::{BDPT, Bidirectional, LIGHT, Strategy, VCM};
pub use missed::missed_caustics;
pub use mlt::{MMLT, PSSMLT};
pub use photon_map::{PHOTON, PhotonMap};
pub use radius::Radius;
pub use sppm::{SPPM, Sppm};

use steradian_engine::Run;
use steradian_math::spectra::Wavelengths;

/// The wavelengths and the moment that all paths of a pass share.
fn pass_wavelengths(run: &Run<'_>, number: u32) -> Wavelengths {
    run.wavelengths(&run.sampler.pixel(u32::MAX, u32::MAX, number))
}
