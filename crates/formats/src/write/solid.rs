//! Quadrics, planes and curves as meshes, for formats that have no such shapes.

use steradian_math::{
    DVec3, Transform,
    geometry::{
        Point3,
        bezier::{self, BezierPatch},
        plane::Plane,
    },
};
use steradian_scene::{Mesh, Node};

const COLUMNS: u32 = 128;
const ROWS: u32 = 64;

/// Half the side of the square that stands for an infinite plane, scene units.
const PLANE: f64 = 1e4;

/// A quadric in its own space: its kind's parameters with their defaults.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Quadric {
    Sphere { radius: f64, z: [f64; 2], phi: f64 },
    Disk { radius: f64, inner: f64, height: f64, phi: f64 },
    Cylinder { radius: f64, z: [f64; 2], phi: f64 },
}

impl Quadric {
    /// The quadric of a node and what places it beyond the shape's own transform.
    pub fn of(node: &Node) -> Option<(Self, Transform)> {
        let number = |name: &str, default: f64| node.float(name).unwrap_or(default);
        let vec = |name: &str| match node.get(name) {
            Some(steradian_scene::Value::Vec3(v)) => Some(DVec3::from(*v)),
            _ => None,
        };
        let (radius, phi) = (number("radius", 1.0), number("phi_max", 360.0).clamp(0.0, 360.0));
        let sorted = |a: f64, b: f64| [a.min(b), a.max(b)];
        Some(match node.kind.as_str() {
            "sphere" => {
                let z = sorted(number("z_min", -radius), number("z_max", radius)).map(|z| z.clamp(-radius, radius));
                (Self::Sphere { radius, z, phi }, Transform::translate(vec("center").unwrap_or_default()))
            }
            "disk" => {
                let (inner, height) = (number("inner_radius", 0.0).max(0.0), number("height", 0.0));
                (Self::Disk { radius, inner, height, phi }, Transform::IDENTITY)
            }
            "cylinder" => match (vec("p0"), vec("p1")) {
                (None, None) => {
                    let z = sorted(number("z_min", -1.0), number("z_max", 1.0));
                    (Self::Cylinder { radius, z, phi }, Transform::IDENTITY)
                }
                (a, b) => {
                    let (a, b) = (a.unwrap_or_default(), b.unwrap_or(DVec3::Z));
                    let axis = (b - a).try_normalize()?;
                    let x = axis.as_vec3().any_orthonormal_vector().as_dvec3();
                    let y = axis.cross(x);
                    let frame = Transform::from_columns([
                        x.x, x.y, x.z, 0.0, y.x, y.y, y.z, 0.0, axis.x, axis.y, axis.z, 0.0, a.x, a.y, a.z, 1.0,
                    ]);
                    (Self::Cylinder { radius, z: [0.0, (b - a).length()], phi }, frame)
                }
            },
            _ => return None,
        })
    }

    /// True if the shape is complete, with no part cut away.
    pub fn is_whole(&self) -> bool {
        match *self {
            Self::Sphere { radius, z, phi } => phi >= 360.0 && z == [-radius, radius],
            Self::Disk { inner, phi, .. } => phi >= 360.0 && inner == 0.0,
            Self::Cylinder { phi, .. } => phi >= 360.0,
        }
    }

    /// Its area in its own space.
    pub fn area(&self) -> f64 {
        match *self {
            Self::Sphere { radius, z, phi } => phi.to_radians() * radius * (z[1] - z[0]),
            Self::Disk { radius, inner, phi, .. } => phi.to_radians() * 0.5 * (radius * radius - inner * inner),
            Self::Cylinder { radius, z, phi } => phi.to_radians() * radius * (z[1] - z[0]),
        }
    }

