//! Faults are reported at their position, with what to do about them.

use super::*;

/// Text, line and column of the first error, and a part of its message.
type Case = (&'static str, u32, u32, &'static str);

#[rustfmt::skip]
const CASES: &[Case] = &[
    // Tokens and statements.
    ("WorldBegin\nShape \"sphere", 2, 7, "not closed on its line"),
    ("WorldBegin\n  Shpae \"sphere\"", 2, 3, "unknown directive 'Shpae'"),
    ("WorldBegin\n  1 2 3", 2, 3, "expected a directive, found '1'"),
    ("WorldBegin\n \"float a\" 1", 2, 2, "expected a directive"),
    ("WorldBegin ]", 1, 12, "expected a directive"),
    ("WorldBegin\nShape sphere", 2, 7, "expected a quoted string, found 'sphere'"),
    ("WorldBegin\nShape", 2, 6, "the file ends where a quoted string is expected"),
    ("WorldBegin\nShape \"sphere\" \"float radius\" [1", 2, 31, "the bracket is not closed"),
    ("WorldBegin\nShape \"sphere\" \"float radius\" [1 Shape \"disk\"", 2, 31, "this list is not closed"),
    ("WorldBegin\nShape \"sphere\" \"float radius\" nan", 2, 31, "not a finite number"),
    ("WorldBegin\nShape \"sphere\" \"float radius\" inf", 2, 31, "not a finite number"),
    ("WorldBegin\nShape \"sphere\" \"float radius\" 1e400", 2, 31, "not a finite number"),
    ("WorldBegin\nShape \"sphere\" \"float radius\" [1 2]", 2, 31, "takes 1 value, found 2"),
    ("WorldBegin\nShape \"sphere\" \"string radius\" \"1\"", 2, 16, "must be float, not string"),
    ("WorldBegin\nShape \"sphere\" \"radius\" 1", 2, 16, "expected a parameter declaration"),
    ("WorldBegin\nShape \"sphere\" \"flaot radius\" 1", 2, 16, "unknown parameter type 'flaot'"),
    ("WorldBegin\nShape \"sphere\" \"float radius\" 0", 2, 31, "must be above 0"),
    ("WorldBegin\nShape \"sp\\here\"", 2, 10, "unknown escape"),
    // Transforms.
    ("WorldBegin\nTranslate 1 2", 2, 14, "the file ends where a number is expected"),
    ("WorldBegin\nTranslate 1 2 Shape \"sphere\"", 2, 15, "expected a number, found 'Shape'"),
    ("WorldBegin\nTransform 1 0 0", 2, 1, "sixteen numbers in brackets"),
    ("WorldBegin\nTransform [1 0 0]", 2, 1, "expected sixteen numbers, found 3"),
    ("WorldBegin\nRotate 10 0 0 0", 2, 1, "no length"),
    ("WorldBegin\nLookAt 0 0 0 0 0 0 0 1 0", 2, 1, "two different points"),
    ("WorldBegin\nLookAt 0 0 0 0 1 0 0 1 0", 2, 1, "up vector"),
    ("WorldBegin\nScale 0 1 1 Shape \"sphere\"", 2, 19, "cannot be inverted"),
    ("WorldBegin\nScale 1e300 1e300 1e300 Scale 1e300 1 1 Shape \"sphere\"", 2, 47, "cannot be inverted"),
    ("Scale 0 1 1\nCamera \"perspective\"\nWorldBegin", 2, 8, "cannot be inverted"),
    ("WorldBegin\nCoordSysTransform \"a\"", 2, 19, "no coordinate system 'a'"),
    ("WorldBegin\nActiveTransform Both", 2, 17, "expected All, StartTime or EndTime"),
    // Order and blocks.
    ("WorldBegin\nCamera \"perspective\"", 2, 1, "must come before WorldBegin"),
    ("WorldBegin\nWorldBegin", 2, 1, "must come before WorldBegin"),
    ("Shape \"sphere\"\nWorldBegin", 1, 1, "must come after WorldBegin"),
    ("WorldBegin\nAttributeEnd", 2, 1, "no block is open"),
    ("WorldBegin\nAttributeBegin\nAttributeBegin\nAttributeEnd", 2, 1, "not closed"),
    ("WorldBegin\nObjectBegin \"a\"", 2, 1, "not closed"),
    ("WorldBegin\nObjectBegin \"a\" AttributeEnd ObjectEnd", 2, 17, "opened by ObjectBegin"),
    ("WorldBegin\nObjectBegin \"a\" AttributeBegin ObjectEnd AttributeEnd ObjectEnd", 2, 32, "opened by AttributeBegin"),
    ("WorldBegin\nObjectEnd", 2, 1, "no object is being defined"),
    ("WorldBegin\nObjectBegin \"a\" ObjectBegin \"b\" ObjectEnd ObjectEnd", 2, 17, "inside another"),
    ("WorldBegin\nObjectBegin \"a\" ObjectInstance \"a\" ObjectEnd", 2, 17, "cannot contain an instance"),
    ("WorldBegin\nObjectBegin \"a\" ObjectEnd\nObjectBegin \"a\" ObjectEnd", 3, 13, "defined twice"),
    ("WorldBegin\nObjectInstance \"gone\"", 2, 16, "no object 'gone'"),
    ("WorldBegin\nInclude \"gone.pbrt\"", 2, 9, "cannot find 'gone.pbrt'"),
    ("Option \"sede\" 1\nWorldBegin", 1, 8, "unknown option"),
    ("Option \"seed\" x\nWorldBegin", 1, 15, "expected an integer"),
    ("ColorSpace \"sgrb\"\nWorldBegin", 1, 12, "unknown colour space"),
    ("WorldBegin\nAttribute \"shapes\" \"float radius\" 1", 2, 11, "unknown target"),
    // Names.
    ("WorldBegin\nNamedMaterial \"gold\" Shape \"sphere\"", 2, 15, "no material 'gold'"),
    ("WorldBegin\nMediumInterface \"fog\" \"\" Shape \"sphere\"", 2, 17, "no medium 'fog'"),
    ("WorldBegin\nMaterial \"diffuse\" \"texture reflectance\" \"t\"", 2, 42, "no spectrum texture 't'"),
    ("WorldBegin\nTexture \"t\" \"float\" \"constant\"\nMaterial \"diffuse\" \"texture reflectance\" \"t\"", 3, 42, "is a float texture"),
    ("WorldBegin\nTexture \"t\" \"float\" \"scale\" \"texture tex\" \"u\"\nTexture \"u\" \"float\" \"constant\"", 2, 43, "used before it is defined"),
    ("WorldBegin\nTexture \"t\" \"float\" \"scale\" \"texture tex\" \"t\"", 2, 43, "used before it is defined"),
    ("WorldBegin\nTexture \"t\" \"float\" \"constant\"\nTexture \"t\" \"float\" \"constant\"", 3, 9, "defined twice"),
    ("WorldBegin\nMakeNamedMaterial \"m\" \"string type\" \"diffuse\"\nMakeNamedMaterial \"m\" \"string type\" \"diffuse\"", 3, 19, "defined twice"),
    ("WorldBegin\nMakeNamedMaterial \"m\"", 2, 19, "needs \"string type\""),
    ("WorldBegin\nMakeNamedMaterial \"m\" \"string type\" \"difuse\"", 2, 37, "unknown material 'difuse'"),
    ("WorldBegin\nMakeNamedMaterial \"m\" \"string type\" \"mix\" \"string materials\" [\"m\" \"m\"]", 2, 62, "used before it is defined"),
    ("WorldBegin\nMakeNamedMedium \"m\"", 2, 17, "needs \"string type\""),
    ("WorldBegin\nMakeNamedMedium \"m\" \"string type\" \"fog\"", 2, 35, "unknown medium 'fog'"),
    // Models.
    ("Film \"rgb\" \"integer xresolution\" 0\nWorldBegin", 1, 34, "the film is empty"),
    ("Film \"rgb\" \"integer xresolution\" 4000000000\nWorldBegin", 1, 34, "does not fit 32 bits"),
    ("Film \"rgb\" \"integer xresolution\" 10 \"integer yresolution\" 10 \"integer pixelbounds\" [20 30 0 5]\nWorldBegin", 1, 84, "leaves no pixel"),
    ("Film \"rgb\" \"float cropwindow\" [0 1]\nWorldBegin", 1, 31, "four numbers"),
    ("Film \"image\"\nWorldBegin", 1, 6, "unknown film"),
    ("PixelFilter \"gausian\"\nWorldBegin", 1, 13, "unknown pixel filter"),
    ("PixelFilter \"box\" \"float xradius\" -1\nWorldBegin", 1, 35, "must be above 0"),
    ("Sampler \"random\"\nWorldBegin", 1, 9, "unknown sampler"),
    ("Sampler \"sobol\" \"integer pixelsamples\" 0\nWorldBegin", 1, 40, "must be above 0"),
    ("Integrator \"pth\"\nWorldBegin", 1, 12, "unknown integrator"),
    ("Integrator \"path\" \"integer maxdepth\" -1\nWorldBegin", 1, 38, "must not be below 0"),
    ("Camera \"fisheye\"\nWorldBegin", 1, 8, "unknown camera"),
    ("Camera \"perspective\" \"float fov\" 180\nWorldBegin", 1, 34, "must be below 180"),
    ("Camera \"perspective\" \"float screenwindow\" [1 0 0 1]\nWorldBegin", 1, 43, "is empty"),
    ("Camera \"perspective\" \"float shutteropen\" 2\nWorldBegin", 1, 8, "closes before it opens"),
    ("WorldBegin\nLightSource \"sun\"", 2, 13, "unknown light source"),
    ("WorldBegin\nLightSource \"point\" \"rgb I\" [1 -1 0]", 2, 29, "below 0"),
    ("WorldBegin\nLightSource \"point\" \"rgb I\" [1 1]", 2, 29, "takes 3 numbers"),
    ("WorldBegin\nLightSource \"point\" \"blackbody I\" 0", 2, 35, "above 0 K"),
    ("WorldBegin\nLightSource \"point\" \"blackbody I\" [6500 2]", 2, 35, "one temperature"),
    ("WorldBegin\nLightSource \"point\" \"spectrum I\" [400 1 500]", 2, 34, "pairs of wavelength and value"),
    ("WorldBegin\nLightSource \"point\" \"spectrum I\" [400 1 400 2]", 2, 34, "must increase"),
    ("WorldBegin\nLightSource \"point\" \"spectrum I\" \"stdillum-D56\"", 2, 34, "unknown spectrum"),
    ("WorldBegin\nLightSource \"point\" \"spectrum I\" \"gone.spd\"", 2, 34, "cannot find 'gone.spd'"),
    ("WorldBegin\nLightSource \"spot\" \"point3 from\" [0 0 1]", 2, 13, "the same point"),
    ("WorldBegin\nLightSource \"infinite\" \"string filename\" \"gone.exr\"", 2, 42, "cannot find"),
    ("WorldBegin\nLightSource \"infinite\" \"point3 portal\" [1 2 3]", 2, 40, "four corners"),
    ("WorldBegin\nLightSource \"projection\"", 2, 13, "needs \"string filename\""),
    ("WorldBegin\nLightSource \"goniometric\"", 2, 13, "needs \"string filename\""),
    ("WorldBegin\nAreaLightSource \"area\"", 2, 17, "unknown area light source"),
    ("WorldBegin\nMaterial \"matte\"", 2, 10, "unknown material 'matte'"),
    ("WorldBegin\nMaterial \"mix\"", 2, 10, "needs \"string materials\""),
    ("WorldBegin\nMaterial \"subsurface\" \"string name\" \"Aple\"", 2, 37, "unknown scattering medium"),
    ("WorldBegin\nMaterial \"conductor\" \"rgb eta\" [1 1 1] \"rgb reflectance\" [1 1 1]", 2, 58, "not both"),
    ("WorldBegin\nMaterial \"dielectric\" \"float eta\" -1", 2, 35, "must be above 0"),
    ("WorldBegin\nTexture \"t\" \"colour\" \"constant\"", 2, 13, "unknown texture type"),
    ("WorldBegin\nTexture \"t\" \"float\" \"checker\"", 2, 21, "unknown texture 'checker'"),
    ("WorldBegin\nTexture \"t\" \"float\" \"marble\"", 2, 21, "no 'marble' texture of type float"),
    ("WorldBegin\nTexture \"t\" \"float\" \"imagemap\"", 2, 21, "needs \"string filename\""),
    ("WorldBegin\nTexture \"t\" \"float\" \"imagemap\" \"string filename\" \"gone.png\"", 2, 50, "cannot find"),
    ("WorldBegin\nTexture \"t\" \"float\" \"checkerboard\" \"integer dimension\" 4", 2, 56, "2 or 3 dimensions"),
    ("WorldBegin\nTexture \"t\" \"float\" \"dots\" \"string mapping\" \"cubic\"", 2, 45, "cannot be 'cubic'"),
    ("WorldBegin\nScale 0 0 0 Texture \"t\" \"float\" \"fbm\"", 2, 33, "cannot be inverted"),
    ("WorldBegin\nMakeNamedMedium \"m\" \"string type\" \"uniformgrid\" \"integer nx\" 2000000000 \"integer ny\" 2000000000 \"float density\" [1]", 2, 113, "found 1"),
    ("WorldBegin\nMakeNamedMedium \"m\" \"string type\" \"homogeneous\" \"float g\" 2", 2, 59, "within [-1, 1]"),
    ("WorldBegin\nMakeNamedMedium \"m\" \"string type\" \"homogeneous\" \"string preset\" \"Milk\"", 2, 65, "unknown medium preset"),
    // Shapes.
    ("WorldBegin\nShape \"nurbs\"", 2, 7, "unknown shape 'nurbs'"),
    ("WorldBegin\nShape \"plymesh\"", 2, 7, "needs \"string filename\""),
    ("WorldBegin\nShape \"trianglemesh\"", 2, 7, "needs \"point3 P\""),
    ("WorldBegin\nShape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 1 1 0 0 1 0]", 2, 7, "needs \"integer indices\""),
    ("WorldBegin\nShape \"trianglemesh\" \"point3 P\" [0 0 0 1 0]", 2, 33, "not a multiple of 3"),
    ("WorldBegin\nShape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 1 1 0] \"integer indices\" [0 1 3]", 2, 71, "index 3 is outside"),
    ("WorldBegin\nShape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 1 1 0] \"integer indices\" [0 1 -1]", 2, 71, "index -1 is outside"),
    ("WorldBegin\nShape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 1 1 0] \"integer indices\" [0 1 4000000000]", 2, 76, "does not fit"),
    ("WorldBegin\nShape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 1 1e60 0]", 2, 33, "not a finite number"),
    ("WorldBegin\nShape \"loopsubdiv\" \"point3 P\" [0 0 0 1 0 0 1 1 0]", 2, 7, "needs \"integer indices\""),
    ("WorldBegin\nShape \"curve\" \"point3 P\" [0 0 0 1 0 0 1 1 0]", 2, 26, "3 control points"),
    ("WorldBegin\nShape \"curve\" \"point3 P\" [0 0 0 1 0 0 1 1 0 2 2 2 3 3 3]", 2, 26, "5 control points"),
    ("WorldBegin\nShape \"curve\" \"integer degree\" 4 \"point3 P\" [0 0 0]", 2, 32, "degree 2 or 3"),
    ("WorldBegin\nShape \"curve\" \"string type\" \"ribbon\" \"point3 P\" [0 0 0 1 0 0 1 1 0 2 2 2]", 2, 7, "needs \"normal N\""),
];

