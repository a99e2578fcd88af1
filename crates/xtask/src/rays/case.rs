//! Test cases of ray tracing: geometry, and its rays.

use super::scene::{View, bounce, displaced_sphere, instances};
use crate::generate::Mesh;
use std::{
    error::Error,
    path::{Path, PathBuf},
};
use steradian_accel::{Builder, Bvh, Geometry, Instance, TopLevel};
use steradian_formats::mesh::ply;
use steradian_math::{Ray, Vec3, transform::Affine};

/// Pixels of a picture along each side.
const SIZE: i32 = 512;

/// A mesh, or instances of one, and where it is looked at from.
pub struct Case {
    pub name: String,
    pub mesh: Mesh,
    /// Placements of the instances; none for the mesh itself.
    pub places: Vec<Affine>,
    views: Vec<View>,
}

/// The displaced sphere in two sizes, instances of the smaller one, and meshes of files.
pub fn all(files: &[PathBuf]) -> Result<Vec<Case>, Box<dyn Error>> {
    let case = |name: &str, mesh, places, views: &[View]| Case { name: name.into(), mesh, places, views: views.into() };
    let mut cases = vec![
        case("mesh_1M", displaced_sphere(289), Vec::new(), &View::SPHERE),
        case("mesh_10k", displaced_sphere(29), Vec::new(), &View::SPHERE),
        case("inst_1000x10k", displaced_sphere(29), instances(), &View::INSTANCES),
    ];
    for file in files {
        let mesh = read_mesh(file)?;
        let name = file.file_stem().unwrap_or_default().to_string_lossy();
        let view = View::of(&mesh);
        cases.push(case(&name, mesh, Vec::new(), &[view]));
    }
    Ok(cases)
}

/// The triangles of a PLY file.
pub fn read_mesh(file: &Path) -> Result<Mesh, Box<dyn Error>> {
    let read = ply::read(&std::fs::read(file)?, &Default::default()).map_err(|e| format!("{}: {e}", file.display()))?;
    let positions = read.mesh.positions.iter().map(|&p| Vec3::from_array(p)).collect();
    Ok((positions, read.mesh.triangles.to_vec()))
}

impl Case {
    /// True if rays through this may be wanted by words in their names.
    pub fn may_be(&self, words: &[String]) -> bool {
        let sets = ["primary", "bounce1", "shadow"].map(|set| self.views.iter().map(move |view| name(set, view)));
        let queries = ["closest", "occluded"];
        sets.into_iter()
            .flatten()
            .any(|set| queries.iter().any(|query| super::is_wanted(words, &[&self.name, &set, query])))
    }

    /// Our hierarchy.
    pub fn build(&self) -> Result<TopLevel, steradian_accel::Error> {
        self.build_by(Builder::default())
    }

    /// Our hierarchy, by a builder of choice.
    pub fn build_by(&self, builder: Builder) -> Result<TopLevel, steradian_accel::Error> {
        let geometry = [Geometry::triangles(&self.mesh.0, &self.mesh.1)];
        if self.places.is_empty() {
            return TopLevel::build_by(builder, &geometry, Vec::new(), &[]);
        }
        let instance = |&world_from_object| Instance::new(0, world_from_object);
        let instances: Vec<_> = self.places.iter().map(instance).collect();
        TopLevel::build_by(builder, &[], vec![Bvh::build_by(builder, &geometry)?], &instances)
    }

    /// Rays of cameras, their first bounces, and from where they hit to a light; with names.
    pub fn rays(&self, top: &TopLevel) -> Vec<(String, Vec<Ray>)> {
        // The normal stays in object space.
        let nearest = |ray: &Ray| {
            let hit = top.intersect(ray, &())?;
            let [a, b, c] = self.mesh.1[hit.id.prim as usize].map(|i| self.mesh.0[i as usize]);
            Some((hit.t, (b - a).cross(c - a)))
        };
        let of_view = |view: &View| {
            let primary = view.primary(SIZE);
            let spots = view.spots(&primary, nearest);
            let (bounced, shadow) = (bounce(&spots, 11), view.shadow(&spots, 14));
            [("primary", primary), ("bounce1", bounced), ("shadow", shadow)].map(|(set, rays)| (name(set, view), rays))
        };
        self.views.iter().flat_map(of_view).collect()
    }
}

/// The name of some rays of a view.
fn name(set: &str, view: &View) -> String {
    format!("{set}-{}", view.name)
}
