//! Path guiding towards caustics: photons that mirrors and glass focused, and the sampling of directions by them
//! (Jensen 1995, "Importance Driven Path Tracing Using the Photon Map").
//!
//! A path tracer finds light behind a lens or in a mirror by chance alone: no light sample passes there. So before a
//! session a number of photons are sent from the lights towards everything that may focus light, and where they then
//! land on other surfaces is kept, with the point q that they came from last. At a point x of a surface near them,
//! directions are drawn with the density
//!
//! `p(ω) = (1 − s) p_bsdf(ω) + s Σ_i w_i K(ω, q_i − x)`
//!
//! over the photons i of its neighbourhood, with kernels K as wide as the photons lie apart and a share s by how much
//! light they bring. Values divided by this density are right whatever the photons are, so these need neither be many
//! nor exact: they decide about the error, not about the mean.
//!
//! Up to 2¹⁶ photons are sent; a k-d tree stores their landings. The map is a `Guide` of `steradian_transport`. A trial
//! decides whether it pays (`trials::caustics`).

mod photons;
use crate::{Stop, regions::Regions};
use photons::{Photon, is_receiver};
use steradian_core::Scene;
use steradian_math::{Bounds3, Frame, Vec2, Vec3};
use steradian_transport::{Directions, Guide, Vertex};

/// Fewer landed ones than this are no guide.
const FEWEST: usize = 64;
/// Most photons of a neighbourhood.
const LANES: usize = 32;
/// The largest share of directions drawn by the photons.
const MOST: f32 = 0.6;
/// Below this share they are not asked.
const LEAST: f32 = 0.03;
/// Points that stand for a direction are this many times the size of a neighbourhood away.
const FAR: f32 = 1e3;
/// Scattering events of a path before which the photons are asked: what they bring to later ones is mixed with much
/// other light by then, and costs as much.
const EVENTS: u32 = 3;
/// Bounds of the kernels' radius, rad.
const RADIUS: (f32, f32) = (0.01, 0.6);

/// The photons that landed, by neighbourhoods.
#[derive(Clone, Debug)]
pub struct Caustics {
    regions: Regions,
    leaves: Vec<Leaf>,
}

/// A neighbourhood; lanes beyond its photons have no weight.
#[derive(Clone, Debug)]
pub(crate) struct Leaf {
    /// Around the photons and a margin: elsewhere they say nothing.
    bounds: Bounds3,
    /// The share of directions that they draw.
    share: f32,
    q: [[f32; LANES]; 3],
    /// One less the cosine of the kernels' radius.
    width: [f32; LANES],
    /// Weight over the kernel's integral.
    scale: [f32; LANES],
    /// Sums of the weights up to and with each.
    sums: [f32; LANES],
}

impl Caustics {
    /// Sends the photons; `None` where nothing focuses light, or too few of them land.
    pub fn new(scene: &Scene, stop: &Stop) -> Option<Self> {
        let mut photons = photons::send(scene, stop);
        if photons.len() < FEWEST {
            return None;
        }
        let mut leaves = Vec::new();
        let make = |photons: &mut [Photon]| {
            let leaf = Leaf::new(photons);
            let guides = leaf.share > 0.0;
            leaves.extend(guides.then_some(leaf));
            guides
        };
        let regions = Regions::new(&mut photons, |photon| photon.p, LANES, make)?;
        Some(Self::of(regions, leaves))
    }

    fn of(regions: Regions, leaves: Vec<Leaf>) -> Self {
        let bounds = leaves.iter().fold(Bounds3::EMPTY, |b, leaf| b.union(leaf.bounds));
        Self { regions: regions.within(bounds), leaves }
    }

    /// True if there may be photons for a point that paths reach after some scattering events.
    #[inline]
    pub(crate) fn reaches(&self, p: Vec3, events: u32) -> bool {
        Self::guides_after(events) && self.regions.bounds().contains(p)
    }

    /// True if photons guide after so many scattering events.
    #[inline]
    fn guides_after(events: u32) -> bool {
        events < EVENTS
    }

    /// The photons about a point.
    #[inline]
    fn leaf(&self, p: Vec3) -> Option<&Leaf> {
        let leaf = &self.leaves[self.regions.leaf(p)?];
        leaf.bounds.contains(p).then_some(leaf)
    }
}

impl Guide for Caustics {
    #[inline]
    fn at(&self, vertex: &Vertex<'_>, events: u32) -> Option<impl Directions> {
        let Vertex::Surface { i, scattering, .. } = vertex else { return None };
        if !Self::guides_after(events) {
            return None;
        }
        let p = i.surface.p;
        is_receiver(&scattering.bsdf).then(|| self.leaf(p)).flatten().map(|leaf| LeafAt { leaf, p })
    }
}

/// A neighbourhood seen from a point in it.
struct LeafAt<'a> {
    leaf: &'a Leaf,
    p: Vec3,
}

