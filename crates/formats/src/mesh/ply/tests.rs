use super::*;
use crate::mesh::test_files::{assets, mutants};
use steradian_scene::{Attribute, Domain};

fn read_ok(bytes: &[u8]) -> Mesh {
    let mesh = read(bytes, &PlyOptions::default()).unwrap().mesh;
    mesh.validate().unwrap();
    mesh
}

/// Exporters write NaN where the faces around a vertex have no area.
#[test]
fn normals_that_are_not_finite_are_left_out_and_counted() {
    let text = TRIANGLE
        .replace("property float z\n", "property float z\nproperty float nx\nproperty float ny\nproperty float nz\n")
        .replace("0 0 0\n1 0 0\n0 1 0\n", "0 0 0 nan nan nan\n1 0 0 0 0 1\n0 1 0 0 inf 1\n");
    let file = read(text.as_bytes(), &PlyOptions::default()).unwrap();
    assert_eq!((file.bad_normals, &file.mesh.normals), (2, &vec![[0.0; 3], [0.0, 0.0, 1.0], [0.0; 3]]));
    assert!(file.warning().is_some());
}

fn fault(bytes: &[u8]) -> MeshError {
    read(bytes, &PlyOptions::default()).unwrap_err()
}

fn file(header: &str, data: &[u8]) -> Vec<u8> {
    [b"ply\n", header.as_bytes(), b"\nend_header\n", data].concat()
}

const TRIANGLE: &str = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
    element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2";

/// Writes a mesh in one of the three encodings; the reader must not see a difference.
fn write(mesh: &Mesh, format: &str) -> Vec<u8> {
    let mut out = format!("ply\nformat {format} 1.0\nelement vertex {}\n", mesh.positions.len()).into_bytes();
    let mut names = vec!["x", "y", "z"];
    names.extend(if mesh.normals.is_empty() { &[][..] } else { &["nx", "ny", "nz"] });
    names.extend(if mesh.uvs.is_empty() { &[][..] } else { &["s", "t"] });
    names.iter().for_each(|n| out.extend(format!("property float {n}\n").bytes()));
    out.extend(
        format!("element face {}\nproperty list uchar int vertex_index\nend_header\n", mesh.triangles.len()).bytes(),
    );
    for i in 0..mesh.positions.len() {
        let mut row = mesh.positions[i].to_vec();
        row.extend(mesh.normals.get(i).into_iter().flatten());
        row.extend(mesh.uvs.get(i).into_iter().flatten());
        for v in row {
            match format {
                "ascii" => out.extend(format!("{v} ").bytes()),
                "binary_big_endian" => out.extend(v.to_be_bytes()),
                _ => out.extend(v.to_le_bytes()),
            }
        }
    }
    for t in &mesh.triangles {
        match format {
            "ascii" => out.extend(format!("\n3 {} {} {}", t[0], t[1], t[2]).bytes()),
            "binary_big_endian" => out.extend([3].into_iter().chain(t.iter().flat_map(|i| i.to_be_bytes()))),
            _ => out.extend([3].into_iter().chain(t.iter().flat_map(|i| i.to_le_bytes()))),
        }
    }
    out
}

#[test]
fn real_files_have_the_documented_faces() {
    let Some(root) = assets() else { return };
    for (name, vertices, triangles) in [
        ("ply/large/Mesh005.ply", 64_582, 127_872),
        ("ply/large/bedroom-Mesh041.be.ply", 39_730, 78_832),
        ("ply/large/lamp-Mesh042.ascii.ply", 18_552, 26_464),
        ("ply/trimesh/cycloidal.ply", 21_384, 43_368),
        ("ply/trimesh/octagonal_pocket.ply", 1_658, 3_262),
        ("ply/trimesh/sphere.ply", 642, 1_280),
        ("ply/assimp/cube.ply", 8, 12),
        ("ply/assimp/cube_binary.ply", 8, 12),
        ("ply/assimp/cube_binary_header_with_RN_newline.ply", 8, 12),
        ("ply/assimp/cube_binary_starts_with_nl.ply", 8, 12),
        ("ply/assimp/cube_uv.ply", 24, 12),
        ("mitsuba/tests/ply/rectangle_normals_uv.ply", 4, 2),
    ] {
        let mesh = read_ok(&std::fs::read(root.join(name)).unwrap());
        assert_eq!((mesh.positions.len(), mesh.triangles.len()), (vertices, triangles), "{name}");
    }
}

