//! Composition of air: optical depths by band, densities by height, phase functions.

use super::data::{self, BANDS, Bands};
use std::f64::consts::PI;

/// Height in km above which there is no air.
pub(super) const TOP: f64 = 100.0;
/// Molecules per m² of a Dobson unit.
const DOBSON: f64 = 2.6867e20;
/// Heights of the table of air's density, km.
const STEP: f64 = 0.25;
const STEPS: usize = 400;

/// Vertical optical depth of air above sea level at a pressure in hPa (Bodhaine, Wood, Dutton, Slusser, "On Rayleigh
/// optical depth calculations", J. Atmos. Oceanic Technol. 16, 1999, eq. 30; 360 ppm CO₂, latitude 45°).
fn rayleigh_depth(nm: f32, pressure: f64) -> f64 {
    let l2 = (f64::from(nm) * 1e-3).powi(2);
    let shape = (1.045_599_6 - 341.290_61 / l2 - 0.902_308_50 * l2) / (1.0 + 0.002_705_988_9 / l2 - 85.968_563 * l2);
    0.002_152_0 * shape * pressure / 1013.25
}

/// Anisotropy of air's molecules: `γ = ρ/(2 − ρ)` of the depolarisation `ρ` that the King factor of air means (Bodhaine
/// et al., eqs. 5, 6 and 23; Bucholtz 1995).
fn anisotropy(nm: f32) -> f64 {
    let i2 = (f64::from(nm) * 1e-3).powi(-2);
    let nitrogen = 1.034 + 3.17e-4 * i2;
    let oxygen = 1.096 + 1.385e-3 * i2 + 1.448e-4 * i2 * i2;
    // King factor of dry air, the mean over its gases by volume.
    let king = (78.084 * nitrogen + 20.946 * oxygen + 0.934 + 0.036 * 1.15) / (78.084 + 20.946 + 0.934 + 0.036);
    let rho = 6.0 * (king - 1.0) / (3.0 + 7.0 * king);
    rho / (2.0 - rho)
}

/// Density at a height in km relative to that at sea level (U.S. Standard Atmosphere 1976, whose last layer goes on).
fn standard_density(height: f64) -> f64 {
    /// Geopotential height in km, temperature there in K, and its change in K/km.
    const LAYERS: [(f64, f64, f64); 8] = [
        (0.0, 288.15, -6.5),
        (11.0, 216.65, 0.0),
        (20.0, 216.65, 1.0),
        (32.0, 228.65, 2.8),
        (47.0, 270.65, 0.0),
        (51.0, 270.65, -2.8),
        (71.0, 214.65, -2.0),
        (84.852, 186.946, 0.0),
    ];
    /// Weight of air over the gas constant, K/km.
    const HYDROSTATIC: f64 = 34.163_195;
    // Geopotential height accounts for the decrease of gravity.
    let h = 6356.766 * height / (6356.766 + height);
    let (mut pressure, mut temperature) = (1.0, LAYERS[0].1);
    // Integrate the hydrostatic equation through the layers: exponential where isothermal, a power law under a lapse
    // rate.
    for (i, &(base, at_base, lapse)) in LAYERS.iter().enumerate() {
        let end = LAYERS.get(i + 1).map_or(h, |next| next.0.min(h));
        if end <= base {
            break;
        }
        temperature = at_base + lapse * (end - base);
        pressure *= if lapse == 0.0 {
            (-HYDROSTATIC * (end - base) / at_base).exp()
        } else {
            (at_base / temperature).powf(HYDROSTATIC / lapse)
        };
    }
    // Ideal gas: ρ ∝ p/T.
    pressure * LAYERS[0].1 / temperature
}

/// Vertical optical depths in some bands, and the ground's reflectance.
#[derive(Clone, Debug)]
pub(super) struct Optics<const N: usize> {
    pub rayleigh: [f32; N],
    /// Extinction and scattering of aerosols.
    pub aerosol: [f32; N],
    pub scattering: [f32; N],
    pub ozone: [f32; N],
    pub ground: [f32; N],
}

impl Optics<BANDS> {
    /// Optics of every `BANDS / N`-th band.
    pub(super) fn thinned<const N: usize>(&self) -> Optics<N> {
        let thin = |b: &Bands| std::array::from_fn(|i| b[i * (BANDS / N)]);
        Optics {
            rayleigh: thin(&self.rayleigh),
            aerosol: thin(&self.aerosol),
            scattering: thin(&self.scattering),
            ozone: thin(&self.ozone),
            ground: thin(&self.ground),
        }
    }

