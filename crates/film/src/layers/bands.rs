//! Layers of bands of wavelengths, which are there without being asked for where the film keeps them.

use super::{held, push};
use crate::{Bands, Film};
use steradian_image::Image;

/// Adds the mean over a pixel's samples of each band. Ranges have the channels and attributes of spectral OpenEXR files
/// (Fichet, Pacanowski, Wilkie 2021, "An OpenEXR Layout for Spectral Images").
pub(super) fn write(film: &Film, image: &mut Image) {
    let Some(bands) = film.bands.as_deref().filter(|_| !film.layers.by_band.is_empty()) else { return };
    for (band, name) in bands.names().iter().enumerate() {
        let sums = film.layers.by_band.iter().skip(band).step_by(bands.count()).zip(&film.pixels);
        push(image, name, sums.map(|(sum, pixel)| held(sum / f64::from(pixel.samples.max(1)))).collect());
    }
    if let Bands::Even { .. } = bands {
        image.metadata.set_text("spectralLayoutVersion", "1.0");
        image.metadata.set_text("emissiveUnits", "W.m^-2.sr^-1");
    }
}
