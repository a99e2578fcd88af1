//! Rays through a scene: nearest surfaces, occlusion, and the opacity that lets rays pass.

use super::{Geometry, Interaction, Scene, Shape};
use steradian_accel::{Hit, PrimId, Steps, UserHit, UserPrimitives, WORLD};
use steradian_math::{Ray, Vec2, Vec3};
use steradian_texture::{FloatTexture, TextureContext, hash_point};

/// Emitting surfaces that a camera ray passes at most where lights are hidden.
const MAX_EMITTERS_PASSED: u32 = 1 << 16;

/// The callbacks of the hierarchy. `SHADOW` queries pass through shapes that scatter nothing.
struct Query<'a, const SHADOW: bool> {
    scene: &'a Scene,
    /// True if surfaces count wherever they have any opacity; otherwise by the stochastic alpha test.
    any_opacity: bool,
}

impl<'a, const SHADOW: bool> Query<'a, SHADOW> {
    fn of(scene: &'a Scene) -> Self {
        Self { scene, any_opacity: false }
    }
}

impl<const SHADOW: bool> Query<'_, SHADOW> {
    /// True if a hit counts; hit and ray are in the space of the shape's group.
    #[inline]
    fn passes(&self, geometry: &Geometry, hit: &Hit, ray: &Ray) -> bool {
        if SHADOW && geometry.is_interface {
            return false;
        }
        if geometry.is_single_sided && geometry.shape.front(hit, ray).dot(ray.direction) > 0.0 {
            return false;
        }
        match &geometry.alpha {
            None => true,
            Some(alpha) if self.any_opacity => self.scene.alpha_at(geometry, alpha, hit, ray).0 > 0.0,
            Some(alpha) => self.scene.is_opaque_at(geometry, alpha, hit, ray),
        }
    }

    /// The nearest infinite plane; the ray is cut there.
    #[inline]
    fn nearest_plane(&self, ray: &mut Ray) -> Option<Hit> {
        let mut best = None;
        for &g in &self.scene.facts.planes {
            let geometry = &self.scene.parts.geometries[g as usize];
            let Shape::Plane(plane) = &geometry.shape else { continue };
            let Some(t) = plane.intersect(ray) else { continue };
            let hit = Hit { t, u: 0.0, v: 0.0, id: PrimId { instance: WORLD, geom: g, prim: 0 } };
            if self.passes(geometry, &hit, ray) {
                ray.t_max = t;
                best = Some(hit);
            }
        }
        best
    }
}

impl<const SHADOW: bool> UserPrimitives for Query<'_, SHADOW> {
    #[inline]
    fn intersect(&self, id: PrimId, ray: &Ray) -> Option<UserHit> {
        let geometry = self.scene.geometry(id);
        let passes = |h: &UserHit| self.passes(geometry, &Hit { t: h.t, u: h.u, v: h.v, id }, ray);
        geometry.shape.intersect(id.prim, ray, passes)
    }

    #[inline]
    fn accept(&self, hit: &Hit, ray: &Ray) -> bool {
        self.passes(self.scene.geometry(hit.id), hit, ray)
    }
}

impl Scene {
    /// Tests a hit found otherwise than by [`Scene::intersect`]: false if the opacity of its shape lets the ray
    /// through. The ray is in the space of the shape's group.
    #[inline]
    pub fn counts(&self, hit: &Hit, ray: &Ray) -> bool {
        Query::<false>::of(self).passes(self.geometry(hit.id), hit, ray)
    }

    /// Probability that [`Scene::counts`] is true: the opacity of a shape at a hit, 0 on a side that is culled.
    pub fn coverage(&self, hit: &Hit, ray: &Ray) -> f32 {
        let geometry = self.geometry(hit.id);
        if geometry.is_single_sided && geometry.shape.front(hit, ray).dot(ray.direction) > 0.0 {
            return 0.0;
        }
        geometry.alpha.as_ref().map_or(1.0, |alpha| self.alpha_at(geometry, alpha, hit, ray).0.clamp(0.0, 1.0))
    }

