//! Lights at a point with a distribution over directions. One that is new is a type here and its name in the list.

use super::{Light, tree::LightBounds};
use std::{
    f32::consts::{FRAC_1_PI, PI, TAU},
    fmt::Debug,
    sync::Arc,
};
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

/// A light at a point.
pub trait PunctualLight {
    /// Position of the light.
    fn position(&self) -> Vec3;

    /// Intensity towards a point.
    fn intensity(&self, p: Vec3, lambda: &Wavelengths, textures: &Textures, mode: ColorMode) -> Spectrum;

    /// Bounds for choosing among lights.
    fn bounds(&self, mode: ColorMode) -> LightBounds;

    /// The luminous flux, an estimate for pictures and textures.
    fn flux(&self, mode: ColorMode) -> f32;

    /// A direction in which it shines, and its density: any, unless it is known better. `None` for none.
    fn draw(&self, u: Vec2) -> Option<(Vec3, f32)> {
        Some((warp::uniform_sphere(u), 0.25 * FRAC_1_PI))
    }

    /// The density with which a direction is drawn.
    fn pdf(&self, _w: Vec3) -> f32 {
        0.25 * FRAC_1_PI
    }
}

macro_rules! lights {
    ($($(#[$doc:meta])* $name:ident),* $(,)?) => {
        /// A light at a point, of any kind.
        #[derive(Clone, Debug)]
        pub enum Punctual {
            $($(#[$doc])* $name(Box<$name>),)*
        }

        impl std::ops::Deref for Punctual {
            type Target = dyn PunctualLight;

            #[inline]
            fn deref(&self) -> &Self::Target {
                match self {
                    $(Self::$name(light) => &**light,)*
                }
            }
        }

        $(impl From<$name> for Light {
            fn from(light: $name) -> Self {
                Self::Punctual(Punctual::$name(Box::new(light)))
            }
        })*
    };
}

lights! {
    /// Even in all directions.
    Isotropic,
    /// A cone.
    Spot,
    /// An image of directions.
    Goniometric,
    /// A slide projector.
    Projection,
    /// A distribution of a program's own.
    Own,
}

/// A distribution of light over directions of a program's own.
pub trait OwnLight: Debug + Send + Sync {
    /// Share of the light's intensity in a unit direction of its own space, away from it. What is negative or not
    /// finite counts as 0.
    fn share(&self, w: Vec3) -> f32;

    /// Greatest share; brighter directions are right, and noisy.
    fn greatest(&self) -> f32 {
        1.0
    }
}

/// A light at a point with a distribution of a program's own.
#[derive(Clone, Debug)]
pub struct Own {
    /// Position of the light.
    pub position: Vec3,
    /// Its orientation.
    pub world_from_light: Affine,
    /// Intensity where the share is one.
    pub intensity: Color,
    /// The distribution.
    pub distribution: Arc<dyn OwnLight>,
}

impl Own {
    fn share(&self, w: Vec3) -> f32 {
        let share = self.distribution.share(w);
        if share.is_finite() { share.max(0.0) } else { 0.0 }
    }
}

impl PunctualLight for Own {
    fn position(&self) -> Vec3 {
        self.position
    }

    fn intensity(&self, p: Vec3, lambda: &Wavelengths, _textures: &Textures, _mode: ColorMode) -> Spectrum {
        let w = self.world_from_light.inverse().vector(p - self.position).normalize_or_zero();
        self.intensity.eval(lambda) * self.share(w)
    }

    fn bounds(&self, mode: ColorMode) -> LightBounds {
        let greatest = self.distribution.greatest();
        let greatest = if greatest > 0.0 { greatest.min(f32::MAX) } else { 1.0 };
        LightBounds::point(self.position, self.intensity.luminance(mode) * greatest)
    }

    fn flux(&self, mode: ColorMode) -> f32 {
        // Φ = ∫ I dω, by the midpoint rule over bands of equal solid angle.
        const BANDS: u32 = 64;
        let centre = |k: u32| (k as f32 + 0.5) / BANDS as f32;
        let all = (0..BANDS * BANDS).map(|k| Vec2::new(centre(k % BANDS), centre(k / BANDS)));
        let sum: f64 = all.map(|u| f64::from(self.share(warp::uniform_sphere(u)))).sum();
        4.0 * PI * (sum / f64::from(BANDS * BANDS)) as f32 * self.intensity.luminance(mode)
    }
}

/// Light that is even in all directions.
#[derive(Clone, Debug)]
pub struct Isotropic {
    /// Position of the light.
    pub position: Vec3,
    /// Its intensity.
    pub intensity: Color,
}

impl PunctualLight for Isotropic {
    fn position(&self) -> Vec3 {
        self.position
    }

    fn intensity(&self, _p: Vec3, lambda: &Wavelengths, _textures: &Textures, _mode: ColorMode) -> Spectrum {
        self.intensity.eval(lambda)
    }

    fn bounds(&self, mode: ColorMode) -> LightBounds {
        LightBounds::point(self.position, self.intensity.luminance(mode))
    }

    fn flux(&self, mode: ColorMode) -> f32 {
        // Φ = 4π·I.
        4.0 * PI * self.intensity.luminance(mode)
    }
}

/// Falloff of a spot light between its two cones.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Falloff {
    /// Cubic smoothstep in the cosine (pbrt).
    Smoothstep,
    /// Linear in the angle (Mitsuba).
    Linear,
    /// Square of a line in the cosine (glTF's KHR_lights_punctual).
    Quadratic,
}

/// A spot light; local +z is its axis.
#[derive(Clone, Debug)]
pub struct Spot {
    /// Position of the light.
    pub position: Vec3,
    /// Its orientation.
    pub world_from_light: Affine,
    /// Intensity on the axis.
    pub intensity: Color,
    /// Half angle beyond which it is dark, radians.
    pub total: f32,
    /// Half angle up to which it is full, radians.
    pub start: f32,
    /// Falloff between the two angles.
    pub falloff: Falloff,
    /// A slide over the cone.
    pub texture: Option<SpectrumTexture>,
}

impl Spot {
    /// Share of the full intensity at a cosine from the axis.
    pub fn share(&self, cos: f32) -> f32 {
        // Full inside the inner cone, dark outside the outer one.
        let (inner, outer) = (self.start.cos(), self.total.cos());
        if cos >= inner {
            1.0
        } else if cos <= outer {
            0.0
        } else {
            match self.falloff {
                Falloff::Smoothstep => {
                    // Hermite polynomial 3t² − 2t³ over the cosine.
                    let t = (cos - outer) / (inner - outer);
                    t * t * (3.0 - 2.0 * t)
                }
                Falloff::Linear => (self.total - cos.acos()) / (self.total - self.start),
                Falloff::Quadratic => ((cos - outer) / (inner - outer)).powi(2),
            }
        }
    }

    /// Flux for an intensity of one on the axis: `∫ share dω`.
    pub fn flux_share(&self) -> f32 {
        // Midpoint rule over the falloff; exact inside.
        let steps = 256;
        let (a, b) = (self.total.cos(), self.start.cos());
        let h = (b - a) / steps as f32;
        let between: f32 = (0..steps).map(|i| self.share(a + (i as f32 + 0.5) * h) * h).sum();
        TAU * ((1.0 - b) + between)
    }
}

impl PunctualLight for Spot {
    fn position(&self) -> Vec3 {
        self.position
    }

    fn intensity(&self, p: Vec3, lambda: &Wavelengths, textures: &Textures, _mode: ColorMode) -> Spectrum {
        let local = self.world_from_light.inverse().vector(p - self.position).normalize_or_zero();
        // Angle from the axis in the light's own frame.
        let share = self.share(local.z);
        if share <= 0.0 {
            return Spectrum::ZERO;
        }
        let mut intensity = self.intensity.eval(lambda) * share;
        if let Some(texture) = &self.texture {
            // Project the slide perspectively onto the cone's cross-section.
            let half = self.total.tan();
            let uv = Vec2::new(local.x, local.y) / (local.z * half) * 0.5 + 0.5;
            intensity *= texture.eval(textures, &TextureContext::new(p, uv), lambda);
        }
        intensity
    }

    fn flux(&self, mode: ColorMode) -> f32 {
        self.flux_share() * self.intensity.luminance(mode)
    }

    fn draw(&self, u: Vec2) -> Option<(Vec3, f32)> {
        // Uniform within the outer cone; a scaled placement changes solid angles.
        let m = 1.0 - self.total.cos();
        let local = warp::uniform_cone(u, m);
        let pdf = warp::uniform_cone_pdf(m) / self.world_from_light.solid_angle(local);
        Some((self.world_from_light.vector(local).try_normalize()?, pdf))
    }

    fn pdf(&self, w: Vec3) -> f32 {
        // The same density where the direction lies within the cone.
        let local = self.world_from_light.inverse().vector(w).normalize_or_zero();
        if local.z >= self.total.cos() {
            warp::uniform_cone_pdf(1.0 - self.total.cos()) / self.world_from_light.solid_angle(local)
        } else {
            0.0
        }
    }

    fn bounds(&self, mode: ColorMode) -> LightBounds {
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
    /// Position of the light.
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
        // Map the direction to the equal-area octahedron (Clarberg 2008) and take the nearest texel.
        let uv = warp::equal_area_sphere_to_square(local);
        nearest(&self.image, uv).element_sum() / 3.0
    }

    /// Mean of the image.
    pub fn mean(&self) -> f32 {
        mean(&self.image).element_sum() / 3.0
    }
}

impl PunctualLight for Goniometric {
    fn position(&self) -> Vec3 {
        self.position
    }

    fn intensity(&self, p: Vec3, lambda: &Wavelengths, _textures: &Textures, _mode: ColorMode) -> Spectrum {
        self.intensity.eval(lambda) * self.factor(p)
    }

    fn bounds(&self, mode: ColorMode) -> LightBounds {
        LightBounds::point(self.position, self.intensity.luminance(mode) * max(&self.image))
    }

    fn flux(&self, mode: ColorMode) -> f32 {
        // The equal-area map makes the flux 4π times the mean of the image.
        4.0 * PI * self.mean() * self.intensity.luminance(mode)
    }
}

/// Slide of a projector.
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
    /// Position and orientation of the light.
    pub world_from_light: Affine,
    /// Projected slide.
    pub slide: Slide,
    /// Half extents of the slide at z = 1.
    pub half: Vec2,
    /// Factor on the slide's values.
    pub scale: f32,
    /// True if values are irradiances at z = 1 (Mitsuba), which fall with the cube of the cosine; false if they are
    /// intensities (pbrt).
    pub is_irradiance: bool,
}

impl PunctualLight for Projection {
    fn position(&self) -> Vec3 {
        self.world_from_light.point(Vec3::ZERO)
    }

    fn intensity(&self, p: Vec3, lambda: &Wavelengths, textures: &Textures, mode: ColorMode) -> Spectrum {
        let local = self.world_from_light.inverse().point(p);
        if local.z <= 0.0 {
            return Spectrum::ZERO;
        }
        // Coordinates on the slide at z = 1.
        let s = Vec2::new(local.x, local.y) / (local.z * self.half);
        if s.x.abs() > 1.0 || s.y.abs() > 1.0 {
            return Spectrum::ZERO;
        }
        // The image's v axis points down, that of the slide up.
        let uv = Vec2::new(0.5 + 0.5 * s.x, 0.5 - 0.5 * s.y);
        let value = match &self.slide {
            Slide::Image(image) => role::texel(nearest(image, uv), Role::Illuminant, lambda, mode),
            Slide::Texture(t) => t.eval(textures, &TextureContext::new(p, uv), lambda),
        };
        // Irradiance on the slide's plane is I·cos³θ/z²: divide it out.
        let cos = local.z / local.length();
        value * if self.is_irradiance { self.scale / (cos * cos * cos) } else { self.scale }
    }

    fn bounds(&self, mode: ColorMode) -> LightBounds {
        LightBounds::point(self.position(), self.max_intensity(mode))
    }

    fn flux(&self, mode: ColorMode) -> f32 {
        // The solid angle of the slide is less than its area at distance one.
        self.max_intensity(mode) * (4.0 * self.half.x * self.half.y).min(TAU)
    }

    fn draw(&self, u: Vec2) -> Option<(Vec3, f32)> {
        // Uniform over the slide; dω = cos³θ dA at distance one.
        let at = (u * 2.0 - 1.0) * self.half;
        let local = Vec3::new(at.x, at.y, 1.0).normalize();
        let pdf = 1.0 / (4.0 * self.half.x * self.half.y * local.z.powi(3));
        let w = self.world_from_light.vector(local).try_normalize()?;
        Some((w, pdf / self.world_from_light.solid_angle(local)))
    }

    fn pdf(&self, w: Vec3) -> f32 {
        // Project the direction onto the slide; without the slide's area there is no density.
        let local = self.world_from_light.inverse().vector(w).normalize_or_zero();
        let at = Vec2::new(local.x, local.y) / (local.z * self.half);
        if local.z > 0.0 && at.abs().max_element() <= 1.0 {
            1.0 / (4.0 * self.half.x * self.half.y * local.z.powi(3)) / self.world_from_light.solid_angle(local)
        } else {
            0.0
        }
    }
}

impl Projection {
    /// A bound on the intensity, as luminance; a guess of one for textures.
    pub fn max_intensity(&self, mode: ColorMode) -> f32 {
        let value = match &self.slide {
            Slide::Image(image) => max(image),
            Slide::Texture(SpectrumTexture::Constant(c)) => c.luminance(mode),
            Slide::Texture(_) => 1.0,
        };
        // The greatest distance on the slide's plane bounds the factor 1/cos³θ.
        let corner = (1.0 + self.half.length_squared()).sqrt();
        value * self.scale * if self.is_irradiance { corner.powi(3) } else { 1.0 }
    }

    /// Flux for the image as it is, as luminance, before the scale.
    pub fn flux_of(&self, image: &Texels) -> f32 {
        // ∫ L cos³θ dA over the slide's plane.
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
        for falloff in [Falloff::Smoothstep, Falloff::Linear, Falloff::Quadratic] {
            let mut s = Spot {
                position: Vec3::ZERO,
                world_from_light: Affine::IDENTITY,
                intensity: Color::constant(1.0),
                total: 0.6,
                start: 0.6,
                falloff,
                texture: None,
            };
            let cone = TAU * (1.0 - 0.6_f32.cos());
            assert!((s.flux_share() / cone - 1.0).abs() < 1e-5);
            s.start = 0.3;
            let lambda = Wavelengths::sample_visible(0.5);
            let n = 40_000;
            let mut rng = steradian_math::hash::HashRng::new(5);
            let mean = (0..n)
                .map(|_| warp::uniform_sphere(Vec2::new(rng.next_f32(), rng.next_f32())))
                .map(|w| s.intensity(w * 3.0, &lambda, &Textures::default(), ColorMode::Spectral)[0])
                .sum::<f32>()
                / n as f32;
            let flux = mean * 4.0 * PI;
            assert!((flux / s.flux_share() - 1.0).abs() < 0.06, "{flux} {}", s.flux_share());
        }
    }
}
