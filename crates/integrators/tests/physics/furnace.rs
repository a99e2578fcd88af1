//! The white furnace: in surroundings of radiance one, what loses no light cannot be seen, and what does shows its
//! albedo.

use crate::{
    materials::{Case, cases},
    shot::{Shot, is_exactly, mean},
    stage::{Stage, cuboid, diffuse, icosphere, light, material, rgb, shape, sphere, white},
};
use steradian_bsdf::{Bsdf, TransportMode};
use steradian_core::{ColorMode, Scene, scene::Interaction};
use steradian_math::{Frame, Vec2, Vec3, hash::ONE_MINUS_EPSILON, spectra::Wavelengths};
use steradian_scene::{Family, Node, NodeId};
use steradian_testkit::integrate_sphere;

/// A convex body of a material in the furnace, seen whole.
fn furnace(case: &Case, closed_mesh: bool) -> Stage {
    let mut stage = Stage::new();
    let made_of = (case.make)(&mut stage.desc);
    with_body(stage, made_of, closed_mesh)
}

/// The stage with the body.
fn with_body(mut stage: Stage, made_of: NodeId, closed_mesh: bool) -> Stage {
    let body = if closed_mesh {
        stage.place_mesh(icosphere([0.1, -0.2, 0.3], 1.0, 2))
    } else {
        stage.place(sphere([0.1, -0.2, 0.3], 1.0))
    };
    body.material = Some(made_of);
    stage.sky(1.0).film(24, 24).look([0.3, 1.0, -5.0], [0.1, -0.2, 0.3], 26.0);
    stage
}

/// M74, M80, M81, M95: whatever loses no light is invisible in a white furnace, as a sphere and as a closed mesh. All
/// lossless models give every path weight one but where a rare draw is rejected: within 4σ, and per pixel no farther
/// than the spread of a path can take it.
#[test]
fn lossless_bodies_are_invisible() {
    for case in cases().iter().filter(|c| c.lossless) {
        for closed_mesh in [false, true] {
            let scene = furnace(case, closed_mesh).scene();
            let film = Shot::of("path", 24).roulette_after(64).take(&scene);
            mean(&film).is_near_grey(&format!("{}, mesh: {closed_mesh}", case.label), 1.0, 2e-3);
            for (i, p) in film.pixels.iter().enumerate() {
                let m = p.mean()[0];
                assert!((m - 1.0).abs() < 2e-3, "{}, mesh: {closed_mesh}: pixel {i} is {m}", case.label);
            }
        }
    }
}

/// Normal maps leave the albedo of what transmits as it is: directions sent to the wrong side of the surface are folded
/// back, and light is not held in a body by total reflection at normals bent towards grazing.
#[test]
fn tilted_normals_lose_no_light() {
    let tilts = [[0.9, 0.6, 0.8], [0.5, 0.85, 0.7]];
    for kind in ["dielectric", "diffuse_transmission", "subsurface"] {
        for (tilt, closed_mesh) in tilts.into_iter().flat_map(|t| [(t, false), (t, true)]) {
            let mut stage = Stage::new();
            let map = stage.add(Node::new(Family::Texture, "constant", None).with("value", rgb(tilt)));
            let made_of = material(kind).with("normal_map", map);
            let made_of = match kind {
                "diffuse_transmission" => {
                    made_of.with("reflectance", rgb([0.3; 3])).with("transmittance", rgb([0.7; 3]))
                }
                "subsurface" => {
                    let matter = made_of.with("method", "random_walk").with("eta", 1.33);
                    matter.with("sigma_a", rgb([0.0; 3])).with("sigma_s", rgb([5.0; 3]))
                }
                _ => made_of,
            };
            let made_of = stage.add(made_of);
            let scene = with_body(stage, made_of, closed_mesh).scene();
            let film = Shot::of("path", 24).depth(400).roulette_after(64).take(&scene);
            mean(&film).is_near_grey(&format!("{kind}, {tilt:?}, mesh: {closed_mesh}"), 1.0, 4e-3);
        }
    }
}

/// Lossless bodies in spectral mode: the picture has the very wavelengths, and so the colour noise, of the empty
/// furnace.
#[test]
fn lossless_bodies_are_invisible_in_spectral_mode() {
    let mut empty = Stage::new();
    empty.sky(1.0).film(24, 24).look([0.3, 1.0, -5.0], [0.1, -0.2, 0.3], 26.0);
    let shot = Shot::of("path", 8).roulette_after(64);
    let surroundings = shot.take(&empty.scene_in(ColorMode::Spectral));
    mean(&surroundings).is_near_grey("D65 of luminance one", 1.0, 0.02);
    for case in cases().iter().filter(|c| c.lossless) {
        for closed_mesh in [false, true] {
            let film = shot.take(&furnace(case, closed_mesh).scene_in(ColorMode::Spectral));
            for (a, b) in film.pixels.iter().zip(&surroundings.pixels) {
                for c in 0..3 {
                    let (a, b) = (a.mean()[c], b.mean()[c]);
                    assert!(
                        (a - b).abs() < 2e-3 * b.abs().max(1.0),
                        "{}, mesh: {closed_mesh}: {a} for {b}",
                        case.label
                    );
                }
            }
        }
    }
}

