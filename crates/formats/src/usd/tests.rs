//! Stages in text, held against what the specification makes of them; where it can be read off, against OpenUSD's own
//! library, which made the binary files.

use super::*;
use steradian_scene::{Node, SceneDesc, Shape, SpectrumValue, Value as Param};

const SCENE: &[u8] = include_bytes!("test_files/scene.usda");
const BINARY: &[u8] = include_bytes!("test_files/scene.usdc");
const ARCHIVE: &[u8] = include_bytes!("test_files/scene.usdz");

fn import(text: impl AsRef<[u8]>) -> Import {
    import_bytes(Path::new("s.usda"), text.as_ref().to_vec(), &Options::default())
}

/// A stage of some prims, which is read without an error.
fn read(prims: &str) -> Import {
    let import = import(format!("#usda 1.0\n{prims}"));
    assert!(!import.diagnostics.has_errors(), "{prims}\n{}", said(&import));
    import
}

fn said(import: &Import) -> String {
    import.diagnostics.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")
}

fn defined(text: &[u8], name: &str, value: &str) -> Import {
    let options = Options { defines: [(name.into(), value.into())].into(), ..Options::default() };
    import_bytes(Path::new("s.usda"), text.to_vec(), &options)
}

/// Shapes but the ground that is added.
fn shapes(desc: &SceneDesc) -> Vec<&Shape> {
    desc.shapes.iter().filter(|s| desc.node(s.node).name.as_deref() != Some("ground")).collect()
}

fn place(desc: &SceneDesc, name: &str) -> DMat4 {
    let found = desc.shapes.iter().find(|s| desc.node(s.node).name.as_deref() == Some(name));
    found.unwrap_or_else(|| panic!("{name}")).world_from_object.matrix
}

fn material<'d>(desc: &'d SceneDesc, name: &str) -> &'d Node {
    let found = desc.shapes.iter().find(|s| desc.node(s.node).name.as_deref() == Some(name));
    desc.node(found.and_then(|s| s.material).unwrap_or_else(|| panic!("{name}")))
}

fn color(node: &Node, name: &str) -> [f64; 3] {
    match node.get(name) {
        Some(Param::Spectrum(SpectrumValue::Rgb(rgb, _))) => *rgb,
        other => panic!("{name}: {other:?}"),
    }
}

fn is_near(a: DVec3, b: [f64; 3]) -> bool {
    (a - DVec3::from(b)).length() < 1e-6
}

const TRIANGLE: &str = "def Mesh \"T\" {\n int[] faceVertexCounts = [3]\n int[] faceVertexIndices = [0, 1, 2]\n \
                        point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]\n \
                        uniform token subdivisionScheme = \"none\"\n";

#[test]
fn all_encodings_of_a_stage_are_the_same_scene() {
    let text = import(SCENE);
    assert!(!text.diagnostics.has_errors(), "{}", said(&text));
    for (name, bytes) in [("s.usdc", BINARY), ("s.usdz", ARCHIVE)] {
        let other = import_bytes(Path::new(name), bytes.to_vec(), &Options::default());
        assert!(!other.diagnostics.has_errors(), "{name}: {}", said(&other));
        let (a, b) = (&text.desc, &other.desc);
        assert_eq!(a.meshes, b.meshes, "{name}");
        let places = |d: &SceneDesc| d.shapes.iter().map(|s| s.world_from_object).collect::<Vec<_>>();
        assert_eq!(places(a), places(b), "{name}");
        let bare = |d: &SceneDesc| -> Vec<Node> {
            let without = |mut node: Node| {
                node.span = None;
                node.params.retain(|p| !matches!(p.value, Param::Path(_)));
                node
            };
            d.nodes.iter().cloned().map(without).collect()
        };
        assert_eq!(bare(a), bare(b), "{name}");
    }
}

#[test]
fn the_stage_turns_its_axes_and_keeps_the_moment() {
    let import = import(SCENE);
    // z is up: what is at (-1.5, 0, 0.8) there is at (-1.5, 0.8, 0) here.
    assert!(is_near(place(&import.desc, "Ball").w_axis.truncate(), [-1.5, 0.8, 0.0]));
    assert_eq!(import.desc.animations[0].times, [0.0, 1.0]);
    assert!(said(&import).contains("-D at=SECONDS"));
    let later = defined(SCENE, "at", "0.5");
    assert!(is_near(place(&later.desc, "Ball").w_axis.truncate(), [0.0, 0.8, 0.0]));
    assert!(said(&defined(SCENE, "at", "soon")).contains("'at' is a time in seconds"));
    // The variant that is selected; the other one is blue.
    let [red, green, blue] = color(material(&import.desc, "Ball"), "base_color");
    assert!(red > 0.79 && green < 0.11 && blue < 0.11);
}

#[test]
fn operations_are_done_in_their_order() {
    let import = read(
        "def Xform \"P\" {\n double3 xformOp:translate = (1, 0, 0)\n\
        uniform token[] xformOpOrder = [\"xformOp:translate\"]\n \
         def Cube \"A\" {\n float3 xformOp:rotateXYZ = (90, 0, 90)\n double3 xformOp:translate:pivot = (0, 0, 2)\n \
         uniform token[] xformOpOrder = [\"xformOp:rotateXYZ\", \"xformOp:translate:pivot\"]\n }\n \
         def Cube \"B\" {\n matrix4d xformOp:transform = ((2, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (5, 6, 7, 1))\n \
         uniform token[] xformOpOrder = [\"!resetXformStack!\", \"xformOp:transform\"]\n }\n \
         def Cube \"C\" {\n double3 xformOp:translate:pivot = (3, 0, 0)\n\
         quatf xformOp:orient = (0.5, 0.5, 0.5, 0.5)\n \
         uniform token[] xformOpOrder = [\"xformOp:translate:pivot\", \"xformOp:orient\", \
        \"!invert!xformOp:translate:pivot\"]\n }\n}\n",
    );
    // (0, 0, 2), about x by 90°: (0, −2, 0); about z by 90°: (2, 0, 0).
    assert!(is_near(place(&import.desc, "A").w_axis.truncate(), [3.0, 0.0, 0.0]));
    assert!(is_near(place(&import.desc, "B").transform_point3(DVec3::X), [7.0, 6.0, 7.0]));
    // About (1, 1, 1) by 120°, x becomes y; the pivot stays.
    assert!(is_near(place(&import.desc, "C").transform_point3(DVec3::new(3.0, 0.0, 0.0)), [4.0, 0.0, 0.0]));
    assert!(is_near(place(&import.desc, "C").transform_vector3(DVec3::X), [0.0, 1.0, 0.0]));
}

