//! A request for a scene: the method that answers it, and its plan.

use crate::{Error, Plan, Scene, Session};
use std::{fmt, sync::Arc};
use steradian_core::{
    ColorMode,
    sampler::{Sampler, SamplerKind},
};
use steradian_engine::{Asked, Feature, Limit, Method, MethodKind, Refusal, Support};
use steradian_film::{LayerInputs, bounce_parts};
use steradian_request::{MethodRequest, Request, SamplerRequest};
use steradian_schema::integrator::path_tracer;

/// Most groups of lights that layers are made of: each takes memory for a picture.
const MOST_LIGHT_GROUPS: usize = 64;

/// A method for a scene, with its plan.
#[derive(Clone, Debug)]
pub struct Render {
    /// Name of the method.
    pub name: &'static str,
    /// The method.
    pub method: Arc<dyn Method>,
    /// Samples, layers and limits of the render.
    pub plan: Plan,
    /// Name of the scene's own method where a path tracer takes its place, and why in a sentence.
    pub replaced: Option<(&'static str, String)>,
    /// The trial that chose the method, where one was asked for.
    pub choice: Option<Choice>,
}

/// Trial that chose a method (`auto`).
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// Methods with the expected squared relative errors of their pictures, at equal cost; those that do not render the
    /// scene as it is asked for are left out. No errors where there is nothing to choose between.
    pub tried: Vec<(&'static str, f64)>,
}

impl fmt::Display for Choice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.tried.is_empty() {
            return f.write_str("no other candidate does all that is asked for");
        }
        let told: Vec<String> = self.tried.iter().map(|(name, error)| format!("{name} {error:.1e}")).collect();
        write!(f, "expected relMSE at equal cost: {}", told.join(", "))
    }
}

/// Something of a scene that a method does not render.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LeftOut {
    /// Limits of the method on the scene.
    pub limits: Vec<Limit>,
    /// Name of a method that renders it.
    pub instead: &'static str,
}

impl LeftOut {
    /// Features that are missing, in words; may be empty.
    pub fn missing(&self) -> String {
        self.told(false)
    }

    /// Features that are rendered otherwise than they are, in words; may be empty.
    pub fn approximated(&self) -> String {
        self.told(true)
    }

    fn told(&self, approximated: bool) -> String {
        let of = self.limits.iter().filter(|limit| matches!(limit.support, Support::Approximates(_)) == approximated);
        of.map(|limit| limit.what.as_str()).collect::<Vec<_>>().join("; ")
    }

    /// The sentence about a method that leaves this out.
    pub fn of(&self, name: &str) -> String {
        let parts = [("leaves out", self.missing()), ("approximates", self.approximated())];
        let parts = parts.into_iter().filter(|(_, what)| !what.is_empty());
        let parts: Vec<String> = parts.map(|(verb, what)| format!("{verb} {what}")).collect();
        format!("integrator '{name}' {}; '{}' renders it", parts.join(" and "), self.instead)
    }
}

/// All methods by name.
pub fn methods() -> impl Iterator<Item = &'static MethodKind> {
    steradian_integrators::METHODS.iter().chain(steradian_realtime::METHODS)
}

/// The method of a name.
fn kind(name: &str) -> Option<&'static MethodKind> {
    methods().find(|kind| kind.name == name)
}

/// The colour mode that suits an integrator, `NAME` or `NAME:key=value,…`, where its scene's format has no say.
pub fn suited_mode(integrator: &str) -> Option<ColorMode> {
    let name = integrator.split_once(':').map_or(integrator, |(name, _)| name);
    kind(name)?.mode
}

/// The method that a scene asks for: its file's own, or a path tracer.
pub fn method_of(scene: &Scene) -> MethodRequest {
    scene.method().cloned().unwrap_or_else(|| MethodRequest::new(path_tracer(scene.has_media())))
}

/// Bytes per pixel of a film while it is rendered, copied, developed and encoded, for `layers` auxiliary layers.
///
/// A pixel's sums take 56 bytes and those of its first hits 64, both twice while the film is copied; a layer has up to
/// three planes of four bytes, that are there again in the encoded file.
pub fn film_bytes_per_pixel(layers: usize) -> u64 {
    let sums = 56 + if layers > 0 { 64 } else { 0 };
    2 * sums + 2 * 12 * (1 + layers as u64)
}

impl Render {
    /// [`Self::of`] without methods of a program's own.
    ///
    /// # Errors
    /// Those of [`Self::of`].
    pub fn new(request: &Request, scene: &Scene) -> Result<Self, Error> {
        Self::of(&[], request, scene)
    }

