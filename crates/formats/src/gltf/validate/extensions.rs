//! The objects of extensions of the Khronos registry: names, types, ranges.

use super::{
    kinds::{Extension, FACTOR, Kind, Kind::*, NOT_NEGATIVE, NUMBER, Object, from, may, must, object},
    schema::{NORMAL_TEXTURE, TEXTURE_INFO},
};

const INFO: Kind = Object(&TEXTURE_INFO);
const COLOR: Kind = List(&FACTOR, &[3]);
const COLOR_OR_MORE: Kind = List(&NOT_NEGATIVE, &[3]);

/// An extension of materials only.
const fn of_material(name: &'static str, places: &'static [(&'static str, &'static Object); 1]) -> Extension {
    Extension { name, places }
}

pub(super) static EXTENSIONS: &[Extension] = &[
    of_material("KHR_materials_anisotropy", &[("material", &ANISOTROPY)]),
    of_material("KHR_materials_clearcoat", &[("material", &CLEARCOAT)]),
    of_material("KHR_materials_diffuse_transmission", &[("material", &DIFFUSE_TRANSMISSION)]),
    of_material("KHR_materials_dispersion", &[("material", &DISPERSION)]),
    of_material("KHR_materials_emissive_strength", &[("material", &EMISSIVE_STRENGTH)]),
    of_material("KHR_materials_ior", &[("material", &IOR)]),
    of_material("KHR_materials_iridescence", &[("material", &IRIDESCENCE)]),
    of_material("KHR_materials_pbrSpecularGlossiness", &[("material", &SPECULAR_GLOSSINESS)]),
    of_material("KHR_materials_sheen", &[("material", &SHEEN)]),
    of_material("KHR_materials_specular", &[("material", &SPECULAR)]),
    of_material("KHR_materials_transmission", &[("material", &TRANSMISSION)]),
    of_material("KHR_materials_unlit", &[("material", &EMPTY)]),
    of_material("KHR_materials_volume", &[("material", &VOLUME)]),
    Extension { name: "KHR_materials_variants", places: &[("glTF", &VARIANTS), ("primitive", &MAPPINGS)] },
    Extension { name: "KHR_lights_punctual", places: &[("glTF", &LIGHTS), ("node", &LIGHT_OF_NODE)] },
    Extension { name: "KHR_node_visibility", places: &[("node", &VISIBILITY)] },
    Extension { name: "KHR_animation_pointer", places: &[("channel target", &POINTER)] },
    Extension { name: "KHR_texture_transform", places: &[("texture info", &TEXTURE_TRANSFORM)] },
    Extension { name: "KHR_texture_basisu", places: &[("texture", &SOURCE)] },
    Extension { name: "EXT_texture_webp", places: &[("texture", &SOURCE)] },
    Extension { name: "KHR_mesh_quantization", places: &[] },
    Extension { name: "KHR_draco_mesh_compression", places: &[("primitive", &DRACO)] },
    Extension { name: "EXT_meshopt_compression", places: &[("buffer", &STAND_IN), ("buffer view", &MESHOPT)] },
    Extension { name: "KHR_meshopt_compression", places: &[("buffer", &STAND_IN), ("buffer view", &MESHOPT)] },
];

