//! Cook & Torrance (1982): Lambertian reflection from the bulk and microfacets on top, with the diffuse part
//! independent of the angle or lessened by what the facets reflect.
//!
//! ```text
//! f = f_d + k_s F D G / (4 cosθ_o cosθ_i)
//! sum                   f_d = k_d/π                                                            with k_d + k_s ≤ 1
//! Ashikhmin & Shirley   f_d = 28/23π k_d (1 − k_s F₀)(1 − (1 − ½cosθ_o)⁵)(1 − (1 − ½cosθ_i)⁵)      2000, eq. 5
//! Fresnel               f_d = k_d/π (1 − k_s F(θ_o))(1 − k_s F(θ_i))/(1 − k_s ⟨F⟩)            Shirley et al. 1997
//! ```
//!
//! (The printed formula `F D G/(π cos cos)` gains energy with a normalised `D`: E3, E4.) All three are reciprocal. The
//! last loses nothing on a smooth white surface, for which it is derived; rough facets reflect less than a plane (by up
//! to a half at grazing angles), which is lost, and at angles between up to 0.0022 more, which the diffuse part must
//! leave them. `plastic` and `coated_diffuse` have the rough interface's own tables instead.

use super::{
    Bsdf, BsdfEval, BsdfSample, Lobe, Microfacet, NormalDistribution, Reflectance, Shadowing, ThinFilm, TransportMode,
    microfacet::Mirror,
    registry::{BLACK, Case, GREY, Model, Visitor, WHITE, gold},
    scatter::Scatter,
};
use std::f32::consts::FRAC_1_PI;
use steradian_math::{Spectrum, Vec2, Vec3, warp::cosine_hemisphere};

/// Coupling of the diffuse part to the reflecting facets.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum DiffuseCoupling {
    /// Not at all: a sum.
    Sum,
    /// As Ashikhmin and Shirley have it.
    AshikhminShirley,
    /// By Fresnel's factor of both directions.
    Fresnel,
}

/// Factor on the diffuse part under rough facets, so that no energy is gained where these reflect more than a plane:
/// the excess over white, for indices from 1.3 to 2.2 and all roughnesses, is 0.0022 at most.
const LEFT_BY_ROUGH_FACETS: f32 = 0.997;

/// Facets over a diffuse bulk.
#[derive(Clone, Copy, Debug)]
pub struct CookTorrance {
    /// `k_d`, with what of its coupling depends on no direction.
    diffuse: Spectrum,
    specular: Spectrum,
    reflectance: Reflectance,
    microfacet: Microfacet,
    coupling: DiffuseCoupling,
}

impl CookTorrance {
    /// `k_d` and `k_s`, each held in `[0, 1]`; in a plain sum both are scaled down where they exceed one together.
    pub fn new(
        diffuse: Spectrum,
        specular: Spectrum,
        reflectance: Reflectance,
        microfacet: Microfacet,
        coupling: DiffuseCoupling,
    ) -> Self {
        let (mut diffuse, mut specular) = (diffuse.clamp(0.0, 1.0), specular.clamp(0.0, 1.0));
        match coupling {
            _ if diffuse.is_black() => {}
            DiffuseCoupling::Sum => {
                let over = (diffuse + specular).map(|sum| 1.0 / sum.max(1.0));
                (diffuse, specular) = (diffuse * over, specular * over);
            }
            DiffuseCoupling::AshikhminShirley => {
                diffuse = diffuse * (Spectrum::ONE - specular * reflectance.eval(1.0)) * (28.0 / 23.0);
            }
            DiffuseCoupling::Fresnel => {
                let left = (Spectrum::ONE - specular * reflectance.diffuse()).max(1e-3);
                let kept = if microfacet.is_smooth() { 1.0 } else { LEFT_BY_ROUGH_FACETS };
                diffuse = diffuse.safe_div(left) * kept;
            }
        }
        Self { diffuse, specular, reflectance, microfacet, coupling }
    }

    /// A metal or mirror without a diffuse part.
    pub fn specular(specular: Spectrum, reflectance: Reflectance, microfacet: Microfacet) -> Self {
        Self::new(Spectrum::ZERO, specular, reflectance, microfacet, DiffuseCoupling::Sum)
    }

    /// `π f_d`.
    fn diffuse(&self, wo: Vec3, wi: Vec3) -> Spectrum {
        match self.coupling {
            DiffuseCoupling::Sum => self.diffuse,
            DiffuseCoupling::AshikhminShirley => {
                let of = |cos: f32| 1.0 - (1.0 - 0.5 * cos).powi(5);
                self.diffuse * (of(wo.z) * of(wi.z))
            }
            DiffuseCoupling::Fresnel => {
                let of = |cos: f32| Spectrum::ONE - self.specular * self.reflectance.eval(cos);
                self.diffuse * of(wo.z) * of(wi.z)
            }
        }
    }

