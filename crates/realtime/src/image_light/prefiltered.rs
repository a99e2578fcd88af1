//! Environments blurred by GGX lobes, a map for each roughness (Karis 2013, "Real Shading in Unreal Engine 4").

use rayon::prelude::*;
use steradian_bsdf::Microfacet;
use steradian_math::{
    Frame, Vec2, Vec3, cell,
    warp::{equal_area_sphere_to_square, equal_area_square_to_sphere, wrap_equal_area_square},
};

/// Sides of the maps in texels, for roughness √α = k/8.
const SIZES: [u32; 9] = [512, 256, 128, 64, 32, 32, 16, 16, 16];
/// Directions of the lobe for each texel.
const DIRECTIONS: u32 = 64;

/// A picture of all directions: a square of texels of equal solid angle (Clarberg 2008).
#[derive(Clone, Debug)]
struct Map {
    size: u32,
    texels: Vec<Vec3>,
}

/// The maps of an environment.
#[derive(Clone, Debug)]
pub struct Prefiltered {
    /// By roughness.
    maps: Vec<Map>,
}

impl Map {
    /// Bilinear lookup.
    fn at(&self, w: Vec3) -> Vec3 {
        let size = self.size as f32;
        let at = equal_area_sphere_to_square(w) * size - 0.5;
        let corner = at.floor();
        let part = at - corner;
        // Texels beyond a side are those of the same direction within.
        let texel = |x: f32, y: f32| {
            let at = wrap_equal_area_square((corner + Vec2::new(x, y) + 0.5) / size) * size;
            let [x, y] = [at.x as u32, at.y as u32].map(|v| v.min(self.size - 1));
            self.texels[(y * self.size + x) as usize]
        };
        let row = |y| texel(0.0, y) * (1.0 - part.x) + texel(1.0, y) * part.x;
        row(0.0) * (1.0 - part.y) + row(1.0) * part.y
    }

    /// Half the size: means of four texels.
    fn halved(&self) -> Self {
        let size = self.size / 2;
        let texel = |k: u32| {
            let (x, y) = (2 * (k % size), 2 * (k / size));
            let at = |dx, dy| self.texels[((y + dy) * self.size + x + dx) as usize];
            (at(0, 0) + at(1, 0) + at(0, 1) + at(1, 1)) * 0.25
        };
        Self { size, texels: (0..size * size).map(texel).collect() }
    }
}

/// Direction of the middle of a texel.
fn middle(k: u32, size: u32) -> Vec3 {
    equal_area_square_to_sphere((Vec2::new((k % size) as f32, (k / size) as f32) + 0.5) / size as f32)
}

impl Prefiltered {
    /// Blurs an environment, of which a direction's radiance, a draw with its density, and the density are given.
    pub fn new(
        radiance: impl Fn(Vec3) -> Vec3 + Sync,
        draw: impl Fn(Vec2) -> Option<(Vec3, f32)> + Sync,
        density: impl Fn(Vec3) -> f32 + Sync,
    ) -> Self {
        let sharp = sharp(&radiance, draw, density);
        let mut pyramid = vec![sharp];
        while let Some(last) = pyramid.last().filter(|map| map.size > 1) {
            pyramid.push(last.halved());
        }
        let roughest = (SIZES.len() - 1) as f32;
        let blurred = |(k, size): (usize, &u32)| blurred(&pyramid, *size, (k as f32 / roughest).powi(2));
        let maps = SIZES.iter().enumerate().skip(1).map(blurred);
        let maps: Vec<Map> = std::iter::once(pyramid[0].clone()).chain(maps).collect();
        Self { maps }
    }

    /// Mean radiance under a lobe of roughness `alpha` around a direction.
    pub fn at(&self, w: Vec3, alpha: f32) -> Vec3 {
        let (k, part) = cell(alpha.clamp(0.0, 1.0).sqrt() * (self.maps.len() - 1) as f32, self.maps.len() - 1);
        self.maps[k].at(w) * (1.0 - part) + self.maps[k + 1].at(w) * part
    }
}

/// The environment in texels: at their middles, and where the light draws many directions for each texel, by these, so
/// that small bright suns keep their energy.
fn sharp(
    radiance: &(impl Fn(Vec3) -> Vec3 + Sync),
    draw: impl Fn(Vec2) -> Option<(Vec3, f32)> + Sync,
    density: impl Fn(Vec3) -> f32 + Sync,
) -> Map {
    const EVEN: f32 = 0.25 * std::f32::consts::FRAC_1_PI;
    let (size, count) = (SIZES[0], SIZES[0] * SIZES[0]);
    // Directions drawn for a texel from which on they are better than its middle.
    const MANY: f32 = 16.0;
    let finite = |light: Vec3| if light.is_finite() { light } else { Vec3::ZERO };
    let at_middle = |k: u32| {
        let w = middle(k, size);
        if density(w) < MANY * EVEN { finite(radiance(w)) } else { Vec3::ZERO }
    };
    let mut texels: Vec<Vec3> = (0..count).into_par_iter().map(at_middle).collect();
    // A draw adds its share of the radiance over the solid angle of a texel.
    let drawn = |k: u32| {
        let u = Vec2::new((k as f32 + 0.5) / count as f32, k.reverse_bits() as f32 / 4_294_967_296.0);
        let (w, pdf) = draw(u.min(Vec2::splat(1.0 - f32::EPSILON)))?;
        let at = (equal_area_sphere_to_square(w) * size as f32).clamp(Vec2::ZERO, Vec2::splat(size as f32 - 1.0));
        let light = finite(radiance(w) * (EVEN / pdf));
        (density(w) >= MANY * EVEN).then_some(((at.y as u32 * size + at.x as u32) as usize, light))
    };
    let draws: Vec<_> = (0..count).into_par_iter().filter_map(drawn).collect();
    draws.into_iter().for_each(|(texel, light)| texels[texel] += light);
    Map { size, texels }
}

