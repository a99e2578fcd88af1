//! Verdicts of culling methods about chunks.

use super::{
    Chunks, Culling,
    footprint::{Footprint, Screen},
    occluders::Candidates,
};
use crate::{Error, draw_list::DrawList, projection::Projected, visibility::in_view};
use rayon::prelude::*;
use steradian_core::Scene;

/// Fate of a chunk.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// It may be seen.
    Drawn,
    /// It lies outside the view.
    Outside,
    /// It lies behind occluders, or is seen through no portal.
    Hidden,
    /// Its footprint is less than a pixel.
    Small,
}

/// Verdicts about all chunks, in their order.
///
/// # Errors
/// Errors of the pipeline, by which occluders are drawn.
pub fn judge(
    scene: &Scene,
    list: &DrawList,
    projected: &Projected,
    chunks: &Chunks,
    culling: Culling,
) -> Result<Vec<Verdict>, Error> {
    if culling == Culling::None {
        return Ok(vec![Verdict::Drawn; chunks.all().len()]);
    }
    if culling == Culling::Items {
        return Ok(by_items(scene, list, projected, chunks));
    }
    let screen = Screen::new(scene, projected);
    let in_picture = |chunk: &super::Chunk| {
        // Without bounds, or with a volume around the eye, nothing is known.
        let Some(volume) = &chunk.volume else { return (Verdict::Drawn, None) };
        if screen.misses(volume) {
            return (Verdict::Outside, None);
        }
        match screen.footprint(volume) {
            Some(footprint) if footprint.pixels(screen.size).is_none() => (Verdict::Outside, None),
            Some(footprint) if culling == Culling::ScreenSize && footprint.area() < 1.0 => {
                (Verdict::Small, Some(footprint))
            }
            footprint => (Verdict::Drawn, footprint),
        }
    };
    let (mut verdicts, footprints): (Vec<_>, Vec<_>) = chunks.all().par_iter().map(in_picture).unzip();
    if matches!(culling, Culling::Portals | Culling::Pvs) {
        let sight = chunks.rooms(scene, list, projected).sight(projected, &screen, culling == Culling::Pvs);
        let Some(may_see) = sight else { return Ok(verdicts) };
        verdicts.par_iter_mut().zip(chunks.all()).for_each(|(verdict, chunk)| {
            if *verdict == Verdict::Drawn && chunk.volume.as_ref().is_some_and(|volume| !may_see(volume)) {
                *verdict = Verdict::Hidden;
            }
        });
        return Ok(verdicts);
    }
    let candidates =
        Candidates { scene, list, projected, chunks, verdicts: &verdicts, footprints: &footprints, size: screen.size };
    let pyramids = match culling {
        Culling::Hiz => vec![candidates.depths()?],
        Culling::Occlusion => candidates.maps()?,
        _ => Vec::new(),
    };
    let is_hidden = |footprint: &Footprint| {
        let pixels = footprint.pixels(screen.size);
        pixels.is_some_and(|pixels| pyramids.iter().any(|pyramid| pyramid.hides(footprint.nearest, &pixels)))
    };
    verdicts.par_iter_mut().zip(&footprints).for_each(|(verdict, footprint)| {
        if *verdict == Verdict::Drawn && footprint.as_ref().is_some_and(is_hidden) {
            *verdict = Verdict::Hidden;
        }
    });
    Ok(verdicts)
}

/// Verdicts about whole items.
fn by_items(scene: &Scene, list: &DrawList, projected: &Projected, chunks: &Chunks) -> Vec<Verdict> {
    let mut verdicts = vec![Verdict::Drawn; chunks.all().len()];
    for (number, item) in list.items.iter().enumerate() {
        if !in_view(scene, projected, item, &list.geometry(scene, item).shape) {
            verdicts[chunks.of_item(number)].fill(Verdict::Outside);
        }
    }
    verdicts
}
