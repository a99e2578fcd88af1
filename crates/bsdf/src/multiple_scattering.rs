//! Light that facets of a metal reflect to each other: what single scattering loses given back.
//!
//! With `E(θ)` the albedo of a perfectly reflecting rough surface, `⟨E⟩` its mean over the cosine and `⟨F⟩` the mean
//! Fresnel factor:
//!
//! ```text
//! Kulla–Conty   f = f₁ + ⟨F⟩²⟨E⟩/(1 − ⟨F⟩(1 − ⟨E⟩)) · (1 − E(θ_o))(1 − E(θ_i))/(π(1 − ⟨E⟩))
//! Turquin       f = f₁ (1 + F₀ (1 − E(θ_o))/E(θ_o))
//! ```
//!
//! (Kulla & Conty 2017, "Revisiting physically based shading at Imageworks", after Kelemen & Szirmay-Kalos 2001; the
//! colour of repeated reflection by Hill 2018. Turquin 2019, "Practical multiple scattering compensation for microfacet
//! models".) The first is reciprocal; the second scales the lobe, keeps its shape, and is not. Both lose nothing where
//! the facets do not. What an anisotropic surface loses depends on the azimuth, which the tables do not know: it is
//! left as it is.

use super::{
    Bsdf, BsdfEval, BsdfSample, Conductor, Lobe, Microfacet, NormalDistribution, Reflectance, Shadowing, TransportMode,
    fresnel,
    microfacet::Mirror,
    registry::{Case, Model, Visitor, WHITE, gold},
    scatter::Scatter,
};
use std::{
    f32::consts::{FRAC_1_PI, TAU},
    sync::LazyLock,
};
use steradian_math::{Spectrum, Vec2, Vec3, cell, warp::cosine_hemisphere};

/// Energy compensation for multiple scattering between facets.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Compensation {
    /// A broad lobe beside the single scattering.
    KullaConty,
    /// A factor on the single scattering.
    Turquin,
}

const ANGLES: usize = 32;
const ROWS: usize = 48;
/// Facets per entry: a number of Fibonacci's, at which multiples of the golden ratio are spread most evenly.
const NORMALS: usize = 610;
/// Roughness of the last row.
const ROUGHEST: f32 = 2.0;

/// `E` of one roughness. The cells are even in `√cos`; in each `E` is linear in the cosine, as it is towards the
/// horizon: its value at zero and its slope.
type Row = [[f32; 2]; ANGLES - 1];

/// `E` over the square root of the cosine and the fourth root of the roughness, for one distribution and kind of
/// shadowing.
#[derive(Clone, Debug)]
pub struct EnergyTable {
    /// `E(θ)` of each roughness, and its mean.
    rows: Vec<(Row, f32)>,
}

impl EnergyTable {
    /// Integrates the table: deterministic, some 45 ms.
    pub fn new(distribution: NormalDistribution, shadowing: Shadowing) -> Self {
        let row = |j: usize| {
            let alpha = ROUGHEST * (j as f32 / (ROWS - 1) as f32).powi(4);
            let surface = Microfacet::new(distribution, shadowing, alpha, alpha);
            if surface.is_smooth() {
                return ([[1.0, 0.0]; ANGLES - 1], 1.0);
            }
            let cos = |i: usize| (i as f32 / (ANGLES - 1) as f32).powi(2);
            let albedo: [f32; ANGLES] = std::array::from_fn(|i| albedo(&surface, cos(i).max(1e-5)));
            let row: Row = std::array::from_fn(|i| {
                let slope = (albedo[i + 1] - albedo[i]) / (cos(i + 1) - cos(i));
                [albedo[i] - slope * cos(i), slope]
            });
            // 2∫ E μ dμ over pieces in √μ, by the midpoint.
            let pieces = 8 * (ANGLES - 1);
            let mean = (0..pieces)
                .map(|i| {
                    let x = (i as f32 + 0.5) / pieces as f32;
                    4.0 * at(&row, x * x) * x * x * x / pieces as f32
                })
                .sum::<f32>();
            (row, mean.min(1.0))
        };
        Self { rows: (0..ROWS).map(row).collect() }
    }

    /// The rows around a roughness and the weight of the second.
    fn place(alpha: f32) -> (usize, f32) {
        cell((alpha / ROUGHEST).clamp(0.0, 1.0).sqrt().sqrt() * (ROWS - 1) as f32, ROWS - 1)
    }

    /// `E(θ)`.
    #[inline]
    fn albedo(&self, (j, t): (usize, f32), cos: f32) -> f32 {
        let (a, b) = (at(&self.rows[j].0, cos), at(&self.rows[j + 1].0, cos));
        (a + (b - a) * t).clamp(1e-3, 1.0)
    }

