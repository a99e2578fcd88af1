use super::*;
use crate::mesh::{
    MeshErrorKind as Kind,
    test_files::{assets, mutants},
};

fn open(text: &str) -> ObjFile {
    let file = read(text.as_bytes(), &ObjOptions::default()).unwrap();
    file.meshes.iter().for_each(|m| m.mesh.validate().unwrap());
    file
}

fn area(mesh: &Mesh) -> f64 {
    let p = |i: u32| steradian_math::DVec3::from(mesh.positions[i as usize].map(f64::from));
    mesh.triangles.iter().map(|t| (p(t[1]) - p(t[0])).cross(p(t[2]) - p(t[0])).length() * 0.5).sum()
}

#[test]
fn real_files_have_the_known_faces() {
    let Some(root) = assets() else { return };
    for (name, meshes, triangles) in [
        ("obj/large/house-Mesh151.obj", 1, 78_848),
        ("obj/bathroom/Mesh238.obj", 1, 20_152),
        ("obj/spot/spot_triangulated.obj", 1, 5_856),
        ("obj/spot/spot_quadrangulated.obj", 1, 5_856),
        ("obj/spot/spot_control_mesh.obj", 1, 372),
        ("obj/assimp/box.obj", 1, 12),
        ("obj/assimp/box_longline.obj", 1, 944),
        ("obj/assimp/box_mat_with_spaces.obj", 1, 12),
        ("obj/assimp/box_without_lineending.obj", 1, 12),
        ("obj/assimp/concave_polygon.obj", 1, 64),
        ("obj/assimp/cube_mtllib_after_g.obj", 1, 12),
        ("obj/assimp/cube_usemtl.obj", 3, 12),
        ("obj/assimp/cube_with_vertexcolors.obj", 1, 12),
        ("obj/assimp/cube_with_vertexcolors_uni.obj", 1, 12),
        ("obj/assimp/mtl_different_folder.obj", 1, 12),
        ("obj/assimp/multiple_spaces.obj", 1, 1),
        ("obj/assimp/number_formats.obj", 1, 1),
        ("obj/assimp/space_in_material_name.obj", 1, 64),
        ("obj/assimp/testline.obj", 0, 0),
        ("obj/assimp/testmixed.obj", 1, 12),
        ("obj/assimp/testpoints.obj", 0, 0),
        ("mitsuba/tests/obj/cbox_smallbox.obj", 1, 12),
        ("mitsuba/tests/obj/rectangle_normals_uv.obj", 1, 2),
    ] {
        let bytes = std::fs::read(root.join(name)).unwrap();
        let file = read(&bytes, &ObjOptions::default()).unwrap_or_else(|e| panic!("{name}: {e}"));
        file.meshes.iter().for_each(|m| m.mesh.validate().unwrap());
        let count: usize = file.meshes.iter().map(|m| m.mesh.triangles.len()).sum();
        assert_eq!((file.meshes.len(), count), (meshes, triangles), "{name}");
        let merged = read(&bytes, &ObjOptions { merge: true, ..ObjOptions::default() }).unwrap();
        assert_eq!(
            merged.meshes.iter().map(|m| m.mesh.triangles.len()).collect::<Vec<_>>(),
            Some(triangles).into_iter().filter(|&n| n > 0).collect::<Vec<_>>()
        );
    }
}

#[test]
fn every_real_file_reads() {
    let Some(root) = assets() else { return };
    let mut count = 0;
    for folder in ["obj/assimp", "obj/bathroom", "obj/large", "obj/spot", "mitsuba/tests/obj"] {
        for entry in std::fs::read_dir(root.join(folder)).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_some_and(|e| e == "obj") {
                read(&std::fs::read(&path).unwrap(), &ObjOptions::default())
                    .unwrap_or_else(|e| panic!("{}: {e}", path.display()));
                count += 1;
            }
        }
    }
    assert!(count >= 25, "{count} files");
}

