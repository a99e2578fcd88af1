//! Every parameter of every plugin is followed or told.

use super::*;
use crate::law::{Reading, asked, judge};
use crate::mitsuba::{graph::Category, plugins};
use std::collections::BTreeSet;

/// A plugin in a scene around it: `@` stands for its element.
struct Stage {
    tag: &'static str,
    around: &'static str,
    plugin: &'static str,
    needs: Vec<(&'static str, &'static str)>,
}

const DIFFUSE: (&str, &str) = ("", "<bsdf type=\"diffuse\"/>");

/// The properties that a plugin cannot do without: names and elements.
fn needs(category: Category, plugin: &str) -> Vec<(&'static str, &'static str)> {
    let file = ("filename", "<string name=\"filename\" value=\"f\"/>");
    let other = ("", "<bsdf type=\"conductor\"/>");
    match (category, plugin) {
        (Category::Bsdf, "twosided" | "mask" | "coating" | "roughcoating") => vec![DIFFUSE],
        (Category::Bsdf, "bumpmap") => vec![DIFFUSE, ("", "<texture type=\"checkerboard\"/>")],
        (Category::Bsdf, "normalmap") => {
            vec![DIFFUSE, ("normalmap", "<texture name=\"normalmap\" type=\"checkerboard\"/>")]
        }
        (Category::Bsdf, "blendbsdf") => vec![DIFFUSE, other, ("weight", "<float name=\"weight\" value=\".3\"/>")],
        (Category::Bsdf, "mixturebsdf") => {
            vec![DIFFUSE, other, ("weights", "<string name=\"weights\" value=\".3, .7\"/>")]
        }
        (Category::Shape, "obj") => vec![("filename", "<string name=\"filename\" value=\"m.obj\"/>")],
        (Category::Shape, "ply") => vec![("filename", "<string name=\"filename\" value=\"m.ply\"/>")],
        (Category::Shape, "bsplinecurve" | "linearcurve") => {
            vec![("filename", "<string name=\"filename\" value=\"curve.txt\"/>")]
        }
        (Category::Sensor, "radiancemeter") => vec![
            ("origin", "<point name=\"origin\" x=\"0\" y=\"0\" z=\"3\"/>"),
            ("direction", "<vector name=\"direction\" x=\"0\" y=\"0\" z=\"-1\"/>"),
        ],
        (Category::Sensor, "thinlens") => {
            vec![("aperture_radius", "<float name=\"aperture_radius\" value=\".1\"/>")]
        }
        (Category::Film, "specfilm") => vec![("", "<spectrum name=\"green\" value=\"500:1, 600:1\"/>")],
        (Category::Texture, "blackbody") => vec![("temperature", "<float name=\"temperature\" value=\"3000\"/>")],
        (Category::Shape, "instance") => vec![("", "<shape type=\"shapegroup\"><shape type=\"sphere\"/></shape>")],
        (Category::Shape, "merge" | "shapegroup") => vec![("", "<shape type=\"sphere\"/>")],
        (Category::Shape, "sdfgrid" | "heightfield")
        | (Category::Bsdf, "measured" | "measured_polarized")
        | (Category::Texture, "bitmap")
        | (Category::Emitter, "envmap")
        | (Category::Volume, "gridvolume") => vec![file],
        (Category::Texture, "mesh_attribute") => vec![("name", "<string name=\"name\" value=\"vertex_color\"/>")],
        (Category::Texture, "volume") => vec![("volume", "<volume name=\"volume\" type=\"constvolume\"/>")],
        (Category::Texture, "regular") => vec![
            ("wavelength_min", "<float name=\"wavelength_min\" value=\"400\"/>"),
            ("wavelength_max", "<float name=\"wavelength_max\" value=\"700\"/>"),
            ("values", "<string name=\"values\" value=\".2, .7\"/>"),
        ],
        (Category::Texture, "irregular") => vec![
            ("wavelengths", "<string name=\"wavelengths\" value=\"400, 700\"/>"),
            ("values", "<string name=\"values\" value=\".2, .7\"/>"),
        ],
        (Category::Texture, "rawconstant") => vec![("value", "<rgb name=\"value\" value=\".2 .3 .4\"/>")],
        (Category::Texture, "srgb") => vec![("color", "<rgb name=\"color\" value=\".2 .3 .4\"/>")],
        (Category::Phase, "blendphase" | "mixturephase") => vec![
            ("weight", "<float name=\"weight\" value=\".3\"/>"),
            ("", "<phase type=\"isotropic\"/>"),
            ("", "<phase type=\"hg\"/>"),
        ],
        (Category::Phase, "tabphase") => vec![("values", "<string name=\"values\" value=\".5, 1, 2\"/>")],
        (Category::Phase, "tabphase_irregular") => vec![
            ("values", "<string name=\"values\" value=\".5, 1, 2\"/>"),
            ("nodes", "<string name=\"nodes\" value=\"-1, 0, 1\"/>"),
        ],
        _ => Vec::new(),
    }
}

