//! Spherical harmonics of light that is mirrored by the plane through the sun: `z` up, the sun along `x`.

/// Degree up to which light and what scatters it again are kept, where there are aerosols and where there are none.
const DUSTY: usize = 6;
const CLEAR: usize = 2;
/// Harmonics with cosines up to the higher degree.
const MOST: usize = (DUSTY + 1) * (DUSTY + 2) / 2;

/// Factors of a phase function by degree.
pub(super) type Factors = [f32; DUSTY + 1];

/// Values of harmonics, or numbers by harmonic.
pub(super) type Values = [f32; MOST];

/// The harmonics with cosines up to a degree, orthonormal over the sphere, by order and then by degree.
#[derive(Clone, Debug)]
pub(super) struct Harmonics {
    pub degree: usize,
    /// Number of harmonics.
    pub count: usize,
    /// The degree of each, and what its recurrence multiplies by.
    pub degrees: [usize; MOST],
    recurrence: [[f32; 2]; MOST],
    first: Factors,
}

impl Harmonics {
    pub(super) fn new(has_aerosols: bool) -> Self {
        let degree = if has_aerosols { DUSTY } else { CLEAR };
        let (mut degrees, mut recurrence, mut first, mut count) = ([0; MOST], [[0.0; 2]; MOST], [0.0; DUSTY + 1], 0);
        // Normalisation of the sectoral harmonics by recurrence over the order.
        let mut p = (0.25 / std::f64::consts::PI).sqrt();
        for (m, first) in first[..=degree].iter_mut().enumerate() {
            if m > 0 {
                p *= ((2 * m + 1) as f64 / (2 * m) as f64).sqrt();
            }
            *first = (p * if m > 0 { std::f64::consts::SQRT_2 } else { 1.0 }) as f32;
            let m2 = (m * m) as f64;
            for l in m..=degree {
                let (l2, k2) = ((l * l) as f64, (l as f64 - 1.0).powi(2));
                degrees[count] = l;
                // Coefficients of the recurrence over the degree for normalised associated Legendre functions.
                if l > m {
                    let a = ((4.0 * l2 - 1.0) / (l2 - m2)).sqrt();
                    let b = if l > m + 1 { ((k2 - m2) / (4.0 * k2 - 1.0)).sqrt() } else { 0.0 };
                    recurrence[count] = [a as f32, (a * b) as f32];
                }
                count += 1;
            }
        }
        Self { degree, count, degrees, recurrence, first }
    }

    /// Values for a unit vector by its components `x` and `z` (Press et al., Numerical Recipes, 6.7).
    pub(super) fn at(&self, x: f32, z: f32) -> Values {
        let y = (1.0 - x * x - z * z).max(0.0).sqrt();
        let (mut out, mut i, mut re, mut im) = ([0.0; MOST], 0, 1.0, 0.0);
        for m in 0..=self.degree {
            // cos mφ·sin^m θ is the real part of (x + iy)^m.
            if m > 0 {
                (re, im) = (re * x - im * y, re * y + im * x);
            }
            let (mut before, mut p) = (0.0, self.first[m] * re);
            // Recurrence over the degree: P_l = a·z·P_{l−1} − b·P_{l−2}.
            for l in m..=self.degree {
                if l > m {
                    let [a, b] = self.recurrence[i];
                    (before, p) = (p, a * z * p - b * before);
                }
                out[i] = p;
                i += 1;
            }
        }
        out
    }

    /// A phase function by its factors, 1/sr, up to the degree.
    pub(super) fn phase(&self, factors: &Factors, cos: f32) -> f32 {
        // p = Σ (2l + 1)·f_l·P_l(cos)/(4π), with Legendre's polynomials by recurrence.
        let (mut before, mut p, mut sum) = (0.0, 1.0, 0.0);
        for (l, factor) in factors[..=self.degree].iter().enumerate() {
            let k = l as f32;
            sum += (2.0 * k + 1.0) * factor * p;
            (before, p) = (p, ((2.0 * k + 1.0) * cos * p - k * before) / (k + 1.0));
        }
        sum * (0.25 * std::f32::consts::FRAC_1_PI)
    }
}

/// The factors of molecules of an anisotropy: those of other degrees are zero.
pub(super) fn of_molecules(gamma: f32) -> Factors {
    let mut factors = [0.0; DUSTY + 1];
    factors[0] = 1.0;
    factors[2] = (1.0 - gamma) / (10.0 * (1.0 + 2.0 * gamma));
    factors
}

/// The part of what aerosols scatter that goes straight on (Wiscombe, "The delta-M method", 1977), and the factors of
/// the rest of Henyey's and Greenstein's phase function.
pub(super) fn of_aerosols(g: f32) -> (f32, Factors) {
    // Henyey and Greenstein's moments are g^l; delta-M removes the first one that is cut off.
    let forward = g.max(0.0).powi(DUSTY as i32 + 1);
    (forward, std::array::from_fn(|l| (g.powi(l as i32) - forward) / (1.0 - forward)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian_math::{Vec3, harmonics as full};

    /// They are those of the mathematical library with cosines.
    #[test]
    fn they_are_spherical_harmonics() {
        let w = Vec3::new(0.48, -0.6, 0.64);
        for has_aerosols in [false, true] {
            let harmonics = Harmonics::new(has_aerosols);
            let (all, found) = (full::values(harmonics.degree, w), harmonics.at(w.x, w.z));
            let mut i = 0;
            for m in 0..=harmonics.degree {
                for l in m..=harmonics.degree {
                    let given = all[full::index(l, m as i32)];
                    assert!(
                        (found[i] - given).abs() < 1e-5 && harmonics.degrees[i] == l,
                        "{l} {m}: {} {given}",
                        found[i]
                    );
                    i += 1;
                }
            }
            assert_eq!(i, harmonics.count);
        }
    }

    /// Sums of Legendre polynomials by the factors are the phase functions.
    #[test]
    fn factors_are_those_of_phase_functions() {
        let harmonics = Harmonics::new(true);
        for c in [-0.9, -0.1, 0.5, 1.0] {
            let gamma = 0.0145f32;
            let k = 3.0 / (16.0 * std::f32::consts::PI * (1.0 + 2.0 * gamma));
            let molecules = k * ((1.0 + 3.0 * gamma) + (1.0 - gamma) * c * c);
            assert!((harmonics.phase(&of_molecules(gamma), c) - molecules).abs() < 1e-6);
            // Little is missing where g is small.
            let (forward, factors) = of_aerosols(0.2);
            let aerosols = super::super::medium::aerosols(0.2, c);
            assert!((harmonics.phase(&factors, c) - aerosols).abs() < 2e-4 && forward < 2e-5);
        }
    }
}
