//! Media that vary: coefficients at points, and bounds on them along rays.
//!
//! At most 16³ cells hold bounds on the extinction. A flight is tracked from cell to cell with these bounds
//! (`steradian-transport`, `tracking`).

use super::Cells;
use std::{fmt::Debug, sync::Arc};
use steradian_math::{
    Bounds3, Ray, Spectrum, Transform, Vec3,
    spectra::{
        ColorMode, Wavelengths, role,
        role::{Color, Role},
    },
    transform::Affine,
};
use steradian_texture::{Wrap, noise::gradient_noise};

/// Cells of bounds along each axis, at most.
pub(super) const CELLS: usize = 16;

/// Numbers at the centres of the cells of a box.
#[derive(Clone, Debug)]
pub struct Grid {
    size: [usize; 3],
    values: Vec<f32>,
    /// Values beyond the outermost numbers: [`Wrap::Border`] is zero (pbrt).
    pub wrap: Wrap,
    /// Selects the nearest number; else they are interpolated linearly.
    pub is_nearest: bool,
    /// From the unit cube of the medium into that of the grid, where it is another one.
    pub from_cube: Option<Affine>,
}

impl Grid {
    /// Grid of `x × y × z` numbers, x fastest, interpolated; `None` if the count differs.
    pub fn new(size: [usize; 3], values: Vec<f32>, wrap: Wrap) -> Option<Self> {
        let count = size.iter().try_fold(1_usize, |n, s| n.checked_mul(*s));
        let is_whole = count == Some(values.len()) && count != Some(0);
        is_whole.then_some(Self { size, values, wrap, is_nearest: false, from_cube: None })
    }

    fn at(&self, c: [i32; 3]) -> f32 {
        let inside = |axis: usize| self.wrap.apply(c[axis], self.size[axis]);
        let (Some(x), Some(y), Some(z)) = (inside(0), inside(1), inside(2)) else { return 0.0 };
        self.values[(z * self.size[1] + y) * self.size[0] + x]
    }

    /// The value at a point of the unit cube of the medium.
    pub fn lookup(&self, p: Vec3) -> f32 {
        let p = self.from_cube.as_ref().map_or(p, |t| t.point(p));
        // Nearest voxel, or trilinear interpolation between centres.
        if self.is_nearest {
            return self.at(std::array::from_fn(|axis| (p[axis] * self.size[axis] as f32).floor() as i32));
        }
        let scaled = [0, 1, 2].map(|axis| p[axis] * self.size[axis] as f32 - 0.5);
        let base = scaled.map(f32::floor);
        let part: [f32; 3] = std::array::from_fn(|axis| scaled[axis] - base[axis]);
        let base = base.map(|v| v as i32);
        let mut sum = 0.0;
        // Weight of a corner of the voxel cell: the product of its distances along the axes.
        for corner in 0..8 {
            let bit = |axis: usize| corner >> axis & 1_i32;
            let weight: f32 = (0..3).map(|a| if bit(a) == 1 { part[a] } else { 1.0 - part[a] }).product();
            if weight > 0.0 {
                sum += weight * self.at(std::array::from_fn(|axis| base[axis].saturating_add(bit(axis))));
            }
        }
        sum
    }

    /// The largest value in a part of the unit cube of the medium.
    fn most(&self, low: Vec3, high: Vec3) -> f32 {
        let part = Bounds3 { min: low, max: high };
        let part = self.from_cube.as_ref().map_or(part, |t| t.bounds(&part));
        let range: [[i32; 2]; 3] = std::array::from_fn(|a| {
            // Voxels whose interpolation reaches into the part.
            let index = |v: f32| (v * self.size[a] as f32 - 0.5).floor() as i32;
            let (first, last) = (index(part.min[a]), index(part.max[a]).saturating_add(1));
            let n = self.size[a] as i32;
            match self.wrap {
                // All that there is.
                Wrap::Repeat | Wrap::Mirror if first < 0 || last >= n => [0, n - 1],
                // Everything beyond the outermost numbers is like the first of it.
                _ => [first.clamp(-1, n), last.clamp(-1, n)],
            }
        });
        // Largest of all voxels in range, which bounds every interpolation between them.
        let [first, last] = [0, 1].map(|end| range.map(|r| r[end]));
        let mut most = 0.0_f32;
        for z in first[2]..=last[2] {
            for y in first[1]..=last[1] {
                for x in first[0]..=last[0] {
                    most = most.max(self.at([x, y, z]));
                }
            }
        }
        most
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.values[..])
    }
}

