//! Focusing: cardinal points of a lens, and where the film has to be.

use super::{
    D_LINE, LensSystem, Stop,
    surface::{Beam, follow},
};
use steradian_math::DVec3;

/// Paraxial approximation of a lens as a thick lens (pbrt-v3, 6.4.3), mm.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cardinal {
    /// Positions of the principal planes on the axis: on the scene side and on the film side.
    pub principal: [f64; 2],
    /// Focal length.
    pub focal_length: f64,
}

/// Zones of the pupil, of equal area, that are brought together on the film.
const ZONES: u32 = 24;

impl LensSystem {
    /// Cardinal points, by rays parallel to the axis at a small height from both sides.
    pub(super) fn cardinal(&self) -> Option<Cardinal> {
        // Trace one paraxial ray from each side.
        let least = self.surfaces.iter().map(|s| s.rim).fold(f64::INFINITY, f64::min);
        let height = 1e-4 * least;
        let (front, rear) = (self.surfaces.first()?.vertex, self.surfaces.last()?.vertex);
        // Where a ray that came in at the height leaves the axis's plane, and where it would be at that height.
        let points = |out: Beam| {
            let slope = out.direction.x / out.direction.z;
            let at = |x: f64| out.origin.z + (x - out.origin.x) / slope;
            (at(height), at(0.0))
        };
        let parallel = |z: f64, direction| Beam { origin: DVec3::new(height, 0.0, z), direction };
        // The principal plane is where the outgoing ray has the height of the incoming one, the focus where it meets
        // the axis.
        let (film_principal, film_focus) = points(self.towards_film(parallel(front + 1.0, -DVec3::Z))?);
        let (scene_principal, _) = points(self.towards_scene(parallel(rear - 1.0, DVec3::Z), D_LINE)?);
        let focal_length = film_principal - film_focus;
        let is_sound = focal_length.is_finite() && scene_principal.is_finite() && focal_length > 0.0;
        is_sound.then_some(Cardinal { principal: [scene_principal, film_principal], focal_length })
    }

    /// Moves the lens along the axis so that what is `distance` mm from the film is sharp: as a thick lens, then by
    /// the smallest root-mean-square radius of the image of a point on the axis.
    pub(super) fn focus(&mut self, distance: f64) -> Result<Cardinal, String> {
        let lens = self.cardinal().ok_or("the lens gathers no light: its focal length is not above 0")?;
        let f = lens.focal_length;
        // Distances of object and image from their planes have this sum S, and the product f S.
        let sum = distance - (lens.principal[0] - lens.principal[1]);
        let square = sum * sum - 4.0 * f * sum;
        if sum <= 0.0 || square < 0.0 {
            let least = 1e-3 * (4.0 * f + lens.principal[0] - lens.principal[1]);
            return Err(format!("the lens cannot focus nearer than {least:.4} m, measured from the film"));
        }
        let image = 2.0 * f * sum / (sum + square.sqrt());
        // Move to the paraxial focus, then refine by Newton-like steps on the spot size.
        self.shift(image - lens.principal[1]);
        for _ in 0..12 {
            let Some(step) = self.best_focus(distance).filter(|s| s.is_finite() && s.abs() < 0.1 * f) else { break };
            self.shift(-step);
            if step.abs() < 1e-9 * f {
                break;
            }
        }
        if self.surfaces.last().is_some_and(|s| s.vertex <= 0.0) {
            return Err("the film would stand inside the lens".into());
        }
        self.cardinal().ok_or_else(|| "the lens gathers no light".into())
    }

    /// Best focus of a point on the axis: the distance before the film at which its rays come closest together.
    fn best_focus(&self, distance: f64) -> Option<f64> {
        let (front, eye) = (self.surfaces.first()?, DVec3::new(0.0, 0.0, distance));
        let through = |height: f64| self.towards_film(Beam::between(eye, DVec3::new(height, 0.0, front.vertex)));
        if distance <= front.vertex {
            return None;
        }
        // The outermost ray that passes.
        let (mut passes, mut fails) = (0.0, 1.5 * front.rim);
        for _ in 0..40 {
            let middle = 0.5 * (passes + fails);
            *if through(middle).is_some() { &mut passes } else { &mut fails } = middle;
        }
        let (mut products, mut squares) = (0.0, 0.0);
        // Zones of equal area sample the pupil uniformly.
        for k in 0..ZONES {
            let out = through(passes * ((f64::from(k) + 0.5) / f64::from(ZONES)).sqrt())?;
            let slope = out.direction.x / out.direction.z;
            products += (out.origin.x - slope * out.origin.z) * slope;
            squares += slope * slope;
        }
        // Least squares: the plane where Σ x² of the rays is smallest.
        Some(-products / squares)
    }

    /// A ray from the film through the lens with a whole stop.
    pub(super) fn towards_scene(&self, beam: Beam, nm: f64) -> Option<Beam> {
        Some(follow(self.surfaces.iter().rev(), beam, nm, &Stop::Circle)?.0)
    }

    /// A ray from the scene at the d line, through the lens with a whole stop.
    pub(super) fn towards_film(&self, beam: Beam) -> Option<Beam> {
        Some(follow(self.surfaces.iter(), beam, D_LINE, &Stop::Circle)?.0)
    }
}
