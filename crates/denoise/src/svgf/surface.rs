//! What filters compare of two pixels.

use steradian_math::{Vec2, Vec3, elementary::exp};

use super::settings::Settings;
use crate::{gbuffer::GBuffer, image::Image};

/// How much depths may differ beyond what gradients tell, relative to them: surfaces are curved.
const CURVATURE: f32 = 1e-3;

/// The part of a G-buffer that says whether two pixels show one surface.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Surface {
    pub depth: f32,
    pub gradient: Vec2,
    pub normal: Vec3,
    pub id: u32,
}

impl Surface {
    /// Those of all pixels.
    pub fn all(gbuffer: &GBuffer) -> Image<Self> {
        let [width, height] = gbuffer.size();
        Image::by_rows(width, height, |x, y| Self {
            depth: gbuffer.depth.at(x, y),
            gradient: gbuffer.depth_gradient.at(x, y),
            normal: gbuffer.normal.at(x, y),
            id: gbuffer.id.at(x, y),
        })
    }

    /// How much a pixel at an offset counts for this one, from 0 to 1: w_z and w_n of the paper's equations 3 and 4,
    /// and the weight of luminance, exp(−`difference`). 0 for another object.
    #[inline]
    pub fn weight(&self, other: &Self, offset: [i64; 2], difference: f32, settings: &Settings) -> f32 {
        if self.id != other.id {
            return 0.0;
        }
        let normal = if self.normal == other.normal {
            1.0
        } else {
            power(self.normal.dot(other.normal).clamp(0.0, 1.0), settings.normal_power)
        };
        let weight = normal * exp(-self.depths_apart(other, offset, settings.sigma_depth) - difference);
        // Not so for NaN.
        if weight > 0.0 { weight } else { 0.0 }
    }

    /// The exponent of w_z.
    #[inline]
    fn depths_apart(&self, other: &Self, [x, y]: [i64; 2], sigma: f32) -> f32 {
        if self.depth == other.depth {
            return 0.0;
        }
        let expected = self.gradient.dot(Vec2::new(x as f32, y as f32)).abs();
        (self.depth - other.depth).abs() / (sigma * expected + CURVATURE * self.depth.abs())
    }
}

/// x^n by squaring.
fn power(mut x: f32, mut n: u32) -> f32 {
    let mut product = 1.0;
    while n > 0 {
        if n & 1 == 1 {
            product *= x;
        }
        x *= x;
        n >>= 1;
    }
    product
}
