//! `Sampler`, `Integrator` and `Accelerator`.

use super::{build::Build, dict::Dict, param::Type, scene::Scene};
use steradian_scene::{Family, NodeId, names};

/// The reason that a parameter has no effect, where it is about the means alone.
const NOISE: &str = "it changes the noise only";

pub(super) const SAMPLERS: [&str; 7] =
    ["zsobol", "sobol", "paddedsobol", "halton", "pmj02bn", "independent", "stratified"];

pub(super) const INTEGRATORS: [&str; 11] = [
    "path",
    "volpath",
    "simplepath",
    "simplevolpath",
    "randomwalk",
    "lightpath",
    "bdpt",
    "mlt",
    "sppm",
    "ambientocclusion",
    "function",
];

/// Translates the sampler; `seed` is that of `Option "seed"`.
pub(super) fn sampler(scene: &mut Scene, dict: &Dict, seed: Option<i64>) -> Option<NodeId> {
    let given = dict.kind.as_str();
    let kind = match given {
        "independent" | "stratified" | "sobol" | "zsobol" | "halton" => given,
        "paddedsobol" => "sobol",
        "pmj02bn" => "pmj02",
        _ => {
            let help = match given {
                "lowdiscrepancy" | "02sequence" => Some(format!("'{given}' is of pbrt-v3; use 'paddedsobol'")),
                "random" => Some("'random' is of pbrt-v3; use 'independent'".into()),
                "maxmindist" => Some("'maxmindist' is of pbrt-v3; use 'pmj02bn'".into()),
                _ => names::did_you_mean(given, SAMPLERS),
            };
            scene.report.error_help(dict.span, format!("unknown sampler '{given}'"), help);
            return None;
        }
    };
    let mut b = Build::new(scene, dict, Family::Sampler, kind);
    if kind == "stratified" {
        let [x, y] = ["xsamples", "ysamples"].map(|n| b.dict.int(&mut b.scene.report, n).unwrap_or(4));
        b.set("samples", i64::from(x) * i64::from(y));
        if x <= 0 || y <= 0 {
            b.error(if x <= 0 { "xsamples" } else { "ysamples" }, "the number of samples must be above 0");
        }
        if b.dict.bool(&mut b.scene.report, "jitter") == Some(false) {
            let span = b.dict.span_of("jitter");
            b.scene.report.note(span, "'jitter' has no effect: samples are jittered all the same");
        }
    } else {
        b.int("pixelsamples", "samples", if kind == "independent" { 4 } else { 16 });
        if b.node.int("samples").is_none_or(|n| n <= 0) {
            b.error("pixelsamples", "the number of samples must be above 0");
        }
        if given != "independent" && given != "pmj02bn" {
            b.no_effect("randomization", Type::String, NOISE);
        }
    }
    b.int("seed", "seed", seed.unwrap_or(0));
    Some(b.finish())
}

/// Parameters of an integrator that have no place in Steradian's.
type Others = &'static [(&'static str, Type)];

/// Steradian's kind for an integrator.
fn kind_of(given: &str) -> Option<(&'static str, Others)> {
    let found: (&str, Others) = match given {
        "path" => ("path", &[("lightsampler", Type::String)]),
        "volpath" => ("volpath", &[("lightsampler", Type::String)]),
        "simplepath" => ("path", &[("samplelights", Type::Bool), ("samplebsdf", Type::Bool)]),
        "simplevolpath" => ("volpath", &[]),
        "randomwalk" => ("path", &[]),
        "lightpath" => ("light", &[]),
        "bdpt" => ("bdpt", &[("visualizestrategies", Type::Bool), ("visualizeweights", Type::Bool)]),
        "mlt" => ("mmlt", &[("bootstrapsamples", Type::Integer), ("chains", Type::Integer), ("sigma", Type::Float)]),
        "sppm" => ("sppm", &[("seed", Type::Integer)]),
        "ambientocclusion" => ("ao", &[("cossample", Type::Bool)]),
        "function" => (
            "path",
            &[
                ("function", Type::String),
                ("filename", Type::String),
                ("skipbad", Type::Bool),
                ("imagefilename", Type::String),
            ],
        ),
        _ => return None,
    };
    Some(found)
}

fn unknown_integrator(scene: &mut Scene, dict: &Dict) {
    let given = dict.kind.as_str();
    let help = match given {
        "directlighting" | "whitted" => Some(format!("'{given}' is of pbrt-v3; pbrt-v4 has 'path'")),
        _ => names::did_you_mean(given, INTEGRATORS),
    };
    scene.report.error_help(dict.span, format!("unknown integrator '{given}'"), help);
}