#[test]
fn primvars_follow_their_interpolation() {
    let quads = |primvars: &str| {
        format!(
            "def Mesh \"M\" {{\n int[] faceVertexCounts = [4, 3]\n int[] faceVertexIndices = [0, 1, 2, 3, 1, 4, 2]\n \
             point3f[] points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (2, 0, 0)]\n \
             uniform token subdivisionScheme = \"none\"\n{primvars}\n}}\n"
        )
    };
    let mesh = |text: &str| read(text).desc.meshes[0].clone();
    let shared = mesh(&quads(
        "texCoord2f[] primvars:st = [(0, 0), (1, 0), (1, 1), (0, 1), (2, 0)] (interpolation = \"vertex\")",
    ));
    assert_eq!((shared.positions.len(), shared.triangles.len()), (5, 3));
    assert_eq!(shared.uvs[4], [2.0, 0.0]);
    let split = mesh(&quads(
        "texCoord2f[] primvars:st = [(0, 0), (1, 1)] (interpolation = \"faceVarying\")\n\
        int[] primvars:st:indices = [0, 0, 0, 0, 1, 1, 1]",
    ));
    assert_eq!(split.positions.len(), 7);
    assert_eq!((split.uvs[3], split.uvs[4]), ([0.0, 0.0], [1.0, 1.0]));
    let colored =
        mesh(&quads("color3f[] primvars:displayColor = [(1, 0, 0), (0, 1, 0)] (interpolation = \"uniform\")"));
    let attribute = &colored.attributes[0];
    assert_eq!(
        (attribute.name.as_str(), &attribute.data[9..15]),
        ("displayColor", &[1.0, 0.0, 0.0, 0.0, 1.0, 0.0][..])
    );
    let turned = mesh(&quads("uniform token orientation = \"leftHanded\""));
    assert_eq!(turned.triangles[0], [0, 2, 1]);
    let short =
        import(format!("#usda 1.0\n{}", quads("normal3f[] normals = [(0, 0, 1)] (interpolation = \"vertex\")")));
    assert!(said(&short).contains("/M.normals: 1 values"), "{}", said(&short));
}

#[test]
fn cages_of_subdivision_surfaces_are_told_and_smooth() {
    let import = read(&(TRIANGLE.replace("\"none\"", "\"catmullClark\"") + "}\n"));
    assert!(said(&import).contains("the cage of a 'catmullClark' subdivision surface"));
    assert_eq!(import.desc.meshes[0].normals[0], [0.0, 0.0, 1.0]);
}

#[test]
fn subsets_have_their_own_materials() {
    let import = read(
        "def Mesh \"M\" {\n int[] faceVertexCounts = [3, 3, 3]\n\
        int[] faceVertexIndices = [0, 1, 2, 0, 2, 3, 0, 3, 4]\n \
         point3f[] points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (-1, 1, 0)]\n\
         uniform token subdivisionScheme = \"none\"\n \
         rel material:binding = </L/A>\n int[] holeIndices = [2]\n \
         def GeomSubset \"S\" {\n uniform token elementType = \"face\"\n\
         uniform token familyName = \"materialBind\"\n int[] indices = [1]\n \
         rel material:binding = </L/B>\n }\n}\n\
         def Scope \"L\" {\n def Material \"A\" {\n token outputs:surface.connect = </L/A/S.outputs:surface>\n \
         def Shader \"S\" {\n uniform token info:id = \"UsdPreviewSurface\"\n\
         color3f inputs:diffuseColor = (1, 0, 0)\n }\n }\n \
         def Material \"B\" {\n token outputs:surface.connect = </L/B/S.outputs:surface>\n \
         def Shader \"S\" {\n uniform token info:id = \"UsdPreviewSurface\"\n\
         color3f inputs:diffuseColor = (0, 1, 0)\n float inputs:opacity = 0.5\n \
         token inputs:opacityMode = \"presence\"\n }\n }\n}\n",
    );
    let desc = &import.desc;
    let parts = shapes(desc);
    assert_eq!(parts.len(), 2);
    assert_eq!(parts.iter().map(|s| desc.meshes[s.mesh.unwrap()].triangles.len()).collect::<Vec<_>>(), [1, 1]);
    let node = |k: usize| desc.node(parts[k].material.unwrap());
    assert_eq!((node(0).kind.as_str(), node(1).kind.as_str()), ("mask", "metallic_roughness"));
    assert_eq!(color(node(1), "base_color"), [1.0, 0.0, 0.0]);
    assert_eq!(color(desc.node(node(0).node("material").unwrap()), "base_color"), [0.0, 1.0, 0.0]);
}

#[test]
fn what_is_not_seen_is_not_drawn() {
    let cubes =
        |extra: &str| shapes(&read(&format!("def Xform \"P\" {{\n{extra}\n def Cube \"C\" {{\n }}\n}}\n")).desc).len();
    assert_eq!(cubes(""), 1);
    assert_eq!(cubes("token visibility = \"invisible\""), 0);
    assert_eq!(cubes("uniform token purpose = \"proxy\""), 0);
    assert_eq!(cubes("uniform token purpose = \"guide\""), 0);
    assert_eq!(cubes("uniform token purpose = \"render\""), 1);
    assert_eq!(shapes(&read("over \"P\" {\n def Cube \"C\" {\n }\n}\nclass Cube \"K\" {\n}\n").desc).len(), 0);
    assert_eq!(shapes(&read("def Cube \"C\" (active = false) {\n}\n").desc).len(), 0);
    let curves = read("def NurbsCurves \"A\" {\n}\ndef NurbsCurves \"B\" {\n}\ndef Cube \"C\" {\n}\n");
    assert!(said(&curves).contains("/A (and 1 more): prims of type 'NurbsCurves' are left out"), "{}", said(&curves));
}

