//! The plugins of Mitsuba 0.6 to 3, by category: what tells a misspelt name from one that Steradian lacks.

use super::graph::Category;

const INTEGRATORS: [&str; 31] = [
    "path",
    "direct",
    "volpath",
    "volpathmis",
    "ptracer",
    "aov",
    "moment",
    "depth",
    "stokes",
    "volpath_simple",
    "bdpt",
    "mlt",
    "pssmlt",
    "erpt",
    "photonmapper",
    "ppm",
    "sppm",
    "vpl",
    "ao",
    "adaptive",
    "irrcache",
    "multichannel",
    "field",
    "prb",
    "prb_basic",
    "prbvolpath",
    "prb_reparam",
    "direct_projective",
    "direct_reparam",
    "emission_reparam",
    "prb_projective",
];

const SENSORS: [&str; 13] = [
    "perspective",
    "thinlens",
    "orthographic",
    "radiancemeter",
    "irradiancemeter",
    "distant",
    "batch",
    "spherical",
    "telecentric",
    "fluencemeter",
    "perspective_rdist",
    "hdistant",
    "mdistant",
];

const SAMPLERS: [&str; 8] =
    ["independent", "stratified", "multijitter", "orthogonal", "ldsampler", "halton", "hammersley", "sobol"];

const FILMS: [&str; 5] = ["hdrfilm", "specfilm", "ldrfilm", "tiledhdrfilm", "mfilm"];

const FILTERS: [&str; 6] = ["box", "tent", "gaussian", "mitchell", "catmullrom", "lanczos"];

const EMITTERS: [&str; 13] = [
    "area",
    "point",
    "spot",
    "directional",
    "directionalarea",
    "constant",
    "envmap",
    "projector",
    "sunsky",
    "timed_sunsky",
    "sky",
    "sun",
    "collimated",
];

const SHAPES: [&str; 18] = [
    "sphere",
    "rectangle",
    "disk",
    "cube",
    "cylinder",
    "obj",
    "ply",
    "serialized",
    "instance",
    "shapegroup",
    "merge",
    "linearcurve",
    "bsplinecurve",
    "sdfgrid",
    "ellipsoids",
    "ellipsoidsmesh",
    "hair",
    "heightfield",
];

const BSDFS: [&str; 32] = [
    "diffuse",
    "dielectric",
    "thindielectric",
    "roughdielectric",
    "conductor",
    "roughconductor",
    "plastic",
    "roughplastic",
    "twosided",
    "mask",
    "blendbsdf",
    "null",
    "bumpmap",
    "normalmap",
    "principled",
    "principledthin",
    "hair",
    "measured",
    "measured_polarized",
    "pplastic",
    "polarizer",
    "retarder",
    "circular",
    "roughdiffuse",
    "coating",
    "roughcoating",
    "ward",
    "phong",
    "hk",
    "irawan",
    "mixturebsdf",
    "difftrans",
];

const TEXTURES: [&str; 16] = [
    "bitmap",
    "checkerboard",
    "mesh_attribute",
    "volume",
    "uniform",
    "d65",
    "blackbody",
    "regular",
    "irregular",
    "srgb",
    "rawconstant",
    "gridtexture",
    "scale",
    "vertexcolors",
    "wireframe",
    "curvature",
];

const VOLUMES: [&str; 4] = ["constvolume", "gridvolume", "volcache", "hgridvolume"];

const MEDIA: [&str; 2] = ["homogeneous", "heterogeneous"];

const PHASES: [&str; 10] = [
    "isotropic",
    "hg",
    "blendphase",
    "rayleigh",
    "sggx",
    "tabphase",
    "tabphase_irregular",
    "kkay",
    "microflake",
    "mixturephase",
];

/// Names of all plugins of a category.
pub(super) fn known(category: Category) -> &'static [&'static str] {
    match category {
        Category::Scene => &[],
        Category::Integrator => &INTEGRATORS,
        Category::Sensor => &SENSORS,
        Category::Sampler => &SAMPLERS,
        Category::Film => &FILMS,
        Category::Filter => &FILTERS,
        Category::Emitter => &EMITTERS,
        Category::Shape => &SHAPES,
        Category::Bsdf => &BSDFS,
        Category::Texture => &TEXTURES,
        Category::Volume => &VOLUMES,
        Category::Medium => &MEDIA,
        Category::Phase => &PHASES,
    }
}

/// `'a', 'b' or 'c'`.
pub(super) fn list(words: &[&str]) -> String {
    let quoted: Vec<String> = words.iter().map(|w| format!("'{w}'")).collect();
    match quoted.split_last() {
        Some((last, [])) => last.clone(),
        Some((last, rest)) => format!("{} or {last}", rest.join(", ")),
        None => String::new(),
    }
}