    /// True if some surface of the scene is neither opaque nor absent.
    pub fn has_layers(&self) -> bool {
        let is_partial = |alpha: &FloatTexture| !matches!(*alpha, FloatTexture::Constant(..=0.0 | 1.0..));
        self.parts.geometries.iter().any(|geometry| geometry.alpha.as_ref().is_some_and(is_partial))
    }

    /// Stochastic alpha test: true if the hit counts, by a random number that is a function of ray and point.
    fn is_opaque_at(&self, geometry: &Geometry, alpha: &FloatTexture, hit: &Hit, ray: &Ray) -> bool {
        if let FloatTexture::Constant(a @ (..=0.0 | 1.0..)) = *alpha {
            return a >= 1.0;
        }
        let (a, p) = self.alpha_at(geometry, alpha, hit, ray);
        a >= 1.0 || (a > 0.0 && hash_point(p, ray.direction, hit.id.prim) < a)
    }

    /// The probability with which a ray that met a surface met it, in (0, 1].
    #[inline]
    pub fn opacity(&self, i: &Interaction) -> f32 {
        let geometry = &self.parts.geometries[i.geometry as usize];
        let Some(alpha) = &geometry.alpha else { return 1.0 };
        let ray = Ray { time: i.time, ..Ray::new(i.surface.p + i.wo * i.t, -i.wo) };
        let ray = self.place(i.id, i.time).map_or(ray, |place| place.inverse().ray(&ray));
        let hit = Hit { t: i.t, u: i.coordinates.x, v: i.coordinates.y, id: i.id };
        match self.alpha_at(geometry, alpha, &hit, &ray).0 {
            a @ f32::MIN_POSITIVE..1.0 => a,
            _ => 1.0,
        }
    }

    /// Opacity at a hit, and the point at which it was looked up. The ray is in the space of the shape's group.
    fn alpha_at(&self, geometry: &Geometry, alpha: &FloatTexture, hit: &Hit, ray: &Ray) -> (f32, Vec3) {
        let mut at = match &geometry.shape {
            Shape::Mesh(m) => TextureContext {
                mesh: Some((&**m, hit.id.prim, Vec2::new(hit.u, hit.v))),
                ..TextureContext::new(ray.at(hit.t), m.uv(hit.id.prim, hit.u, hit.v))
            },
            _ => {
                let s = geometry.shape.surface(hit, ray);
                TextureContext { n: s.ns, ..TextureContext::new(s.p, s.uv) }
            }
        };
        let p = at.p;
        if self.facts.footprints.is_some()
            && matches!(alpha, FloatTexture::Texture(id) if self.parts.textures.effort(*id).is_filtered)
        {
            // Nothing is known of how the ray came: the footprint is that which the camera would have here.
            let place = self.place(hit.id, ray.time);
            let i = self.interaction(&place.map_or(*ray, |place| place.ray(ray)), hit);
            (at.p, at.n, at.footprint) = (i.surface.p, i.surface.ns, self.footprint(&i, None));
        }
        (alpha.eval(&self.parts.textures, &at), p)
    }

    /// The nearest surface along a ray.
    pub fn intersect(&self, ray: &Ray) -> Option<Hit> {
        if self.facts.planes.is_empty() {
            return self.parts.accel.intersect(ray, &Query::<false>::of(self));
        }
        let mut ray = *ray;
        let plane = self.nearest_plane::<false>(&mut ray);
        self.parts.accel.intersect(&ray, &Query::<false>::of(self)).or(plane)
    }

    /// The nearest surface along a ray that has any opacity there, and its opacity: the layers of a pixel, one by one.
    pub fn intersect_layer(&self, ray: &Ray) -> Option<(Hit, f32)> {
        let query = Query::<false> { scene: self, any_opacity: true };
        let mut ray = *ray;
        let plane = query.nearest_plane(&mut ray);
        let hit = self.parts.accel.intersect(&ray, &query).or(plane)?;
        let place = self.place(hit.id, ray.time);
        let local = place.map_or(ray, |place| place.inverse().ray(&ray));
        Some((hit, self.coverage(&hit, &local)))
    }

