//! Python bindings of Steradian: scenes are loaded, edited and rendered, pictures are arrays.
//! `python/steradian` is the package around
//! this module, `docs/python.md` its guide.
//!
//! Planes of pictures belong to NumPy from the moment a render is developed, so that looking at them copies
//! nothing. The interpreter's
//! lock is released while anything takes long.

mod batch;
mod comparison;
mod convert;
mod denoise;
mod faults;
mod frames;
mod guard;
mod image;
mod look;
mod material;
mod mesh;
mod message;
mod metadata;
mod meter;
mod mix;
mod own;
mod own_method;
mod parameter;
mod parts;
mod progress;
mod rays;
mod render;
mod resume;
mod samples;
mod scene;
mod settings;
mod shape;
mod stepping;
mod view;

use pyo3::prelude::*;

pyo3::create_exception!(steradian, SceneError, pyo3::exceptions::PyValueError, "A scene that has errors.");

/// The native part of the package `steradian`.
#[pymodule]
mod _steradian {
    #[pymodule_export]
    #[expect(non_upper_case_globals, reason = "the name of the attribute in Python")]
    const __version__: &str = env!("CARGO_PKG_VERSION");
    #[pymodule_export]
    use super::SceneError;
    #[pymodule_export]
    use super::frames::Frames;
    #[pymodule_export]
    use super::image::{Image, read_image};
    #[pymodule_export]
    use super::material::{Material, spectrum};
    #[pymodule_export]
    use super::message::Message;
    #[pymodule_export]
    use super::meter::meter;
    #[pymodule_export]
    use super::own::{own_integrator, own_material, own_texture};
    #[pymodule_export]
    use super::own_method::Wave;
    #[pymodule_export]
    use super::parameter::Parameter;
    #[pymodule_export]
    use super::parts::Parts;
    #[pymodule_export]
    use super::progress::Progress;
    #[pymodule_export]
    use super::rays::{occluded, trace};
    #[pymodule_export]
    use super::registry;
    #[pymodule_export]
    use super::samples::{sample_emitter, sample_ray};
    #[pymodule_export]
    use super::scene::Scene;
    #[pymodule_export]
    use super::settings::Settings;
    #[pymodule_export]
    use super::shape::{mesh, placement, set_mesh, set_placement};
    #[pymodule_export]
    use super::view::View;
}

/// The names of what there is, family by family, each with its description.
#[pyfunction]
fn registry() -> std::collections::BTreeMap<&'static str, std::collections::BTreeMap<&'static str, &'static str>> {
    steradian::registry().into_iter().map(|(family, models)| (family, models.into_iter().collect())).collect()
}
