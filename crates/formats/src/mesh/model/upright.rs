//! Guess of the axis that is up in a file that does not say it.
//!
//! A model stands on its base. Its stance on a side is how far it can be tilted there before it falls: the distance of
//! its centre from the edge of the hull of all contacts, over the height of the centre. A model that would fall over
//! as the file has it, and stands firmly on the side where z is lowest but not on the opposite one, has z up. Flat
//! things say nothing of themselves: they may be plates on a table or pictures on a wall.

use std::sync::Arc;
use steradian_math::DVec3;
use steradian_scene::Mesh;

/// Distance from the lowest point, in diagonals of the box, within which a model touches the ground.
const CONTACT: f64 = 0.01;
/// Least cosine between the vertical and the normals of faces that lie on the ground.
const LEVEL: f64 = 0.94;
/// Greatest tangent of the angle of tilt for a model that would fall.
const FALLS: f64 = 0.05;
/// Tangents for one that stands; what cannot be tilted over lies flat.
const STANDS: std::ops::RangeInclusive<f64> = 0.15..=2.0;
/// Least height of one that stands, in extents along y.
const HEIGHT: f64 = 0.7;
/// Least share of the footprint that is a broad base.
const BROAD: f64 = 0.5;

/// A model on the ground.
struct Stance {
    /// Tangent of the angle by which it can be tilted in any direction; negative where it falls by itself.
    tilt: f64,
    /// Area of level faces on the ground as a share of the footprint.
    base: f64,
}

/// A model whose stances are compared.
struct Body<'a> {
    meshes: &'a [Arc<Mesh>],
    low: DVec3,
    high: DVec3,
    /// Centre of its surface.
    center: DVec3,
}

/// Twice the signed area of a triangle in the plane.
fn turn(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// The convex hull of points in the plane, counter-clockwise (Andrew's monotone chains).
fn hull(mut points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    points.sort_unstable_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    points.dedup();
    let chain = |points: &mut dyn Iterator<Item = &[f64; 2]>| {
        let mut chain: Vec<[f64; 2]> = Vec::new();
        for &p in points {
            while let [.., a, b] = chain[..]
                && turn(a, b, p) <= 0.0
            {
                chain.pop();
            }
            chain.push(p);
        }
        chain.pop();
        chain
    };
    let mut around = chain(&mut points.iter());
    around.extend(chain(&mut points.iter().rev()));
    around
}

/// The triangles of meshes, patches as two.
fn triangles(meshes: &[Arc<Mesh>]) -> impl Iterator<Item = [DVec3; 3]> {
    meshes.iter().flat_map(|mesh| {
        let halves = mesh.patches.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [b, d, c]]);
        mesh.triangles.iter().copied().chain(halves).filter_map(|triangle| {
            let place = |i: u32| mesh.positions.get(i as usize).map(|p| DVec3::from(p.map(f64::from)));
            let [a, b, c] = triangle.map(place);
            Some([a?, b?, c?])
        })
    })
}

impl<'a> Body<'a> {
    /// `None` for a model without surface.
    fn of(meshes: &'a [Arc<Mesh>]) -> Option<Self> {
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let (mut sum, mut total) = (DVec3::ZERO, 0.0);
        for [a, b, c] in triangles(meshes) {
            let area = (b - a).cross(c - a).length();
            sum += (a + b + c) * (area / 3.0);
            total += area;
            low = low.min(a).min(b).min(c);
            high = high.max(a).max(b).max(c);
        }
        let center = sum / total;
        (center.is_finite() && (high - low).is_finite()).then_some(Self { meshes, low, high, center })
    }

    fn extent(&self) -> DVec3 {
        self.high - self.low
    }

    /// Its stance with `down` towards the ground, an axis or its opposite.
    fn stance(&self, down: DVec3) -> Stance {
        let (x, y) = match down.abs().max_position() {
            0 => (DVec3::Y, DVec3::Z),
            1 => (DVec3::Z, DVec3::X),
            _ => (DVec3::X, DVec3::Y),
        };
        let place = |p: DVec3| [p.dot(x), p.dot(y)];
        let lowest = self.low.dot(down).max(self.high.dot(down));
        let reach = lowest - CONTACT * self.extent().length();
        let touches = |p: &DVec3| p.dot(down) >= reach;
        let mut contacts = Vec::new();
        let mut base = 0.0;
        for triangle in triangles(self.meshes) {
            contacts.extend(triangle.iter().copied().filter(touches).map(place));
            let [a, b, c] = triangle;
            let normal = (b - a).cross(c - a);
            if triangle.iter().all(touches) && normal.dot(down).abs() >= LEVEL * normal.length() {
                base += 0.5 * normal.length();
            }
        }
        let (center, hull) = (place(self.center), hull(contacts));
        let edges = hull.iter().zip(hull.iter().cycle().skip(1));
        let inside = edges.map(|(&a, &b)| turn(a, b, center) / (b[0] - a[0]).hypot(b[1] - a[1]));
        let nearest = inside.reduce(f64::min).filter(|_| hull.len() > 2).unwrap_or(0.0);
        let height = lowest - self.center.dot(down);
        let footprint = self.extent().dot(x) * self.extent().dot(y);
        Stance { tilt: nearest / height.max(1e-9 * self.extent().length()), base: base / footprint }
    }
}

