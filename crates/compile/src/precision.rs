//! Shapes so far from the origin, for their size, that single precision loses detail of them: they are told.

use super::Compiler;
use steradian_core::scene::{Geometry, Placement, Shape};
use steradian_math::{Bounds3, Vec3};

/// The largest step of coordinates, as a part of the size of a mesh, that goes without a word.
const COARSE: f32 = 2e-4;

/// Meshes of fewer triangles, such as lamps of two, have no detail to lose.
const LEAST_TRIANGLES: usize = 12;

impl Compiler<'_> {
    /// Warns of meshes whose vertices, or whose placements, are far away for their size.
    pub(super) fn tell_coarse(&mut self, world: usize, placements: &[Placement]) {
        let bounds_of = |geometry: &Geometry| match &geometry.shape {
            Shape::Mesh(mesh) if mesh.triangles.len() >= LEAST_TRIANGLES => Some(geometry.shape.bounds()),
            _ => None,
        };
        let own = self.geometries[..world].iter().filter_map(bounds_of);
        let placed = placements.iter().flat_map(|placement| {
            let group = &self.geometries[placement.base as usize..(placement.base + placement.count) as usize];
            let m = placement.world_from_group;
            let corners = move |b: Bounds3| Bounds3::from_points((0..8).map(|k| m.point(b.corner(k))));
            group.iter().filter_map(bounds_of).map(corners)
        });
        let (mut count, mut worst) = (0_usize, (0.0_f32, 0.0_f32));
        for bounds in own.chain(placed) {
            let far = bounds.min.abs().max(bounds.max.abs());
            let step = (far.max_element() * f32::EPSILON).min(f32::MAX);
            if far != Vec3::INFINITY && step > COARSE * bounds.diagonal().max_element() {
                count += 1;
                worst = if step > worst.1 { (far.max_element(), step) } else { worst };
            }
        }
        if count > 0 {
            let meshes = if count == 1 { "a mesh".to_owned() } else { format!("{count} meshes") };
            let (far, step) = worst;
            let message = format!(
                "coordinates of {meshes} are as large as {far:.0}, where single precision has steps of {step:.1e}: \
                 smaller details are lost; move the scene to the origin"
            );
            self.diagnostics.warn(&self.desc.sources, None, message);
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::{Options, compile};
    use steradian_math::Transform;
    use steradian_scene::{Family, Mesh, Node, SceneDesc, Shape};

    /// A fan of 12 triangles, this large and this far away.
    fn said(size: f32, far: f64) -> String {
        let mut desc = SceneDesc::default();
        let place = |k: u32| [size * (k as f32).cos(), size * (k as f32).sin(), 0.0];
        let triangles = (0..12).map(|k| [0, k + 1, k + 2]).collect::<Vec<_>>();
        let mesh = Mesh { positions: (0..14).map(place).collect(), triangles: triangles.into(), ..Mesh::default() };
        let mesh = desc.add_mesh(mesh);
        let node = desc.add(Node::new(Family::Shape, "mesh", None));
        let world_from_object = Transform::translate([far, 0.0, 0.0].into());
        desc.shapes.push(Shape { mesh: Some(mesh), world_from_object, ..Shape::new(node) });
        let (camera, light) = (Node::new(Family::Camera, "perspective", None), Node::new(Family::Light, "point", None));
        let (camera, light) = (desc.add(camera), desc.add(light));
        desc.cameras.push(camera);
        desc.lights.push(light);
        compile(&desc, &Options::default()).diagnostics.iter().map(|d| d.message.clone()).collect::<Vec<_>>().join("; ")
    }

    #[test]
    fn distant_details_are_told() {
        for (size, far, is_coarse) in
            [(5.0, 0.0, false), (5.0, 4e3, false), (5.0, 5e6, true), (5e3, 5e6, false), (0.01, 500.0, true)]
        {
            let said = said(size, far);
            assert_eq!(said.contains("smaller details are lost"), is_coarse, "{size} at {far}: {said}");
        }
    }
}
