//! Every parameter of every kind is followed or told.

use super::*;
use crate::law::{Asked, Reading, asked, judge, outcome};
use crate::pbrt::{camera, film, light, material, medium, option, sampling, shape, texture};

/// A directive for every kind of a family, in a scene around it.
struct Stage {
    before: String,
    after: &'static str,
    kind: String,
    needs: Vec<(&'static str, &'static str)>,
}

const QUAD: &str = "[0 0 0 1 0 0 0 1 0 1 1 0]";

/// The parameters that a kind cannot do without.
fn needs(kind: &str) -> Vec<(&'static str, &'static str)> {
    match kind {
        "realistic" => vec![("string lensfile", "\"f\"")],
        "goniometric" | "projection" | "imagemap" | "ptex" | "nanovdb" | "measured" => {
            vec![("string filename", "\"f\"")]
        }
        "plymesh" => vec![("string filename", "\"m.ply\"")],
        "trianglemesh" | "loopsubdiv" => vec![("point3 P", QUAD), ("integer indices", "[0 1 2]")],
        "bilinearmesh" | "curve" => vec![("point3 P", QUAD)],
        "heightfield" => vec![("integer nu", "2"), ("integer nv", "2"), ("float Pz", "[0 1 2 3]")],
        "mix-material" => vec![("string materials", "[\"a\" \"b\"]")],
        "uniformgrid" => {
            vec![("float density", "[1 2]"), ("integer nx", "2"), ("integer ny", "1"), ("integer nz", "1")]
        }
        "rgbgrid" => {
            vec![("rgb sigma_a", "[1 1 1 .5 .5 .5]"), ("integer nx", "2"), ("integer ny", "1"), ("integer nz", "1")]
        }
        _ => Vec::new(),
    }
}

fn stages() -> Vec<Stage> {
    const WORLD: &str = "WorldBegin\nTexture \"t\" \"float\" \"constant\" \"float value\" .3\n\
         Texture \"t\" \"spectrum\" \"constant\"\nMakeNamedMaterial \"a\" \"string type\" \"diffuse\"\n\
         MakeNamedMaterial \"b\" \"string type\" \"conductor\"\n";
    let mut all = Vec::new();
    let mut add = |before: &str, kinds: &[&str], after: &'static str| {
        for &kind in kinds {
            let needed = if kind == "mix" && before.ends_with("Material") { "mix-material" } else { kind };
            all.push(Stage { before: before.into(), after, kind: kind.into(), needs: needs(needed) });
        }
    };
    let world = |directive: &str| format!("{WORLD}{directive}");
    add("Camera", &camera::KINDS, "WorldBegin");
    add("Film", &film::FILMS, "WorldBegin");
    add("PixelFilter", &film::FILTERS.map(|f| f.0), "WorldBegin");
    add("Sampler", &sampling::SAMPLERS, "WorldBegin");
    add("Integrator", &sampling::INTEGRATORS, "WorldBegin");
    add("Accelerator", &sampling::ACCELERATORS.map(|a| a.0), "WorldBegin");
    add(&world("LightSource"), &light::KINDS, "");
    add(&world("AreaLightSource"), &["diffuse"], "Shape \"sphere\"");
    add(&world("Shape"), &shape::KINDS, "");
    add(&world("Material"), &material::KINDS, "Shape \"sphere\"");
    add(
        &world("Texture \"x\" \"float\""),
        &texture::CLASSES,
        "Material \"diffuse\" \"texture displacement\" \"x\" Shape \"sphere\"",
    );
    add(
        &world("Texture \"x\" \"spectrum\""),
        &texture::CLASSES,
        "Material \"diffuse\" \"texture reflectance\" \"x\" Shape \"sphere\"",
    );
    for kind in medium::KINDS {
        let after = "MediumInterface \"m\" \"\" Material \"interface\" Shape \"sphere\"";
        let before = world("MakeNamedMedium \"m\" \"string type\"");
        all.push(Stage { before, after, kind: kind.into(), needs: needs(kind) });
    }
    all
}

