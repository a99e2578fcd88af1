//! Films, pixel filters and samplers.

use crate::{
    model::{Group, Model},
    parameter::{ANY, POSITIVE, Parameter, Type, integer, number, text},
};

/// Longest side of a film, pixels.
pub const MAX_SIDE: f64 = 1_048_576.0;

const PARAMETERS: &[Parameter] = &[
    integer("width", (1.0, MAX_SIDE), "1280; 768 in Mitsuba scenes", "width").unit("pixels").refused(),
    integer("height", (1.0, MAX_SIDE), "720; 576 in Mitsuba scenes", "height").unit("pixels").refused(),
    Parameter::new(
        Type::Integers,
        "crop",
        ANY,
        "none",
        "the part that is rendered: x0 x1 y0 y1, the last ones exclusive; held on the film",
    )
    .unit("pixels"),
    number("iso", POSITIVE, "100", "sensitivity: the picture's factor is exposure_time · iso / 100").refused(),
    number("exposure_time", POSITIVE, "1", "exposure time").unit("s").refused(),
    text(
        "sensor",
        "cie1931",
        "the CIE 1931 observer, or a camera by its name in pbrt-v4, such as nikon_d850 (docs/sensors.md)",
    ),
    number(
        "white_balance",
        (0.0, 25_000.0),
        "0; 6500 for cameras",
        "colour temperature of daylight that is seen as white; 0 for no balance",
    )
    .unit("K")
    .refused(),
    number("max_component", POSITIVE, "none", "samples whose largest component is above are scaled down to it")
        .refused(),
    number("full_well", (f64::MIN_POSITIVE, 1e9), "none", "electrons of a full pixel; with it the picture has noise")
        .unit("e⁻")
        .refused(),
    number("read_noise", (0.0, 1e6), "0", "standard deviation of reading a pixel")
        .unit("e⁻")
        .refused()
        .where_given("full_well"),
    number("dark_current", (0.0, 1e9), "0", "electrons that come without light; their mean is subtracted")
        .unit("e⁻/s")
        .refused()
        .where_given("full_well"),
    integer("bits", (1.0, 24.0), "14", "of the converter; a value of 1 is its last code")
        .refused()
        .where_given("full_well"),
    integer("noise_seed", ANY, "0", "chooses among equally likely pictures").where_given("full_well"),
    text("filename", "none", "without effect: the command line names outputs"),
];

/// Parameters that all films have.
pub static ANY_FILM: Group =
    Group { name: "frame", doc: "size, exposure, sensor", parameters: PARAMETERS, source: "pbrt-v4, 5.4" };

/// Wavelengths that films can have bands of, nm.
const WAVELENGTHS: (f64, f64) = (360.0, 830.0);

/// All films; R, G and B of the three are the same.
pub const FILMS: &[Model] = &[
    Model { kind: "rgb", doc: "colours", parameters: &[], groups: &[&ANY_FILM], source: "pbrt-v4, 5.4" },
    Model {
        kind: "gbuffer",
        doc: "colours, and the layers albedo, normal, geometric_normal, position, uv and variance",
        parameters: &[],
        groups: &[&ANY_FILM],
        source: "pbrt-v4, 5.4.5",
    },
    Model {
        kind: "spectral",
        doc: "colours, and the mean spectral radiance in bands of wavelengths",
        parameters: &[
            number("lambda_min", WAVELENGTHS, "360", "where the first band begins").unit("nm").refused(),
            number("lambda_max", WAVELENGTHS, "830", "where the last band ends").unit("nm").refused(),
            integer("buckets", (1.0, 256.0), "16", "number of bands, which have equal widths").refused(),
            Parameter::new(
                Type::Maps,
                "bands",
                ANY,
                "none",
                "sensitivities of named bands instead, as textures 'constant' by their names; a band is the integral \
                 of radiance times sensitivity over wavelengths",
            ),
        ],
        groups: &[&ANY_FILM],
        source: "pbrt-v4, 5.4.6; Mitsuba's specfilm; Fichet, Pacanowski, Wilkie, An OpenEXR Layout for Spectral Images \
                 (2021)",
    },
];

const fn radius_x(default: &'static str) -> Parameter {
    number("radius_x", POSITIVE, default, "half width").unit("pixels").refused()
}

