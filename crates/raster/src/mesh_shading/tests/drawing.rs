use glam::{Mat4, Vec3, Vec4};

use super::shapes::{Mesh, Random, icosphere, soup, torus};
use crate::{
    ColorTarget, Counters, DepthFormat, DepthTarget, Draw, Extent, Format, Fragment, Framebuffer, Invocation, Pipeline,
    Program, State, Vertex, VertexInput, fragment,
    mesh_shading::{
        MeshOutput, MeshPipeline, MeshPrimitive, MeshProgram, MeshShader, MeshVertex, MeshletLimits, Meshlets,
    },
    state::{BlendState, ColorState, DepthState, Provoking},
    varyings,
};

varyings! {
    /// Fragment input of a meshlet's triangle.
    pub struct Seen {
        pub position: Vec3,
        pub vertex: u32 => flat,
        pub meshlet: u32 => flat,
    }
}

/// Draws meshlets: 32 invocations write the vertices and primitives of one.
pub struct DrawMeshlets<'a> {
    pub positions: &'a [Vec3],
    pub meshlets: &'a Meshlets,
    pub clip_from_object: Mat4,
}

impl MeshShader for DrawMeshlets<'_> {
    type Payload = ();
    type Shared = ();
    type Private = ();
    type Vertex = (Vec3, u32);
    type Primitive = u32;
    type Corners = [u8; 3];
    type Varyings = Seen;
    const LOCAL_SIZE: [u32; 3] = [32, 1, 1];
    const MAX_VERTICES: usize = 64;
    const MAX_PRIMITIVES: usize = 126;

    fn shade(
        &self,
        _: u32,
        at: Invocation,
        (): &(),
        (): &mut (),
        (): &mut (),
        out: &mut MeshOutput<(Vec3, u32), u32, [u8; 3]>,
    ) {
        self.put_out(at.group[0], at, out);
    }

    fn varyings(&(position, vertex): &(Vec3, u32), &meshlet: &u32) -> Seen {
        Seen { position, vertex, meshlet }
    }
}

impl DrawMeshlets<'_> {
    /// Writes what an invocation has to of a meshlet.
    pub fn put_out(&self, number: u32, at: Invocation, out: &mut MeshOutput<(Vec3, u32), u32, [u8; 3]>) {
        let meshlet = &self.meshlets.meshlets()[number as usize];
        let (vertices, triangles) = (meshlet.vertices(), meshlet.triangles());
        out.set_counts(vertices.len(), triangles.len());
        for i in (at.index as usize..vertices.len()).step_by(32) {
            let vertex = self.meshlets.vertices()[vertices.start + i];
            let position = self.positions[vertex as usize];
            out.vertex(i, MeshVertex::new(self.clip_from_object * position.extend(1.0), (position, vertex)));
        }
        for i in (at.index as usize..triangles.len()).step_by(32) {
            let corners = self.meshlets.triangles()[triangles.start + i];
            let id = (triangles.start + i) as u32;
            out.primitive(i, MeshPrimitive { id, ..MeshPrimitive::new(corners, number) });
        }
    }
}

/// Colour of 32-bit floats and depth.
pub fn framebuffer(extent: Extent) -> Framebuffer {
    let color = ColorTarget::new(extent, Format::Rgba32Float).unwrap();
    let mut framebuffer =
        Framebuffer::new(vec![color], Some(DepthTarget::new(extent, DepthFormat::Float32).unwrap()), None).unwrap();
    framebuffer.clear(Vec4::new(0.25, 0.5, 0.75, 1.0), 1.0, 0);
    framebuffer
}

/// Colours and depths of all layers and samples.
pub fn bits(framebuffer: &Framebuffer) -> Vec<u32> {
    let Extent { width, height, layers, samples } = framebuffer.extent();
    let mut bits = Vec::new();
    for (layer, sample) in (0..layers).flat_map(|l| (0..samples).map(move |s| (l, s))) {
        for pixel in (0..height).flat_map(|y| (0..width).map(move |x| [x, y])) {
            let color = framebuffer.color(0).sample(pixel, layer, sample).unwrap();
            bits.extend(color.to_array().map(f32::to_bits));
            bits.push(framebuffer.depth().unwrap().sample(pixel, layer, sample).unwrap().to_bits());
        }
    }
    bits
}

/// Everything that a fragment sees, mixed into a colour.
pub fn look(f: &Fragment<Seen>) -> Vec4 {
    look_at(f, f.varyings().meshlet)
}

fn look_at(f: &Fragment<Seen>, meshlet: u32) -> Vec4 {
    let Seen { position, vertex, .. } = *f.varyings();
    let noise = |i: u32| (i.wrapping_mul(2_654_435_761) >> 8) as f32 / (1 << 24) as f32;
    let ids = Vec3::new(noise(vertex), noise(meshlet), noise(f.primitive_id()));
    (0.5 * position + ids + 0.1 * f.dx(|v| v.position)).extend(0.4)
}