#[test]
fn arcs_compose_by_their_strength() {
    let size = |arcs: &str, own: &str| -> f64 {
        let text = format!(
            "class \"K\" {{\n double radius = 2\n}}\ndef Sphere \"R\" {{\n double radius = 3\n}}\nclass \"S\" {{\n\
            double radius = 4\n}}\n\
             def Sphere \"A\" ({arcs}) {{\n{own}\n}}\n"
        );
        let desc = read(&text).desc;
        let found = desc.shapes.iter().find(|s| desc.node(s.node).name.as_deref() == Some("A")).unwrap();
        desc.node(found.node).float("radius").unwrap()
    };
    let all = "specializes = </S>\n references = </R>\n inherits = </K>";
    let variants = "\n variantSets = \"v\"\n variants = { string v = \"x\" }";
    let five = "variantSet \"v\" = {\n \"x\" {\n double radius = 5\n }\n}";
    assert_eq!(size(all, "double radius = 1"), 1.0);
    assert_eq!(size(all, ""), 2.0);
    assert_eq!(size(&format!("references = </R>{variants}"), five), 5.0);
    assert_eq!(size(&format!("inherits = </K>{variants}"), five), 2.0);
    assert_eq!(size("specializes = </S>\n references = </R>", ""), 3.0);
    assert_eq!(size("specializes = </S>", ""), 4.0);
    let circle = import("#usda 1.0\ndef \"A\" (references = </B>) {\n}\ndef \"B\" (references = </A>) {\n}\n");
    assert!(said(&circle).contains("lead in a circle"), "{}", said(&circle));
    let below = import("#usda 1.0\ndef \"A\" {\n def \"B\" (references = </A>) {\n }\n}\n");
    assert!(said(&below).contains("lead in a circle"), "{}", said(&below));
}

#[test]
fn files_are_composed_and_stay_inside_their_folder() {
    let folder = tempfile::tempdir().unwrap();
    let inner = folder.path().join("in");
    std::fs::create_dir(&inner).unwrap();
    let at = |name: &str| inner.join(name);
    std::fs::write(
        at("asset.usda"),
        "#usda 1.0\n(defaultPrim = \"M\")\ndef Xform \"M\" {\n def Sphere \"S\" {\n\
        double radius = 2\n \
        double3 xformOp:translate.timeSamples = { 0: (0, 0, 0), 10: (10, 0, 0) }\n\
        uniform token[] xformOpOrder = [\"xformOp:translate\"]\n \
        rel material:binding = </M/L>\n }\n def Material \"L\" {\n\
        token outputs:surface.connect = </M/L/P.outputs:surface>\n \
        def Shader \"P\" {\n uniform token info:id = \"UsdPreviewSurface\"\n float inputs:roughness = 0.25\n }\n }\n\
        }\n",
    )
    .unwrap();
    std::fs::write(
        at("weak.usda"),
        "#usda 1.0\nover \"A\" {\n over \"S\" {\n double radius = 7\n }\n}\ndef Cube \"W\" {\n}\n",
    )
    .unwrap();
    let root = "#usda 1.0\n(subLayers = [@./weak.usda@])\n\
        def \"A\" (references = @./asset.usda@ (offset = 5; scale = 2)) {\n}\n\
                def \"B\" (payload = @asset.usda@</M>) {\n}\ndef \"C\" (references = @asset.usda@) {\n}\n";
    std::fs::write(at("root.usda"), root).unwrap();
    let options = |within: bool, time: &str| Options {
        within: within.then(|| inner.clone()),
        defines: [("at".into(), time.into())].into(),
        ..Options::default()
    };
    let found = super::import(&at("root.usda"), &options(true, "0.625"));
    assert!(!found.diagnostics.has_errors(), "{}", said(&found));
    let radii: Vec<f64> = found.desc.shapes.iter().filter_map(|s| found.desc.node(s.node).float("radius")).collect();
    // The sublayer is stronger than the reference.
    assert_eq!(radii.iter().filter(|r| **r == 7.0).count(), 1, "{radii:?}");
    assert_eq!(radii.iter().filter(|r| **r == 2.0).count(), 2, "{radii:?}");
    // Time code 15 is 5 in the file that is shifted by 5 and twice as long.
    let xs: Vec<f64> = found.desc.shapes.iter().map(|s| s.world_from_object.matrix.w_axis.x).collect();
    assert!(xs.contains(&5.0) && xs.contains(&10.0), "{xs:?}");
    assert_eq!(material(&found.desc, "S").float("roughness"), Some(0.25));
    // Materials of one file are one, as of the same time.
    assert_eq!(found.desc.nodes.iter().filter(|n| n.kind == "metallic_roughness").count(), 2);
    std::fs::write(folder.path().join("out.usda"), "#usda 1.0\n(defaultPrim = \"M\")\ndef Cube \"M\" {\n}\n").unwrap();
    std::fs::write(at("leads.usda"), "#usda 1.0\ndef \"A\" (references = @../out.usda@) {\n}\n").unwrap();
    let refused = super::import(&at("leads.usda"), &options(true, "0"));
    assert!(said(&refused).contains("is outside the scene's folder"), "{}", said(&refused));
    let allowed = super::import(&at("leads.usda"), &options(false, "0"));
    assert_eq!(shapes(&allowed.desc).len(), 1, "{}", said(&allowed));
    std::fs::write(at("gone.usda"), "#usda 1.0\ndef \"A\" (references = @none.usda@) {\n}\n").unwrap();
    assert!(said(&super::import(&at("gone.usda"), &options(false, "0"))).contains("/A: cannot find 'none.usda'"));
}

#[test]
fn instancers_place_their_prototypes() {
    let instancer = |count: usize, extra: &str| {
        let list = |value: &str| vec![value; count].join(", ");
        format!(
            "def PointInstancer \"I\" {{\n rel prototypes = </I/P>\n int[] protoIndices = [{}]\n\
            point3f[] positions = [{}]\n{extra}\n \
             def Xform \"P\" {{\n double3 xformOp:translate = (0, 0, 1)\n\
             uniform token[] xformOpOrder = [\"xformOp:translate\"]\n \
             def Cube \"C\" {{\n }}\n }}\n}}\n",
            list("0"),
            list("(4, 0, 0)")
        )
    };
    let few = read(&instancer(2, "int64[] invisibleIds = [1]\nfloat3[] scales = [(2, 2, 2), (1, 1, 1)]"));
    assert_eq!(shapes(&few.desc).len(), 1);
    assert!(is_near(place(&few.desc, "C").transform_point3(DVec3::ZERO), [4.0, 0.0, 2.0]));
    let many = read(&instancer(20, ""));
    assert_eq!((many.desc.instances.len(), many.desc.groups.len()), (20, 1));
    let wrong = import("#usda 1.0\n".to_owned() + &instancer(2, "").replace("[0, 0]", "[0, 3]"));
    assert!(said(&wrong).contains("there is no prototype 3"), "{}", said(&wrong));
    let own = "def PointInstancer \"I\" {\n rel prototypes = </I>\n int[] protoIndices = [0]\n\
        point3f[] positions = [(0, 0, 0)]\n}\n";
    assert!(said(&import("#usda 1.0\n".to_owned() + own)).contains("nested deeper"));
}

