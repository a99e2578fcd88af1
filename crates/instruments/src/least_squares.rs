//! Nonlinear least squares by the Levenberg–Marquardt method, for a handful of parameters.
//!
//! Steps solve `(JᵀJ + λ diag JᵀJ) δ = −Jᵀr`; `λ` falls after steps that help and grows after others (Marquardt 1963;
//! Press et al., Numerical Recipes, 15.5). Derivatives are central differences. Written out here because the libraries
//! that have it bring a whole linear algebra.

/// Minimum found by a search.
#[derive(Clone, Debug)]
pub struct Minimum {
    /// The parameters.
    pub parameters: Vec<f64>,
    /// Half the sum of squared residuals.
    pub cost: f64,
    /// Steps taken.
    pub steps: usize,
}

/// Largest number of steps.
const MAX_STEPS: usize = 200;

/// Finds parameters from a start that minimise the squared residuals. Residuals that are not finite count as a step
/// that does not help.
pub fn minimise(start: &[f64], residuals: impl Fn(&[f64]) -> Vec<f64>) -> Minimum {
    let cost = |r: &[f64]| 0.5 * r.iter().map(|v| v * v).sum::<f64>();
    let n = start.len();
    let mut at = Minimum { parameters: start.to_vec(), cost: 0.0, steps: 0 };
    let mut r = residuals(start);
    at.cost = cost(&r);
    let mut damping = 1e-3;
    while at.steps < MAX_STEPS && damping < 1e12 {
        at.steps += 1;
        let columns: Vec<Vec<f64>> = (0..n)
            .map(|i| {
                let h = 1e-5 * at.parameters[i].abs().max(1e-2);
                let side = |sign: f64| {
                    let mut p = at.parameters.clone();
                    p[i] += sign * h;
                    residuals(&p)
                };
                side(1.0).iter().zip(side(-1.0)).map(|(a, b)| (a - b) / (2.0 * h)).collect()
            })
            .collect();
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
        let gradient: Vec<f64> = columns.iter().map(|c| dot(c, &r)).collect();
        let normal: Vec<Vec<f64>> = columns.iter().map(|a| columns.iter().map(|b| dot(a, b)).collect()).collect();
        // Damp more until a step helps.
        let before = at.cost;
        let mut helped = false;
        while damping < 1e12 {
            let mut m = normal.clone();
            (0..n).for_each(|i| m[i][i] += damping * m[i][i].max(1e-12));
            let step = solve(m, gradient.iter().map(|g| -g).collect());
            let tried: Vec<f64> = at.parameters.iter().zip(&step).map(|(p, d)| p + d).collect();
            let tried_r = residuals(&tried);
            let c = cost(&tried_r);
            if c.is_finite() && c < at.cost {
                (at.parameters, at.cost, r) = (tried, c, tried_r);
                damping = (damping * 0.2).max(1e-12);
                helped = true;
                break;
            }
            damping *= 4.0;
        }
        if !helped || before - at.cost <= 1e-14 * before {
            break;
        }
    }
    at
}

/// Solves a symmetric system by Gaussian elimination with pivoting; what is singular gets zero.
fn solve(mut a: Vec<Vec<f64>>, mut b: Vec<f64>) -> Vec<f64> {
    let n = b.len();
    for i in 0..n {
        let pivot = (i..n).max_by(|x, y| a[*x][i].abs().total_cmp(&a[*y][i].abs())).unwrap_or(i);
        a.swap(i, pivot);
        b.swap(i, pivot);
        if a[i][i].abs() < 1e-300 {
            continue;
        }
        for row in i + 1..n {
            let k = a[row][i] / a[i][i];
            let (above, below) = a.split_at_mut(row);
            below[0][i..].iter_mut().zip(&above[i][i..]).for_each(|(x, y)| *x -= k * y);
            b[row] -= k * b[i];
        }
    }
    for i in (0..n).rev() {
        let rest: f64 = (i + 1..n).map(|j| a[i][j] * b[j]).sum();
        b[i] = if a[i][i].abs() < 1e-300 { 0.0 } else { (b[i] - rest) / a[i][i] };
    }
    b
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rosenbrocks_valley_is_walked_to_its_end() {
        let m = minimise(&[-1.2, 1.0], |p| vec![10.0 * (p[1] - p[0] * p[0]), 1.0 - p[0]]);
        assert!((m.parameters[0] - 1.0).abs() < 1e-6 && (m.parameters[1] - 1.0).abs() < 1e-6, "{m:?}");
    }

    #[test]
    fn an_exponential_is_recovered_and_useless_parameters_do_no_harm() {
        let data: Vec<(f64, f64)> =
            (0..20).map(|i| f64::from(i) * 0.2).map(|x| (x, 3.0 * (-1.5 * x).exp() + 0.5)).collect();
        let m = minimise(&[1.0, 0.2, 0.0, 7.0], |p| {
            data.iter().map(|(x, y)| p[0] * (-p[1] * x).exp() + p[2] - y).collect()
        });
        assert!([3.0, 1.5, 0.5].iter().zip(&m.parameters).all(|(a, b)| (a - b).abs() < 1e-6), "{m:?}");
        assert_eq!(m.parameters[3], 7.0);
    }
}
