use std::sync::atomic::{AtomicBool, Ordering};

use glam::{Mat4, Vec3};

use super::{
    drawing::{DrawMeshlets, Seen, bits, framebuffer, look, view},
    shapes::{Mesh, Random, icosphere, torus},
};
use crate::{
    DepthFormat, DepthTarget, Extent, Invocation, State, fragment,
    mesh_shading::{
        DepthPyramid, Frustum, MeshCounters, MeshOutput, MeshPipeline, MeshProgram, MeshShader, MeshletLimits,
        Meshlets, Sphere, TaskOutput, TaskShader,
    },
    state::{Cull, DepthRange, DepthState, RasterState},
};

/// The meshlets that a task group lets through.
#[derive(Clone, Copy, Default)]
struct Chosen([u32; 32]);

/// Each of 32 invocations looks at one meshlet.
struct CullMeshlets<'a> {
    meshlets: &'a Meshlets,
    frustum: Option<Frustum>,
    eye: Option<Vec3>,
    occlusion: Option<(&'a DepthPyramid, Mat4)>,
    /// Which meshlets are looked at.
    asked: &'a (dyn Fn(usize) -> bool + Sync),
    /// Notes those that were let through.
    passed: &'a [AtomicBool],
}

impl TaskShader for CullMeshlets<'_> {
    type Payload = Chosen;
    type Shared = u32;
    type Private = ();
    const LOCAL_SIZE: [u32; 3] = [32, 1, 1];
    const PHASES: u32 = 2;
    fn shade(&self, phase: u32, at: Invocation, (): &mut (), count: &mut u32, out: &mut TaskOutput<Chosen>) {
        let number = at.global[0] as usize;
        if phase == 1 {
            return out.emit([*count, 1, 1]);
        }
        let Some(meshlet) = self.meshlets.meshlets().get(number) else { return };
        let passes = (self.asked)(number)
            && !self.frustum.is_some_and(|f| f.misses(&meshlet.sphere))
            && !self.eye.is_some_and(|eye| meshlet.cone.faces_away_from(eye))
            && !self.occlusion.is_some_and(|(z, m)| z.hides(&meshlet.sphere, m, DepthRange::ZeroToOne));
        if passes {
            self.passed[number].store(true, Ordering::Relaxed);
            out.payload.0[*count as usize] = number as u32;
            *count += 1;
        }
    }
}

struct DrawChosen<'a>(DrawMeshlets<'a>);

impl MeshShader for DrawChosen<'_> {
    type Payload = Chosen;
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
        chosen: &Chosen,
        (): &mut (),
        (): &mut (),
        out: &mut MeshOutput<(Vec3, u32), u32, [u8; 3]>,
    ) {
        self.0.put_out(chosen.0[at.group[0] as usize], at, out);
    }
    fn varyings(vertex: &(Vec3, u32), meshlet: &u32) -> Seen {
        DrawMeshlets::varyings(vertex, meshlet)
    }
}

/// A wall of rings before a crowd of balls.
fn scene() -> (Mesh, Meshlets) {
    let mut all = Mesh { positions: Vec::new(), indices: Vec::new() };
    let mut add = |mesh: &Mesh, place: &dyn Fn(Vec3) -> Vec3| {
        let first = all.positions.len() as u32;
        all.positions.extend(mesh.positions.iter().map(|&p| place(p)));
        all.indices.extend(mesh.indices.iter().map(|i| i + first));
    };
    let (ring, ball) = (torus(48, 24), icosphere(3));
    for x in -1..=1 {
        // Squeezed until the holes are narrow.
        add(&ring, &|p| Vec3::new(p.y * 1.2 + 1.1 * x as f32, 0.3 * p.z, p.x * 1.2));
    }
    for i in 0..60u8 {
        let [x, y, z] = [i % 5, i / 5 % 4, i / 20].map(f32::from);
        add(&ball, &|p| 0.3 * p + Vec3::new(x - 2.0, 1.0 + y, z - 1.0));
    }
    let limits = MeshletLimits { vertices: 64, triangles: 64 };
    let meshlets = Meshlets::build(&all.positions, &all.indices, limits).unwrap();
    (all, meshlets)
}

fn state() -> State {
    let raster = RasterState { cull: Cull::Back, ..RasterState::default() };
    State { depth: Some(DepthState::LESS), raster, ..State::default() }
}