    /// Triangles with normals and the quadric's texture coordinates.
    pub fn mesh(&self) -> Mesh {
        let mut mesh = Mesh::default();
        let (columns, rows) = (COLUMNS, if matches!(self, Self::Sphere { .. }) { ROWS } else { 1 });
        for j in 0..=rows {
            for i in 0..=columns {
                let (s, t) = (f64::from(i) / f64::from(columns), f64::from(j) / f64::from(rows));
                let (r, z, n, phi) = match *self {
                    Self::Sphere { radius, z, phi } => {
                        let theta = |z: f64| (z / radius).clamp(-1.0, 1.0).acos();
                        let a = theta(z[0]) + (theta(z[1]) - theta(z[0])) * t;
                        (radius * a.sin(), radius * a.cos(), [a.sin(), a.cos()], phi)
                    }
                    Self::Cylinder { radius, z, phi } => (radius, z[0] + (z[1] - z[0]) * t, [1.0, 0.0], phi),
                    Self::Disk { radius, inner, height, phi } => {
                        (radius + (inner - radius) * t, height, [0.0, 1.0], phi)
                    }
                };
                let (sin, cos) = (phi.to_radians() * s).sin_cos();
                mesh.positions.push([(r * cos) as f32, (r * sin) as f32, z as f32]);
                mesh.normals.push([(n[0] * cos) as f32, (n[0] * sin) as f32, n[1] as f32]);
                mesh.uvs.push([s as f32, t as f32]);
            }
        }
        for j in 0..rows {
            for i in 0..columns {
                let a = j * (columns + 1) + i;
                let (b, c, d) = (a + 1, a + columns + 1, a + columns + 2);
                mesh.triangles.extend([[a, b, d], [a, d, c]]);
            }
        }
        mesh
    }
}

/// The uniform scale of a transform that keeps angles.
pub(crate) fn similarity(t: &Transform) -> Option<f64> {
    let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| t.vector(axis));
    let size = x.length();
    let even = (y.length() - size).abs() <= 1e-4 * size && (z.length() - size).abs() <= 1e-4 * size;
    let square = x.dot(y).abs().max(y.dot(z).abs()).max(z.dot(x).abs()) <= 1e-4 * size * size;
    (even && square && size > 0.0).then_some(size)
}

/// A large square on an infinite plane.
pub(crate) fn plane(node: &Node) -> Option<Mesh> {
    let vector = |name: &str| node.vec3(name).map(DVec3::from);
    let point = vector("point").map(Point3::from_vector);
    let plane = match (point, vector("along"), vector("across")) {
        (Some(p), Some(a), Some(b)) => Plane::from_spanning(p, a, b)?,
        (point, ..) => {
            let normal = vector("normal").unwrap_or(DVec3::Y);
            match point {
                Some(p) => Plane::from_point_normal(p, normal)?,
                None => Plane::new(normal.extend(node.float("distance").unwrap_or(0.0)))?,
            }
        }
    };
    let covector = plane.coordinates;
    let n = covector.truncate().try_normalize()?;
    let origin = n * (-covector.w / covector.truncate().length());
    let x = n.as_vec3().any_orthonormal_vector().as_dvec3() * PLANE;
    let y = n.cross(x);
    let at = |v: DVec3| v.as_vec3().to_array();
    Some(Mesh {
        positions: vec![at(origin - x - y), at(origin + x - y), at(origin + x + y), at(origin - x + y)],
        triangles: vec![[0, 1, 2], [0, 2, 3]].into(),
        ..Mesh::default()
    })
}

/// A tube around a curve in uniform cubic B-spline segments of control points with radii.
pub(crate) struct Spline {
    pub points: Vec<[f64; 4]>,
}

