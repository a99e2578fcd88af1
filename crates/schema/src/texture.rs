//! Textures: every kind with its parameters, and what images and patterns share.

use crate::{
    model::{Group, Model},
    parameter::{
        ANY, POSITIVE, Parameter, Type, file, flag, integer, list, number, tex, text, transform, vector, word,
    },
};

/// Shares, which are refused outside.
const SHARE: (f64, f64) = (0.0, 1.0);

const FREQUENCY: Parameter = number("frequency", ANY, "1", "factor on coordinates in space");
/// `frequency` of patterns not defined in space, where it has no effect.
const NO_FREQUENCY: Parameter = number("frequency", ANY, "1", "without effect: it is of patterns in space");
const DIMENSION: Parameter = integer("dimension", ANY, "3", "2 for the pattern over u and v, else in space");
const BASIS: Parameter = word("basis", "gradient, value", "gradient", "noise of random slopes, or of random values");
const SEED: Parameter = integer("seed", ANY, "0", "number of the random sequence; 0 is Perlin's own permutation");
const SHIFT: Parameter = number("shift", ANY, "0.5", "shift of each row against the one below, in bricks");
const BRICK_WIDTH: Parameter = number("width", POSITIVE, "1", "width of a brick with its mortar").refused();
const BRICK_HEIGHT: Parameter = number("height", POSITIVE, "1", "height of a brick with its mortar").refused();
const MORTAR: Parameter = number("mortar", ANY, "0.1", "width of the mortar; below 0 counts as 0");
const METRIC: Parameter =
    word("metric", "euclidean, manhattan, chebyshev", "euclidean", "what the distance to a point is");
const JITTER: Parameter =
    number("jitter", SHARE, "1", "how far points lie from the middle of their cells; 0 is a grid").refused();
const INPUT: Parameter = tex("input", ANY, "0.5", "what is changed");
const FROM_WORLD: Parameter = transform("texture_from_world", "identity", "from the world to the space of the texture");
const FORMULA: &str = "of u, v, the point x, y, z in the texture's space, the moment t of the exposure in [0, 1], pi \
     and numbers, with + - * / ^, parentheses, min, max, abs, sqrt, sin, cos, exp, log and floor; of 4096 letters, \
     1024 operations and 64 levels at most";
const DIRECTION: Parameter = vector("dir", "0,1,0", "the direction, in the space of the texture; it has a length");

