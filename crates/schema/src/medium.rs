//! Participating media and phase functions.

use crate::{
    model::{Group, Model},
    parameter::{ANY, Parameter, Type, file, integer, list, number, spectrum, tex, transform, vector},
};

const SIGMA_A: Parameter = spectrum("sigma_a", ANY, "0", "absorption").unit("per scene unit");
const SIGMA_S: Parameter = spectrum("sigma_s", ANY, "0", "scattering").unit("per scene unit");
const SIGMA_T: Parameter =
    spectrum("sigma_t", ANY, "none; 1 beside albedo", "extinction, with albedo instead of sigma_a and sigma_s")
        .unit("per scene unit");
const ALBEDO: Parameter = spectrum("albedo", ANY, "none; 0.75 beside sigma_t", "share of the extinction that scatters");
const SCALE: Parameter = number("scale", (0.0, f64::INFINITY), "1", "factor on all coefficients").refused();
const PHASE: Parameter = Parameter::new(Type::Phase, "phase", ANY, "none", "phase function");
const G: Parameter = number(
    "g",
    ANY,
    "0",
    "mean cosine of Henyey and Greenstein's phase function where there is no phase; refused up to -1 and from 1",
);
const LESCALE: Parameter = Parameter::new(
    Type::NumberOrList,
    "Lescale",
    ANY,
    "1",
    "factor on what is emitted, or as many as there are cells; a single one below 0 counts as 0",
);
const TEMPERATURE_OFFSET: Parameter =
    number("temperatureoffset", ANY, "0", "what is taken from the temperature, after interpolation").unit("K");
const TEMPERATURE_SCALE: Parameter = number("temperaturescale", ANY, "1", "factor on the temperature, after that");
const LE_GRID: Parameter =
    list("Le", "none", "emitted radiance: as many linear colours as there are cells, three numbers each");
const LE_OR_GRID: Parameter = Parameter::new(
    Type::SpectrumOrList,
    "Le",
    ANY,
    "none",
    "emitted radiance: a number or colour, another spectrum, which is divided by its luminance, or as many linear \
     colours as there are cells",
);

/// All media.
pub const MEDIA: &[Model] = &[
    Model {
        kind: "homogeneous",
        doc: "the same everywhere",
        parameters: &[
            SIGMA_A,
            SIGMA_S,
            SIGMA_T,
            ALBEDO,
            SCALE,
            PHASE,
            G,
            spectrum(
                "Le",
                ANY,
                "none",
                "emitted radiance, times absorption and length; spectra that are neither colours nor plain \
                 numbers are divided by their luminance",
            ),
            number("Lescale", ANY, "1", "factor on what is emitted; below 0 counts as 0"),
        ],
        groups: &[],
        source: "pbrt-v4, 11.4",
    },
    Model {
        kind: "uniformgrid",
        doc: "coefficients times a density on a grid",
        parameters: &[
            SIGMA_A,
            SIGMA_S,
            SIGMA_T,
            ALBEDO,
            SCALE,
            PHASE,
            G,
            list("density", "needed", "as many numbers as there are cells"),
            LE_OR_GRID,
        ],
        groups: &[&CELLS, &BOX, &GLOW],
        source: "pbrt-v4, 11.4",
    },
    Model {
        kind: "rgbgrid",
        doc: "coefficients on a grid",
        parameters: &[
            list("sigma_a", "1 everywhere", "absorption: as many linear colours as there are cells")
                .unit("per scene unit"),
            list("sigma_s", "1 everywhere", "scattering: as many linear colours as there are cells")
                .unit("per scene unit"),
            SCALE,
            PHASE,
            G,
            LE_GRID,
        ],
        groups: &[&CELLS, &BOX, &GLOW],
        source: "pbrt-v4, 11.4",
    },
    Model {
        kind: "cloud",
        doc: "coefficients times the density of a cloud of noise",
        parameters: &[
            SIGMA_A,
            SIGMA_S,
            SIGMA_T,
            ALBEDO,
            SCALE,
            PHASE,
            G,
            number("density", ANY, "1", "factor on the density"),
            number("wispiness", ANY, "1", "how far noise moves the noise"),
            number("frequency", ANY, "5", "factor on coordinates"),
            LE_OR_GRID,
        ],
        groups: &[&CELLS, &BOX, &GLOW],
        source: "pbrt-v4, 11.4",
    },
    Model {
        kind: "heterogeneous",
        doc: "extinction and albedo on grids (Mitsuba's); it fills the box, parallel to the world's axes, \
         around the unit cube of sigma_t's grid",
        parameters: &[
            tex("sigma_t", ANY, "1", "extinction: constant, or a texture grid, of which filter and wrap count")
                .unit("per scene unit"),
            tex("albedo", ANY, "0.75", "share of the extinction that scatters: constant, or a texture grid"),
            SCALE,
            PHASE,
            G,
            transform("to_world", "identity", "places the unit cube where sigma_t is constant"),
            LE_GRID,
        ],
        groups: &[&CELLS, &GLOW],
        source: "Mitsuba 3, plugin documentation: heterogeneous",
    },
    Model {
        kind: "vdb",
        doc: "coefficients times a density on the grid of a volume file, where the file places it; numbers stand at \
         indices, are linear in between, and fade to zero within a voxel outside of the active ones; with a grid of \
         temperatures it glows as a black body whose spectrum's largest value is Lescale",
        parameters: &[
            file("file", "needed", "the volume: NanoVDB's .nvdb or OpenVDB's .vdb"),
            Parameter::new(Type::Text, "grid", ANY, "density", "name of the grid of densities"),
            Parameter::new(
                Type::Text,
                "temperature_grid",
                ANY,
                "temperature",
                "name of the grid of temperatures, if any",
            ),
            SIGMA_A,
            SIGMA_S,
            SIGMA_T,
            ALBEDO,
            SCALE,
            PHASE,
            G,
            number("Lescale", ANY, "1", "factor on what is emitted; below 0 counts as 0"),
            TEMPERATURE_OFFSET,
            TEMPERATURE_SCALE,
            transform("to_world", "identity", "places the file's own world"),
        ],
        groups: &[],
        source: "Museth, NanoVDB: A GPU-friendly and portable VDB data structure (2021); pbrt-v4, 11.4",
    },
];

