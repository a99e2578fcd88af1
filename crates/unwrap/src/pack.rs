//! Packing of charts, as in the game of Tetris (Lévy, Petitjean, Ray and Maillot 2002): the horizon is the height up to
//! which each column of texels is taken; charts come in the order of their sizes, and each falls to where its top is
//! lowest, upright or turned by a right angle. The scale is the largest found at which all fit.
//!
//! Heights count in sixteenths of a texel, rounded outwards. The upper outline of a chart is widened by the padding to all
//! sides, so that charts keep that distance.

use crate::flatten::Flat;
use std::collections::VecDeque;
use steradian_math::DVec2;

/// Steps of height per texel.
const STEPS: i32 = 16;

/// Places that are looked at in one try, times the columns of charts. Beyond it, places are first looked for in steps.
const EFFORT: f64 = 4e7;

/// Bisections of the scale.
const BISECTIONS: u32 = 5;

/// Place of a chart.
#[derive(Clone, Copy, Debug, Default)]
pub struct Place {
    /// True if the chart is turned left by a right angle.
    pub is_turned: bool,
    /// Lower left corner of its box, texels.
    pub at: DVec2,
}

impl Place {
    /// A point of a chart with a box of a size, in texels.
    pub fn texel(&self, p: DVec2, size: DVec2, scale: f64) -> DVec2 {
        self.at + turned(p, size, self.is_turned) * scale
    }
}

fn turned(p: DVec2, size: DVec2, is_turned: bool) -> DVec2 {
    if is_turned { DVec2::new(size.y - p.y, p.x) } else { p }
}

/// Packs charts into a square of so many texels: texels per unit of length, and places. Nothing if they do not fit.
pub fn pack(charts: &[Flat], resolution: u32, padding: u32) -> Option<(f64, Vec<Place>)> {
    // The margin at each side of the square makes up the padding where atlases repeat.
    let margin = padding.div_ceil(2);
    let side = (resolution - 2 * margin) as usize;
    let least = (f64::from(padding) + 1.0).powi(2) * charts.len() as f64;
    if least > f64::from(resolution).powi(2) {
        return None;
    }
    let area: f64 = charts.iter().map(|c| c.chart.area).sum();
    let longest = charts.iter().map(|c| c.size.x).fold(0.0, f64::max);
    let mut order: Vec<u32> = (0..charts.len() as u32).collect();
    order.sort_by(|a, b| charts[*b as usize].size.x.total_cmp(&charts[*a as usize].size.x).then(a.cmp(b)));
    let attempt = |scale: f64| Packing::new(charts, side, padding as usize, scale).all(&order);
    let mut high = (side as f64 / area.sqrt()).min(side as f64 / longest);
    let mut low = 0.85 * high;
    let mut best = loop {
        match attempt(low) {
            Some(places) => break places,
            None => (low, high) = (0.85 * low, low),
        }
        // All charts are specks then, and take as much as they ever will.
        if low * longest < 0.01 {
            return None;
        }
    };
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (low + high);
        match attempt(middle) {
            Some(places) => (low, best) = (middle, places),
            None => high = middle,
        }
    }
    best.iter_mut().for_each(|place| place.at += f64::from(margin));
    Some((low, best))
}

/// Outline of a chart by columns of texels.
struct Outline {
    /// Lowest point in each column, steps.
    low: Vec<i32>,
    /// Highest point in each column, steps.
    high: Vec<i32>,
    /// Height of the whole, steps.
    top: i32,
}

impl Outline {
    fn new(chart: &Flat, scale: f64, is_turned: bool) -> Self {
        let point = |i: u32| turned(chart.uvs[i as usize], chart.size, is_turned) * scale;
        let width = if is_turned { chart.size.y } else { chart.size.x };
        let columns = (width * scale) as usize + 1;
        let (mut low, mut high) = (vec![f64::INFINITY; columns], vec![f64::NEG_INFINITY; columns]);
        let border = &chart.chart.border;
        for (a, b) in border.iter().zip(border.iter().cycle().skip(1)) {
            let (a, b) = (point(*a), point(*b));
            let (left, right) = if a.x <= b.x { (a, b) } else { (b, a) };
            let column = |x: f64| (x.max(0.0) as usize).min(columns - 1);
            for k in column(left.x)..=column(right.x) {
                // The part of the side within the column.
                let at = |x: f64| {
                    let t = if right.x > left.x { (x - left.x) / (right.x - left.x) } else { 0.0 };
                    left.y + (right.y - left.y) * t.clamp(0.0, 1.0)
                };
                let mut ys = [at(k as f64), at((k + 1) as f64)];
                if column(left.x) == column(right.x) {
                    ys = [left.y, right.y];
                }
                low[k] = low[k].min(ys[0]).min(ys[1]);
                high[k] = high[k].max(ys[0]).max(ys[1]);
            }
        }
        let steps = |y: f64, round: fn(f64) -> f64| round(y * f64::from(STEPS)) as i32;
        let high: Vec<i32> = high.iter().map(|y| steps(*y, f64::ceil)).collect();
        let top = high.iter().copied().max().unwrap_or(0);
        Self { low: low.iter().map(|y| steps(*y, f64::floor)).collect(), high, top }
    }
}

