//! Layers of parts of the light: of groups of lights, and of time bins.

use super::{Layer, Names, Row, Write, held, push};
use crate::{Film, LayerInputs};
use steradian_image::Image;

/// The picture by the light of each group of lights alone.
pub const LIGHT_GROUPS: Layer = Layer(&Row {
    name: "light_groups",
    channels: &["RGBA.R", "RGBA.G", "RGBA.B"],
    doc: "the light of each light or named group of them, whose sum is the picture: RGBA_NAME.R .G .B; not among 'all'",
    in_all: false,
    inputs: LayerInputs::LIGHT_GROUPS,
    write: Write::Film(groups),
});

/// Adds the light of each group of lights. Dots part layers in names of channels, so that groups lose theirs.
fn groups(film: &Film, names: &Names, image: &mut Image) {
    if film.bins > 0 || film.layers.by_light.is_empty() {
        return;
    }
    for (group, name) in names.light_groups.iter().enumerate() {
        let mut name = format!("RGBA_{}", name.replace(['.', '\0'], "_"));
        name.truncate(name.floor_char_boundary(200));
        while image.channel(&format!("{name}.R")).is_some() {
            name.push('_');
        }
        part(image, &name, film, (group, names.light_groups.len()));
    }
}

/// Adds the time bins of a transient render, which are there without being asked for.
pub(super) fn bins(film: &Film, image: &mut Image) {
    let bins = film.bins as usize;
    for bin in 0..bins {
        part(image, &format!("bin.{bin:03}"), film, (bin, bins));
    }
}

/// Adds a layer of one part of the light out of so many.
fn part(image: &mut Image, name: &str, film: &Film, (part, count): (usize, usize)) {
    for (c, n) in ["R", "G", "B"].iter().enumerate() {
        let sums = film.layers.by_light.iter().skip(part).step_by(count).zip(&film.pixels);
        let plane = sums.map(|(sum, p)| held(sum[c] / f64::from(p.samples.max(1)))).collect();
        push(image, &format!("{name}.{n}"), plane);
    }
}