/// Clouds of gradient noise (Pharr, Jakob, Humphreys, PBR 4th ed., 11.4.5), denser towards the ground y = 0 of their
/// space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cloud {
    /// Factor on the noise.
    pub density: f32,
    /// Amount by which the noise is distorted by other noise.
    pub wispiness: f32,
    /// Cycles of the coarsest octave per unit.
    pub frequency: f32,
}

impl Cloud {
    /// The density at a point of its space, from zero to one.
    pub fn density(&self, p: Vec3) -> f32 {
        let noise = |p: Vec3| gradient_noise(p, 0);
        let mut at = p * self.frequency;
        if self.wispiness > 0.0 {
            // Domain warping by the gradient of finer noise.
            const STEP: f32 = 0.01;
            let (mut amplitude, mut frequency) = (0.05 * self.wispiness, 10.0);
            for _ in 0..2 {
                let q = at * frequency;
                let here = noise(q);
                let slope = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| (noise(q + axis * STEP) - here) / STEP);
                at += Vec3::from_array(slope) * amplitude;
                (amplitude, frequency) = (amplitude * 0.5, frequency * 1.99);
            }
        }
        // Fractional Brownian motion of five octaves.
        let (mut sum, mut amplitude, mut frequency) = (0.0, 0.5, 1.0);
        for _ in 0..5 {
            sum += amplitude * noise(at * frequency);
            (amplitude, frequency) = (amplitude * 0.5, frequency * 1.99);
        }
        // Density falls with height; below the middle it is raised.
        let sum = ((1.0 - p.y) * 4.5 * self.density * sum).clamp(0.0, 1.0);
        (sum + 2.0 * (0.5 - p.y).max(0.0)).clamp(0.0, 1.0)
    }
}

/// Spatial variation of a medium.
#[derive(Clone, Debug)]
pub enum Variation {
    /// Both coefficients by the density of a cloud.
    Cloud(Cloud),
    /// Both coefficients by one factor.
    Density(Grid),
    /// Both coefficients by a factor of a program's own, in the space of the medium.
    Own(Arc<dyn OwnMedium>),
    /// Extinction, and the part of it that is scattering in one or three channels of linear Rec.709: of media that
    /// scatter only where the variation is one.
    Albedo(Grid, Vec<Grid>),
    /// Absorption and scattering, each as three channels of linear Rec.709.
    Rgb(Box<[[Grid; 3]; 2]>),
}

/// A density of a program's own: a factor on both coefficients of a medium. What is negative or not finite counts as 0.
pub trait OwnMedium: Debug + Send + Sync {
    /// The box of the medium, in its space; outside there is none.
    fn bounds(&self) -> Bounds3;

    /// The density at a point of the box.
    fn density(&self, p: Vec3) -> f32;

    /// The greatest density in a part of the box, or more. Light passes too far where the density is above it, and
    /// renders take longer the more it is below it.
    fn most(&self, part: &Bounds3) -> f32;
}

/// A factor that is none counts as 0.
fn sound(density: f32) -> f32 {
    if density.is_finite() { density.max(0.0) } else { 0.0 }
}

/// Light that a medium gives off; times the absorption coefficient it is radiance per length.
#[derive(Clone, Debug)]
pub struct Glow {
    /// The light where the factor is one.
    pub source: GlowSource,
    /// The factor on it, from place to place.
    pub scale: Option<Grid>,
}

/// Source of the colour of a glow.
#[derive(Clone, Debug)]
pub enum GlowSource {
    /// One colour everywhere.
    Even(Color),
    /// A black body, by the temperature from place to place.
    Heat(Box<Heat>),
    /// Three channels of linear Rec.709.
    Rgb(Box<[Grid; 3]>, ColorMode),
}

/// Temperatures, K, and the colours of black bodies.
#[derive(Clone, Debug)]
pub struct Heat {
    temperatures: Grid,
    /// Subtracted from an interpolated temperature before it is multiplied by the scale (pbrt).
    offset: f32,
    scale: f32,
    /// Colours at even steps from [`Heat::COLDEST`] to the highest temperature.
    colors: Vec<Color>,
    step: f32,
}