#[test]
fn mesh_clusters_culled_by_frustum_cone_and_two_passes_of_depths_leave_the_picture_as_it_was() {
    let (mesh, meshlets) = scene();
    let n = meshlets.meshlets().len();
    let groups = [n.div_ceil(32) as u32, 1, 1];
    let extent = Extent::new(200, 160);
    let none = || (0..n).map(|_| AtomicBool::new(false)).collect::<Vec<_>>();
    // What passed both passes of the last picture, which was seen from elsewhere.
    let mut visible_before: Vec<bool> = (0..n).map(|i| i % 7 == 0).collect();
    let mut hidden = 0;
    for step in 0..6u8 {
        let eye = Vec3::new(0.3 * f32::from(step) - 0.8, -2.5 + 0.2 * f32::from(step), 0.4);
        let matrix = view(eye, Vec3::new(0.3, 0.0, 0.1 * f32::from(step)));
        let draw = |task: CullMeshlets, target: &mut crate::Framebuffer| -> MeshCounters {
            let shader =
                DrawChosen(DrawMeshlets { positions: &mesh.positions, meshlets: &meshlets, clip_from_object: matrix });
            let program = MeshProgram::new(shader, fragment(look)).task(task);
            MeshPipeline::new(program, state(), target.layout()).unwrap().draw(target, groups).unwrap()
        };
        let passed = [none(), none(), none()];
        let plain = |asked, passed| CullMeshlets {
            meshlets: &meshlets,
            frustum: None,
            eye: None,
            occlusion: None,
            asked,
            passed,
        };
        let mut reference = framebuffer(extent);
        // All clusters, in the order in which the two passes look at them: of equal depths the first wins.
        let before = |i: usize| visible_before[i];
        let others = |i: usize| !visible_before[i];
        let mut all = draw(plain(&before, &passed[0]), &mut reference);
        all += draw(plain(&others, &passed[0]), &mut reference);
        assert_eq!(all.primitives as usize, mesh.triangles().len());
        // First pass: what was visible before.
        let frustum = Frustum::new(matrix, &state().raster);
        let mut target = framebuffer(extent);
        let first =
            draw(CullMeshlets { frustum: Some(frustum), eye: Some(eye), ..plain(&before, &passed[1]) }, &mut target);
        let pyramid = DepthPyramid::new(target.depth().unwrap(), 0).unwrap();
        let culled_alone = first.mesh_groups as usize;
        let second = draw(
            CullMeshlets {
                frustum: Some(frustum),
                eye: Some(eye),
                occlusion: Some((&pyramid, matrix)),
                ..plain(&others, &passed[2])
            },
            &mut target,
        );
        assert!(bits(&target) == bits(&reference), "step {step}");
        assert!(culled_alone + (second.mesh_groups as usize) < n);
        let not_hidden = |i: usize| passed[1][i].load(Ordering::Relaxed) || passed[2][i].load(Ordering::Relaxed);
        let in_view = meshlets
            .meshlets()
            .iter()
            .enumerate()
            .filter(|(i, m)| !visible_before[*i] && !frustum.misses(&m.sphere) && !m.cone.faces_away_from(eye));
        hidden += in_view.filter(|(i, _)| !not_hidden(*i)).count();
        visible_before = meshlets
            .meshlets()
            .iter()
            .enumerate()
            .map(|(i, m)| {
                not_hidden(i)
                    && !DepthPyramid::new(target.depth().unwrap(), 0).unwrap().hides(
                        &m.sphere,
                        matrix,
                        DepthRange::ZeroToOne,
                    )
            })
            .collect();
    }
    assert!(hidden > n / 6, "depths hide {hidden} of {n} clusters in six pictures");
}

