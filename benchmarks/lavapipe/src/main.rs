//! Frames of Steradian's rasterizer and of lavapipe, Mesa's driver of Vulkan for processors: the same work in turns, in
//! CPU seconds of this process, and the difference of the pictures.
//!
//! Reads a mesh ([`work::Mesh::read`]) from the standard input and writes JSON. Both sides use as many threads as
//! `RAYON_NUM_THREADS` and `LP_NUM_THREADS` say; Mesa's driver runs vertex shaders on a further one.

mod ours;
mod theirs;
mod work;

use rustix::time::{ClockId, clock_gettime};
use serde_json::json;
use std::error::Error;
use work::{Mesh, Row, Shading};

/// Turns of each row; the medians count.
const TURNS: usize = 5;
/// CPU seconds that a turn takes at least, as far as the first frame tells.
const TURN: f64 = 0.1;

fn main() -> Result<(), Box<dyn Error>> {
    let asset = Mesh::read(std::io::stdin().lock())?;
    let driver = theirs::Lavapipe::open()?;
    let (small, large) = (Mesh::grid(1000, 500), Mesh::grid(4, 2));
    let row = |name, mesh, shading| Row { name, mesh, layers: 1, samples: 1, shading };
    let rows = [
        row("1 M small triangles", &small, Shading::Lit),
        Row { layers: 10, ..row("large triangles, 10 layers back to front", &large, Shading::Lit) },
        row("large triangles, trilinear texture", &large, Shading::Textured),
        row("1 M small triangles, depth only", &small, Shading::Depth),
        row("mesh, Phong", &asset, Shading::Phong),
        Row { samples: 4, ..row("mesh, 4 samples", &asset, Shading::Lit) },
    ];
    let measured = rows.iter().map(|row| measure(row, &driver)).collect::<Result<Vec<_>, _>>()?;
    println!("{}", json!({ "driver": driver.name, "triangles": asset.indices.len() / 3, "rows": measured }));
    Ok(())
}

/// CPU seconds of a frame by either side, and the share of the pixels that differ.
fn measure(row: &Row, driver: &theirs::Lavapipe) -> Result<serde_json::Value, Box<dyn Error>> {
    let texture = work::board()?;
    let mut ours = ours::frame(row, &texture)?;
    let theirs = driver.frame(row, &texture);
    // The first frames compile shaders and touch memory; the second ones tell how many a turn has.
    theirs.draw()?;
    let picture = ours(true)?;
    if picture.chunks_exact(4).all(|pixel| *pixel == picture[..4]) {
        return Err(format!("the picture of '{}' is empty", row.name).into());
    }
    let differing = differing(row.shading, &picture, &theirs.bytes()?);
    let mut draw_ours = || -> Result<(), Box<dyn Error>> { ours(false).map(drop).map_err(Into::into) };
    let mut draw_theirs = || theirs.draw();
    let counts = [(TURN / timed(1, &mut draw_ours)?).ceil(), (TURN / timed(1, &mut draw_theirs)?).ceil()];
    let mut seconds = [Vec::new(), Vec::new()];
    for _ in 0..TURNS {
        seconds[0].push(timed(counts[0] as u32, &mut draw_ours)?);
        seconds[1].push(timed(counts[1] as u32, &mut draw_theirs)?);
    }
    let [ours, theirs] = seconds.map(|mut turns| {
        turns.sort_by(f64::total_cmp);
        turns[TURNS / 2]
    });
    Ok(json!({ "row": row.name, "ours": ours, "theirs": theirs, "differing": differing }))
}

/// CPU seconds of one of so many frames, all threads together.
fn timed(frames: u32, draw: &mut impl FnMut() -> Result<(), Box<dyn Error>>) -> Result<f64, Box<dyn Error>> {
    let cpu = || {
        let t = clock_gettime(ClockId::ProcessCPUTime);
        t.tv_sec as f64 + 1e-9 * t.tv_nsec as f64
    };
    let start = cpu();
    (0..frames).try_for_each(|_| draw())?;
    Ok((cpu() - start) / f64::from(frames))
}

/// Share of the pixels of which a channel or the depth differs by more than 2/255.
fn differing(shading: Shading, ours: &[u8], theirs: &[u8]) -> f64 {
    let depth = |pixel: &[u8]| f32::from_le_bytes([pixel[0], pixel[1], pixel[2], pixel[3]]);
    let is_other = |(a, b): &(&[u8], &[u8])| match shading {
        Shading::Depth => (depth(a) - depth(b)).abs() > 2.0 / 255.0,
        _ => a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > 2),
    };
    let pixels = || ours.chunks_exact(4).zip(theirs.chunks_exact(4));
    pixels().filter(is_other).count() as f64 / pixels().len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_differ_by_more_than_two_steps() {
        assert_eq!(differing(Shading::Lit, &[0, 0, 0, 9, 7, 7, 7, 7], &[2, 0, 0, 9, 7, 7, 4, 7]), 0.5);
        let depths = |depths: [f32; 2]| depths.map(f32::to_le_bytes).concat();
        assert_eq!(differing(Shading::Depth, &depths([0.5, 0.5]), &depths([0.507, 0.509])), 0.5);
    }

    #[test]
    fn meshes_that_lie_about_their_length_are_refused() {
        let bytes = |words: &[u32]| words.iter().flat_map(|w| w.to_le_bytes()).collect::<Vec<u8>>();
        let mut words = vec![3, 1, 0, 0, 0, 1f32.to_bits(), 0, 0, 0, 1f32.to_bits(), 0, 0, 1, 2];
        assert_eq!(Mesh::read(&bytes(&words)[..]).unwrap().normals, vec![steradian_raster::glam::Vec3::Z; 3]);
        words[13] = 3;
        assert!(Mesh::read(&bytes(&words)[..]).is_err());
        assert!(Mesh::read(&bytes(&words[..13])[..]).is_err());
    }
}
