//! Form factors between patches: which part of the light that leaves one arrives at another, with what stands between.

use super::{
    cells::Cells,
    direct::spawn,
    form_factor,
    patches::{NONE, Patch, Patches},
    surfaces::Surfaces,
};
use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, Ordering};
use steradian_core::{Scene, scene::Hit};
use steradian_math::{Frame, Ray, Vec2, Vec3, ray::offset_ray_origin, warp};

/// Computation of form factors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FormFactors {
    /// The closed form for polygons, times the part of their points that see each other, weighted by the kernel.
    Analytic,
    /// Rays with density cosθ/π from points of the patch; so many.
    MonteCarlo(u32),
    /// View from the middle of the patch through the pixels of half a cube (Cohen, Greenberg 1985); number of pixels
    /// along an edge.
    Hemicube(u32),
}

/// A row of the matrix: the patches that receive, and the part that they receive.
pub type Row = Vec<(u32, f64)>;

/// Inputs of the rows of form factors.
#[derive(Clone, Copy)]
pub struct Exchange<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// Its pieces.
    pub surfaces: &'a Surfaces,
    /// The quadtrees.
    pub cells: &'a Cells,
    /// The patches.
    pub patches: &'a Patches,
    /// The method.
    pub method: FormFactors,
    /// Chooses the rays.
    pub seed: u32,
    /// Rays traced so far.
    pub rays: &'a AtomicU64,
    /// Told of parts that are done; whether to go on. What is found after it says no counts for nothing.
    pub tell: &'a (dyn Fn(usize) -> bool + Sync),
}

/// Pairs of points that are looked at first; where these disagree, all are.
const FIRST_PAIRS: usize = 4;
/// Pairs of points that are looked at at most.
pub const PAIRS: usize = 16;
/// Rays through pixels of a half cube that are traced together, about.
const RAYS_AT_ONCE: u32 = 1 << 14;
/// Pairs of patches after which it is asked whether to go on: a few thousand rays.
const PAIRS_AT_ONCE: usize = 256;
/// Interfaces that a ray passes at most.
const PASSES: u32 = 16;

