//! Radiosity as a method: its options, its limits, its sessions.

use super::{FormFactors, METHODS, Settings, View, beyond_lambert, check, not_cut};
use crate::support;
use std::sync::Arc;
use steradian_core::Scene;
use steradian_engine::{
    Asked, Feature, Limit, Method, MethodKind, Plan, Refusal, Session,
    Support::{self, Approximates, LeavesOut, Refuses},
    Tiles, local_scene,
};

/// `radiosity`.
pub const RADIOSITY: MethodKind = MethodKind::new("radiosity", |asked| {
    let view = View::of(asked);
    match check(asked.scene, &view.settings) {
        // Features of scenes are told by the method's limits.
        Ok(()) | Err(super::Refusal::Media | super::Refusal::Motion | super::Refusal::Schedules) => Ok(Arc::new(view)),
        Err(refusal) => Err(Refusal(refusal.to_string())),
    }
});

impl View {
    /// With the options of a request.
    pub fn of(asked: &Asked<'_>) -> Self {
        let (options, depth) = (asked.options, asked.depth());
        let gather = options.count("gather");
        let factors = options.word("factors");
        // The default depends on what is resolved: rays of a patch, or pixels of an edge of the hemicube.
        let resolution = options.given("resolution").and_then(|v| v.number()).map(|v| v as u32);
        // The last bounce is that at the surface that is seen; with a final gather the last two are followed.
        let carried = depth.max.saturating_sub(u32::from(gather > 0));
        let settings = Settings {
            method: METHODS.iter().find(|m| m.0 == options.word("method")).map_or(Settings::default().method, |m| m.1),
            factors: match factors {
                "montecarlo" => FormFactors::MonteCarlo(resolution.unwrap_or(1000)),
                "hemicube" => FormFactors::Hemicube(resolution.unwrap_or(64)),
                _ => FormFactors::Analytic,
            },
            patches: options.count("patches") as usize,
            adaptive: options.count("adaptive"),
            tolerance: options.number("tolerance").unwrap_or_default(),
            rays: options.count("rays"),
            bands: options.count("wavelengths").div_ceil(4) as usize,
            ambient: options.flag("ambient"),
            bounces: (depth.max != u32::MAX).then_some(carried),
            seed: asked.seed(),
        };
        Self { settings, depth, gather, smooth: options.flag("smooth") }
    }
}

impl Method for View {
    fn supports(&self, feature: Feature) -> Support {
        match feature {
            Feature::Media | Feature::Fluorescence | Feature::Schedules => Refuses(""),
            Feature::Motion => Refuses("it knows one moment"),
            Feature::Subsurface => Approximates("it is shown as diffuse"),
            Feature::SurfaceDetail => LeavesOut("light between surfaces does not meet them"),
            Feature::Bands => Approximates("patches know the light at a few wavelengths"),
            Feature::Denoising => Refuses("patches err, not pixels"),
            Feature::TransparencyBehindMedia => Support::Exact,
            _ => support::of_camera_rays(feature),
        }
    }

    fn limits(&self, scene: &Scene) -> Vec<Limit> {
        let mut limits = Limit::of(self, scene);
        if let Ok(names) = beyond_lambert(scene)
            && !names.is_empty()
        {
            let what = format!("materials '{}'", names.join("', '"));
            limits.push(Limit::new(what, Approximates("only their Lambertian part exchanges light")));
        }
        if let Ok(kinds) = not_cut(scene)
            && !kinds.is_empty()
        {
            let why = "they are no patches, cast shadows, but exchange no light";
            limits.push(Limit::new(kinds.join(", "), LeavesOut(why)));
        }
        limits
    }

    fn session(&self, scene: Arc<Scene>, plan: Plan) -> Result<Box<dyn Session>, Refusal> {
        Ok(Box::new(Tiles::per_pixel(local_scene(scene), *self, plan)))
    }

    /// Without a final gather pixels have no noise but that of edges.
    fn default_spp(&self, of_scene: u32) -> u32 {
        if self.gather > 0 { of_scene } else { of_scene.min(16) }
    }

    fn bias_pair(&self) -> Option<[Arc<dyn Method>; 2]> {
        let mut coarser = *self;
        coarser.settings.patches /= 4;
        Some([Arc::new(*self), Arc::new(coarser)])
    }
}
