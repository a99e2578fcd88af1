//! The integrator `raster` against rays: what is seen, how it is lit, and where shadows fall.

use steradian::{
    CompileOptions, Control, Film, Quality, Scene, compile,
    integrators::{Counters, Depth, Integrator, PathContext, whitted::Whitted},
    load,
    math::{Ray, Vec2, Vec3, spectra::Wavelengths},
};
use steradian_core::sampler::Sampler;
use steradian_realtime::{Method, Projected, Visibility, Wanted, draw_list::DrawList, lesson};

/// Every shape, a group placed twice (once mirrored), a mask, a mirror; a point, a spot and parallel light.
const SCENE: &str = r#"
LookAt 3 -5 3  0.3 0 0.6  0 0 1
Camera "perspective" "float fov" 40
Film "rgb" "integer xresolution" 200 "integer yresolution" 150
WorldBegin
LightSource "point" "rgb I" [20 18 15] "point3 from" [2 -1 4]
LightSource "spot" "rgb I" [30 30 40] "point3 from" [-3 -3 5] "point3 to" [0 0 0] "float coneangle" 25
LightSource "distant" "rgb L" [0.6 0.6 0.5] "point3 from" [-1 -2 3] "point3 to" [0 0 0]
Texture "board" "float" "checkerboard" "float uscale" 6 "float vscale" 6 "float tex1" 1 "float tex2" 0
Material "diffuse" "rgb reflectance" [0.6 0.55 0.5]
Shape "trianglemesh" "point3 P" [-6 -6 0 6 -6 0 6 6 0 -6 6 0] "integer indices" [0 1 2 0 2 3]
Material "diffuse" "rgb reflectance" [0.2 0.4 0.7]
AttributeBegin
  Translate -1.2 0 0.6
  Shape "sphere" "float radius" 0.6
AttributeEnd
AttributeBegin
  Translate 0.4 0.9 0.8
  Shape "sphere" "float radius" 0.7 "float zmin" -0.3 "float zmax" 0.5 "float phimax" 250
AttributeEnd
AttributeBegin
  Translate 1.6 0.3 0
  Shape "cylinder" "float radius" 0.35 "float zmin" 0 "float zmax" 1.1
  Translate 0 0 1.1
  Shape "disk" "float radius" 0.35
AttributeEnd
AttributeBegin
  Translate 0.2 -1.1 0.1
  Shape "bilinearmesh" "point3 P" [-0.5 0 0 0.5 0 0.3 -0.5 0.2 0.9 0.5 -0.3 0.7] "integer indices" [0 1 2 3]
  Shape "curve" "point3 P" [-1 0 0 -0.7 0.4 0.9 -0.3 -0.4 1.2 0 0 1.6] "float width" 0.12
AttributeEnd
Material "conductor" "spectrum eta" "metal-Au-eta" "spectrum k" "metal-Au-k" "float roughness" 0
AttributeBegin
  Translate 0.9 -1.4 0.35
  Shape "sphere" "float radius" 0.35
AttributeEnd
Material "diffuse" "rgb reflectance" [0.7 0.2 0.2]
AttributeBegin
  Translate 2.3 -0.9 0.05
  Shape "trianglemesh" "texture alpha" "board" "point3 P" [-0.7 0 0 0.7 0 0 0.7 0 1.2 -0.7 0 1.2] "point2 uv" [0 0 1 0 1 1 0 1] "integer indices" [0 1 2 0 2 3]
AttributeEnd
ObjectBegin "not placed"
  Shape "sphere" "float radius" 3
ObjectEnd
ObjectBegin "thing"
  Shape "trianglemesh" "point3 P" [0 0 0 0.5 0 0 0.2 0.5 0 0.25 0.2 0.8] "integer indices" [0 1 3 1 2 3 2 0 3 0 2 1]
  Translate 0.3 0.2 0.95
  Shape "sphere" "float radius" 0.2
ObjectEnd
AttributeBegin
  Translate -2.2 -0.6 0
  ObjectInstance "thing"
AttributeEnd
AttributeBegin
  Translate -0.4 1.6 0
  Scale -1.4 1 1
  ObjectInstance "thing"
AttributeEnd
"#;

fn scene_of(text: &str) -> Scene {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.pbrt");
    std::fs::write(&path, text).unwrap();
    let loaded = load(path.to_str().unwrap(), &Default::default());
    assert!(!loaded.diagnostics.has_errors());
    let options = CompileOptions { mode: Some(steradian::ColorMode::Rgb), ..CompileOptions::default() };
    compile(&loaded.desc, &options).scene.unwrap()
}

fn radiances(scene: &Scene, options: &str) -> Vec<[f64; 3]> {
    let quality = Quality { integrator: Some(format!("raster:frame=forward,{options}")), ..Quality::default() };
    film(scene, &quality, 0).unwrap().pixels.iter().map(|p| p.mean()).collect()
}

/// All samples that a quality asks for, on so many threads.
fn film(scene: &Scene, quality: &Quality, threads: usize) -> Result<Film, steradian::Error> {
    let scene = std::sync::Arc::new(scene.clone());
    let mut session = Quality { threads, ..quality.clone() }.render(&scene)?.session(&scene)?;
    session.step(u32::MAX, &Control::default());
    assert_eq!(session.failure(), None);
    Ok(session.film())
}

