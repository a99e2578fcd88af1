//! The base under a smooth coat, such that pbrt's coat (which absorbs, and follows so many orders of scattering) and
//! Mitsuba's plastic look the same: what leaves a base of albedo ρ is Σ (ρK)ⁿ, where the coat throws K back.

/// Steps of integrals over cosines.
const STEPS: u32 = 512;

/// A coat over a diffuse base.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Coat {
    /// The share of light from the base that comes back to it.
    back: f64,
    /// The share that passes the coat, in and out, of what passes its surface.
    passed: f64,
    series: Series,
}

#[derive(Clone, Copy, Debug)]
enum Series {
    /// At most so many orders.
    Orders(i32),
    /// The base tints the sum once.
    Once,
    /// All orders.
    All,
}

impl Coat {
    /// pbrt's layered coat: optical thickness, and interfaces met at most.
    pub fn layered(eta: f64, thickness: f64, max_depth: i64) -> Self {
        let thickness = thickness.max(0.0);
        // Light that comes through the surface goes steeply.
        let steep = mean(|mu| (1.0 - reflectance(mu, eta)) * (-2.0 * thickness / refracted(mu, eta)).exp());
        let passed = steep / mean(|mu| 1.0 - reflectance(mu, eta)).max(1e-6);
        let orders = (max_depth.clamp(0, 1 << 20) + 1) / 2;
        Self { back: internal(eta, thickness), passed, series: Series::Orders(orders as i32) }
    }

    /// Mitsuba's plastic.
    pub fn plastic(eta: f64, nonlinear: bool) -> Self {
        let series = if nonlinear { Series::All } else { Series::Once };
        Self { back: internal(eta, 0.0), passed: 1.0, series }
    }

    /// Share of incident light that leaves the coated base of albedo `rho`: passed · Σ ρ (ρK)ⁿ.
    fn leaving(&self, rho: f64) -> f64 {
        let k = self.back;
        let sum = match self.series {
            Series::Orders(n) => rho * (1.0 - (rho * k).powi(n)) / (1.0 - rho * k).max(1e-4),
            Series::Once => rho / (1.0 - k).max(1e-4),
            Series::All => rho / (1.0 - rho * k).max(1e-4),
        };
        sum * self.passed
    }

    /// The albedo of the base under this coat that looks as `rho` does under `other`.
    pub fn base_like(&self, other: &Self, rho: f64) -> f64 {
        let wanted = other.leaving(rho);
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..50 {
            let middle = 0.5 * (low + high);
            if self.leaving(middle) < wanted { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    }
}

/// ∫ 2μ f(μ) dμ.
fn mean(f: impl Fn(f64) -> f64) -> f64 {
    let at = |i: u32| (f64::from(i) + 0.5) / f64::from(STEPS);
    (0..STEPS).map(|i| 2.0 * at(i) * f(at(i))).sum::<f64>() / f64::from(STEPS)
}

/// The share of diffuse light from below that the surface of a coat throws back.
fn internal(eta: f64, thickness: f64) -> f64 {
    mean(|mu| reflectance(mu, 1.0 / eta) * (-2.0 * thickness / mu).exp())
}

/// Cosine beyond a smooth interface; zero where nothing passes.
fn refracted(mu: f64, eta: f64) -> f64 {
    (1.0 - (1.0 - mu * mu) / (eta * eta)).max(0.0).sqrt().max(1e-6)
}

/// Fresnel's reflectance of an interface of that index, beyond over before.
fn reflectance(mu: f64, eta: f64) -> f64 {
    let sin2 = (1.0 - mu * mu) / (eta * eta);
    if sin2 >= 1.0 {
        return 1.0;
    }
    let t = (1.0 - sin2).sqrt();
    let (s, p) = ((mu - eta * t) / (mu + eta * t), (eta * mu - t) / (eta * mu + t));
    0.5 * (s * s + p * p)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn internal_reflection_is_the_known_one() {
        // Egan and Hilgeman's fit, as in d'Eon and Irving 2011, to its own accuracy.
        assert!((internal(1.5, 0.0) - 0.5963).abs() < 2e-3, "{}", internal(1.5, 0.0));
        assert!((internal(1.3, 0.0) - 0.4448).abs() < 5e-3, "{}", internal(1.3, 0.0));
    }

    #[test]
    fn bases_go_there_and_back() {
        let (ours, theirs) = (Coat::layered(1.5, 0.01, 10), Coat::plastic(1.5, true));
        for rho in [0.05, 0.3, 0.6, 0.9] {
            let there = theirs.base_like(&ours, rho);
            assert!(there < rho && (ours.base_like(&theirs, there) - rho).abs() < 1e-6, "{rho} {there}");
        }
        let thin = Coat::layered(1.5, 0.0, i64::MAX);
        assert!((thin.base_like(&theirs, 0.5) - 0.5).abs() < 1e-6);
    }
}
