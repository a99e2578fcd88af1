//! `Shape`: kinds, their parameters, and mesh data written in the scene file.

use super::{build::Build, dict::Dict, param::Type, scene::Scene};
use steradian_scene::{Family, Mesh, NodeId, names};

pub(super) const KINDS: [&str; 12] = [
    "sphere",
    "disk",
    "cylinder",
    "cone",
    "paraboloid",
    "hyperboloid",
    "trianglemesh",
    "plymesh",
    "bilinearmesh",
    "loopsubdiv",
    "curve",
    "heightfield",
];

/// Translates a shape into its node and, for meshes, the index of its data.
pub(super) fn translate(scene: &mut Scene, dict: &Dict) -> Option<(NodeId, Option<usize>)> {
    let given = dict.kind.as_str();
    let kind = match given {
        "trianglemesh" | "plymesh" | "bilinearmesh" => "mesh",
        "loopsubdiv" => "loop_subdivision",
        // Of pbrt-v3.
        "heightfield" => "height_field",
        kind => kind,
    };
    let mut b = Build::new(scene, dict, Family::Shape, kind);
    let mut mesh = None;
    match given {
        "sphere" => {
            b.positive("radius", "radius", 1.0);
            let radius = b.node.float("radius").unwrap_or(1.0);
            b.float("zmin", "z_min", -radius);
            b.float("zmax", "z_max", radius);
            b.float("phimax", "phi_max", 360.0);
        }
        "disk" => {
            b.float("height", "height", 0.0);
            b.positive("radius", "radius", 1.0);
            b.float("innerradius", "inner_radius", 0.0);
            b.float("phimax", "phi_max", 360.0);
        }
        "cylinder" => {
            b.positive("radius", "radius", 1.0);
            b.float("zmin", "z_min", -1.0);
            b.float("zmax", "z_max", 1.0);
            b.float("phimax", "phi_max", 360.0);
        }
        // These three are of pbrt-v3; pbrt-v4 left them out.
        "cone" => {
            b.positive("radius", "radius", 1.0);
            b.positive("height", "height", 1.0);
            b.float("phimax", "phi_max", 360.0);
        }
        "paraboloid" => {
            b.positive("radius", "radius", 1.0);
            b.float("zmin", "z_min", 0.0);
            b.float("zmax", "z_max", 1.0);
            b.float("phimax", "phi_max", 360.0);
        }
        "hyperboloid" => {
            for name in ["p1", "p2"] {
                if let Some(&[x, y, z]) = b.dict.floats(&mut b.scene.report, name, Type::Point3) {
                    b.set(name, [x, y, z]);
                }
            }
            b.float("phimax", "phi_max", 360.0);
        }
        "curve" => curve(&mut b)?,
        "heightfield" => {
            b.int("nu", "nu", None);
            b.int("nv", "nv", None);
            b.floats("Pz", "heights", Type::Float);
        }
        "plymesh" => {
            mesh = Some(ply(&mut b)?);
            b.set("flat", false);
        }
        "trianglemesh" | "bilinearmesh" | "loopsubdiv" => {
            let data = inline_mesh(&mut b, given)?;
            mesh = Some(b.scene.desc.add_mesh(data));
            match given {
                "loopsubdiv" => {
                    b.int("levels", "levels", 3);
                    b.no_effect("scheme", Type::String, "Loop's scheme is the only one");
                }
                _ => b.set("flat", false),
            }
        }
        _ if b.own().is_some() => {}
        _ => {
            let help = match given {
                "nurbs" => Some("'nurbs' is of pbrt-v3; pbrt-v4 has no such shape".into()),
                _ => names::did_you_mean(given, KINDS),
            };
            scene.report.error_help(dict.span, format!("unknown shape '{given}'"), help);
            return None;
        }
    }
    // The textures may be defined after the shape.
    let mut textures = Vec::new();
    for parameter in ["alpha", "displacement"] {
        if parameter == "displacement" && given != "plymesh" {
            continue;
        }
        if b.dict.has(parameter, &[Type::Texture]) {
            let texture = b.dict.texture(&mut b.scene.report, parameter);
            textures.extend(texture.map(|(name, span)| (parameter, name.to_string(), span)));
        } else {
            b.float(parameter, parameter, None);
        }
    }
    let id = b.finish();
    for (parameter, name, span) in textures {
        scene.set_texture_later(id, parameter, name, span);
    }
    Some((id, mesh))
}

fn ply(b: &mut Build) -> Option<usize> {
    if b.dict.has("displacement", &[Type::Texture, Type::Float]) {
        let length = b.dict.float_or(&mut b.scene.report, "edgelength", 1.0);
        b.set("edge_length", length * b.scene.edge_scale);
    } else {
        b.no_effect("edgelength", Type::Float, "edges are split for a 'displacement' only");
    }
    let Some((name, span)) = b.dict.text(&mut b.scene.report, "filename") else {
        let span = b.span();
        b.scene.report.error(span, "shape 'plymesh' needs \"string filename\"");
        return None;
    };
    match b.scene.search.find(name) {
        Ok(path) => Some(b.scene.meshes.add(&mut b.scene.desc, path, span)),
        Err(fault) => {
            b.scene.report.error(span, fault.to_string());
            None
        }
    }
}

