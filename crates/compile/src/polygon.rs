//! Compiling polygons: points in a plane, in one outline or several, as triangles.

use super::Compiler;
use steradian_math::{DVec2, DVec3, geometry::fill::fill, intersect::FillRule};
use steradian_scene::{Mesh, Node};

/// Largest distance of points from the plane, as a fraction of the polygon's extent.
const FLAT: f64 = 1e-4;

impl Compiler<'_> {
    /// The triangles of a polygon; nothing where it is refused.
    pub(super) fn polygon(&mut self, node: &Node) -> Option<Mesh> {
        let span = node.param("points").and_then(|p| p.span).or(node.span);
        let list = self.list(node, "points");
        let counts = self.list(node, "loops");
        let rule = self.choice(node, "rule", &[("even_odd", FillRule::EvenOdd), ("nonzero", FillRule::NonZero)]);
        if node.get("points").is_none() {
            self.error(span, "shape 'polygon' needs 'points', three numbers each");
        }
        let list = list?;
        if list.len() % 3 != 0 || list.len() < 9 {
            let what =
                format!("a polygon needs three points or more, of three numbers each; here are {} numbers", list.len());
            self.error(span, what);
            return None;
        }
        let points: Vec<DVec3> =
            list.chunks_exact(3).map(|p| DVec3::new(p[0].into(), p[1].into(), p[2].into())).collect();
        let counts = counts.unwrap_or_else(|| vec![points.len() as f32]);
        let is_count = |c: &f32| *c >= 0.0 && c.fract() == 0.0 && f64::from(*c) <= points.len() as f64;
        let total: f64 = counts.iter().map(|c| f64::from(*c)).sum();
        if !counts.iter().all(is_count) || total != points.len() as f64 {
            let what =
                format!("'loops' are the numbers of points of each outline: their sum is to be {}", points.len());
            self.error(node.param("loops").and_then(|p| p.span).or(span), what);
            return None;
        }
        match flat_mesh(&points, &counts.iter().map(|c| *c as usize).collect::<Vec<_>>(), rule) {
            Ok(mesh) => Some(mesh),
            Err(fault) => {
                self.error(span, fault);
                None
            }
        }
    }
}

/// The triangles, right-handed to the order of the first outline.
fn flat_mesh(points: &[DVec3], counts: &[usize], rule: FillRule) -> Result<Mesh, String> {
    let first = points[0];
    let extent = points.iter().fold(0.0, |m: f64, p| m.max((*p - first).length()));
    // Newell's normal of the first outline; of one that crosses itself evenly, of some corner.
    let outline = &points[..counts.first().copied().unwrap_or(0)];
    let ring = outline.iter().zip(outline.iter().cycle().skip(1));
    let newell: DVec3 = ring.map(|(a, b)| (*a - first).cross(*b - first)).sum();
    let corner =
        points.windows(3).map(|w| (w[1] - w[0]).cross(w[2] - w[0])).max_by(|a, b| a.length().total_cmp(&b.length()));
    let n = if newell.length() > 1e-9 * extent * extent { newell } else { corner.unwrap_or_default() };
    let Some(n) = n.try_normalize().filter(|_| extent.is_finite()) else {
        return Err("the points of this polygon are on a line: it has no area".into());
    };
    if let Some((k, off)) =
        points.iter().map(|p| (*p - first).dot(n).abs()).enumerate().find(|(_, off)| *off > FLAT * extent)
    {
        return Err(format!("the points of a polygon are to be in a plane; point {k} is {off} off that of the others"));
    }
    let size = n.abs();
    let axis = if size.x >= size.y && size.x >= size.z {
        0
    } else if size.y >= size.z {
        1
    } else {
        2
    };
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut rest = points;
    let outlines: Vec<Vec<DVec2>> = counts
        .iter()
        .map(|count| {
            let (outline, after) = rest.split_at((*count).min(rest.len()));
            rest = after;
            outline.iter().map(|p| DVec2::new(p[u], p[v])).collect()
        })
        .collect();
    let Some(filled) = fill(&outlines, rule) else {
        return Err(format!("a polygon of {} points is too large", points.len()));
    };
    if filled.triangles.is_empty() {
        return Err("this polygon has no area".into());
    }
    let flat = outlines.iter().flatten();
    let (low, high) = flat.fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(a, b), p| (a.min(*p), b.max(*p)));
    let mut mesh = Mesh::default();
    for p in &filled.points {
        let mut place = [0.0; 3];
        place[u] = p.x as f32;
        place[v] = p.y as f32;
        place[axis] = (first[axis] - (n[u] * (p.x - first[u]) + n[v] * (p.y - first[v])) / n[axis]) as f32;
        mesh.positions.push(place);
        mesh.uvs.push(((*p - low) / (high - low)).as_vec2().to_array());
    }
    let turn = |[a, b, c]: [u32; 3]| if n[axis] > 0.0 { [a, b, c] } else { [a, c, b] };
    mesh.triangles = filled.triangles.into_iter().map(turn).collect::<Vec<_>>().into();
    Ok(mesh)
}