#[test]
fn cameras_have_the_view_and_lens_of_the_file() {
    let desc = read(
        "def Camera \"C\" {\n float focalLength = 50\n float horizontalAperture = 36\n float verticalAperture = 24\n \
         float fStop = 2.5\n float focusDistance = 7\n float2 clippingRange = (0.5, 90)\n\
         float horizontalApertureOffset = 3.6\n}\ndef Cube \"B\" {\n}\n",
    )
    .desc;
    let camera = desc.node(desc.cameras[0]);
    assert!((camera.float("fov").unwrap() - 39.597_752).abs() < 1e-5);
    // 50 tenths of a unit over 2.5 are 2 units across.
    assert_eq!((camera.float("lens_radius"), camera.float("focal_distance")), (Some(1.0), Some(7.0)));
    assert!((camera.float("principal_x").unwrap() + 0.1).abs() < 1e-6);
    assert_eq!((camera.float("near"), camera.float("far")), (Some(0.5), Some(90.0)));
    assert!(camera.transform("to_world").unwrap().vector(DVec3::Z).distance(DVec3::NEG_Z) < 1e-9);
    let film = desc.node(desc.film.unwrap());
    assert_eq!((film.int("width"), film.int("height")), (Some(1152), Some(768)));
}

#[test]
fn lights_have_the_radiance_of_the_specification() {
    let light = |text: &str| -> Node {
        let desc = read(&format!("def {text}\n}}\ndef Cube \"B\" {{\n}}\n")).desc;
        let area = desc.shapes.iter().find_map(|s| s.emission);
        desc.node(area.unwrap_or_else(|| desc.lights[0])).clone()
    };
    let near = |a: f64, b: f64| (a - b).abs() < 1e-5 * b.abs();
    let rect = light(
        "RectLight \"L\" {\n float inputs:intensity = 6\n float inputs:exposure = 1\n float inputs:width = 2\n\
        float inputs:height = 3\n bool inputs:normalize = 1",
    );
    assert!(near(color(&rect, "radiance")[0], 2.0));
    let sphere = light(
        "SphereLight \"L\" {\n float inputs:intensity = 5\n color3f inputs:color = (1, 0.5, 0)\n\
        float inputs:radius = 2",
    );
    assert_eq!(color(&sphere, "radiance"), [5.0, 2.5, 0.0]);
    let sun = light("DistantLight \"L\" {\n float inputs:intensity = 3\n float inputs:angle = 0");
    assert_eq!(color(&sun, "radiance"), [3.0; 3]);
    let wide = light("DistantLight \"L\" {\n float inputs:angle = 0.53");
    assert!(near(color(&wide, "radiance")[1], 50_000.0 * std::f64::consts::PI * 0.265_f64.to_radians().sin().powi(2)));
    let point =
        light("SphereLight \"L\" {\n float inputs:intensity = 8\n bool treatAsPoint = 1\n bool inputs:normalize = 1");
    assert_eq!((point.kind.as_str(), color(&point, "intensity")), ("point", [2.0; 3]));
    let spot = light(
        "SphereLight \"L\" {\n bool treatAsPoint = 1\n float inputs:shaping:cone:angle = 20\n\
        float inputs:shaping:cone:softness = 0.25",
    );
    assert_eq!((spot.float("cone_angle"), spot.float("falloff_start")), (Some(20.0), Some(15.0)));
    let warm =
        light("DomeLight \"L\" {\n bool inputs:enableColorTemperature = 1\n float inputs:colorTemperature = 3000");
    let [r, g, b] = color(&warm, "radiance");
    assert!(r > 1.5 && b < 0.5 && near(0.212_672_9 * r + 0.715_152_2 * g + 0.072_175 * b, 1.0), "{r} {g} {b}");
    let portal = read("def PortalLight \"L\" {\n}\ndef Cube \"B\" {\n}\n");
    assert!(said(&portal).contains("lights of type 'PortalLight' are left out"));
}

#[test]
fn textures_keep_their_channel_and_place() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("t.png"), b"").unwrap();
    let text = format!(
        "#usda 1.0\n{TRIANGLE} rel material:binding = </M>\n}}\ndef Material \"M\" {{\n\
        token outputs:surface.connect = </M/S.outputs:surface>\n \
         def Shader \"S\" {{\n uniform token info:id = \"UsdPreviewSurface\"\n\
         color3f inputs:diffuseColor.connect = </M/T.outputs:rgb>\n \
         float inputs:roughness.connect = </M/T.outputs:g>\n normal3f inputs:normal.connect = </M/N.outputs:rgb>\n \
         float inputs:metallic.connect = </M/X.outputs:out>\n }}\n \
         def Shader \"X\" {{\n uniform token info:id = \"Strange\"\n }}\n \
         def Shader \"T\" {{\n uniform token info:id = \"UsdUVTexture\"\n asset inputs:file = @t.png@\n\
         token inputs:wrapS = \"mirror\"\n \
         float4 inputs:scale = (2, 2, 2, 1)\n float2 inputs:st.connect = </M/D.outputs:result>\n }}\n \
         def Shader \"N\" {{\n uniform token info:id = \"UsdUVTexture\"\n asset inputs:file = @gone.png@\n }}\n \
         def Shader \"D\" {{\n uniform token info:id = \"UsdTransform2d\"\n float2 inputs:scale = (2, 3)\n\
         float2 inputs:translation = (0.5, 0)\n \
         float inputs:rotation = 90\n float2 inputs:in.connect = </M/R.outputs:result>\n }}\n \
         def Shader \"R\" {{\n uniform token info:id = \"UsdPrimvarReader_float2\"\n\
         string inputs:varname = \"map2\"\n }}\n}}\n"
    );
    let found = import_bytes(&folder.path().join("s.usda"), text.into_bytes(), &Options::default());
    assert!(!found.diagnostics.has_errors(), "{}", said(&found));
    let desc = &found.desc;
    let node = material(desc, "T");
    let base = desc.node(node.node("base_color").unwrap());
    assert_eq!((base.kind.as_str(), color(base, "scale")), ("scale", [2.0; 3]));
    let image = desc.node(base.node("texture").unwrap());
    assert_eq!((image.string("wrap_u"), image.string("uv_set")), (Some("mirror"), Some("map2")));
    // Scaled to (2, 0), turned to (0, 2), moved.
    assert!(is_near(image.transform("to_uv").unwrap().point(DVec3::X), [0.5, 2.0, 0.0]));
    let rough = desc.node(node.node("roughness").unwrap());
    assert_eq!(desc.node(rough.node("texture").unwrap()).string("channel"), Some("g"));
    assert!(node.get("normal_map").is_none());
    let said = said(&found);
    assert!(
        said.contains("/M/N: cannot find 'gone.png'") && said.contains("the shader 'Strange' is not read"),
        "{said}"
    );
}

