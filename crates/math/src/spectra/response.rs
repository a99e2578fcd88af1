//! Sensor response of a camera: responses of its pixels, and the matrix from them to linear Rec.709.
//!
//! As in pbrt-v4 (5.4.2 of "Physically Based Rendering", 4th edition): the matrix is the one that, by least squares,
//! gives the patches of a ColorChecker under daylight of the white balance the colours that they have under D65.

use super::{
    CIE_Y_INTEGRAL, ColorMode, Curve, Dense, LAMBDA_COUNT, Wavelengths,
    cie::{nearest, to_xyz},
    d65,
    data::{cameras::CAMERAS, color_checker::PATCHES},
    daylight::daylight,
};
use crate::{Error, Mat3, Spectrum, Vec3, color::space::REC709};
use glam::{DMat3, DVec3};

/// Response that turns light into linear Rec.709, other than by the CIE 1931 observer.
#[derive(Clone, Debug, PartialEq)]
pub struct Response {
    /// Responses of the pixels at each whole nanometre; without them linear Rec.709 itself.
    pixels: Option<Box<[Vec3; LAMBDA_COUNT]>>,
    /// From what they give.
    matrix: Mat3,
}

/// Cone responses from XYZ (Lam 1985, "Metamerism and Colour Constancy": Bradford).
const BRADFORD: [[f64; 3]; 3] = [[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]];

impl Response {
    /// Cameras whose responses are known, by their names in pbrt-v4, with maker and model.
    pub fn cameras() -> impl Iterator<Item = (&'static str, &'static str)> {
        CAMERAS.iter().map(|(name, model, _)| (*name, *model))
    }

    /// The CIE 1931 observer, balanced so that daylight of a colour temperature (K) is white: von Kries' adaptation of
    /// Bradford's cones. Fails where there is no such daylight, above 25000 K.
    pub fn observer(kelvin: f64) -> Result<Self, Error> {
        let light = daylight(kelvin)?;
        let cones = DMat3::from_cols_array_2d(&BRADFORD).transpose();
        let source = to_xyz(|l| light.eval(l));
        let [from, to] = [source / source.y, REC709.white()].map(|white| cones * white);
        let adapted = cones.inverse() * DMat3::from_diagonal(to / from) * cones;
        let matrix = REC709.rgb_from_xyz() * adapted * REC709.xyz_from_rgb();
        Ok(Self { pixels: None, matrix: matrix.as_mat3() })
    }

    /// A camera, balanced for daylight of a colour temperature (K); `None` for one that is not known. Fails where there
    /// is no such daylight, above 25000 K.
    pub fn camera(name: &str, kelvin: f64) -> Result<Option<Self>, Error> {
        let Some((_, _, curves)) = CAMERAS.iter().find(|(known, ..)| *known == name) else { return Ok(None) };
        let light = daylight(kelvin)?;
        let curve = |values: &[f32; 35]| Ok(Dense::from(&Curve::regular(380.0, 720.0, values.as_slice())?.extended()));
        let [r, g, b] = [curve(&curves[0])?, curve(&curves[1])?, curve(&curves[2])?];
        let mut pixels = Box::new([Vec3::ZERO; LAMBDA_COUNT]);
        for (i, pixel) in pixels.iter_mut().enumerate() {
            *pixel = Vec3::new(r.values()[i], g.values()[i], b.values()[i]);
        }
        // Least squares: of all M the one with the smallest Σ |M c − x|² is (Σ x cᵀ)(Σ c cᵀ)⁻¹.
        let (mut seen, mut paired) = (DMat3::ZERO, DMat3::ZERO);
        for patch in &PATCHES {
            let patch = Dense::from(&Curve::regular(380.0, 730.0, patch.as_slice())?.extended());
            let reflected = patch.values().iter().zip(light.values()).map(|(r, l)| f64::from(r * l));
            let c = pixels.iter().zip(reflected).map(|(p, l)| p.as_dvec3() * l).sum::<DVec3>() / CIE_Y_INTEGRAL;
            let x = to_xyz(|l| patch.eval(l) * d65().eval(l));
            seen += DMat3::from_cols(c * c.x, c * c.y, c * c.z);
            paired += DMat3::from_cols(x * c.x, x * c.y, x * c.z);
        }
        // The camera is exposed so that white under its light is as bright as to the observer.
        let white = to_xyz(|l| d65().eval(l)).y;
        let bright = to_xyz(|l| light.eval(l)).y / white;
        let matrix = REC709.rgb_from_xyz() * (paired * seen.inverse()) * bright;
        Ok(Some(Self { pixels: Some(pixels), matrix: matrix.as_mat3() }))
    }

