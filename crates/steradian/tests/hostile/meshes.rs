//! Mesh files that lie, break off, or hold what cannot be rendered: PLY, OBJ and `.serialized`.

use crate::case::{Case, Expect};
use Expect::{Either, Picture, Refused, Warned};
use std::io::Write;

/// An ASCII PLY file.
fn ply(vertices: &str, faces: &str, body: &str) -> Vec<u8> {
    format!(
        "ply\nformat ascii 1.0\nelement vertex {vertices}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {faces}\nproperty list uchar int vertex_indices\nend_header\n{body}"
    )
    .into_bytes()
}

/// The three corners of a triangle before the camera.
const CORNERS: &str = "-1 -1 0\n1 -1 0\n0 1 0\n";

/// A binary PLY file of one triangle, with counts and list length as given.
fn binary_ply(vertices: u64, faces: u64, list: &str, length: &[u8]) -> Vec<u8> {
    let mut bytes = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {vertices}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {faces}\nproperty list {list} int vertex_indices\nend_header\n"
    )
    .into_bytes();
    for v in [-1.0_f32, -1.0, 0.0, 1.0, -1.0, 0.0, 0.0, 1.0, 0.0] {
        bytes.extend(v.to_le_bytes());
    }
    bytes.extend(length);
    [0, 1, 2].iter().for_each(|i: &i32| bytes.extend(i.to_le_bytes()));
    bytes
}

/// A `.serialized` file (version 4) with one mesh of a triangle and the counts as given.
fn serialized(vertices: u64, triangles: u64, flags: u32, last_index: u32) -> Vec<u8> {
    let mut plain = flags.to_le_bytes().to_vec();
    plain.extend(b"mesh\0");
    plain.extend(vertices.to_le_bytes());
    plain.extend(triangles.to_le_bytes());
    for v in [-1.0_f32, -1.0, 0.0, 1.0, -1.0, 0.0, 0.0, 1.0, 0.0] {
        plain.extend(v.to_le_bytes());
    }
    [0, 1, last_index].iter().for_each(|i| plain.extend(i.to_le_bytes()));
    let mut packer = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::default());
    packer.write_all(&plain).expect("memory can be written");
    let mut bytes = vec![0x1c, 0x04, 4, 0];
    bytes.extend(packer.finish().expect("memory can be written"));
    bytes.extend(0_u64.to_le_bytes());
    bytes.extend(1_u32.to_le_bytes());
    bytes
}

/// A mesh as the file of a pbrt shape, and by itself.
fn ply_cases(name: &str, bytes: &[u8], expect: Expect) -> [Case; 3] {
    let in_mitsuba = "<shape type='ply'><string name='filename' value='m.ply'/></shape>";
    [
        Case::pbrt(format!("pbrt, {name}"), "Shape \"plymesh\" \"string filename\" \"m.ply\"", expect)
            .with("m.ply", bytes),
        Case::mitsuba(format!("Mitsuba, {name}"), in_mitsuba, expect).with("m.ply", bytes),
        Case::new(format!("alone, {name}"), "m.ply", bytes, expect),
    ]
}

