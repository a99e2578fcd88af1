//! Light from all directions: constant, an image, or the sky, maybe seen through a portal.
//!
//! A constant environment is found by samples of the BSDF only. A picture is sampled by its luminance above the mean
//! (MIS compensation, Karlík et al. 2019), unless it is nearly constant. Portals are sampled by solid angle. The sky is
//! two environments: the dome, sampled by a table of its luminance but evaluated by the model, and the sun, sampled as
//! a cone.

use super::{cube, punctual::rgb, sky::Celestial};
use steradian_image::Texels;
use steradian_math::{
    Spectrum, Vec2, Vec3,
    color::luminance,
    distribution::Piecewise2D,
    spectra::{
        ColorMode, Wavelengths, role,
        role::{Color, Role},
    },
    transform::Affine,
    warp::{self, SphericalRectangle},
};

/// Mapping of an image to the sphere of directions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parametrization {
    /// Equal-area octahedral (Clarberg 2008), local +z up: pbrt-v4.
    Octahedral,
    /// Longitude and latitude, local +y up, the middle column at +z … as Mitsuba has it: `u = atan2(x, −z)/2π`,
    /// `v = acos(y)/π`.
    LatLongY {
        /// True if the first and last row stand at the poles, row `i` of `h` at `v = i/(h − 1)` (Mitsuba 3), rather
        /// than at the middle of `h` strips.
        poles: bool,
    },
    /// Longitude and latitude, local +z up: `u = φ/2π`, `v = θ/π`.
    LatLongZ,
    /// Six faces of a cube below each other: [`cube`].
    Cube,
}

/// An image around the scene.
#[derive(Clone, Debug)]
pub struct EnvironmentImage {
    /// The image.
    pub texels: Texels,
    /// Mapping of the image to the sphere.
    pub parametrization: Parametrization,
    /// Its orientation.
    pub world_from_light: Affine,
    /// Sampling distribution of directions: the luminance above the mean, so that directions that scattering finds well
    /// anyway are left to it (MIS compensation, Karlík et al. 2019).
    distribution: Piecewise2D,
    /// Estimate of the irradiance in the part that is sampled.
    excess: f32,
}

/// An environment light.
#[derive(Clone, Debug)]
pub struct Environment {
    /// A constant radiance (white for images).
    pub radiance: Color,
    /// Factor on everything.
    pub scale: f32,
    /// The image, if any.
    pub image: Option<EnvironmentImage>,
    /// The sky or the sun instead, if any.
    pub celestial: Option<Celestial>,
    /// A quadrilateral through which alone it is seen, as corner and two edges, if any.
    pub portal: Option<[Vec3; 3]>,
    /// The colour mode.
    pub mode: ColorMode,
}

