//! `steradian bake light`: irradiance against closed forms and the light meter, and faults.

use crate::Place;
use std::f64::consts::PI;
use steradian::{
    CompileOptions,
    formats::Options,
    integrators::Depth,
    lightmap,
    math::{DVec2, DVec3},
    meter::{self, Receiver},
    unwrap,
};

const SIDE: usize = 32;
const BAKE: [&str; 6] = ["--resolution", "32", "--padding", "2", "-o", "map.exr"];

fn bake(place: &Place, scene: &str, more: &[&str]) -> Vec<[f32; 3]> {
    place.succeed(&[&["bake", "light", scene][..], &BAKE, more].concat());
    place.picture("map.exr").to_rgb().unwrap()
}

/// Mitsuba's square of [−1, 1]² that faces +z, placed, of a reflectance, with something more.
fn square(place: &str, reflectance: f64, more: &str) -> String {
    format!(
        "<shape type='rectangle'><transform name='to_world'>{place}</transform><bsdf type='diffuse'>\
         <rgb name='reflectance' value='{reflectance}'/></bsdf>{more}</shape>"
    )
}

fn lamp(radiance: f64) -> String {
    format!("<emitter type='area'><rgb name='radiance' value='{radiance}'/></emitter>")
}

fn scene(what: &str) -> String {
    format!("<scene version='3.0.0'><sensor type='perspective'/>{what}</scene>")
}

/// The point and the normal of the surface at the centres of texels.
fn points(place: &Place, name: &str) -> Vec<Option<(DVec3, DVec3)>> {
    let desc = steradian::load(place.path(name), &Options::default()).desc;
    let atlas = unwrap::Options { resolution: SIDE as u32, padding: 2, ..unwrap::Options::default() };
    let desc = lightmap::laid_out(&desc, atlas).unwrap().0;
    let mut points = vec![None; SIDE * SIDE];
    for shape in &desc.shapes {
        let mesh = &desc.meshes[shape.mesh.unwrap()];
        let uv = &mesh.attributes.iter().find(|a| a.name == "uv1").unwrap().data;
        for triangle in mesh.triangles.iter() {
            let texel = |i: u32| DVec2::new(uv[2 * i as usize].into(), uv[2 * i as usize + 1].into()) * SIDE as f64;
            let position = |i: u32| {
                let p = DVec3::from(mesh.positions[i as usize].map(f64::from));
                shape.world_from_object.matrix.transform_point3(p)
            };
            let ([a, b, c], [p, q, r]) = (triangle.map(texel), triangle.map(position));
            let area = (b - a).perp_dot(c - a);
            for (k, point) in points.iter_mut().enumerate() {
                let t = DVec2::new((k % SIDE) as f64 + 0.5, (k / SIDE) as f64 + 0.5) - a;
                let (u, v) = (t.perp_dot(c - a) / area, (b - a).perp_dot(t) / area);
                if u.min(v).min(1.0 - u - v) >= 1e-6 {
                    *point = Some((p + (q - p) * u + (r - p) * v, (q - p).cross(r - p).normalize()));
                }
            }
        }
    }
    points
}

/// Under a sky of radiance 1 all irradiances are π; in a closed box whose walls emit 1 and reflect one half, 2π.
/// Texels within the padding have values too.
#[test]
fn even_light_gives_even_maps() {
    let place = Place::new();
    let open = square("", 0.5, "") + "<emitter type='constant'><rgb name='radiance' value='1'/></emitter>";
    place.file("open.xml", &scene(&open));
    let wall = lamp(1.0) + "<boolean name='flip_normals' value='true'/>";
    place.file("closed.xml", &scene(&square("", 0.5, &wall).replace("rectangle", "cube")));
    for (name, expected) in [("open.xml", PI), ("closed.xml", 2.0 * PI)] {
        let map = bake(&place, name, &["--spp", "256", "--max-depth", "-1"]);
        let (mut sum, mut count) = (0.0, 0);
        for (k, at) in points(&place, name).iter().enumerate().filter(|(_, at)| at.is_some()) {
            assert!((f64::from(map[k][1]) / expected - 1.0).abs() < 0.1, "{name} {k} {at:?}: {:?}", map[k]);
            (sum, count) = (sum + f64::from(map[k][1]), count + 1);
            for near in [k - 1, k + 1, k - SIDE, k + SIDE, k + SIDE + 1] {
                assert!(map.get(near).is_none_or(|v| v[1] > 0.0), "{name}: nothing beside {k}");
            }
        }
        assert!((sum / f64::from(count) / expected - 1.0).abs() < 3e-3, "{name}: {}", sum / f64::from(count));
    }
    let ao = bake(&place, "open.xml", &["--parts", "ao", "--spp", "4"]);
    assert!(points(&place, "open.xml").iter().zip(&ao).all(|(at, v)| at.is_none() || *v == [1.0; 3]));
}