/// All textures.
pub const TEXTURES: &[Model] = &[
    Model {
        kind: "constant",
        doc: "the same everywhere",
        parameters: &[tex("value", ANY, "1", "the value")],
        groups: &[],
        source: "",
    },
    Model {
        kind: "image",
        doc: "a picture",
        parameters: &[file("file", "needed", "the picture"), number("scale", ANY, "1", "factor on its values")],
        groups: &[&PICTURE, &MAPPING],
        source: "Williams, Pyramidal Parametrics (1983); Crow, Summed-Area Tables (1984); Heckbert (1989)",
    },
    Model {
        kind: "distance_field",
        doc: "a mask whose edges stay sharp when it is magnified, for opacity: the file is made once into a small \
         picture of the distances to its edge; the value is the part of the footprint inside of it, and from afar the \
         mask's mean",
        parameters: &[
            file("file", "needed", "the mask, of high resolution: several texels for each of the field"),
            word(
                "channel",
                "alpha, r, g, b",
                "alpha",
                "what is compared with cut, as it is stored; alpha is the mean of the colour in a picture without",
            ),
            number("cut", SHARE, "0.5", "value from which on a texel of the mask is inside"),
            integer("size", (1.0, 4096.0), "64", "texels of the field along the longer side of the mask").refused(),
            number("spread", (0.5, 64.0), "4", "distance that the field holds on each side of the edge")
                .unit("texels of the field")
                .refused(),
            word("wrap_u", "repeat, mirror, clamp", "repeat", "what lies beyond the sides"),
            word("wrap_v", "repeat, mirror, clamp", "repeat", "what lies beyond top and bottom"),
            word("origin", "bottom, top", "bottom", "where v = 0 is: at the last row (pbrt), or at the first"),
            flag("invert", "false", "whether values are one minus the coverage"),
        ],
        groups: &[&MAPPING],
        source: "Green, Improved Alpha-Tested Magnification for Vector Textures and Special Effects (2007); \
         Felzenszwalb, Huttenlocher, Distance Transforms of Sampled Functions (2012)",
    },
    Model {
        kind: "checkerboard",
        doc: "squares or cubes of two values",
        parameters: &[
            tex("a", ANY, "1", "where the sum of a cell's numbers is even"),
            tex("b", ANY, "0", "where it is odd"),
            integer("dimension", ANY, "2", "3 for cubes in space, else squares over u and v"),
            FREQUENCY,
        ],
        groups: &[&PATTERN, &MAPPING],
        source: "pbrt-v3, 10.5",
    },
    Model {
        kind: "bricks",
        doc: "rectangles in rows with mortar between them: 1 on bricks",
        parameters: &[BRICK_WIDTH, BRICK_HEIGHT, MORTAR, SHIFT, NO_FREQUENCY],
        groups: &[&SHADES, &PATTERN, &MAPPING],
        source: "",
    },
    Model {
        kind: "tiles",
        doc: "bricks whose rows are not shifted: 1 on tiles",
        parameters: &[
            BRICK_WIDTH,
            BRICK_HEIGHT,
            MORTAR,
            number("shift", ANY, "0", "shift of each row against the one below, in tiles"),
            NO_FREQUENCY,
        ],
        groups: &[&SHADES, &PATTERN, &MAPPING],
        source: "",
    },
    Model {
        kind: "brick_shade",
        doc: "a random number for each brick",
        parameters: &[BRICK_WIDTH, BRICK_HEIGHT, MORTAR, SHIFT, SEED, NO_FREQUENCY],
        groups: &[&SHADES, &PATTERN, &MAPPING],
        source: "",
    },
    Model {
        kind: "stripes",
        doc: "stripes across u, of period 1",
        parameters: &[number("duty", SHARE, "0.5", "share of a period that is 1").refused(), NO_FREQUENCY],
        groups: &[&SHADES, &PATTERN, &MAPPING],
        source: "",
    },
    Model {
        kind: "dots",
        doc: "pbrt's polka dots: 1 inside",
        parameters: &[NO_FREQUENCY],
        groups: &[&SHADES, &PATTERN, &MAPPING],
        source: "pbrt-v3, 10.6",
    },
    Model {
        kind: "gradient",
        doc: "from 0 to 1",
        parameters: &[
            word(
                "type",
                "u, v, radial, angular",
                "u",
                "what it follows: a coordinate, the distance from (½, ½), which is 1 from ½ on, or the angle around it",
            ),
            NO_FREQUENCY,
        ],
        groups: &[&SHADES, &PATTERN, &MAPPING],
        source: "",
    },
    Model {
        kind: "bilerp",
        doc: "bilinear between four values",
        parameters: &[
            tex("v00", ANY, "0", "at u = 0, v = 0"),
            tex("v10", ANY, "0", "at u = 1, v = 0"),
            tex("v01", ANY, "1", "at u = 0, v = 1"),
            tex("v11", ANY, "1", "at u = 1, v = 1"),
        ],
        groups: &[&MAPPING],
        source: "pbrt-v3, 10.3",
    },
    Model {
        kind: "noise",
        doc: "one octave of noise, in [-1, 1]",
        parameters: &[BASIS, SEED, DIMENSION, FREQUENCY],
        groups: &[&SHADES, &PATTERN, &MAPPING],
        source: "Perlin, Improving noise (2002)",
    },
    Model {
        kind: "fbm",
        doc: "fractional Brownian motion: the sum of octaves of noise",
        parameters: &[DIMENSION, FREQUENCY],
        groups: &[&FRACTAL, &SHADES, &PATTERN, &MAPPING],
        source: "Ebert et al., Texturing and Modeling, 3rd ed. (2003); pbrt-v3, 10.6",
    },
    Model {
        kind: "wrinkled",
        doc: "turbulence: the sum of magnitudes of octaves of noise",
        parameters: &[DIMENSION, FREQUENCY],
        groups: &[&FRACTAL, &SHADES, &PATTERN, &MAPPING],
        source: "Perlin, An image synthesizer (1985); pbrt-v3, 10.6",
    },
    Model {
        kind: "ridged",
        doc: "the sum of ridges of octaves of noise, in [0, 1]",
        parameters: &[DIMENSION, FREQUENCY],
        groups: &[&FRACTAL, &SHADES, &PATTERN, &MAPPING],
        source: "Musgrave, in Ebert et al., Texturing and Modeling, 3rd ed. (2003)",
    },
    Model {
        kind: "windy",
        doc: "waves by wind of varying strength",
        parameters: &[DIMENSION, FREQUENCY],
        groups: &[&SHADES, &PATTERN, &MAPPING],
        source: "pbrt-v3, 10.6",
    },
    Model {
        kind: "worley",
        doc: "distance to random points",
        parameters: &[
            word(
                "feature",
                "f1, f2, border",
                "f1",
                "distance to the nearest point, to the second nearest, or the difference of the two, which is 0 \
                 on the borders of cells",
            ),
            METRIC,
            JITTER,
            SEED,
            DIMENSION,
            FREQUENCY,
        ],
        groups: &[&SHADES, &PATTERN, &MAPPING],
        source: "Worley, A cellular texture basis function (1996)",
    },
    Model {
        kind: "voronoi",
        doc: "a random number for each cell of a Voronoi diagram",
        parameters: &[METRIC, JITTER, SEED, DIMENSION, FREQUENCY],
        groups: &[&SHADES, &PATTERN, &MAPPING],
        source: "Worley, A cellular texture basis function (1996)",
    },
    Model {
        kind: "wood",
        doc: "rings around z",
        parameters: &[
            number("ring", POSITIVE, "1", "width of a ring, light and dark together").refused(),
            number("light", SHARE, "0.6666667", "share of a ring that is light").refused(),
            number("wobble", ANY, "0.033333335", "how far rings are from round"),
            number("lobes", ANY, "20", "bulges around a ring; rounded"),
            number("twist", ANY, "0.4", "turn of the bulges along z").unit("rad per unit"),
            number("grain", ANY, "0", "how far noise moves the rings"),
            DIMENSION,
            FREQUENCY,
        ],
        groups: &[&FRACTAL, &SHADES, &PATTERN, &MAPPING],
        source: "Peachey, in Ebert et al., Texturing and Modeling, 3rd ed. (2003)",
    },
    Model {
        kind: "marble",
        doc: "veins across y; in pbrt's colours where neither a nor b is given",
        parameters: &[
            number("variation", ANY, "0.2", "how far noise moves the veins"),
            number("scale", ANY, "1", "factor on coordinates"),
            DIMENSION,
        ],
        groups: &[&FRACTAL, &SHADES, &PATTERN, &MAPPING],
        source: "pbrt-v3, 10.6",
    },
    Model {
        kind: "facing",
        doc: "the cosine between the surface's normal and a direction, without its sign",
        parameters: &[DIRECTION, FROM_WORLD, NO_FREQUENCY],
        groups: &[&SHADES, &PATTERN],
        source: "pbrt-v4: directionmix",
    },
    Model {
        kind: "direction_mix",
        doc: "between two values by the cosine between normal and direction",
        parameters: &[
            tex("a", ANY, "0", "where the surface faces the direction"),
            tex("b", ANY, "1", "where it is seen from the side"),
            DIRECTION,
            FROM_WORLD,
            NO_FREQUENCY,
        ],
        groups: &[&PATTERN],
        source: "pbrt-v4, 10.3",
    },
    Model {
        kind: "grid",
        doc: "numbers or colours on a grid in space, over the unit cube",
        parameters: &[
            file("file", "needed", "the grid: Mitsuba's .vol"),
            word("filter", "trilinear, tetrahedral, nearest", "trilinear", "interpolation between samples"),
            word("wrap", "clamp, repeat, mirror, black", "clamp", "what lies outside of the cube"),
            number("scale", ANY, "1", "factor on its values"),
            flag("use_grid_bounds", "false", "whether the file's own box takes the place of the unit cube"),
            FROM_WORLD,
        ],
        groups: &[],
        source: "Mitsuba 3, plugin documentation: gridvolume",
    },
    Model {
        kind: "scale",
        doc: "the product of two textures",
        parameters: &[tex("texture", ANY, "1", "one factor"), tex("scale", ANY, "1", "the other")],
        groups: &[],
        source: "pbrt-v4, 10.3",
    },
    Model {
        kind: "add",
        doc: "the sum of two textures",
        parameters: &[tex("a", ANY, "0", "one of them"), tex("b", ANY, "0", "the other")],
        groups: &[],
        source: "",
    },
    Model {
        kind: "mix",
        doc: "linear between two textures",
        parameters: &[
            tex("a", ANY, "0", "where the amount is 0"),
            tex("b", ANY, "1", "where it is 1"),
            tex("amount", ANY, "0.5", "share of b; beyond [0, 1] it extrapolates, as in pbrt"),
        ],
        groups: &[],
        source: "pbrt-v4, 10.3",
    },
    Model {
        kind: "triplanar",
        doc: "three projections along the axes, blended by the normal",
        parameters: &[
            tex("texture", ANY, "none", "for all axes: its images and flat patterns are projected along each"),
            tex("x", ANY, "texture; 1 without it", "seen along x"),
            tex("y", ANY, "texture; 1 without it", "seen along y"),
            tex("z", ANY, "texture; 1 without it", "seen along z"),
            integer("sharpness", ANY, "4", "exponent of the weights; held in [1, 64]"),
            FROM_WORLD,
        ],
        groups: &[],
        source: "",
    },
    Model {
        kind: "ramp",
        doc: "a colour for a number",
        parameters: &[
            INPUT,
            PLACES,
            list("colors", "needed", "linear colours at the places, three numbers each"),
            INTERPOLATION,
        ],
        groups: &[],
        source: "",
    },
    Model {
        kind: "curve",
        doc: "a curve applied to each component",
        parameters: &[INPUT, PLACES, list("values", "needed", "values at the places"), INTERPOLATION],
        groups: &[],
        source: "",
    },
    Model {
        kind: "channel",
        doc: "one number of a colour",
        parameters: &[INPUT, word("channel", "r, g, b, luminance, mean, max", "r", "which")],
        groups: &[],
        source: "",
    },
    Model {
        kind: "color_space",
        doc: "linear colours of another space",
        parameters: &[
            INPUT,
            word("from", "srgb, dci-p3, rec2020, aces", "srgb", "the space that colours are read in"),
            word("to", "srgb, dci-p3, rec2020, aces", "srgb", "the space that they are written in"),
            list("matrix", "none", "nine numbers by rows, instead of both"),
        ],
        groups: &[],
        source: "",
    },
    Model {
        kind: "hsv",
        doc: "turned hue, scaled saturation and value",
        parameters: &[
            INPUT,
            number("hue", ANY, "0", "what is added to the hue").unit("degrees"),
            number("saturation", ANY, "1", "factor; below 0 counts as 0"),
            number("value", ANY, "1", "factor"),
        ],
        groups: &[],
        source: "Smith, Color gamut transform pairs (1978)",
    },
    Model {
        kind: "expression",
        doc: "a number by a formula, or a colour by three; taken at points, so small detail needs samples; 0 where it \
         is not defined",
        parameters: &[
            text("expression", "needed, or three colours", FORMULA),
            text("red", "none", "a formula of red, linear Rec.709, in place of 'expression'"),
            text("green", "none", "of green"),
            text("blue", "none", "of blue"),
        ],
        groups: &[&MAPPING],
        source: "",
    },
    Model {
        kind: "time",
        doc: "the moment of the exposure, from 0 as the shutter opens to 1: with ramp and curve parameters that \
         vary over it (opacities and displacement are taken at 0)",
        parameters: &[],
        groups: &[],
        source: "",
    },
    Model {
        kind: "mesh_attribute",
        doc: "a vertex or face attribute of the mesh",
        parameters: &[
            text("name", "needed", "its name, without a prefix for the domain"),
            word("domain", "vertex, face", "none", "what it has a value for; where absent, whichever there is"),
            number("scale", ANY, "1", "factor on its values"),
        ],
        groups: &[],
        source: "Mitsuba 3, plugin documentation: mesh_attribute",
    },
];

