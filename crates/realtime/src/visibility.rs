//! Which primitive each pixel sees.

use rayon::prelude::*;
use steradian_accel::{PrimId, WORLD};
use steradian_core::{
    Scene,
    scene::{Hit, Shape},
};
use steradian_math::{Ray, Vec3};
use steradian_raster::{
    ColorTarget, Counters, DepthFormat, DepthTarget, Draw, Format, Fragment, Framebuffer, Pipeline, Program, State,
    Vertex, VertexInput, fragment,
    glam::{UVec4, Vec4},
    output::WithDepth,
    state::{Compare, Cull, DepthState, FrontFace, RasterState},
};

use crate::{
    Error,
    culling::Selection,
    draw_list::{BOX, DrawList, Item, box_count, part_bounds},
    options::Method,
    order,
    projection::Projected,
};

/// Visible surface of a pixel.
#[derive(Clone, Copy, Debug)]
pub struct Seen {
    /// Hit of the pixel's ray.
    pub hit: Hit,
    /// Number of the primitive among all of the draw list, whatever is drawn of it; larger scenes have some twice.
    pub number: u32,
}

/// A picture of primitives.
#[derive(Debug)]
pub struct Visibility {
    /// Numbers from 1, by rows; 0 where nothing is seen.
    numbers: Vec<u32>,
    /// Reversed depths, by rows.
    pub(crate) depths: Vec<f32>,
    width: u32,
    parts: Parts,
    /// Counters of the pipeline.
    pub counters: Counters,
}

/// Primitives numbered one after the other: triangles of meshes, those of masked meshes, boxes, planes.
#[derive(Debug, Default)]
struct Parts {
    /// Sorted by the numbers of their first parts.
    runs: Vec<Run>,
    count: u32,
    /// Number of all primitives that were offered, drawn or not, modulo 2³².
    offered: u32,
}

/// Consecutive parts of an item.
#[derive(Clone, Copy, Debug)]
struct Run {
    item: u32,
    /// First part within the item.
    part: u32,
    /// Number of the first part.
    first: u32,
    /// Number of the first part among all primitives.
    among_all: u32,
}

impl Parts {
    /// Numbers so many parts of an item; `false` where numbers are used up.
    fn add(&mut self, item: u32, part: u32, count: u32, among_all: u32) -> bool {
        // Three vertices or 36 corners each must be countable, too.
        let Some(end) = self.count.checked_add(count).filter(|&n| n < u32::MAX / 36) else { return false };
        if count > 0 {
            self.runs.push(Run { item, part, first: self.count, among_all });
            self.count = end;
        }
        true
    }

    /// The run of a number.
    #[inline]
    fn run(&self, number: u32) -> Option<&Run> {
        // Binary search: the last run that begins at or before the number.
        Some(&self.runs[self.runs.partition_point(|run| run.first <= number).checked_sub(1)?])
    }

    /// The item and its part of a number.
    #[inline]
    fn find(&self, number: u32) -> Option<(u32, u32)> {
        self.run(number).map(|run| (run.item, run.part + (number - run.first)))
    }

    /// The number among all primitives of a number.
    fn among_all(&self, number: u32) -> Option<u32> {
        self.run(number).map(|run| run.among_all.wrapping_add(number - run.first))
    }
}

impl Visibility {
    /// Draws what the view sees.
    ///
    /// # Errors
    /// More than 119 million primitives in the view, and sizes that the pipeline refuses.
    pub fn draw(scene: &Scene, list: &DrawList, projected: &Projected) -> Result<Self, Error> {
        Self::draw_with(scene, list, projected, Some(Method::ZBuffer))
    }

    /// Draws a selection of what there is.
    ///
    /// # Errors
    /// As [`draw`](Self::draw).
    pub fn draw_selected(
        scene: &Scene,
        list: &DrawList,
        projected: &Projected,
        selection: Selection<'_>,
    ) -> Result<Self, Error> {
        Self::draw_selected_with(scene, list, projected, selection, Some(Method::ZBuffer))
    }

    /// Draws what the view sees, meshes by a method; without one, what is no mesh of whole triangles.
    ///
    /// # Errors
    /// As [`draw`](Self::draw), and more triangles or cuts than the method takes.
    pub fn draw_with(
        scene: &Scene,
        list: &DrawList,
        projected: &Projected,
        method: Option<Method>,
    ) -> Result<Self, Error> {
        Self::draw_selected_with(scene, list, projected, Selection::Items, method)
    }

