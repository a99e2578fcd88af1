//! The immutable scene: geometry, materials, textures, lights, media, camera and film, and the queries on them.
//!
//! There is no epsilon in scene units. A hit has a box that contains the true point, and spawned rays start just
//! outside it. The triangle test is watertight and rejects hits within the rounding error of the origin, so that no ray
//! meets the surface again that it leaves. Shadow rays end a relative 10⁻⁴ before the light ([`SHADOW_END`]).
//!
//! A scene whose details lie too far from the origin for single precision is compiled around another origin
//! (`Scene::origin`). Points of the world pass `Scene::from_file` on the way in and `Scene::to_file` on the way out.

mod ambient;
mod derived;
mod differentials;
mod motion_vectors;
mod parts;
mod queries;
mod tables;

pub use crate::shape::Shape;
use crate::{
    camera::Camera,
    film::FilmSpec,
    footprint::RayDifferential,
    light::{LightGroups, Lights},
    material::{self, Lambertian, Material, Model, Needs, Scattering, SurfaceDetail, detail::Base},
    medium::{EmissiveVolume, Medium},
    shape::{SurfacePoint, TriMesh},
};
use derived::{Facts, Kind};
pub use motion_vectors::Moved;
pub use parts::{Geometry, Parts, Placement, Settings};
use std::{collections::BTreeMap, sync::Arc};
use steradian_accel::Accel;
pub use steradian_accel::{Hit, PrimId, WORLD};
use steradian_math::{
    Bounds3, DVec3, Frame, Ray, Vec2, Vec3,
    ray::offset_ray_origin,
    spectra::{ColorMode, Wavelengths},
    transform::Affine,
};
use steradian_request::MethodRequest;
use steradian_texture::{Footprint, MeshAttributes, TextureContext, Textures, pages::Pages};
pub use tables::Table;

/// A scene that can be rendered: its [`Parts`], and what follows from them.
#[derive(Clone, Debug)]
pub struct Scene {
    parts: Parts,
    facts: Facts,
}

impl Scene {
    /// The scene of these parts.
    pub fn new(mut parts: Parts) -> Self {
        let mut facts = Facts::of(&parts);
        set_needs(&mut parts, facts.footprints.is_some());
        facts.find_kinds(&parts);
        Self { parts, facts }
    }

    /// Changes some of its parts.
    pub fn change(&mut self, change: impl FnOnce(&mut Parts)) {
        change(&mut self.parts);
        self.facts = Facts::of(&self.parts);
        set_needs(&mut self.parts, self.facts.footprints.is_some());
        self.facts.find_kinds(&self.parts);
    }

    /// Scene with local stand-ins for materials with subsurface transport and for those that change the wavelength, for
    /// methods that do not follow light there.
    #[must_use]
    pub fn with_local_scattering(self) -> Self {
        self.changed(|parts| {
            for material in &mut parts.materials {
                material.model.make_local();
            }
        })
    }

    /// Scene with some of its parts changed.
    #[must_use]
    pub fn changed(mut self, change: impl FnOnce(&mut Parts)) -> Self {
        self.change(change);
        self
    }

    /// Meaning of the spectral lanes.
    #[inline]
    pub fn mode(&self) -> ColorMode {
        self.parts.mode
    }

    /// World geometry first, then that of each group.
    #[inline]
    pub fn geometries(&self) -> &[Geometry] {
        &self.parts.geometries
    }

    /// The structure that rays go through: the hierarchy, unless another one was asked for.
    #[inline]
    pub fn accel(&self) -> &Accel {
        &self.parts.accel
    }

    /// Placed groups, by the hierarchy's instance index.
    #[inline]
    pub fn placements(&self) -> &[Placement] {
        &self.parts.placements
    }

    /// Number of geometries of the world itself; those of groups follow.
    #[inline]
    pub fn world_count(&self) -> u32 {
        self.parts.world_count
    }

    /// Indices of infinite planes among the geometries.
    #[inline]
    pub fn planes(&self) -> &[u32] {
        &self.facts.planes
    }

