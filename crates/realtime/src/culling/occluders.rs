//! Occluders, and the pictures of depths that they make.

use super::{Chunks, Selection, Verdict, footprint::Footprint, pyramid::Pyramid};
use crate::{
    Error,
    draw_list::DrawList,
    projection::Projected,
    visibility::{Visibility, Wanted},
};
use steradian_core::Scene;

/// Side in pixels of the cells of estimated depths.
const CELL: u32 = 8;

/// Shares of the occluders, from the nearest on, that occlusion maps are made of. A map of few near ones is not spoilt
/// by large ones far away.
const SHARES: [usize; 4] = [8, 4, 2, 1];

/// Inputs of occluders: a view, the chunks of its draw list, and the footprints of those that may be in the view. A
/// footprint that is `None` is unknown.
pub struct Candidates<'a> {
    pub scene: &'a Scene,
    pub list: &'a DrawList,
    pub projected: &'a Projected,
    pub chunks: &'a Chunks,
    /// Verdicts so far.
    pub verdicts: &'a [Verdict],
    pub footprints: &'a [Option<Footprint>],
    /// Size of the picture.
    pub size: [u32; 2],
}

impl Candidates<'_> {
    /// A pyramid of the depths of the largest chunks, drawn with masks and curved shapes as in the picture: what is
    /// behind it in all its pixels is hidden.
    ///
    /// # Errors
    /// Errors of the pipeline.
    pub fn depths(&self) -> Result<Pyramid, Error> {
        Ok(Pyramid::new(self.draw(&self.largest())?.depths, self.size))
    }

    /// Occlusion maps: pyramids in which a pixel that occluders cover has the farthest depth of the bounding volumes of
    /// all occluders in its cell, and other pixels are infinitely far away. An occluder that covers a pixel is nowhere
    /// behind its volume, so that what is behind one map in all its pixels is hidden.
    ///
    /// # Errors
    /// Errors of the pipeline.
    pub fn maps(&self) -> Result<Vec<Pyramid>, Error> {
        // Occluders of known depth, near ones first.
        let mut occluders: Vec<(usize, Footprint)> =
            self.largest().into_iter().filter_map(|number| Some((number, self.footprints[number]?))).collect();
        occluders.sort_by(|a, b| b.1.farthest.total_cmp(&a.1.farthest).then(a.0.cmp(&b.0)));
        let map = |share: usize| {
            let occluders = &occluders[..occluders.len().div_ceil(share)];
            let numbers: Vec<usize> = occluders.iter().map(|o| o.0).collect();
            let covered = self.draw(&numbers)?.depths;
            Ok(Pyramid::new(self.estimated(covered, occluders), self.size))
        };
        SHARES.into_iter().map(map).collect()
    }

    /// Depths of pixels by cells, where they are covered.
    fn estimated(&self, covered: Vec<f32>, occluders: &[(usize, Footprint)]) -> Vec<f32> {
        let [width, height] = self.size;
        let columns = width.div_ceil(CELL);
        let mut cells = vec![f32::MAX; (columns * height.div_ceil(CELL)) as usize];
        for (_, footprint) in occluders {
            let Some([xs, ys]) = footprint.pixels(self.size) else { continue };
            for (x, y) in (ys.start() / CELL..=ys.end() / CELL)
                .flat_map(|y| (xs.start() / CELL..=xs.end() / CELL).map(move |x| (x, y)))
            {
                let cell = &mut cells[(y * columns + x) as usize];
                *cell = cell.min(footprint.farthest as f32);
            }
        }
        let of_cell = |i: u32| cells[(i / width / CELL * columns + i % width / CELL) as usize];
        (0..).zip(covered).map(|(i, depth)| if depth > 0.0 { of_cell(i) } else { 0.0 }).collect()
    }

    /// The chunks with the largest footprints that together have at most a quarter of the primitives that may be in the
    /// view, and the largest one in any case. Unknown footprints count as the whole picture.
    fn largest(&self) -> Vec<usize> {
        let area =
            |number: usize| self.footprints[number].map_or(f64::INFINITY, |footprint| footprint.area_in(self.size));
        let drawn = |number: &usize| self.verdicts[*number] == Verdict::Drawn;
        let mut numbers: Vec<(f64, usize)> =
            (0..self.verdicts.len()).filter(drawn).map(|number| (area(number), number)).collect();
        numbers.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let count = |number: usize| u64::from(self.chunks.all()[number].count);
        let most = numbers.iter().map(|n| count(n.1)).sum::<u64>() / 4;
        let mut sum = 0;
        let fits = |&(place, number): &(usize, usize)| {
            sum += count(number);
            place == 0 || sum <= most
        };
        numbers.iter().map(|n| n.1).enumerate().take_while(fits).map(|n| n.1).collect()
    }

    /// Picture of some chunks alone.
    fn draw(&self, numbers: &[usize]) -> Result<Visibility, Error> {
        let mut verdicts = vec![Verdict::Hidden; self.verdicts.len()];
        numbers.iter().for_each(|number| verdicts[*number] = Verdict::Drawn);
        let selection = Selection::Chunks(self.chunks, &verdicts);
        let wanted = Wanted { selection, ..Wanted::default() };
        Visibility::draw_wanted(self.scene, self.list, self.projected, wanted)
    }
}
