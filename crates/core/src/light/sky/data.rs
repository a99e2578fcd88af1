//! The published tables, and what all models interpolate in them by: turbidity, albedo, wavelength.

use steradian_math::{
    Spectrum,
    color::space::REC709,
    spectra::{Wavelengths, cie},
};

/// The wavelengths of the tables: so many, the first in nm, and from one to the next.
pub(super) const BANDS: usize = 11;
const FIRST: f32 = 320.0;
const STEP: f32 = 40.0;
/// The albedos, and the points of the Bézier curves over the sun's height.
const ALBEDOS: usize = 2;
const POINTS: usize = 6;
/// The polynomials over the height of the line of sight: so many, of such an order.
pub(super) const SEGMENTS: usize = 45;
pub(super) const POWERS: usize = 4;
/// Coefficients of limb darkening.
pub(super) const LIMB: usize = 6;
const TURBIDITIES: usize = 10;

const BYTES: &[u8] = include_bytes!("data/hosek_wilkie.bin");

/// A run of numbers of the file, in groups.
#[derive(Clone, Copy)]
struct Table {
    start: usize,
    len: usize,
}

impl Table {
    const fn after(self, len: usize) -> Self {
        Self { start: self.start + self.len, len }
    }

    fn get(self, i: usize) -> f32 {
        debug_assert!(i < self.len);
        let at = 4 * (self.start + i);
        f32::from_le_bytes([BYTES[at], BYTES[at + 1], BYTES[at + 2], BYTES[at + 3]])
    }
}

const SKY: usize = TURBIDITIES * ALBEDOS * POINTS;
const SPECTRAL_SHAPE: Table = Table { start: 0, len: SKY * BANDS * 9 };
const SPECTRAL_LEVEL: Table = SPECTRAL_SHAPE.after(SKY * BANDS);
const RGB_SHAPE: Table = SPECTRAL_LEVEL.after(SKY * 3 * 9);
const RGB_LEVEL: Table = RGB_SHAPE.after(SKY * 3);
const SUN: Table = RGB_LEVEL.after(TURBIDITIES * SEGMENTS * BANDS * POWERS);
const LIMBS: Table = SUN.after(BANDS * LIMB);
const _: () = assert!(BYTES.len() == 4 * (LIMBS.start + LIMBS.len));

/// The row below a turbidity, and how far it is to the next.
fn turbidity_row(turbidity: f32) -> (usize, f32) {
    let x = (turbidity - 1.0).clamp(0.0, (TURBIDITIES - 1) as f32);
    let row = (x as usize).min(TURBIDITIES - 2);
    (row, x - row as f32)
}

/// The nine coefficients and the radiance (W/(m² sr nm)) of one wavelength of the sky.
pub(super) type SkyBand = [f32; 10];

/// The bands of the sky for a turbidity in [1, 10], the ground's albedo in each band, and the sun's height in radians:
/// eleven, or three where those of linear sRGB are asked for by three albedos. The height goes along a quintic Bézier
/// curve (Hosek and Wilkie 2012, eq. 11 and section 5.3).
pub(super) fn sky(turbidity: f32, albedo: &[f32], height: f32) -> Vec<SkyBand> {
    let bands = albedo.len();
    let is_rgb = bands == 3;
    let (shape, level) = if is_rgb { (RGB_SHAPE, RGB_LEVEL) } else { (SPECTRAL_SHAPE, SPECTRAL_LEVEL) };
    let per_nm = if is_rgb { 1.0 / cie::CIE_Y_INTEGRAL as f32 } else { 1.0 };
    // Elevation enters by its cube root; Bernstein polynomials of degree five.
    let x = (height.max(0.0) * std::f32::consts::FRAC_2_PI).cbrt().min(1.0);
    let bernstein = |k: usize| [1.0, 5.0, 10.0, 10.0, 5.0, 1.0][k] * x.powi(k as i32) * (1.0 - x).powi(5 - k as i32);
    let (row, t) = turbidity_row(turbidity);
    let mut out = vec![[0.0; 10]; bands];
    // Interpolate trilinearly over turbidity, albedo and the control points.
    for (turbid, wt) in [(row, 1.0 - t), (row + 1, t)] {
        for ground in 0..ALBEDOS {
            for point in 0..POINTS {
                let group = ((turbid * ALBEDOS + ground) * POINTS + point) * bands;
                for (band, out) in out.iter_mut().enumerate() {
                    let albedo = albedo[band].clamp(0.0, 1.0);
                    let wa = if ground == 0 { 1.0 - albedo } else { albedo };
                    let w = wt * wa * bernstein(point);
                    for (k, out) in out[..9].iter_mut().enumerate() {
                        *out += w * shape.get((group + band) * 9 + k);
                    }
                    out[9] += w * per_nm * level.get(group + band);
                }
            }
        }
    }
    out
}