#[test]
fn faults_are_told_with_their_place() {
    for (text, place, message) in [
        ("#usda 1.0\ndef Mesh \"M\" {\n int[] faceVertexCounts = [3\n}\n", "4:1", "a number is expected"),
        ("#usda 1.0\ndef \"a\"\n", "3:1", "'{' is expected"),
        ("#usda 1.0\nxyz\n", "2:1", "'def', 'over' or 'class' is expected"),
        ("#usda 1.0\ndef \"a b\" {}\n", "2:5", "cannot name a prim"),
        ("#usda 1.0\n(doc = \"open\n", "2:8", "does not end on its line"),
        ("#usda 1.0\ndef \"a\" (references = 5) {}\n", "2:23", "a file between '@'"),
        ("PXR", "1:1", "begins with '#usda 1.0'"),
    ] {
        let import = import(text);
        let found = import.diagnostics.iter().find(|d| d.message.contains(message));
        let location = found.unwrap_or_else(|| panic!("{text}: {}", said(&import))).location.clone().unwrap();
        assert_eq!(format!("{}:{}", location.line, location.column), place, "{text}");
    }
    let named = |text: &str, message: &str| {
        let import = import(format!("#usda 1.0\n{text}"));
        assert!(import.diagnostics.has_errors() && said(&import).contains(message), "{text}: {}", said(&import));
    };
    named(&(TRIANGLE.replace("[0, 1, 2]", "[0, 1, 9]") + "}"), "/T.faceVertexIndices: there is no point 9");
    named(&(TRIANGLE.replace("[0, 1, 2]", "[0, 1]") + "}"), "/T.faceVertexCounts: the faces have 3 corners");
    named(&(TRIANGLE.replace("(1, 0, 0)", "(nan, 0, 0)") + "}"), "/T.points");
    named("def Sphere \"S\" {\n double radius = -1\n}", "/S.radius: a number from 0");
    named(
        "def Cube \"C\" {\n uniform token[] xformOpOrder = [\"xformOp:bend\"]\n}",
        "'xformOp:bend' is not a known operation",
    );
}

#[test]
fn hostile_layers_end() {
    let deep = "def \"a\" {".repeat(100_000);
    assert!(said(&import(format!("#usda 1.0\n{deep}"))).contains("nested deeper"));
    let lists = "[".repeat(100_000);
    assert!(import(format!("#usda 1.0\ndef \"a\" {{ int[] x = {lists}")).diagnostics.has_errors());
    let dictionaries = "{ dictionary a = ".repeat(100_000);
    assert!(said(&import(format!("#usda 1.0\n(customLayerData = {dictionaries}"))).contains("nested deeper"));
}

#[test]
fn damaged_binary_layers_are_refused_or_read() {
    let mut rng = steradian_math::hash::HashRng::new(7);
    for seed in [BINARY, ARCHIVE] {
        for _ in 0..500 {
            let mut bytes = seed.to_vec();
            for _ in 0..1 + rng.next_u64() % 4 {
                let at = rng.next_u64() as usize % bytes.len();
                bytes[at] = match rng.next_u64() % 3 {
                    0 => 0xff,
                    1 => 0,
                    _ => rng.next_u64() as u8,
                };
            }
            let _ = import_bytes(Path::new("s.usdc"), bytes, &Options::default());
        }
        for length in (0..seed.len()).step_by(5) {
            let cut = import_bytes(Path::new("s.usdc"), seed[..length].to_vec(), &Options::default());
            assert!(cut.diagnostics.has_errors(), "{length}");
        }
    }
}

#[test]
fn movements_that_are_not_read_are_told() {
    let found = import(
        "#usda 1.0\n(relocates = { </A/B>: </A/C> })\ndef Mesh \"M\" (\n\
         clips = { dictionary default = { string primPath = \"/M\" } }) {\n\
         int[] primvars:skel:jointIndices = [0, 0, 0]\n\
         int[] faceVertexCounts = [3]\n int[] faceVertexIndices = [0, 1, 2]\n\
         point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]\n}\n\
         def Sphere \"S\" {\n double radius = 2\n double radius.spline = { 1: 2, 3: 4 }\n}\n\
         def RenderSettings \"R\" {\n}\n",
    );
    let told = said(&found);
    for what in ["relocates", "/M: value clips", "rest pose", "/S: the spline of 'radius'", "/R: render settings"] {
        assert!(told.contains(what), "{what}: {told}");
    }
    assert_eq!(shapes(&found.desc).len(), 2, "{told}");
}

/// A stage with a sphere that has a surface of MaterialX, by its inputs and the nodes of its graph.
fn materialx(id: &str, inputs: &str, graph: &str) -> Import {
    import(format!(
        "#usda 1.0\ndef Sphere \"S\" {{\n rel material:binding = </M>\n}}\ndef Material \"M\" {{\n\
         token outputs:mtlx:surface.connect = </M/P.outputs:out>\n\
         token outputs:surface.connect = </M/Preview.outputs:surface>\n\
         def Shader \"Preview\" {{\n uniform token info:id = \"UsdPreviewSurface\"\n token outputs:surface\n }}\n\
         def Shader \"P\" {{\n uniform token info:id = \"{id}\"\n{inputs}\n token outputs:out\n }}\n{graph}\n}}\n"
    ))
}

