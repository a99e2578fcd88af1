//! A dielectric coat over a Lambertian base: plastic, varnish, lacquer.
//!
//! Light that enters the coat reaches the base with probability `T(wo)`, is scattered diffusely, and each time leaves
//! or is thrown back with probability `K`. Summing all orders, with `T` by reciprocity for the way out,
//!
//! ```text
//! f = f_interface + T(wo)·T(wi)/(π η²) · ρ/(1 − ρK)
//! ```
//!
//! which is the expectation of pbrt-v4's random walk for `coateddiffuse` (Pharr et al. 2023, 14.3) and the model of
//! Mitsuba's `plastic` and `roughplastic`; [`CoatSeries`] says where the two differ. `T`, `K` and
//! the absorption in the coat come from a [`CoatTable`].
//!
//! Where it departs: pbrt-v4's *evaluation* of a rough coat (not its sampling) weighs its two strategies by densities
//! that are measured on different sides of the interface, so their weights do not add up to one and the value comes out
//! too high: by 0.2 to 1 % at roughness 0.01, 2 to 9 % at 0.1, 6 to 13 % above 0.3. This model is the walk's true
//! expectation. An anisotropic coat uses the tables of its mean roughness; its interface reflection is exact.

use super::{
    Bsdf, BsdfEval, BsdfSample, CoatSeries, CoatTable, Lobe, Microfacet, NormalDistribution, Shadowing, TransportMode,
    coat_table::RowPlace,
    fresnel,
    microfacet::Mirror,
    registry::{Case, GREY, Model, Visitor},
    scatter::Scatter,
};
use std::f32::consts::FRAC_1_PI;
use steradian_math::{Spectrum, Vec2, Vec3, warp::cosine_hemisphere};

/// A coated diffuse surface.
#[derive(Clone, Copy, Debug)]
pub struct Coated<'a> {
    table: &'a CoatTable,
    /// `ρ/(1 − ρK)/η²`.
    base: Spectrum,
    /// Factor on the light that the interface reflects.
    tint: Spectrum,
    microfacet: Microfacet,
    place: RowPlace,
    /// The part of diffuse light inside that leaves, times the largest lane of `base`; for choosing a lobe.
    base_weight: f32,
}

/// The coat as a direction sees it.
struct Seen {
    /// Reflectance of the interface, and transmission to the base.
    r: f32,
    t: f32,
    /// Sampling weights of the interface, and of interface and base together, in the brightest lanes.
    interface: f32,
    all: f32,
}

impl Seen {
    /// The probability of sampling the interface.
    #[inline(always)]
    fn chance(&self) -> f32 {
        if self.all > 0.0 { self.interface / self.all } else { 0.0 }
    }
}

impl<'a> Coated<'a> {
    /// A base of albedo `reflectance` (clamped to `[0, 1]`) under the coat of `table` with roughness `alpha_x`,
    /// `alpha_y`, which should lie in the table's range; `tint` is a factor on what the coat itself reflects (1 is
    /// physical).
    pub fn new(table: &'a CoatTable, reflectance: Spectrum, tint: Spectrum, alpha_x: f32, alpha_y: f32) -> Self {
        let microfacet = table.microfacet(alpha_x, alpha_y);
        let place = table.place(&microfacet);
        let eta2 = table.eta() * table.eta();
        let base = table.multiply_scattered(place, reflectance.clamp(0.0, 1.0)) / eta2;
        let base_weight = base.max_element() * table.mean_transmitted(place);
        Self { table, base, tint, microfacet, place, base_weight }
    }

    #[inline(always)]
    fn at(&self, wo: Vec3) -> Seen {
        let (r, t) = self.table.interface(self.place, wo.z);
        let interface = r * self.tint.max_element();
        Seen { r, t, interface, all: interface + t * self.base_weight }
    }

    /// Facet that mirrors one direction into another, unless the coat is smooth.
    #[inline(always)]
    fn mirror(&self, wo: Vec3, wi: Vec3) -> Option<Mirror> {
        (!self.microfacet.is_smooth()).then(|| self.microfacet.mirror(wo, wi))
    }

