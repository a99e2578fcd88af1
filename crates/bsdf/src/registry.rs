//! Every scattering model, with cases at the corners of its parameters. Registering a model here is what gets it
//! tested.

use super::{
    Bsdf, CoatSeries, CoatTable, Coated, Conductor, Dielectric, Diffuse, DiffuseTransmission, Hair, Layered, Measured,
    Microfacet, NormalDistribution, Pbr, Principled, PrincipledThin, Shadowing, Tail, ThinDielectric, ThinFilm,
    classical,
    hair::Offset,
    layered::{Base, Walk},
    measured,
    pbr::PbrParams,
    principled::PrincipledParams,
};
use steradian_math::{
    Spectrum, Vec2,
    spectra::{ColorMode, Wavelengths},
};

/// One family of BSDFs.
pub struct Model {
    /// Its name.
    pub name: &'static str,
    /// What it is, in a sentence.
    pub doc: &'static str,
    /// Hands each test case to the visitor.
    pub cases: fn(&mut Visitor<'_>),
}

/// A value of a model that the laws of scattering are checked on.
pub struct Case<'a> {
    /// What is special about it.
    pub label: &'static str,
    /// The value.
    pub bsdf: Bsdf<'a>,
    /// Whether it neither absorbs nor loses light, so that it is invisible in a white furnace.
    pub lossless: bool,
}

/// What is done with each case.
pub type Visitor<'v> = dyn FnMut(Case<'_>) + 'v;

/// All models.
pub const MODELS: &[Model] = &[
    Model { name: "diffuse", doc: "Lambertian reflection", cases: diffuse },
    Model { name: "diffuse-transmission", doc: "Lambertian reflection and transmission", cases: diffuse_transmission },
    Model { name: "conductor", doc: "metals and mirrors, smooth or rough", cases: conductor },
    Model { name: "dielectric", doc: "glass and liquids, smooth or rough", cases: dielectric },
    Model { name: "thin-dielectric", doc: "a thin pane of glass", cases: thin_dielectric },
    Model { name: "coated", doc: "a dielectric coat over a diffuse base: plastic, varnish", cases: coated },
    Model { name: "oren-nayar", doc: "rough diffuse reflection", cases: classical::oren_nayar },
    Model { name: "minnaert", doc: "diffuse reflection with a darkened limb", cases: classical::minnaert },
    Model { name: "minnaert-bright-limb", doc: "Minnaert below k = 1", cases: classical::minnaert_bright_limb },
    Model { name: "phong", doc: "normalised cosine lobe around the mirror direction", cases: classical::phong },
    Model { name: "phong-empirical", doc: "Phong of 1975", cases: classical::phong_empirical },
    Model { name: "lafortune", doc: "cosine lobe around a transformed direction", cases: classical::lafortune },
    Model { name: "blinn-phong", doc: "normalised cosine lobe in the half vector", cases: classical::blinn_phong },
    Model { name: "blinn-phong-empirical", doc: "without normalisation", cases: classical::blinn_phong_empirical },
    Model { name: "ward", doc: "Gaussian lobe, the bounded normalisation", cases: classical::ward },
    Model { name: "ward-original", doc: "Gaussian lobe, Ward's own normalisation", cases: classical::ward_original },
    Model { name: "ward-duer", doc: "Gaussian lobe, Dür's normalisation", cases: classical::ward_duer },
    Model { name: "cook-torrance", doc: "facets over a diffuse bulk", cases: classical::cook_torrance },
    Model { name: "conductor-kulla-conty", doc: "metal with light between facets", cases: classical::kulla_conty },
    Model { name: "conductor-turquin", doc: "metal scaled to conserve energy", cases: classical::turquin },
    Model { name: "measured", doc: "tables of values", cases: both_ways },
    Model { name: "measured-one-way", doc: "tables that are not the same backwards", cases: one_way },
    Model { name: "hair", doc: "a fibre of hair or fur", cases: hair },
    Model { name: "layered", doc: "a coat over a metal or a scattering medium, by random walks", cases: layered },
    Model { name: "pbr", doc: "the surface of glTF and OpenPBR", cases: pbr },
    Model { name: "principled", doc: "Disney's surface", cases: principled },
    Model { name: "principled-thin", doc: "Disney's thin sheet", cases: principled_thin },
];

