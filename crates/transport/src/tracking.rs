//! Flights through media that vary, by tracking: distances are drawn from a bound on the extinction, and what is met
//! there is real or null (Woodcock and others 1965). Along a way value and density are kept for every lane, so that
//! colours are combined by the balance heuristic of lanes (Miller, Georgiev, Jarosz 2019, "A Null-Scattering Path
//! Integral Formulation of Light Transport").
//!
//! A walk through at most 16³ cells gives a bound on the extinction in each; events drawn from it are real or null.
//! Random numbers of a flight are a hash of the ray and of one number of the path. The optical depth of a cell counts
//! as at most 4000, which bounds the number of collisions.

use crate::flight::{Flight, lanes, sample_flight};
use steradian_core::{
    Scene,
    medium::{Field, Medium, transmittance},
};
use steradian_engine::Stop;
use steradian_math::{
    Ray, Spectrum,
    hash::{HashRng, combine64},
    spectra::Wavelengths,
};

/// Largest optical depth of a cell of the majorant grid.
const MOST_DEPTH: f32 = 4000.0;
/// Collisions, real and null, between looks at whether to stop.
const STEPS_UNWATCHED: u32 = 1024;

/// Random numbers for a path segment: a function of the ray and of one number of the path.
fn numbers(ray: &Ray, number: f32) -> HashRng {
    // The seed hashes the random number with the bits of origin and direction: equal rays have equal estimates.
    let mut seed = u64::from(number.to_bits());
    for v in [ray.origin, ray.direction] {
        seed = v.to_array().iter().fold(seed, |seed, x| combine64(seed, x.to_bits().into()));
    }
    HashRng::new(seed)
}

/// A path segment through a medium, under way: throughput and density by lanes.
struct Way {
    /// Throughput, and the density with which each lane would have drawn it; of both only the ratio counts.
    value: Spectrum,
    density: Spectrum,
    lanes: usize,
}

impl Way {
    fn mean(&self, s: Spectrum) -> f32 {
        (0..self.lanes).map(|l| s[l]).sum::<f32>() / self.lanes as f32
    }

    /// Goes on: both by factors of their own.
    fn pass(&mut self, value: Spectrum, density: Spectrum) {
        // Both products run side by side; dividing both by the mean density keeps them near one, and only their ratio
        // counts.
        self.value *= value;
        self.density *= density;
        let mean = self.mean(self.density);
        if mean > 0.0 {
            self.value = self.value / mean;
            self.density = self.density / mean;
        }
    }

    /// The weight of an event with a value and a density.
    fn weight(&self, value: Spectrum, density: Spectrum) -> Spectrum {
        // Balance heuristic over lanes: w = f(λ) / mean of p over the lanes that might have drawn the way.
        let mean = self.mean(self.density * density);
        if mean > 0.0 { self.value * value / mean } else { Spectrum::ZERO }
    }
}

/// A stretch of a ray through a medium that varies.
#[derive(Clone, Copy, Debug)]
pub struct Stretch<'a> {
    /// The medium.
    pub medium: &'a Medium,
    /// Its field.
    pub field: &'a Field,
    /// The ray.
    pub ray: &'a Ray,
    /// Length of the stretch, in units of the ray's direction.
    pub distance: f32,
    /// The wavelengths.
    pub lambda: &'a Wavelengths,
    /// Cancellation flag.
    pub stop: &'a Stop,
}

