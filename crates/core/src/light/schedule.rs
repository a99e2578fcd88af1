//! Schedules of lights.

use steradian_math::spectra::Wavelengths;

/// Schedule of a light, in seconds on the clock of the camera's shutter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Schedule {
    /// Time at which the light goes on.
    pub on: f64,
    /// Time at which the light goes off.
    pub off: f64,
    /// Period after which the light goes on again, and went on before; infinite of a light that shines once.
    pub period: f64,
}

impl Schedule {
    /// Schedule of a light that always shines.
    pub const ALWAYS: Self = Self { on: f64::NEG_INFINITY, off: f64::INFINITY, period: f64::INFINITY };

    fn shines(&self, moment: f64) -> bool {
        let Self { on, off, period } = *self;
        // Fold the moment into the period that begins when the light goes on.
        let moment = if period.is_finite() { on + (moment - on).rem_euclid(period) } else { moment };
        on <= moment && moment < off
    }
}

/// The schedules of all lights.
#[derive(Clone, Debug)]
pub struct Timetable {
    /// Times at which the shutter opens and closes, s.
    pub exposure: [f64; 2],
    /// Schedule of each of [`Lights::lights`](super::Lights::lights).
    pub of_lights: Vec<Schedule>,
    /// Schedule of each of [`Lights::emitters`](super::Lights::emitters).
    pub of_emitters: Vec<Schedule>,
}

impl Timetable {
    /// True if a light with the given schedule shines at the moment of the sample.
    pub(super) fn shines(&self, schedule: &Schedule, lambda: &Wavelengths) -> bool {
        let [open, close] = self.exposure;
        // The moment of emission: the time in the exposure less the delay of the light on its way.
        schedule.shines(open + (close - open) * f64::from(lambda.time) - f64::from(lambda.delay))
    }
}