pub fn table() -> Vec<Case> {
    let t = |numbers: &str| numbers.to_string() + "\n1 -1 0\n0 1 0\n3 0 1 2\n";
    let mut cases: Vec<Case> = [
        ply_cases("sound", &ply("3", "1", &format!("{CORNERS}3 0 1 2\n")), Picture),
        ply_cases("sound binary", &binary_ply(3, 1, "uchar", &[3]), Picture),
        ply_cases("empty", b"", Either),
        ply_cases("magic alone", b"ply\n", Refused("m.ply")),
        ply_cases("no end of header", b"ply\nformat ascii 1.0\nelement vertex 3\n", Refused("m.ply")),
        ply_cases("unknown format", b"ply\nformat middle_endian 1.0\nend_header\n", Refused("middle_endian")),
        ply_cases("no elements", b"ply\nformat ascii 1.0\nend_header\n", Refused("m.ply")),
        ply_cases("4e9 vertices", &ply("4000000000", "1", CORNERS), Refused("4000000000")),
        ply_cases("4e9 vertices, binary", &binary_ply(4_000_000_000, 1, "uchar", &[3]), Refused("4000000000")),
        ply_cases("4e9 faces", &ply("3", "4000000000", CORNERS), Refused("4000000000")),
        ply_cases("2^64 vertices", &binary_ply(u64::MAX, 1, "uchar", &[3]), Refused("m.ply")),
        ply_cases("10^30 vertices", &ply("1000000000000000000000000000000", "1", CORNERS), Refused("m.ply")),
        ply_cases("minus one vertices", &ply("-1", "1", CORNERS), Refused("-1")),
        ply_cases("list of 2^32 - 1", &binary_ply(3, 1, "uint", &[0xff; 4]), Refused("m.ply")),
        ply_cases("list of minus one", &binary_ply(3, 1, "int", &[0xff; 4]), Refused("m.ply")),
        ply_cases("list of no length", &binary_ply(3, 1, "float", &f32::NAN.to_le_bytes()), Refused("m.ply")),
        ply_cases("cut off in the vertices", &ply("3", "1", "-1 -1 0\n1 -1"), Refused("m.ply")),
        ply_cases("cut off in the faces", &ply("3", "1", &format!("{CORNERS}3 0 1")), Refused("m.ply")),
        ply_cases("index out of range", &ply("3", "1", &format!("{CORNERS}3 0 1 3\n")), Refused("3")),
        ply_cases("index negative", &ply("3", "1", &format!("{CORNERS}3 0 1 -1\n")), Refused("-1")),
        ply_cases("index of 2^31", &ply("3", "1", &format!("{CORNERS}3 0 1 2147483647\n")), Refused("2147483647")),
        ply_cases("word for a number", &ply("3", "1", &t("x -1 0")), Refused("m.ply")),
        ply_cases("nan vertex", &ply("3", "1", &t("nan -1 0")), Either),
        ply_cases("infinite vertex", &ply("3", "1", &t("inf -1 0")), Either),
        ply_cases("vertex 1e39", &ply("3", "1", &t("1e39 -1 0")), Either),
        ply_cases("vertex 3e38", &ply("3", "1", &t("3e38 -3e38 0")), Either),
        ply_cases("vertex 1e37", &ply("3", "1", &t("1e37 -1e37 0")), Either),
        ply_cases("all vertices 1e38", &ply("3", "1", "1e38 0 0\n0 1e38 0\n-1e38 -1e38 0\n3 0 1 2\n"), Either),
        ply_cases("vertices 1e-38", &ply("3", "1", "1e-38 0 0\n0 1e-38 0\n-1e-38 -1e-38 0\n3 0 1 2\n"), Either),
        ply_cases("vertices 1e-45", &ply("3", "1", "1e-45 0 0\n0 1e-45 0\n-1e-45 -1e-45 0\n3 0 1 2\n"), Either),
        ply_cases("no faces", &ply("3", "0", CORNERS), Either),
        ply_cases("no vertices", &ply("0", "0", ""), Either),
        ply_cases("faces without vertices", &ply("0", "1", "3 0 1 2\n"), Refused("m.ply")),
        ply_cases("triangle of one point", &ply("3", "1", "0 0 0\n0 0 0\n0 0 0\n3 0 1 2\n"), Either),
        ply_cases("triangle of one index", &ply("3", "1", &format!("{CORNERS}3 1 1 1\n")), Either),
        ply_cases("triangle on a line", &ply("3", "1", "-1 0 0\n0 0 0\n1 0 0\n3 0 1 2\n"), Either),
        ply_cases("face of two", &ply("3", "1", &format!("{CORNERS}2 0 1\n")), Either),
        ply_cases("face of none", &ply("3", "1", &format!("{CORNERS}0\n")), Either),
        ply_cases("polygon of one point", &ply("3", "1", &format!("{CORNERS}5 0 0 0 0 0\n")), Either),
        ply_cases("polygon that crosses itself", &ply("4", "1", "0 0 0\n1 1 0\n1 0 0\n0 1 0\n4 0 1 2 3\n"), Either),
        ply_cases("gzip bomb", &gzip_bomb(16 << 20), Either),
        ply_cases("10^5 properties", &properties(100_000), Either),
        ply_cases(
            "property of a type that is none",
            b"ply\nformat ascii 1.0\nelement vertex 1\nproperty quad x\nend_header\n",
            Refused("quad"),
        ),
    ]
    .into_iter()
    .flatten()
    .collect();
    cases.extend(obj());
    cases.extend(serialized_cases());
    cases.extend(emitting());
    cases
}