impl Stretch<'_> {
    /// Draws a free flight; adds the light that the medium gives off on the way. `number` is a random number, `lane`
    /// another one.
    pub fn sample_flight(&self, scene: &Scene, (lane, number): (f32, f32), emitted: &mut Spectrum) -> Flight {
        let lanes = lanes(scene, self.lambda);
        // Where nothing scatters, the flight passes for sure and absorption is a factor.
        let scatters = self.medium.scatters(self.lambda, lanes);
        // One lane, drawn evenly, decides about all distances and collisions of the flight.
        let chosen = ((lane * lanes as f32) as usize).min(lanes - 1);
        self.track((chosen, lanes), numbers(self.ray, number), scatters, emitted)
    }

    /// Estimates the transmittance without bias; adds the light that the medium gives off on the way.
    pub fn estimate_transmittance(&self, scene: &Scene, number: f32, emitted: &mut Spectrum) -> Spectrum {
        let lanes = lanes(scene, self.lambda);
        let mut rng = numbers(self.ray, number);
        let chosen = ((rng.next_f32() * lanes as f32) as usize).min(lanes - 1);
        // Ratio tracking never scatters.
        match self.track((chosen, lanes), rng, false, emitted) {
            Flight::Passed(part) => part,
            Flight::Scattered(..) => Spectrum::ZERO,
        }
    }

    /// With `scatters` real events end the way (delta tracking), else they take their part of the light (ratio
    /// tracking).
    fn track(
        &self,
        (chosen, lanes): (usize, usize),
        mut rng: HashRng,
        scatters: bool,
        emitted: &mut Spectrum,
    ) -> Flight {
        let Self { medium, field, ray, distance, lambda, stop } = *self;
        // Coefficients where the variation is one; times the bound of a cell they give its majorant.
        let (a, s) = medium.coefficients(lambda);
        let unit = medium.majorant(lambda);
        let mut way = Way { value: Spectrum::ONE, density: Spectrum::ONE, lanes };
        // Where majorants are far above the extinction, a segment may have thousands of null collisions.
        let (mut event, mut steps) = (None, 0_u32);
        // The cells of the grid along the ray, in order, each with the bound on the variation in it.
        field.walk(ray, distance, |begin, end, most| {
            // Bounds the number of events: beyond an optical depth of MOST_DEPTH a cell is opaque in any case.
            let majorant = (unit * most).map(|m| m.min(MOST_DEPTH / (end - begin)));
            // Tentative collisions in the cell: t ← t − ln(1 − ξ)/μ̄ with the majorant μ̄ of the chosen lane. The
            // exponential has no memory, so each cell begins anew.
            let mut t = begin;
            loop {
                let step = if majorant[chosen] > 0.0 {
                    -(1.0 - rng.next_f32()).ln() / majorant[chosen]
                } else {
                    f32::INFINITY
                };
                let left = end - t;
                // exp(−μ̄ Δt) of every lane, in the value and in the density that the lane would have had.
                let passed = transmittance(majorant, step.min(left));
                way.pass(passed, passed);
                // No collision before the end of the cell.
                if step >= left {
                    return true;
                }
                t += step;
                steps = steps.wrapping_add(1);
                if steps.is_multiple_of(STEPS_UNWATCHED) && stop.is_asked() {
                    event = Some(Flight::Passed(Spectrum::ZERO));
                    return false;
                }
                // A collision: μa, μs and μt = μa + μs at its point.
                let p = field.place(ray.at(t));
                let (absorbed, scattered) = field.coefficients((a, s), p, lambda);
                let real = absorbed + scattered;
                // Coefficients are held below the majorant, which only its cap can make smaller than they are.
                let part = |l: usize| if real[l] > majorant[l] { majorant[l] / real[l] } else { 1.0 };
                let part = Spectrum::new([0, 1, 2, 3].map(part));
                let (absorbed, scattered, real) = (absorbed * part, scattered * part, real * part);
                // Emission: μa Le at the collision, over the density μ̄ of collisions.
                if let Some(glow) = &medium.glow {
                    *emitted += way.weight(absorbed * glow.eval(p, lambda), majorant);
                }
                // The null part of the collision, μn = μ̄ − μt, adds nothing and absorbs nothing.
                let null = (majorant - real).max(0.0);
                // Ratio tracking: the way goes on with the part μn/μ̄ (Novák, Selle, Jarosz 2014, "Residual Ratio
                // Tracking for Estimating Attenuation in Participating Media").
                if !scatters {
                    way.pass(null, majorant);
                } else if rng.next_f32() * majorant[chosen] < real[chosen] {
                    // Delta tracking: the collision is real with probability μt/μ̄ of the chosen lane. Its value is μs,
                    // its density μt.
                    event = Some(Flight::Scattered(t, way.weight(scattered, real)));
                    return false;
                } else {
                    // A null collision, with probability μn/μ̄: the way goes on.
                    way.pass(null, null);
                }
                // Nothing left: the rest of the way brings nothing.
                let left = way.mean(way.value);
                if left <= 0.0 || left.is_nan() {
                    event = Some(Flight::Passed(Spectrum::ZERO));
                    return false;
                }
            }
        });
        // No real collision up to the end: value over mean density is the estimate of the transmittance.
        event.unwrap_or_else(|| Flight::Passed(way.weight(Spectrum::ONE, Spectrum::ONE)))
    }
}

