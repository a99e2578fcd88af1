//! Normal maps from afar: normals that differ within the footprint look like roughness.
//!
//! Two ways are here (`relief/filtering.rs` has their equations): Toksvig's reads the spread off the length of the mean
//! normal, in the form that adds, `α'² = α² + 2 (1 − |n̄|)/|n̄|`; LEAN averages slopes and their squares, whose
//! variances add to those of the facets, `α'² = α² + 2 σ²`, each way. The covariance of the two axes is left out, since
//! facets have their axes along the surface's parametrisation.
//!
//! Both keep floats made from unit normals rather than the picture: codes of eight bits are off by up to 0.7 % in
//! length, which would count as a roughness of 0.1.

use crate::relief::filtering::Moments;
use std::sync::Arc;
use steradian_image::{Encoding, TexelData, Texels};
use steradian_math::{Vec2, Vec3};
use steradian_texture::{
    Filter, ImageTexture, TextureContext, Wrap,
    kernel::MipKernel,
    levels::{Levels, Recipe, Shape},
    store::{Level, Pages},
};

/// Mapping from the spread of normals to roughness.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NormalFilter {
    /// From the length of the mean normal: the same in all directions.
    Toksvig,
    /// From the variance of slopes, along both axes.
    Lean,
}

/// A normal map as levels of moments.
#[derive(Clone, Debug)]
pub struct FilteredNormals {
    kind: NormalFilter,
    moments: ImageTexture,
}

/// Slopes are at most this: normals below are taken up.
const STEEPEST: f32 = 20.0;

impl FilteredNormals {
    /// Takes a picture of normals apart; `normal` makes the tangent-space normal of a texel's value.
    ///
    /// # Errors
    /// Where levels cannot be written to `pages`.
    pub fn new(
        image: &ImageTexture,
        kind: NormalFilter,
        normal: impl Fn(Vec3) -> Vec3,
        pages: Option<&Arc<Pages>>,
    ) -> std::io::Result<Self> {
        let base = image.levels.base();
        let (width, height, channels) = (base.width(), base.height(), base.channels());
        let bytes = width * height * kind.channels() * size_of::<f32>();
        let room = pages.map(|pages| pages.take_room(bytes));
        let mut data = Vec::with_capacity(width * height * kind.channels());
        let mut row = vec![0.0; width * channels];
        for y in 0..height {
            base.linear_row(y, |i, v| row[i] = image.finish(v));
            for texel in row.chunks_exact(channels) {
                let rgb = if channels < 3 { Vec3::splat(texel[0]) } else { Vec3::new(texel[0], texel[1], texel[2]) };
                let n = normal(rgb).normalize_or(Vec3::Z);
                match kind {
                    NormalFilter::Toksvig => data.extend(n.to_array()),
                    NormalFilter::Lean => {
                        let m = Moments::of(n.with_z(n.z.max(1.0 / STEEPEST)));
                        data.extend([m.mean.x, m.mean.y, m.square.x, m.square.y]);
                    }
                }
            }
        }
        let texels = Texels {
            width,
            height,
            channels: kind.channels(),
            data: TexelData::F32(data),
            encoding: Encoding::Linear,
            metadata: Default::default(),
        };
        let filter = if image.filter.is_prefiltered() { image.filter } else { Filter::Trilinear };
        // Means over boxes need sums, and those are of the picture.
        let filter = if filter == Filter::Box { Filter::Trilinear } else { filter };
        let recipe = Recipe {
            shape: if filter == Filter::Ripmap { Shape::Rip } else { Shape::Mip },
            kernel: MipKernel::Box,
            wrap: image.wrap.map(|w| if w == Wrap::Border { Wrap::Clamp } else { w }),
            keep_coverage: None,
            bleed: false,
        };
        let base = Level::new(Arc::new(texels), pages)?;
        drop(room);
        let levels = Levels::new(base, &recipe, pages)?;
        let moments = ImageTexture {
            levels: Arc::new(levels),
            sums: None,
            filter,
            stochastic: false,
            wrap: recipe.wrap,
            channel: None,
            ..image.clone()
        };
        Ok(Self { kind, moments })
    }

    /// The mean normal in the tangent frame, of any length, and the variance of slopes along both axes.
    #[inline]
    pub fn normal(&self, at: &TextureContext) -> (Vec3, Vec2) {
        match self.kind {
            NormalFilter::Toksvig => {
                let mean = Vec3::from(self.moments.channels::<3>(at, 0));
                let length = mean.length().clamp(1e-2, 1.0);
                (mean, Vec2::splat((1.0 - length) / length))
            }
            NormalFilter::Lean => {
                let [x, y, xx, yy] = self.moments.channels::<4>(at, 0);
                let m = Moments { mean: Vec2::new(x, y), square: Vec2::new(xx, yy), product: 0.0 };
                (m.normal(), m.covariance().0)
            }
        }
    }
}

