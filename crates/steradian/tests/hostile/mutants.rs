//! Published scenes, meshes and pictures, damaged at random: numbers replaced, bytes flipped, pieces cut off, left out
//! or repeated.

use crate::case::{
    Case,
    Expect::{Either, Picture},
};
use std::path::{Path, PathBuf};
use steradian::math::hash::HashRng;

/// Mutants of each seed but those that are [`SLOW`]. A sweep with many more is a matter of changing this number.
const MUTANTS: usize = 120;

/// Scenes that load twenty times longer than others, by many curves and large pictures: a quarter of the mutants.
const SLOW: [&str; 2] =
    ["pbrt/hair-curl/scene-v4.pbrt", "mitsuba/tests/scenes/various_emitters/test_various_emitters_ptracer.xml"];

/// Replacements of a number in a text.
const NUMBERS: [&str; 16] = [
    "nan",
    "inf",
    "-inf",
    "1e39",
    "-1e39",
    "1e38",
    "-1",
    "0",
    "-0",
    "1e-45",
    "1e-30",
    "4294967296",
    "-2147483649",
    "9223372036854775808",
    "0.5",
    "x",
];

const ASSETS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/assets");

/// A file that is damaged, and the scene that it is in.
struct Seed {
    /// Below the assets.
    file: &'static str,
    /// The scene where the file is not one itself; it stands under its own name in the folder.
    scene: Option<fn(&str) -> Case>,
}

const fn scene(file: &'static str) -> Seed {
    Seed { file, scene: None }
}

fn as_ply(name: &str) -> Case {
    Case::pbrt("", format!("Shape \"plymesh\" \"string filename\" \"{name}\""), Either)
}

fn as_obj(name: &str) -> Case {
    Case::mitsuba("", format!("<shape type='obj'><string name='filename' value='{name}'/></shape>"), Either)
}

fn as_serialized(name: &str) -> Case {
    Case::mitsuba("", format!("<shape type='serialized'><string name='filename' value='{name}'/></shape>"), Either)
}

fn as_texture(name: &str) -> Case {
    let world = format!(
        "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"{name}\"\nMaterial \"diffuse\" \"texture reflectance\" \"t\"\nShape \"sphere\"\n\
         LightSource \"infinite\" \"string filename\" \"{name}\""
    );
    Case::pbrt("", world, Either)
}

const SEEDS: [Seed; 37] = [
    scene("pbrt/cornell-box/scene-v4.pbrt"),
    scene("pbrt/veach-mis/scene-v4.pbrt"),
    scene("pbrt/volumetric-caustic/scene-v4.pbrt"),
    scene("pbrt/hair-curl/scene-v4.pbrt"),
    scene("mitsuba/cornell-box/scene_v3.xml"),
    scene("mitsuba/scenes/cbox/cbox.xml"),
    scene("mitsuba/scenes/cbox/cbox-spectral.xml"),
    scene("mitsuba/scenes/hello.xml"),
    scene("mitsuba/tests/scenes/various_emitters/test_various_emitters_ptracer.xml"),
    scene("mitsuba/tests/scenes/participating_media/test_homo_area_light_volpath.xml"),
    scene("mitsuba/tests/scenes/mesh_attributes/test_mesh_attributes_3_face_direct.xml"),
    scene("mitsuba/tests/scenes/projector/test_projector_constant_direct.xml"),
    Seed { file: "ply/assimp/cube.ply", scene: Some(as_ply) },
    Seed { file: "ply/assimp/cube_binary.ply", scene: Some(as_ply) },
    Seed {
        file: "ply/magnum/positions-colors4-normals-texcoords-float-indices-int-be-unaligned.ply",
        scene: Some(as_ply),
    },
    scene("ply/magnum/custom-components-be.ply"),
    scene("gltf/BoxVertexColors/BoxVertexColors.glb"),
    scene("gltf/SimpleMorph/SimpleMorph.gltf"),
    scene("gltf/magnum/mesh-sparse.gltf"),
    scene("gltf/Cubes-lights/Cubes.glb"),
    scene("obj/assimp/multiple_spaces.obj"),
    scene("obj/assimp/concave_polygon.obj"),
    Seed { file: "obj/assimp/cube_usemtl.obj", scene: Some(as_obj) },
    Seed { file: "mitsuba/tests/serialized/rectangle_normals_uv.serialized", scene: Some(as_serialized) },
    Seed { file: "mitsuba/tests/serialized/rectangle_uv.serialized", scene: Some(as_serialized) },
    Seed { file: "png/pngsuite/primary/basn2c08.png", scene: Some(as_texture) },
    Seed { file: "png/pngsuite/primary/basi3p02.png", scene: Some(as_texture) },
    Seed { file: "png/pngsuite/16bit/basn4a16.png", scene: Some(as_texture) },
    Seed { file: "image/jpeg/progressive/test.jpg", scene: Some(as_texture) },
    Seed { file: "image/hdr/rgbr4x4.hdr", scene: Some(as_texture) },
    Seed { file: "exr/TestImages/stripes.exr", scene: Some(as_texture) },
    Seed { file: "exr/openexr-src/tiled_with_scanlineimage_type.exr", scene: Some(as_texture) },
    Seed { file: "exr/openexr-src/comp_dwaa_v2.exr", scene: Some(as_texture) },
    Seed { file: "exr/openexr-src/comp_b44.exr", scene: Some(as_texture) },
    Seed { file: "exr/codec-truth-f16/piz.exr", scene: Some(as_texture) },
    Seed { file: "exr/codec-truth-f16/pxr24.exr", scene: Some(as_texture) },
    Seed { file: "exr/codec-truth-f16/rle.exr", scene: Some(as_texture) },
];