    /// Aerosols of which a part of what they scatter goes straight on, as if it had not been scattered.
    pub(super) fn without_forward(mut self, part: f32) -> Self {
        for b in 0..BANDS {
            // Light scattered straight on is neither extinguished nor scattered.
            self.aerosol[b] -= part * self.scattering[b];
            self.scattering[b] *= 1.0 - part;
        }
        self
    }
}

/// The air around a globe.
#[derive(Clone, Debug)]
pub(super) struct Medium {
    /// Radius of the globe, km.
    pub radius: f64,
    /// Air per km of height where all of a vertical column is one.
    air: Vec<f64>,
    /// Scale height of aerosols, km.
    aerosol_height: f64,
    pub optics: Optics<BANDS>,
    /// Anisotropy of molecules by band.
    pub gamma: Bands,
    /// Mean cosine of the angle that aerosols scatter by.
    pub g: f32,
}

impl Medium {
    /// The Earth's, of what is in it.
    pub(super) fn new(contents: &super::Contents, ground: Bands) -> Self {
        let band = |value: &dyn Fn(f32) -> f64| std::array::from_fn(|b| value(data::wavelength(b)) as f32);
        // Ångström's law: τ(λ) = τ_550·(λ/550)^(−α).
        let aerosol = band(&|nm| contents.aerosol * (f64::from(nm) / 550.0).powf(-contents.angstrom));
        let ozone: Bands =
            std::array::from_fn(|b| (contents.ozone * DOBSON * f64::from(data::OZONE[b]) * 1e-27) as f32);
        let medium = Self {
            radius: 6371.0,
            air: Vec::new(),
            aerosol_height: contents.aerosol_height * 1e-3,
            optics: Optics {
                rayleigh: band(&|nm| rayleigh_depth(nm, contents.pressure)),
                aerosol,
                scattering: aerosol.map(|a| a * contents.aerosol_albedo),
                ozone,
                ground,
            },
            gamma: band(&anisotropy),
            g: contents.g,
        };
        medium.with_air(standard_density)
    }

    /// A sky of air with another density by height.
    pub(super) fn with_air(mut self, density: impl Fn(f64) -> f64) -> Self {
        // Normalise the profile to a column of one.
        let at: Vec<f64> = (0..=STEPS).map(|i| density(STEP * i as f64)).collect();
        let column: f64 = at.windows(2).map(|w| 0.5 * STEP * (w[0] + w[1])).sum();
        self.air = at.into_iter().map(|d| d / column).collect();
        self
    }

    /// Air, aerosols and ozone per km at a height, of columns of one. Ozone is that of Lacis and Hansen, "A
    /// parameterization for the absorption of solar radiation in the Earth's atmosphere" (1974), eq. 15.
    pub(super) fn densities(&self, height: f64) -> [f64; 3] {
        let x = (height / STEP).clamp(0.0, STEPS as f64 - 1e-9);
        let (i, t) = (x as usize, x.fract());
        let air = self.air[i] * (1.0 - t) + self.air[i + 1] * t;
        let aerosol = (-height / self.aerosol_height).exp() / self.aerosol_height;
        const MIDDLE: f64 = 20.0;
        const WIDTH: f64 = 5.0;
        // Derivative of a logistic curve about 20 km.
        let e = ((height - MIDDLE) / WIDTH).exp();
        let ozone = (1.0 + (-MIDDLE / WIDTH).exp()) * e / (WIDTH * (1.0 + e) * (1.0 + e));
        [air, aerosol, ozone]
    }

    /// The phase function of molecules as `a + b cos²` (Bucholtz 1995, eq. 12), 1/sr.
    pub(super) fn molecules(&self, band: usize) -> (f32, f32) {
        let gamma = f64::from(self.gamma[band]);
        let k = 3.0 / (16.0 * PI * (1.0 + 2.0 * gamma));
        ((k * (1.0 + 3.0 * gamma)) as f32, (k * (1.0 - gamma)) as f32)
    }
}

