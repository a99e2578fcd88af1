//! Strands: UsdGeomBasisCurves, as tubes of one mesh, and UsdGeomPoints, as spheres.

use super::{
    Loss, Reader,
    look::Channels,
    mesh::Part,
    nodes::{Drawn, Form, Inherited, MOST_DRAWN},
    stage::Prim,
    value::Value,
};
use glam::Vec3;
use std::{
    collections::HashMap,
    f32::consts::{PI, TAU},
    sync::Arc,
};
use steradian_math::{DMat4, DVec3};
use steradian_scene::{Attribute, Domain, Instance, Mesh};

/// Sides of a tube and most pieces of a segment, the finest first. Sides are odd: the width that is seen then hardly
/// depends on the direction.
const FINENESS: [(usize, usize); 4] = [(9, 16), (7, 4), (5, 2), (3, 1)];
/// Most triangles of the tubes of a prim.
const MOST_TRIANGLES: usize = 12_000_000;
/// Largest deviation of a piece from its curve, in widths.
const TOLERANCE: f32 = 0.05;
/// Width of what has none, of the box around.
const THIN: f32 = 1e-3;
/// Most colours of points; where there are more, they are rounded to so many.
const MOST_COLORS: usize = 4096;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Basis {
    Linear,
    Bezier,
    BSpline,
    CatmullRom,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Wrap {
    Open,
    Pinned,
    Closed,
}

/// Rule by which control points are a curve.
#[derive(Clone, Copy, Debug)]
struct Rule {
    basis: Basis,
    wrap: Wrap,
}

impl Rule {
    /// Number of segments of a curve of so many control points; `None` where there are no such curves.
    fn segments(self, n: usize) -> Option<usize> {
        match (self.basis, self.wrap) {
            (Basis::Bezier, Wrap::Closed) => (n >= 3 && n.is_multiple_of(3)).then_some(n / 3),
            (Basis::Bezier, _) => (n >= 4 && (n - 4).is_multiple_of(3)).then(|| (n - 4) / 3 + 1),
            (_, Wrap::Closed) => (n >= 3).then_some(n),
            (Basis::Linear, _) | (_, Wrap::Pinned) => (n >= 2).then(|| n - 1),
            _ => (n >= 4).then(|| n - 3),
        }
    }

    /// Number of its values that vary linearly, from joint to joint.
    fn joints(self, n: usize) -> usize {
        self.segments(n).map_or(0, |s| if self.wrap == Wrap::Closed { s } else { s + 1 })
    }

    /// A place on a curve of `n` control points.
    fn place(self, n: usize, segment: usize, t: f32) -> Place {
        let s = 1.0 - t;
        let weights = match self.basis {
            Basis::Linear => [s, t, 0.0, 0.0],
            Basis::Bezier => [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t],
            Basis::BSpline => [
                s * s * s / 6.0,
                (4.0 + t * t * (3.0 * t - 6.0)) / 6.0,
                (1.0 + 3.0 * t * (1.0 + t * s)) / 6.0,
                t * t * t / 6.0,
            ],
            Basis::CatmullRom => [
                -0.5 * t * s * s,
                1.0 + 0.5 * t * t * (3.0 * t - 5.0),
                0.5 * t * (1.0 + t * (4.0 - 3.0 * t)),
                -0.5 * t * t * s,
            ],
        };
        let is_local = matches!(self.basis, Basis::BSpline | Basis::CatmullRom);
        let is_pinned = is_local && self.wrap == Wrap::Pinned;
        let first = if self.basis == Basis::Bezier { 3 * segment } else { segment };
        let mut points = [(0, 0.0); 6];
        let mut free = points.iter_mut();
        let mut add = |k: usize, weight: f32| {
            if let Some(slot) = free.next() {
                *slot = (k, weight);
            }
        };
        for (k, weight) in weights.into_iter().enumerate().filter(|(_, w)| *w != 0.0) {
            let k = first + k;
            if is_pinned && k == 0 {
                // Ends of pinned curves go on as far as they came.
                add(0, 2.0 * weight);
                add(1, -weight);
            } else if is_pinned && k > n {
                add(n - 1, 2.0 * weight);
                add(n - 2, -weight);
            } else {
                add((k - usize::from(is_pinned)) % n, weight);
            }
        }
        let next = if self.wrap == Wrap::Closed { (segment + 1) % self.joints(n).max(1) } else { segment + 1 };
        Place { points, joints: [segment, next], t }
    }
}

/// A place on a curve.
struct Place {
    /// Control points and their weights.
    points: [(usize, f32); 6],
    /// Joints before and after it, with the way between them.
    joints: [usize; 2],
    t: f32,
}

/// One curve of many.
struct Strand {
    /// The first of its control points, and their number.
    first: usize,
    n: usize,
    segments: usize,
    /// The first of its joints.
    joint: usize,
}

/// Elements that have one value each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Over {
    All,
    Curve,
    Joint,
    Point,
}

