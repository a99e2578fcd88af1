//! The surfaces of a scene as pieces with parameters: what patches are cut from.
//!
//! A triangle of a mesh is a piece, so is a bilinear patch. Quadrics are cut into a grid of pieces. Infinite planes end
//! where others cut them off from the camera: what lies behind an opaque plane can neither be seen nor light what is
//! seen. Where they go on for ever they end at a distance.

use super::polygon::Polygon;
use glam::DVec3;
use std::{f64::consts::TAU, sync::Arc};
use steradian_core::{
    Scene,
    scene::{Geometry, Hit, Interaction, PrimId, Shape, WORLD},
    shape::{Plane, Quadric, QuadricKind},
};
use steradian_math::{Bounds3, Ray, Vec2, Vec3, transform::Affine};
use steradian_texture::FloatTexture;

/// Infinite planes end this many diagonals of everything else beyond it.
const PLANE_MARGIN: f32 = 3.0;
/// Pieces of a full turn of a quadric, and from pole to pole of a sphere.
const COLUMNS: u32 = 8;
const ROWS: u32 = 4;

/// Mapping from parameters to points.
#[derive(Clone, Debug)]
enum Sheet {
    /// Corners; the parameters are barycentric coordinates of the second and third.
    Triangle([DVec3; 3]),
    /// Corners at parameters (0, 0), (1, 0), (0, 1), (1, 1).
    Quad([DVec3; 4]),
    /// A quadric in its own parameters, and where it is placed.
    Quadric(Arc<Quadric>, Option<Affine>),
}

/// A piece of surface.
#[derive(Clone, Debug)]
pub struct Piece {
    /// The primitive that it is of.
    pub id: PrimId,
    /// Index of the geometry.
    pub geometry: u32,
    /// The part of the parameters that it covers: least and greatest.
    pub domain: [Vec2; 2],
    sheet: Sheet,
    /// True if the surface's normal is that of the parameters turned over.
    flipped: bool,
}

/// Reason why a scene cannot be cut into patches.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Refusal {
    /// More planes than are cut against each other.
    #[error("radiosity takes up to {limit} infinite planes; the scene has {count}")]
    TooManyPlanes {
        /// Number in the scene.
        count: usize,
        /// Largest number.
        limit: usize,
    },
    /// Light is lost or scattered between surfaces.
    #[error("radiosity knows light between surfaces only; the scene has participating media")]
    Media,
    /// Light is not the same at all moments.
    #[error("radiosity knows one moment; things move in the scene while the shutter is open")]
    Motion,
    /// Lights do not always shine.
    #[error("radiosity knows one moment; the scene has lights that go on and off")]
    Schedules,
    /// Rays pass a surface by chance: what a patch sends and what it receives are not the same share.
    #[error("radiosity does not know surfaces that rays pass by chance (masks, 'alpha')")]
    Masks,
    /// The method has no order of bounces.
    #[error(
        "'{method}' solves for light of any number of bounces, and {limit} are asked for; 'gauss-seidel', 'jacobi', \
         'hierarchical' and 'stochastic' follow a limit, and 'max_depth=-1' takes it away"
    )]
    Bounces {
        /// The method.
        method: &'static str,
        /// The limit.
        limit: u32,
    },
    /// Scene without surfaces to cut.
    #[error("radiosity needs surfaces; the scene has none that can be cut into patches")]
    NoSurfaces,
    /// More pieces than a method can hold.
    #[error("{what} takes up to {limit} patches, and the scene has {count}; '{instead}' takes any number")]
    TooManyPatches {
        /// The method.
        what: &'static str,
        /// Number in the scene.
        count: usize,
        /// Largest number.
        limit: usize,
        /// A method that takes them.
        instead: &'static str,
    },
}

/// All pieces, and which of them a primitive has.
#[derive(Clone, Debug, Default)]
pub struct Surfaces {
    /// The pieces.
    pub pieces: Vec<Piece>,
    /// For each geometry of the world, then of each placement, its first piece and the columns and rows that each
    /// primitive has.
    blocks: Vec<Block>,
    /// First block of each placement.
    placed: Vec<u32>,
    /// The point from which infinite planes were cut off.
    pub eye: DVec3,
    /// Shapes that take no part, for reports.
    pub left_out: Vec<&'static str>,
}

