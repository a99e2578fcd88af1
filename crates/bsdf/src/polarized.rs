//! Polarised scattering: what a surface does to Stokes vectors, apart from the unpolarised path.
//!
//! Mirrors and facets of metals and glass polarise by Fresnel's equations at the facet that the light meets; the
//! unpolarised value is shared out by the Mueller matrix of that facet over its first element. All other models
//! depolarise: so do Mitsuba's diffuse, plastic and principled ones. The first element is always one, so the radiance
//! `S₀` of unpolarised light is that of unpolarised transport after one event, and differs after several by what
//! polarisation adds (two mirrors at Brewster's angle). Polarisers and retarders: [`super::filter`].

use super::{Bsdf, fresnel};
use steradian_math::{
    Frame, Spectrum, Vec3,
    polarization::{self, Complex, Mueller},
};

/// The Mueller matrix of scattering light from `wi` towards `wo` (in the shading frame `frame`, away from the surface),
/// relative to the unpolarised value, in the frames of [`polarization::basis`] of the directions of travel `−wi` and
/// `wo` in the world.
pub fn relative(bsdf: &Bsdf<'_>, frame: &Frame, wo: Vec3, wi: Vec3) -> Mueller {
    let depolarizer = Mueller::depolarizer(Spectrum::ONE);
    let reflects = wo.z * wi.z > 0.0;
    let interface = match bsdf {
        Bsdf::Conductor(c) if reflects => {
            let n: [Complex; 4] = std::array::from_fn(|l| Complex::new(f64::from(c.eta[l]), f64::from(c.k[l])));
            facet(wo, wi, 1.0).map(|h| (h, polarization::fresnel_reflection(f64::from(wo.dot(h).abs()), n)))
        }
        Bsdf::Dielectric(d) if (d.eta - 1.0).abs() >= 1e-4 => {
            let eta = if wi.z > 0.0 { d.eta } else { 1.0 / d.eta };
            if reflects {
                let n = [Complex::new(f64::from(eta), 0.0); 4];
                facet(wo, wi, 1.0).map(|h| (h, polarization::fresnel_reflection(f64::from(wi.dot(h).abs()), n)))
            } else {
                let t = |h: Vec3| polarization::fresnel_transmission(f64::from(wi.dot(h).abs()), f64::from(eta));
                facet(wo, wi, eta).map(|h| (h, t(h)))
            }
        }
        Bsdf::Filter(f) if !reflects => return f.relative(frame, wo),
        Bsdf::Dielectric(_) if !reflects => return through(frame, wo, wi),
        Bsdf::ThinDielectric(d) => {
            let single =
                fresnel::dielectric_amplitudes(wi.z.abs(), d.eta).map(|a| [a.s, a.p].map(|r| f64::from(r * r)));
            // All orders of inner reflection, for each polarisation by itself: R = 2r/(1 + r).
            let [s, p] = single.unwrap_or([1.0; 2]).map(|r| 2.0 * r / (1.0 + r));
            let part = |r: f64| Complex::new(if reflects { r } else { 1.0 - r }.max(0.0).sqrt(), 0.0);
            let m = Mueller::from_amplitudes([part(s); 4], [part(p); 4]);
            Some((Vec3::Z, m))
        }
        _ => None,
    };
    let Some((h, m)) = interface else { return depolarizer };
    let total = m.0[0][0];
    if total.max_element() <= 0.0 || !total.is_finite() {
        return depolarizer;
    }
    let [k_in, k_out, h] = [-wi, wo, h].map(|w| frame.to_world(w));
    // Perpendicular to the plane of incidence; at normal incidence any direction will do.
    let s = h.cross(k_out).try_normalize().unwrap_or_else(|| polarization::basis(k_out));
    let relative = m.scaled(Spectrum::ONE.safe_div(total));
    relative.in_bases(k_in, [s, polarization::basis(k_in)], k_out, [s, polarization::basis(k_out)])
}

/// Light that goes straight on keeps its polarisation.
fn through(frame: &Frame, wo: Vec3, wi: Vec3) -> Mueller {
    let [k_in, k_out] = [-wi, wo].map(|w| frame.to_world(w));
    let same = Mueller::change_basis(k_out, polarization::basis(k_in), polarization::basis(k_out));
    if k_in.dot(k_out) > 0.999 { same } else { Mueller::depolarizer(Spectrum::ONE) }
}

