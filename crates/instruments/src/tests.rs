//! The instruments read off what theory says.

use crate::{
    Specimen, TransportMode,
    albedo::albedo,
    direction,
    gloss::{BLACK_GLASS, GEOMETRIES, gloss},
    goniometer::{self, Bins},
    laws,
    microsurface::Microsurface,
    plot, summary,
};
use steradian_bsdf::{
    Microfacet, NormalDistribution, Shadowing, fresnel,
    measured::{AngleTable, synthetic::METAL},
};
use steradian_compile::{Options, compile};
use steradian_core::Scene;
use steradian_math::Vec3;
use steradian_scene::{Family, Mesh, Node, SceneDesc, Shape};

/// A scene of one mesh, or of a ball, of a material; nothing else matters to the instruments.
fn scene(mesh: Option<Mesh>, material: Node) -> Scene {
    let mut d = SceneDesc::default();
    let camera = d.add(Node::new(Family::Camera, "perspective", None));
    d.cameras.push(camera);
    let material = d.add(material);
    let node = d.add(Node::new(Family::Shape, if mesh.is_some() { "mesh" } else { "sphere" }, None));
    let mesh = mesh.map(|m| d.add_mesh(m));
    d.shapes.push(Shape {
        mesh,
        world_from_object: steradian_math::Transform::IDENTITY,
        material: Some(material),
        ..Shape::new(node)
    });
    compile(&d, &Options::default()).scene.expect("a sound scene")
}

fn material(kind: &str) -> Node {
    Node::new(Family::Material, kind, None)
}

