//! Tables of what was measured.

use super::{Curve, Measured, errors::EDGES, measure::Snapshot};
use crate::csv;
use std::fmt::Write;

/// Names of the columns for the squares of [`EDGES`].
fn edges(quantity: &str) -> impl Iterator<Item = String> {
    EDGES.map(|edge| format!("{quantity}_{edge}x{edge}")).into_iter()
}

/// A line for each snapshot of each render.
pub fn csv(scenes: &[Measured]) -> String {
    let first = ["scene", "integrator", "seed", "wall_seconds", "cpu_seconds", "spp", "flip"].map(str::to_owned);
    let head = first.into_iter().chain(edges("relmse")).chain(edges("efficiency")).collect();
    let mut rows = vec![head];
    for (scene, curve) in scenes.iter().flat_map(|scene| scene.integrators.iter().map(move |curve| (scene, curve))) {
        for (run, s) in curve.runs.iter().flat_map(|run| run.snapshots.iter().map(move |s| (run, s))) {
            let mut row = vec![scene.scene.clone(), curve.integrator.clone(), run.seed.to_string()];
            let numbers =
                [s.wall_seconds, s.cpu_seconds, s.spp, s.flip].into_iter().chain(s.relmse).chain(s.efficiency);
            row.extend(numbers.map(|number| number.to_string()));
            rows.push(row);
        }
    }
    csv::table(rows)
}

/// Headings of [`cells`].
pub fn heads() -> Vec<String> {
    let first = ["spp", "CPU s", "relMSE", "FLIP"].map(str::to_owned).into_iter();
    first.chain(EDGES.map(|edge| format!("eff {edge}x{edge}"))).collect()
}

/// Means over renders of their last snapshots; with the standard error of efficiencies where there are several. `None`
/// without a snapshot.
pub fn cells(curve: &Curve) -> Option<Vec<String>> {
    let last: Vec<&Snapshot> = curve.runs.iter().filter_map(|run| run.snapshots.last()).collect();
    if last.is_empty() {
        return None;
    }
    let mean = |of: &dyn Fn(&Snapshot) -> f64| mean_and_error(last.iter().map(|s| of(s)).collect());
    let efficiency = |k: usize| match mean(&|s| s.efficiency[k]) {
        (mean, Some(error)) => format!("{} ±{}", rounded(mean), rounded(error)),
        (mean, None) => rounded(mean),
    };
    let [spp, cpu] = [mean(&|s| s.spp).0, mean(&|s| s.cpu_seconds).0];
    let [relmse, flip] = [mean(&|s| s.relmse[0]).0, mean(&|s| s.flip).0];
    let first = [format!("{spp:.1}"), format!("{cpu:.2}"), format!("{relmse:.3e}"), format!("{flip:.4}")];
    Some(first.into_iter().chain((0..EDGES.len()).map(efficiency)).collect())
}

/// A number without digits that a table does not need.
fn rounded(number: f64) -> String {
    if number < 100.0 { format!("{number:.2}") } else { format!("{number:.0}") }
}

/// Mean of numbers, and its standard error where there are several.
fn mean_and_error(numbers: Vec<f64>) -> (f64, Option<f64>) {
    let n = numbers.len() as f64;
    let mean = numbers.iter().sum::<f64>() / n;
    let squares: f64 = numbers.iter().map(|x| (x - mean) * (x - mean)).sum();
    (mean, (numbers.len() > 1).then(|| (squares / (n * (n - 1.0))).sqrt()))
}

/// The means as text.
pub fn text(scenes: &[Measured]) -> String {
    let mut out = String::new();
    for scene in scenes {
        let names = scene.integrators.iter().map(|curve| curve.integrator.chars().count());
        let width = names.max().unwrap_or(0).max("integrator".len());
        let line = |name: &str, cells: &[String]| {
            let cells: String = cells.iter().map(|cell| format!(" {cell:>15}")).collect();
            format!("{name:<width$}{cells}\n")
        };
        let _ = writeln!(out, "{}, {} x {}, reference: {}", scene.scene, scene.width, scene.height, scene.reference);
        out += &line("integrator", &heads());
        for curve in &scene.integrators {
            out += &match (cells(curve), &curve.cannot) {
                (Some(cells), _) => line(&curve.integrator, &cells),
                (None, Some(why)) => format!("{:<width$} {why}\n", curve.integrator),
                (None, None) => format!("{:<width$} no snapshot\n", curve.integrator),
            };
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_have_standard_errors() {
        assert_eq!(mean_and_error(vec![3.0]), (3.0, None));
        // A variance of 1 over three numbers.
        let (mean, error) = mean_and_error(vec![1.0, 2.0, 3.0]);
        assert!(mean == 2.0 && (error.unwrap() - (1.0f64 / 3.0).sqrt()).abs() < 1e-12);
    }
}
