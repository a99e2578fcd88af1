//! Taking a picture of a stage, and holding it against theory.

use std::sync::Arc;
use steradian_core::{
    Scene,
    sampler::{Sampler, SamplerKind},
};
use steradian_engine::Asked;
use steradian_integrators::{
    Control, Depth, Film, METHODS, Method, PathEffort, Plan, Session, SharedPath, VarianceReduction, path::PathTracer,
};
use steradian_request::{MethodRequest, Request};

/// Settings of a picture.
#[derive(Clone, Copy)]
pub struct Shot {
    pub integrator: &'static str,
    pub spp: u32,
    pub max_depth: u32,
    pub roulette_after: u32,
    pub hide_emitters: bool,
    pub seed: u64,
    pub threads: usize,
    pub sampler: SamplerKind,
    /// Paths that share. Comparisons of means take pixels as independent, so it is one unless sharing itself is tested.
    pub reuse: u32,
    /// Enables photons for caustics; `None` where a trial tells.
    pub caustics: Option<bool>,
    /// Guiding by training.
    pub guiding: Option<bool>,
    /// Light samples and roulette of paths that share; `None` where trials tell, and which samples are the mean of
    /// several paths.
    pub effort: Option<PathEffort>,
    pub adaptive: bool,
    pub error: Option<f64>,
}

impl Shot {
    /// Paths of any length without Russian roulette for the first eight events, on one thread, with independent
    /// samples.
    pub fn of(integrator: &'static str, spp: u32) -> Self {
        Self {
            integrator,
            spp,
            max_depth: u32::MAX,
            roulette_after: 8,
            hide_emitters: false,
            seed: 1,
            threads: 1,
            sampler: SamplerKind::Independent,
            reuse: 1,
            caustics: Some(false),
            guiding: Some(false),
            effort: Some(PathEffort::default()),
            adaptive: false,
            error: None,
        }
    }

    pub fn depth(self, max_depth: u32) -> Self {
        Self { max_depth, ..self }
    }

    pub fn roulette_after(self, events: u32) -> Self {
        Self { roulette_after: events, ..self }
    }

    pub fn reuse(self, reuse: u32) -> Self {
        Self { reuse, ..self }
    }

    pub fn adaptive(self) -> Self {
        Self { adaptive: true, ..self }
    }

    pub fn seed(self, seed: u64) -> Self {
        Self { seed, ..self }
    }

    /// The method, with options `key=value,…` of its own.
    pub fn method(self, scene: &Scene, options: &str) -> Arc<dyn Method> {
        let depth =
            Depth { max: self.max_depth, roulette_after: self.roulette_after, hide_emitters: self.hide_emitters };
        let variance_reduction = VarianceReduction {
            reuse: Some(self.reuse),
            caustics: self.caustics,
            guiding: self.guiding,
            effort: self.effort,
        };
        match self.integrator {
            "path" => return Arc::new(SharedPath { path: PathTracer::<false> { depth }, variance_reduction }),
            "volpath" => return Arc::new(SharedPath { path: PathTracer::<true> { depth }, variance_reduction }),
            _ => {}
        }
        let model = MethodRequest::named(self.integrator).expect("a method").model();
        let of_paths =
            [("rr_depth", self.roulette_after.to_string()), ("hide_emitters", self.hide_emitters.to_string())];
        let of_paths = of_paths.into_iter().filter(|(name, _)| model.parameter(name).is_some());
        let of_paths: String = of_paths.map(|(name, value)| format!("{name}={value},")).collect();
        let options = MethodRequest::parse(&format!("{}:{of_paths}{options}", self.integrator)).expect("options");
        let request = Request { max_depth: Some(self.max_depth), ..Request::default() };
        let kind = METHODS.iter().find(|kind| kind.name == self.integrator).expect("a method");
        (kind.new)(&Asked { request: &request, options: &options, scene }).expect("a method for the scene")
    }

    /// The first limit of the method on a scene.
    pub fn limit(self, scene: &Scene) -> Option<String> {
        self.method(scene, "").limits(scene).into_iter().next().map(|limit| limit.what)
    }

    pub fn session(self, scene: &Scene) -> Box<dyn Session> {
        self.session_of(scene, &*self.method(scene, ""))
    }

    /// A session of another method with this plan.
    pub fn session_of(self, scene: &Scene, method: &dyn Method) -> Box<dyn Session> {
        let sampler = Sampler { kind: self.sampler, spp: self.spp, seed: self.seed };
        let (threads, adaptive, error) = (self.threads, self.adaptive, self.error);
        let plan = Plan { threads, adaptive, error, ..Plan::new(sampler) };
        method.session(Arc::new(scene.clone()), plan).expect("a session")
    }