/// The polygon is a ring cut open along a slit; a fan would cover its hole.
#[test]
fn concave_polygons_keep_their_area() {
    let Some(root) = assets() else { return };
    let mesh = &open(&std::fs::read_to_string(root.join("obj/assimp/concave_polygon.obj")).unwrap()).meshes[0].mesh;
    let (mut radii, n) = ([0.0f64; 2], mesh.positions.len());
    assert!(n >= 64);
    // Shoelace over the corners in the order of the file (all at one x).
    let line = std::fs::read_to_string(root.join("obj/assimp/concave_polygon.obj")).unwrap();
    let v: Vec<[f64; 2]> = line
        .lines()
        .filter(|l| l.starts_with("v "))
        .map(|l| {
            let w: Vec<f64> = l.split_whitespace().skip(1).map(|w| w.parse().unwrap()).collect();
            [w[1], w[2]]
        })
        .collect();
    let f = line.lines().find(|l| l.starts_with("f ")).unwrap();
    let ring: Vec<[f64; 2]> =
        f.split_whitespace().skip(1).map(|c| v[c.split('/').next().unwrap().parse::<usize>().unwrap() - 1]).collect();
    for i in 0..ring.len() {
        let (a, b) = (ring[i], ring[(i + 1) % ring.len()]);
        radii[0] += 0.5 * (a[0] * b[1] - a[1] * b[0]);
    }
    radii[1] = area(mesh);
    assert!((radii[0].abs() - radii[1]).abs() < 1e-4, "{radii:?}");
}

#[test]
fn corners_are_shared_where_they_agree() {
    let file = open(
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 1\nvn 0 0 1\nf 1/1/1 2/1/1 3/1/1\nf 1/1/1 3/1/1 4/1/1\nf 1/2/1 3/1/1 4/1/1\n",
    );
    let mesh = &file.meshes[0].mesh;
    assert_eq!(mesh.positions.len(), 5);
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [4, 2, 3]]);
    assert_eq!(mesh.uvs[4], [1.0, 1.0]);
}

#[test]
fn many_variants_of_a_position_are_told_apart() {
    let mut text = String::from("v 0 0 0\nv 1 0 0\nv 0 1 0\n");
    (0..60_000).for_each(|i| text += &format!("vt {i} 0\n"));
    for round in 0..2 {
        (0..20_000).for_each(|i| text += &format!("f 1/{} 1/{} 1/{}\n", 3 * i + 1, 3 * i + 2, 3 * i + 3));
        assert_eq!(open(&text).meshes[0].mesh.positions.len(), 60_000, "round {round}");
    }
}

#[test]
fn relative_indices_count_back_from_the_face() {
    let file = open("v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 5 5 5\nf -4 -3 -1\nf 1 2 \\\n 4\n");
    let mesh = &file.meshes[0].mesh;
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 1, 3], [0, 1, 3]]);
}

#[test]
fn faces_may_stand_before_their_vertices() {
    assert_eq!(open("f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0").meshes[0].mesh.triangles, [[0, 1, 2]]);
}

#[test]
fn names_libraries_and_skips_are_kept() {
    let text = "mtllib a.mtl b.mtl\nmtllib my lib.mtl\r\nmtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0 1.0\no thing\ng left arm\nusemtl red paint \n\
        f 1 2 3\nusemtl blue\nf 1 2 3\nusemtl red paint\nf 3 2 1\np 1\nl 1 2\nf 1 2\ncurv 0 1 1 2\nnonsense\ns off\n";
    let file = open(text);
    assert_eq!(file.libraries.iter().map(|l| l.name.as_str()).collect::<Vec<_>>(), ["a.mtl", "b.mtl", "my lib.mtl"]);
    assert_eq!(file.meshes.len(), 2);
    let first = &file.meshes[0];
    assert_eq!(
        (first.object.as_str(), first.group.as_str(), first.material.as_deref()),
        ("thing", "left arm", Some("red paint"))
    );
    assert_eq!(first.mesh.triangles.len(), 2);
    assert!(text[first.material_offset..].starts_with("usemtl red paint \nf 1"));
    let s = file.skipped;
    assert_eq!((s.points, s.lines, s.degenerate, s.free_form, s.unknown), (1, 1, 1, 1, 1));
}

