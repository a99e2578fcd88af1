//! Cases of the classical models and of the ways to build on facets, for the registry.

use super::{
    BlinnPhong, Bsdf, CompensatedConductor, Compensation, Conductor, CookTorrance, DiffuseCoupling, EnergyTable,
    Microfacet, Minnaert, NormalDistribution, OrenNayar, OrenNayarForm, Phong, Reflectance, Shadowing, ThinFilm, Ward,
    WardForm,
    registry::{Case, GREY, Visitor},
};
use steradian_math::{Spectrum, Vec3};

const WHITE: Spectrum = Spectrum::ONE;
const BLACK: Spectrum = Spectrum::ZERO;

pub(super) fn oren_nayar(visit: &mut Visitor<'_>) {
    use OrenNayarForm::{EnergyPreserving, Fujii, Full, Qualitative};
    let mut case = |label, reflectance, roughness, form, lossless| {
        visit(Case { label, bsdf: Bsdf::OrenNayar(OrenNayar::new(reflectance, roughness, form)), lossless });
    };
    case("qualitative, 0.3", GREY, 0.3, Qualitative, false);
    case("qualitative, white, 90°", WHITE, 10.0, Qualitative, false);
    case("full, 0.5", GREY, 0.5, Full, false);
    case("full, white, 90°", WHITE, 10.0, Full, false);
    case("Fujii, 0.7", GREY, 0.7, Fujii, false);
    case("Fujii, white, 1", WHITE, 1.0, Fujii, false);
    case("EON, coloured", GREY, 0.6, EnergyPreserving, false);
    case("EON, white, smooth", WHITE, 0.0, EnergyPreserving, true);
    case("EON, white, 0.5", WHITE, 0.5, EnergyPreserving, true);
    case("EON, white, 1", WHITE, 1.0, EnergyPreserving, true);
}

pub(super) fn minnaert(visit: &mut Visitor<'_>) {
    let mut case = |label, reflectance, k, lossless| {
        visit(Case { label, bsdf: Bsdf::Minnaert(Minnaert::new(reflectance, k)), lossless });
    };
    case("Lambert", WHITE, 1.0, true);
    case("dark limb", GREY, 1.7, false);
    case("velvet the wrong way", WHITE, 30.0, false);
}

pub(super) fn minnaert_bright_limb(visit: &mut Visitor<'_>) {
    let bsdf = Bsdf::Minnaert(Minnaert::new(WHITE, 0.5));
    visit(Case { label: "the full Moon", bsdf, lossless: false });
}

pub(super) fn phong(visit: &mut Visitor<'_>) {
    let mut case = |label, value| visit(Case { label, bsdf: Bsdf::Phong(value), lossless: false });
    case("exponent 0", Phong::modified(BLACK, WHITE, 0.0));
    case("exponent 30, Mitsuba's default", Phong::modified(Spectrum::splat(0.5), Spectrum::splat(0.2), 30.0));
    case("exponent 1000, coloured", Phong::modified(GREY, WHITE - GREY, 1000.0));
    case("too much of both", Phong::modified(WHITE, WHITE, 5.0));
    case("diffuse alone", Phong::modified(GREY, BLACK, 10.0));
}

pub(super) fn phong_empirical(visit: &mut Visitor<'_>) {
    let bsdf = Bsdf::Phong(Phong::empirical(GREY * 0.5, WHITE, 3.0));
    visit(Case { label: "exponent 3", bsdf, lossless: false });
}

pub(super) fn lafortune(visit: &mut Visitor<'_>) {
    let mut case = |label, coefficients, n| {
        let value = Phong::lafortune(GREY * 0.3, WHITE * 0.6, coefficients, n);
        visit(Case { label, bsdf: Bsdf::Phong(value), lossless: false });
    };
    case("leaning to grazing", Vec3::new(-1.0, -1.0, 0.6), 10.0);
    case("back where it came from", Vec3::ONE, 20.0);
    case("anisotropic", Vec3::new(-0.95, -0.5, 0.9), 15.0);
    case("none", Vec3::ZERO, 15.0);
}

pub(super) fn blinn_phong(visit: &mut Visitor<'_>) {
    let mut case = |label, value| visit(Case { label, bsdf: Bsdf::BlinnPhong(value), lossless: false });
    case("exponent 0", BlinnPhong::normalised(BLACK, WHITE, 0.0));
    case("exponent 2, white", BlinnPhong::normalised(BLACK, WHITE, 2.0));
    case("exponent 40, coloured", BlinnPhong::normalised(GREY, WHITE - GREY, 40.0));
    case("exponent 800", BlinnPhong::normalised(GREY * 0.2, WHITE * 0.5, 800.0));
}

pub(super) fn blinn_phong_empirical(visit: &mut Visitor<'_>) {
    let bsdf = Bsdf::BlinnPhong(BlinnPhong::empirical(GREY * 0.5, WHITE, 5.0));
    visit(Case { label: "exponent 5", bsdf, lossless: false });
}

pub(super) fn ward(visit: &mut Visitor<'_>) {
    use WardForm::Bounded;
    let mut case = |label, diffuse, specular, x, y, form| {
        visit(Case { label, bsdf: Bsdf::Ward(Ward::new(diffuse, specular, x, y, form)), lossless: false });
    };
    case("bounded, 0.1, Mitsuba's default", Spectrum::splat(0.5), Spectrum::splat(0.2), 0.1, 0.1, Bounded);
    case("bounded, anisotropic", GREY * 0.5, WHITE * 0.5, 0.3, 0.08, Bounded);
    case("bounded, 0.6", BLACK, WHITE, 0.6, 0.6, Bounded);
}

/// It loses light where the others gain, but its albedo grows with the root of the cosine beyond all bounds within a
/// tenth of a degree of the horizon.
pub(super) fn ward_original(visit: &mut Visitor<'_>) {
    let mut case = |label, diffuse, specular, x, y| {
        let bsdf = Bsdf::Ward(Ward::new(diffuse, specular, x, y, WardForm::Ward));
        visit(Case { label, bsdf, lossless: false });
    };
    case("0.2", BLACK, WHITE, 0.2, 0.2);
    case("anisotropic", GREY * 0.5, WHITE * 0.4, 0.1, 0.35);
}

pub(super) fn ward_duer(visit: &mut Visitor<'_>) {
    let bsdf = Bsdf::Ward(Ward::new(BLACK, WHITE, 0.2, 0.2, WardForm::Duer));
    visit(Case { label: "0.2", bsdf, lossless: false });
}

fn gold() -> (Spectrum, Spectrum) {
    (Spectrum::new([0.18, 0.42, 1.37, 0.37]), Spectrum::new([3.1, 2.35, 1.77, 2.82]))
}

pub(super) fn cook_torrance(visit: &mut Visitor<'_>) {
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

pub(super) fn kulla_conty(visit: &mut Visitor<'_>) {
    compensated(visit, Compensation::KullaConty);
}

pub(super) fn turquin(visit: &mut Visitor<'_>) {
    compensated(visit, Compensation::Turquin);
}