#[test]
fn every_real_file_reads() {
    let Some(root) = assets() else { return };
    let mut count = 0;
    for folder in ["ply/assimp", "ply/large", "ply/magnum", "ply/trimesh", "mitsuba/tests/ply"] {
        for entry in std::fs::read_dir(root.join(folder)).unwrap() {
            let path = entry.unwrap().path();
            let mesh = read(&std::fs::read(&path).unwrap(), &PlyOptions::default());
            let mesh = mesh.unwrap_or_else(|e| panic!("{}: {e}", path.display())).mesh;
            mesh.validate().unwrap();
            assert!(!mesh.triangles.is_empty(), "{}", path.display());
            count += 1;
        }
    }
    assert!(count >= 36, "{count} files");
}

#[test]
fn the_three_encodings_agree() {
    let Some(root) = assets() else { return };
    for name in ["ply/large/Mesh005.ply", "ply/large/lamp-Mesh042.ascii.ply", "ply/trimesh/sphere.ply"] {
        let mesh = read_ok(&std::fs::read(root.join(name)).unwrap());
        for format in ["ascii", "binary_little_endian", "binary_big_endian"] {
            assert!(read_ok(&write(&mesh, format)) == mesh, "{name} as {format}");
        }
    }
}

/// The magnum files hold one mesh in every type: the position of vertex 1 is (3, 2, 1), of vertex 4 (9, 4, 5) in the
/// small ones.
#[test]
fn all_types_and_orders_agree() {
    let Some(root) = assets() else { return };
    let open = |name: &str| read_ok(&std::fs::read(root.join("ply/magnum").join(name)).unwrap());
    let reference = open("positions-float-indices-uint.ply");
    let mut compared = 0;
    for entry in std::fs::read_dir(root.join("ply/magnum")).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        if name == "ascii.ply" {
            continue;
        }
        let mesh = open(&name);
        assert_eq!(mesh.positions, reference.positions, "{name}");
        assert_eq!(mesh.triangles, reference.triangles, "{name}");
        compared += 1;
    }
    assert!(compared >= 14);
    let colors = open("positions-colors4-float-indices-int.ply").attributes;
    assert_eq!((colors[0].name.as_str(), colors[0].domain, colors[0].channels), ("color", Domain::Vertex, 4));
    let bytes = open("positions-short-colors-uchar-texcoords-ushort-indices-char.ply");
    // 0xcc = 0.8 of full scale, decoded from sRGB; texture coordinates are fractions of full scale.
    assert!((bytes.attributes[0].data[0] - 0.603_827).abs() < 1e-5, "{:?}", bytes.attributes[0].data);
    assert_eq!(bytes.uvs[1], [0x2222_u16, 0xeeee].map(|v| f32::from(v) / 65535.0));
}

#[test]
fn face_colors_follow_their_triangles() {
    let Some(root) = assets() else { return };
    let mesh = read_ok(&std::fs::read(root.join("ply/trimesh/cycloidal.ply")).unwrap());
    let of = |d: Domain| mesh.attributes.iter().find(|a| a.domain == d && a.name == "color").unwrap();
    assert_eq!(of(Domain::Face).data.len(), 4 * 43_368);
    assert_eq!(of(Domain::Vertex).data.len(), 4 * 21_384);
    let mesh = read_ok(&std::fs::read(root.join("mitsuba/tests/ply/triangle_face_colors.ply")).unwrap());
    assert_eq!((mesh.attributes[0].name.as_str(), mesh.attributes[0].channels), ("color", 3));
}