/// A PLY file whose vertices never end, packed.
fn gzip_bomb(bytes: usize) -> Vec<u8> {
    let mut packer = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    packer.write_all(&ply("100000000", "1", "")).expect("memory can be written");
    packer.write_all(&vec![b'0'; bytes]).expect("memory can be written");
    packer.finish().expect("memory can be written")
}

fn properties(count: usize) -> Vec<u8> {
    let list: String = (0..count).map(|i| format!("property float p{i}\n")).collect();
    format!("ply\nformat ascii 1.0\nelement vertex 1\n{list}end_header\n1 2 3\n").into_bytes()
}

fn obj() -> Vec<Case> {
    let vertices = "v -1 -1 0\nv 1 -1 0\nv 0 1 0\n";
    let cases = [
        ("sound", format!("{vertices}f 1 2 3\n"), Picture),
        ("empty", String::new(), Either),
        ("index out of range", format!("{vertices}f 1 2 4\n"), Refused("4")),
        ("index zero", format!("{vertices}f 0 1 2\n"), Refused("0")),
        ("index far below", format!("{vertices}f -4 -2 -1\n"), Refused("-4")),
        ("index of 2^63", format!("{vertices}f 1 2 9223372036854775808\n"), Refused("")),
        ("texture index out of range", format!("{vertices}vt 0 0\nf 1/1 2/2 3/1\n"), Warned("texture coordinates")),
        (
            "normal index overflow",
            format!("{vertices}vn 0 0 1\nf 1//1 2//1 3//4294967297\n"),
            Warned("texture coordinates and normals"),
        ),
        ("nan vertex", format!("v nan 0 0\n{vertices}f 1 2 3\n"), Either),
        ("infinite vertex", format!("v inf 0 0\n{vertices}f 1 2 3\n"), Either),
        ("vertex 1e39", format!("v 1e39 0 0\n{vertices}f 1 2 3\n"), Either),
        ("vertex 1e38", format!("v 1e38 -1e38 0\n{vertices}f 1 2 3\n"), Either),
        ("nan normal", format!("{vertices}vn nan 0 1\nf 1//1 2//1 3//1\n"), Either),
        ("zero normal", format!("{vertices}vn 0 0 0\nf 1//1 2//1 3//1\n"), Either),
        ("nan texture coordinate", format!("{vertices}vt nan 0\nf 1/1 2/1 3/1\n"), Either),
        ("vertex of two numbers", format!("v 1 2\n{vertices}f 1 2 3\n"), Refused("")),
        ("face of two corners", format!("{vertices}f 1 2\n"), Either),
        ("face of one corner, thrice", format!("{vertices}f 1 1 1\n"), Either),
        ("face that is none", format!("{vertices}f a b c\n"), Refused("")),
        ("material library missing", format!("mtllib no.mtl\nusemtl m\n{vertices}f 1 2 3\n"), Either),
        ("material library is itself", format!("mtllib m.obj\nusemtl m\n{vertices}f 1 2 3\n"), Either),
        ("face of 10^5 corners", format!("{vertices}f {}\n", "1 2 3 ".repeat(33_333)), Either),
        ("line of 10^6 words", format!("{vertices}f 1 2 3\n# {}\n", "x ".repeat(1_000_000)), Picture),
        ("10^5 groups", format!("{vertices}{}", (0..100_000).map(|i| format!("g {i}\n")).collect::<String>()), Either),
        ("zeros", "\0".repeat(4096), Either),
    ];
    let in_mitsuba = "<shape type='obj'><string name='filename' value='m.obj'/></shape>";
    let mut all: Vec<Case> = Vec::new();
    for (name, text, expect) in cases {
        all.push(Case::new(format!("OBJ alone, {name}"), "m.obj", text.clone(), expect));
        all.push(Case::mitsuba(format!("OBJ in Mitsuba, {name}"), in_mitsuba, expect).with("m.obj", text));
    }
    let triangle = format!("mtllib m.mtl\nusemtl m\n{vertices}f 1 2 3\n");
    for value in ["nan", "inf", "1e39", "-1", "7", ""] {
        let mtl = format!(
            "newmtl m\nKd {value} 1 1\nKs 1 {value} 1\nNs {value}\nNi {value}\nd {value}\nKe {value} 0 0\nillum {value}\n"
        );
        all.push(Case::new(format!("MTL of '{value}'"), "m.obj", triangle.clone(), Either).with("m.mtl", mtl));
    }
    all.push(
        Case::new("MTL with itself as texture", "m.obj", triangle.clone(), Either)
            .with("m.mtl", "newmtl m\nmap_Kd m.mtl\nbump m.obj\n"),
    );
    all.push(Case::new("MTL of zeros", "m.obj", triangle, Either).with("m.mtl", vec![0; 4096]));
    all
}