fn stages() -> Vec<Stage> {
    use Category::*;
    let stage = |category: Category, tag, around: &'static str| {
        plugins::known(category).iter().map(move |plugin| {
            let around = match (category, *plugin) {
                (Emitter, "area" | "directionalarea") => "<shape type=\"rectangle\">@</shape>",
                (Sensor, "irradiancemeter") => "<shape type=\"rectangle\">@</shape>",
                _ => around,
            };
            Stage { tag, around, plugin, needs: needs(category, plugin) }
        })
    };
    stage(Integrator, "integrator", "@")
        .chain(stage(Sensor, "sensor", "@"))
        .chain(stage(Sampler, "sampler", "<sensor type=\"perspective\">@</sensor>"))
        .chain(stage(Film, "film", "<sensor type=\"perspective\">@</sensor>"))
        .chain(stage(Filter, "rfilter", "<sensor type=\"perspective\"><film type=\"hdrfilm\">@</film></sensor>"))
        .chain(stage(Emitter, "emitter", "@"))
        .chain(stage(Shape, "shape", "@"))
        .chain(stage(Bsdf, "bsdf", "<shape type=\"sphere\">@</shape>"))
        .chain(stage(Texture, "texture", "<shape type=\"sphere\"><bsdf type=\"diffuse\">@</bsdf></shape>"))
        .chain(stage(
            Volume,
            "volume",
            "<shape type=\"cube\"><medium name=\"interior\" type=\"heterogeneous\">@</medium></shape>",
        ))
        .chain(stage(Medium, "medium", "<shape type=\"cube\">@</shape>"))
        .chain(stage(
            Phase,
            "phase",
            "<shape type=\"cube\"><medium name=\"interior\" type=\"homogeneous\">@</medium></shape>",
        ))
        .collect()
}

/// Elements that set a parameter, of which some are of use.
fn values(name: &str) -> Vec<String> {
    let simple = |tag: &str, values: &[&str]| {
        values.iter().map(|v| format!("<{tag} name=\"{name}\" value=\"{v}\"/>")).collect::<Vec<_>>()
    };
    let mut all = simple("boolean", &["true", "false"]);
    all.extend(simple("float", &[".37", ".8", "2.5", "7", "30", "450"]));
    all.extend(simple("integer", &["3", "0", "1", "2", "64"]));
    all.extend(simple("rgb", &[".2 .5 .7"]));
    all.extend(simple("spectrum", &["400:.2, 700:.7"]));
    let words = [
        "f",
        "m.obj",
        "m.ply",
        "curve.txt",
        "Au",
        "bk7",
        "water",
        "ggx",
        "beckmann",
        "phong",
        "nearest",
        "bilinear",
        "trilinear",
        "ewa",
        "repeat",
        "mirror",
        "clamp",
        "srgb",
        "raw",
        "x",
        "y",
        "diagonal",
        "rgba",
        "luminance",
        "vertex_color",
        ".5, 1, 3",
        "400, 500",
        "-1, 0.5, 1",
        "0, 0, 1",
        "ward-duer",
        "modified",
        "anisotropic",
        "r",
        "a",
        "float16",
        "openexr",
        "catmullrom",
        "fp16",
        "left",
        "50mm",
        "variance",
        "smooth",
        "analytic",
        "face_color",
        "n.ply",
        "other.txt",
        "linear",
        "2020-01-02",
    ];
    all.extend(simple("string", &words));
    for tag in ["vector", "point"] {
        all.push(format!("<{tag} name=\"{name}\" x=\".1\" y=\".2\" z=\".9\"/>"));
    }
    for operation in ["<translate x=\"2\" y=\"1\"/>", "<scale value=\"2\"/>", "<rotate y=\"1\" angle=\"40\"/>"] {
        all.push(format!("<transform name=\"{name}\">{operation}</transform>"));
    }
    all.push(format!("<texture name=\"{name}\" type=\"checkerboard\"/>"));
    all.push(format!("<volume name=\"{name}\" type=\"constvolume\"><float name=\"value\" value=\".3\"/></volume>"));
    all
}