/// A camera at `eye` that looks at a point, z up, with depths from 0 at 0.1 to 1 at 20.
pub fn view(eye: Vec3, at: Vec3) -> Mat4 {
    let back = (eye - at).normalize();
    let right = Vec3::Z.cross(back).normalize();
    let rotation =
        Mat4::from_cols(right.extend(0.0), back.cross(right).extend(0.0), back.extend(0.0), Vec4::W).transpose();
    let (near, far, focal) = (0.1, 20.0, 2.0);
    let depth = far / (near - far);
    let clip_from_camera = Mat4::from_cols(
        Vec4::X * focal,
        Vec4::Y * focal,
        Vec4::new(0.0, 0.0, depth, -1.0),
        Vec4::new(0.0, 0.0, near * depth, 0.0),
    );
    clip_from_camera * rotation * Mat4::from_translation(-eye)
}

/// Eye point of the views; some of the meshes are cut by the picture's borders and the near plane.
const EYE: Vec3 = Vec3::new(1.4, 0.9, 0.7);

/// Draws a mesh through its meshlets, with this number of threads.
fn through_meshlets(
    mesh: &Mesh,
    meshlets: &Meshlets,
    state: &State,
    extent: Extent,
    threads: usize,
) -> (Vec<u32>, Counters) {
    let shader = DrawMeshlets { positions: &mesh.positions, meshlets, clip_from_object: view(EYE, Vec3::ZERO) };
    let mut framebuffer = framebuffer(extent);
    let pipeline =
        MeshPipeline::new(MeshProgram::new(shader, fragment(look)), state.clone(), framebuffer.layout()).unwrap();
    let groups = [meshlets.meshlets().len() as u32, 1, 1];
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let counters = pool.install(|| pipeline.draw(&mut framebuffer, groups)).unwrap();
    assert_eq!(
        counters,
        crate::mesh_shading::MeshCounters { rasterized: counters.rasterized, ..pipeline.count(groups).unwrap() }
    );
    assert_eq!((counters.task_groups, counters.mesh_groups), (0, u64::from(groups[0])));
    assert_eq!(counters.vertices, meshlets.vertices().len() as u64);
    assert_eq!(counters.primitives, meshlets.triangles().len() as u64);
    (bits(&framebuffer), counters.rasterized)
}

/// Draws the same triangles in the same order with indices.
fn with_indices(mesh: &Mesh, meshlets: &Meshlets, state: &State, extent: Extent) -> (Vec<u32>, Counters) {
    let (matrix, indices) = (view(EYE, Vec3::ZERO), meshlets.to_indices());
    let of_triangle: Vec<u32> =
        meshlets.meshlets().iter().enumerate().flat_map(|(i, m)| m.triangles().map(move |_| i as u32)).collect();
    let vertex = |input: VertexInput| {
        let position = mesh.positions[input.vertex as usize];
        Vertex::new(matrix * position.extend(1.0), Seen { position, vertex: input.vertex, meshlet: 0 })
    };
    let shader = fragment(|f: &Fragment<Seen>| look_at(f, of_triangle[f.primitive_id() as usize]));
    let mut framebuffer = framebuffer(extent);
    let pipeline = Pipeline::new(Program::new(vertex, shader), state.clone(), framebuffer.layout()).unwrap();
    let counters = pipeline.draw(&mut framebuffer, &Draw::indexed(&indices)).unwrap();
    (bits(&framebuffer), Counters { vertices: 0, vertex_shader: 0, ..counters })
}

#[test]
fn mesh_draws_have_the_bits_of_indexed_draws_for_any_number_of_threads() {
    let blended = State { color: vec![ColorState::blended(BlendState::OVER)], ..State::default() };
    let nearest = State { depth: Some(DepthState::LESS), provoking: Provoking::Last, ..State::default() };
    let mut random = Random(9);
    for mesh in [torus(64, 48), icosphere(4), soup(500, 1500, &mut random)] {
        let meshlets = Meshlets::build(&mesh.positions, &mesh.indices, MeshletLimits::default()).unwrap();
        for (state, samples) in [(&blended, 1), (&nearest, 4)] {
            let extent = Extent::new(150, 110).samples(samples);
            let mut state = state.clone();
            state.multisample.count = samples;
            let (expected, counters) = with_indices(&mesh, &meshlets, &state, extent);
            assert!(counters.fragments > 2000 && counters.primitives > 1000);
            for threads in [1, 2, 3, 8] {
                let (found, mesh_counters) = through_meshlets(&mesh, &meshlets, &state, extent, threads);
                assert!(found == expected, "{threads} threads");
                assert_eq!(mesh_counters, counters);
            }
        }
    }
}
