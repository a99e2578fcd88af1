//! Polarised light: Stokes vectors, Mueller matrices, and the frames in which they hold.
//!
//! A Stokes vector `(S₀, S₁, S₂, S₃)` describes light that travels along `k` relative to a unit vector `x ⊥ k`, with
//! `y = k × x`: total radiance; linear polarisation along `x` over along `y`; along the diagonal `x + y` over the
//! other; right- over left-circular. With fields `∝ exp(i(kz − ωt))` these are `S₂ = 2 Re(E_x E_y*)` and
//! `S₃ = 2 Im(E_x E_y*)`. Frames and signs are those of Mitsuba 3. (Collett, Field Guide to Polarization, 2005; Wilkie
//! and Weidlich 2012 on bookkeeping.) The four lanes of each element are colours or wavelengths.

use crate::{Frame, Spectrum, Vec3};
use std::ops::{Add, Mul};

/// The oblique axis to which [`basis`] is orthogonal: a direction that scenes are not likely to have.
const BASIS_AXIS: Vec3 = Vec3::new(0.408, -0.544, 0.733);

/// The reference direction that goes with a direction of travel, where no other is agreed on. It is continuous but at
/// the two directions of one oblique axis: directions that are equal up to rounding, or up to the sign of a zero, have
/// the same reference.
pub fn basis(k: Vec3) -> Vec3 {
    BASIS_AXIS.cross(k).try_normalize().unwrap_or_else(|| Frame::from_z(k).x)
}

/// Light with its polarisation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stokes(pub [Spectrum; 4]);

impl Stokes {
    /// No light.
    pub const ZERO: Self = Self([Spectrum::ZERO; 4]);

    /// Light without polarisation.
    pub const fn unpolarized(radiance: Spectrum) -> Self {
        Self([radiance, Spectrum::ZERO, Spectrum::ZERO, Spectrum::ZERO])
    }

    /// Degree of polarisation of each lane, [0, 1]; 0 for no light.
    pub fn degree(&self) -> Spectrum {
        let [s0, s1, s2, s3] = self.0;
        (s1 * s1 + s2 * s2 + s3 * s3).sqrt().safe_div(s0)
    }

    /// Degree of linear polarisation.
    pub fn linear_degree(&self) -> Spectrum {
        let [s0, s1, s2, _] = self.0;
        (s1 * s1 + s2 * s2).sqrt().safe_div(s0)
    }
}

impl Add for Stokes {
    type Output = Self;

    fn add(self, o: Self) -> Self {
        Self(std::array::from_fn(|i| self.0[i] + o.0[i]))
    }
}

/// Mueller matrix: the effect of an interaction on polarised light; row by row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mueller(pub [[Spectrum; 4]; 4]);

impl Mueller {
    /// Nothing passes.
    pub const ZERO: Self = Self([[Spectrum::ZERO; 4]; 4]);

    /// Everything passes unchanged.
    pub const IDENTITY: Self = {
        let mut m = Self::ZERO;
        let mut i = 0;
        while i < 4 {
            m.0[i][i] = Spectrum::ONE;
            i += 1;
        }
        m
    };

    /// A part passes and loses its polarisation.
    pub fn depolarizer(part: Spectrum) -> Self {
        let mut m = Self::ZERO;
        m.0[0][0] = part;
        m
    }

    /// Broadcasts one matrix to all lanes.
    pub fn splat(rows: [[f32; 4]; 4]) -> Self {
        Self(rows.map(|r| r.map(Spectrum::splat)))
    }

    /// Amplitudes `a` along `x` and `b` along `y`, complex, one of each per lane: mirrors and interfaces, with `x`
    /// perpendicular to the plane of incidence.
    pub fn from_amplitudes(a: [Complex; 4], b: [Complex; 4]) -> Self {
        let lanes = |f: &dyn Fn(Complex, Complex) -> f64| Spectrum::new(std::array::from_fn(|i| f(a[i], b[i]) as f32));
        let mean = lanes(&|a, b| 0.5 * (a.norm2() + b.norm2()));
        let half = lanes(&|a, b| 0.5 * (a.norm2() - b.norm2()));
        let re = lanes(&|a, b| (a * b.conjugate()).re);
        let im = lanes(&|a, b| (a * b.conjugate()).im);
        let o = Spectrum::ZERO;
        Self([[mean, half, o, o], [half, mean, o, o], [o, o, re, im * -1.0], [o, o, im, re]])
    }

