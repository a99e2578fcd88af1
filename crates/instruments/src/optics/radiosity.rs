//! Radiosity of a box, step by step: the six walls are patches, `B_i = E_i + ρ_i Σ F_ij B_j`.
//!
//! Form factors have closed forms: of opposite rectangles, and of rectangles with a common side (Howell's catalogue,
//! C-11 and C-14). In a closed box the rows of `F` add up to one, and `A_i F_ij = A_j F_ji`. Jacobi's step number `k`
//! has the light of `k` bounces; its error is at most `ρ^k/(1 − ρ)` times the greatest change of the first step.

use crate::laboratory::{Axis, Chart, Error, Experiment, Marker, Parameter, Report, Run, Series, Values};
use std::f64::consts::PI;

pub const EXPERIMENT: Experiment = Experiment {
    name: "radiosity",
    doc: "form factors of the walls of a box, and Jacobi's steps to their radiosities, as numbers",
    source: "Goral et al. 1984; Howell, Catalog of Radiation Heat Transfer Configuration Factors, C-11, C-14",
    parameters: &[
        Parameter::number("width", 1.0, (0.01, 100.0), "m", "of the box, x"),
        Parameter::number("depth", 1.0, (0.01, 100.0), "m", "of the box, y"),
        Parameter::number("height", 1.0, (0.01, 100.0), "m", "of the box, z"),
        Parameter::number("walls", 0.5, (0.0, 0.99), "", "albedo of the four walls"),
        Parameter::number("floor", 0.5, (0.0, 0.99), "", "albedo of the floor"),
        Parameter::number("ceiling", 0.5, (0.0, 0.99), "", "albedo of the ceiling"),
        Parameter::number("emission", 1.0, (0.0, 1e6), "W/m²", "of the ceiling"),
        Parameter::choice("method", &["jacobi", "gauss-seidel"], "the iteration"),
        Parameter::count("steps", 8, (1, 200), "of the iteration"),
    ],
    run: Run::Alone(run),
};

/// Names of the patches.
const PATCHES: [&str; 6] = ["floor", "ceiling", "left", "right", "front", "back"];

/// Form factor between two equal rectangles of sides `a` and `b` that face each other at the distance `c`.
fn opposite(a: f64, b: f64, c: f64) -> f64 {
    let (x, y) = (a / c, b / c);
    let (x1, y1) = ((1.0 + x * x).sqrt(), (1.0 + y * y).sqrt());
    let log = (x1 * x1 * y1 * y1 / (1.0 + x * x + y * y)).ln();
    let arcs = x * y1 * (x / y1).atan() + y * x1 * (y / x1).atan() - x * x.atan() - y * y.atan();
    2.0 / (PI * x * y) * (0.5 * log + arcs)
}

/// Form factor from a rectangle to one at a right angle to it: `l` is their common side, `w` the other side of the
/// first, `h` that of the second.
fn adjacent(l: f64, w: f64, h: f64) -> f64 {
    let (h, w) = (h / l, w / l);
    let (h2, w2) = (h * h, w * w);
    let arcs = w * (1.0 / w).atan() + h * (1.0 / h).atan() - (h2 + w2).sqrt() * (1.0 / (h2 + w2).sqrt()).atan();
    let log = ((1.0 + w2) * (1.0 + h2) / (1.0 + w2 + h2)).ln()
        + w2 * (w2 * (1.0 + w2 + h2) / ((1.0 + w2) * (w2 + h2))).ln()
        + h2 * (h2 * (1.0 + h2 + w2) / ((1.0 + h2) * (h2 + w2))).ln();
    (arcs + 0.25 * log) / (PI * w)
}

