//! Shadows on planes (Blinn 1988, "Me and My (Fake) Shadow"): what lies between a light and a plane is projected to it
//! and drawn there.

use steradian_accel::WORLD;
use steradian_core::{Scene, scene::Shape};
use steradian_math::{Vec3, Vec4};
use steradian_raster::{
    ColorTarget, Draw, Format, Fragment, Framebuffer, Pipeline, Program, State, Vertex, VertexInput, fragment,
    state::RasterState, varyings,
};

use super::{Eye, Source, casters::Casters};
use crate::{
    Error,
    draw_list::{DrawList, Item},
};

varyings! {
    /// Signed distances from the plane of the receiver, towards the light: of a point above the plane, and below the
    /// light.
    struct Between {
        above: f32 => clip,
        below_light: f32 => clip,
    }
}

/// Which pixels see a plane in shadow.
#[derive(Debug)]
pub struct Planar {
    dark: Vec<bool>,
}

impl Planar {
    /// Projects the casters to all flat meshes and planes that the eye sees.
    pub fn new(scene: &Scene, list: &DrawList, casters: &Casters, source: Source, eye: &Eye) -> Result<Self, Error> {
        let pixels = (scene.film().crop.width() * scene.film().crop.height()) as usize;
        // Receivers are the flat items that the eye sees.
        let seen: Vec<Option<u32>> = (0..pixels).map(|pixel| eye.visibility.item(pixel)).collect();
        let mut receivers: Vec<u32> = seen.iter().flatten().copied().collect();
        receivers.sort_unstable();
        receivers.dedup();
        let mut dark = vec![false; pixels];
        for receiver in receivers {
            let Some(plane) = plane(scene, &list.items[receiver as usize]) else { continue };
            let covered = project(scene, casters, source, eye, receiver, plane)?;
            let on_it = seen.iter().map(|item| *item == Some(receiver));
            dark.iter_mut().zip(on_it.zip(covered)).for_each(|(dark, (on_it, covered))| *dark |= on_it && covered);
        }
        Ok(Self { dark })
    }

    /// Visibility of the light from the visible point of a pixel: 1 lit, 0 dark.
    pub fn lit(&self, pixel: usize) -> f32 {
        if self.dark[pixel] { 0.0 } else { 1.0 }
    }
}

/// Unit normal and a point of the plane that all of an item lies in.
fn plane(scene: &Scene, item: &Item) -> Option<(Vec3, Vec3)> {
    let place = item.place(scene);
    let in_world = |p: Vec3| if item.instance == WORLD { p } else { place.point(p) };
    match &scene.geometries()[item.geometry as usize].shape {
        Shape::Mesh(mesh) => {
            let corners = || (0..mesh.triangles.len() as u32).flat_map(|t| mesh.corners(t)).map(in_world);
            let start = corners().next()?;
            let area = |t: u32| {
                let [a, b, c] = mesh.corners(t).map(in_world);
                (b - a).cross(c - a)
            };
            // The normal of the largest triangle is the best known. The item is a plane if all corners lie in it within
            // rounding.
            let largest =
                (0..mesh.triangles.len() as u32).map(area).max_by(|a, b| a.length().total_cmp(&b.length()))?;
            let n = largest.try_normalize()?;
            let size = corners().fold(0f32, |size, p| size.max((p - start).length()));
            corners().all(|p| (p - start).dot(n).abs() <= 1e-5 * size).then_some((n, start))
        }
        Shape::Plane(plane) => Some((plane.n, plane.n * -plane.d)),
        _ => None,
    }
}

/// The pixels that the shadow of all casters but the receiver falls on, on its plane.
fn project(
    scene: &Scene,
    casters: &Casters,
    source: Source,
    eye: &Eye,
    receiver: u32,
    (n, start): (Vec3, Vec3),
) -> Result<Vec<bool>, Error> {
    // The normal towards the light.
    let side = match source {
        Source::At(place) => n.dot(place - start),
        Source::From(wi) => n.dot(wi),
    };
    // Only the part above the plane, on the light's side, casts a shadow on it.
    let n = if side < 0.0 { -n } else { n };
    let (_, radius) = crate::extent(scene);
    let least = 1e-5 * radius;
    // Draw the projected casters as the eye sees them, clipped to what lies between light and receiver.
    let (extent, viewport) = eye.projected.frame(scene);
    let mut target = Framebuffer::new(vec![ColorTarget::new(extent, Format::R8Unorm)?], None, None)?;
    target.clear(Vec4::ZERO, 0.0, 0);
    let chosen = || (0..casters.triangles.len()).filter(|&t| casters.items[t] != receiver);
    let corners: Vec<Vec3> = chosen().flat_map(|t| casters.triangles[t]).collect();
    let vertex = |input: VertexInput| {
        let p = corners[input.vertex as usize];
        let above = n.dot(p - start);
        // Along the ray from the light, to the plane; weights instead of divisions, so that what is beyond the light is
        // cut first.
        let (on_plane, below_light) = match source {
            // The ray from the light l at height h through p at height a meets the plane at (h p − a l)/(h − a).
            Source::At(place) => {
                let height = n.dot(place - start);
                ((p * height - place * above).extend(height - above), height - above - least)
            }
            Source::From(wi) => ((p * n.dot(wi) - wi * above).extend(n.dot(wi)), 1.0),
        };
        Vertex::new(eye.projected.clip_homogeneous(on_plane), Between { above: above - least, below_light })
    };
    // Neither depth test nor depth clip: the shadow is asked for at pixels that see the receiver only. Clip distances
    // cut casters below the plane and beyond the light.
    let raster = RasterState { depth_clip: false, ..RasterState::default() };
    let state = State { raster, viewports: vec![viewport], ..State::default() };
    let shader = fragment(|_: &Fragment<Between>| Vec4::ONE);
    let pipeline = Pipeline::new(Program::new(vertex, shader), state, target.layout())?;
    pipeline.draw(&mut target, &Draw::vertices(0..corners.len() as u32))?;
    Ok(target.color(0).to_bytes(0).into_iter().map(|byte| byte > 0).collect())
}
