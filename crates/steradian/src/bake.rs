//! Baking of normal maps: the normals of a fine mesh, and its distance, as pictures over the texture coordinates of a
//! coarse one (Cignoni et al., "A General Method for Preserving Attribute Values on Simplified Meshes", 1998).
//!
//! From each sample of a texel that lies in a triangle of the coarse mesh, rays go both ways along the interpolated
//! normal. The nearest surface of the fine mesh that faces the same side gives its shading normal. Normals are kept in
//! the frame in which the renderer reads them ([`Base::tangent_frame`](steradian_core::material::detail::Base)), or in
//! the space of the coarse object.

use crate::{Error, LoadedScene, Scene};
use rayon::prelude::*;
use steradian_core::{
    material::NormalSpace,
    scene::{Hit, PrimId, Shape, WORLD},
};
use steradian_math::{Mat4, Ray, Vec2, Vec3};
use steradian_scene::Format;

/// Size, sampling and space of a map.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// Width and height in texels.
    pub size: [usize; 2],
    /// Samples along each side of a texel.
    pub samples: usize,
    /// Space of the normals.
    pub space: NormalSpace,
    /// Length of the rays each way, scene units; a twentieth of the coarse mesh's diagonal for `None`.
    pub distance: Option<f32>,
    /// Texels by which charts are extended beyond their edges.
    pub dilate: usize,
}

/// Pictures over the texture coordinates of the coarse mesh, rows from the top.
#[derive(Clone, Debug)]
pub struct Baked {
    /// Normals as numbers from 0 to 1; (½, ½, 1) where there is nothing.
    pub normals: Vec<[f32; 3]>,
    /// Distances of the fine surface along the coarse one's normal, scene units; 0 where there is nothing.
    pub heights: Vec<f32>,
    /// Texels that lie in triangles of the coarse mesh.
    pub covered: usize,
    /// Covered texels from which no ray met the fine mesh.
    pub missed: usize,
    /// Texels in which triangles lie over each other.
    pub overlapping: usize,
    /// Length of the rays each way, scene units.
    pub distance: f32,
}

/// A triangle of the coarse mesh over the picture.
struct Chart {
    id: PrimId,
    /// Corners in texels from the top left.
    corners: [Vec2; 3],
    /// From the space of its object to the world.
    world_from_object: Mat4,
}

/// Sums over the samples of a texel.
#[derive(Clone, Copy, Default)]
struct Texel {
    normal: Vec3,
    height: f32,
    hits: u32,
    samples: u32,
    overlaps: bool,
}

/// Bakes the normals of a fine scene over a coarse one.
///
/// # Errors
/// [`Error::CannotBake`] where the coarse scene has no triangles with texture coordinates in the unit square, or no ray
/// meets the fine one.
pub fn normals(fine: &Scene, coarse: &LoadedScene, settings: &Settings) -> Result<Baked, Error> {
    let refused = |why: &str| Error::CannotBake(why.into());
    let scene = coarse.scene.as_ref().ok_or_else(|| refused("the coarse scene has errors"))?;
    let charts = charts(scene, coarse, settings.size)?;
    let bounds = scene.bounds();
    let distance = settings.distance.unwrap_or(0.05 * (bounds.max - bounds.min).length());
    let [width, height] = settings.size;
    let mut rows: Vec<Vec<u32>> = vec![Vec::new(); height];
    for (k, chart) in charts.iter().enumerate() {
        let ys = chart.corners.map(|c| c.y);
        let (top, bottom) = (ys[0].min(ys[1]).min(ys[2]), ys[0].max(ys[1]).max(ys[2]));
        for row in &mut rows[(top.max(0.0) as usize).min(height)..(bottom.ceil().max(0.0) as usize).min(height)] {
            row.push(k as u32);
        }
    }
    let row = |(y, here): (usize, &Vec<u32>)| {
        let here: Vec<&Chart> = here.iter().map(|k| &charts[*k as usize]).collect();
        Rays { fine, coarse: scene, settings, distance }.row(y, &here)
    };
    let texels: Vec<Texel> = rows.par_iter().enumerate().flat_map_iter(row).collect();
    let count = |is: fn(&Texel) -> bool| texels.iter().filter(|t| is(t)).count();
    let (covered, missed) = (count(|t| t.samples > 0), count(|t| t.samples > 0 && t.hits == 0));
    if covered == 0 {
        return Err(refused("no texel's sample lies in a triangle of the coarse mesh: give a larger --size"));
    }
    if covered == missed {
        let why = "no ray met the fine mesh within";
        return Err(Error::CannotBake(format!("{why} {distance} of the coarse one: --distance reaches farther")));
    }
    let values =
        texels.iter().map(|t| (t.hits > 0).then(|| (t.normal.normalize_or(Vec3::Z), t.height / t.hits as f32)));
    let values = dilated(values.collect(), width, settings.dilate);
    let of = |v: &Option<(Vec3, f32)>| v.map_or([0.5, 0.5, 1.0], |(n, _)| ((n + 1.0) * 0.5).to_array());
    Ok(Baked {
        normals: values.iter().map(of).collect(),
        heights: values.iter().map(|v| v.map_or(0.0, |v| v.1)).collect(),
        covered,
        missed,
        overlapping: count(|t| t.overlaps),
        distance,
    })
}