#[derive(Clone, Copy, Debug)]
struct Block {
    first: u32,
    columns: u32,
    rows: u32,
    /// Number of pieces of the geometry.
    count: u32,
}

impl Piece {
    /// True if parameters are barycentric.
    pub fn is_triangle(&self) -> bool {
        matches!(self.sheet, Sheet::Triangle(_))
    }

    /// The point at parameters.
    pub fn point(&self, uv: Vec2) -> DVec3 {
        let (u, v) = (f64::from(uv.x), f64::from(uv.y));
        match &self.sheet {
            // Barycentric, bilinear, or by the quadric's own angles.
            Sheet::Triangle(c) => c[0] * (1.0 - u - v) + c[1] * u + c[2] * v,
            Sheet::Quad(c) => c[0].lerp(c[1], u).lerp(c[2].lerp(c[3], u), v),
            Sheet::Quadric(q, place) => {
                let p = quadric_point(q, u, v).as_vec3();
                let p = q.place.point(p);
                place.map_or(p, |place| place.point(p)).as_dvec3()
            }
        }
    }

    /// The polygon that stands for the surface between points at parameters, which go round counterclockwise in the
    /// parameters' plane: for curved surfaces one of the same area, through the middle of the surface.
    pub fn polygon(&self, corners: &[Vec2]) -> Polygon {
        let mut points: Vec<DVec3> = corners.iter().map(|uv| self.point(*uv)).collect();
        points.dedup();
        let mut polygon = Polygon::new(&points);
        if let (false, [a, _, b, _]) = (self.is_triangle(), corners) {
            // Curved pieces: the polygon is scaled to their area.
            let ratio = (self.curved_area(*a, *b) / polygon.area()).sqrt();
            if ratio.is_finite() && (ratio - 1.0).abs() > 1e-6 {
                let (from, to) = (polygon.center(), self.point((*a + *b) * 0.5));
                let n = polygon.normal();
                // Between the chords and the middle, where the mean of a parabola is.
                let rise = n * n.dot(to - from) * (2.0 / 3.0);
                points.iter_mut().for_each(|p| *p = from + (*p - from) * ratio + rise);
                polygon = Polygon::new(&points);
            }
        }
        if self.flipped { polygon.reversed() } else { polygon }
    }

    /// Area of a part of the parameters, by small triangles.
    fn curved_area(&self, a: Vec2, b: Vec2) -> f64 {
        const PARTS: u32 = 6;
        let at = |i: u32, j: u32| self.point(a + (b - a) * Vec2::new(i as f32, j as f32) / PARTS as f32);
        let triangle = |a: DVec3, b: DVec3, c: DVec3| 0.5 * (b - a).cross(c - a).length();
        let cell = |i: u32, j: u32| {
            // Two triangles for each cell of a fine grid.
            let c = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            triangle(c[0], c[1], c[2]) + triangle(c[0], c[2], c[3])
        };
        (0..PARTS * PARTS).map(|k| cell(k % PARTS, k / PARTS)).sum()
    }

    /// The surface there as a ray sees it that comes straight down on the front or the back.
    pub fn seen(&self, scene: &Scene, uv: Vec2, front: bool) -> Interaction {
        let p = self.point(uv).as_vec3();
        let e = 1e-3;
        let (du, dv) = (Vec2::new(e, 0.0), Vec2::new(0.0, e));
        let inward = |d: Vec2| if uv.dot(d) > 0.5 * e { -d } else { d };
        // Tangents by differences that stay within the parameters; the normal is their cross product.
        let (su, sv) = (inward(du), inward(dv));
        let (a, b) = (self.point(uv + su) - self.point(uv), self.point(uv + sv) - self.point(uv));
        let turn = f64::from(su.x * sv.y).signum() * if self.flipped { -1.0 } else { 1.0 };
        let n = (a.cross(b) * turn).normalize_or(DVec3::Z).as_vec3();
        let wo = if front { n } else { -n };
        // Coordinates of quadrics and planes follow from the point, which is where the ray is after one unit of length.
        let hit = Hit { t: 1.0, u: uv.x, v: uv.y, id: self.id };
        let mut seen = scene.interaction(&Ray::new(p + wo, -wo), &hit);
        // The normal is the scene's, which knows it better.
        seen.wo = if (seen.surface.n.dot(n) > 0.0) == front { seen.surface.n } else { -seen.surface.n };
        seen
    }