impl Directions for LeafAt<'_> {
    #[inline]
    fn share(&self) -> f32 {
        self.leaf.share
    }

    #[inline]
    fn sample(&self, u: f32, u2: Vec2) -> Vec3 {
        self.leaf.sample(self.p, u, u2)
    }

    #[inline]
    fn pdf(&self, w: Vec3) -> f32 {
        self.leaf.pdf(self.p, w)
    }
}

impl Leaf {
    fn new(photons: &[Photon]) -> Self {
        let bounds = Bounds3::from_points(photons.iter().map(|p| p.p));
        let scale = bounds.diagonal().max_element().max(f32::MIN_POSITIVE);
        let margin = Vec3::splat(0.25 * bounds.diagonal().max_element());
        let total: f32 = photons.iter().map(|p| p.power).sum();
        let area = {
            let d = bounds.diagonal().max(Vec3::splat(0.01 * bounds.diagonal().max_element()));
            (d.x * d.y).max(d.y * d.z).max(d.z * d.x)
        };
        let focused = total / area;
        let other = photons.iter().map(|p| p.other).sum::<f32>() / photons.len() as f32;
        let share = (focused / (focused + other)).min(MOST);
        let mut leaf = Self {
            share: if share >= LEAST { share } else { 0.0 },
            bounds: Bounds3 { min: bounds.min - margin, max: bounds.max + margin },
            q: [[0.0; LANES]; 3],
            width: [1.0; LANES],
            scale: [0.0; LANES],
            sums: [1.0; LANES],
        };
        // Seen from another point of the neighbourhood a photon came from the same place on the last mirror, from the
        // same image of the light behind it, or out of the same direction: whatever brings them closest together.
        let centre = bounds.center();
        let aims: [&dyn Fn(&Photon) -> Vec3; 3] = [
            &|photon| photon.q,
            &|photon| photon.p + (photon.q - photon.p).normalize_or_zero() * photon.length.min(FAR * scale),
            &|photon| photon.p + (photon.q - photon.p).normalize_or_zero() * (FAR * scale),
        ];
        let (points, radii) = aims
            .iter()
            .map(|aim| {
                let points: Vec<Vec3> = photons.iter().map(aim).collect();
                let radii = radii(centre, &points);
                (points, radii)
            })
            .min_by(|a, b| a.1.iter().sum::<f32>().total_cmp(&b.1.iter().sum()))
            .unwrap_or_default();
        let mut sum = 0.0;
        for (i, photon) in photons.iter().enumerate() {
            let radius = radii[i];
            let width = 1.0 - radius.cos();
            let weight = photon.power / total;
            sum += weight;
            for (q, coordinate) in leaf.q.iter_mut().zip(points[i].to_array()) {
                q[i] = coordinate;
            }
            leaf.width[i] = width;
            leaf.scale[i] = weight / (std::f32::consts::PI * width * width);
            leaf.sums[i] = if i + 1 == photons.len() { 1.0 } else { sum };
        }
        leaf
    }

    /// A direction from `p`; its density falls linearly with the cosine from each photon's direction.
    fn sample(&self, p: Vec3, u: f32, u2: Vec2) -> Vec3 {
        let i = self.sums.iter().position(|s| u < *s).unwrap_or(0);
        let z = (Vec3::new(self.q[0][i], self.q[1][i], self.q[2][i]) - p).normalize_or(Vec3::Z);
        // A cone of a width whose square is uniform.
        let width = self.width[i] * (1.0 - (1.0 - u2.x).sqrt());
        let sin = (width * (2.0 - width)).max(0.0).sqrt();
        let (y, x) = (u2.y * std::f32::consts::TAU).sin_cos();
        Frame::from_z(z).to_world(Vec3::new(sin * x, sin * y, 1.0 - width)).normalize()
    }

    /// The density of a direction from `p` (sr⁻¹).
    fn pdf(&self, p: Vec3, w: Vec3) -> f32 {
        let mut sum = [0.0; LANES];
        for (i, sum) in sum.iter_mut().enumerate() {
            let (x, y, z) = (self.q[0][i] - p.x, self.q[1][i] - p.y, self.q[2][i] - p.z);
            let cos = (x * w.x + y * w.y + z * w.z) / (x * x + y * y + z * z).sqrt();
            *sum = self.scale[i] * (self.width[i] - 1.0 + cos).max(0.0);
        }
        sum.iter().sum()
    }
}