/// Why there is no picture.
fn refusal(scene: &Scene, options: &str) -> String {
    let quality = Quality { integrator: Some(format!("raster:frame=forward,{options}")), ..Quality::default() };
    film(scene, &quality, 0).unwrap_err().to_string()
}

/// The ray through a place of a pixel.
fn ray(scene: &Scene, x: u32, y: u32, at: Vec2) -> Ray {
    scene.camera().ray(scene.film(), Vec2::new(x as f32, y as f32) + at, Vec2::splat(0.5))
}

/// The primitive that a pixel sees is the one that its ray meets, or that a ray meets within the rounding of positions
/// (1/256 pixel) of it (M46).
#[test]
fn what_is_seen_is_what_rays_meet() {
    let scene = scene_of(SCENE);
    let list = DrawList::new(&scene);
    let projected = Projected::new(&scene, Vec2::splat(0.5)).unwrap();
    let visibility = Visibility::draw(&scene, &list, &projected).unwrap();
    let (mut equal, mut near, mut masked) = (0, 0, 0);
    for (x, y) in (0..200).flat_map(|x| (0..150).map(move |y| (x, y))) {
        let seen = visibility.seen(&scene, &list, &projected, [x, y]);
        let id = seen.map(|s| s.hit.id);
        let met = |at: Vec2| scene.intersect(&ray(&scene, x, y, at));
        match (seen, met(Vec2::splat(0.5))) {
            (Some(seen), Some(hit)) if seen.hit.id == hit.id => {
                equal += 1;
                assert!((seen.hit.t - hit.t).abs() < 1e-4 * hit.t, "{x} {y}: {} {}", seen.hit.t, hit.t);
            }
            (None, None) => equal += 1,
            // Where a mask is half open, chance decides by the bits of the point.
            (seen, hit) if [seen.map(|s| s.hit), hit].iter().flatten().any(|h| scene.geometry(h.id).is_masked()) => {
                masked += 1;
            }
            _ => {
                near += 1;
                let beside = |i: i32| Vec2::new((i % 3 - 1) as f32, (i / 3 - 1) as f32) / 100.0 + 0.5;
                assert!((0..9).any(|i| met(beside(i)).map(|h| h.id) == id), "{x} {y}: {id:?}");
            }
        }
    }
    assert!(equal > 29_900 && near < 60 && masked < 60, "{equal} {near} {masked}");
}

/// With lights that have one place, and mirrors, a pixel has the radiance of Whitted's ray tracing through its centre.
#[test]
fn light_is_that_of_rays() {
    let scene = scene_of(SCENE);
    // The half-open places of the mask are told by chance, as rays tell them.
    let found = radiances(&scene, "transparency=dither");
    let whitted = Whitted { depth: Depth { max: 8, roulette_after: 100, hide_emitters: false } };
    let sampler = Sampler { kind: scene.settings().sampler, spp: 1, seed: 0 };
    let (mut off, mut sum) = (0, 0.0);
    for (x, y) in (0..200).flat_map(|x| (0..150).map(move |y| (x, y))) {
        let centre = ray(&scene, x, y, Vec2::splat(0.5));
        let (mut lambda, counters) = (Wavelengths::RGB, &mut Counters::default());
        let sampler = &sampler.pixel(x, y, 0);
        let context = &mut PathContext { scene: &scene, sampler, lambda: &mut lambda, counters };
        let expected = whitted.radiance(&(), centre, context).to_rgb();
        let value = found[(y * 200 + x) as usize];
        sum += value[1];
        let differs =
            (0..3).any(|c| (value[c] - f64::from(expected[c])).abs() > 1e-3 * (f64::from(expected[c]) + 0.01));
        off += u32::from(differs);
    }
    // Pixels whose centre is within rounding of an edge, or of the border of a shadow.
    assert!(off < 90 && sum > 1000.0, "{off} {sum}");
}

/// Shadow maps differ from rays along the borders of shadows alone, by fewer pixels the finer they are, and none
/// without shadows is lit less (M228).
#[test]
fn shadow_maps_come_close_to_rays() {
    // Without the mask, whose half-open places are chance, and the curve: a flat ribbon that faces whoever looks at it
    // has no place that eye and light agree on.
    let without_mask = SCENE.replace("\"texture alpha\" \"board\"", "");
    let lines = without_mask.lines().filter(|line| !line.contains("Shape \"curve\""));
    let scene = scene_of(&lines.collect::<Vec<_>>().join("\n"));
    let (exact, open) = (radiances(&scene, "shadows=ray"), radiances(&scene, "shadows=none"));
    let wrong = |options: &str| {
        let found = radiances(&scene, options);
        let differs = |i: usize| (0..3).any(|c| (found[i][c] - exact[i][c]).abs() > 1e-3 * (exact[i][c] + 0.01));
        assert!((0..found.len()).all(|i| found[i][1] <= open[i][1] * 1.001 + 1e-6));
        let pixels: Vec<usize> = (0..found.len()).filter(|&i| differs(i)).collect();
        // A border is there where what rays find of shadow changes within 3 pixels.
        let shade = |i: usize| exact[i][1] / open[i][1].max(1e-9);
        let by_border = |i: &usize| {
            let (x, y) = ((i % 200) as i32, (i / 200) as i32);
            let around = (-3..=3).flat_map(|dx| (-3..=3).map(move |dy| (x + dx, y + dy)));
            let inside = around.filter(|(x, y)| (0..200).contains(x) && (0..150).contains(y));
            inside.map(|(x, y)| shade((y * 200 + x) as usize)).any(|s| (s - shade(*i)).abs() > 0.02)
        };
        (pixels.len(), pixels.iter().filter(|i| !by_border(i)).count())
    };
    let (coarse, _) = wrong("shadows=map,size=256");
    let (fine, stray) = wrong("shadows=map,size=2048");
    assert!(coarse < 3000 && fine * 3 < coarse && stray < 30, "{coarse} {fine} {stray}");
    // Four by four texels soften borders, no more.
    assert!(wrong("shadows=map,size=2048,pcf=4").0 < 1500);
}

