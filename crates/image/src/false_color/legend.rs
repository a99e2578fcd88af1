//! A bar of colours beside a picture, with ticks and what they stand for.

use super::{Scale, font, map};

const WHITE: [u8; 3] = [255; 3];
const BLACK: [u8; 3] = [0; 3];
/// Lengths in pixels of a letter: around everything, the bar's width, a tick, from a tick to its label.
const MARGIN: usize = 6;
const BAR: usize = 14;
const TICK: usize = 4;
const GAP: usize = 3;
/// Least height of a legend.
const LEAST: usize = 64;
/// Pixels of the picture's height for each pixel of a letter.
const PER_PIXEL: f64 = 300.0;

/// A picture with a legend at its right: the width, and the pixels by rows. Where the picture is lower than a legend,
/// white comes below it.
pub(super) fn beside(colours: &[[u8; 3]], size: [usize; 2], scale: &Scale, unit: &str) -> (usize, Vec<[u8; 3]>) {
    let zoom = ((size[1] as f64 / PER_PIXEL).round() as usize).max(1);
    let height = size[1].max(LEAST * zoom);
    let top = (2 * MARGIN + font::SIZE[1]) * zoom;
    let rows = height - top - (MARGIN + font::SIZE[1] / 2) * zoom;
    let ticks = ticks(scale, rows / (2 * font::SIZE[1] * zoom));
    let labels = ticks.iter().map(|t| font::width(&t.1)).max().unwrap_or(0);
    let inner = (BAR + TICK + GAP + labels).max(font::width(unit));
    let width = size[0] + (2 * MARGIN + inner) * zoom;
    let mut pixels = vec![WHITE; width * height];
    for (from, to) in colours.chunks(size[0].max(1)).zip(pixels.chunks_mut(width)) {
        to[..from.len()].copy_from_slice(from);
    }
    let mut canvas = Canvas { pixels: &mut pixels, width, zoom };
    let left = size[0] + MARGIN * zoom;
    canvas.text([left, MARGIN * zoom], unit);
    for row in 0..rows {
        let t = 1.0 - row as f64 / (rows - 1) as f64;
        canvas.fill([left, top + row], [BAR * zoom, 1], map::color(t));
    }
    for (value, label) in &ticks {
        let middle = top + row_of(scale.place(*value), rows);
        canvas.fill([left + BAR * zoom, middle - zoom / 2], [TICK * zoom, zoom], BLACK);
        canvas.text([left + (BAR + TICK + GAP) * zoom, middle - font::SIZE[1] * zoom / 2], label);
    }
    (width, pixels)
}

/// The bar's row, from its top, at a place of the scale.
fn row_of(t: f64, rows: usize) -> usize {
    ((1.0 - t) * (rows - 1) as f64).round() as usize
}

struct Canvas<'a> {
    pixels: &'a mut [[u8; 3]],
    width: usize,
    zoom: usize,
}

impl Canvas<'_> {
    fn fill(&mut self, [x, y]: [usize; 2], [w, h]: [usize; 2], color: [u8; 3]) {
        for row in y..y + h {
            self.pixels[row * self.width + x..row * self.width + x + w].fill(color);
        }
    }

    fn text(&mut self, [x, y]: [usize; 2], text: &str) {
        for [dx, dy] in font::pixels(text) {
            self.fill([x + dx * self.zoom, y + dy * self.zoom], [self.zoom; 2], BLACK);
        }
    }
}

/// Round numbers between the ends of a scale, and how they are written: as many as keep apart, of so many places that
/// do.
fn ticks(scale: &Scale, places: usize) -> Vec<(f64, String)> {
    let apart = 1.0 / places.max(2) as f64;
    let keep_apart = |ticks: &Vec<(f64, String)>| {
        let places = ticks.windows(2).map(|w| scale.place(w[1].0) - scale.place(w[0].0));
        ticks.len() >= 2 && places.fold(f64::INFINITY, f64::min) >= apart
    };
    let logarithmic: &[(&[u32], i32)] =
        &[(&[1, 2, 3, 5, 7], 1), (&[1, 2, 5], 1), (&[1, 3], 1), (&[1], 1), (&[1], 2), (&[1], 5), (&[1], 10)];
    let found = logarithmic.iter().filter(|_| !scale.is_linear).map(|(digits, every)| decades(scale, digits, *every));
    found.into_iter().find(keep_apart).unwrap_or_else(|| {
        let ticks = even(scale, apart);
        // One number is no scale; at half the distance labels do not touch yet.
        if ticks.len() < 2 { even(scale, 0.5 * apart) } else { ticks }
    })
}

/// Some digits of every so many decades.
fn decades(scale: &Scale, digits: &[u32], every: i32) -> Vec<(f64, String)> {
    let [first, last] = scale.ends.map(|end| end.log10().floor() as i32);
    let exponents = (first..=last).filter(|e| e.rem_euclid(every) == 0);
    exponents.flat_map(|e| digits.iter().filter_map(move |d| labelled(i64::from(*d), e, scale))).collect()
}

