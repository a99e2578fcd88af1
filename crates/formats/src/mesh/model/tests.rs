use super::*;
use crate::mesh::test_files::assets;
use steradian_math::DVec3;
use steradian_scene::{SceneDesc, SpectrumValue, Value};

/// A folder with these files, and the scene that the first of them opens as.
fn open(files: &[(&str, &[u8])]) -> Import {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in files {
        std::fs::write(folder.path().join(name), bytes).unwrap();
    }
    import(&folder.path().join(files[0].0), &Options::default())
}

const SQUARE: &str = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\n";

/// The material of a square whose library says this.
fn material(statements: &str) -> (Import, Node) {
    let obj = format!("{SQUARE}usemtl m\nf 1/1 2/1 3/1 4/1\n");
    let mtl = format!("newmtl m\n{statements}\n");
    let import = open(&[("a.obj", obj.as_bytes()), ("a.mtl", mtl.as_bytes()), ("t.png", b""), ("n o.png", b"")]);
    assert!(!import.diagnostics.has_errors());
    let node = import.desc.node(import.desc.shapes[0].material.unwrap()).clone();
    (import, node)
}

fn front(import: &Import, node: &Node) -> Node {
    assert_eq!(node.kind, "two_sided");
    import.desc.node(node.node("front").unwrap()).clone()
}

fn messages(import: &Import) -> String {
    import.diagnostics.iter().map(|d| format!("{d}\n")).collect()
}

#[test]
fn phong_materials_become_diffuse_and_plastic() {
    let (i, m) = material("Kd 0.5 0.25 2\nillum 1\nKs 1 1 1\nNs 10");
    let m = front(&i, &m);
    assert_eq!(m.kind, "diffuse");
    assert_eq!(m.get("reflectance"), Some(&Value::Spectrum(SpectrumValue::Rgb([0.5, 0.25, 1.0], Default::default()))));
    let (i, m) = material("Kd 0.5 0 0\nillum 2\nKs 1 1 1\nNs 198\nNi 1.4");
    let m = front(&i, &m);
    assert_eq!((m.kind.as_str(), m.float("alpha_u"), m.float("eta")), ("plastic", Some(0.1), Some(f64::from(1.4f32))));
    let (i, m) = material("Kd 0 0 0\nillum 3\nKs 0.9 0.9 0.9\nNs 1000");
    assert_eq!(front(&i, &m).kind, "conductor");
    assert!(i.diagnostics.is_empty());
}

#[test]
fn transparency_is_glass_or_absence() {
    let (_, m) = material("illum 7\nNi 1.33\nTf 0.5 1 1");
    assert_eq!((m.kind.as_str(), m.float("eta")), ("dielectric", Some(f64::from(1.33f32))));
    assert!(m.get("specular_transmittance").is_some());
    let (_, m) = material("d 0.2\nNi 1.5\nillum 2");
    assert_eq!(m.kind, "dielectric");
    let (i, m) = material("d 0.25\nNi 1.0\nillum 2");
    assert_eq!((m.kind.as_str(), m.float("opacity")), ("mask", Some(0.25)));
    front(&i, i.desc.node(m.node("material").unwrap()));
    let (i, m) = material("map_d -clamp on t.png");
    let map = i.desc.node(m.node("opacity").unwrap());
    assert_eq!((map.kind.as_str(), map.bool("raw"), map.string("wrap_u")), ("image", Some(true), Some("clamp")));
}

#[test]
fn physical_parameters_become_metal_and_plastic() {
    let (i, m) = material("Kd 1 0.8 0.2\nPr 0.5\nPm 1");
    let m = front(&i, &m);
    assert_eq!((m.kind.as_str(), m.float("alpha_v")), ("conductor", Some(0.25)));
    let (i, m) = material("Kd 1 0.8 0.2\nPr 0.5");
    assert_eq!(front(&i, &m).kind, "plastic");
    let (i, m) = material("Pr 0.5\nPm 0.25");
    let m = front(&i, &m);
    assert_eq!((m.kind.as_str(), m.float("amount")), ("mix", Some(0.25)));
}

