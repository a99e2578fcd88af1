//! A forest of 16 bytes for each tree: task groups let trees grow, the nearer the finer, and mesh groups make a branch
//! each.

use steradian_raster::{
    ColorTarget, Extent, Format, Fragment, Framebuffer, Invocation, Result, State, fragment,
    glam::{Mat4, Quat, Vec3, Vec4},
    mesh_shading::{
        MeshCounters, MeshOutput, MeshPipeline, MeshPrimitive, MeshProgram, MeshShader, MeshVertex, TaskOutput,
        TaskShader,
    },
    state::DepthState,
    varyings,
};

varyings! {
    /// Input of the fragment shader.
    pub struct Bark {
        color: Vec3 => flat,
    }
}

/// Position of a tree's root (y up, camera space), and its height.
#[derive(Clone, Copy, Debug, Default)]
pub struct Tree {
    root: Vec3,
    height: f32,
}

/// Largest number of forks of the trunk: 2⁸ − 1 branches.
pub const MOST_FORKS: u32 = 7;

/// Each group lets a tree grow: it emits a group for each branch, of which a distant tree has few.
struct Grow<'a>(&'a [Tree]);

impl TaskShader for Grow<'_> {
    type Payload = Tree;
    type Shared = ();
    type Private = ();
    const LOCAL_SIZE: [u32; 3] = [1; 3];
    fn shade(&self, _: u32, at: Invocation, (): &mut (), (): &mut (), out: &mut TaskOutput<Tree>) {
        let tree = self.0[at.group[0] as usize];
        out.payload = tree;
        let halvings = (-tree.root.z / 4.0).max(1.0).to_bits() >> 23; // floor(log₂) + 127
        out.emit([(1 << (MOST_FORKS + 1 - (halvings - 127).min(MOST_FORKS))) - 1, 1, 1]);
    }
}

/// Branch `n` forks into 2n and 2n + 1; the trunk is 1. Each is a prism of four sides.
struct Branch;

impl MeshShader for Branch {
    type Payload = Tree;
    type Shared = Mat4;
    type Private = ();
    type Vertex = ();
    type Primitive = Vec3;
    type Corners = [u8; 3];
    type Varyings = Bark;
    const LOCAL_SIZE: [u32; 3] = [8, 1, 1];
    const PHASES: u32 = 2;
    const MAX_VERTICES: usize = 8;
    const MAX_PRIMITIVES: usize = 8;
    fn shade(
        &self,
        phase: u32,
        at: Invocation,
        tree: &Tree,
        (): &mut (),
        placed: &mut Mat4,
        out: &mut MeshOutput<(), Vec3, [u8; 3]>,
    ) {
        let number = at.group[0] + 1;
        if phase == 0 {
            // The first invocation finds the branch's place for all of them: from the trunk fork by fork.
            if at.index == 0 {
                let turn = |x: f32, y: f32, z: f32, w: f32| {
                    let length = (x * x + y * y + z * z + w * w).sqrt();
                    Mat4::from_quat(Quat::from_xyzw(x / length, y / length, z / length, w / length))
                };
                let fork = [turn(0.0, 4.0, 3.0, 9.0), turn(1.0, 5.0, -3.0, 7.0)];
                *placed = Mat4::from_translation(tree.root) * Mat4::from_scale(Vec3::splat(0.35 * tree.height));
                for bit in (0..number.ilog2()).rev() {
                    let shrunk = Mat4::from_scale(Vec3::splat(0.74)) * fork[(number >> bit & 1) as usize];
                    *placed = *placed * Mat4::from_translation(Vec3::Y) * shrunk;
                }
            }
            return;
        }
        out.set_counts(8, 8);
        let i = at.index;
        let (side, top) = (i % 4, i / 4);
        let radius = if top == 1 { 0.06 } else { 0.08 };
        let [x, z] = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]][side as usize];
        let p = *placed * Vec4::new(radius * x, top as f32, radius * z, 1.0);
        out.vertex(i as usize, MeshVertex::new(Vec4::new(1.5 * p.x, 1.5 * p.y, -p.z - 0.5, -p.z), ()));
        let [a, b] = [side as u8, (side as u8 + 1) % 4];
        let corners = if top == 0 { [a, a + 4, b] } else { [b, a + 4, b + 4] };
        let green = number.ilog2() as f32 / MOST_FORKS as f32;
        let color = Vec3::new(0.45, 0.3, 0.15).lerp(Vec3::new(0.2, 0.6, 0.15), green) * (1.0 - 0.15 * side as f32);
        out.primitive(i as usize, MeshPrimitive::new(corners, color));
    }
    fn varyings((): &(), color: &Vec3) -> Bark {
        Bark { color: *color }
    }
}

/// Trees in rows.
pub fn forest() -> Vec<Tree> {
    let tree = |i: u32| {
        let (column, row, noise) = (i % 16, i / 16, i.wrapping_mul(2_654_435_761) >> 24);
        let x = (column as f32 - 7.5) * 1.6 + noise as f32 / 256.0;
        Tree { root: Vec3::new(x, -1.2, -3.0 - 1.7 * row as f32), height: 1.2 + noise as f32 / 512.0 }
    };
    (0..256).map(tree).collect()
}

/// Draws trees.
pub fn draw(trees: &[Tree], framebuffer: &mut Framebuffer) -> Result<MeshCounters> {
    let shader = fragment(|f: &Fragment<Bark>| f.varyings().color.extend(1.0));
    let state = State { depth: Some(DepthState::LESS), ..State::default() };
    let program = MeshProgram::new(Branch, shader).task(Grow(trees));
    MeshPipeline::new(program, state, framebuffer.layout())?.draw(framebuffer, [trees.len() as u32, 1, 1])
}

/// The forest.
pub fn picture() -> Result<ColorTarget> {
    let mut framebuffer = Framebuffer::with_color_and_depth(Extent::new(480, 320), Format::Rgba8Unorm)?;
    framebuffer.clear(Vec4::new(0.7, 0.8, 0.95, 1.0), 1.0, 0);
    draw(&forest(), &mut framebuffer)?;
    Ok(framebuffer.color(0).clone())
}

#[allow(dead_code, reason = "tests include this file")]
fn main() -> std::result::Result<(), Box<dyn std::error::Error>> {
    Ok(steradian_image::write("forest.png".as_ref(), &picture()?.to_image()?, &Default::default())?)
}