#[test]
fn networks_of_materialx_are_surfaces() {
    let open = "ND_open_pbr_surface_surfaceshader";
    // The network counts, not the preview beside it; films are given in micrometres.
    let inputs = "color3f inputs:base_color = (0.125, 0.25, 0.5)\nfloat inputs:specular_roughness = 0.25\n\
                  float inputs:coat_darkening\nfloat inputs:thin_film_thickness = 0.5\n\
                  float inputs:emission_luminance = 3\nfloat inputs:geometry_opacity = 0.5\n\
                  bool inputs:geometry_thin_walled = 1";
    let desc = materialx(open, inputs, "").desc;
    let mask = desc.node(desc.shapes[0].material.unwrap());
    assert_eq!((mask.kind.as_str(), mask.float("opacity")), ("mask", Some(0.5)));
    let node = desc.node(mask.node("material").unwrap());
    assert_eq!(node.kind, "openpbr");
    assert_eq!(
        node.get("base_color"),
        Some(&Param::Spectrum(SpectrumValue::Rgb([0.125, 0.25, 0.5], steradian_scene::ColorSpace::Srgb)))
    );
    let numbers = ["specular_roughness", "thin_film_thickness", "emission_luminance"].map(|n| node.float(n));
    assert_eq!((numbers, node.float("coat_darkening")), ([Some(0.25), Some(500.0), Some(0.0)], None));
    assert_eq!(node.bool("geometry_thin_walled"), Some(true));
    assert_eq!(desc.node(desc.shapes[0].emission.unwrap()).float("scale"), Some(3.0));
    // Constants are computed, the rest becomes textures.
    let graph = "def NodeGraph \"G\" {\n float outputs:r.connect = </M/G/A.outputs:out>\n\
         def Shader \"A\" {\n uniform token info:id = \"ND_multiply_float\"\n\
         float inputs:in1.connect = </M/G/B.outputs:out>\n\
         float inputs:in2 = 0.5\n float outputs:out\n }\n\
         def Shader \"B\" {\n uniform token info:id = \"ND_remap_float\"\n float inputs:in = 5\n\
         float inputs:inhigh = 10\n\
         float inputs:outlow = 0.2\n float inputs:outhigh = 0.6\n float outputs:out\n }\n\
         def Shader \"C\" {\n uniform token info:id = \"ND_invert_color3\"\n\
         color3f inputs:in.connect = </M/G/D.outputs:out>\n color3f outputs:out\n }\n\
         def Shader \"D\" {\n uniform token info:id = \"ND_geompropvalue_color3\"\n\
         string inputs:geomprop = \"displayColor\"\n color3f outputs:out\n }\n\
         def Shader \"E\" {\n uniform token info:id = \"ND_quantum_foam_float\"\n float outputs:out\n }\n}\n";
    let inputs = "float inputs:base_metalness.connect = </M/G.outputs:r>\n\
         color3f inputs:base_color.connect = </M/G/C.outputs:out>\n\
         float inputs:coat_weight.connect = </M/G/E.outputs:out>";
    let found = materialx(open, inputs, graph);
    let desc = &found.desc;
    let node = desc.node(desc.shapes[0].material.unwrap());
    assert!((node.float("base_metalness").unwrap() - 0.2).abs() < 1e-7);
    let sum = desc.node(node.node("base_color").unwrap());
    let product = desc.node(sum.node("b").unwrap());
    assert_eq!((sum.kind.as_str(), sum.float("a"), product.float("scale")), ("add", Some(1.0), Some(-1.0)));
    assert_eq!(desc.node(product.node("texture").unwrap()).kind, "mesh_attribute");
    assert_eq!(node.get("coat_weight"), None);
    assert!(said(&found).contains("the node 'quantum_foam' is not read"), "{}", said(&found));
    let told = said(&materialx(open, "color3f inputs:base_colour = (1, 0, 0)\nfloat3 inputs:geometry_tangent", ""));
    assert!(told.contains("'base_colour' is not an input") && told.contains("did you mean 'base_color'?"), "{told}");
    assert!(!told.contains("tangent"), "{told}");
    let turned = "float3 inputs:geometry_tangent.connect = </M/T.outputs:out>\n\
                  float inputs:specular_roughness_anisotropy = ";
    let node = "def Shader \"T\" {\n uniform token info:id = \"ND_rotate3d_vector3\"\n float3 outputs:out\n }";
    let told = |a: &str| said(&materialx(open, &format!("{turned}{a}"), node));
    assert!(told("0.5").contains("stretched along the tangent of the mesh") && !told("0").contains("stretched"));
    let standard = "ND_standard_surface_surfaceshader";
    let told = |v: f32| said(&materialx(standard, &format!("float inputs:coat_affect_color = {v}"), ""));
    assert!(told(0.5).contains("'coat_affect_color' is not an input") && !told(0.0).contains("coat_affect"));
    // The standard surface has defaults of its own.
    let desc = materialx("ND_standard_surface_surfaceshader", "float inputs:metalness = 1", "").desc;
    let node = desc.node(desc.shapes[0].material.unwrap());
    let numbers = ["base_metalness", "specular_roughness", "coat_darkening"].map(|n| node.float(n));
    assert_eq!(numbers, [Some(1.0), Some(0.2), Some(0.0)]);
}

#[test]
fn graphs_that_never_end_are_told() {
    let graph = "def Shader \"A\" {\n uniform token info:id = \"ND_add_float\"\n\
         float inputs:in1.connect = </M/A.outputs:out>\n float inputs:in2.connect = </M/A.outputs:out>\n\
         float outputs:out\n }";
    let input = "float inputs:base_metalness.connect = </M/A.outputs:out>";
    let found = materialx("ND_open_pbr_surface_surfaceshader", input, graph);
    assert!(said(&found).contains("is not followed"), "{}", said(&found));
}

#[test]
fn pictures_of_networks_have_their_place_and_space() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("p.png"), b"").unwrap();
    let path = folder.path().join("s.usda");
    std::fs::write(
        &path,
        "#usda 1.0\ndef Sphere \"S\" {\n rel material:binding = </M>\n}\ndef Material \"M\" {\n\
         token outputs:mtlx:surface.connect = </M/P.outputs:out>\n\
         def Shader \"P\" {\n uniform token info:id = \"ND_open_pbr_surface_surfaceshader\"\n\
         color3f inputs:base_color.connect = </M/I.outputs:out>\n\
         float3 inputs:geometry_normal.connect = </M/N.outputs:out>\n\
         float inputs:geometry_opacity.connect = </M/X.outputs:out>\n token outputs:out\n }\n\
         def Shader \"I\" {\n uniform token info:id = \"ND_image_color4\"\n\
         asset inputs:file = @p.png@ (colorSpace = \"srgb_texture\")\n string inputs:uaddressmode = \"mirror\"\n\
         float2 inputs:texcoord.connect = </M/T.outputs:out>\n color4f outputs:out\n }\n\
         def Shader \"T\" {\n uniform token info:id = \"ND_place2d_vector2\"\n float2 inputs:scale = (0.5, 0.25)\n\
         float2 inputs:offset = (1, 2)\n float2 outputs:out\n }\n\
         def Shader \"X\" {\n uniform token info:id = \"ND_separate4_color4\"\n\
         color4f inputs:in.connect = </M/I.outputs:out>\n float outputs:outa\n float outputs:out\n }\n\
         def Shader \"N\" {\n uniform token info:id = \"ND_normalmap_float\"\n float inputs:scale = 0.5\n\
         float3 inputs:in.connect = </M/V.outputs:out>\n float3 outputs:out\n }\n\
         def Shader \"V\" {\n uniform token info:id = \"ND_image_vector3\"\n asset inputs:file = @p.png@\n\
         float3 outputs:out\n }\n}\n"
            .replace("</M/X.outputs:out>", "</M/X.outputs:outa>"),
    )
    .unwrap();
    let found = super::import(&path, &Options::default());
    let desc = &found.desc;
    let mask = desc.node(desc.shapes[0].material.unwrap());
    let opacity = desc.node(mask.node("opacity").unwrap());
    assert_eq!(opacity.string("channel"), Some("a"));
    let node = desc.node(mask.node("material").unwrap());
    let picture = desc.node(node.node("base_color").unwrap());
    assert_eq!((picture.string("encoding"), picture.string("wrap_u")), (Some("srgb"), Some("mirror")));
    let Some(Param::Transform(map)) = picture.get("to_uv") else { panic!("{picture:?}") };
    assert!(is_near(map.matrix.transform_point3(DVec3::new(0.5, 0.5, 0.0)), [0.0, 0.0, 0.0]));
    assert_eq!(node.float("normal_map_strength"), Some(0.5));
    assert_eq!(desc.node(node.node("normal_map").unwrap()).bool("raw"), Some(true));
}

