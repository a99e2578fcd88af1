//! Shadow volumes (Crow 1977, "Shadow Algorithms for Computer Graphics"): the space behind what a light meets, bounded
//! by polygons.
//!
//! Each triangle bounds a volume of its own; it is turned to face the light, so that winding says nothing about inside
//! and outside and meshes may be open or not manifold (Kim, Kim, Kim 2008, "Shadow volumes for non-manifold meshes").
//! Where two volumes meet along an edge their sides cancel; what is left are the silhouettes, each with how often it
//! counts. Sides go on to infinity. Of points of the picture it is counted, in the stencil buffer, how many volumes
//! they are in: behind them (z-fail: Bilodeau, Songy 1999; Carmack 2000), where volumes are closed by caps, or before
//! them (z-pass: Heidmann 1991).

use std::collections::HashMap;

use steradian_core::{
    Scene,
    scene::{Interaction, Shape},
};
use steradian_math::{Vec3, Vec4};
use steradian_raster::{
    DepthFormat, DepthTarget, Draw, Framebuffer, Pipeline, Program, State, StencilTarget, Vertex, VertexInput,
    stages::DepthOnly,
    state::{DepthState, FrontFace, RasterState, StencilFace, StencilOp, StencilState},
};

use super::{Eye, Source, casters::Casters};
use crate::{Error, visibility::fill_depths};

/// Number of shadow volumes that each pixel is in.
#[derive(Debug)]
pub struct Volumes {
    counts: Vec<u8>,
    /// True if shapes other than whole meshes cast shadows, too: these are traced by rays.
    others: bool,
}

/// The edges that bound the volumes of a light, each turned as the triangle that it belongs to, and how often it
/// counts.
pub struct Silhouette {
    pub edges: Vec<([Vec3; 2], u32)>,
    /// Per triangle: true if its corners are counter-clockwise as the light sees them.
    pub faces_light: Vec<bool>,
}

impl Silhouette {
    fn new(triangles: &[[Vec3; 3]], source: Source) -> Self {
        let faces_light: Vec<bool> = triangles.iter().map(|corners| faces(corners, source)).collect();
        // An edge by its corners in a fixed order, and how often it is run through in that order rather than back.
        let mut counts: HashMap<[[u32; 3]; 2], i32> = HashMap::new();
        // Zeros of either sign are one place.
        let key = |p: Vec3| (p + Vec3::ZERO).to_array().map(f32::to_bits);
        let mut order = Vec::new();
        for (corners, faces_light) in triangles.iter().zip(&faces_light) {
            // Each triangle runs through its edges as the light sees it counter-clockwise. Two triangles that share an
            // edge run through it in opposite directions and cancel; the rest is the silhouette.
            for i in 0..3 {
                let (from, to) = (key(corners[i]), key(corners[(i + 1) % 3]));
                let forward = (from < to) == *faces_light;
                let edge = if from < to { [from, to] } else { [to, from] };
                let count = counts.entry(edge).or_insert_with(|| {
                    order.push(edge);
                    0
                });
                *count += if from == to {
                    0
                } else if forward {
                    1
                } else {
                    -1
                };
            }
        }
        let place = |bits: [u32; 3]| Vec3::from_array(bits.map(f32::from_bits));
        let edge = |edge: [[u32; 3]; 2]| {
            // What remains is the silhouette with its multiplicity.
            let count = counts[&edge];
            let [a, b] = edge.map(place);
            (count != 0).then(|| (if count > 0 { [a, b] } else { [b, a] }, count.unsigned_abs()))
        };
        Self { edges: order.into_iter().filter_map(edge).collect(), faces_light }
    }
}

/// True if the corners are counter-clockwise as the light sees them.
fn faces([a, b, c]: &[Vec3; 3], source: Source) -> bool {
    let n = (b.as_dvec3() - a.as_dvec3()).cross(c.as_dvec3() - a.as_dvec3());
    let to_light = match source {
        Source::At(place) => place.as_dvec3() - a.as_dvec3(),
        Source::From(wi) => wi.as_dvec3(),
    };
    n.dot(to_light) > 0.0
}

impl Volumes {
    /// Draws the volumes of a light and counts. `behind`: z-fail.
    pub fn new(scene: &Scene, casters: &Casters, source: Source, eye: &Eye, behind: bool) -> Result<Self, Error> {
        let silhouette = Silhouette::new(&casters.triangles, source);
        let mut counting = Counting::new(scene, eye, behind)?;
        let projected = eye.projected;
        let end = |p: Vec3| match source {
            // Extrude away from the light to infinity: homogeneous points with w = 0.
            Source::At(place) => p - place,
            Source::From(wi) => -wi,
        };
        // Corners at infinity are directions, with weight 0 (Everitt, Kilgard 2002).
        let far = |p: Vec3| projected.clip_homogeneous(end(p).extend(0.0));
        let mut sides = Vec::new();
        // A side is the quad from a silhouette edge to infinity; for parallel light both far corners are one point, and
        // it is a triangle.
        for ([a, b], count) in &silhouette.edges {
            let (p, q, q_far, p_far) = (projected.clip(*b), projected.clip(*a), far(*a), far(*b));
            for _ in 0..*count {
                sides.extend([p, q, q_far]);
                if matches!(source, Source::At(_)) {
                    sides.extend([p, q_far, p_far]);
                }
            }
        }
        counting.draw(&sides, false, false)?;
        // z-fail needs closed volumes: the triangles themselves are the near caps, their images at infinity the far
        // caps. A triangle that faces away from the light counts with its corners turned round.
        if behind {
            for turned in [false, true] {
                let of_side = || casters.triangles.iter().zip(&silhouette.faces_light).filter(|(_, f)| **f != turned);
                let caps: Vec<Vec4> = of_side().flat_map(|(corners, _)| corners.map(|p| projected.clip(p))).collect();
                counting.draw(&caps, turned, true)?;
                // Parallel volumes end in a point.
                if matches!(source, Source::At(_)) {
                    let ends: Vec<Vec4> = of_side().flat_map(|(corners, _)| corners.map(far)).collect();
                    counting.draw(&ends, !turned, false)?;
                }
            }
        }
        Ok(Self { counts: counting.counts(), others: casters.others })
    }