/// Films have equal bits for any number of threads, crops are parts of the whole, and more samples converge.
#[test]
fn threads_crops_and_samples() {
    let scene = scene_of(SCENE);
    let with_threads = |threads: usize| {
        let quality = Quality { integrator: Some("raster:shadows=map,size=256".into()), ..Quality::default() };
        film(&scene, &quality, threads).unwrap().pixels.iter().map(|p| p.mean()).collect::<Vec<_>>()
    };
    let first = with_threads(1);
    assert!((2..=4).all(|threads| with_threads(threads) == first));
    let crop = steradian_core::film::Crop { x0: 37, y0: 20, x1: 120, y1: 101 };
    let part = scene.clone().changed(|parts| parts.film.crop = crop);
    let (whole, part) = (radiances(&scene, "show=primitives"), radiances(&part, "show=depth"));
    assert_eq!((whole.len(), part.len()), (200 * 150, 83 * 81));
    let whole = radiances(&scene, "show=depth");
    for (i, pixel) in part.iter().enumerate() {
        assert_eq!(*pixel, whole[(20 + i / 83) * 200 + 37 + i % 83], "{i}");
    }
    // The mean of many samples is that of the picture with few, but for edges.
    let quality = Quality { spp: Some(16), integrator: Some("raster".into()), ..Quality::default() };
    let smooth = film(&scene, &quality, 0).unwrap();
    let mean = |pixels: &[[f64; 3]]| pixels.iter().map(|p| p[1]).sum::<f64>() / pixels.len() as f64;
    let smooth: Vec<_> = smooth.pixels.iter().map(|p| p.mean()).collect();
    let sharp = radiances(&scene, "");
    assert!((mean(&smooth) / mean(&sharp) - 1.0).abs() < 0.01, "{} {}", mean(&smooth), mean(&sharp));
}

/// Infinite planes, parallel rays, an eye inside a sphere, nothing at all.
#[test]
fn odd_scenes() {
    let head = "Film \"rgb\" \"integer xresolution\" 33 \"integer yresolution\" 17\nWorldBegin\nLightSource \"infinite\" \"rgb L\" [1 1 1]\n";
    let empty = scene_of(&format!("Camera \"perspective\"\n{head}"));
    assert!(radiances(&empty, "").iter().all(|p| (p[1] - 1.0).abs() < 1e-5));
    // A white furnace: directions are drawn as the surface scatters, so each has all light.
    let inside = scene_of(&format!(
        "Camera \"perspective\"\n{head}Material \"diffuse\" \"rgb reflectance\" [1 1 1]\nShape \"sphere\""
    ));
    let furnace = radiances(&inside, "shadows=none");
    let mean = furnace.iter().map(|p| p[1]).sum::<f64>() / furnace.len() as f64;
    assert!((mean - 1.0).abs() < 1e-4, "{mean}");
    let flat =
        scene_of(&format!("Camera \"orthographic\"\n{head}Translate 0 0 3 Shape \"sphere\" \"float radius\" 0.5"));
    let list = DrawList::new(&flat);
    let projected = Projected::new(&flat, Vec2::splat(0.5)).unwrap();
    let visibility = Visibility::draw(&flat, &list, &projected).unwrap();
    for (x, y) in (0..33).flat_map(|x| (0..17).map(move |y| (x, y))) {
        let seen = visibility.seen(&flat, &list, &projected, [x, y]).is_some();
        assert_eq!(seen, flat.intersect(&ray(&flat, x, y, Vec2::splat(0.5))).is_some(), "{x} {y}");
    }
    let around = scene_of(&format!("Camera \"spherical\"\n{head}"));
    assert!(refusal(&around, "").contains("perspective or orthographic camera"));
}

/// A table, a box, a sheet and posts on a floor, in parallel light.
const TABLE: &str = include_str!("../../../../scenes/shadows.pbrt");
const PARALLEL: &str =
    "LightSource \"distant\" \"rgb L\" [1.6 1.5 1.3] \"point3 from\" [-3 -2 4] \"point3 to\" [0 0 0]";
const POINT: &str = "LightSource \"point\" \"rgb I\" [30 28 24] \"point3 from\" [-2.2 -1.4 3.1]";

/// Shares of the light that pixels have, by what they would have without shadows; none where that is nothing.
fn shares(scene: &Scene, options: &str) -> Vec<Option<f64>> {
    let (found, open) = (radiances(scene, options), radiances(scene, "shadows=none"));
    found.iter().zip(open).map(|(a, b)| (b[1] > 1e-6).then(|| a[1] / b[1])).collect()
}

/// Pixels whose shares differ.
fn differing(a: &[Option<f64>], b: &[Option<f64>]) -> Vec<usize> {
    let differ = |i: &usize| a[*i].zip(b[*i]).is_some_and(|(a, b)| (a - b).abs() > 1e-3);
    (0..a.len()).filter(differ).collect()
}