    /// The parameters of a hit.
    fn parameters(&self, i: &Interaction) -> Vec2 {
        match &self.sheet {
            Sheet::Quadric(..) => i.surface.uv,
            Sheet::Triangle(c) if self.id.prim == ON_PLANE => {
                let (a, b) = (c[1] - c[0], c[2] - c[0]);
                within(i.surface.p.as_dvec3() - c[0], a, b)
            }
            Sheet::Quad(c) if self.id.prim == ON_PLANE => {
                within(i.surface.p.as_dvec3() - c[0], c[1] - c[0], c[2] - c[0])
            }
            _ => i.coordinates,
        }
    }
}

/// Marks pieces of planes, whose hits have no coordinates.
const ON_PLANE: u32 = u32::MAX;

/// The coordinates of a vector in the basis of two others of its plane.
fn within(p: DVec3, a: DVec3, b: DVec3) -> Vec2 {
    // Least squares in the plane (normal equations).
    let (aa, ab, bb) = (a.dot(a), a.dot(b), b.dot(b));
    let det = aa * bb - ab * ab;
    let (pa, pb) = (p.dot(a), p.dot(b));
    Vec2::new(((bb * pa - ab * pb) / det) as f32, ((aa * pb - ab * pa) / det) as f32)
}

/// The object-space point at a quadric's parameters.
fn quadric_point(q: &Quadric, u: f64, v: f64) -> DVec3 {
    // Cylindrical coordinates of the quadric by its parameters.
    let phi = f64::from(q.phi_max) * u;
    let (r, z) = match q.kind {
        QuadricKind::Sphere { radius, z_min, z_max } => {
            let theta = |z: f32| f64::from(z / radius).clamp(-1.0, 1.0).acos();
            let theta = theta(z_min) + (theta(z_max) - theta(z_min)) * v;
            (f64::from(radius) * theta.sin(), f64::from(radius) * theta.cos())
        }
        QuadricKind::Cylinder { radius, z_min, z_max } => {
            (f64::from(radius), f64::from(z_min) + f64::from(z_max - z_min) * v)
        }
        QuadricKind::Disk { height, radius, inner } => {
            (f64::from(radius) + f64::from(inner - radius) * v, f64::from(height))
        }
    };
    // Poles are one point, whatever the azimuth.
    let r = if r < 1e-7 * f64::from(q.world_radius().max(f32::MIN_POSITIVE)) { 0.0 } else { r };
    DVec3::new(r * phi.cos(), r * phi.sin(), z)
}

impl Surfaces {
    /// Cuts a scene.
    ///
    /// # Errors
    /// [`Refusal`] for scenes with media, with too many infinite planes, or without surfaces.
    pub fn new(scene: &Scene) -> Result<Self, Refusal> {
        Self::seen_from(scene, scene.camera().world_from_camera.point(Vec3::ZERO).as_dvec3())
    }