impl NormalFilter {
    fn channels(self) -> usize {
        match self {
            Self::Toksvig => 3,
            Self::Lean => 4,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian_bsdf::{Microfacet, NormalDistribution, Shadowing};
    use steradian_math::hash::HashRng;
    use steradian_texture::{Mapping, wrap::BLACK};

    const SIZE: usize = 64;

    /// Normals of Gaussian slopes with these standard deviations, as floats.
    fn ripples(sigma: Vec2) -> (ImageTexture, Vec<Vec2>) {
        let mut rng = HashRng::new(3);
        let slopes: Vec<Vec2> = (0..SIZE * SIZE)
            .map(|_| {
                // Box and Muller's pair.
                let (r, phi) = ((-2.0 * (1.0 - rng.next_f32()).ln()).sqrt(), std::f32::consts::TAU * rng.next_f32());
                sigma * Vec2::new(r * phi.cos(), r * phi.sin())
            })
            .collect();
        let code = |s: &Vec2| ((s.extend(1.0).normalize() + 1.0) * 0.5).to_array();
        let texels = Texels {
            width: SIZE,
            height: SIZE,
            channels: 3,
            data: TexelData::F32(slopes.iter().flat_map(code).collect()),
            encoding: Encoding::Linear,
            metadata: Default::default(),
        };
        let base = Level::new(Arc::new(texels), None).unwrap();
        let image = ImageTexture {
            levels: Arc::new(Levels::flat(base)),
            sums: None,
            filter: Filter::Trilinear,
            stochastic: false,
            wrap: [Wrap::Repeat; 2],
            borders: BLACK,
            channel: None,
            origin_bottom: false,
            scale: 1.0,
            invert: false,
            mapping: Mapping::default(),
        };
        (image, slopes)
    }

    fn filtered(image: &ImageTexture, kind: NormalFilter) -> FilteredNormals {
        FilteredNormals::new(image, kind, |v| v * 2.0 - 1.0, None).unwrap()
    }

    /// A lookup over the whole map.
    fn afar() -> TextureContext<'static> {
        let mut at = TextureContext::new(Vec3::ZERO, Vec2::splat(0.5));
        (at.footprint.duvdx, at.footprint.duvdy) = (Vec2::X, Vec2::Y);
        at
    }

    #[test]
    fn near_maps_are_exact_and_hide_nothing() {
        let (image, slopes) = ripples(Vec2::new(0.3, 0.1));
        for kind in [NormalFilter::Toksvig, NormalFilter::Lean] {
            let map = filtered(&image, kind);
            for (x, y) in [(0, 0), (17, 40), (63, 5)] {
                let uv = (Vec2::new(x as f32, y as f32) + 0.5) / SIZE as f32;
                let (n, hidden) = map.normal(&TextureContext::new(Vec3::ZERO, uv));
                let wanted = slopes[y * SIZE + x].extend(1.0).normalize();
                assert!((n.normalize() - wanted).length() < 1e-5 && hidden.max_element() < 1e-6, "{kind:?} {hidden}");
            }
        }
    }

    /// The variance of the slopes comes back exactly from LEAN, and nearly, in the mean of both axes, from lengths.
    #[test]
    fn hidden_slopes_are_those_of_the_map() {
        let (image, slopes) = ripples(Vec2::new(0.25, 0.1));
        let n = slopes.len() as f32;
        let mean = slopes.iter().sum::<Vec2>() / n;
        let variance = slopes.iter().map(|s| (*s - mean) * (*s - mean)).sum::<Vec2>() / n;
        let (m, hidden) = filtered(&image, NormalFilter::Lean).normal(&afar());
        assert!((hidden - variance).abs().max_element() < 1e-5 && (m.truncate() - mean).length() < 1e-5, "{hidden}");
        let (_, hidden) = filtered(&image, NormalFilter::Toksvig).normal(&afar());
        let both = 0.5 * (variance.x + variance.y);
        assert!(hidden.x == hidden.y && (hidden.x / both - 1.0).abs() < 0.15, "{hidden} {both}");
    }

    /// Facets on ripples, seen as one: the density of normals from afar is the mean of the densities over the map.
    #[test]
    fn lean_is_the_mean_over_the_facets_of_all_texels() {
        let (image, slopes) = ripples(Vec2::new(0.2, 0.05));
        let alpha = 0.15;
        let near = Microfacet::new(NormalDistribution::Beckmann, Shadowing::HeightCorrelated, alpha, alpha);
        let (_, hidden) = filtered(&image, NormalFilter::Lean).normal(&afar());
        let context = TextureContext { slopes: hidden, ..afar() };
        let (x, y) = context.roughened(alpha, alpha);
        let far = Microfacet::new(NormalDistribution::Beckmann, Shadowing::HeightCorrelated, x, y);
        for m in [Vec2::ZERO, Vec2::new(0.2, 0.0), Vec2::new(0.0, 0.2), Vec2::new(0.25, 0.1), Vec2::new(-0.4, 0.0)] {
            let m = m.extend(1.0).normalize();
            // In slope space the facets of a texel are those of a flat one, moved; cos⁴ is the change from slopes to
            // directions.
            let density = |facets: &Microfacet, m: Vec3, around: Vec2| {
                let s = (m.truncate() / m.z - around).extend(1.0).normalize();
                facets.d(s) * s.z.powi(4) / m.z.powi(4)
            };
            let mean = slopes.iter().map(|s| density(&near, m, *s)).sum::<f32>() / slopes.len() as f32;
            let seen = density(&far, m, Vec2::ZERO);
            assert!((seen / mean - 1.0).abs() < 0.12, "{m}: {seen} {mean}");
        }
    }
}