    /// The finished film; every sample must have been finite.
    pub fn take(self, scene: &Scene) -> Film {
        let mut session = self.session(scene);
        session.step(u32::MAX, &Control::default());
        assert_eq!(session.counters().nonfinite, 0, "samples that are not finite");
        session.film()
    }
}

/// Significance of every statistical comparison: this many standard errors, estimated by the film itself.
pub const SIGMAS: f64 = 4.0;
/// Relative rounding error granted to sums of single-precision samples.
pub const ROUNDING: f64 = 2e-5;

/// A mean with the standard error of each component.
#[derive(Clone, Copy, Debug)]
pub struct Estimate {
    pub mean: [f64; 3],
    pub sigma: [f64; 3],
}

/// The mean over all pixels of a film.
pub fn mean(film: &Film) -> Estimate {
    let n = film.pixels.len() as f64;
    let (mut mean, mut variance) = ([0.0; 3], [0.0; 3]);
    for p in &film.pixels {
        let (m, v) = (p.mean(), p.variance_of_mean());
        for c in 0..3 {
            mean[c] += m[c] / n;
            variance[c] += v[c] / (n * n);
        }
    }
    Estimate { mean, sigma: variance.map(f64::sqrt) }
}

impl Estimate {
    pub fn times(self, k: f64) -> Self {
        Self { mean: self.mean.map(|v| v * k), sigma: self.sigma.map(|v| v * k.abs()) }
    }

    pub fn plus(self, o: Self) -> Self {
        Self {
            mean: std::array::from_fn(|c| self.mean[c] + o.mean[c]),
            sigma: std::array::from_fn(|c| self.sigma[c].hypot(o.sigma[c])),
        }
    }

    /// Passes if every component is within [`SIGMAS`] of `expected`, and the standard error is below `precision` of it:
    /// a comparison too noisy to find anything fails too.
    #[track_caller]
    pub fn is_near(self, what: &str, expected: [f64; 3], precision: f64) {
        for (c, e) in expected.into_iter().enumerate() {
            let (m, s) = (self.mean[c], self.sigma[c]);
            assert!(
                s <= precision * e.abs() + 1e-12,
                "{what}, component {c}: standard error {s:.3e} of {e:.6} tells nothing"
            );
            assert!(
                (m - e).abs() <= SIGMAS * s + ROUNDING * e.abs(),
                "{what}, component {c}: {m:.7} against {e:.7}, {:.1} standard errors of {s:.2e}",
                (m - e).abs() / s
            );
        }
    }

    #[track_caller]
    pub fn is_near_grey(self, what: &str, expected: f64, precision: f64) {
        self.is_near(what, [expected; 3], precision);
    }

    /// Passes if two independent estimates of one quantity agree within [`SIGMAS`] of their common standard error.
    #[track_caller]
    pub fn agrees(self, what: &str, other: Self, precision: f64) {
        let sigma = std::array::from_fn(|c| self.sigma[c].hypot(other.sigma[c]));
        Self { mean: self.mean, sigma }.is_near(what, other.mean, precision);
    }
}

/// Passes if every sample of every pixel is exactly (up to rounding) the expected radiance.
#[track_caller]
pub fn is_exactly(film: &Film, what: &str, expected: [f64; 3]) {
    for (i, p) in film.pixels.iter().enumerate() {
        let (m, v) = (p.mean(), p.variance_of_mean());
        for c in 0..3 {
            let tolerance = ROUNDING * expected[c].abs();
            assert!(
                (m[c] - expected[c]).abs() <= tolerance,
                "{what}, pixel {i}, component {c}: {} for {}",
                m[c],
                expected[c]
            );
            // Rounding is all the spread there is.
            assert!(v[c].sqrt() <= tolerance, "{what}, pixel {i}, component {c}: samples spread by {}", v[c].sqrt());
        }
    }
}

/// Passes if two films have the same bits.
#[track_caller]
pub fn same_bits(a: &Film, b: &Film, what: &str) {
    assert_eq!(a.crop, b.crop);
    for (i, (a, b)) in a.pixels.iter().zip(&b.pixels).enumerate() {
        let bits = |v: [f64; 3]| v.map(f64::to_bits);
        assert_eq!(a.samples, b.samples, "{what}, pixel {i}");
        assert_eq!(bits(a.sum), bits(b.sum), "{what}, pixel {i}: {:?} against {:?}", a.sum, b.sum);
        assert_eq!(bits(a.sum_squares), bits(b.sum_squares), "{what}, pixel {i}");
    }
}
