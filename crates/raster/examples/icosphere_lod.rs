//! Spheres without vertex or index buffers: task groups choose how finely each face of an icosahedron is divided, mesh
//! groups make its triangles.

use steradian_raster::{
    Extent, Format, Fragment, Framebuffer, Invocation, Result, State, fragment,
    glam::{Vec3, Vec4},
    mesh_shading::{
        MeshCounters, MeshOutput, MeshPipeline, MeshPrimitive, MeshProgram, MeshShader, MeshVertex, TaskOutput,
        TaskShader,
    },
    state::{Cull, DepthState, RasterState},
    varyings,
};

varyings! {
    /// Input of the fragment shader.
    pub struct Surface {
        normal: Vec3,
        color: Vec3 => flat,
    }
}

/// A sphere of radius 1 and how often its faces are divided: 20·4ᵏ triangles.
#[derive(Clone, Copy, Debug)]
pub struct Ball {
    /// Its centre, in camera space.
    pub center: Vec3,
    /// From 0 to 9.
    pub level: u32,
}

/// One face of one sphere.
#[derive(Clone, Copy, Debug, Default)]
pub struct Face {
    ball: u32,
    face: u32,
}

/// Group (face, ball) emits a mesh group for each 64 triangles.
struct Divide<'a>(&'a [Ball]);

impl TaskShader for Divide<'_> {
    type Payload = Face;
    type Shared = ();
    type Private = ();
    const LOCAL_SIZE: [u32; 3] = [1; 3];
    fn shade(&self, _: u32, at: Invocation, (): &mut (), (): &mut (), out: &mut TaskOutput<Face>) {
        out.payload = Face { ball: at.group[1], face: at.group[0] };
        out.emit([4u32.pow(self.0[at.group[1] as usize].level.saturating_sub(3)), 1, 1]);
    }
}

struct Patch<'a>(&'a [Ball]);

/// Row and place in it of point `i` of a triangle of points.
fn point(i: u32) -> [u32; 2] {
    let row = ((8 * i + 1).isqrt() - 1) / 2;
    [row, i - row * (row + 1) / 2]
}

/// The corners of triangle `i` of those that a triangle is divided into.
fn triangle(i: u32) -> [[u32; 2]; 3] {
    let row = i.isqrt();
    let (place, odd) = ((i - row * row) / 2, (i - row * row) % 2);
    [[row, place], [row + 1, place + odd], [row + 1 - odd, place + 1]]
}

/// Barycentric weights of a point of a triangle of `n` rows, their sum n.
fn weights(n: u32, [row, place]: [u32; 2]) -> [u32; 3] {
    [n - row, row - place, place]
}

impl MeshShader for Patch<'_> {
    type Payload = Face;
    type Shared = ();
    type Private = ();
    type Vertex = Vec3;
    type Primitive = Vec3;
    type Corners = [u8; 3];
    type Varyings = Surface;
    const LOCAL_SIZE: [u32; 3] = [64, 1, 1];
    const MAX_VERTICES: usize = 45;
    const MAX_PRIMITIVES: usize = 64;
    fn shade(
        &self,
        _: u32,
        at: Invocation,
        face: &Face,
        (): &mut (),
        (): &mut (),
        out: &mut MeshOutput<Vec3, Vec3, [u8; 3]>,
    ) {
        let Ball { center, level } = self.0[face.ball as usize];
        let (patches, rows) = (1 << level.saturating_sub(3), 1 << level.min(3));
        let (vertices, triangles) = ((rows + 1) * (rows + 2) / 2, rows * rows);
        out.set_counts(vertices as usize, triangles as usize);
        let i = at.index;
        if i < vertices {
            // Whole numbers as weights, so that neighbours find the same position on a common edge.
            let patch = triangle(at.group[0]).map(|corner| weights(patches, corner));
            let inner = weights(rows, point(i));
            let w = [0, 1, 2].map(|c: usize| (0..3).map(|k: usize| patch[k][c] * inner[k]).sum::<u32>() as f32);
            let [a, b, c] = icosahedron(face.face as usize);
            let normal = (a * w[0] + b * w[1] + c * w[2]).normalize();
            let p = center + normal;
            // A camera at the origin that looks along −z.
            out.vertex(i as usize, MeshVertex::new(Vec4::new(2.0 * p.x, 2.0 * p.y, -p.z - 1.0, -p.z), normal));
        }
        if i < triangles {
            let color = [Vec3::ONE, Vec3::X, Vec3::Y, Vec3::new(0.3, 0.5, 1.0)][level as usize / 2 % 4];
            let corners = triangle(i).map(|[row, place]| (row * (row + 1) / 2 + place) as u8);
            out.primitive(i as usize, MeshPrimitive::new(corners, color * (0.7 + 0.3 * (at.group[0] % 2) as f32)));
        }
    }
    fn varyings(normal: &Vec3, color: &Vec3) -> Surface {
        Surface { normal: *normal, color: *color }
    }
}