#[test]
fn images_are_found_and_scaled() {
    let (i, m) = material("Kd 0.5 0.5 0.5\nmap_Kd -s 2 3 C:\\work\\n o.png\nmap_bump -bm 2 t.png");
    let bump = i.desc.node(m.node("bump").unwrap());
    assert!((bump.float("scale").unwrap() - 2.0 * 0.01 * 2f64.sqrt()).abs() < 1e-9, "{bump:?}");
    let m = front(&i, &m);
    let scale = i.desc.node(m.node("reflectance").unwrap());
    assert_eq!(scale.kind, "scale");
    let image = i.desc.node(scale.node("texture").unwrap());
    assert!(image.path("file").unwrap().ends_with("n o.png"));
    assert_eq!(
        (image.float("scale_u"), image.float("scale_v"), image.string("origin")),
        (Some(2.0), Some(3.0), Some("bottom"))
    );
}

#[test]
fn emission_becomes_light() {
    let (i, _) = material("Ke 5 5 4\nKd 0 0 0");
    let light = i.desc.node(i.desc.shapes[0].emission.unwrap());
    assert_eq!((light.family, light.kind.as_str()), (Family::Light, "area"));
    let (i, _) = material("Ke 0 0 0");
    assert!(i.desc.shapes[0].emission.is_none());
}

#[test]
fn what_is_missing_is_reported_and_stood_in_for() {
    let (i, m) = material("map_Kd gone.png\nbogus 1\nKd 0.1 0.2 0.3");
    assert_eq!(front(&i, &m).kind, "diffuse");
    let text = messages(&i);
    assert!(text.contains("cannot find 'gone.png'") && text.contains("a.mtl:2:1"), "{text}");
    assert!(text.contains("unknown statement 'bogus'") && text.contains("a.mtl:3:1"), "{text}");

    let i = open(&[("a.obj", format!("{SQUARE}usemtl nowhere\nf 1 2 3\n").as_bytes())]);
    let text = messages(&i);
    assert!(!i.diagnostics.has_errors() && i.diagnostics.is_lossy());
    assert!(text.contains("approximated: cannot find 'a.mtl'") && text.contains("a.obj:1:1"), "{text}");
    assert!(text.contains("'nowhere'") && text.contains("7 | usemtl nowhere\n  | ^^^^^^^^^^^^^^"), "{text}");
    assert!(i.desc.shapes[0].material.is_none());
}

