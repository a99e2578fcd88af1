//! Specification of a film: its size, the part that is rendered, its filter, and how it takes radiance.

use crate::{BandSample, Bands, Crop, Filter, Layer};
use std::sync::Arc;
use steradian_image::Sensor;
use steradian_math::{
    Spectrum, Vec3,
    spectra::{ColorMode, Response, Wavelengths},
};

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
    /// Bands of wavelengths that are kept beside the colour; `None` for colour alone.
    pub bands: Option<Arc<Bands>>,
    /// Layers that the picture has without being asked for.
    pub layers: &'static [Layer],
    /// Noise model for development; `None` for a picture without noise of its own.
    pub sensor: Option<Sensor>,
}

impl FilmSpec {
    /// Most pixels that are rendered: of the crop.
    pub const MAX_PIXELS: u64 = 1 << 28;
    /// Layers of a film that keeps the geometry of what is seen (pbrt-v4, 5.4.5, "GBufferFilm").
    pub const GEOMETRY: &[Layer] =
        &[Layer::ALBEDO, Layer::NORMAL, Layer::GEOMETRIC_NORMAL, Layer::POSITION, Layer::UV, Layer::VARIANCE];
    /// Most pixels of a side of the frame.
    pub const MAX_SIDE: i64 = 1 << 20;

    /// Layers that are asked for, and those of the film itself.
    pub fn with_layers(&self, asked: &[Layer]) -> Vec<Layer> {
        let own = self.layers.iter().filter(|layer| !asked.contains(layer));
        asked.iter().chain(own).copied().collect()
    }

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

    /// The sample of light that is [exposed](Self::exposed) for the bands, with a weight, W/(m² sr nm) without the
    /// exposure; `None` where there are no bands.
    #[inline]
    pub fn band_sample(&self, light: Spectrum, lambda: &Wavelengths, weight: f32) -> Option<BandSample> {
        self.bands.as_ref()?;
        let scale = weight * Bands::scale(self.imaging_ratio, self.unit_luminance);
        Some(BandSample::new(light * scale, lambda))
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
