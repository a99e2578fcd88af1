//! pbrt scenes: faults of the text, and numbers that no scene should hold.

use crate::case::{Case, Expect, PBRT_HEAD, PBRT_SKY, POISON};
use Expect::{Either, Picture, Refused, Warned};

/// Faults of syntax and structure: the message names the fault, its place, and what to do.
pub fn syntax() -> Vec<Case> {
    [words(), whole_files(), missing_files(), references()].into_iter().flatten().collect()
}

/// Unknown words, and values and blocks that do not fit.
fn words() -> Vec<Case> {
    let c = Case::pbrt;
    vec![
        c("sound", "Shape \"sphere\"", Picture),
        c("unknown directive", "Shpe \"sphere\"", Refused("did you mean 'Shape'")),
        c("place of the fault", "\n  Shpe \"sphere\"", Refused("s.pbrt:8:3")),
        c("unknown shape", "Shape \"spere\"", Refused("did you mean 'sphere'")),
        c("unknown material", "Material \"difuse\" Shape \"sphere\"", Refused("did you mean 'diffuse'")),
        c("unknown light", "LightSource \"infinit\"", Refused("did you mean 'infinite'")),
        c("unknown texture", "Texture \"t\" \"spectrum\" \"imagmap\"", Refused("did you mean 'imagemap'")),
        c("unknown parameter", "Shape \"sphere\" \"float radus\" 1", Warned("did you mean 'radius'")),
        c("unknown type", "Shape \"sphere\" \"flot radius\" 1", Refused("flot")),
        c("unknown named material", "NamedMaterial \"a\" Shape \"sphere\"", Refused("'a'")),
        c(
            "unknown texture name",
            "Material \"diffuse\" \"texture reflectance\" \"t\" Shape \"sphere\"",
            Refused("'t'"),
        ),
        c("unknown object", "ObjectInstance \"o\"", Refused("'o'")),
        c("unknown coordinate system", "CoordSysTransform \"x\" Shape \"sphere\"", Either),
        c("unbalanced end", "AttributeEnd Shape \"sphere\"", Refused("AttributeEnd")),
        c("unclosed block", "AttributeBegin Shape \"sphere\"", Either),
        c("unclosed string", "Shape \"sphere", Refused("s.pbrt:")),
        c("unclosed list", "Shape \"sphere\" \"float radius\" [ 1", Refused("s.pbrt:")),
        c("missing value", "Shape \"sphere\" \"float radius\"", Refused("radius")),
        c("two values for one", "Shape \"sphere\" \"float radius\" [1 2]", Either),
        c("empty list", "Shape \"sphere\" \"float radius\" []", Either),
        c("string for a number", "Shape \"sphere\" \"float radius\" \"one\"", Refused("radius")),
        c("number for a string", "Shape 1", Refused("s.pbrt:")),
        c("words", "lorem ipsum dolor sit amet", Refused("lorem")),
        c("camera in the world", "Camera \"perspective\"", Refused("Camera")),
        c("errors come together", "Shape \"a1\"\nMaterial \"b2\"\nLightSource \"c3\"", Refused("a1")),
        c("errors come together, last", "Shape \"a1\"\nMaterial \"b2\"\nLightSource \"c3\"", Refused("c3")),
    ]
}

/// Files that are no scenes.
fn whole_files() -> Vec<Case> {
    let raw = |name: &str, text: &[u8], expect| Case::new(name, "s.pbrt", text, expect);
    vec![
        raw("empty file", b"", Refused("")),
        raw(
            "no camera",
            b"Film \"rgb\" \"integer xresolution\" 16 \"integer yresolution\" 16 WorldBegin Shape \"sphere\"",
            Either,
        ),
        raw("no world", PBRT_HEAD.as_bytes(), Either),
        raw("zeros", &[0; 4096], Refused("")),
        raw("ones", &[0xff; 4096], Refused("")),
        raw("cut-off gzip", &[0x1f, 0x8b, 8, 0, 0, 0, 0], Refused("cannot read")),
        raw("byte order mark", format!("\u{feff}{PBRT_HEAD}WorldBegin {PBRT_SKY}").as_bytes(), Either),
        raw("carriage returns", format!("{PBRT_HEAD}WorldBegin {PBRT_SKY}").replace('\n', "\r").as_bytes(), Either),
    ]
}