/// The triangles of the coarse scene, over the picture.
fn charts(scene: &Scene, loaded: &LoadedScene, [width, height]: [usize; 2]) -> Result<Vec<Chart>, Error> {
    let from_top = loaded.desc.format == Format::Gltf;
    let mut charts = Vec::new();
    for (geom, geometry) in (0..scene.world_count()).zip(scene.geometries()) {
        let Shape::Mesh(mesh) = &geometry.shape else { continue };
        let shape = loaded.desc.shapes.iter().find(|s| s.node.0 + 1 == geometry.id);
        let name = shape.and_then(|s| loaded.desc.node(s.node).name.as_deref()).unwrap_or("mesh");
        if mesh.uvs.is_empty() {
            return Err(Error::CannotBake(format!("the coarse shape '{name}' has no texture coordinates")));
        }
        if mesh.uvs.iter().any(|uv| uv.min_element() < -1e-3 || uv.max_element() > 1.001) {
            let why = "has texture coordinates outside of the unit square";
            return Err(Error::CannotBake(format!("the coarse shape '{name}' {why}")));
        }
        let world_from_object = shape.map_or(Mat4::IDENTITY, |s| s.world_from_object.matrix.as_mat4());
        let texel = |uv: Vec2| Vec2::new(uv.x, if from_top { uv.y } else { 1.0 - uv.y });
        for (prim, triangle) in (0..).zip(mesh.triangles.iter()) {
            let scale = Vec2::new(width as f32, height as f32);
            let corners = triangle.map(|i| texel(mesh.uvs[i as usize]) * scale);
            charts.push(Chart { id: PrimId { instance: WORLD, geom, prim }, corners, world_from_object });
        }
    }
    if charts.is_empty() {
        return Err(Error::CannotBake("the coarse scene has no triangles of its own (instances do not count)".into()));
    }
    Ok(charts)
}

/// All that rays need.
#[derive(Clone, Copy)]
struct Rays<'a> {
    fine: &'a Scene,
    coarse: &'a Scene,
    settings: &'a Settings,
    distance: f32,
}