    /// Materials.
    #[inline]
    pub fn materials(&self) -> &[Material] {
        &self.parts.materials
    }

    /// Textures.
    #[inline]
    pub fn textures(&self) -> &Textures {
        &self.parts.textures
    }

    /// Lights.
    #[inline]
    pub fn lights(&self) -> &Lights {
        &self.parts.lights
    }

    /// Media.
    #[inline]
    pub fn media(&self) -> &[Medium] {
        &self.parts.media
    }

    /// The point of the file's world that is the scene's origin.
    pub fn origin(&self) -> DVec3 {
        self.parts.origin
    }

    /// A point of the file's world in the scene's coordinates.
    pub fn from_file(&self, p: DVec3) -> Vec3 {
        (p - self.parts.origin).as_vec3()
    }

    /// A point of the scene in the file's world.
    pub fn to_file(&self, p: Vec3) -> DVec3 {
        p.as_dvec3() + self.parts.origin
    }

    /// Camera.
    #[inline]
    pub fn camera(&self) -> &Camera {
        &self.parts.camera
    }

    /// Film.
    #[inline]
    pub fn film(&self) -> &FilmSpec {
        &self.parts.film
    }

    /// The method that the scene's file names, with its options.
    pub fn method(&self) -> Option<&MethodRequest> {
        self.parts.method.as_ref()
    }

    /// Settings of the scene.
    #[inline]
    pub fn settings(&self) -> &Settings {
        &self.parts.settings
    }

    /// Groups of lights.
    #[inline]
    pub fn light_groups(&self) -> &LightGroups {
        &self.parts.light_groups
    }

    /// Names of objects, by [`Geometry::id`]; those that the file gives none are numbered.
    #[inline]
    pub fn object_names(&self) -> &BTreeMap<u32, String> {
        &self.parts.object_names
    }

    /// Names of materials, by index, for reports.
    #[inline]
    pub fn material_names(&self) -> &[String] {
        &self.parts.material_names
    }

    /// Page store of the textures that are not in memory, if texture memory is limited.
    #[inline]
    pub fn texture_pages(&self) -> Option<&Arc<Pages>> {
        self.parts.texture_pages.as_ref()
    }

    /// True if anything changes over the exposure.
    #[inline]
    pub fn is_timed(&self) -> bool {
        self.facts.is_timed
    }

    /// True if any material is a mixture.
    #[inline]
    pub fn has_mixtures(&self) -> bool {
        self.facts.has_mixtures
    }

    /// True if light is absorbed or scattered between surfaces.
    #[inline]
    pub fn has_media(&self) -> bool {
        self.facts.has_media
    }

    /// True if pictures show only the shadows of some surfaces.
    #[inline]
    pub fn has_shadow_catchers(&self) -> bool {
        self.facts.has_shadow_catchers
    }

    /// True if there are polarisers or retarders.
    #[inline]
    pub fn polarizes(&self) -> bool {
        self.facts.polarizes
    }

    /// True if there are surfaces that light passes straight: interfaces, thin panes, polarisers, retarders.
    #[inline]
    pub fn is_see_through(&self) -> bool {
        self.facts.is_see_through
    }

    /// Emissive media within bounds whose light may arrive straight.
    #[inline]
    pub fn emissive_volumes(&self) -> &[EmissiveVolume] {
        &self.facts.emissive_volumes
    }

    /// True if light enters any material to leave it elsewhere.
    #[inline]
    pub fn has_subsurface(&self) -> bool {
        self.facts.below_surfaces.is_some()
    }

    /// Name of the subsurface transport, with its material; `None` without any.
    pub fn below_surfaces(&self) -> Option<&'static str> {
        self.facts.below_surfaces
    }

    /// True if any material is fluorescent: reradiates light at other wavelengths.
    #[inline]
    pub fn is_fluorescent(&self) -> bool {
        self.facts.is_fluorescent
    }

    /// True if any light does not always shine.
    #[inline]
    pub fn has_schedules(&self) -> bool {
        self.parts.lights.timetable.is_some()
    }

    /// True if paths must be traced one by one from the eye: light goes below surfaces, or changes its wavelength, or
    /// does not always shine.
    #[inline]
    pub fn needs_scalar_path_tracer(&self) -> bool {
        self.has_subsurface() || self.is_fluorescent() || self.has_schedules()
    }

    /// True if there are curves, which face the ray ([`Scene::faces_rays`]).
    #[inline]
    pub fn has_curves(&self) -> bool {
        self.facts.has_curves
    }
}