    /// The method of a request, or the scene's own, with the options of both; methods may be a program's own.
    ///
    /// # Errors
    /// [`Error::CannotRender`] where the method refuses the scene or something that is asked for, and
    /// [`Error::Refused`] for options that do not go together.
    pub fn of(own: &[MethodKind], request: &Request, scene: &Scene) -> Result<Self, Error> {
        let options = match &request.method {
            Some(asked) => asked.over(scene.method()),
            None => method_of(scene),
        };
        let asked = Asked { request, options: &options, scene };
        let method = match made(own, &asked) {
            Err(Error::Refused(refusal)) if request.method.is_none() => {
                return Self::instead_of(options.name(), refusal.to_string(), request, scene);
            }
            made => made?,
        };
        if let Some(refused) = Limit::of(&*method, scene).into_iter().find(Limit::refuses) {
            let name = options.name();
            return match request.method.is_some() || name == path_tracer(scene.has_media()).kind {
                true => Err(Error::CannotRender { integrator: name.into(), what: refused.what }),
                false => Self::instead_of(name, format!("it cannot do {}", refused.what), request, scene),
            };
        }
        let plan = plan(&asked, &*method);
        let render = Self { name: options.name(), method, plan, replaced: None, choice: None };
        render.check(scene)?;
        Ok(render)
    }

    /// By a path tracer, in place of a scene's own method that refuses the scene or has options that do not go
    /// together.
    fn instead_of(name: &'static str, why: String, request: &Request, scene: &Scene) -> Result<Self, Error> {
        let method = Some(MethodRequest::new(path_tracer(scene.has_media())));
        let render = Self::new(&Request { method, ..request.clone() }, scene)?;
        Ok(Self { replaced: Some((name, why)), ..render })
    }

    /// Refuses what the request asks for and the method does not do.
    fn check(&self, scene: &Scene) -> Result<(), Error> {
        let cannot = |what: String| Error::CannotRender { integrator: self.name.into(), what };
        let (plan, supports) = (&self.plan, |feature| self.method.supports(feature));
        if plan.adaptive && supports(Feature::Adaptivity) != Support::Exact {
            return Err(Error::NotAdaptive(self.name.into()));
        }
        let (by_light, halves) = (plan.has(LayerInputs::LIGHT_GROUPS), plan.has(LayerInputs::HALVES));
        let by_bounce = plan.has(LayerInputs::BOUNCES);
        let behind = if scene.has_media() { " behind media" } else { "" };
        let transparency = if scene.has_media() { Feature::TransparencyBehindMedia } else { Feature::Transparency };
        let groups = scene.light_groups().names.len();
        let asked = [
            (plan.transparent, transparency, format!("a transparent background{behind}")),
            (scene.has_shadow_catchers() && scene.has_media(), transparency, format!("shadow catchers{behind}")),
            (by_light, Feature::LightGroups, "layers of groups of lights".into()),
            (by_bounce, Feature::Bounces, "layers of bounces".into()),
        ];
        for (is_asked, feature, what) in asked {
            if is_asked && supports(feature) != Support::Exact {
                return Err(cannot(Limit::new(what, supports(feature)).what));
            }
        }
        // Their parts add up to the path's light, of which a catcher shows nothing.
        for (is_asked, feature) in [(by_light, Feature::LightGroups), (by_bounce, Feature::Bounces)] {
            if is_asked && scene.has_shadow_catchers() {
                return Err(cannot(format!("{} with shadow catchers", feature.name())));
            }
        }
        if by_light && groups > MOST_LIGHT_GROUPS {
            return Err(cannot(format!("layers of {groups} groups of lights ({MOST_LIGHT_GROUPS} at most)")));
        }
        for (is_asked, feature) in [(by_light, Feature::LightGroups), (by_bounce, Feature::Bounces)] {
            if is_asked && plan.adaptive {
                return Err(cannot(format!("{} with --adaptive", feature.name())));
            }
        }
        if plan.has(LayerInputs::BANDS) && plan.adaptive {
            return Err(cannot(format!("{} with --adaptive", Feature::Bands.name())));
        }
        if by_light && by_bounce {
            return Err(cannot("layers of groups of lights and of bounces in one picture".into()));
        }
        if halves && plan.sampler.spp < 2 {
            return Err(cannot("the layer 'halves' with one sample per pixel; it takes two or more".into()));
        }
        match self.not_denoisable(scene).filter(|_| halves) {
            Some(why) => Err(cannot(format!("the layer 'halves': {why}"))),
            None => Ok(()),
        }
    }

    /// Bytes of the film while it is rendered, copied, developed and encoded, with so many layers that were asked for.
    /// Mattes, the light of groups and bounces, intervals of arrival and halves count for themselves.
    pub fn film_bytes(&self, scene: &Scene, layers: usize) -> u64 {
        // Mattes are counted apart from other layers, and have eight times as many planes.
        let mattes = if self.plan.has(LayerInputs::MATTES) { 16 } else { 0 };
        let groups = if self.plan.has(LayerInputs::LIGHT_GROUPS) { 3 * scene.light_groups().names.len() } else { 0 };
        let max_events = self.method.camera_paths().map_or(0, |paths| paths.depth.max);
        let bounces = if self.plan.has(LayerInputs::BOUNCES) { 3 * bounce_parts(max_events) } else { 0 };
        let bins = 3 * self.method.bins() as usize;
        let bands = scene.film().bands.as_ref().filter(|_| self.plan.has(LayerInputs::BANDS));
        let bands = bands.map_or(0, |bands| bands.count());
        // Sums of even number beside those of all, and two more pictures.
        let halves = if self.plan.has(LayerInputs::HALVES) { 8 } else { 0 };
        let layers = layers + scene.film().layers.len();
        let crop = scene.film().crop;
        let pixels = u64::from(crop.width()) * u64::from(crop.height());
        pixels.saturating_mul(film_bytes_per_pixel(layers + mattes + groups + bounces + bins + bands + halves))
    }