/// The stencil buffer tells what rays tell, but where the ray of a pixel passes within the rounding of positions (1/256
/// pixel) of an edge of a shadow or of what casts it: in parallel light and that of a point, with the eye in light and
/// in shadow, among all kinds of shapes (M234).
#[test]
fn shadow_volumes_are_ray_cast_shadows() {
    let among_legs = "LookAt 1.2 0.2 0.5  2.2 3 0.2  0 0 1";
    let from_outside = "LookAt 0 -9 2.2  0 0 0.9  0 0 1";
    let point = TABLE.replace(PARALLEL, POINT);
    assert!(point != TABLE && TABLE.contains(from_outside));
    let without_mask = SCENE.replace("\"texture alpha\" \"board\"", "");
    let without_curve: Vec<_> = without_mask.lines().filter(|line| !line.contains("Shape \"curve\"")).collect();
    let cases = [
        (TABLE.to_owned(), true),
        (point.clone(), true),
        (TABLE.replace(from_outside, among_legs), false),
        (point.replace(from_outside, among_legs), false),
        (without_curve.join("\n"), true),
    ];
    for (number, (text, eye_is_lit)) in cases.into_iter().enumerate() {
        let scene = scene_of(&text);
        let width = scene.film().width as usize;
        let (exact, volumes) = (shares(&scene, "shadows=ray"), shares(&scene, "shadows=volume"));
        assert!(exact.iter().flatten().any(|s| *s < 0.9));
        let wrong = differing(&exact, &volumes);
        let beside = |i: usize, dx: i32, dy: i32| {
            let at = Vec2::new(dx as f32, dy as f32) / 100.0 + 0.5;
            let ray = ray(&scene, (i % width) as u32, (i / width) as u32, at);
            let hit = scene.intersect(&ray)?;
            let i = scene.interaction(&ray, &hit);
            let lit = |light: u32| {
                let ctx = steradian_core::light::LightContext { p: i.surface.p, n: Vec3::ZERO };
                let s = scene.lights().sample(light, &ctx, Vec2::splat(0.5), &Wavelengths::RGB, scene.textures())?;
                Some(!scene.occluded(&i.spawn_towards(s.wi, s.distance)))
            };
            Some((0..scene.lights().lights.len() as u32).map(lit).collect::<Vec<_>>())
        };
        let off_edges = wrong.iter().filter(|&&i| {
            let here = beside(i, 0, 0);
            !(0..9).any(|k| beside(i, k % 3 - 1, k / 3 - 1) != here)
        });
        let off_edges: Vec<_> = off_edges.map(|i| (i % width, i / width)).collect();
        assert!(off_edges.is_empty() && wrong.len() < 40, "case {number}: {} wrong, {off_edges:?}", wrong.len());
        let before = differing(&exact, &shares(&scene, "shadows=volume-pass")).len();
        assert!(if eye_is_lit { before < 40 } else { before > 1000 }, "case {number}: {before}");
    }
}

/// Every map errs by at most a texel: where it differs from rays, rays that start within a texel's width differ, too.
/// Bent and split maps err in fewer pixels than plain ones of their size (M228, M232, M233), and a cube in one pass is
/// six maps (M231).
#[test]
fn shadow_maps_err_within_a_texel() {
    let scene = scene_of(TABLE);
    let exact = shares(&scene, "shadows=ray");
    let (size, radius) = (512, scene.bounds().bounding_sphere().1);
    let texel = 2.0 * 1.01 * radius / size as f32;
    let wi = Vec3::new(-3.0, -2.0, 4.0).normalize();
    let (right, up) = wi.any_orthonormal_pair();
    let by_border = |pixel: usize| {
        let ray = ray(&scene, (pixel % 480) as u32, (pixel / 480) as u32, Vec2::splat(0.5));
        let Some(hit) = scene.intersect(&ray) else { return false };
        let at = scene.interaction(&ray, &hit);
        let lit = |x: f32, y: f32| {
            let aside = right * x + up * y;
            // On the surface, which is flat.
            let aside = aside - wi * (at.surface.n.dot(aside) / at.surface.n.dot(wi));
            let mut moved = at;
            moved.surface.p += aside;
            !scene.occluded(&moved.spawn_towards(wi, f32::INFINITY))
        };
        let here = lit(0.0, 0.0);
        // A texel, and what the bias adds on surfaces that the light grazes.
        let steps = || (-8..=8).map(|i| i as f32 / 8.0 * 1.5 * texel);
        steps().any(|x| steps().any(|y| lit(x, y) != here))
    };
    let mut counts = std::collections::HashMap::new();
    for kind in [
        "map",
        "map,bias-by=normal",
        "map,bias-by=plane",
        "trapezoid,bias-by=plane",
        "perspective,bias-by=plane",
        "cascades,bias-by=plane",
    ] {
        let found = shares(&scene, &format!("shadows={kind},size={size}"));
        let wrong = differing(&exact, &found);
        let stray: Vec<_> = wrong.iter().filter(|i| !by_border(**i)).map(|i| (i % 480, i / 480)).collect();
        assert!(stray.is_empty(), "{kind}: {} of {} pixels off borders: {stray:?}", stray.len(), wrong.len());
        counts.insert(kind, wrong.len());
    }
    let plain = counts["map,bias-by=plane"];
    for kind in ["trapezoid", "perspective", "cascades"] {
        let better = counts[&*format!("{kind},bias-by=plane")];
        assert!(2 * better < plain && better > 0, "{kind}: {better} of {plain}");
    }
    let lamp = scene_of(&TABLE.replace(PARALLEL, POINT));
    assert_eq!(radiances(&lamp, "shadows=cube,size=256"), radiances(&lamp, "shadows=map,size=256"));
}

