//! Which primitive each pixel sees.

mod candidate;
mod meet;
mod parts;
mod stage;

pub(crate) use candidate::Candidate;
pub use candidate::Cover;
pub(crate) use meet::{Border, local, meet};
pub(crate) use stage::{Stage, in_view};

use crate::{Error, culling::Selection, draw_list::DrawList, options::Method, projection::Projected};
use parts::Parts;
use rayon::prelude::*;
use steradian_core::{
    Scene,
    scene::{Hit, Shape},
};
use steradian_raster::{
    ColorTarget, Counters, DepthFormat, DepthTarget, Draw, Format, Fragment, Framebuffer, Pipeline, Program, State,
    Vertex, VertexInput, fragment,
    glam::Vec4,
    output::WithDepth,
    state::{Compare, DepthState},
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
    cover: Cover,
    /// Counters of the pipeline.
    pub counters: Counters,
}

/// Choice of what a picture of primitives shows; by default all that passes the alpha test, by depths.
#[derive(Debug)]
pub struct Wanted<'a> {
    /// Parts of the draw list.
    pub selection: Selection<'a>,
    /// Hidden-surface algorithm of meshes without masks; `None` leaves these out.
    pub method: Option<Method>,
    /// Surfaces, by their opacity.
    pub cover: Cover,
}

impl Default for Wanted<'_> {
    fn default() -> Self {
        Self { selection: Selection::Items, method: Some(Method::ZBuffer), cover: Cover::Tested }
    }
}

impl Visibility {
    /// Draws what the view sees.
    ///
    /// # Errors
    /// More than 119 million primitives in the view, and sizes that the pipeline refuses.
    pub fn draw(scene: &Scene, list: &DrawList, projected: &Projected) -> Result<Self, Error> {
        Self::draw_wanted(scene, list, projected, Wanted::default())
    }

    /// Draws what is wanted of what the view sees.
    ///
    /// # Errors
    /// As [`draw`](Self::draw), and more triangles or cuts than the method takes.
    pub fn draw_wanted(
        scene: &Scene,
        list: &DrawList,
        projected: &Projected,
        wanted: Wanted<'_>,
    ) -> Result<Self, Error> {
        // The target holds a primitive number and a reversed depth for each pixel (Burns, Hunt 2013). Shading comes
        // later, once for each pixel rather than once for each fragment.
        let (extent, viewport) = projected.frame(scene);
        let colors = vec![ColorTarget::new(extent, Format::R32Uint)?];
        let mut target = Framebuffer::new(colors, Some(DepthTarget::new(extent, DepthFormat::Float32)?), None)?;
        target.clear(Vec4::ZERO, 0.0, 0);
        let state = State { depth: Some(DepthState::GREATER), viewports: vec![viewport], ..State::default() };
        let Wanted { selection, method, cover } = wanted;
        let take = |found: &Candidate<'_>| found.meet(scene, projected, &cover);
        let mut stage = Stage::new((scene, list, projected), selection, (target, state), &take);
        // Opaque meshes first: they hide most of what needs a fragment shader with an intersection. All passes share
        // the depth buffer, so that their order does not matter for the picture.
        match method {
            None => {}
            Some(Method::ZBuffer) => stage.meshes(false)?,
            Some(method) => stage.ordered(method)?,
        }
        stage.tested()?;
        // Read back, row by row; 0 stands for the background.
        let bytes = stage.target.color(0).to_bytes(0);
        let numbers = bytes.par_chunks_exact(4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect();
        let depths = stage.target.depth().map_or(Vec::new(), |depth| depth.to_rows(0));
        let Stage { parts, counters, .. } = stage;
        Ok(Self { numbers, depths, width: extent.width, parts, cover, counters })
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
        let (index, among_all) = (item, self.parts.among_all(number)?);
        let (item, ray) = (&list.items[item as usize], projected.ray(scene, at));
        // Of a triangle that was drawn the only hit is meant; other shapes have several.
        let is_triangle = matches!(list.geometry(scene, item).shape, Shape::Mesh(_));
        let pixel = (at[1] * self.width + at[0]) as usize;
        let border = Border::Included;
        let found = Candidate { pixel, item, index, part, ray, number: among_all, border, depth: None };
        let hit = match is_triangle {
            true => meet(scene, item, part, &ray, Border::Included, |_, _| true)?,
            false => found.meet(scene, projected, &self.cover)?,
        };
        Some(Seen { hit, number: among_all })
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