const fn radius_y(default: &'static str) -> Parameter {
    number("radius_y", POSITIVE, default, "half height").unit("pixels").refused()
}

/// All pixel filters.
pub const FILTERS: &[Model] = &[
    Model {
        kind: "box",
        doc: "constant over the radius",
        parameters: &[radius_x("0.5"), radius_y("0.5")],
        groups: &[],
        source: "pbrt-v4, 8.8",
    },
    Model {
        kind: "tent",
        doc: "linear falloff",
        parameters: &[radius_x("1"), radius_y("1")],
        groups: &[],
        source: "pbrt-v4, 8.8",
    },
    Model {
        kind: "gaussian",
        doc: "a Gaussian less its value at the radius",
        parameters: &[
            radius_x("1.5"),
            radius_y("1.5"),
            number("sigma", POSITIVE, "0.5", "standard deviation").unit("pixels").refused(),
        ],
        groups: &[],
        source: "pbrt-v4, 8.8",
    },
    Model {
        kind: "mitchell",
        doc: "Mitchell and Netravali's cubic",
        parameters: &[
            radius_x("2"),
            radius_y("2"),
            number("b", ANY, "0.3333333333333333", "the cubic's B"),
            number("c", ANY, "0.3333333333333333", "the cubic's C"),
        ],
        groups: &[],
        source: "Mitchell, Netravali, Reconstruction filters in computer graphics (1988)",
    },
    Model {
        kind: "catmull_rom",
        doc: "the same cubic at B = 0, C = 1/2",
        parameters: &[radius_x("2"), radius_y("2")],
        groups: &[],
        source: "Catmull, Rom, A class of local interpolating splines (1974)",
    },
    Model {
        kind: "lanczos",
        doc: "a windowed sinc",
        parameters: &[radius_x("3"), radius_y("3"), number("tau", POSITIVE, "3", "lobes over the radius").refused()],
        groups: &[],
        source: "Duchon, Lanczos filtering in one and two dimensions (1979)",
    },
    Model {
        kind: "blackman_harris",
        doc: "the Blackman–Harris window",
        parameters: &[radius_x("1.5"), radius_y("1.5")],
        groups: &[],
        source: "Harris, On the use of windows for harmonic analysis (1978)",
    },
];

const SAMPLER: &[Parameter] = &[
    integer("samples", (1.0, f64::INFINITY), "16", "samples of a pixel; at most 16777216 count").refused(),
    integer("seed", ANY, "0", "number of the random sequence"),
];

const fn sampler(kind: &'static str, doc: &'static str, source: &'static str) -> Model {
    Model { kind, doc, parameters: SAMPLER, groups: &[], source }
}

/// All samplers. Scenes of Steradian's own get the one they name, others the default unless the user decides.
pub const SAMPLERS: &[Model] = &[
    sampler(
        "zsobol",
        "Owen-scrambled Sobol' pairs, shared along a Z-curve so that the error is blue noise; the default",
        "Ahmed, Wonka, Screen-Space Blue-Noise Diffusion of Monte Carlo Sampling Error via Hierarchical \
         Ordering of Pixels (2020)",
    ),
    sampler(
        "sobol",
        "Owen-scrambled Sobol' pairs, shuffled per dimension; pixels are independent",
        "Burley, Practical Hash-based Owen Scrambling (2020)",
    ),
    sampler("halton", "Halton points with Owen-scrambled digits", "Owen (1995)"),
    sampler(
        "pmj02",
        "progressive multi-jittered (0,2) points that keep a distance; for powers of two of samples",
        "Christensen, Kensler, Kilpatrick, Progressive Multi-Jittered Sample Sequences (2018)",
    ),
    sampler(
        "lattice",
        "an extensible rank-1 lattice, shifted at random",
        "Cools, Kuo, Nuyens (2006); Cranley, Patterson (1976)",
    ),
    sampler(
        "multijitter",
        "correlated multi-jittering; the number of samples must be known",
        "Kensler, Correlated Multi-Jittered Sampling (2013)",
    ),
    sampler(
        "stratified",
        "jittered strata over the samples of a pixel, shuffled per dimension; the number of samples must be known",
        "",
    ),
    sampler("independent", "independent uniform random numbers", ""),
    sampler(
        "fixed",
        "independent uniform random numbers, one list for all pixels: errors form patterns, as a lesson",
        "",
    ),
];