    /// The probability of sampling the facets.
    fn glossy(&self, wo: Vec3) -> f32 {
        let s = (self.specular * self.reflectance.eval(wo.z)).max_element();
        let d = self.diffuse.max_element().min(1.0);
        match (s > 0.0, d > 0.0) {
            (true, true) => (s / (s + d)).clamp(0.1, 0.9),
            (true, false) => 1.0,
            _ => 0.0,
        }
    }

    /// The value where facets are sampled with probability `glossy`, with what mirrors.
    #[inline]
    fn eval_at(&self, wo: Vec3, wi: Vec3, glossy: f32, mirror: &Mirror) -> BsdfEval {
        if wi.z <= 0.0 {
            return BsdfEval::ZERO;
        }
        let cosine = wi.z * FRAC_1_PI;
        let mut e = BsdfEval::ZERO;
        if glossy < 1.0 {
            e = BsdfEval { value: self.diffuse(wo, wi) * cosine, pdf: (1.0 - glossy) * cosine };
        }
        if glossy > 0.0
            && !self.microfacet.is_smooth()
            && let Some(facet) = self.microfacet.reflecting_by(mirror, wo, wi)
        {
            e.value += self.specular * self.reflectance.eval(facet.cos_o) * facet.value;
            e.pdf += glossy * facet.pdf;
        }
        e
    }
}

impl Scatter for CookTorrance {
    const MODELS: &'static [Model] = &[Model::new("cook-torrance", "facets over a diffuse bulk", cases)];

    fn eval(&self, wo: Vec3, wi: Vec3, _: TransportMode) -> BsdfEval {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return BsdfEval::ZERO;
        }
        self.eval_at(wo, wi, self.glossy(wo), &self.microfacet.mirror(wo, wi))
    }

    fn sample(&self, wo: Vec3, u: f32, u2: Vec2, _: TransportMode) -> Option<BsdfSample> {
        if wo.z <= 0.0 {
            return None;
        }
        let glossy = self.glossy(wo);
        let (wi, mirror, lobe) = if u >= glossy {
            let wi = cosine_hemisphere(u2);
            (wi, self.microfacet.mirror(wo, wi), Lobe::DIFFUSE)
        } else if self.microfacet.is_smooth() {
            return Some(BsdfSample::mirrored(wo, self.specular * self.reflectance.eval(wo.z) / glossy, glossy));
        } else {
            let n = self.microfacet.draw(wo, u2);
            (n.mirrored(wo), n.mirror(), Lobe::GLOSSY)
        };
        self.eval_at(wo, wi, glossy, &mirror).drawn_above(wi, Lobe::REFLECTION.with(lobe))
    }

    fn albedo_estimate(&self, wo: Vec3) -> Spectrum {
        let specular = self.specular * self.reflectance.eval(wo.z);
        let diffuse = match self.coupling {
            DiffuseCoupling::Fresnel => self.diffuse * (Spectrum::ONE - specular),
            _ => self.diffuse,
        };
        (diffuse + specular).clamp(0.0, 1.0)
    }

    fn is_specular(&self) -> bool {
        self.microfacet.is_smooth() && self.diffuse.is_black()
    }
}