/// Sets the data that each geometry's hits need. Footprints go on from any surface.
fn set_needs(parts: &mut Parts, has_footprints: bool) {
    let mut needs = Vec::with_capacity(parts.materials.len());
    for material in &parts.materials {
        needs.push(material.needs(&needs));
    }
    for geometry in &mut parts.geometries {
        let needs = needs[geometry.material as usize];
        let is_shown = geometry.emitter.is_some_and(|e| parts.lights.emitters[e as usize].is_textured());
        geometry.needs = Needs { parameters: needs.parameters || is_shown || has_footprints, ..needs };
    }
}

/// A point of a surface that a ray met.
#[derive(Clone, Copy, Debug)]
pub struct Interaction {
    /// The surface there.
    pub surface: SurfacePoint,
    /// Unit direction back along the ray.
    pub wo: Vec3,
    /// Distance along the ray, in units of its direction.
    pub t: f32,
    /// The moment of the exposure.
    pub time: f32,
    /// Index of the geometry.
    pub geometry: u32,
    /// The primitive.
    pub id: PrimId,
    /// Barycentric or surface coordinates of the hit.
    pub coordinates: Vec2,
}

impl Interaction {
    /// A ray that leaves the surface in a direction.
    #[inline]
    pub fn spawn(&self, direction: Vec3) -> Ray {
        let s = &self.surface;
        Ray { time: self.time, ..Ray::new(offset_ray_origin(s.p, s.error, s.n, direction), direction) }
    }

    /// The rest of the ray that arrived, behind the surface.
    #[inline]
    pub fn rest(&self, ray: &Ray) -> Ray {
        Ray { t_max: ray.t_max - self.t, ..self.spawn(ray.direction) }
    }

    /// A ray to a point at a distance in a unit direction, that ends just before it.
    #[inline]
    pub fn spawn_towards(&self, direction: Vec3, distance: f32) -> Ray {
        let s = &self.surface;
        Ray { time: self.time, ..shadow_ray(s.p, offset_ray_origin(s.p, s.error, s.n, direction), direction, distance) }
    }
}

/// The ray from an origin near a point to what is at a distance from that in a unit direction, which ends just before.
#[inline(always)]
pub fn shadow_ray(p: Vec3, origin: Vec3, direction: Vec3, distance: f32) -> Ray {
    // Rays start off curves by their width: there the direction to the point is another.
    let moved = origin - p;
    let is_moved = moved.length_squared() > (MOVED * distance) * (MOVED * distance);
    let to = direction * distance - moved;
    let left = to.length();
    let (direction, distance) = if is_moved { (to / left, left) } else { (direction, distance) };
    Ray { t_max: distance * SHADOW_END, ..Ray::new(origin, direction) }
}

/// Shadow rays end this share of the way to the light, so that they do not meet it.
pub const SHADOW_END: f32 = 1.0 - 1e-4;

/// Shadow rays that start off the surface by less than this share of the way keep their direction.
const MOVED: f32 = 1e-5;

impl Scene {
    /// A scene to be made in code, by types (`steradian_scene::build`). What it builds is a description, which
    /// `steradian_compile::compile` turns into a scene.
    pub fn builder() -> steradian_scene::build::SceneBuilder {
        steradian_scene::build::Scene::builder()
    }

    /// True if a primitive belongs to a mesh in the world that emits nothing, separates no media, and of which each
    /// side scatters by Lambert's law, the same everywhere.
    #[inline]
    pub fn is_lambertian(&self, id: PrimId) -> bool {
        id.instance == WORLD && self.facts.kinds[id.geom as usize] == Kind::Lambertian
    }