/// The kernels' radii (rad) at a point: as wide as the third next photon is away.
fn radii(at: Vec3, points: &[Vec3]) -> Vec<f32> {
    let directions: Vec<Vec3> = points.iter().map(|p| (*p - at).normalize_or_zero()).collect();
    let radius = |d: &Vec3| {
        // Squared distances of itself and the three next.
        let mut nearest = [f32::INFINITY; 4];
        for other in &directions {
            let mut distance = (*other - *d).length_squared();
            for near in &mut nearest {
                (*near, distance) = (near.min(distance), near.max(distance));
            }
        }
        (2.0 * nearest[directions.len().min(4) - 1].sqrt()).clamp(RADIUS.0, RADIUS.1)
    };
    directions.iter().map(radius).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian_bsdf::Diffuse;
    use steradian_core::{material::Scattering, shape::SurfacePoint};
    use steradian_math::{
        Ray, Spectrum,
        hash::{combine32, unit_f32},
        warp,
    };
    use steradian_transport::GuidedDirection;

    fn leaf() -> Leaf {
        let at = |k: u32, scale: f32| Vec3::from([0, 1, 2].map(|axis| (unit_f32(combine32(k, axis)) - 0.5) * scale));
        let photons: Vec<Photon> = (0..LANES as u32 - 3)
            .map(|k| Photon {
                p: at(k, 0.1),
                q: at(k + 100, 1.0) + Vec3::new(0.0, 0.0, 1.5),
                length: 3.0,
                power: 1.0 + k as f32,
                other: 0.1,
            })
            .collect();
        Leaf::new(&photons)
    }

    /// The density integrates to one, and samples have the mean direction that it gives. 5σ.
    #[test]
    fn directions_have_their_density() {
        let (leaf, p) = (leaf(), Vec3::new(0.02, -0.03, 0.01));
        let (rows, columns) = (1000, 1000);
        let (mut total, mut mean) = (0.0_f64, [0.0_f64; 3]);
        for k in 0..rows * columns {
            let u = Vec2::new((k % columns) as f32 + 0.5, (k / columns) as f32 + 0.5)
                / Vec2::new(columns as f32, rows as f32);
            let w = warp::uniform_sphere(u);
            let d = f64::from(leaf.pdf(p, w)) * 4.0 * std::f64::consts::PI / f64::from(rows * columns);
            total += d;
            (0..3).for_each(|a| mean[a] += d * f64::from(w[a]));
        }
        assert!((total - 1.0).abs() < 1e-3, "{total}");
        let n = 100_000;
        let (mut sum, mut squares) = ([0.0_f64; 3], [0.0_f64; 3]);
        for k in 0..n {
            let u = |d| unit_f32(combine32(k, d));
            let w = leaf.sample(p, u(1), Vec2::new(u(2), u(3)));
            assert!((w.length() - 1.0).abs() < 1e-5 && leaf.pdf(p, w) > 0.0);
            for a in 0..3 {
                sum[a] += f64::from(w[a]);
                squares[a] += f64::from(w[a]) * f64::from(w[a]);
            }
        }
        for a in 0..3 {
            let m = sum[a] / f64::from(n);
            let sigma = ((squares[a] / f64::from(n) - m * m) / f64::from(n)).sqrt();
            assert!((m - mean[a]).abs() < 5.0 * sigma, "axis {a}: {m} for {}", mean[a]);
        }
    }

    /// Beside a lobe of a surface the photons leave the albedo what it is, in the mean.
    #[test]
    fn mixtures_keep_the_albedo() {
        let mut leaf = leaf();
        leaf.share = 0.4;
        let regions = Regions::new(&mut [Vec3::ZERO], |p| *p, 1, |_| true).unwrap();
        let caustics = Caustics::of(regions, vec![leaf]);
        // A grey point of a surface, seen aslant.
        let scene = crate::stop_tests::ball("diffuse");
        let ray = Ray::new(Vec3::new(0.0, 0.0, -3.0), Vec3::Z);
        let mut i = scene.interaction(&ray, &scene.intersect(&ray).unwrap());
        let (p, n) = (Vec3::ZERO, Vec3::new(0.6, 0.0, 0.8));
        let frame = Frame::from_z(n);
        i.surface = SurfacePoint::bare(p, Vec3::ZERO, n);
        i.wo = frame.to_world(Vec3::new(0.0, 0.6, 0.8));
        let scattering =
            Scattering::plain(steradian_bsdf::Bsdf::Diffuse(Diffuse { reflectance: Spectrum::splat(0.7) }));
        let vertex = Vertex::Surface { i, scattering, frame, medium: None };
        let n = 100_000;
        let (mut sum, mut squares) = (0.0_f64, 0.0_f64);
        for k in 0..n {
            let u = |d| unit_f32(combine32(k, d));
            let directions = caustics.at(&vertex, 0).unwrap();
            let draw = GuidedDirection::by_mixture(&vertex, &directions, u(1), Vec2::new(u(2), u(3)));
            let weight = draw.map_or(0.0, |d| f64::from(d.sample.weight[0]));
            sum += weight;
            squares += weight * weight;
        }
        let mean = sum / f64::from(n);
        let sigma = ((squares / f64::from(n) - mean * mean) / f64::from(n)).sqrt();
        assert!((mean - 0.7).abs() < 4.0 * sigma && sigma < 0.005, "{mean} ± {sigma}");
    }
}