static EMPTY: Object = object("extension", &[]);
static ANISOTROPY: Object = object(
    "extension",
    &[may("anisotropyStrength", FACTOR), may("anisotropyRotation", NUMBER), may("anisotropyTexture", INFO)],
);
static CLEARCOAT: Object = object(
    "extension",
    &[
        may("clearcoatFactor", FACTOR),
        may("clearcoatTexture", INFO),
        may("clearcoatRoughnessFactor", FACTOR),
        may("clearcoatRoughnessTexture", INFO),
        may("clearcoatNormalTexture", Object(&NORMAL_TEXTURE)),
    ],
);
static DIFFUSE_TRANSMISSION: Object = object(
    "extension",
    &[
        may("diffuseTransmissionFactor", FACTOR),
        may("diffuseTransmissionTexture", INFO),
        may("diffuseTransmissionColorFactor", COLOR),
        may("diffuseTransmissionColorTexture", INFO),
    ],
);
static DISPERSION: Object = object("extension", &[may("dispersion", NOT_NEGATIVE)]);
static EMISSIVE_STRENGTH: Object = object("extension", &[may("emissiveStrength", NOT_NEGATIVE)]);
static IOR: Object = object("extension", &[may("ior", NOT_NEGATIVE)]);
static IRIDESCENCE: Object = object(
    "extension",
    &[
        may("iridescenceFactor", FACTOR),
        may("iridescenceTexture", INFO),
        may("iridescenceIor", Number { least: 1.0, most: f64::INFINITY }),
        may("iridescenceThicknessMinimum", NOT_NEGATIVE),
        may("iridescenceThicknessMaximum", NOT_NEGATIVE),
        may("iridescenceThicknessTexture", INFO),
    ],
);
static SPECULAR_GLOSSINESS: Object = object(
    "extension",
    &[
        may("diffuseFactor", List(&FACTOR, &[4])),
        may("diffuseTexture", INFO),
        may("specularFactor", COLOR),
        may("glossinessFactor", FACTOR),
        may("specularGlossinessTexture", INFO),
    ],
);
static SHEEN: Object = object(
    "extension",
    &[
        may("sheenColorFactor", COLOR),
        may("sheenColorTexture", INFO),
        may("sheenRoughnessFactor", FACTOR),
        may("sheenRoughnessTexture", INFO),
    ],
);
static SPECULAR: Object = object(
    "extension",
    &[
        may("specularFactor", FACTOR),
        may("specularTexture", INFO),
        may("specularColorFactor", COLOR_OR_MORE),
        may("specularColorTexture", INFO),
    ],
);
static TRANSMISSION: Object =
    object("extension", &[may("transmissionFactor", FACTOR), may("transmissionTexture", INFO)]);
static VOLUME: Object = object(
    "extension",
    &[
        may("thicknessFactor", NOT_NEGATIVE),
        may("thicknessTexture", INFO),
        may("attenuationDistance", Above(0.0)),
        may("attenuationColor", COLOR),
    ],
);

static VARIANTS: Object = object("extension", &[must("variants", List(&Object(&VARIANT), &[]))]);
static VARIANT: Object = object("variant", &[must("name", Text)]);
static MAPPINGS: Object = object("extension", &[must("mappings", List(&Object(&MAPPING), &[]))]);
static MAPPING: Object = object(
    "mapping",
    &[
        must("variants", Set(&Index("extensions/KHR_materials_variants/variants"))),
        must("material", Index("materials")),
        may("name", Text),
    ],
);

static LIGHTS: Object = object("extension", &[must("lights", List(&Object(&LIGHT), &[]))]);
static LIGHT: Object = object(
    "light",
    &[
        may("color", COLOR),
        may("intensity", NOT_NEGATIVE),
        may("spot", Object(&SPOT)),
        must("type", Word(&["directional", "point", "spot"])),
        may("range", Above(0.0)),
        may("name", Text),
    ],
);
static SPOT: Object = object(
    "spot",
    &[
        may("innerConeAngle", Number { least: 0.0, most: std::f64::consts::FRAC_PI_2 }),
        may("outerConeAngle", Number { least: 0.0, most: std::f64::consts::FRAC_PI_2 }),
    ],
);
static LIGHT_OF_NODE: Object = object("extension", &[must("light", Index("extensions/KHR_lights_punctual/lights"))]);

static VISIBILITY: Object = object("extension", &[may("visible", Bool)]);
static POINTER: Object = object("extension", &[must("pointer", Text)]);
static TEXTURE_TRANSFORM: Object = object(
    "extension",
    &[
        may("offset", List(&NUMBER, &[2])),
        may("rotation", NUMBER),
        may("scale", List(&NUMBER, &[2])),
        may("texCoord", from(0)),
    ],
);
static SOURCE: Object = object("extension", &[may("source", Index("images"))]);
static DRACO: Object =
    object("extension", &[must("bufferView", Index("bufferViews")), must("attributes", Map(&from(0)))]);
static STAND_IN: Object = object("extension", &[may("fallback", Bool)]);
static MESHOPT: Object = object(
    "extension",
    &[
        must("buffer", Index("buffers")),
        may("byteOffset", from(0)),
        must("byteLength", from(1)),
        must("byteStride", Integer { least: 2, most: 256, multiple: 2 }),
        must("count", from(1)),
        must("mode", Word(&["ATTRIBUTES", "TRIANGLES", "INDICES"])),
        may("filter", Word(&["NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL", "COLOR"])),
    ],
);
