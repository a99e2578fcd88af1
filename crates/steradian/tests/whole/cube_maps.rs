//! Environments by cube maps (M217).

use std::{path::Path, sync::Arc};
use steradian::{ColorMode, CompileOptions, Quality, compile, image::Image, load_bytes, math::Vec3, render};

/// Radiance from a direction: no two axes look alike.
fn sky(d: Vec3) -> [f32; 3] {
    let d = d.normalize();
    [0.5 + 0.4 * d.x, 0.5 + 0.4 * d.y, 0.5 + 0.3 * d.z + 0.1 * d.x * d.y]
}

/// Direction of a place on a face as OpenGL stores it, in a right-handed world: +x is mirrored.
fn direction(face: usize, s: f32, t: f32) -> Vec3 {
    let d = [
        Vec3::new(1.0, -t, -s),
        Vec3::new(-1.0, -t, s),
        Vec3::new(s, 1.0, t),
        Vec3::new(s, -1.0, -t),
        Vec3::new(s, -t, 1.0),
        Vec3::new(-s, -t, -1.0),
    ][face];
    Vec3::new(-d.x, d.y, d.z)
}

const N: usize = 32;

fn texel(face: usize, x: usize, y: usize) -> [f32; 3] {
    let at = |i: usize| (i as f32 + 0.5) / N as f32 * 2.0 - 1.0;
    sky(direction(face, at(x), at(y)))
}

/// A picture of so many by so many squares; each is a face, turned by half a turn if so, or black.
fn picture(columns: usize, rows: usize, face: impl Fn(usize, usize) -> Option<(usize, bool)>) -> Image {
    let pixel = |k: usize| {
        let (x, y) = (k % (columns * N), k / (columns * N));
        match face(x / N, y / N) {
            Some((face, false)) => texel(face, x % N, y % N),
            Some((face, true)) => texel(face, N - 1 - x % N, N - 1 - y % N),
            None => [0.0; 3],
        }
    };
    let pixels: Vec<_> = (0..columns * rows * N * N).map(pixel).collect();
    Image::from_rgb(columns * N, rows * N, &pixels).expect("a picture")
}

/// A DDS file of six faces of floats with two levels each, the smaller of which are of no use.
fn dds() -> Vec<u8> {
    let mut words = [0_u32; 37];
    words[0] = u32::from_le_bytes(*b"DDS ");
    (words[1], words[2], words[3], words[4], words[7]) = (124, 0x2_1007, N as u32, N as u32, 2);
    (words[19], words[20], words[21]) = (32, 4, u32::from_le_bytes(*b"DX10"));
    (words[27], words[28]) = (0x40_1008, 0xfe00);
    // R32G32B32A32_FLOAT, two dimensions, a cube map.
    (words[32], words[33], words[34], words[35]) = (2, 3, 4, 1);
    let mut bytes: Vec<u8> = words.iter().flat_map(|w| w.to_le_bytes()).collect();
    for face in 0..6 {
        for k in 0..N * N {
            let [r, g, b] = texel(face, k % N, k / N);
            bytes.extend([r, g, b, 1.0].into_iter().flat_map(f32::to_le_bytes));
        }
        bytes.extend(std::iter::repeat_n(0x40_u8, N * N / 4 * 16));
    }
    bytes
}

/// The background of a view, and a ball that mirrors it, as green and red of all pixels.
fn shown(file: &Path) -> Vec<f32> {
    let text = format!(
        r#"steradian: 1
        film: {{film: rgb, width: 24, height: 24}}
        camera: {{camera: perspective, fov: 70, to_world: {{look_at: [0.3, 0.2, 0], from: [1, 0.5, 3]}}}}
        lights: [{{light: environment, file: {{file: "{}"}}}}]
        shapes: [{{shape: sphere, material: {{material: conductor, reflectance: 1}}}}]"#,
        file.display()
    );
    let loaded = load_bytes("view.steradian", text.into_bytes(), None, &Default::default());
    let options = CompileOptions { mode: Some(ColorMode::Rgb), ..CompileOptions::default() };
    let scene = Arc::new(compile(&loaded.desc, &options).scene.unwrap_or_else(|| panic!("{}", file.display())));
    let picture = render(&scene, &Quality::of("path:reuse=1").spp(64)).expect("a picture");
    ["R", "G", "B"].iter().flat_map(|c| picture.channel(c).expect(c).to_vec()).collect()
}

/// A picture by longitude and latitude, both crosses, a row, a column and a DDS file of one sky are one sky: nothing is
/// mirrored, turned or swapped, in the background and in a mirror.
#[test]
fn all_forms_of_cube_maps_are_one_sky() {
    let folder = tempfile::tempdir().unwrap();
    let save = |name: &str, image: &Image| {
        let path = folder.path().join(name);
        steradian::image::write(&path, image, &Default::default()).unwrap();
        path
    };
    let longitudes = {
        let (w, h) = (256, 128);
        let pixel = |k: usize| {
            let (u, v) = (((k % w) as f32 + 0.5) / w as f32, ((k / w) as f32 + 0.5) / h as f32);
            let (phi, theta) = (u * std::f32::consts::TAU, v * std::f32::consts::PI);
            sky(Vec3::new(phi.sin() * theta.sin(), theta.cos(), -phi.cos() * theta.sin()))
        };
        Image::from_rgb(w, h, &(0..w * h).map(pixel).collect::<Vec<_>>()).unwrap()
    };
    let right = shown(&save("latlong.exr", &longitudes));
    let cross = |x: usize, y: usize| match (x, y) {
        (1, 0) => Some((2, false)),
        (0, 1) => Some((1, false)),
        (1, 1) => Some((4, false)),
        (2, 1) => Some((0, false)),
        (3, 1) => Some((5, false)),
        (1, 2) => Some((3, false)),
        _ => None,
    };
    let tall = |x: usize, y: usize| match (x, y) {
        (1, 3) => Some((5, true)),
        (3, _) => None,
        _ if y < 3 => cross(x, y).filter(|(face, _)| *face != 5),
        _ => None,
    };
    let dds_file = folder.path().join("cube.dds");
    std::fs::write(&dds_file, dds()).unwrap();
    for path in [
        save("cross.exr", &picture(4, 3, cross)),
        save("tall.exr", &picture(3, 4, tall)),
        save("row.exr", &picture(6, 1, |x, _| Some((x, false)))),
        save("column.exr", &picture(1, 6, |_, y| Some((y, false)))),
        dds_file,
    ] {
        let found = shown(&path);
        let worst = found.iter().zip(&right).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(worst < 0.03, "{}: {worst}", path.display());
    }
}