/// A map of a roughness: Σ L(ωᵢ) cosθᵢ / Σ cosθᵢ of directions drawn by the lobe that is seen along its normal. Each
/// takes the level of the pyramid whose texels have its solid angle (Křivánek, Colbert 2008, "Real-time shading with
/// filtered importance sampling").
fn blurred(pyramid: &[Map], size: u32, alpha: f32) -> Map {
    let facets = Microfacet::ggx(alpha, alpha);
    let finest = pyramid[0].size as f32;
    let texel_angle = 4.0 * std::f32::consts::PI / (finest * finest);
    // Directions about z with their cosines and levels, the same for all texels.
    let lobe: Vec<(Vec3, usize)> = (0..DIRECTIONS)
        .filter_map(|k| {
            let u = Vec2::new((k as f32 + 0.5) / DIRECTIONS as f32, k.reverse_bits() as f32 / 4_294_967_296.0);
            let m = facets.sample_visible(Vec3::Z, u);
            let w = 2.0 * m.z * m - Vec3::Z;
            // The density of reflected directions is D/4 where the view is along the normal.
            let angle = 4.0 / (DIRECTIONS as f32 * facets.d(m));
            let level = (0.5 * (angle / texel_angle).log2()).max(0.0).round() as usize;
            (w.z > 0.0).then_some((w, level.min(pyramid.len() - 1)))
        })
        .collect();
    let all: f32 = lobe.iter().map(|(w, _)| w.z).sum();
    let texel = |k: u32| {
        let frame = Frame::from_z(middle(k, size));
        lobe.iter().map(|(w, level)| pyramid[*level].at(frame.to_world(*w)) * w.z).sum::<Vec3>() / all
    };
    Map { size, texels: (0..size * size).into_par_iter().map(texel).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian_math::warp;

    /// An even environment stays as it is; a small sun keeps its energy at every roughness, and moves nowhere.
    #[test]
    fn energy_is_kept() {
        let even = |u: Vec2| Some((warp::uniform_sphere(u), 0.25 * std::f32::consts::FRAC_1_PI));
        let density = |_| 0.25 * std::f32::consts::FRAC_1_PI;
        let grey = Prefiltered::new(|_| Vec3::splat(0.5), even, density);
        for map in &grey.maps {
            assert!(map.texels.iter().all(|t| (*t - 0.5).abs().max_element() < 1e-4));
        }
        // A disc of 0.01 radians and radiance 1000, across the border of the square.
        let axis = Vec3::new(0.3, 0.0, -0.95).normalize();
        let (cos, frame) = (0.01_f32.cos(), Frame::from_z(axis));
        let pdf = 0.5 * std::f32::consts::FRAC_1_PI / (1.0 - cos);
        let is_in = |w: Vec3| w.dot(axis) >= cos;
        let draw = |u: Vec2| {
            let z = 1.0 - u.x * (1.0 - cos);
            let (sin, phi) = ((1.0 - z * z).max(0.0).sqrt(), std::f32::consts::TAU * u.y);
            Some((frame.to_world(Vec3::new(sin * phi.cos(), sin * phi.sin(), z)), pdf))
        };
        let radiance = |w| if is_in(w) { Vec3::splat(1000.0) } else { Vec3::ZERO };
        let sun = Prefiltered::new(radiance, draw, |w| if is_in(w) { pdf } else { 0.0 });
        let energy = 1000.0 / pdf;
        for (k, map) in sun.maps.iter().enumerate() {
            let area = 4.0 * std::f32::consts::PI / (map.size * map.size) as f32;
            let sum: Vec3 = map.texels.iter().sum::<Vec3>() * area;
            assert!((sum.x / energy - 1.0).abs() < 0.03, "{k}: {} of {energy}", sum.x);
            let brightest = (0..map.texels.len()).max_by(|a, b| map.texels[*a].x.total_cmp(&map.texels[*b].x));
            let w = middle(brightest.unwrap_or(0) as u32, map.size);
            assert!(w.dot(axis) > 0.97, "{k}: {w}");
        }
    }
}
