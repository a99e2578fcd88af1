//! `bsplinecurve`: tubes around cubic B-splines, in a text file of control points `x y z radius` with blank lines
//! between curves.

use super::{graph::ObjectId, reader::Reader, values};
use crate::files;
use steradian_scene::{Family, Node};

/// A control point with its radius.
type Knot = [f64; 4];

impl Reader<'_> {
    /// A node for each curve of the file.
    pub(super) fn curves(&mut self, object: ObjectId) -> Option<Vec<Node>> {
        let path = self.needed_file(object, "filename")?;
        let span = self.value_span(object, "filename");
        let bytes = files::read(&path, &self.options.limits).map_err(|e| self.error(span, e.to_string())).ok()?;
        self.desc.sources.note(&path);
        let curves = match parse(&String::from_utf8_lossy(&bytes)) {
            Ok(curves) => curves,
            Err(why) => {
                self.error(span, format!("'{}': {why}", path.display()));
                return None;
            }
        };
        let mut uneven = false;
        let nodes = curves.iter().map(|curve| {
            let (widths, is_even) = widths(curve);
            uneven |= !is_even;
            let points: Vec<f64> = curve.iter().flat_map(|k| [k[0], k[1], k[2]]).collect();
            self.node(Family::Shape, "curve", object)
                .with("points", points)
                .with("degree", 3_i64)
                .with("basis", "bspline")
                .with("type", "round")
                .with("width0", widths[0])
                .with("width1", widths[1])
        });
        let nodes = nodes.collect();
        if uneven {
            self.approximated(span, "radii of a curve grow evenly from its first to its last");
        }
        Some(nodes)
    }
}

fn parse(text: &str) -> Result<Vec<Vec<Knot>>, String> {
    let mut curves = vec![Vec::new()];
    for (i, line) in text.lines().enumerate() {
        let numbers = values::numbers(line).map_err(|e| format!("line {}: {e}", i + 1))?;
        match (numbers[..].try_into(), curves.last_mut()) {
            (Ok(knot), Some(curve)) => curve.push(knot),
            (Err(_), Some(curve)) if numbers.is_empty() => {
                if !curve.is_empty() {
                    curves.push(Vec::new());
                }
            }
            _ => return Err(format!("line {}: a control point and its radius are four numbers", i + 1)),
        }
    }
    curves.retain(|c| !c.is_empty());
    match curves.iter().find(|c| c.len() < 4) {
        Some(short) => Err(format!("a curve has at least 4 control points, not {}", short.len())),
        None if curves.is_empty() => Err("the file holds no curves".into()),
        None => Ok(curves),
    }
}

/// The widths at both ends, and whether the radii lead evenly from one to the other.
fn widths(curve: &[Knot]) -> ([f64; 2], bool) {
    let n = curve.len();
    let at = |i: usize| (curve[i][3] + 4.0 * curve[i + 1][3] + curve[i + 2][3]) / 6.0;
    let ends = [at(0), at(n - 3)];
    let spans = (n - 3) as f64;
    let largest = curve.iter().fold(0.0_f64, |m, k| m.max(k[3].abs()));
    let is_even = (0..=n - 3).all(|i| {
        let expected = ends[0] + (ends[1] - ends[0]) * i as f64 / spans;
        (at(i) - expected).abs() <= 1e-3 * largest
    });
    (ends.map(|r| 2.0 * r), is_even)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_are_control_points_with_radii() {
        let curves =
            parse("0 0 0 1\n1 0 0 1\n2 0 0 1\n3 0 0 1\n\n\n0 0 0 .4\n1 0 0 .3\n2 0 0 .2\n3 0 0 .1\n4 0 0 0\n").unwrap();
        assert_eq!((curves.len(), curves[1].len()), (2, 5));
        let ([a, b], is_even) = widths(&curves[1]);
        assert!((a - 0.6).abs() < 1e-12 && (b - 0.2).abs() < 1e-12 && is_even);
        assert!(parse("0 0 0 1\n1 0 0 1\n").unwrap_err().contains("at least 4"));
        assert!(parse("0 0 1\n").unwrap_err().starts_with("line 1"));
        assert!(parse("").is_err());
    }
}
