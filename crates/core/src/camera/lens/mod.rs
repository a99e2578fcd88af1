//! Cameras with lenses of several elements: rays are refracted at each spherical surface (Kolb, Mitchell, Hanrahan, A
//! realistic camera model for computer graphics, 1995; pbrt-v3, 6.4, with the weights of pbrt-v4).

mod focus;
mod pupil;
mod stop;
mod surface;
#[cfg(test)]
mod tests;

pub use stop::Stop;
pub use surface::LensElement;

use pupil::{Bounds, INTERVALS};
use steradian_math::{DVec2, Vec2, Vec3};
use surface::{Beam, Glass, Surface};

/// The wavelength, nm, at which indices are given.
pub(super) const D_LINE: f64 = 587.561_8;

/// A double Gauss of 50 mm at f/2: US patent 2,673,491 (Tronnier, 1954), scaled from 100 mm as in Smith, Modern Lens
/// Design. Abbe numbers are those of Schott's glasses of these indices.
pub const DOUBLE_GAUSS: [[f64; 5]; 11] = [
    [29.475, 3.76, 1.67, 25.2, 47.1],
    [84.83, 0.12, 1.0, 25.2, 0.0],
    [19.275, 4.025, 1.67, 23.0, 47.1],
    [40.77, 3.275, 1.699, 23.0, 30.1],
    [12.75, 5.705, 1.0, 18.0, 0.0],
    [0.0, 4.5, 0.0, 17.1, 0.0],
    [-14.495, 1.18, 1.603, 17.0, 38.0],
    [40.77, 6.065, 1.658, 20.0, 57.3],
    [-20.385, 0.19, 1.0, 20.0, 0.0],
    [437.065, 3.22, 1.717, 20.0, 48.0],
    [-39.73, 5.0, 1.0, 20.0, 0.0],
];

/// A lens in front of a film, focused.
#[derive(Clone, Debug)]
pub struct LensSystem {
    /// From the scene to the film.
    surfaces: Vec<Surface>,
    stop: Stop,
    is_dispersive: bool,
    /// Bounds of the exit pupil by intervals of the film's radius.
    pupils: Vec<Option<Bounds>>,
    /// Film radius at which the last interval ends, mm.
    film_radius: f64,
    /// From the film to the principal plane that is nearer to it, mm.
    image_distance: f64,
}

impl LensSystem {
    /// Places a lens before a film of a diagonal in mm, so that what is `focus` metres from the film is sharp. The
    /// diameter of its stop is the smaller one of `aperture` (mm) and its table's.
    ///
    /// # Errors
    /// What is wrong with the table, or why the lens makes no picture.
    pub fn new(
        rows: &[LensElement],
        stop: Stop,
        aperture: Option<f64>,
        focus: f64,
        diagonal: f64,
    ) -> Result<Self, String> {
        const MOST: usize = 256;
        if rows.is_empty() || rows.len() > MOST {
            return Err(format!("a lens has 1 to {MOST} rows, not {}", rows.len()));
        }
        // Validate the table row by row.
        for (k, row) in rows.iter().enumerate() {
            let fault = if row.radius.is_nan() || row.radius.abs() > 0.0 && row.radius.abs() < 1e-3 {
                Some("a radius of curvature is 0 (the stop) or at least 0.001 mm")
            } else if !(0.0..=1e5).contains(&row.thickness) {
                Some("a thickness is in [0, 100000] mm")
            } else if row.eta != 0.0 && !(1.0..=10.0).contains(&row.eta) {
                Some("an index of refraction is 0 or in [1, 10]")
            } else if !(1e-3..=1e5).contains(&row.diameter) {
                Some("a diameter is in [0.001, 100000] mm")
            } else if !(0.0..=1e6).contains(&row.abbe) || row.abbe > 0.0 && row.abbe < 5.0 {
                Some("an Abbe number is 0 (no dispersion) or in [5, 1000000]")
            } else {
                None
            };
            if let Some(fault) = fault {
                return Err(format!("row {} of the lens: {fault}", k + 1));
            }
        }
        // Place surfaces from the film outwards; the glass behind one row is before the next.
        let mut vertex: f64 = rows.iter().map(|r| r.thickness).sum();
        let mut before = Glass::AIR;
        let mut surfaces = Vec::with_capacity(rows.len());
        for row in rows {
            let mut row = *row;
            if row.radius == 0.0 {
                row.diameter = aperture.map_or(row.diameter, |a| a.clamp(1e-3, row.diameter));
            }
            surfaces.push(Surface::new(&row, vertex, before));
            before = Glass::behind(&row);
            vertex -= row.thickness;
        }
        let is_dispersive = rows.iter().any(|r| r.abbe > 0.0 && r.eta > 1.0);
        // Filters reach beyond the film.
        let film_radius = 0.5 * 1.05 * diagonal;
        let mut lens = Self { surfaces, stop, is_dispersive, pupils: Vec::new(), film_radius, image_distance: 0.0 };
        // Focus first: pupils depend on the lens's place.
        lens.image_distance = lens.focus(1e3 * focus)?.principal[1];
        lens.pupils = lens.pupils(film_radius);
        if lens.pupils.iter().all(Option::is_none) {
            return Err("no light passes the lens".into());
        }
        if !lens.surfaces.iter().any(|s| s.is_stop) {
            lens.stop = Stop::Circle;
        }
        Ok(lens)
    }