fn serialized_cases() -> Vec<Case> {
    let sound = serialized(3, 1, 0x1000, 2);
    let mut huge_table = sound.clone();
    let at = huge_table.len() - 4;
    huge_table[at..].fill(0xff);
    let mut version = sound.clone();
    version[2] = 9;
    let cases = [
        ("sound", 0, sound.clone(), Picture),
        ("empty", 0, Vec::new(), Refused("m.serialized")),
        ("cut off", 0, sound[..sound.len() / 2].to_vec(), Refused("m.serialized")),
        ("index out of range", 0, serialized(3, 1, 0x1000, 3), Refused("3")),
        ("4e9 vertices", 0, serialized(4_000_000_000, 1, 0x1000, 2), Refused("m.serialized")),
        ("2^64 triangles", 0, serialized(3, u64::MAX, 0x1000, 2), Refused("m.serialized")),
        ("doubles that are not there", 0, serialized(3, 1, 0x2000, 2), Refused("m.serialized")),
        ("unknown version", 0, version, Refused("9")),
        ("mesh that is not there", 7, sound.clone(), Refused("7")),
        ("mesh number -1", -1, sound.clone(), Refused("")),
        ("table of 2^32 - 1 meshes", 1, huge_table, Refused("m.serialized")),
        ("zeros", 0, vec![0; 4096], Refused("m.serialized")),
    ];
    let case = |(name, index, bytes, expect): (&str, i64, Vec<u8>, Expect)| {
        let body = format!(
            "<shape type='serialized'><string name='filename' value='m.serialized'/><integer name='shape_index' value='{index}'/></shape>"
        );
        Case::mitsuba(format!("serialized, {name}"), body, expect).with("m.serialized", bytes)
    };
    cases.into_iter().map(case).collect()
}

/// Emitting meshes with nothing, with points, and with NaN in them.
fn emitting() -> Vec<Case> {
    let meshes = [
        ("no faces", ply("3", "0", CORNERS)),
        ("one point", ply("3", "1", "0 0 0\n0 0 0\n0 0 0\n3 0 1 2\n")),
        ("a line", ply("3", "1", "-1 0 0\n0 0 0\n1 0 0\n3 0 1 2\n")),
        ("one point and a triangle", ply("3", "2", &format!("{CORNERS}3 0 0 0\n3 0 1 2\n"))),
        ("nan", ply("3", "1", "nan 0 0\n0 0 0\n1 1 0\n3 0 1 2\n")),
        ("nan and a triangle", ply("4", "2", &format!("{CORNERS}nan 0 0\n3 0 1 3\n3 0 1 2\n"))),
        ("vertices 1e30", ply("3", "1", "-1e30 -1e30 0\n1e30 -1e30 0\n0 1e30 0\n3 0 1 2\n")),
        ("vertices 1e-30", ply("3", "1", "-1e-30 -1e-30 0\n1e-30 -1e-30 0\n0 1e-30 0\n3 0 1 2\n")),
        ("a quad of 1e19", ply("4", "1", "-1e19 -1e19 9\n1e19 -1e19 9\n1e19 1e19 9\n-1e19 1e19 9\n4 0 1 2 3\n")),
    ];
    meshes
        .into_iter()
        .flat_map(|(name, bytes)| {
            let pbrt = "AreaLightSource \"diffuse\" \"rgb L\" [1 1 1] Shape \"plymesh\" \"string filename\" \"m.ply\" Translate 0 -1 0 Shape \"sphere\"";
            let mitsuba = "<shape type='ply'><string name='filename' value='m.ply'/><emitter type='area'/></shape><shape type='sphere'/>";
            [
                Case::pbrt(format!("pbrt light, {name}"), pbrt, Either).with("m.ply", bytes.clone()),
                Case::mitsuba(format!("Mitsuba light, {name}"), mitsuba, Either).with("m.ply", bytes),
            ]
        })
        .collect()
}
