//! The whole way from a mesh to its atlas.

use crate::{
    chart::Cutter,
    cluster::{self, Clusters},
    connect::{self, Connections, NONE},
    flatten::{Flat, flatten},
    measure::{Metrics, Sums},
    mesh::{Error, Mesh, Options},
    pack::{self, Place},
    proof::{self, Point},
};
use steradian_math::{DVec2, DVec3};

/// Number of the chart of triangles that are in none.
pub const NO_CHART: u32 = u32::MAX;

/// Steps of the coordinates in the atlas: single precision holds all multiples of their inverse up to one.
const STEPS: f64 = (1 << 23) as f64;

/// Share of the atlas that charts are expected to take, before it is known.
const EXPECTED: f64 = 0.6;

/// Rounds in which charts that rounding broke are taken apart into two; then they are taken apart into triangles.
const ROUNDS: u32 = 8;

/// A mesh over a texture atlas. Vertices are split where charts meet.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Atlas {
    /// For each vertex the vertex of the mesh that it comes from.
    pub sources: Vec<u32>,
    /// Texture coordinates of each vertex: within the unit square, (0, 0) at its lower left.
    pub uvs: Vec<[f32; 2]>,
    /// Vertices of each triangle of the mesh.
    pub triangles: Vec<[u32; 3]>,
    /// Chart of each triangle; [`NO_CHART`] for those without area, whose corners are all at (0, 0).
    pub charts: Vec<u32>,
    /// Measures of the whole.
    pub metrics: Metrics,
}

/// Makes the atlas of a mesh.
///
/// # Errors
/// Faults of the mesh and the options, and more charts than fit.
pub fn unwrap(mesh: &Mesh<'_>, options: &Options) -> Result<Atlas, Error> {
    mesh.check(options)?;
    let connections = connect::connect(mesh, options.seam_angle);
    let total: f64 = connections.area.iter().sum();
    if total <= 0.0 {
        return Err(Error::Empty);
    }
    let clusters = cluster::cluster(mesh, &connections, options.cone);
    let mut layout = Layout {
        cutter: Cutter::new(mesh, &connections),
        clusters: &clusters,
        total,
        unit: (total / EXPECTED).sqrt() / STEPS,
        nodes: Vec::new(),
        flats: Vec::new(),
    };
    clusters.roots.iter().for_each(|root| layout.add(*root));
    let mut round = 0;
    loop {
        let (flats, &Options { resolution, padding, .. }) = (&layout.flats, options);
        let does_not_fit = || Error::DoesNotFit { charts: flats.len(), padding, resolution };
        let (scale, places) = pack::pack(flats, resolution, padding).ok_or_else(does_not_fit)?;
        let points: Vec<Vec<Point>> =
            flats.iter().zip(&places).map(|(flat, place)| placed(flat, place, scale, resolution)).collect();
        if layout.mend(&points, round >= ROUNDS) {
            return Ok(layout.atlas(mesh, &connections, &points, scale));
        }
        round += 1;
    }
}

/// The vertices of a chart in steps of the atlas.
fn placed(flat: &Flat, place: &Place, scale: f64, resolution: u32) -> Vec<Point> {
    let steps = |texel: f64| (texel / f64::from(resolution) * STEPS).round().clamp(0.0, STEPS) as i64;
    let mut points: Vec<Point> =
        flat.uvs.iter().map(|p| place.texel(*p, flat.size, scale).to_array().map(steps)).collect();
    // A triangle that is too thin for the steps has no area then, rather than one of the wrong sign.
    if let [a, b, c] = points[..]
        && proof::twice_area(a, b, c) < 0
    {
        points[2] = points[1];
    }
    points
}

/// Charts in the plane.
struct Layout<'a> {
    cutter: Cutter<'a>,
    clusters: &'a Clusters,
    /// Area of all triangles.
    total: f64,
    /// Step of the coordinates in the units of the mesh, about.
    unit: f64,
    /// Node of each chart.
    nodes: Vec<u32>,
    flats: Vec<Flat>,
}