/// Models that are not the same backwards.
pub const NON_RECIPROCAL: &[&str] =
    &["phong-empirical", "blinn-phong-empirical", "conductor-turquin", "measured-one-way", "hair"];

/// Models that may reflect more light than they get.
pub const NON_CONSERVING: &[&str] =
    &["minnaert-bright-limb", "phong-empirical", "blinn-phong-empirical", "ward-original", "ward-duer"];

pub(super) const GREY: Spectrum = Spectrum::new([0.2, 0.5, 0.8, 0.4]);

fn diffuse(visit: &mut Visitor<'_>) {
    let mut case =
        |label, reflectance, lossless| visit(Case { label, bsdf: Bsdf::Diffuse(Diffuse { reflectance }), lossless });
    case("coloured", GREY, false);
    case("white", Spectrum::ONE, true);
}

fn diffuse_transmission(visit: &mut Visitor<'_>) {
    let mut case = |label, reflectance, transmittance, lossless| {
        visit(Case {
            label,
            bsdf: Bsdf::DiffuseTransmission(DiffuseTransmission { reflectance, transmittance }),
            lossless,
        });
    };
    case("half and half", Spectrum::splat(0.5), Spectrum::splat(0.5), true);
    case("coloured", GREY * 0.5, GREY * 0.2, false);
    case("transmits only", Spectrum::ZERO, GREY, false);
}

fn conductor(visit: &mut Visitor<'_>) {
    use NormalDistribution::{Beckmann, Ggx};
    use Shadowing::{HeightCorrelated, Separable};
    let gold = |microfacet| Conductor {
        eta: Spectrum::new([0.18, 0.42, 1.37, 0.37]),
        k: Spectrum::new([3.1, 2.35, 1.77, 2.82]),
        tint: Spectrum::ONE,
        microfacet,
    };
    let mut case = |label, value, lossless| visit(Case { label, bsdf: Bsdf::Conductor(value), lossless });
    case("smooth mirror", Conductor::mirror(Spectrum::ONE, Microfacet::SMOOTH), true);
    case("smooth gold", gold(Microfacet::SMOOTH), false);
    case("GGX mirror, 0.05", Conductor::mirror(Spectrum::ONE, Microfacet::ggx(0.05, 0.05)), false);
    case("GGX gold, 0.3", gold(Microfacet::ggx(0.3, 0.3)), false);
    case("GGX gold, separable, 0.5", gold(Microfacet::new(Ggx, Separable, 0.5, 0.5)), false);
    case("GGX gold, anisotropic 0.1 and 0.4", gold(Microfacet::ggx(0.1, 0.4)), false);
    case("GGX mirror, 1", Conductor::mirror(GREY, Microfacet::ggx(1.0, 1.0)), false);
    case("Beckmann gold, 0.05", gold(Microfacet::new(Beckmann, HeightCorrelated, 0.05, 0.05)), false);
    case("Beckmann gold, 0.3", gold(Microfacet::new(Beckmann, Separable, 0.3, 0.3)), false);
    case("Beckmann gold, anisotropic 0.4 and 0.1", gold(Microfacet::new(Beckmann, Separable, 0.4, 0.1)), false);
    case("from reflectance", Conductor::from_reflectance(GREY, Microfacet::ggx(0.2, 0.2)), false);
    for (label, distribution, shadowing, x, y) in further_surfaces() {
        case(label, gold(Microfacet::new(distribution, shadowing, x, y)), false);
    }
}