const DOWN: &str = "<rotate x='1' angle='180'/>";

/// E = L A cos⁴θ / h² under a small lamp.
#[test]
fn a_small_lamp_gives_its_closed_form() {
    let place = Place::new();
    let floor = square("", 0.5, "");
    let lamp = square(&format!("<scale value='0.01'/>{DOWN}<translate z='1.5'/>"), 0.0, &lamp(1000.0));
    place.file("lamp.xml", &scene(&(floor + &lamp)));
    let map = bake(&place, "lamp.xml", &["--spp", "64", "--parts", "direct"]);
    let points = points(&place, "lamp.xml");
    let floor = points.iter().enumerate().filter_map(|(k, at)| Some((k, at.filter(|at| at.0.z < 0.1)?.0)));
    let mut count = 0;
    for (k, p) in floor {
        let expected = 1000.0 * 4e-4 * 1.5_f64.powi(2) / (p - DVec3::Z * 1.5).length_squared().powi(2);
        assert!((f64::from(map[k][0]) / expected - 1.0).abs() < 1e-3, "{p}: {} {expected}", map[k][0]);
        count += 1;
    }
    assert!(count > 100);
}

/// A box with a lamp: the mean of eight maps is within three standard errors of the meter, direct and indirect light
/// add up to all of it, and one thread gives the bits of two.
#[test]
fn a_box_has_the_light_of_the_meter() {
    let place = Place::new();
    place.file("box.xml", &scene(&room()));
    let parts = ["--spp", "64", "--parts", "all,direct,indirect", "--threads"];
    let one = bake(&place, "box.xml", &[&parts[..], &["1"]].concat());
    assert_eq!(one, bake(&place, "box.xml", &[&parts[..], &["2"]].concat()));
    let layers = place.picture("map.exr");
    let [direct, indirect] = ["direct.G", "indirect.G"].map(|name| layers.channel(name).unwrap());
    assert!((0..SIDE * SIDE).all(|k| (one[k][1] - direct[k] - indirect[k]).abs() <= 1e-5 * one[k][1]));
    let maps: Vec<_> =
        (0..8).map(|seed| bake(&place, "box.xml", &["--spp", "256", "--seed", &seed.to_string()])).collect();
    let loaded = steradian::load(place.path("box.xml"), &Options::default()).compile(&CompileOptions::default());
    let scene = loaded.scene.unwrap();
    let depth =
        Depth { max: scene.settings().max_depth, roulette_after: scene.settings().rr_depth, hide_emitters: false };
    let settings = meter::Settings { samples: 1 << 15, error: None, seed: 9, media: false, depth };
    let points = points(&place, "box.xml");
    let inner = points.iter().enumerate().filter_map(|(k, at)| Some((k, (*at)?)));
    for (k, (p, n)) in inner.filter(|(_, (p, _))| p.abs().max_element() > 0.99).step_by(23) {
        let read = meter::read(&scene, &Receiver::Plane(scene.from_file(p), n.as_vec3()), &settings).rgb[1];
        let mean = maps.iter().map(|map| f64::from(map[k][1])).sum::<f64>() / 8.0;
        let variance = maps.iter().map(|map| (f64::from(map[k][1]) - mean).powi(2)).sum::<f64>() / 56.0;
        let error = (variance + (read.plus_minus / 2.04).powi(2)).sqrt();
        assert!((mean - read.value).abs() <= 3.0 * error, "{k} {p}: {mean} {read:?} {error}");
        assert!(error < 0.02 * read.value, "{k} {p}: {error}");
    }
}

/// Five walls of a box and a lamp.
fn room() -> String {
    let walls = ["", "<rotate x='1' angle='-90'/>", "<rotate x='1' angle='90'/>", "<rotate y='1' angle='90'/>", DOWN];
    let walls = walls.map(|turn| square(&format!("<translate z='-1'/>{turn}"), 0.5, "")).concat();
    walls + &square(&format!("<scale value='0.3'/>{DOWN}<translate z='0.9'/>"), 0.0, &lamp(10.0))
}

