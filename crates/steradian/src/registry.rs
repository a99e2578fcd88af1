//! Models and methods of a program's own.

use crate::{
    CompileOptions, Error, MethodRequest, Quality, Request, Scene,
    auto::AUTO,
    develop,
    load::{LoadedScene, load},
    method::Render,
};
use std::{path::Path, sync::Arc};
use steradian_compile::{Registry as Models, RegistryError, Values};
use steradian_engine::{Control, MethodKind};
use steradian_image::Image;
use steradian_scene::Diagnostics;
use steradian_schema::{Kinds, Model};

/// Models and methods of a program's own, which scene files name as they name those of Steradian, and for whose
/// parameters the same rules hold. A model is described by a row of the schema ([`Model`]): kind, parameters with type,
/// range, default and meaning.
///
/// Rust programs hand it to [`Registry::open`]; see the example `own_models`.
#[derive(Clone, Debug, Default)]
pub struct Registry {
    models: Models,
    methods: Vec<MethodKind>,
}

macro_rules! forwarded {
    ($($(#[$doc:meta])* $name:ident: $type:path;)*) => {
        $($(#[$doc])*
        ///
        /// # Errors
        /// [`RegistryError`] where the kind is there already, or the model has parameters that it cannot have.
        pub fn $name<T: $type + 'static>(
            self,
            model: &'static Model,
            make: impl Fn(&Values) -> Result<T, String> + Send + Sync + 'static,
        ) -> Result<Self, RegistryError> {
            Ok(Self { models: self.models.$name(model, make)?, ..self })
        })*
    };
}

impl Registry {
    /// Nothing of one's own.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a material ([`Models::material`]).
    ///
    /// # Errors
    /// [`RegistryError`] where the kind is there already, or the model has parameters that it cannot have.
    pub fn material(
        self,
        model: &'static Model,
        scatter: impl steradian_bsdf::OwnScatter + 'static,
    ) -> Result<Self, RegistryError> {
        Ok(Self { models: self.models.material(model, scatter)?, ..self })
    }

    forwarded! {
        /// Adds a texture ([`Models::texture`]).
        texture: steradian_texture::OwnTexture;
        /// Adds a shape ([`Models::shape`]).
        shape: steradian_core::shape::OwnShape;
        /// Adds a light at a point ([`Models::light`]).
        light: steradian_core::light::OwnLight;
        /// Adds a medium ([`Models::medium`]).
        medium: steradian_core::medium::OwnMedium;
        /// Adds a camera ([`Models::camera`]).
        camera: steradian_core::camera::OwnCamera;
    }

    /// Adds a method of rendering with its row of the schema, whose kind is the method's name.
    ///
    /// # Errors
    /// [`RegistryError`] where there is an integrator of this kind.
    pub fn method(mut self, model: &'static Model, mut method: MethodKind) -> Result<Self, RegistryError> {
        method.name = model.kind;
        self.methods.push(method);
        Ok(Self { models: self.models.integrator(model)?, ..self })
    }

    /// All kinds of scenes.
    pub fn kinds(&self) -> &Kinds {
        self.models.kinds()
    }

    /// Options for readers of files that know the kinds.
    pub fn reading(&self) -> steradian_formats::Options {
        steradian_formats::Options { kinds: self.kinds().clone(), ..Default::default() }
    }

    /// Options for compiling that have the models.
    pub fn compiling(&self) -> CompileOptions {
        CompileOptions { registry: self.models.clone(), ..CompileOptions::default() }
    }

    /// Reads and compiles a scene, as [`crate::open`] does, in which models may be of one's own.
    ///
    /// # Errors
    /// [`Error::Scene`] with all messages, where it has errors.
    pub fn open(&self, name: impl AsRef<Path>) -> Result<(Arc<Scene>, Diagnostics), Error> {
        let LoadedScene { scene, diagnostics, .. } = load(name, &self.reading()).compile(&self.compiling());
        match scene {
            Some(scene) => Ok((Arc::new(scene), diagnostics)),
            None => Err(Error::Scene(diagnostics)),
        }
    }

    /// The typed request of a quality, whose integrator may be of one's own.
    ///
    /// # Errors
    /// As [`Quality::request`].
    pub fn request(&self, quality: &Quality) -> Result<Request, Error> {
        let named = quality.integrator.as_deref().filter(|text| *text != AUTO);
        let method = named.map(|text| MethodRequest::parse_of(self.kinds(), text)).transpose()?;
        match method.filter(|method| self.methods.iter().any(|own| own.name == method.name())) {
            Some(method) => {
                let request = Quality { integrator: None, ..quality.clone() }.request()?;
                Ok(Request { method: Some(method), ..request })
            }
            None => quality.request(),
        }
    }

    /// The method and plan of a quality for a scene, by a method of one's own where the quality or the scene names one.
    ///
    /// # Errors
    /// As [`Quality::render`].
    pub fn plan(&self, scene: &Scene, quality: &Quality) -> Result<Render, Error> {
        match quality.integrator.as_deref() {
            Some(AUTO) => quality.render(scene),
            _ => Render::of(&self.methods, &self.request(quality)?, scene),
        }
    }

    /// Renders a scene to the end and develops it, as [`crate::render`] does.
    ///
    /// # Errors
    /// As [`crate::render`].
    pub fn render(&self, scene: &Arc<Scene>, quality: &Quality) -> Result<Image, Error> {
        let mut session = self.plan(scene, quality)?.session(scene)?;
        session.step(u32::MAX, &Control::default());
        match session.failure() {
            Some(why) => Err(Error::Failed(why)),
            None => Ok(develop(scene, &session.film(), &quality.layers)),
        }
    }
}
