//! Compiling Bézier patches, as triangles.

use super::Compiler;
use steradian_math::{
    DVec3,
    geometry::bezier::{BezierPatch, MOST_SEGMENTS, segments, tessellate},
};
use steradian_scene::{Mesh, Node};

impl Compiler<'_> {
    /// The triangles of Bézier patches; nothing where they are refused.
    pub(super) fn bezier_patches(&mut self, node: &Node) -> Option<Mesh> {
        let span = node.param("points").and_then(|p| p.span).or(node.span);
        let level = self.int(node, "level").clamp(0, i64::from(MOST_SEGMENTS)) as u32;
        let list = self.list(node, "points");
        if list.is_none() && node.get("points").is_some() {
            return None;
        }
        let list = list.unwrap_or_default();
        if list.is_empty() || !list.len().is_multiple_of(48) {
            let what =
                format!("Bézier patches need 16 'points' each, of three numbers; here are {} numbers", list.len());
            self.error(span, what);
            return None;
        }
        let point = |p: &[f32]| DVec3::new(p[0].into(), p[1].into(), p[2].into());
        let patches: Vec<BezierPatch> = list
            .chunks_exact(48)
            .map(|p| BezierPatch { points: std::array::from_fn(|k| point(&p[3 * k..3 * k + 3])) })
            .collect();
        let n = if level > 0 { level } else { segments(&patches) };
        match tessellate(&patches, n) {
            Some(mesh) if mesh.triangles.is_empty() => {
                self.error(span, "these Bézier patches have no area");
                None
            }
            Some(mesh) => Some(mesh.into()),
            None => {
                self.error(span, format!("{} patches of {n} segments along each side are too many", patches.len()));
                None
            }
        }
    }
}