/// All phase functions.
pub const PHASES: &[Model] = &[
    Model { kind: "isotropic", doc: "the same in all directions", parameters: &[], groups: &[], source: "" },
    Model {
        kind: "hg",
        doc: "Henyey and Greenstein's",
        parameters: &[number("g", ANY, "0.8", "mean cosine; refused up to -1 and from 1")],
        groups: &[],
        source: "Henyey, Greenstein, Diffuse radiation in the galaxy (1941)",
    },
    Model {
        kind: "rayleigh",
        doc: "Rayleigh's, of particles much smaller than the wavelength: 3 (1 + cos²)/(16π)",
        parameters: &[],
        groups: &[],
        source: "Rayleigh, On the light from the sky, its polarization and colour (1871)",
    },
    Model {
        kind: "draine",
        doc: "Draine's, between Henyey and Greenstein's (alpha 0) and Cornette and Shanks's (alpha 1), and beyond: \
         grains of dust; in proportion to (1 + alpha cos²) / (1 + g² - 2 g cos)^1.5",
        parameters: &[
            number("g", (-0.999, 0.999), "0.6", "asymmetry").refused(),
            number("alpha", (0.0, 1e6), "1", "weight of the squared cosine").refused(),
        ],
        groups: &[],
        source: "Draine, Scattering by interstellar dust grains (2003)",
    },
    Model {
        kind: "droplets",
        doc: "of droplets of water in white light, fitted to Mie's theory: mist, fog, clouds",
        parameters: &[number("diameter", (5.0, 50.0), "20", "diameter of the droplets, micrometres").refused()],
        groups: &[],
        source: "Jendersie, d'Eon, An approximate Mie scattering function for fog and cloud rendering (2023)",
    },
    Model {
        kind: "tabulated",
        doc: "values at even steps of the cosine of the deflection, from back to straight on, linear in between",
        parameters: &[list("values", "needed", "two or more, in any scale, none below 0")],
        groups: &[],
        source: "Mitsuba 3, plugin documentation: tabphase",
    },
    Model {
        kind: "blend",
        doc: "a weighted sum of two",
        parameters: &[
            Parameter::new(Type::Phase, "first", ANY, "needed", "one phase function"),
            Parameter::new(Type::Phase, "second", ANY, "needed", "the other one"),
            number("weight", (0.0, 1.0), "0.5", "part of the second one").refused(),
        ],
        groups: &[],
        source: "Mitsuba 3, plugin documentation: blendphase",
    },
];

/// The box of a medium.
pub static BOX: Group = Group {
    name: "box",
    doc: "the box that the medium fills; outside of it there is nothing, so that the outermost half cells of a \
     grid fade",
    parameters: &[
        vector("p0", "0,0,0", "one corner"),
        vector("p1", "1,1,1", "the opposite one"),
        transform("to_world", "identity", "places the box"),
    ],
    source: "",
};

/// The cells of grids.
pub static CELLS: Group = Group {
    name: "cells",
    doc: "grids of nx × ny × nz numbers, x fastest, at the centres of the cells of the medium's box",
    parameters: &[
        integer("nx", (1.0, 1_048_576.0), "1", "cells along x").refused(),
        integer("ny", (1.0, 1_048_576.0), "1", "cells along y").refused(),
        integer("nz", (1.0, 1_048_576.0), "1", "cells along z").refused(),
    ],
    source: "",
};

/// Emission parameters of grid media.
pub static GLOW: Group = Group {
    name: "glow",
    doc: "what the medium gives off: by Le, or as a black body whose spectrum's largest value is Lescale",
    parameters: &[
        LESCALE,
        list("temperature", "none", "as many numbers as there are cells, instead of Le").unit("K"),
        TEMPERATURE_OFFSET,
        TEMPERATURE_SCALE,
    ],
    source: "pbrt-v4, 11.4",
};

/// Parameters of media of a program's own.
pub static OWN: Group = Group {
    name: "own_medium",
    doc: "coefficients of a medium, where the density that a program gives is one, its phase function and place",
    parameters: &[
        SIGMA_A,
        SIGMA_S,
        SIGMA_T,
        ALBEDO,
        SCALE,
        PHASE,
        G,
        transform("to_world", "identity", "places its box"),
    ],
    source: "",
};