    /// `⟨E⟩`.
    fn mean(&self, (j, t): (usize, f32)) -> f32 {
        let (a, b) = (self.rows[j].1, self.rows[j + 1].1);
        a + (b - a) * t
    }
}

/// `E` at a cosine.
#[inline(always)]
fn at(row: &Row, cos: f32) -> f32 {
    let [at_zero, slope] = row[cell(cos.sqrt() * (ANGLES - 1) as f32, ANGLES - 1).0];
    at_zero + slope * cos
}

/// The albedo of perfectly reflecting facets, over a lattice of the normals that are seen.
fn albedo(surface: &Microfacet, mu: f32) -> f32 {
    let wo = Vec3::new((1.0 - mu * mu).max(0.0).sqrt(), 0.0, mu);
    let sum: f64 = (0..NORMALS)
        .map(|i| {
            let i = i as f64 + 0.5;
            let u = Vec2::new((i * 0.618_033_988_749_894_9).fract() as f32, (i / NORMALS as f64) as f32);
            let m = surface.sample_visible(wo, u);
            let wi = fresnel::reflect(wo, m);
            if wi.z <= 0.0 { 0.0 } else { f64::from(surface.sampled_weight(wo, wi, m)) }
        })
        .sum();
    ((sum / NORMALS as f64) as f32).min(1.0)
}

/// Kulla and Conty's factor on what both directions lose, by the mean reflectance and `⟨E⟩`.
fn repeated(f: Spectrum, e: f32) -> Spectrum {
    f.map(|f| f * f * e / (1.0 - f * (1.0 - e)).max(1e-4)) / (1.0 - e).max(1e-6)
}

/// GGX under height-correlated shadowing, integrated when it is first asked for.
static GGX: LazyLock<EnergyTable> =
    LazyLock::new(|| EnergyTable::new(NormalDistribution::Ggx, Shadowing::HeightCorrelated));

/// Kulla and Conty's lobe alone, beside GGX facets of a metal that is seen from a direction.
///
/// Stretched facets lose as isotropic ones of the root of the mean of `α²`, but no more than those of the roughness
/// along the direction's azimuth lose, with what the first lose at normal incidence; and a part of the lobe is left out
/// that grows with the stretch. So they never reflect more than arrives.
#[derive(Clone, Copy, Debug)]
pub(super) struct BetweenFacets {
    alpha2: Vec2,
    place: (usize, f32),
    /// The part of the light along the view that white facets lose.
    pub lost: f32,
    /// Factor on what both directions lose.
    colour: Spectrum,
    mean: f32,
}

impl BetweenFacets {
    /// The lobe of facets whose reflectance has this mean over the cosine, times `weight`.
    pub fn new(facets: &Microfacet, reflectance: Spectrum, weight: f32, wo: Vec3) -> Self {
        let alpha2 = facets.alpha() * facets.alpha();
        let place = EnergyTable::place((0.5 * (alpha2.x + alpha2.y)).sqrt());
        let kept = 0.7 + 0.3 * (alpha2.min_element() / alpha2.max_element());
        let mean = GGX.mean(place);
        let lobe = Self { alpha2, place, lost: 0.0, colour: Spectrum::ZERO, mean };
        let lost = lobe.lost_along(wo);
        Self { lost, colour: repeated(reflectance, mean) * (kept * weight * lost), ..lobe }
    }

    fn lost_along(&self, w: Vec3) -> f32 {
        let lost = |place, cos| 1.0 - GGX.albedo(place, cos);
        let cos = w.z.min(1.0);
        let round = lost(self.place, cos);
        if self.alpha2.x == self.alpha2.y {
            return round;
        }
        let (x2, y2) = (w.x * w.x, w.y * w.y);
        let along = (self.alpha2.x * x2 + self.alpha2.y * y2) / (x2 + y2).max(1e-12);
        round.min(lost(EnergyTable::place(along.sqrt()), cos) + lost(self.place, 1.0))
    }

    /// The part of the light along the view that the lobe gives back, or a little more.
    #[inline]
    pub fn albedo(&self) -> Spectrum {
        self.colour * (1.0 - self.mean)
    }

    /// `f cosθ_i`.
    #[inline]
    pub fn value(&self, wi: Vec3) -> Spectrum {
        self.colour * (self.lost_along(wi) * wi.z * FRAC_1_PI)
    }

    /// The cosine about which the lobe falls off: what facets lose goes about as `(μ² + a²)^(−3/2)`.
    fn width(&self) -> f32 {
        (3.75 * (0.5 * (self.alpha2.x + self.alpha2.y)).sqrt()).min(4.0)
    }

