//! Orders of fragments that do not go by their own depths.

use super::{Fragment, View};
use crate::{
    Error,
    draw_list::part_bounds,
    options::Method,
    order::{self, Found, Frame},
};
use std::collections::BTreeMap;
use steradian_core::scene::Shape;
use steradian_math::Vec3;

impl View<'_> {
    /// Corners in the world of a part that is a triangle.
    fn corners(&self, (item, part): (u32, u32)) -> Option<[Vec3; 3]> {
        let item = &self.list.items[item as usize];
        let Shape::Mesh(mesh) = &self.list.geometry(self.scene, item).shape else { return None };
        Some(mesh.corners(part).map(|p| item.place(self.scene).point(p)))
    }

    /// Distance along the view of the centre of a part; infinite where it has none.
    fn distance(&self, part: (u32, u32)) -> f32 {
        let center = self.corners(part).map(|[a, b, c]| (a + b + c) / 3.0).or_else(|| {
            let item = &self.list.items[part.0 as usize];
            let bounds = part_bounds(&self.list.geometry(self.scene, item).shape, part.1);
            (!bounds.is_empty()).then(|| item.place(self.scene).point((bounds.min + bounds.max) * 0.5))
        });
        center.map_or(f32::INFINITY, |p| self.projected.along_axis(p))
    }
}

/// Fragments by pixels, those of each by the distances of the centres of their primitives: wrong where these are long,
/// or cross each other.
pub fn sorted(view: &View<'_>, mut fragments: Vec<Fragment>) -> Vec<Fragment> {
    let distances: BTreeMap<_, f32> = fragments.iter().map(|f| (f.part, view.distance(f.part))).collect();
    // Stable: two sides of one shape keep the order of their depths.
    fragments.sort_by(|a, b| a.pixel.cmp(&b.pixel).then(distances[&a.part].total_cmp(&distances[&b.part])));
    fragments
}

/// Fragments by pixels, those of each in the order of a tree of the planes of their triangles.
///
/// # Errors
/// Shapes that are not triangles of meshes, and more triangles or cuts than the tree takes.
pub fn by_planes(view: &View<'_>, mut fragments: Vec<Fragment>) -> Result<Vec<Fragment>, Error> {
    let parts: Vec<(u32, u32)> =
        fragments.iter().map(|f| f.part).collect::<std::collections::BTreeSet<_>>().into_iter().collect();
    let triangles: Option<Vec<_>> =
        (0..).zip(&parts).map(|(number, part)| Some((number, view.corners(*part)?))).collect();
    let Some(triangles) = triangles else {
        return Err(Error::Scene(
            "transparency=bsp orders triangles of meshes, and other shapes of the view are transparent".into(),
        ));
    };
    // The tree gives pieces from the back to the front; of the pieces of a triangle each pixel is in one.
    let frame = Frame { size: [1, 1], view: [1.0, 1.0], start: [0.0, 0.0] };
    let (found, _) = order::solve(Method::Bsp, &triangles, view.projected, frame)?;
    let Found::Ordered(pieces, _) = found else { return Ok(fragments) };
    let mut of_parts: BTreeMap<(u32, u32), Vec<usize>> = BTreeMap::new();
    for (rank, piece) in pieces.iter().enumerate() {
        of_parts.entry(parts[piece.number as usize]).or_default().push(rank);
    }
    let rank = |fragment: &Fragment| {
        let pieces_of_part = of_parts.get(&fragment.part)?;
        let p = view.ray(fragment.pixel as usize).at(fragment.seen.hit.t).as_dvec3();
        pieces_of_part.iter().copied().find(|rank| pieces[*rank].has(p)).or(pieces_of_part.last().copied())
    };
    // What comes later in the order is nearer.
    fragments.sort_by_cached_key(|f| (f.pixel, std::cmp::Reverse(rank(f))));
    Ok(fragments)
}
