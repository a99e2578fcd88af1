//! Shapes so far from the origin, for their size, that single precision loses detail of them: they are told.

use super::Compiler;
use steradian_math::{Bounds3, DVec3, Transform};
use steradian_scene::{SceneDesc, Shape};

/// The largest step of coordinates, as a part of the size of a mesh, that goes without a word.
const COARSE: f64 = 2e-4;

/// Meshes of fewer triangles, such as lamps of two, have no detail to lose.
const LEAST_TRIANGLES: usize = 12;

/// A box in double precision.
#[derive(Clone, Copy)]
pub(super) struct Extent {
    pub min: DVec3,
    pub max: DVec3,
}

impl Extent {
    fn of(points: impl Iterator<Item = DVec3>) -> Self {
        let empty = Self { min: DVec3::INFINITY, max: DVec3::NEG_INFINITY };
        points.fold(empty, |all, p| Self { min: all.min.min(p), max: all.max.max(p) })
    }

    /// The largest coordinate as seen from a point.
    fn far(&self, origin: DVec3) -> f64 {
        (self.min - origin).abs().max((self.max - origin).abs()).max_element()
    }

    /// True if details of a mesh are lost where a point is the origin.
    pub fn is_coarse(&self, origin: DVec3) -> bool {
        let far = self.far(origin);
        far.is_finite() && step(far) > COARSE * (self.max - self.min).max_element()
    }
}

/// The distance between numbers of single precision.
fn step(far: f64) -> f64 {
    far * f64::from(f32::EPSILON)
}

/// Calls for each mesh with detail, each time it is placed: the boxes around its stored coordinates, and around it in
/// the world.
pub(super) fn each_placed(desc: &SceneDesc, mut call: impl FnMut(&Extent, &Extent)) {
    let stored: Vec<Option<Bounds3>> = desc
        .meshes
        .iter()
        .map(|mesh| (mesh.triangles.len() >= LEAST_TRIANGLES).then(|| &mesh.positions))
        .map(|positions| positions.map(|all| Bounds3::from_points(all.iter().copied().map(Into::into))))
        .collect();
    let mut place = |shapes: &[Shape], from: &dyn Fn(&Shape) -> Transform| {
        for shape in shapes {
            let Some(Some(bounds)) = shape.mesh.and_then(|mesh| stored.get(mesh)) else { continue };
            let (corners, place) = ((0..8).map(|k| bounds.corner(k).as_dvec3()), from(shape));
            call(&Extent::of(corners.clone()), &Extent::of(corners.map(|p| place.point(p))));
        }
    };
    place(&desc.shapes, &|shape| shape.world_from_object);
    for instance in &desc.instances {
        let Some(group) = desc.groups.get(instance.group) else { continue };
        place(&group.shapes, &|shape| instance.world_from_group * shape.world_from_object);
    }
}

impl Compiler<'_> {
    /// Warns of meshes whose vertices, or whose placements, are far away for their size.
    pub(super) fn tell_coarse(&mut self) {
        let (mut count, mut worst) = (0_usize, 0.0_f64);
        each_placed(self.desc, |stored, placed| {
            let coarse = [stored, placed].into_iter().filter(|extent| extent.is_coarse(DVec3::ZERO));
            if let Some(far) = coarse.map(|extent| extent.far(DVec3::ZERO)).reduce(f64::max) {
                (count, worst) = (count + 1, worst.max(far));
            }
        });
        if count > 0 {
            let meshes = if count == 1 { "a mesh".to_owned() } else { format!("{count} meshes") };
            let message = format!(
                "coordinates of {meshes} are as large as {worst:.0}, where single precision has steps of {:.1e}: \
                 smaller details are lost; move the scene to the origin",
                step(worst)
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

    /// A fan of 12 triangles, this large and so far away by its vertices and by its place.
    fn said(size: f32, stored: f32, far: f64) -> String {
        let mut desc = SceneDesc::default();
        let place = |k: u32| [stored + size * (k as f32).cos(), size * (k as f32).sin(), 0.0];
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
        for (size, stored, far, is_coarse) in [
            (5.0, 0.0, 0.0, false),
            (5.0, 4e3, 0.0, false),
            (5.0, 5e6, 0.0, true),
            (5e3, 5e6, 0.0, false),
            (0.01, 500.0, 0.0, true),
            // The scene is compiled around it.
            (5.0, 0.0, 5e6, false),
            (5.0, 5e6, -5e6, true),
        ] {
            let said = said(size, stored, far);
            assert_eq!(said.contains("smaller details are lost"), is_coarse, "{size} at {stored} and {far}: {said}");
        }
    }
}
