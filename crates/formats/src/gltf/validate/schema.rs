//! The objects of glTF 2.0 (specification, chapter 5): names, types, ranges.

use super::kinds::{FACTOR, Kind, Kind::*, Member, NOT_NEGATIVE, NUMBER, Object, from, may, may_with, must, object};

const NAME: Member = may("name", Text);
const FIXED_3: Kind = List(&NUMBER, &[3]);

pub(super) static ROOT: Object = object(
    "glTF",
    &[
        must("asset", Object(&ASSET)),
        may("scene", Index("scenes")),
        may("extensionsUsed", Set(&Text)),
        may("extensionsRequired", Set(&Text)),
        may("accessors", List(&Object(&ACCESSOR), &[])),
        may("animations", List(&Object(&ANIMATION), &[])),
        may("buffers", List(&Object(&BUFFER), &[])),
        may("bufferViews", List(&Object(&BUFFER_VIEW), &[])),
        may("cameras", List(&Object(&CAMERA), &[])),
        may("images", List(&Object(&IMAGE), &[])),
        may("materials", List(&Object(&MATERIAL), &[])),
        may("meshes", List(&Object(&MESH), &[])),
        may("nodes", List(&Object(&NODE), &[])),
        may("samplers", List(&Object(&SAMPLER), &[])),
        may("scenes", List(&Object(&SCENE), &[])),
        may("skins", List(&Object(&SKIN), &[])),
        may("textures", List(&Object(&TEXTURE), &[])),
    ],
);

static ASSET: Object = object(
    "asset",
    &[may("copyright", Text), may("generator", Text), must("version", Version), may("minVersion", Version)],
);

static ACCESSOR: Object = object(
    "accessor",
    &[
        may("bufferView", Index("bufferViews")),
        may_with("byteOffset", from(0), "bufferView"),
        must("componentType", Code(&[5120, 5121, 5122, 5123, 5125, 5126])),
        may("normalized", Bool),
        must("count", from(1)),
        must("type", Word(&["SCALAR", "VEC2", "VEC3", "VEC4", "MAT2", "MAT3", "MAT4"])),
        may("max", List(&NUMBER, &[1, 2, 3, 4, 9, 16])),
        may("min", List(&NUMBER, &[1, 2, 3, 4, 9, 16])),
        may("sparse", Object(&SPARSE)),
        NAME,
    ],
);

static SPARSE: Object = object(
    "sparse",
    &[must("count", from(1)), must("indices", Object(&SPARSE_INDICES)), must("values", Object(&SPARSE_VALUES))],
);
static SPARSE_INDICES: Object = object(
    "sparse indices",
    &[
        must("bufferView", Index("bufferViews")),
        may("byteOffset", from(0)),
        must("componentType", Code(&[5121, 5123, 5125])),
    ],
);
static SPARSE_VALUES: Object =
    object("sparse values", &[must("bufferView", Index("bufferViews")), may("byteOffset", from(0))]);

static ANIMATION: Object = object(
    "animation",
    &[must("channels", List(&Object(&CHANNEL), &[])), must("samplers", List(&Object(&ANIMATION_SAMPLER), &[])), NAME],
);
static CHANNEL: Object = object("channel", &[must("sampler", Index("")), must("target", Object(&TARGET))]);
static TARGET: Object = object(
    "channel target",
    &[may("node", Index("nodes")), must("path", Word(&["translation", "rotation", "scale", "weights", "pointer"]))],
);
static ANIMATION_SAMPLER: Object = object(
    "animation sampler",
    &[
        must("input", Index("accessors")),
        may("interpolation", Word(&["LINEAR", "STEP", "CUBICSPLINE"])),
        must("output", Index("accessors")),
    ],
);

static BUFFER: Object = object("buffer", &[may("uri", Uri), must("byteLength", from(1)), NAME]);
static BUFFER_VIEW: Object = object(
    "buffer view",
    &[
        must("buffer", Index("buffers")),
        may("byteOffset", from(0)),
        must("byteLength", from(1)),
        may("byteStride", Integer { least: 4, most: 252, multiple: 4 }),
        may("target", Code(&[34962, 34963])),
        NAME,
    ],
);

