//! Denoising of rendered pictures, guided by what is known of the surfaces in them.
//!
//! [`nlm`] filters finished pictures, as [`oidn`] does by a library of others; [`atrous`] does so at once, for
//! previews. [`svgf`] filters terms of a picture in real time, frame after frame, guided by a [`GBuffer`]. Pictures
//! and guides are [`Image`]s.
//!
//! A frame of two terms, one of which is illumination that the albedo is a factor of:
//!
//! ```
//! use steradian_denoise::{GBuffer, Image, svgf::{Denoiser, Settings, Term}};
//! use steradian_math::{Vec2, Vec3};
//!
//! # fn main() -> steradian_denoise::Result<()> {
//! let (width, height) = (64, 48);
//! // A wall of one object, 3 units away, that neither it nor the camera moves.
//! let gbuffer = GBuffer {
//!     depth: Image::filled(width, height, 3.0),
//!     depth_gradient: Image::filled(width, height, Vec2::ZERO),
//!     previous_depth: Image::filled(width, height, 3.0),
//!     normal: Image::filled(width, height, Vec3::Z),
//!     albedo: Image::filled(width, height, Vec3::new(0.8, 0.5, 0.2)),
//!     id: Image::filled(width, height, 1),
//!     motion: Image::filled(width, height, Vec2::ZERO),
//! };
//! let mut denoiser = Denoiser::new(Settings::default())?;
//! for frame in 0..4 {
//!     // One sample for each pixel: light, or shadow.
//!     let lit = |x: u32, y: u32| (x * 7 + y * 13 + frame * 5) % 16 < 8;
//!     let diffuse = Image::from_fn(width, height, |x, y| Vec3::new(0.8, 0.5, 0.2) * f32::from(lit(x, y)));
//!     let occlusion = Image::from_fn(width, height, |x, y| Vec3::splat(f32::from(!lit(x, y))));
//!     let terms = [Term { radiance: &diffuse, has_albedo: true }, Term { radiance: &occlusion, has_albedo: false }];
//!     let filtered = denoiser.frame(&terms, &gbuffer)?;
//!     assert_eq!(filtered[0].history.get(5, 5), Some(&(frame + 1)));
//! }
//! # Ok(())
//! # }
//! ```

pub mod atrous;
mod balance;
mod error;
mod falloff;
mod gbuffer;
mod image;
mod kernel;
pub mod nlm;
pub mod oidn;
mod rows;
pub mod svgf;

pub use error::{Error, Result};
pub use gbuffer::GBuffer;
pub use image::Image;