    /// The value for `wo` that is seen so.
    #[inline(always)]
    fn eval_at(&self, wo: Vec3, wi: Vec3, seen: &Seen, mirror: Option<Mirror>) -> BsdfEval {
        if wi.z <= 0.0 {
            return BsdfEval::ZERO;
        }
        let (_, t_i) = self.table.interface(self.place, wi.z);
        let (cosine, p) = (wi.z * FRAC_1_PI, seen.chance());
        let mut e = BsdfEval { value: self.base * (seen.t * t_i * cosine), pdf: (1.0 - p) * cosine };
        if let Some(mirror) = mirror
            && let Some(facet) = self.microfacet.reflecting_by(&mirror, wo, wi)
        {
            let f = fresnel::Crossing::by_square(mirror.cos2, self.table.eta()).reflectance;
            e.value += self.tint * (f * facet.value);
            e.pdf += p * facet.pdf;
        }
        e
    }
}

impl Scatter for Coated<'_> {
    const MODELS: &'static [Model] =
        &[Model::new("coated", "a dielectric coat over a diffuse base: plastic, varnish", cases)];

    fn eval(&self, wo: Vec3, wi: Vec3, _: TransportMode) -> BsdfEval {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return BsdfEval::ZERO;
        }
        self.eval_at(wo, wi, &self.at(wo), self.mirror(wo, wi))
    }

    fn sample(&self, wo: Vec3, u: f32, u2: Vec2, _: TransportMode) -> Option<BsdfSample> {
        if wo.z <= 0.0 {
            return None;
        }
        let seen = self.at(wo);
        let (wi, mirror, lobe) = if u * seen.all >= seen.interface {
            let wi = cosine_hemisphere(u2);
            (wi, self.mirror(wo, wi), Lobe::DIFFUSE)
        } else if self.microfacet.is_smooth() {
            let p = seen.chance();
            return Some(BsdfSample::mirrored(wo, self.tint * (seen.r / p), p));
        } else {
            let n = self.microfacet.draw(wo, u2);
            (n.mirrored(wo), Some(n.mirror()), Lobe::GLOSSY)
        };
        self.eval_at(wo, wi, &seen, mirror).drawn_above(wi, Lobe::REFLECTION.with(lobe))
    }

    fn albedo_estimate(&self, wo: Vec3) -> Spectrum {
        let (r, t) = self.table.interface(self.place, wo.z.abs());
        self.tint * r + self.base * (t * self.table.mean_transmitted(self.place))
    }
}

fn cases(visit: &mut Visitor<'_>) {
    use NormalDistribution::{Beckmann, Ggx};
    use Shadowing::{HeightCorrelated, Separable};
    let pbrt = CoatSeries::Layered { thickness: 0.01, max_depth: 10 };
    let exact = CoatSeries::Layered { thickness: 0.0, max_depth: u32::MAX };
    let mut case = |label, table: CoatTable, rho, alpha: (f32, f32), lossless| {
        let value = Coated::new(&table, rho, Spectrum::ONE, alpha.0, alpha.1);
        visit(Case { label, bsdf: Bsdf::Coated(value), lossless });
    };
    let smooth = (0.0, 0.0);
    case("smooth, absorbing", CoatTable::new(Ggx, HeightCorrelated, 1.5, smooth, pbrt), GREY, smooth, false);
    case("smooth over white", CoatTable::new(Ggx, HeightCorrelated, 1.5, smooth, exact), Spectrum::ONE, smooth, true);
    let plastic = |nonlinear| CoatSeries::Plastic { nonlinear };
    case("smooth plastic", CoatTable::new(Beckmann, Separable, 1.49, smooth, plastic(false)), GREY, smooth, false);
    case("nonlinear plastic", CoatTable::new(Beckmann, Separable, 1.49, smooth, plastic(true)), GREY, smooth, false);
    let rough = (0.3, 0.3);
    case("GGX, 0.3", CoatTable::new(Ggx, HeightCorrelated, 1.5, rough, pbrt), GREY, rough, false);
    case(
        "Beckmann, 0.1",
        CoatTable::new(Beckmann, Separable, 1.49, (0.1, 0.1), plastic(false)),
        GREY,
        (0.1, 0.1),
        false,
    );
    case(
        "GGX, textured roughness",
        CoatTable::new(Ggx, HeightCorrelated, 1.5, (0.0, 0.6), pbrt),
        GREY,
        (0.2, 0.2),
        false,
    );
    case("GGX, anisotropic", CoatTable::new(Ggx, HeightCorrelated, 1.5, (0.2, 0.2), pbrt), GREY, (0.1, 0.4), false);
    case("index 1", CoatTable::new(Ggx, HeightCorrelated, 1.0, smooth, exact), Spectrum::ONE, smooth, true);
}