#[test]
fn attributes_follow_mitsubas_names() {
    let header = "format ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nproperty float speed_x\n\
        property float speed_y\nproperty float speed_z\nproperty float heat_0\nproperty float glow_r\nproperty float glow_g\n\
        property float glow_b\nproperty float quality";
    let mesh = read_ok(&file(header, b"0 0 0 1 2 3 4 5 6 7 8"));
    let found: Vec<_> = mesh.attributes.iter().map(|a| (a.name.as_str(), a.data.clone())).collect();
    let expected = [("speed", vec![1., 2., 3.]), ("heat", vec![4.]), ("glow_color", vec![5., 6., 7.])];
    assert_eq!(found, expected);
}

#[test]
fn quads_are_kept_in_the_order_of_patches() {
    let text = "format ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 2\n\
        property list uchar int vertex_indices\nproperty float red\nproperty float green\nproperty float blue";
    let bytes = file(text, b"0 0 0 1 0 0 1 1 0 0 1 0\n4 0 1 2 3 1 0 0\n3 0 1 2 0 1 0\n");
    let mesh = read(&bytes, &PlyOptions { keep_quads: true, ..PlyOptions::default() }).unwrap().mesh;
    mesh.validate().unwrap();
    assert_eq!((mesh.patches.as_slice(), mesh.triangles.as_slice()), (&[[0, 1, 3, 2]][..], &[[0, 1, 2]][..]));
    // Triangles come first.
    assert_eq!(mesh.attributes[0].data, [0., 1., 0., 1., 0., 0.]);
    let mesh = read_ok(&bytes);
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [0, 1, 2]]);
    assert_eq!(mesh.attributes[0].data, [1., 0., 0., 1., 0., 0., 0., 1., 0.]);
}

#[test]
fn faces_may_stand_before_vertices_among_other_elements() {
    let header = "format ascii 1.0\nobj_info x\nelement edge 2\nproperty list uint8 double q\nproperty int w\nelement face 1\n\
        property list uchar float texcoord\nproperty list uchar int vertex_indices\nelement vertex 3\nproperty double z\n\
        property list uchar int neighbours\nproperty int y\nproperty float x\nelement trailing 1000000\nproperty int gone";
    let mesh = read_ok(&file(header, b"1 2.5 7\n0 8\n2 0.5 0.5 3 2 1 0\n0 1 5 0 0\n0 0 0 1\n0 2 1 1 1 0"));
    assert_eq!(mesh.positions, [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]]);
    assert_eq!(mesh.triangles, [[2, 1, 0]]);
}

#[test]
fn strips_alternate_their_winding() {
    let header = "format ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\nelement tristrips 1\n\
        property list int int vertex_indices";
    let mesh = read_ok(&file(header, b"0 0 0 1 0 0 0 1 0 1 1 0 2 2 0\n8 0 1 2 3 -1 2 3 4"));
    assert_eq!(mesh.triangles, [[0, 1, 2], [2, 1, 3], [2, 3, 4]]);
}

#[test]
fn carriage_returns_may_end_the_header() {
    for end in ["\r\n", "\r"] {
        let bytes = TRIANGLE.replace('\n', end);
        assert_eq!(read_ok(bytes.as_bytes()).triangles, [[0, 1, 2]]);
    }
}

