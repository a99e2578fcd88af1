//! What the user decides about a render; what is left open follows the scene.

use crate::{
    Error, Layer, Method, Render, radiosity,
    raster::{FrameKind, Options, RASTER},
};
use std::path::PathBuf;
use steradian_core::{
    Scene,
    sampler::{SAMPLERS, Sampler, SamplerKind},
};
use steradian_integrators::{
    Depth, IntegratorKind, PathEffort, Plan, VarianceReduction,
    ao::AmbientOcclusion,
    passes::left_to_chance,
    radiosity::{Settings, View},
};
use steradian_scene::{Family, names::did_you_mean};

/// Most groups of lights that layers are made of: each takes memory for a picture.
const MOST_LIGHT_GROUPS: usize = 64;

/// Pixels of the largest preview: it takes some 200 bytes for each.
const LARGEST_PREVIEW: u64 = 1 << 24;
/// Most samples per pixel.
pub const MAX_SPP: u32 = 1 << 24;
/// Most threads.
pub const MAX_THREADS: usize = 1024;

/// Integrator, samples, depth, threads and layers.
#[derive(Clone, Debug, Default)]
pub struct Quality {
    /// `NAME` or `NAME:key=value,…` with keys `max_depth`, `rr_depth`, `hide_emitters`, `reuse`: how many paths share
    /// what they find, 1, 4 or 16, or `auto` where a trial is to tell, `caustics`: whether photons look for light
    /// behind mirrors and glass beforehand, and `effort`: whether trials tell how many light samples and how much
    /// roulette pay, and where more paths (`auto`), or not (`even`).
    pub integrator: Option<String>,
    /// Samples per pixel, up to [`MAX_SPP`]; their mean with `adaptive`.
    pub spp: Option<u32>,
    /// Whether parts of the picture that err more get more samples.
    pub adaptive: bool,
    /// The relative error of the picture ([`steradian_integrators::Session::error`]) at which to stop.
    pub error: Option<f64>,
    /// Random seed.
    pub seed: Option<u64>,
    /// Threads, up to [`MAX_THREADS`]; 0 for one per processor.
    pub threads: usize,
    /// Most scattering events.
    pub max_depth: Option<u32>,
    /// Sampler by name, or `scene` for the one that the scene's file names.
    pub sampler: Option<String>,
    /// Auxiliary layers.
    pub layers: Vec<Layer>,
    /// Whether what lies behind all surfaces is left out of the picture, for [`Layer::Alpha`].
    pub transparent: bool,
    /// Whether pixels are to err independently, as denoising needs it: `reuse` is 1 unless an option says otherwise.
    pub independent: bool,
}

/// Something of a scene that an integrator does not render.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LeftOut {
    /// What.
    pub what: String,
    /// The integrator that renders it.
    pub instead: &'static str,
}

impl Quality {
    /// By an integrator, `NAME` or `NAME:key=value,…`; the rest follows the scene.
    pub fn of(integrator: &str) -> Self {
        Self { integrator: Some(integrator.into()), ..Self::default() }
    }

    /// With so many samples per pixel.
    #[must_use]
    pub fn spp(self, spp: u32) -> Self {
        Self { spp: Some(spp), ..self }
    }

