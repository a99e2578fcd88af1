//! Views that show how a picture comes about rather than the picture.

use steradian_core::{Scene, scene::Shape};
use steradian_math::{Vec3, Vec4};
use steradian_raster::{
    ColorTarget, DepthFormat, DepthTarget, Draw, Extent, Format, Fragment, Framebuffer, Pipeline, Program, State,
    Vertex, VertexInput, fragment,
    stages::DepthOnly,
    state::{BlendEquation, BlendFactor, BlendState, ColorState, Compare, DepthState, PolygonMode, RasterState},
};

use crate::{
    Error,
    draw_list::DrawList,
    options::{Options, Show},
    projection::Projected,
    shadow::{Casters, Eye, Shadowing, has_maps, has_sharp_light, stencil_counts},
    visibility::{Seen, fill_depths},
};

/// The pixels of a view by rows; `None` for views that are made point by point.
///
/// # Errors
/// Views that need a light, or maps, that the scene or the options do not have.
pub fn picture(
    scene: &Scene,
    list: &DrawList,
    eye: &Eye,
    options: &Options,
    shadows: &Shadowing,
) -> Result<Option<Vec<Vec3>>, Error> {
    let projected = eye.projected;
    Ok(Some(match options.show {
        Show::Overdraw => overdraw(scene, list, projected)?.into_iter().map(|n| heat(n / 12.0)).collect(),
        Show::Wireframe => wireframe(scene, list, eye)?,
        Show::Tiles => {
            let (extent, counts) = tiles(scene, list, projected)?;
            // One colour for each tile, by the logarithm of its list; borders are darker.
            let columns = extent.width.div_ceil(TILE);
            let pixel = |(x, y): (u32, u32)| {
                let count = counts[(y / TILE * columns + x / TILE) as usize];
                let border = if x % TILE == 0 || y % TILE == 0 { 0.5 } else { 1.0 };
                heat((1.0 + count as f32).log2() / 14.0) * border
            };
            (0..extent.height).flat_map(|y| (0..extent.width).map(move |x| (x, y))).map(pixel).collect()
        }
        Show::Stencil => {
            let casters = Casters::all(scene, list)?;
            let counts = stencil_counts(scene, &casters, eye)?;
            counts.ok_or_else(no_sharp_light)?.into_iter().map(|n| heat(f32::from(n) / 8.0)).collect()
        }
        Show::ShadowMap => {
            let (extent, _) = projected.frame(scene);
            shadows.maps_side_by_side([extent.width, extent.height]).ok_or_else(no_maps)?
        }
        _ => return Ok(None),
    }))
}

/// Checks that a scene has what a view needs.
///
/// # Errors
/// What it needs.
pub(crate) fn check(scene: &Scene, options: &Options) -> Result<(), Error> {
    match options.show {
        Show::Stencil if !has_sharp_light(scene) => Err(no_sharp_light()),
        Show::ShadowMap if !has_maps(scene, options) => Err(no_maps()),
        _ => Ok(()),
    }
}

fn no_sharp_light() -> Error {
    Error::Option("show=stencil needs a point, a spot or parallel light in the scene".into())
}

fn no_maps() -> Error {
    let wanted = "shadows=map, cube, trapezoid, perspective, cascades or pcss, and a light that has maps then";
    Error::Option(format!("show=shadow-map needs {wanted}"))
}

/// Side of the pipeline's tiles in pixels.
const TILE: u32 = 64;

/// Black, red, yellow, white from 0 to 1.
fn heat(share: f32) -> Vec3 {
    (Vec3::splat(3.0 * share) - Vec3::new(0.0, 1.0, 2.0)).clamp(Vec3::ZERO, Vec3::ONE)
}

/// Colour of the clip planes that a triangle's corners are beyond: grey if none, red the near plane, green the sides;
/// dark grey for other shapes.
pub(crate) fn clipping(scene: &Scene, list: &DrawList, projected: &Projected, item: u32, seen: &Seen) -> Vec3 {
    let item = &list.items[item as usize];
    let Shape::Mesh(mesh) = &list.geometry(scene, item).shape else { return Vec3::splat(0.2) };
    let place = item.place(scene);
    let corners = mesh.corners(seen.hit.id.prim).map(|p| projected.clip(place.point(p)));
    let any = |out: fn(&Vec4) -> bool| corners.iter().any(out);
    // The tests of homogeneous clipping, one half-space for each plane.
    let near = any(|c| c.w <= 0.0 || c.z > c.w);
    let sides = any(|c| c.w <= 0.0 || c.x.abs() > c.w || c.y.abs() > c.w);
    Vec3::new(if near { 1.0 } else { 0.35 }, if sides { 0.9 } else { 0.35 }, 0.35)
}