/// The polynomials of solar radiance for a turbidity: `[segment][band][power]`.
pub(super) fn sun(turbidity: f32) -> Vec<[[f32; POWERS]; BANDS]> {
    // Interpolate the polynomials between adjacent turbidities.
    let (row, t) = turbidity_row(turbidity);
    let at = |row: usize, i: usize| SUN.get(row * SEGMENTS * BANDS * POWERS + i);
    let mixed = |i: usize| at(row, i) * (1.0 - t) + at(row + 1, i) * t;
    (0..SEGMENTS)
        .map(|s| std::array::from_fn(|b| std::array::from_fn(|k| mixed((s * BANDS + b) * POWERS + k))))
        .collect()
}

/// The coefficients of limb darkening: `[band][power]`.
pub(super) fn limb() -> [[f32; LIMB]; BANDS] {
    std::array::from_fn(|b| std::array::from_fn(|k| LIMBS.get(b * LIMB + k)))
}

/// A value per lane, interpolated between bands; zero outside the tables, beyond 720 nm as below 320 nm.
pub(super) fn at_wavelengths(lambda: &Wavelengths, value: impl Fn(usize) -> f32) -> Spectrum {
    Spectrum::new(lambda.lambda.map(|l| {
        // The model ends with its tables: no radiance is extrapolated.
        let x = (l - FIRST) / STEP;
        if !(0.0..=(BANDS - 1) as f32).contains(&x) {
            return 0.0;
        }
        let band = (x as usize).min(BANDS - 2);
        let t = x - band as f32;
        (value(band) * (1.0 - t) + value(band + 1) * t).max(0.0)
    }))
}

/// A quantity that is given by wavelength, in the bands.
pub(super) fn banded(value: impl Fn(&Wavelengths) -> Spectrum) -> [f32; BANDS] {
    std::array::from_fn(|b| value(&Wavelengths::at([FIRST + STEP * b as f32; 4])).to_array()[0])
}

/// Contribution of each band to linear sRGB, exact for spectra that are linear between bands.
pub(super) fn rgb_of_bands() -> [[f32; 3]; BANDS] {
    std::array::from_fn(|b| {
        let centre = FIRST + STEP * b as f32;
        // Hat function of the band: one at its own wavelength, zero at its neighbours.
        let xyz = cie::to_xyz(|l| {
            let inside = (FIRST..=FIRST + STEP * (BANDS - 1) as f32).contains(&l);
            if inside { (1.0 - (l - centre).abs() / STEP).max(0.0) } else { 0.0 }
        });
        (REC709.rgb_from_xyz() * xyz).as_vec3().to_array()
    })
}

/// Contribution of each band to linear sRGB by the sum over the bands alone that Mitsuba's RGB variants take of the
/// sun, whose step is 467.07 nm / 11: five to nine per cent more than the integral.
pub(super) fn rgb_of_bands_by_mitsuba() -> [[f32; 3]; BANDS] {
    const STEP_OF_SUM: f64 = 467.069_280_386 / BANDS as f64;
    std::array::from_fn(|b| {
        let matching = cie::matching_linear(f64::from(FIRST + STEP * b as f32));
        let xyz = glam::DVec3::from_array(matching) * (STEP_OF_SUM / cie::CIE_Y_INTEGRAL);
        (REC709.rgb_from_xyz() * xyz).as_vec3().to_array()
    })
}