fn flat() -> Mesh {
    Mesh {
        positions: vec![[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [4.0, 4.0, 0.0], [0.0, 4.0, 0.0]],
        triangles: vec![[0, 1, 2], [0, 2, 3]].into(),
        ..Mesh::default()
    }
}

/// M111: black glass of index 1.567 has 100 gloss units in every geometry; a matt surface next to none.
#[test]
fn black_glass_has_a_hundred_gloss_units() {
    let glass = scene(None, material("dielectric").with("eta", f64::from(BLACK_GLASS)));
    let matt = scene(None, material("diffuse").with("reflectance", 0.8));
    for geometry in GEOMETRIES {
        let g = gloss(&Specimen::new(&glass, 1), geometry, 1 << 16);
        // What bends over the angle of the source is left: 0.3 units at 85°.
        assert!((g.units - 100.0).abs() < 0.5 + 4.0 * g.error, "{g:?}");
        assert!(gloss(&Specimen::new(&matt, 1), geometry, 1 << 16).units < 8.0);
    }
}

/// A rougher surface is less glossy, at every angle; and the rougher of two is told best at 20°.
#[test]
fn gloss_falls_with_roughness() {
    let reading = |alpha: f64, i: usize| {
        let s = scene(None, material("conductor").with("alpha_u", alpha));
        gloss(&Specimen::new(&s, 1), GEOMETRIES[i], 1 << 14).units
    };
    for i in 0..3 {
        let series = [0.02, 0.1, 0.3].map(|alpha| reading(alpha, i));
        assert!(series[0] > series[1] && series[1] > series[2], "{series:?}");
    }
}

#[test]
fn albedos_are_those_of_closed_forms() {
    let matt = scene(None, material("diffuse").with("reflectance", 0.8));
    let glass = scene(None, material("dielectric").with("eta", 1.5));
    for theta in [0.0, 40.0, 80.0] {
        let a = albedo(&Specimen::new(&matt, 1), theta, 4096);
        assert!((a.reflectance[0] - 0.8).abs() < 1e-5 && a.transmittance[0] == 0.0, "{a:?}");
        let a = albedo(&Specimen::new(&glass, 1), theta, 1 << 14);
        let f = fresnel::dielectric(theta.to_radians().cos() as f32, 1.5);
        assert!((a.reflectance[0] - f).abs() < 2e-3 && (a.transmittance[0] - (1.0 - f)).abs() < 2e-3, "{a:?}");
    }
}

/// A white fibre neither gains nor loses light of the white furnace, however steeply it is seen; and a coloured one is
/// the same whether its surface is really round.
#[test]
fn fibres_are_told_of_as_the_furnace_shows_them() {
    let told = |is_round: bool, sigma_a: f64, theta: f64| {
        let hair = material("hair").with("round", is_round).with("sigma_a", sigma_a);
        let s = scene(None, hair);
        let a = albedo(&Specimen::new(&s, 1), theta, 1 << 14);
        [a.reflectance[0], a.transmittance[0]]
    };
    for theta in [0.0, 45.0, 80.0, 89.0, 105.0] {
        let [white, brown] = [0.0, 0.5].map(|sigma_a| [false, true].map(|is_round| told(is_round, sigma_a, theta)));
        for [r, t] in white {
            assert!((r + t - 1.0).abs() < 1e-3 && r > 0.05 && t > 0.05, "{theta}: {r} {t}");
        }
        let [strip, tube] = brown;
        for k in 0..2 {
            assert!((strip[k] - tube[k]).abs() < 5e-3, "{theta}: {strip:?} {tube:?}");
        }
        assert!(strip[0] + strip[1] < 0.95, "{theta}: {strip:?}");
    }
    let s = scene(None, material("hair").with("sigma_a", 0.0));
    let laws = laws::laws(&Specimen::new(&s, 1), 1 << 14);
    assert!(laws.laws.iter().filter(|law| law.law.starts_with("energy")).all(|law| law.holds), "{laws}");
    assert!(summary::summary(&Specimen::new(&s, 1), 1 << 12).conserves_energy);
}

/// M112: the lobe of a metal is highest near the mirror direction, and a mirror's arrow points along it.
#[test]
fn lobes_point_along_the_mirror_direction() {
    let metal = scene(None, material("conductor").with("alpha_u", 0.1));
    for theta in [0.0, 30.0, 60.0] {
        let slice = plot::slice(&Specimen::new(&metal, 1), theta);
        let top = slice.values.iter().max_by(|a, b| a.1.total_cmp(&b.1)).expect("values").0;
        assert!((top - theta).abs() <= 3.0, "{theta}: {top}");
    }
    let mirror = scene(None, material("conductor"));
    let slice = plot::slice(&Specimen::new(&mirror, 1), 50.0);
    assert!(
        matches!(slice.specular[..], [(theta, power)] if (theta - 50.0).abs() < 1e-3 && (power - 1.0).abs() < 1e-5)
    );
    let svg = plot::svg(&Specimen::new(&mirror, 1), "a < b & c", plot::Radius::Linear);
    assert!(svg.starts_with("<svg") && svg.ends_with("</svg>\n") && svg.contains("a &lt; b &amp; c"));
}

/// M107: the table of a material, read back, is the material.
#[test]
fn a_table_read_back_is_the_material() {
    let metal = scene(None, material("conductor").with("alpha_u", 0.4));
    let specimen = Specimen::new(&metal, 1);
    let table = AngleTable::read(&goniometer::table(&specimen, [5.0, 10.0], &[0.0])).expect("a table");
    for (ti, to, po) in [(10.0, 15.0, 180.0), (40.0, 45.0, 170.0), (60.0, 20.0, 30.0)] {
        let (wo, wi) = (direction(to, po), direction(ti, 0.0));
        let f = specimen.luminance(specimen.eval(wo, wi, TransportMode::Radiance).value) / wi.z;
        assert!((table.eval(wo, wi).x - f).abs() < 1e-3 * f + 1e-5, "{ti} {to} {po}");
    }
}

/// M107: a flat piece of matt geometry measures as its material.
#[test]
fn flat_geometry_is_its_material() {
    let s = scene(Some(flat()), material("diffuse").with("reflectance", 0.6));
    let seen = goniometer::geometry(&s, direction(35.0, 20.0), Bins { rings: 4, sectors: 6 }, 1 << 16, 4);
    assert!((seen.albedo - 0.6).abs() < 1e-6, "{}", seen.albedo);
    for (f, error) in &seen.f {
        assert!((f - 0.6 / std::f64::consts::PI).abs() < 4.5 * error, "{f} ± {error}");
    }
}

/// M97: mirrors on a Gaussian surface reflect, at first contact, as Cook and Torrance's model with Beckmann's
/// distribution and Smith's masking; what it leaves out, light that is reflected again, grows with the slopes.
#[test]
fn a_gaussian_surface_scatters_as_beckmann() {
    let single_share = |alpha: f32| {
        let s = scene(Some(Microsurface::new(alpha, 48, 5).mesh()), material("conductor"));
        let wi = direction(30.0, 0.0);
        let bins = Bins { rings: 6, sectors: 4 };
        let seen = goniometer::geometry(&s, wi, bins, 1 << 18, 8);
        let facets = Microfacet::new(NormalDistribution::Beckmann, Shadowing::HeightCorrelated, alpha, alpha);
        let mirror = steradian_bsdf::Conductor::mirror(steradian_math::Spectrum::ONE, facets);
        let model = steradian_bsdf::Bsdf::Conductor(mirror);
        // The model's mean over each bin, by midpoints in projected solid angle.
        let (mut worst, n) = (0.0f64, 24);
        for (b, single) in seen.single.iter().enumerate() {
            let mut mean = 0.0;
            for i in 0..n * n {
                let ring = (b / bins.sectors) as f32 + ((i / n) as f32 + 0.5) / n as f32;
                let sector = (b % bins.sectors) as f32 + ((i % n) as f32 + 0.5) / n as f32;
                let (sin2, phi) = (ring / bins.rings as f32, sector / bins.sectors as f32 * std::f32::consts::TAU);
                let w = Vec3::new(sin2.sqrt() * phi.cos(), sin2.sqrt() * phi.sin(), (1.0 - sin2).sqrt());
                mean += f64::from(model.eval(wi, w, TransportMode::Importance).value[0] / w.z) / (n * n) as f64;
            }
            // In units of the largest difference that a share of all light can make.
            worst = worst.max((single - mean).abs() * std::f64::consts::PI / seen.f.len() as f64);
        }
        assert!(worst < 0.02, "α = {alpha}: {worst} of the light goes elsewhere");
        let all: f64 = seen.f.iter().map(|f| f.0).sum();
        seen.single.iter().sum::<f64>() / all
    };
    let (smooth, rough) = (single_share(0.2), single_share(0.6));
    assert!(smooth > 0.98 && rough < smooth, "light met once: {smooth} and {rough}");
}

/// The facets of the surface are distributed as Beckmann says: their slopes have the variance α²/2 along each axis.
#[test]
fn slopes_are_gaussian() {
    let alpha = 0.3f64;
    let facets = Microsurface::new(alpha as f32, 64, 9).facets();
    let n = facets.len() as f64;
    let moment = |k: i32| facets.iter().map(|f| f64::from(f.x).powi(k)).sum::<f64>() / n;
    // Both axes together: one alone varies with the few hundred waves. The mesh's facets cut the finest of them a
    // little.
    let both = facets.iter().map(|f| f64::from(f.x * f.x + f.y * f.y)).sum::<f64>() / n;
    assert!((both / (alpha * alpha) - 1.0).abs() < 0.06, "{both}");
    assert!((moment(4) / (3.0 * moment(2).powi(2)) - 1.0).abs() < 0.15, "kurtosis {}", moment(4));
}

/// M108: the metal that the tables are made from is found again by the model it is.
#[test]
fn a_specimen_is_fitted_by_its_own_model() {
    let s = scene(None, material("conductor").with("reflectance", 0.6).with("alpha_u", 0.3));
    let fits = crate::fit::MODELS.map(|m| m.fit(&crate::fit::readings(&Specimen::new(&s, 1))));
    let best = fits.iter().min_by(|a, b| a.residual.total_cmp(&b.residual)).expect("three");
    assert_eq!(best.model, crate::fit::Model::Ggx);
    assert!((best.alpha - 0.3).abs() < 0.02 && best.diffuse < 0.02, "{best:?}");
}

/// M78: sound models keep the laws of scattering; those that are known to break one are found out in it and in nothing
/// else: the empirical Phong of the lectures (E11) is not reciprocal.
#[test]
fn laws_are_kept_or_named() {
    let samples = 1 << 16;
    let broken = |m: Node| -> Vec<&'static str> {
        let scene = scene(None, m);
        let found = laws::laws(&Specimen::new(&scene, 1), samples);
        assert_eq!(found.hold, found.laws.iter().all(|l| l.holds));
        found.laws.iter().filter(|l| !l.holds).map(|l| l.law).collect()
    };
    for sound in [
        material("diffuse").with("reflectance", 0.8),
        material("conductor").with("alpha_u", 0.2).with("alpha_v", 0.4),
        material("dielectric").with("eta", 1.5),
        material("dielectric").with("eta", 1.5).with("alpha_u", 0.3).with("alpha_v", 0.3),
        material("cook_torrance"),
    ] {
        let kind = sound.kind.clone();
        let scene = scene(None, sound);
        let found = laws::laws(&Specimen::new(&scene, 1), samples);
        assert!(found.hold, "{kind}: {found}");
    }
    let empirical = broken(material("phong").with("form", "empirical").with("diffuse_reflectance", 0.0));
    assert!(empirical.contains(&"reciprocity: f(a, b) = f(b, a)"), "{empirical:?}");
    assert!(empirical.iter().all(|l| l.starts_with("reciprocity") || l.starts_with("energy")), "{empirical:?}");
    // Dür's form has an albedo above one at 85° (E15), and breaks nothing else.
    let ward = material("ward").with("form", "duer").with("alpha_u", 0.2).with("diffuse_reflectance", 0.0);
    let ward = broken(ward.with("specular_reflectance", 1.0));
    assert!(!ward.is_empty() && ward.iter().all(|l| l.starts_with("energy")), "{ward:?}");
}