    /// Cuts a scene whose infinite planes end where others cut them off from a point.
    ///
    /// # Errors
    /// As [`Surfaces::new`].
    pub fn seen_from(scene: &Scene, eye: DVec3) -> Result<Self, Refusal> {
        if scene.has_media() {
            return Err(Refusal::Media);
        }
        if scene.placements().iter().any(|p| p.motion.is_some()) {
            return Err(Refusal::Motion);
        }
        if scene.has_schedules() {
            return Err(Refusal::Schedules);
        }
        let is_masked = |alpha: &FloatTexture| !matches!(alpha, FloatTexture::Constant(a) if *a >= 1.0);
        if scene.geometries().iter().any(|g| g.alpha.as_ref().is_some_and(is_masked)) {
            return Err(Refusal::Masks);
        }
        // Geometry of the world, then of every placement.
        let mut all = Self { eye, ..Self::default() };
        let world = scene.placements().iter().map(|p| p.base).min().unwrap_or(scene.geometries().len() as u32);
        for (g, geometry) in scene.geometries()[..world as usize].iter().enumerate() {
            let id = PrimId { instance: WORLD, geom: g as u32, prim: 0 };
            all.geometry(scene, geometry, id, g as u32, None)?;
        }
        for (instance, placement) in scene.placements().iter().enumerate() {
            all.placed.push(all.blocks.len() as u32);
            // Groups end where the next one begins.
            let next = scene.placements().iter().map(|p| p.base).filter(|b| *b > placement.base).min();
            let end = next.unwrap_or(scene.geometries().len() as u32);
            for g in placement.base..end {
                let id = PrimId { instance: instance as u32, geom: g - placement.base, prim: 0 };
                let geometry = &scene.geometries()[g as usize];
                all.geometry(scene, geometry, id, g, Some(&placement.world_from_group))?;
            }
        }
        if all.pieces.is_empty() {
            return Err(Refusal::NoSurfaces);
        }
        all.left_out.sort_unstable();
        all.left_out.dedup();
        Ok(all)
    }

    fn geometry(
        &mut self,
        scene: &Scene,
        geometry: &Geometry,
        id: PrimId,
        index: u32,
        place: Option<&Affine>,
    ) -> Result<(), Refusal> {
        let (first, eye) = (self.pieces.len(), self.eye);
        let (mut columns, mut rows) = (1, 1);
        let world = |p: Vec3| place.map_or(p, |place| place.point(p)).as_dvec3();
        let unit = [Vec2::ZERO, Vec2::ONE];
        let mut add = |prim: u32, domain: [Vec2; 2], sheet: Sheet| {
            self.pieces.push(Piece { id: PrimId { prim, ..id }, geometry: index, domain, sheet, flipped: false });
        };
        if !geometry.is_interface {
            // Pieces by kind of shape; what cannot be cut is noted.
            match &geometry.shape {
                Shape::Mesh(m) => {
                    for t in 0..m.triangles.len() as u32 {
                        add(t, unit, Sheet::Triangle(m.corners(t).map(world)));
                    }
                }
                Shape::Patches(m) => {
                    for t in 0..m.patches.len() as u32 {
                        add(t, unit, Sheet::Quad(m.corners(t).map(world)));
                    }
                }
                Shape::Quadric(q) => {
                    // Columns by the angle, rows by the kind.
                    let turn = (f64::from(q.phi_max) / TAU * f64::from(COLUMNS)).ceil().max(1.0) as u32;
                    (columns, rows) = match q.kind {
                        QuadricKind::Sphere { .. } => (turn, ROWS),
                        QuadricKind::Cylinder { .. } => (turn, 1),
                        QuadricKind::Disk { .. } => (turn, 2),
                    };
                    for k in 0..columns * rows {
                        let cell = Vec2::new((k % columns) as f32, (k / columns) as f32);
                        let size = Vec2::new(columns as f32, rows as f32);
                        add(0, [cell / size, (cell + 1.0) / size], Sheet::Quadric(q.clone(), place.copied()));
                    }
                }
                Shape::Plane(plane) => {
                    if scene.planes().len() > PLANES {
                        return Err(Refusal::TooManyPlanes { count: scene.planes().len(), limit: PLANES });
                    }
                    // A rectangle of a plane stays one piece, other polygons become fans of triangles.
                    if let Some(part) = face_of(scene, index, plane, eye) {
                        let c = part.corners();
                        match *c {
                            [a, b, e, d] if (a + e - b - d).length() < 1e-6 * a.distance(e) => {
                                add(ON_PLANE, unit, Sheet::Quad([a, b, d, e]));
                            }
                            _ => {
                                (2..c.len()).for_each(|k| add(ON_PLANE, unit, Sheet::Triangle([c[0], c[k - 1], c[k]])))
                            }
                        }
                    }
                }
                Shape::Curves(_) => self.left_out.push("curves"),
                Shape::Field(_) => self.left_out.push("height fields"),
                Shape::Level(_) => self.left_out.push("surfaces by their equations"),
                Shape::Sdf(_) => self.left_out.push("signed distance functions"),
            }
        }
        let count = (self.pieces.len() - first) as u32;
        self.blocks.push(Block { first: first as u32, columns, rows, count });
        // Orientation: polygons face the way of the surface's normal.
        for k in first..self.pieces.len() {
            let piece = &self.pieces[k];
            let middle = piece.middle();
            let n = piece.seen(scene, middle, true).surface.n;
            let corners = piece.corners();
            let flipped = piece.polygon(&corners).normal().as_vec3().dot(n) < 0.0;
            self.pieces[k].flipped = flipped;
        }
        Ok(())
    }

