//! The physics of light transport: pictures held against closed forms, conservation laws, and each other.
//!
//! Statistical comparisons are made at four standard errors, estimated by the film itself, with fixed seeds.
//! Comparisons without spread allow for rounding alone.

mod adaptive;
mod bidirectional;
mod bidirectional_media;
mod color;
mod determinism;
mod emitters;
mod film;
mod furnace;
mod gathering;
mod glass;
mod glow;
mod grating;
mod guiding;
mod highlights;
mod irradiance;
mod irradiance_caching;
mod lab;
mod lenses;
mod lights;
mod masks;
mod materials;
mod media;
mod metropolis;
mod motion;
mod occlusion;
mod polarization;
mod radiosity;
mod reuse;
mod scales;
mod shot;
mod shutter;
mod splitting;
mod stage;
mod textures;
mod transport;
mod varying_media;
