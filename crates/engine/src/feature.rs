//! Features of scenes and requests that not every method renders, and the answers of methods to them.

use steradian_bsdf::TransportMode;
use steradian_core::{Scene, camera::Projection, light::Light};
use steradian_math::Vec2;

/// A feature of a scene or of a request that not every method renders.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Feature {
    /// Participating media.
    Media,
    /// Media that emit light.
    GlowingMedia,
    /// Light transport below surfaces.
    Subsurface,
    /// Materials that shift the wavelength of light.
    Fluorescence,
    /// Polarisers and retarders.
    Polarization,
    /// Lights that are switched on and off.
    Schedules,
    /// Emitters that light sampling does not reach, such as infinite planes.
    UnsampledEmitters,
    /// Ambient lights.
    AmbientLight,
    /// Light from infinity on infinite planes.
    InfinitePlanes,
    /// Curves, whose surface faces the ray.
    Curves,
    /// Normal and bump maps.
    SurfaceDetail,
    /// Surfaces with specular scattering alone in the view.
    SpecularView,
    /// Objects or a camera in motion while the shutter is open.
    Motion,
    /// A camera in motion while the shutter is open.
    MovingCamera,
    /// A camera with a lens of several elements.
    RealisticLens,
    /// A camera without an inverse: light paths are not connected to it.
    UnconnectedCamera,
    /// Surfaces that are seen by their shadows alone.
    ShadowCatchers,
    /// A picture without its background.
    Transparency,
    /// A picture without its background, of a scene with participating media.
    TransparencyBehindMedia,
    /// A choice of point sets.
    Samplers,
    /// More samples where the error is larger.
    Adaptivity,
    /// A layer for each group of lights.
    LightGroups,
    /// A layer for each number of scattering events.
    Bounces,
    /// Bands of wavelengths beside the colour of the film.
    Bands,
    /// Noise that a denoiser can tell from the picture: errors of pixels are independent. Halves of the samples, too.
    Denoising,
}

