//! Light samples of emissive media: directions to points drawn by how much the cells of a box give off, and
//! the density of a direction along its whole way through them (Villemin, Hery 2013, "Practical Illumination from
//! Flames").

use super::{Cells, Medium, field::CELLS};
use steradian_math::{Ray, Vec3, hash::HashRng, spectra::ColorMode, transform::Affine};

/// Points at which a cell is looked at.
const POINTS: usize = 16;

/// An emissive medium as a light that can be sampled.
#[derive(Clone, Debug)]
pub struct EmissiveVolume {
    /// Index of the medium.
    pub medium: u32,
    /// The probability with which it is chosen among those of a scene.
    pub probability: f32,
    cells: Cells,
    world_from_cube: Affine,
    /// For each cell the probability of it and all before it.
    until: Vec<f32>,
    /// For each cell the density of points, per volume of the world.
    density: Vec<f32>,
}

impl EmissiveVolume {
    /// Emissive volume of a medium, given by its index, in a box that `cube_from_world` maps to the unit cube, and its
    /// emission: luminance times volume, in proportion to which a volume is chosen. `None` if there is no emission, or
    /// the box has no volume.
    pub fn new(index: u32, medium: &Medium, cube_from_world: &Affine, mode: ColorMode) -> Option<(Self, f32)> {
        let world_from_cube = cube_from_world.inverse();
        let axes = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| world_from_cube.vector(axis));
        let volume = axes[0].cross(axes[1]).dot(axes[2]).abs();
        // What is the same everywhere needs no cells.
        let count = if medium.field.is_some() { [CELLS; 3] } else { [1; 3] };
        let size = 1.0 / Vec3::from_array(count.map(|c| c as f32));
        let mut rng = HashRng::new(1);
        // Mean emission of a cell from jittered points.
        let mut mean = |cell: usize| {
            let corner = [cell % count[0], cell / count[0] % count[1], cell / (count[0] * count[1])];
            let sum = (0..POINTS).map(|k| {
                let within = Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32());
                let p = (Vec3::from_array(corner.map(|c| c as f32)) + within) * size;
                let lambda = mode.wavelengths(|| (k as f32 + 0.5) / POINTS as f32);
                mode.luminance(medium.glow_at(p, &lambda), &lambda).max(0.0)
            });
            sum.sum::<f32>() / POINTS as f32
        };
        let cells = count.iter().product::<usize>();
        let brightness: Vec<f32> = (0..cells).map(&mut mean).collect();
        let total = brightness.iter().sum::<f32>();
        let power = total * volume / cells as f32;
        if !(power > 0.0 && power.is_finite() && volume.is_normal()) {
            return None;
        }
        // Density of points: the cell's share over its volume.
        let density = brightness.iter().map(|b| b / total * cells as f32 / volume).collect();
        let mut sum = 0.0;
        let until = brightness.iter().map(|b| {
            sum += b / total;
            sum
        });
        let cells = Cells { cube_from_world: *cube_from_world, count };
        let volume = Self { medium: index, probability: 1.0, until: until.collect(), density, world_from_cube, cells };
        Some((volume, power))
    }

    /// True if next-event estimation leaves this volume out at `p`: the medium glows there, so that scattering finds
    /// the light wherever it leads.
    #[inline]
    pub fn surrounds(&self, p: Vec3) -> bool {
        self.cells.cell(p).is_some_and(|cell| self.density[cell] > 0.0)
    }

    /// A direction from a point: by a number for the cell and three for the place within it.
    pub fn sample(&self, p: Vec3, u: f32, within: Vec3) -> Option<Vec3> {
        // Choose a cell by inversion of the cumulative distribution, then a uniform place within.
        let cell = self.until.partition_point(|sum| *sum <= u).min(self.until.len() - 1);
        let [nx, ny, _] = self.cells.count;
        let corner = Vec3::new((cell % nx) as f32, (cell / nx % ny) as f32, (cell / (nx * ny)) as f32);
        let place = (corner + within) / Vec3::from_array(self.cells.count.map(|c| c as f32));
        (self.world_from_cube.point(place) - p).try_normalize()
    }

    /// The density per solid angle with which [`EmissiveVolume::sample`] gives a unit direction: `∫ p(x) r² dr` along
    /// it.
    pub fn pdf(&self, p: Vec3, w: Vec3) -> f32 {
        // p(ω) = ∫ p(x) r² dr, exact for constant density in each cell: (b³ − a³)/3.
        let mut sum = 0.0;
        self.cells.walk(&Ray::new(p, w), f32::INFINITY, |begin, end, cell| {
            // b³ − a³, without what cancels.
            sum += self.density[cell] * (end - begin) * (end * end + end * begin + begin * begin) / 3.0;
            true
        });
        sum
    }
}
