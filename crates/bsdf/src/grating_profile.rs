//! Diffraction efficiencies: the part of the light that a grating sends into each order, by scalar theory of a thin
//! phase grating (Goodman, *Introduction to Fourier Optics*, 4.4.3 and 4.4.4, for the sinusoidal one; the others are
//! Fourier coefficients of their phase).
//!
//! With the retardation `Γ`, by how many wavelengths the path at the deepest place differs:
//!
//! ```text
//! sinusoidal    η_m = J_m²(π Γ)
//! rectangular   η_0 = 1 − 2 w (1 − w) (1 − cos 2πΓ),   η_m = 2 (1 − cos 2πΓ) (sin(π m w)/(π m))²
//! blazed        η_m = (sin π(m − Γ)/π(m − Γ))²
//! ```
//!
//! Over all orders each sums to one.

use std::f32::consts::{PI, TAU};

/// The shape of the grooves, or what it does.
#[derive(Clone, Debug, PartialEq)]
pub enum Profile {
    /// A sine, by a table: see [`Profile::sinusoidal`].
    Sinusoidal(Sine),
    /// Steps; the part of a period that is high.
    Rectangular(f32),
    /// Saw teeth.
    Blazed,
    /// The efficiencies themselves, of orders from −m to m: an odd number, none negative, of sum at most 1.
    Listed(Vec<f32>),
}

/// Efficiencies of a sine, from `Γ = 0` in steps, one order after the other.
#[derive(Clone, Debug, PartialEq)]
pub struct Sine {
    table: Vec<f32>,
    steps: usize,
}

/// Steps of a table for one wavelength of retardation; linear interpolation errs by 10⁻⁵.
const STEPS: f32 = 512.0;
/// Most steps, beyond which Bessel functions are worked out at each point.
const MOST_STEPS: f32 = 16_384.0;

impl Profile {
    /// A sine, with a table for orders up to the largest and retardations up to the greatest.
    pub fn sinusoidal(largest: u16, greatest: f32) -> Self {
        let steps = (greatest * STEPS).clamp(0.0, MOST_STEPS) as usize + 2;
        let of = |m| move |k| bessel(m, f64::from(PI) * k as f64 / f64::from(STEPS)).powi(2) as f32;
        Self::Sinusoidal(Sine { table: (0..=u32::from(largest)).flat_map(|m| (0..steps).map(of(m))).collect(), steps })
    }

    /// The part of light that goes into an order.
    pub(super) fn efficiency(&self, order: i32, retardation: f32) -> f32 {
        let m = order as f32;
        match self {
            Self::Sinusoidal(sine) => sine.efficiency(order.unsigned_abs(), retardation.abs()),
            &Self::Rectangular(high) => {
                let beat = 1.0 - (TAU * retardation).cos();
                if order == 0 {
                    1.0 - 2.0 * high * (1.0 - high) * beat
                } else {
                    let amplitude = (PI * m * high).sin() / (PI * m);
                    2.0 * beat * amplitude * amplitude
                }
            }
            Self::Blazed => {
                let x = PI * (m - retardation);
                if x.abs() < 1e-3 { 1.0 } else { (x.sin() / x).powi(2) }
            }
            Self::Listed(of) => {
                let place = i64::from(order) + of.len() as i64 / 2;
                usize::try_from(place).ok().and_then(|i| of.get(i)).copied().unwrap_or(0.0)
            }
        }
    }
}

impl Sine {
    fn efficiency(&self, order: u32, retardation: f32) -> f32 {
        let place = retardation * STEPS;
        let k = place as usize;
        let row = order as usize * self.steps;
        match self.table.get(row + k..row + k + 2) {
            Some(&[a, b]) if k + 1 < self.steps => a + (b - a) * (place - k as f32),
            _ => bessel(order, f64::from(PI * retardation)).powi(2) as f32,
        }
    }
}

