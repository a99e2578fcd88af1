//! The choice of what a facet reflects: the factor `F` of models that can be given any of them.

use super::{ThinFilm, fresnel};
use steradian_math::Spectrum;

/// A reflectance by the angle of incidence.
#[derive(Clone, Copy, Debug)]
pub enum Reflectance {
    /// A dielectric of index η by Fresnel's equations.
    Dielectric(f32),
    /// A conductor of index `η − ik` by Fresnel's equations.
    Conductor {
        /// Real part.
        eta: Spectrum,
        /// Imaginary part.
        k: Spectrum,
    },
    /// The approximation for metals with large `k`, for comparison.
    LargeK {
        /// Real part.
        eta: Spectrum,
        /// Imaginary part.
        k: Spectrum,
    },
    /// Schlick's `F₀ + (F₉₀ − F₀)(1 − cosθ)⁵` (1994).
    Schlick {
        /// Reflectance at normal incidence.
        f0: Spectrum,
        /// Reflectance at grazing incidence.
        f90: Spectrum,
    },
    /// A thin film on a base of index `η − ik`.
    ThinFilm {
        /// The film.
        film: ThinFilm,
        /// Real part of the base's index.
        eta: Spectrum,
        /// Imaginary part of the base's index.
        k: Spectrum,
    },
}

impl Reflectance {
    /// The part of unpolarised light from above that is reflected, in `[0, 1]`.
    #[inline]
    pub fn eval(&self, cos: f32) -> Spectrum {
        match *self {
            Self::Dielectric(eta) => Spectrum::splat(fresnel::dielectric(cos.abs(), eta)),
            Self::Conductor { eta, k } => fresnel::conductor(cos, eta, k),
            Self::LargeK { eta, k } => {
                let of = |i: usize| fresnel::conductor_approximate(cos.abs(), eta[i], k[i]).clamp(0.0, 1.0);
                Spectrum::new(std::array::from_fn(of))
            }
            Self::Schlick { f0, f90 } => f0 + (f90 - f0) * (1.0 - cos.abs().min(1.0)).powi(5),
            Self::ThinFilm { film, eta, k } => film.reflectance(cos, eta, k),
        }
    }

    /// The reflectance of diffuse light, `2∫ F cosθ d(cosθ)`, by eight points of Gauss and Legendre: exact to 10⁻⁶ for
    /// interfaces without a film.
    pub fn diffuse(&self) -> Spectrum {
        GAUSS_LEGENDRE.iter().fold(Spectrum::ZERO, |sum, &[x, w]| sum + self.eval(x) * (2.0 * x * w))
    }
}

/// Points and weights on `[0, 1]` (Abramowitz & Stegun 1964, table 25.4, n = 8).
const GAUSS_LEGENDRE: [[f32; 2]; 8] = [
    [0.019_855_072, 0.050_614_268],
    [0.101_666_76, 0.111_190_52],
    [0.237_233_8, 0.156_853_32],
    [0.408_282_68, 0.181_341_9],
    [0.591_717_3, 0.181_341_9],
    [0.762_766_2, 0.156_853_32],
    [0.898_333_24, 0.111_190_52],
    [0.980_144_9, 0.050_614_268],
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_diffuse_mean_is_the_integral() {
        let glass = Reflectance::Dielectric(1.5).diffuse()[0];
        assert!((glass - 0.091_778).abs() < 2e-6, "{glass}");
        let one = Reflectance::Schlick { f0: Spectrum::ONE, f90: Spectrum::ONE }.diffuse()[0];
        assert!((one - 1.0).abs() < 1e-5);
        // ∫ (1−μ)⁵ 2μ dμ = 1/21.
        let schlick = Reflectance::Schlick { f0: Spectrum::ZERO, f90: Spectrum::ONE }.diffuse()[0];
        assert!((schlick - 1.0 / 21.0).abs() < 1e-5);
    }

    #[test]
    fn schlick_runs_between_its_ends_and_the_approximation_stays_below_one() {
        let s = Reflectance::Schlick { f0: Spectrum::splat(0.04), f90: Spectrum::splat(0.5) };
        assert!((s.eval(1.0)[0] - 0.04).abs() < 1e-7 && (s.eval(0.0)[0] - 0.5).abs() < 1e-7);
        let copper = Reflectance::LargeK { eta: Spectrum::splat(0.2), k: Spectrum::splat(3.91) };
        assert!((0..=100).all(|i| (0.0..=1.0).contains(&copper.eval(i as f32 / 100.0)[0])));
    }
}