const PLACES: Parameter = list("places", "evenly spaced from 0 to 1", "numbers that rise, one for each value");
const INTERPOLATION: Parameter =
    word("interpolation", "linear, step, smooth, catmull_rom, bezier", "linear", "what lies between two places");

/// Parameters of picture files: decoding and lookup.
pub static PICTURE: Group = Group {
    name: "picture",
    doc: "how a picture is read and looked up",
    parameters: &[
        word(
            "filter",
            "nearest, bilinear, bicubic, mitchell, bspline, catmull_rom, lanczos, spline, sinc, trilinear, ripmap, box, \
             ewa",
            "bilinear",
            "interpolation at points up to sinc (bicubic is mitchell; spline is exact for cubics, and sinc, which looks \
             at all texels of a small picture that repeats, for what is band-limited), then averages over the footprint",
        ),
        number("max_anisotropy", ANY, "8", "greatest ratio of a footprint's axes; held in [1, 64]")
            .with("filter", "ewa"),
        word("mip_filter", "box, gaussian, lanczos, kaiser", "box", "how smaller levels are made"),
        number(
            "keep_coverage",
            ANY,
            "none",
            "opacity at which smaller levels keep the picture's coverage; colours are then weighted by alpha. \
             For pictures \
             that something compares with a threshold: masks and alpha are passed by chance, for which plain \
              means are right",
        ),
        flag(
            "bleed",
            "false",
            "whether texels of no opacity take the colour of their neighbours, for pictures whose alpha is opacity",
        ),
        flag("stochastic", "false", "whether one texel is taken at random, which is the filter's value in the mean"),
        word("channel", "color, r, g, b, a", "color", "all of it, or one number; a is 1 in a picture without alpha"),
        word(
            "wrap_u",
            WRAPS,
            "repeat",
            "what lies beyond the sides: octahedral joins edges as on the sphere, on both axes",
        ),
        word("wrap_v", WRAPS, "repeat", "what lies beyond top and bottom"),
        vector("border", "0,0,0", "linear colour beyond the edges where wrap_u or wrap_v is border"),
        Parameter::new(
            Type::WordOrNumber("auto, srgb, linear"),
            "encoding",
            ANY,
            "auto",
            "how stored values encode light; a number, above 0, is a gamma exponent",
        ),
        flag("raw", "false", "whether its values are numbers, not colours: encoding is then linear"),
        word("origin", "bottom, top", "bottom", "where v = 0 is: at the last row (pbrt), or at the first"),
        flag("invert", "false", "whether values are one minus what is stored"),
    ],
    source: "",
};