/// `J_m(x)` for `x ≥ 0`, to about 10⁻⁸: by the recurrence downwards, `J_{k−1} = 2k/x J_k − J_{k+1}`, from far above,
/// and the sum `J_0 + 2 (J_2 + J_4 + …) = 1` (Abramowitz, Stegun, 9.1.27, 9.1.46, 9.12).
fn bessel(m: u32, x: f64) -> f64 {
    if x < 1e-4 {
        return [1.0, 0.5 * x].get(m as usize).copied().unwrap_or(0.0);
    }
    // Beyond this order it falls faster than any power.
    let last = (x + 6.0 * x.cbrt() + 10.0) as u32;
    if m > last {
        return 0.0;
    }
    let (mut above, mut here, mut sum, mut wanted) = (0.0, 1e-280, 0.0, 0.0);
    for k in (0..=last + last % 2).rev() {
        if k == m {
            wanted = here;
        }
        if k % 2 == 0 {
            sum += if k == 0 { here } else { 2.0 * here };
        }
        (above, here) = (here, 2.0 * f64::from(k) / x * here - above);
    }
    wanted / sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Abramowitz, Stegun, tables 9.1, 9.2 and 9.4.
    #[test]
    fn bessel_functions_have_their_values_in_print() {
        for (m, x, expected) in [
            (0, 1.0, 0.765_197_686_6),
            (1, 1.0, 0.440_050_585_7),
            (2, 1.0, 0.114_903_484_9),
            (3, 1.0, 0.019_563_353_98),
            (0, 2.404_825_557_7, 0.0),
            (1, 2.0, 0.576_724_807_8),
            (5, 5.0, 0.261_140_546_1),
            (10, 10.0, 0.207_486_106_6),
            (1, 50.0, -0.097_511_828_13),
            (2, 1e-5, 0.0),
            (1, 1e-5, 5e-6),
            (30, 1e-3, 0.0),
        ] {
            let found = bessel(m, x);
            assert!((found - expected).abs() < 2e-8, "J_{m}({x}) = {found}");
        }
    }

    /// Parseval's theorem: a grating that only changes the phase loses nothing.
    #[test]
    fn all_orders_together_have_all_light() {
        use Profile::{Blazed, Rectangular};
        for (profile, most, within) in
            [(Profile::sinusoidal(60, 3.0), 60, 2e-5), (Rectangular(0.3), 20_000, 1e-4), (Blazed, 20_000, 1e-4)]
        {
            for retardation in [0.0, 0.2, 0.5, 1.3, 7.7] {
                let sum: f64 = (-most..=most).map(|m| f64::from(profile.efficiency(m, retardation))).sum();
                assert!((sum - 1.0).abs() < within, "{profile:?}, Γ = {retardation}: {sum}");
            }
        }
    }

    /// Goodman, *Introduction to Fourier Optics*: at most 33.9 % in a first order of a sine, 4/π² = 40.5 % of equal
    /// steps half a wave apart, whose even orders are dark; all of a blazed one whose retardation is a wave.
    #[test]
    fn the_best_efficiencies_are_those_in_textbooks() {
        let sine = Profile::sinusoidal(3, 1.0);
        let best = (0..2000).map(|k| sine.efficiency(1, k as f32 * 1e-3)).fold(0.0, f32::max);
        assert!((best - 0.3386).abs() < 1e-4, "{best}");
        let steps = |m| Profile::Rectangular(0.5).efficiency(m, 0.5);
        assert!(
            (steps(1) - 0.405_28).abs() < 1e-5 && (steps(-3) - 0.045_03).abs() < 1e-5,
            "{}, {}",
            steps(1),
            steps(-3)
        );
        assert!(steps(0).abs() < 1e-6 && steps(2).abs() < 1e-6);
        let blazed = |m| Profile::Blazed.efficiency(m, 1.0);
        assert!((blazed(1) - 1.0).abs() < 1e-6 && blazed(0) < 1e-6 && blazed(-1) < 1e-6);
        let listed = Profile::Listed(vec![0.1, 0.5, 0.3]);
        let seen = [-2, -1, 0, 1, 2].map(|m| listed.efficiency(m, 0.7));
        assert_eq!(seen, [0.0, 0.1, 0.5, 0.3, 0.0]);
    }
}
