//! Pixels in which a shape is what a camera ray meets first, for outlines.

use crate::{
    app::{App, Refused},
    frame::Shown,
};
use axum::{
    extract::{Query, State},
    http::StatusCode,
    response::{IntoResponse, Json, Response},
};
use serde::{Deserialize, Serialize};
use steradian::math::{DVec3, Vec2, Vec3};

/// Most columns or rows of a mask; of larger pictures a part of the pixels is looked at.
const MOST_SIDE: usize = 1024;

/// A shape, by its name.
#[derive(Deserialize)]
pub struct Asked {
    shape: String,
}

/// The pixels of a shape, in runs.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Outline {
    generation: u32,
    /// Upper left corner of the first pixel, in pixels of the whole picture.
    origin: [u32; 2],
    /// Size of a pixel here, in pixels of the whole picture.
    pixel: [f64; 2],
    /// Row, first column, and the column after the last.
    runs: Vec<[u32; 3]>,
    /// Handle by which the shape is moved, where it is placed once.
    handle: Option<Handle>,
}

/// Point of a shape in the picture, and the axes of the world there.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Handle {
    /// Place in the whole picture, pixels.
    at: [f32; 2],
    /// Pixels by which a point moves in the picture for each unit along x, y and z.
    axes: [[f32; 2]; 3],
}

/// Pixels of a shape in the picture that is shown; `null` where surfaces are not known of it.
pub async fn outline(State(app): State<App>, Query(Asked { shape }): Query<Asked>) -> Result<Response, Refused> {
    let none = |why: String| Refused(StatusCode::NOT_FOUND, why);
    let id = app.viewer.subject().names.shape(&shape);
    let (id, is_single) = id.ok_or_else(|| none(format!("there is no shape '{shape}' in the scene")))?;
    let shown = app.viewer.shown().ok_or_else(|| none("there is no picture yet".into()))?;
    if shown.film.layers.features.is_empty() {
        return Ok(Json(None::<Outline>).into_response());
    }
    let outline = tokio::task::spawn_blocking(move || of(&shown, id, is_single)).await;
    let outline = outline.map_err(|_| Refused(StatusCode::INTERNAL_SERVER_ERROR, "the outline failed".into()))?;
    Ok(Json(Some(outline)).into_response())
}

fn of(shown: &Shown, id: u32, is_single: bool) -> Outline {
    let [width, height] = shown.size();
    let step = width.max(height).div_ceil(MOST_SIDE).max(1);
    let [x0, y0, x1, y1] = shown.crop;
    let pixel = |from: u32, to: u32, count: usize| f64::from(to - from) * step as f64 / count.max(1) as f64;
    let rows = shown.film.layers.features.chunks_exact(width.max(1)).step_by(step);
    let mask: Vec<Vec<bool>> = rows.map(|row| row.iter().step_by(step).map(|p| p.sum.shape == id).collect()).collect();
    let mut runs: Vec<[u32; 3]> = Vec::new();
    for (row, pixels) in (0..).zip(smoothed(mask)) {
        for (column, _) in (0..).zip(pixels).filter(|(_, is_inside)| *is_inside) {
            match runs.last_mut() {
                Some([of, _, end]) if (*of, *end) == (row, column) => *end += 1,
                _ => runs.push([row, column, column + 1]),
            }
        }
    }
    let handle = if is_single { handle(shown, id) } else { None };
    Outline {
        generation: shown.generation,
        origin: [x0, y0],
        pixel: [pixel(x0, x1, width), pixel(y0, y1, height)],
        runs,
        handle,
    }
}