#[test]
fn absent_normals_become_those_of_the_face() {
    let file = open("v 0 0 0\nv 2 0 0\nv 0 2 0\nvn 1 0 0\nf 1//1 2//1 3//1\nf 1 2 3\n");
    let mesh = &file.meshes[0].mesh;
    assert_eq!(mesh.normals[..3], [[1., 0., 0.]; 3]);
    assert_eq!(mesh.normals[3..], [[0., 0., 1.]; 3]);
}

#[test]
fn colors_and_flipped_coordinates() {
    let text = "v 0 0 0 1 0.5 0\nv 1 0 0\nv 0 1 0 0 0 1\nvt 0.25 0.25\nf 1/1 2/1 3/1";
    let file = read(text.as_bytes(), &ObjOptions { flip_v: true, merge: true, ..ObjOptions::default() }).unwrap();
    let mesh = &file.meshes[0].mesh;
    assert_eq!(mesh.uvs[0], [0.25, 0.75]);
    assert_eq!(mesh.attributes[0].data, [1., 0.5, 0., 1., 1., 1., 0., 0., 1.]);
}

/// A vertex that is not finite takes its faces with it, one that nothing uses nothing; other numbers become zero.
#[test]
fn numbers_that_are_not_finite_are_left_out_and_counted() {
    let vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 nan 0\nv inf 1 1e99\nvn 0 1e99 0\nvt nan 0\n";
    for (faces, left, left_out) in
        [("f 1 2 3", 1, 0), ("f 1 2 4\nf 1//1 2//1 3//1\nf 5 1 2 3", 1, 2), ("f 1 2 5", 0, 1)]
    {
        let file = read((vertices.to_owned() + faces).as_bytes(), &ObjOptions::default()).unwrap();
        assert_eq!((file.skipped.bad_faces, file.skipped.not_finite), (left_out, 2), "{faces}");
        assert_eq!(file.meshes.iter().map(|m| m.mesh.triangles.len()).sum::<usize>(), left, "{faces}");
        file.meshes.iter().for_each(|m| m.mesh.validate().unwrap());
        assert!(file.skipped.warning().unwrap().contains("not finite"));
    }
}

#[test]
fn faults_are_located() {
    let start = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    for (line, kind, text) in [
        ("v 1 2", Kind::Syntax, "line 4: vertex: 2 numbers where 3 are needed"),
        ("v 1 2 x", Kind::Syntax, "line 4: vertex: 'x' is not a number"),
        ("vt", Kind::Syntax, "line 4: texture coordinate: 0 numbers"),
        ("f 1 2 4", Kind::IndexOutOfRange, "line 4: the face refers to number 4 of the vertices, but the file has 3"),
        ("f 0 1 2", Kind::IndexOutOfRange, "line 4: the face refers to vertex 0"),
        ("f -4 1 2", Kind::IndexOutOfRange, "line 4: the face refers to vertex -4, but 3 stand before it"),
        ("f 1 2 99999999999999999999999", Kind::IndexOutOfRange, "line 4: the face refers to vertex"),
        ("f 1 2 3x", Kind::Syntax, "line 4: face: '3x' is not a corner"),
        ("f 1 2 /3", Kind::Syntax, "line 4: face: '/3' is not a corner"),
        ("f 1/1/1/1 2 3", Kind::Syntax, "line 4: "),
    ] {
        let error =
            read(format!("{start}{line}\nv 1\n").replace("v 1\n", "# end\n").as_bytes(), &ObjOptions::default())
                .unwrap_err();
        assert!(error.kind == kind && error.to_string().contains(text), "{text:?} is not in {error:?}");
    }
}

