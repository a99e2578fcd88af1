//! A dielectric coat over a metal or a diffuse base, with a medium between them that absorbs and scatters: pbrt-v4's
//! layered materials (Guo, Hašan, Zhao 2018, "Position-Free Monte Carlo Simulation for Arbitrary Layered BSDFs"; Pharr
//! et al. 2023, 14.3).
//!
//! What the interface reflects has a closed form. The rest is the expectation of random walks that enter, go from layer
//! to layer or scatter in the medium (extinction one per unit of depth, albedo `a`, Henyey–Greenstein), and leave:
//!
//! ```text
//! f(wo, wi) = f_interface + E[ Σ β · (base or phase function towards the refracted wi) · T(wi) ]
//! ```
//!
//! Each evaluation estimates the expectation by `samples` walks whose random numbers are a hash of the two directions,
//! so that the value is a function of its arguments; it is noisy as a function, and right in the mean over directions.
//! Two ways to find the exit are weighted by the power heuristic: refracting `wi` in, and scattering towards the
//! interface and refracting out.
//!
//! Where it departs from pbrt-v4: both densities of that heuristic are measured inside the coat (pbrt compares one
//! inside with one outside, so its weights do not add up to one and rough coats come out too bright); the directions
//! that are sampled come from a closed-form density rather than from a walk, so that every sample has a density of its
//! own; and light that meets smooth layers only is added up exactly, not cut at `max_depth`.

use super::{
    Bsdf, BsdfEval, BsdfSample, Conductor, Diffuse, Lobe, Microfacet, NormalDistribution, Shadowing, TransportMode,
    fresnel,
    registry::{Case, GREY, Model, Visitor},
    sample_cosine_hemisphere,
    scatter::Scatter,
};
use std::f32::consts::FRAC_1_PI;
use steradian_math::{
    Spectrum, Vec2, Vec3,
    hash::{HashRng, combine64},
    warp,
};

/// Base under the coat.
#[derive(Clone, Copy, Debug)]
pub enum Base {
    /// A metal; its index relative to the coat's.
    Conductor(Conductor),
    /// A Lambertian surface.
    Diffuse(Diffuse),
}

/// The medium between coat and base, and how the walk is made.
#[derive(Clone, Copy, Debug)]
pub struct Walk {
    /// Optical depth of the coat at normal incidence (≥ 0).
    pub thickness: f32,
    /// Single-scattering albedo, in [0, 1].
    pub albedo: Spectrum,
    /// Mean cosine of the phase function, in (−1, 1).
    pub g: f32,
    /// Most events of a walk.
    pub max_depth: u16,
    /// Walks for each evaluation (≥ 1).
    pub samples: u16,
}

/// A coated surface.
#[derive(Clone, Copy, Debug)]
pub struct Layered {
    /// η and k of a metal, or the reflectance.
    base: [Spectrum; 2],
    albedo: Spectrum,
    coat: Microfacet,
    base_facets: Microfacet,
    eta: f32,
    thickness: f32,
    g: f32,
    max_depth: u16,
    samples: u16,
    is_metal: bool,
}

/// Probabilities of the ways to draw a direction; what is left to one is a cosine.
struct Chances {
    /// The interface's reflection, with that of smooth layers under it.
    reflect: f32,
    /// The metal's lobe, seen through the coat.
    lobe: f32,
}

impl Layered {
    /// The surface of a coat with index `eta` (> 0) and the facets `coat`, over `base`.
    pub fn new(eta: f32, coat: Microfacet, base: Base, walk: &Walk) -> Self {
        let (base, base_facets, is_metal) = match base {
            Base::Conductor(c) => ([c.eta, c.k], c.microfacet, true),
            Base::Diffuse(d) => ([d.reflectance, Spectrum::ZERO], Microfacet::SMOOTH, false),
        };
        let eta = if eta > 1e-3 { eta.min(1e3) } else { 1.0 };
        let is_matched = (eta - 1.0).abs() < 1e-4;
        Self {
            base,
            albedo: walk.albedo.clamp(0.0, 1.0),
            coat: if is_matched { Microfacet::SMOOTH } else { coat },
            base_facets,
            eta: if is_matched { 1.0 } else { eta },
            thickness: if walk.thickness > 0.0 { walk.thickness.min(1e4) } else { 0.0 },
            g: if walk.g.is_finite() { walk.g.clamp(-0.999, 0.999) } else { 0.0 },
            max_depth: walk.max_depth,
            samples: walk.samples.max(1),
            is_metal,
        }
    }