#[test]
fn mesh_frustum_misses_no_sphere_with_a_point_in_view() {
    let mut random = Random(4);
    let (mut missed, mut outside) = (0, 0);
    for i in 0..20_000 {
        let matrix = view(random.point(3.0), random.point(1.0));
        let sphere = Sphere { center: random.point(4.0), radius: random.point(1.0).x.abs() };
        let raster = RasterState { depth_clip: i % 2 == 0, ..RasterState::default() };
        let gone = Frustum::new(matrix, &raster).misses(&sphere);
        let mut any = false;
        for _ in 0..20 {
            let clip = matrix * (sphere.center + random.point(1.0).normalize_or_zero() * sphere.radius).extend(1.0);
            let depth = !raster.depth_clip || (0.0..=clip.w).contains(&clip.z);
            any |= clip.w > 0.0 && clip.x.abs() <= clip.w && clip.y.abs() <= clip.w && depth;
        }
        assert!(!(gone && any));
        missed += usize::from(gone);
        outside += usize::from(!any);
    }
    assert!(missed * 10 > outside * 7, "{missed} of {outside}");
    let endless = Sphere { center: Vec3::MAX, radius: f32::INFINITY };
    assert!(!Frustum::new(view(Vec3::X, Vec3::ZERO), &RasterState::default()).misses(&endless));
    assert!(!Frustum::new(Mat4::NAN, &RasterState::default()).misses(&Sphere { center: Vec3::ZERO, radius: 0.0 }));
}

/// M41: of 10⁶ boxes, half of them along the axes, none with a point in view is missed, and four of five of those
/// without one are.
#[test]
fn mesh_frustum_misses_no_box_with_a_point_in_view() {
    let mut random = Random(41);
    let (mut missed, mut outside) = (0, 0);
    let raster = RasterState::default();
    for _ in 0..1000 {
        let matrix = view(random.point(3.0), random.point(1.0));
        let frustum = Frustum::new(matrix, &raster);
        for i in 0..1000 {
            let (center, size) = (random.point(4.0), random.point(0.7));
            let axes = match i % 2 {
                0 => [Vec3::X * size.x, Vec3::Y * size.y, Vec3::Z * size.z],
                _ => {
                    let z = random.point(1.0).normalize_or(Vec3::Z);
                    let (x, y) = z.any_orthonormal_pair();
                    [x * size.x, y * size.y, z * size.z]
                }
            };
            let gone = frustum.misses_box(center, axes);
            let is_seen = |p: Vec3| {
                let clip = matrix * p.extend(1.0);
                clip.w > 0.0 && clip.x.abs() <= clip.w && clip.y.abs() <= clip.w && (0.0..=clip.w).contains(&clip.z)
            };
            // Corners, the centre, and points between.
            let corner = |k: usize| (0..3).fold(center, |p, a| if k >> a & 1 == 0 { p - axes[a] } else { p + axes[a] });
            let mut any = is_seen(center) || (0..8).any(|k| is_seen(corner(k)));
            for _ in 0..6 {
                let t = random.point(1.0);
                any |= is_seen(center + axes[0] * t.x + axes[1] * t.y + axes[2] * t.z);
            }
            assert!(!(gone && any), "{center} {axes:?}");
            missed += usize::from(gone);
            outside += usize::from(!any);
        }
    }
    assert!(missed * 5 > outside * 4, "{missed} of {outside}");
}

#[test]
fn mesh_depth_pyramid_knows_the_largest_depth() {
    let extent = Extent::new(83, 41);
    let mut depth = DepthTarget::new(extent, DepthFormat::Unorm16).unwrap();
    depth.clear(0.5);
    assert!(DepthPyramid::new(&depth, 1).is_none());
    let pyramid = DepthPyramid::new(&depth, 0).unwrap();
    assert_eq!(pyramid, DepthPyramid::new(&depth, 0).unwrap());
    // Without perspective, a sphere at depth z reaches from z − radius on.
    let at = |x: f32, z: f32, radius: f32| {
        pyramid.hides(&Sphere { center: Vec3::new(x, 0.0, z), radius }, Mat4::IDENTITY, DepthRange::ZeroToOne)
    };
    assert!(at(0.0, 0.9, 0.39) && !at(0.0, 0.9, 0.41) && at(0.9, 0.7, 0.19) && !at(-1.0, 0.4, 0.0));
    // One step of the format is less than can be told.
    assert!(!at(0.0, 0.5 + 1.0 / 65535.0, 0.0) && at(0.0, 0.5 + 3.0 / 65535.0, 0.0));
    assert!(!at(3.0, 0.9, 0.1) && !at(f32::NAN, 0.9, 0.1) && !at(0.0, 0.9, f32::INFINITY));
    let behind =
        Mat4::from_cols_array(&[1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0]);
    assert!(!pyramid.hides(&Sphere { center: Vec3::ZERO, radius: 0.1 }, behind, DepthRange::ZeroToOne));
}
