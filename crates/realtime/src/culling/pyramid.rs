//! Pyramids of reversed depths.

use std::ops::RangeInclusive;

/// The least, that is farthest, of the reversed depths in squares of a picture: pixels, and levels with squares twice
/// as wide each, up to one that covers all (Greene, Kass, Miller 1993, "Hierarchical Z-Buffer Visibility").
#[derive(Debug)]
pub struct Pyramid {
    levels: Vec<Level>,
}

#[derive(Debug)]
struct Level {
    columns: u32,
    rows: u32,
    /// By rows.
    least: Vec<f32>,
}

impl Pyramid {
    /// Pyramid over depths by rows.
    pub fn new(depths: Vec<f32>, [columns, rows]: [u32; 2]) -> Self {
        let mut levels = vec![Level { columns, rows, least: depths }];
        while let Some(next) = levels.last().and_then(Level::halved) {
            levels.push(next);
        }
        Self { levels }
    }

    /// True if what has no reversed depth above `nearest` is behind the picture in all pixels of a rectangle.
    pub fn hides(&self, nearest: f64, rectangle: &[RangeInclusive<u32>; 2]) -> bool {
        self.is_behind(self.levels.len() - 1, [0, 0], nearest, rectangle)
    }

    /// From the coarsest squares on, to finer ones where a square does not tell.
    fn is_behind(&self, level: usize, [x, y]: [u32; 2], depth: f64, rectangle: &[RangeInclusive<u32>; 2]) -> bool {
        let squares = &self.levels[level];
        let touches = |axis: usize, at: u32| {
            let first = u64::from(at) << level;
            first <= u64::from(*rectangle[axis].end()) && first + (1 << level) > u64::from(*rectangle[axis].start())
        };
        if x >= squares.columns || y >= squares.rows || !touches(0, x) || !touches(1, y) {
            return true;
        }
        if depth < f64::from(squares.least[(y * squares.columns + x) as usize]) {
            return true;
        }
        level > 0 && (0..4).all(|i| self.is_behind(level - 1, [2 * x + (i & 1), 2 * y + (i >> 1)], depth, rectangle))
    }
}

impl Level {
    /// With squares twice as wide; `None` for a single square.
    fn halved(&self) -> Option<Self> {
        if self.columns <= 1 && self.rows <= 1 {
            return None;
        }
        let (columns, rows) = (self.columns.div_ceil(2), self.rows.div_ceil(2));
        let at = |x: u32, y: u32| self.least[(y.min(self.rows - 1) * self.columns + x.min(self.columns - 1)) as usize];
        let of_four = |x: u32, y: u32| (0..4).map(|i| at(2 * x + (i & 1), 2 * y + (i >> 1))).fold(f32::MAX, f32::min);
        let least = (0..rows).flat_map(|y| (0..columns).map(move |x| (x, y))).map(|(x, y)| of_four(x, y)).collect();
        Some(Self { columns, rows, least })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rectangles are compared as a search over their pixels compares them.
    #[test]
    fn rectangles_are_behind_all_their_pixels() {
        let size = [13, 7];
        let depths: Vec<f32> = (0..13 * 7).map(|i: u32| (i.wrapping_mul(0x9e37_79b9) >> 28) as f32 + 1.0).collect();
        let pyramid = Pyramid::new(depths.clone(), size);
        for (x0, y0, w, h) in (0..13).flat_map(|x| (0..7).map(move |y| (x, y, 1 + y % 3, 1 + x % 2))) {
            let rectangle = [x0..=(x0 + w - 1).min(12), y0..=(y0 + h - 1).min(6)];
            let least = rectangle[1]
                .clone()
                .flat_map(|y| rectangle[0].clone().map(move |x| (x, y)))
                .map(|(x, y)| depths[(y * 13 + x) as usize])
                .fold(f32::MAX, f32::min);
            assert!(pyramid.hides(f64::from(least) - 0.5, &rectangle));
            assert!(!pyramid.hides(f64::from(least), &rectangle));
        }
    }
}
