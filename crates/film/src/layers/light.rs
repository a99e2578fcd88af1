//! Layers of parts of the light: of groups of lights, of numbers of scattering events, and of time bins.

use super::{Layer, Names, Row, Write, held, push};
use crate::{Film, LayerInputs, Pixel};
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

/// Most parts that light is kept apart in by its scattering events: the last of so many holds the rest of the series.
pub const MOST_BOUNCES: usize = 16;

/// The terms of the Neumann series `L = Σ τⁿ Le` (Kajiya 1986, "The Rendering Equation").
pub const BOUNCES: Layer = Layer(&Row {
    name: "bounces",
    channels: &["bounce.00.R", "bounce.00.G", "bounce.00.B"],
    doc: "the light by its number of scattering events, whose sum is the picture: bounce.00.R .G .B to bounce.14, \
          then bounce.rest; not among 'all'",
    in_all: false,
    inputs: LayerInputs::BOUNCES,
    write: Write::Film(bounces),
});

/// Number of parts that light is kept apart in for a number of scattering events at most.
pub fn bounce_parts(max_events: u32) -> usize {
    (max_events as usize).saturating_add(1).min(MOST_BOUNCES)
}

/// Parts of each pixel's light.
fn parts(film: &Film) -> usize {
    film.layers.by_light.len() / film.pixels.len().max(1)
}

/// Adds the light of each number of scattering events.
fn bounces(film: &Film, _names: &Names, image: &mut Image) {
    let count = parts(film);
    for bounce in 0..count {
        let name = if bounce + 1 == MOST_BOUNCES { "bounce.rest".into() } else { format!("bounce.{bounce:02}") };
        part(image, &name, film, (bounce, count));
    }
}

/// The picture as the sum of its layers of bounces, in their order: equal to it to the bit.
pub(super) fn sum_of_bounces(film: &Film) -> Vec<[f32; 3]> {
    let of_pixel = |(p, parts): (&Pixel, &[[f64; 3]])| {
        let add = |sum: [f32; 3], part: &[f64; 3]| std::array::from_fn(|c| sum[c] + mean(part[c], p));
        parts.iter().fold([0.0; 3], add)
    };
    film.pixels.iter().zip(film.layers.by_light.chunks(parts(film).max(1))).map(of_pixel).collect()
}

/// Mean over a pixel's samples of a sum.
fn mean(sum: f64, pixel: &Pixel) -> f32 {
    held(sum / f64::from(pixel.samples.max(1)))
}

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
        let plane = sums.map(|(sum, p)| mean(sum[c], p)).collect();
        push(image, &format!("{name}.{n}"), plane);
    }
}