const DOCUMENT: &str = r#"<?xml version="1.0"?>
<materialx version="1.39" colorspace="lin_rec709" fileprefix="maps/">
  <nodegraph name="G">
    <input name="tint" type="float" value="0.5"/>
    <image name="i" type="color3">
      <input name="file" type="filename" value="p.png" colorspace="srgb_texture"/>
    </image>
    <multiply name="m" type="color3">
      <input name="in1" type="color3" nodename="i"/>
      <input name="in2" type="float" interfacename="tint"/>
    </multiply>
    <output name="o" type="color3" nodename="m"/>
  </nodegraph>
  <open_pbr_surface name="S" type="surfaceshader">
    <input name="base_color" type="color3" nodegraph="G" output="o"/>
    <input name="coat_color" type="color3" value="0.5, 1, 0" colorspace="srgb_texture"/>
    <input name="geometry_thin_walled" type="boolean" value="true"/>
  </open_pbr_surface>
  <surfacematerial name="Paint" type="material">
    <input name="surfaceshader" type="surfaceshader" nodename="S"/>
  </surfacematerial>
  <surfacematerial name="Bare" type="material"/>
</materialx>"#;

#[test]
fn documents_of_materialx_are_layers() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("maps")).unwrap();
    std::fs::write(folder.path().join("maps/p.png"), b"").unwrap();
    let document = folder.path().join("d.mtlx");
    std::fs::write(&document, DOCUMENT).unwrap();
    // Alone: a ball for each.
    let alone = super::import(&document, &Options::default());
    assert_eq!(shapes(&alone.desc).len(), 2, "{}", said(&alone));
    assert!(said(&alone).contains("/MaterialX/Materials/Bare"), "{}", said(&alone));
    // As a layer: a material of a stage.
    let stage = folder.path().join("s.usda");
    let text = "#usda 1.0\ndef Sphere \"B\" {\n rel material:binding = </L>\n}\n\
                def \"L\" (references = @d.mtlx@</MaterialX/Materials/Paint>) {\n}\n";
    std::fs::write(&stage, text).unwrap();
    let found = super::import(&stage, &Options::default());
    for (import, name) in [(&alone, "Paint"), (&found, "B")] {
        let desc = &import.desc;
        let node = material(desc, name);
        assert_eq!(node.kind, "openpbr", "{}", said(import));
        assert_eq!(node.bool("geometry_thin_walled"), Some(true));
        let Some(Param::Spectrum(SpectrumValue::Rgb(coat, _))) = node.get("coat_color") else { panic!("{node:?}") };
        assert!((coat[0] - 0.214_041).abs() < 1e-6 && coat[1] == 1.0 && coat[2] == 0.0, "{coat:?}");
        let product = desc.node(node.node("base_color").unwrap());
        assert_eq!((product.kind.as_str(), product.float("scale")), ("scale", Some(0.5)));
        let picture = desc.node(product.node("texture").unwrap());
        assert_eq!(picture.path("file"), Some(folder.path().join("maps/p.png").as_path()));
        assert_eq!(picture.string("encoding"), Some("srgb"));
    }
}

#[test]
fn faults_of_documents_have_their_place() {
    let fault = |text: &str| {
        let import = import_bytes(Path::new("d.mtlx"), text.as_bytes().to_vec(), &Options::default());
        assert!(import.diagnostics.has_errors(), "{text}");
        said(&import)
    };
    let told = fault(&DOCUMENT.replace("0.5, 1, 0", "0.5, 1"));
    assert!(told.contains("a color3 is 3 numbers, not 2") && told.contains("d.mtlx:16:"), "{told}");
    assert!(fault(&DOCUMENT.replace("0.5, 1, 0", "0.5, one, 0")).contains("is not a color3"));
    assert!(fault("<materialx><surfacematerial type=\"material\"/></materialx>").contains("has no name"));
    assert!(fault("<materialx><a></materialx>").contains("is not closed"));
    assert!(fault("<scene version='3.0.0'/>").contains("is a <materialx>, not a <scene>"));
}

#[test]
fn curves_are_tubes() {
    let curves = |counts: &str, rest: &str| {
        format!(
            "def BasisCurves \"C\" {{\n int[] curveVertexCounts = [{counts}]\n uniform token type = \"linear\"\n\
             point3f[] points = [(0, 0, 0), (0, 0, 2), (5, 0, 0), (5, 0, 1), (5, 0, 2)]\n{rest}\n}}\n"
        )
    };
    let found = read(&curves(
        "2, 3",
        "float[] widths = [0.2, 0.4] (interpolation = \"uniform\")\n\
         color3f[] primvars:displayColor = [(1, 0, 0), (0, 0, 1), (0, 1, 0), (1, 0, 0), (0, 0, 1)] \
         (interpolation = \"vertex\")\n texCoord2f[] primvars:st = [(0.25, 0), (0.5, 1)] (interpolation = \"uniform\")",
    ));
    let mesh = &found.desc.meshes[0];
    assert_eq!((mesh.positions.len(), mesh.triangles.len()), (5 * 9, 3 * 18));
    // The perimeter of nine sides is that of the circle.
    let side = |k: usize| (glam::Vec3::from(mesh.positions[k + 1]) - glam::Vec3::from(mesh.positions[k])).length();
    assert!((9.0 * side(0) - 0.2 * std::f32::consts::PI).abs() < 1e-5);
    assert!((9.0 * side(18) - 0.4 * std::f32::consts::PI).abs() < 1e-5);
    assert_eq!((mesh.uvs[0], mesh.uvs[44]), ([0.25, 0.0], [0.5, 1.0]));
    assert_eq!(mesh.attributes[0].data[27..30], [0.0, 0.0, 1.0]);
    let out = mesh.normals.iter().zip(&mesh.positions).take(9).all(|(n, p)| n[0] * p[0] + n[1] * p[1] > 0.0);
    let [a, b, c] = mesh.triangles[0].map(|k| glam::Vec3::from(mesh.positions[k as usize]));
    assert!(out && (b - a).cross(c - a).dot(a) > 0.0);
    let refused = |text: String| said(&import(format!("#usda 1.0\n{text}")));
    assert!(refused(curves("2, 2", "")).contains("/C.curveVertexCounts: the curves have 4 points, and 5 are given"));
    assert!(refused(curves("4, 1", "")).contains("curve 1 has 1 points"));
    assert!(refused(curves("2, 3", "float[] widths = [1, 1, -1, 1, 1]")).contains("/C.widths: numbers from 0 on"));
    assert!(said(&read(&curves("2, 3", ""))).contains("without widths"));
    // As many pieces as the bend asks for: a half-turn of a thin strand against a straight one.
    let bent = |y: f32| {
        let text = format!(
            "def BasisCurves \"C\" {{\n int[] curveVertexCounts = [4]\n\
             float[] widths = [0.01] (interpolation = \"constant\")\n\
             point3f[] points = [(0, 0, 0), (0, {y}, 1), (0, {y}, 2), (0, 0, 3)]\n}}\n"
        );
        let mesh = read(&text).desc.meshes[0].clone();
        let top = mesh.positions.iter().fold(0.0_f32, |top, p| top.max(p[1]));
        (mesh.triangles.len(), top)
    };
    assert_eq!(bent(0.0).0, 18);
    assert!(bent(2.0).0 == 16 * 18 && (bent(2.0).1 - 1.505).abs() < 1e-3, "{:?}", bent(2.0));
}

