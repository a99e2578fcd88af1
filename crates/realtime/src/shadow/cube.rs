//! The six maps around a point in one pass: a geometry shader hands each triangle to the faces that may see it.

use steradian_core::Scene;
use steradian_raster::{
    DepthFormat, DepthTarget, Draw, Extent, Framebuffer, Pipeline, Program, State, Vertex, VertexInput,
    glam::Vec4,
    stages::{DepthOnly, Emitter, GeometryInput, GeometryOutput, GeometryShader},
    state::DepthState,
};

use super::{casters::Casters, map::Map};
use crate::{
    Error,
    draw_list::DrawList,
    projection::Projected,
    visibility::{Visibility, Wanted},
};

/// Emits a triangle of the world once for each face of the cube that may see it, in the layer of that face.
struct ToFaces<'a>(&'a [Projected; 6]);

impl GeometryShader for ToFaces<'_> {
    type Input = ();
    type Output = ();
    const OUTPUT: GeometryOutput = GeometryOutput::TriangleStrip;
    const MAX_VERTICES: usize = 18;

    fn shade(&self, input: GeometryInput<()>, out: &mut Emitter<()>) {
        // A face is left out if one plane of its frustum rejects all three corners.
        for (layer, view) in self.0.iter().enumerate() {
            let corners = [0, 1, 2].map(|i| view.clip(input.vertices[i].position.truncate()));
            let outside = |p: Vec4| [p.x < -p.w, p.x > p.w, p.y < -p.w, p.y > p.w, p.z > p.w];
            let [a, b, c] = corners.map(outside);
            if (0..5).any(|plane| a[plane] && b[plane] && c[plane]) {
                continue;
            }
            for corner in corners {
                out.vertex(Vertex { layer: layer as u32, ..Vertex::new(corner, ()) });
            }
            out.end_primitive();
        }
    }
}

/// The maps of these views.
pub fn maps(
    scene: &Scene,
    list: &DrawList,
    casters: &Casters,
    views: &[Projected; 6],
    size: u32,
) -> Result<Vec<Map>, Error> {
    // A layered depth target, one layer for each face.
    let depth = DepthTarget::new(Extent::new(size, size).layers(6), DepthFormat::Float32)?;
    let mut target = Framebuffer::new(Vec::new(), Some(depth), None)?;
    target.clear_depth(0.0);
    let vertex = |input: VertexInput| {
        let corner = casters.triangles[(input.vertex / 3) as usize][(input.vertex % 3) as usize];
        Vertex::new(corner.extend(1.0), ())
    };
    let program = Program::new(vertex, DepthOnly::default()).geometry(ToFaces(views));
    let state = State { depth: Some(DepthState::GREATER), ..State::default() };
    let count = u32::try_from(3 * casters.triangles.len()).unwrap_or(u32::MAX);
    Pipeline::new(program, state, target.layout())?.draw(&mut target, &Draw::vertices(0..count))?;
    // Shapes other than meshes are drawn face by face; of two reversed depths the larger is the nearer.
    let map = |(face, view): (usize, &Projected)| {
        let mut depths = target.depth().map_or(Vec::new(), |depth| depth.to_rows(face as u32));
        if casters.others {
            let others = Visibility::draw_wanted(scene, list, view, Wanted { method: None, ..Wanted::default() })?;
            depths.iter_mut().zip(&others.depths).for_each(|(depth, other)| *depth = depth.max(*other));
        }
        Ok(Map::of_depths(*view, &depths, size))
    };
    views.iter().enumerate().map(map).collect()
}