/// The control points of a curve node as cubic B-splines, with radii: Bézier segments become splines of their own.
pub(crate) fn splines(node: &Node) -> Option<Vec<Spline>> {
    let points: Vec<f64> = match node.get("points") {
        Some(steradian_scene::Value::Floats(v)) => v.clone(),
        _ => return None,
    };
    let points: Vec<DVec3> = points.chunks_exact(3).map(|c| DVec3::new(c[0], c[1], c[2])).collect();
    let widths = [node.float("width0").unwrap_or(1.0), node.float("width1").unwrap_or(1.0)];
    let radius = |t: f64| 0.5 * (widths[0] + (widths[1] - widths[0]) * t);
    let degree = node.int("degree").unwrap_or(3);
    match (node.string("basis").unwrap_or("bezier"), degree) {
        ("bspline", 3) if points.len() > 3 => {
            // Parameters of the curve's ends lie one control point inside.
            let span = (points.len() - 3) as f64;
            let at =
                |(i, p): (usize, &DVec3)| [p.x, p.y, p.z, radius(((i as f64 - 1.0) / span).clamp(-0.5, 1.5)).max(0.0)];
            Some(vec![Spline { points: points.iter().enumerate().map(at).collect() }])
        }
        ("bezier", 2 | 3) => {
            let degree = degree as usize;
            let count = points.len().saturating_sub(1) / degree;
            let mut out = Vec::with_capacity(count);
            for s in 0..count {
                let p = &points[s * degree..=(s + 1) * degree];
                let b = if degree == 3 {
                    [p[0], p[1], p[2], p[3]]
                } else {
                    [p[0], (p[0] + p[1] * 2.0) / 3.0, (p[1] * 2.0 + p[2]) / 3.0, p[2]]
                };
                // The B-spline with the same polynomial.
                let c = [
                    b[0] * 6.0 - b[1] * 7.0 + b[2] * 2.0,
                    b[1] * 2.0 - b[2],
                    b[2] * 2.0 - b[1],
                    b[1] * 2.0 - b[2] * 7.0 + b[3] * 6.0,
                ];
                let at = |i: usize| {
                    let t = (s as f64 + (i as f64 - 1.0)) / count as f64;
                    [c[i].x, c[i].y, c[i].z, radius(t).max(0.0)]
                };
                out.push(Spline { points: (0..4).map(at).collect() });
            }
            Some(out)
        }
        _ => None,
    }
}

/// Bézier patches as triangles.
pub(crate) fn bezier(node: &Node) -> Option<Mesh> {
    let Some(steradian_scene::Value::Floats(points)) = node.get("points") else { return None };
    let point = |p: &[f64]| DVec3::new(p[0], p[1], p[2]);
    let patch = |p: &[f64]| BezierPatch { points: std::array::from_fn(|k| point(&p[3 * k..3 * k + 3])) };
    let patches: Vec<BezierPatch> = points.chunks_exact(48).map(patch).collect();
    let level = node.int("level").filter(|n| *n > 0).map(|n| n.min(i64::from(bezier::MOST_SEGMENTS)) as u32);
    let n = level.unwrap_or_else(|| bezier::segments(&patches));
    bezier::tessellate(&patches, n).map(Mesh::from).filter(|mesh| mesh.validate().is_ok())
}

/// Heights in the description as a mesh over the unit square.
pub(crate) fn height_field(node: &Node) -> Option<Mesh> {
    let Some(steradian_scene::Value::Floats(heights)) = node.get("heights") else { return None };
    let (nu, nv) = (node.int("nu")? as usize, node.int("nv")? as usize);
    if nu < 2 || nv < 2 || nu.checked_mul(nv) != Some(heights.len()) {
        return None;
    }
    let scale = node.float("scale").unwrap_or(1.0);
    let mut mesh = Mesh::default();
    for j in 0..nv {
        for i in 0..nu {
            let (u, v) = (i as f32 / (nu - 1) as f32, j as f32 / (nv - 1) as f32);
            mesh.positions.push([u, v, (heights[j * nu + i] * scale) as f32]);
            mesh.uvs.push([u, v]);
            if i + 1 < nu && j + 1 < nv {
                let a = (j * nu + i) as u32;
                let (b, c, d) = (a + 1, a + nu as u32, a + nu as u32 + 1);
                mesh.triangles.extend([[a, b, d], [a, d, c]]);
            }
        }
    }
    Some(mesh)
}