/// `∫ f |cos| dω` over all directions, delta distributions added.
fn albedo(bsdf: &Bsdf, wo: Vec3) -> [f64; 3] {
    let mode = TransportMode::Radiance;
    let lane = |c: usize| {
        if bsdf.is_specular() { 0.0 } else { integrate_sphere(|w| f64::from(bsdf.eval(wo, w, mode).value[c]), 1e-4) }
    };
    let mut sum: [f64; 3] = std::array::from_fn(lane);
    // The choice of lobe runs from reflection to transmission; a specular lobe weighs what it is worth times its
    // probability.
    let ends =
        [0.0, ONE_MINUS_EPSILON].map(|u| bsdf.sample(wo, u, Vec2::splat(0.5), mode).filter(|s| s.lobe.is_specular()));
    let second = ends[1].filter(|l| ends[0].is_none_or(|f| f.lobe != l.lobe));
    for s in [ends[0], second].into_iter().flatten() {
        for (c, sum) in sum.iter_mut().enumerate() {
            *sum += f64::from(s.weight[c] * s.pdf);
        }
    }
    sum
}

/// First hit of a probe's ray.
fn met(scene: &Scene) -> Interaction {
    let ray = scene.camera().ray(scene.film(), Vec2::splat(0.5), Vec2::splat(0.5));
    let hit = scene.intersect(&ray).expect("the probe looks at the disk");
    scene.interaction(&ray, &hit)
}

/// M74, M79: what loses light shows the albedo a(ω) = ∫ f cos dω in the furnace, by quadrature of the model at the same
/// point, from straight on to near grazing. A flat disk, so that light is scattered once. 4σ.
#[test]
fn lossy_surfaces_show_their_albedo() {
    for case in cases().iter().filter(|c| !matches!(c.kind, "mix" | "mask" | "interface")) {
        for degrees in [0.0_f64, 40.0, 80.0] {
            let (sin, cos) = degrees.to_radians().sin_cos();
            let mut stage = Stage::new();
            let made_of = (case.make)(&mut stage.desc);
            stage.place(shape("disk").with("radius", 0.5)).material = Some(made_of);
            stage.sky(1.0).probe([2.0 * sin, 0.03, 2.0 * cos], [0.1, 0.03, 0.0]);
            let scene = stage.scene();
            let i = met(&scene);
            let mut lambda = Wavelengths::RGB;
            let (s, frame): (_, Frame) = scene.scattering(&i, 0.5, &mut lambda).expect("a surface that scatters");
            if s.bsdf.is_stochastic() {
                break; // An estimate has no quadrature; the laws of scattering compare its means.
            }
            let expected = albedo(&s.bsdf, frame.to_local(i.wo));
            assert!(expected.iter().all(|a| (0.0..=1.0 + 1e-3).contains(a)), "{}: {expected:?}", case.label);
            let got = mean(&Shot::of("path", 8_000).take(&scene));
            // Quadrature is granted 10⁻³.
            for c in 0..3 {
                let allowed = 4.0 * got.sigma[c] + 1e-3 * expected[c];
                assert!(got.sigma[c] <= 0.02 * expected[c], "{}: too noisy, {:?}", case.label, got);
                let difference = (got.mean[c] - expected[c]).abs();
                assert!(difference <= allowed, "{} at {degrees}°: {:?} for {expected:?}", case.label, got.mean);
            }
        }
    }
}

/// M80: a white-lit diffuse surface shows exactly its reflectance, whatever its colour.
#[test]
fn diffuse_reflectance_is_exact() {
    for v in [0.0, 0.18, 0.5, 1.0] {
        let mut stage = Stage::new();
        stage.solid(sphere([0.0; 3], 1.0), diffuse(v));
        stage.sky(3.0).film(8, 8).look([0.0, 0.0, -4.0], [0.0; 3], 10.0);
        is_exactly(&Shot::of("path", 4).take(&stage.scene()), "diffuse sphere", [3.0 * v; 3]);
    }
}