    /// Draws a selection of what there is, meshes by a method as [`draw_with`](Self::draw_with).
    ///
    /// # Errors
    /// As [`draw_with`](Self::draw_with).
    pub fn draw_selected_with(
        scene: &Scene,
        list: &DrawList,
        projected: &Projected,
        selection: Selection<'_>,
        method: Option<Method>,
    ) -> Result<Self, Error> {
        // The target holds a primitive number and a reversed depth for each pixel (Burns, Hunt 2013). Shading comes
        // later, once for each pixel rather than once for each fragment.
        let (extent, viewport) = projected.frame(scene);
        let colors = vec![ColorTarget::new(extent, Format::R32Uint)?];
        let mut target = Framebuffer::new(colors, Some(DepthTarget::new(extent, DepthFormat::Float32)?), None)?;
        target.clear(Vec4::ZERO, 0.0, 0);
        let state = State { depth: Some(DepthState::GREATER), viewports: vec![viewport], ..State::default() };
        let (parts, counters) = (Parts::default(), Counters::default());
        let mut stage = Stage { scene, list, projected, selection, target, state, parts, counters };
        // Opaque meshes first: they hide most of what needs a fragment shader with an intersection. All passes share
        // the depth buffer, so that their order does not matter for the picture.
        match method {
            None => {}
            Some(Method::ZBuffer) => stage.meshes(false)?,
            Some(method) => stage.ordered(method)?,
        }
        stage.meshes(true)?;
        stage.boxes(false)?;
        stage.boxes(true)?;
        stage.planes()?;
        // Read back, row by row; 0 stands for the background.
        let bytes = stage.target.color(0).to_bytes(0);
        let numbers = bytes.par_chunks_exact(4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect();
        let depths = stage.target.depth().map_or(Vec::new(), |depth| depth.to_rows(0));
        Ok(Self { numbers, depths, width: extent.width, parts: stage.parts, counters: stage.counters })
    }

    /// Number of pixels that see another primitive than in another picture of the same view.
    pub fn differing(&self, other: &Self) -> usize {
        (0..self.numbers.len()).filter(|&pixel| self.part(pixel) != other.part(pixel)).count()
    }

    /// Index in the list of what a pixel sees, and its part.
    pub fn part(&self, pixel: usize) -> Option<(u32, u32)> {
        self.parts.find(self.numbers[pixel].checked_sub(1)?)
    }

    /// Index in the list of what a pixel sees.
    pub(crate) fn item(&self, pixel: usize) -> Option<u32> {
        self.part(pixel).map(|(item, _)| item)
    }

    /// The first pixel of each primitive that is seen, in the order of their numbers.
    pub fn first_pixels(&self) -> Vec<u32> {
        let mut all: Vec<(u32, u32)> =
            (0..).zip(&self.numbers).filter(|(_, n)| **n > 0).map(|(p, n)| (*n, p)).collect();
        all.par_sort_unstable();
        all.dedup_by_key(|(number, _)| *number);
        all.into_iter().map(|(_, pixel)| pixel).collect()
    }

    /// Visible surface of a pixel.
    pub fn seen(&self, scene: &Scene, list: &DrawList, projected: &Projected, at: [u32; 2]) -> Option<Seen> {
        let number = self.numbers[(at[1] * self.width + at[0]) as usize].checked_sub(1)?;
        let (item, part) = self.parts.find(number)?;
        let hit = meet(scene, &list.items[item as usize], part, &projected.ray(scene, at), Border::Included)?;
        Some(Seen { hit, number: self.parts.among_all(number)? })
    }
}

/// Draws these reversed depths, by rows, into a framebuffer of their size.
pub(crate) fn fill_depths(target: &mut Framebuffer, depths: &[f32]) -> Result<(), Error> {
    let width = target.extent().width;
    // One triangle that covers the picture; the fragment shader sets the depth.
    let vertex = |input: VertexInput| {
        let [x, y] = [[-1.0, -1.0], [3.0, -1.0], [-1.0, 3.0]][(input.vertex % 3) as usize];
        Vertex::new(Vec4::new(x, y, 0.5, 1.0), ())
    };
    // A fragment of the box becomes one of the shape: the pixel's ray is intersected, and its depth replaces that of
    // the box.
    let shader = fragment(|f: &Fragment<()>| {
        let [x, y] = f.pixel();
        WithDepth::<()> { output: (), depth: depths.get((y * width + x) as usize).copied().unwrap_or(0.0) }
    });
    let state = State { depth: Some(DepthState { compare: Compare::Always, write: true }), ..State::default() };
    Pipeline::new(Program::new(vertex, shader), state, target.layout())?.draw(target, &Draw::vertices(0..3))?;
    Ok(())
}

/// Treatment of rays that narrowly miss a triangle, as a hit on its border or as none: the pipeline rounds corners to
/// 1/256 pixel.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Border {
    Included,
    Excluded,
}

