//! Integrators and their options by name: what the command line, files and messages know of them.

/// An option of an integrator, written `name=value`.
#[derive(Clone, Copy, Debug)]
pub struct OptionInfo {
    /// Its name.
    pub name: &'static str,
    /// The values that it takes.
    pub values: &'static str,
    /// The value where none is given.
    pub default: &'static str,
    /// What it decides.
    pub meaning: &'static str,
}

/// An integrator.
#[derive(Clone, Copy, Debug)]
pub struct IntegratorInfo {
    /// Its name.
    pub name: &'static str,
    /// What it computes, in a line.
    pub description: &'static str,
    /// Its options.
    pub options: &'static [OptionInfo],
}

/// An option.
pub const fn option(
    name: &'static str,
    values: &'static str,
    default: &'static str,
    meaning: &'static str,
) -> OptionInfo {
    OptionInfo { name, values, default, meaning }
}

const fn method(name: &'static str, description: &'static str, options: &'static [OptionInfo]) -> IntegratorInfo {
    IntegratorInfo { name, description, options }
}

const MAX_DEPTH: OptionInfo =
    option("max_depth", "whole number, -1: no limit", "the scene's", "most scattering events");
const RR_DEPTH: OptionInfo =
    option("rr_depth", "whole number", "the scene's", "scattering events before Russian roulette");
const HIDE_EMITTERS: OptionInfo =
    option("hide_emitters", "true, false", "the scene's", "whether camera rays pass lights, to what is behind them");
const REUSE: OptionInfo =
    option("reuse", "1, 4, 16, auto", "auto", "neighbouring pixels that share what their paths find; auto: by a trial");
const CAUSTICS: OptionInfo = option(
    "caustics",
    "true, false, auto",
    "auto",
    "whether photons guide paths to light behind mirrors and glass; auto: by a trial",
);
const EFFORT: OptionInfo = option(
    "effort",
    "even, auto",
    "auto",
    "whether trials choose light samples, roulette, and paths per sample by parts of the picture",
);
const RADIUS: OptionInfo = option("radius", "length above 0", "by pixels", "radius in which photons are gathered");
const PHOTONS: OptionInfo = option("photons", "whole number, 0: by pixels", "0", "photons of a pass");
const GUIDED_PATHS: &[OptionInfo] = &[MAX_DEPTH, RR_DEPTH, HIDE_EMITTERS, REUSE, CAUSTICS, EFFORT];
const PATHS: &[OptionInfo] = &[MAX_DEPTH, RR_DEPTH, HIDE_EMITTERS];

const fn pixels(default: &'static str) -> OptionInfo {
    option("pixels", "number above 0", default, "radius in which photons are gathered, in widths of a pixel")
}

/// The integrators.
pub const INTEGRATORS: &[IntegratorInfo] = &[
    method("path", "path tracing", GUIDED_PATHS),
    method("volpath", "path tracing with participating media", GUIDED_PATHS),
    method("direct", "direct light", &[HIDE_EMITTERS]),
    method(
        "whitted",
        "Whitted ray tracing: mirrors, glass, and direct light from every light",
        &[MAX_DEPTH, HIDE_EMITTERS],
    ),
    method(
        "ao",
        "ambient occlusion",
        &[option("distance", "length above 0", "no limit", "how far away something may be to stop light")],
    ),
    method("raycast", "the colour of the first surface", &[HIDE_EMITTERS]),
    method(
        "radiosity",
        "radiosity of Lambertian patches",
        &[
            option(
                "method",
                "gauss-seidel, jacobi, direct, shooting, hierarchical, stochastic",
                "gauss-seidel",
                "how the system is solved",
            ),
            option("factors", "analytic, montecarlo, hemicube", "analytic", "how form factors are computed"),
            option("resolution", "2 to 4096", "1000 or 64", "rays of a patch, or pixels of an edge of the hemicube"),
            option("patches", "1 to 2000000", "2000", "patches of the scene; finer meshes share their light"),
            option("adaptive", "0 to 8", "1", "how often patches are split that differ most from their neighbours"),
            option(
                "tolerance",
                "above 0, below 1",
                "0.0001",
                "relative change, or share of light unshot, that ends solving",
            ),
            option("rays", "1 to 1000000", "1000", "rays of a patch, of method=stochastic"),
            option("wavelengths", "4 to 256", "32", "wavelengths of a spectral solution"),
            option(
                "ambient",
                "true, false",
                "false",
                "of method=shooting: whether light that is not shot is shown as ambient",
            ),
            option("gather", "0 to 4096", "0", "rays of a final gather for each camera sample"),
            option("smooth", "true, false", "true", "whether irradiance is interpolated between vertices"),
            option("solution", "a file", "none", "where the solution is kept for further views"),
            MAX_DEPTH,
            HIDE_EMITTERS,
        ],
    ),
    method("light", "light tracing: paths from lights to the camera", PATHS),
    method("bdpt", "bidirectional path tracing", PATHS),
    method("vcm", "vertex connection and merging", &[MAX_DEPTH, RR_DEPTH, HIDE_EMITTERS, RADIUS, pixels("0.6")]),
    method(
        "sppm",
        "stochastic progressive photon mapping",
        &[MAX_DEPTH, RR_DEPTH, HIDE_EMITTERS, RADIUS, pixels("3"), PHOTONS],
    ),
    method(
        "photon",
        "photon mapping",
        &[
            MAX_DEPTH,
            RR_DEPTH,
            HIDE_EMITTERS,
            RADIUS,
            pixels("1"),
            PHOTONS,
            option("nearest", "whole number, 0: all", "0", "most photons that are gathered at a point"),
            option("gather", "true, false", "true", "whether the map is looked up one bounce further on"),
        ],
    ),
    method(
        "pssmlt",
        "Metropolis light transport in primary sample space",
        &[
            MAX_DEPTH,
            RR_DEPTH,
            HIDE_EMITTERS,
            option(
                "large_step",
                "above 0, up to 1",
                "0.3",
                "probability of a path that is independent of the last one",
            ),
        ],
    ),
    method(
        "transient",
        "path tracing that tells when light of one pulse arrives: a layer bin.NNN of each interval",
        &[
            option("from", "number of metres", "0", "the optical length where the first interval begins"),
            option("to", "number of metres, more than from", "10", "the optical length where the last interval ends"),
            option("bins", "1 to 1024", "32", "into how many intervals of the same length that is cut"),
            option("unit", "above 0", "1", "metres of a unit of the scene"),
            option("camera", "true, false", "true", "whether the way from the camera to what it sees counts"),
            MAX_DEPTH,
            RR_DEPTH,
            HIDE_EMITTERS,
        ],
    ),
    method("stokes", "path tracing of polarised light: radiance S0", PATHS),
    method("stokes-s1", "polarised light: S1, horizontal minus vertical (may be negative)", PATHS),
    method("stokes-s2", "polarised light: S2, diagonal (may be negative)", PATHS),
    method("stokes-s3", "polarised light: S3, circular (may be negative)", PATHS),
];
