//! Lights: area lights of shapes, and lights without a shape.

use crate::{
    model::{Group, Model},
    parameter::{
        ANY, POSITIVE, Parameter, file, flag, integer, list, map, number, spectrum, tex, transform, vector, word,
    },
    texture::{MAPPING, PICTURE},
};

/// The colour white, which is D65 in spectral mode; the number 1 is the spectrum that is 1 everywhere.
const WHITE: &str = "1, 1, 1";
const SCALE: Parameter = number("scale", ANY, "1", "factor on what is emitted");
const NORMALIZE: Parameter =
    flag("normalize", "false", "whether a spectrum that is no colour is divided by its luminance, as in pbrt");
const POWER: Parameter =
    number("power", ANY, "none", "luminous flux, whatever the spectrum (of white with `normalize`); counts above 0")
        .unit("lm");
const ILLUMINANCE: Parameter = number(
    "illuminance",
    ANY,
    "none",
    "illuminance of a surface that faces it, whatever the spectrum (of white with `normalize`); counts above 0",
)
.unit("lx");
const INTENSITY: Parameter = spectrum("intensity", ANY, WHITE, "radiant intensity");
/// Parameters of every light: its timetable.
const SCHEDULE: Group = Group {
    name: "schedule",
    doc: "when a light shines, on the clock of the camera's `shutter_open` and `shutter_close`",
    parameters: &[
        number("on", ANY, "none", "when it goes on; it shone all the time before where it is absent").unit("s"),
        number("off", ANY, "none", "when it goes off, after `on`; never where it is absent").unit("s"),
        number("period", POSITIVE, "none", "after how long it goes on again and again, and went on before: a strobe")
            .unit("s")
            .refused(),
    ],
    source: "",
};
/// Parameters of lights of a program's own.
pub static OWN: Group = Group {
    name: "own_light",
    doc: "brightness and place of a light whose distribution is a program's own",
    parameters: &[
        INTENSITY,
        POWER,
        SCALE,
        NORMALIZE,
        vector("position", "0, 0, 0", "position"),
        transform("to_world", "identity", "places and turns it"),
    ],
    source: "",
};
const FILE_FIRST: &str = "a picture over u and v, instead of radiance";

/// Parameters of area lights, which shapes have.
const OF_SHAPES: &[Parameter] = &[
    tex("radiance", ANY, WHITE, "radiance"),
    flag("two_sided", "false", "whether both sides emit"),
    SCALE,
    NORMALIZE,
    POWER,
    file("file", "none", FILE_FIRST),
];

/// Parameters of skies with a sun: its position, brightness and size.
const SUN: Group = Group {
    name: "sun",
    doc: "where the sun of a sky is, how bright both are, and where its up is",
    parameters: &[
        number("latitude", (-90.0, 90.0), "35.6894", "north of the equator").unit("degrees").refused(),
        number("longitude", (-360.0, 360.0), "139.6917", "east of Greenwich").unit("degrees").refused(),
        number("timezone", (-24.0, 24.0), "9", "what local time is ahead of universal time by").unit("h").refused(),
        integer("year", (1.0, 9999.0), "2010", "year; the sun is within half a minute of arc from 1999 to 2015")
            .refused(),
        integer("month", (1.0, 12.0), "7", "month").refused(),
        integer("day", (1.0, 31.0), "10", "day of the month").refused(),
        number("hour", (0.0, 24.0), "15", "local time").unit("h").refused(),
        number("minute", (0.0, 60.0), "0", "what is added to the hour").unit("min").refused(),
        number("second", (0.0, 60.0), "0", "what is added to the minute").unit("s").refused(),
        vector("sun_direction", "none", "the way to the sun, in the world, instead of place and time"),
        number("sun_scale", (0.0, f64::INFINITY), "1", "factor on the sun; 0 leaves it out").refused(),
        number("sky_scale", (0.0, f64::INFINITY), "1", "factor on the sky; 0 leaves it out").refused(),
        number("sun_aperture", (0.01, 89.0), "0.5358", "whole angle of the sun's disc; its light stays the same")
            .unit("degrees")
            .refused(),
        number("scale", (0.0, f64::INFINITY), "1", "factor on both").refused(),
        transform("to_world", "identity", "turns it; of its own, +z is up, +x north and +y east"),
    ],
    source: "",
};
const GROUND: Parameter =
    spectrum("albedo", (0.0, 1.0), "0.3", "reflectance of the ground, which lights the sky again").refused();