/// Draws a free flight along a ray over at most `distance` through any medium, by two random numbers; adds the light
/// that the medium gives off on the way: over the whole distance in closed form where it is homogeneous, else as
/// tracking meets it.
#[inline]
pub fn fly(
    medium: &Medium,
    (ray, distance): (&Ray, f32),
    (lane, u): (f32, f32),
    (scene, lambda, stop): (&Scene, &Wavelengths, &Stop),
    emitted: &mut Spectrum,
) -> Flight {
    match &medium.field {
        // Le over the whole segment in closed form, and a distance t = −ln(1 − u)/σt.
        None => {
            if medium.glow.is_some() {
                *emitted += medium.glow_over(distance, lambda);
            }
            sample_flight(scene, medium, distance, lane, u, lambda)
        }
        // Tracking through cells of bounded extinction; Le is gathered at the collisions.
        Some(field) => Stretch { medium, field, ray, distance, lambda, stop }.sample_flight(scene, (lane, u), emitted),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::{Arc, atomic::AtomicBool};
    use steradian_core::{
        ColorMode,
        medium::{Grid, Variation},
    };
    use steradian_math::{Bounds3, Vec3, spectra::role::Color, transform::Affine};
    use steradian_texture::Wrap;

    /// A way of thousands of null events through an empty part of a cell ends where that is asked for, and else by
    /// itself.
    #[test]
    fn ways_of_null_events_end_where_they_are() {
        let mut densities = vec![0.0; 64 * 64];
        densities[63] = 1e8;
        let grid = Grid::new([64, 64, 1], densities, Wrap::Border).unwrap();
        let unit = Bounds3 { min: Vec3::ZERO, max: Vec3::ONE };
        let field = Field::new(&unit, &Affine::IDENTITY, Variation::Density(grid), ColorMode::Rgb).unwrap();
        let medium = Medium {
            field: None,
            glow: None,
            sigma_a: Color::constant(1.0),
            sigma_s: Color::BLACK,
            scale: 1.0,
            phase: steradian_core::medium::Phase::ISOTROPIC,
        };
        // Above the number that is not zero, within its cell of the bounds.
        let ray = Ray::new(Vec3::new(-1.0, 3.5 / 64.0, 0.5), Vec3::X);
        let passed = |stop: &Stop| {
            let mut emitted = Spectrum::ZERO;
            let lambda = &Wavelengths::RGB;
            let stretch = Stretch { medium: &medium, field: &field, ray: &ray, distance: 9.0, lambda, stop };
            match stretch.track((0, 3), HashRng::new(1), false, &mut emitted) {
                Flight::Passed(part) => part[0],
                Flight::Scattered(..) => f32::NAN,
            }
        };
        assert_eq!(passed(&Stop::by(&Arc::new(AtomicBool::new(true)))), 0.0, "it went on");
        assert!((passed(&Stop::default()) - 1.0).abs() < 1e-3, "nothing is there to take light");
    }
}