    /// [`Scene::intersect`] of many rays at once.
    ///
    /// # Panics
    /// When the slices differ in length.
    pub fn intersect_batch(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        if self.facts.planes.is_empty() {
            self.parts.accel.intersect_batch(rays, &Query::<false>::of(self), hits);
        } else {
            assert_eq!(rays.len(), hits.len(), "one place for each ray");
            rays.iter().zip(hits).for_each(|(ray, hit)| *hit = self.intersect(ray));
        }
    }

    /// [`Scene::occluded`] of many rays at once.
    ///
    /// # Panics
    /// When the slices differ in length.
    pub fn occluded_batch(&self, rays: &[Ray], occluded: &mut [bool]) {
        if self.facts.planes.is_empty() {
            self.parts.accel.occluded_batch(rays, &Query::<true>::of(self), occluded);
        } else {
            assert_eq!(rays.len(), occluded.len(), "one place for each ray");
            rays.iter().zip(occluded).for_each(|(ray, is)| *is = self.occluded(ray));
        }
    }

    /// True if the ray meets anything that scatters within its interval.
    pub fn occluded(&self, ray: &Ray) -> bool {
        let meets_plane = || self.nearest_plane::<true>(&mut ray.clone()).is_some();
        !self.facts.planes.is_empty() && meets_plane() || self.parts.accel.occluded(ray, &Query::<true>::of(self))
    }

    /// The nearest surface along a camera ray where lights are hidden from the camera, and the part of the ray that
    /// begins behind the last light it passed: emitting surfaces let camera rays pass on both sides, as in Mitsuba 3.9.
    pub fn intersect_past_emitters(&self, ray: &Ray) -> Option<(Ray, Hit)> {
        let mut ray = *ray;
        for _ in 0..MAX_EMITTERS_PASSED {
            let hit = self.intersect(&ray)?;
            if self.geometry(hit.id).emitter.is_none() {
                return Some((ray, hit));
            }
            let next = self.interaction_of_light(&ray, &hit).spawn(ray.direction);
            ray = Ray { t_max: ray.t_max - (next.origin - ray.origin).length(), ..next };
            if ray.t_max <= 0.0 {
                return None;
            }
        }
        None
    }

    /// True if the ray meets anything that scatters and emits no light within its interval, which hides a point from a
    /// camera that does not see lights.
    pub fn occluded_past_emitters(&self, ray: &Ray) -> bool {
        let mut ray = *ray;
        while let Some((from, hit)) = self.intersect_past_emitters(&ray) {
            if !self.geometry(hit.id).is_interface {
                return true;
            }
            let next = self.interaction_of_light(&from, &hit).spawn(ray.direction);
            ray = Ray { t_max: from.t_max - (next.origin - from.origin).length(), ..next };
            if ray.t_max <= 0.0 {
                break;
            }
        }
        false
    }

    /// Traversal cost of [`Scene::intersect`].
    pub fn intersect_cost(&self, ray: &Ray) -> Steps {
        let mut ray = *ray;
        self.nearest_plane::<false>(&mut ray);
        self.parts.accel.intersect_cost(&ray, &Query::<false>::of(self))
    }

    /// Traversal cost of [`Scene::occluded`].
    pub fn occluded_cost(&self, ray: &Ray) -> Steps {
        match self.nearest_plane::<true>(&mut ray.clone()) {
            Some(_) => Steps::default(),
            None => self.parts.accel.occluded_cost(ray, &Query::<true>::of(self)),
        }
    }

    /// [`Query::nearest_plane`] of rays that obey the stochastic alpha test.
    #[inline]
    fn nearest_plane<const SHADOW: bool>(&self, ray: &mut Ray) -> Option<Hit> {
        Query::<SHADOW>::of(self).nearest_plane(ray)
    }
}