/// Polished glass reflects 4 % at the normal (Fresnel: (½/2½)²) in a specular lobe and transmits the rest; a matt white
/// reflects its albedo; the empirical form of Phong's model gains energy, and that is told.
#[test]
fn a_material_at_a_glance() {
    let glance = |m: Node| summary::summary(&Specimen::new(&scene(None, m), 1), 4096);
    let glass = glance(material("dielectric").with("eta", 1.5));
    assert!((glass.white[0].reflectance - 0.04).abs() < 1e-3 && (glass.white[0].transmittance - 0.96).abs() < 1e-3);
    let names: Vec<_> = glass.lobes.iter().map(|l| l.name.as_str()).collect();
    assert_eq!(names, ["specular transmission", "specular reflection"]);
    // Fresnel's equations at 45°: R = (sin²(a−b)/sin²(a+b) + tan²(a−b)/tan²(a+b)) / 2.
    let (a, b) = (45f64.to_radians(), (0.5f64.sqrt() / 1.5).asin());
    let r = 0.5 * (((a - b).sin() / (a + b).sin()).powi(2) + ((a - b).tan() / (a + b).tan()).powi(2));
    assert!((glass.lobes[1].share - r).abs() < 3e-3 && (f64::from(glass.white[1].reflectance) - r).abs() < 3e-3);
    assert!(glass.is_transmitting && glass.conserves_energy);
    let matt = glance(material("diffuse").with("reflectance", 0.8));
    assert!(matt.white.iter().all(|w| (w.reflectance - 0.8).abs() < 1e-4 && w.transmittance == 0.0));
    assert!(!matt.is_transmitting && matt.conserves_energy && (matt.largest_albedo - 0.8).abs() < 1e-4);
    let empirical = material("phong").with("form", "empirical").with("specular_reflectance", 0.9);
    assert!(!glance(empirical).conserves_energy);
}