    /// Draws a direction by `μ (μ² + a²)^(−3/2)`.
    pub fn draw(&self, u: Vec2) -> Vec3 {
        let a = self.width();
        let s = (1.0 + a * a).sqrt();
        let v = u.x / (s * (s + a));
        let cos = (a * (v * (2.0 - v)).sqrt() / (1.0 - v)).min(1.0);
        let (sin, (y, x)) = ((1.0 - cos * cos).sqrt(), (TAU * u.y).sin_cos());
        Vec3::new(sin * x, sin * y, cos)
    }

    /// The density of directions drawn so.
    pub fn pdf(&self, wi: Vec3) -> f32 {
        let a = self.width();
        let (s, far) = ((1.0 + a * a).sqrt(), wi.z * wi.z + a * a);
        a * s * (s + a) * wi.z / (far * far.sqrt() * TAU)
    }
}

/// A rough metal with light between its facets.
#[derive(Clone, Copy, Debug)]
pub struct CompensatedConductor<'a> {
    conductor: Conductor,
    table: &'a EnergyTable,
    row: (u32, f32),
    /// Kulla and Conty's colour factor over `1 − ⟨E⟩`, or `F₀`.
    colour: Spectrum,
    kind: Compensation,
}

impl<'a> CompensatedConductor<'a> {
    /// A metal whose facets have the table's distribution and shadowing.
    pub fn new(conductor: Conductor, kind: Compensation, table: &'a EnergyTable) -> Self {
        let place = EnergyTable::place(conductor.microfacet.isotropic_alpha().unwrap_or(0.0));
        let reflectance = Reflectance::Conductor { eta: conductor.eta, k: conductor.k };
        let colour = match kind {
            Compensation::KullaConty => {
                let e = table.mean(place);
                let f = (conductor.tint * reflectance.diffuse()).clamp(0.0, 1.0);
                repeated(f, e)
            }
            Compensation::Turquin => conductor.tint * reflectance.eval(1.0),
        };
        Self { conductor, table, row: (place.0 as u32, place.1), colour, kind }
    }

    fn lost(&self, cos: f32) -> f32 {
        1.0 - self.table.albedo((self.row.0 as usize, self.row.1), cos)
    }

    /// The value where facets lose `lost` of what they reflect along `wo`, with what mirrors.
    #[inline]
    fn eval_at(&self, wo: Vec3, wi: Vec3, lost: f32, mirror: &Mirror) -> BsdfEval {
        if wi.z <= 0.0 {
            return BsdfEval::ZERO;
        }
        let mut e = self.conductor.eval_by(mirror, wo, wi);
        match self.kind {
            Compensation::Turquin => e.value *= Spectrum::ONE + self.colour * (lost / (1.0 - lost)),
            Compensation::KullaConty => {
                let cosine = wi.z * FRAC_1_PI;
                e.value += self.colour * (lost * self.lost(wi.z) * cosine);
                e.pdf += (cosine - e.pdf) * lost;
            }
        }
        e
    }
}

impl Scatter for CompensatedConductor<'_> {
    const MODELS: &'static [Model] = &[
        Model::new("conductor-kulla-conty", "metal with light between facets", kulla_conty),
        Model::new("conductor-turquin", "metal scaled to conserve energy", turquin).not_reciprocal(),
    ];

    fn eval(&self, wo: Vec3, wi: Vec3, _: TransportMode) -> BsdfEval {
        if wo.z <= 0.0 || wi.z <= 0.0 || self.is_specular() {
            return BsdfEval::ZERO;
        }
        self.eval_at(wo, wi, self.lost(wo.z), &self.conductor.microfacet.mirror(wo, wi))
    }

    fn sample(&self, wo: Vec3, u: f32, u2: Vec2, _: TransportMode) -> Option<BsdfSample> {
        if wo.z <= 0.0 {
            return None;
        }
        if self.is_specular() {
            return self.conductor.sample(wo, 0.0, u2, TransportMode::Radiance);
        }
        // The broad lobe carries what single scattering loses, and is drawn with that probability.
        let lost = self.lost(wo.z);
        let (wi, mirror, lobe) = if self.kind == Compensation::KullaConty && u < lost {
            let wi = cosine_hemisphere(u2);
            (wi, self.conductor.microfacet.mirror(wo, wi), Lobe::DIFFUSE)
        } else {
            let n = self.conductor.microfacet.draw(wo, u2);
            (n.mirrored(wo), n.mirror(), Lobe::GLOSSY)
        };
        self.eval_at(wo, wi, lost, &mirror).drawn_above(wi, Lobe::REFLECTION.with(lobe))
    }

    fn albedo_estimate(&self, wo: Vec3) -> Spectrum {
        self.conductor.albedo_estimate(wo)
    }

    fn is_specular(&self) -> bool {
        self.conductor.microfacet.is_smooth()
    }

    fn is_reciprocal(&self) -> bool {
        self.kind == Compensation::KullaConty
    }
}

