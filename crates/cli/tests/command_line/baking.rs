//! `steradian bake normals`: maps against closed forms, what they render, and faults.

use crate::Place;
use std::{f32::consts::PI, fmt::Write};
use steradian::math::Vec3;

/// Height of the fine plane and its normal.
fn wave(x: f32, y: f32) -> (f32, Vec3) {
    let (a, k, l) = (0.03, 4.0 * PI, 2.0 * PI);
    let slope = Vec3::new(-a * k * (k * x).cos() * (l * y).cos(), a * l * (k * x).sin() * (l * y).sin(), 1.0);
    (a * (k * x).sin() * (l * y).cos(), slope.normalize())
}

/// A wavy plane over [−1.1, 1.1]², with its normals, and a flat square of [−1, 1]² over the unit square of coordinates.
fn meshes(place: &Place) {
    const N: usize = 281;
    let mut fine = ply(N * N, "nx ny nz", (N - 1) * (N - 1));
    for i in 0..N * N {
        let at = |i: usize| 2.2 * i as f32 / (N - 1) as f32 - 1.1;
        let (x, y) = (at(i % N), at(i / N));
        let (z, n) = wave(x, y);
        writeln!(fine, "{x} {y} {z} {} {} {}", n.x, n.y, n.z).unwrap();
    }
    for i in (0..N * N).filter(|i| i % N + 1 < N && i / N + 1 < N) {
        writeln!(fine, "4 {i} {} {} {}", i + 1, i + N + 1, i + N).unwrap();
    }
    let corners = "-1 -1 0 0 0\n1 -1 0 1 0\n1 1 0 1 1\n-1 1 0 0 1\n";
    place.file("fine.ply", &fine);
    place.file("coarse.ply", &format!("{}{corners}4 0 1 2 3\n", ply(4, "u v", 1)));
    place.file("double.ply", &format!("{}{corners}4 0 1 2 3\n3 0 1 2\n", ply(4, "u v", 2)));
    place.file("bare.obj", "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nf 1 2 3\n");
    place.file("far.obj", "v -1 -1 9\nv 1 -1 9\nv 1 1 9\nf 1 2 3\n");
}

/// Head of a PLY file of vertices with positions and further numbers.
fn ply(vertices: usize, numbers: &str, faces: usize) -> String {
    let mut head = format!("ply\nformat ascii 1.0\nelement vertex {vertices}\n");
    for name in "x y z".split(' ').chain(numbers.split(' ')) {
        writeln!(head, "property float {name}").unwrap();
    }
    head + &format!("element face {faces}\nproperty list uchar int vertex_indices\nend_header\n")
}

const SIZE: usize = 128;

/// Normals are off by less than 0.003, heights by less than 0.001 of the plane's: in both spaces, which are one here.
#[test]
fn a_wavy_plane_gives_its_normals_and_heights() {
    let place = Place::new();
    meshes(&place);
    for space in ["tangent", "object"] {
        let line = ["bake", "normals", "fine.ply", "coarse.ply", "--size", "128x128", "--space", space];
        place.succeed(&[&line[..], &["-o", "map.exr", "--height", "height.exr"]].concat());
        let (map, heights) = (place.picture("map.exr").to_rgb().unwrap(), place.picture("height.exr"));
        let heights = heights.channel("R").unwrap();
        for i in 0..SIZE * SIZE {
            let at = |i: usize| 2.0 * (i as f32 + 0.5) / SIZE as f32 - 1.0;
            let (height, n) = wave(at(i % SIZE), -at(i / SIZE));
            let seen = Vec3::from(map[i]) * 2.0 - 1.0;
            assert!((seen - n).length() < 3e-3, "{space} {i}: {seen} {n}");
            assert!((heights[i] - height).abs() < 1e-3, "{space} {i}: {} {height}", heights[i]);
        }
    }
}

/// The square with its map shades as the wavy plane does: seen from above, its normals are the same to an 8-bit code's
/// step and a texel.
#[test]
fn the_coarse_mesh_with_its_map_has_the_normals_of_the_fine_one() {
    let place = Place::new();
    meshes(&place);
    let said = place.succeed(&[
        "bake",
        "normals",
        "fine.ply",
        "coarse.ply",
        "--size",
        "256x256",
        "-o",
        "map.png",
        "--height",
        "height.png",
    ]);
    assert!(said.stderr.contains("are 0 to 1 in 'height.png'"), "{}", said.stderr);
    let scene = |mesh: &str, material: &str| {
        format!(
            "steradian: 1\ncamera: {{camera: orthographic, to_world: {{look_at: [0, 0, 0], from: [0, 0, 3]}}}}\n\
             film: {{film: rgb, width: 64, height: 64}}\nlights: [{{light: environment}}]\n\
             shapes: [{{shape: mesh, mesh: {{file: \"{mesh}\"}}, material: {{material: diffuse {material}}}}}]\n"
        )
    };
    place.file("fine.steradian", &scene("fine.ply", ""));
    let map = "normal_map: {texture: image, file: {file: \"map.png\"}, raw: true}, detail_facing: as_it_is";
    place.file("coarse.steradian", &scene("coarse.ply", map));
    let normals = |name: &str| {
        let scene = format!("{name}.steradian");
        let line = ["render", &scene, "--spp", "4", "--aov", "normal", "-q", "-o", "out.exr"];
        place.succeed(&line);
        let picture = place.picture("out.exr");
        let [x, y, z] = ["X", "Y", "Z"].map(|c| picture.channel(&format!("N.{c}")).expect("normals"));
        (0..64 * 64).map(|i| Vec3::new(x[i], y[i], z[i])).collect::<Vec<_>>()
    };
    let (fine, coarse) = (normals("fine"), normals("coarse"));
    let off = fine.iter().zip(&coarse).map(|(a, b)| (*a - *b).length()).fold(0.0, f32::max);
    let flat = fine.iter().map(|n| (*n - Vec3::Z).length()).fold(0.0, f32::max);
    assert!(off < 0.02 && flat > 0.2, "{off} {flat}");
}

#[test]
fn faults_are_told() {
    let place = Place::new();
    meshes(&place);
    let line = |fine: &'static str, coarse: &'static str| {
        ["bake", "normals", fine, coarse, "--size", "16x16", "--samples", "1", "-o", "map.png"]
    };
    place.refuse(2, &line("fine.ply", "bare.obj"), &["bare.obj", "no texture coordinates"]);
    place.refuse(2, &line("far.obj", "coarse.ply"), &["no ray met the fine mesh", "--distance"]);
    place.refuse(2, &line("none.obj", "coarse.ply"), &["none.obj"]);
    let unwritten = ["bake", "normals", "fine.ply", "coarse.ply", "-o", "map.tga"];
    place.refuse(2, &unwritten, &["not written"]);
    assert!(!place.path("map.png").exists(), "nothing is written");
    let said = place.succeed(&line("fine.ply", "double.ply")).stderr;
    assert!(said.contains("texture coordinates overlap"), "{said}");
}