    /// Features of the scene that the picture lacks or shows otherwise, with the method that renders them; `None` where
    /// there are none.
    pub fn left_out(&self, scene: &Scene) -> Option<LeftOut> {
        let limits = self.method.limits(scene);
        let misses = |feature| self.method.supports(feature) != Support::Exact;
        let misses_ambient = !scene.lights().ambient.is_empty() && misses(Feature::AmbientLight);
        let misses_polarization = scene.polarizes() && misses(Feature::Polarization);
        let instead = if misses_ambient && limits.len() == 1 {
            "whitted"
        } else if misses_polarization && limits.len() == 1 {
            "stokes"
        } else if misses(Feature::SpecularView) {
            // Connections from the camera find what light tracing alone cannot, and its caustics.
            "bdpt"
        } else {
            path_tracer(scene.has_media()).kind
        };
        (!limits.is_empty()).then_some(LeftOut { limits, instead })
    }

    /// Reason why a denoiser cannot estimate the noise of the picture: errors of pixels that are not independent, or
    /// not noise.
    pub fn not_denoisable(&self, scene: &Scene) -> Option<&'static str> {
        match self.method.supports(Feature::Denoising) {
            _ if scene.film().sensor.is_some() => Some("the film adds the noise of a sensor, which is to stay"),
            Support::Refuses(why) => Some(why),
            _ => None,
        }
    }

    /// Starts with an empty film.
    ///
    /// # Errors
    /// [`Error::Refused`] for scenes that the method cannot begin with.
    pub fn session(&self, scene: &Arc<Scene>) -> Result<Box<dyn Session>, Error> {
        Ok(self.method.session(Arc::clone(scene), self.plan)?)
    }
}

/// The method of a request.
fn made(own: &[MethodKind], asked: &Asked<'_>) -> Result<Arc<dyn Method>, Error> {
    let kind = check_options(own, asked.options)?;
    Ok((kind.new)(asked)?)
}

/// The kind of the method that is asked for. Refuses options that no scene can have: numbers beyond single precision,
/// in which methods compute, and options that exclude each other.
///
/// # Errors
/// [`Error::Refused`], and [`Error::CannotRender`] for names without a method.
pub(crate) fn check_options(own: &[MethodKind], options: &MethodRequest) -> Result<MethodKind, Error> {
    let name = options.name();
    for parameter in options.model().all() {
        let Some(value) = options.given(parameter.name).and_then(|v| v.number()) else { continue };
        let single = value as f32;
        if !single.is_finite() || (single == 0.0) != (value == 0.0) {
            let what =
                format!("option '{}={value:e}' of integrator '{name}' is beyond single precision", parameter.name);
            return Err(Refusal(what).into());
        }
    }
    let nothing = || Error::CannotRender { integrator: name.into(), what: "anything: it has no method".into() };
    let kind = kind(name).or_else(|| own.iter().find(|kind| kind.name == name)).ok_or_else(nothing)?;
    (kind.check)(options)?;
    Ok(*kind)
}

/// True for answers with which a feature is there.
fn keeps(support: Support) -> bool {
    matches!(support, Support::Exact | Support::Approximates(_))
}

/// Samples, layers and limits of a request.
fn plan(asked: &Asked<'_>, method: &dyn Method) -> Plan {
    let Asked { request, options, scene } = asked;
    let settings = scene.settings();
    let kind = match request.sampler {
        None => settings.sampler,
        Some(SamplerRequest::OfFile) => settings.named_sampler,
        Some(SamplerRequest::Row(row)) => SamplerKind::named(row.kind).unwrap_or(settings.sampler),
    };
    // Metropolis counts its own.
    let samples = options.given("samples").and_then(|v| v.number()).map(|n| n as u32);
    let spp = request.spp.or(samples).unwrap_or_else(|| method.default_spp(settings.spp));
    let has_bands = scene.film().bands.is_some() && keeps(method.supports(Feature::Bands));
    let bands = if has_bands { LayerInputs::BANDS } else { LayerInputs::NONE };
    Plan {
        sampler: Sampler { kind, spp, seed: asked.seed() },
        threads: request.threads,
        inputs: LayerInputs::of(&scene.film().with_layers(&request.layers)).with(bands),
        independent: request.independent,
        transparent: request.transparent,
        hide_emitters: asked.hides_emitters(),
        adaptive: request.adaptive,
        error: request.error,
    }
}
