//! Specification of a film: its size, the part that is rendered, its filter, and how it takes radiance.

use crate::Filter;
use std::sync::Arc;
use steradian_image::Sensor;
use steradian_math::{
    Spectrum, Vec3,
    spectra::{ColorMode, Response, Wavelengths},
};

/// The rectangle of pixels that is rendered, within the full frame. Half open: `x0 ≤ x < x1`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Crop {
    /// First column.
    pub x0: u32,
    /// First row.
    pub y0: u32,
    /// One past the last column.
    pub x1: u32,
    /// One past the last row.
    pub y1: u32,
}

impl Crop {
    /// Columns.
    pub fn width(&self) -> u32 {
        self.x1 - self.x0
    }

    /// Rows.
    pub fn height(&self) -> u32 {
        self.y1 - self.y0
    }
}

/// Specification of a film.
#[derive(Clone, Debug)]
pub struct FilmSpec {
    /// Columns of the full frame.
    pub width: u32,
    /// Rows of the full frame.
    pub height: u32,
    /// Part of it that is rendered.
    pub crop: Crop,
    /// Reconstruction filter around pixel centres.
    pub filter: Filter,
    /// Factor from radiance to film value (pbrt's exposure time × ISO / 100).
    pub imaging_ratio: f32,
    /// Luminance of radiance of Y = 1 in the scene's numbers, cd/m²: 72 983 where these are W/(m² sr nm), 1 where they
    /// are cd/m².
    pub unit_luminance: f64,
    /// Samples with a larger component are scaled down to it; infinite where nothing is clamped.
    pub max_component: f32,
    /// Colour response of the sensor; `None` for the CIE 1931 observer.
    pub response: Option<Arc<Response>>,
    /// Noise model for development; `None` for a picture without noise of its own.
    pub sensor: Option<Sensor>,
}

impl FilmSpec {
    /// Most pixels that are rendered: of the crop.
    pub const MAX_PIXELS: u64 = 1 << 28;
    /// Most pixels of a side of the frame.
    pub const MAX_SIDE: i64 = 1 << 20;

    /// A sample's radiance as the film holds it: exposed, and clamped where the film clamps.
    #[inline]
    pub fn exposed(&self, radiance: Spectrum) -> Spectrum {
        let exposed = radiance * self.imaging_ratio;
        let largest = exposed.max_element();
        // Where nothing is clamped, infinite radiance stays for the gate to count.
        if self.max_component.is_finite() && largest > self.max_component {
            return exposed * (self.max_component / largest);
        }
        exposed
    }

    /// The colour of light that is [exposed](Self::exposed), in linear Rec.709.
    #[inline]
    pub fn to_rgb(&self, light: Spectrum, lambda: &Wavelengths, mode: ColorMode) -> Vec3 {
        match &self.response {
            None => mode.to_rgb(light, lambda),
            Some(response) => response.to_rgb(mode, light, lambda),
        }
    }

    /// A sample's radiance as it is added to a pixel: [exposed](Self::exposed), in linear Rec.709.
    #[inline]
    pub fn developed(&self, radiance: Spectrum, lambda: &Wavelengths, mode: ColorMode) -> Vec3 {
        self.to_rgb(self.exposed(radiance), lambda, mode)
    }
}
