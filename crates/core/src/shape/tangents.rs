//! Tangents at the corners of triangles, for normal maps that were baked with them.
//!
//! The rules are those of Mikkelsen, "Simulation of Wrinkled Surfaces Revisited", MSc thesis, Copenhagen 2008, as in
//! his MikkTSpace: corners share a tangent where they have the same position, normal and coordinates, their triangles
//! hang together by edges, and are mapped the same way round; it is the mean of the triangles' ∂p/∂u, projected across
//! the normal and of unit length, weighted by the angles at the corner. The order of triangles and vertices does not
//! matter. Triangles whose coordinates have no area take no part.

use super::TriMesh;
use std::collections::HashMap;
use steradian_math::{Vec2, Vec3, Vec4, transform::Affine};
use steradian_texture::{Domain, MeshAttributes};

/// For each triangle the tangents of its corners: unit x, y, z, and in w the sign of the bitangent `w · n × t`.
pub fn mikktspace(mesh: &TriMesh) -> Vec<[Vec4; 3]> {
    let count = mesh.triangles.len();
    let faces: Vec<Face> = (0..count as u32).map(|t| Face::new(mesh, t)).collect();
    // Corners with the same position, normal and coordinates are one vertex.
    let mut vertices = HashMap::new();
    let mut welded = |face: &Face, k: usize| {
        let (p, n, uv) = (face.positions[k], face.normals[k], face.uvs[k]);
        // Both zeros are one number.
        let key = [p.x, p.y, p.z, n.x, n.y, n.z, uv.x, uv.y].map(|v| (v + 0.0).to_bits());
        let next = vertices.len() as u32;
        *vertices.entry(key).or_insert(next)
    };
    let ids: Vec<[u32; 3]> = faces.iter().map(|f| [welded(f, 0), welded(f, 1), welded(f, 2)]).collect();
    // Corners are joined over edges that two triangles run along in opposite directions.
    let mut groups = Groups::new(3 * count);
    let mut edges: HashMap<(u32, u32, bool), (usize, usize)> = HashMap::new();
    for (t, face) in faces.iter().enumerate() {
        let Some(mirrored) = face.mirrored() else { continue };
        for k in 0..3 {
            let (a, b) = (k, (k + 1) % 3);
            edges.entry((ids[t][a], ids[t][b], mirrored)).or_insert((3 * t + a, 3 * t + b));
        }
    }
    for (&(a, b, mirrored), &(at_a, at_b)) in &edges {
        if let Some(&(other_b, other_a)) = edges.get(&(b, a, mirrored)) {
            groups.join(at_a, other_a);
            groups.join(at_b, other_b);
        }
    }
    let mut sums = vec![Vec3::ZERO; 3 * count];
    for (t, face) in faces.iter().enumerate() {
        if face.mirrored().is_some() {
            for k in 0..3 {
                sums[groups.root(3 * t + k)] += face.weighted(k);
            }
        }
    }
    let corner = |groups: &mut Groups, t: usize, k: usize| {
        let face = &faces[t];
        let n = face.normals[k];
        let tangent = sums[groups.root(3 * t + k)].normalize_or_zero();
        let tangent = if tangent == Vec3::ZERO { n.any_orthonormal_vector() } else { tangent };
        tangent.extend(if face.mirrored() == Some(true) { -1.0 } else { 1.0 })
    };
    (0..count).map(|t| std::array::from_fn(|k| corner(&mut groups, t, k))).collect()
}

/// [`mikktspace`] of `(u, −v)`: for coordinates whose v grows downwards in pictures whose green points up, as glTF has
/// them.
pub fn mikktspace_down(mesh: &TriMesh) -> Vec<[Vec4; 3]> {
    let mut tangents = mikktspace(mesh);
    tangents.as_flattened_mut().iter_mut().for_each(|t| t.w = -t.w);
    tangents
}

/// Tangents from a vertex attribute of three or four numbers in the space of the file, where the mesh has it. `turned`:
/// whether the mesh was mirrored or turned inside out when it was placed, but not both.
pub fn from_attribute(mesh: &TriMesh, name: &str, place: &Affine, turned: bool) -> Option<Vec<[Vec4; 3]>> {
    let domain = Some(Domain::Vertex);
    let at = |t: u32, u: f32, v: f32| {
        let (a, channels) = mesh.attribute(name, domain, t, Vec2::new(u, v))?;
        let sign = if (channels >= 4 && a[3] < 0.0) ^ turned { -1.0 } else { 1.0 };
        (channels >= 3).then(|| place.vector(Vec3::new(a[0], a[1], a[2])).normalize_or_zero().extend(sign))
    };
    (0..mesh.triangles.len() as u32).map(|t| Some([at(t, 0.0, 0.0)?, at(t, 1.0, 0.0)?, at(t, 0.0, 1.0)?])).collect()
}