impl Rays<'_> {
    /// A row of texels.
    fn row(&self, y: usize, charts: &[&Chart]) -> Vec<Texel> {
        let (width, n) = (self.settings.size[0], self.settings.samples);
        let mut texels = vec![Texel::default(); width];
        let mut taken = vec![false; width * n];
        for sub in 0..n {
            taken.fill(false);
            let v = y as f32 + (sub as f32 + 0.5) / n as f32;
            for chart in charts {
                let [a, b, c] = chart.corners;
                let area = (b - a).perp_dot(c - a);
                if area == 0.0 || !area.is_finite() {
                    continue;
                }
                let (left, right) = (a.x.min(b.x).min(c.x), a.x.max(b.x).max(c.x));
                let first = (left.max(0.0) * n as f32) as usize;
                for x in first..((right.max(0.0) * n as f32).ceil() as usize).min(width * n) {
                    let p = Vec2::new((x as f32 + 0.5) / n as f32, v);
                    let (s, t) = ((p - a).perp_dot(c - a) / area, (b - a).perp_dot(p - a) / area);
                    let inside = s.min(t).min(1.0 - s - t);
                    if inside < -1e-6 {
                        continue;
                    }
                    let texel = &mut texels[x / n];
                    // Samples on edges belong to either triangle.
                    if taken[x] {
                        texel.overlaps |= inside > 1e-3;
                        continue;
                    }
                    taken[x] = true;
                    texel.samples += 1;
                    if let Some((normal, height)) = self.sample(chart, s, t) {
                        texel.normal += normal;
                        texel.height += height;
                        texel.hits += 1;
                    }
                }
            }
        }
        texels
    }

    /// The normal of the fine surface and its height at a point of the coarse one.
    fn sample(&self, chart: &Chart, u: f32, v: f32) -> Option<(Vec3, f32)> {
        let i = self.coarse.interaction(&Ray::new(Vec3::ZERO, Vec3::Z), &Hit { t: 0.0, u, v, id: chart.id });
        let base = self.coarse.base(&i);
        let p = self.fine.from_file(self.coarse.to_file(i.surface.p));
        let ways = [base.ns, -base.ns].map(|way| self.facing(p, way, base.ns));
        let (n, height) = ways.into_iter().flatten().min_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
        let n = match self.settings.space {
            NormalSpace::Object => (chart.world_from_object.transpose().transform_vector3(n)).normalize_or(Vec3::Z),
            NormalSpace::Tangent => {
                let (frame, mirrored) = base.tangent_frame(true);
                let m = frame.to_local(n);
                if mirrored { Vec3::new(m.x, -m.y, m.z) } else { m }
            }
        };
        Some((n, height))
    }

    /// The nearest fine surface one way that faces the side of `up`: its normal, and its height along `up`.
    fn facing(&self, p: Vec3, way: Vec3, up: Vec3) -> Option<(Vec3, f32)> {
        /// Surfaces that face the other side are passed, so many at most.
        const MOST_PASSED: usize = 16;
        // A surface through the point itself lies on one side of it or the other by rounding.
        let step = 1e-4 * self.distance;
        let mut ray = Ray { t_max: self.distance + step, ..Ray::new(p - way * step, way) };
        for _ in 0..MOST_PASSED {
            let hit = self.fine.intersect(&ray)?;
            let i = self.fine.interaction(&ray, &hit);
            if i.surface.n.dot(up) > 0.0 {
                return Some((i.surface.ns, (i.surface.p - p).dot(up)));
            }
            ray = Ray { t_max: ray.t_max - hit.t - step, ..Ray::new(i.surface.p + way * step, way) };
        }
        None
    }
}

/// Values that go on beyond their edges: texels without one take the mean of their neighbours, ring by ring.
fn dilated(mut values: Vec<Option<(Vec3, f32)>>, width: usize, rings: usize) -> Vec<Option<(Vec3, f32)>> {
    let height = values.len() / width;
    for _ in 0..rings {
        let mean = |k: usize| {
            let (x, y) = (k % width, k / width);
            let (mut n, mut h, mut count) = (Vec3::ZERO, 0.0, 0.0);
            for j in y.saturating_sub(1)..(y + 2).min(height) {
                for i in x.saturating_sub(1)..(x + 2).min(width) {
                    if let Some((normal, height)) = values[j * width + i] {
                        (n, h, count) = (n + normal, h + height, count + 1.0);
                    }
                }
            }
            (count > 0.0).then(|| (n.normalize_or(Vec3::Z), h / count))
        };
        values = (0..values.len()).into_par_iter().map(|k| values[k].or_else(|| mean(k))).collect();
    }
    values
}
