//! Wrong values in words: the mistake that explains them, or where and by how much they are off.

use crate::{
    exercise::{Exercise, Function, Mistake, Values, Wrong, shape},
    numbers::{answer, point, shown},
};
use std::f64::consts::{FRAC_1_PI, PI, TAU};

/// Part of the points that a mistake must explain.
const NEARLY_ALL: f64 = 0.97;
/// Difference, as a part of the right value, that makes an example a telling one.
const TELLING: f64 = 0.1;
/// Fewest points on each side of a border between right and wrong.
const FEW: usize = 3;

/// A function's answers at points, and what they are compared with.
pub(crate) struct Compared<'a> {
    pub exercise: &'static Exercise,
    pub function: &'static Function,
    pub reference: Values,
    pub points: &'a [Vec<f64>],
    pub given: &'a [Vec<f64>],
}

/// Result of a comparison.
pub(crate) struct Diagnosis {
    /// Points at which the answer is right.
    pub right: usize,
    pub mistake: Option<&'static Mistake>,
    /// Words on what is wrong; empty if nothing is.
    pub text: String,
}

/// A point with the answers there.
struct Row<'a> {
    point: &'a [f64],
    given: &'a [f64],
    right: Vec<f64>,
    is_right: bool,
}

impl Compared<'_> {
    /// Compares at all points.
    pub fn diagnose(&self) -> Diagnosis {
        let rows: Vec<Row<'_>> =
            self.points.iter().zip(self.given).map(|(point, given)| self.row(point, given)).collect();
        let right = rows.iter().filter(|r| r.is_right).count();
        if right == rows.len() {
            return Diagnosis { right, mistake: None, text: String::new() };
        }
        if let Some(text) = self.malformed(&rows) {
            return Diagnosis { right, mistake: None, text };
        }
        let mistake = self.mistake(&rows, right);
        let text = match mistake {
            Some(mistake) => format!("{} {}", mistake.hint, self.example(&rows)),
            None => self.described(&rows, right),
        };
        Diagnosis { right, mistake, text }
    }

    fn row<'a>(&self, point: &'a [f64], given: &'a [f64]) -> Row<'a> {
        let right = (self.reference)(point);
        let is_right = self.exercise.tolerance.all_hold(given, &right);
        Row { point, given, right, is_right }
    }

    /// Answers that are no numbers, or not as many as asked for.
    fn malformed(&self, rows: &[Row<'_>]) -> Option<String> {
        let (function, at) = (self.function, |r: &Row<'_>| point(self.function, r.point));
        if let Some(r) = rows.iter().find(|r| r.given.len() != r.right.len()) {
            let (n, names) = (r.right.len(), function.outputs.join(", "));
            return Some(format!("It gives {} numbers at {}; {n} are asked for: {names}.", r.given.len(), at(r)));
        }
        let row = rows.iter().find(|r| r.given.iter().zip(&r.right).any(|(g, r)| !g.is_finite() && g != r))?;
        Some(format!(
            "It gives {} at {}, right is {}. Is something divided by 0, or the square root of a negative number \
            taken?",
            answer(function, row.given),
            at(row),
            answer(function, &row.right)
        ))
    }

    /// The mistake that explains nearly all answers, and more of them than the reference.
    fn mistake(&self, rows: &[Row<'_>], right: usize) -> Option<&'static Mistake> {
        let explained = |mistake: &Mistake| match mistake.wrong {
            Wrong::Values(wrong) if mistake.function == self.function.name => {
                rows.iter().filter(|r| self.exercise.tolerance.all_hold(r.given, &wrong(r.point))).count()
            }
            _ => 0,
        };
        let best = self.exercise.mistakes.iter().map(|m| (explained(m), m)).rev().max_by_key(|(count, _)| *count)?;
        (best.0 > right && best.0 as f64 >= NEARLY_ALL * rows.len() as f64).then_some(best.1)
    }

    /// The first point with a clear difference.
    fn example(&self, rows: &[Row<'_>]) -> String {
        let off = |r: &&Row<'_>| {
            let size = r.right.iter().fold(self.exercise.tolerance.floor, |a, x| a.max(x.abs()));
            r.given.iter().zip(&r.right).map(|(g, x)| (g - x).abs() / size).fold(0.0, f64::max)
        };
        let wrong = || rows.iter().filter(|r| !r.is_right);
        let telling = wrong().find(|r| off(r) >= TELLING).or_else(|| wrong().max_by(|a, b| off(a).total_cmp(&off(b))));
        telling.map_or_else(String::new, |r| {
            let (given, right) = (answer(self.function, r.given), answer(self.function, &r.right));
            format!("At {} you gave {given}, right is {right}.", point(self.function, r.point))
        })
    }

    /// Wrong answers that no known mistake explains.
    fn described(&self, rows: &[Row<'_>], right: usize) -> String {
        let mut text = Vec::new();
        if right > 0 {
            text.push(format!("It is right at {right} of {} points.", rows.len()));
        }
        text.extend(self.parts(rows));
        text.extend(factor(rows, self.exercise.tolerance.floor).or_else(|| self.border(rows)));
        text.push(self.example(rows));
        text.join(" ")
    }

    /// Numbers of the answer that are right everywhere, if others are not.
    fn parts(&self, rows: &[Row<'_>]) -> Option<String> {
        let tolerance = &self.exercise.tolerance;
        let holds = |i: usize| {
            rows.iter().all(|r| r.given.get(i).zip(r.right.get(i)).is_some_and(|(g, x)| tolerance.holds(*g, *x)))
        };
        let (right, wrong): (Vec<_>, Vec<_>) = (0..self.function.outputs.len()).partition(|i| holds(*i));
        let named = |parts: &[usize]| {
            parts.iter().filter_map(|i| self.function.outputs.get(*i).copied()).collect::<Vec<_>>().join(", ")
        };
        (!right.is_empty()).then(|| format!("Right everywhere: {}; wrong: {}.", named(&right), named(&wrong)))
    }

    /// The input that tells right from wrong by its size.
    fn border(&self, rows: &[Row<'_>]) -> Option<String> {
        let names = self.function.inputs.iter().flat_map(|input| {
            let (name, count) = shape(input);
            (0..count).map(
                move |i| if count == 1 { name.to_owned() } else { format!("{name}.{}", ["x", "y", "z", "w"][i % 4]) },
            )
        });
        names.enumerate().find_map(|(column, name)| {
            let of = |is_right: bool| -> Vec<f64> {
                rows.iter().filter(|r| r.is_right == is_right).filter_map(|r| r.point.get(column).copied()).collect()
            };
            let (right, wrong) = (of(true), of(false));
            let least = |v: &[f64]| v.iter().copied().fold(f64::INFINITY, f64::min);
            let most = |v: &[f64]| v.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            if right.len() < FEW || wrong.len() < FEW {
                return None;
            }
            if most(&right) < least(&wrong) {
                let (right, wrong) = (shown(most(&right)), shown(least(&wrong)));
                return Some(format!("It is right where {name} is at most {right}, and wrong from {wrong} on."));
            }
            (least(&right) > most(&wrong)).then(|| {
                let (right, wrong) = (shown(least(&right)), shown(most(&wrong)));
                format!("It is right where {name} is at least {right}, and wrong up to {wrong}.")
            })
        })
    }
}

/// The factor by which all values are off.
fn factor(rows: &[Row<'_>], floor: f64) -> Option<String> {
    let pairs = rows.iter().flat_map(|r| r.given.iter().copied().zip(r.right.iter().copied()));
    let (small, large): (Vec<_>, Vec<_>) = pairs.partition(|(_, right)| right.abs() <= floor);
    let (given, right) = *large.first()?;
    let ratio = given / right;
    let is_constant = large.len() >= FEW
        && large.iter().all(|(g, r)| (g / r - ratio).abs() <= 1e-3 * ratio.abs())
        && small.iter().all(|(g, _)| g.abs() <= 2.0 * floor * ratio.abs().max(1.0));
    if !is_constant || ratio == 0.0 || (ratio - 1.0).abs() < 1e-3 {
        return None;
    }
    if (ratio + 1.0).abs() < 1e-3 {
        return Some("All values have the wrong sign.".into());
    }
    let names =
        [(PI, "π"), (FRAC_1_PI, "1/π"), (TAU, "2π"), (1.0 / TAU, "1/2π"), (4.0 * PI, "4π"), (0.25 * FRAC_1_PI, "1/4π")];
    let name = names.iter().find(|(x, _)| (ratio / x - 1.0).abs() < 1e-3).map(|(_, name)| format!(", {name}"));
    Some(format!("All values are {}{} times the right ones.", shown(ratio), name.unwrap_or_default()))
}