impl EnvironmentImage {
    /// Prepares an image for sampling.
    pub fn new(texels: Texels, parametrization: Parametrization, world_from_light: Affine) -> Self {
        let (w, h) = (texels.width, texels.height);
        let area = |x: usize, y: usize| match parametrization {
            // Solid angle of a texel relative to the mean: π/2·sin θ in a latitude–longitude map, constant in an
            // equal-area one.
            Parametrization::Octahedral => 1.0,
            Parametrization::Cube => {
                let uv = Vec2::new((x as f32 + 0.5) / w as f32, (y as f32 + 0.5) / h as f32);
                cube::direction(uv).1 / (4.0 * std::f32::consts::PI)
            }
            _ => (std::f32::consts::PI * (y as f32 + 0.5) / h as f32).sin() * std::f32::consts::FRAC_PI_2,
        };
        let light = |x: usize, y: usize| luminance(rgb(&texels, x, y)).max(0.0);
        // A cell counts as its brightest neighbour: interpolation spreads texels over half of the next.
        let cell = |x: usize, y: usize| {
            let mut m = 0.0_f32;
            for dy in [h - 1, 0, 1] {
                for dx in [w - 1, 0, 1] {
                    let yy = if dy == 1 {
                        (y + 1).min(h - 1)
                    } else if dy == 0 {
                        y
                    } else {
                        y.saturating_sub(1)
                    };
                    m = m.max(light((x + dx) % w, yy) * if (dx, dy) == (0, 0) { 1.0 } else { 0.5 });
                }
            }
            m
        };
        // Mean over the sphere, each row weighted by its solid angle.
        let row = |y: usize| -> f64 {
            match parametrization {
                Parametrization::Cube => (0..w).map(|x| f64::from(light(x, y)) * f64::from(area(x, y))).sum(),
                _ => f64::from(area(0, y)) * (0..w).map(|x| f64::from(light(x, y))).sum::<f64>(),
            }
        };
        let total: f64 = (0..h).map(row).sum();
        let mean = (total / (w * h) as f64) as f32;
        let mut excess = 0.0_f64;
        let mut values = Vec::with_capacity(w * h);
        for y in 0..h {
            for x in 0..w {
                // MIS compensation: sample only the part above the mean, which samples of the BSDF do not find well
                // (Karlík et al. 2019).
                let v = (cell(x, y) - mean).max(0.0) * area(x, y);
                excess += f64::from((light(x, y) - mean).max(0.0) * area(x, y));
                values.push(if v.is_finite() { v } else { 0.0 });
            }
        }
        // Radiance above the mean, integrated over the sphere (4π times its average), at a mean cosine of one half.
        let excess = (excess / (w * h) as f64) as f32 * 4.0 * std::f32::consts::PI * 0.5;
        let flat = excess < 0.02 * mean * std::f32::consts::PI;
        let distribution = Piecewise2D::new(&values, w, h);
        Self { texels, parametrization, world_from_light, distribution, excess: if flat { 0.0 } else { excess } }
    }

    /// Image coordinates of a world direction (v down).
    #[inline]
    fn uv(&self, w: Vec3) -> Vec2 {
        // Rotate into the frame of the map, then apply its parametrisation.
        let d = self.world_from_light.inverse().vector(w).normalize_or(Vec3::Z);
        match self.parametrization {
            Parametrization::Octahedral => warp::equal_area_sphere_to_square(d),
            Parametrization::LatLongZ => warp::latlong_from_direction(d),
            Parametrization::Cube => cube::uv(d),
            Parametrization::LatLongY { .. } => {
                let u = d.x.atan2(-d.z) * (0.5 * std::f32::consts::FRAC_1_PI);
                Vec2::new(u - u.floor(), d.y.clamp(-1.0, 1.0).acos() * std::f32::consts::FRAC_1_PI)
            }
        }
    }

    /// The world direction of image coordinates, and the density of directions per unit of image area:
    /// `pdf_ω = pdf_uv · that`.
    #[inline]
    fn direction(&self, uv: Vec2) -> (Vec3, f32) {
        use std::f32::consts::PI;
        // Density in solid angle: constant for equal-area maps, 1/(2π² sin θ) for latitude and longitude.
        let (d, density) = match self.parametrization {
            Parametrization::Octahedral => (warp::equal_area_square_to_sphere(uv), 1.0 / (4.0 * PI)),
            Parametrization::Cube => {
                let (d, solid_angle) = cube::direction(uv);
                (d, 1.0 / solid_angle)
            }
            Parametrization::LatLongZ => {
                let (d, sin) = warp::direction_from_latlong(uv);
                (d, 1.0 / (2.0 * PI * PI * sin))
            }
            Parametrization::LatLongY { .. } => {
                let (sin, cos) = (uv.y * PI).sin_cos();
                let phi = uv.x * 2.0 * PI;
                (Vec3::new(phi.sin() * sin, cos, -phi.cos() * sin), 1.0 / (2.0 * PI * PI * sin))
            }
        };
        (self.world_from_light.vector(d).normalize_or(Vec3::Z), density)
    }