fn kulla_conty(visit: &mut Visitor<'_>) {
    compensated(visit, Compensation::KullaConty);
}

fn turquin(visit: &mut Visitor<'_>) {
    compensated(visit, Compensation::Turquin);
}

fn compensated(visit: &mut Visitor<'_>, kind: Compensation) {
    use NormalDistribution::{Beckmann, Ggx};
    use Shadowing::{HeightCorrelated, VGroove};
    let (eta, k) = gold();
    let mut case = |label, distribution, shadowing, (x, y), white, lossless| {
        let microfacet = Microfacet::new(distribution, shadowing, x, y);
        let metal = Conductor { eta, k, tint: WHITE, microfacet };
        let conductor = if white { Conductor::mirror(WHITE, microfacet) } else { metal };
        let table = EnergyTable::new(distribution, shadowing);
        let value = CompensatedConductor::new(conductor, kind, &table);
        visit(Case { label, bsdf: Bsdf::CompensatedConductor(value), lossless });
    };
    case("GGX gold, 0.5", Ggx, HeightCorrelated, (0.5, 0.5), false, false);
    case("GGX mirror, 0.3", Ggx, HeightCorrelated, (0.3, 0.3), true, false);
    case("GGX mirror, 1", Ggx, HeightCorrelated, (1.0, 1.0), true, false);
    case("Beckmann gold in V-grooves", Beckmann, VGroove, (0.4, 0.4), false, false);
    // Anisotropic metals are left as they are, so this one is reciprocal in Turquin's form too.
    if matches!(kind, Compensation::KullaConty) {
        case("Beckmann mirror, anisotropic", Beckmann, HeightCorrelated, (0.5, 0.15), true, false);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rough_metal_loses_light_to_its_facets_and_a_smooth_one_does_not() {
        let table = EnergyTable::new(NormalDistribution::Ggx, Shadowing::HeightCorrelated);
        let e = |alpha, cos| table.albedo(EnergyTable::place(alpha), cos);
        assert!(e(0.0, 0.5) > 0.999 && e(0.05, 0.9) > 0.99);
        // Kulla & Conty's figure: a third of the light is lost at α = 1.
        let rough = table.mean(EnergyTable::place(1.0));
        assert!((0.4..0.75).contains(&rough), "{rough}");
        for alpha in [0.3, 0.45, 0.77] {
            let surface = Microfacet::ggx(alpha, alpha);
            for cos in [0.02, 0.2, 0.55, 1.0] {
                let (exact, tabulated) = (albedo(&surface, cos), e(alpha, cos));
                assert!((exact - tabulated).abs() < 6e-3, "α = {alpha}, {cos}: {tabulated} is not {exact}");
            }
        }
    }
    /// Whatever the facets do, a compensated mirror reflects all, in the mean over its own samples.
    #[test]
    fn a_compensated_mirror_is_white() {
        use super::super::{Bsdf, TransportMode};
        use steradian_math::hash::HashRng;
        use steradian_testkit::Moments;
        for (distribution, shadowing) in
            [(NormalDistribution::Ggx, Shadowing::HeightCorrelated), (NormalDistribution::Beckmann, Shadowing::VGroove)]
        {
            let table = EnergyTable::new(distribution, shadowing);
            for (kind, cos) in
                [(Compensation::KullaConty, 0.35f32), (Compensation::Turquin, 0.35), (Compensation::KullaConty, 0.9)]
            {
                let mirror = Conductor::mirror(Spectrum::ONE, Microfacet::new(distribution, shadowing, 0.4, 0.4));
                let bsdf = Bsdf::CompensatedConductor(CompensatedConductor::new(mirror, kind, &table));
                let wo = Vec3::new(0.6 * (1.0 - cos * cos).sqrt(), 0.8 * (1.0 - cos * cos).sqrt(), cos);
                let (mut rng, mut albedo) = (HashRng::new(7), Moments::default());
                for _ in 0..20_000 {
                    let (u, u2) = (rng.next_f32(), Vec2::new(rng.next_f32(), rng.next_f32()));
                    let weight = bsdf.sample(wo, u, u2, TransportMode::Radiance).map_or(0.0, |s| s.weight[0]);
                    albedo.push(f64::from(weight));
                }
                let off = (albedo.mean() - 1.0).abs();
                assert!(
                    off < 4.0 * albedo.standard_error() + 4e-3,
                    "{shadowing:?}, {kind:?}, {cos}: {}",
                    albedo.mean()
                );
            }
        }
    }
}