impl Heat {
    /// Below this nothing glows, K (pbrt).
    const COLDEST: f32 = 100.0;
    const STEPS: usize = 256;

    /// Black-body emission of a grid of temperatures, less `offset`, times `scale`, where `color` gives the colour of a
    /// black body of any temperature.
    pub fn new(temperatures: Grid, (offset, scale): (f32, f32), color: impl Fn(f32) -> Color) -> Self {
        // Outside of the grid the temperature is zero.
        let kelvin = temperatures.values.iter().chain(&[0.0]).map(|t| (t - offset) * scale);
        let hottest = kelvin.fold(Self::COLDEST, f32::max);
        let step = (hottest - Self::COLDEST) / (Self::STEPS - 1) as f32;
        let colors = (0..Self::STEPS).map(|i| color(Self::COLDEST + step * i as f32)).collect();
        Self { temperatures, offset, scale, colors, step }
    }

    fn eval(&self, p: Vec3, lambda: &Wavelengths) -> Spectrum {
        let above = (self.temperatures.lookup(p) - self.offset) * self.scale - Self::COLDEST;
        if above <= 0.0 || self.step <= 0.0 {
            return Spectrum::ZERO;
        }
        // Interpolate the tabulated colours of black bodies over the temperature.
        let at = (above / self.step).min((Self::STEPS - 1) as f32);
        let first = (at as usize).min(Self::STEPS - 2);
        self.colors[first].eval(lambda).lerp(self.colors[first + 1].eval(lambda), at - first as f32)
    }
}

impl Glow {
    /// At a point of the unit cube.
    pub fn eval(&self, p: Vec3, lambda: &Wavelengths) -> Spectrum {
        let source = match &self.source {
            GlowSource::Even(color) => color.eval(lambda),
            GlowSource::Heat(heat) => heat.eval(p, lambda),
            GlowSource::Rgb(grids, mode) => {
                let rgb = Vec3::from_array([0, 1, 2].map(|c| grids[c].lookup(p).max(0.0)));
                role::texel(rgb, Role::Illuminant, lambda, *mode)
            }
        };
        source * self.scale.as_ref().map_or(1.0, |grid| grid.lookup(p).max(0.0))
    }
}

/// The map of a box to the unit cube; `None` where it has no volume.
pub fn into_cube(bounds: &Bounds3) -> Option<Affine> {
    let extent = bounds.max - bounds.min;
    let map = Transform::scale((Vec3::ONE / extent).as_dvec3()) * Transform::translate(-bounds.min.as_dvec3());
    map.affine()
}

/// A medium in a box, whose coefficients are functions of the place.
#[derive(Clone, Debug)]
pub struct Field {
    cells: Cells,
    variation: Variation,
    /// Bounds on the variation in the cells.
    most: Vec<f32>,
    /// The box, in the space of the medium.
    bounds: Bounds3,
    mode: ColorMode,
}

impl Field {
    /// Medium that fills a box placed by `world_from_medium`.
    pub fn new(bounds: &Bounds3, world_from_medium: &Affine, variation: Variation, mode: ColorMode) -> Option<Self> {
        // Compose the map from the world to the unit cube, and its inverse.
        let cube = into_cube(bounds)?;
        let into = world_from_medium.inverse();
        let cube_from_world = Affine { m: cube.m * into.m, inv: into.inv * cube.inv };
        let grids: Vec<&Grid> = match &variation {
            Variation::Cloud(_) | Variation::Own(_) => Vec::new(),
            Variation::Density(grid) | Variation::Albedo(grid, _) => vec![grid],
            Variation::Rgb(grids) => grids.iter().flatten().collect(),
        };
        // As many cells of bounds as the finest grid has voxels, up to a limit.
        let count: [usize; 3] = match &variation {
            Variation::Own(_) => [CELLS; 3],
            _ => std::array::from_fn(|a| grids.iter().map(|g| g.size[a]).max().unwrap_or(1).min(CELLS)),
        };
        let mut most = Vec::with_capacity(count.iter().product());
        let scale = Vec3::from_array(count.map(|c| 1.0 / c as f32));
        // Bound the variation in each cell, a little enlarged against rounding.
        for z in 0..count[2] {
            for y in 0..count[1] {
                for x in 0..count[0] {
                    let low = Vec3::new(x as f32, y as f32, z as f32) * scale;
                    // Rounding of the place of a point may lead into the next cell.
                    let (low, high) = (low - scale * 1e-3, low + scale * 1.001);
                    most.push(match &variation {
                        Variation::Cloud(_) => 1.0,
                        Variation::Own(own) => {
                            let [low, high] = [low, high].map(|p| bounds.min + p * (bounds.max - bounds.min));
                            sound(own.most(&Bounds3::new(low, high)))
                        }
                        Variation::Density(grid) | Variation::Albedo(grid, _) => grid.most(low, high),
                        Variation::Rgb(grids) => {
                            let largest = |c: &[Grid; 3]| c.iter().map(|g| g.most(low, high)).fold(0.0, f32::max);
                            largest(&grids[0]) + largest(&grids[1])
                        }
                    });
                }
            }
        }
        (cube_from_world.m.is_finite()).then_some(Self {
            cells: Cells { cube_from_world, count },
            variation,
            most,
            bounds: *bounds,
            mode,
        })
    }