    /// Interpolated linear RGB. Spectral variants of Mitsuba 3 (where rows stand at the poles) interpolate brightness
    /// and hue by themselves, so that the mean of a bright and a dark texel is another one.
    #[inline]
    fn lookup(&self, uv: Vec2, mode: ColorMode) -> Vec3 {
        let (w, h) = (self.texels.width as i64, self.texels.height as i64);
        if self.parametrization == Parametrization::Cube {
            let around = cube::around(uv, self.texels.width);
            return around.iter().fold(Vec3::ZERO, |sum, ([x, y], weight)| sum + rgb(&self.texels, *x, *y) * *weight);
        }
        let fetch = |x: i64, y: i64| {
            let (x, y) = match self.parametrization {
                Parametrization::Octahedral => {
                    // Beyond an edge the map goes on mirrored about the edge's middle.
                    let (mut x, mut y) = (x, y);
                    if x < 0 || x >= w {
                        x = if x < 0 { -1 - x } else { 2 * w - 1 - x };
                        y = h - 1 - y;
                    }
                    if y < 0 || y >= h {
                        y = if y < 0 { -1 - y } else { 2 * h - 1 - y };
                        x = w - 1 - x;
                    }
                    (x.clamp(0, w - 1), y.clamp(0, h - 1))
                }
                _ => (x.rem_euclid(w), y.clamp(0, h - 1)),
            };
            rgb(&self.texels, x as usize, y as usize)
        };
        // Bilinear interpolation between the centres of texels.
        let y = match self.parametrization {
            Parametrization::LatLongY { poles: true } => uv.y * (h - 1) as f32,
            _ => uv.y * h as f32 - 0.5,
        };
        let x = uv.x * w as f32 - 0.5;
        let (x0, y0) = (x.floor(), y.floor());
        let (dx, dy) = (x - x0, y - y0);
        let (x0, y0) = (x0 as i64, y0 as i64);
        let corners = [fetch(x0, y0), fetch(x0 + 1, y0), fetch(x0, y0 + 1), fetch(x0 + 1, y0 + 1)];
        let mean = |[a, b, c, d]: [Vec3; 4]| (a * (1.0 - dx) + b * dx) * (1.0 - dy) + (c * (1.0 - dx) + d * dx) * dy;
        // Separate the brightest component from the ratio to it, and interpolate each.
        if mode == ColorMode::Spectral && self.parametrization == (Parametrization::LatLongY { poles: true }) {
            let brightness = corners.map(|c| Vec3::splat(c.max_element()));
            let hues = corners.map(|c| c / c.max_element().max(f32::MIN_POSITIVE));
            return mean(hues) * mean(brightness);
        }
        mean(corners)
    }
}

impl Environment {
    /// Radiance that arrives at `p` from direction `w`.
    #[inline]
    pub fn radiance(&self, p: Vec3, w: Vec3, lambda: &Wavelengths) -> Spectrum {
        if self.portal.is_some_and(|q| through(q, p, w).is_none()) {
            return Spectrum::ZERO;
        }
        self.beyond(w, lambda)
    }

    /// Radiance from direction `w`, where no portal stands before it.
    #[inline]
    pub fn beyond(&self, w: Vec3, lambda: &Wavelengths) -> Spectrum {
        match (&self.image, &self.celestial) {
            (None, None) => self.radiance.eval(lambda) * self.scale,
            (None, Some(celestial)) => celestial.radiance(w, lambda) * self.scale,
            (Some(image), _) => {
                let rgb = image.lookup(image.uv(w), self.mode);
                role::texel(rgb, Role::Illuminant, lambda, self.mode) * self.scale
            }
        }
    }

    /// Estimate of the irradiance (as luminance) that next-event estimation has to find; zero where scattering finds
    /// all of it well enough (constant environments).
    pub fn sampled_irradiance(&self) -> f32 {
        match (&self.image, &self.portal) {
            (None, None) => self.celestial.as_ref().map_or(0.0, |c| c.irradiance() * self.scale),
            (None, Some(_)) => self.radiance.luminance(self.mode) * self.scale,
            (Some(image), None) => image.excess * self.scale,
            (Some(image), Some(_)) => (image.excess * self.scale).max(f32::MIN_POSITIVE),
        }
    }