    /// Mesh and reflectances of a primitive for which [`Scene::is_lambertian`] holds; `None` for others.
    #[inline]
    pub fn lambertian(&self, id: PrimId) -> Option<(&TriMesh, &Lambertian)> {
        let (mesh, lambertian) = self.facts.lambertian_meshes.get(id.geom as usize)?.as_ref()?;
        (id.instance == WORLD).then_some((mesh, lambertian))
    }

    /// True if a geometry scatters nothing, being black.
    #[inline]
    pub fn is_black(&self, geometry: u32) -> bool {
        self.facts.kinds[geometry as usize] == Kind::Black
    }

    /// The geometry of a primitive.
    #[inline]
    pub fn geometry(&self, id: PrimId) -> &Geometry {
        &self.parts.geometries[self.geometry_index(id) as usize]
    }

    #[inline]
    fn geometry_index(&self, id: PrimId) -> u32 {
        if id.instance == WORLD { id.geom } else { self.parts.placements[id.instance as usize].base + id.geom }
    }

    /// Transform of a primitive's group at a moment of the exposure; `None` in the world.
    #[inline]
    pub fn place(&self, id: PrimId, time: f32) -> Option<Affine> {
        (id.instance != WORLD).then(|| self.parts.placements[id.instance as usize].at(time))
    }

    /// The light that a point of a surface belongs to, if any finds it.
    #[inline]
    pub fn light(&self, i: &Interaction) -> Option<u32> {
        let light = self.parts.geometries[i.geometry as usize].light(i.id.prim)?;
        Some(if i.id.instance == WORLD {
            light
        } else {
            light + self.parts.placements[i.id.instance as usize].first_light
        })
    }

    /// Number of emitting shapes that cannot be sampled as lights, such as infinite planes: only paths that meet them
    /// by chance find their light.
    pub fn unsampled_emitters(&self) -> usize {
        self.parts.geometries.iter().filter(|g| g.emitter.is_some() && g.lights.is_empty()).count()
    }

    /// True if camera rays pass a geometry when lights are hidden from the camera: it emits, and hidden emitters do not
    /// block.
    #[inline]
    pub fn is_passed_when_hidden(&self, geometry: u32) -> bool {
        self.parts.geometries[geometry as usize].emitter.is_some() && !self.parts.settings.hidden_emitters_block
    }

    /// True if normal or bump maps change the shading of any material.
    pub fn has_surface_detail(&self) -> bool {
        self.parts.materials.iter().any(|m| m.detail.as_ref().is_some_and(SurfaceDetail::bends_normals))
    }

    /// True if a geometry turns towards every ray, so that a point of it is one of its surface only from one side.
    pub fn faces_rays(&self, geometry: u32) -> bool {
        self.parts.geometries[geometry as usize].shape.faces_rays()
    }

    /// True if anything moves while the shutter is open.
    pub fn moves(&self) -> bool {
        self.parts.camera.motion.is_some() || self.parts.placements.iter().any(|p| p.motion.is_some())
    }

    /// The surface at a hit of a ray whose direction has unit length.
    pub fn interaction(&self, ray: &Ray, hit: &Hit) -> Interaction {
        self.interaction_by(ray, hit, |geometry, ray| geometry.shape.surface(hit, ray))
    }

    /// Surface at a hit, as [`Scene::interaction`], with the parametrisation left zero where nothing that scatters or
    /// emits light asks for it.
    #[inline]
    pub fn interaction_of_light(&self, ray: &Ray, hit: &Hit) -> Interaction {
        self.interaction_by(ray, hit, |geometry, ray| {
            if geometry.needs.parameters { geometry.shape.surface(hit, ray) } else { geometry.shape.bare(hit, ray) }
        })
    }