    /// Changes the reference direction: turns it by an angle, counter-clockwise when the light comes towards the eye.
    pub fn rotator(angle: f32) -> Self {
        let (s, c) = (2.0 * angle).sin_cos();
        Self::splat([[1.0, 0.0, 0.0, 0.0], [0.0, c, s, 0.0], [0.0, -s, c, 0.0], [0.0, 0.0, 0.0, 1.0]])
    }

    /// Changes the reference direction of light along `k` from one unit vector to another, both perpendicular to it.
    pub fn change_basis(k: Vec3, from: Vec3, to: Vec3) -> Self {
        Self::rotator(k.dot(from.cross(to)).atan2(from.dot(to)))
    }

    /// A perfect linear polariser whose axis is turned by an angle from the reference direction.
    pub fn polarizer(angle: f32) -> Self {
        let h = 0.5;
        Self::splat([[h, h, 0.0, 0.0], [h, h, 0.0, 0.0], [0.0; 4], [0.0; 4]]).turned(angle)
    }

    /// A linear retarder: the fast axis turned by an angle, the phase of the slow one behind by `delta`.
    pub fn retarder(angle: f32, delta: f32) -> Self {
        let (s, c) = delta.sin_cos();
        Self::splat([[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, c, s], [0.0, 0.0, -s, c]]).turned(angle)
    }

    /// The element turned by an angle about the direction of travel.
    #[must_use]
    pub fn turned(self, angle: f32) -> Self {
        Self::rotator(-angle) * self * Self::rotator(angle)
    }

    /// The matrix for the frames of other reference directions of the light that arrives (along `k_in`) and leaves
    /// (along `k_out`).
    #[must_use]
    pub fn in_bases(self, k_in: Vec3, [from_in, to_in]: [Vec3; 2], k_out: Vec3, [from_out, to_out]: [Vec3; 2]) -> Self {
        Self::change_basis(k_out, from_out, to_out) * self * Self::change_basis(k_in, to_in, from_in)
    }

    /// Each lane by a factor.
    #[must_use]
    pub fn scaled(self, k: Spectrum) -> Self {
        Self(self.0.map(|r| r.map(|v| v * k)))
    }

    /// Stokes vector that results from unpolarised light of some radiance: the first column.
    pub fn of_unpolarized(&self, radiance: Spectrum) -> Stokes {
        Stokes(self.0.map(|r| r[0] * radiance))
    }
}

impl Mul for Mueller {
    type Output = Self;

    fn mul(self, o: Self) -> Self {
        let element = |i: usize, j: usize| (0..4).fold(Spectrum::ZERO, |s, k| s + self.0[i][k] * o.0[k][j]);
        Self(std::array::from_fn(|i| std::array::from_fn(|j| element(i, j))))
    }
}

impl Mul<Stokes> for Mueller {
    type Output = Stokes;

    fn mul(self, s: Stokes) -> Stokes {
        Stokes(self.0.map(|r| (0..4).fold(Spectrum::ZERO, |sum, k| sum + r[k] * s.0[k])))
    }
}

/// A complex number.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Complex {
    /// Real part.
    pub re: f64,
    /// Imaginary part.
    pub im: f64,
}

impl Complex {
    /// From its parts.
    pub const fn new(re: f64, im: f64) -> Self {
        Self { re, im }
    }

    fn norm2(self) -> f64 {
        self.re * self.re + self.im * self.im
    }

    fn conjugate(self) -> Self {
        Self::new(self.re, -self.im)
    }

    /// The root in the right half plane, with the imaginary part of the same sign.
    fn sqrt(self) -> Self {
        let r = self.re.hypot(self.im);
        let re = (0.5 * (r + self.re)).max(0.0).sqrt();
        Self::new(re, (0.5 * (r - self.re)).max(0.0).sqrt().copysign(if self.im < 0.0 { -1.0 } else { 1.0 }))
    }

