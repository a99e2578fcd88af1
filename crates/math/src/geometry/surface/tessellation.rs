//! Triangle meshes of parametric surfaces.

use super::Parametric;
use crate::geometry::Point3;
use glam::{DVec2, DVec3};

/// A triangle mesh of a surface. Triangles are counter-clockwise seen from outside.
#[derive(Clone, Debug, Default)]
pub struct SurfaceMesh {
    /// Points of the surface.
    pub positions: Vec<Point3>,
    /// Unit outward normal at each position.
    pub normals: Vec<DVec3>,
    /// Parameters of each position, scaled to `[0, 1]²`.
    pub parameters: Vec<DVec2>,
    /// Positions of each triangle.
    pub triangles: Vec<[u32; 3]>,
}

impl SurfaceMesh {
    /// Sum of the areas of the triangles.
    pub fn area(&self) -> f64 {
        self.corners().map(|[a, b, c]| 0.5 * (b - a).cross(c - a).length()).sum()
    }

    /// Enclosed volume, by the divergence theorem; meaningful for closed surfaces.
    pub fn volume(&self) -> f64 {
        let Some(&o) = self.positions.first() else { return 0.0 };
        self.corners().map(|[a, b, c]| (a - o).cross(b - o).dot(c - o) / 6.0).sum()
    }

    fn corners(&self) -> impl Iterator<Item = [Point3; 3]> + '_ {
        self.triangles.iter().map(|t| t.map(|i| self.positions[i as usize]))
    }
}

/// A mesh of `nu × nv` cells of the domain, two triangles each; cells that a pole shrinks to a triangle get one. Seams
/// keep a vertex for each of their two parameters.
///
/// `None` for zero cells and for more than `u32` can number.
pub fn tessellate(surface: &impl Parametric, nu: usize, nv: usize) -> Option<SurfaceMesh> {
    let count = nu.checked_add(1)?.checked_mul(nv.checked_add(1)?)?;
    if nu == 0 || nv == 0 || u32::try_from(count).is_err() {
        return None;
    }
    let [[u0, u1], [v0, v1]] = surface.domain();
    let mut mesh = SurfaceMesh::default();
    for j in 0..=nv {
        for i in 0..=nu {
            let s = DVec2::new(i as f64 / nu as f64, j as f64 / nv as f64);
            let (u, v) = (u0 + (u1 - u0) * s.x, v0 + (v1 - v0) * s.y);
            // The end of a closed parameter is its beginning, to the last bit.
            let u = if i == nu && surface.is_closed_in_u() { u0 } else { u };
            mesh.positions.push(surface.point(u, v));
            mesh.normals.push(surface.normal_at(u, v));
            mesh.parameters.push(s);
        }
    }
    let index = |i: usize, j: usize| (j * (nu + 1) + i) as u32;
    for j in 0..nv {
        for i in 0..nu {
            let corners = [index(i, j), index(i + 1, j), index(i + 1, j + 1), index(i, j + 1)];
            for t in [[0, 1, 2], [0, 2, 3]].map(|t| t.map(|k| corners[k])) {
                mesh.push_outward(t);
            }
        }
    }
    Some(mesh)
}

impl SurfaceMesh {
    /// Adds a triangle, turned so that it looks to the side of its normals; leaves out one without area.
    fn push_outward(&mut self, [a, b, c]: [u32; 3]) {
        let [p, q, r] = [a, b, c].map(|i| self.positions[i as usize]);
        let n = (q - p).cross(r - p);
        let edges = (q - p).length_squared().max((r - p).length_squared()).max((r - q).length_squared());
        if n.length() <= 1e-12 * edges {
            return;
        }
        let outward: DVec3 = [a, b, c].iter().map(|&i| self.normals[i as usize]).sum();
        self.triangles.push(if n.dot(outward) >= 0.0 { [a, b, c] } else { [a, c, b] });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::surface::Ellipsoid;
    use std::collections::HashMap;

    #[test]
    fn a_sphere_mesh_is_closed() {
        let sphere = Ellipsoid::sphere(Point3::ORIGIN, 1.0).expect("a sphere");
        let (nu, nv) = (12, 8);
        let mesh = tessellate(&sphere, nu, nv).expect("a mesh");
        assert_eq!(mesh.triangles.len(), 2 * nu * (nv - 1), "one triangle per cell at the poles");
        assert_eq!((mesh.positions.len(), mesh.normals.len(), mesh.parameters.len()), (117, 117, 117));
        // By position, every edge is used once in each direction.
        let key = |i: u32| {
            let p = mesh.positions[i as usize];
            [p.x, p.y, p.z].map(|x| (x * 1e9).round() as i64)
        };
        let mut edges: HashMap<_, i32> = HashMap::new();
        for t in &mesh.triangles {
            for k in 0..3 {
                let (a, b) = (key(t[k]), key(t[(k + 1) % 3]));
                *edges.entry((a.min(b), a.max(b))).or_default() += if a < b { 1 } else { -1 };
            }
        }
        assert!(edges.values().all(|&n| n == 0));
        assert_eq!(edges.len() * 2, mesh.triangles.len() * 3);
    }

    #[test]
    fn senseless_sizes_are_refused() {
        let sphere = Ellipsoid::sphere(Point3::ORIGIN, 1.0).expect("a sphere");
        assert!(tessellate(&sphere, 0, 5).is_none());
        assert!(tessellate(&sphere, usize::MAX, 5).is_none());
        assert!(tessellate(&sphere, 1 << 20, 1 << 20).is_none());
    }
}