    /// The surface at a hit, by what it is in the space of its shape.
    #[inline]
    fn interaction_by(
        &self,
        ray: &Ray,
        hit: &Hit,
        surface: impl FnOnce(&Geometry, &Ray) -> SurfacePoint,
    ) -> Interaction {
        let index = self.geometry_index(hit.id);
        let geometry = &self.parts.geometries[index as usize];
        let mut i = Interaction {
            surface: SurfacePoint::bare(Vec3::ZERO, Vec3::ZERO, Vec3::Z),
            wo: -ray.direction,
            t: hit.t,
            time: ray.time,
            geometry: index,
            id: hit.id,
            coordinates: Vec2::new(hit.u, hit.v),
        };
        // Written where it stays.
        if hit.id.instance == WORLD {
            i.surface = surface(geometry, ray);
            return i;
        }
        let place = self.parts.placements[hit.id.instance as usize].at(ray.time);
        let s = surface(geometry, &place.inverse().ray(ray));
        // Normals keep to their side: the inverse transpose does not turn them over against each other.
        i.surface = SurfacePoint {
            p: place.point(s.p),
            error: place.point_error(s.p, s.error),
            n: place.normal(s.n).normalize_or_zero(),
            ns: place.normal(s.ns).normalize_or_zero(),
            dpdu: place.vector(s.dpdu),
            uv: s.uv,
        };
        i
    }