/// On what is flat, projected shadows are those of rays (M235).
#[test]
fn projected_shadows_are_exact_on_planes() {
    for text in [TABLE.to_owned(), TABLE.replace(PARALLEL, POINT)] {
        let scene = scene_of(&text);
        let (exact, found) = (shares(&scene, "shadows=ray"), shares(&scene, "shadows=planar"));
        let is_floor = |i: &usize| {
            let ray = ray(&scene, (i % 480) as u32, (i / 480) as u32, Vec2::splat(0.5));
            scene.intersect(&ray).is_some_and(|hit| ray.at(hit.t).z.abs() < 1e-4)
        };
        let dark = (0..found.len()).filter(|i| found[*i].is_some_and(|s| s < 0.01)).count();
        let wrong = differing(&exact, &found).into_iter().filter(is_floor).count();
        assert!(dark > 1000 && wrong < 12, "{wrong} of {dark}");
    }
}

/// M229: a share by percentage-closer filtering is a number of texels that pass over all that are compared: 4, 16, 25,
/// and 7 or 12 of 25 for sparse kernels; of the border each of them is met.
#[test]
fn filtered_comparisons_are_fractions() {
    let scene = scene_of(TABLE);
    for (options, count) in
        [("pcf=2", 4.0), ("pcf=4", 16.0), ("pcf=5", 25.0), ("pcf=5,pcf-samples=7", 7.0), ("pcf=5,pcf-samples=12", 12.0)]
    {
        let found = shares(&scene, &format!("shadows=map,size=512,{options}"));
        let mut met = std::collections::BTreeSet::new();
        for share in found.into_iter().flatten() {
            let passed = share * count;
            assert!((passed - passed.round()).abs() < 2e-4 * count, "{options}: {share}");
            met.insert(passed.round() as u32);
        }
        assert_eq!(met.len() as f64, count + 1.0, "{options}: {met:?}");
    }
}

/// M236: the penumbra of a half-plane under a square lamp, by rays, is the light of the part of the lamp that a point
/// of the floor sees: all places x of the lamp above −x of the point, since the edge hangs at half its height. The
/// integral of cos⁴θ/h² over that part, by 400² midpoints.
#[test]
fn penumbrae_are_those_of_the_integral() {
    let scene = scene_of(
        r#"
LookAt 0 -7 3  0 0 0  0 0 1
Camera "perspective" "float fov" 30
Film "rgb" "integer xresolution" 90 "integer yresolution" 60
WorldBegin
AttributeBegin
  AreaLightSource "diffuse" "rgb L" [9 9 9]
  Shape "trianglemesh" "point3 P" [-0.6 -0.6 4 -0.6 0.6 4 0.6 0.6 4 0.6 -0.6 4] "integer indices" [0 1 2 0 2 3]
AttributeEnd
Material "diffuse" "rgb reflectance" [0.6 0.6 0.6]
Shape "trianglemesh" "point3 P" [-6 -6 0 6 -6 0 6 6 0 -6 6 0] "integer indices" [0 1 2 0 2 3]
Shape "trianglemesh" "point3 P" [-30 -30 2 0 -30 2 0 30 2 -30 30 2] "integer indices" [0 1 2 0 2 3]
"#,
    );
    let [found, open] = ["ray", "none"].map(|kind| radiances(&scene, &format!("shadows={kind},points=1024")));
    let found: Vec<_> = found.iter().zip(open).map(|(a, b)| (b[1] > 1e-6).then(|| a[1] / b[1])).collect();
    let (mut count, mut sum, mut largest) = (0, 0.0, 0f64);
    for (pixel, share) in found.iter().enumerate() {
        let ray = ray(&scene, pixel as u32 % 90, pixel as u32 / 90, Vec2::splat(0.5));
        let Some((hit, share)) = scene.intersect(&ray).zip(*share) else { continue };
        let p = scene.interaction(&ray, &hit).surface.p.as_dvec3();
        if p.z.abs() > 1e-3 || p.x.abs() > 0.6 {
            continue;
        }
        let (mut whole, mut seen) = (0.0, 0.0);
        for k in 0..160_000 {
            let at = |i: u32| (f64::from(i) + 0.5) / 400.0 * 1.2 - 0.6;
            let (x, y) = (at(k % 400), at(k / 400));
            let light = ((x - p.x).powi(2) + (y - p.y).powi(2) + 16.0).powi(-2);
            whole += light;
            seen += if x > -p.x { light } else { 0.0 };
        }
        count += 1;
        sum += (share - seen / whole).abs();
        largest = largest.max((share - seen / whole).abs());
    }
    assert!(
        count > 300 && sum / f64::from(count) < 0.004 && largest < 0.02,
        "{count} {} {largest}",
        sum / f64::from(count)
    );
}