    /// A direction and its density per solid angle.
    #[inline]
    pub fn sample(&self, p: Vec3, u: Vec2) -> Option<(Vec3, f32)> {
        let wi = match (&self.portal, &self.image) {
            (Some([corner, ex, ey]), _) => {
                // A portal is sampled uniformly in the solid angle it subtends.
                let rectangle = SphericalRectangle::new(*corner, *ex, *ey, p);
                if rectangle.solid_angle <= 0.0 {
                    return None;
                }
                (rectangle.sample(u) - p).try_normalize()?
            }
            (None, Some(image)) => {
                // Draw image coordinates by the tabulated distribution and convert the density.
                let (uv, pdf) = image.distribution.sample(u);
                let (wi, density) = image.direction(uv);
                let pdf = pdf * density;
                return (pdf > 0.0 && pdf.is_finite()).then_some((wi, pdf));
            }
            (None, None) => return self.celestial.as_ref().map(|c| c.sample(u)).filter(|s| s.1 > 0.0),
        };
        let pdf = self.pdf(p, wi);
        (pdf > 0.0).then_some((wi, pdf))
    }

    /// The density of [`Environment::sample`] for a direction.
    #[inline]
    pub fn pdf(&self, p: Vec3, w: Vec3) -> f32 {
        match (&self.portal, &self.image) {
            (Some(q), _) => match through(*q, p, w) {
                Some(()) => {
                    let s = SphericalRectangle::new(q[0], q[1], q[2], p).solid_angle;
                    if s > 0.0 { 1.0 / s } else { 0.0 }
                }
                None => 0.0,
            },
            (None, Some(image)) => {
                // Density of image coordinates times the Jacobian of the parametrisation.
                let uv = image.uv(w);
                let density = match image.parametrization {
                    Parametrization::Octahedral => 0.25 * std::f32::consts::FRAC_1_PI,
                    Parametrization::Cube => 1.0 / cube::direction(uv).1,
                    _ => {
                        let sin = (uv.y * std::f32::consts::PI).sin();
                        1.0 / (2.0 * std::f32::consts::PI * std::f32::consts::PI * sin)
                    }
                };
                let pdf = image.distribution.pdf(uv) * density;
                if pdf.is_finite() { pdf } else { 0.0 }
            }
            (None, None) => self.celestial.as_ref().map_or(0.0, |c| c.pdf(w)),
        }
    }
}

