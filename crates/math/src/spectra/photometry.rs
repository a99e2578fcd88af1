//! Radiometric quantities with their units, and their photometric counterparts.
//!
//! A photometric quantity is the radiometric one weighed by the eye: `683 lm/W ∫ Q_λ(λ) ȳ(λ) dλ`.

use super::{CIE_Y_INTEGRAL, cie};

/// Luminous efficacy of monochromatic light of 540 THz (555 nm), lm/W: the definition of the candela.
pub const LUMINOUS_EFFICACY: f64 = 683.0;

/// Radiometric or photometric quantity of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Quantity {
    /// Power through a surface or out of a source.
    Flux,
    /// Power per solid angle of a point source.
    Intensity,
    /// Power that arrives per area.
    Irradiance,
    /// Power that leaves per area.
    Radiosity,
    /// Power per area, perpendicular to the ray, and solid angle. It is constant along a ray in empty space; where it
    /// enters a medium of another index of refraction, radiance over the index squared is.
    Radiance,
}

impl Quantity {
    /// The SI unit.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Flux => "W",
            Self::Intensity => "W/sr",
            Self::Irradiance | Self::Radiosity => "W/m²",
            Self::Radiance => "W/(m² sr)",
        }
    }

    /// The unit of the spectral quantity, per nanometre of wavelength.
    pub fn spectral_unit(self) -> &'static str {
        match self {
            Self::Flux => "W/nm",
            Self::Intensity => "W/(sr nm)",
            Self::Irradiance | Self::Radiosity => "W/(m² nm)",
            Self::Radiance => "W/(m² sr nm)",
        }
    }

    /// The name of the photometric counterpart.
    pub fn photometric_name(self) -> &'static str {
        match self {
            Self::Flux => "luminous flux",
            Self::Intensity => "luminous intensity",
            Self::Irradiance => "illuminance",
            Self::Radiosity => "luminous exitance",
            Self::Radiance => "luminance",
        }
    }

    /// The SI unit of the photometric counterpart.
    pub fn photometric_unit(self) -> &'static str {
        match self {
            Self::Flux => "lm",
            Self::Intensity => "cd",
            Self::Irradiance => "lx",
            Self::Radiosity => "lm/m²",
            Self::Radiance => "cd/m²",
        }
    }
}

/// The photometric counterpart of the spectral quantity `s(λ in nm)` per nanometre: lm of W/nm, lx of W/(m² nm), cd/m²
/// of W/(m² sr nm).
pub fn photometric(s: impl Fn(f32) -> f32) -> f64 {
    LUMINOUS_EFFICACY * cie::to_photometric(s)
}

/// The photometric counterpart of a spectral quantity per nanometre whose CIE Y (constant spectrum 1: Y = 1) is `y`.
pub fn photometric_from_y(y: f64) -> f64 {
    LUMINOUS_EFFICACY * CIE_Y_INTEGRAL * y
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectra::d65;

    #[test]
    fn a_watt_at_555_nm_is_683_lumens() {
        // One watt within the nanometre about 555 nm.
        let line = |l: f32| if (l - 555.0).abs() < 0.5 { 1.0 } else { 0.0 };
        assert!((photometric(line) - 683.0).abs() < 1e-9);
        // In the far red the same watt is worth little: ȳ(700 nm) = 0.0041.
        let red = |l: f32| if (l - 700.0).abs() < 0.5 { 1.0 } else { 0.0 };
        assert!((photometric(red) / 683.0 - 0.004102).abs() < 1e-6);
    }

    #[test]
    fn both_ways_to_luminance_agree() {
        let y = cie::to_xyz(|l| d65().eval(l)).y;
        assert!((photometric(|l| d65().eval(l)) / photometric_from_y(y) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn units_are_those_of_the_si() {
        assert_eq!((Quantity::Radiance.unit(), Quantity::Radiance.photometric_unit()), ("W/(m² sr)", "cd/m²"));
        assert_eq!(Quantity::Irradiance.photometric_name(), "illuminance");
        assert_eq!(Quantity::Flux.spectral_unit(), "W/nm");
    }
}