#[test]
fn faults_are_located() {
    let edit = |from: &str, to: &str| fault(TRIANGLE.replacen(from, to, 1).as_bytes());
    for (error, kind, text) in [
        (edit("ply", "plx"), Kind::Syntax, "line 1: this is not a PLY file"),
        (edit("ascii", "asci"), Kind::Syntax, "line 2: unknown format 'asci'"),
        (edit("1.0", "2.0"), Kind::Unsupported, "line 2: 'format ascii 2.0': only version 1.0"),
        (edit("format ascii 1.0\n", ""), Kind::Missing, "no 'format' line"),
        (edit("vertex 3", "vertex -3"), Kind::Syntax, "line 3: element 'vertex': '-3' is not a count"),
        (edit("float x", "flat x"), Kind::Unsupported, "line 4: property 'x': unknown type 'flat'"),
        (edit("float z", "float w"), Kind::Missing, "line 3: element 'vertex' has no property 'z'"),
        (edit("vertex_indices", "corners"), Kind::Missing, "line 7: element 'face' has no list 'vertex_indices'"),
        (edit("list uchar", "list float"), Kind::Syntax, "length of a list must be an integer"),
        (edit("element face", "elephant face"), Kind::Syntax, "line 7: unknown keyword 'elephant'"),
        (edit("end_header\n", ""), Kind::Syntax, "line 9: unknown keyword '0'"),
        (edit("1 0 0", "1 zero 0"), Kind::Syntax, "line 11: vertex 1, property 'y': 'zero' is not a number"),
        (edit("3 0 1 2", "3 0 1 3"), Kind::IndexOutOfRange, "face 0 refers to vertex 3, but there are 3 vertices"),
        (edit("3 0 1 2", "3 0 -1 2"), Kind::IndexOutOfRange, "face 0 refers to vertex -1"),
        (
            edit("3 0 1 2", "3 0 1.5 2"),
            Kind::Syntax,
            "line 13: face 0, property 'vertex_indices': 1.5 is not a whole number",
        ),
        (edit("3 0 1 2", "-3 0 1 2"), Kind::Syntax, "a list cannot have -3 items"),
        (edit("3 0 1 2", "900000000 0 1 2"), Kind::Truncated, "a list of 900000000 items, but only 6 bytes are left"),
        (
            edit("vertex 3", "vertex 4000000000"),
            Kind::Truncated,
            "line 3: element 'vertex' declares 4000000000 records",
        ),
        (edit("face 1", "face 4000000000"), Kind::Truncated, "element 'face' declares 4000000000 records"),
    ] {
        assert!(error.kind == kind && error.to_string().contains(text), "{text:?} is not in {error:?}");
    }
}

/// Faces at vertices that are not finite are left out and counted, of every layout; one that nothing uses takes nothing
/// with it.
#[test]
fn vertices_that_are_not_finite_lose_their_faces() {
    let quad = "0 0 0\n1 0 0\n1 1 0\n0 1 0\nnan 0 0\n0 1e60 0\n";
    for (faces, list, triangles, left_out) in [
        ("3 0 1 2\n3 0 2 3", "", 2, 0),
        ("3 0 1 2\n3 0 2 4\n3 0 2 3", "", 2, 1),
        ("4 0 1 2 3\n4 0 1 5 3", "", 2, 1),
        ("3 0 1 2 9\n3 0 5 4 8", "property int label_x\n", 1, 1),
    ] {
        let text = TRIANGLE
            .replace("vertex 3", "vertex 6")
            .replace("0 0 0\n1 0 0\n0 1 0\n3 0 1 2", &(quad.to_owned() + faces));
        let text = text.replace("face 1", &format!("face {}", faces.lines().count()));
        let text = text.replace("end_header", &format!("{list}end_header"));
        let file = read(text.as_bytes(), &PlyOptions::default()).unwrap();
        file.mesh.validate().unwrap();
        assert_eq!((file.mesh.triangles.len(), file.bad_vertices, file.bad_faces), (triangles, 2, left_out), "{faces}");
        assert!(file.warning().unwrap().contains("2 vertices are not finite"));
    }
    // Packed binary records have a loop of their own.
    let mesh = Mesh {
        positions: vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [f32::INFINITY, 0., 0.]],
        triangles: vec![[0, 1, 2], [1, 2, 3]].into(),
        ..Mesh::default()
    };
    for format in ["binary_little_endian", "binary_big_endian"] {
        let file = read(&write(&mesh, format), &PlyOptions::default()).unwrap();
        assert_eq!((&file.mesh.triangles[..], file.bad_faces), (&[[0, 1, 2]][..], 1));
    }
}