const WRAPS: &str = "repeat, mirror, clamp, octahedral, border, black, one";

/// Mappings from a point of a surface to texture coordinates.
pub static MAPPING: Group = Group {
    name: "mapping",
    doc: "from a point of a surface to texture coordinates: first the mapping, then scale_u to delta_v, then \
     to_uv or glTF's transform",
    parameters: &[
        word(
            "mapping",
            "uv, spherical, cylindrical, planar, cube, triangle, two_part",
            "uv",
            "where coordinates come from: all but uv from the point in the space of the texture",
        ),
        text("uv_set", "none", "a vertex attribute of two components, instead of the mesh's own coordinates")
            .with("mapping", "uv"),
        vector("v1", "1,0,0", "the vector that u is measured along").with("mapping", "planar"),
        vector("v2", "0,1,0", "the vector that v is measured along").with("mapping", "planar"),
        list("corners", "needed", "nine numbers: a triangle's corners in the space of the texture")
            .with("mapping", "triangle"),
        list("corner_uvs", "needed", "six numbers: its corners' coordinates").with("mapping", "triangle"),
        word(
            "object_map",
            "centroid, reflection, normal, proxy_normal",
            "centroid",
            "where on the surface around it: where the line from the origin through the point leads, the \
             reflected line of \
             sight, or the normal, or the point whose own normal leads here",
        )
        .with("mapping", "two_part"),
        word(
            "surface",
            "sphere, plane, cylinder, cube",
            "sphere",
            "the surface around it, about the origin of the space of the texture, of radius 1",
        )
        .with("mapping", "two_part"),
        number("scale_u", ANY, "1", "factor on u"),
        number("scale_v", ANY, "1", "factor on v"),
        number("delta_u", ANY, "0", "what is added to u"),
        number("delta_v", ANY, "0", "what is added to v"),
        transform("to_uv", "identity", "of coordinates; without effect beside glTF's"),
        list("khr_offset", "none", "glTF's offset, two numbers"),
        number("khr_rotation", ANY, "0", "glTF's rotation").unit("degrees"),
        list("khr_scale", "none", "glTF's scale, two numbers"),
        FROM_WORLD,
    ],
    source: "Bier, Sloan, Two-part texture mappings (1986); Khronos Group, KHR_texture_transform",
};