/// Values over curves or points.
struct Values {
    values: Vec<f32>,
    width: usize,
    over: Over,
}

impl Values {
    fn get(&self, element: usize) -> &[f32] {
        self.values.get(element * self.width..(element + 1) * self.width).unwrap_or_default()
    }

    /// The value at a place of a curve.
    fn at<const N: usize>(&self, curve: usize, strand: &Strand, place: &Place) -> [f32; N] {
        let mut sum = [0.0; N];
        let mut add = |element: usize, weight: f32| {
            sum.iter_mut().zip(self.get(element)).for_each(|(sum, v)| *sum += weight * v);
        };
        match self.over {
            Over::All => add(0, 1.0),
            Over::Curve => add(curve, 1.0),
            Over::Joint => {
                add(strand.joint + place.joints[0], 1.0 - place.t);
                add(strand.joint + place.joints[1], place.t);
            }
            Over::Point => place.points.iter().filter(|p| p.1 != 0.0).for_each(|(k, w)| add(strand.first + k, *w)),
        }
        sum
    }
}

/// Tubes under way.
struct Tubes<'a> {
    rule: Rule,
    points: &'a Values,
    widths: &'a Values,
    strands: &'a [Strand],
}

impl Tubes<'_> {
    fn point(&self, curve: usize, strand: &Strand, place: &Place) -> Vec3 {
        Vec3::from(self.points.at::<3>(curve, strand, place))
    }

    /// Pieces into which a segment is cut.
    fn pieces(&self, curve: usize, strand: &Strand, segment: usize, most: usize) -> usize {
        if self.rule.basis == Basis::Linear || most == 1 {
            return 1;
        }
        let at = |t: f32| self.rule.place(strand.n, segment, t);
        let [a, b, c, d, e] = [0.0, 0.25, 0.5, 0.75, 1.0].map(|t| self.point(curve, strand, &at(t)));
        let bend = [(b, 0.25), (c, 0.5), (d, 0.75)].map(|(p, t)| p.distance(a.lerp(e, t)));
        let [width] = self.widths.at::<1>(curve, strand, &at(0.5));
        let needed = (bend.into_iter().fold(0.0, f32::max) / (TOLERANCE * width)).sqrt().ceil();
        if needed.is_finite() { (needed as usize).clamp(1, most) } else { 1 }
    }

    /// Triangles at a fineness.
    fn count(&self, (sides, most): (usize, usize)) -> usize {
        let pieces = self.strands.iter().enumerate().flat_map(|(curve, strand)| {
            (0..strand.segments).map(move |segment| self.pieces(curve, strand, segment, most))
        });
        pieces.sum::<usize>().saturating_mul(2 * sides)
    }

    /// The mesh, with further values at its vertices.
    fn mesh(&self, (sides, most): (usize, usize), uvs: Option<&Values>, color: Option<&Values>) -> Mesh {
        let mut mesh = Mesh::default();
        let (mut triangles, mut colors) = (Vec::new(), Vec::new());
        // As wide in the mean over directions as a round tube (Cauchy: the perimeter over π).
        let half = PI / sides as f32;
        let wide = half / half.sin();
        for (curve, strand) in self.strands.iter().enumerate() {
            let mut places = vec![self.rule.place(strand.n, 0, 0.0)];
            for segment in 0..strand.segments {
                let pieces = self.pieces(curve, strand, segment, most);
                let place = |k: usize| self.rule.place(strand.n, segment, k as f32 / pieces as f32);
                places.extend((1..=pieces).map(place));
            }
            let at: Vec<Vec3> = places.iter().map(|place| self.point(curve, strand, place)).collect();
            let (last, is_closed) = (at.len() - 1, self.rule.wrap == Wrap::Closed);
            let (mut along, mut aside) = (Vec3::Z, Vec3::X);
            for (k, (place, p)) in places.iter().zip(&at).enumerate() {
                let before = if k > 0 {
                    k - 1
                } else if is_closed {
                    last - 1
                } else {
                    0
                };
                let after = if k < last {
                    k + 1
                } else if is_closed {
                    1
                } else {
                    last
                };
                let ends = [before, after].map(|k| at.get(k).copied().unwrap_or(*p));
                along = (ends[1] - ends[0]).try_normalize().unwrap_or(along);
                // The frame turns as little as it can.
                let turned = (aside - along * aside.dot(along)).try_normalize();
                aside = turned.filter(|_| k > 0).unwrap_or_else(|| along.any_orthonormal_vector());
                let up = along.cross(aside);
                let [width] = self.widths.at::<1>(curve, strand, place);
                let radius = 0.5 * width.max(0.0) * wide;
                let first = mesh.positions.len() as u32;
                for side in 0..sides {
                    let (sin, cos) = (TAU * side as f32 / sides as f32).sin_cos();
                    let n = aside * cos + up * sin;
                    mesh.positions.push((*p + n * radius).to_array());
                    mesh.normals.push(n.to_array());
                    mesh.uvs.extend(uvs.map(|v| v.at::<2>(curve, strand, place)));
                    colors.extend(color.map(|v| v.at::<3>(curve, strand, place)).into_iter().flatten());
                    let [a, b] = [side, (side + 1) % sides].map(|side| first + side as u32);
                    if k < last {
                        let [c, d] = [a, b].map(|v| v + sides as u32);
                        triangles.extend([[a, b, d], [a, d, c]]);
                    }
                }
            }
        }
        mesh.triangles = triangles.into();
        if color.is_some() {
            let name = "displayColor".into();
            mesh.attributes = vec![Attribute { name, domain: Domain::Vertex, channels: 3, data: colors }];
        }
        mesh
    }
}