/// Soft shadows by maps are close to those of rays (M230) if one plane casts the shadow of a lamp that is parallel to
/// it: in the mean over the penumbra to four hundredths, and nowhere off by more than a quarter.
#[test]
fn soft_shadows_by_maps_are_close_to_rays() {
    let text = r#"
LookAt 0 -6 3  0 0 0  0 0 1
Camera "perspective" "float fov" 40
Film "rgb" "integer xresolution" 120 "integer yresolution" 90
WorldBegin
AttributeBegin
  AreaLightSource "diffuse" "rgb L" [9 9 9]
  Shape "trianglemesh" "point3 P" [-0.6 -0.4 4 -0.6 0.4 4 0.6 0.4 4 0.6 -0.4 4] "integer indices" [0 1 2 0 2 3]
AttributeEnd
Material "diffuse" "rgb reflectance" [0.6 0.6 0.6]
Shape "trianglemesh" "point3 P" [-6 -6 0 6 -6 0 6 6 0 -6 6 0] "integer indices" [0 1 2 0 2 3]
Shape "trianglemesh" "point3 P" [-0.8 -0.8 1.2 0.8 -0.8 1.2 0.8 0.8 1.2 -0.8 0.8 1.2] "integer indices" [0 1 2 0 2 3]
"#;
    let scene = scene_of(text);
    let exact = shares(&scene, "shadows=ray,points=200");
    let soft = shares(&scene, "shadows=pcss,points=200,size=512");
    let (mut penumbra, mut sum, mut largest) = (0, 0.0, 0f64);
    for (a, b) in exact.iter().zip(&soft).filter_map(|(a, b)| a.zip(*b)) {
        largest = largest.max((a - b).abs());
        if a > 0.02 && a < 0.98 {
            penumbra += 1;
            sum += (a - b).abs();
        }
    }
    let mean = sum / f64::from(penumbra);
    // The samples of both are 48 and 200 points: differences of a few hundredths are theirs.
    assert!(penumbra > 500 && mean < 0.04 && largest < 0.25, "{penumbra} {mean} {largest}");
}

/// BSP order, Newell's sort and Warnock's subdivision give the depth buffer's picture, but where a pixel's centre is
/// within rounding of an edge: for many things, for triangles that cross, and for three that lie before one another in
/// a circle, which the painter's algorithm gets wrong (M42, M242, M243, M244).
#[test]
fn every_order_shows_what_the_depth_buffer_shows() {
    let head = "LookAt 0 0 -6  0 0 0  0 1 0\nCamera \"perspective\" \"float fov\" 40\nFilm \"rgb\" \"integer xresolution\" 150 \"integer yresolution\" 150\nWorldBegin\n";
    let shape = |p: &str| format!("Shape \"trianglemesh\" \"point3 P\" [{p}] \"integer indices\" [0 1 2]\n");
    // Each begins behind the one before and ends before the one after.
    let circle: String = (0..3)
        .map(|k| {
            let turn = |x: f32, y: f32, z: f32| {
                let (sin, cos) = (k as f32 * std::f32::consts::TAU / 3.0).sin_cos();
                format!("{} {} {z} ", x * cos - y * sin, x * sin + y * cos)
            };
            shape(&(turn(-1.6, -0.9, 0.4) + &turn(1.6, -0.8, -0.4) + &turn(1.5, -0.4, -0.4)))
        })
        .collect();
    let crossing = shape("-1 -1 -0.5 1 -0.8 0.7 0.1 1 0")
        + &shape("-1 0.9 0.6 1 0.7 -0.6 -0.2 -1 0.1")
        + &shape("-1.2 0 0 1 0.1 -0.3 0.9 0.3 0.6");
    let apart: String = (0..20)
        .map(|k| {
            let z = (k * 7 % 20) as f32 / 5.0;
            shape(&format!("{} -1 {z} 1 {} {z} -0.5 1.1 {z}", -1.0 + k as f32 / 30.0, k as f32 / 10.0 - 1.0))
        })
        .collect();
    let cases = [
        (TABLE.to_owned(), None),
        (SCENE.to_owned(), None),
        (format!("{head}{circle}"), Some(false)),
        (format!("{head}{crossing}"), Some(false)),
        (format!("{head}{apart}"), Some(true)),
    ];
    for (case, (text, can_be_sorted)) in cases.into_iter().enumerate() {
        let scene = scene_of(&text);
        let (list, projected) = (DrawList::new(&scene), Projected::new(&scene, Vec2::splat(0.5)).unwrap());
        let by = |method| {
            Visibility::draw_wanted(&scene, &list, &projected, Wanted { method: Some(method), ..Wanted::default() })
                .unwrap()
        };
        let expected = by(Method::ZBuffer);
        let wrong = |found: &Visibility| {
            let (width, height) = (scene.film().width, scene.film().height);
            let id = |v: &Visibility, at| v.seen(&scene, &list, &projected, at).map(|s| s.hit.id);
            let pixels = (0..height).flat_map(|y| (0..width).map(move |x| [x, y]));
            let differ: Vec<_> = pixels.filter(|&at| id(found, at) != id(&expected, at)).collect();
            let off_edges = differ.iter().filter(|&&[x, y]| {
                let beside = |i: i32| Vec2::new((i % 3 - 1) as f32, (i / 3 - 1) as f32) / 100.0 + 0.5;
                !(0..9).any(|i| scene.intersect(&ray(&scene, x, y, beside(i))).map(|h| h.id) == id(found, [x, y]))
            });
            (differ.len(), off_edges.count())
        };
        for method in [Method::Bsp, Method::Newell, Method::Warnock] {
            let (differ, off_edges) = wrong(&by(method));
            assert!(differ < 60 && off_edges == 0, "case {case}, {method:?}: {differ} {off_edges}");
        }
        let (_, painter) = wrong(&by(Method::Painter));
        match can_be_sorted {
            Some(true) => assert_eq!(painter, 0),
            Some(false) => assert!(painter > 10, "case {case}: {painter}"),
            None => {}
        }
    }
}

