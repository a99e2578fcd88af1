//! Drawing of the primitives of a scene, kind by kind of shape.

use super::{
    candidate::{Candidate, Take},
    meet::Border,
    parts::Parts,
};
use crate::{
    Error,
    culling::Selection,
    draw_list::{BOX, DrawList, Item, box_count, part_bounds},
    options::Method,
    order,
    projection::Projected,
};
use steradian_accel::WORLD;
use steradian_core::{Scene, scene::Shape};
use steradian_raster::{
    Counters, Draw, Fragment, Framebuffer, Pipeline, Program, State, Vertex, VertexInput, fragment,
    glam::{UVec4, Vec4},
    output::WithDepth,
    state::{Compare, Cull, DepthState, FrontFace, RasterState},
};

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
pub(crate) struct Stage<'a> {
    scene: &'a Scene,
    list: &'a DrawList,
    projected: &'a Projected,
    selection: Selection<'a>,
    pub target: Framebuffer,
    state: State,
    /// Chooses the hits of what is not a triangle of a mesh without masks.
    take: &'a Take<'a>,
    pub parts: Parts,
    pub counters: Counters,
}

impl<'a> Stage<'a> {
    pub fn new(
        (scene, list, projected): (&'a Scene, &'a DrawList, &'a Projected),
        selection: Selection<'a>,
        (target, state): (Framebuffer, State),
        take: &'a Take<'a>,
    ) -> Self {
        let (parts, counters) = (Parts::default(), Counters::default());
        Self { scene, list, projected, selection, target, state, take, parts, counters }
    }

    /// All but triangles of meshes without masks.
    pub fn tested(&mut self) -> Result<(), Error> {
        self.meshes(true)?;
        self.boxes(false)?;
        self.boxes(true)?;
        self.planes()
    }

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
    pub fn meshes(&mut self, masked: bool) -> Result<(), Error> {
        let (scene, list) = (self.scene, self.list);
        let (start, end) = self.number(|item, shape| match shape {
            Shape::Mesh(mesh) if list.geometry(scene, item).is_masked() == masked => mesh.triangles.len() as u32,
            _ => 0,
        })?;
        if start == end {
            return Ok(());
        }
        let Self { projected, parts, target, take, .. } = self;
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
            let finder = Finder { scene, list, projected, parts, take: *take, width: target.extent().width };
            let shader = fragment(|f: &Fragment<()>| {
                finder.hit((f, number(f)), Border::Included, Some(f.position().z)).map(|found| found.0)
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
    pub fn ordered(&mut self, method: Method) -> Result<(), Error> {
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
        let Self { projected, parts, target, take, .. } = self;
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
        let finder = Finder { scene, list, projected, parts, take: *take, width: target.extent().width };
        let shader = fragment(|f: &Fragment<()>| {
            let (output, depth) = finder.hit((f, start + f.primitive_id() / 12), Border::Excluded, None)?;
            Some(WithDepth::<UVec4> { output, depth })
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
        let Self { scene, list, projected, parts, target, take, .. } = self;
        let finder = Finder { scene, list, projected, parts, take: *take, width: target.extent().width };
        for number in start..end {
            let vertex = |input: VertexInput| {
                let [x, y] = [[-1.0, -1.0], [3.0, -1.0], [-1.0, 3.0]][(input.vertex % 3) as usize];
                Vertex::new(Vec4::new(x, y, 0.5, 1.0), ())
            };
            let shader = fragment(|f: &Fragment<()>| {
                // Every pixel intersects its ray with the plane.
                let (output, depth) = finder.hit((f, number), Border::Excluded, None)?;
                Some(WithDepth::<UVec4> { output, depth })
            });
            let pipeline = Pipeline::new(Program::new(vertex, shader), self.state.clone(), target.layout())?;
            self.counters += pipeline.draw(target, &Draw::vertices(0..3))?;
        }
        Ok(())
    }
}

/// Finds hits of pixels with primitives by their numbers.
struct Finder<'f> {
    scene: &'f Scene,
    list: &'f DrawList,
    projected: &'f Projected,
    parts: &'f Parts,
    take: &'f Take<'f>,
    /// Width of the picture.
    width: u32,
}

impl Finder<'_> {
    /// Value and depth of a fragment that shows the primitive of a number. `depth`: that of the pipeline for triangles.
    fn hit(&self, (f, number): (&Fragment<'_, ()>, u32), border: Border, depth: Option<f32>) -> Option<(UVec4, f32)> {
        // Helpers serve derivatives alone, and are no pixels of the primitive.
        if f.is_helper() {
            return None;
        }
        let [x, y] = f.pixel();
        let (index, part) = self.parts.find(number)?;
        let ray = self.projected.ray(self.scene, [x, y]);
        let (pixel, item) = ((y * self.width + x) as usize, &self.list.items[index as usize]);
        let among_all = self.parts.among_all(number)?;
        let hit = (self.take)(&Candidate { pixel, item, index, part, number: among_all, ray, border, depth })?;
        Some((UVec4::splat(number + 1), self.projected.depth(ray.at(hit.t))))
    }
}