/// Texture coordinates at corners split the vertices where they differ, with all that these have.
#[test]
fn texture_coordinates_of_corners_split_vertices() {
    let header = "format ascii 1.0\ncomment TextureFile a picture.png\nelement vertex 4\nproperty float x\nproperty \
      float y\n\
        property float z\nproperty uchar diffuse_red\nproperty uchar diffuse_green\nproperty uchar \
          diffuse_blue\nelement face 2\n\
        property list uchar int vertex_indices\nproperty list uchar float texcoord";
    let data = b"0 0 0 255 0 0 1 0 0 0 255 0 1 1 0 0 0 255 0 1 0 255 255 255\n3 0 1 2 6 0 0 1 0 1 1\n3 0 2 3 6 .5 \
      .5 1 1 nan 1";
    let options = PlyOptions { corner_uvs: true, ..PlyOptions::default() };
    let read = read(&file(header, data), &options).unwrap();
    let mesh = read.mesh;
    mesh.validate().unwrap();
    assert_eq!(read.pictures, ["a picture.png"]);
    assert_eq!(&mesh.triangles[..], [[0, 1, 2], [4, 2, 3]]);
    assert_eq!(mesh.uvs, [[0., 0.], [1., 0.], [1., 1.], [0., 1.], [0.5, 0.5]]);
    assert_eq!((mesh.positions[4], mesh.attributes[0].name.as_str()), ([0.0; 3], "color"));
    assert_eq!(mesh.attributes[0].data[12..], [1.0, 0.0, 0.0]);
}

#[test]
fn a_small_file_cannot_ask_for_much() {
    for (format, properties) in [
        ("ascii", "property float x"),
        ("binary_little_endian", "property uchar x"),
        ("binary_big_endian", "property list uchar int x"),
    ] {
        for element in ["vertex", "face", "other"] {
            let header = format!(
                "format {format} 1.0\nelement {element} 4000000000000000000\n{properties}\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z"
            );
            // What takes a step, or a byte, for each of them does not come to an end.
            fault(&file(&header, &[0; 1024]));
        }
    }
    // An element without properties takes no bytes, whatever its count.
    let header = "format ascii 1.0\nelement nothing 4000000000\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z";
    assert_eq!(read_ok(&file(header, b"1 2 3")).positions, [[1., 2., 3.]]);
}

#[test]
fn every_truncation_is_an_error_or_a_valid_mesh() {
    let Some(root) = assets() else { return };
    for name in [
        "assimp/cube_binary.ply",
        "magnum/custom-components-be.ply",
        "trimesh/plane.ply",
        "magnum/per-face-colors-be.ply",
    ] {
        let bytes = std::fs::read(root.join("ply").join(name)).unwrap();
        for end in 0..bytes.len() {
            match read(&bytes[..end], &PlyOptions::default()) {
                Ok(file) => {
                    file.mesh.validate().unwrap();
                    assert!(name.contains("plane") && end + 4 > bytes.len(), "{name} cut at {end} is read");
                }
                Err(e) => assert!(e.offset <= end, "{e}"),
            }
        }
    }
}

#[test]
fn mutants_neither_panic_nor_swell() {
    let Some(root) = assets() else { return };
    for name in
        ["assimp/cube_binary.ply", "assimp/cube_uv.ply", "magnum/custom-components-be.ply", "trimesh/metadata.ply"]
    {
        let seed = std::fs::read(root.join("ply").join(name)).unwrap();
        mutants(&seed, 2_500, |bytes| {
            for keep_quads in [false, true] {
                let options = PlyOptions { keep_quads, corner_uvs: keep_quads, recentre: keep_quads };
                if let Ok(PlyFile { mesh, .. }) = read(bytes, &options) {
                    mesh.validate().unwrap();
                    assert!(mesh.bytes() < 1 << 20, "{} bytes from {}", mesh.bytes(), bytes.len());
                }
            }
        });
    }
}

