//! Whole files with packed data, made by scripts/packed_gltf.py with the reference encoders: they hold what the files
//! with plain data hold, and mutants of them are refused or read, without a panic.

use super::import_bytes;
use crate::{Import, Options, mesh::test_files::mutants};
use std::path::Path;
use steradian_scene::Mesh;

const TORUS: &[u8] = include_bytes!("torus.glb");
const MESHOPT_0: &[u8] = include_bytes!("meshopt-v0.glb");
const MESHOPT_1: &[u8] = include_bytes!("meshopt-v1.glb");
const QUANTIZED: &[u8] = include_bytes!("quantized.glb");
const QUANTIZED_MESHOPT: &[u8] = include_bytes!("quantized-meshopt.glb");
const DRACO: &[u8] = include_bytes!("draco.glb");
const DRACO_PLAIN: &[u8] = include_bytes!("draco-plain.glb");
const SEQUENTIAL: &[u8] = include_bytes!("draco-sequential.glb");
const SEQUENTIAL_PLAIN: &[u8] = include_bytes!("draco-sequential-plain.glb");

fn read(bytes: &[u8]) -> Import {
    import_bytes(Path::new("packed.glb"), bytes.to_vec(), &Options::default())
}

/// The only mesh of a file about which nothing is said.
fn mesh(bytes: &[u8]) -> Mesh {
    let import = read(bytes);
    let messages: Vec<_> = import.diagnostics.iter().map(ToString::to_string).collect();
    assert!(messages.is_empty(), "{messages:#?}");
    import.desc.meshes[0].as_ref().clone()
}

fn same(a: &[u8], b: &[u8]) {
    let (a, b) = (mesh(a), mesh(b));
    assert_eq!(a.triangles, b.triangles);
    assert_eq!((a.positions, a.normals, a.uvs), (b.positions, b.normals, b.uvs));
}

/// The first error of a file with one text in place of another of the same length.
fn error_with(bytes: &[u8], from: &str, to: &str) -> String {
    assert_eq!(from.len(), to.len());
    let mut bytes = bytes.to_vec();
    let at = bytes.windows(from.len()).position(|w| w == from.as_bytes()).expect(from);
    bytes[at..at + to.len()].copy_from_slice(to.as_bytes());
    let import = read(&bytes);
    assert!(import.diagnostics.has_errors(), "{to}");
    import.diagnostics.iter().map(ToString::to_string).find(|m| m.starts_with("error")).unwrap()
}

#[test]
fn meshopt_holds_the_same_bits() {
    let plain = mesh(TORUS);
    assert_eq!((plain.positions.len(), plain.triangles.len()), (231, 400));
    same(TORUS, MESHOPT_0);
    same(TORUS, MESHOPT_1);
}

#[test]
fn quantized_data_are_read_also_packed() {
    same(QUANTIZED, QUANTIZED_MESHOPT);
    let (plain, coarse) = (mesh(TORUS), mesh(QUANTIZED));
    let desc = read(QUANTIZED).desc;
    let place = desc.shapes[0].world_from_object.matrix;
    for (k, p) in coarse.positions.iter().enumerate() {
        let p = place.transform_point3(steradian_math::DVec3::from(p.map(f64::from)));
        // Half a step of 14 bits over the 2.9 units of the torus.
        for (found, wanted) in p.to_array().into_iter().zip(plain.positions[k]) {
            assert!((found - f64::from(wanted)).abs() < 0.5 * 2.9 / 16383.0 + 1e-6, "{k}: {found} is not {wanted}");
        }
        // Half a step of 7 bits and the error of the octahedral code.
        let apart = |a: &[f32], b: &[f32]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0f32, f32::max);
        assert!(apart(&coarse.normals[k], &plain.normals[k]) < 0.025);
        assert!(apart(&coarse.uvs[k], &plain.uvs[k]) < 1e-5);
    }
}

#[test]
fn draco_holds_what_the_reference_decoder_gives() {
    same(DRACO_PLAIN, DRACO);
    same(SEQUENTIAL_PLAIN, SEQUENTIAL);
}

#[test]
fn wrong_packings_are_told() {
    for (from, to, words) in [
        ("\"byteStride\":12,\"count\":231", "\"byteStride\":12,\"count\":232", "232 elements of 12 bytes are not what"),
        ("\"mode\":\"ATTRIBUTES\"", "\"mode\":\"ATTRIBUTER\"", "one of ATTRIBUTES, TRIANGLES, INDICES"),
        ("\"mode\":\"TRIANGLES\"", "\"mode\":\"INDICES\"  ", "begin with the byte 0xd1, not 0xe1"),
    ] {
        let error = error_with(MESHOPT_0, from, to);
        assert!(error.contains(words), "{error}");
        assert!(error.contains("/extensions/EXT_meshopt_compression"), "{error}");
    }
    for (from, to, words) in [
        ("\"count\":231", "\"count\":230", "not that of the Draco data, which is 231"),
        ("\"type\":\"VEC2\"", "\"type\":\"VEC4\"", "'TEXCOORD_0' has 2 numbers a vertex"),
        ("DRACO", "DRAGO", "cannot be unpacked"),
        ("\"POSITION\":2", "\"POSITION\":9", "Draco attribute of 'POSITION' (9) is not in the data"),
    ] {
        let error = error_with(DRACO, from, to);
        assert!(error.contains(words), "{error}");
    }
}

#[test]
fn damaged_files_do_not_panic() {
    for file in [MESHOPT_0, MESHOPT_1, QUANTIZED_MESHOPT, DRACO, SEQUENTIAL] {
        for cut in (0..file.len()).step_by(7) {
            let _ = read(&file[..cut]);
        }
        mutants(file, 300, |bytes| {
            let _ = read(bytes);
        });
    }
}

/// Draco data of every length and with changed bytes, in a file that is otherwise sound.
#[test]
fn damaged_draco_data_do_not_panic() {
    for file in [DRACO, SEQUENTIAL] {
        let start = file.windows(5).position(|w| w == b"DRACO").unwrap();
        let mut refused = 0;
        for at in start..file.len() {
            let mut cut = file.to_vec();
            cut[at..].fill(0);
            refused += usize::from(read(&cut).diagnostics.has_errors());
        }
        assert!(refused > (file.len() - start) / 4, "{refused}");
        mutants(&file[start..], 500, |data| {
            let mut bytes = file.to_vec();
            let length = data.len().min(file.len() - start);
            bytes[start..start + length].copy_from_slice(&data[..length]);
            let _ = read(&bytes);
        });
    }
}