    /// The integrator for a scene, and what it is to render.
    ///
    /// # Errors
    /// [`Error`] for unknown names and options, and numbers that are too large.
    pub fn render(&self, scene: &Scene) -> Result<Render, Error> {
        let asked = self.integrator_or_scene(scene);
        let (name, options) = asked.split_once(':').unwrap_or((asked, ""));
        check_options(name, options)?;
        let of_scene = self.options_of_scene(name, scene);
        let depth = Depth {
            max: scene.settings().max_depth,
            roulette_after: scene.settings().rr_depth,
            hide_emitters: scene.settings().hide_emitters,
        };
        if name == "radiosity" {
            let depth = Depth { max: self.max_depth.unwrap_or(depth.max), ..depth };
            let asked = radiosity::options(&(of_scene + options), depth)?;
            let settings = Settings { seed: self.seed.unwrap_or(scene.settings().seed), ..asked.view.settings };
            let view = View { settings, ..asked.view };
            radiosity::can_solve(scene, &view)?;
            if let Some(what) = IntegratorKind::Radiosity(view).refuses(scene) {
                return Err(Error::CannotRender { integrator: name.into(), what });
            }
            // Without a final gather pixels have no noise but that of edges.
            let spp =
                self.spp.unwrap_or(if view.gather > 0 { scene.settings().spp } else { scene.settings().spp.min(16) });
            let hide = view.depth.hide_emitters;
            return self.plan_of(scene, Method::Rays(IntegratorKind::Radiosity(view)), spp, hide);
        }
        if name == RASTER {
            let by_light = self.layers.contains(&Layer::LightGroups);
            // What is asked without a word more is a first picture.
            let crop = scene.film().crop;
            let is_small = u64::from(crop.width()) * u64::from(crop.height()) <= LARGEST_PREVIEW;
            let is_preview = options.is_empty()
                && of_scene.is_empty()
                && self.spp.is_none()
                && !by_light
                && !self.transparent
                && is_small;
            let mut options = Options::parse(&(of_scene + options))?;
            if is_preview {
                options.frame = FrameKind::Preview;
            }
            let depth = Depth { max: self.max_depth.unwrap_or(u32::MAX), ..depth };
            if self.adaptive {
                return Err(Error::NotAdaptive(name.into()));
            }
            let spp = self.spp.unwrap_or(1);
            return self.plan_of(scene, Method::Pipeline(options, depth), spp, depth.hide_emitters);
        }
        if name == "ao" {
            let integrator = IntegratorKind::AmbientOcclusion(ambient_occlusion(&(of_scene + options))?);
            let spp = self.spp.unwrap_or(scene.settings().spp);
            return self.plan_of(scene, Method::Rays(integrator), spp, false);
        }
        let options = of_scene + options;
        let PathOptions { mut depth, mut variance_reduction, samples, own } =
            PathOptions::parse(name, &options, depth)?;
        if self.independent {
            variance_reduction.reuse.get_or_insert(1);
        }
        depth.max = self.max_depth.unwrap_or(depth.max);
        let mut integrator =
            IntegratorKind::named(name, depth, variance_reduction).ok_or_else(|| Error::UnknownIntegrator {
                name: name.into(),
                hint: did_you_mean(name, Family::Integrator.kinds()),
                known: Family::Integrator.kinds().collect::<Vec<_>>().join(", "),
            })?;
        for (key, value, option) in own {
            if !integrator.set(key, value) {
                return Err(unknown_option(name, option));
            }
        }
        if self.adaptive && matches!(integrator, IntegratorKind::Passes(_) | IntegratorKind::Transient(_)) {
            return Err(Error::NotAdaptive(name.into()));
        }
        if let Some(what) = integrator.refuses(scene) {
            return Err(Error::CannotRender { integrator: name.into(), what });
        }
        if self.transparent {
            let what = match integrator {
                IntegratorKind::Passes(_) => Some("a transparent background"),
                _ if scene.has_media() => Some("a transparent background behind media"),
                _ => None,
            };
            if let Some(what) = what {
                return Err(Error::CannotRender { integrator: name.into(), what: what.into() });
            }
        }
        let spp = self.spp.or(samples).unwrap_or(scene.settings().spp);
        self.plan_of(scene, Method::Rays(integrator), spp, depth.hide_emitters)
    }

    /// The scene's own options of an integrator, to stand before those that are asked for.
    fn options_of_scene(&self, name: &str, scene: &Scene) -> String {
        let settings = scene.settings();
        let own = settings.options.iter().filter(|_| name == settings.integrator);
        own.map(|(key, value)| format!("{key}={value},")).collect()
    }

    /// Makes paths fit for layers of groups of lights, which share nothing and take one light sample each.
    fn keep_lights_apart(&self, scene: &Scene, method: &mut Method) -> Result<(), String> {
        let groups = scene.light_groups().names.len();
        if groups > MOST_LIGHT_GROUPS {
            return Err(format!("layers of {groups} groups of lights ({MOST_LIGHT_GROUPS} at most)"));
        }
        if self.adaptive {
            return Err("layers of groups of lights with --adaptive".into());
        }
        let plain = |variance_reduction: &mut VarianceReduction| {
            *variance_reduction =
                VarianceReduction { reuse: Some(1), effort: Some(PathEffort::default()), ..*variance_reduction };
        };
        match method {
            Method::Rays(IntegratorKind::Path(i)) => plain(&mut i.variance_reduction),
            Method::Rays(IntegratorKind::VolPath(i)) => plain(&mut i.variance_reduction),
            Method::Pipeline(..) => {}
            Method::Rays(_) => return Err("layers of groups of lights; 'path', 'volpath' and 'raster' can".into()),
        }
        Ok(())
    }