impl Exchange<'_> {
    /// The row of a patch.
    pub fn row(&self, i: usize) -> Row {
        match self.method {
            FormFactors::Analytic => {
                self.pairs(i, 0..self.patches.len()).map(|(j, a)| (j, a / self.patches.list[i].area)).collect()
            }
            FormFactors::MonteCarlo(rays) => self.row_by_rays(i, rays),
            FormFactors::Hemicube(edge) => self.row_by_hemicube(i, edge),
        }
    }

    /// All rows. `A_i F_ij = A_j F_ji` holds exactly for the closed form.
    pub fn rows(&self) -> Option<Vec<Row>> {
        let n = self.patches.len();
        if self.method != FormFactors::Analytic {
            return self.rows_by(n, &|i| self.row(i));
        }
        // Closed form: each pair once, above the diagonal; A_i F_ij serves both directions.
        let upper = self.rows_by(n, &|i| self.pairs(i, i + 1..n).collect())?;
        let area = |i: usize| self.patches.list[i].area;
        let mut rows: Vec<Row> = vec![Row::new(); n];
        for (i, row) in upper.iter().enumerate() {
            for &(j, a) in row {
                rows[i].push((j, a / area(i)));
                rows[j as usize].push((i as u32, a / area(j as usize)));
            }
        }
        // Rows in order of patches, and none above one.
        rows.par_iter_mut().for_each(|row| {
            row.sort_unstable_by_key(|e| e.0);
            hold_to_one(row);
        });
        Some(rows)
    }

    /// Makes `count` rows, each reported when it is made; `None` where told to stop.
    pub fn rows_by(&self, count: usize, make: &(dyn Fn(usize) -> Row + Sync)) -> Option<Vec<Row>> {
        let made = |i: usize| {
            let row = (self.tell)(0).then(|| make(i))?;
            (self.tell)(1).then_some(row)
        };
        (0..count).into_par_iter().map(made).collect()
    }

    /// `A_i F_ij` of a patch and some others, by the closed form. Ends early where told to stop.
    fn pairs(&self, i: usize, others: std::ops::Range<usize>) -> impl Iterator<Item = (u32, f64)> {
        let goes_on = |j: &usize| !j.is_multiple_of(PAIRS_AT_ONCE) || (self.tell)(0);
        others.take_while(goes_on).filter_map(move |j| self.pair(i, j).map(|a| (j as u32, a)))
    }

    /// `A_i F_ij` by the closed form, with visibility; `None` where nothing is exchanged.
    fn pair(&self, i: usize, j: usize) -> Option<f64> {
        if i == j {
            return None;
        }
        // The same for both orders, so that what is exchanged is.
        let (a, b) = (&self.patches.list[i.min(j)], &self.patches.list[i.max(j)]);
        // Unoccluded exchange first, which is cheap to find zero; visibility only where something is exchanged.
        let exchange = form_factor::exchange(&a.polygon, &b.polygon);
        if exchange <= 0.0 {
            return None;
        }
        let seen = self.visibility(a, b);
        (seen > 0.0).then_some(exchange * seen)
    }

    /// The part of what two patches exchange that nothing stops.
    pub fn visibility(&self, a: &Patch, b: &Patch) -> f64 {
        // A few pairs of points decide in most cases: all see each other, or none.
        let (seen, all) = self.seen(a, b, 0..FIRST_PAIRS);
        if all <= 0.0 || seen == 0.0 || seen >= all {
            let (more, rest) = if all <= 0.0 { self.seen(a, b, FIRST_PAIRS..PAIRS) } else { (0.0, 0.0) };
            let (seen, all) = (seen + more, all + rest);
            // Polygons that stand for curved surfaces may lie before each other where the surfaces do not.
            return if all > 0.0 { seen / all } else { 0.0 };
        }
        // Partly seen: all pairs.
        let (more, rest) = self.seen(a, b, FIRST_PAIRS..PAIRS);
        (seen + more) / (all + rest)
    }

    /// Visibility of two patches by all pairs of points; `None` where none of these lie before each other.
    pub fn visibility_of_all(&self, a: &Patch, b: &Patch) -> Option<f64> {
        let (seen, all) = self.seen(a, b, 0..PAIRS);
        (all > 0.0).then(|| seen / all)
    }

    /// The kernel summed over pairs of points: over those that see each other, and over all.
    fn seen(&self, a: &Patch, b: &Patch, pairs: std::ops::Range<usize>) -> (f64, f64) {
        let (mut seen, mut all) = (0.0, 0.0);
        for k in pairs {
            let p = &a.points[k % a.points.len()];
            // Not the same order in both, so that places are paired with many others.
            let q = &b.points[(k * 7 + 3) % b.points.len()];
            let to = q.p - p.p;
            let d2 = to.length_squared();
            // cosθ cosθ' / r², up to the common factor: pairs count by what they exchange.
            let kernel = p.n.dot(to).max(0.0) * (-q.n.dot(to)).max(0.0) / (d2 * d2);
            if !(kernel > 0.0 && kernel.is_finite()) {
                continue;
            }
            all += f64::from(kernel);
            // Shadow ray between the points, both moved off their surfaces.
            let origin = offset_ray_origin(p.p, p.error, p.n, to);
            let end = offset_ray_origin(q.p, q.error, q.n, -to);
            let codec = end - origin;
            let length = codec.length();
            self.rays.fetch_add(1, Ordering::Relaxed);
            let ray = Ray { t_max: length * (1.0 - 1e-4), ..Ray::new(origin, codec / length) };
            if !self.scene.occluded(&ray) {
                seen += f64::from(kernel);
            }
        }
        (seen, all)
    }

    /// The patch that a ray meets first, or [`NONE`].
    pub fn first_met(&self, ray: &Ray, hit: Option<Hit>) -> u32 {
        let (mut ray, mut hit) = (*ray, hit);
        // Interfaces are passed.
        for _ in 0..PASSES {
            let Some(h) = hit else { return NONE };
            let i = self.scene.interaction(&ray, &h);
            if self.scene.geometries()[i.geometry as usize].is_interface {
                ray = i.spawn(ray.direction);
                hit = self.scene.intersect(&ray);
                continue;
            }
            let Some((piece, uv)) = self.surfaces.locate(&i) else { return NONE };
            return self.patches.of(self.cells.find(piece, uv), i.surface.n.dot(i.wo) > 0.0);
        }
        NONE
    }

    /// The patches that rays meet.
    pub(super) fn met(&self, rays: &[Ray]) -> Vec<u32> {
        // Rays in one batch, then each hit to its patch.
        let mut hits = vec![None; rays.len()];
        self.scene.intersect_batch(rays, &mut hits);
        self.rays.fetch_add(rays.len() as u64, Ordering::Relaxed);
        rays.iter().zip(hits).map(|(ray, hit)| self.first_met(ray, hit)).collect()
    }

    fn row_by_rays(&self, i: usize, count: u32) -> Row {
        let patch = &self.patches.list[i];
        // F_ij by cosine-distributed rays: the share that meets patch j.
        let rays: Vec<Ray> = (0..count).map(|k| self.ray_from(patch, k, self.seed)).collect();
        let share = 1.0 / f64::from(count);
        collected(self.met(&rays).into_iter().map(|j| (j, share)))
    }

    /// A ray from a patch, of a sequence of points and directions.
    pub fn ray_from(&self, patch: &Patch, k: u32, seed: u32) -> Ray {
        let seed = steradian_math::hash::combine32(seed, patch.cell * 2 + u32::from(patch.front));
        self.ray_at(patch, steradian_math::sobol::shuffled_scrambled_sobol_4d(k, seed))
    }

    /// The ray from a patch whose point and direction belong to uniform random numbers.
    pub fn ray_at(&self, patch: &Patch, [a, b, c, d]: [f32; 4]) -> Ray {
        // Two numbers for the point, two for the direction about the normal of the side.
        let cell = &self.cells.cells[patch.cell as usize];
        let piece = &self.surfaces.pieces[cell.piece as usize];
        let seen = piece.seen(self.scene, cell.at(Vec2::new(a, b)), patch.front);
        let w = Frame::from_z(seen.wo).to_world(warp::cosine_hemisphere(Vec2::new(c, d)));
        seen.spawn(w)
    }

    fn row_by_hemicube(&self, i: usize, edge: u32) -> Row {
        let patch = &self.patches.list[i];
        let cell = &self.cells.cells[patch.cell as usize];
        let piece = &self.surfaces.pieces[cell.piece as usize];
        let seen = piece.seen(self.scene, cell.at(Vec2::splat(0.5)), patch.front);
        let point = super::patches::Point { p: seen.surface.p, error: seen.surface.error, n: seen.wo };
        let frame = Frame::from_z(point.n);
        // Pixels of the hemicube with their delta form factors, normalised to a sum of one.
        let edge = (edge.max(2) / 2) * 2;
        let sum: f64 = (0..edge).flat_map(|j| hemicube_pixels(edge, j)).map(|pixel| pixel.1).sum();
        let mut row = Row::new();
        // By some lines at a time, so that memory is for few of the rays.
        let lines: Vec<u32> = (0..edge).collect();
        for lines in lines.chunks((RAYS_AT_ONCE / (3 * edge)).max(1) as usize).take_while(|_| (self.tell)(0)) {
            let pixels = lines.iter().flat_map(|j| hemicube_pixels(edge, *j));
            let (rays, shares): (Vec<Ray>, Vec<f64>) =
                pixels.map(|(w, share)| (spawn(&point, frame.to_world(w)), share / sum)).unzip();
            row = collected(row.into_iter().chain(self.met(&rays).into_iter().zip(shares)));
        }
        row
    }
}