/// A triangle with all that its corners have.
struct Face {
    positions: [Vec3; 3],
    normals: [Vec3; 3],
    uvs: [Vec2; 3],
    /// Twice the area of the coordinates, signed.
    area: f32,
}

impl Face {
    fn new(mesh: &TriMesh, triangle: u32) -> Self {
        let positions = mesh.corners(triangle);
        let uvs = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)].map(|(u, v)| mesh.uv(triangle, u, v));
        let normals = if mesh.normals.is_empty() {
            [mesh.geometric_normal(triangle); 3]
        } else {
            mesh.triangles[triangle as usize].map(|i| mesh.normals[i as usize])
        };
        Self { positions, normals, uvs, area: (uvs[1] - uvs[0]).perp_dot(uvs[2] - uvs[0]) }
    }

    /// True if the texture is mirrored, seen against the normals; `None` if the coordinates have no area, or are no
    /// numbers.
    fn mirrored(&self) -> Option<bool> {
        let [p0, p1, p2] = self.positions;
        let back = (p1 - p0).cross(p2 - p0).dot(self.normals.iter().sum()) < 0.0;
        (self.area != 0.0 && self.area.is_finite()).then_some((self.area < 0.0) ^ back)
    }

    /// ∂p/∂u across the normal at a corner, as long as the angle there.
    fn weighted(&self, k: usize) -> Vec3 {
        let [p0, p1, p2] = self.positions;
        let [t0, t1, t2] = self.uvs;
        let n = self.normals[k];
        let across = |v: Vec3| (v - n * v.dot(n)).normalize_or_zero();
        let du = ((p1 - p0) * (t2.y - t0.y) - (p2 - p0) * (t1.y - t0.y)) * self.area.signum();
        let (a, b) = (self.positions[(k + 1) % 3] - self.positions[k], self.positions[(k + 2) % 3] - self.positions[k]);
        let angle = across(a).dot(across(b)).clamp(-1.0, 1.0).acos();
        let v = across(du) * angle;
        if v.is_finite() { v } else { Vec3::ZERO }
    }
}

/// Corners that are one, by union and find.
struct Groups(Vec<usize>);

impl Groups {
    fn new(n: usize) -> Self {
        Self((0..n).collect())
    }

    fn root(&mut self, mut i: usize) -> usize {
        while self.0[i] != i {
            self.0[i] = self.0[self.0[i]];
            i = self.0[i];
        }
        i
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        // The smaller stands for both, whatever the order of joining.
        self.0[a.max(b)] = a.min(b);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mesh(positions: &[[f32; 3]], normals: &[[f32; 3]], uvs: &[[f32; 2]], triangles: &[[u32; 3]]) -> TriMesh {
        TriMesh {
            positions: positions.iter().map(|&p| p.into()).collect(),
            normals: normals.iter().map(|&n| Vec3::from(n).normalize()).collect(),
            uvs: uvs.iter().map(|&t| t.into()).collect(),
            triangles: triangles.to_vec().into(),
            ..TriMesh::default()
        }
    }

    fn close(a: Vec4, b: Vec4) {
        assert!((a - b).length() < 1e-6, "{a} {b}");
    }

    #[test]
    fn flat_squares_have_the_axes_of_their_coordinates() {
        let positions = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [1., 1., 0.]];
        let triangles = [[0, 1, 3], [0, 3, 2]];
        let cases = [
            ([[0., 0.], [1., 0.], [0., 1.], [1., 1.]], Vec4::new(1., 0., 0., 1.)),
            ([[0., 1.], [0., 0.], [1., 1.], [1., 0.]], Vec4::new(0., 1., 0., 1.)),
            ([[0., 1.], [1., 1.], [0., 0.], [1., 0.]], Vec4::new(1., 0., 0., -1.)),
            ([[1., 0.], [0., 0.], [1., 1.], [0., 1.]], Vec4::new(-1., 0., 0., -1.)),
        ];
        for (uvs, wanted) in cases {
            let m = mesh(&positions, &[[0., 0., 1.]; 4], &uvs, &triangles);
            mikktspace(&m).iter().flatten().for_each(|t| close(*t, wanted));
            // Where v goes down, the bitangent w (n × t) points up all the same.
            let turned = wanted.truncate().extend(-wanted.w);
            mikktspace_down(&m).iter().flatten().for_each(|t| close(*t, turned));
        }
        // Coordinates without area: some tangent across the normal.
        let m = mesh(&positions, &[[0., 0., 1.]; 4], &[[0.5, 0.5]; 4], &triangles);
        mikktspace(&m).iter().flatten().for_each(|t| assert!(t.z == 0.0 && (t.truncate().length() - 1.0).abs() < 1e-6));
    }