/// True if the box around an item may be in the view: not if all its corners are outside one plane.
pub(crate) fn in_view(scene: &Scene, projected: &Projected, item: &Item, shape: &Shape) -> bool {
    let bounds = shape.bounds();
    if bounds.is_empty() {
        return true;
    }
    let place = item.place(scene);
    // Outcodes in clip space (Cohen, Sutherland): a plane rejects the box only if it rejects all eight corners.
    let outside = (0..8).fold(!0u32, |all, i| {
        let p = projected.clip(place.point(bounds.corner(i)));
        let planes = [p.x < -p.w, p.x > p.w, p.y < -p.w, p.y > p.w, p.z > p.w];
        all & planes.iter().enumerate().fold(0, |bits, (i, out)| bits | u32::from(*out) << i)
    });
    outside == 0
}

/// Inputs and target of a drawing.
struct Stage<'a> {
    scene: &'a Scene,
    list: &'a DrawList,
    projected: &'a Projected,
    selection: Selection<'a>,
    target: Framebuffer,
    state: State,
    parts: Parts,
    counters: Counters,
}

impl Stage<'_> {
    /// Numbers the parts of items that fit and are selected, and gives the range of numbers.
    fn number(&mut self, count: impl Fn(&Item, &Shape) -> u32) -> Result<(u32, u32), Error> {
        // Continue the numbers where the kind of shape before ended.
        let start = self.parts.count;
        for (i, item) in self.list.items.iter().enumerate() {
            let shape = &self.list.geometry(self.scene, item).shape;
            let count = count(item, shape);
            let among_all = self.parts.offered;
            self.parts.offered = among_all.wrapping_add(count);
            if count == 0 || self.projected.hides(self.list.geometry(self.scene, item)) {
                continue;
            }
            // Number only what is drawn: numbers are limited.
            let in_view = || in_view(self.scene, self.projected, item, shape);
            for (part, count) in self.selection.runs(i, count, in_view) {
                if !self.parts.add(i as u32, part, count, among_all.wrapping_add(part)) {
                    return Err(Error::Scene(
                        "raster draws up to 119 million primitives at once, and more are in the view".into(),
                    ));
                }
            }
        }
        Ok((start, self.parts.count))
    }

    /// Triangles of meshes, those with masks or the others.
    fn meshes(&mut self, masked: bool) -> Result<(), Error> {
        let (scene, list) = (self.scene, self.list);
        let (start, end) = self.number(|item, shape| match shape {
            Shape::Mesh(mesh) if list.geometry(scene, item).is_masked() == masked => mesh.triangles.len() as u32,
            _ => 0,
        })?;
        if start == end {
            return Ok(());
        }
        let Self { projected, parts, target, .. } = self;
        // The vertex shader pulls corners by the number of the vertex; there are no vertex buffers. Corners of
        // world-space meshes are taken as they are, so that a shared edge has the same bits in both triangles.
        let places: Vec<_> = list.items.iter().map(|item| item.place(scene)).collect();
        let vertex = |input: VertexInput| {
            let position = parts.find(start + input.vertex / 3).and_then(|(item, triangle)| {
                let Shape::Mesh(mesh) = &list.geometry(scene, &list.items[item as usize]).shape else { return None };
                let corner = mesh.corners(triangle)[(input.vertex % 3) as usize];
                let corner = if list.items[item as usize].instance == WORLD {
                    corner
                } else {
                    places[item as usize].point(corner)
                };
                Some(projected.clip(corner))
            });
            Vertex::new(position.unwrap_or(Vec4::NAN), ())
        };
        let draw = Draw::vertices(0..3 * (end - start));
        let number = |f: &Fragment<()>| start + f.primitive_id();
        // A mask is evaluated where the pixel's ray meets the triangle, so that it has the bits that a ray tracer
        // finds.
        self.counters += if masked {
            let shader = fragment(|f: &Fragment<()>| {
                let number = number(f);
                let (item, part) = parts.find(number)?;
                let ray = projected.ray(scene, f.pixel());
                let hit = meet(scene, &list.items[item as usize], part, &ray, Border::Included)?;
                opaque(scene, &list.items[item as usize], &hit, &ray).then_some(UVec4::splat(number + 1))
            });
            Pipeline::new(Program::new(vertex, shader), self.state.clone(), target.layout())?.draw(target, &draw)?
        } else {
            let shader = fragment(|f: &Fragment<()>| UVec4::splat(number(f) + 1));
            Pipeline::new(Program::new(vertex, shader), self.state.clone(), target.layout())?.draw(target, &draw)?
        };
        Ok(())
    }

    /// Triangles of meshes without masks by another method than depths. What it finds is put into the depth buffer,
    /// where other shapes meet it.
    fn ordered(&mut self, method: Method) -> Result<(), Error> {
        let (scene, list) = (self.scene, self.list);
        let (start, end) = self.number(|item, shape| match shape {
            Shape::Mesh(mesh) if !list.geometry(scene, item).is_masked() => mesh.triangles.len() as u32,
            _ => 0,
        })?;
        // The methods without depth buffer work on triangles of the world.
        let mut triangles = Vec::with_capacity((end - start) as usize);
        for number in start..end {
            let Some((item, triangle)) = self.parts.find(number) else { continue };
            let item = &list.items[item as usize];
            let Shape::Mesh(mesh) = &list.geometry(scene, item).shape else { continue };
            let place = item.place(scene);
            let in_world = |p| if item.instance == WORLD { p } else { place.point(p) };
            triangles.push((number, mesh.corners(triangle).map(in_world)));
        }
        let (extent, viewport) = self.projected.frame(scene);
        let frame = order::Frame {
            size: [extent.width, extent.height],
            view: [f64::from(viewport.width), f64::from(viewport.height)],
            start: [f64::from(viewport.x), f64::from(viewport.y)],
        };
        let (found, largest) = order::solve(method, &triangles, self.projected, frame)?;
        let Self { state, target, projected, .. } = self;
        // Drawn without a depth test: the order is the result. Depths are written all the same, for other shapes.
        let state = State { depth: Some(DepthState { compare: Compare::Always, write: true }), ..state.clone() };
        self.counters += match found {
            // Back to front. A part of a cut triangle is drawn as the whole triangle, and each pixel decides by the
            // cuts whether it belongs to the part.
            order::Found::Ordered(polygons, space) => {
                let vertex = |input: VertexInput| {
                    let polygon = &polygons[(input.vertex / 3) as usize];
                    let (_, corners) = triangles[(polygon.number - start) as usize];
                    Vertex::new(projected.clip(corners[(input.vertex % 3) as usize]), ())
                };
                let shader = fragment(|f: &Fragment<()>| {
                    let polygon = &polygons[f.primitive_id() as usize];
                    // A piece is drawn as the whole triangle; the cuts decide which pixels are its own.
                    let is_in = polygon.cuts.is_empty()
                        || polygon.has(match space {
                            order::Space::World => {
                                let (_, corners) = triangles[(polygon.number - start) as usize];
                                order::meet(&projected.ray(scene, f.pixel()), corners)
                            }
                            order::Space::Picture => frame.position(f.pixel()).extend(0.0),
                        });
                    is_in.then(|| UVec4::splat(polygon.number + 1))
                });
                let count = u32::try_from(3 * polygons.len())
                    .map_err(|_| Error::Scene("more than 1431 million pieces to draw".into()))?;
                Pipeline::new(Program::new(vertex, shader), state, target.layout())?
                    .draw(target, &Draw::vertices(0..count))?
            }
            // Already by pixels: copied by a triangle that covers the frame.
            order::Found::Painted(painted) => {
                let mut pixels = vec![(0, 0.0); (extent.width * extent.height) as usize];
                for one in painted {
                    let depth = (one.z * largest).clamp(0.0, 1.0) as f32;
                    pixels[(one.pixel[1] * extent.width + one.pixel[0]) as usize] = (one.number + 1, depth);
                }
                let vertex = |input: VertexInput| {
                    let [x, y] = [[-1.0, -1.0], [3.0, -1.0], [-1.0, 3.0]][(input.vertex % 3) as usize];
                    Vertex::new(Vec4::new(x, y, 0.5, 1.0), ())
                };
                let shader = fragment(|f: &Fragment<()>| {
                    let [x, y] = f.pixel();
                    // Helpers may lie beyond the border.
                    let place = (y * extent.width + x) as usize;
                    let (number, depth) = pixels.get(place).copied().filter(|(number, _)| *number > 0)?;
                    Some(WithDepth::<UVec4> { output: UVec4::splat(number), depth })
                });
                let state = State { viewports: Vec::new(), ..state };
                Pipeline::new(Program::new(vertex, shader), state, target.layout())?
                    .draw(target, &Draw::vertices(0..3))?
            }
        };
        Ok(())
    }

    /// Shapes that rays meet in boxes: the far sides of the boxes are drawn, so that the eye may be inside. `mirrored`:
    /// those whose place turns boxes inside out, or the others.
    fn boxes(&mut self, mirrored: bool) -> Result<(), Error> {
        let (scene, list) = (self.scene, self.list);
        let (start, end) = self.number(|item, shape| {
            let turned = item.place(scene).m.determinant() < 0.0;
            if turned == mirrored { box_count(shape).unwrap_or(0) } else { 0 }
        })?;
        if start == end {
            return Ok(());
        }
        let Self { projected, parts, target, .. } = self;
        // A box of twelve triangles around each part.
        let vertex = |input: VertexInput| {
            let position = parts.find(start + input.vertex / 36).map(|(item, part)| {
                let item = &list.items[item as usize];
                let bounds = part_bounds(&list.geometry(scene, item).shape, part);
                let corner = BOX[(input.vertex % 36 / 3) as usize][(input.vertex % 3) as usize];
                projected.clip(item.place(scene).point(bounds.corner(corner)))
            });
            Vertex::new(position.unwrap_or(Vec4::NAN), ())
        };
        // Intersect the shape itself and write its depth; the box only selects pixels.
        let shader = fragment(|f: &Fragment<()>| {
            let number = start + f.primitive_id() / 12;
            let (item, part) = parts.find(number)?;
            let ray = projected.ray(scene, f.pixel());
            let hit = meet(scene, &list.items[item as usize], part, &ray, Border::Excluded)?;
            Some(WithDepth::<UVec4> { output: UVec4::splat(number + 1), depth: projected.depth(ray.at(hit.t)) })
        });
        // Front faces are culled, so that each pixel of the box is shaded once, from inside the box too.
        let turned = projected.is_mirrored() != mirrored;
        let front_face = if turned { FrontFace::Clockwise } else { FrontFace::CounterClockwise };
        let state = State {
            raster: RasterState { cull: Cull::Front, front_face, ..RasterState::default() },
            ..self.state.clone()
        };
        let pipeline = Pipeline::new(Program::new(vertex, shader), state, target.layout())?;
        self.counters += pipeline.draw(target, &Draw::vertices(0..36 * (end - start)))?;
        Ok(())
    }

    /// Infinite planes: each is asked for at every pixel.
    fn planes(&mut self) -> Result<(), Error> {
        let (start, end) = self.number(|_, shape| u32::from(matches!(shape, Shape::Plane(_))))?;
        let Self { scene, list, projected, parts, target, .. } = self;
        for number in start..end {
            let Some((item, part)) = parts.find(number) else { continue };
            let vertex = |input: VertexInput| {
                let [x, y] = [[-1.0, -1.0], [3.0, -1.0], [-1.0, 3.0]][(input.vertex % 3) as usize];
                Vertex::new(Vec4::new(x, y, 0.5, 1.0), ())
            };
            let shader = fragment(|f: &Fragment<()>| {
                // Every pixel intersects its ray with the plane.
                let ray = projected.ray(scene, f.pixel());
                let hit = meet(scene, &list.items[item as usize], part, &ray, Border::Excluded)?;
                Some(WithDepth::<UVec4> { output: UVec4::splat(number + 1), depth: projected.depth(ray.at(hit.t)) })
            });
            let pipeline = Pipeline::new(Program::new(vertex, shader), self.state.clone(), target.layout())?;
            self.counters += pipeline.draw(target, &Draw::vertices(0..3))?;
        }
        Ok(())
    }
}