impl Reader<'_> {
    /// The tubes of a prim of curves.
    pub(super) fn strands(&mut self, prim: &Prim) -> Vec<Part> {
        self.tubes(prim).into_iter().collect()
    }

    fn tubes(&mut self, prim: &Prim) -> Option<Part> {
        let rule = self.rule(prim)?;
        let points = self.positions(prim)?;
        let counts = self.integers(prim, "curveVertexCounts")?;
        let (mut strands, mut first, mut joint) = (Vec::with_capacity(counts.len()), 0, 0);
        for (k, n) in counts.iter().map(|n| *n as usize).enumerate() {
            let Some(segments) = rule.segments(n) else {
                let message = format!("curve {k} has {n} points, which are no such curve ({rule:?})");
                self.fault(prim, "curveVertexCounts", message);
                return None;
            };
            strands.push(Strand { first, n, segments, joint });
            (first, joint) = (first.saturating_add(n), joint + rule.joints(n));
        }
        let there = points.values.len() / 3;
        if first != there {
            self.fault(prim, "curveVertexCounts", format!("the curves have {first} points, and {there} are given"));
            return None;
        }
        let sizes = [counts.len(), joint, there];
        let widths = self.widths(prim, &points, sizes)?;
        if self.stage.value(prim, "normals").is_some() {
            self.count(Loss::Approximated("ribbons of curves (normals) are tubes".into()), prim, None);
        }
        let uvs = self.spread(prim, "primvars:st", 2, sizes);
        let color = self.spread(prim, "primvars:displayColor", 3, sizes).filter(|c| c.over != Over::All);
        let tubes = Tubes { rule, points: &points, widths: &widths, strands: &strands };
        let fineness = FINENESS.into_iter().find(|fineness| tubes.count(*fineness) <= MOST_TRIANGLES);
        let needed = fineness.map_or(u64::MAX, |f| tubes.count(f) as u64 * 40);
        let Some(fineness) = fineness.filter(|_| self.stage.options.limits.shortage(needed).is_none()) else {
            self.fault(prim, "curveVertexCounts", "these are too many curves".into());
            return None;
        };
        if fineness != FINENESS[0] {
            let what = format!("its many curves are tubes of {} sides, and cut coarsely", fineness.0);
            self.count(Loss::Approximated(what), prim, None);
        }
        let mesh = tubes.mesh(fineness, uvs.as_ref(), color.as_ref());
        if mesh.triangles.is_empty() {
            return None;
        }
        if let Err(fault) = mesh.validate() {
            self.fault(prim, "points", fault.to_string());
            return None;
        }
        let channels = Channels { color: color.is_some() };
        Some(Part { mesh: self.stage.import.desc.add_mesh(Arc::new(mesh)), subset: None, channels })
    }

    fn rule(&mut self, prim: &Prim) -> Option<Rule> {
        let word = |reader: &mut Self, name: &str, default: &str| reader.word(prim, name).unwrap_or(default.into());
        let basis = match word(self, "type", "cubic").as_str() {
            "linear" => "linear".into(),
            _ => word(self, "basis", "bezier"),
        };
        let basis = match basis.as_str() {
            "linear" => Basis::Linear,
            "bezier" => Basis::Bezier,
            "bspline" => Basis::BSpline,
            "catmullRom" => Basis::CatmullRom,
            other => {
                let what = format!("curves by '{other}' are left out");
                self.count(Loss::Dropped(what), prim, Some("basis"));
                return None;
            }
        };
        let wrap = match word(self, "wrap", "nonperiodic").as_str() {
            "periodic" => Wrap::Closed,
            "pinned" => Wrap::Pinned,
            _ => Wrap::Open,
        };
        Some(Rule { basis, wrap })
    }

    /// The points of a prim; `None`, told, where there are none.
    fn positions(&mut self, prim: &Prim) -> Option<Values> {
        let value = self.stage.value(prim, "points");
        let Some(values) = value.as_ref().and_then(Value::floats).filter(|v| v.len() >= 3) else {
            self.count(Loss::Dropped("what has no points is left out".into()), prim, None);
            return None;
        };
        if values.len() % 3 != 0 || !values.iter().all(|v| v.is_finite() && v.abs() < 1e30) {
            self.fault(prim, "points", "triples of finite numbers are expected".into());
            return None;
        }
        Some(Values { values: values.into_owned(), width: 3, over: Over::Point })
    }

    /// Widths, or one for all where there are none.
    fn widths(&mut self, prim: &Prim, points: &Values, sizes: [usize; 3]) -> Option<Values> {
        for name in ["primvars:widths", "widths"] {
            let Some(widths) = self.spread(prim, name, 1, sizes) else { continue };
            if let Some(w) = widths.values.iter().find(|w| !(**w >= 0.0 && **w < 1e30)) {
                self.fault(prim, name, format!("numbers from 0 on are expected, not {w}"));
                return None;
            }
            return Some(widths);
        }
        let all = points.values.chunks_exact(3).map(Vec3::from_slice);
        let [low, high] = all.fold([Vec3::INFINITY, Vec3::NEG_INFINITY], |[l, h], p| [l.min(p), h.max(p)]);
        let width = THIN * (high - low).length().max(THIN);
        self.count(Loss::Approximated("without widths, it is as thin as a thousandth of its size".into()), prim, None);
        Some(Values { values: vec![width], width: 1, over: Over::All })
    }

    /// Values over as many curves, joints and points; `None` where there are none, or, told, another number of them.
    fn spread(&mut self, prim: &Prim, name: &str, width: usize, sizes: [usize; 3]) -> Option<Values> {
        let value = self.stage.value(prim, name)?;
        let mut values = value.floats().filter(|v| !v.is_empty())?.into_owned();
        let indexed = format!("{name}:indices");
        let mut is_out = !values.len().is_multiple_of(width);
        if self.stage.value(prim, &indexed).is_some() {
            let indices = self.integers(prim, &indexed)?;
            let there = Values { values, width, over: Over::All };
            is_out |= indices.iter().any(|k| there.get(*k as usize).is_empty());
            values = indices.iter().flat_map(|k| there.get(*k as usize)).copied().collect();
        }
        let word = self.stage.property_field(prim, name, "interpolation").and_then(Value::text);
        let over = match (word, name) {
            (Some("uniform"), _) => Over::Curve,
            (Some("varying" | "faceVarying"), _) => Over::Joint,
            (Some("vertex"), _) | (None, "widths") => Over::Point,
            _ => Over::All,
        };
        let [curves, joints, points] = sizes;
        let needed = [1, curves, joints, points][over as usize];
        let found = values.len() / width;
        // One width is that of all, whatever it is said to be.
        if name.ends_with("widths") && found == 1 && !is_out {
            return Some(Values { values, width, over: Over::All });
        }
        if is_out || found < needed || !values.iter().all(|v| v.is_finite()) {
            let span = self.stage.span(prim, Some(name));
            let of = ["constant", "uniform", "varying", "vertex"][over as usize];
            let what = format!("{}.{name}: {found} values are not the {needed} finite ones of '{of}'", prim.path);
            self.stage.dropped(span, format!("{what}: they are left out"));
            return None;
        }
        Some(Values { values, width, over })
    }

    /// UsdGeomPoints.
    pub(super) fn points(&mut self, prim: &Prim, state: &Inherited) {
        let Some(points) = self.positions(prim) else { return };
        let count = points.values.len() / 3;
        // Of points, what is uniform is one value.
        let sizes = [1, count, count];
        let Some(widths) = self.widths(prim, &points, sizes) else { return };
        let color = self.spread(prim, "primvars:displayColor", 3, sizes);
        let color = color.filter(|c| matches!(c.over, Over::Joint | Over::Point) && state.material.is_none());
        let limits = &self.stage.options.limits;
        let needed = (count as u64).saturating_mul((size_of::<Drawn>() + size_of::<Instance>()) as u64);
        if count.saturating_add(self.drawn.len()) > limits.instances.min(MOST_DRAWN)
            || limits.shortage(needed).is_some()
        {
            return self.fault(prim, "points", format!("{count} points are too many"));
        }
        let rounded = |k: usize, levels: f32| -> [u8; 3] {
            let of = color.as_ref().map_or(&[][..], |c| c.get(k));
            std::array::from_fn(|i| (of.get(i).map_or(0.0, |v| v.clamp(0.0, 1.0)).sqrt() * levels).round() as u8)
        };
        let mut levels = 255.0;
        if color.is_some() {
            let distinct: std::collections::HashSet<_> = (0..count).map(|k| rounded(k, levels)).collect();
            if distinct.len() > MOST_COLORS {
                levels = 15.0;
                let what = format!("colours of points are rounded to {MOST_COLORS}");
                self.count(Loss::Approximated(what), prim, None);
            }
        }
        let plain = self.look(prim, state.material.as_deref(), Channels::default());
        let mut looks = HashMap::new();
        for k in 0..count {
            let center = points.get(k).iter().map(|v| f64::from(*v)).collect::<Vec<_>>();
            let center = DVec3::from_slice(&center);
            let element = if widths.over == Over::All || widths.over == Over::Curve { 0 } else { k };
            let radius = 0.5 * f64::from(widths.get(element).first().copied().unwrap_or(0.0));
            if radius <= 0.0 {
                continue;
            }
            let look = match color {
                Some(_) => {
                    let rounded = rounded(k, levels);
                    let color = rounded.map(|v| (f64::from(v) / f64::from(levels)).powi(2));
                    *looks.entry(rounded).or_insert_with(|| self.painted(color))
                }
                None => plain,
            };
            let place = state.place * DMat4::from_translation(center) * DMat4::from_scale(DVec3::splat(radius));
            let (material, emission) = (look.material, look.emission);
            self.draw(Drawn { name: prim.name().to_owned(), form: Form::Ball, place, material, emission });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rules_are_those_of_their_bases() {
        let at = |basis, wrap, values: &[f32], segment: usize, t: f32| -> f32 {
            let place = Rule { basis, wrap }.place(values.len(), segment, t);
            place.points.iter().map(|(k, w)| values[*k] * w).sum()
        };
        let near = |a: f32, b: f32| assert!((a - b).abs() < 1e-6 * b.abs().max(1.0), "{a} {b}");
        let v = [1.0, 4.0, 9.0, 16.0, 25.0];
        for basis in [Basis::Linear, Basis::Bezier, Basis::BSpline, Basis::CatmullRom] {
            for wrap in [Wrap::Open, Wrap::Pinned, Wrap::Closed] {
                near(at(basis, wrap, &[3.0; 6], 0, 0.3), 3.0);
            }
        }
        near(at(Basis::Linear, Wrap::Closed, &v, 4, 0.25), 19.0);
        near(at(Basis::Bezier, Wrap::Open, &v, 0, 0.5), (1.0 + 12.0 + 27.0 + 16.0) / 8.0);
        near(at(Basis::BSpline, Wrap::Open, &v, 1, 0.5), (4.0 + 23.0 * 9.0 + 23.0 * 16.0 + 25.0) / 48.0);
        near(at(Basis::CatmullRom, Wrap::Open, &v, 1, 0.5), (9.0 * 9.0 + 9.0 * 16.0 - 4.0 - 25.0) / 16.0);
        // Pinned curves begin and end at their outer points, and two points are a line.
        for basis in [Basis::BSpline, Basis::CatmullRom] {
            near(at(basis, Wrap::Pinned, &v, 0, 0.0), 1.0);
            near(at(basis, Wrap::Pinned, &v, 3, 1.0), 25.0);
            near(at(basis, Wrap::Pinned, &v[..2], 0, 0.25), 1.75);
        }
        near(at(Basis::CatmullRom, Wrap::Closed, &v, 4, 0.0), 1.0);
        let count = |basis, wrap, n| Rule { basis, wrap }.segments(n);
        assert_eq!(count(Basis::Bezier, Wrap::Open, 7), Some(2));
        assert_eq!(count(Basis::Bezier, Wrap::Open, 6), None);
        assert_eq!(count(Basis::Bezier, Wrap::Closed, 6), Some(2));
        assert_eq!(count(Basis::BSpline, Wrap::Open, 3), None);
        assert_eq!(count(Basis::CatmullRom, Wrap::Pinned, 3), Some(2));
    }
}
