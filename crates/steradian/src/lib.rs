//! Steradian: load a scene, compile it, render it, save the picture.
//!
//! ```
//! use steradian::{Quality, render};
//!
//! // A file, or a built-in scene; `Err` has all that is wrong with it, with files, lines and columns.
//! let (scene, messages) = steradian::open("builtin:cornell-box")?;
//! assert!(messages.is_empty());
//! let quality = Quality { spp: Some(1), ..Quality::default() };
//! let picture = render(&scene, &quality)?;
//! assert_eq!((picture.width(), picture.height()), (scene.film().width as usize, scene.film().height as usize));
//! # Ok::<(), steradian::Error>(())
//! ```

pub mod archive;
pub mod auto;
pub mod bake;
pub mod bench;
pub mod compare;
pub mod cornell;
pub mod denoise;
pub mod develop;
mod error;
mod hashing;
pub mod inputs;
pub mod lightmap;
pub mod load;
pub mod merge;
mod method;
mod missed;
mod oidn_library;
pub mod plugin;
pub mod prelude;
pub mod quality;
pub mod radiosity;
pub mod raster;
mod registry;
pub mod resume;
mod single;
pub mod specimen;
pub mod support;
pub mod unwrap;
pub mod verify;
mod viewpoint;

pub use develop::develop;
pub use error::Error;
pub use inputs::Inputs;
pub use load::{Loaded, LoadedScene, load, load_bytes, open};
pub use method::{LeftOut, Render, film_bytes_per_pixel, method_of, methods, suited_mode};
pub use missed::missing_light;
pub use quality::Quality;
pub use registry::Registry;
pub use single::{SinglePath, trace_path};
pub use steradian_accel as accel;
pub use steradian_accel::Accelerator;
pub use steradian_bsdf as bsdf;
pub use steradian_compile::{
    Compiled, Kept, Options as CompileOptions, RegistryError, SensorNoise, Values, compile, recompile,
};
pub use steradian_core as core;
pub use steradian_core::film::Pixel;
pub use steradian_core::{ColorMode, Scene};
pub use steradian_engine as engine;
pub use steradian_film as film;
pub use steradian_film::Layer;
pub use steradian_formats as formats;
pub use steradian_image as image;
pub use steradian_instruments as instruments;
pub use steradian_integrators as integrators;
pub use steradian_integrators::{Control, Film, History, Plan, Session, meter};
pub use steradian_math as math;
pub use steradian_request as request;
pub use steradian_request::{MethodRequest, Request};
pub use steradian_scene as scene;
pub use steradian_schema as schema;
pub use steradian_texture as texture;
pub use steradian_transport as transport;
pub use viewpoint::Viewpoint;

use std::sync::Arc;
use steradian_scene::Family;

/// Everything that has a name, family by family: plural name of the family, and name and description of each model and
/// of what several models share.
pub fn registry() -> Vec<(&'static str, Vec<(&'static str, &'static str)>)> {
    let of = |family: Family| {
        let models = family.models().iter().map(|m| (m.kind, m.doc));
        (family.plural(), models.chain(family.groups().into_iter().map(|g| (g.name, g.doc))).collect())
    };
    vec![
        of(Family::Integrator),
        of(Family::Material),
        of(Family::Texture),
        of(Family::Light),
        of(Family::Shape),
        of(Family::Camera),
        of(Family::Medium),
        of(Family::Phase),
        of(Family::Film),
        of(Family::Filter),
        of(Family::Sampler),
        ("accelerators", Accelerator::ALL.iter().map(|a| a.about()).collect()),
        (
            "sensors",
            std::iter::once(("cie1931", "the CIE 1931 observer")).chain(math::spectra::Response::cameras()).collect(),
        ),
        ("tones", steradian_image::tone::CURVES.iter().map(|c| (c.name, c.doc)).collect()),
        ("layers", Layer::ALL.iter().map(|l| (l.name(), l.doc())).collect()),
    ]
}

/// Renders a scene to the end and develops it, without watching. For progress, stopping and saving on the way use
/// [`Session`].
///
/// # Errors
/// [`Error::Request`] when the quality names an integrator or option that does not exist.
pub fn render(scene: &Arc<Scene>, quality: &Quality) -> Result<image::Image, Error> {
    Registry::default().render(scene, quality)
}