/// The ray in the space of an item.
pub(crate) fn local(scene: &Scene, item: &Item, ray: &Ray) -> Ray {
    if item.instance == WORLD { *ray } else { item.place(scene).inverse().ray(ray) }
}

/// True if a hit counts, by the opacity of its shape.
fn opaque(scene: &Scene, item: &Item, hit: &Hit, ray: &Ray) -> bool {
    scene.counts(hit, &local(scene, item, ray))
}

/// Intersection of a world-space ray with a part of an item.
pub(crate) fn meet(scene: &Scene, item: &Item, part: u32, ray: &Ray, border: Border) -> Option<Hit> {
    let id = PrimId { instance: item.instance, geom: item.in_group, prim: part };
    let ray = local(scene, item, ray);
    let hit = |h: steradian_accel::UserHit| Hit { t: h.t, u: h.u, v: h.v, id };
    match &scene.geometries()[item.geometry as usize].shape {
        Shape::Mesh(mesh) => triangle(&ray, mesh.corners(part), border).map(|(t, u, v)| Hit { t, u, v, id }),
        // The nearer of two roots may be masked away; then the farther one counts.
        Shape::Quadric(q) => {
            let first = q.intersect(&ray)?;
            if scene.counts(&hit(first), &ray) {
                return Some(hit(first));
            }
            q.intersect_after(&ray, first.t).map(hit).filter(|h| scene.counts(h, &ray))
        }
        Shape::Patches(m) => m.intersect(part, &ray).map(hit).filter(|h| scene.counts(h, &ray)),
        Shape::Curves(c) => c.intersect(part, &ray).map(hit).filter(|h| scene.counts(h, &ray)),
        Shape::Field(f) => f.intersect(part, &ray, |h| scene.counts(&hit(*h), &ray)).map(hit),
        Shape::Sdf(s) => s.intersect(part, &ray, |h| scene.counts(&hit(*h), &ray)).map(hit),
        Shape::Level(l) => l.intersect(&ray, |h| scene.counts(&hit(*h), &ray)).map(hit),
        Shape::Plane(p) => {
            let t = p.intersect(&ray)?;
            // The plane's hits have its geometry for a number.
            let id = PrimId { geom: item.geometry, ..id };
            Some(Hit { t, u: 0.0, v: 0.0, id }).filter(|h| scene.counts(h, &ray))
        }
    }
}