    /// A sphere that holds the camera, all bounded geometry and lights with places.
    pub fn middle(&self, scene: &Scene) -> (DVec3, f64) {
        let bounds = extent(scene, self.eye.as_vec3());
        (bounds.center().as_dvec3(), 0.5 * f64::from(bounds.diagonal().length().max(1e-3)))
    }

    /// The piece that was hit, and the parameters in it.
    #[inline]
    pub fn locate(&self, i: &Interaction) -> Option<(u32, Vec2)> {
        let start = if i.id.instance == WORLD { 0 } else { *self.placed.get(i.id.instance as usize)? };
        let block = self.blocks.get((start + i.id.geom) as usize)?;
        if block.count == 0 {
            return None;
        }
        let piece = &self.pieces[block.first as usize];
        // Planes: the piece whose parameters hold the point.
        if piece.id.prim == ON_PLANE {
            return (block.first..block.first + block.count).find_map(|k| {
                let piece = &self.pieces[k as usize];
                let uv = piece.parameters(i);
                let edge = 1e-5;
                let holds = uv.min_element() >= -edge
                    && if piece.is_triangle() { uv.x + uv.y <= 1.0 + edge } else { uv.max_element() <= 1.0 + edge };
                holds.then_some((k, uv.clamp(Vec2::ZERO, Vec2::ONE)))
            });
        }
        // Quadrics: column and row of the parameters.
        if let Sheet::Quadric(..) = piece.sheet {
            let uv = piece.parameters(i).clamp(Vec2::ZERO, Vec2::ONE);
            let cell = |x: f32, n: u32| ((x * n as f32) as u32).min(n - 1);
            let k = cell(uv.y, block.rows) * block.columns + cell(uv.x, block.columns);
            return Some((block.first + k, uv));
        }
        (i.id.prim < block.count).then_some((block.first + i.id.prim, i.coordinates))
    }

    /// The piece nearest to a point of an infinite plane that lies beyond all its pieces, and the parameters there.
    pub fn nearest_on_plane(&self, i: &Interaction) -> Option<(u32, Vec2)> {
        let start = if i.id.instance == WORLD { 0 } else { *self.placed.get(i.id.instance as usize)? };
        let block = self.blocks.get((start + i.id.geom) as usize)?;
        let p = i.surface.p.as_dvec3();
        let on_plane =
            (block.first..block.first + block.count).filter(|k| self.pieces[*k as usize].id.prim == ON_PLANE);
        let distance = |(k, uv): &(u32, Vec2)| self.pieces[*k as usize].point(*uv).distance_squared(p);
        on_plane.map(|k| (k, self.pieces[k as usize].nearest(i))).min_by(|a, b| distance(a).total_cmp(&distance(b)))
    }
}

impl Piece {
    /// The corners in parameters, counterclockwise: three of a triangle, four of others.
    pub fn corners(&self) -> Vec<Vec2> {
        let [a, b] = self.domain;
        if self.is_triangle() {
            vec![Vec2::ZERO, Vec2::X, Vec2::Y]
        } else {
            vec![a, Vec2::new(b.x, a.y), b, Vec2::new(a.x, b.y)]
        }
    }