/// The error of a map of few samples against one of many falls by half at least, the light in all by no more than a
/// hundredth, and one thread gives the bits of two.
#[test]
fn denoising_halves_the_error() {
    let place = Place::new();
    place.file("box.xml", &scene(&room()));
    let baked = |more: &str| {
        let line = format!("bake light box.xml -o map.exr --resolution 96 --padding 2 --max-depth 2 {more}");
        place.succeed(&line.split(' ').collect::<Vec<_>>());
        place.picture("map.exr").to_rgb().unwrap()
    };
    let reference = baked("--spp 128 --seed 1");
    let noisy = baked("--spp 2");
    let denoised = baked("--spp 2 --denoise --threads 1");
    assert_eq!(denoised, baked("--spp 2 --denoise --threads 2"));
    let error =
        |map: &[[f32; 3]]| map.iter().zip(&reference).map(|(a, b)| f64::from(a[1] - b[1]).powi(2)).sum::<f64>().sqrt();
    let light = |map: &[[f32; 3]]| map.iter().map(|texel| f64::from(texel[1])).sum::<f64>();
    let (before, after) = (error(&noisy), error(&denoised));
    assert!(after < 0.5 * before, "{before} {after}");
    assert!((light(&denoised) / light(&noisy) - 1.0).abs() < 0.01, "{} {}", light(&denoised), light(&noisy));
}

/// Two instances of a square have the maps of two squares.
#[test]
fn instances_have_their_own_places() {
    let place = Place::new();
    let sky = "<emitter type='constant'><rgb name='radiance' value='1'/></emitter>";
    let places = ["<rotate x='1' angle='90'/>", "<translate z='-1'/>"];
    let apart = places.map(|at| square(at, 0.5, "")).concat();
    let instance =
        |at| format!("<shape type='instance'><transform name='to_world'>{at}</transform><ref id='group'/></shape>");
    let group = format!("<shape type='shapegroup' id='group'>{}</shape>", square("", 0.5, ""));
    place.file("apart.xml", &scene(&(apart + sky)));
    place.file("instances.xml", &scene(&(group + &places.map(instance).concat() + sky)));
    let [apart, instances] = ["apart.xml", "instances.xml"].map(|name| bake(&place, name, &["--spp", "4"]));
    assert!(apart.iter().any(|texel| texel[0] > 0.0));
    assert_eq!(apart, instances);
}

/// A sphere of eight times 8² triangles with normals, as an OBJ file.
fn ball() -> String {
    const N: i32 = 8;
    let (mut vertices, mut faces, mut count) = (String::new(), String::new(), 0);
    for octant in 0..8 {
        let sign = [1, 2, 4].map(|bit| if octant & bit == 0 { 1 } else { -1 });
        let mut add = |corners: [[i32; 2]; 3]| {
            for [i, j] in corners {
                let [x, y, z] = [i * sign[0], j * sign[1], (N - i - j) * sign[2]];
                let p = DVec3::new(x.into(), y.into(), z.into()).normalize();
                vertices += &format!("v {0} {1} {2}\nvn {0} {1} {2}\n", p.x, p.y, p.z);
            }
            let [a, b, c] = if sign.iter().product::<i32>() > 0 { [1, 2, 3] } else { [1, 3, 2] }.map(|k| count + k);
            faces += &format!("f {a}//{a} {b}//{b} {c}//{c}\n");
            count += 3;
        };
        for (i, j) in (0..N).flat_map(|i| (0..N - i).map(move |j| (i, j))) {
            add([[i, j], [i + 1, j], [i, j + 1]]);
            if i + j + 1 < N {
                add([[i + 1, j], [i + 1, j + 1], [i, j + 1]]);
            }
        }
    }
    vertices + &faces
}

/// Bilinear lookup of red.
fn look_up(map: &[[f32; 3]], side: usize, texel: DVec2) -> f64 {
    let at = (texel - 0.5).clamp(DVec2::ZERO, DVec2::splat(side as f64 - 1.001));
    let (x, y, f) = (at.x as usize, at.y as usize, at.fract());
    let value = |x: usize, y: usize| f64::from(map[y * side + x][0]);
    let row = |y: usize| value(x, y) * (1.0 - f.x) + value(x + 1, y) * f.x;
    row(y) * (1.0 - f.y) + row(y + 1) * f.y
}