#[test]
fn attributes_are_plain_data() {
    let header = "format binary_little_endian 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n\
        property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha";
    let mesh = read_ok(&file(header, &[&[0; 12][..], &[0, 255, 128, 128]].concat()));
    let Attribute { data, channels, .. } = &mesh.attributes[0];
    assert_eq!(*channels, 4);
    for (found, expected) in data.iter().zip([0.0, 1.0, 0.215_861, 128.0 / 255.0]) {
        assert!((found - expected).abs() < 1e-5, "{data:?}");
    }
}

#[test]
fn a_header_of_very_many_properties_is_refused() {
    let mut header = String::from("format ascii 1.0\nelement vertex 1");
    (0..200_000).for_each(|i| header += &format!("\nproperty float a{i}_x"));
    assert_eq!(fault(&file(&header, b"")).kind, Kind::TooLarge);
}

/// Files in coordinates of a country keep their millimetres when they are moved to the origin, in every encoding; those
/// whose numbers are in single precision, and all where nobody asks for it, stay where they are.
#[test]
fn georeferenced_files_are_moved_to_the_origin() {
    let points: [[f64; 3]; 3] =
        [[448_262.25, 5_411_932.75, 35.5], [448_262.251, 5_411_932.75, 35.5], [448_262.25, 5_411_932.753, 35.5]];
    let far = |encoding: &str, t: &str, extra: &str| {
        let mut out = format!(
            "ply\nformat {encoding} 1.0\nelement vertex 3\nproperty {t} x\nproperty {t} y\nproperty {t} z\n{extra}\
             element face 1\nproperty list uchar uchar vertex_indices\nend_header\n"
        )
        .into_bytes();
        let is_text = encoding == "ascii";
        let end_of_list = || (!extra.is_empty()).then_some(None);
        for v in points.iter().flat_map(|p| p.iter().map(Some).chain(end_of_list())) {
            match (v, is_text, encoding.contains("big"), t) {
                (Some(v), true, ..) => out.extend(format!("{v} ").bytes()),
                (None, true, ..) => out.extend(b"0 "),
                (None, ..) => out.push(0),
                (Some(v), _, big, "double") => out.extend(if big { v.to_be_bytes() } else { v.to_le_bytes() }),
                (Some(v), ..) => out.extend((*v as f32).to_le_bytes()),
            }
        }
        out.extend(if is_text { &b"3 0 1 2"[..] } else { &[3, 0, 1, 2] });
        out
    };
    let moved = PlyOptions { recentre: true, ..PlyOptions::default() };
    let (little, list) = ("binary_little_endian", "property list uchar uchar others\n");
    for file in [
        far("ascii", "double", ""),
        far("ascii", "float", ""),
        far(little, "double", ""),
        far("binary_big_endian", "double", ""),
        far(little, "double", list),
        far("ascii", "double", list),
    ] {
        let PlyFile { mesh, origin, .. } = read(&file, &moved).unwrap();
        assert_eq!(origin, [448_262.0, 5_411_933.0, 0.0]);
        for (p, wanted) in mesh.positions.iter().zip(points) {
            let found: [f64; 3] = std::array::from_fn(|c| f64::from(p[c]) + origin[c]);
            assert!(found.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-6), "{found:?}");
        }
        assert_eq!(read(&file, &PlyOptions::default()).unwrap().origin, [0.0; 3]);
    }
    assert_eq!(read(&far(little, "float", ""), &moved).unwrap().origin, [0.0; 3]);
    assert_eq!(read(TRIANGLE.as_bytes(), &moved).unwrap().origin, [0.0; 3]);
}