    fn scatters(&self) -> bool {
        self.thickness > 0.0 && self.albedo.max_element() > 0.0
    }

    fn base_is_smooth(&self) -> bool {
        self.is_metal && self.base_facets.is_smooth()
    }

    fn fresnel(&self, cos: f32) -> f32 {
        if self.eta == 1.0 { 0.0 } else { fresnel::dielectric(cos, self.eta) }
    }

    fn metal(&self) -> Conductor {
        Conductor { eta: self.base[0], k: self.base[1], tint: Spectrum::ONE, microfacet: self.base_facets }
    }

    /// Reflectance of smooth layers in the mirror direction: the interface's reflection and, over a smooth metal, all
    /// orders of reflection under it.
    fn mirrored(&self, wo: Vec3) -> Spectrum {
        let outside = self.fresnel(wo.z);
        let mut sum = Spectrum::splat(outside);
        if self.base_is_smooth()
            && let Some((inside, _)) = fresnel::refract(wo, Vec3::Z, self.eta)
        {
            let cos = inside.z.abs();
            let way = fresnel::conductor(cos, self.base[0], self.base[1]) * (-2.0 * self.thickness / cos).exp();
            let through = (1.0 - outside) * (1.0 - outside);
            sum += way.map(|w| through * w / (1.0 - w * outside).max(1e-6));
        }
        sum
    }

    fn chances(&self, wo: Vec3) -> Chances {
        let r = self.fresnel(wo.z);
        let below = (1.0 - r) * self.below_estimate();
        let mirror = if self.coat.is_smooth() { self.mirrored(wo).max_element() } else { r };
        if self.is_specular() {
            return Chances { reflect: 1.0, lobe: 0.0 };
        }
        // Over a smooth metal the light below a smooth coat is in the mirrored direction already; what is left, the
        // medium scattered.
        let below = if self.coat.is_smooth() && self.base_is_smooth() { 0.3 * below } else { below };
        let reflect = if mirror + below > 0.0 { (mirror / (mirror + below)).min(0.95) } else { 0.0 };
        let has_lobe = self.is_metal && !(self.coat.is_smooth() && self.base_is_smooth());
        let spread = if self.scatters() { 1.0 - (-2.0 * self.thickness).exp() * (1.0 - 0.25) } else { 0.2 };
        Chances { reflect, lobe: if has_lobe { (1.0 - reflect) * (1.0 - spread) } else { 0.0 } }
    }

    fn below_estimate(&self) -> f32 {
        let base = if self.is_metal {
            fresnel::conductor(1.0, self.base[0], self.base[1]).max_element()
        } else {
            self.base[0].max_element()
        };
        base.max(if self.scatters() { self.albedo.max_element() } else { 0.0 })
    }

    /// Facets like those the metal seems to have through the coat: each way through widens the lobe by the part of the
    /// coat's slopes that refraction keeps.
    fn seen_facets(&self) -> Microfacet {
        let bend = 0.5 * (1.0 - 1.0 / self.eta).abs().min(1.0);
        let widened = self.base_facets.mean_alpha().powi(2) + 2.0 * (bend * self.coat.mean_alpha()).powi(2);
        let alpha = (1.1 * widened.sqrt()).max(2e-3);
        Microfacet::new(NormalDistribution::Ggx, Shadowing::Separable, alpha, alpha)
    }

