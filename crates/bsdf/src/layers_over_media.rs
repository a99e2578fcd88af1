//! Light that enters a layered surface, and light that it reflects.

use crate::{
    Bsdf, Lobe, Microfacet, Pbr, Principled,
    TransportMode::Radiance,
    pbr::{Convention, PbrParams, plain},
    principled,
    subsurface::SubsurfacePart,
};
use steradian_math::{Spectrum, Vec2, Vec3, hash::HashRng};

const WHITE: SubsurfacePart = SubsurfacePart { weight: 1.0, color: Spectrum::ONE, is_followed: true, g: 0.0 };

/// The parts of light along a direction that enter and that leave at once, each lane.
fn shares(bsdf: &Bsdf<'_>, cos: f32, n: u32) -> [[f64; 4]; 2] {
    let mut rng = HashRng::new(11);
    let wo = Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
    let mut sums = [[0.0; 4]; 2];
    for _ in 0..n {
        let (u, u2) = (rng.next_f32(), Vec2::new(rng.next_f32(), rng.next_f32()));
        let Some(s) = bsdf.sample(wo, u, u2, Radiance) else { continue };
        let sum = &mut sums[usize::from(!s.lobe.contains(Lobe::SUBSURFACE))];
        sum.iter_mut().zip(s.weight.to_array()).for_each(|(sum, w)| *sum += f64::from(w) / f64::from(n));
    }
    sums
}

fn base(roughness: f32) -> PbrParams {
    let facets = |r: f32| Microfacet::ggx(r * r, r * r);
    PbrParams {
        base_color: Spectrum::ONE,
        facets: facets(roughness),
        transmission_color: Spectrum::ONE,
        thin: false,
        coat_facets: facets(0.2),
        coat_eta: 1.6,
        convention: Convention::OpenPbr,
        subsurface: WHITE,
        ..plain()
    }
}

/// Under a bare interface what enters and what is reflected are all of the light, as of a white diffuse base. Under a
/// coat and sheen they are no more than all, and no less than of that base, of which both directions pay for layers.
#[test]
fn what_enters_under_layers_is_what_a_white_base_gives_back() {
    for roughness in [0.0, 0.3, 0.8] {
        let bare = base(roughness);
        let coated = PbrParams { coat: 0.7, sheen_color: Spectrum::splat(0.6), ..bare };
        for (label, p) in [("bare", bare), ("coated", coated)] {
            let diffuse = PbrParams { subsurface: SubsurfacePart::NONE, ..p };
            for cos in [1.0, 0.5, 0.15] {
                let [entered, reflected] = shares(&Bsdf::Pbr(Pbr::new(&p)), cos, 20_000);
                let [none, white] = shares(&Bsdf::Pbr(Pbr::new(&diffuse)), cos, 20_000);
                let sum = entered[0] + reflected[0];
                assert!(none[0] == 0.0 && sum < 1.01 && sum > white[0] - 0.01, "{label} {roughness} {cos}: {sum}");
                assert!(label != "bare" || sum > 0.985, "{roughness} {cos}: {sum}, diffuse {}", white[0]);
            }
        }
    }
}

/// Half of a base enters, half is diffuse, and both are what a whole one is.
#[test]
fn shares_of_a_base_are_taken_from_it() {
    let half = PbrParams { subsurface: SubsurfacePart { weight: 0.5, ..WHITE }, transmission: 0.5, ..base(0.3) };
    let whole = PbrParams { transmission: 0.5, ..base(0.3) };
    let [[half, ..], _] = shares(&Bsdf::Pbr(Pbr::new(&half)), 0.7, 40_000);
    let [[whole, ..], _] = shares(&Bsdf::Pbr(Pbr::new(&whole)), 0.7, 40_000);
    assert!((half / whole - 0.5).abs() < 0.02, "{half} of {whole}");
}

/// The light that enters Disney's surface, whose lobes are added, is the part that they leave: together no more than
/// arrives.
#[test]
fn disneys_surface_gains_nothing_where_light_enters() {
    for roughness in [0.05, 0.5, 1.0] {
        for (clearcoat, sheen, spec_tint) in [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.5), (1.0, 1.0, 1.0)] {
            let params = principled::PrincipledParams {
                base_color: Spectrum::ONE,
                tint: Spectrum::ONE,
                roughness,
                clearcoat,
                clearcoat_gloss: 0.8,
                sheen,
                spec_tint,
                subsurface: WHITE,
                ..principled::plain()
            };
            let bsdf = Bsdf::Principled(Principled::new(&params));
            for cos in [1.0, 0.6, 0.3, 0.1] {
                let [entered, reflected] = shares(&bsdf, cos, 20_000);
                let sum = entered[0] + reflected[0];
                let what = format!("{roughness} {clearcoat} {sheen} {cos}: {entered:?} {reflected:?}");
                assert!(sum < 1.01 && sum > 0.8, "{what}");
                // What rough facets lose between them they lose here, too.
                assert!(cos < 0.5 || roughness > 0.5 || sum > 0.96, "{what}");
            }
        }
    }
}