    fn over(self, d: Self) -> Self {
        let n = d.norm2();
        if n > 0.0 { self * d.conjugate() * Self::new(1.0 / n, 0.0) } else { Self::default() }
    }
}

impl Add for Complex {
    type Output = Self;

    fn add(self, o: Self) -> Self {
        Self::new(self.re + o.re, self.im + o.im)
    }
}

impl Mul for Complex {
    type Output = Self;

    fn mul(self, o: Self) -> Self {
        Self::new(self.re * o.re - self.im * o.im, self.re * o.im + self.im * o.re)
    }
}

/// The cosine of refraction into a medium of index `n`, by Snell's law; imaginary under total reflection.
fn refracted_cosine(cos: f64, n: Complex) -> Complex {
    let sin2 = Complex::new(cos * cos - 1.0, 0.0);
    (Complex::new(1.0, 0.0) + sin2.over(n * n)).sqrt()
}

/// Amplitudes of reflection perpendicular (s) and parallel (p) to the plane of incidence, from vacuum onto a medium of
/// index `n = η + ik` (relative to what is above), for the cosine of incidence in [0, 1] (E6: s is perpendicular).
pub fn reflection_amplitudes(cos: f64, n: Complex) -> [Complex; 2] {
    let (c, t) = (Complex::new(cos, 0.0), refracted_cosine(cos, n));
    let minus = Complex::new(-1.0, 0.0);
    let (nt, nc) = (n * t, n * c);
    [(c + minus * nt).over(c + nt), (nc + minus * t).over(nc + t)]
}

/// Amplitudes of transmission into a dielectric of relative index `eta`, scaled so that their squares are parts of the
/// power; zero under total reflection.
pub fn transmission_amplitudes(cos: f64, eta: f64) -> [Complex; 2] {
    let n = Complex::new(eta, 0.0);
    let t = refracted_cosine(cos, n);
    if t.im != 0.0 || cos <= 0.0 {
        return [Complex::default(); 2];
    }
    let power = (eta * t.re / cos).sqrt();
    [cos + eta * t.re, eta * cos + t.re].map(|d| Complex::new(2.0 * cos / d * power, 0.0))
}

/// The Mueller matrix of reflection in the frames whose reference is perpendicular to the plane of incidence, `n` per
/// lane.
pub fn fresnel_reflection(cos: f64, n: [Complex; 4]) -> Mueller {
    let r = n.map(|n| reflection_amplitudes(cos, n));
    Mueller::from_amplitudes(r.map(|r| r[0]), r.map(|r| r[1]))
}