/// In a room of 36 000 triangles, many of them thin, the orders show what the depth buffer shows, at every pixel: parts
/// of a triangle leave no gaps, and are ordered right however small they are.
#[test]
fn orders_of_a_room_are_those_of_the_depth_buffer() {
    let Some(path) = steradian_testkit::asset("pbrt/staircase2/scene-v4.pbrt") else { return };
    let loaded = load(path.to_str().unwrap(), &Default::default());
    let options = CompileOptions { size: Some((320, 480)), ..CompileOptions::default() };
    let scene = compile(&loaded.desc, &options).scene.unwrap();
    let (list, projected) = (DrawList::new(&scene), Projected::new(&scene, Vec2::splat(0.5)).unwrap());
    let by = |method| {
        Visibility::draw_wanted(&scene, &list, &projected, Wanted { method: Some(method), ..Wanted::default() })
            .unwrap()
    };
    let expected = by(Method::ZBuffer);
    for method in [Method::Bsp, Method::Newell, Method::Warnock] {
        assert_eq!(by(method).differing(&expected), 0, "{method:?}");
    }
    assert!(by(Method::Painter).differing(&expected) > 1000);
}

/// Overdraw counts the triangles that the ray of a pixel meets, at every seventh column and fifth row; tiles list as
/// many primitives together as the pipeline bins; views that need a light refuse scenes without it (M46, M47).
#[test]
fn lesson_views_count_what_they_show() {
    let scene = scene_of(TABLE);
    let (list, projected) = (DrawList::new(&scene), Projected::new(&scene, Vec2::splat(0.5)).unwrap());
    let counts = lesson::overdraw(&scene, &list, &projected).unwrap();
    let met = |x: u32, y: u32, at: Vec2| {
        let mut ray = ray(&scene, x, y, at);
        let mut met = 0.0;
        while let Some(hit) = scene.intersect(&ray) {
            met += 1.0;
            let i = scene.interaction(&ray, &hit);
            ray = i.spawn(ray.direction);
        }
        met
    };
    let mut most = 0f32;
    for (x, y) in (0..480).step_by(7).flat_map(|x| (0..270).step_by(5).map(move |y| (x, y))) {
        let count = counts[(y * 480 + x) as usize];
        most = most.max(count);
        let beside = |i: i32| Vec2::new((i % 3 - 1) as f32, (i / 3 - 1) as f32) / 100.0 + 0.5;
        // Through the centre, or beside it where it is within rounding of an edge.
        assert!([4, 0, 1, 2, 3, 5, 6, 7, 8].into_iter().any(|i| met(x, y, beside(i)) == count), "{x} {y}: {count}");
    }
    assert!(most >= 5.0);
    let (extent, tiles) = lesson::tiles(&scene, &list, &projected).unwrap();
    assert_eq!((extent.width, tiles.len()), (480, 8 * 5));
    let drawn = Visibility::draw(&scene, &list, &projected).unwrap();
    assert_eq!(tiles.iter().sum::<u64>(), drawn.counters.binned);
    // Views that need a light say so.
    let dark = scene_of(&TABLE.replace(PARALLEL, ""));
    for (show, part) in [("stencil", "parallel light"), ("shadow-map", "shadows=map")] {
        let error = refusal(&dark, &format!("show={show}"));
        assert!(error.contains(part), "{error}");
    }
    for show in ["wireframe", "clip", "stencil", "shadow-map,shadows=cascades"] {
        let found = radiances(&scene, &format!("show={show}"));
        let colors: std::collections::HashSet<_> = found.iter().map(|p| p.map(f64::to_bits)).collect();
        assert!(colors.len() > 1, "{show}");
    }
}

/// A scene of `scenes/verify`, small.
fn verified(name: &str) -> Scene {
    let path = format!("{}/../../scenes/verify/{name}.pbrt", env!("CARGO_MANIFEST_DIR"));
    let loaded = load(&path, &Default::default());
    let mode = Some(steradian::ColorMode::Rgb);
    compile(&loaded.desc, &CompileOptions { mode, size: Some((32, 32)), ..Default::default() }).scene.expect(name)
}

/// A sheet with a normal map of steep dents under a lamp and a dim sky.
fn dented() -> Scene {
    let folder = tempfile::tempdir().unwrap();
    let mut normals = steradian::image::Image::new(16, 16);
    let tilt = |k: usize, axis: usize| [0.1, 0.5, 0.9, 0.5][(if axis == 0 { k % 16 } else { k / 16 }) % 4];
    for (axis, name) in ["R", "G", "B"].into_iter().enumerate() {
        let plane = (0..256).map(|k| if axis == 2 { 0.75 } else { tilt(k, axis) }).collect();
        normals.push(name, plane).unwrap();
    }
    let path = folder.path().join("n.exr");
    steradian::image::write(&path, &normals, &Default::default()).unwrap();
    let text = r#"<scene version="3.0.0"><sensor type="perspective"><float name="fov" value="40"/>
        <transform name="to_world"><lookat origin="0,-2,1" target="0,0,0" up="0,0,1"/></transform>
        <film type="hdrfilm"><integer name="width" value="32"/><integer name="height" value="32"/></film></sensor>
        <emitter type="constant"><rgb name="radiance" value="0.2,0.2,0.25"/></emitter>
        <shape type="sphere"><point name="center" x="1.7" y="0" z="0.6"/><float name="radius" value="0.3"/>
        <emitter type="area"><rgb name="radiance" value="9,9,9"/></emitter></shape>
        <shape type="rectangle"><bsdf type="normalmap"><texture type="bitmap"><string name="filename" value="n.exr"/>
        <boolean name="raw" value="true"/></texture><bsdf type="diffuse"/></bsdf></shape></scene>"#;
    let path = folder.path().join("s.xml");
    std::fs::write(&path, text).unwrap();
    let loaded = load(path.to_str().unwrap(), &Default::default());
    let mode = Some(steradian::ColorMode::Rgb);
    let scene = compile(&loaded.desc, &CompileOptions { mode, ..Default::default() }).scene.unwrap();
    assert!(scene.has_surface_detail());
    scene
}