fn reading(folder: &Path, stage: &Stage, version: &str, given: &[(&str, &str)]) -> Reading {
    let Stage { tag, around, plugin, needs } = stage;
    let replaced = |name: &str| !name.is_empty() && given.iter().any(|(n, _)| *n == name);
    let needed = needs.iter().filter(|(name, _)| !replaced(name)).chain(given).map(|(_, element)| *element);
    let name = if *tag == "medium" { " name=\"interior\"" } else { "" };
    let name = if *tag == "texture" { " name=\"reflectance\"" } else { name };
    let name = if *tag == "volume" { " name=\"albedo\"" } else { name };
    let own = format!("<{tag}{name} type=\"{plugin}\">{}</{tag}>", needed.collect::<String>());
    let text = format!("<scene version=\"{version}\">{}</scene>", around.replace('@', &own));
    Reading::of(&import_text(&text, &folder.join("scene.xml"), &Options::default()))
}

/// A folder with the files that plugins need.
fn files() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("f", "VOL");
    write("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n");
    write("other.txt", "0 0 0 .2\n1 0 0 .2\n1 1 0 .2\n0 1 0 .3\n");
    write("curve.txt", "0 0 0 .1\n1 0 0 .1\n1 1 0 .1\n0 1 0 .2\n");
    let header = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
                  property float u\nproperty float v\nelement face 1\nproperty list uchar int vertex_indices\n\
                  end_header\n";
    for (name, x) in [("m.ply", 1), ("n.ply", 2)] {
        write(name, &format!("{header}0 0 0 0 0\n{x} 0 0 1 0\n0 1 0 0 1\n3 0 1 2\n"));
    }
    folder
}

#[test]
fn every_parameter_is_followed_or_told() {
    let folder = files();
    let mut all = Vec::new();
    for (stage, version) in stages().iter().flat_map(|stage| [(stage, "3.0.0"), (stage, "0.6.0")]) {
        asked();
        let plain = reading(folder.path(), stage, version, &[]);
        let of = format!(" {}", stage.plugin);
        // Plugins that there are not, and one whose files are packed.
        if plain.is_refused {
            let messages = plain.messages();
            assert!(messages.contains("error: there is no ") || stage.plugin == "serialized", "{messages}");
            continue;
        }
        let names: BTreeSet<&'static str> = asked().iter().filter(|a| a.of.ends_with(&of)).map(|a| a.name).collect();
        let parameters: Vec<(String, Vec<(String, String)>)> = names
            .iter()
            .map(|name| ((*name).to_owned(), values(name).into_iter().map(|v| ((*name).to_owned(), v)).collect()))
            .collect();
        let read = |given: &[(String, String)]| {
            let given: Vec<(&str, &str)> = given.iter().map(|(n, v)| (n.as_str(), v.as_str())).collect();
            reading(folder.path(), stage, version, &given)
        };
        for (name, of) in names.iter().zip(crate::law::outcomes(&parameters, read)) {
            all.push((format!("{} {} of {version}: {name}", stage.tag, stage.plugin), of));
        }
    }
    judge(&all, 500);
}