/// Corners of a face, counter-clockwise from outside: five around each pole, and ten between them.
fn icosahedron(face: usize) -> [Vec3; 3] {
    // cos and sin of 0°, 72°, … by roots.
    let root = 5f32.sqrt();
    let (c1, c2) = ((root - 1.0) / 4.0, (-root - 1.0) / 4.0);
    let (s1, s2) = ((1.0 - c1 * c1).sqrt(), (1.0 - c2 * c2).sqrt());
    let ring = |i: usize| [(1.0, 0.0), (c1, s1), (c2, s2), (c2, -s2), (c1, -s1)][i % 5];
    let (z, r) = (1.0 / root, 2.0 / root);
    let upper = |i: usize| Vec3::new(r * ring(i).0, r * ring(i).1, z);
    let lower = |i: usize| -upper(i + 3);
    let i = face % 5;
    match face / 5 {
        0 => [Vec3::Z, upper(i), upper(i + 1)],
        1 => [upper(i), lower(i), upper(i + 1)],
        2 => [lower(i), lower(i + 1), upper(i + 1)],
        _ => [lower(i + 1), lower(i), -Vec3::Z],
    }
}

/// Draws spheres, or only counts what would be drawn.
pub fn draw(balls: &[Ball], framebuffer: &mut Framebuffer, count_only: bool) -> Result<MeshCounters> {
    let shader = fragment(|f: &Fragment<Surface>| {
        let Surface { normal, color } = *f.varyings();
        (color * (0.2 + 0.8 * normal.dot(Vec3::new(0.5, 0.6, 0.6)).max(0.0))).extend(1.0)
    });
    let raster = RasterState { cull: Cull::Back, ..RasterState::default() };
    let state = State { depth: Some(DepthState::LESS), raster, ..State::default() };
    let program = MeshProgram::new(Patch(balls), shader).task(Divide(balls));
    let pipeline = MeshPipeline::new(program, state, framebuffer.layout())?;
    let groups = [20, balls.len() as u32, 1];
    if count_only { pipeline.count(groups) } else { pipeline.draw(framebuffer, groups) }
}

/// Four spheres, the nearer the finer.
pub fn picture() -> Result<steradian_raster::ColorTarget> {
    let mut framebuffer = Framebuffer::with_color_and_depth(Extent::new(320, 320), Format::Rgba8Unorm)?;
    framebuffer.clear(Vec4::new(0.1, 0.1, 0.1, 1.0), 1.0, 0);
    let ball = |(x, y, z, level)| Ball { center: Vec3::new(x, y, z), level };
    let balls = [(-2.0, -2.0, -6.0, 6), (1.5, -1.5, -8.0, 5), (-3.0, 2.5, -10.0, 4), (3.0, 2.5, -14.0, 2)];
    draw(&balls.map(ball), &mut framebuffer, false)?;
    Ok(framebuffer.color(0).clone())
}

#[allow(dead_code, reason = "tests include this file")]
fn main() -> std::result::Result<(), Box<dyn std::error::Error>> {
    Ok(steradian_image::write("icosphere_lod.png".as_ref(), &picture()?.to_image()?, &Default::default())?)
}
