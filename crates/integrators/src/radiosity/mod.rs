//! Radiosity: the light that Lambertian surfaces exchange, solved once for all cameras.
//!
//! Surfaces are cut into patches that are taken to be evenly bright (`surfaces`, `cells`, `patches`). Which part of the
//! light of one arrives at another is a form factor (`form_factor`, `factors`); the equation between them is solved by
//! iteration (`system`), elimination (`elimination`), shooting (`shooting`), over a hierarchy of patches (`hierarchy`)
//! or by rays without a matrix (`stochastic`). Where a scene has more pieces than patches are asked for, it is solved
//! for clusters of patches (`clusters`). What is kept is the irradiance (`solution`), so that textures stay sharp;
//! pictures are made of it by `view`.
//!
//! The solution is found before the session. A hit leads to its patch by primitive and parameters. The façade keeps
//! solutions in files, with a fingerprint of the scene without its cameras.

mod bands;
mod cells;
mod clusters;
mod direct;
mod elimination;
mod factors;
pub mod form_factor;
mod hierarchy;
mod matter;
mod patches;
pub mod polygon;
mod request;
mod saved;
mod shooting;
mod solution;
mod stochastic;
mod surfaces;
mod system;
#[cfg(test)]
mod tests;
mod vertices;
mod view;

pub use factors::FormFactors;
pub use request::RADIOSITY;
pub use saved::LoadError;
pub use solution::{Report, Solution};
pub use surfaces::Refusal;
pub use view::View;

use crate::Stop;
pub(crate) use bands::Bands;
use cells::Cells;
use clusters::Unknowns;
use factors::Exchange;
use patches::Patches;
use shooting::Shooting;
use solution::Light;
use std::sync::atomic::AtomicU64;
use steradian_core::Scene;
use surfaces::Surfaces;
use system::{Solved, System};

/// Solver of the radiosity equation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Jacobi iteration: all patches from the previous values.
    Jacobi,
    /// Each patch from the newest values.
    GaussSeidel,
    /// Elimination.
    Direct,
    /// Progressive shooting: from the brightest patch to all others, again and again.
    Shooting,
    /// Over links between patches of all sizes, which are made where they are needed.
    Hierarchical,
    /// Stochastic radiosity, by rays alone.
    Stochastic,
}

/// The methods by name.
pub const METHODS: &[(&str, Method)] = &[
    ("jacobi", Method::Jacobi),
    ("gauss-seidel", Method::GaussSeidel),
    ("direct", Method::Direct),
    ("shooting", Method::Shooting),
    ("hierarchical", Method::Hierarchical),
    ("stochastic", Method::Stochastic),
];

/// Settings of a solution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// The method.
    pub method: Method,
    /// Form factors; for the methods that have a matrix or rows of it.
    pub factors: FormFactors,
    /// Number of patches. Where there are more pieces of surface, those that are near each other and face the same way
    /// share one irradiance for each side, so that the equation has so many unknowns.
    pub patches: usize,
    /// Number of refinements: after each solution the patches that differ most from their neighbours are split; the
    /// first has a quarter of the patches then.
    pub adaptive: u32,
    /// The relative change, or the share of light unshot, at which iteration ends; of the hierarchy the share of all
    /// light that a link may carry.
    pub tolerance: f64,
    /// Rays of the stochastic method, for each patch.
    pub rays: u32,
    /// Bands of four wavelengths in spectral mode.
    pub bands: usize,
    /// Enables the ambient term: light that is not shot yet is shown as ambient light.
    pub ambient: bool,
    /// Most times that light is carried from patch to patch; `None` for any number. The methods `direct` and `shooting`
    /// have no order of bounces and refuse it; `gauss-seidel` becomes `jacobi`.
    pub bounces: Option<u32>,
    /// Chooses the random numbers.
    pub seed: u64,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            method: Method::GaussSeidel,
            factors: FormFactors::Analytic,
            patches: 2000,
            adaptive: 1,
            tolerance: 1e-4,
            rays: 1000,
            bands: 8,
            ambient: false,
            bounces: None,
            seed: 0,
        }
    }
}

