//! Shapes, groups, instances and mesh files.

use super::*;
use steradian_math::DVec3;

#[test]
fn spheres_keep_mitsubas_texture_coordinates() {
    let desc = good(
        "<shape type=\"sphere\"><point name=\"center\" value=\"1, 2, 3\"/><float name=\"radius\" value=\"2\"/></shape>",
    );
    let shape = &desc.shapes[0];
    assert_eq!((desc.node(shape.node).float("radius"), shape.reverse_orientation), (Some(2.0), false));
    // Mitsuba's pole v = 0 is at +z, Steradian's at -z.
    let pole = shape.world_from_object.point(DVec3::new(0.0, 0.0, -2.0));
    assert_eq!(pole, DVec3::new(1.0, 2.0, 5.0));
    assert!(
        good("<shape type=\"sphere\"><boolean name=\"flip_normals\" value=\"true\"/></shape>").shapes[0]
            .reverse_orientation
    );
}

#[test]
fn cylinders_run_from_p0_to_p1() {
    let desc = good(
        "<shape type=\"cylinder\"><point name=\"p0\" value=\"1, 0, 0\"/><point name=\"p1\" value=\"1, 4, 0\"/><float name=\"radius\" value=\"0.5\"/></shape>",
    );
    let shape = &desc.shapes[0];
    let node = desc.node(shape.node);
    assert_eq!((node.float("radius"), node.float("z_max")), (Some(0.5), Some(4.0)));
    assert!((shape.world_from_object.point(DVec3::new(0.0, 0.0, 4.0)) - DVec3::new(1.0, 4.0, 0.0)).length() < 1e-12);
    assert!(!shape.world_from_object.swaps_handedness());
}

/// Which side of a mirrored shape is its front: inside for spheres, outside for cylinders, and for flat shapes that to
/// which the mirrored normal points.
#[test]
fn mirrored_shapes_face_as_in_mitsuba() {
    for (plugin, mirrored) in
        [("sphere", true), ("cylinder", false), ("disk", false), ("rectangle", false), ("cube", false)]
    {
        let is_mesh = matches!(plugin, "rectangle" | "cube");
        for flip in [false, true] {
            for (scale, expected) in [("1", flip && !is_mesh), ("1, 1, -1", (mirrored != flip) && !is_mesh)] {
                let desc = good(&format!(
                    "<shape type=\"{plugin}\"><transform name=\"to_world\"><scale value=\"{scale}\"/></transform>
                     <boolean name=\"flip_normals\" value=\"{flip}\"/><emitter type=\"area\"/></shape>"
                ));
                assert_eq!(desc.shapes[0].reverse_orientation, expected, "{plugin} {scale} {flip}");
                // Meshes are turned over themselves.
                if let Some(mesh) = desc.shapes[0].mesh {
                    let z = if plugin == "cube" {
                        desc.meshes[mesh].normals[12][2]
                    } else {
                        desc.meshes[mesh].normals[0][2]
                    };
                    assert_eq!(z, if flip { -1.0 } else { 1.0 }, "{plugin} {scale} {flip}");
                }
            }
        }
    }
}

#[test]
fn height_fields_reach_from_minus_one_to_one() {
    let desc = good(
        "<shape type=\"heightfield\"><texture type=\"checkerboard\"/><integer name=\"width\" value=\"5\"/>
         <float name=\"scale\" value=\"0.2\"/></shape>",
    );
    let shape = &desc.shapes[0];
    let node = desc.node(shape.node);
    assert_eq!(node.kind, "height_field");
    assert_eq!((node.int("nu"), node.int("nv"), node.float("scale")), (Some(5), None, Some(0.2)));
    assert_eq!((node.bool("smooth"), child(&desc, node, "heights").kind.as_str()), (Some(true), "checkerboard"));
    let corner = |x: f64, y: f64| shape.world_from_object.point(DVec3::new(x, y, 0.5));
    assert_eq!((corner(0.0, 0.0), corner(1.0, 1.0)), (DVec3::new(-1.0, -1.0, 0.5), DVec3::new(1.0, 1.0, 0.5)));
    assert!(errors(&read("<shape type=\"heightfield\"/>"))[0].contains("needs 'filename'"));
}

#[test]
fn textures_on_disks_are_turned() {
    let desc = good(
        "<bsdf id=\"b\" type=\"diffuse\"><texture name=\"reflectance\" type=\"checkerboard\"/></bsdf>
         <shape type=\"disk\"><ref id=\"b\"/></shape><shape type=\"cube\"><ref id=\"b\"/></shape>",
    );
    let to_uv =
        |i: usize| child(&desc, desc.node(desc.shapes[i].material.unwrap()), "reflectance").transform("to_uv").unwrap();
    // On the rim (v = 0) a quarter round: Mitsuba's u = 1, v = 0.25, doubled for the cells.
    assert!((to_uv(0).point(DVec3::new(0.25, 0.0, 0.0)) - DVec3::new(2.0, 0.5, 0.0)).length() < 1e-12);
    assert_eq!(to_uv(1).point(DVec3::new(0.25, 0.0, 0.0)), DVec3::new(0.5, 0.0, 0.0));
}

#[test]
fn groups_and_instances() {
    let desc = good(
        "<shape type=\"shapegroup\" id=\"g\"><shape type=\"cube\"/><shape type=\"sphere\"/></shape>
         <shape type=\"instance\"><ref id=\"g\"/><transform name=\"to_world\"><translate x=\"3\"/></transform></shape>
         <shape type=\"instance\"><ref id=\"g\"/></shape>
         <shape type=\"merge\"><shape type=\"rectangle\"/><shape type=\"rectangle\"/></shape>",
    );
    assert_eq!((desc.groups.len(), desc.instances.len(), desc.shapes.len()), (1, 2, 2));
    assert_eq!((desc.groups[0].name.as_str(), desc.groups[0].shapes.len()), ("g", 2));
    assert_eq!(desc.instances[0].world_from_group.point(DVec3::ZERO), DVec3::new(3.0, 0.0, 0.0));
    assert_eq!(desc.face_count(), 2 * 12 + 2 * 2);
}