    /// Density of leaving along `wi` by the metal's lobe, seen through a flat interface.
    fn lobe_pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        let (Some((o, _)), Some((i, _))) =
            (fresnel::refract(wo, Vec3::Z, self.eta), fresnel::refract(wi, Vec3::Z, self.eta))
        else {
            return 0.0;
        };
        let Some(facet) = self.seen_facets().reflecting(-o, -i) else { return 0.0 };
        // Snell: η² cosθ' dω' = cosθ dω.
        facet.pdf * wi.z / (self.eta * self.eta * i.z.abs())
    }

    /// `f cosθ_i` of the light that entered the coat: the mean of `samples` walks.
    fn walk(&self, wo: Vec3, wi: Vec3) -> Spectrum {
        if self.is_specular() {
            return Spectrum::ZERO;
        }
        let seed = [wo.x, wo.y, wo.z, wi.x, wi.y, wi.z].iter().fold(0, |h, v| combine64(h, u64::from(v.to_bits())));
        let mut rng = HashRng::new(seed);
        let mut sum = Spectrum::ZERO;
        for _ in 0..self.samples {
            sum += self.walk_once(wo, wi, &mut rng);
        }
        sum / f32::from(self.samples)
    }

    /// A direction that crosses the interface from `w`, the weight, and the density (0 where the interface is smooth).
    fn cross(&self, w: Vec3, mode: TransportMode, rng: &mut HashRng) -> Option<(Vec3, f32, f32)> {
        if self.coat.is_smooth() {
            let (t, eta) = fresnel::refract(w, Vec3::Z, self.eta)?;
            return Some((t, (1.0 - self.fresnel(w.z)) * mode.compression(eta), 0.0));
        }
        let n = self.coat.draw(w, Vec2::new(rng.next_f32(), rng.next_f32()));
        let crossing = n.crossing(self.eta);
        let (t, eta) = n.refracted(w, &crossing)?;
        let facet = self.coat.refracting_drawn(&n, &crossing, w, t)?;
        Some((t, (1.0 - self.fresnel(facet.cos_o)) * mode.compression(eta) * facet.value / facet.pdf, facet.pdf))
    }

    /// `f cosθ` of crossing the interface from `w` inside to `wi` outside, and the density with which `cross` draws
    /// `−w`'s reverse from `wi`.
    fn leave(&self, w: Vec3, wi: Vec3) -> Option<(f32, f32)> {
        let eta = 1.0 / self.eta;
        let facet = self.coat.refracting(w, wi, eta)?;
        let back = self.coat.refracting(wi, w, self.eta)?;
        let through = 1.0 - self.fresnel(facet.cos_o);
        Some((through * facet.value * TransportMode::Radiance.compression(eta), back.pdf))
    }

    fn walk_once(&self, wo: Vec3, wi: Vec3, rng: &mut HashRng) -> Spectrum {
        let Some((mut w, entered, _)) = self.cross(wo, TransportMode::Radiance, rng) else { return Spectrum::ZERO };
        let Some((end, end_weight, end_pdf)) = self.cross(wi, TransportMode::Importance, rng) else {
            return Spectrum::ZERO;
        };
        // `end` is where light from `wi` goes inside; the weight carries cosθ_end, which is taken out, and cosθ_i is
        // put in.
        let end_weight = end_weight * wi.z / end.z.abs();
        let exit_is_smooth = self.coat.is_smooth();
        let medium = self.scatters();
        let pass = |depth: f32, w: Vec3| (-depth / w.z.abs()).exp();
        let metal = self.metal();
        let mut beta = Spectrum::splat(entered);
        let mut sum = Spectrum::ZERO;
        // Depth below the interface.
        let mut z = 0.0f32;
        for depth in 0..self.max_depth {
            if depth > 3 && beta.max_element() < 0.25 {
                let q = (1.0 - beta.max_element()).max(0.0);
                if rng.next_f32() < q {
                    break;
                }
                beta = beta / (1.0 - q);
            }
            if w.z == 0.0 {
                break;
            }
            if medium {
                let dz = -(1.0 - rng.next_f32()).ln() * w.z.abs();
                let to = if w.z < 0.0 { z + dz } else { z - dz };
                if to > 0.0 && to < self.thickness {
                    // Scattered in between.
                    let p = warp::hg_phase(w.dot(end), self.g);
                    let weight = if exit_is_smooth { 1.0 } else { heuristic(end_pdf, p) };
                    sum += beta * self.albedo * (p * weight * pass(to, end) * end_weight);
                    let u = Vec2::new(rng.next_f32(), rng.next_f32());
                    let (next, p) = warp::sample_hg(-w, self.g, u);
                    if next.z == 0.0 || p <= 0.0 {
                        break;
                    }
                    beta *= self.albedo;
                    w = next;
                    z = to;
                    if w.z > 0.0
                        && !exit_is_smooth
                        && let Some((f, back)) = self.leave(-w, wi)
                    {
                        sum += beta * (pass(z, w) * f * heuristic(p, back));
                    }
                    continue;
                }
                z = to.clamp(0.0, self.thickness);
            } else {
                z = if w.z < 0.0 { self.thickness } else { 0.0 };
                beta *= pass(self.thickness, w);
            }
            if w.z > 0.0 {
                // Thrown back by the interface.
                let inside = -w;
                if exit_is_smooth {
                    beta *= self.fresnel(inside.z);
                    w = Vec3::new(w.x, w.y, -w.z);
                } else {
                    let n = self.coat.draw(inside, Vec2::new(rng.next_f32(), rng.next_f32()));
                    let next = n.mirrored(inside);
                    let Some(facet) = self.coat.reflecting_by(&n.mirror(), inside, next) else { break };
                    beta *= self.fresnel(facet.cos_o) * facet.value / facet.pdf;
                    w = next;
                }
            } else {
                let up = -w;
                let u = Vec2::new(rng.next_f32(), rng.next_f32());
                let (towards_end, next) = if self.is_metal {
                    (metal.eval(up, -end, TransportMode::Radiance), metal.sample(up, 0.0, u, TransportMode::Radiance))
                } else {
                    let base = Diffuse { reflectance: self.base[0] };
                    (base.eval(up, -end, TransportMode::Radiance), base.sample(up, 0.0, u, TransportMode::Radiance))
                };
                if towards_end.pdf > 0.0 {
                    let weight = if exit_is_smooth { 1.0 } else { heuristic(end_pdf, towards_end.pdf) };
                    // The base's cosine is that of `end`, which `end_weight` has not.
                    sum += beta * towards_end.value * (weight * pass(self.thickness, end) * end_weight);
                }
                let Some(next) = next else { break };
                beta *= next.weight;
                w = next.wi;
                if !exit_is_smooth && let Some((f, back)) = self.leave(-w, wi) {
                    let weight = if next.lobe.is_specular() { 1.0 } else { heuristic(next.pdf, back) };
                    sum += beta * (pass(self.thickness, w) * f * weight);
                }
            }
            if beta.is_black() {
                break;
            }
        }
        if sum.is_finite() { sum } else { Spectrum::ZERO }
    }
}