    /// A roof with a common normal along its ridge: the tangents of both sides are averaged there by angle, and nowhere
    /// else.
    #[test]
    fn smooth_edges_share_tangents_and_mirrored_ones_do_not() {
        let positions = [[-1., 0., 0.], [0., 0., 1.], [-1., 1., 0.], [0., 1., 1.], [1., 0., 0.], [1., 1., 0.]];
        let (l, r, up) = ([-1., 0., 1.], [1., 0., 1.], [0., 0., 1.]);
        let normals = [l, up, l, up, r, r];
        let uvs = [[0., 0.], [1., 0.], [0., 1.], [1., 1.], [2., 0.], [2., 1.]];
        let triangles = [[0, 1, 3], [0, 3, 2], [1, 4, 5], [1, 5, 3]];
        let m = mesh(&positions, &normals, &uvs, &triangles);
        let t = mikktspace(&m);
        close(t[0][1], Vec4::new(1., 0., 0., 1.));
        close(t[3][2], t[0][2]);
        let s = 0.5_f32.sqrt();
        close(t[0][0], Vec4::new(s, 0., s, 1.));
        close(t[2][1], Vec4::new(s, 0., -s, 1.));
        // The right side mirrored: u runs back down, and the ridge has two tangents.
        let uvs = [[0., 0.], [1., 0.], [0., 1.], [1., 1.], [0., 0.], [0., 1.]];
        let t = mikktspace(&mesh(&positions, &normals, &uvs, &triangles));
        close(t[0][1], Vec4::new(1., 0., 0., 1.));
        close(t[2][0], Vec4::new(-1., 0., 0., -1.));
    }

    /// Placed mirrored or inside out, the bitangent still runs along ∂p/∂v.
    #[test]
    fn bitangents_run_along_v_whatever_the_winding() {
        let (positions, uvs) = ([[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]], [[0., 0.], [1., 0.], [0., 1.]]);
        for (triangle, z) in [([0, 1, 2], 1.0), ([0, 2, 1], 1.0), ([0, 1, 2], -1.0), ([0, 2, 1], -1.0)] {
            for t in mikktspace(&mesh(&positions, &[[0., 0., z]; 3], &uvs, &[triangle]))[0] {
                close((Vec3::new(0.0, 0.0, z).cross(t.truncate()) * t.w).extend(0.0), Vec4::Y);
            }
        }
    }

    /// Corners with unlike angles weigh by them: three triangles around a vertex, bent out of the plane.
    #[test]
    fn angles_are_the_weights_and_order_does_not_matter() {
        let positions = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [-1., 0., 0.4]];
        let normals = [[0., 0., 1.]; 4];
        let uvs = [[0., 0.], [1., 0.], [0., 1.], [-1., 0.3]];
        let triangles = [[0, 1, 2], [0, 2, 3]];
        let a = mikktspace(&mesh(&positions, &normals, &uvs, &triangles));
        // Both angles are right ones in the plane of the normal; ∂p/∂u of the second triangle is (1, 0.3, −0.4).
        let du = Vec3::new(1.0, 0.3, 0.0).normalize();
        let wanted = (Vec3::X + du).normalize();
        close(a[0][0], wanted.extend(1.0));
        close(a[1][0], wanted.extend(1.0));
        let b = mikktspace(&mesh(&positions, &normals, &uvs, &[[2, 3, 0], [1, 2, 0]]));
        close(b[0][2], a[0][0]);
        close(b[1][2], a[0][0]);
    }

    #[test]
    fn attributes_give_tangents_per_vertex() {
        let mut m = mesh(&[[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]], &[], &[], &[[0, 1, 2]]);
        let by_name = |m: &TriMesh, turned| from_attribute(m, "tangent", &Affine::IDENTITY, turned);
        assert!(by_name(&m, false).is_none());
        m.attributes.push(crate::shape::mesh::MeshAttribute {
            name: "tangent".into(),
            domain: Domain::Vertex,
            channels: 4,
            data: vec![2., 0., 0., 1., 0., 1., 0., -1., 0., 0., 3., 1.],
            spectra: Vec::new(),
        });
        let t = by_name(&m, false).unwrap();
        assert_eq!(t, [[Vec4::new(1., 0., 0., 1.), Vec4::new(0., 1., 0., -1.), Vec4::new(0., 0., 1., 1.)]]);
        assert_eq!(by_name(&m, true).unwrap()[0][0], Vec4::new(1., 0., 0., -1.));
    }
}
