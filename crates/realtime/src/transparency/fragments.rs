//! A-buffer: all transparent fragments of each pixel.

use super::{Fragment, View};
use crate::{
    Error,
    visibility::{Candidate, Cover, Seen, Stage},
};
use std::sync::{
    Mutex,
    atomic::{AtomicUsize, Ordering},
};
use steradian_core::scene::Shape;
use steradian_raster::{Format, Framebuffer, State};

/// Fragments that a picture may have: some 50 bytes each.
const MOST: usize = 1 << 25;

/// All transparent fragments before what is opaque, by pixels, those of each from the nearest on.
pub fn gather(view: &View<'_>) -> Result<Vec<Fragment>, Error> {
    let View { scene, list, projected, selection, opaque } = *view;
    let (extent, viewport) = projected.frame(scene);
    let rows: Vec<Mutex<Vec<Fragment>>> = (0..extent.height).map(|_| Mutex::default()).collect();
    let count = AtomicUsize::new(0);
    // The fragment shader stores each hit of a part in the list of its row; nothing is written to the target.
    let take = |found: &Candidate<'_>| {
        let is_triangle = matches!(list.geometry(scene, found.item).shape, Shape::Mesh(_));
        let mut after = f32::NEG_INFINITY;
        while let Some(hit) = found.meet_after(scene, projected, &Cover::Transparent, after) {
            after = hit.t;
            let depth = found.depth.unwrap_or_else(|| projected.depth(found.ray.at(hit.t)));
            let is_before = opaque.depths.get(found.pixel).is_some_and(|opaque| depth > *opaque);
            if is_before && count.fetch_add(1, Ordering::Relaxed) < MOST {
                let opacity = scene.coverage(&hit, &found.local_ray(scene));
                let seen = Seen { hit, number: found.number };
                let (pixel, part) = (found.pixel as u32, (found.index, found.part));
                if let Ok(mut row) = rows[found.pixel / extent.width as usize].lock() {
                    row.push(Fragment { pixel, seen, opacity, part });
                }
            }
            if is_triangle {
                break;
            }
        }
        None
    };
    let target = Framebuffer::with_color_and_depth(extent, Format::R32Uint)?;
    let state = State { viewports: vec![viewport], ..State::default() };
    Stage::new((scene, list, projected), selection, (target, state), &take).tested()?;
    if count.into_inner() > MOST {
        return Err(Error::Scene(format!(
            "raster keeps up to {MOST} transparent fragments for a picture, and more are in the view; \
             transparency=peel, or dither, takes less memory"
        )));
    }
    // Threads come in any order: sorting by distance and number makes the lists those of one thread.
    let sorted = |row: Mutex<Vec<Fragment>>| {
        let mut row = row.into_inner().unwrap_or_default();
        row.sort_by(|a, b| {
            let by_distance = a.pixel.cmp(&b.pixel).then(a.seen.hit.t.total_cmp(&b.seen.hit.t));
            by_distance.then(a.seen.number.cmp(&b.seen.number))
        });
        row
    };
    Ok(rows.into_iter().flat_map(sorted).collect())
}