impl Scatter for Layered {
    const MODELS: &'static [Model] =
        &[Model::new("layered", "a coat over a metal or a scattering medium, by random walks", cases)];

    fn eval(&self, wo: Vec3, wi: Vec3, _: TransportMode) -> BsdfEval {
        let pdf = self.pdf(wo, wi, TransportMode::Radiance);
        if pdf <= 0.0 || !pdf.is_finite() {
            return BsdfEval::ZERO;
        }
        let mut value = self.walk(wo, wi);
        if !self.coat.is_smooth()
            && let Some(facet) = self.coat.reflecting(wo, wi)
        {
            value += Spectrum::splat(self.fresnel(facet.cos_o) * facet.value);
        }
        BsdfEval { value, pdf }
    }

    fn sample(&self, wo: Vec3, u: f32, u2: Vec2, _: TransportMode) -> Option<BsdfSample> {
        if wo.z <= 0.0 {
            return None;
        }
        let c = self.chances(wo);
        let (wi, lobe) = if u < c.reflect {
            if self.coat.is_smooth() {
                return Some(BsdfSample::mirrored(wo, self.mirrored(wo) / c.reflect, c.reflect));
            }
            (self.coat.draw(wo, u2).mirrored(wo), Lobe::GLOSSY)
        } else if u < c.reflect + c.lobe {
            let (o, _) = fresnel::refract(wo, Vec3::Z, self.eta)?;
            let i = self.seen_facets().draw(-o, u2).mirrored(-o);
            if i.z <= 0.0 {
                return None;
            }
            (fresnel::refract(-i, Vec3::Z, self.eta)?.0, Lobe::GLOSSY)
        } else {
            (sample_cosine_hemisphere(u2)?, Lobe::DIFFUSE)
        };
        if wi.z <= 0.0 {
            return None;
        }
        let wi = wi.normalize();
        let e = self.eval(wo, wi, TransportMode::Radiance);
        e.drawn(wi, Lobe::REFLECTION.with(lobe), 1.0)
    }

    fn albedo_estimate(&self, wo: Vec3) -> Spectrum {
        let r = self.fresnel(wo.z.abs());
        let base = if self.is_metal { fresnel::conductor(1.0, self.base[0], self.base[1]) } else { self.base[0] };
        (Spectrum::splat(r) + base * (1.0 - r)).clamp(0.0, 1.0)
    }

    fn is_specular(&self) -> bool {
        self.coat.is_smooth() && self.base_is_smooth() && !self.scatters()
    }

    fn pdf(&self, wo: Vec3, wi: Vec3, _: TransportMode) -> f32 {
        if wo.z <= 0.0 || wi.z <= 0.0 || self.is_specular() {
            return 0.0;
        }
        let c = self.chances(wo);
        let mut pdf = (1.0 - c.reflect - c.lobe).max(0.0) * FRAC_1_PI * wi.z;
        if c.lobe > 0.0 {
            pdf += c.lobe * self.lobe_pdf(wo, wi);
        }
        if !self.coat.is_smooth()
            && let Some(facet) = self.coat.reflecting(wo, wi)
        {
            pdf += c.reflect * facet.pdf;
        }
        pdf
    }

