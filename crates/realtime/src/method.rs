//! Rasterisation as a method: its options, its limits, its sessions.

use crate::{EnvironmentKind, Error, FrameKind, Hybrid, Options, Preview, Rasterizer};
use std::sync::Arc;
use steradian_core::{ColorMode, Scene};
use steradian_engine::{
    Asked, Depth, Feature, Method, MethodKind, Passes, Plan, Refusal, Session,
    Support::{self, Approximates, LeavesOut, Refuses},
    local_scene,
};

/// Pixels of the largest preview: it takes some 200 bytes for each.
const LARGEST_PREVIEW: u64 = 1 << 24;

/// `raster`. One sample of wavelengths would be noise: RGB suits it.
pub const RASTER: MethodKind = MethodKind {
    name: "raster",
    new: |asked| Ok(Arc::new(Raster::of(asked)?)),
    check: |options| Ok(Options::of(options).map(drop)?),
    mode: Some(ColorMode::Rgb),
};

/// All methods of this crate, by name.
pub const METHODS: &[MethodKind] = &[RASTER];

/// Frames of the graphics pipeline.
#[derive(Clone, Copy, Debug)]
pub struct Raster {
    /// Options of frames.
    pub options: Options,
    /// Limits of paths behind what is seen, and whether the camera sees lights.
    pub depth: Depth,
}

impl Raster {
    /// With the options of a request. One without options, samples, groups of lights and transparency is a preview.
    fn of(asked: &Asked<'_>) -> Result<Self, Refusal> {
        let (request, crop) = (asked.request, asked.scene.film().crop);
        let mut options = Options::of(asked.options)?;
        let is_small = u64::from(crop.width()) * u64::from(crop.height()) <= LARGEST_PREVIEW;
        let by_light = request.layers.contains(&steradian_core::film::Layer::LIGHT_GROUPS);
        let is_plain = asked.options.sets_nothing_but(&["hide_emitters"]);
        if is_plain && request.spp.is_none() && !by_light && !request.transparent && is_small {
            options.frame = FrameKind::Preview;
        }
        if options.environment != EnvironmentKind::Sampled && asked.scene.mode() == ColorMode::Spectral {
            return Err(Refusal("raster: environment=harmonics and prefiltered take RGB mode (--color rgb)".into()));
        }
        let depth = Depth { max: request.max_depth.unwrap_or(u32::MAX), ..asked.depth() };
        Ok(Self { options, depth })
    }
}

impl Method for Raster {
    fn supports(&self, feature: Feature) -> Support {
        let is_preview = self.options.frame == FrameKind::Preview;
        match feature {
            Feature::Media | Feature::UnsampledEmitters => LeavesOut(""),
            Feature::Motion | Feature::Schedules => LeavesOut("it shows the moment at which the shutter opens"),
            Feature::Polarization => Approximates("filters act as on unpolarised light"),
            Feature::Subsurface | Feature::Fluorescence => Approximates("it is shown as diffuse"),
            Feature::Samplers => LeavesOut("it spreads samples in a way of its own"),
            Feature::AmbientLight if self.options.frame != FrameKind::Forward => {
                LeavesOut("frame=preview and frame=hybrid find the light that they stand for; frame=forward has them")
            }
            Feature::Adaptivity => Refuses("it makes whole pictures pass by pass"),
            Feature::Denoising => {
                Refuses("rasterisation has no noise of paths (its frames frame=hybrid are denoised already)")
            }
            Feature::Bands => LeavesOut("it adds its light to R, G and B; 'path', 'volpath' and 'whitted' have bands"),
            Feature::Bounces => Refuses("it follows no paths; 'path', 'volpath' and 'direct' do"),
            Feature::LightGroups if self.options.frame != FrameKind::Forward => {
                Refuses("frame=preview and frame=hybrid do not tell groups of lights apart")
            }
            Feature::ShadowCatchers if self.options.frame == FrameKind::Hybrid => {
                LeavesOut("frame=hybrid shows them as surfaces")
            }
            Feature::Transparency if is_preview => Refuses("frame=preview has none"),
            _ => Support::Exact,
        }
    }

    fn session(&self, scene: Arc<Scene>, plan: Plan) -> Result<Box<dyn Session>, Refusal> {
        let (scene, Self { options, depth }) = (local_scene(scene), *self);
        Ok(match options.frame {
            FrameKind::Hybrid => {
                let hybrid = Hybrid::new(&scene, options, depth, &plan)?;
                Box::new(Passes::new(scene, hybrid, plan))
            }
            FrameKind::Preview => {
                let preview = Preview::new(&scene, options, depth, &plan)?;
                Box::new(Passes::new(scene, preview, plan))
            }
            FrameKind::Forward => {
                let rasterizer = Rasterizer::new(&scene, options, depth, &plan)?;
                Box::new(Passes::new(scene, rasterizer, plan))
            }
        })
    }

    fn default_spp(&self, _of_scene: u32) -> u32 {
        1
    }
}

impl From<Error> for Refusal {
    fn from(error: Error) -> Self {
        Self(error.to_string())
    }
}
