//! Gauss–Legendre quadrature, for areas and solid angles without a closed form.

/// Nodes and weights of the rule with `n` points on `[−1, 1]`, exact for polynomials up to degree `2n − 1`. At least
/// one point is made.
///
/// Nodes are the roots of the Legendre polynomial, found by Newton's method from Tricomi's approximation.
pub fn gauss_legendre(n: usize) -> Vec<(f64, f64)> {
    let n = n.max(1);
    (0..n)
        .map(|i| {
            let mut x = ((i as f64 + 0.75) / (n as f64 + 0.5) * std::f64::consts::PI).cos();
            let mut slope = 1.0;
            // Convergence is quadratic from a start that is already within 1/n².
            for _ in 0..8 {
                let (p, d) = legendre(n, x);
                slope = d;
                let step = p / d;
                x -= step;
                if step.abs() < 1e-16 {
                    slope = legendre(n, x).1;
                    break;
                }
            }
            (x, 2.0 / ((1.0 - x * x) * slope * slope))
        })
        .collect()
}

/// The Legendre polynomial of degree `n` and its derivative at `x`, `|x| < 1`.
fn legendre(n: usize, x: f64) -> (f64, f64) {
    let (mut before, mut p) = (1.0, x);
    for k in 1..n {
        let k = k as f64;
        (before, p) = (p, ((2.0 * k + 1.0) * x * p - k * before) / (k + 1.0));
    }
    (p, n as f64 * (x * p - before) / (x * x - 1.0))
}

/// The integral of `f` from `a` to `b` by the rule with `n` points.
pub fn integrate(f: impl Fn(f64) -> f64, a: f64, b: f64, n: usize) -> f64 {
    let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
    gauss_legendre(n).into_iter().map(|(x, w)| w * f(middle + half * x)).sum::<f64>() * half
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rules_are_exact_for_polynomials() {
        for n in [1, 2, 3, 5, 16, 64] {
            let rule = gauss_legendre(n);
            assert!((rule.iter().map(|r| r.1).sum::<f64>() - 2.0).abs() < 1e-13);
            for degree in 0..2 * n as i32 {
                let sum: f64 = rule.iter().map(|(x, w)| w * x.powi(degree)).sum();
                let exact = if degree % 2 == 0 { 2.0 / f64::from(degree + 1) } else { 0.0 };
                assert!((sum - exact).abs() < 1e-13, "{n} points, degree {degree}");
            }
        }
        // The published nodes of two and three points.
        assert!((gauss_legendre(2)[0].0 - 1.0 / 3.0_f64.sqrt()).abs() < 1e-15);
        assert!((gauss_legendre(3)[0].0 - 0.6_f64.sqrt()).abs() < 1e-15);
        assert!((integrate(f64::exp, 0.0, 1.0, 12) - (std::f64::consts::E - 1.0)).abs() < 1e-15);
    }
}