    /// Linear Rec.709 of light, as the estimate that [`ColorMode::to_rgb`] is. In RGB mode there are no wavelengths,
    /// and a camera gives what its matrix makes of them: use the observer there.
    #[inline]
    pub fn to_rgb(&self, mode: ColorMode, light: Spectrum, lambda: &Wavelengths) -> Vec3 {
        let raw = match &self.pixels {
            Some(pixels) if mode == ColorMode::Spectral => {
                let mut sum = Vec3::ZERO;
                for lane in 0..4 {
                    if let (Some(i), true) = (nearest(lambda.lambda[lane]), lambda.pdf[lane] > 0.0) {
                        sum += pixels[i] * (light[lane] / lambda.pdf[lane]);
                    }
                }
                sum * (0.25 / CIE_Y_INTEGRAL as f32)
            }
            _ => mode.to_rgb(light, lambda),
        };
        self.matrix * raw
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Colour of a spectrum: its integral, by wavelengths that are drawn evenly in the visible importance.
    fn seen(response: &Response, s: impl Fn(f32) -> f32) -> Vec3 {
        const COUNT: usize = 1000;
        let of = |k: usize| {
            let lambda = Wavelengths::sample_visible((k as f32 + 0.5) / COUNT as f32 * 0.25);
            response.to_rgb(ColorMode::Spectral, Spectrum::new(lambda.lambda.map(&s)), &lambda)
        };
        (0..COUNT).map(of).sum::<Vec3>() / COUNT as f32
    }

    /// Linear sRGB of a spectrum of 1, by pbrt-v4's definition and tables in numpy (least squares by `lstsq`).
    #[test]
    fn cameras_are_those_of_pbrt() {
        let cases = [
            ("canon_eos_100d", 6500.0, Vec3::new(1.196377, 0.939255, 0.907037)),
            ("nikon_d850", 3200.0, Vec3::new(0.508756, 1.078608, 2.177273)),
            ("sony_ilce_9", 5000.0, Vec3::new(1.00659, 0.94795, 1.259119)),
        ];
        for (name, kelvin, expected) in cases {
            let found = seen(&Response::camera(name, kelvin).unwrap().unwrap(), |_| 1.0);
            assert!((found - expected).abs().max_element() < 2e-3, "{name}: {found}, not {expected}");
        }
    }

    #[test]
    fn cameras_see_daylight_as_white() {
        for (name, _) in Response::cameras() {
            for kelvin in [3200.0, 5000.0, 6500.0, 9000.0] {
                let camera = Response::camera(name, kelvin).unwrap().unwrap();
                let light = daylight(kelvin).unwrap();
                let white = seen(&camera, |l| light.eval(l));
                let bright = to_xyz(|l| light.eval(l)).y as f32;
                // The fit leaves greys a little off, the more the further the light is from daylight.
                assert!(
                    (white / bright - Vec3::ONE).abs().max_element() < 0.04,
                    "{name}, {kelvin} K: {}",
                    white / bright
                );
            }
        }
    }

    /// Colours of the patches come out as the observer sees them, within what a matrix can do for a camera.
    #[test]
    fn cameras_see_the_patches_nearly_as_the_observer_does() {
        for (name, _) in Response::cameras() {
            let camera = Response::camera(name, 6500.0).unwrap().unwrap();
            let mut error = 0.0;
            for patch in &PATCHES {
                let patch = Dense::from(&Curve::regular(380.0, 730.0, patch.as_slice()).unwrap().extended());
                let of = |l: f32| patch.eval(l) * d65().eval(l);
                let right = (REC709.rgb_from_xyz() * to_xyz(of)).as_vec3();
                error += (seen(&camera, of) - right).length_squared() / 24.0;
            }
            assert!(error.sqrt() < 0.02, "{name}: {error}");
        }
    }

    #[test]
    fn the_observer_is_balanced() {
        let plain = Response::observer(6500.0).unwrap();
        for rgb in [Vec3::ONE, Vec3::new(0.8, 0.3, 0.1)] {
            let light = Spectrum::rgb(rgb.x, rgb.y, rgb.z);
            assert!((plain.to_rgb(ColorMode::Rgb, light, &Wavelengths::RGB) - rgb).abs().max_element() < 2e-3);
        }
        for kelvin in [2500.0, 5000.0, 12_000.0] {
            let warm = Response::observer(kelvin).unwrap();
            let light = daylight(kelvin).unwrap();
            let (white, bright) = (seen(&warm, |l| light.eval(l)), to_xyz(|l| light.eval(l)).y as f32);
            assert!((white / bright - Vec3::ONE).abs().max_element() < 3e-3, "{kelvin} K: {}", white / bright);
        }
    }

    #[test]
    fn what_is_not_known() {
        assert_eq!(Response::camera("leica_m3", 6500.0).unwrap(), None);
        assert!(Response::camera("nikon_d850", 30_000.0).is_err() && Response::observer(-1.0).is_err());
        assert_eq!(Response::cameras().count(), 17);
    }
}
