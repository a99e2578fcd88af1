//! The sun through air.

use super::{
    Air,
    data::{self, BANDS, Bands},
    orders::passed,
    path::{Way, horizon},
};
use crate::light::sky::{
    body::CelestialBody,
    data::LIMB,
    disc::{Disc, polynomial},
};
use steradian_math::{
    Spectrum, Vec2, Vec3,
    color::luminance,
    spectra::{ColorMode, Wavelengths},
};

/// Heights of the disc that are tabulated, dense towards the horizon.
const ROWS: usize = 64;

/// The sun's disc, dimmed at each of its heights by the air before it.
#[derive(Clone, Debug)]
pub struct AirSun {
    disc: Disc,
    up: Vec3,
    /// The lowest height of the disc that is seen, and from there to the highest, radians.
    lowest: f32,
    range: f32,
    /// In spectral mode radiance by height, and the darkening by band.
    rows: Vec<Bands>,
    limb: [[f32; LIMB]; BANDS],
    /// In RGB mode, by height, the polynomial of the cosine at which the sun's surface is seen.
    rgb: Vec<[Vec3; LIMB]>,
    mode: ColorMode,
    fluence: f32,
}

impl AirSun {
    /// The sun in some air; `None` where all of it is below the horizon.
    pub fn new(air: &Air, aperture: f32, limb_darkening: bool) -> Option<Self> {
        let medium = air.medium();
        let height = air.altitude_km();
        let dip = -(horizon(medium.radius, height).asin() as f32);
        let disc = Disc::new(air.sun, aperture);
        let (middle, half) = (air.sun.dot(air.up).clamp(-1.0, 1.0).asin(), 0.5 * aperture.to_radians());
        // Clip the disc at the horizon.
        let lowest = (middle - half).max(-dip);
        let range = (middle + half).min(std::f32::consts::FRAC_PI_2) - lowest;
        if range <= 0.0 {
            return None;
        }
        let solid_angle = disc.integral(1.0);
        let rows: Vec<Bands> = (0..ROWS)
            .map(|row| {
                // Rows spaced by squares, dense where the air mass changes fastest.
                let v = row as f32 / (ROWS - 1) as f32;
                let mu = f64::from(lowest + range * v * v).sin();
                let way = Way { height, mu, mu_sun: mu, nu: 1.0, can_hit: false };
                // Extraterrestrial radiance times the transmittance along the way, by height on the disc.
                let through = way.columns(&medium, 64).map_or([0.0; BANDS], |c| passed(&medium.optics, &c));
                std::array::from_fn(|b| data::SUN[b] * through[b] / solid_angle)
            })
            .collect();
        let even: [f32; LIMB] = std::array::from_fn(|k| if k == 0 { 1.0 } else { 0.0 });
        let limb = if limb_darkening { data::limb() } else { [even; BANDS] };
        let to_rgb = data::rgb_of_bands();
        // The colour of a row is a polynomial in the cosine: fold the bands into linear sRGB term by term.
        let colour =
            |row: &Bands| std::array::from_fn(|k| (0..BANDS).map(|b| to_rgb[b] * (row[b] * limb[b][k])).sum::<Vec3>());
        let rgb: Vec<[Vec3; LIMB]> = rows.iter().map(colour).collect();
        let mut sun = Self { disc, up: air.up, lowest, range, rows, limb, rgb, mode: air.mode, fluence: 0.0 };
        sun.fluence = sun.light();
        if air.mode == ColorMode::Rgb {
            sun.rows = Vec::new();
        } else {
            sun.rgb = Vec::new();
        }
        Some(sun)
    }

    /// The luminance of all of the disc.
    fn light(&self) -> f32 {
        const EDGE: u32 = 64;
        // Integrate the disc's luminance by stratified samples.
        let mut sum = 0.0_f64;
        for k in 0..EDGE * EDGE {
            let u = Vec2::new((k % EDGE) as f32 + 0.5, (k / EDGE) as f32 + 0.5) / EDGE as f32;
            let w = self.disc.sample(u).0;
            if let (Some(mu2), Some((row, t))) = (self.disc.mu2(w), self.place(w)) {
                sum += f64::from(luminance(self.colour(row, t, mu2)).max(0.0));
            }
        }
        self.disc.integral((sum / f64::from(EDGE * EDGE)) as f32)
    }

    /// The row below a direction, and how far it is to the next; `None` below the horizon.
    fn place(&self, w: Vec3) -> Option<(usize, f32)> {
        let above = (w.dot(self.up).clamp(-1.0, 1.0).asin() - self.lowest) / self.range;
        // The disc's lowest edge may be lower by rounding.
        if above < -1e-5 {
            return None;
        }
        let y = above.clamp(0.0, 1.0).sqrt() * (ROWS - 1) as f32;
        let row = (y as usize).min(ROWS - 2);
        Some((row, y - row as f32))
    }

    fn colour(&self, row: usize, t: f32, mu2: f32) -> Vec3 {
        // Limb darkening: a polynomial in the cosine on the sun's surface.
        let mu = mu2.sqrt();
        let at = |row: usize| self.rgb[row].iter().rev().fold(Vec3::ZERO, |sum, c| sum * mu + *c);
        at(row) * (1.0 - t) + at(row + 1) * t
    }
}

impl CelestialBody for AirSun {
    fn radiance(&self, w: Vec3, lambda: &Wavelengths) -> Spectrum {
        let Some(mu2) = self.disc.mu2(w) else { return Spectrum::ZERO };
        let Some((row, t)) = self.place(w) else { return Spectrum::ZERO };
        match self.mode {
            ColorMode::Rgb => {
                let rgb = self.colour(row, t, mu2).max(Vec3::ZERO);
                Spectrum::rgb(rgb.x, rgb.y, rgb.z)
            }
            ColorMode::Spectral => data::at_wavelengths(lambda, |b| {
                let through = self.rows[row][b] * (1.0 - t) + self.rows[row + 1][b] * t;
                through * polynomial(&self.limb[b], mu2.sqrt())
            }),
        }
    }

    fn sample(&self, u: Vec2) -> (Vec3, f32) {
        self.disc.sample(u)
    }

    fn pdf(&self, w: Vec3) -> f32 {
        self.disc.pdf(w)
    }

    fn fluence(&self) -> f32 {
        self.fluence
    }

    fn bytes(&self) -> usize {
        size_of_val(&self.rows[..]) + size_of_val(&self.rgb[..])
    }
}
