//! Lights at a point with a distribution over directions.

use super::tree::LightBounds;
use steradian_image::Texels;
use steradian_math::{
    Spectrum, Vec2, Vec3,
    spectra::{
        ColorMode, Wavelengths, role,
        role::{Color, Role},
    },
    transform::Affine,
    warp,
};
use steradian_texture::{SpectrumTexture, TextureContext, Textures};

/// How a spot light falls off between its two cones.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Falloff {
    /// Cubic smoothstep in the cosine (pbrt).
    Smoothstep,
    /// Linear in the angle (Mitsuba).
    Linear,
}

/// A spot light; local +z is its axis.
#[derive(Clone, Debug)]
pub struct Spot {
    /// Where it is.
    pub position: Vec3,
    /// Its orientation.
    pub world_from_light: Affine,
    /// Intensity on the axis.
    pub intensity: Color,
    /// Half angle beyond which it is dark, radians.
    pub total: f32,
    /// Half angle up to which it is full, radians.
    pub start: f32,
    /// What is between.
    pub falloff: Falloff,
    /// A slide over the cone.
    pub texture: Option<SpectrumTexture>,
}

impl Spot {
    /// Share of the full intensity at a cosine from the axis.
    pub fn share(&self, cos: f32) -> f32 {
        let (inner, outer) = (self.start.cos(), self.total.cos());
        if cos >= inner {
            1.0
        } else if cos <= outer {
            0.0
        } else {
            match self.falloff {
                Falloff::Smoothstep => {
                    let t = (cos - outer) / (inner - outer);
                    t * t * (3.0 - 2.0 * t)
                }
                Falloff::Linear => (self.total - cos.acos()) / (self.total - self.start),
            }
        }
    }

    /// Intensity towards a point.
    pub fn intensity(&self, p: Vec3, lambda: &Wavelengths, textures: &Textures) -> Spectrum {
        let local = self.world_from_light.inverse().vector(p - self.position).normalize_or_zero();
        let share = self.share(local.z);
        if share <= 0.0 {
            return Spectrum::ZERO;
        }
        let mut intensity = self.intensity.eval(lambda) * share;
        if let Some(texture) = &self.texture {
            let half = self.total.tan();
            let uv = Vec2::new(local.x, local.y) / (local.z * half) * 0.5 + 0.5;
            intensity *= texture.eval(textures, &TextureContext::new(p, uv), lambda);
        }
        intensity
    }

    /// Flux for an intensity of one on the axis: `∫ share dω`.
    pub fn flux_share(&self) -> f32 {
        // Midpoint rule over the falloff; exact inside.
        let steps = 256;
        let (a, b) = (self.total.cos(), self.start.cos());
        let h = (b - a) / steps as f32;
        let between: f32 = (0..steps).map(|i| self.share(a + (i as f32 + 0.5) * h) * h).sum();
        std::f32::consts::TAU * ((1.0 - b) + between)
    }

    /// Bounds for choosing among lights.
    pub fn bounds(&self, mode: ColorMode) -> LightBounds {
        LightBounds {
            axis: self.world_from_light.vector(Vec3::Z).normalize(),
            cos_o: 1.0,
            // A little more than the cone, for rounding.
            cos_e: (self.total + 1e-3).cos(),
            ..LightBounds::point(self.position, self.intensity.luminance(mode))
        }
    }
}

/// A point light whose intensity is an image over the equal-area map of the sphere.
#[derive(Clone, Debug)]
pub struct Goniometric {
    /// Where it is.
    pub position: Vec3,
    /// Its orientation.
    pub world_from_light: Affine,
    /// Intensity where the image is one.
    pub intensity: Color,
    /// The image.
    pub image: Texels,
}

impl Goniometric {
    fn factor(&self, p: Vec3) -> f32 {
        let local = self.world_from_light.inverse().vector(p - self.position).normalize_or(Vec3::Z);
        let uv = warp::equal_area_sphere_to_square(local);
        nearest(&self.image, uv).element_sum() / 3.0
    }

    /// Intensity towards a point.
    pub fn intensity(&self, p: Vec3, lambda: &Wavelengths) -> Spectrum {
        self.intensity.eval(lambda) * self.factor(p)
    }

    /// Mean of the image.
    pub fn mean(&self) -> f32 {
        mean(&self.image).element_sum() / 3.0
    }

    /// A bound on the intensity, as luminance.
    pub fn max_intensity(&self, mode: ColorMode) -> f32 {
        self.intensity.luminance(mode) * max(&self.image)
    }
}

/// What a projector shows.
#[derive(Clone, Debug)]
pub enum Slide {
    /// An image, nearest texel.
    Image(Texels),
    /// A texture over (u, v), v down.
    Texture(SpectrumTexture),
}

/// A slide projector at a point; local +z is its axis, +x right, +y up.
#[derive(Clone, Debug)]
pub struct Projection {
    /// Where it is and points.
    pub world_from_light: Affine,
    /// What it shows.
    pub slide: Slide,
    /// Half extents of the slide at z = 1.
    pub half: Vec2,
    /// Factor on the slide's values.
    pub scale: f32,
    /// Whether values are intensities (pbrt), or irradiances at z = 1 (Mitsuba), which fall with the cube of the
    /// cosine.
    pub is_irradiance: bool,
}