/// Distance and weights of the second and third corner (Möller, Trumbore 1997).
fn triangle(ray: &Ray, [a, b, c]: [Vec3; 3], border: Border) -> Option<(f32, f32, f32)> {
    // Cramer's rule for o + t d = a + u e1 + v e2.
    let (e1, e2) = (b - a, c - a);
    let p = ray.direction.cross(e2);
    let det = e1.dot(p);
    let s = ray.origin - a;
    let q = s.cross(e1);
    let (u, v, t) = (s.dot(p) / det, ray.direction.dot(q) / det, e2.dot(q) / det);
    let is_within = |t: f32| t > 0.0 && t.is_finite() && t < ray.t_max;
    let inside = u >= 0.0 && v >= 0.0 && u + v <= 1.0 && is_within(t);
    if inside {
        return Some((t, u, v));
    }
    if border == Border::Excluded {
        return None;
    }
    // The nearest weights; where the triangle is seen edge on, those of its middle.
    let clamp = |x: f32| if x.is_finite() { x.clamp(0.0, 1.0) } else { 1.0 / 3.0 };
    let (u, v) = (clamp(u), clamp(v));
    let (u, v) = if u + v > 1.0 { (u / (u + v), v / (u + v)) } else { (u, v) };
    // Distance of the closest point of the triangle, along the ray.
    let at = a + e1 * u + e2 * v;
    let t = (at - ray.origin).dot(ray.direction) / ray.direction.length_squared();
    is_within(t).then_some((t, u, v))
}