    /// Refuses numbers that no render can have.
    ///
    /// # Errors
    /// [`Error::OutOfRange`].
    pub fn check(&self) -> Result<(), Error> {
        let within = |what, least: usize, most: usize, asked: usize| match (least..=most).contains(&asked) {
            true => Ok(()),
            false => Err(Error::OutOfRange { what, least, most, asked }),
        };
        within("samples per pixel", 1, MAX_SPP as usize, self.spp.unwrap_or(1) as usize)?;
        within("threads", 0, MAX_THREADS, self.threads)
    }

    /// By a method, with so many samples per pixel, and lights hidden from the camera or not.
    fn plan_of(&self, scene: &Scene, mut method: Method, spp: u32, hide_emitters: bool) -> Result<Render, Error> {
        self.check()?;
        if self.layers.contains(&Layer::LightGroups) {
            let kept = self.keep_lights_apart(scene, &mut method);
            kept.map_err(|what| Error::CannotRender { integrator: self.integrator_name(scene).into(), what })?;
        }
        let kind = match self.sampler.as_deref() {
            None => scene.settings().sampler,
            Some("scene") => scene.settings().named_sampler,
            Some(name) => SamplerKind::named(name).ok_or_else(|| Error::UnknownSampler {
                name: name.into(),
                hint: did_you_mean(name, SAMPLERS.iter().map(|s| s.0)),
                known: SAMPLERS.iter().map(|s| s.0).collect::<Vec<_>>().join(", "),
            })?,
        };
        let sampler = Sampler { kind, spp, seed: self.seed.unwrap_or(scene.settings().seed) };
        let plan = Plan {
            sampler,
            threads: self.threads,
            features: self.layers.iter().any(|l| l.needs_features()),
            motion: self.layers.contains(&Layer::Motion),
            sees_through: self.layers.iter().any(|l| l.sees_through()),
            mattes: self.layers.contains(&Layer::Cryptomatte),
            by_light: self.layers.contains(&Layer::LightGroups),
            halves: self.layers.contains(&Layer::Halves),
            transparent: self.transparent,
            hide_emitters,
            adaptive: self.adaptive,
            error: self.error,
        };
        let render = Render { method, plan };
        if plan.halves
            && let Some(what) = render.no_halves(scene)
        {
            return Err(Error::CannotRender { integrator: self.integrator_name(scene).into(), what });
        }
        Ok(render)
    }

    /// The file that keeps the solution of radiosity, where one is named.
    pub fn solution(&self) -> Option<PathBuf> {
        let (_, options) = self.integrator.as_deref()?.strip_prefix("radiosity").map(|o| o.split_once(':'))??;
        options.split(',').find_map(|o| o.strip_prefix("solution=")).filter(|f| !f.is_empty()).map(PathBuf::from)
    }

    /// The integrator that is asked for, or the scene's; where that cannot do what is in the scene, a path tracer.
    fn integrator_or_scene<'a>(&'a self, scene: &'a Scene) -> &'a str {
        let named = scene.settings().integrator.as_str();
        match &self.integrator {
            Some(asked) => asked,
            None if self.cannot(scene).is_some() => {
                if scene.has_media() {
                    "volpath"
                } else {
                    "path"
                }
            }
            None => named,
        }
    }

    /// What in the scene its own integrator cannot do, where no other one is asked for: a path tracer renders it then.
    pub fn cannot(&self, scene: &Scene) -> Option<String> {
        let depth = Depth { max: 1, roulette_after: 1, hide_emitters: false };
        match IntegratorKind::named(&scene.settings().integrator, depth, VarianceReduction::default())? {
            kind if self.integrator.is_none() => kind.refuses(scene),
            _ => None,
        }
    }

