//! Light that enters a surface and leaves it elsewhere. What happens at the two points is a model of scattering each:
//! [`Entry`], where light is reflected or goes below, and [`Emergence`], where it comes out again by
//!
//! ```text
//! S(x_o, ω_o, x_i, ω_i) = (1 − F(ω_o)) S_p(x_o, x_i) (1 − F(ω_i))/(c π),   c = 1 − 2 ∫ F(μ) μ dμ
//! ```
//!
//! (PBR 3rd ed., 11.4). `S_p` is a diffusion [`Profile`] of the distance between the two, or what walks at random below
//! the surface bring. Who follows paths finds the second point.

mod dipole;
mod emergence;
mod entry;
mod inversion;
mod normalized_diffusion;
mod part;
mod photon_beam;
mod profile;

pub use dipole::dipole;
pub use emergence::Emergence;
pub use entry::Entry;
pub use inversion::{WalkAlbedo, deep_albedo, deep_single_scattering};
pub use normalized_diffusion::normalized_diffusion;
pub use part::SubsurfacePart;
pub use photon_beam::photon_beam_diffusion;
pub use profile::{Profile, ProfileTable};