/// The phase function of Henyey and Greenstein, 1/sr.
pub(super) fn aerosols(g: f32, cos: f32) -> f32 {
    let d = (1.0 + g * g - 2.0 * g * cos).max(1e-6);
    // p(θ) = (1 − g²)/(4π(1 + g² − 2g cos θ)^(3/2)).
    (1.0 - g * g) / (4.0 * std::f32::consts::PI * d * d.sqrt())
}

#[cfg(test)]
mod tests {
    use super::{super::Contents, *};
    use steradian_math::quadrature::integrate;

    /// From the first principles of the paper (its eqs. 17 to 27 with the refractive index of Peck and Reeder, by
    /// `colour.rayleigh_optical_depth` of colour-science 0.4 at latitude 0): 0.360514, 0.143474, 0.0681480.
    #[test]
    fn rayleigh() {
        for (nm, published) in [(400.0, 0.360_514), (500.0, 0.143_474), (600.0, 0.068_148_0)] {
            let depth = rayleigh_depth(nm, 1013.25);
            assert!((depth / published - 1.0).abs() < 2e-3, "{nm}: {depth}");
        }
        assert!((rayleigh_depth(500.0, 506.625) / rayleigh_depth(500.0, 1013.25) - 0.5).abs() < 1e-12);
        // Its King factors of 1.05126 and 1.04844 at 400 and 600 nm mean depolarisations of 0.0297 and 0.0281.
        for (nm, rho) in [(400.0, 0.0297), (600.0, 0.0281)] {
            let gamma = anisotropy(nm);
            assert!((2.0 * gamma / (1.0 + gamma) - rho).abs() < 2e-4, "{nm}: {gamma}");
        }
    }

    /// Densities of the published tables, kg/m³.
    #[test]
    fn standard_air() {
        for (height, density) in
            [(5.0, 0.736_43), (11.0, 0.364_80), (20.0, 0.088_910), (40.0, 0.003_995_7), (70.0, 8.2829e-5)]
        {
            let found = 1.225 * standard_density(height);
            assert!((found / density - 1.0).abs() < 2e-3, "{height}: {found}");
        }
    }

    /// 300 DU are 8.06·10¹⁸ molecules per cm², which at 600 nm absorb 5.0 to 5.1·10⁻²¹ cm² each.
    #[test]
    fn ozone_and_aerosols() {
        let medium = Medium::new(&Contents { ozone: 300.0, aerosol: 0.2, angstrom: 1.3, ..Contents::CLEAR }, [0.0; 48]);
        let at = |values: &Bands, nm: f32| {
            let lanes = data::at_wavelengths(&steradian_math::spectra::Wavelengths::at([nm; 4]), |b| values[b]);
            lanes.to_array()[0]
        };
        let ozone = at(&medium.optics.ozone, 600.0);
        assert!((ozone / (8.06e18 * 5.05e-21) as f32 - 1.0).abs() < 0.05, "{ozone}");
        assert!((at(&medium.optics.aerosol, 550.0) / 0.2 - 1.0).abs() < 1e-3);
        let law = at(&medium.optics.aerosol, 445.0) / at(&medium.optics.aerosol, 695.0);
        assert!((law / (695.0f32 / 445.0).powf(1.3) - 1.0).abs() < 1e-3, "{law}");
    }

    /// Columns are one, and phase functions integrate to one with their mean cosines.
    #[test]
    fn all_is_normalised() {
        let medium = Medium::new(&Contents::CLEAR, [0.0; 48]);
        let (mut columns, n) = ([0.0; 3], 100_000);
        for i in 0..n {
            let d = medium.densities(TOP * (i as f64 + 0.5) / n as f64);
            (0..3).for_each(|k| columns[k] += d[k] * TOP / n as f64);
        }
        assert!(columns.iter().all(|c| (c - 1.0).abs() < 1e-3), "{columns:?}");
        for band in [0, 25, 47] {
            let (a, b) = medium.molecules(band);
            let all = integrate(|c| 2.0 * PI * (f64::from(a) + f64::from(b) * c * c), -1.0, 1.0, 4);
            assert!((all - 1.0).abs() < 1e-6, "{all}");
        }
        let moment =
            |power: i32| integrate(|c| 2.0 * PI * c.powi(power) * f64::from(aerosols(0.7, c as f32)), -1.0, 1.0, 100);
        assert!((moment(0) - 1.0).abs() < 1e-5 && (moment(1) - 0.7).abs() < 1e-5);
    }
}