    #[inline]
    fn is_stochastic(&self) -> bool {
        !self.is_specular()
    }
}

/// The power heuristic's weight of a sample with density `a`, which another way draws with density `b`.
#[inline]
fn heuristic(a: f32, b: f32) -> f32 {
    let r = b / a;
    1.0 / (1.0 + r * r)
}

fn cases(visit: &mut Visitor<'_>) {
    let gold = |microfacet| {
        let (eta, k) = (Spectrum::new([0.18, 0.42, 1.37, 0.37]), Spectrum::new([3.1, 2.35, 1.77, 2.82]));
        Base::Conductor(Conductor { eta: eta / 1.5, k: k / 1.5, tint: Spectrum::ONE, microfacet })
    };
    let clear = Walk { thickness: 0.01, albedo: Spectrum::ZERO, g: 0.0, max_depth: 10, samples: 1 };
    let milky = Walk { thickness: 0.5, albedo: Spectrum::new([0.9, 0.5, 0.2, 0.7]), g: 0.4, max_depth: 20, samples: 1 };
    let mut furnace = |label, eta, coat: f32, base, walk, lossless| {
        let bsdf = Bsdf::Layered(Layered::new(eta, Microfacet::ggx(coat, coat), base, walk));
        visit(Case { label, bsdf, lossless });
    };
    let white = Walk { albedo: Spectrum::ONE, g: 0.3, max_depth: 1000, ..milky };
    let snow = Base::Diffuse(Diffuse { reflectance: Spectrum::ONE });
    furnace("white on white", 1.4, 0.0, snow, &white, true);
    furnace("white on white, rough", 1.4, 0.4, snow, &white, false);
    let mut case = |label, eta, coat, base, walk| furnace(label, eta, coat, base, walk, false);
    case("smooth on smooth gold", 1.5, 0.0, gold(Microfacet::SMOOTH), &clear);
    case("smooth on rough gold", 1.5, 0.0, gold(Microfacet::ggx(0.3, 0.3)), &clear);
    case("rough on smooth gold", 1.5, 0.3, gold(Microfacet::SMOOTH), &clear);
    case("rough on rough gold", 1.5, 0.2, gold(Microfacet::ggx(0.4, 0.4)), &clear);
    case("milky on smooth gold", 1.5, 0.0, gold(Microfacet::SMOOTH), &milky);
    case("milky on rough gold", 1.5, 0.25, gold(Microfacet::ggx(0.3, 0.3)), &milky);
    case("milky on grey", 1.5, 0.0, Base::Diffuse(Diffuse { reflectance: GREY }), &milky);
    case("no interface", 1.0, 0.0, gold(Microfacet::ggx(0.3, 0.3)), &milky);
}

#[cfg(test)]
mod tests {
    use super::{
        super::{Bsdf, CoatSeries, CoatTable, Coated},
        *,
    };
    use steradian_testkit::{Moments, SphereGrid, normal_two_sided_p, sidak, z_test};

    fn at(cos: f32, phi: f32) -> Vec3 {
        let sin = (1.0 - cos * cos).sqrt();
        Vec3::new(sin * phi.cos(), sin * phi.sin(), cos)
    }