/// A sphere under a sun, which has no noise: filtered lookups on both sides of a seam find the light of the same point
/// to within what it changes by over a texel, denoised or not.
#[test]
fn seams_do_not_show() {
    const SIDE: u32 = 256;
    let place = Place::new();
    let sun = "<emitter type='directional'><vector name='direction' x='0' y='0' z='-1'/>\
               <rgb name='irradiance' value='1'/></emitter>";
    let ball_of_file = "<shape type='obj'><string name='filename' value='ball.obj'/></shape>";
    place.file("ball.obj", &ball()).file("sun.xml", &scene(&format!("{ball_of_file}{sun}")));
    let line = "bake light sun.xml -o map.exr --resolution 256 --max-depth 0 --spp";
    let maps = [" 1", " 2 --denoise"].map(|more| {
        place.succeed(&format!("{line}{more}").split(' ').collect::<Vec<_>>());
        place.picture("map.exr").to_rgb().unwrap()
    });
    let desc = steradian::load(place.path("sun.xml"), &Options::default()).desc;
    let atlas = unwrap::Options { resolution: SIDE, ..unwrap::Options::default() };
    let desc = lightmap::laid_out(&desc, atlas).unwrap().0;
    let mesh = &desc.meshes[desc.shapes[0].mesh.unwrap()];
    let uv = &mesh.attributes.iter().find(|a| a.name == "uv1").unwrap().data;
    let texel = |i: u32| DVec2::new(uv[2 * i as usize].into(), uv[2 * i as usize + 1].into()) * f64::from(SIDE);
    let position = |i: u32| DVec3::from(mesh.positions[i as usize].map(f64::from));
    let edges: Vec<[u32; 2]> = mesh.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
    let mut seams = 0;
    for [a, b] in &edges {
        let same = |i: u32, j: u32| (position(i) - position(j)).length() < 1e-6;
        let other = edges.iter().find(|[c, d]| same(*c, *b) && same(*d, *a)).expect("a closed mesh");
        let middle = (position(*a) + position(*b)).normalize();
        let is_seam = texel(*a) != texel(other[1]) || texel(*b) != texel(other[0]);
        // Where the sun sets, triangles that face away are dark beside such that do not.
        if !is_seam || middle.z.abs() < 0.2 {
            continue;
        }
        seams += 1;
        let length = (texel(*a) - texel(*b)).length();
        let change = (position(*a) - position(*b)).length() / length;
        for map in &maps {
            let value = |[i, j]: [u32; 2]| look_up(map, SIDE as usize, (texel(i) + texel(j)) * 0.5);
            let [here, there] = [value([*a, *b]), value(*other)];
            assert!((here - there).abs() < change, "{middle}: {here} {there}, {change} over a texel");
            assert!((here - middle.z.max(0.0)).abs() < change, "{middle}: {here}");
        }
    }
    assert!(seams > 20, "{seams}");
}

#[test]
fn faults_are_told() {
    let place = Place::new();
    place.file("sphere.xml", &scene("<shape type='sphere'/>")).file("square.xml", &scene(&square("", 0.5, "")));
    let refuse = |line: &[&str], about: &[&str]| place.refuse(2, &[&["bake", "light"][..], line].concat(), about);
    refuse(&["sphere.xml", "-o", "a.exr"], &["sphere.xml", "no mesh"]);
    refuse(&["none.xml", "-o", "a.exr"], &["none.xml"]);
    refuse(&["square.xml", "-o", "a.png", "--parts", "all,ao"], &["a.png", ".exr"]);
    refuse(&["square.xml", "-o", "a.exr", "--spp", "1", "--denoise"], &["square.xml", "two or more"]);
    refuse(&["square.xml", "-o", "a.glb", "--parts", "all,ao"], &["a.glb", ".exr"]);
    refuse(&["square.xml", "-o", "a.exr", "--parts", "all,all"], &["twice"]);
    refuse(&["square.xml", "-o", "a.exr", "--resolution", "30000"], &["16384"]);
    refuse(&["square.xml", "-o", "a.exr", "--resolution", "8"], &["resolution"]);
    refuse(&["square.xml", "-o", "a.exr", "--resolution", "2048", "--spp", "1000k"], &["samples", "more than"]);
    assert!(!place.path("a.exr").exists(), "nothing is written");
}