    /// The parameters of a flat piece that are nearest to those of a point of its plane.
    fn nearest(&self, i: &Interaction) -> Vec2 {
        let uv = self.parameters(i);
        if self.is_triangle() && uv.min_element() >= 0.0 && uv.element_sum() > 1.0 {
            let u = ((1.0 + uv.x - uv.y) / 2.0).clamp(0.0, 1.0);
            return Vec2::new(u, 1.0 - u);
        }
        // Of a triangle one coordinate is zero then.
        uv.clamp(Vec2::ZERO, Vec2::ONE)
    }

    /// Parameters in its middle.
    pub fn middle(&self) -> Vec2 {
        if self.is_triangle() { Vec2::splat(1.0 / 3.0) } else { (self.domain[0] + self.domain[1]) * 0.5 }
    }
}

/// Most infinite planes.
const PLANES: usize = 10;

/// The part of an infinite plane that the camera may see past the other opaque planes, within a box around everything.
fn face_of(scene: &Scene, index: u32, plane: &Plane, eye: DVec3) -> Option<Polygon> {
    // The other opaque planes; each keeps the side that the eye is on.
    let others: Vec<&Plane> = scene
        .planes()
        .iter()
        .filter(|g| **g != index)
        .map(|g| &scene.geometries()[*g as usize])
        .filter(|g| !g.is_masked() && !g.is_interface)
        .filter_map(|g| if let Shape::Plane(p) = &g.shape { Some(p) } else { None })
        .collect();
    let origin = |p: &Plane| (-p.n * p.d).as_dvec3();
    let ahead =
        |p: &Plane| if p.n.as_dvec3().dot(eye) + f64::from(p.d) < 0.0 { -p.n.as_dvec3() } else { p.n.as_dvec3() };
    let cut = |mut face: Polygon| {
        for other in &others {
            face = face.before(origin(other), ahead(other))?;
        }
        Some(face)
    };
    // A first face large enough for where the planes meet, then one that ends near what there is.
    let bounds = extent(scene, eye.as_vec3());
    let reach = f64::from(bounds.diagonal().length().max(1e-3)) * f64::from(1.0 + PLANE_MARGIN);
    let center = bounds.center().as_dvec3();
    let n = plane.n.as_dvec3();
    // A large square around the foot of the scene's centre, cut by all other planes.
    let foot = center - n * (n.dot(center) + f64::from(plane.d));
    // Along the planes that cut it, where that makes a rectangle.
    let edge = others.iter().map(|p| p.n.as_dvec3()).map(|m| m - n * m.dot(n)).find(|m| m.length() > 1e-3);
    let x = edge.unwrap_or(n.any_orthonormal_vector()).normalize() * reach;
    let y = n.cross(x.normalize()) * reach;
    cut(Polygon::new(&[foot - x - y, foot + x - y, foot + x + y, foot - x + y]))
}

/// A box around the eye, all bounded geometry, lights with places, and the points where three planes meet.
fn extent(scene: &Scene, eye: Vec3) -> Bounds3 {
    let mut bounds = Bounds3::from_points([eye]);
    let inner = scene.bounds();
    if !inner.is_empty() {
        bounds = bounds.union(inner);
    }
    for light in &scene.lights().lights {
        use steradian_core::light::Light;
        if let Light::Punctual(light) = light {
            bounds = bounds.union_point(light.position());
        }
    }
    let planes: Vec<&Plane> = scene
        .planes()
        .iter()
        .filter_map(|g| if let Shape::Plane(p) = &scene.geometries()[*g as usize].shape { Some(p) } else { None })
        .collect();
    // Corners of three planes, solved by their matrix, if they are not too far away.
    let reach = bounds.diagonal().length().max(1e-3) * 10.0;
    for (i, a) in planes.iter().enumerate() {
        for (j, b) in planes.iter().enumerate().skip(i + 1) {
            for c in &planes[j + 1..] {
                let m = glam::DMat3::from_cols(a.n.as_dvec3(), b.n.as_dvec3(), c.n.as_dvec3()).transpose();
                if m.determinant().abs() > 1e-6 {
                    let p = (m.inverse() * -DVec3::new(a.d.into(), b.d.into(), c.d.into())).as_vec3();
                    if p.distance(eye) < reach {
                        bounds = bounds.union_point(p);
                    }
                }
            }
        }
    }
    bounds
}