/// `Some` if the ray from `p` along `w` passes through a rectangle given by corner and edges.
#[inline]
fn through([corner, ex, ey]: [Vec3; 3], p: Vec3, w: Vec3) -> Option<()> {
    // Intersect the plane of the rectangle and compare with its edges.
    let n = ex.cross(ey);
    let t = n.dot(corner - p) / n.dot(w);
    let q = p + w * t - corner;
    let (s, r) = (q.dot(ex) / ex.length_squared(), q.dot(ey) / ey.length_squared());
    (t > 0.0 && (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&r)).then_some(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian_image::{Encoding, TexelData};
    use steradian_math::hash::HashRng;

    fn image(parametrization: Parametrization) -> EnvironmentImage {
        let (w, h) = (32, if parametrization == Parametrization::Octahedral { 32 } else { 16 });
        let mut rng = HashRng::new(9);
        let mut data = Vec::new();
        for _ in 0..w * h {
            let v = rng.next_f32().powi(8) * 20.0;
            data.extend([v, v * 0.5, 0.1]);
        }
        let texels = Texels {
            width: w,
            height: h,
            channels: 3,
            data: TexelData::F32(data),
            encoding: Encoding::Linear,
            metadata: Default::default(),
        };
        let turn = steradian_math::Transform::rotate(steradian_math::DVec3::new(1.0, 2.0, 0.5), 0.7).affine().unwrap();
        EnvironmentImage::new(texels, parametrization, turn)
    }

    const ALL: [Parametrization; 4] = [
        Parametrization::Octahedral,
        Parametrization::LatLongY { poles: false },
        Parametrization::LatLongY { poles: true },
        Parametrization::LatLongZ,
    ];

    #[test]
    fn directions_and_coordinates_are_inverse() {
        let mut rng = HashRng::new(2);
        for p in ALL {
            let image = image(p);
            for _ in 0..500 {
                let uv = Vec2::new(rng.next_f32(), rng.next_f32() * 0.98 + 0.01);
                let (d, _) = image.direction(uv);
                assert!((image.uv(d) - uv).length() < 2e-3, "{p:?} {uv} {}", image.uv(d));
            }
        }
    }

    /// Rows at the poles: row i of h at v = i/(h − 1); columns at the middle of strips all the same. In spectral mode
    /// brightness and hue are interpolated by themselves.
    #[test]
    fn rows_at_the_poles() {
        let (w, h) = (4, 3);
        let data = (0..w * h).flat_map(|i| [i as f32, 2.0 * i as f32, 1.0]).collect();
        let (data, encoding) = (TexelData::F32(data), Encoding::Linear);
        let texels = Texels { width: w, height: h, channels: 3, data, encoding, metadata: Default::default() };
        let image = EnvironmentImage::new(texels, Parametrization::LatLongY { poles: true }, Affine::default());
        let at = |u: f32, v: f32| image.lookup(Vec2::new(u, v), ColorMode::Rgb).x;
        for (row, v) in [(0, 0.0), (1, 0.5), (2, 1.0)] {
            for column in 0..4 {
                let u = (column as f32 + 0.5) / 4.0;
                assert!((at(u, v) - (4 * row + column) as f32).abs() < 1e-5, "{u} {v}: {}", at(u, v));
            }
        }
        assert!((at(0.125, 0.75) - 6.0).abs() < 1e-5);
        // Between texels (1, 2, 1) and (2, 4, 1): hue (½, 1, (½ + ¼)/2) times brightness 3.
        let rgb = image.lookup(Vec2::new(0.5, 0.0), ColorMode::Spectral);
        assert!((rgb - Vec3::new(1.5, 3.0, 1.125)).length() < 1e-5, "{rgb}");
    }

    /// The density integrates to one over the sphere and samples follow it: the mean of `1/pdf` over samples with
    /// `f = 1` on the support is the support's solid angle, found by uniform sampling.
    #[test]
    fn density_is_normalised_and_sampled() {
        for p in ALL {
            let env = Environment {
                radiance: Color::constant(1.0),
                scale: 1.0,
                image: Some(image(p)),
                celestial: None,
                portal: None,
                mode: ColorMode::Rgb,
            };
            let mut rng = HashRng::new(4);
            let n = 200_000;
            let (mut integral, mut z, mut z_sampled) = (0.0_f64, 0.0_f64, 0.0_f64);
            let (mut none, mut strays) = (0, 0);
            for _ in 0..n {
                let w = warp::uniform_sphere(Vec2::new(rng.next_f32(), rng.next_f32()));
                let pdf = f64::from(env.pdf(Vec3::ZERO, w));
                integral += pdf;
                z += pdf * f64::from(w.z * w.x);
                let Some((wi, pdf)) = env.sample(Vec3::ZERO, Vec2::new(rng.next_f32(), rng.next_f32())) else {
                    none += 1;
                    continue;
                };
                // Rounding may move a direction at the border of a texel into the next one.
                strays += i32::from((env.pdf(Vec3::ZERO, wi) / pdf - 1.0).abs() > 1e-3);
                z_sampled += f64::from(wi.z * wi.x);
            }
            assert!(none < n / 10_000 && strays < n / 1000, "{p:?}: {none} lost, {strays} astray of {n}");
            let k = 4.0 * std::f64::consts::PI / f64::from(n);
            assert!((integral * k - 1.0).abs() < 0.03, "{p:?}: {}", integral * k);
            assert!((z * k - z_sampled / f64::from(n)).abs() < 0.02, "{p:?}");
        }
    }
}