/// Names of files that are not there.
fn missing_files() -> Vec<Case> {
    let c = Case::pbrt;
    vec![
        c("missing include", "Include \"not-there.pbrt\"", Refused("not-there.pbrt' (searched '")),
        c("missing import", "Import \"not-there.pbrt\"", Refused("not-there.pbrt' (searched '")),
        c("missing mesh", "Shape \"plymesh\" \"string filename\" \"no.ply\"", Refused("no.ply' (searched '")),
        c(
            "missing image",
            "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"no.png\"\nMaterial \"diffuse\" \"texture reflectance\" \"t\"\nShape \"sphere\"",
            Refused("no.png' (searched '"),
        ),
        c(
            "missing environment",
            "LightSource \"infinite\" \"string filename\" \"no.exr\"",
            Refused("no.exr' (searched '"),
        ),
        c("missing spectrum", "Material \"conductor\" \"spectrum eta\" \"no.spd\" Shape \"sphere\"", Refused("no.spd")),
        c("a folder for a mesh", "Shape \"plymesh\" \"string filename\" \".\"", Refused("'.'")),
    ]
}

/// References to itself, or to nothing.
fn references() -> Vec<Case> {
    let c = Case::pbrt;
    vec![
        c("include of itself", "Include \"s.pbrt\"", Refused("")),
        c("include cycle", "Include \"a.pbrt\"", Refused(""))
            .with("a.pbrt", "Include \"b.pbrt\"")
            .with("b.pbrt", "Include \"a.pbrt\""),
        c("import cycle", "Import \"a.pbrt\"", Refused("")).with("a.pbrt", "Import \"a.pbrt\""),
        c(
            "texture of itself",
            "Texture \"t\" \"float\" \"scale\" \"texture tex\" \"t\"\nMaterial \"diffuse\" \"texture reflectance\" \"t\" Shape \"sphere\"",
            Refused("'t'"),
        ),
        c(
            "texture cycle",
            "Texture \"a\" \"spectrum\" \"scale\" \"texture tex\" \"b\"\nTexture \"b\" \"spectrum\" \"scale\" \"texture tex\" \"a\"\nMaterial \"diffuse\" \"texture reflectance\" \"b\" Shape \"sphere\"",
            Either,
        ),
        c(
            "material cycle",
            "MakeNamedMaterial \"a\" \"string type\" \"mix\" \"string materials\" [\"a\" \"b\"]\nMakeNamedMaterial \"b\" \"string type\" \"mix\" \"string materials\" [\"b\" \"a\"]\nNamedMaterial \"a\" Shape \"sphere\"",
            Refused(""),
        ),
        c(
            "object in itself",
            "ObjectBegin \"o\" Shape \"sphere\" ObjectInstance \"o\" ObjectEnd ObjectInstance \"o\"",
            Refused("ObjectInstance"),
        ),
        c("object in an object", "ObjectBegin \"o\" ObjectBegin \"p\" ObjectEnd ObjectEnd", Refused("ObjectBegin")),
        c("unclosed object", "ObjectBegin \"o\" Shape \"sphere\"", Refused("")),
        c("empty object", "ObjectBegin \"o\" ObjectEnd ObjectInstance \"o\"", Either),
        c(
            "object of nothing visible",
            "ObjectBegin \"o\" Shape \"trianglemesh\" \"point3 P\" [0 0 0 0 0 0 0 0 0] ObjectEnd ObjectInstance \"o\"",
            Either,
        ),
        c("medium that is not there", "MediumInterface \"fog\" \"\" Shape \"sphere\"", Refused("fog")),
        c(
            "spectrum by an unknown name",
            "Material \"conductor\" \"spectrum eta\" \"metal-Xx-eta\" Shape \"sphere\"",
            Refused("metal-Xx-eta"),
        ),
    ]
}