/// A method's answer to a feature. The texts say how or why, after a colon; they may be empty.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Support {
    /// The expectation of the picture has the feature.
    Exact,
    /// The feature is rendered otherwise than it is.
    Approximates(&'static str),
    /// The feature is missing from the picture.
    LeavesOut(&'static str),
    /// The method renders no picture of scenes with the feature.
    Refuses(&'static str),
}

impl Support {
    /// The text of an answer other than [`Self::Exact`].
    pub(crate) fn reason(self) -> &'static str {
        match self {
            Self::Exact => "",
            Self::Approximates(how) => how,
            Self::LeavesOut(why) | Self::Refuses(why) => why,
        }
    }
}

impl Feature {
    /// Features of scenes, in the order in which limits are told.
    pub(crate) const OF_SCENES: [Self; 18] = [
        Self::MovingCamera,
        Self::Media,
        Self::Subsurface,
        Self::Fluorescence,
        Self::Polarization,
        Self::Schedules,
        Self::GlowingMedia,
        Self::RealisticLens,
        Self::UnconnectedCamera,
        Self::Curves,
        Self::AmbientLight,
        Self::InfinitePlanes,
        Self::Motion,
        Self::SpecularView,
        Self::SurfaceDetail,
        Self::UnsampledEmitters,
        Self::Bands,
        Self::ShadowCatchers,
    ];

    /// All features: those of scenes, then those of requests.
    pub const ALL: [Self; 25] = [
        Self::Media,
        Self::GlowingMedia,
        Self::Subsurface,
        Self::Fluorescence,
        Self::Polarization,
        Self::Schedules,
        Self::UnsampledEmitters,
        Self::AmbientLight,
        Self::InfinitePlanes,
        Self::Curves,
        Self::SurfaceDetail,
        Self::SpecularView,
        Self::Motion,
        Self::MovingCamera,
        Self::RealisticLens,
        Self::UnconnectedCamera,
        Self::Bands,
        Self::ShadowCatchers,
        Self::Transparency,
        Self::TransparencyBehindMedia,
        Self::Samplers,
        Self::Adaptivity,
        Self::LightGroups,
        Self::Bounces,
        Self::Denoising,
    ];

    /// The feature in a phrase.
    pub fn name(self) -> &'static str {
        match self {
            Self::Media => "participating media",
            Self::GlowingMedia => "media that glow",
            Self::Subsurface => "light that goes below surfaces",
            Self::Fluorescence => "light that changes its wavelength (material 'fluorescent')",
            Self::Polarization => "polarisation (materials 'polarizer' and 'retarder')",
            Self::Schedules => "lights that go on and off (parameters 'on' and 'off')",
            Self::UnsampledEmitters => "light of shapes of which no point can be drawn, such as an infinite plane",
            Self::AmbientLight => "lights 'ambient'",
            Self::InfinitePlanes => "light from infinity on infinite planes",
            Self::Curves => "curves",
            Self::SurfaceDetail => "normal and bump maps",
            Self::SpecularView => "what smooth surfaces show",
            Self::Motion => "motion",
            Self::MovingCamera => "a camera that moves",
            Self::RealisticLens => "a camera with a lens of several elements (realistic)",
            Self::UnconnectedCamera => {
                "a camera whose view has no inverse: spherical with a lens, or of a program's own"
            }
            Self::ShadowCatchers => "shadow catchers",
            Self::Transparency => "a transparent background",
            Self::TransparencyBehindMedia => "a transparent background behind media",
            Self::Samplers => "a choice of samplers",
            Self::Adaptivity => "more samples where the error is larger (--adaptive)",
            Self::LightGroups => "layers of groups of lights",
            Self::Bounces => "layers of bounces",
            Self::Bands => "bands of wavelengths (film 'spectral')",
            Self::Denoising => "denoising, and the layer 'halves'",
        }
    }

    /// The feature as a scene has it; `None` where it has none, and for features of requests.
    pub fn found(self, scene: &Scene) -> Option<String> {
        let is_there = match self {
            // Some are told by name or number.
            Self::Subsurface => return scene.below_surfaces().map(Into::into),
            Self::UnsampledEmitters => {
                return match scene.unsampled_emitters() {
                    0 => None,
                    1 => {
                        Some("the light of one shape of which no point can be drawn, such as an infinite plane".into())
                    }
                    n => Some(format!(
                        "the light of {n} shapes of which no point can be drawn, such as an infinite plane"
                    )),
                };
            }
            Self::SpecularView => {
                return specular_material(scene).map(|name| format!("{}, such as '{name}'", self.name()));
            }
            Self::Media => scene.has_media(),
            Self::AmbientLight => !scene.lights().ambient.is_empty(),
            Self::GlowingMedia => scene.media().iter().any(|m| m.glow.is_some()),
            Self::Fluorescence => scene.is_fluorescent(),
            Self::Polarization => scene.polarizes(),
            Self::Schedules => scene.has_schedules(),
            Self::InfinitePlanes => {
                let is_infinite = |l: &Light| matches!(l, Light::Distant(..) | Light::Environment(_));
                !scene.planes().is_empty() && scene.lights().lights.iter().any(is_infinite)
            }
            Self::Curves => scene.has_curves(),
            Self::SurfaceDetail => scene.has_surface_detail(),
            Self::Motion => scene.moves(),
            Self::MovingCamera => scene.camera().motion.is_some(),
            Self::RealisticLens => matches!(scene.camera().projection, Projection::Realistic(_)),
            Self::UnconnectedCamera => !scene.camera().can_receive(),
            Self::Bands => scene.film().bands.is_some(),
            Self::ShadowCatchers => scene.has_shadow_catchers(),
            Self::Transparency
            | Self::TransparencyBehindMedia
            | Self::Samplers
            | Self::Adaptivity
            | Self::LightGroups
            | Self::Bounces
            | Self::Denoising => false,
        };
        is_there.then(|| self.name().to_owned())
    }
}

/// Interfaces between media that [`specular_material`] looks past along a ray.
const MOST_INTERFACES: u32 = 64;

/// The material of a surface that the camera sees and that reflects or refracts in one direction, by a grid of rays.
pub fn specular_material(scene: &Scene) -> Option<String> {
    const EDGE: u32 = 48;
    let size = Vec2::new(scene.film().width as f32, scene.film().height as f32);
    (0..EDGE * EDGE).find_map(|k| {
        let place = Vec2::new((k % EDGE) as f32 + 0.5, (k / EDGE) as f32 + 0.5) / EDGE as f32;
        let mut ray = scene.camera().ray(scene.film(), place * size, Vec2::splat(0.5));
        let mut lambda = scene.mode().wavelengths(|| 0.5);
        // The first surface that scatters, past interfaces between media.
        let (i, (s, frame)) = (0..MOST_INTERFACES).find_map(|_| {
            let Some(hit) = scene.intersect(&ray) else { return Some(None) };
            let i = scene.interaction(&ray, &hit);
            ray = i.rest(&ray);
            scene.scattering(&i, 0.5, &mut lambda).map(|s| Some((i, s)))
        })??;
        let wo = frame.to_local(i.wo);
        let lobe = |u| s.bsdf.sample(wo, u, Vec2::splat(0.4), TransportMode::Radiance);
        let is_specular = [0.0, 0.25, 0.5, 0.75, 0.999].into_iter().filter_map(lobe).any(|s| s.lobe.is_specular());
        let name = || scene.material_names().get(scene.geometries()[i.geometry as usize].material as usize).cloned();
        is_specular.then(|| name().unwrap_or_default())
    })
}