    /// What of the scene the integrator does not see. (That a file's own integrator sees no media is said by
    /// compiling.)
    pub fn leaves_out(&self, scene: &Scene) -> Option<LeftOut> {
        let name = self.integrator_name(scene);
        let is_raster = name == RASTER;
        let depth = Depth { max: 1, roulette_after: 1, hide_emitters: false };
        let passes = match IntegratorKind::named(name, depth, VarianceReduction::default()) {
            Some(IntegratorKind::Passes(kind)) => Some(kind),
            _ => None,
        };
        let is_blind = matches!(name, "path" | "direct" | "whitted") || name.starts_with("stokes") || is_raster;
        let media = scene.has_media() && is_blind && self.integrator.is_some();
        let media = media.then(|| "participating media".to_owned());
        let chance = scene.emitters_left_to_chance();
        let chance = (chance > 0 && (is_raster || name == "whitted")).then(|| left_to_chance(chance));
        let motion = ((scene.moves() || scene.has_schedules()) && is_raster)
            .then(|| "motion: it shows the moment at which the shutter opens".to_owned());
        let below = ((scene.has_subsurface() || scene.is_fluorescent()) && is_raster)
            .then(|| "light that goes below surfaces or changes its wavelength: they are shown as diffuse".to_owned());
        let of_passes = passes.as_ref().and_then(|kind| kind.leaves_out(scene));
        let solved = (name == "radiosity").then(|| self.not_solved(scene)).flatten();
        let what: Vec<String> = [media, motion, below, of_passes, chance, solved].into_iter().flatten().collect();
        let instead = match passes {
            _ if scene.has_media() => "volpath",
            Some(_) => "bdpt",
            None => "path",
        };
        (!what.is_empty()).then(|| LeftOut { what: what.join(", "), instead })
    }

    /// What of the scene radiosity shows otherwise than it is.
    fn not_solved(&self, scene: &Scene) -> Option<String> {
        let media = scene.has_media().then(|| "participating media".to_owned());
        let below =
            scene.has_subsurface().then(|| "light that goes below surfaces: they are shown as diffuse".to_owned());
        let detail = scene.has_surface_detail().then(|| "normal and bump maps between surfaces".to_owned());
        media.into_iter().chain(below).chain(detail).reduce(|a, b| format!("{a}, {b}"))
    }

    /// The integrator's name in the plan, without options.
    pub fn integrator_name<'a>(&'a self, scene: &'a Scene) -> &'a str {
        let asked = self.integrator_or_scene(scene);
        asked.split_once(':').map_or(asked, |s| s.0)
    }
}

/// The options of an integrator that follows paths.
struct PathOptions<'a> {
    depth: Depth,
    variance_reduction: VarianceReduction,
    /// Samples per pixel, of methods that count their own.
    samples: Option<u32>,
    /// Those of the integrator alone: key, value, and both as written.
    own: Vec<(&'a str, &'a str, &'a str)>,
}

impl<'a> PathOptions<'a> {
    fn parse(name: &str, options: &'a str, depth: Depth) -> Result<Self, Error> {
        let variance_reduction = VarianceReduction::default();
        let mut parsed = Self { depth, variance_reduction, samples: None, own: Vec::new() };
        for option in options.split(',').filter(|o| !o.is_empty()) {
            let fault = || unknown_option(name, option);
            let (key, value) = option.split_once('=').ok_or_else(fault)?;
            let reduction = &mut parsed.variance_reduction;
            match key.trim() {
                "max_depth" if value == "-1" => parsed.depth.max = u32::MAX,
                "max_depth" => parsed.depth.max = value.parse().map_err(|_| fault())?,
                "rr_depth" => parsed.depth.roulette_after = value.parse().map_err(|_| fault())?,
                "hide_emitters" => parsed.depth.hide_emitters = value.parse().map_err(|_| fault())?,
                "samples" => parsed.samples = Some(value.parse().map_err(|_| fault())?),
                "reuse" if value == "auto" => reduction.reuse = None,
                "reuse" => {
                    let size: u32 = value.parse().map_err(|_| fault())?;
                    reduction.reuse = Some([1, 4, 16].into_iter().find(|s| *s == size).ok_or_else(fault)?);
                }
                "caustics" if value == "auto" => reduction.caustics = None,
                "effort" if value == "auto" => reduction.effort = None,
                "effort" if value == "even" => reduction.effort = Some(PathEffort::default()),
                "caustics" => reduction.caustics = Some(value.parse().map_err(|_| fault())?),
                key => parsed.own.push((key, value, option)),
            }
        }
        Ok(parsed)
    }
}

/// Holds options against the schema.
fn check_options(integrator: &str, options: &str) -> Result<(), Error> {
    // Names that are unknown are told where they are looked up.
    let Some(model) = Family::Integrator.model(integrator) else { return Ok(()) };
    let is_value = |option: &str| {
        let (key, value) = option.split_once('=')?;
        model.parameter(key.trim()).filter(|p| p.takes(value))
    };
    match options.split(',').map(str::trim).find(|o| !o.is_empty() && is_value(o).is_none()) {
        Some(wrong) => Err(unknown_option(integrator, wrong)),
        None => Ok(()),
    }
}

