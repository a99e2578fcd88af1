//! The light of each group of lights, as planes beside the picture: pages mix them.

use steradian::{Film, Scene};

/// The number of the first group's plane among those of a frame; the other groups follow.
pub const FIRST_PLANE: u16 = 256;

/// Most groups: pages have a weight for each in their shader.
const MOST_GROUPS: usize = 32;
/// Pixels of all planes together, at 6 bytes each.
const MOST_PIXELS: u64 = 1 << 25;

/// Refuses scenes whose groups are not sent.
///
/// # Errors
/// Why not.
pub fn check(scene: &Scene) -> Result<(), String> {
    let count = scene.light_groups().names.len();
    let crop = scene.film().crop;
    let [width, height] = [crop.width(), crop.height()];
    if count > MOST_GROUPS {
        return Err(format!("the scene has {count} groups of lights, and at most {MOST_GROUPS} are shown"));
    }
    if count as u64 * u64::from(width) * u64::from(height) > MOST_PIXELS {
        return Err(format!(
            "{count} groups of lights of {width} x {height} pixels are not shown: at most {MOST_PIXELS} pixels in all"
        ));
    }
    if scene.film().sensor.is_some() {
        return Err("light groups are not shown here: the film adds the noise of a sensor, which is of no light".into());
    }
    Ok(())
}

/// The names of the groups that a film has, in order. There are none where pixels have no samples yet, as a picture
/// without groups shows there.
pub fn names<'s>(scene: &'s Scene, film: &Film) -> &'s [String] {
    let names = scene.light_groups().names.as_slice();
    let are_kept = film.bins == 0
        && !film.layers.by_light.is_empty()
        && film.layers.by_light.len() == names.len() * film.pixels.len();
    let has_all = || film.pixels.iter().all(|p| p.samples > 0);
    if are_kept && check(scene).is_ok() && has_all() { names } else { &[] }
}

/// R, G, B of pixels by the light of one group of so many.
pub fn plane(film: &Film, group: usize, count: usize) -> Vec<f32> {
    let sums = film.layers.by_light.iter().skip(group).step_by(count);
    sums.zip(&film.pixels).flat_map(|(sum, p)| sum.map(|v| (v / f64::from(p.samples)) as f32)).collect()
}
