//! Facts derived from the parts of a scene, found once.

use super::{Geometry, Parts, Shape};
use crate::{
    camera::ViewFootprint,
    material::{self, Lambertian, Model, SurfaceDetail},
    medium::{EmissiveVolume, Medium, into_cube},
    shape::mesh::TriMesh,
};
use std::sync::Arc;
use steradian_math::Bounds3;

/// Facts derived from the parts of a scene.
#[derive(Clone, Debug)]
pub struct Facts {
    pub planes: Vec<u32>,
    pub footprints: Option<ViewFootprint>,
    pub is_timed: bool,
    pub has_mixtures: bool,
    pub has_media: bool,
    /// True if any surface is a shadow catcher.
    pub has_shadow_catchers: bool,
    /// True if there are polarisers or retarders.
    pub polarizes: bool,
    pub is_see_through: bool,
    /// Media that give off light, where it may arrive straight.
    pub emissive_volumes: Vec<EmissiveVolume>,
    pub has_curves: bool,
    /// Name of the subsurface transport in the scene, if there is any.
    pub below_surfaces: Option<&'static str>,
    pub is_fluorescent: bool,
    /// The back and the front of each material.
    pub constants: Vec<[Option<material::Constant>; 2]>,
    /// Each material whose sides reflect by Lambert's law, the same everywhere.
    pub lambertian: Vec<Option<Lambertian>>,
    /// Scattering kind of each geometry.
    pub kinds: Vec<Kind>,
    /// Mesh and reflectances of each geometry of the kind [`Kind::Lambertian`].
    pub lambertian_meshes: Vec<Option<(Arc<TriMesh>, Lambertian)>>,
}

impl Facts {
    pub fn of(parts: &Parts) -> Self {
        let Parts { geometries, materials, textures, camera, placements, .. } = parts;
        // Bump maps take their differences over the footprint, and normal maps their roughness.
        let has_detail = materials.iter().any(|m| {
            let filtered = |d: &SurfaceDetail| d.normal_map.as_ref().is_some_and(|m| m.filtered.is_some());
            m.detail.as_ref().is_some_and(|d| d.bump.is_some() || filtered(d))
        });
        let has_footprints = has_detail || textures.is_filtered();
        let world = &geometries[..parts.world_count as usize];
        let polarizes = materials.iter().any(|m| matches!(&m.model, Model::Parametric(p) if p.recipe.polarizes));
        let is_see_through =
            polarizes || materials.iter().any(|m| matches!(m.model, Model::ThinDielectric { .. } | Model::Interface));
        Self {
            planes: (0..).zip(world).filter(|(_, g)| matches!(g.shape, Shape::Plane(_))).map(|(i, _)| i).collect(),
            footprints: has_footprints.then(|| camera.view_footprint(&parts.film, parts.spp)),
            is_timed: textures.is_timed()
                || camera.motion.is_some()
                || parts.lights.timetable.is_some()
                || placements.iter().any(|p| p.motion.is_some()),
            has_mixtures: materials.iter().any(|m| matches!(m.model, Model::Mix(..) | Model::Fluorescent(_))),
            is_fluorescent: materials.iter().any(|m| matches!(m.model, Model::Fluorescent(_))),
            has_media: parts.has_media(),
            has_shadow_catchers: geometries.iter().any(|g| g.catches_shadows),
            polarizes,
            is_see_through,
            emissive_volumes: if is_see_through { emissive_volumes(parts) } else { Vec::new() },
            below_surfaces: materials.iter().find_map(|m| m.model.below()),
            has_curves: geometries.iter().any(|g| g.shape.faces_rays()),
            constants: material::constants(materials, textures),
            lambertian: material::lambertian(materials),
            kinds: Vec::new(),
            lambertian_meshes: Vec::new(),
        }
    }
}

/// The media that give off light within bounds.
fn emissive_volumes(parts: &Parts) -> Vec<EmissiveVolume> {
    let cube = |index: u32, medium: &Medium| match &medium.field {
        Some(field) => Some(*field.cube()),
        None => into_cube(&filled(parts, index)),
    };
    let emissive = (0..).zip(&parts.media).filter(|(_, m)| m.glow.is_some());
    let mut found: Vec<_> = emissive.filter_map(|(i, m)| EmissiveVolume::new(i, m, &cube(i, m)?, parts.mode)).collect();
    let total: f32 = found.iter().map(|(_, power)| power).sum();
    found.iter_mut().for_each(|(volume, power)| volume.probability = *power / total);
    found.into_iter().map(|(volume, _)| volume).collect()
}

/// The box around what a medium is within.
fn filled(parts: &Parts, medium: u32) -> Bounds3 {
    let within = |g: &&Geometry| g.media.is_some_and(|(inner, _)| inner == Some(medium));
    let bounds = |of: &[Geometry]| of.iter().filter(within).fold(Bounds3::EMPTY, |b, g| b.union(g.shape.bounds()));
    let world = bounds(&parts.geometries[..parts.world_count as usize]);
    parts.placements.iter().fold(world, |all, p| {
        let group = bounds(&parts.geometries[p.base as usize..][..p.count as usize]);
        if group.is_empty() { all } else { all.union(p.world_from_group.bounds(&group)) }
    })
}

/// Scattering of a geometry, as far as it is simple.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Any scattering.
    Any,
    /// Lambert's law, with one albedo everywhere on each side: a mesh in the world that emits nothing and separates no
    /// media.
    Lambertian,
    /// No scattering: Lambert's law with an albedo of zero.
    Black,
}

impl Facts {
    /// Finds the kinds of geometries, which takes what is asked of their points.
    pub fn find_kinds(&mut self, parts: &Parts) {
        let kind = |(number, g): (usize, &Geometry)| {
            let Some(lambertian) = &self.lambertian[g.material as usize] else { return Kind::Any };
            let is_plain = g.emitter.is_none() && g.media.is_none() && number < parts.world_count as usize;
            if g.is_interface || g.needs.tangent {
                Kind::Any
            } else if lambertian.is_black() {
                Kind::Black
            } else if is_plain && matches!(g.shape, Shape::Mesh(_)) && !g.needs.parameters {
                Kind::Lambertian
            } else {
                Kind::Any
            }
        };
        self.kinds = parts.geometries.iter().enumerate().map(kind).collect();
        let mesh = |(kind, g): (&Kind, &Geometry)| match (kind, &g.shape) {
            (Kind::Lambertian, Shape::Mesh(mesh)) => {
                Some((Arc::clone(mesh), self.lambertian[g.material as usize].clone()?))
            }
            _ => None,
        };
        self.lambertian_meshes = self.kinds.iter().zip(&parts.geometries).map(mesh).collect();
    }
}
