//! The clear sky and the sun: Hosek, Wilkie, "An analytic model for full spectral sky-dome radiance" (2012), and
//! "Adding a solar-radiance function to the Hošek–Wilkie skylight model" (2013), with their published tables.
//!
//! Radiances are in W/(m² sr nm), and black below the horizon. Beside it stand the sky and the sun of simulated air.

mod air;
mod body;
mod cells;
mod data;
mod disc;
mod dome;
mod position;
mod sun;

pub use air::{Air, AirDome, AirSun, Contents};
pub use dome::SkyDome;
pub use position::Moment;
pub use sun::{SunDisc, SunLook};

use body::CelestialBody;
use steradian_math::{
    Spectrum, Vec2, Vec3,
    spectra::{ColorMode, Wavelengths, role::Color},
};

/// The state of the atmosphere, and where the sun is.
#[derive(Clone, Debug)]
pub struct Atmosphere {
    /// Turbidity in [1, 10]: 2 is very clear, 3 clear, 10 hazy.
    pub turbidity: f32,
    /// Reflectance of the ground, which lights the sky again, in [0, 1].
    pub albedo: Color,
    /// Unit vector to the zenith.
    pub up: Vec3,
    /// Unit vector to the middle of the sun.
    pub sun: Vec3,
    /// The colour mode.
    pub mode: ColorMode,
}

impl Atmosphere {
    /// The sun's height above the horizon in radians.
    fn height(&self) -> f32 {
        self.sun.dot(self.up).clamp(-1.0, 1.0).asin()
    }
}

/// Light from the sky, by direction.
#[derive(Clone, Debug)]
pub enum Celestial {
    /// The sky without the sun.
    Sky(Box<SkyDome>),
    /// The sun without the sky.
    Sun(Box<SunDisc>),
    /// The sky that air makes, without the sun.
    Air(Box<AirDome>),
    /// The sun through air.
    AirSun(Box<AirSun>),
}

impl Celestial {
    #[inline]
    fn body(&self) -> &dyn CelestialBody {
        match self {
            Self::Sky(dome) => &**dome,
            Self::Sun(disc) => &**disc,
            Self::Air(dome) => &**dome,
            Self::AirSun(disc) => &**disc,
        }
    }

    /// Radiance from the direction `w`.
    #[inline]
    pub(super) fn radiance(&self, w: Vec3, lambda: &Wavelengths) -> Spectrum {
        self.body().radiance(w, lambda)
    }

    /// A direction and its density per solid angle. All light is found so.
    #[inline]
    pub(super) fn sample(&self, u: Vec2) -> (Vec3, f32) {
        self.body().sample(u)
    }

    /// The density of [`Celestial::sample`].
    #[inline]
    pub(super) fn pdf(&self, w: Vec3) -> f32 {
        self.body().pdf(w)
    }

    /// Estimate of the irradiance of a surface, as luminance: all of the sun's on one that faces it, and half of what
    /// comes from the sky.
    pub(super) fn irradiance(&self) -> f32 {
        // A sky lights a facing surface from its hemisphere at a mean cosine of one half.
        match self {
            Self::Sky(_) | Self::Air(_) => 0.5 * self.fluence(),
            Self::Sun(_) | Self::AirSun(_) => self.fluence(),
        }
    }

    /// The luminance of what comes from all directions together: `∫ Y dω`.
    pub fn fluence(&self) -> f32 {
        self.body().fluence()
    }

    /// Bytes of its tables.
    pub(super) fn bytes(&self) -> usize {
        self.body().bytes()
    }
}
