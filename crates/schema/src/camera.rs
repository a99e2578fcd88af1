//! Cameras.

use crate::{
    model::{Group, Model},
    parameter::{ANY, POSITIVE, Parameter, Type, file, flag, list, number, transform, word},
};

const NEAR: Parameter = number("near", ANY, "0", "distance along the axis where rays start; below 0 counts as 0");
const FAR: Parameter =
    number("far", POSITIVE, "none", "distance along the axis where rays end, and the background is seen").refused();
const LENS_RADIUS: Parameter = number("lens_radius", ANY, "0", "radius of the thin lens; up to 0 is a pinhole");
const FOCAL_DISTANCE: Parameter =
    number("focal_distance", POSITIVE, "1e6", "distance of what is in focus, along the axis").refused();
const FRAME_ASPECT: Parameter =
    number("frame_aspect", POSITIVE, "the film's", "width over height of the window").refused();
const PRINCIPAL_X: Parameter =
    number("principal_x", ANY, "0", "offset of the axis to the right, as a share of the film");
const PRINCIPAL_Y: Parameter = number("principal_y", ANY, "0", "offset of the axis downwards, as a share of the film");

/// All cameras.
pub const CAMERAS: &[Model] = &[
    Model {
        kind: "perspective",
        doc: "a pinhole or thin lens",
        parameters: &[
            number("fov", (f64::MIN_POSITIVE, 180.0), "90", "angle of view; 180 is refused").unit("degrees").refused(),
            word("fov_axis", "smaller, larger, x, y, diagonal", "smaller", "what the angle spans"),
            LENS_RADIUS,
            FOCAL_DISTANCE,
            list(
                "screen_window",
                "the whole view",
                "what the film shows, x0 x1 y0 y1: 1 is half the angle of view on the shorter axis",
            ),
            FRAME_ASPECT,
            NEAR,
            FAR,
            PRINCIPAL_X,
            PRINCIPAL_Y,
        ],
        groups: &[&ANY_CAMERA],
        source: "pbrt-v4, 5.2",
    },
    Model {
        kind: "orthographic",
        doc: "parallel rays",
        parameters: &[
            list(
                "screen_window",
                "from -1 to 1 on the shorter axis; on x in Mitsuba scenes",
                "what the film shows, x0 x1 y0 y1, in units of camera space",
            ),
            FRAME_ASPECT,
            LENS_RADIUS,
            FOCAL_DISTANCE,
            NEAR,
            FAR,
            PRINCIPAL_X,
            PRINCIPAL_Y,
        ],
        groups: &[&ANY_CAMERA],
        source: "pbrt-v4, 5.2",
    },
    Model {
        kind: "spherical",
        doc: "all directions",
        parameters: &[word(
            "mapping",
            "equalarea, equirectangular",
            "equalarea",
            "the octahedral map of equal areas, or longitude and latitude",
        )],
        groups: &[&ANY_CAMERA],
        source: "pbrt-v4, 5.3; Clarberg, Fast equal-area mapping of the (hemi)sphere (2008)",
    },
    Model {
        kind: "realistic",
        doc: "a lens of several elements before a film: the picture is irradiance of the film, with the lens's \
              distortion, vignetting and aberrations. A unit of camera space is a metre, and the film is at its origin",
        parameters: &[
            file(
                "file",
                "none",
                "the lens as pbrt has it: rows as in elements, with the Abbe number as a fifth column by choice",
            ),
            list(
                "elements",
                "a double Gauss of 50 mm, f/2",
                "for each surface, from the scene to the film: radius of curvature (above 0 bulges to the scene; 0 is \
                 the stop), distance to the next surface, index of refraction behind it (0 is air), diameter; mm",
            ),
            list(
                "abbe",
                "none",
                "for each surface the Abbe number of what is behind it, 0 for none: in spectral mode colours split",
            )
            .where_given("elements"),
            number("aperture_diameter", POSITIVE, "the stop's", "of the stop, at most the one in the table")
                .unit("mm")
                .refused(),
            number("focus_distance", POSITIVE, "10", "from the film to what is in focus").unit("m").refused(),
            word(
                "aperture",
                "circle, square, pentagon, star, gaussian",
                "circle",
                "the shape of the stop, as bright as the circle",
            ),
            file("aperture_file", "none", "a picture of the stop instead, over the square around it"),
            number("film_diagonal", POSITIVE, "35", "corner to corner of the film").unit("mm").refused(),
        ],
        groups: &[&ANY_CAMERA],
        source: "Kolb, Mitchell, Hanrahan, A realistic camera model for computer graphics (1995); pbrt-v3, 6.4; \
                 pbrt-v4, 5.3",
    },
    Model {
        kind: "radiance_meter",
        doc: "the radiance along one ray, from its place along +z, in every pixel",
        parameters: &[],
        groups: &[&ANY_CAMERA],
        source: "Mitsuba 3, radiancemeter",
    },
    Model {
        kind: "irradiance_meter",
        doc: "the irradiance of a surface: the film is spread over its area",
        parameters: &[
            word(
                "surface",
                "square, disk, sphere, cylinder",
                "square",
                "from -1 to 1 along x and y, facing +z; of radius 1, facing +z; of radius 1; of radius 1 about z from 0 \
                 to 1",
            ),
            flag("inward", "false", "whether the other side receives"),
        ],
        groups: &[&ANY_CAMERA],
        source: "Mitsuba 3, irradiancemeter",
    },
];

/// Parameters of every camera.
pub static ANY_CAMERA: Group = Group {
    name: "any",
    doc: "every camera: where it is, what is around it, and when it looks",
    parameters: &[
        transform("to_world", "identity", "places it; it looks along its own +z, +y is up and +x to the right"),
        Parameter::new(Type::Medium, "medium", ANY, "none", "the medium that it is in"),
        number("shutter_open", ANY, "0", "when the shutter opens; pbrt's exposure follows from this and the next"),
        number("shutter_close", ANY, "1", "when it closes"),
        transform("to_world_end", "none", "its place at the end of its motion"),
        list("motion_times", "0,1", "when its motion begins and ends").where_given("to_world_end"),
    ],
    source: "",
};
