//! A torus in meshlets, each in a colour of its own: task groups choose those that are drawn, mesh groups draw them.

use steradian_raster::{
    ColorTarget, Extent, Format, Fragment, Framebuffer, Invocation, Result, State, fragment,
    glam::{Mat3, Mat4, Vec2, Vec3, Vec4},
    mesh_shading::*,
    state::DepthState,
    varyings,
};

varyings! {
    struct Surface {
        light: f32,
        color: Vec3 => flat,
    }
}

/// Positions, and three indices for each triangle, of a torus of radii 1 and 0.4 whose axis is y.
pub fn torus(rings: u32, sides: u32) -> (Vec<Vec3>, Vec<u32>) {
    let circle = |i: u32, count: u32| {
        let (t, quarter) = ((i * 4 % count) as f32 / count as f32, [Vec2::X, Vec2::Y, -Vec2::X, -Vec2::Y]);
        quarter[(i * 4 / count) as usize].rotate(Vec2::new(1.0 - t * t, 2.0 * t) / (1.0 + t * t))
    };
    let point = |i: u32| {
        let (p, q) = (circle(i / sides, rings), 0.4 * circle(i % sides, sides));
        Vec3::new((1.0 + q.x) * p.x, q.y, -(1.0 + q.x) * p.y)
    };
    let cell = |i: u32| {
        let (row, next, j, k) = (i / sides * sides, (i / sides + 1) % rings * sides, i % sides, (i + 1) % sides);
        [row + j, next + j, next + k, row + j, next + k, row + k]
    };
    ((0..rings * sides).map(point).collect(), (0..rings * sides).flat_map(cell).collect())
}

/// Resources of the shaders.
#[derive(Clone, Copy)]
struct Asset<'a> {
    positions: &'a [Vec3],
    meshlets: &'a Meshlets,
    clip_from_object: Mat4,
    eye: Vec3,
}

/// Each of 32 invocations looks at a meshlet. A mesh group is emitted for each that does not show its back.
impl TaskShader for Asset<'_> {
    type Payload = [u32; 32];
    type Shared = usize;
    type Private = ();
    const LOCAL_SIZE: [u32; 3] = [32, 1, 1];
    const PHASES: u32 = 2;
    fn shade(&self, phase: u32, at: Invocation, (): &mut (), count: &mut usize, out: &mut TaskOutput<[u32; 32]>) {
        if phase == 1 {
            return out.emit([*count as u32, 1, 1]);
        }
        let Some(meshlet) = self.meshlets.meshlets().get(at.global[0] as usize) else { return };
        if !meshlet.cone.faces_away_from(self.eye) {
            out.payload[*count] = at.global[0];
            *count += 1;
        }
    }
}

/// Draws one of the meshlets that a task group chose.
impl MeshShader for Asset<'_> {
    type Payload = [u32; 32];
    type Shared = ();
    type Private = ();
    type Vertex = f32;
    type Primitive = Vec3;
    type Corners = [u8; 3];
    type Varyings = Surface;
    const LOCAL_SIZE: [u32; 3] = [32, 1, 1];
    const MAX_VERTICES: usize = 64;
    const MAX_PRIMITIVES: usize = 126;
    #[rustfmt::skip]
    fn shade(&self, _: u32, at: Invocation, chosen: &[u32; 32], (): &mut (), (): &mut (),
             out: &mut MeshOutput<f32, Vec3, [u8; 3]>) {
        let number = chosen[at.group[0] as usize];
        let meshlet = &self.meshlets.meshlets()[number as usize];
        let (table, triangles) = (meshlet.vertices(), meshlet.triangles());
        out.set_counts(table.len(), triangles.len());
        for i in (at.index as usize..table.len()).step_by(32) {
            let p = self.positions[self.meshlets.vertices()[table.start + i] as usize];
            let normal = (p - Vec3::new(p.x, 0.0, p.z).normalize()) / 0.4;
            let light = 0.3 + 0.7 * normal.dot(Vec3::new(0.48, 0.8, 0.36)).max(0.0);
            out.vertex(i, MeshVertex::new(self.clip_from_object * p.extend(1.0), light));
        }
        let color = [37, 91, 151].map(|k| 0.25 + 0.75 * (number * k % 256) as f32 / 255.0).into();
        for i in (at.index as usize..triangles.len()).step_by(32) {
            out.primitive(i, MeshPrimitive::new(self.meshlets.triangles()[triangles.start + i], color));
        }
    }
    fn varyings(&light: &f32, &color: &Vec3) -> Surface {
        Surface { light, color }
    }
}

/// A torus of 9216 triangles as it is seen from a point 2.8 away, at an angle of 37° above it.
pub fn draw() -> Result<(ColorTarget, MeshCounters)> {
    let (positions, indices) = torus(96, 48);
    let meshlets = &Meshlets::build(&positions, &indices, MeshletLimits::default())?;
    // x stays; y and z are turned by an angle of cosine 0.8. Depths from 0.5 (0) to 8 (1).
    let turn = Mat3::from_cols(Vec3::X, Vec3::new(0.0, 0.8, 0.6), Vec3::new(0.0, -0.6, 0.8));
    let [depth, near] = [Vec4::new(0.0, 0.0, -8.0 / 7.5, -1.0), Vec4::new(0.0, 0.0, -4.0 / 7.5, 0.0)];
    let clip_from_camera = Mat4::from_cols(1.8 * Vec4::X, 1.8 * Vec4::Y, depth, near);
    let clip_from_object = clip_from_camera * Mat4::from_translation(-2.8 * Vec3::Z) * Mat4::from_mat3(turn);
    let asset = Asset { positions: &positions, meshlets, clip_from_object, eye: Vec3::new(0.0, 1.68, 2.24) };
    let shader = fragment(|f: &Fragment<Surface>| (f.varyings().color * f.varyings().light).extend(1.0));
    let state = State { depth: Some(DepthState::LESS), ..State::default() };
    let mut target = Framebuffer::with_color_and_depth(Extent::new(320, 320), Format::Rgba8Unorm)?;
    target.clear(Vec4::new(0.1, 0.1, 0.1, 1.0), 1.0, 0);
    let pipeline = MeshPipeline::new(MeshProgram::new(asset, shader).task(asset), state, target.layout())?;
    let counters = pipeline.draw(&mut target, [meshlets.meshlets().len().div_ceil(32) as u32, 1, 1])?;
    Ok((target.color(0).clone(), counters))
}

#[allow(dead_code, reason = "tests include this file")]
fn main() -> std::result::Result<(), Box<dyn std::error::Error>> {
    Ok(steradian_image::write("meshlets.png".as_ref(), &draw()?.0.to_image()?, &Default::default())?)
}