/// An option that an integrator does not have, or not with that value.
fn unknown_option(integrator: &str, option: &str) -> Error {
    let known = Family::Integrator.model(integrator).map_or(&[][..], |i| i.parameters);
    let keys: Vec<String> = known.iter().map(|o| format!("{} ({})", o.name, o.values())).collect();
    let keys = if keys.is_empty() { "none".to_owned() } else { keys.join("; ") };
    let key = option.split('=').next().unwrap_or(option).trim();
    let hint = match known.iter().find(|o| o.name == key) {
        Some(o) => format!(" ('{key}' takes {})", o.values()),
        None => did_you_mean(key, known.iter().map(|o| o.name)).map(|h| format!(" ({h})")).unwrap_or_default(),
    };
    Error::IntegratorOption { option: option.into(), integrator: integrator.into(), hint, keys }
}

/// The options of ambient occlusion.
fn ambient_occlusion(options: &str) -> Result<AmbientOcclusion, Error> {
    let mut asked = AmbientOcclusion { distance: f32::INFINITY };
    for option in options.split(',').filter(|o| !o.is_empty()) {
        let distance = option.trim().strip_prefix("distance=").and_then(|v| v.parse::<f32>().ok());
        asked.distance = distance.filter(|d| *d > 0.0).ok_or_else(|| Error::AmbientOcclusionOption(option.into()))?;
    }
    Ok(asked)
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian_compile::{Options, compile};
    use steradian_scene::{Node, SceneDesc};
    use steradian_schema::{Type, integrator::INTEGRATORS};

    fn scene(integrator: Node) -> Scene {
        let mut desc = SceneDesc::default();
        desc.cameras = vec![desc.add(Node::new(Family::Camera, "perspective", None))];
        desc.integrator = Some(desc.add(integrator));
        compile(&desc, &Options::default()).scene.unwrap_or_else(|| panic!("no scene"))
    }

    fn plan(scene: &Scene, integrator: Option<&str>, adaptive: bool) -> Result<String, String> {
        let quality = Quality { integrator: integrator.map(Into::into), adaptive, ..Quality::default() };
        quality.render(scene).map(|r| format!("{:?} {}", r.method, r.plan.sampler.spp)).map_err(|e| e.to_string())
    }

    #[test]
    fn options_of_files_are_used_and_can_be_overridden() {
        let of_file = scene(
            Node::new(Family::Integrator, "sppm", None)
                .with("photons", 700i64)
                .with("radius", 0.5)
                .with("samples", 9i64),
        );
        let said = plan(&of_file, None, false).unwrap();
        assert!(said.contains("photons: 700") && said.contains("Fixed(0.5)") && said.ends_with(" 9"), "{said}");
        let said = plan(&of_file, Some("sppm:radius=0.25"), false).unwrap();
        assert!(said.contains("photons: 700") && said.contains("Fixed(0.25)"), "{said}");
        assert!(plan(&of_file, Some("vcm"), false).unwrap().contains("Pixels"));
    }

    #[test]
    fn the_distance_of_a_file_is_that_of_its_occlusion() {
        let of_file = scene(Node::new(Family::Integrator, "ao", None).with("distance", 2.5));
        assert!(plan(&of_file, None, false).unwrap().contains("distance: 2.5"));
        assert!(plan(&of_file, Some("ao"), false).unwrap().contains("distance: 2.5"));
        assert!(plan(&of_file, Some("ao:distance=7"), false).unwrap().contains("distance: 7"));
        let another = scene(Node::new(Family::Integrator, "path", None));
        assert!(plan(&another, Some("ao"), false).unwrap().contains("distance: inf"));
    }

    #[test]
    fn numbers_that_no_render_can_have_are_refused() {
        let scene = scene(Node::new(Family::Integrator, "path", None));
        let said = |quality: Quality| quality.render(&scene).unwrap_err().to_string();
        let threads = said(Quality { threads: 1 << 31, ..Quality::default() });
        assert_eq!(threads, "threads are whole numbers from 0 to 1024, not 2147483648");
        for (spp, integrator) in [(0, None), (u32::MAX, None), (u32::MAX, Some("vcm".into()))] {
            let said = said(Quality { spp: Some(spp), integrator, ..Quality::default() });
            assert!(said.starts_with("samples per pixel are whole numbers from 1 to 16777216"), "{said}");
        }
        let raster = Quality { spp: Some(u32::MAX), integrator: Some("raster".into()), ..Quality::default() };
        assert!(matches!(raster.render(&scene), Err(Error::OutOfRange { .. })));
    }

    #[test]
    fn options_that_an_integrator_lacks_are_refused() {
        let scene = scene(Node::new(Family::Integrator, "path", None));
        for wrong in
            ["bdpt:reuse=4", "whitted:caustics=true", "sppm:nearest=3", "pssmlt:large_step=2", "stokes:effort=auto"]
        {
            let said = plan(&scene, Some(wrong), false).unwrap_err();
            let (name, option) = wrong.split_once(':').unwrap();
            assert!(said.contains(name) && said.contains(option) && said.contains("max_depth"), "{said}");
        }
        assert!(plan(&scene, Some("vcm"), true).unwrap_err().contains("--adaptive"));
        assert!(plan(&scene, Some("path:reuse=4"), true).is_ok());
    }

    /// Every option that is listed is understood by its integrator, with a value of those that are listed and with the
    /// stated default, and every other one is refused with their names.
    #[test]
    fn options_are_those_that_are_listed() {
        let scene = compile(&crate::cornell::luminous_ceiling(), &Options::default()).scene.expect("a sound scene");
        let render = |text: &str| Quality { integrator: Some(text.into()), ..Quality::default() }.render(&scene);
        let all: Vec<_> = INTEGRATORS.iter().flat_map(|i| i.parameters).map(|o| o.name).chain(["speed"]).collect();
        for info in INTEGRATORS {
            for p in info.parameters {
                let values: Vec<String> = match p.kind {
                    Type::Word(_) => p.words().map(Into::into).collect(),
                    Type::Flag => vec!["true".into(), "false".into()],
                    Type::File => vec!["light".into()],
                    _ => ["1", "0.5", p.usual_default()].map(Into::into).to_vec(),
                };
                let values: Vec<_> = values.iter().filter(|value| p.takes(value)).collect();
                assert!(!values.is_empty(), "{}", p.name);
                for value in values {
                    // Views of hybrid frames are of those.
                    let of_hybrid = info.kind == "raster"
                        && p.name == "show"
                        && ["emission", "direct", "indirect", "reflections", "transparency", "occlusion", "graph"]
                            .contains(&value.as_str());
                    let frame = if of_hybrid { "frame=hybrid," } else { "" };
                    let text = format!("{}:{frame}{}={value}", info.kind, p.name);
                    assert!(render(&text).is_ok(), "{text}: {:?}", render(&text));
                }
                let text = format!("{}:{}=§", info.kind, p.name);
                assert!(p.kind == Type::File || render(&text).is_err(), "{text}");
            }
            for other in all.iter().filter(|name| info.parameters.iter().all(|o| o.name != **name)) {
                let refusal = render(&format!("{}:{other}=1", info.kind)).expect_err(other).to_string();
                let has_all = info.parameters.iter().all(|o| refusal.contains(o.name));
                assert!(refusal.contains(other) && has_all, "{}: {refusal}", info.kind);
            }
        }
    }

    /// Every integrator that has the option leaves out lights that the camera sees: here nothing else shines.
    #[test]
    fn hidden_lights_are_not_seen() {
        let text = r#"Film "rgb" "integer xresolution" 4 "integer yresolution" 4
            LookAt 0 0 -3  0 0 0  0 1 0 Camera "perspective" "float fov" 30 WorldBegin
            Material "diffuse" "rgb reflectance" [0 0 0] AreaLightSource "diffuse" "rgb L" [4 4 4]
            Shape "trianglemesh" "point3 P" [-9 -9 0  -9 9 0  9 9 0  9 -9 0] "integer indices" [0 1 2 0 2 3]"#;
        let loaded = crate::load_bytes("lamp.pbrt", text.as_bytes().to_vec(), Some("pbrt"), &Default::default());
        let mode = Some(steradian_core::ColorMode::Rgb);
        let scene = compile(&loaded.desc, &Options { mode, ..Options::default() }).scene.expect("a sound scene");
        let scene = std::sync::Arc::new(scene);
        let seen = |name: &str, is_hidden: bool| {
            let quality = Quality::of(&format!("{name}:hide_emitters={is_hidden}")).spp(4);
            let picture = crate::render(&scene, &quality).expect(name);
            picture.channel("G").expect("green").iter().sum::<f32>() / 16.0
        };
        for info in INTEGRATORS.iter().filter(|i| i.parameter("hide_emitters").is_some()) {
            assert_eq!(seen(info.kind, true), 0.0, "{} sees a hidden light", info.kind);
            // S1 to S3 of light that is not polarised are black.
            let is_black = info.kind.starts_with("stokes-");
            assert!(is_black || seen(info.kind, false) > 3.0, "{}: {}", info.kind, seen(info.kind, false));
        }
    }

    /// Camera rays pass hidden lights, of any shape and from either side, to what is behind them: a wall lit by a
    /// spherical lamp of radius r at distance d, whose radiance there is ρ L r²/d². Four seeds tell the noise; beyond
    /// four standard errors of it, methods with patches and photons may be off by 5 %.
    #[test]
    fn what_is_behind_hidden_lights_is_seen() {
        let text = |wall: &str| {
            format!(
                r#"Film "rgb" "integer xresolution" 4 "integer yresolution" 4
                LookAt 0 0 -30  0 0 0  0 1 0 Camera "perspective" "float fov" 0.5 WorldBegin
                AttributeBegin Material "diffuse" "rgb reflectance" [0 0 0] AreaLightSource "diffuse" "rgb L" [40 40 40]
                Shape "sphere" "float radius" 0.5 AttributeEnd
                AttributeBegin Material "diffuse" "rgb reflectance" [0 0 0]
                AreaLightSource "diffuse" "rgb L" [1e-4 1e-4 1e-4]
                Shape "trianglemesh" "point3 P" [-9 -9 -1  -9 9 -1  9 9 -1  9 -9 -1] "integer indices" [0 1 2 0 2 3]
                AttributeEnd
                Material "diffuse" "rgb reflectance" [0.5 0.5 0.5] {wall}"#
            )
        };
        let scene = |wall: &str| {
            let loaded = crate::load_bytes("lamp.pbrt", text(wall).into_bytes(), Some("pbrt"), &Default::default());
            let mode = Some(steradian_core::ColorMode::Rgb);
            let options = Options { mode, ..Options::default() };
            let mut scene = compile(&loaded.desc, &options).scene.expect("a sound scene");
            scene.change(|parts| parts.settings.hide_emitters = true);
            std::sync::Arc::new(scene)
        };
        let wall = scene(
            r#"Shape "trianglemesh" "point3 P" [-9 -9 2  -9 9 2  9 9 2  9 -9 2] "integer indices" [0 1 2 0 2 3]"#,
        );
        let mean = |name: &str, seed: u64| {
            let quality = Quality::of(name).spp(if name == "light" { 8192 } else { 8 });
            let picture = crate::render(&wall, &Quality { seed: Some(seed), ..quality }).expect(name);
            f64::from(picture.channel("G").expect("green").iter().sum::<f32>()) / 16.0
        };
        for info in INTEGRATORS.iter().filter(|i| i.parameter("hide_emitters").is_some()) {
            let right = match info.kind {
                "raycast" => 0.5,
                name if name.starts_with("stokes-") => 0.0,
                _ => 0.5 * 40.0 * 0.25 / 4.0,
            };
            let means: Vec<_> = (1..=4).map(|seed| mean(info.kind, seed)).collect();
            let found = means.iter().sum::<f64>() / 4.0;
            let error = (means.iter().map(|m| (m - found).powi(2)).sum::<f64>() / 12.0).sqrt();
            assert!(
                (found - right).abs() <= 4.0 * error + 0.05 * right,
                "{}: {found} ± {error}, not {right}",
                info.kind
            );
        }
        let (lamps, layers) = (scene(""), vec![Layer::Alpha, Layer::Depth]);
        for name in ["path", "raster"] {
            let quality = Quality { layers: layers.clone(), ..Quality::of(name).spp(2) };
            let of = |scene, channel: &str| {
                let quality = Quality { transparent: true, ..quality.clone() };
                crate::render(scene, &quality).expect(name).channel(channel).expect(channel).to_vec()
            };
            assert!(of(&lamps, "A").iter().all(|a| *a == 0.0), "{name}: hidden lights cover nothing");
            assert!(of(&wall, "Z").iter().all(|z| (z - 32.0).abs() < 0.01), "{name}: the depth is the wall's");
        }
    }
}