static CAMERA: Object = Object {
    name: "camera",
    members: &[
        may("orthographic", Object(&ORTHOGRAPHIC)),
        may("perspective", Object(&PERSPECTIVE)),
        must("type", Word(&["perspective", "orthographic"])),
        NAME,
    ],
    one_of: &["orthographic", "perspective"],
};
static ORTHOGRAPHIC: Object = object(
    "orthographic camera",
    &[must("xmag", NUMBER), must("ymag", NUMBER), must("zfar", Above(0.0)), must("znear", NOT_NEGATIVE)],
);
static PERSPECTIVE: Object = object(
    "perspective camera",
    &[may("aspectRatio", Above(0.0)), must("yfov", Above(0.0)), may("zfar", Above(0.0)), must("znear", Above(0.0))],
);

static IMAGE: Object = Object {
    name: "image",
    members: &[
        may("uri", Uri),
        may(
            "mimeType",
            Word(&["image/jpeg", "image/png", "image/webp", "image/ktx2", "image/avif", "image/vnd-ms.dds"]),
        ),
        may_with("bufferView", Index("bufferViews"), "mimeType"),
        NAME,
    ],
    one_of: &["uri", "bufferView"],
};

static MATERIAL: Object = object(
    "material",
    &[
        may("pbrMetallicRoughness", Object(&METALLIC_ROUGHNESS)),
        may("normalTexture", Object(&NORMAL_TEXTURE)),
        may("occlusionTexture", Object(&OCCLUSION_TEXTURE)),
        may("emissiveTexture", Object(&TEXTURE_INFO)),
        may("emissiveFactor", List(&FACTOR, &[3])),
        may("alphaMode", Word(&["OPAQUE", "MASK", "BLEND"])),
        may("alphaCutoff", NOT_NEGATIVE),
        may("doubleSided", Bool),
        NAME,
    ],
);
static METALLIC_ROUGHNESS: Object = object(
    "metallic roughness",
    &[
        may("baseColorFactor", List(&FACTOR, &[4])),
        may("baseColorTexture", Object(&TEXTURE_INFO)),
        may("metallicFactor", FACTOR),
        may("roughnessFactor", FACTOR),
        may("metallicRoughnessTexture", Object(&TEXTURE_INFO)),
    ],
);
pub(super) static TEXTURE_INFO: Object =
    object("texture info", &[must("index", Index("textures")), may("texCoord", from(0))]);
pub(super) static NORMAL_TEXTURE: Object =
    object("texture info", &[must("index", Index("textures")), may("texCoord", from(0)), may("scale", NUMBER)]);
static OCCLUSION_TEXTURE: Object =
    object("texture info", &[must("index", Index("textures")), may("texCoord", from(0)), may("strength", FACTOR)]);

static MESH: Object =
    object("mesh", &[must("primitives", List(&Object(&PRIMITIVE), &[])), may("weights", List(&NUMBER, &[])), NAME]);
static PRIMITIVE: Object = object(
    "primitive",
    &[
        must("attributes", Map(&Index("accessors"))),
        may("indices", Index("accessors")),
        may("material", Index("materials")),
        may("mode", Code(&[0, 1, 2, 3, 4, 5, 6])),
        may("targets", List(&Map(&Index("accessors")), &[])),
    ],
);

static NODE: Object = object(
    "node",
    &[
        may("camera", Index("cameras")),
        may("children", Set(&Index("nodes"))),
        may_with("skin", Index("skins"), "mesh"),
        may("matrix", List(&NUMBER, &[16])),
        may("mesh", Index("meshes")),
        may("rotation", List(&Number { least: -1.0, most: 1.0 }, &[4])),
        may("scale", FIXED_3),
        may("translation", FIXED_3),
        may_with("weights", List(&NUMBER, &[]), "mesh"),
        NAME,
    ],
);

static SAMPLER: Object = object(
    "sampler",
    &[
        may("magFilter", Code(&[9728, 9729])),
        may("minFilter", Code(&[9728, 9729, 9984, 9985, 9986, 9987])),
        may("wrapS", Code(&[33071, 33648, 10497])),
        may("wrapT", Code(&[33071, 33648, 10497])),
        NAME,
    ],
);
static SCENE: Object = object("scene", &[may("nodes", Set(&Index("nodes"))), NAME]);
static SKIN: Object = object(
    "skin",
    &[
        may("inverseBindMatrices", Index("accessors")),
        may("skeleton", Index("nodes")),
        must("joints", Set(&Index("nodes"))),
        NAME,
    ],
);
static TEXTURE: Object = object("texture", &[may("sampler", Index("samplers")), may("source", Index("images")), NAME]);
