//! Footprints and ray differentials at the hits of a scene.

use super::{Interaction, Scene, Shape, WORLD};
use crate::{
    footprint::{Bounce, RayDifferential},
    shape::QuadricKind,
};
use steradian_math::{Ray, Vec3};
use steradian_texture::Footprint;

impl Scene {
    /// The differential of a camera ray, where the scene has textures that ask for footprints.
    #[inline]
    pub fn ray_differential(&self, ray: &Ray) -> Option<RayDifferential> {
        let spacing = self.facts.footprints.as_ref()?.spacing;
        self.parts.camera.differential(&self.parts.film, ray, spacing)
    }

    /// The footprint at a hit: of the ray's differential where it has one, else as the camera would see the point.
    #[inline]
    pub fn footprint(&self, i: &Interaction, differential: Option<&RayDifferential>) -> Footprint {
        match &self.facts.footprints {
            None => Footprint::POINT,
            Some(camera) => {
                let [dpdx, dpdy] = match differential {
                    Some(d) => d.transfer(-i.wo, i.t, i.surface.n),
                    None => camera.displacements(&self.parts.camera, i.surface.p, i.surface.n),
                };
                Footprint::new(dpdx, dpdy, i.surface.dpdu, self.dpdv(i))
            }
        }
    }

    /// The differential of the ray that leaves a hit towards `wi`; `None` where it leaves the range of numbers.
    pub fn scatter_differential(
        &self,
        i: &Interaction,
        differential: &RayDifferential,
        wi: Vec3,
        bounce: Bounce,
    ) -> Option<RayDifferential> {
        let d = -i.wo;
        let dp = differential.transfer(d, i.t, i.surface.n);
        let dn = dp.map(|dp| self.normal_derivative(i, dp));
        let n = bounce.facet(d, wi, i.surface.ns);
        Some(differential.scatter(d, wi, n, dp, dn, bounce)).filter(RayDifferential::is_finite)
    }

    /// ∂p/∂v at a hit, in the world; may be zero. For curves it runs along the rim and for quadrics along the profile.
    pub fn dpdv(&self, i: &Interaction) -> Vec3 {
        let (u, v) = (i.coordinates.x, i.coordinates.y);
        let local = match &self.parts.geometries[i.geometry as usize].shape {
            Shape::Mesh(m) => m.dpdv(i.id.prim),
            Shape::Patches(m) => m.dpdv(i.id.prim, u, v),
            // Both are in the space that the point is in.
            Shape::Quadric(q) => q.dpdv(self.local_point(i)),
            Shape::Curves(c) => c.dpdv(i.id.prim, u, i.surface.n, i.surface.dpdu),
            Shape::Field(f) => f.dpdv(u, v),
            Shape::Level(l) => l.dpdv(self.local_point(i)),
            Shape::Sdf(_) => Vec3::ZERO,
            Shape::Plane(p) => p.dpdv(),
        };
        if i.id.instance == WORLD {
            local
        } else {
            self.parts.placements[i.id.instance as usize].at(i.time).vector(local)
        }
    }

    /// Derivative of the unit shading normal for a displacement of the point, in first order. The curvature of patches,
    /// curves and height fields is left out.
    fn normal_derivative(&self, i: &Interaction, dp: Vec3) -> Vec3 {
        match &self.parts.geometries[i.geometry as usize].shape {
            Shape::Mesh(m) if !m.normals.is_empty() => {
                let place = self.place(i.id, i.time);
                let into = |v: Vec3| place.map_or(v, |a| a.inverse().vector(v));
                let change = m.normal_change(i.id.prim, into(dp));
                let change = place.map_or(change, |a| a.normal(change));
                // Only the part across the normal turns it.
                change - i.surface.ns * change.dot(i.surface.ns)
            }
            Shape::Quadric(q) => match q.kind {
                QuadricKind::Sphere { .. } | QuadricKind::Cylinder { .. } => {
                    // Along the rim the normal turns as the point goes around; a cylinder's is straight along its axis.
                    let radius = q.world_radius();
                    let dp = match q.kind {
                        QuadricKind::Cylinder { .. } => {
                            let axis = self.dpdv(i).normalize_or_zero();
                            dp - axis * dp.dot(axis)
                        }
                        _ => dp,
                    };
                    let outward = if q.flip { -1.0 } else { 1.0 };
                    if radius > 0.0 { dp * (outward / radius) } else { Vec3::ZERO }
                }
                QuadricKind::Disk { .. } => Vec3::ZERO,
            },
            _ => Vec3::ZERO,
        }
    }

    /// The hit point in the space that its shape is placed in.
    fn local_point(&self, i: &Interaction) -> Vec3 {
        match i.id.instance {
            WORLD => i.surface.p,
            instance => self.parts.placements[instance as usize].at(i.time).inverse().point(i.surface.p),
        }
    }
}