/// Values of a type, of which some are of use.
fn values(ty: &str) -> &'static [&'static str] {
    match ty {
        "bool" => &["true", "false"],
        "integer" => &["3", "2", "1", "0", "[0 1 2]", "[1 2 3]", "[0 1 2 3]", "[1 2 0 1]", "[7]"],
        "float" => &[
            ".37",
            "2.5",
            "7",
            "0",
            "[.25 .75]",
            "[3 4]",
            "[.1 .2 .3 .4]",
            "[0 .5 0 .5]",
            "[.9 .8 .7 .6]",
            "[.1 .2 .3]",
            "[1 0 0 1]",
            "[1 0 0 0 0 1 0 0 0 0 1 0 2 0 0 1]",
            "4000",
        ],
        "point2" | "vector2" => &["[.5 .25]", "[0 0 .5 0 0 .5]", "[0 0 .5 0 0 .5 .5 .5]"],
        "point3" | "vector3" | "normal" => &[
            "[.1 .2 .3]",
            "[0 0 1]",
            "[0 1 0]",
            "[0 0 1 0 0 1 0 1 1]",
            "[0 0 1 0 0 1 0 1 1 0 1 1]",
            "[0 0 0 2 0 0 0 2 0 3 3 1]",
            "[0 0 1 0 1 1]",
        ],
        "texture" => &["\"t\""],
        "spectrum" => &["\"metal-Ag-k\"", "\"glass-BK7\"", "[400 .2 700 .9]", "\"stdillum-A\""],
        "rgb" => &["[.2 .5 .7]", "[.2 .5 .7 .1 .2 .3]"],
        "blackbody" => &["3000"],
        _ => &[
            "\"f\"",
            "\"n.ply\"",
            "\"m.ply\"",
            "\"repeat\"",
            "\"clamp\"",
            "\"black\"",
            "\"bilinear\"",
            "\"point\"",
            "\"ewa\"",
            "\"linear\"",
            "\"sRGB\"",
            "\"gamma 2\"",
            "\"planar\"",
            "\"spherical\"",
            "\"cylindrical\"",
            "\"3d\"",
            "\"bspline\"",
            "\"ribbon\"",
            "\"cylinder\"",
            "\"flat\"",
            "\"world\"",
            "\"camera\"",
            "\"equirectangular\"",
            "\"equalarea\"",
            "\"canon_eos_100d\"",
            "\"square\"",
            "\"uniform\"",
            "\"power\"",
            "\"bvh\"",
            "\"none\"",
            "\"fastowen\"",
            "\"Skin1\"",
            "\"beckmann\"",
            "[\"b\" \"a\"]",
            "\"a\"",
            "\"owen\"",
        ],
    }
}

/// A scene with parameters of the directive under test; later ones of a name take the place of earlier ones.
fn reading(folder: &Path, stage: &Stage, given: &[(&str, &str)]) -> Reading {
    let mut list: Vec<(&str, &str)> = Vec::new();
    for &(declared, value) in stage.needs.iter().chain(given) {
        list.retain(|(d, _)| d.split(' ').nth(1) != declared.split(' ').nth(1));
        list.push((declared, value));
    }
    let list: String = list.iter().map(|(declared, value)| format!(" \"{declared}\" {value}")).collect();
    let Stage { before, after, kind, .. } = stage;
    Reading::of(&load_in(folder, &format!("{before} \"{kind}\"{list}\n{after}")))
}

/// The declarations and values that a parameter may have.
fn candidates(asked: &Asked) -> Vec<(String, &'static str)> {
    let all = asked.types.iter().flat_map(|ty| values(ty).iter().map(move |value| (*ty, *value)));
    all.map(|(ty, value)| (format!("{ty} {}", asked.name), value)).collect()
}

#[test]
fn every_parameter_is_followed_or_told() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("f"), "35.98738 1.21638 1.54 23.716\n0 9.9 0 8\n-20 4 1.5 20\n").unwrap();
    let header = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
                  element face 1\nproperty list uchar int vertex_indices\nend_header\n";
    for (name, x) in [("m.ply", 1), ("n.ply", 2)] {
        let text = format!("{header}0 0 0\n{x} 0 0\n0 1 0\n3 0 1 2\n");
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    let mut all = Vec::new();
    for stage in stages() {
        asked();
        let plain = reading(folder.path(), &stage, &[]);
        // There are no textures of numbers of some classes.
        if plain.is_refused && ["there is no '", "not supported"].iter().any(|m| plain.messages().contains(m)) {
            continue;
        }
        assert!(!plain.is_refused, "{} {}: {}", stage.before, stage.kind, plain.messages());
        let mut parameters: Vec<(String, Vec<(String, &'static str)>)> = Vec::new();
        for parameter in asked().iter().filter(|a| a.of == stage.kind) {
            // A parameter of several types is asked for by each.
            match parameters.iter_mut().find(|(name, _)| *name == parameter.name) {
                Some((_, values)) => values.extend(candidates(parameter)),
                None => parameters.push((parameter.name.to_owned(), candidates(parameter))),
            }
        }
        let read = |given: &[(String, &'static str)]| {
            let given: Vec<(&str, &str)> = given.iter().map(|(d, v)| (d.as_str(), *v)).collect();
            reading(folder.path(), &stage, &given)
        };
        let directive = stage.before.lines().last().unwrap_or_default();
        for ((name, _), of) in parameters.iter().zip(crate::law::outcomes(&parameters, read)) {
            all.push((format!("{directive} {}: {name}", stage.kind), of));
        }
    }
    let displaced = "WorldBegin Shape \"plymesh\" \"string filename\" \"m.ply\" \"float displacement\" 1";
    let options = |options: &str| Reading::of(&load_in(folder.path(), &format!("{options}\n{displaced}")));
    for name in option::KNOWN {
        let with = ["true", "7", "\"f\""].map(|value| options(&format!("Option \"{name}\" {value}")));
        all.push((format!("Option {name}"), outcome(name, &options(""), with)));
    }
    judge(&all, 300);
}
