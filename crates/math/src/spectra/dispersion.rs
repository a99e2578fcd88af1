//! Indices of refraction by formula: Cauchy's and Sellmeier's dispersion, the Abbe number, and the complex index of a
//! medium with given permittivity, permeability and conductivity.

use std::f64::consts::TAU;

/// Fraunhofer's lines F, d and C in nm: the Abbe number is `V_d = (n_d − 1)/(n_F − n_C)`.
pub const FRAUNHOFER: [f64; 3] = [486.134_27, 587.561_8, 656.272_48];

/// Speed of light in vacuum, m/s (exact), and the permittivity of vacuum, F/m (CODATA 2018).
const LIGHT_SPEED: f64 = 299_792_458.0;
const EPSILON_0: f64 = 8.854_187_812_8e-12;

/// An index of refraction that depends on the wavelength.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Dispersion {
    /// Cauchy's `n = A + B/λ² + C/λ⁴` with λ in µm.
    Cauchy([f64; 3]),
    /// Sellmeier's `n² = 1 + Σ B_i λ²/(λ² − C_i)` with λ in µm and `C_i` in µm²: four terms `[B, C]`, zero where
    /// there are fewer.
    Sellmeier([[f64; 2]; 4]),
}

impl Dispersion {
    /// Sellmeier's formula with three terms `[B, C]`, as catalogues of glasses have it.
    pub const fn three_terms([a, b, c]: [[f64; 2]; 3]) -> Self {
        Self::Sellmeier([a, b, c, [0.0; 2]])
    }

    /// Cauchy's formula with two terms through the index at the d line and the Abbe number, as
    /// `KHR_materials_dispersion` has it. An Abbe number that is not positive means no dispersion.
    pub fn from_abbe(n_d: f64, abbe: f64) -> Self {
        if abbe.is_nan() || abbe <= 0.0 {
            return Self::Cauchy([n_d, 0.0, 0.0]);
        }
        let [f, d, c] = FRAUNHOFER.map(|nm| (nm * 1e-3).powi(-2));
        let b = (n_d - 1.0) / (abbe * (f - c));
        Self::Cauchy([n_d - b * d, b, 0.0])
    }

    /// Value of the formula at `lambda` nm.
    fn formula(&self, lambda: f64) -> f64 {
        let l2 = (lambda * 1e-3).powi(2);
        match self {
            Self::Cauchy([a, b, c]) => a + b / l2 + c / (l2 * l2),
            Self::Sellmeier(terms) => (1.0 + terms.iter().map(|[b, c]| b * l2 / (l2 - c)).sum::<f64>()).max(0.0).sqrt(),
        }
    }

    /// The index at `lambda` nm; not below 0.05 nor above 20, where a formula leaves what is possible (Sellmeier's at a
    /// resonance).
    pub fn eval(&self, lambda: f64) -> f64 {
        let n = self.formula(lambda);
        if n.is_nan() { 1.0 } else { n.clamp(0.05, 20.0) }
    }

    /// True if [`Dispersion::eval`] gives the value of the formula at `lambda` nm, without clamping.
    pub fn is_possible(&self, lambda: f64) -> bool {
        (0.05..=20.0).contains(&self.formula(lambda))
    }

    /// The Abbe number of the formula; infinite without dispersion.
    pub fn abbe(&self) -> f64 {
        let [f, d, c] = FRAUNHOFER.map(|nm| self.eval(nm));
        (d - 1.0) / (f - c)
    }
}

/// The complex index `(η, κ)` of a medium with relative permittivity, relative permeability and conductivity (S/m) at
/// `lambda` nm: `n² = μ_r (ε_r + iσ/(ω ε₀))`, `ω = 2πc/λ`. (The printed form is its inverse, and lacks `c`: E9.)
pub fn complex_index(permittivity: f64, permeability: f64, conductivity: f64, lambda: f64) -> (f64, f64) {
    let omega = TAU * LIGHT_SPEED / (lambda * 1e-9);
    let (re, im) = (permeability * permittivity, permeability * conductivity / (omega * EPSILON_0));
    let m = re.hypot(im);
    ((0.5 * (m + re)).max(0.0).sqrt(), (0.5 * (m - re)).max(0.0).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectra::named;

    /// SCHOTT's constants of N-BK7 give its catalogue values n_d = 1.5168 and V_d = 64.17, and the tabulated glass.
    #[test]
    fn sellmeiers_formula_is_the_catalogue_glass() {
        let bk7 = Dispersion::three_terms([
            [1.039_612_12, 0.006_000_698_67],
            [0.231_792_344, 0.020_017_914_4],
            [1.010_469_45, 103.560_653],
        ]);
        assert!((bk7.eval(587.5618) - 1.5168).abs() < 1e-5 && (bk7.abbe() - 64.17).abs() < 0.01);
        let table = named("glass-BK7").unwrap();
        for l in [420.0, 500.0, 650.0, 750.0] {
            assert!((bk7.eval(l) - f64::from(table.eval(l as f32))).abs() < 5e-4, "{l} nm");
        }
    }

    #[test]
    fn cauchys_formula_meets_index_and_abbe_number() {
        for (n, v) in [(1.5168, 64.17), (1.7847, 25.7), (2.417, 55.3)] {
            let d = Dispersion::from_abbe(n, v);
            assert!((d.eval(FRAUNHOFER[1]) - n).abs() < 1e-12 && (d.abbe() - v).abs() < 1e-9);
            assert!(d.eval(400.0) > d.eval(700.0));
        }
        assert_eq!(Dispersion::from_abbe(1.5, 0.0).eval(400.0), 1.5);
        assert_eq!(Dispersion::from_abbe(1.5, f64::NAN).eval(400.0), 1.5);
        let resonant = Dispersion::three_terms([[1.0, 0.25], [0.0; 2], [0.0; 2]]);
        assert!((360..=830).all(|l| (0.05..=20.0).contains(&resonant.eval(f64::from(l)))));
    }

    #[test]
    fn the_index_of_an_insulator_is_the_root_of_its_permittivity_and_a_good_conductor_has_its_skin_depth() {
        // Glass (E9): 1.5, not its inverse.
        assert_eq!(complex_index(2.25, 1.0, 0.0, 550.0), (1.5, 0.0));
        assert!((complex_index(2.0, 1.5, 0.0, 550.0).0 - 3f64.sqrt()).abs() < 1e-12);
        // Copper at 1 cm: κ = λ/(2πδ) with the skin depth δ = √(2/(ωμ₀σ)), and η = κ.
        let (lambda, sigma) = (1e7, 5.96e7);
        let omega = TAU * LIGHT_SPEED / (lambda * 1e-9);
        let skin = (2.0 / (omega * 4e-7 * std::f64::consts::PI * sigma)).sqrt();
        let (eta, k) = complex_index(1.0, 1.0, sigma, lambda);
        assert!((k * TAU * skin / (lambda * 1e-9) - 1.0).abs() < 1e-6 && (eta / k - 1.0).abs() < 1e-6);
    }
}