/// Directives whose numbers (`@`) are poisoned one after the other.
const WORLDS: [&str; 62] = [
    "Translate @ 0 0 Shape \"sphere\"",
    "Scale @ 1 1 Shape \"sphere\"",
    "Scale @ @ @ Shape \"sphere\"",
    "Rotate @ 0 1 0 Shape \"sphere\"",
    "Rotate 30 @ 0 0 Shape \"sphere\"",
    "LookAt @ 0 0 0 0 1 0 1 0 Shape \"sphere\"",
    "Transform [@ 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1] Shape \"sphere\"",
    "Transform [1 0 0 @ 0 1 0 0 0 0 1 0 0 0 0 1] Shape \"sphere\"",
    "ConcatTransform [1 0 0 0 0 1 0 0 0 0 1 0 @ 0 0 1] Shape \"sphere\"",
    "Shape \"sphere\" \"float radius\" @",
    "Shape \"sphere\" \"float zmin\" @",
    "Shape \"sphere\" \"float zmax\" @",
    "Shape \"sphere\" \"float phimax\" @",
    "Shape \"sphere\" \"float alpha\" @",
    "Shape \"disk\" \"float radius\" @",
    "Shape \"disk\" \"float innerradius\" @",
    "Shape \"disk\" \"float height\" @",
    "Shape \"disk\" \"float phimax\" @",
    "Shape \"cylinder\" \"float radius\" @",
    "Shape \"cylinder\" \"float zmin\" @",
    "Shape \"cylinder\" \"float zmax\" @",
    "Shape \"trianglemesh\" \"point3 P\" [-1 -1 0 1 -1 0 @ 1 0]",
    "Shape \"trianglemesh\" \"point3 P\" [@ @ 0 @ -1 0 0 1 0]",
    "Shape \"trianglemesh\" \"point3 P\" [-1 -1 0 1 -1 0 0 1 0] \"normal N\" [0 0 1 0 @ 1 0 0 1]",
    "Shape \"trianglemesh\" \"point3 P\" [-1 -1 0 1 -1 0 0 1 0] \"point2 uv\" [0 0 @ 0 0 1]",
    "Shape \"trianglemesh\" \"point3 P\" [-1 -1 0 1 -1 0 0 1 0] \"integer indices\" [0 1 @]",
    "Shape \"bilinearmesh\" \"point3 P\" [-1 -1 0 1 -1 0 -1 1 @ 1 1 0.5]",
    "Shape \"bilinearmesh\" \"point3 P\" [-1 -1 0 1 -1 0 -1 1 1 1 1 0.5] \"integer indices\" [0 1 2 @]",
    "Shape \"loopsubdiv\" \"integer levels\" @ \"point3 P\" [-1 -1 0 1 -1 0 0 1 0 0 0 1] \"integer indices\" [0 1 2 0 1 3 1 2 3 2 0 3]",
    "Shape \"loopsubdiv\" \"point3 P\" [-1 -1 0 1 @ 0 0 1 0 0 0 1] \"integer indices\" [0 1 2 0 1 3 1 2 3 2 0 3]",
    "Shape \"curve\" \"point3 P\" [-1 0 0 -0.5 @ 0 0.5 1 0 1 0 0] \"float width\" 0.2",
    "Shape \"curve\" \"point3 P\" [-1 0 0 -0.5 1 0 0.5 1 0 1 0 0] \"float width\" @",
    "Shape \"curve\" \"point3 P\" [-1 0 0 -0.5 1 0 0.5 1 0 1 0 0] \"float width0\" @ \"string type\" \"ribbon\" \"normal N\" [0 0 1 0 @ 1]",
    "Shape \"curve\" \"integer degree\" @ \"point3 P\" [-1 0 0 -0.5 1 0 0.5 1 0 1 0 0]",
    "LightSource \"point\" \"point3 from\" [0 @ 0] \"rgb I\" [1 1 1] Shape \"sphere\"",
    "LightSource \"point\" \"rgb I\" [@ 1 1] Shape \"sphere\"",
    "LightSource \"point\" \"float scale\" @ \"float power\" @ Shape \"sphere\"",
    "LightSource \"point\" \"blackbody I\" @ Shape \"sphere\"",
    "LightSource \"point\" \"spectrum I\" [400 1 @ 2] Shape \"sphere\"",
    "LightSource \"point\" \"spectrum I\" [400 1 500 @] Shape \"sphere\"",
    "LightSource \"spot\" \"point3 to\" [0 0 @] \"point3 from\" [0 0 0] Shape \"sphere\"",
    "LightSource \"spot\" \"float coneangle\" @ \"float conedeltaangle\" 5 Shape \"sphere\"",
    "LightSource \"spot\" \"float conedeltaangle\" @ Shape \"sphere\"",
    "LightSource \"distant\" \"point3 from\" [0 0 @] \"point3 to\" [0 0 0] Shape \"sphere\"",
    "LightSource \"distant\" \"rgb L\" [1 1 1] \"float illuminance\" @ Shape \"sphere\"",
    "LightSource \"infinite\" \"rgb L\" [1 @ 1] Shape \"sphere\"",
    "LightSource \"infinite\" \"float scale\" @ \"float illuminance\" @ Shape \"sphere\"",
    "LightSource \"infinite\" \"rgb L\" [1 1 1] \"point3 portal\" [-1 -1 @ 1 -1 1 1 1 1 -1 1 1] Shape \"sphere\"",
    "AreaLightSource \"diffuse\" \"rgb L\" [@ 1 1] Shape \"sphere\"",
    "AreaLightSource \"diffuse\" \"float scale\" @ Shape \"disk\"",
    "AreaLightSource \"diffuse\" \"float power\" @ Shape \"disk\"",
    "AreaLightSource \"diffuse\" Shape \"trianglemesh\" \"point3 P\" [-1 -1 0 1 -1 0 @ 1 0]",
    "AreaLightSource \"diffuse\" Shape \"sphere\" \"float radius\" @",
    "Scale @ 2 1 AreaLightSource \"diffuse\" Shape \"sphere\"",
    "MakeNamedMedium \"m\" \"string type\" \"homogeneous\" \"rgb sigma_a\" [@ 1 1] MediumInterface \"m\" \"\" Material \"interface\" Shape \"sphere\"",
    "MakeNamedMedium \"m\" \"string type\" \"homogeneous\" \"float scale\" @ MediumInterface \"m\" \"\" Material \"interface\" Shape \"sphere\"",
    "MakeNamedMedium \"m\" \"string type\" \"homogeneous\" \"float g\" @ MediumInterface \"m\" \"\" Material \"interface\" Shape \"sphere\"",
    "Texture \"t\" \"float\" \"constant\" \"float value\" @ Material \"diffuse\" Shape \"sphere\" \"texture alpha\" \"t\"",
    "Texture \"t\" \"spectrum\" \"checkerboard\" \"float uscale\" @ \"float vdelta\" @ Material \"diffuse\" \"texture reflectance\" \"t\" Shape \"sphere\"",
    "Texture \"t\" \"spectrum\" \"scale\" \"float scale\" @ \"rgb tex\" [1 1 @] Material \"diffuse\" \"texture reflectance\" \"t\" Shape \"sphere\"",
    "Texture \"t\" \"spectrum\" \"mix\" \"float amount\" @ Material \"diffuse\" \"texture reflectance\" \"t\" Shape \"sphere\"",
    "Texture \"t\" \"spectrum\" \"checkerboard\" \"integer dimension\" @ Material \"diffuse\" \"texture reflectance\" \"t\" Shape \"sphere\"",
];

