//! A scene as the structures of the ray-tracing pipeline: meshes as triangles, other shapes as procedural primitives in
//! boxes, in which the shape itself is met. Masks are asked where candidates are.

use crate::{
    Error,
    draw_list::{DrawList, Item, box_count, part_bounds},
    visibility::{Border, local, meet},
};
use std::sync::Arc;
use steradian_accel::PrimId;
use steradian_core::{
    Scene,
    scene::{Hit, Shape},
};
use steradian_math::{Bounds3, Ray};
use steradian_rt::{
    BottomLevel, BoxGeometry, BuildError, BuildOptions, Geometries, GeometryFlags, HitKind, Instance, QueryCandidate,
    RayDesc, RayFlags, RayQuery, TopLevel, Transform3x4, TriangleGeometry,
};

/// All rays meet all instances.
const MASK: u32 = 0xff;
/// Hits on shapes are of one kind.
const SHAPE: HitKind = match HitKind::procedural(0) {
    Some(kind) => kind,
    None => HitKind::TRIANGLE_BACK_FACE,
};

/// Acceleration structures for the rays of a frame.
#[derive(Debug)]
pub struct World {
    top: TopLevel,
    /// Draw list, which numbers the instances.
    list: DrawList,
    /// Infinite planes among it, which have no boxes.
    planes: Vec<Item>,
}

impl World {
    /// Builds the structures of what a list draws.
    ///
    /// # Errors
    /// More instances, geometries or primitives than the pipeline counts.
    pub fn new(scene: &Scene, list: &DrawList) -> Result<Self, Error> {
        let build = || -> Result<TopLevel, BuildError> {
            // Placements of a group share its structures.
            let mut levels: Vec<Option<Arc<BottomLevel>>> = vec![None; scene.geometries().len()];
            let mut instances = Vec::new();
            for (number, item) in list.items.iter().enumerate() {
                let place = Transform3x4::from_mat4(&item.place(scene).m);
                // What is squeezed flat cannot be met.
                let is_flat = !item.place(scene).m.inverse().is_finite();
                if is_flat || matches!(list.geometry(scene, item).shape, Shape::Plane(_)) {
                    continue;
                }
                let level = &mut levels[item.geometry as usize];
                let level = match level {
                    Some(level) => level.clone(),
                    None => level.insert(Arc::new(bottom_level(scene, list, item)?)).clone(),
                };
                instances.push(Instance::new(level).with_transform(place).with_custom_index(number as u32));
            }
            TopLevel::build(&instances, BuildOptions::default())
        };
        let top = build().map_err(|e| Error::Scene(format!("the ray-tracing pipeline: {e}")))?;
        let is_plane = |item: &&Item| scene.planes().contains(&item.geometry);
        let planes = list.items.iter().filter(is_plane).copied().collect();
        Ok(Self { top, list: list.clone(), planes })
    }

    /// Nearest hit of a ray.
    pub fn nearest(&self, scene: &Scene, ray: &Ray) -> Option<Hit> {
        self.search(scene, ray, RayFlags::NONE)
    }

    /// True if a ray is occluded.
    pub fn is_occluded(&self, scene: &Scene, ray: &Ray) -> bool {
        self.search(scene, ray, RayFlags::ACCEPT_FIRST_HIT_AND_END_SEARCH).is_some()
    }

    fn search(&self, scene: &Scene, ray: &Ray, flags: RayFlags) -> Option<Hit> {
        // A ray query without shaders: the loop below is what any-hit and intersection shaders would be.
        let desc = RayDesc::new(ray.origin, ray.direction).with_extents(0.0, ray.t_max);
        // A ray that breaks a rule (one with a NaN) meets nothing.
        let mut query = RayQuery::new(Some(&self.top), flags, MASK, desc).ok()?;
        let mut met = None;
        while let Some(candidate) = query.proceed() {
            match candidate {
                QueryCandidate::Triangle(mut candidate) => {
                    let Some(item) = self.item(candidate.primitive().custom_index()) else { continue };
                    let (at, id) = (candidate.barycentrics(), id(item, candidate.primitive().primitive_index()));
                    let hit = Hit { t: candidate.t(), u: at.u, v: at.v, id };
                    if scene.counts(&hit, &local(scene, item, ray)) {
                        candidate.confirm();
                    }
                }
                QueryCandidate::Procedural(mut candidate) => {
                    let Some(item) = self.item(candidate.primitive().custom_index()) else { continue };
                    let part = candidate.primitive().primitive_index();
                    let end = Ray { t_max: candidate.ray().t_current, ..*ray };
                    // The shape is intersected within its box; the query keeps the nearest committed distance.
                    let found = meet(scene, item, part, &end, Border::Excluded, |h, ray| scene.counts(h, ray));
                    if let Some(hit) = found.filter(|hit| candidate.generate(hit.t, SHAPE)) {
                        met = Some(hit);
                    }
                }
            }
        }
        // The committed hit is a triangle, or the last shape that was accepted.
        let committed = query.committed().and_then(|hit| {
            if !hit.kind.is_triangle() {
                return met;
            }
            let item = self.item(hit.primitive.custom_index())?;
            let id = id(item, hit.primitive.primitive_index());
            Some(Hit { t: hit.t, u: hit.barycentrics.u, v: hit.barycentrics.v, id })
        });
        self.nearest_with_planes(scene, ray, committed)
    }

    /// Nearest hit of a ray, infinite planes included.
    fn nearest_with_planes(&self, scene: &Scene, ray: &Ray, found: Option<Hit>) -> Option<Hit> {
        // Infinite planes are tested one by one behind the traversal.
        self.planes.iter().fold(found, |nearest, item| {
            let end = Ray { t_max: nearest.map_or(ray.t_max, |hit| hit.t), ..*ray };
            meet(scene, item, 0, &end, Border::Excluded, |h, ray| scene.counts(h, ray))
                .filter(|hit| hit.t < end.t_max)
                .or(nearest)
        })
    }

    fn item(&self, number: u32) -> Option<&Item> {
        self.list.items.get(number as usize)
    }
}

fn id(item: &Item, part: u32) -> PrimId {
    PrimId { instance: item.instance, geom: item.in_group, prim: part }
}

/// The structure of an item's geometry.
fn bottom_level(scene: &Scene, list: &DrawList, item: &Item) -> Result<BottomLevel, BuildError> {
    let geometry = list.geometry(scene, item);
    let flags = if geometry.is_masked() { GeometryFlags::NONE } else { GeometryFlags::OPAQUE };
    match &geometry.shape {
        Shape::Mesh(mesh) => {
            let triangles = TriangleGeometry::indexed(&mesh.positions, mesh.triangles.as_flattened());
            BottomLevel::build(Geometries::Triangles(&[triangles.with_flags(flags)]), BuildOptions::default())
        }
        shape => {
            let parts = 0..box_count(shape).unwrap_or(0);
            let boxes: Vec<Bounds3> = parts.map(|part| part_bounds(shape, part)).collect();
            BottomLevel::build(Geometries::Boxes(&[BoxGeometry::new(&boxes)]), BuildOptions::default())
        }
    }
}