/// The triangles of meshes as the pipeline draws them.
fn triangles(scene: &Scene, list: &DrawList, projected: &Projected) -> Result<Vec<Vec4>, Error> {
    let casters = Casters::all(scene, list)?;
    Ok(casters.triangles.iter().flatten().map(|p| projected.clip(*p)).collect())
}

/// Number of mesh triangles that cover each pixel, by rows.
///
/// # Errors
/// Those of the pipeline, and more than 119 million triangles.
pub fn overdraw(scene: &Scene, list: &DrawList, projected: &Projected) -> Result<Vec<f32>, Error> {
    let corners = triangles(scene, list, projected)?;
    let (extent, viewport) = projected.frame(scene);
    let mut target = Framebuffer::new(vec![ColorTarget::new(extent, Format::R32Float)?], None, None)?;
    target.clear(Vec4::ZERO, 0.0, 0);
    // Additive blending without a depth test counts the fragments of each pixel.
    let add = BlendState::new(BlendEquation::Add, BlendFactor::One, BlendFactor::One);
    let color = vec![ColorState { blend: Some(add), ..ColorState::default() }];
    let state = State { color, viewports: vec![viewport], ..State::default() };
    let vertex = |input: VertexInput| Vertex::new(corners[input.vertex as usize], ());
    let program = Program::new(vertex, fragment(|_: &Fragment<()>| Vec4::ONE));
    Pipeline::new(program, state, target.layout())?.draw(&mut target, &Draw::vertices(0..corners.len() as u32))?;
    let bytes = target.color(0).to_bytes(0);
    Ok(bytes.chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect())
}

/// Number of mesh triangles that each tile of 64² pixels lists, by rows; and the size of the picture.
///
/// # Errors
/// Those of the pipeline, and more than 119 million triangles.
pub fn tiles(scene: &Scene, list: &DrawList, projected: &Projected) -> Result<(Extent, Vec<u64>), Error> {
    let corners = triangles(scene, list, projected)?;
    let (extent, viewport) = projected.frame(scene);
    let target = Framebuffer::with_depth(extent)?;
    // Bin only: the lists of the tiles tell how uneven the load is.
    let state = State { depth: Some(DepthState::GREATER), viewports: vec![viewport], ..State::default() };
    let vertex = |input: VertexInput| Vertex::new(corners[input.vertex as usize], ());
    let pipeline = Pipeline::new(Program::new(vertex, DepthOnly::default()), state, target.layout())?;
    Ok((extent, pipeline.tile_counts(extent, &Draw::vertices(0..corners.len() as u32))))
}

/// The edges of triangles that are seen.
fn wireframe(scene: &Scene, list: &DrawList, eye: &Eye) -> Result<Vec<Vec3>, Error> {
    let corners = triangles(scene, list, eye.projected)?;
    let (extent, viewport) = eye.projected.frame(scene);
    let colors = vec![ColorTarget::new(extent, Format::R8Unorm)?];
    let mut target = Framebuffer::new(colors, Some(DepthTarget::new(extent, DepthFormat::Float32)?), None)?;
    target.clear(Vec4::ZERO, 0.0, 0);
    // A little behind what is seen: lines have other depths than what they border.
    let behind: Vec<f32> = eye.visibility.depths.iter().map(|depth| depth * 0.998).collect();
    fill_depths(&mut target, &behind)?;
    let depth = Some(DepthState { compare: Compare::Greater, write: false });
    let raster = RasterState { polygon_mode: PolygonMode::Line, ..RasterState::default() };
    let state = State { depth, raster, viewports: vec![viewport], ..State::default() };
    let vertex = |input: VertexInput| Vertex::new(corners[input.vertex as usize], ());
    let program = Program::new(vertex, fragment(|_: &Fragment<()>| Vec4::ONE));
    Pipeline::new(program, state, target.layout())?.draw(&mut target, &Draw::vertices(0..corners.len() as u32))?;
    let shown = target.color(0).to_bytes(0).into_iter().zip(&eye.visibility.depths);
    Ok(shown
        .map(|(line, depth)| Vec3::splat(if line > 0 { 1.0 } else { f32::from(u8::from(*depth > 0.0)) * 0.04 }))
        .collect())
}