impl Projection {
    /// Where it is.
    pub fn position(&self) -> Vec3 {
        self.world_from_light.point(Vec3::ZERO)
    }

    /// Intensity towards a point.
    pub fn intensity(&self, p: Vec3, lambda: &Wavelengths, textures: &Textures, mode: ColorMode) -> Spectrum {
        let local = self.world_from_light.inverse().point(p);
        if local.z <= 0.0 {
            return Spectrum::ZERO;
        }
        let s = Vec2::new(local.x, local.y) / (local.z * self.half);
        if s.x.abs() > 1.0 || s.y.abs() > 1.0 {
            return Spectrum::ZERO;
        }
        let uv = Vec2::new(0.5 + 0.5 * s.x, 0.5 - 0.5 * s.y);
        let value = match &self.slide {
            Slide::Image(image) => role::texel(nearest(image, uv), Role::Illuminant, lambda, mode),
            Slide::Texture(t) => t.eval(textures, &TextureContext::new(p, uv), lambda),
        };
        let cos = local.z / local.length();
        value * if self.is_irradiance { self.scale / (cos * cos * cos) } else { self.scale }
    }

    /// A bound on the intensity, as luminance; a guess of one for textures.
    pub fn max_intensity(&self, mode: ColorMode, _textures: &Textures) -> f32 {
        let value = match &self.slide {
            Slide::Image(image) => max(image),
            Slide::Texture(SpectrumTexture::Constant(c)) => c.luminance(mode),
            Slide::Texture(_) => 1.0,
        };
        let corner = (1.0 + self.half.length_squared()).sqrt();
        value * self.scale * if self.is_irradiance { corner.powi(3) } else { 1.0 }
    }

    /// Flux for the image as it is, as luminance, before the scale.
    pub fn flux(&self, image: &Texels) -> f32 {
        let area = 4.0 * self.half.x * self.half.y;
        let mut sum = 0.0_f64;
        for y in 0..image.height {
            for x in 0..image.width {
                let s = Vec2::new(
                    (x as f32 + 0.5) / image.width as f32 * 2.0 - 1.0,
                    1.0 - (y as f32 + 0.5) / image.height as f32 * 2.0,
                ) * self.half;
                let cos = 1.0 / (1.0 + s.length_squared()).sqrt();
                sum += f64::from(steradian_math::color::luminance(rgb(image, x, y)) * cos.powi(3));
            }
        }
        area * (sum / (image.width * image.height).max(1) as f64) as f32
    }
}

/// Linear RGB of a texel; grey pictures give equal components.
pub(super) fn rgb(image: &Texels, x: usize, y: usize) -> Vec3 {
    match image.channels {
        1 | 2 => Vec3::splat(image.linear(x, y, 0)),
        _ => Vec3::new(image.linear(x, y, 0), image.linear(x, y, 1), image.linear(x, y, 2)),
    }
}

fn nearest(image: &Texels, uv: Vec2) -> Vec3 {
    let index = |v: f32, n: usize| ((v * n as f32) as usize).min(n - 1);
    rgb(image, index(uv.x, image.width), index(uv.y, image.height))
}

fn texels(image: &Texels) -> impl Iterator<Item = Vec3> + '_ {
    (0..image.height).flat_map(move |y| (0..image.width).map(move |x| rgb(image, x, y)))
}

fn mean(image: &Texels) -> Vec3 {
    let sum: glam::DVec3 = texels(image).map(Vec3::as_dvec3).sum();
    (sum / (image.width * image.height).max(1) as f64).as_vec3()
}

fn max(image: &Texels) -> f32 {
    texels(image).map(Vec3::max_element).fold(0.0, f32::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// M70: the flux of a spot light is the integral of its intensity; E39: a cone without falloff has I = Φ/(2π(1 −
    /// cos α)).
    #[test]
    fn spot_flux() {
        for falloff in [Falloff::Smoothstep, Falloff::Linear] {
            let mut s = Spot {
                position: Vec3::ZERO,
                world_from_light: Affine::IDENTITY,
                intensity: Color::constant(1.0),
                total: 0.6,
                start: 0.6,
                falloff,
                texture: None,
            };
            let cone = std::f32::consts::TAU * (1.0 - 0.6_f32.cos());
            assert!((s.flux_share() / cone - 1.0).abs() < 1e-5);
            s.start = 0.3;
            let lambda = Wavelengths::sample_visible(0.5);
            let n = 40_000;
            let mut rng = steradian_math::hash::HashRng::new(5);
            let mean = (0..n)
                .map(|_| warp::uniform_sphere(Vec2::new(rng.next_f32(), rng.next_f32())))
                .map(|w| s.intensity(w * 3.0, &lambda, &Textures::default())[0])
                .sum::<f32>()
                / n as f32;
            let flux = mean * 4.0 * std::f32::consts::PI;
            assert!((flux / s.flux_share() - 1.0).abs() < 0.06, "{flux} {}", s.flux_share());
        }
    }
}