/// The Mueller matrix of transmission into a dielectric, as parts of the power.
pub fn fresnel_transmission(cos: f64, eta: f64) -> Mueller {
    let [s, p] = transmission_amplitudes(cos, eta);
    Mueller::from_amplitudes([s; 4], [p; 4])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hash::HashRng;

    fn glass(eta: f64) -> [Complex; 4] {
        [Complex::new(eta, 0.0); 4]
    }

    fn lane(s: Stokes) -> [f32; 4] {
        s.0.map(|v| v[0])
    }

    /// Amplitudes whose phases differ are a retarder: `exp(iδ)` is behind by δ.
    #[test]
    fn phases_of_amplitudes_are_retardations() {
        let one = [Complex::new(1.0, 0.0); 4];
        for delta in [0.3_f64, 1.5, -2.0] {
            let behind = [Complex::new(delta.cos(), delta.sin()); 4];
            let (a, b) = (Mueller::from_amplitudes(one, behind), Mueller::retarder(0.0, delta as f32));
            let apart = (0..16).map(|k| (a.0[k / 4][k % 4][0] - b.0[k / 4][k % 4][0]).abs()).fold(0.0, f32::max);
            assert!(apart < 1e-6, "{delta}: {a:?} {b:?}");
        }
    }

    /// The least eigenvalue of the coherency matrix of lane 0 over its trace: a matrix can occur in nature if it is not
    /// negative (Cloude 1986).
    fn realizability(m: &Mueller) -> f64 {
        // Pauli matrices in the order of Stokes parameters: identity, σz, σx, σy.
        let (o, l, i, ni) =
            (Complex::default(), Complex::new(1.0, 0.0), Complex::new(0.0, 1.0), Complex::new(0.0, -1.0));
        let minus = Complex::new(-1.0, 0.0);
        let pauli = [[[l, o], [o, l]], [[l, o], [o, minus]], [[o, l], [l, o]], [[o, ni], [i, o]]];
        let mut h = [[Complex::default(); 4]; 4];
        for a in 0..4 {
            for b in 0..4 {
                let weight = Complex::new(f64::from(m.0[a][b][0]) / 4.0, 0.0);
                for r in 0..4 {
                    for c in 0..4 {
                        let k = pauli[a][r / 2][c / 2] * pauli[b][r % 2][c % 2].conjugate();
                        h[r][c] = h[r][c] + weight * k;
                    }
                }
            }
        }
        // A Hermitian matrix as a real symmetric one of twice the size, diagonalised by Jacobi rotations.
        let mut s = [[0.0f64; 8]; 8];
        for r in 0..4 {
            for c in 0..4 {
                (s[r][c], s[r + 4][c + 4]) = (h[r][c].re, h[r][c].re);
                (s[r][c + 4], s[r + 4][c]) = (-h[r][c].im, h[r][c].im);
            }
        }
        for _ in 0..30 {
            for p in 0..8 {
                for q in p + 1..8 {
                    let theta = 0.5 * (2.0 * s[p][q]).atan2(s[q][q] - s[p][p]);
                    let (sin, cos) = theta.sin_cos();
                    for row in &mut s {
                        (row[p], row[q]) = (cos * row[p] - sin * row[q], sin * row[p] + cos * row[q]);
                    }
                    let (a, b) = (s[p], s[q]);
                    for k in 0..8 {
                        (s[p][k], s[q][k]) = (cos * a[k] - sin * b[k], sin * a[k] + cos * b[k]);
                    }
                }
            }
        }
        let trace: f64 = (0..8).map(|i| s[i][i]).sum();
        (0..8).map(|i| s[i][i]).fold(f64::INFINITY, f64::min) / trace
    }

    #[test]
    fn at_brewsters_angle_reflection_is_fully_polarised() {
        let eta = 1.5f64;
        let cos = eta.atan().cos();
        let s = fresnel_reflection(cos, glass(eta)).of_unpolarized(Spectrum::ONE);
        assert!((s.degree()[0] - 1.0).abs() < 1e-5 && (s.linear_degree()[0] - 1.0).abs() < 1e-5, "{s:?}");
        assert!(s.0[1][0] > 0.0, "perpendicular to the plane of incidence");
        assert!((s.0[0][0] - 0.073_96).abs() < 1e-4, "the daggered value of E8: {}", s.0[0][0]);
    }

    #[test]
    fn crossed_polarisers_are_black_and_malus_holds() {
        for (angle, part) in [(0.0f32, 0.5), (std::f32::consts::FRAC_PI_2, 0.0), (std::f32::consts::FRAC_PI_3, 0.125)] {
            let both = Mueller::polarizer(angle) * Mueller::polarizer(0.0);
            assert!((both.of_unpolarized(Spectrum::ONE).0[0][0] - part).abs() < 1e-6, "{angle}");
        }
        // A third between two crossed ones lets light through again.
        let three = Mueller::polarizer(std::f32::consts::FRAC_PI_2)
            * Mueller::polarizer(std::f32::consts::FRAC_PI_4)
            * Mueller::polarizer(0.0);
        assert!((three.of_unpolarized(Spectrum::ONE).0[0][0] - 0.125).abs() < 1e-6);
    }

    #[test]
    fn a_quarter_wave_plate_makes_circular_light() {
        let plate =
            Mueller::retarder(std::f32::consts::FRAC_PI_4, std::f32::consts::FRAC_PI_2) * Mueller::polarizer(0.0);
        let s = lane(plate.of_unpolarized(Spectrum::ONE));
        assert!(
            (s[0] - 0.5).abs() < 1e-6 && s[1].abs() < 1e-6 && s[2].abs() < 1e-6 && (s[3].abs() - 0.5).abs() < 1e-6,
            "{s:?}"
        );
    }

    /// Energy: what is not reflected is transmitted, in both polarisations.
    #[test]
    fn reflection_and_transmission_share_the_power() {
        for eta in [1.5, 1.0 / 1.5, 2.4] {
            for i in 1..=90 {
                let cos = f64::from(i) / 90.0;
                let sum = |k: usize| {
                    fresnel_reflection(cos, glass(eta)).0[k][0][0] + fresnel_transmission(cos, eta).0[k][0][0]
                };
                assert!((sum(0) - 1.0).abs() < 1e-5 && sum(1).abs() < 1e-5, "{eta} {cos}");
            }
        }
    }

    #[test]
    fn total_reflection_turns_the_phase_only() {
        // Fresnel's rhomb: two reflections at 54.6° in glass of 1.51 make a quarter wave.
        let once = fresnel_reflection(54.62f64.to_radians().cos(), glass(1.0 / 1.51));
        let s = Stokes([Spectrum::ONE, Spectrum::ZERO, Spectrum::ONE, Spectrum::ZERO]);
        let twice = lane(once * (once * s));
        assert!(
            (twice[0] - 1.0).abs() < 1e-6 && twice[2].abs() < 2e-3 && (twice[3].abs() - 1.0).abs() < 1e-3,
            "{twice:?}"
        );
    }

    #[test]
    fn frames_go_around_without_a_trace() {
        let k = Vec3::new(0.48, 0.6, 0.64);
        let x = basis(k);
        let y = k.cross(x);
        let turn = |a: f32| x * a.cos() + y * a.sin();
        let there = Mueller::change_basis(k, turn(0.0), turn(0.7)) * Mueller::change_basis(k, turn(2.0), turn(0.0));
        let direct = Mueller::change_basis(k, turn(2.0), turn(0.7));
        for i in 0..4 {
            for j in 0..4 {
                assert!((there.0[i][j] - direct.0[i][j]).to_array()[0].abs() < 1e-5);
            }
        }
        // Light along x seen from a reference turned by 45° is along the diagonal on the other side.
        let s = lane(
            Mueller::rotator(std::f32::consts::FRAC_PI_4)
                * Stokes([Spectrum::ONE, Spectrum::ONE, Spectrum::ZERO, Spectrum::ZERO]),
        );
        assert!(s[1].abs() < 1e-6 && (s[2] + 1.0).abs() < 1e-6, "{s:?}");
    }

    #[test]
    fn matrices_can_occur_in_nature() {
        let mut rng = HashRng::new(4);
        let mut random = Mueller::IDENTITY;
        for _ in 0..300 {
            let (a, b, c) = (rng.next_f32(), rng.next_f32(), rng.next_f32());
            let n = [Complex::new(f64::from(0.2 + 3.0 * a), f64::from(4.0 * b)); 4];
            let cos = f64::from(c.max(1e-3));
            for m in [
                fresnel_reflection(cos, n),
                fresnel_reflection(cos, glass(f64::from(0.4 + 2.0 * a))),
                fresnel_transmission(cos, f64::from(1.0 + a)),
                Mueller::polarizer(6.0 * a),
                Mueller::retarder(6.0 * a, 6.0 * b),
                Mueller::depolarizer(Spectrum::ONE),
                Mueller::fresnel_chain(&mut random, cos, n, 6.0 * b),
            ] {
                assert!(realizability(&m) > -1e-4, "{m:?}");
            }
        }
        // The check itself can fail: a matrix that makes polarisation out of nothing.
        assert!(
            realizability(&Mueller::splat([
                [1.0, 0.0, 0.0, 0.0],
                [0.0, -1.0, 0.0, 0.0],
                [0.0, 0.0, 1.0, 0.0],
                [0.0, 0.0, 0.0, 1.0]
            ])) < -0.1
        );
    }

    impl Mueller {
        /// One more reflection, in a turned plane, at the end of a chain, scaled to keep its size.
        fn fresnel_chain(chain: &mut Self, cos: f64, n: [Complex; 4], turn: f32) -> Self {
            let next = fresnel_reflection(cos, n) * Self::rotator(turn) * *chain;
            *chain = next.scaled(Spectrum::ONE.safe_div(next.0[0][0]));
            *chain
        }
    }
}