/// Multiples of 1, 2 or 5 of a power of ten, the closest that keep apart.
fn even(scale: &Scale, apart: f64) -> Vec<(f64, String)> {
    let [low, high] = scale.ends;
    let least = (high - low) * apart;
    let exponent = least.log10().floor() as i32;
    let steps = [(1, exponent), (2, exponent), (5, exponent), (1, exponent + 1)];
    let value = |(digit, exponent): (i64, i32)| digit as f64 * 10_f64.powi(exponent);
    // Rounding may put a step a little below.
    let step = steps.into_iter().find(|s| value(*s) >= least * 0.999).unwrap_or((1, exponent + 1));
    let first = (low / value(step) - 1e-6).ceil();
    // Beyond these numbers are no longer told apart.
    if first.abs() > 1e12 {
        return Vec::new();
    }
    let multiples = (0..).map(|k| first as i64 + k).take_while(|k| *k as f64 * value(step) <= high * (1.0 + 1e-6));
    multiples.take(100).filter_map(|k| labelled(k * step.0, step.1, scale)).collect()
}

/// `digits · 10^exponent` and its label, where it is on the scale.
fn labelled(digits: i64, exponent: i32, scale: &Scale) -> Option<(f64, String)> {
    let value: f64 = format!("{digits}e{exponent}").parse().ok()?;
    let [low, high] = scale.ends;
    let slack = 1e-9 * (high - low);
    let is_plain = value == 0.0 || (1e-3..1e6).contains(&value.abs());
    let label = if is_plain { value.to_string() } else { format!("{value:e}") };
    (low - slack..=high + slack).contains(&value).then_some((value, label))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(is_linear: bool, ends: [f64; 2], places: usize) -> String {
        let scale = Scale { is_linear, ends };
        ticks(&scale, places).into_iter().map(|t| t.1).collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn ticks_are_round_numbers() {
        assert_eq!(labels(false, [1.0, 1e4], 8), "1 10 100 1000 10000");
        assert_eq!(labels(false, [1.0, 1e4], 10), "1 3 10 30 100 300 1000 3000 10000");
        assert_eq!(labels(false, [0.5, 120.0], 14), "0.5 1 2 5 10 20 50 100");
        assert_eq!(labels(false, [1e-9, 1e9], 10), "1e-8 1e-6 1e-4 0.01 1 100 10000 1e6 1e8");
        assert_eq!(labels(false, [100.0, 120.0], 10), "100 102 104 106 108 110 112 114 116 118 120");
        assert_eq!(labels(true, [0.0, 1.0], 5), "0 0.2 0.4 0.6 0.8 1");
        assert_eq!(labels(true, [-3.0, 72_983.0], 8), "0 10000 20000 30000 40000 50000 60000 70000");
        assert_eq!(labels(true, [0.0, 3e-6], 3), "0 1e-6 2e-6 3e-6");
    }

    /// The bar has the colour of each tick's value in its row, within half a row of the bar.
    #[test]
    fn ticks_stand_at_their_colours() {
        for (size, ends) in [([20, 400], [1.0, 1e4]), ([7, 5], [0.3, 0.9]), ([1, 1300], [2e-7, 6e3])] {
            let scale = Scale { is_linear: false, ends };
            let (width, pixels) = beside(&vec![[9; 3]; size[0] * size[1]], size, &scale, "cd/m²");
            let zoom = ((size[1] as f64 / 300.0).round() as usize).max(1);
            let (top, left) = (19 * zoom, size[0] + 6 * zoom);
            let rows = pixels.len() / width - top - 9 * zoom;
            let found = ticks(&scale, rows / (14 * zoom));
            assert!(found.len() >= 2, "{found:?}");
            for (value, _) in found {
                let row = top + row_of(scale.place(value), rows);
                let at = |x: usize| pixels[row * width + x];
                assert_eq!(at(left + 14 * zoom), BLACK, "a tick at {value}");
                let (bar, expected) = (at(left), map::color((value / ends[0]).ln() / (ends[1] / ends[0]).ln()));
                let off = bar.iter().zip(expected).map(|(b, e)| b.abs_diff(e)).max();
                assert!(
                    off.is_some_and(|o| f64::from(o) <= 1.0 + 350.0 / rows as f64),
                    "{value}: {bar:?} {expected:?}"
                );
            }
            assert_eq!(pixels[..size[0]], vec![[9; 3]; size[0]]);
        }
    }

    /// A label is drawn where the font says.
    #[test]
    fn text_is_drawn_enlarged() {
        let mut pixels = vec![WHITE; 30 * 20];
        Canvas { pixels: &mut pixels, width: 30, zoom: 2 }.text([1, 2], "-1");
        let row = |y: usize| pixels[y * 30..y * 30 + 30].iter().map(|p| if *p == BLACK { '#' } else { '.' }).collect();
        let [first, middle]: [String; 2] = [row(2), row(9)];
        assert_eq!(first, ".................##...........");
        assert_eq!(middle, ".##########......##...........");
    }
}