    /// Texture context of a surface point, over the footprint that the camera would have there.
    #[inline]
    pub fn texture_context<'a>(&'a self, i: &Interaction) -> TextureContext<'a> {
        self.texture_context_over(i, self.footprint(i, None))
    }

    /// Texture context of a surface point, over a given footprint.
    #[inline]
    pub fn texture_context_over<'a>(&'a self, i: &Interaction, footprint: Footprint) -> TextureContext<'a> {
        let mesh: Option<(&dyn MeshAttributes, _, _)> = match &self.parts.geometries[i.geometry as usize].shape {
            Shape::Mesh(m) => Some((&**m, i.id.prim, i.coordinates)),
            _ => None,
        };
        TextureContext { n: i.surface.ns, wo: i.wo, footprint, mesh, ..TextureContext::new(i.surface.p, i.surface.uv) }
    }

    /// Scattering at a surface point, and its shading frame: +z on the viewer's side for models that only reflect.
    /// `None` if nothing scatters.
    #[inline]
    pub fn scattering<'a>(
        &'a self,
        i: &Interaction,
        choice: f32,
        lambda: &mut Wavelengths,
    ) -> Option<(Scattering<'a>, Frame)> {
        self.scattering_along(i, None, choice, lambda)
    }

    /// Scattering at a surface as by [`Scene::scattering`], seen by a ray with a differential.
    #[inline]
    pub fn scattering_along<'a>(
        &'a self,
        i: &Interaction,
        differential: Option<&RayDifferential>,
        choice: f32,
        lambda: &mut Wavelengths,
    ) -> Option<(Scattering<'a>, Frame)> {
        let (mut scattering, mut frame) = (Scattering::NONE, Frame::IDENTITY);
        self.write_scattering(i, differential, choice, lambda, (&mut scattering, &mut frame))
            .then_some((scattering, frame))
    }

    /// Writes the result of [`Scene::scattering_along`] in place, since it is large; false if nothing scatters.
    #[inline]
    pub fn write_scattering<'a>(
        &'a self,
        i: &Interaction,
        differential: Option<&RayDifferential>,
        choice: f32,
        lambda: &mut Wavelengths,
        (scattering, frame): (&mut Scattering<'a>, &mut Frame),
    ) -> bool {
        let Geometry { material, needs, .. } = &self.parts.geometries[i.geometry as usize];
        let front = i.surface.ns.dot(i.wo) > 0.0;
        let constant = &self.facts.constants[*material as usize][usize::from(front)];
        if let (Some((bsdf, flipped)), false) = (constant, needs.tangent) {
            *scattering = Scattering { flipped: *flipped, ..Scattering::plain(*bsdf) };
            *frame = Frame::from_z(if *flipped { -i.surface.ns } else { i.surface.ns });
            return true;
        }
        let found = if needs.parameters {
            let mut at = self.texture_context_over(i, self.footprint(i, differential));
            at.time = lambda.time;
            self.scattering_when(i, &at, choice, lambda)
        } else {
            self.scattering_when(i, &TextureContext::NOWHERE, choice, lambda)
        };
        let Some(found) = found else { return false };
        (*scattering, *frame) = found;
        true
    }

    /// Scattering at a surface as by [`Scene::scattering`], with textures looked up where `at` says.
    pub fn scattering_at<'a>(
        &'a self,
        i: &Interaction,
        at: &TextureContext<'a>,
        choice: f32,
        lambda: &mut Wavelengths,
    ) -> Option<(Scattering<'a>, Frame)> {
        self.scattering_when(i, &TextureContext { time: lambda.time, ..*at }, choice, lambda)
    }

    /// Scattering at a surface as by [`Scene::scattering_at`], at the moment that `at` says.
    #[inline]
    fn scattering_when<'a>(
        &'a self,
        i: &Interaction,
        at: &TextureContext<'a>,
        choice: f32,
        lambda: &mut Wavelengths,
    ) -> Option<(Scattering<'a>, Frame)> {
        let geometry = &self.parts.geometries[i.geometry as usize];
        if geometry.is_interface {
            return None;
        }
        let front = i.surface.ns.dot(i.wo) > 0.0;
        let mut s = material::scattering(
            &self.parts.materials,
            &self.parts.textures,
            geometry.material,
            at,
            front,
            choice,
            lambda,
        )?;
        // Curves face each ray: they have no side.
        let transmits = s.detail.is_some() && s.bsdf.has_transmission() && !geometry.shape.faces_rays();
        let mut base = None;
        let (ns, tangent) = match s.detail {
            None => (i.surface.ns, i.surface.dpdu),
            Some(detail) => {
                let base = base.insert(self.base(i));
                let ns = detail.shading_normal(&self.parts.textures, at, base, i.wo, transmits);
                (ns, detail.tangent(&self.parts.textures, at, base))
            }
        };
        let z = if s.flipped { -ns } else { ns };
        let frame = if geometry.needs.tangent { Frame::from_zx(z, tangent) } else { Frame::from_z(z) };
        if let (Some(detail), Some(base)) = (s.detail, &base)
            && let Some(coat) = detail.coat_normal(&self.parts.textures, at, base, i.wo)
        {
            s.bsdf.set_coat_normal(frame.to_local(if s.flipped { -coat } else { coat }));
        }
        s.ground = s.detail.zip(base).and_then(|(detail, base)| detail.ground(&base, &frame, s.flipped, transmits));
        Some((s, frame))
    }

    /// The surface that bump and normal maps change.
    pub fn base(&self, i: &Interaction) -> Base {
        let s = &i.surface;
        let geometry = &self.parts.geometries[i.geometry as usize];
        let place = self.place(i.id, i.time);
        let object = geometry.group_from_object.as_deref().map(|object| place.map_or(*object, |place| place * *object));
        let Shape::Mesh(m) = &geometry.shape else {
            return Base { n: s.n, ns: s.ns, dpdu: s.dpdu, dpdv: self.dpdv(i), tangent: None, object };
        };
        let vector = |v: Vec3| place.map_or(v, |a| a.vector(v));
        let tangent = m.tangent_frame(i.id.prim, i.coordinates).map(|(t, sign)| {
            let turned = place.is_some_and(|a| a.m.determinant() < 0.0);
            // Normals stay on the side that the winding had.
            (vector(t), if turned { -sign } else { sign })
        });
        Base { n: s.n, ns: s.ns, dpdu: s.dpdu, dpdv: vector(m.dpdv(i.id.prim)), tangent, object }
    }

    /// The medium on the side of a surface that a direction points to; `current` where the surface separates none.
    #[inline]
    pub fn medium_towards(&self, i: &Interaction, w: Vec3, current: Option<u32>) -> Option<u32> {
        match self.parts.geometries[i.geometry as usize].media {
            Some((interior, exterior)) => {
                if w.dot(i.surface.n) > 0.0 {
                    exterior
                } else {
                    interior
                }
            }
            None => current,
        }
    }

    /// Box around all bounded geometry.
    pub fn bounds(&self) -> Bounds3 {
        self.parts.accel.bounds()
    }
}

/// True for a material that scatters nothing.
pub fn is_interface(material: &Material) -> bool {
    matches!(material.model, Model::Interface)
}