/// Reads a scene with an OBJ file beside it: one triangle with texture coordinates, then one more that shares an edge.
fn with_obj(obj: &str, properties: &str) -> Import {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("m.obj"), obj).unwrap();
    let shape = |extra: &str| {
        format!("<shape type=\"obj\"><string name=\"filename\" value=\"m.obj\"/>{properties}{extra}</shape>")
    };
    let moved = shape("<transform name=\"to_world\"><translate x=\"1\"/></transform>");
    let text = format!("<scene version=\"3.0.0\">{}{moved}</scene>", shape(""));
    import_text(&text, &folder.path().join("s.xml"), &Options::default())
}

#[test]
fn meshes_get_normals_and_upright_textures() {
    let roof = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 0 0.25\nf 1/1 2/2 3/3\nf 2/2 4/1 3/3\n";
    let import = with_obj(roof, "");
    assert_eq!(errors(&import), Vec::<String>::new());
    // Both shapes share one mesh.
    assert_eq!((import.desc.meshes.len(), import.desc.shapes.len()), (1, 2));
    let mesh = &import.desc.meshes[0];
    assert_eq!(mesh.normals, vec![[0.0, 0.0, 1.0]; mesh.positions.len()]);
    assert!(mesh.uvs.contains(&[0.0, 0.75]), "{:?}", mesh.uvs);
    let import = with_obj(
        roof,
        "<boolean name=\"face_normals\" value=\"true\"/><boolean name=\"flip_tex_coords\" value=\"false\"/>",
    );
    assert!(import.desc.meshes[0].normals.is_empty() && import.desc.meshes[0].uvs.contains(&[0.0, 0.25]));
    let import = with_obj(roof, "<boolean name=\"flip_normals\" value=\"true\"/>");
    assert_eq!(import.desc.meshes[0].normals[0], [0.0, 0.0, -1.0]);
}

#[test]
fn mesh_files_of_every_format() {
    let folder = shared("assets/mitsuba/tests");
    if !folder.exists() {
        println!("skipped: {} is absent", folder.display());
        return;
    }
    let mesh = |kind: &str, name: &str, properties: &str| {
        let text = format!(
            "<scene version=\"3.0.0\"><shape type=\"{kind}\"><string name=\"filename\" value=\"{name}\"/>{properties}</shape></scene>"
        );
        let import = import_text(&text, &folder.join("scene.xml"), &Options::default());
        assert_eq!(errors(&import), Vec::<String>::new());
        import.desc.meshes[0].as_ref().clone()
    };
    let [obj, ply] = [mesh("obj", "obj/rectangle_normals_uv.obj", ""), mesh("ply", "ply/rectangle_normals_uv.ply", "")];
    assert_eq!((obj.triangles.len(), ply.triangles.len()), (2, 2));
    assert!(obj.normals.len() == obj.positions.len() && ply.uvs.len() == ply.positions.len());
    // Mitsuba turns the coordinates of OBJ files over, those of PLY files only when asked.
    let flipped = mesh("ply", "ply/rectangle_normals_uv.ply", "<boolean name=\"flip_tex_coords\" value=\"true\"/>");
    assert_eq!(flipped.uvs[1][1], 1.0 - ply.uvs[1][1]);
    let first = mesh("serialized", "serialized/rectangle_normals_uv.serialized", "");
    assert!(!first.triangles.is_empty() && first.normals.len() == first.positions.len());
    let flat = mesh(
        "serialized",
        "serialized/rectangle_normals_uv.serialized",
        "<boolean name=\"face_normals\" value=\"true\"/>",
    );
    assert!(flat.normals.is_empty());
}

#[test]
fn faults_of_mesh_files_name_the_file_and_the_line() {
    let import = with_obj("v 0 0 0\nv 1 0 zero\n", "");
    let error = &errors(&import)[0];
    assert!(error.contains("m.obj") && error.contains("line 2") && error.contains("s.xml:1:"), "{error}");
    assert_eq!(import.diagnostics.error_count(), 1);
}

#[test]
fn grids_of_distances() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.vol"), b"").unwrap();
    let open = |inside: &str| {
        let text = format!("<scene version=\"3.0.0\"><shape type=\"sdfgrid\">{inside}</shape></scene>");
        import_text(&text, &folder.path().join("a.xml"), &Options::default())
    };
    for (normals, expected) in [("", "smooth"), ("<string name=\"normals\" value=\"analytic\"/>", "analytic")] {
        let import = open(&format!("<string name=\"filename\" value=\"a.vol\"/>{normals}"));
        assert_eq!(errors(&import), Vec::<String>::new());
        let node = import.desc.node(import.desc.shapes[0].node);
        assert_eq!((node.kind.as_str(), node.string("normals")), ("sdf_grid", Some(expected)));
        assert!(node.path("file").unwrap().ends_with("a.vol") && !import.diagnostics.is_lossy());
    }
    assert!(errors(&open(""))[0].contains("needs 'filename'"));
}

/// Shapes in a group may emit, which Mitsuba itself refuses.
#[test]
fn groups_emit() {
    let d = good(
        "<shape type=\"shapegroup\" id=\"g\"><shape type=\"sphere\"><emitter type=\"area\"/></shape></shape>
        <shape type=\"instance\"><ref id=\"g\"/></shape>",
    );
    assert!(d.groups[0].shapes[0].emission.is_some());
}