#[test]
fn points_are_spheres() {
    let points = |count: usize, rest: &str| {
        let all: Vec<String> = (0..count).map(|k| format!("({k}, 0, 0)")).collect();
        format!("def Points \"P\" {{\n point3f[] points = [{}]\n{rest}\n}}\n", all.join(", "))
    };
    let few = read(&points(
        3,
        "float[] widths = [1, 0, 4]\n\
        color3f[] primvars:displayColor = [(1, 0, 0), (0, 0, 0), (0, 1, 0)] (interpolation = \"vertex\")",
    ));
    let found = shapes(&few.desc);
    assert_eq!(found.len(), 2, "none of no width");
    assert!(is_near(found[1].world_from_object.matrix.transform_point3(DVec3::X), [4.0, 0.0, 0.0]));
    assert_eq!(color(few.desc.node(found[1].material.unwrap()), "reflectance"), [0.0, 1.0, 0.0]);
    let many = read(&points(20, "float[] widths = [1] (interpolation = \"constant\")"));
    assert_eq!((many.desc.instances.len(), many.desc.groups.len()), (20, 1));
    let wrong = import("#usda 1.0\n".to_owned() + &points(2, "float[] widths = [1, inf]"));
    assert!(said(&wrong).contains("/P.widths"), "{}", said(&wrong));
}

#[test]
fn closures_that_are_diffuse_are_surfaces() {
    let graph = |kind: &str| {
        format!(
            " def Shader \"B\" {{\n uniform token info:id = \"{kind}\"\n color3f inputs:color = (0.5, 0.25, 0.125)\n\
             float inputs:roughness = 0.5\n token outputs:out\n }}\n\
             def Shader \"E\" {{\n uniform token info:id = \"ND_uniform_edf\"\n color3f inputs:color = (4, 2, 0)\n\
             token outputs:out\n }}\n"
        )
    };
    let inputs = "token inputs:bsdf.connect = </M/B.outputs:out>\ntoken inputs:edf.connect = </M/E.outputs:out>";
    let found = materialx("ND_surface", inputs, &graph("ND_oren_nayar_diffuse_bsdf"));
    let shape = &found.desc.shapes[0];
    let node = found.desc.node(shape.material.unwrap());
    assert_eq!((node.kind.as_str(), node.float("specular_weight")), ("openpbr", Some(0.0)), "{}", said(&found));
    assert_eq!((node.float("base_weight"), node.float("base_diffuse_roughness")), (Some(1.0), Some(0.5)));
    assert_eq!(color(node, "base_color"), [0.5, 0.25, 0.125]);
    let light = found.desc.node(shape.emission.unwrap());
    assert_eq!((color(light, "radiance"), light.float("scale")), ([1.0, 0.5, 0.0], Some(4.0)));
    // Of what else there is, the preview beside it counts.
    let other = materialx("ND_surface", inputs, &graph("ND_sheen_bsdf"));
    let node = other.desc.node(other.desc.shapes[0].material.unwrap());
    assert_eq!(node.kind, "metallic_roughness");
}

#[test]
fn volumes_are_media_in_boxes() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("v.vdb"), "").unwrap();
    let stage = |extent: &str| {
        format!(
            "#usda 1.0\ndef Xform \"W\" {{\n double3 xformOp:translate = (0, 0, 5)\n\
             uniform token[] xformOpOrder = [\"xformOp:translate\"]\n\
             def Volume \"V\" {{\n rel field:density = </W/V/d>\n{extent}\n\
             def OpenVDBAsset \"d\" {{\n asset filePath = @v.vdb@\n token fieldName = \"smoke\"\n\
             double3 xformOp:translate = (1, 0, 0)\n\
             uniform token[] xformOpOrder = [\"xformOp:translate\"]\n }}\n }}\n}}\n"
        )
    };
    let open = |text: String| import_bytes(&folder.path().join("s.usda"), text.into_bytes(), &Options::default());
    let found = open(stage("float3[] extent = [(0, 0, 0), (1, 2, 3)]"));
    assert!(!found.diagnostics.has_errors(), "{}", said(&found));
    let shape = shapes(&found.desc)[0];
    let medium = found.desc.node(shape.interior.unwrap());
    assert_eq!((medium.kind.as_str(), medium.string("grid")), ("vdb", Some("smoke")));
    assert_eq!(medium.transform("to_world").unwrap().point(DVec3::ZERO), DVec3::new(1.0, 0.0, 5.0));
    assert!(shape.is_medium_boundary && found.desc.meshes[shape.mesh.unwrap()].positions[7] == [1.0, 2.0, 3.0]);
    assert!(said(&open(stage("float3[] extent = [(0, 0, 0), (1, 0, 3)]"))).contains("/W/V.extent"));
    assert!(said(&open(stage(""))).contains("without an extent"));
    let gone = said(&open(stage("float3[] extent = [(0, 0, 0), (1, 2, 3)]").replace("v.vdb", "w.vdb")));
    assert!(gone.contains("/W/V/d: cannot find 'w.vdb'"), "{gone}");
}
