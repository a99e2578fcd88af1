//! Surfaces of a lens and what they do to a ray. Lengths are in mm; the axis is z, with the film at 0 and the scene
//! ahead.

use super::stop::Stop;
use steradian_math::{DVec3, spectra::Dispersion};

/// A row of a lens table, from the scene to the film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LensElement {
    /// Radius of curvature, mm; above 0 where the middle bulges towards the scene. Infinite for a plane, 0 for the
    /// aperture stop.
    pub radius: f64,
    /// Distance on the axis to the next row, mm; of the last row to the film, until the lens is focused.
    pub thickness: f64,
    /// Index of refraction behind it, at the d line (587.6 nm); 0 counts as air.
    pub eta: f64,
    /// Diameter of the part that lets light through, mm.
    pub diameter: f64,
    /// Abbe number of what is behind it; 0 without dispersion.
    pub abbe: f64,
}

/// A ray inside the lens, with a direction of unit length.
#[derive(Clone, Copy, Debug)]
pub(super) struct Beam {
    pub origin: DVec3,
    pub direction: DVec3,
}

impl Beam {
    /// Ray from one point to another.
    pub fn between(origin: DVec3, to: DVec3) -> Self {
        Self { origin, direction: (to - origin).normalize() }
    }
}

/// A surface in its place.
#[derive(Clone, Debug)]
pub(super) struct Surface {
    /// Inverse of the radius, 1/mm.
    curvature: f64,
    /// Axial position of the vertex.
    pub vertex: f64,
    /// Half its diameter.
    pub rim: f64,
    /// True for the aperture stop.
    pub is_stop: bool,
    /// Media on the scene side and on the film side.
    media: [Glass; 2],
}

/// Cauchy's constants A and B (µm²) of an index of refraction `A + B/λ²`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Glass([f64; 2]);

impl Glass {
    pub const AIR: Self = Self([1.0, 0.0]);

    /// Medium behind a row of the lens table.
    pub fn behind(row: &LensElement) -> Self {
        match Dispersion::from_abbe(row.eta, row.abbe) {
            Dispersion::Cauchy([a, b, _]) if row.eta != 0.0 => Self([a, b]),
            _ => Self::AIR,
        }
    }
}

impl Surface {
    /// The surface of a row, with what is before it.
    pub fn new(row: &LensElement, vertex: f64, before: Glass) -> Self {
        let is_stop = row.radius == 0.0;
        let curvature = if is_stop { 0.0 } else { 1.0 / row.radius };
        Self { curvature, vertex, rim: 0.5 * row.diameter, is_stop, media: [before, Glass::behind(row)] }
    }

    /// Refraction of a beam at the surface, for a wavelength given by its inverse square (1/µm²): the refracted ray,
    /// starting on the surface, and the transmitted share. `None` if the beam misses, is stopped, or is totally
    /// reflected.
    fn pass(&self, beam: &Beam, inverse_square: f64, stop: &Stop) -> Option<(Beam, f64)> {
        let (c, d) = (self.curvature, beam.direction);
        let o = beam.origin - DVec3::Z * self.vertex;
        // The sphere c p² + 2 p_z = 0 by a quadratic that has the plane as its limit.
        let b = c * o.dot(d) + d.z;
        let discriminant = b * b - c * (c * o.length_squared() + 2.0 * o.z);
        if discriminant.is_nan() || discriminant <= 0.0 {
            return None;
        }
        // Cosine of incidence, signed as the direction along the axis: the side of the sphere around the vertex.
        let cos = discriminant.sqrt().copysign(d.z);
        let t = -(c * o.length_squared() + 2.0 * o.z) / (b + cos);
        let p = o + d * t;
        let normal = DVec3::new(c * p.x, c * p.y, c * p.z + 1.0);
        // The first comparison fails for NaN, too.
        let is_hit = t >= -1e-9 && normal.z > 0.0 && p.x * p.x + p.y * p.y <= self.rim * self.rim;
        if !is_hit {
            return None;
        }
        let origin = p + DVec3::Z * self.vertex;
        if self.is_stop {
            let share = stop.transmission(p.x / self.rim, p.y / self.rim);
            return (share > 0.0).then_some((Beam { origin, direction: d }, share));
        }
        // Cauchy's equation n = A + B/λ².
        let [scene, film] = self.media.map(|Glass([a, b])| a + b * inverse_square);
        let eta = if d.z > 0.0 { film / scene } else { scene / film };
        // Snell's law in vector form: ω_t = η·ω_i + (cos θ_t − η·cos θ_i)·n; total reflection ends the ray.
        let cos2 = 1.0 - eta * eta * (1.0 - cos * cos);
        let direction = d * eta + normal * (cos2.max(0.0).sqrt().copysign(d.z) - eta * cos);
        (cos2 > 0.0).then_some((Beam { origin, direction }, 1.0))
    }
}

/// Follows a ray of a wavelength (nm) through surfaces, in the order in which it meets them.
pub(super) fn follow<'a>(
    surfaces: impl Iterator<Item = &'a Surface>,
    mut beam: Beam,
    nm: f64,
    stop: &Stop,
) -> Option<(Beam, f64)> {
    let inverse_square = 1e6 / (nm * nm);
    let mut share = 1.0;
    for surface in surfaces {
        let (next, passed) = surface.pass(&beam, inverse_square, stop)?;
        (beam, share) = (next, share * passed);
    }
    Some((beam, share))
}
