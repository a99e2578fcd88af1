//! The graphics pipeline: frames of what pipelines are measured by, in CPU seconds.

use crate::{
    clock,
    report::{Report, Table},
};
use serde_json::json;
use std::error::Error;
use steradian_raster::{
    Counters, Draw, Extent, Format, Fragment, Framebuffer, Pipeline, Program, State, Vertex, VertexInput, fragment,
    glam::{Vec2, Vec3, Vec4},
    stages::DepthOnly,
    state::{DepthState, Multisample},
    texture::{Lod, Sampler, Texture},
    varyings,
};

varyings! {
    struct Surface {
        normal: Vec3,
        uv: Vec2,
    }
}

/// Frames of each row; the middle one counts.
const FRAMES: usize = 5;

/// A grid of triangles over the picture, with hills as depth.
struct Grid {
    points: Vec<Vec3>,
    indices: Vec<u32>,
}

impl Grid {
    fn new(columns: u32, rows: u32) -> Self {
        let mut points = Vec::new();
        for (y, x) in (0..=rows).flat_map(|y| (0..=columns).map(move |x| (y, x))) {
            let at = Vec2::new(x as f32 / columns as f32, y as f32 / rows as f32) * 2.0 - 1.0;
            points.push(at.extend(0.5 + 0.2 * (7.0 * at.x).sin() * (5.0 * at.y).cos()));
        }
        let mut indices = Vec::new();
        for (y, x) in (0..rows).flat_map(|y| (0..columns).map(move |x| (y, x))) {
            let a = y * (columns + 1) + x;
            let c = a + columns + 1;
            indices.extend([a, a + 1, c + 1, a, c + 1, c]);
        }
        Self { points, indices }
    }
}

/// Measures each kind of frame.
pub fn measure(report: &mut Report) -> Result<(), Box<dyn Error>> {
    let columns = ["row", "frame CPU ms", "frames per CPU s", "M triangles per CPU s", "M fragments per CPU s"];
    let mut table = Table::new("Graphics pipeline, 1920 x 1080", &columns);
    table.note(format!("The middle of {FRAMES} frames, clearing included, CPU time of all threads."));
    let extent = Extent::new(1920, 1080);
    let small = Grid::new(1000, 500);
    let large = Grid::new(4, 2);
    let board: Vec<Vec4> = (0..512 * 512u32).map(|i| Vec4::splat(((i % 512 / 32 + i / 512 / 32) % 2) as f32)).collect();
    let texture = Texture::from_colors(Format::Rgba8Unorm, 512, 512, &board, true)?;
    let sampler = Sampler::default();
    let lit = |f: &Fragment<Surface>| {
        let light = f.varyings().normal.normalize().dot(Vec3::new(0.36, 0.48, 0.8)).max(0.0);
        Vec4::new(light, light, light, 1.0)
    };
    let textured = |f: &Fragment<Surface>| {
        let lod = Lod::Gradients(f.dx(|v| v.uv).extend(0.0), f.dy(|v| v.uv).extend(0.0));
        sampler.sample(&texture.view(), f.varyings().uv.extend(0.0).extend(0.0), lod)
    };
    let phong = |f: &Fragment<Surface>| {
        let n = f.varyings().normal.normalize();
        let (to_light, to_eye) = (Vec3::new(0.36, 0.48, 0.8), Vec3::Z);
        let mirrored = 2.0 * n.dot(to_light) * n - to_light;
        let shine = mirrored.dot(to_eye).max(0.0).powi(32);
        (Vec3::new(0.6, 0.3, 0.2) * n.dot(to_light).max(0.0) + shine).extend(1.0)
    };
    row(&mut table, "1 M small triangles", extent, &small, 1, fragment(lit))?;
    row(&mut table, "large triangles, 10 layers back to front", extent, &large, 10, fragment(lit))?;
    row(&mut table, "large triangles, trilinear texture", extent, &large, 1, fragment(textured))?;
    row(&mut table, "1 M small triangles, depth only", extent, &small, 1, DepthOnly::<Surface>::new())?;
    row(&mut table, "100 k triangles, Phong", extent, &Grid::new(316, 158), 1, fragment(phong))?;
    row(&mut table, "100 k triangles, 4 samples", extent.samples(4), &Grid::new(316, 158), 1, fragment(lit))?;
    report.add(table);
    Ok(())
}

fn row<F>(
    table: &mut Table,
    name: &str,
    extent: Extent,
    grid: &Grid,
    layers: u32,
    shader: F,
) -> Result<(), Box<dyn Error>>
where
    F: steradian_raster::stages::FragmentShader<Varyings = Surface>,
{
    let mut framebuffer = Framebuffer::with_color_and_depth(extent, Format::Rgba8Unorm)?;
    let vertex = |input: VertexInput| {
        let p = grid.points[input.vertex as usize];
        // Later layers lie in front.
        let depth = (p.z + (layers - input.instance) as f32) / (layers + 1) as f32;
        Vertex::new(
            Vec4::new(p.x, p.y, depth, 1.0),
            Surface { normal: Vec3::new(p.x, p.y, 1.0), uv: p.truncate() * 3.0 },
        )
    };
    let state =
        State { depth: Some(DepthState::LESS), multisample: Multisample::samples(extent.samples), ..State::default() };
    let pipeline = Pipeline::new(Program::new(vertex, shader), state, framebuffer.layout())?;
    let draw = Draw::indexed(&grid.indices).instances(0..layers);
    let mut counters = Counters::default();
    let mut seconds = Vec::new();
    for _ in 0..FRAMES {
        let (drawn, time) = clock::timed(|| {
            framebuffer.clear(Vec4::ZERO, 1.0, 0);
            pipeline.draw(&mut framebuffer, &draw)
        });
        counters = drawn?;
        seconds.push(time);
    }
    let time = clock::median(seconds);
    let per_second = |count: u64| json!(count as f64 / time / 1e6);
    table.row(vec![
        json!(name),
        json!(1e3 * time),
        json!(1.0 / time),
        per_second(counters.primitives),
        per_second(counters.fragments),
    ]);
    Ok(())
}