fn cases(visit: &mut Visitor<'_>) {
    use DiffuseCoupling::{AshikhminShirley, Fresnel, Sum};
    use NormalDistribution::{Beckmann, Gaussian};
    let mut case =
        |label, value: CookTorrance, lossless| visit(Case { label, bsdf: Bsdf::CookTorrance(value), lossless });
    let (eta, k) = gold();
    let v_grooves = |d, alpha| Microfacet::new(d, Shadowing::VGroove, alpha, alpha);
    let plain =
        |diffuse, reflectance, microfacet| CookTorrance::new(diffuse, WHITE - diffuse, reflectance, microfacet, Sum);
    let metal = Reflectance::Conductor { eta, k };
    case("Beckmann in V-grooves", plain(GREY, metal, v_grooves(Beckmann, 0.3)), false);
    case("Gaussian in V-grooves", plain(GREY * 0.5, Reflectance::LargeK { eta, k }, v_grooves(Gaussian, 0.2)), false);
    let schlick = Reflectance::Schlick { f0: GREY * 0.1, f90: GREY };
    case("Schlick to F₉₀", plain(GREY, schlick, Microfacet::ggx(0.4, 0.2)), false);
    case("smooth", plain(GREY, Reflectance::Dielectric(1.5), Microfacet::SMOOTH), false);
    let coupled = |diffuse, microfacet, coupling| {
        CookTorrance::new(diffuse, WHITE, Reflectance::Dielectric(1.5), microfacet, coupling)
    };
    case("Ashikhmin–Shirley, white", coupled(WHITE, Microfacet::ggx(0.1, 0.3), AshikhminShirley), false);
    case("Fresnel, white and smooth", coupled(WHITE, Microfacet::SMOOTH, Fresnel), true);
    case("Fresnel, rough", coupled(GREY, Microfacet::ggx(0.3, 0.3), Fresnel), false);
    let film = |thickness| Reflectance::ThinFilm { film: ThinFilm::new(1.4, thickness, None), eta, k };
    case("a film on gold", CookTorrance::specular(WHITE, film(300.0), Microfacet::ggx(0.2, 0.2)), false);
    case("a film on a smooth metal", CookTorrance::specular(WHITE, film(500.0), Microfacet::SMOOTH), false);
    let soap = Reflectance::ThinFilm {
        film: ThinFilm::new(1.33, 400.0, Some([450.0, 550.0, 600.0, 650.0])),
        eta: Spectrum::splat(1.5),
        k: BLACK,
    };
    case(
        "a film on glass over a diffuse bulk",
        CookTorrance::new(GREY, WHITE, soap, Microfacet::ggx(0.1, 0.1), Fresnel),
        false,
    );
}

#[cfg(test)]
mod tests {
    use super::{
        super::{NormalDistribution::Beckmann, Shadowing::VGroove},
        *,
    };
    use steradian_testkit::integrate_sphere;

    /// The albedo of perfect mirrors as facets (Beckmann's, in V-grooves) against a quadrature over half vectors in
    /// double precision (M90).
    #[test]
    fn the_directional_albedo_has_its_tabulated_values() {
        let table =
            [(0.2, [0.99998, 0.99885, 0.96559, 0.92752, 0.95976]), (0.5, [0.89242, 0.87504, 0.88688, 0.93437, 0.9772])];
        let white = Reflectance::Schlick { f0: Spectrum::ONE, f90: Spectrum::ONE };
        for (m, albedos) in table {
            let facets = CookTorrance::specular(Spectrum::ONE, white, Microfacet::new(Beckmann, VGroove, m, m));
            for (degrees, albedo) in [0.0f32, 30.0, 60.0, 75.0, 85.0].into_iter().zip(albedos) {
                let (sin, cos) = degrees.to_radians().sin_cos();
                let wo = Vec3::new(sin, 0.0, cos);
                let seen =
                    integrate_sphere(|wi| f64::from(facets.eval(wo, wi, TransportMode::Radiance).value[0]), 1e-4);
                assert!((seen - albedo).abs() < 5e-4, "m = {m}, {degrees}°: {seen} is not {albedo}");
            }
        }
    }

    /// Whatever the diffuse part leaves to white facets, no more light comes back than there was, and as much the other
    /// way (M100).
    #[test]
    fn a_diffuse_part_by_fresnels_factor_gains_nothing() {
        use DiffuseCoupling::{AshikhminShirley, Fresnel, Sum};
        for coupling in [Sum, AshikhminShirley, Fresnel] {
            let glass = Reflectance::Dielectric(1.5);
            let facets = Microfacet::new(Beckmann, VGroove, 0.2, 0.2);
            let plastic = CookTorrance::new(Spectrum::ONE, Spectrum::ONE, glass, facets, coupling);
            let direction = |degrees: f32, phi: f32| {
                let (sin, cos) = degrees.to_radians().sin_cos();
                Vec3::new(sin * phi.cos(), sin * phi.sin(), cos)
            };
            for degrees in [0.0f32, 40.0, 80.0] {
                let wo = direction(degrees, 0.0);
                let albedo =
                    integrate_sphere(|wi| f64::from(plastic.eval(wo, wi, TransportMode::Radiance).value[0]), 1e-4);
                assert!(albedo < 1.0 + 1e-4 && albedo > 0.3, "{coupling:?}, {degrees}°: {albedo}");
                let wi = direction(65.0, 2.0);
                let (there, back) = (
                    plastic.eval(wo, wi, TransportMode::Radiance).value[0] / wi.z,
                    plastic.eval(wi, wo, TransportMode::Radiance).value[0] / wo.z,
                );
                assert!((there - back).abs() < 1e-5 * there, "{coupling:?}, {degrees}°: {there}, {back}");
            }
        }
    }
}