/// Mutants of all seeds there are.
pub fn table() -> impl Iterator<Item = Case> {
    SEEDS.iter().zip(1..).flat_map(|(seed, number)| {
        let path = Path::new(ASSETS).join(seed.file);
        let bytes = std::fs::read(&path).unwrap_or_default();
        let mutants = if SLOW.contains(&seed.file) { MUTANTS / 4 } else { MUTANTS };
        let count = if bytes.is_empty() { 0 } else { mutants };
        let mut rng = HashRng::new(number);
        (0..count).map(move |i| {
            // The first one is sound.
            let bytes = if i == 0 { bytes.clone() } else { mutate(&bytes, &mut rng) };
            case(seed, &path, bytes, i)
        })
    })
}

/// The files that are there.
pub fn found() -> usize {
    SEEDS.iter().filter(|s| steradian_testkit::asset(s.file).is_some()).count()
}

fn case(seed: &Seed, path: &Path, bytes: Vec<u8>, number: usize) -> Case {
    let file = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    let mut case = match seed.scene {
        Some(scene) => scene(&file).with(&file, bytes),
        None => Case::new("", &file, bytes, Either),
    };
    case.name = format!("mutant {number} of {}", seed.file);
    if file.ends_with(".png") {
        mend_png(&mut case.files[1].1);
    }
    // What scenes name is found beside the originals.
    case.expect = if number == 0 { Picture } else { Either };
    case.search = path.parent().map(PathBuf::from);
    case.small = true;
    case
}

/// One fault, or up to four.
fn mutate(seed: &[u8], rng: &mut HashRng) -> Vec<u8> {
    let mut below = |n: usize| (rng.next_u64() % n.max(1) as u64) as usize;
    let mut bytes = seed.to_vec();
    let is_text = seed.iter().all(|b| b.is_ascii_graphic() || b.is_ascii_whitespace());
    let more = below(4) * below(2) * below(2);
    for _ in 0..=more {
        if bytes.is_empty() {
            break;
        }
        let at = below(bytes.len());
        match below(if is_text { 12 } else { 6 }) {
            0 => bytes[at] ^= 1 << below(8),
            1 => bytes[at] = below(256) as u8,
            2 => bytes.truncate(at),
            3 => _ = bytes.drain(at..(at + below(60)).min(bytes.len())),
            4 => {
                let piece = bytes[at..(at + below(200)).min(bytes.len())].to_vec();
                let to = below(bytes.len());
                bytes.splice(to..to, piece);
            }
            5 => {
                let length = below(8) + 1;
                let fill = [0, 0xff, 0x80, 0x7f][below(4)];
                let end = (at + length).min(bytes.len());
                bytes[at..end].fill(fill);
            }
            _ => replace_number(&mut bytes, at, NUMBERS[below(NUMBERS.len())]),
        }
    }
    bytes
}

/// Replaces the first number from a place on.
fn replace_number(bytes: &mut Vec<u8>, from: usize, by: &str) {
    let part_of_number = |b: &u8| b.is_ascii_digit() || b"+-.".contains(b);
    let Some(start) = bytes[from..].iter().position(part_of_number).map(|i| from + i) else { return };
    let length = bytes[start..].iter().position(|b| !part_of_number(b)).unwrap_or(bytes.len() - start);
    bytes.splice(start..start + length, by.bytes());
}

/// Puts the checksums of a PNG file right, as far as its chunks can be told: else nearly all mutants end there.
fn mend_png(bytes: &mut [u8]) {
    let mut at = 8;
    while let Some(length) = bytes.get(at..at + 4).and_then(|b| b.try_into().ok()).map(u32::from_be_bytes) {
        let end = at + 8 + length as usize;
        if end + 4 > bytes.len() {
            break;
        }
        let mut crc = flate2::Crc::new();
        crc.update(&bytes[at + 4..end]);
        bytes[end..end + 4].copy_from_slice(&crc.sum().to_be_bytes());
        at = end + 4;
    }
}