/// Directives before `WorldBegin` whose numbers (`@`) are poisoned one after the other.
const HEADS: [&str; 30] = [
    "LookAt @ 0 0 0 0 0 0 1 0 Camera \"perspective\"",
    "LookAt 0 0 -5 0 0 @ 0 1 0 Camera \"perspective\"",
    "LookAt 0 0 -5 0 0 0 0 @ 0 Camera \"perspective\"",
    "Camera \"perspective\" \"float fov\" @",
    "Camera \"perspective\" \"float lensradius\" @",
    "Camera \"perspective\" \"float lensradius\" 0.1 \"float focaldistance\" @",
    "Camera \"perspective\" \"float frameaspectratio\" @",
    "Camera \"perspective\" \"float screenwindow\" [-1 @ -1 1]",
    "Camera \"perspective\" \"float shutteropen\" @",
    "Camera \"orthographic\" \"float screenwindow\" [-1 1 @ 1]",
    "Camera \"orthographic\" \"float lensradius\" @",
    "Camera \"spherical\" \"float shutterclose\" @",
    "Film \"rgb\" \"integer xresolution\" @ \"integer yresolution\" 4",
    "Film \"rgb\" \"integer xresolution\" [16] \"integer yresolution\" [16] \"float cropwindow\" [0 @ 0 1]",
    "Film \"rgb\" \"integer xresolution\" [16] \"integer yresolution\" [16] \"integer pixelbounds\" [0 @ 0 16]",
    "Film \"rgb\" \"integer xresolution\" [16] \"integer yresolution\" [16] \"float iso\" @",
    "Film \"rgb\" \"integer xresolution\" [16] \"integer yresolution\" [16] \"float maxcomponentvalue\" @",
    "Film \"rgb\" \"integer xresolution\" [16] \"integer yresolution\" [16] \"float diagonal\" @",
    "Film \"rgb\" \"integer xresolution\" [16] \"integer yresolution\" [16] \"float whitebalance\" @ \"string sensor\" \"canon_eos_100d\"",
    "Film \"spectral\" \"integer xresolution\" [16] \"integer yresolution\" [16] \"integer nbuckets\" @",
    "PixelFilter \"gaussian\" \"float xradius\" @",
    "PixelFilter \"gaussian\" \"float sigma\" @",
    "PixelFilter \"mitchell\" \"float B\" @ \"float C\" @",
    "PixelFilter \"sinc\" \"float tau\" @",
    "PixelFilter \"triangle\" \"float yradius\" @",
    "Sampler \"halton\" \"integer pixelsamples\" @",
    "Sampler \"stratified\" \"integer xsamples\" @ \"integer ysamples\" @",
    "Integrator \"path\" \"integer maxdepth\" @",
    "Integrator \"volpath\" \"float regularize\" @",
    "Option \"integer seed\" @",
];

/// Poisoned numbers: errors, or a finite picture.
pub fn numbers() -> Vec<Case> {
    let world = WORLDS.iter().flat_map(|t| POISON.iter().map(move |p| (t, p, true)));
    let head = HEADS.iter().flat_map(|t| POISON.iter().map(move |p| (t, p, false)));
    let case = |(template, poison, world): (&&str, &&str, bool)| {
        let text = template.replace('@', poison);
        let expect = Expect::of_number(poison);
        if world { Case::pbrt(text.clone(), text, expect) } else { Case::pbrt_head(text.clone(), text, expect) }
    };
    world.chain(head).map(case).collect()
}