/// M160, M163: inside a closed sphere that emits one and reflects ρ, k scattering events give Σ ρⁱ for i ≤ k, each
/// bounce adds ρᵏ, and all of them 1/(1 − ρ) (E1: the lecture's program gives another sum). Light and scattering draw
/// with the same density here, so truncated series are exact; the whole series, with Russian roulette, is within 4σ.
#[test]
fn neumann_series_inside_a_luminous_sphere() {
    let inside = |reflectance: f64| {
        let mut stage = Stage::new();
        let emission = stage.add(light("area").with("radiance", white(1.0)));
        let wall = stage.solid(sphere([0.0; 3], 2.0), diffuse(reflectance));
        (wall.emission, wall.reverse_orientation) = (Some(emission), true);
        stage.film(4, 4).look([0.4, 0.3, -0.5], [0.1, 0.5, 1.0], 60.0);
        stage.scene()
    };
    let scene = inside(0.5);
    let mut last = 0.0;
    for k in 0..=6 {
        let film = Shot::of("path", 8).depth(k).take(&scene);
        let sum: f64 = (0..=k).map(|i| 0.5_f64.powi(i as i32)).sum();
        is_exactly(&film, &format!("{k} events"), [sum; 3]);
        let bounce = mean(&film).mean[0] - last;
        assert!((bounce - 0.5_f64.powi(k as i32)).abs() < 1e-4, "bounce {k} adds {bounce}");
        last += bounce;
    }
    for (reflectance, spp) in [(0.5, 512), (0.9, 2048)] {
        let film = Shot::of("path", spp).roulette_after(1).take(&inside(reflectance));
        mean(&film).is_near_grey("the whole series", 1.0 / (1.0 - reflectance), 0.01);
    }
}

/// Neumann series in a closed box of luminous rectangles, whose densities differ: 4σ.
#[test]
fn neumann_series_inside_a_luminous_box() {
    let mut stage = Stage::new();
    let emission = stage.add(light("area").with("radiance", white(1.0)));
    let wall = stage.add(diffuse(0.6));
    let room = stage.place_mesh(cuboid([-1.0, -1.0, -1.0], [1.0, 2.0, 1.0]));
    (room.emission, room.material, room.reverse_orientation) = (Some(emission), Some(wall), true);
    stage.film(4, 4).look([0.4, 0.3, -0.5], [0.1, 0.5, 1.0], 60.0);
    let scene = stage.scene();
    for k in [0, 1, 2, 5] {
        let sum: f64 = (0..=k).map(|i| 0.6_f64.powi(i)).sum();
        mean(&Shot::of("path", 512).depth(k as u32).take(&scene)).is_near_grey(&format!("{k} events"), sum, 0.01);
    }
    mean(&Shot::of("path", 1024).roulette_after(2).take(&scene)).is_near_grey("the whole series", 2.5, 0.01);
}

/// M92, M134: gold by name has, at normal incidence under D65, the colour that Fresnel's equations give its measured
/// index: the quadrature of R(λ) = ((n−1)² + k²)/((n+1)² + k²). 4σ.
#[test]
fn metals_by_name_have_their_colour() {
    use steradian_math::spectra::{cie, d65, named};
    for metal in ["Au", "Ag", "Cu", "Al"] {
        let mut stage = Stage::new();
        let spectrum = |s: String| steradian_scene::Value::Spectrum(steradian_scene::SpectrumValue::Named(s));
        let node = material("conductor")
            .with("eta", spectrum(format!("metal-{metal}-eta")))
            .with("k", spectrum(format!("metal-{metal}-k")));
        stage.solid(shape("disk").with("radius", 1.0), node);
        stage.sky(1.0).probe([0.0, 0.0, 3.0], [0.0; 3]);
        let curve = |part: &str| named(&format!("metal-{metal}-{part}")).expect("a metal by name");
        let (eta, k) = (curve("eta"), curve("k"));
        let reflectance = |l: f32| {
            let (n, k) = (eta.eval(l), k.eval(l));
            ((n - 1.0).powi(2) + k * k) / ((n + 1.0).powi(2) + k * k)
        };
        // D65 of luminance one reflected, as linear Rec.709.
        let lit = cie::to_xyz(|l| reflectance(l) * d65().eval(l)) / cie::to_xyz(|l| d65().eval(l)).y;
        let expected = (steradian_math::color::space::REC709.rgb_from_xyz() * lit).to_array();
        mean(&Shot::of("path", 60_000).take(&stage.scene_in(ColorMode::Spectral))).is_near(metal, expected, 0.02);
        // Three numbers cannot hold a spectrum; they come close.
        let rgb = mean(&Shot::of("path", 4).take(&stage.scene())).mean;
        for c in 0..3 {
            assert!((rgb[c] - expected[c]).abs() < 0.06, "{metal} in RGB mode: {rgb:?} for {expected:?}");
        }
    }
}
