//! Shapes.

use crate::{
    model::{Group, Model},
    parameter::{ANY, POSITIVE, Parameter, Type, file, flag, integer, list, number, scalar, text, vector, word},
};

const PHI_MAX: Parameter = number("phi_max", ANY, "360", "how far it goes around z; held in [0, 360]").unit("degrees");
const RADIUS: Parameter = number("radius", POSITIVE, "1", "radius").refused();
const TANGENTS: Parameter = text(
    "tangents",
    "uv",
    "tangents of normal maps: uv (those of each triangle's coordinates), mikktspace, mikktspace_down (v grows \
     downwards, glTF), \
     or a vertex attribute (x, y, z, and the sign of the bitangent)",
);

const BOX_MIN: Parameter = vector("min", "-1,-1,-1", "lower corner of the box");
const BOX_MAX: Parameter = vector("max", "1,1,1", "upper corner of the box");

/// All shapes.
pub const SHAPES: &[Model] = &[
    Model {
        kind: "mesh",
        doc: "triangles and bilinear patches, which are mesh data",
        parameters: &[
            flag("flat", "false", "whether vertex normals are ignored"),
            TANGENTS,
            scalar("displacement", ANY, "none", "heights along the normal, in units of object space"),
            flag(
                "displacement_vector",
                "false",
                "whether displacement has vectors: along ∂p/∂u, across it, and along the normal",
            )
            .where_given("displacement"),
            number("displacement_scale", ANY, "1", "factor on the displacement").where_given("displacement"),
            number("displacement_middle", ANY, "0", "value of no displacement").where_given("displacement"),
            number("edge_length", ANY, "none", "edges are split to this length in the world first; counts above 0")
                .unit("scene units")
                .where_given("displacement"),
            number("edge_pixels", ANY, "none", "the same as seen on the first frame; counts above 0")
                .unit("pixels")
                .where_given("displacement"),
        ],
        groups: &[&ANY_SHAPE],
        source: "pbrt-v4, 6.5 and 6.6; Cook, Shade trees (1984); Mikkelsen, Simulation of Wrinkled Surfaces \
         Revisited (2008)",
    },
    Model {
        kind: "loop_subdivision",
        doc: "the limit surface of a mesh by Loop's rules, which is mesh data",
        parameters: &[integer("levels", ANY, "3", "how often triangles are split; held in [0, 16]"), TANGENTS],
        groups: &[&ANY_SHAPE],
        source: "Loop, Smooth subdivision surfaces based on triangles (1987)",
    },
    Model {
        kind: "sphere",
        doc: "a sphere, or a part of one",
        parameters: &[
            vector("center", "0,0,0", "its middle"),
            RADIUS,
            number("z_min", ANY, "none", "lower end; held inside the sphere, and that of the sphere where absent"),
            number("z_max", ANY, "radius", "upper end; held inside the sphere"),
            PHI_MAX,
        ],
        groups: &[&ANY_SHAPE],
        source: "pbrt-v4, 6.2",
    },
    Model {
        kind: "disk",
        doc: "a disk, a ring, or a part of them, across z",
        parameters: &[
            number("height", ANY, "0", "its z"),
            RADIUS,
            number("inner_radius", ANY, "0", "radius of the hole; below 0 counts as 0"),
            PHI_MAX,
        ],
        groups: &[&ANY_SHAPE],
        source: "pbrt-v4, 6.4",
    },
    Model {
        kind: "cylinder",
        doc: "an open cylinder around z, or from point to point",
        parameters: &[
            RADIUS,
            number("z_min", ANY, "-1", "lower end"),
            number("z_max", ANY, "1", "upper end"),
            PHI_MAX,
            vector("p0", "none; 0,0,0 beside p1", "one end, instead of z_min"),
            vector("p1", "none; 0,0,1 beside p0", "the other end, instead of z_max"),
        ],
        groups: &[&ANY_SHAPE],
        source: "pbrt-v4, 6.3",
    },
    Model {
        kind: "cone",
        doc: "an open cone around z with its base at 0",
        parameters: &[RADIUS, number("height", POSITIVE, "1", "z of the tip").refused(), PHI_MAX],
        groups: &[&ANY_SHAPE],
        source: "pbrt-v3, 3.5",
    },
    Model {
        kind: "paraboloid",
        doc: "a paraboloid around z with its apex at the origin",
        parameters: &[
            number("radius", POSITIVE, "1", "radius at z_max").refused(),
            number("z_min", ANY, "0", "lower end; below 0 counts as 0"),
            number("z_max", ANY, "1", "upper end, above 0"),
            PHI_MAX,
        ],
        groups: &[&ANY_SHAPE],
        source: "pbrt-v3, 3.5",
    },
    Model {
        kind: "hyperboloid",
        doc: "what a line between two points of different z sweeps that is turned around z: a hyperboloid of one \
         sheet, or a cone or cylinder; normals are away from z where p2 is above p1",
        parameters: &[vector("p1", "0,0,0", "one end"), vector("p2", "1,1,1", "the other end"), PHI_MAX],
        groups: &[&ANY_SHAPE],
        source: "pbrt-v3, 3.5",
    },
    Model {
        kind: "quadric",
        doc: "A x² + B y² + C z² + D xy + E yz + F xz + G x + H y + I z + J = 0 in a box; normals are towards where it \
         is above 0; it has no coordinates, and its light is found by chance alone",
        parameters: &[list("coefficients", "needed", "the ten numbers A to J"), BOX_MIN, BOX_MAX],
        groups: &[&ANY_SHAPE],
        source: "Glassner (ed.), An introduction to ray tracing (1989), chapter 2",
    },
    Model {
        kind: "implicit",
        doc: "where an expression changes its sign, in a box; normals are towards where it grows. Of one ray 8192 \
         parts, and two million operations, are looked at closely; what is beyond is told by the signs at the ends of \
         parts. It has no coordinates, and its light is found by chance alone",
        parameters: &[
            text(
                "expression",
                "needed",
                "of x, y, z, pi and numbers with + - * / ^, parentheses, min, max, abs, sqrt, sin, cos, exp, log and \
                 floor; of 4096 letters, 1024 operations and 64 levels at most; what is not defined is no surface",
            ),
            BOX_MIN,
            BOX_MAX,
        ],
        groups: &[&ANY_SHAPE],
        source: "Mitchell, Robust ray intersection with interval arithmetic (1990)",
    },
    Model {
        kind: "polygon",
        doc: "a plane polygon, which may be concave, cross itself, and have holes; it becomes triangles, and its u \
         and v go from 0 to 1 over its box in the plane of two axes",
        parameters: &[
            list("points", "needed", "corners, three numbers each, in one plane"),
            list("loops", "none; all in one", "how many of the points each outline has, in order"),
            word(
                "rule",
                "even_odd, nonzero",
                "even_odd",
                "what is inside: where a half-line meets outlines an odd number of times, or where they wind around",
            ),
        ],
        groups: &[&ANY_SHAPE],
        source: "",
    },
    Model {
        kind: "bezier_patch",
        doc: "bicubic Bézier patches, which become triangles with the normals of the patches; normals are along ∂p/∂u \
         × ∂p/∂v",
        parameters: &[
            list("points", "needed", "16 control points for each patch, three numbers each, in four rows along u"),
            integer(
                "level",
                ANY,
                "0",
                "segments along each side of a patch, held in [0, 256]; 0 keeps within a thousandth of the size of \
                 all, with 64 at most",
            ),
        ],
        groups: &[&ANY_SHAPE],
        source: "Farin, Curves and surfaces for CAGD (2002), chapter 14",
    },
    Model {
        kind: "curve",
        doc: "strands; as lights they are tubes of nine sides, and ribbons strips",
        parameters: &[
            list("points", "needed", "control points, three numbers each"),
            integer("degree", ANY, "3", "2 or 3"),
            word("basis", "bezier, bspline", "bezier", "what the control points are of"),
            word(
                "type",
                "flat, cylinder, round, ribbon",
                "flat",
                "a strip that faces the ray; the same with normals over half a turn, as in pbrt, which suit hair; \
                 the same with those of a round strand; or a strip that faces along normals",
            ),
            number("width0", ANY, "1", "width at the beginning"),
            number("width1", ANY, "1", "width at the end"),
            list("normals", "none", "of each end of a segment, three numbers each").with("type", "ribbon"),
            integer("split_depth", ANY, "3", "how often segments are halved; held in [0, 8]"),
        ],
        groups: &[&ANY_SHAPE],
        source: "Nakamaru, Ohno (2002); pbrt-v4, 6.7",
    },
    Model {
        kind: "height_field",
        doc: "heights over the unit square, along z, bilinear between samples and traced without triangles: a \
         file, or heights",
        parameters: &[
            Parameter::new(
                Type::ScalarOrList,
                "heights",
                ANY,
                "none",
                "the samples row by row from v = 0, or a texture that is sampled",
            ),
            integer("nu", ANY, "none; 256 of a texture", "samples along u"),
            integer("nv", ANY, "none; 256 of a texture", "samples along v"),
            file(
                "file",
                "none",
                "a picture whose texels are the samples, its numbers as they stand; v = 0 is in the last row",
            ),
            number("scale", ANY, "1", "factor on heights"),
            flag("smooth", "false", "whether shading normals are continuous"),
        ],
        groups: &[&ANY_SHAPE],
        source: "",
    },
    Model {
        kind: "sdf_grid",
        doc: "where a signed distance function is zero that is trilinear between samples on a grid over the \
         unit cube; it has no coordinates, and its light is found by chance alone",
        parameters: &[
            file(
                "file",
                "needed",
                "the grid: Mitsuba's .vol, of one channel, with the first and last samples on the faces of the cube",
            ),
            word(
                "normals",
                "smooth, analytic",
                "smooth",
                "continuous over the borders of cells, or the function's own",
            ),
        ],
        groups: &[&ANY_SHAPE],
        source: "Hansson-Söderlund, Evans, Akenine-Möller, Ray tracing of signed distance function grids (2022)",
    },
    Model {
        kind: "plane",
        doc: "an infinite plane: n·x + d = 0, or through a point with a normal, or through a point along two \
              directions, which are then the axes of its parameters u and v",
        parameters: &[
            vector("normal", "0,1,0", "n; it has a length"),
            number("distance", ANY, "0", "d, without a point"),
            vector("point", "none", "a point of the plane, instead of d"),
            vector("along", "none", "a direction of the plane, ∂p/∂u, instead of a normal").where_given("point"),
            vector("across", "none", "another one, ∂p/∂v: the normal is along × across").where_given("point"),
        ],
        groups: &[&ANY_SHAPE],
        source: "",
    },
];

/// Parameters of every shape.
pub static ANY_SHAPE: Group = Group {
    name: "any",
    doc: "every shape: where rays pass, and as what it is seen",
    parameters: &[
        scalar("alpha", ANY, "1", "part of rays that meet it"),
        flag("single_sided", "false", "whether rays pass that meet it from behind, against the order of the corners"),
        flag(
            "shadow_catcher",
            "false",
            "whether the camera sees of it only the shadows that it receives: before the background, or as alpha",
        ),
    ],
    source: "",
};