/// Surfaces whose normals are drawn in other ways than those of GGX and Beckmann under Smith's masking.
fn further_surfaces() -> [(&'static str, NormalDistribution, Shadowing, f32, f32); 9] {
    use NormalDistribution::{Beckmann, Blinn, Gaussian, Ggx, StudentT};
    use Shadowing::{HeightCorrelated, Separable, VGroove};
    [
        ("Blinn, 0.2", Blinn, Separable, 0.2, 0.2),
        ("Blinn, anisotropic, V-grooves", Blinn, VGroove, 0.1, 0.5),
        ("Gaussian, 0.4", Gaussian, HeightCorrelated, 0.4, 0.4),
        ("Gaussian, V-grooves, 0.15", Gaussian, VGroove, 0.15, 0.15),
        ("Student's t, long tail, 0.1", StudentT(Tail::new(1.8)), HeightCorrelated, 0.1, 0.1),
        ("Student's t, short tail, anisotropic", StudentT(Tail::new(5.0)), Separable, 0.5, 0.2),
        ("GGX, V-grooves, 0.3", Ggx, VGroove, 0.3, 0.3),
        ("Beckmann, V-grooves, anisotropic", Beckmann, VGroove, 0.2, 0.6),
        ("Blinn, 1", Blinn, Separable, 1.0, 1.0),
    ]
}

fn dielectric(visit: &mut Visitor<'_>) {
    use NormalDistribution::{Beckmann, Ggx};
    use Shadowing::Separable;
    let mut case = |label, value, lossless| visit(Case { label, bsdf: Bsdf::Dielectric(value), lossless });
    case("smooth glass", Dielectric::new(1.5, Microfacet::SMOOTH), true);
    case("smooth bubble", Dielectric::new(1.0 / 1.33, Microfacet::SMOOTH), true);
    case("index 1", Dielectric::new(1.0, Microfacet::ggx(0.3, 0.3)), true);
    case("GGX glass, 0.1", Dielectric::new(1.5, Microfacet::ggx(0.1, 0.1)), false);
    case("GGX glass, 0.5", Dielectric::new(1.5, Microfacet::ggx(0.5, 0.5)), false);
    case("GGX glass, anisotropic, separable", Dielectric::new(1.33, Microfacet::new(Ggx, Separable, 0.15, 0.4)), false);
    case("GGX bubble, 0.3", Dielectric::new(1.0 / 1.5, Microfacet::ggx(0.3, 0.3)), false);
    case("GGX diamond, 0.2", Dielectric::new(2.417, Microfacet::ggx(0.2, 0.2)), false);
    case("Beckmann glass, 0.2", Dielectric::new(1.5, Microfacet::new(Beckmann, Separable, 0.2, 0.2)), false);
    let tinted = Dielectric {
        reflectance: GREY,
        transmittance: Spectrum::new([0.9, 0.1, 0.4, 0.2]),
        ..Dielectric::new(1.5, Microfacet::ggx(0.25, 0.25))
    };
    case("tinted", tinted, false);
    for (label, distribution, shadowing, x, y) in further_surfaces().into_iter().step_by(3) {
        case(label, Dielectric::new(1.5, Microfacet::new(distribution, shadowing, x, y)), false);
    }
}

fn thin_dielectric(visit: &mut Visitor<'_>) {
    visit(Case { label: "pane", bsdf: Bsdf::ThinDielectric(ThinDielectric::new(1.5)), lossless: true });
}

fn coated(visit: &mut Visitor<'_>) {
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

/// Tables whose lookup or projection treats the two directions differently.
const ONE_WAY: [&str; 3] = ["adaptive", "harmonics", "anisotropic table"];

fn one_way(visit: &mut Visitor<'_>) {
    tabulated(visit, |name| ONE_WAY.contains(&name));
}

fn both_ways(visit: &mut Visitor<'_>) {
    tabulated(visit, |name| !ONE_WAY.contains(&name));
}

fn tabulated(visit: &mut Visitor<'_>, wanted: impl Fn(&str) -> bool) {
    let metal = measured::synthetic::Metal { alpha: 0.4, ..measured::synthetic::METAL };
    for (label, data) in metal.all().iter().flatten().filter(|d| wanted(d.0)) {
        let lambda = Wavelengths::sample_visible(0.2);
        let mut case = |mode| {
            let bsdf = Bsdf::Measured(Measured::new(data, &lambda, mode, Vec2::splat(0.25)));
            visit(Case { label, bsdf, lossless: false });
        };
        case(ColorMode::Rgb);
        // Colours that become spectra do so in the same way for all.
        if *label == "MERL" {
            case(ColorMode::Spectral);
        }
    }
}

fn hair(visit: &mut Visitor<'_>) {
    let mut case = |label, h, sigma_a, eta, beta_m, beta_n, alpha, lossless| {
        let bsdf = Bsdf::Hair(Hair::new(h, sigma_a, eta, beta_m, beta_n, alpha));
        visit(Case { label, bsdf, lossless });
    };
    use Offset::{FromNormal, Given};
    let brown = Spectrum::new([0.54, 0.91, 1.78, 1.0]);
    case("brown", Given(0.3), brown, 1.55, 0.3, 0.3, 2.0, false);
    case("white", Given(-0.6), Spectrum::ZERO, 1.55, 0.3, 0.3, 2.0, true);
    case("white, rough", Given(0.9), Spectrum::ZERO, 1.55, 1.0, 1.0, 0.0, true);
    case("white, on the axis", Given(0.0), Spectrum::ZERO, 1.3, 0.5, 0.2, 0.0, true);
    case("smooth", Given(0.5), brown * 0.2, 1.55, 0.1, 0.15, 3.0, false);
    case("at the edge", Given(1.0), brown, 1.55, 0.3, 0.3, 2.0, false);
    case("index 1", Given(0.4), Spectrum::ZERO, 1.0, 0.4, 0.4, 0.0, true);
    case("round surface", FromNormal, brown, 1.55, 0.25, 0.3, 2.0, false);
    case("round and white", FromNormal, Spectrum::ZERO, 1.55, 0.4, 0.5, 2.0, true);
}

fn layered(visit: &mut Visitor<'_>) {
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

/// The plain surface that cases depart from.
fn plain() -> PrincipledParams {
    let luminance = 0.2126 * GREY[0] + 0.7152 * GREY[1] + 0.0722 * GREY[2];
    PrincipledParams {
        base_color: GREY,
        tint: GREY / luminance,
        roughness: 0.5,
        anisotropic: 0.0,
        metallic: 0.0,
        spec_trans: 0.0,
        eta: 1.5,
        spec_tint: 0.0,
        sheen: 0.0,
        sheen_tint: 0.0,
        flatness: 0.0,
        clearcoat: 0.0,
        clearcoat_gloss: 0.0,
    }
}

fn principled(visit: &mut Visitor<'_>) {
    let mut case = |label, params: PrincipledParams| {
        visit(Case { label, bsdf: Bsdf::Principled(Principled::new(&params)), lossless: false });
    };
    let p = plain();
    case("plain", p);
    case("metal", PrincipledParams { metallic: 1.0, roughness: 0.4, anisotropic: 0.7, ..p });
    case("glass", PrincipledParams { spec_trans: 1.0, roughness: 0.4, ..p });
    case("bubble", PrincipledParams { spec_trans: 0.8, eta: 0.7, roughness: 0.5, ..p });
    case("cloth", PrincipledParams { sheen: 1.0, sheen_tint: 0.5, roughness: 1.0, flatness: 0.6, ..p });
    case("lacquer", PrincipledParams { clearcoat: 1.0, clearcoat_gloss: 0.3, ..p });
    case("white", PrincipledParams { base_color: Spectrum::ONE, tint: Spectrum::ONE, roughness: 1.0, sheen: 1.0, ..p });
    case(
        "all at once",
        PrincipledParams {
            metallic: 0.4,
            spec_trans: 0.5,
            spec_tint: 0.6,
            sheen: 0.5,
            clearcoat: 0.7,
            flatness: 0.3,
            anisotropic: 0.4,
            ..p
        },
    );
}

fn principled_thin(visit: &mut Visitor<'_>) {
    let mut case = |label, params: PrincipledParams, diff_trans| {
        let bsdf = Bsdf::PrincipledThin(PrincipledThin::new(&params, diff_trans));
        visit(Case { label, bsdf, lossless: false });
    };
    let p = plain();
    case("paper", p, 0.8);
    case("opaque", PrincipledParams { sheen: 0.5, ..p }, 0.0);
    case("pane", PrincipledParams { spec_trans: 1.0, roughness: 0.5, ..p }, 0.0);
    case("leaf", PrincipledParams { spec_trans: 0.3, spec_tint: 0.5, anisotropic: 0.5, flatness: 0.5, ..p }, 1.2);
}

fn pbr(visit: &mut Visitor<'_>) {
    let mut furnace = |label, params: PbrParams, lossless| {
        visit(Case { label, bsdf: Bsdf::Pbr(Pbr::new(&params)), lossless });
    };
    let p = PbrParams {
        base_color: GREY,
        metallic: 0.0,
        facets: Microfacet::ggx(0.3, 0.3),
        eta: 1.5,
        specular: 1.0,
        specular_color: Spectrum::ONE,
        transmission: 0.0,
        transmission_color: GREY,
        thin: true,
        diffuse_transmission: 0.0,
        diffuse_transmission_color: GREY,
        sheen_color: Spectrum::ZERO,
        sheen_roughness: 0.5,
        coat: 0.0,
        coat_facets: Microfacet::ggx(0.1, 0.1),
        coat_eta: 1.5,
        coat_color: Spectrum::ONE,
        tints_metal_edge: false,
        film: ThinFilm::new(1.3, 0.0, None),
        film_weight: 0.0,
    };
    let white = PbrParams { base_color: Spectrum::ONE, ..p };
    let clear = PbrParams { transmission: 1.0, transmission_color: Spectrum::ONE, facets: Microfacet::SMOOTH, ..white };
    furnace("smooth pane", clear, true);
    furnace("smooth glass", PbrParams { thin: false, ..clear }, true);
    let oxide = ThinFilm::new(2.2, 900.0, Some([450.0, 500.0, 560.0, 640.0]));
    furnace("film on a smooth pane", PbrParams { film: oxide, film_weight: 1.0, ..clear }, true);
    let mut case = |label, params: PbrParams| furnace(label, params, false);
    case("plain", p);
    case("smooth metal", PbrParams { metallic: 1.0, facets: Microfacet::SMOOTH, ..p });
    case("smooth, white", PbrParams { facets: Microfacet::SMOOTH, ..white });
    let smooth_coat = PbrParams { coat: 0.8, coat_facets: Microfacet::SMOOTH, ..white };
    case("smooth lacquer", smooth_coat);
    case("smooth lacquer on smooth coloured glass", PbrParams { thin: false, coat_color: GREY, ..clear });
    case(
        "smooth lacquer on smooth glass",
        PbrParams { thin: false, coat: 1.0, coat_facets: Microfacet::SMOOTH, ..clear },
    );
    let soap = ThinFilm::new(1.33, 380.0, None);
    case("film on white", PbrParams { film: soap, film_weight: 1.0, ..white });
    case("film on metal", PbrParams { film: oxide, film_weight: 0.7, metallic: 0.6, ..white });
    case(
        "film on rough glass",
        PbrParams { film: soap, film_weight: 0.5, thin: false, facets: Microfacet::ggx(0.2, 0.2), ..clear },
    );
    case("white, rough", PbrParams { facets: Microfacet::ggx(1.0, 1.0), ..white });
    case("white, dense", PbrParams { eta: 2.4, facets: Microfacet::ggx(0.1, 0.1), ..white });
    case("metal, stretched", PbrParams { metallic: 1.0, facets: Microfacet::ggx(0.5, 0.1), ..p });
    case("metal with a dark edge", PbrParams { metallic: 1.0, specular_color: GREY, tints_metal_edge: true, ..white });
    case("cloth", PbrParams { sheen_color: Spectrum::ONE, sheen_roughness: 0.4, specular: 0.5, ..white });
    case("soft cloth", PbrParams { sheen_color: GREY, sheen_roughness: 1.0, specular: 0.0, ..white });
    let lacquer = PbrParams { coat: 1.0, coat_facets: Microfacet::ggx(0.2, 0.2), ..white };
    case("lacquer", lacquer);
    case("coloured lacquer on metal", PbrParams { coat_color: GREY, metallic: 1.0, coat: 0.7, ..lacquer });
    case("pane", PbrParams { transmission: 1.0, transmission_color: Spectrum::ONE, ..white });
    case("glass", PbrParams { transmission: 1.0, thin: false, ..p });
    case(
        "lacquered cloudy glass",
        PbrParams { transmission: 0.6, transmission_color: Spectrum::ONE, thin: false, eta: 1.3, ..lacquer },
    );
    case("leaf", PbrParams { diffuse_transmission: 0.6, diffuse_transmission_color: Spectrum::ONE, ..white });
    case(
        "all at once",
        PbrParams {
            metallic: 0.3,
            transmission: 0.4,
            diffuse_transmission: 0.5,
            sheen_color: GREY,
            coat: 0.5,
            specular: 0.7,
            specular_color: GREY,
            ..p
        },
    );
}