/// Directions through the pixels of a line of a half cube, of the top and of the sides in so far as they stand above
/// the plane, and their form factors but for the factor by which all of them add up to one.
fn hemicube_pixels(edge: u32, j: u32) -> impl Iterator<Item = (Vec3, f64)> {
    let at = move |k: u32| (f64::from(k) + 0.5) / f64::from(edge) * 2.0 - 1.0;
    (0..edge).flat_map(move |i| {
        let (x, y) = (at(i), at(j));
        let r2 = x * x + y * y + 1.0;
        let direction = move |v: [f64; 3]| (glam::DVec3::from(v) / r2.sqrt()).as_vec3();
        // π cosθ cosθ' / r².
        let top = ([x, y, 1.0], 1.0 / (r2 * r2));
        let sides = [[1.0, x, y], [-1.0, x, y], [x, 1.0, y], [x, -1.0, y]].map(|w| (w, y / (r2 * r2)));
        let sides = sides.into_iter().filter(move |_| y > 0.0);
        std::iter::once(top).chain(sides).map(move |(w, share)| (direction(w), share))
    })
}

/// No patch sends more than it has, whatever flat polygons that stand for curved surfaces come to.
fn hold_to_one(row: &mut Row) {
    let sum: f64 = row.iter().map(|e| e.1).sum();
    if sum > 1.0 {
        row.iter_mut().for_each(|e| e.1 /= sum);
    }
}

/// A row from single contributions.
pub(super) fn collected(shares: impl Iterator<Item = (u32, f64)>) -> Row {
    // Contributions of the same patch are added up.
    let mut all: Row = shares.filter(|s| s.0 != NONE).collect();
    all.sort_by_key(|s| s.0);
    all.dedup_by(|from, into| {
        let same = from.0 == into.0;
        if same {
            into.1 += from.1;
        }
        same
    });
    all
}