/// Parameters that map a pattern's number: factor, offset and filtering.
pub static PATTERN: Group = Group {
    name: "pattern",
    doc: "what is done with the number of a pattern",
    parameters: &[
        number("gain", ANY, "1", "factor on it"),
        number("offset", ANY, "0", "what is added to it"),
        flag("antialias", "true", "whether it is averaged over the footprint"),
        number(
            "width_filter",
            ANY,
            "0",
            "least width of that average, in the space of the texture; below 0 counts as 0",
        ),
    ],
    source: "",
};

/// Parameters of the two shades between which a pattern interpolates.
pub static SHADES: Group = Group {
    name: "shades",
    doc: "where either is given, the texture leads from a to b by the number of the pattern; else it is that number",
    parameters: &[
        tex("a", ANY, "none; 0 beside b", "where the number is 0"),
        tex("b", ANY, "none; 1 beside a", "where it is 1"),
    ],
    source: "",
};

/// Octaves of noise.
pub static FRACTAL: Group = Group {
    name: "fractal",
    doc: "octaves of noise",
    parameters: &[
        integer("octaves", (0.0, f64::INFINITY), "8", "how many; at most 32 count").refused(),
        number("roughness", (-1e3, 1e3), "0.5", "factor on the amplitude from one octave to the next").refused(),
        number("lacunarity", POSITIVE, "1.99", "factor on the frequency; at most 1000 counts").refused(),
        BASIS,
        SEED,
    ],
    source: "Ebert et al., Texturing and Modeling, 3rd ed. (2003)",
};