/// Direct light is that of `direct` under bump maps, normal maps and masks, with textures, many lights and a sky: means
/// of blocks of 8 × 8 pixels agree within four times their errors and a hundredth, the picture's within five
/// thousandths.
#[test]
fn direct_light_is_that_of_rays() {
    let verified = ["bumps", "masked", "textured", "sky-and-lamp", "many-lights"].map(|name| (name, verified(name)));
    for (name, scene) in verified.into_iter().chain([("a normal map", dented())]) {
        let of = |integrator: &str| {
            let integrator = Some(integrator.to_owned());
            film(&scene, &Quality { integrator, spp: Some(256), seed: Some(3), ..Quality::default() }, 0).unwrap()
        };
        let (a, b) = (of("raster:bounces=0,points=1"), of("direct"));
        let (mut far, mut sum, mut of_sum) = (0, [0.0; 2], 0.0);
        for block in 0..16 {
            let pixels = (0..64).map(|k| (block / 4 * 8 + k / 8) * 32 + block % 4 * 8 + k % 8);
            let mean = |film: &Film| pixels.clone().map(|at| film.pixels[at].mean()[1]).sum::<f64>() / 64.0;
            let variance =
                |film: &Film| pixels.clone().map(|at| film.pixels[at].variance_of_mean()[1]).sum::<f64>() / 4096.0;
            let (x, y, v) = (mean(&a), mean(&b), variance(&a) + variance(&b));
            // Places that all pixels share err alike within a block.
            far += u32::from((x - y).abs() > 4.0 * v.sqrt() + 0.01 * y);
            (sum, of_sum) = ([sum[0] + x, sum[1] + y], of_sum + v);
        }
        let [x, y] = sum.map(|s| s / 16.0);
        assert!(far == 0 && (x / y - 1.0).abs() < 5e-3, "{name}: {far} blocks are far off; {x} for {y} ± {of_sum}");
    }
}

/// Layers, a crop, more samples after a stop, groups of lights whose sum is the picture, and a limit on events.
#[test]
fn it_is_rendered_as_others_are() {
    let scene = std::sync::Arc::new(scene_of(SCENE));
    let mut layers = steradian::Layer::ALL.to_vec();
    layers.retain(|layer| ![steradian::Layer::HALVES, steradian::Layer::BOUNCES].contains(layer));
    let quality = Quality { integrator: Some("raster".into()), spp: Some(4), layers, ..Quality::default() };
    let render = quality.render(&scene).unwrap();
    let mut session = render.session(&scene).unwrap();
    session.step(u32::MAX, &Control::default());
    let film = session.film();
    for (at, pixel) in film.pixels.iter().enumerate() {
        let groups = scene.light_groups().names.len();
        let sum: f64 = film.layers.by_light[at * groups..(at + 1) * groups].iter().map(|l| l[1]).sum();
        assert!((sum - pixel.sum[1]).abs() < 1e-5 * (pixel.sum[1].abs() + 1.0), "{sum} {}", pixel.sum[1]);
        assert_eq!((pixel.samples, film.layers.features[at].samples, film.layers.mattes[at].samples), (4, 4, 4));
    }
    // What camera rays see covers what is drawn: by the same places of pixels.
    let picture = steradian::develop(&scene, &film, &quality.layers);
    let covered = picture.channel("A").unwrap().iter().sum::<f32>();
    assert!(covered > 0.5 * film.pixels.len() as f32 && picture.channel("crypto_object00.r").is_some());
    let mut state = Vec::new();
    let mut first = render.session(&scene).unwrap();
    first.step(2, &Control::default());
    first.save(&mut state).unwrap();
    let mut second = render.session(&scene).unwrap();
    second.restore(&mut &state[..]).unwrap();
    second.step(u32::MAX, &Control::default());
    let bits = |film: &Film| film.pixels.iter().map(|p| p.sum.map(f64::to_bits)).collect::<Vec<_>>();
    assert_eq!(bits(&second.film()), bits(&film));
    let limited = |max| film_of(&scene, &Quality { max_depth: Some(max), layers: Vec::new(), ..quality.clone() });
    let light = |film: &Film| film.pixels.iter().map(|p| p.sum[1]).sum::<f64>();
    assert_eq!(light(&limited(0)), 0.0, "nothing shines by itself");
    assert!(light(&limited(1)) < light(&limited(2)), "the mirror shows what is lit");
}

fn film_of(scene: &Scene, quality: &Quality) -> Film {
    film(scene, quality, 0).unwrap()
}