#[test]
fn malformed_models_are_errors_with_a_place() {
    for (name, bytes, expected) in [
        ("a.obj", &b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n"[..], "a.obj:4:1\n  |\n4 | f 1 2 9\n  | ^^^^^^^"),
        ("a.ply", b"ply\nformat ascii 1.0\nelement vertex 1\nproperty flat x\nend_header\n", "a.ply:4:1"),
        (
            "a.ply",
            b"ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty float x\nproperty float \
          y\nproperty float z\nend_header\n\0\0\x80\x7f\0\0\0\0\0\0\0\0",
            "1 vertices are not finite",
        ),
        ("a.obj", b"", "has no faces"),
        ("a.obj", b"v 1 2 3\np 1\n", "has no faces"),
        ("a.ply", b"ply", "this is not a PLY file"),
        ("a.ply", b"plx\nformat ascii 1.0\n", "this is not a PLY file"),
        ("a.PLY", b"v 0 0 0\n", "this is not a PLY file"),
    ] {
        let import = open(&[(name, bytes)]);
        let text = messages(&import);
        assert!(import.diagnostics.has_errors() && text.contains(expected), "{expected:?} is not in {text}");
    }
    let gone = import(Path::new("/nowhere/at all.obj"), &Options::default());
    assert!(gone.diagnostics.has_errors());
}

/// UTF-16 with a byte order mark, as exporters on Windows write it, in model and library. Positions are those of the
/// text.
#[test]
fn utf_16_models_open() {
    let wide = |text: &str| {
        [0xff, 0xfe].into_iter().chain(text.encode_utf16().flat_map(u16::to_le_bytes)).collect::<Vec<u8>>()
    };
    let obj = wide("mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl rötlich\nf 1 2 3\nbogus\n");
    let i = open(&[("a.obj", &obj), ("a.mtl", &wide("newmtl rötlich\nillum 7\n"))]);
    assert!(!i.diagnostics.has_errors(), "{}", messages(&i));
    assert_eq!(i.desc.node(i.desc.shapes[0].material.unwrap()).kind, "dielectric");
    assert!(messages(&i).contains("a.obj:7:1"), "{}", messages(&i));
}

/// Faults beside the shape are mended, and said.
#[test]
fn faults_of_colours_and_references_leave_the_model() {
    let i = open(&[("a.obj", b"v 0 0 0 1 nan 1\nv 1 0 0 1 1 1\nv 0 1 0 1 1 1\nf 1/3/2 2 3\n")]);
    let text = messages(&i);
    assert!(!i.diagnostics.has_errors() && i.desc.shapes.len() == 2, "{text}");
    assert!(text.contains("2 texture coordinates and normals") && text.contains("1 colours of vertices"), "{text}");
    let header = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float r\nproperty float g\nproperty float b\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
    let ply = format!("{header}0 0 0 inf 0.5 nan\n1 0 0 1 1 1\n0 1 0 1 1 1\n3 0 1 2\n");
    let i = open(&[("a.ply", ply.as_bytes())]);
    assert!(!i.diagnostics.has_errors() && i.desc.shapes.len() == 2, "{}", messages(&i));
    let texture = i.desc.nodes.iter().find(|n| n.kind == "mesh_attribute").unwrap();
    assert_eq!(texture.get("scale"), None, "an infinite colour is not the brightest");
}

#[test]
fn the_camera_frames_real_models() {
    let Some(root) = assets() else { return };
    for name in [
        "obj/spot/spot_triangulated.obj",
        "obj/bathroom/Mesh238.obj",
        "ply/large/Mesh005.ply",
        "ply/trimesh/plane.ply",
        "obj/assimp/cube_usemtl.obj",
    ] {
        let import = import(&root.join(name), &Options::default());
        assert!(!import.diagnostics.has_errors(), "{}", messages(&import));
        let desc = &import.desc;
        let to_world = desc.node(desc.cameras[0]).transform("to_world").unwrap();
        let to_camera = to_world.inverse().unwrap();
        let (mut reach, mut nearest) = (0.0f64, f64::INFINITY);
        for p in desc.meshes.iter().flat_map(|m| &m.positions) {
            let q = to_camera.point(DVec3::from(p.map(f64::from)));
            let tan = 20f64.to_radians().tan();
            reach = reach.max((q.x / q.z / tan).abs()).max((q.y / q.z / (tan * 0.75)).abs());
            nearest = nearest.min(q.z);
        }
        assert!(nearest > 0.0 && reach <= 1.0 && reach > 0.6, "{name}: {nearest} {reach}");
        // Up in the world is up in the picture, and +x is to the right.
        assert!(to_camera.vector(DVec3::Y).y > 0.5 && to_camera.vector(DVec3::X).x > 0.5);
        assert_eq!((desc.lights.len(), desc.shapes.last().unwrap().mesh), (1, None), "a sky, and a ground");
    }
}

#[test]
fn vertex_and_face_colors_are_shown() {
    let Some(root) = assets() else { return };
    for (name, domain) in [
        ("ply/trimesh/cycloidal.ply", "vertex"),
        ("ply/magnum/per-face-colors-be.ply", "face"),
        ("obj/assimp/cube_with_vertexcolors.obj", "vertex"),
    ] {
        let i = import(&root.join(name), &Options::default());
        let m = front(&i, i.desc.node(i.desc.shapes[0].material.unwrap()));
        let texture = i.desc.node(m.node("reflectance").unwrap());
        assert_eq!((texture.kind.as_str(), texture.string("domain")), ("mesh_attribute", Some(domain)), "{name}");
        let mesh = &i.desc.meshes[0];
        mesh.validate().unwrap();
        assert!(mesh.attributes.iter().any(|a| a.name == "color" && a.channels == 3));
    }
}

/// A picture named by `comment TextureFile` is on the faces, by texture coordinates of vertices or of corners; what is
/// missing for it is told, and colours stand in.
#[test]
fn pictures_of_ply_files_are_shown() {
    let ply = |vertex: &str, uvs: &str, face: &str, wedge: &str| {
        format!(
            "ply\nformat ascii 1.0\ncomment TextureFile n o.png\nelement vertex 3\nproperty float x\nproperty float \
              y\nproperty float z\n\
             property uchar diffuse_red\nproperty uchar diffuse_green\nproperty uchar diffuse_blue\n{vertex}element \
               face 1\n\
             property list uchar int vertex_indices\n{face}end_header\n0 0 0 9 9 9 {uvs}\n1 0 0 9 9 9 {uvs}\n0 1 0 \
               9 9 9 {uvs}\n3 0 1 2 {wedge}\n"
        )
    };
    let by_vertex = ply("property float texture_u\nproperty float texture_v\n", "0.5 0.5", "", "");
    let by_corner = ply("", "", "property list uchar float texcoord\n", "6 0 0 1 0 1 1");
    let reflectance = |text: &str, picture: &str| {
        let import = open(&[("a.ply", text.as_bytes()), (picture, b"")]);
        let material = front(&import, import.desc.node(import.desc.shapes[0].material.unwrap()));
        let texture = import.desc.node(material.node("reflectance").unwrap()).kind.clone();
        (texture, messages(&import))
    };
    for text in [&by_vertex, &by_corner] {
        assert_eq!(reflectance(text, "n o.png"), ("image".into(), String::new()));
        let (texture, said) = reflectance(text, "other.png");
        assert!(texture == "mesh_attribute" && said.contains("n o.png"), "{texture} {said}");
    }
    let (texture, said) = reflectance(&ply("", "", "", ""), "n o.png");
    assert!(texture == "mesh_attribute" && said.contains("has no texture coordinates"), "{texture} {said}");
}

/// Warnings for materials that are invisible or grey in a way that their author hardly meant.
#[test]
fn doubtful_materials_are_told() {
    for line in ["Tr 1", "d 0"] {
        let said = messages(&material(line).0);
        assert!(said.contains("'m' is invisible by its 'd 0' or 'Tr 1'"), "{said}");
    }
    assert_eq!(messages(&material("d 1\nTr 1").0), "");
    assert!(messages(&material("Ka 1 1 1").0).contains("'Ka' counts under a light 'ambient' alone"));
    assert_eq!(messages(&material("Ka 0 0 0").0), "");
    let obj = format!("{SQUARE}f 1/1 2/1 3/1 4/1\n");
    let said = messages(&open(&[("a.obj", obj.as_bytes()), ("a.mtl", b"newmtl sheet\nKd 1 0 0\n")]));
    assert!(said.contains("a.obj:1:1") && said.contains("'usemtl NAME'") && said.contains("one of 'sheet'"), "{said}");
}

#[test]
fn a_library_shared_by_groups_makes_one_material_each() {
    let Some(root) = assets() else { return };
    let i = import(&root.join("obj/assimp/cube_usemtl.obj"), &Options::default());
    assert_eq!(i.desc.shapes.len(), 4, "with the ground");
    let text = messages(&i);
    assert!(text.contains("no library defines the material 'mtl3'"), "{text}");
    assert_eq!(i.desc.nodes.iter().filter(|n| n.kind == "plastic").count(), 2);
}

/// A lamp of its own or the user's wish leaves the ground out; a wish that is none is refused.
#[test]
fn the_ground_can_be_left_out() {
    let triangle = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let with = |ground: &str| {
        let options = Options { defines: [("ground".into(), ground.into())].into(), ..Options::default() };
        import_bytes(Path::new("a.obj"), triangle.to_vec(), &options)
    };
    assert_eq!((with("true").desc.shapes.len(), with("false").desc.shapes.len()), (2, 1));
    for (ground, shapes) in [("true", 1), ("false", 1)] {
        let mut desc = with(ground).desc;
        leave_out_ground(&mut desc);
        assert_eq!((desc.shapes.len(), desc.shapes[0].mesh.is_some()), (shapes, true), "the ground alone goes");
    }
    assert!(messages(&with("maybe")).contains("'ground' is 'true', 'false' or 'shadow', not 'maybe'"));
    let catcher = with("shadow").desc;
    let ground = catcher.node(catcher.shapes[1].node);
    assert_eq!(ground.get("shadow_catcher"), Some(&Value::Bool(true)));
}

/// View direction and up axis follow the user's options; malformed options are refused.
#[test]
fn models_are_seen_as_the_user_says() {
    let needle = b"v -1 0 0\nv 1 0 0\nv 0 0 8\nf 1 2 3\n";
    let with = |defines: &[(&str, &str)]| {
        let defines = defines.iter().map(|(a, b)| ((*a).to_owned(), (*b).to_owned())).collect();
        import_bytes(Path::new("a.obj"), needle.to_vec(), &Options { defines, ..Options::default() })
    };
    let eye = |defines: &[(&str, &str)]| {
        let desc = with(defines).desc;
        let camera = desc.node(desc.cameras[0]).transform("to_world").expect("it is placed");
        (camera.point(DVec3::ZERO), camera.vector(DVec3::Z))
    };
    // From the right, level: along -x; from behind and above: forward and down.
    let (origin, forward) = eye(&[("azimuth", "90"), ("elevation", "0")]);
    assert!(origin.x > 1.0 && (forward - DVec3::NEG_X).length() < 1e-9, "{origin} {forward}");
    let (_, forward) = eye(&[("azimuth", "180"), ("elevation", "30")]);
    assert!((forward - DVec3::new(0.0, -0.5, 0.75_f64.sqrt())).length() < 1e-9, "{forward}");
    // Named sides have one distance from the middle, that of all of them.
    let distance = |azimuth: &str| (eye(&[("azimuth", azimuth)]).0 - DVec3::new(0.0, 0.0, 4.0)).length();
    assert!((distance("90") - distance("180")).abs() < 1e-9 * distance("90"));
    // The sky that is added turns with the viewer.
    let turn = |azimuth: &str| {
        let desc = with(&[("azimuth", azimuth)]).desc;
        desc.node(desc.lights[0]).transform("to_world").expect("it is turned").vector(DVec3::Z)
    };
    assert!((turn("100").cross(turn("190")).y - 1.0).abs() < 1e-9, "a quarter turn from +z towards +x");
    // The needle's tip, which is where z is up.
    for (defines, tip) in [
        (&[("up", "y")][..], DVec3::new(0.0, 0.0, 8.0)),
        (&[("up", "z")], DVec3::new(0.0, 8.0, 0.0)),
        (&[("up", "x")], DVec3::new(0.0, 0.0, 8.0)),
        (&[("up", "-z")], DVec3::new(0.0, -8.0, 0.0)),
        (&[("front", "-z")], DVec3::new(0.0, 0.0, -8.0)),
        (&[("front", "x")], DVec3::new(-8.0, 0.0, 0.0)),
        (&[("handedness", "left")], DVec3::new(0.0, 0.0, -8.0)),
        (&[("up", "z"), ("handedness", "left")], DVec3::new(0.0, 8.0, 0.0)),
    ] {
        let desc = with(defines).desc;
        let found = desc.shapes[0].world_from_object.point(DVec3::new(0.0, 0.0, 8.0));
        assert!((found - tip).length() < 1e-12, "{defines:?}: {found}");
        let ground = &desc.shapes[1].world_from_object;
        assert!(ground.point(DVec3::ZERO).y <= tip.y.min(0.0), "{defines:?}: the ground is above");
    }
    // Skies that need no file, their turn and the factor on their light.
    for (name, file) in [
        ("studio", Some("studio of the viewer")),
        ("overcast", Some("overcast of the viewer")),
        ("dim", Some("dim of the viewer")),
        ("outdoor", Some("sky of the viewer")),
        ("none", None),
    ] {
        let desc = with(&[("sky", name), ("turn", "90"), ("strength", "2")]).desc;
        let light = desc.lights.first().map(|&light| desc.node(light));
        assert_eq!(light.and_then(|l| l.get("file")), file.map(|f| Value::Path(f.into())).as_ref(), "{name}");
        assert!(light.is_none_or(|l| l.float("scale") == Some(2.0)) && desc.embedded.len() == desc.lights.len());
        let x = |desc: &SceneDesc| desc.node(desc.lights[0]).transform("to_world").map(|t| t.vector(DVec3::X));
        let turned = [desc, with(&[("sky", name), ("turn", "0.25")]).desc];
        if file.is_some() {
            let [a, b] = turned.map(|desc| x(&desc).expect("it is turned"));
            assert!((b.cross(a).y - 89.75f64.to_radians().sin()).abs() < 1e-9, "{name}: {a} {b}");
        }
    }
    // A sky with a sun: its height, and where it stands for the viewer.
    for (height, azimuth) in [("47.0746658610554", "28.810793742973065"), ("5", "118.810793742973065")] {
        let desc = with(&[("sky", "clear"), ("sun", height), ("azimuth", azimuth)]).desc;
        let sky = desc.node(desc.lights[0]);
        let Some(Value::Vec3(sun)) = sky.get("sun_direction") else { panic!("{sky:?}") };
        let sun = DVec3::from_array(*sun);
        assert_eq!(sky.transform("to_world").expect("it is placed").vector(DVec3::Z), DVec3::Y, "up");
        let is_high = height != "5";
        let expected = if is_high { DVec3::new(-0.45, 0.85, 0.65).normalize() } else { sun };
        assert!((sun - expected).length() < 1e-9 && (sun.length() - 1.0).abs() < 1e-9, "{sun}");
        assert!((sun.y - height.parse::<f64>().unwrap().to_radians().sin()).abs() < 1e-9);
        // A quarter turn further to the right the sun of the other is.
        assert!(is_high || (sun.x - 0.65 / 0.45f64.hypot(0.65) * sun.y.acos().sin()).abs() < 1e-9, "{sun}");
        assert_eq!((sky.kind.as_str(), desc.lights.len()), ("sky", 1));
    }
    for (name, value, message) in [
        ("up", "w", "'up' is the axis 'x', 'y' or 'z', or one of them with a minus, not 'w'"),
        ("front", "north", "'front' is the axis 'x', 'y' or 'z', or one of them with a minus, not 'north'"),
        ("front", "-y", "'front' is along the axis that is up"),
        ("handedness", "both", "'handedness' is 'right' or 'left', not 'both'"),
        ("azimuth", "north", "'azimuth' is an angle in degrees from -360 to 360, not 'north'"),
        ("azimuth", "NaN", "not 'NaN'"),
        ("elevation", "90", "'elevation' is an angle in degrees from -89 to 89, not '90'"),
        ("crease", "181", "'crease' is an angle in degrees from 0 to 180, not '181'"),
        ("sky", "nothing.hdr", "'sky': cannot find 'nothing.hdr'"),
        ("sky", "studoi", "the skies that need no file are studio, overcast, dim, clear, atmosphere, outdoor and none"),
        ("strength", "-1", "'strength' is a factor on the light of the sky from 0 to 1000000, not '-1'"),
        ("turn", "round", "'turn' is an angle in degrees from -360 to 360, not 'round'"),
        ("sun", "10", "'sun' is the height of the sun of sky=clear or sky=atmosphere"),
    ] {
        let import = with(&[(name, value)]);
        assert!(import.diagnostics.has_errors() && messages(&import).contains(message), "{}", messages(&import));
    }
}

/// Models that clearly lie on their sides are turned, and a note says so; all others keep the axes of their files.
#[test]
fn models_stand_on_their_bases() {
    let Some(root) = assets() else { return };
    for (name, lies) in [
        ("mitsuba/common/meshes/teapot.ply", true),
        ("obj/spot/spot_triangulated.obj", false),
        ("obj/bathroom/Mesh238.obj", false),
        ("pbrt/coffee/models/Mesh000.ply", false),
        ("pbrt/staircase2/models/Mesh000.ply", false),
        ("pbrt/staircase2/models/Mesh002.ply", false),
        ("ply/trimesh/plane.ply", false),
        ("ply/large/lamp-Mesh042.ascii.ply", false),
    ] {
        for up in [None, Some("y")] {
            let defines = up.map(|axis| ("up".to_owned(), axis.to_owned())).into_iter().collect();
            let import = import(&root.join(name), &Options { defines, ..Options::default() });
            let turned = import.desc.shapes[0].world_from_object.vector(DVec3::Z);
            let is_turned = lies && up.is_none();
            assert_eq!(turned, if is_turned { DVec3::Y } else { DVec3::Z }, "{name}");
            assert_eq!(messages(&import).contains("(-D up=y keeps the file's axes)"), is_turned, "{name}");
        }
    }
}

/// A background is seen in place of the sky that lights the model; the ground is as bright as it, or left out.
#[test]
fn backgrounds_stand_behind_the_sky() {
    let of = |defines: &[(&str, &str)]| {
        let defines = defines.iter().map(|(a, b)| ((*a).to_owned(), (*b).to_owned())).collect();
        let triangle = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n".to_vec();
        import_bytes(Path::new("a.obj"), triangle, &Options { defines, ..Options::default() })
    };
    let kinds = |import: &Import| {
        let desc = &import.desc;
        (desc.lights.iter().map(|&l| desc.node(l).kind.clone()).collect::<Vec<_>>().join(" "), desc.shapes.len())
    };
    for (background, lights, shapes) in [
        ("sky", "environment", 2),
        ("none", "environment backdrop", 1),
        ("gradient", "environment backdrop", 2),
        ("#ffffff", "environment backdrop", 2),
        ("0.2,0.3,1", "environment backdrop", 2),
    ] {
        let import = of(&[("background", background)]);
        assert_eq!(kinds(&import), (lights.to_owned(), shapes), "{background}: {}", messages(&import));
    }
    assert_eq!(kinds(&of(&[("background", "none"), ("ground", "true")])).1, 2);
    let said = messages(&of(&[("background", "white")]));
    assert!(said.contains("'background' is sky, none, gradient, #rrggbb"), "{said}");
    let reflectance = |strength: &str| {
        let desc = of(&[("background", "0.2,0.2,0.2"), ("sky", "dim"), ("strength", strength)]).desc;
        let ground = desc.nodes.iter().find(|n| n.kind == "diffuse").and_then(|n| n.get("reflectance")).cloned();
        let Some(Value::Spectrum(SpectrumValue::Rgb([red, ..], _))) = ground else { panic!("{ground:?}") };
        red
    };
    assert!((reflectance("1") / reflectance("2") - 2.0).abs() < 1e-9, "less is needed under more light");
}

#[test]
fn bezier_patches_are_models() {
    let points: String = (0..16).map(|k| format!("{} {} {}\n", k % 4, k / 4, k % 3)).collect();
    let import = open(&[("a.bpt", format!("1\n3 3\n{points}").as_bytes())]);
    assert!(!import.diagnostics.has_errors(), "{}", messages(&import));
    let mesh = &import.desc.meshes[import.desc.shapes[0].mesh.unwrap()];
    assert!(mesh.triangles.len() > 100 && mesh.normals.len() == mesh.positions.len());
    let import = open(&[("a.bpt", b"1\n3 3\n0 0 zero\n")]);
    assert!(messages(&import).contains("a.bpt:3"), "{}", messages(&import));
}