    /// The mean value near a pair of directions.
    fn mean(b: &Layered, wo: Vec3, wi: Vec3, seed: u64) -> Moments {
        let mut rng = HashRng::new(seed);
        let mut m = Moments::default();
        for _ in 0..6000 {
            let mut near = |w: Vec3| {
                let d = Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32()) - 0.5;
                (w + d * 1e-3).normalize()
            };
            let (o, i) = (near(wo), near(wi));
            m.push(f64::from(b.eval(o, i, TransportMode::Radiance).value[0] / i.z));
        }
        m
    }

    fn milk(base: Base, coat: f32) -> Layered {
        let walk = Walk { thickness: 0.8, albedo: Spectrum::splat(0.8), g: 0.5, max_depth: 50, samples: 1 };
        Layered::new(1.5, Microfacet::ggx(coat, coat), base, &walk)
    }

    #[test]
    fn walks_are_reciprocal_in_the_mean() {
        let metal = |alpha| {
            Base::Conductor(Conductor {
                eta: Spectrum::splat(0.3),
                k: Spectrum::splat(2.0),
                tint: Spectrum::ONE,
                microfacet: Microfacet::ggx(alpha, alpha),
            })
        };
        let diffuse = Base::Diffuse(Diffuse { reflectance: Spectrum::splat(0.7) });
        let cases = [
            milk(diffuse, 0.0),
            milk(diffuse, 0.3),
            milk(metal(0.4), 0.0),
            milk(metal(0.4), 0.3),
            milk(metal(0.0), 0.4),
        ];
        let pairs = [(at(0.9, 0.0), at(0.3, 2.0)), (at(0.5, 0.0), at(0.8, 3.0)), (at(0.25, 0.0), at(0.6, 0.4))];
        for (k, b) in cases.iter().enumerate() {
            for (wo, wi) in pairs {
                let (f, g) = (mean(b, wo, wi, k as u64), mean(b, wi, wo, 99 + k as u64));
                let z = (f.mean() - g.mean()) / f.standard_error().hypot(g.standard_error());
                let p = normal_two_sided_p(z);
                assert!(p > sidak(0.01, 15), "case {k} from {wo} to {wi}: {} and {}: z = {z}", f.mean(), g.mean());
            }
        }
    }

    #[test]
    fn over_a_diffuse_base_the_walk_has_the_closed_form_as_its_mean() {
        const BANDS: usize = 6;
        use NormalDistribution::Ggx;
        use Shadowing::HeightCorrelated;
        for alpha in [0.0, 0.4] {
            let (rho, walk) = (
                Spectrum::splat(0.8),
                Walk { thickness: 0.1, albedo: Spectrum::ZERO, g: 0.0, max_depth: 200, samples: 1 },
            );
            let series = CoatSeries::Layered { thickness: walk.thickness, max_depth: u32::from(walk.max_depth) };
            let table = CoatTable::new(Ggx, HeightCorrelated, 1.5, (alpha, alpha), series);
            let closed = Bsdf::Coated(Coated::new(&table, rho, Spectrum::ONE, alpha, alpha));
            let walked =
                Layered::new(1.5, Microfacet::ggx(alpha, alpha), Base::Diffuse(Diffuse { reflectance: rho }), &walk);
            let grid = SphereGrid { bands: 2 * BANDS, sectors: 1 };
            for cos in [0.9, 0.3f32] {
                let wo = at(cos, 0.0);
                let expected =
                    grid.integrate(|wi| f64::from(closed.eval(wo, wi, TransportMode::Radiance).value[0]), 1e-6);
                let mut rng = HashRng::new(u64::from(cos.to_bits()));
                let mut bands = [Moments::default(); BANDS];
                for _ in 0..60_000 {
                    let u = Vec2::new(rng.next_f32(), rng.next_f32());
                    let s =
                        walked.sample(wo, rng.next_f32(), u, TransportMode::Radiance).filter(|s| !s.lobe.is_specular());
                    for (i, m) in bands.iter_mut().enumerate() {
                        let here = s.filter(|s| ((s.wi.z * BANDS as f32) as usize).min(BANDS - 1) == i);
                        m.push(here.map_or(0.0, |s| f64::from(s.weight[0])));
                    }
                }
                for (i, m) in bands.iter().enumerate() {
                    let e = expected[BANDS + i];
                    let p = z_test(m, e, 4e-3 * e);
                    assert!(
                        p > sidak(0.01, 24),
                        "α {alpha}, cosθ {cos}, band {i}: {} ± {} not {e}",
                        m.mean(),
                        m.standard_error()
                    );
                }
            }
        }
    }

    #[test]
    fn smooth_layers_add_up_all_orders() {
        // R + T² r/(1 − r R) for a mirror of reflectance r under a clear coat without thickness.
        let walk = Walk { thickness: 0.0, albedo: Spectrum::ZERO, g: 0.0, max_depth: 10, samples: 1 };
        let silver = Conductor::from_reflectance(Spectrum::splat(0.9), Microfacet::SMOOTH);
        let b = Layered::new(1.5, Microfacet::SMOOTH, Base::Conductor(silver), &walk);
        let s = b.sample(Vec3::Z, 0.3, Vec2::new(0.5, 0.5), TransportMode::Radiance).expect("a mirror reflects");
        let expected = 0.04 + 0.96 * 0.96 * 0.9 / (1.0 - 0.9 * 0.04);
        assert!((s.weight[0] - expected).abs() < 1e-4 && b.is_specular(), "{} is not {expected}", s.weight[0]);
    }
}