/// Translates the integrator.
pub(super) fn integrator(scene: &mut Scene, dict: &Dict) -> Option<NodeId> {
    let given = dict.kind.as_str();
    let Some((kind, others)) = kind_of(given) else {
        unknown_integrator(scene, dict);
        return None;
    };
    // All others are there, or estimate the same light as a path tracer, by simpler means.
    let same_light = !matches!(given, "randomwalk" | "function");
    if !same_light {
        scene.report.approximated(dict.span, format!("integrator '{given}' is rendered as '{kind}'"));
    }
    let mut b = Build::new(scene, dict, Family::Integrator, kind);
    b.int("maxdepth", "max_depth", 5);
    if b.node.int("max_depth").is_some_and(|n| n < 0) {
        b.error("maxdepth", "parameter 'maxdepth' must not be below 0");
    }
    settings(&mut b, kind);
    without_effect(&mut b, others, same_light);
    if b.dict.bool(&mut b.scene.report, "regularize") == Some(true) {
        let span = b.dict.span_of("regularize");
        b.scene.report.approximated(span, "paths are not regularized");
    }
    Some(b.finish())
}

/// Translates the parameters that a kind of integrator has of its own.
fn settings(b: &mut Build, kind: &str) {
    match kind {
        "sppm" => {
            b.int("photonsperiteration", "photons", 0);
            if b.node.int("photons").is_some_and(|n| n <= 0) {
                // As many as pixels.
                b.set("photons", 0_i64);
            }
            b.positive("radius", "radius", 1.0);
        }
        "mmlt" => {
            b.int("mutationsperpixel", "samples", 100);
            if b.node.int("samples").is_some_and(|n| n <= 0) {
                b.error("mutationsperpixel", "the number of mutations must be above 0");
            }
            b.float("largestepprobability", "large_step", 0.3);
            if b.node.float("large_step").is_some_and(|p| !(p > 0.0 && p <= 1.0)) {
                b.error("largestepprobability", "a probability above 0 and up to 1 was expected");
            }
        }
        "ao" => {
            b.positive("maxdistance", "distance", None);
            let what = "occlusion counts directions about the shading normal; pbrt takes the geometric one";
            b.scene.report.note(b.dict.span, what);
        }
        _ => {}
    }
}

/// Takes the parameters that Steradian does not have, and says what comes of it.
fn without_effect(b: &mut Build, names: Others, same_light: bool) {
    let given = b.dict.kind.as_str();
    for &(name, ty) in names {
        if same_light && !name.starts_with("visualize") {
            b.no_effect(name, ty, NOISE);
        } else if b.dict.find(&mut b.scene.report, name, &[ty]).is_some() {
            let span = b.dict.span_of(name);
            if !same_light {
                b.scene.report.dropped(span, format!("'{name}' of integrator '{given}' is left out"));
            } else if b.dict.bool(&mut b.scene.report, name) == Some(true) {
                let message = format!("pictures of single strategies ('{name}') are not written");
                b.scene.report.dropped(span, message);
            }
        }
    }
}

/// Accelerators of pbrt-v3 and v4 with their parameters.
pub(super) const ACCELERATORS: [(&str, &[(&str, Type)]); 2] = [
    ("bvh", &[("maxnodeprims", Type::Integer), ("splitmethod", Type::String)]),
    (
        "kdtree",
        &[
            ("intersectcost", Type::Integer),
            ("traversalcost", Type::Integer),
            ("emptybonus", Type::Float),
            ("maxprims", Type::Integer),
            ("maxdepth", Type::Integer),
        ],
    ),
];

/// Any accelerator gives the same picture.
pub(super) fn accelerator(scene: &mut Scene, dict: &Dict) {
    let Some((_, parameters)) = ACCELERATORS.iter().find(|(kind, _)| *kind == dict.kind) else {
        dict.ignore_all();
        let message = format!("unknown accelerator '{}'", dict.kind);
        let help = || names::did_you_mean(&dict.kind, ACCELERATORS.map(|a| a.0));
        return scene.report.unused(dict.span, message, help);
    };
    for &(name, ty) in *parameters {
        dict.no_effect(&mut scene.report, "accelerator", name, ty, "it changes the speed only");
    }
    dict.report_unused(&mut scene.report, "accelerator");
}
