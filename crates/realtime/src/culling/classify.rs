//! Classes of culling methods, by comparison with what rays see.

use super::{Chunks, Culling, Selection, Verdict};
use crate::{
    Error,
    draw_list::DrawList,
    projection::Projected,
    visibility::{Visibility, Wanted},
};
use rayon::prelude::*;
use std::{collections::HashMap, fmt};
use steradian_accel::bounding::{Answers, Class};
use steradian_core::Scene;
use steradian_math::{Ray, Vec3};

/// Surfaces between media that a ray passes at most.
const MAX_PASSED: usize = 64;

const WHITE: Vec3 = Vec3::ONE;
const MAGENTA: Vec3 = Vec3::new(1.0, 0.0, 1.0);
const RED: Vec3 = Vec3::new(1.0, 0.0, 0.0);

/// Verdicts against the truth.
#[derive(Debug)]
pub struct Classified {
    /// The method.
    pub culling: Culling,
    /// Counts of chunks. Positive is a chunk that is drawn; it is rightly so where a ray meets it.
    pub answers: Answers,
    /// Colours of pixels, by rows: white where a chunk is seen that is drawn, magenta where one is seen that is not
    /// drawn, black where nothing is seen; half red where chunks are that are drawn and nowhere seen.
    pub colors: Vec<Vec3>,
}

/// Compares verdicts with the set of chunks that are met first by the ray of a pixel, one ray for each. A chunk that is
/// not drawn counts as seen only if the pipeline, drawing everything, shows it in that pixel, too: positions in the
/// picture are rounded to 1/256 pixel, and rays are not.
///
/// # Errors
/// Errors of the pipeline.
pub fn classify(
    scene: &Scene,
    list: &DrawList,
    projected: &Projected,
    chunks: &Chunks,
    verdicts: &[Verdict],
    culling: Culling,
) -> Result<Classified, Error> {
    let met = met(scene, list, projected, chunks);
    let drawn = |chunk: usize| verdicts[chunk] == Verdict::Drawn;
    let draw = |selection: Selection<'_>| {
        Visibility::draw_wanted(scene, list, projected, Wanted { selection, ..Wanted::default() })
    };
    let everything = draw(Selection::All)?;
    let counts = |pixel: usize, chunk: usize| {
        drawn(chunk) || everything.part(pixel).and_then(|(item, part)| chunks.find(item, part)) == Some(chunk)
    };
    let mut is_seen = vec![false; verdicts.len()];
    for (pixel, chunk) in met.iter().enumerate() {
        if let Some(chunk) = chunk.filter(|&chunk| counts(pixel, chunk)) {
            is_seen[chunk] = true;
        }
    }
    let mut answers = Answers::default();
    (0..verdicts.len()).for_each(|chunk| answers.add(drawn(chunk), is_seen[chunk]));
    // A picture of the superfluous chunks alone.
    let superfluous: Vec<Verdict> = (0..verdicts.len())
        .map(|chunk| if drawn(chunk) && !is_seen[chunk] { Verdict::Drawn } else { Verdict::Hidden })
        .collect();
    let behind = draw(Selection::Chunks(chunks, &superfluous))?;
    let color = |(pixel, chunk): (usize, &Option<usize>)| {
        let front = match *chunk {
            Some(chunk) if drawn(chunk) => WHITE,
            Some(chunk) if counts(pixel, chunk) => MAGENTA,
            Some(_) => WHITE,
            None => Vec3::ZERO,
        };
        if behind.part(pixel).is_some() { (front + RED) * 0.5 } else { front }
    };
    let colors = met.iter().enumerate().map(color).collect();
    Ok(Classified { culling, answers, colors })
}

/// The chunk that the ray of each pixel meets first, by rows.
fn met(scene: &Scene, list: &DrawList, projected: &Projected, chunks: &Chunks) -> Vec<Option<usize>> {
    // Hits name geometries by their place in a group, planes by that in the scene; in the world both are one.
    let items: HashMap<(u32, u32), u32> =
        (0..).zip(&list.items).map(|(number, item)| ((item.instance, item.in_group), number)).collect();
    let (extent, _) = projected.frame(scene);
    let chunk = |pixel: u32| {
        let mut ray = projected.ray(scene, [pixel % extent.width, pixel / extent.width]);
        for _ in 0..MAX_PASSED {
            let hit = scene.intersect(&ray)?;
            let geometry = scene.geometry(hit.id);
            if !geometry.is_interface && !projected.hides(geometry) {
                let item = items.get(&(hit.id.instance, hit.id.geom))?;
                return chunks.find(*item, hit.id.prim);
            }
            let next = scene.interaction(&ray, &hit).spawn(ray.direction);
            ray = Ray { t_max: ray.t_max - (next.origin - ray.origin).length(), ..next };
        }
        None
    };
    (0..extent.width * extent.height).into_par_iter().map(chunk).collect()
}

impl fmt::Display for Classified {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let class = match self.answers.class() {
            Class::Exact => "exact",
            Class::Conservative => "conservative",
            Class::Aggressive => "aggressive",
            Class::Approximate => "approximate",
        };
        let Answers { true_positives, true_negatives, false_positives, false_negatives } = self.answers;
        write!(
            f,
            "culling={} is {class} here, against a ray for each pixel: {true_positives} chunks are drawn and seen, \
             {false_positives} drawn and not seen, {true_negatives} neither drawn nor seen, {false_negatives} seen but \
             not drawn",
            self.culling.name()
        )
    }
}