    /// A point of the world in the unit cube.
    pub fn place(&self, p: Vec3) -> Vec3 {
        self.cells.cube_from_world.point(p)
    }

    /// Absorption and scattering at a point of the unit cube, for the coefficients that the medium has where the
    /// variation is one.
    pub fn coefficients(&self, (a, s): (Spectrum, Spectrum), p: Vec3, lambda: &Wavelengths) -> (Spectrum, Spectrum) {
        match &self.variation {
            Variation::Cloud(cloud) => {
                let density = cloud.density(self.bounds.min + p * (self.bounds.max - self.bounds.min));
                (a * density, s * density)
            }
            Variation::Own(own) => {
                let density = sound(own.density(self.bounds.min + p * (self.bounds.max - self.bounds.min)));
                (a * density, s * density)
            }
            Variation::Density(grid) => {
                let density = grid.lookup(p).max(0.0);
                (a * density, s * density)
            }
            Variation::Albedo(grid, albedo) => {
                // Extinction times albedo scatters; the rest is absorbed.
                let rgb = [0, 1, 2].map(|c: usize| albedo.get(c).or(albedo.first()).map_or(0.0, |g| g.lookup(p)));
                let albedo = role::texel(Vec3::from_array(rgb), Role::Albedo, lambda, self.mode);
                let extinction = s * grid.lookup(p).max(0.0);
                (extinction * (Spectrum::ONE - albedo), extinction * albedo)
            }
            Variation::Rgb(grids) => {
                // Absorption and scattering have colours of their own, bounded by nothing.
                let [absorbed, scattered] = [0, 1].map(|k| {
                    let rgb = Vec3::from_array([0, 1, 2].map(|c| grids[k][c].lookup(p).max(0.0)));
                    role::texel(rgb, Role::Unbounded, lambda, self.mode)
                });
                (a * absorbed, s * scattered)
            }
        }
    }

    /// Goes through the cells along a ray up to a distance: `visit` is given where each begins and ends, and the bound
    /// on the variation there, until it says `false`.
    pub fn walk(&self, ray: &Ray, distance: f32, mut visit: impl FnMut(f32, f32, f32) -> bool) {
        self.cells.walk(ray, distance, |begin, end, cell| visit(begin, end, self.most[cell]));
    }

    /// Box around the medium in the world.
    pub fn world_bounds(&self) -> Bounds3 {
        self.cube().inverse().bounds(&Bounds3 { min: Vec3::ZERO, max: Vec3::ONE })
    }