/// Most iterations or, for each patch, shots.
const MOST_STEPS: usize = 10_000;
/// Most products of form factors and radiosities over all iterations, from a hundred iterations on: where no light is
/// lost the solution does not exist, and iterations would not end.
const MOST_PRODUCTS: usize = 2_000_000_000;
/// Most patches of the methods that keep a matrix: of 16 bytes for each pair that exchanges light, up to 2 GiB.
const MATRIX_LIMIT: usize = 12_000;
/// Most pieces of surface of the methods that have form factors: each side takes a kilobyte.
const PIECES_LIMIT: usize = 500_000;
/// Most patches of shooting, which makes a row of form factors for each shot.
const SHOOTING_LIMIT: usize = 100_000;

/// Shown while a scene is being solved, and asked whether to go on.
pub trait Watcher: Sync {
    /// A phase begins, of so many parts.
    fn begins(&self, phase: &'static str, parts: u64);
    /// Reports that `parts` more parts are done; false to stop.
    fn advances(&self, parts: u64) -> bool;
}

/// Nobody watches.
impl Watcher for () {
    fn begins(&self, _: &'static str, _: u64) {}

    fn advances(&self, _: u64) -> bool {
        true
    }
}

/// Stops where it is asked to.
impl Watcher for Stop {
    fn begins(&self, _: &'static str, _: u64) {}

    fn advances(&self, _: u64) -> bool {
        !self.is_asked()
    }
}

/// Tests if a scene can be solved with these settings.
///
/// # Errors
/// [`Refusal`]: why it cannot.
pub fn check(scene: &Scene, settings: &Settings) -> Result<(), Refusal> {
    let surfaces = Surfaces::new(scene)?;
    let method = match settings.method {
        Method::Direct => Some("direct"),
        Method::Shooting => Some("shooting"),
        _ => None,
    };
    // Methods without an order of bounces cannot stop at a limit.
    if let (Some(method), Some(limit)) = (method, settings.bounces) {
        return Err(Refusal::Bounces { method, limit });
    }
    // Bounds on memory and time, by method.
    let (pieces, count) = (surfaces.pieces.len(), settings.patches);
    if settings.method != Method::Stochastic {
        within("a matrix of form factors", pieces, PIECES_LIMIT)?;
    }
    match settings.method {
        Method::Hierarchical => within("hierarchical", pieces, hierarchy::LIMIT),
        Method::Shooting => within("shooting", count, SHOOTING_LIMIT),
        Method::Direct => within("direct", count, elimination::LIMIT),
        Method::Jacobi | Method::GaussSeidel => within("a matrix of form factors", count, MATRIX_LIMIT),
        Method::Stochastic => Ok(()),
    }
}

/// Kinds of shapes of the scene that cannot be cut into patches: they neither send nor receive light.
///
/// # Errors
/// [`Refusal`] for scenes that cannot be cut into patches at all.
pub fn not_cut(scene: &Scene) -> Result<Vec<&'static str>, Refusal> {
    Ok(Surfaces::new(scene)?.left_out)
}

/// Names of the materials that scatter otherwise than Lambert: of these only the Lambertian part exchanges light.
///
/// # Errors
/// [`Refusal`] for scenes that cannot be cut into patches.
pub fn beyond_lambert(scene: &Scene) -> Result<Vec<String>, Refusal> {
    let surfaces = Surfaces::new(scene)?;
    let patches = Patches::new(scene, &surfaces, &Cells::new(&surfaces), &Bands::new(scene.mode(), 1), &|_| true);
    Ok(patches.unwrap_or_default().impure.iter().map(|m| scene.material_names()[*m as usize].clone()).collect())
}

fn within(what: &'static str, count: usize, limit: usize) -> Result<(), Refusal> {
    match count > limit {
        true => Err(Refusal::TooManyPatches { what, count, limit, instead: "stochastic" }),
        false => Ok(()),
    }
}

/// Solves a scene; `None` where the watcher says to stop.
///
/// # Errors
/// [`Refusal`] for scenes that radiosity, or the method, cannot do.
pub fn solve(scene: &Scene, settings: &Settings, watcher: &dyn Watcher) -> Result<Option<Solution>, Refusal> {
    check(scene, settings)?;
    let surfaces = Surfaces::new(scene)?;
    let bands = Bands::new(scene.mode(), settings.bands);
    let tell = |parts: usize| watcher.advances(parts as u64);
    // One quadtree for each piece of surface.
    let mut cells = Cells::new(&surfaces);
    // More pieces than patches: clusters share their irradiance.
    let is_crowded = surfaces.pieces.len() > settings.patches;
    let is_adaptive = settings.adaptive > 0 && settings.method != Method::Hierarchical && !is_crowded;
    // Of the hierarchy's leaves some are made beforehand, for light that does not come over links.
    {
        let is_even = settings.method != Method::Hierarchical && !is_adaptive;
        let count = if is_even { settings.patches } else { settings.patches / 4 };
        // Large pieces beside many small ones are split too: clusters have members of all sizes.
        let count = if is_crowded && is_even { surfaces.pieces.len() + count } else { count };
        cells.split_to(&surfaces, count, surfaces.middle(scene), &tell);
    }
    let passes = if is_adaptive { settings.adaptive } else { 0 };
    // Solve, split where the solution varies most, and solve again.
    for pass in 0..=passes {
        let Some(solution) = solve_cells(scene, &surfaces, &cells, &bands, settings, watcher)? else { return Ok(None) };
        if pass == passes {
            return Ok(Some(solution));
        }
        // The number of patches grows evenly, by factors.
        let left = f64::from(passes - pass - 1) / f64::from(passes);
        let count = settings.patches as f64 * 0.25_f64.powf(left);
        cells.split_by(&surfaces, count as usize, &solution.needs(), &tell);
    }
    Ok(None)
}

fn solve_cells(
    scene: &Scene,
    surfaces: &Surfaces,
    cells: &Cells,
    bands: &Bands,
    settings: &Settings,
    watcher: &dyn Watcher,
) -> Result<Option<Solution>, Refusal> {
    watcher.begins("patches", 1);
    let tell = |parts: usize| watcher.advances(parts as u64);
    // Sides of leaves as patches, with materials, emission, and light from lights that are no patches.
    let patches = match settings.method {
        Method::Hierarchical => Some(Patches::default()),
        _ => Patches::new(scene, surfaces, cells, bands, &tell),
    };
    let Some(patches) = patches.filter(|_| tell(1)) else { return Ok(None) };
    let rays = AtomicU64::new(0);
    let seed = steradian_math::hash::mix64(settings.seed) as u32;
    let method = settings.factors;
    // All that form factors and rays are made from.
    let exchange = Exchange { scene, surfaces, cells, patches: &patches, method, seed, rays: &rays, tell: &tell };
    // Irradiances that patches exchange, by the method.
    let (cells, patches, exchanged, mut report) = match settings.method {
        // Hierarchy: cells are refined by the solver, and the patches are those of the final leaves.
        Method::Hierarchical => {
            watcher.begins("links", 0);
            let Settings { tolerance, patches, bounces, .. } = *settings;
            let wanted = hierarchy::Wanted { tolerance, patches, precision: 1e-6, bounces };
            let Some(refined) = hierarchy::solve(&exchange, bands, wanted) else { return Ok(None) };
            let Some(patches) = Patches::new(scene, surfaces, &refined.cells, bands, &tell) else { return Ok(None) };
            let exchanged = hierarchy::by_patch(&patches, &refined.irradiance);
            let report = Report { steps: refined.rounds, factors: refined.links, ..Report::default() };
            (refined.cells, patches, exchanged, report)
        }
        // Rays: no matrix; rays by the number of unknowns, in four runs.
        Method::Stochastic => {
            let Some(unknowns) = Unknowns::new(&exchange, settings.patches) else { return Ok(None) };
            let system = System::of(&patches);
            let count = u64::from(settings.rays) * unknowns.len() as u64;
            let shots = stochastic::Shots { rays: count.div_ceil(4), bounces: settings.bounces };
            watcher.begins("rays", 0);
            let Some(solved) = stochastic::solve(&system, &exchange, shots, 4) else {
                return Ok(None);
            };
            let report = Report { steps: solved.steps, clusters: unknowns.clusters(), ..Report::default() };
            let exchanged = unknowns.evened(solved.irradiance);
            (cells.clone(), patches, exchanged, report)
        }
        // Progressive shooting: one row of form factors for each shot.
        Method::Shooting => {
            let Some(unknowns) = Unknowns::new(&exchange, settings.patches) else { return Ok(None) };
            let system = unknowns.system();
            let mut shooting = Shooting::new(&system);
            watcher.begins("shots", 0);
            while shooting.shots < MOST_STEPS.max(100 * system.len()) {
                // The sum over all patches is not for every shot.
                if shooting.shots.is_multiple_of(16) && shooting.left(&system) <= settings.tolerance {
                    break;
                }
                if !tell(1) {
                    return Ok(None);
                }
                shooting.shoot(&system, |i| unknowns.row(i));
            }
            let solved = shooting.solved(&system, settings.ambient);
            let Solved { steps, residual, irradiance } = solved;
            let report = Report { steps, residual, clusters: unknowns.clusters(), ..Report::default() };
            let exchanged = unknowns.by_patch(irradiance);
            (cells.clone(), patches, exchanged, report)
        }
        // The whole matrix, then iteration or elimination.
        Method::Jacobi | Method::GaussSeidel | Method::Direct => {
            let Some(unknowns) = Unknowns::new(&exchange, settings.patches) else { return Ok(None) };
            watcher.begins("form factors", unknowns.len() as u64);
            let Some(rows) = unknowns.rows() else { return Ok(None) };
            let system = System { rows, ..unknowns.system() };
            let entries = system.rows.iter().map(Vec::len).sum::<usize>() * system.bands;
            // Iterations are bounded by the work that they are.
            let most = (MOST_PRODUCTS / entries.max(1)).clamp(100, MOST_STEPS);
            let solved = match settings.method {
                Method::Jacobi | Method::GaussSeidel if settings.bounces.is_some() => {
                    let most = settings.bounces.map_or(most, |bounces| most.min(bounces as usize));
                    Some(system.jacobi_from(unknowns.emission(), settings.tolerance, most, &tell))
                }
                Method::Jacobi => Some(system.jacobi(settings.tolerance, most, &tell)),
                Method::Direct => system.direct(&tell),
                _ => Some(system.gauss_seidel(settings.tolerance, most, &tell)),
            };
            // Iterations that were told to stop have come nowhere.
            let Some(Solved { irradiance, steps, residual, .. }) = solved else { return Ok(None) };
            let factors = system.rows.iter().map(Vec::len).sum();
            let report = Report { steps, residual, factors, clusters: unknowns.clusters(), ..Report::default() };
            let exchanged = unknowns.by_patch(irradiance);
            (cells.clone(), patches, exchanged, report)
        }
    };
    // Statistics; then the solution with what is looked up at hits.
    report.patches = patches.len();
    report.rays = rays.into_inner();
    report.impure = patches.impure.iter().map(|m| scene.material_names()[*m as usize].clone()).collect();
    report.left_out = surfaces.left_out.iter().map(|s| (*s).into()).collect();
    let light = Light::new(&patches, &exchanged);
    Ok(Solution::new(scene, surfaces.clone(), cells, bands.clone(), light, report, &tell))
}