/// Parameters of the Hošek–Wilkie sky, whose radiance is in W/(m² sr nm).
const OF_SKY: &[Parameter] = &[
    number("turbidity", (1.0, 10.0), "3", "haze: 2 is an arctic sky, 3 a clear one, 10 a humid day").refused(),
    GROUND,
    flag("limb_darkening", "true", "whether the sun's disc is darker at its edge, else it is even"),
    word(
        "sun_rgb",
        "exact, mitsuba",
        "exact",
        "the sun's colour in RGB: the spectrum's, or the coarse sum of Mitsuba's RGB variants, brighter by 5 to 9 %",
    ),
];

/// Parameters of the sky simulated from the air, whose radiance is in W/(m² sr nm).
const OF_ATMOSPHERE: &[Parameter] = &[
    number("altitude", (0.0, 50_000.0), "0", "of the viewer above the ground, which is at sea level")
        .unit("m")
        .refused(),
    number("pressure", (0.0, 5000.0), "1013.25", "of the air at sea level; 0 leaves its molecules out")
        .unit("hPa")
        .refused(),
    number("ozone", (0.0, 2000.0), "300", "column of ozone above sea level").unit("Dobson units").refused(),
    number("aerosol", (0.0, 5.0), "0.1", "vertical optical depth of aerosols at 550 nm: 0.05 very clear, 0.4 hazy")
        .refused(),
    number("angstrom", (-1.0, 4.0), "1.3", "Ångström's exponent: their depth goes with the wavelength to minus this")
        .refused(),
    number("aerosol_albedo", (0.0, 1.0), "0.95", "the part of what aerosols take out of light that they scatter")
        .refused(),
    number("aerosol_height", (100.0, 20_000.0), "1500", "scale height over which aerosols thin").unit("m").refused(),
    number("g", (-0.9, 0.9), "0.7", "mean cosine of the angle that aerosols scatter by (Henyey, Greenstein)").refused(),
    GROUND,
    word("scattering", "multiple, single", "multiple", "whether light is scattered as often as it may be, or once"),
    flag("limb_darkening", "true", "whether the sun's disc is darker at its edge"),
];