    /// True if the path of a ray through the lens depends on the wavelength.
    pub fn is_dispersive(&self) -> bool {
        self.is_dispersive
    }

    /// From the film to the principal plane on its side, m: what a thin lens would have.
    pub fn image_distance(&self) -> f32 {
        (1e-3 * self.image_distance) as f32
    }

    /// The radius of the stop (or else of the smallest surface), m.
    pub fn stop_radius(&self) -> f32 {
        let least = |all: &mut dyn Iterator<Item = &Surface>| all.map(|s| s.rim).fold(f64::INFINITY, f64::min);
        let stop = least(&mut self.surfaces.iter().filter(|s| s.is_stop));
        (1e-3 * if stop.is_finite() { stop } else { least(&mut self.surfaces.iter()) }) as f32
    }

    /// The ray that leaves the lens for light of a wavelength (nm) that arrives at a point of the picture, in tangents
    /// of the equivalent pinhole, through a point of the exit pupil (`u` in the unit square): origin (m) and
    /// direction in camera space, and its weight: radiance times it, averaged over `u`, is irradiance on the film.
    /// `None` where the lens stops it.
    pub(super) fn ray(&self, window: Vec2, u: Vec2, nm: f64) -> Option<(Vec3, Vec3, f32)> {
        let film = -window.as_dvec2() * self.image_distance;
        let (radius, rear) = (film.length(), self.surfaces.last()?.vertex);
        // Bounds of the exit pupil for this distance from the axis; a uniform point in them.
        let interval = ((radius / self.film_radius * INTERVALS as f64) as usize).min(INTERVALS - 1);
        let [x0, x1, y1] = (*self.pupils.get(interval)?)?;
        let aim = DVec2::new(x0 + (x1 - x0) * f64::from(u.x), y1 * (2.0 * f64::from(u.y) - 1.0));
        let turn = if radius > 0.0 { film / radius } else { DVec2::X };
        // Bounds are stored for the +x axis: rotate to the point of the film.
        let aim = turn.rotate(aim);
        let beam = Beam::between(film.extend(0.0), aim.extend(rear));
        // Trace from the film to the scene, refracting at every surface.
        let (out, share) = surface::follow(self.surfaces.iter().rev(), beam, nm, &self.stop)?;
        let area = (x1 - x0) * 2.0 * y1;
        // cos⁴θ·A/z²: the measure of the rectangle aimed at (pbrt-v4's weight, without its exposure time).
        let weight = share * beam.direction.z.powi(4) * area / (rear * rear);
        Some(((out.origin * 1e-3).as_vec3(), out.direction.as_vec3(), weight as f32))
    }

    /// Axial position of the vertex of the foremost surface, m.
    pub(super) fn front(&self) -> f32 {
        self.surfaces.first().map_or(0.0, |s| (1e-3 * s.vertex) as f32)
    }

    /// Moves it towards the scene, mm.
    fn shift(&mut self, by: f64) {
        self.surfaces.iter_mut().for_each(|s| s.vertex += by);
    }
}

impl From<[f64; 5]> for LensElement {
    /// Radius, thickness, index, diameter, Abbe number.
    fn from([radius, thickness, eta, diameter, abbe]: [f64; 5]) -> Self {
        Self { radius, thickness, eta, diameter, abbe }
    }
}