/// Handle in the middle of what is seen of a shape.
fn handle(shown: &Shown, id: u32) -> Option<Handle> {
    let hits = shown.film.layers.features.iter().filter(|pixel| pixel.sum.shape == id && pixel.sum.coverage > 0.0);
    let positions = hits.map(|pixel| DVec3::from(pixel.mean().position.map(f64::from)));
    let (sum, count) = positions.fold((DVec3::ZERO, 0.0), |(sum, count), position| (sum + position, count + 1.0));
    let (scene, middle) = (&shown.scene, (sum / count).as_vec3());
    // The scene of a coarse picture has a film of its size.
    let (crop, [x0, y0, x1, y1]) = (shown.film.crop, shown.crop.map(|v| v as f32));
    let first = Vec2::new(crop.x0 as f32, crop.y0 as f32);
    let pixel = Vec2::new((x1 - x0) / crop.width().max(1) as f32, (y1 - y0) / crop.height().max(1) as f32);
    let place = |p: Vec3| {
        let at = scene.camera().project(scene.film(), p, 0.0).filter(|at| at.is_finite())?;
        Some(Vec2::new(x0, y0) + (at - first) * pixel)
    };
    let at = place(middle)?;
    let step = 1e-3 * (middle - scene.camera().world_from_camera.point(Vec3::ZERO)).length();
    let axis = |axis: Vec3| place(middle + axis * step).map(|to| (to - at) / step);
    let axes = [axis(Vec3::X)?, axis(Vec3::Y)?, axis(Vec3::Z)?];
    Some(Handle { at: at.to_array(), axes: axes.map(|axis| axis.to_array()) })
}

/// A mask with the value that most pixels around a pixel have: samples are taken anywhere in their pixels, so that
/// edges are ragged. A mask of thin lines stays as it is.
fn smoothed(mask: Vec<Vec<bool>>) -> Vec<Vec<bool>> {
    let near = |v: usize, count: usize| [v.saturating_sub(1), v, (v + 1).min(count - 1)];
    let around = |x: usize, y: usize| {
        let rows = near(y, mask.len()).into_iter().map(|v| &mask[v]);
        rows.flat_map(|row| near(x, row.len()).into_iter().map(|u| row[u])).filter(|inside| *inside).count()
    };
    let row = |(y, row): (usize, &Vec<bool>)| (0..row.len()).map(|x| around(x, y) >= 5).collect();
    let smooth: Vec<Vec<bool>> = mask.iter().enumerate().map(row).collect();
    let count = |of: &[Vec<bool>]| of.iter().flatten().filter(|inside| **inside).count();
    if 4 * count(&smooth) < 3 * count(&mask) { mask } else { smooth }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{frame::tests::shown, protocol::FrameKind};
    use steradian::film::{FirstHit, FirstHitSums};

    fn of_ids(size: [u32; 2], id: impl Fn(u32, u32) -> u32) -> Shown {
        let mut shown = shown(FrameKind::Preview, size, Vec::new());
        let places = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x, y)));
        let hit = |(x, y)| FirstHitSums { sum: FirstHit { shape: id(x, y), ..FirstHit::default() }, samples: 1 };
        shown.film.layers.features = places.map(hit).collect();
        shown
    }

    #[test]
    fn runs_cover_the_pixels_of_the_shape() {
        // A preview of a picture of twelve by six pixels: rows end where the next one begins.
        let ids = [[7, 7, 0, 0], [7, 7, 1, 7], [0, 0, 0, 7]];
        let preview = of_ids([4, 3], |x, y| ids[y as usize][x as usize]);
        let outline = of(&Shown { crop: [2, 1, 14, 7], ..preview }, 7, false);
        assert_eq!((outline.origin, outline.pixel), ([2, 1], [3.0, 2.0]));
        assert_eq!(outline.runs, [[0, 0, 2], [1, 0, 2], [1, 3, 4], [2, 3, 4]]);
    }

    #[test]
    fn ragged_edges_are_smoothed_and_lines_stay() {
        let of_text =
            |rows: &[&str]| rows.iter().map(|row| row.chars().map(|c| c == '#').collect()).collect::<Vec<Vec<_>>>();
        let ragged = of_text(&["..####..", "..####..", ".#####..", "..##.#..", "..####..", "......#."]);
        let smooth = of_text(&["..####..", "..####..", "..####..", "..####..", "..####..", "........"]);
        assert_eq!(smoothed(ragged)[..4], smooth[..4]);
        let line = of_text(&["......", "######", "......"]);
        assert_eq!(smoothed(line.clone()), line);
    }

    #[test]
    fn of_large_pictures_every_few_pixels_count() {
        let outline = of(&of_ids([2050, 2], |x, _| u32::from((600..1200).contains(&x))), 1, false);
        assert_eq!((outline.pixel, outline.runs), ([3.0, 3.0], vec![[0, 200, 400]]));
    }
}