/// Vertices and faces given as parameters.
fn inline_mesh(b: &mut Build, given: &str) -> Option<Mesh> {
    let corners = if given == "bilinearmesh" { 4 } else { 3 };
    let Some(p) = b.dict.floats(&mut b.scene.report, "P", Type::Point3) else {
        if !b.dict.has("P", &[Type::Point3]) {
            let span = b.span();
            b.scene.report.error(span, format!("shape '{given}' needs \"point3 P\""));
        }
        return None;
    };
    let positions = triples(p);
    let count = positions.len();
    let mut indices: Vec<i32> = match b.dict.ints(&mut b.scene.report, "indices") {
        Some(indices) => indices.to_vec(),
        None if count == corners && given != "loopsubdiv" => (0..corners as i32).collect(),
        None => {
            let span = b.span();
            b.scene.report.error(span, format!("shape '{given}' needs \"integer indices\""));
            return None;
        }
    };
    let excess = indices.len() % corners;
    if excess > 0 {
        let span = b.dict.span_of("indices");
        let message = format!("{} indices are not a multiple of {corners}; the last are left out", indices.len());
        b.scene.report.warn(span, message);
        indices.truncate(indices.len() - excess);
    }
    if let Some(&bad) = indices.iter().find(|&&i| i < 0 || i as usize >= count) {
        b.error("indices", format!("index {bad} is outside the {count} vertices"));
        return None;
    }
    let mut mesh = Mesh { positions, ..Mesh::default() };
    if corners == 4 {
        mesh.patches = indices.chunks_exact(4).map(|c| [c[0], c[1], c[2], c[3]].map(|i| i as u32)).collect();
    } else {
        mesh.triangles = indices.chunks_exact(3).map(|c| [c[0], c[1], c[2]].map(|i| i as u32)).collect();
    }
    if given != "loopsubdiv" {
        mesh.normals = per_vertex(b, "N", Type::Normal, count).map_or(Vec::new(), triples);
        mesh.uvs = per_vertex(b, "uv", Type::Point2, count)
            .map_or(Vec::new(), |v| v.chunks_exact(2).map(|c| [c[0] as f32, c[1] as f32]).collect());
        b.no_effect("faceIndices", Type::Integer, "numbers of faces serve Ptex textures only");
    }
    match given {
        "trianglemesh" => mesh.tangents = per_vertex(b, "S", Type::Vector3, count).map_or(Vec::new(), triples),
        "bilinearmesh" => {
            if let Some((_, span)) = b.dict.text(&mut b.scene.report, "emissionfilename") {
                b.scene.report.dropped(span, "'emissionfilename' is left out: the patch emits the same everywhere");
            }
        }
        _ => {}
    }
    if let Err(fault) = mesh.validate() {
        b.error("P", format!("shape '{given}': {fault}"));
        return None;
    }
    Some(mesh)
}

fn triples(v: &[f64]) -> Vec<[f32; 3]> {
    v.chunks_exact(3).map(|c| [c[0] as f32, c[1] as f32, c[2] as f32]).collect()
}

/// Data with one value per vertex; with another count it is left out, as pbrt does.
fn per_vertex<'a>(b: &mut Build<'a, '_>, name: &'static str, ty: Type, count: usize) -> Option<&'a [f64]> {
    let values = b.dict.floats(&mut b.scene.report, name, ty)?;
    let found = values.len() / ty.arity();
    if found != count {
        let span = b.dict.span_of(name);
        let message = format!("'{name}' has {found} values for {count} vertices and is left out");
        b.scene.report.warn(span, message);
        return None;
    }
    Some(values)
}

fn curve(b: &mut Build) -> Option<()> {
    let Some(points) = b.dict.floats(&mut b.scene.report, "P", Type::Point3) else {
        if !b.dict.has("P", &[Type::Point3]) {
            let span = b.span();
            b.scene.report.error(span, "shape 'curve' needs \"point3 P\"");
        }
        return None;
    };
    b.int("degree", "degree", 3);
    let degree = match b.node.int("degree") {
        Some(d @ (2 | 3)) => d as usize,
        _ => {
            b.error("degree", "a curve is of degree 2 or 3");
            return None;
        }
    };
    b.choice("basis", "basis", &[("bezier", "bezier"), ("bspline", "bspline")], "bezier");
    b.choice("type", "type", &[("flat", "flat"), ("cylinder", "cylinder"), ("ribbon", "ribbon")], "flat");
    let count = points.len() / 3;
    let bezier = b.node.string("basis") == Some("bezier");
    if count <= degree || (bezier && !(count - 1).is_multiple_of(degree)) {
        let rule = if bezier { format!("{} + n × {degree}", degree + 1) } else { format!("at least {}", degree + 1) };
        b.error("P", format!("the curve has {count} control points, but needs {rule}"));
        return None;
    }
    let segments = if bezier { (count - 1) / degree } else { count - degree };
    if !points.iter().all(|&v| (v as f32).is_finite()) {
        b.error("P", "a control point is too far away");
        return None;
    }
    b.node.set("points", points.to_vec(), None);
    let width = b.dict.float_or(&mut b.scene.report, "width", 1.0);
    b.float("width0", "width0", width);
    b.float("width1", "width1", width);
    b.int("splitdepth", "split_depth", 3);
    let normals = b.dict.floats(&mut b.scene.report, "N", Type::Normal);
    let ribbon = b.node.string("type") == Some("ribbon");
    match normals {
        Some(_) if !ribbon => {
            let span = b.dict.span_of("N");
            b.scene.report.warn(span, "'N' has no effect: only ribbons use normals");
        }
        Some(n) if n.len() / 3 != segments + 1 => {
            let message =
                format!("a ribbon of {segments} segments needs {} normals, found {}", segments + 1, n.len() / 3);
            b.error("N", message);
            return None;
        }
        Some(n) => b.set("normals", n.to_vec()),
        None if ribbon => {
            let span = b.span();
            b.scene.report.error(span, "a ribbon needs \"normal N\"");
            return None;
        }
        None => {}
    }
    Some(())
}