    /// Number of volumes that each pixel is in, modulo 256.
    pub fn into_counts(self) -> Vec<u8> {
        self.counts
    }

    /// True if the visible point of a pixel is lit from `wi`; `None` where rays must tell.
    pub fn lit(&self, scene: &Scene, i: &Interaction, wi: Vec3, pixel: usize) -> Option<f32> {
        // The far side of a triangle is in the volume of the triangle itself, which casts no shadow on it.
        let geometry = &scene.geometries()[i.geometry as usize];
        let is_caster = matches!(geometry.shape, Shape::Mesh(_)) && !geometry.is_masked();
        let n = i.surface.n;
        // Counts are modulo 256, so that the subtraction wraps too.
        let own = u8::from(is_caster && n.dot(i.wo) * n.dot(wi) < 0.0);
        let lit = self.counts[pixel].wrapping_sub(own) == 0;
        if lit && self.others { None } else { Some(f32::from(u8::from(lit))) }
    }
}

/// A stencil buffer before the depths that the eye sees.
struct Counting {
    target: Framebuffer,
    state: State,
    mirrored: bool,
    behind: bool,
}

impl Counting {
    fn new(scene: &Scene, eye: &Eye, behind: bool) -> Result<Self, Error> {
        let (extent, viewport) = eye.projected.frame(scene);
        let depth = DepthTarget::new(extent, DepthFormat::Float32)?;
        let mut target = Framebuffer::new(Vec::new(), Some(depth), Some(StencilTarget::new(extent)?))?;
        // The depths of the visible points; the volumes are tested against them and do not write.
        fill_depths(&mut target, &eye.visibility.depths)?;
        let depth = Some(DepthState { write: false, ..DepthState::GREATER });
        let state = State { depth, viewports: vec![viewport], ..State::default() };
        Ok(Self { target, state, mirrored: eye.projected.is_mirrored(), behind })
    }

    /// Counts triangles whose corners are counter-clockwise from outside the volumes, or clockwise if `turned`. `seen`:
    /// they are among what the eye sees, and must have the very same depths.
    fn draw(&mut self, corners: &[Vec4], turned: bool, seen: bool) -> Result<(), Error> {
        let vertex = |input: VertexInput| Vertex::new(corners[input.vertex as usize], ());
        let front_face = if self.mirrored != turned { FrontFace::Clockwise } else { FrontFace::CounterClockwise };
        let (up, down) = (StencilOp::IncrementWrap, StencilOp::DecrementWrap);
        // z-fail counts sides behind the visible point (those that fail the depth test), z-pass sides before it.
        let face = |op: StencilOp| {
            if self.behind {
                StencilFace { depth_fail: op, ..StencilFace::default() }
            } else {
                StencilFace { pass: op, ..StencilFace::default() }
            }
        };
        // Behind the point, back faces are exits (+1) and front faces entries (−1); before it, the other way round.
        let stencil = if self.behind {
            StencilState { front: face(down), back: face(up) }
        } else {
            StencilState { front: face(up), back: face(down) }
        };
        let raster = RasterState { front_face, depth_clip: seen, ..RasterState::default() };
        let state = State { stencil: Some(stencil), raster, ..self.state.clone() };
        let pipeline = Pipeline::new(Program::new(vertex, DepthOnly::default()), state, self.target.layout())?;
        // A draw counts up to 2³² − 1 vertices.
        let most = u32::MAX - 2;
        if corners.len() > most as usize {
            return Err(Error::Scene("shadow volumes of more than a thousand million triangles".into()));
        }
        pipeline.draw(&mut self.target, &Draw::vertices(0..corners.len() as u32))?;
        Ok(())
    }

    fn counts(&self) -> Vec<u8> {
        self.target.stencil().map_or(Vec::new(), |stencil| stencil.to_rows(0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A closed box has the outline that the light sees, each edge twice, as often as volumes of its near and far sides
    /// begin there; an open sheet its border, once; edges without extent do not count (M234).
    #[test]
    fn silhouettes_are_outlines() {
        let corner = |i: usize| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32);
        let cube: Vec<[Vec3; 3]> = crate::draw_list::BOX.iter().map(|t| t.map(corner)).collect();
        let from_corner = Silhouette::new(&cube, Source::From(Vec3::ONE.normalize()));
        assert_eq!(from_corner.edges.len(), 6);
        assert!(from_corner.edges.iter().all(|(_, count)| *count == 2));
        let from_side = Silhouette::new(&cube, Source::At(Vec3::new(0.5, 0.5, 9.0)));
        // From the middle of a side its four edges are where the light leaves the box.
        assert_eq!(from_side.edges.len(), 4);
        assert_eq!(from_side.faces_light.iter().filter(|f| **f).count(), 2);
        let sheet = Silhouette::new(&cube[..2], Source::At(Vec3::new(0.3, 0.4, -3.0)));
        assert!(sheet.edges.len() == 4 && sheet.edges.iter().all(|(_, count)| *count == 1));
        let needle = [[Vec3::ZERO, Vec3::ZERO, Vec3::X]];
        assert!(Silhouette::new(&needle, Source::From(Vec3::Z)).edges.is_empty());
    }
}
