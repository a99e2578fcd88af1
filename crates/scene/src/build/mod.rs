//! Scenes made in code, by types: what would be a misspelt name in a file is a compile error here.
//!
//! ```
//! use steradian_scene::build::{Camera, Material, Plane, PointLight, Scene, Sphere, metal};
//!
//! let desc = Scene::builder()
//!     .camera(Camera::look_at([0.0, 2.0, -8.0], [0.0, 1.0, 0.0]).fov(35.0))
//!     .add(Sphere::new([0.0, 1.0, 0.0], 1.0), Material::conductor(metal::GOLD).roughness(0.15))
//!     .add(Plane::facing([0.0, 1.0, 0.0]), Material::diffuse([0.5, 0.5, 0.5]))
//!     .light(PointLight::at([3.0, 5.0, -4.0], [60.0, 55.0, 45.0]))
//!     .build();
//! assert_eq!((desc.shapes.len(), desc.lights.len()), (2, 1));
//! ```
//!
//! A typo does not compile:
//!
//! ```compile_fail
//! use steradian_scene::build::{Material, metal};
//! let gold = Material::conductor(metal::GOLD).roughnes(0.15);
//! ```
//!
//! Angles are in degrees, lengths in scene units, colours linear Rec.709. What the builder makes is a
//! [`SceneDesc`], as readers of files do; what has no type here can be put into it by name.

mod camera;
mod color;
mod light;
mod material;
mod node;
mod shape;

pub use camera::Camera;
pub use color::{Checkerboard, Color, Glass, Image, Metal, Texture, glass, metal};
pub use light::{AreaLight, DistantLight, Light, PointLight, Sky, SpotLight};
pub use material::{Coated, Conductor, Dielectric, Material, Pbr};
pub use shape::{Cylinder, Disk, Geometry, Plane, Sphere, TriangleMesh};

use crate::{Family, NodeId, SceneDesc, Shape, node::Node};
use node::{Arena, Draft};

/// Entry point of the scene builders.
#[derive(Clone, Copy, Debug)]
pub struct Scene;

impl Scene {
    /// An empty scene under construction.
    pub fn builder() -> SceneBuilder {
        SceneBuilder::default()
    }
}

/// A scene under construction. Materials that are alike are one.
#[derive(Debug, Default)]
pub struct SceneBuilder {
    arena: Arena,
}

impl SceneBuilder {
    /// Adds a surface of a material.
    #[must_use]
    pub fn add(self, shape: impl Into<Geometry>, material: impl Into<Material>) -> Self {
        let material: Material = material.into();
        self.surface(shape.into(), &material, None)
    }

    /// Adds a surface that emits light; it reflects none.
    #[must_use]
    pub fn lamp(self, shape: impl Into<Geometry>, light: AreaLight) -> Self {
        self.surface(shape.into(), &Material::diffuse(0.0), Some(&light.draft))
    }

    fn surface(mut self, shape: Geometry, material: &Material, emission: Option<&Draft>) -> Self {
        let material = self.arena.add(&material.draft);
        let emission = emission.map(|e| self.arena.add(e));
        let Geometry { draft, mesh, placement, reversed } = shape;
        let node = self.arena.add(&draft);
        let mesh = mesh.map(|m| self.arena.desc.add_mesh(m));
        self.arena.desc.shapes.push(Shape {
            mesh,
            world_from_object: placement,
            reverse_orientation: reversed,
            material: Some(material),
            emission,
            ..Shape::new(node)
        });
        self
    }

    /// Adds a light that is no surface.
    #[must_use]
    pub fn light(mut self, light: impl Into<Light>) -> Self {
        let light: Light = light.into();
        let id = self.arena.add(&light.draft);
        self.arena.desc.lights.push(id);
        self
    }

    /// Adds a camera; the first is the one that renders.
    #[must_use]
    pub fn camera(mut self, camera: Camera) -> Self {
        let id = self.arena.add(&camera.draft);
        self.arena.desc.cameras.push(id);
        self
    }

    fn single(&mut self, slot: fn(&mut SceneDesc) -> &mut Option<NodeId>, family: Family, kind: &str) -> &mut Node {
        let id = match *slot(&mut self.arena.desc) {
            Some(id) => id,
            None => self.arena.desc.add(Node::new(family, kind, None)),
        };
        *slot(&mut self.arena.desc) = Some(id);
        self.arena.desc.node_mut(id)
    }

    /// The size of the picture in pixels.
    #[must_use]
    pub fn size(mut self, width: u32, height: u32) -> Self {
        let film = self.single(|d| &mut d.film, Family::Film, "rgb");
        film.set("width", i64::from(width), None).set("height", i64::from(height), None);
        self
    }

    /// Samples per pixel.
    #[must_use]
    pub fn samples(mut self, count: u32) -> Self {
        self.single(|d| &mut d.sampler, Family::Sampler, "zsobol").set("samples", i64::from(count), None);
        self
    }

    /// Scattering events on a path at most; 0 shows emitters alone.
    #[must_use]
    pub fn max_depth(mut self, events: u32) -> Self {
        self.single(|d| &mut d.integrator, Family::Integrator, "path").set("max_depth", i64::from(events), None);
        self
    }

    /// The description, ready to be compiled.
    pub fn build(self) -> SceneDesc {
        self.arena.desc
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_materials_are_one_node() {
        let gold = || Material::conductor(metal::GOLD).roughness(0.2);
        let desc = Scene::builder()
            .add(Sphere::new([0.0; 3], 1.0), gold())
            .add(Sphere::new([2.0, 0.0, 0.0], 1.0), gold())
            .add(Sphere::new([4.0, 0.0, 0.0], 1.0), gold().named("other"))
            .size(64, 32)
            .samples(4)
            .max_depth(3)
            .build();
        assert_eq!(desc.shapes[0].material, desc.shapes[1].material);
        assert_ne!(desc.shapes[0].material, desc.shapes[2].material);
        let film = desc.node(desc.film.expect("a film"));
        assert_eq!((film.int("width"), film.int("height")), (Some(64), Some(32)));
    }

    #[test]
    fn parts_come_before_what_refers_to_them() {
        let board = Checkerboard::new([0.8; 3], Image::new("a.png")).repeat(4.0, 2.0);
        let material = Material::diffuse(board).masked(0.5);
        let desc = Scene::builder().add(Disk::new(2.0), material).build();
        let mask = desc.shapes[0].material.expect("a material");
        let inner = desc.node(mask).node("material").expect("an inner one");
        let texture = desc.node(inner).node("reflectance").expect("a texture");
        assert!(texture.0 < inner.0 && inner.0 < mask.0);
        assert_eq!(desc.node(desc.node(texture).node("b").expect("an image")).kind, "image");
    }
}