#[test]
fn faults_are_located() {
    let mut wrong = String::new();
    for &(text, line, column, part) in CASES {
        let import = load(text);
        let found = errors(&import).first().map(|d| {
            let at = d.location.as_ref().map(|l| (l.line, l.column));
            (at == Some((line, column)) && d.message.contains(part), d.to_string())
        });
        match found {
            Some((true, _)) => {}
            Some((false, message)) => wrong += &format!("\n{text}\n{message}\n"),
            None => wrong += &format!("\n{text}\nno error\n"),
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}

#[test]
fn one_fault_gives_one_error() {
    for &(text, ..) in CASES {
        let import = load(text);
        let all: Vec<String> = errors(&import).iter().map(ToString::to_string).collect();
        // Where a block is cut short, what should close it is missing too.
        let most =
            if text.contains("ObjectBegin") || text.contains("Camera") || text.contains("[1 Shape") { 2 } else { 1 };
        assert!(all.len() <= most, "{text}\n{}", all.join("\n"));
    }
}

#[test]
fn every_fault_is_found_in_one_pass() {
    let text = "Camera \"perspctive\" WorldBegin Shape \"spehre\" Material \"difuse\" LightSource \"piont\" Bogus 1 2 \"x\" [3] Shape \"sphere\"";
    let import = load(text);
    let helps: Vec<_> = errors(&import).iter().filter_map(|d| d.help.as_deref()).collect();
    for name in ["perspective", "sphere", "diffuse", "point"] {
        assert!(helps.contains(&format!("did you mean '{name}'?").as_str()), "{name}: {helps:?}");
    }
    assert_eq!(errors(&import).len(), 5);
    assert_eq!(import.desc.shapes.len(), 1, "reading goes on");
}

#[test]
fn parameters_that_nothing_reads_are_reported() {
    for (text, message, help) in [
        ("Shape \"sphere\" \"float raduis\" 2", "shape 'sphere' has no parameter 'raduis'", "radius"),
        (
            "Material \"diffuse\" \"rgb reflectence\" [1 1 1]",
            "material 'diffuse' has no parameter 'reflectence'",
            "reflectance",
        ),
        ("LightSource \"point\" \"float scal\" 2", "light 'point' has no parameter 'scal'", "scale"),
        (
            "Texture \"t\" \"float\" \"constant\" \"float vlaue\" 2",
            "texture 'constant' has no parameter 'vlaue'",
            "value",
        ),
        (
            "MakeNamedMedium \"m\" \"string type\" \"homogeneous\" \"float scael\" 2",
            "medium 'm' has no parameter 'scael'",
            "scale",
        ),
    ] {
        let import = load(&format!("WorldBegin {text}"));
        let all: Vec<_> = import.diagnostics.iter().collect();
        assert_eq!(all.len(), 1, "{text}: {all:?}");
        assert_eq!((all[0].message.as_str(), all[0].severity), (message, Severity::Warning));
        assert_eq!(all[0].help, Some(format!("did you mean '{help}'?")));
    }
    assert!(load("WorldBegin Attribute \"shape\" \"float bogus\" 1 Shape \"sphere\"").diagnostics.is_empty());
}

#[test]
fn warnings_do_not_stop_a_scene() {
    for text in [
        "Camera \"perspective\" Camera \"perspective\" WorldBegin",
        "WorldBegin Shape \"sphere\" \"float radius\" 1 \"float radius\" 2",
        "WorldBegin Material \"diffuse\" \"rgb reflectance\" [1 2 1] Shape \"sphere\"",
        "WorldBegin Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 1 1 0] \"point2 uv\" [0 0]",
        "WorldBegin Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 1 1 0] \"integer indices\" [0 1 2 0]",
        "Film \"rgb\" \"integer pixelbounds\" [0 5000 0 5] WorldBegin",
        "Integrator \"randomwalk\" WorldBegin",
        "Integrator \"path\" \"bool regularize\" true WorldBegin",
        "Integrator \"path\" WorldBegin MakeNamedMedium \"m\" \"string type\" \"homogeneous\" MediumInterface \"m\" \"\" Shape \"sphere\"",
        "ColorSpace \"rec2020\" Film \"rgb\" WorldBegin",
    ] {
        let import = load(text);
        assert!(!import.diagnostics.has_errors(), "{text}: {:?}", import.diagnostics);
        assert_eq!(import.diagnostics.iter().count(), 1, "{text}: {:?}", import.diagnostics);
    }
}

#[test]
fn a_scene_without_a_world_is_refused() {
    assert_eq!(errors(&load(""))[0].message, "the scene has no WorldBegin");
    assert!(errors(&load("\u{0}\u{1}")).len() >= 2);
    let utf16: Vec<u8> = [0xff, 0xfe].into_iter().chain("WorldBegin".bytes().flat_map(|b| [b, 0])).collect();
    let import = import_text("s", utf16, Path::new("."), &Options::default());
    assert!(errors(&import)[0].message.contains("UTF-16"));
}