impl Layout<'_> {
    /// Adds the chart of a node, or charts of parts of it.
    fn add(&mut self, node: u32) {
        let mut work = vec![node];
        while let Some(node) = work.pop() {
            let chart = self.cutter.cut(node, self.clusters.triangles(node));
            match flatten(chart, self.total, self.unit) {
                Some(flat) => {
                    self.nodes.push(node);
                    self.flats.push(flat);
                }
                None => work.extend(self.clusters.parts(node).into_iter().flatten().rev()),
            }
        }
    }

    /// Takes apart what is not one-to-one in the atlas; true if nothing was.
    fn mend(&mut self, points: &[Vec<Point>], to_triangles: bool) -> bool {
        let is_good = |flat: &Flat, points: &Vec<Point>| {
            flat.chart.triangles.len() == 1 || proof::is_injective(points, &flat.chart.corners, &flat.chart.border)
        };
        let good: Vec<bool> = self.flats.iter().zip(points).map(|(flat, points)| is_good(flat, points)).collect();
        let (nodes, flats) = (std::mem::take(&mut self.nodes), std::mem::take(&mut self.flats));
        for ((node, flat), is_good) in nodes.into_iter().zip(flats).zip(&good) {
            if *is_good {
                self.nodes.push(node);
                self.flats.push(flat);
            } else if to_triangles {
                flat.chart.triangles.iter().for_each(|t| self.add(*t));
            } else {
                self.clusters.parts(node).into_iter().flatten().for_each(|part| self.add(part));
            }
        }
        good.iter().all(|is_good| *is_good)
    }

    /// The mesh over the atlas, with its measures.
    fn atlas(&self, mesh: &Mesh<'_>, connections: &Connections, points: &[Vec<Point>], scale: f64) -> Atlas {
        let count = mesh.triangles.len();
        let mut atlas = Atlas { triangles: vec![[0; 3]; count], charts: vec![NO_CHART; count], ..Atlas::default() };
        for (number, (flat, points)) in self.flats.iter().zip(points).enumerate() {
            let chart = &flat.chart;
            chart.triangles.iter().for_each(|t| atlas.charts[*t as usize] = number as u32);
            atlas.append(mesh, chart.triangles.iter().zip(&chart.corners), points);
        }
        let left_out: Vec<u32> = (0..count as u32).filter(|t| connections.area[*t as usize] == 0.0).collect();
        atlas.append(mesh, left_out.iter().map(|t| (t, &[0; 3])), &[[0, 0]]);
        let is_cut = |side: u32| {
            let partner = connections.partner[side as usize];
            partner != NONE && side < partner && atlas.charts[side as usize / 3] != atlas.charts[partner as usize / 3]
        };
        let length = |side: u32| {
            let corners = mesh.corners(side / 3);
            corners[side as usize % 3].distance(corners[(side as usize + 1) % 3])
        };
        let cuts = (0..3 * count as u32).filter(|side| is_cut(*side)).chain(connections.seams.iter().copied());
        let seam_length = cuts.map(length).sum();
        atlas.metrics = atlas.measured(mesh);
        atlas.metrics.charts = self.flats.len();
        atlas.metrics.seam_length = seam_length;
        atlas.metrics.texels_per_unit = scale;
        atlas
    }
}

impl Atlas {
    /// Adds triangles by their corners among points, with a vertex for each pair of a point and a vertex of the mesh.
    fn append<'a>(
        &mut self,
        mesh: &Mesh<'_>,
        triangles: impl Iterator<Item = (&'a u32, &'a [u32; 3])> + Clone,
        points: &[Point],
    ) {
        let pairs = |t: u32, corners: &[u32; 3]| {
            let sources = mesh.triangles[t as usize];
            [0, 1, 2].map(|c| (corners[c], sources[c]))
        };
        let mut vertices: Vec<(u32, u32)> = triangles.clone().flat_map(|(t, corners)| pairs(*t, corners)).collect();
        vertices.sort_unstable();
        vertices.dedup();
        let first = self.sources.len() as u32;
        for &(point, source) in &vertices {
            self.sources.push(source);
            self.uvs.push(points[point as usize].map(|x| (x as f64 / STEPS) as f32));
        }
        for (t, corners) in triangles {
            let number = |pair: (u32, u32)| first + vertices.partition_point(|v| *v < pair) as u32;
            self.triangles[*t as usize] = pairs(*t, corners).map(number);
        }
    }

    fn measured(&self, mesh: &Mesh<'_>) -> Metrics {
        let (mut sums, mut degenerate) = (Sums::default(), 0);
        for (t, corners) in self.triangles.iter().enumerate() {
            let uvs = corners.map(|i| DVec2::from(self.uvs[i as usize].map(f64::from)));
            let positions: [DVec3; 3] = mesh.corners(t as u32);
            degenerate += usize::from(self.charts[t] == NO_CHART || !sums.add(positions, uvs));
        }
        let [stretch_l2, stretch_max] = sums.stretch();
        Metrics {
            degenerate,
            stretch_l2,
            stretch_max,
            conformal: sums.conformal(),
            area: sums.area(),
            utilisation: sums.flat(),
            ..Metrics::default()
        }
    }
}