/// Summary and laws tell the same of energy, at the same angles: a gain from 86° on is broken law in both.
#[test]
fn summary_and_laws_agree_on_energy() {
    let grazing = std::env::temp_dir().join(format!("steradian-grazing-{}.txt", std::process::id()));
    std::fs::write(&grazing, METAL.angles([15.0, 30.0], &[0.0]))
        .expect("the folder for temporary files can be written");
    for m in [
        material("diffuse").with("reflectance", 0.8),
        material("phong").with("form", "empirical").with("specular_reflectance", 0.9),
        material("ward").with("form", "duer").with("alpha_u", 0.2).with("specular_reflectance", 1.0),
        material("measured").with("file", grazing.clone()),
    ] {
        let (kind, scene) = (m.kind.clone(), scene(None, m));
        let specimen = Specimen::new(&scene, 1);
        let (glance, laws) = (summary::summary(&specimen, 1 << 14), laws::laws(&specimen, 1 << 14));
        let energy = || laws.laws.iter().filter(|l| l.law.starts_with("energy") && l.angle.is_some_and(|a| a < 90.0));
        assert_eq!(glance.conserves_energy, energy().all(|l| l.holds), "{kind}: {laws}");
        assert_eq!(f64::from(glance.largest_albedo), energy().map(|l| l.found).fold(0.0, f64::max), "{kind}");
    }
    let _ = std::fs::remove_file(grazing);
}

/// The radius of a plot: what is a tenth of the largest is drawn at a quarter less by the logarithm over four decades;
/// only what transmits has a lower half; titles of any length stay within the picture.
#[test]
fn plots_have_two_scales() {
    let metal = scene(None, material("conductor").with("alpha_u", 0.1));
    let specimen = Specimen::new(&metal, 1);
    let extent = |svg: &str| {
        // Height of the viewer's arrow at 0° that the slice of that light reaches below the top: its highest point.
        let path = svg.split("<path d=\"").find(|p| p.contains("fill-opacity")).expect("a slice");
        let points = path.split('"').next().unwrap_or_default().split(['M', 'L', 'Z']).filter(|p| !p.is_empty());
        points.filter_map(|p| p.split(' ').nth(1)?.parse::<f64>().ok()).fold(f64::INFINITY, f64::min)
    };
    let [linear, log] = [plot::Radius::Linear, plot::Radius::Log].map(|r| extent(&plot::svg(&specimen, "metal", r)));
    let top = |theta| plot::slice(&specimen, theta).values.iter().map(|v| v.1).fold(0.0, f64::max);
    let largest = [0.0, 30.0, 60.0, 80.0].map(top).into_iter().fold(0.0, f64::max);
    let outer = 10f64.powf(largest.log10().ceil());
    let expected = 324.0 - 236.0 * (1.0 + (top(0.0) / outer).log10() / 4.0);
    assert!((log - expected).abs() < 0.1 && linear > log + 20.0, "{log} {expected} {linear}");
    let long = plot::svg(&specimen, &"/a/long/folder".repeat(20), plot::Radius::Log);
    assert!(long.matches("/a/long/folder").count() >= 18 && long.contains("translate(0 60)"), "{long}");
}
