//! Compiling when lights shine.

use super::Compiler;
use steradian_core::light::{Light, Lights, Schedule, Timetable};
use steradian_scene::Node;

/// Emitter, by its index.
#[derive(Clone, Copy, Debug)]
pub(super) enum Lamp {
    /// A light that is no part of a shape.
    Light(u32),
    /// A surface.
    Emitter(u32),
}

impl Compiler<'_> {
    /// Notes when a light shines, where that is not always; reports times that are none.
    pub(super) fn schedule(&mut self, node: &Node, lamp: Lamp) {
        let Schedule { mut on, mut off, mut period } = Schedule::ALWAYS;
        for (name, time) in [("on", &mut on), ("off", &mut off), ("period", &mut period)] {
            if let Some(given) = self.typed(node, name, "a number", |n| n.float(name)) {
                *time = given;
            }
        }
        let schedule = Schedule { on, off, period };
        if schedule == Schedule::ALWAYS {
            return;
        }
        let mut given = ["on", "off", "period"].into_iter().filter_map(|name| node.param(name));
        let span = given.next_back().and_then(|p| p.span).or(node.span);
        let [open, close] = self.shutter();
        if on.is_nan() || off.is_nan() || on >= off {
            self.error(span, format!("this light goes on at {on} s and off at {off} s: 'off' must be after 'on'"));
        } else if period.is_nan() || period <= 0.0 || period.is_finite() && off - on > period {
            let what = format!(
                "a light with a period of {period} s needs a period above 0, 'on', and 'off' within a period after it, \
                 not {on} s and {off} s"
            );
            self.error(span, what);
        } else if !(open <= close && (close - open).is_finite()) {
            let what = format!(
                "a light goes on or off in an exposure from {open} s to {close} s, which must not end before it begins"
            );
            self.error(span, what);
        } else {
            self.schedules.push((lamp, schedule));
        }
    }

    /// The schedules of all lights; `None` where all always shine.
    pub(super) fn timetable(&self, lights: &Lights) -> Option<Box<Timetable>> {
        if self.schedules.is_empty() {
            return None;
        }
        let mut of_emitters = vec![Schedule::ALWAYS; lights.emitters.len()];
        for (lamp, schedule) in &self.schedules {
            if let Lamp::Emitter(e) = lamp {
                of_emitters[*e as usize] = *schedule;
            }
        }
        let of_area = |light: &Light| match light {
            Light::Area(a) | Light::DirectionalArea(a) => of_emitters[a.emitter as usize],
            _ => Schedule::ALWAYS,
        };
        let mut of_lights: Vec<Schedule> = lights.lights.iter().map(of_area).collect();
        for (lamp, schedule) in &self.schedules {
            if let Lamp::Light(l) = lamp {
                of_lights[*l as usize] = *schedule;
            }
        }
        Some(Box::new(Timetable { exposure: self.shutter(), of_lights, of_emitters }))
    }
}