/// All lights.
pub const LIGHTS: &[Model] = &[
    Model {
        kind: "area",
        doc: "emission of a shape, wherever its group is placed, and where it moves; `power` is that of the shape in its \
         group; where an opacity cuts a part away that does not shine; picture and mapping are of its file",
        parameters: OF_SHAPES,
        groups: &[&PICTURE, &MAPPING, &SCHEDULE],
        source: "pbrt-v4, 12.4",
    },
    Model {
        kind: "directional_area",
        doc: "emission of a flat shape along its normal alone (Mitsuba's directionalarea); picture and mapping \
         are of its file",
        parameters: OF_SHAPES,
        groups: &[&PICTURE, &MAPPING, &SCHEDULE],
        source: "Mitsuba 3, plugin documentation: directionalarea",
    },
    Model {
        kind: "point",
        doc: "the same in all directions, from a point",
        parameters: &[
            INTENSITY,
            vector("position", "0,0,0", "where it is"),
            SCALE,
            NORMALIZE,
            POWER,
            transform("to_world", "identity", "places it"),
        ],
        groups: &[&SCHEDULE],
        source: "pbrt-v4, 12.2",
    },
    Model {
        kind: "spot",
        doc: "a cone of light from a point",
        parameters: &[
            INTENSITY,
            number(
                "cone_angle",
                POSITIVE,
                "30",
                "angle between the axis and the end of the light; held in [0.001, 180]",
            )
            .unit("degrees")
            .refused(),
            number(
                "falloff_start",
                ANY,
                "25",
                "angle between the axis and where light begins to fade; held in [0, cone_angle]",
            )
            .unit("degrees"),
            word(
                "falloff",
                "smoothstep, linear, quadratic",
                "smoothstep",
                "how it fades: as in pbrt, as in Mitsuba, or as in glTF",
            ),
            map("texture", "none", "a slide in front of it"),
            SCALE,
            NORMALIZE,
            POWER,
            transform("to_world", "identity", "places it; its own +z is the axis"),
        ],
        groups: &[&SCHEDULE],
        source: "pbrt-v4, 12.2.1; Mitsuba 3, plugin documentation: spot",
    },
    Model {
        kind: "distant",
        doc: "parallel light",
        parameters: &[
            spectrum("radiance", ANY, WHITE, "irradiance of a plane that faces it"),
            vector("direction", "0,0,1", "the way the light travels, in the world; it has a length"),
            SCALE,
            NORMALIZE,
            ILLUMINANCE,
        ],
        groups: &[&SCHEDULE],
        source: "pbrt-v4, 12.3",
    },
    Model {
        kind: "environment",
        doc: "light from all directions, constant or a picture",
        parameters: &[
            spectrum("radiance", ANY, WHITE, "radiance, or factor on the picture"),
            file("file", "none", "the picture"),
            word(
                "parametrization",
                "auto, latlong, octahedral, cube",
                "auto",
                "what the picture maps: auto is octahedral for square ones, cube for cube maps of DDS and KTX2 files, \
                 crosses of 4 x 3 or 3 x 4 faces and rows or columns of 6 (+x, -x, +y, -y, +z, -z), else by longitude \
                 and latitude",
            )
            .where_given("file"),
            word(
                "rows",
                "centers, poles",
                "centers",
                "where the rows of a latlong with +y up are: at the middle of strips, or the first and last at \
                 the poles (Mitsuba 3)",
            )
            .where_given("file"),
            SCALE,
            NORMALIZE,
            ILLUMINANCE,
            list("portal", "none", "twelve numbers: the corners of a rectangle that the light comes through"),
            transform(
                "to_world",
                "identity",
                "turns it; of its own, +y is up in a latlong (+z in pbrt scenes), +z in octahedral maps",
            ),
        ],
        groups: &[&SCHEDULE],
        source: "pbrt-v4, 12.5; Bitterli, Novák, Jarosz, Portal-masked environment map sampling (2015)",
    },
    Model {
        kind: "backdrop",
        doc: "what camera rays see where they meet nothing, in place of the light from infinity; it lights nothing, \
              and mirrors and glass show that light; a scene has one",
        parameters: &[
            spectrum("radiance", ANY, WHITE, "radiance, or factor on the picture"),
            file("file", "none", "the picture"),
            word(
                "parametrization",
                "auto, latlong, octahedral, cube",
                "auto",
                "what the picture maps, as of `environment`",
            )
            .where_given("file"),
            word(
                "rows",
                "centers, poles",
                "centers",
                "where the rows of a latlong with +y up are, as of `environment`",
            )
            .where_given("file"),
            SCALE,
            NORMALIZE,
            transform("to_world", "identity", "turns it; of its own, its up is as of `environment`"),
        ],
        groups: &[],
        source: "",
    },
    Model {
        kind: "ambient",
        doc: "a constant in place of light from all sides, of which surfaces reflect their 'ambient' part or their \
              albedo; whitted and raster:frame=forward alone have it, the other methods trace the light that it stands for",
        parameters: &[spectrum("radiance", ANY, "1", "ambient radiance"), SCALE, NORMALIZE],
        groups: &[],
        source: "Phong, Illumination for computer generated pictures (1975)",
    },
    Model {
        kind: "sky",
        doc: "the clear sky and the sun, by place and time; black below the horizon, and at night",
        parameters: OF_SKY,
        groups: &[&SUN, &SCHEDULE],
        source: "Hosek, Wilkie, An analytic model for full spectral sky-dome radiance (2012), Adding a solar-radiance \
                 function to the Hošek-Wilkie skylight model (2013); Blanco-Muriel et al., Computing the solar vector \
                 (2001)",
    },
    Model {
        kind: "atmosphere",
        doc: "the sky and the sun through simulated air, by place and time, in twilight too and from above; black \
              below the horizon",
        parameters: OF_ATMOSPHERE,
        groups: &[&SUN, &SCHEDULE],
        source: "Bodhaine et al., On Rayleigh optical depth calculations (1999); Serdyuchenko et al., High spectral \
                 resolution ozone absorption cross-sections (2014); ASTM G173; U.S. Standard Atmosphere (1976); \
                 Wiscombe, The delta-M method (1977); Nakajima, Tanaka, Algorithms for \
                 radiative intensity calculations (1988)",
    },
    Model {
        kind: "goniometric",
        doc: "a point light with a picture of all directions",
        parameters: &[
            file("file", "needed", "the picture, an octahedral map"),
            INTENSITY,
            SCALE,
            NORMALIZE,
            POWER,
            transform("to_world", "identity", "places it"),
        ],
        groups: &[&SCHEDULE],
        source: "pbrt-v4, 12.2.3",
    },
    Model {
        kind: "projection",
        doc: "a slide projector",
        parameters: &[
            file("file", "none", "the slide"),
            tex("texture", ANY, "none", "the slide, where there is no file"),
            tex("radiance", ANY, WHITE, "the slide, where there is neither"),
            number("fov", POSITIVE, "90", "angle of view; held in [0.001, 179.9]").unit("degrees").refused(),
            word(
                "fov_axis",
                "smaller, larger, x, y, diagonal",
                "smaller",
                "what it spans: smaller in pbrt, x in Mitsuba",
            ),
            SCALE,
            flag("normalize", "false", "without effect: what pbrt sets of every light"),
            number("power", ANY, "none", "luminous flux; of a file alone, and counts above 0").unit("lm"),
            transform("to_world", "identity", "places it; its own +z is the axis, +x right, +y up"),
        ],
        groups: &[&SCHEDULE],
        source: "pbrt-v4, 12.2.2",
    },
];
