//! Neighbours of triangles.
//!
//! Vertices at one position are welded: files split them where normals or texture coordinates jump. A *side* `3t + c`
//! leads from corner `c` of triangle `t` to the next. Two sides are partners if they alone join their two vertices and
//! run in opposite directions; edges of three or more triangles, of triangles whose orientations differ, and of
//! triangles without area have no partners, so that what is joined is always an oriented manifold. Seams are edges that
//! were given, and those where the normals turn by more than an angle.

use crate::mesh::Mesh;
use steradian_math::DVec3;

/// Number of no side.
pub const NONE: u32 = u32::MAX;

/// Height of a triangle over its longest side, relative to that side, below which its area is taken as zero.
const FLAT: f64 = 1e-8;

/// Partners of all sides.
pub struct Connections {
    /// Partner of each side across an edge that is no seam, or [`NONE`].
    pub partner: Vec<u32>,
    /// Area of each triangle; 0 for those that are left out.
    pub area: Vec<f64>,
    /// Unit normal of each triangle; zero for those that are left out.
    pub normal: Vec<DVec3>,
    /// Edges between triangles that are seams, a side for each.
    pub seams: Vec<u32>,
}

/// The side after a side in its triangle.
pub fn next(side: u32) -> u32 {
    if side % 3 == 2 { side - 2 } else { side + 1 }
}

/// The side before a side in its triangle.
pub fn previous(side: u32) -> u32 {
    if side.is_multiple_of(3) { side + 2 } else { side - 1 }
}

/// Finds the partners of a mesh's sides.
pub fn connect(mesh: &Mesh<'_>, seam_angle: f64) -> Connections {
    let welded = weld(mesh.positions);
    let count = mesh.triangles.len();
    let (mut area, mut normal) = (vec![0.0; count], vec![DVec3::ZERO; count]);
    for t in 0..count {
        let [a, b, c] = mesh.corners(t as u32);
        let v = mesh.area_vector(t as u32);
        let longest = (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared());
        if v.length() > 0.5 * FLAT * longest {
            area[t] = v.length();
            normal[t] = v / v.length();
        }
    }
    let ends = |side: usize| {
        let corners = mesh.triangles[side / 3];
        [corners[side % 3], corners[(side + 1) % 3]].map(|i| welded[i as usize])
    };
    let key = |[a, b]: [u32; 2]| if a < b { [a, b] } else { [b, a] };
    let mut sides: Vec<([u32; 2], u32)> =
        (0..3 * count).filter(|s| area[s / 3] > 0.0).map(|s| (key(ends(s)), s as u32)).collect();
    sides.sort_unstable();
    let mut given: Vec<[u32; 2]> = mesh.seams.iter().map(|ends| key(ends.map(|i| welded[i as usize]))).collect();
    given.sort_unstable();
    let turn = if seam_angle < std::f64::consts::PI { seam_angle.cos() } else { -2.0 };
    let (mut partner, mut seams) = (vec![NONE; 3 * count], Vec::new());
    for group in sides.chunk_by(|a, b| a.0 == b.0) {
        let is_pair = group.len() == 2 && ends(group[0].1 as usize) != ends(group[1].1 as usize);
        let joins = |[a, b]: [u32; 2]| normal[a as usize / 3].dot(normal[b as usize / 3]) >= turn;
        if is_pair && joins([group[0].1, group[1].1]) && given.binary_search(&group[0].0).is_err() {
            partner[group[0].1 as usize] = group[1].1;
            partner[group[1].1 as usize] = group[0].1;
        } else if group.len() > 1 {
            seams.push(group[0].1);
        }
    }
    Connections { partner, area, normal, seams }
}

/// For each vertex the first one at its position.
fn weld(positions: &[[f32; 3]]) -> Vec<u32> {
    // Adding zero makes −0 into +0, of which the bits are then the same.
    let bits = |i: u32| positions[i as usize].map(|x| (x + 0.0).to_bits());
    let mut order: Vec<u32> = (0..positions.len() as u32).collect();
    order.sort_unstable_by_key(|i| (bits(*i), *i));
    let mut welded = vec![0; positions.len()];
    for group in order.chunk_by(|a, b| bits(*a) == bits(*b)) {
        group.iter().for_each(|i| welded[*i as usize] = group[0]);
    }
    welded
}