#[test]
fn truncations_and_mutants_neither_panic_nor_swell() {
    let Some(root) = assets() else { return };
    for name in ["box_mat_with_spaces.obj", "cube_with_vertexcolors.obj", "number_formats.obj", "testmixed.obj"] {
        let seed = std::fs::read(root.join("obj/assimp").join(name)).unwrap();
        let check = |bytes: &[u8]| {
            if let Ok(file) = read(bytes, &ObjOptions::default()) {
                for m in &file.meshes {
                    m.mesh.validate().unwrap();
                    assert!(!m.mesh.triangles.is_empty() && m.mesh.bytes() < 1 << 20);
                }
            }
        };
        (0..seed.len()).for_each(|end| check(&seed[..end]));
        mutants(&seed, 2_500, check);
    }
}

/// Hostile files are read in full. A quadratic algorithm takes minutes here, and is seen in the time of all tests: no
/// verdict depends on a clock.
#[test]
fn hostile_files_are_read_whole() {
    let square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
    let mut text = String::from(square);
    (0..200_000).for_each(|i| text += &format!("mtllib {i}.mtl\nusemtl {i}\nf 1 2 3\n"));
    let file = open(&text);
    assert_eq!((file.meshes.len(), file.libraries.len()), (200_000, 200_000));
    let long = format!("{square}g {}\n", "x".repeat(1 << 20));
    let text =
        (0..100_000).fold(long, |t, i| t + if i % 2 == 0 { "usemtl a\nf 1 2 3\n" } else { "usemtl b\nf 1 2 3\n" });
    assert_eq!(open(&text).meshes.len(), 2);
}

/// Texture coordinates and normals that the file does not have are left out, whether they stand before it or not; so
/// are colours that are no numbers. All are counted.
#[test]
fn what_faces_lack_is_left_out() {
    let vertices = "v 0 0 0 1 0 0\nv 1 0 0 nan 0 0\nv 0 1 0 0 inf 1\nvt 0.5 0.25\nvn 0 0 1\n";
    let file = open(&format!("{vertices}f 1/1/1 2/7/9 3/-5/0\n"));
    assert_eq!((file.skipped.references, file.skipped.colors), (4, 2));
    let mesh = &file.meshes[0].mesh;
    assert_eq!(mesh.triangles.len(), 1);
    assert_eq!(
        (mesh.uvs[0], mesh.uvs[1], mesh.normals[0], mesh.normals[2]),
        ([0.5, 0.25], [0.0; 2], [0., 0., 1.], [0., 0., 1.])
    );
    assert_eq!(mesh.attributes[0].data, [1., 0., 0., 1., 1., 1., 1., 1., 1.]);
    let said = file.skipped.warning().unwrap();
    assert!(said.contains("4 texture coordinates and normals") && said.contains("2 colours"), "{said}");
    let sound = open(&format!("{vertices}f 1/1/1 2/1/1 3/1/1\n").replace("nan", "1").replace("inf", "1"));
    assert_eq!(sound.skipped.warning(), None);
}

/// Files in coordinates of a country keep their centimetres when they are moved to the origin, and nothing moves
/// otherwise.
#[test]
fn georeferenced_files_are_moved_to_the_origin() {
    let text = "v 448262.25 5411932.75 35.5\nv 448262.26 5411932.75 35.5\nv 448262.25 5411932.77 35.5\nf 1 2 3\n";
    let moved = read(text.as_bytes(), &ObjOptions { recentre: true, ..ObjOptions::default() }).unwrap();
    assert_eq!(moved.origin[2], 0.0);
    let p = &moved.meshes[0].mesh.positions;
    for (k, wanted) in [[448_262.25, 5_411_932.75, 35.5], [448_262.26, 5_411_932.75, 35.5]].iter().enumerate() {
        let found: [f64; 3] = std::array::from_fn(|c| f64::from(p[k][c]) + moved.origin[c]);
        assert!(found.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-6), "{found:?}");
    }
    assert_eq!(open(text).origin, [0.0; 3]);
    let near = read(b"v 1 2 3\nv 4 5 6\nv 7 8 10\nf 1 2 3\n", &ObjOptions { recentre: true, ..ObjOptions::default() });
    assert_eq!(near.unwrap().origin, [0.0; 3]);
}