/// The normal of the facet that sends light from `wi` to `wo`, `eta` being the index on the side of `wo` over that of
/// `wi`.
fn facet(wo: Vec3, wi: Vec3, eta: f32) -> Option<Vec3> {
    (wo * eta + wi).try_normalize()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Conductor, Dielectric, Diffuse, Filter, Microfacet, TransportMode};
    use steradian_math::{Vec2, hash::HashRng};

    fn frames() -> [Frame; 2] {
        [Frame::from_z(Vec3::Z), Frame::from_zx(Vec3::new(0.48, -0.6, 0.64), Vec3::new(1.0, 2.0, 0.3))]
    }

    fn at(theta: f32) -> Vec3 {
        Vec3::new(theta.sin(), 0.0, theta.cos())
    }

    #[test]
    fn glass_at_brewsters_angle_polarises_across_the_plane_of_incidence() {
        let theta = 1.5f32.atan();
        let (wo, wi) = (at(theta), at(-theta));
        for microfacet in [Microfacet::SMOOTH, Microfacet::ggx(0.2, 0.2)] {
            let glass = Bsdf::Dielectric(Dielectric::new(1.5, microfacet));
            for frame in frames() {
                let s = relative(&glass, &frame, wo, wi).of_unpolarized(Spectrum::ONE);
                assert!((s.linear_degree()[0] - 1.0).abs() < 1e-4, "{s:?}");
                // Across the plane of incidence, which is y of the shading frame.
                let k = frame.to_world(wo);
                let across = Mueller::change_basis(k, polarization::basis(k), frame.y) * s;
                assert!((across.0[1][0] - 1.0).abs() < 1e-4, "{across:?}");
            }
        }
    }

    #[test]
    fn a_matt_surface_forgets_polarisation() {
        let b = Bsdf::Diffuse(Diffuse { reflectance: Spectrum::splat(0.5) });
        let m = relative(&b, &frames()[1], at(0.3), at(-1.0));
        assert_eq!(m, Mueller::depolarizer(Spectrum::ONE));
    }

    /// Whatever polarisation arrives: what leaves is never more polarised than light can be, and unpolarised light
    /// keeps its radiance.
    #[test]
    fn no_interface_makes_more_than_all_polarised() {
        let gold = Conductor {
            eta: Spectrum::new([0.18, 0.42, 1.37, 0.37]),
            k: Spectrum::new([3.1, 2.35, 1.77, 2.82]),
            tint: Spectrum::ONE,
            microfacet: Microfacet::ggx(0.3, 0.3),
        };
        let models = [
            Bsdf::Conductor(gold),
            Bsdf::Dielectric(Dielectric::new(1.5, Microfacet::SMOOTH)),
            Bsdf::Dielectric(Dielectric::new(1.5, Microfacet::ggx(0.3, 0.3))),
            Bsdf::ThinDielectric(super::super::ThinDielectric::new(1.5)),
            Bsdf::Filter(Filter::linear(20.0, Spectrum::ONE)),
            Bsdf::Filter(Filter::circular(true, Spectrum::ONE)),
            Bsdf::Filter(Filter::retarder(20.0, 70.0)),
        ];
        let mut rng = HashRng::new(8);
        for b in &models {
            for frame in frames() {
                for _ in 0..500 {
                    let mut unit =
                        || Vec3::new(rng.next_f32() - 0.5, rng.next_f32() - 0.5, rng.next_f32() - 0.5).normalize();
                    let (wo, state) = (unit(), unit());
                    let u2 = Vec2::new(rng.next_f32(), rng.next_f32());
                    let Some(s) = b.sample(wo, rng.next_f32(), u2, TransportMode::Radiance) else { continue };
                    let m = relative(b, &frame, wo, s.wi);
                    assert!((m.0[0][0] - Spectrum::ONE).to_array().iter().all(|v| v.abs() < 1e-4), "{m:?}");
                    let light = [1.0, state.x, state.y, state.z].map(Spectrum::splat);
                    let out = m * polarization::Stokes(light);
                    assert!(out.degree().max_element() <= 1.0 + 1e-3 && out.0[0].0.min_element() >= -1e-4, "{out:?}");
                }
            }
        }
    }
}