    /// The unit cube that stands for the box.
    pub fn cube(&self) -> &Affine {
        &self.cells.cube_from_world
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        let grids = match &self.variation {
            Variation::Cloud(_) | Variation::Own(_) => 0,
            Variation::Density(grid) => grid.bytes(),
            Variation::Albedo(grid, albedo) => grid.bytes() + albedo.iter().map(Grid::bytes).sum::<usize>(),
            Variation::Rgb(grids) => grids.iter().flatten().map(Grid::bytes).sum(),
        };
        grids + size_of_val(&self.most[..])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian_math::hash::HashRng;

    fn field(size: [usize; 3], wrap: Wrap, from_cube: Option<Affine>) -> Field {
        let mut rng = HashRng::new(5);
        let values = (0..size.iter().product()).map(|_| rng.next_f32()).collect();
        let grid = Grid { from_cube, ..Grid::new(size, values, wrap).unwrap() };
        let bounds = Bounds3 { min: Vec3::new(-1.0, 0.0, 2.0), max: Vec3::new(3.0, 1.0, 2.5) };
        let place = Transform::rotate(glam::DVec3::new(1.0, 2.0, 0.5), 0.8) * Transform::scale(glam::DVec3::splat(1.7));
        Field::new(&bounds, &place.affine().unwrap(), Variation::Density(grid), ColorMode::Rgb).unwrap()
    }

    /// Along any ray cells follow each other without a gap, cover the way through the box, and bound the density.
    #[test]
    fn cells_bound_what_is_in_them() {
        let mut rng = HashRng::new(8);
        let turned =
            Transform::rotate(glam::DVec3::new(1.0, 0.3, 0.5), 0.9) * Transform::scale(glam::DVec3::splat(2.5));
        for (size, wrap, is_turned) in [
            ([5, 7, 3], Wrap::Clamp, false),
            ([40, 1, 23], Wrap::Border, false),
            ([1, 1, 1], Wrap::Clamp, false),
            ([5, 7, 3], Wrap::Clamp, true),
            ([9, 4, 17], Wrap::Border, true),
            ([9, 4, 17], Wrap::Repeat, true),
            ([4, 2, 5], Wrap::Mirror, true),
        ] {
            let field = field(size, wrap, is_turned.then(|| turned.affine().unwrap()));
            let world_from_cube = field.cells.cube_from_world.inverse();
            let mut total = 0;
            for _ in 0..400 {
                let mut v = || Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32());
                let (a, b) = (world_from_cube.point(v() * 3.0 - 1.0), world_from_cube.point(v()));
                let ray = Ray::new(a, (b - a).normalize());
                let (mut last, mut length) = (None, 0.0);
                field.walk(&ray, f32::INFINITY, |from, to, most| {
                    assert!(last.is_none_or(|last| last == from) && to > from);
                    (last, length) = (Some(to), length + to - from);
                    for i in 0..8 {
                        let t = from + (to - from) * (i as f32 + 0.5) / 8.0;
                        let (density, _) = field.coefficients(
                            (Spectrum::ONE, Spectrum::ONE),
                            field.place(ray.at(t)),
                            &Wavelengths::RGB,
                        );
                        assert!(density[0] <= most * 1.0001 + 1e-6, "{} > {most}", density[0]);
                        total += 1;
                    }
                    true
                });
                // The ray goes through the point b, which is within: the way through the box is that of many samples.
                let inside = |t: &f32| {
                    let p = field.place(ray.at(*t));
                    p.min_element() >= 0.0 && p.max_element() <= 1.0
                };
                let far = (b - a).length() + 20.0;
                let steps: Vec<f32> = (0..4000).map(|i| far * (i as f32 + 0.5) / 4000.0).collect();
                let expected = steps.iter().filter(|t| inside(t)).count() as f32 * far / 4000.0;
                assert!((length - expected).abs() < 0.02, "{length} {expected}");
            }
            assert!(total > 3000);
        }
    }

    /// Numbers stand at the centres of cells; beyond the outermost they go on or fade to zero.
    #[test]
    fn grids_interpolate_between_centres() {
        let values = vec![1.0, 3.0];
        let [clamped, fading] =
            [Wrap::Clamp, Wrap::Border].map(|wrap| Grid::new([2, 1, 1], values.clone(), wrap).unwrap());
        let at = |grid: &Grid, x: f32| grid.lookup(Vec3::new(x, 0.5, 0.5));
        assert_eq!((at(&clamped, 0.25), at(&clamped, 0.5), at(&clamped, 0.75)), (1.0, 2.0, 3.0));
        assert_eq!((at(&clamped, 0.0), at(&fading, 0.0), at(&fading, 0.5)), (1.0, 0.5, 2.0));
        let nearest = Grid { is_nearest: true, ..clamped.clone() };
        assert_eq!([0.0, 0.49, 0.51, 1.0].map(|x| at(&nearest, x)), [1.0, 1.0, 3.0, 3.0]);
        assert!(Grid::new([2, 2, 1], values, Wrap::Clamp).is_none());
    }
}