/// Form factors of a box.
fn factors([x, y, z]: [f64; 3]) -> [[f64; 6]; 6] {
    // The axis of a patch's normal; pairs of patches are opposite.
    let sides = [x, y, z];
    let axis = |patch: usize| [2, 0, 1][patch / 2];
    std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            let (a, b) = (axis(i), axis(j));
            match (i == j, a == b) {
                (true, _) => 0.0,
                (false, true) => opposite(sides[(a + 1) % 3], sides[(a + 2) % 3], sides[a]),
                // The common side lies along the third axis; each patch extends along the other's normal.
                (false, false) => adjacent(sides[3 - a - b], sides[b], sides[a]),
            }
        })
    })
}

/// One step of an iteration.
fn step(
    before: &[f64; 6],
    emission: &[f64; 6],
    albedo: &[f64; 6],
    factors: &[[f64; 6]; 6],
    is_jacobi: bool,
) -> [f64; 6] {
    let mut after = *before;
    for i in 0..6 {
        // Gauss and Seidel take what this step has found already.
        let from = if is_jacobi { before } else { &after };
        let arrives: f64 = factors[i].iter().zip(from).map(|(f, b)| f * b).sum();
        after[i] = emission[i] + albedo[i] * arrives;
    }
    after
}

/// Greatest difference of two solutions.
fn apart(a: &[f64; 6], b: &[f64; 6]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

fn run(values: &Values) -> Result<Report, Error> {
    let number = |name: &str| values.number(name);
    let sides = ["width", "depth", "height"].map(number);
    let factors = factors(sides);
    let [x, y, z] = sides;
    let areas = [x * y, x * y, y * z, y * z, x * z, x * z];
    let walls = number("walls");
    let albedo = [number("floor"), number("ceiling"), walls, walls, walls, walls];
    let emission = [0.0, number("emission"), 0.0, 0.0, 0.0, 0.0];
    let is_jacobi = values.choice("method") == "jacobi";
    let mut report = Report::default();
    for (i, row) in factors.iter().enumerate() {
        for (j, f) in row.iter().enumerate().filter(|(j, _)| i != *j) {
            report.quantity(format!("form factor, {} to {}", PATCHES[i], PATCHES[j]), *f, "");
        }
        report.quantity(format!("form factors of the {}, sum", PATCHES[i]), row.iter().sum(), "");
    }
    let asymmetry = (0..36).map(|k| (k / 6, k % 6)).map(|(i, j)| areas[i] * factors[i][j] - areas[j] * factors[j][i]);
    report.quantity("greatest difference of A_i F_ij and A_j F_ji", asymmetry.map(f64::abs).fold(0.0, f64::max), "m²");
    // The limit: errors fall by the greatest albedo in each step, to below the rounding of numbers.
    let all = |before: &[f64; 6], is_jacobi: bool| step(before, &emission, &albedo, &factors, is_jacobi);
    let limit = (0..4000).fold(emission, |b, _| all(&b, false));
    let greatest = albedo.into_iter().fold(0.0, f64::max);
    let first = apart(&all(&emission, true), &emission);
    let (mut now, mut errors, mut bounds) = (emission, Vec::new(), Vec::new());
    for k in 0..=values.count("steps") {
        if k > 0 {
            now = all(&now, is_jacobi);
        }
        // A table of the first steps; the chart has all.
        if k <= 8 {
            for (patch, b) in PATCHES.into_iter().zip(now) {
                report.quantity(format!("step {k}, radiosity of the {patch}"), b, "W/m²");
            }
        }
        errors.push((k as f64, apart(&now, &limit)));
        bounds.push((k as f64, greatest.powi(k as i32) / (1.0 - greatest) * first));
    }
    for (patch, b) in PATCHES.into_iter().zip(limit) {
        report.quantity(format!("limit, radiosity of the {patch}"), b, "W/m²");
    }
    report.quantity("error after the last step", errors.last().map_or(0.0, |e| e.1), "W/m²");
    report.quantity("bound of Jacobi's error", bounds.last().map_or(0.0, |e| e.1), "W/m²");
    let absorbed: f64 =
        (0..6).map(|i| areas[i] * (limit[i] - emission[i]) * (1.0 - albedo[i]) / albedo[i].max(1e-30)).sum();
    if albedo.iter().all(|a| *a > 0.0) {
        report.quantity("power emitted", areas[1] * emission[1], "W");
        report.quantity("power absorbed", absorbed, "W");
    }
    report.chart = Some(
        Chart::new("error of the iteration", Axis::linear("step"), Axis::log("greatest error (W/m²)"))
            .with(Series::line("error", errors))
            .with(Series::line("bound of Jacobi's", bounds).drawn(Marker::Dashed)),
    );
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with(given: &[(&str, &str)]) -> Report {
        let given: Vec<_> = given.iter().map(|(a, b)| ((*a).to_owned(), (*b).to_owned())).collect();
        EXPERIMENT.run(&given, None).unwrap()
    }

    /// Howell's values: 0.1998 between opposite sides of a cube, 0.2000 between adjacent ones; in any box rows add up
    /// to one and areas times factors are symmetric.
    #[test]
    fn factors_are_those_of_the_catalogue() {
        assert!((opposite(1.0, 1.0, 1.0) - 0.199_825).abs() < 1e-6, "{}", opposite(1.0, 1.0, 1.0));
        assert!((adjacent(1.0, 1.0, 1.0) - 0.200_044).abs() < 1e-6, "{}", adjacent(1.0, 1.0, 1.0));
        for sides in [["1", "1", "1"], ["2", "3", "1"], ["0.3", "5", "2"]] {
            let r = with(&[("width", sides[0]), ("depth", sides[1]), ("height", sides[2])]);
            for patch in PATCHES {
                let sum = r.value(&format!("form factors of the {patch}, sum"));
                assert!((sum - 1.0).abs() < 1e-12, "{sides:?} {patch}: {sum}");
            }
            assert!(r.value("greatest difference of A_i F_ij and A_j F_ji") < 1e-12);
        }
    }

    /// By quadrature of the definition, for rectangles of three different sides.
    #[test]
    fn factors_agree_with_their_integral() {
        let (l, w, h) = (1.0, 2.0, 0.7);
        let n = 24_usize;
        let at = |k: usize, side: f64| (k as f64 + 0.5) / n as f64 * side;
        let mut sum = 0.0;
        for k in 0..n.pow(4) {
            let (x1, y, x2, z) = (at(k % n, l), at(k / n % n, w), at(k / n.pow(2) % n, l), at(k / n.pow(3), h));
            // (x1, y, 0) faces up, (x2, 0, z) along y.
            let d2 = (x1 - x2).powi(2) + y * y + z * z;
            sum += z * y / (PI * d2 * d2);
        }
        let found = sum * l * h / (n as f64).powi(4);
        assert!((found / adjacent(l, w, h) - 1.0).abs() < 0.01, "{found} {}", adjacent(l, w, h));
    }

    /// A room of one albedo in which all walls would emit has E/(1 − ρ); here: energy is kept, errors stay below the
    /// bound and fall, Gauss and Seidel's faster.
    #[test]
    fn steps_come_to_the_limit() {
        let jacobi = with(&[("walls", "0.8"), ("height", "2")]);
        assert!((jacobi.value("power absorbed") / jacobi.value("power emitted") - 1.0).abs() < 1e-9);
        assert!(jacobi.value("error after the last step") < jacobi.value("bound of Jacobi's error"));
        let seidel = with(&[("walls", "0.8"), ("height", "2"), ("method", "gauss-seidel")]);
        assert!(seidel.value("error after the last step") < 0.5 * jacobi.value("error after the last step"));
        // One bounce from the ceiling of a cube: the floor gets ρ F.
        assert!((with(&[]).value("step 1, radiosity of the floor") - 0.5 * opposite(1.0, 1.0, 1.0)).abs() < 1e-12);
        assert!(with(&[]).value("step 0, radiosity of the floor") == 0.0);
    }
}