/// A packing under way.
struct Packing<'a> {
    charts: &'a [Flat],
    padding: usize,
    scale: f64,
    /// Height up to which each column is taken, steps.
    horizon: Vec<i32>,
    stride: usize,
}

impl<'a> Packing<'a> {
    fn new(charts: &'a [Flat], side: usize, padding: usize, scale: f64) -> Self {
        let columns: f64 = charts.iter().map(|c| (c.size.x + c.size.y) * scale + 2.0).sum();
        let stride = (columns * side as f64 / EFFORT).ceil() as usize;
        Self { charts, padding, scale, horizon: vec![0; side], stride: stride.max(1) }
    }

    /// Places of all charts, or nothing where one finds none.
    fn all(mut self, order: &[u32]) -> Option<Vec<Place>> {
        let mut places = vec![Place::default(); self.charts.len()];
        for &i in order {
            places[i as usize] = self.next(&self.charts[i as usize])?;
        }
        Some(places)
    }

    fn next(&mut self, chart: &Flat) -> Option<Place> {
        let outlines = [false, true].map(|is_turned| Outline::new(chart, self.scale, is_turned));
        let [mut fall, mut turned] = outlines.each_ref().map(|outline| Fall::new(&self.horizon, outline));
        for fall in [&mut fall, &mut turned] {
            let last = (self.horizon.len() + 1).saturating_sub(fall.outline.low.len());
            (0..last).step_by(self.stride).for_each(|x| fall.look(x));
            // Around the best place, every column.
            let near = fall.x.saturating_sub(self.stride - 1)..(fall.x + self.stride).min(last);
            near.for_each(|x| fall.look(x));
        }
        let is_turned = turned.best < fall.best;
        let Fall { outline, best, x, y, .. } = if is_turned { turned } else { fall };
        if best.0 > self.horizon.len() as i32 * STEPS {
            return None;
        }
        let raised = y + self.padding as i32 * STEPS;
        for (column, high) in (x as isize - self.padding as isize..).zip(widened(&outline.high, self.padding)) {
            if let Some(h) = usize::try_from(column).ok().and_then(|column| self.horizon.get_mut(column)) {
                *h = (*h).max(raised + high);
            }
        }
        Some(Place { is_turned, at: DVec2::new(x as f64, f64::from(y) / f64::from(STEPS)) })
    }
}

/// Search for the place to which an outline falls.
struct Fall<'a> {
    horizon: &'a [i32],
    outline: &'a Outline,
    /// Height of the top and space below, the least so far; of equal ones the first counts.
    best: (i32, i64),
    x: usize,
    y: i32,
}

impl<'a> Fall<'a> {
    fn new(horizon: &'a [i32], outline: &'a Outline) -> Self {
        Self { horizon, outline, best: (i32::MAX, i64::MAX), x: 0, y: 0 }
    }

    fn look(&mut self, x: usize) {
        let low = &self.outline.low;
        let ground = &self.horizon[x..x + low.len()];
        let y = ground.iter().zip(low).fold(0, |y, (h, low)| y.max(h - low));
        let top = y + self.outline.top;
        if top > self.best.0 {
            return;
        }
        let space = ground.iter().zip(low).map(|(h, low)| i64::from(y + low - h)).sum();
        if (top, space) < self.best {
            (self.best, self.x, self.y) = ((top, space), x, y);
        }
    }
}

/// The largest value within a distance of each place, from that distance before the first to that after the last.
fn widened(values: &[i32], distance: usize) -> Vec<i32> {
    let mut widened = Vec::with_capacity(values.len() + 2 * distance);
    // Places whose values may still be the largest, which fall from front to back.
    let mut window: VecDeque<usize> = VecDeque::new();
    for end in 0..values.len() + 2 * distance {
        if let Some(&new) = values.get(end) {
            while window.back().is_some_and(|i| values[*i] <= new) {
                window.pop_back();
            }
            window.push_back(end);
        }
        while window.front().is_some_and(|i| i + 2 * distance < end) {
            window.pop_front();
        }
        widened.push(values[window[0]]);
    }
    widened
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outlines_are_widened() {
        assert_eq!(widened(&[1, 5, 2, 0, 0], 1), [1, 5, 5, 5, 2, 0, 0]);
        assert_eq!(widened(&[3], 2), [3; 5]);
        assert_eq!(widened(&[3, 4], 0), [3, 4]);
    }
}