/// True if a model whose file should have y up clearly lies on its side, and stands with z up.
pub(super) fn lies_on_its_side(meshes: &[Arc<Mesh>]) -> bool {
    let Some(body) = Body::of(meshes) else { return false };
    let extent = body.extent();
    if extent.z < HEIGHT * extent.y || extent.min_element() < 1e-3 * extent.max_element() {
        return false;
    }
    let rests = |low: f64| low.abs() < 0.005 * extent.length();
    if rests(body.low.y) && !rests(body.low.z) {
        return false;
    }
    let [lying, standing, upside_down] = [DVec3::NEG_Y, DVec3::NEG_Z, DVec3::Z].map(|down| body.stance(down));
    let is_clear = STANDS.contains(&standing.tilt) && upside_down.tilt < 0.5 * standing.tilt;
    let is_broad = standing.base > BROAD.max(4.0 * lying.base);
    is_clear && (lying.tilt < FALLS || (is_broad && standing.tilt > 3.0 * lying.tilt))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A frustum of a square pyramid along z, with squares at the bottom and at the top.
    fn frustum(bottom: f32, top: f32, height: f32) -> Mesh {
        let ring = |half: f32, z: f32| [[-half, -half, z], [half, -half, z], [half, half, z], [-half, half, z]];
        let positions = [ring(bottom, 0.0), ring(top, height)].concat();
        let mut triangles = vec![[0, 2, 1], [0, 3, 2], [4, 5, 6], [4, 6, 7]];
        triangles.extend((0..4).flat_map(|i| [[i, (i + 1) % 4, i + 4], [(i + 1) % 4, (i + 1) % 4 + 4, i + 4]]));
        Mesh { positions, triangles: triangles.into(), ..Mesh::default() }
    }

    fn turned(mesh: &Mesh, axes: impl Fn([f32; 3]) -> [f32; 3]) -> [Arc<Mesh>; 1] {
        [Arc::new(Mesh { positions: mesh.positions.iter().map(|&p| axes(p)).collect(), ..mesh.clone() })]
    }

    /// Half the base over the height of the centre.
    #[test]
    fn tilts_are_those_of_statics() {
        let cube = turned(&frustum(1.0, 1.0, 2.0), |p| p);
        let body = Body::of(&cube).expect("it has an extent");
        let stance = body.stance(DVec3::NEG_Z);
        assert!(
            (stance.tilt - 1.0).abs() < 1e-9 && (stance.base - 1.0).abs() < 1e-9,
            "{} {}",
            stance.tilt,
            stance.base
        );
        let tower = turned(&frustum(1.0, 1.0, 8.0), |p| p);
        assert!((Body::of(&tower).expect("it has an extent").stance(DVec3::NEG_Z).tilt - 0.25).abs() < 1e-9);
        // On its side a cone of half angle α, of which only an edge touches.
        let cone = turned(&frustum(1.0, 0.0, 3.0), |p| p);
        assert!(Body::of(&cone).expect("it has an extent").stance(DVec3::NEG_Y).tilt < FALLS);
    }

    #[test]
    fn only_what_clearly_lies_is_turned() {
        let cone = frustum(1.0, 0.1, 3.0);
        assert!(lies_on_its_side(&turned(&cone, |p| p)));
        assert!(!lies_on_its_side(&turned(&cone, |[x, y, z]| [x, z, -y])), "it stands");
        assert!(!lies_on_its_side(&turned(&cone, |[x, y, z]| [x, y, -z])), "its tip is down");
        assert!(!lies_on_its_side(&turned(&frustum(1.0, 1.0, 2.0), |p| p)), "a cube");
        assert!(!lies_on_its_side(&turned(&frustum(1.0, 0.8, 0.1), |p| p)), "a plate, or a picture on a wall");
        assert!(!lies_on_its_side(&turned(&cone, |[x, y, z]| [x, y + 1.0, z - 9.0])), "the file has it on y = 0");
        assert!(!lies_on_its_side(&[]));
        let point = Mesh { positions: vec![[1.0; 3]], triangles: vec![[0, 0, 0]].into(), ..Mesh::default() };
        assert!(!lies_on_its_side(&[Arc::new(point)]));
    }
}
