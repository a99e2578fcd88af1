//! The graph of passes as a picture: a box with its name for each pass, in columns from left to right, and lines from
//! where something is written to where it is read.

use super::graph::Graph;
use steradian_math::Vec3;

const BACKGROUND: Vec3 = Vec3::new(0.01, 0.012, 0.016);
const BOX: Vec3 = Vec3::new(0.06, 0.12, 0.22);
const LINE: Vec3 = Vec3::new(0.35, 0.3, 0.12);
const TEXT: Vec3 = Vec3::ONE;

/// Letters from a to z, 3 pixels wide and 5 high: rows from the top, three bits each, the left one highest.
const LETTERS: [u16; 26] = [
    0b010_101_111_101_101,
    0b110_101_110_101_110,
    0b011_100_100_100_011,
    0b110_101_101_101_110,
    0b111_100_110_100_111,
    0b111_100_110_100_100,
    0b011_100_101_101_011,
    0b101_101_111_101_101,
    0b111_010_010_010_111,
    0b001_001_001_101_010,
    0b101_101_110_101_101,
    0b100_100_100_100_111,
    0b101_111_111_101_101,
    0b110_101_101_101_101,
    0b010_101_101_101_010,
    0b110_101_110_100_100,
    0b010_101_101_110_011,
    0b110_101_110_101_101,
    0b011_100_010_001_110,
    0b111_010_010_010_010,
    0b101_101_101_101_111,
    0b101_101_101_101_010,
    0b101_101_111_111_101,
    0b101_101_010_101_101,
    0b101_101_010_010_010,
    0b111_001_010_100_111,
];

/// A picture of a size under way.
struct Canvas {
    pixels: Vec<Vec3>,
    size: [i64; 2],
}

impl Canvas {
    fn set(&mut self, [x, y]: [i64; 2], color: Vec3) {
        if (0..self.size[0]).contains(&x) && (0..self.size[1]).contains(&y) {
            self.pixels[(y * self.size[0] + x) as usize] = color;
        }
    }

    fn fill(&mut self, [x0, y0]: [i64; 2], [w, h]: [i64; 2], color: Vec3) {
        // What is beyond the picture is left out before it is walked over.
        for y in y0.max(0)..(y0 + h).min(self.size[1]) {
            for x in x0.max(0)..(x0 + w).min(self.size[0]) {
                self.set([x, y], color);
            }
        }
    }

    /// A line of a width.
    fn line(&mut self, [ax, ay]: [i64; 2], [bx, by]: [i64; 2], width: i64) {
        // Digital differential analyser: one brush position for each step along the longer axis.
        let steps = (bx - ax).abs().max((by - ay).abs()).max(1);
        for k in 0..=steps {
            let at = [ax + (bx - ax) * k / steps, ay + (by - ay) * k / steps];
            self.fill(at, [width, width], LINE);
        }
    }

    /// A text, by pixels of a size.
    fn text(&mut self, text: &str, [x, y]: [i64; 2], scale: i64) {
        for (k, letter) in text.bytes().enumerate() {
            let Some(bits) = letter.checked_sub(b'a').and_then(|l| LETTERS.get(usize::from(l))) else { continue };
            for dot in (0..15).filter(|dot| bits >> (14 - dot) & 1 != 0) {
                let at = [x + (4 * k as i64 + dot % 3) * scale, y + dot / 3 * scale];
                self.fill(at, [scale, scale], TEXT);
            }
        }
    }
}

/// Draws a graph.
pub fn draw(graph: &Graph, [width, height]: [u32; 2]) -> Vec<Vec3> {
    let size = [i64::from(width), i64::from(height)];
    let mut canvas = Canvas { pixels: vec![BACKGROUND; (width * height) as usize], size };
    // Columns are the levels of the graph; passes of one level share a column evenly.
    let levels = graph.levels();
    let columns = levels.iter().max().map_or(1, |level| level + 1) as i64;
    let longest = graph.passes().iter().map(|p| p.name.len()).max().unwrap_or(1) as i64;
    let column = size[0] / columns;
    // As large as names fit in three quarters of a column.
    let scale = (column * 3 / 4 / (4 * longest + 3)).clamp(1, 4);
    let [w, h] = [(4 * longest + 3) * scale, 9 * scale];
    let place = |k: usize| {
        let level = levels[k];
        let rows = levels.iter().filter(|l| **l == level).count() as i64;
        let row = levels[..k].iter().filter(|l| **l == level).count() as i64;
        [level as i64 * column + (column - w) / 2, (2 * row + 1) * size[1] / (2 * rows) - h / 2]
    };
    // Draw lines first, so that boxes cover their ends.
    for (k, node) in graph.passes().iter().enumerate() {
        let readers =
            graph.passes().iter().enumerate().filter(|(_, r)| r.reads.iter().any(|x| node.writes.contains(x)));
        for (reader, _) in readers {
            let ([ax, ay], [bx, by]) = (place(k), place(reader));
            canvas.line([ax + w, ay + h / 2], [bx, by + h / 2], (scale / 2).max(1));
        }
    }
    for (k, node) in graph.passes().iter().enumerate() {
        let [x, y] = place(k);
        canvas.fill([x, y], [w, h], BOX);
        canvas.text(node.name, [x + 2 * scale, y + 2 * scale], scale);
    }
    canvas.pixels
}
