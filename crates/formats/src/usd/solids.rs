//! Solids: UsdGeomSphere, Cube, Cylinder, Cone, Capsule and Plane.

use super::{
    Reader,
    look::Channels,
    nodes::{Drawn, Form, Inherited},
    stage::Prim,
};
use std::{f64::consts::FRAC_PI_2, sync::Arc};
use steradian_math::{DMat4, DVec3};
use steradian_scene::{Family, Mesh, Node};

/// Largest measure of a solid.
const MOST: f64 = 1e30;

pub(super) fn solid(kind: &str) -> Node {
    Node::new(Family::Shape, kind, None)
}

/// A rectangle in the plane z = 0, seen from +z, with coordinates from 0 to 1.
pub(super) fn rectangle(width: f64, height: f64) -> Mesh {
    let (x, y) = ((width * 0.5) as f32, (height * 0.5) as f32);
    Mesh {
        positions: vec![[-x, -y, 0.0], [x, -y, 0.0], [x, y, 0.0], [-x, y, 0.0]],
        uvs: vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]],
        triangles: vec![[0, 1, 2], [0, 2, 3]].into(),
        ..Mesh::default()
    }
}

/// A cube about the origin; each face has coordinates from 0 to 1.
fn cube(size: f64) -> Mesh {
    let mut mesh = Mesh::default();
    let mut triangles = Vec::new();
    for axis in 0..3 {
        for sign in [-1.0, 1.0] {
            let base = mesh.positions.len() as u32;
            for (u, v) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
                let mut p = [0.0; 3];
                (p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]) = (sign, u * sign, v);
                mesh.positions.push(p.map(|v: f64| (v * size * 0.5) as f32));
                mesh.uvs.push([(0.5 + 0.5 * u) as f32, (0.5 + 0.5 * v) as f32]);
            }
            triangles.extend([[base, base + 1, base + 2], [base, base + 2, base + 3]]);
        }
    }
    mesh.triangles = triangles.into();
    mesh
}

impl Reader<'_> {
    pub(super) fn solid(&mut self, prim: &Prim, kind: &str, state: &Inherited) {
        let measure = |reader: &mut Self, name: &str, default: f64| reader.number(prim, name, default, (0.0, MOST));
        let along = match self.word(prim, "axis").as_deref() {
            // z becomes the axis.
            Some("X") => DMat4::from_rotation_y(FRAC_PI_2),
            Some("Y") => DMat4::from_rotation_x(-FRAC_PI_2),
            _ => DMat4::IDENTITY,
        };
        let up = |z: f64| along * DMat4::from_translation(DVec3::new(0.0, 0.0, z));
        let over = DMat4::from_rotation_x(std::f64::consts::PI);
        let disk = |radius: f64| Form::Solid(solid("disk").with("radius", radius));
        let sphere = |radius: f64| Form::Solid(solid("sphere").with("radius", radius));
        let tube = |radius: f64, half: f64| {
            Form::Solid(solid("cylinder").with("radius", radius).with("z_min", -half).with("z_max", half))
        };
        let forms = match kind {
            "Sphere" => vec![(sphere(measure(self, "radius", 1.0)), DMat4::IDENTITY)],
            "Cube" => {
                let mesh = cube(measure(self, "size", 2.0));
                vec![(self.form(mesh), DMat4::IDENTITY)]
            }
            "Plane" => {
                // Width is along x, or along z where x is the axis; length is along the other one.
                let (width, length) = (measure(self, "width", 2.0), measure(self, "length", 2.0));
                let mesh = match self.word(prim, "axis").as_deref() {
                    Some("X") => rectangle(width, length),
                    _ => rectangle(width, length),
                };
                vec![(self.form(mesh), along)]
            }
            "Cone" => {
                let (radius, height) = (measure(self, "radius", 1.0), measure(self, "height", 2.0));
                let side = Form::Solid(solid("cone").with("radius", radius).with("height", height));
                vec![(side, up(-0.5 * height)), (disk(radius), up(-0.5 * height) * over)]
            }
            "Capsule" => {
                let (radius, half) = (measure(self, "radius", 0.5), 0.5 * measure(self, "height", 1.0));
                vec![(tube(radius, half), along), (sphere(radius), up(half)), (sphere(radius), up(-half))]
            }
            _ => {
                let (radius, half) = (measure(self, "radius", 1.0), 0.5 * measure(self, "height", 2.0));
                vec![(tube(radius, half), along), (disk(radius), up(half)), (disk(radius), up(-half) * over)]
            }
        };
        let look = self.look(prim, state.material.as_deref(), Channels::default());
        for (form, place) in forms {
            let is_zero = |node: &Node, name: &str| node.float(name) == Some(0.0);
            let empty = matches!(&form, Form::Solid(node) if is_zero(node, "radius") || is_zero(node, "height"));
            if !empty {
                let name = prim.name().to_owned();
                let (place, material, emission) = (state.place * place, look.material, look.emission);
                self.draw(Drawn { name, form, place, material, emission });
            }
        }
    }

    pub(super) fn form(&mut self, mesh: Mesh) -> Form {
        Form::Mesh { mesh: self.stage.import.desc.add_mesh(Arc::new(mesh)), tangents: false }
    }
}
